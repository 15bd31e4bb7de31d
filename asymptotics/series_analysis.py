r"""Where the ε-series ends: its nearest singularities, estimated from its coefficients.

ξ_c's harmonic j is a series :math:`\sum_i c_i x^i` in x = ε², times ε^j. If its nearest singularity
is :math:`(1 − x/x_c)^{−g}`, then :math:`c_i/c_{i−1} = x_c^{−1}(1 + (g−1)/i + O(i^{−2}))`: the ratio
method (Domb & Sykes) takes x_c and g from successive ratios. It fails where the nearest ones are a
complex pair, or several. Padé approximants of f and of f′/f (:mod:`asymptotics.approximants`) see
several, on the axes and off them; one counts only where both have it, and where it has settled
between neighbouring approximants and shorter series. What these differ by is its error. Whether it
is a pole or a branch point is said only where two exponents, of f and of f′, agree.

**What they find at fixed Ω.** A characteristic's mean return time times Ω is
:math:`ϱ = 2Ω + γ(Ω) ε^2 + O(ε^4)`, with γ of :func:`rotation_shift`. Harmonic j resonates not at
jΩ = pπ but at jϱ/2 = pπ, so the series has a pole near

.. math:: ε_j^2 = \frac{2 (pπ − jΩ)}{j\, γ(Ω)}

and, |pπ − jΩ| being below 1/j for infinitely many j, such poles come arbitrarily close to ε = 0, on
the real or the imaginary axis, ever weaker. Unless they all cancel, **the series at fixed Ω
diverges at every Ω** and is asymptotic only; the positions are confirmed here for the poles within
reach, the divergence is their consequence and not proved. At a fixed Diophantine ϱ, with Ω
following, no harmonic resonates and it converges: that is the Lindstedt series of the standard map
with K = 2εΩ², see :mod:`asymptotics.lindstedt`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from flint import arb

from asymptotics.approximants import Located, exact_series, located, logarithmic_derivative
from asymptotics.balls import ball_string
from asymptotics.errors import InputError
from asymptotics.expansion import Expansion, check_order, expand
from asymptotics.precision import until
from asymptotics.problem import float_string

# Fewer coefficients than this say nothing about a singularity.
_FEWEST = 8
# Estimates must agree on a singularity to this fraction of its distance: a choice, not a bound. The
# disagreement found is reported as the error.
_AGREE = 0.25
# An exponent counts as settled, and two of them as equal, to this: between poles and their nearest
# relatives, square roots, lie ½.
_SETTLED = 0.1


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
    """

    harmonic: int
    method: str
    position: complex
    error: float
    exponent: float = math.nan
    exponent_error: float = math.nan
    kind: str = "undecided"

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


def harmonic_series(expansion: Expansion[float], omega: float, j: int) -> list[float]:
    """c_i: the coefficients of ε^{j+2i} cos jΩτ in ξ_c (of ε^{2+2i} for j = 0), up to order N.

    >>> series = harmonic_series(expand(float_string(0.83, 5), 5), 0.83, 1)
    >>> len(series), round(series[0], 6)           # Ω/(2 sin Ω)
    (3, 0.562383)
    """
    small = 1 / math.sin(omega)
    orders = range(j or 2, expansion.order + 1, 2)
    return [(2 if j else 1) * small**n * expansion.contact(n).get(j, 0.0) for n in orders]


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
    if len(series) < _FEWEST:
        raise InputError(
            f"{len(series)} coefficients are too few to locate a singularity; give at least "
            f"{_FEWEST}, hence a higher order"
        )


