"""What is expanded: an equation, its static shape, its harmonics' impedances, its drive.

Over any ring of :mod:`asymptotics.rings.ring`.
"""
