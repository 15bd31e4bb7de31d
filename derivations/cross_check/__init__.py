"""The emitted closed forms against both kinds of numerics."""