def pade_estimates(series: Sequence[Any], harmonic: int = 0) -> list[Singularity]:
    """Singularities on which the Padé approximants of f and of f′/f agree, nearest first.

    The coefficients (floats, rational numbers, or balls, of which the centre counts) are taken as
    exact. The error is the distance between the two methods or, when larger, the smaller of their
    own (:class:`asymptotics.approximants.Located`), and |x_c| (|g − 1| + δg)/n for n coefficients.

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
    values, scale = exact_series(series)
    if not values[0]:
        return []
    rate = [i * c for i, c in enumerate(values)][1:]
    poles = located(values, _AGREE)
    first = located(logarithmic_derivative(values), _AGREE)
    second = located(logarithmic_derivative(rate), _AGREE) if rate[0] else []
    found = []
    for pole in poles:
        partner = _partner(pole, first)
        # f′/f has residue −g; a zero of f has residue 1 and is no singularity.
        if pole.position.imag < 0 or partner is None or abs(partner.residue - 1) <= _SETTLED:
            continue
        gap, best = abs(pole.position - partner.position), min(pole, partner, key=_error)
        exponent, spread = -partner.residue, partner.residue_error
        # A pole stands for (1 − x/x_c)^{−g} only up to |g − 1|/n of x_c, by the ratio method.
        model = abs(best.position) * (abs(exponent - 1) + spread) / len(values)
        error = max(gap, best.error) + model
        if error <= _AGREE * abs(best.position):
            kind = _kind(exponent, spread, _partner(pole, second))
            found.append(
                Singularity(
                    harmonic,
                    "Padé",
                    best.position / scale,
                    error / scale,
                    exponent.real,
                    max(spread, abs(exponent.imag)),
                    kind,
                )
            )
    return sorted(found, key=lambda singularity: abs(singularity.position))


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
    if derivative is None or max(spread, derivative.residue_error) > _SETTLED:
        return "undecided"
    if abs(exponent - (-derivative.residue - 1)) > _SETTLED:
        return "undecided"
    return "pole" if abs(exponent - 1) <= _SETTLED else "branch point"


def rotation_shift(omega: float) -> float:
    r"""γ with ϱ = 2Ω + γε² + O(ε⁴), the string's mean return time times Ω.

    .. math:: γ = −\frac{Ω^3}{8 \sin^2 Ω} (1 + 2Ω \cot Ω)

    From the mean height W(0) = 1 on the invariant circle φ = ψ + K sin ψ/(4 sin²Ω), K = 2εΩ².

    >>> f"{0.02**2 * rotation_shift(0.83):.3e}"
    '-1.322e-04'
    """
    return -(omega**3) / (8 * math.sin(omega) ** 2) * (1 + 2 * omega / math.tan(omega))


def resonance_pole(omega: float, j: int) -> float:
    """ε_j², where harmonic j resonates, to leading order in ε².

    >>> round(resonance_pole(0.83, 19), 6)
    0.019757
    """
    nearest = round(j * omega / math.pi) * math.pi
    return 2 * (nearest - j * omega) / (j * rotation_shift(omega))


@dataclass(frozen=True)
class SeriesAnalysis:
    """The ε-series of ξ_c at fixed Ω; made by :func:`analyse_series`.

    Attributes
    ----------
    growth
        ‖ξ_n‖^{−1/n}, n = 1 … N, ‖·‖ the largest amplitude: the root test. It would tend to the
        radius of convergence; here it falls without end.
    singularities
        Padé poles by harmonic, nearest first, and each harmonic's ratio estimate after them.
    resonances
        (j, ε_j²) of :func:`resonance_pole` with j ≤ N, nearest first.
    """

    omega: float
    order: int
    growth: tuple[float, ...]
    singularities: tuple[Singularity, ...]
    resonances: tuple[tuple[int, float], ...]

    @property
    def nearest(self) -> Singularity | None:
        """The nearest singularity on which both Padé methods agree for some harmonic.

        Its error is widened to what other harmonics have within it. None where no two estimates
        agree. Nearer ones, too weak to be seen at this order, are not excluded.
        """
        poles = [found for found in self.singularities if found.method == "Padé"]
        first = min(poles, key=lambda found: abs(found.position), default=None)
        if first is None:
            return None
        gaps = [(abs(found.position - first.position), found.error) for found in poles]
        return replace(
            first,
            error=max(max(gap, first.error) for gap, error in gaps if gap <= first.error + error),
        )

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "omega": self.omega,
            "order": self.order,
            "growth": list(self.growth),
            "nearest": None if self.nearest is None else self.nearest.as_json(),
            "singularities": [found.as_json() for found in self.singularities],
            "resonances": [list(pair) for pair in self.resonances[:10]],
        }


def _exact_harmonics(omega: float, order: int) -> dict[int, list[arb]]:
    """As :func:`harmonic_series`, in balls, of every harmonic that has enough coefficients."""

    def compute() -> dict[int, list[arb]]:
        expansion = expand(ball_string(omega), order)
        small = 1 / arb(omega).sin()
        return {
            j: [
                (2 if j else 1) * small**n * expansion.contact(n).get(j, arb(0))
                for n in range(j or 2, order + 1, 2)
            ]
            for j in range(order + 2 - 2 * _FEWEST)
        }

    def settled(rows: dict[int, list[arb]]) -> bool:
        digits = 4 * order + 53
        return all(c.rel_accuracy_bits() >= digits for row in rows.values() for c in row)

    what = f"the series at Omega = {omega!r}, order {order}"
    return until(settled, compute, what, 8 * order + 64)[0]


def analyse_series(omega: float, order: int = 60) -> SeriesAnalysis:
    """Expand the string at Ω and look for the singularities of every harmonic.

    The coefficients are computed with 4N digits in base 2 more than doubles have: Padé approximants
    lose some two digits a coefficient.

    Raises
    ------
    InputError, ResonanceError
        As :func:`~asymptotics.problem.float_string`; also where no harmonic has 8 coefficients.

    Examples
    --------
    >>> found = analyse_series(0.83, 36)
    >>> round(found.nearest.position.real, 4), round(resonance_pole(0.83, 19), 4)
    (0.0196, 0.0198)
    """
    order = check_order(order)
    if order < 2 * _FEWEST:
        raise InputError(f"order = {order} gives too few coefficients; give at least 16")
    expansion = expand(float_string(omega, order), order)
    found: list[Singularity] = []
    for j, values in _exact_harmonics(float(omega), order).items():
        series = harmonic_series(expansion, omega, j)
        found += [*pade_estimates(values, j), ratio_estimate(series, j)]
    found.sort(key=lambda s: (s.method != "Padé", abs(s.position)))
    growth = []
    for n in range(1, order + 1):
        largest = max((2 if j else 1) * abs(c) for j, c in expansion.contact(n).items())
        growth.append(abs(math.sin(omega)) * largest ** (-1 / n))
    poles = sorted(
        ((j, resonance_pole(omega, j)) for j in range(1, order + 1)), key=lambda p: abs(p[1])
    )
    return SeriesAnalysis(float(omega), order, tuple(growth), tuple(found), tuple(poles))
