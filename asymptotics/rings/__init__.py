"""What a coefficient is: rings, harmonics, and the numbers a ring is made of.

Imports nothing from the other rooms.
"""
