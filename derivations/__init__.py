"""The programs a reader of the paper would run."""
