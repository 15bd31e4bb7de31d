r"""Balls as coefficients: every number is an interval that contains the true one.

The engine adds and multiplies; over :class:`flint.arb` and :class:`flint.acb` each such step
encloses the exact result, rounding included. So what
:func:`asymptotics.expansion.order_loop.expand` yields is proved: the true coefficient lies in the
ball. Residuals (:func:`asymptotics.expansion.proof.residuals`) are balls that must contain zero.
The precision is FLINT's, :func:`~asymptotics.rings.precision.at_precision`.

A frequency may be given as a double, as a decimal, or relative to a resonance, see
:class:`Frequency`; nothing is rounded on the way in.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from asymptotics.errors import InputError, ResonanceError


class ArbRing:
    """Real balls, in the precision of the current context.

    >>> third = ArbRing().rational(1, 3)
    >>> third.contains(fmpq(1, 3)), float(third.rad()) < 1e-15
    (True, True)
    """

    even = True

    @property
    def zero(self) -> arb:
        """The exact 0."""
        return arb(0)

    @property
    def one(self) -> arb:
        """The exact 1."""
        return arb(1)

    def rational(self, numerator: int, denominator: int = 1) -> arb:
        """A ball around numerator/denominator."""
        return arb(fmpq(numerator, denominator))

    def sum(self, terms: Iterable[arb]) -> arb:
        """Σ terms."""
        return sum(terms, arb(0))

    def conjugate(self, element: arb) -> arb:
        """The element itself: the state is even in time."""
        return element

    def is_zero(self, element: arb) -> bool:
        """Exactly zero: a ball around zero may hold another number."""
        return bool(element.is_zero())


class AcbRing:
    """Complex balls, in the precision of the current context.

    >>> ring = AcbRing()
    >>> ring.is_zero(ring.conjugate(acb(1, 2)) + ring.rational(-1) - acb(0, -2))
    True
    """

    even = False

    @property
    def zero(self) -> acb:
        """The exact 0."""
        return acb(0)

    @property
    def one(self) -> acb:
        """The exact 1."""
        return acb(1)

    def rational(self, numerator: int, denominator: int = 1) -> acb:
        """A ball around numerator/denominator."""
        return acb(arb(fmpq(numerator, denominator)))

    def sum(self, terms: Iterable[acb]) -> acb:
        """Σ terms."""
        return sum(terms, acb(0))

    def conjugate(self, element: acb) -> acb:
        """The complex conjugate."""
        return element.conjugate()

    def is_zero(self, element: acb) -> bool:
        """Exactly zero."""
        return bool(element.is_zero())


# Decimals beyond 10^±3000 would take seconds to write out, and mean nothing here.
_LARGEST_EXPONENT = 3000
_DECIMAL = r"[+-]?\s*(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?:/\d+)?"
_RELATIVE = re.compile(rf"(?:(\d+)\s*\*?\s*)?(?:pi|π)(?:\s*/\s*(\d+))?\s*({_DECIMAL})?")


@dataclass(frozen=True)
class Frequency:
    """Ω = turns · π + offset, exactly; made by :func:`frequency`."""

    turns: Fraction
    offset: Fraction

    def ball(self) -> arb:
        """Ω, in the precision of the current context."""
        return arb(fmpq(self.turns.numerator, self.turns.denominator)) * arb.pi() + arb(
            fmpq(self.offset.numerator, self.offset.denominator)
        )

    def check(self, order: int) -> None:
        """Refuse Ω = pπ/q with q ≤ order: nothing else is a resonance, π being irrational."""
        p, q = self.turns.numerator, self.turns.denominator
        if self.offset == 0 and p and q <= order:
            raise ResonanceError(
                f"Omega = {p}π/{q} is the resonance p/q = {p}/{q}, where the expansion of order "
                f"{order} ≥ q has a pole; add an offset as in '{p}*pi/{q} + 1e-9', or ask for an "
                f"order below {q}",
                p,
                q,
            )

    def __str__(self) -> str:
        parts = [f"{self.turns}*pi"] if self.turns else []
        parts += [str(self.offset)] if self.offset or not parts else []
        return " + ".join(parts)


def frequency(omega: Any) -> Frequency:
    """Ω without any rounding.

    Parameters
    ----------
    omega
        A number (a double is the binary fraction it stands for), a decimal in a string, or a string
        'p*pi/q', 'p*pi/q + mu', 'pi - 1e-30'.

    Raises
    ------
    InputError
        None of these, or not positive.

    Examples
    --------
    >>> frequency("2*pi/3 - 1e-20")
    Frequency(turns=Fraction(2, 3), offset=Fraction(-1, 100000000000000000000))
    >>> frequency(0.5), str(frequency("0.83"))
    (Frequency(turns=Fraction(0, 1), offset=Fraction(1, 2)), '83/100')
    """
    if isinstance(omega, Frequency):
        return omega
    turns, offset = Fraction(0), rational(omega)
    relative = _RELATIVE.fullmatch(omega.strip()) if isinstance(omega, str) else None
    if relative is not None and int(relative[2] or 1):
        turns = Fraction(int(relative[1] or 1), int(relative[2] or 1))
        offset = rational(relative[3] or "0")
    if offset is None:
        raise InputError(
            f"Omega = {omega!r}; give a number, a decimal, or 'p*pi/q + mu', e.g. 'pi/2 - 1e-6'"
        )
    result = Frequency(turns, offset)
    if not result.ball() > 0:
        raise InputError(
            f"Omega = {omega!r}; the dimensionless frequency ωx₀/c must be positive and finite"
        )
    return result


def rational(value: Any) -> Fraction | None:
    """The exact value of a finite number or of a decimal or fraction in a string; else None.

    >>> rational("1e-3"), rational(0.5), rational("x")
    (Fraction(1, 1000), Fraction(1, 2), None)
    """
    try:
        if isinstance(value, str):
            value = value.replace(" ", "")
            exponent = value.lower().partition("e")[2].partition("/")[0]
            if abs(int(exponent or 0)) > _LARGEST_EXPONENT:
                return None
            above, _, below = value.partition("/")
            return Fraction(above) / Fraction(below or 1)
        number = value if isinstance(value, int | Fraction) else float(value)
        return Fraction(number)
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        return None


def outward(ball: arb) -> tuple[float, float]:
    """Doubles (lower, upper) between which the ball, hence the true value, lies.

    >>> lower, upper = outward(ArbRing().rational(1, 3))
    >>> lower < 1 / 3 < upper, (upper - lower) < 1e-15
    (True, True)
    """
    lower, upper = float(ball.lower()), float(ball.upper())
    return math.nextafter(lower, -math.inf), math.nextafter(upper, math.inf)
