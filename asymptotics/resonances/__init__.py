"""Where the expansion has its poles, and what happens there: tongues, folds, first touch."""
