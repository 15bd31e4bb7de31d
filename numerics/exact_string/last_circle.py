"""The largest ε at which the exact string has a periodic state, followed from small ε."""

from __future__ import annotations

import math

from numerics.errors import CircleNotFoundError
from numerics.exact_string.invariant_circle import NO_CIRCLE, InvariantCircle, invariant_circle

MISSES = 4
"""Failures in a row that end the search."""

_NODES = 4096
_FIRST = 1e-5


def largest_circle(omega: float, width: float = 0.01, step: float = 1.1) -> tuple[float, float]:
    """Bracket of the largest ε at which a periodic state is found, followed from small ε.

    A lower bound of the largest at which there is one, and not a close one away from the
    resonances: at Ω = 1.9387855 it is 0.1260, where the golden circle lasts to 0.1292, 3 % more.
    Where the rotation number passes a rational there is none either, in a narrow gap. So the search
    goes on past MISSES failures, each ``step`` further, before it takes a failure for the end.

    >>> low, high = largest_circle(2.9)
    >>> round(low, 4), high < 1.011 * low
    (0.0087, True)
    """
    state: InvariantCircle | None = None

    def found(epsilon: float) -> bool:
        nonlocal state
        try:
            state = invariant_circle(omega, epsilon, max_nodes=_NODES, start=state)
        except CircleNotFoundError:
            return False
        return True

    highest = NO_CIRCLE / (2 * omega**2)
    low = _FIRST
    while not found(low):  # next to a resonance it ends below 1e-5
        low /= 4
    high, misses = low * step, 0
    epsilon = high
    while misses < MISSES and epsilon < highest:
        if found(epsilon):
            low, high, misses = epsilon, min(epsilon * step, highest), 0
        else:
            misses += 1
        epsilon *= step
    while high > low * (1 + width):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if found(middle) else (low, middle)
    return low, high
