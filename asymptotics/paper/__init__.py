"""The printed formulas of the paper, and the check that ours equal them."""
