r"""Rational approximants of a power series: its poles and, by f′/f, its exponents.

Where f has (1 − x/x_c)^{−g}, f′/f has a simple pole with residue −g: so Padé approximants of f show
poles, those of f′/f (*D log Padé*) also branch points, with their exponents. The coefficients are
taken as exact, and both are solved over balls, with so many bits that what is lost on the way does
not count. Coefficients that are rounded make poles of their own, which is why they should come with
many more digits than the result is to have.

Everything here is computed in the precision of the moment; :data:`BITS` is enough.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, acb_poly, arb, arb_mat, arb_poly, fmpq

BITS = 1024
"""Solving for n/2 coefficients costs some 3n bits: enough for every order within reach."""

# A denominator has to be known to so many bits, and its roots to more than doubles have.
_KNOWN = 128
_ROOTS = 1e-24


@dataclass(frozen=True)
class Located:
    """A pole on which neighbouring approximants agree.

    Attributes
    ----------
    position, error
        Where it is in the largest approximant. The error is the distance to the neighbouring
        approximant or, when larger, three times that to the one from three quarters of the series:
        what is left where the position moves like 1/n with the number n of coefficients.
    residue, residue_error
        Its residue, likewise.
    """

    position: complex
    error: float
    residue: complex
    residue_error: float


def scaled_series(series: Sequence[Any]) -> tuple[list[arb], float]:
    """The coefficients of f(x·scale) and the scale, a power of 2 that makes them of one size.

    Floats, whole numbers, rational numbers and balls, of which the centre counts.
    """
    values = [_ball(value) for value in series]
    first, last = next((abs(x) for x in values if x), arb(1)), abs(values[-1])
    power = 0
    if last and len(values) > 1:
        power = round(float((first / last).log() / arb(2).log()) / (len(values) - 1))
    return [x * arb(2) ** (power * i) for i, x in enumerate(values)], 2.0**power


def _ball(value: Any) -> arb:
    if isinstance(value, arb):
        return value.mid()
    return arb(value if isinstance(value, fmpq) else fmpq(*Fraction(value).as_integer_ratio()))


def pade(series: Sequence[arb], top: int, bottom: int) -> list[tuple[complex, complex]]:
    """(pole, residue) of the [top/bottom] approximant, nearest first; empty where there is none.

    >>> [(p, r)] = pade([arb(1), arb(0.5), arb(0.25)], 0, 1)     # 2/(2 − x)
    >>> p, r
    ((2+0j), (-2+0j))
    """

    def entry(i: int) -> arb:
        return series[i] if i >= 0 else arb(0)

    indices = range(1, bottom + 1)
    matrix = arb_mat(bottom, bottom, [entry(top + i - k) for i in indices for k in indices])
    try:
        q = matrix.solve(arb_mat(bottom, 1, [-entry(top + i) for i in indices]))
    except ZeroDivisionError:
        return []
    solved = [arb(1)] + [q[i, 0] for i in range(bottom)]
    largest = max(abs(x).mid() for x in solved)
    if any(x.rad() * arb(2) ** _KNOWN > largest for x in solved):
        return []
    below = [x.mid() for x in solved]
    while below and not below[-1]:
        below.pop()
    above = [
        sum((below[k] * entry(i - k) for k in range(min(i, len(below) - 1) + 1)), arb(0)).mid()
        for i in range(top + 1)
    ]
    numerator, denominator = acb_poly(arb_poly(above)), acb_poly(arb_poly(below))
    try:
        poles: list[acb] = denominator.roots(tol=_ROOTS)
    except ValueError:
        return []
    slope = denominator.derivative()
    found = []
    for ball in poles:
        # An isolated root whose ball meets the axis is real: else its conjugate were in it too.
        pole = acb(ball.real) if ball.imag.contains(0) else ball
        found.append((complex(pole), complex(numerator(pole) / slope(pole))))
    return sorted(found, key=lambda pair: abs(pair[0]))


def logarithmic_derivative(series: Sequence[arb]) -> list[arb]:
    """The coefficients of f′/f; f(0) ≠ 0.

    >>> [float(c) for c in logarithmic_derivative([arb(1)] * 4)]       # of 1/(1 − x): the same
    [1.0, 1.0, 1.0]
    """
    quotient: list[arb] = []
    for i in range(len(series) - 1):
        known = sum((quotient[k] * series[i - k] for k in range(i)), arb(0))
        quotient.append(((i + 1) * series[i + 1] - known) / series[0])
    return [x.mid() for x in quotient]


def located(series: Sequence[arb], agree: float) -> list[Located]:
    """The poles whose error is below ``agree`` of their distance, nearest first."""
    n = len(series)
    half, short = n // 2, max(4, 3 * n // 4)
    largest = pade(series, half - 1, half)
    neighbour = pade(series, n - half, half - 1)
    shorter = pade(series[:short], short // 2 - 1, short // 2)
    found = []
    for pole, residue in largest:
        near, near_residue = _nearest(pole, neighbour)
        far, far_residue = _nearest(pole, shorter)
        error = max(abs(near - pole), 3 * abs(far - pole))
        if error <= agree * abs(pole):
            spread = max(abs(near_residue - residue), 3 * abs(far_residue - residue))
            found.append(Located(pole, error, residue, spread))
    return found


def _nearest(pole: complex, others: list[tuple[complex, complex]]) -> tuple[complex, complex]:
    return min(others, key=lambda pair: abs(pair[0] - pole), default=(cmath.inf, cmath.inf))
