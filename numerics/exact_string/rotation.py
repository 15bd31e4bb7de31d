r"""Rotation numbers: the irrational that is meant by some digits, and its convergents.

A number given to finitely many digits is rational, and the circle of a rational rotation number is
the first to break. What is meant is a neighbour that is as far from all rationals as the digits
allow: its continued fraction :math:`ν = a_0 + 1/(a_1 + 1/(a_2 + …))` begins with the quotients that
the digits fix and goes on with ones. Such *noble* numbers have the most robust circles nearby
(J. M. Greene, J. Math. Phys. 20 (1979) 1183).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from numerics.errors import InputError

GOLDEN = (1 + math.sqrt(5)) / 2
# Of ν; larger ones are other numbers of whole turns with the same circles.
_LARGEST = 1000
# Quotients searched for: a double's own never need more.
_MOST = 64


@dataclass(frozen=True)
class Noble:
    """A noble number by the quotients a_0, a_1, … before the ones.

    >>> round(Noble((0, 2)).value, 6)
    0.381966
    """

    head: tuple[int, ...]

    @property
    def value(self) -> float:
        """ν, rounded."""
        x = GOLDEN
        for quotient in reversed(self.head):
            x = quotient + 1 / x
        return x

    def quotients(self) -> Iterator[int]:
        """a_0, a_1, …, without end."""
        yield from self.head
        while True:
            yield 1

    def convergents(self, largest: int) -> tuple[tuple[int, int, int], ...]:
        """(p, q, a): the convergents p/q with q ≤ ``largest`` and the quotient that made each.

        >>> [f"{p}/{q}" for p, q, _ in Noble((0, 2, 2)).convergents(20)]
        ['0/1', '1/2', '2/5', '3/7', '5/12', '8/19']
        """
        found: list[tuple[int, int, int]] = []
        before, last = (0, 1), (1, 0)
        for a in self.quotients():
            before, last = last, (a * last[0] + before[0], a * last[1] + before[1])
            if last[1] > largest:
                break
            found.append((*last, a))
        return tuple(found)


def noble(rotation: float, uncertainty: float | None = None) -> Noble:
    """The noble number with the shortest head within ``uncertainty`` of ν.

    Parameters
    ----------
    rotation
        0 < ν < 1000.
    uncertainty
        Absolute; by default what the rounding of ν to a double leaves open.

    Raises
    ------
    InputError
        ν or the uncertainty is not what is allowed.

    Examples
    --------
    >>> noble(0.618034, 5e-7).head, noble(2**0.5 - 1).head[:6]
    ((0,), (0, 2, 2, 2, 2, 2))
    """
    if not isinstance(rotation, int | float) or not 0 < rotation < _LARGEST:
        raise InputError(f"rotation = {rotation!r}; give a number between 0 and {_LARGEST}")
    width = math.ulp(rotation) if uncertainty is None else uncertainty
    if not 0 < width < rotation:
        raise InputError(
            f"uncertainty = {uncertainty!r}; give a positive number smaller than ν = {rotation!r}"
        )
    middle = Fraction(rotation)
    head = _shortest(middle - Fraction(width), middle + Fraction(width), _MOST)
    if head is None:
        raise InputError(f"rotation = {rotation!r}: no noble number is this near; give more digits")
    return Noble(head)


def _shortest(low: Fraction, high: Fraction | None, most: int) -> tuple[int, ...] | None:
    """The head with the least sum of a noble number in [low, high], high = None for infinity."""
    if most == 0:
        return None
    first = math.floor(low)
    tail = Fraction(1 / GOLDEN)
    for quotient in (first, first + 1):
        if low <= quotient + tail and (high is None or quotient + tail <= high):
            return (quotient,)
    heads = []
    for quotient in (first, first + 1):
        if high is not None and quotient > high:
            continue
        least = max(low - quotient, Fraction(0))
        largest = Fraction(1) if high is None else min(high - quotient, Fraction(1))
        if largest <= 0:
            continue
        further = _shortest(1 / largest, 1 / least if least else None, most - 1)
        if further is not None:
            heads.append((quotient, *further))
    return min(heads, key=sum) if heads else None
