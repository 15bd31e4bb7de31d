r"""The singularities of a power series, estimated from its coefficients.

If the nearest one is :math:`(1 − x/x_c)^{−g}`, then successive coefficients have
:math:`c_i/c_{i−1} = x_c^{−1}(1 + (g−1)/i + O(i^{−2}))`: the ratio method (Domb & Sykes) takes x_c
and g from them. It fails where the nearest ones are a complex pair, or several. Padé approximants
of f and of f′/f (:mod:`asymptotics.values.approximants`) see several, on the axes and off them; one
counts only where both have it, and where it has settled between neighbouring approximants and
shorter series. What these differ by is its error. Whether it is a pole or a branch point is said
only where two exponents, of f and of f′, agree.

The errors are spreads, not bounds: a series of which only N coefficients are known can have any
singularity.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from asymptotics.errors import InputError
from asymptotics.rings.precision import at_precision
from asymptotics.values.approximants import (
    BITS,
    Located,
    located,
    logarithmic_derivative,
    scaled_series,
)

FEWEST = 8
"""Fewer coefficients than this say nothing about a singularity."""

AGREE = 0.25
"""Estimates must agree on a singularity to this fraction of its distance: a choice, not a bound.
The disagreement found is reported as the error."""

SETTLED = 0.1
"""An exponent counts as settled, and two of them as equal, to this: between poles and their nearest
relatives, square roots, lie ½."""


@dataclass(frozen=True)
class Singularity:
    """An estimated singularity (1 − x/x_c)^{−g} of one harmonic's series in x = ε².

    Attributes
    ----------
    harmonic
        j.
    method
        ``ratio`` or ``Padé``.
    position, error
        x_c, and the spread of its estimates: between methods, approximants and orders. Of a complex
        pair the one above the axis.
    exponent, exponent_error
        g with its spread; a pole has g = 1. Nan where it is not known.
    kind
        ``pole`` or ``branch point`` where two methods agree on g, else ``undecided``.
    residue
        r of the approximant of f, r/(x − x_c) next to the singularity; nan for ``ratio``.
    """

    harmonic: int
    method: str
    position: complex
    error: float
    exponent: float = math.nan
    exponent_error: float = math.nan
    kind: str = "undecided"
    residue: complex = complex(math.nan, math.nan)

    def as_json(self) -> dict[str, Any]:
        """Plain data; ``epsilon`` is |x_c|^{1/2}."""
        exponent = None if math.isnan(self.exponent) else [self.exponent, self.exponent_error]
        return {
            "harmonic": self.harmonic,
            "method": self.method,
            "epsilon_squared": [self.position.real, self.position.imag],
            "error": self.error,
            "epsilon": math.sqrt(abs(self.position)),
            "exponent": exponent,
            "kind": self.kind,
        }


def ratio_estimate(series: Sequence[float], harmonic: int = 0) -> Singularity:
    """x_c and g by the ratio method, with the spread over the last four estimates as errors.

    Competing singularities make the ratios wander and the errors large. Where a coefficient is zero
    there is no estimate: x_c and its error are nan.

    Raises
    ------
    InputError
        Fewer than 8 coefficients.

    Examples
    --------
    >>> geometric = [3.0 * 2.0**-i for i in range(12)]
    >>> found = ratio_estimate(geometric)
    >>> found.position, round(found.exponent, 12)
    ((2+0j), 1.0)
    """
    _check_length(series)
    tail = series[-6:]
    if 0.0 in tail:
        return Singularity(harmonic, "ratio", complex(math.nan, math.nan), math.nan)
    ratios = [b / a for a, b in pairwise(tail)]
    places, exponents = [], []
    first = len(series) - len(ratios)
    for i, (before, ratio) in enumerate(pairwise(ratios), start=first + 1):
        inverse = i * ratio - (i - 1) * before
        places.append(1 / inverse if inverse else math.inf)
        exponents.append(1 + i * (ratio / inverse - 1) if inverse else math.nan)
    return Singularity(
        harmonic,
        "ratio",
        complex(places[-1]),
        max(places) - min(places),
        exponents[-1],
        max(exponents) - min(exponents),
    )


def _check_length(series: Sequence[float]) -> None:
    if len(series) < FEWEST:
        raise InputError(
            f"{len(series)} coefficients are too few to locate a singularity; give at least "
            f"{FEWEST}, hence a higher order"
        )


def pade_estimates(series: Sequence[Any], harmonic: int = 0) -> list[Singularity]:
    """Singularities on which the Padé approximants of f and of f′/f agree, nearest first.

    The coefficients (floats, rational numbers, or balls, of which the centre counts) are taken as
    exact. The error is the distance between the two methods or, when larger, the smaller of their
    own (:class:`asymptotics.values.approximants.Located`), and |x_c| (|g − 1| + δg)/n for n
    coefficients.

    Raises
    ------
    InputError
        Fewer than 8 coefficients.

    Examples
    --------
    Two poles and an entire part:

    >>> series = [0.5**i + (-0.4) ** i + 1 / math.factorial(i) for i in range(20)]
    >>> [round(found.position.real, 6) for found in pade_estimates(series)][:2]
    [2.0, -2.5]
    """
    _check_length(series)
    with at_precision(BITS):
        values, scale = scaled_series(series)
        if not values[0]:
            return []
        poles = located(values, AGREE)
        first = located(logarithmic_derivative(values), AGREE) if poles else []
        rate = [i * c for i, c in enumerate(values)][1:]
        second = located(logarithmic_derivative(rate), AGREE) if first and rate[0] else []
    found = []
    for pole in poles:
        partner = _partner(pole, first)
        # f′/f has residue −g; a zero of f has residue 1 and is no singularity.
        if pole.position.imag < 0 or partner is None or abs(partner.residue - 1) <= SETTLED:
            continue
        one = _agreed(pole, partner, len(values), scale)
        if one.error <= AGREE * abs(one.position):
            kind = _kind(-partner.residue, partner.residue_error, _partner(pole, second))
            found.append(replace(one, harmonic=harmonic, kind=kind))
    return sorted(found, key=lambda singularity: abs(singularity.position))


def _agreed(pole: Located, partner: Located, count: int, scale: float) -> Singularity:
    """What the approximants of f and of f′/f, in x/scale, say together."""
    gap, best = abs(pole.position - partner.position), min(pole, partner, key=_error)
    exponent, spread = -partner.residue, partner.residue_error
    # A pole stands for (1 − x/x_c)^{−g} only up to |g − 1|/n of x_c, by the ratio method.
    model = abs(best.position) * (abs(exponent - 1) + spread) / count
    return Singularity(
        harmonic=0,
        method="Padé",
        position=best.position * scale,
        error=(max(gap, best.error) + model) * scale,
        exponent=exponent.real,
        exponent_error=max(spread, abs(exponent.imag)),
        residue=pole.residue * scale,
    )


def _error(found: Located) -> float:
    return found.error


def _partner(pole: Located, others: list[Located]) -> Located | None:
    """The nearest of the others, where it is within the errors."""
    nearest = min(others, key=lambda z: abs(z.position - pole.position), default=None)
    if nearest is None or abs(nearest.position - pole.position) > pole.error + nearest.error:
        return None
    return nearest


def _kind(exponent: complex, spread: float, derivative: Located | None) -> str:
    """What g from f′/f and g + 1 from f″/f′ say together."""
    if derivative is None or max(spread, derivative.residue_error) > SETTLED:
        return "undecided"
    if abs(exponent - (-derivative.residue - 1)) > SETTLED:
        return "undecided"
    return "pole" if abs(exponent - 1) <= SETTLED else "branch point"
