"""The string without bending, exactly: characteristics and invariant circles."""
