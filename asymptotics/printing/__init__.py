"""Formulas as text, LaTeX and NumPy code, with the helpers that are copied into it."""
