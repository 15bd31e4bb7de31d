r"""Rational approximants of a power series: its poles and, by f′/f, its exponents.

Where f has (1 − x/x_c)^{−g}, f′/f has a simple pole with residue −g: so Padé approximants of f show
poles, those of f′/f (*D log Padé*) also branch points, with their exponents. Both are solved
exactly for the coefficients given; coefficients that are rounded make poles of their own, which is
why they should come with many more digits than the result is to have.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, fmpq, fmpq_mat, fmpq_poly, fmpz, fmpz_poly

# Denominators, before their roots are isolated, and quotients are rounded to so many bits.
_BITS = 512


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


def exact_series(series: Sequence[Any]) -> tuple[list[fmpq], float]:
    """The coefficients of f(x/scale) as they stand, exactly, and the scale: all are of one size.

    Floats, whole numbers, rational numbers and balls, of which the centre counts.
    """
    values = [_exact(value) for value in series]
    first, last = next((abs(x) for x in values if x), fmpq(1)), abs(values[-1])
    power = 0
    if last and len(values) > 1:
        power = round(float((arb(last) / arb(first)).log() / arb(2).log()) / (len(values) - 1))
    scale = fmpq(2) ** power
    return [x / scale**i for i, x in enumerate(values)], 2.0**power


def _exact(value: Any) -> fmpq:
    if isinstance(value, fmpq):
        return value
    if isinstance(value, arb):
        mantissa, exponent = value.mid().man_exp()
        return fmpq(mantissa) * fmpq(2) ** int(exponent)
    return fmpq(*Fraction(value).as_integer_ratio())


def pade(series: Sequence[fmpq], top: int, bottom: int) -> list[tuple[complex, complex]]:
    """(pole, residue) of the [top/bottom] approximant, nearest first; empty where there is none.

    >>> [(p, r)] = pade([fmpq(1), fmpq(1, 2), fmpq(1, 4)], 0, 1)     # 2/(2 − x)
    >>> p, r.real
    ((2+0j), -2.0)
    """

    def entry(i: int) -> fmpq:
        return series[i] if i >= 0 else fmpq(0)

    indices = range(1, bottom + 1)
    matrix = fmpq_mat(bottom, bottom, [entry(top + i - k) for i in indices for k in indices])
    try:
        q = matrix.solve(fmpq_mat(bottom, 1, [-entry(top + i) for i in indices]))
    except ZeroDivisionError:
        return []
    below = [fmpq(1)] + [q[i, 0] for i in range(bottom)]
    above = [
        sum((below[k] * entry(i - k) for k in range(min(i, bottom) + 1)), fmpq(0))
        for i in range(top + 1)
    ]
    numerator, denominator = fmpq_poly(above), fmpq_poly(below)
    rounded = fmpz_poly([_rounded(x, max(below, key=abs)) for x in below])
    slope = denominator.derivative()
    roots: Any = rounded.complex_roots()
    poles = [complex(root) for root, multiplicity in roots if multiplicity == 1]
    found = [(pole, _value(numerator, pole) / _value(slope, pole)) for pole in poles]
    return sorted(found, key=lambda pair: abs(pair[0]))


def _rounded(x: fmpq, largest: fmpq) -> fmpz:
    scaled = x / abs(largest) * fmpq(2) ** _BITS
    return scaled.floor()


def _value(poly: fmpq_poly, z: complex) -> complex:
    total = 0j
    for i in range(poly.degree(), -1, -1):
        total = total * z + float(arb(poly[i]))
    return total


def logarithmic_derivative(series: Sequence[fmpq]) -> list[fmpq]:
    """The coefficients of f′/f, to 512 bits; f(0) ≠ 0.

    >>> logarithmic_derivative([fmpq(1), fmpq(1), fmpq(1), fmpq(1)])       # of 1/(1 − x): the same
    [1, 1, 1]
    """
    quotient: list[fmpq] = []
    for i in range(len(series) - 1):
        known = sum((quotient[k] * series[i - k] for k in range(i)), fmpq(0))
        quotient.append(_shortened(((i + 1) * series[i + 1] - known) / series[0]))
    return quotient


def _shortened(x: fmpq) -> fmpq:
    """x to 512 bits: the denominators of a quotient would grow without end."""
    bits = _BITS + int(x.q).bit_length() - int(x.p).bit_length()
    return fmpq((x * fmpq(2) ** bits).floor()) / fmpq(2) ** bits if x else x


def located(series: Sequence[fmpq], agree: float) -> list[Located]:
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
