"""Periodic states, found as such and not by waiting for a ramp to die out."""
