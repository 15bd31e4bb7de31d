"""Runs and checkpoints on disk: sealed, checked, whole or not at all."""
