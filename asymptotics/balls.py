r"""Balls as coefficients: every number is an interval that contains the true one.

The engine adds and multiplies; over :class:`flint.arb` and :class:`flint.acb` each such step
encloses the exact result, rounding included. So what :func:`asymptotics.expansion.expand` yields is
proved: the true coefficient lies in the ball. Residuals (:func:`asymptotics.proof.residuals`) are
balls that must contain zero. The precision is FLINT's,
:func:`~asymptotics.precision.at_precision`.

A frequency may be given as a double, as a decimal, or relative to a resonance, see
:class:`Frequency`; nothing is rounded on the way in.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from asymptotics.errors import InputError, ResonanceError
from asymptotics.pickling import remembering
from asymptotics.problem import Problem, driven_string, string
from asymptotics.rings import Ring


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


@remembering
def ball_string(omega: Any) -> Problem[Any]:
    """The string over real balls, for :func:`asymptotics.expansion.expand`.

    The small parameter is ε̂ = ε/sin Ω. Make it, and expand it, within
    :func:`~asymptotics.precision.at_precision`.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.precision import at_precision
    >>> with at_precision(128):
    ...     print(expand(ball_string("pi/2 + 1e-9"), 2).contact(2)[2].str(20))
    [-121118268.51374002570 +/- 3.25e-12]
    """
    exact = frequency(omega)
    ball = exact.ball()
    return string(ArbRing(), ball, lambda j: (j * ball).cot(), name=f"string at {exact} in balls")


@remembering
def ball_damped_string(
    omega: Any, damping: Any, viscosity: Any = 0, drive: Mapping[int, acb] | None = None
) -> Problem[Any]:
    """:func:`asymptotics.damped.damped_string` over complex balls; arguments as decimals are exact.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.precision import at_precision
    >>> with at_precision(128):
    ...     c = expand(ball_damped_string("pi", "1e-9"), 1).contact(1)[1]
    >>> round(2e-9 * float(c.abs_upper()), 12)        # |ξ₁| → π/(2ζ)
    1.570796326795
    """
    ring: Ring[Any] = AcbRing()
    ball, numbers = frequency(omega).ball(), []
    for name, value in (("damping", damping), ("viscosity", viscosity)):
        number = rational(value)
        if number is None or number < 0:
            raise InputError(f"{name} = {value!r}; give a finite number ≥ 0")
        numbers.append(arb(fmpq(number.numerator, number.denominator)))
    zeta, eta = numbers

    def square(j: int) -> acb:
        return inertia(j) / acb(1, eta * j * ball)

    def inertia(j: int) -> acb:
        return acb((j * ball) ** 2, -2 * zeta * j * ball)

    def k(j: int) -> acb:
        return square(j).sqrt()

    name = f"string at {omega!r}, damping {damping!r}, viscosity {viscosity!r} in balls"
    return driven_string(
        name if drive is None else f"{name} under {drive!r}",
        ring,
        stiffness=square,
        impedance=lambda j: k(j) * k(j).cot(),
        source=lambda j: k(j) * k(j).csc(),
        drive={1: ring.rational(1, 2)} if drive is None else dict(drive),
        equation_residual=lambda j, w: acb(1, eta * j * ball) * w[2] + inertia(j) * w[0],
        end_residual=lambda j, w: k(j).cos() * w[0] - k(j).sin() / k(j) * w[1],
        end_unit=lambda j: ring.one,
    )


def outward(ball: arb) -> tuple[float, float]:
    """Doubles (lower, upper) between which the ball, hence the true value, lies.

    >>> lower, upper = outward(ArbRing().rational(1, 3))
    >>> lower < 1 / 3 < upper, (upper - lower) < 1e-15
    (True, True)
    """
    lower, upper = float(ball.lower()), float(ball.upper())
    return math.nextafter(lower, -math.inf), math.nextafter(upper, math.inf)
