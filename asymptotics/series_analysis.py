r"""Where the ε-series ends: its nearest singularities, estimated from its coefficients.

ξ_c's harmonic j is a series :math:`\sum_i c_i x^i` in x = ε², times ε^j. If its nearest singularity
is :math:`(1 − x/x_c)^{−g}`, then :math:`c_i/c_{i−1} = x_c^{−1}(1 + (g−1)/i + O(i^{−2}))`: the ratio
method (Domb & Sykes) takes x_c and g from successive ratios. Padé approximants, solved exactly for
the doubles given, see several poles at once; one counts only if three neighbouring approximants
agree on it, for rounding makes others that do not.

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

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly

from asymptotics.errors import InputError
from asymptotics.expansion import Expansion, check_order, expand
from asymptotics.problem import float_string

# Fewer coefficients than this say nothing about a singularity.
_FEWEST = 8
# Neighbouring Padé approximants must agree on a pole to this fraction of its distance: a choice,
# not a bound. The disagreement found is reported as the error.
_AGREE = 0.02


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
        x_c, and the spread of its last estimates.
    exponent, exponent_error
        g with its spread; a pole has g = 1. Nan for ``Padé``, which is given poles only.
    """

    harmonic: int
    method: str
    position: complex
    error: float
    exponent: float = math.nan
    exponent_error: float = math.nan

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


def pade_poles(series: Sequence[float], top: int, bottom: int) -> list[complex]:
    """The poles of the [top/bottom] Padé approximant, nearest first; exact for the given doubles.

    Empty where the approximant does not exist.

    >>> pade_poles([1.0, 0.5, 0.25, 0.125], 0, 1)
    [(2+0j)]
    """
    # Scaled to coefficients of one size, the roots found are of size one.
    scale = abs(series[-1] / series[0]) ** (1 / (len(series) - 1)) if series[0] else 1.0
    scale = scale or 1.0
    c = [
        fmpq(*Fraction(value / scale**i).as_integer_ratio()) if value else fmpq(0)
        for i, value in enumerate(series)
    ]

    def entry(i: int) -> fmpq:
        return c[i] if i >= 0 else fmpq(0)

    indices = range(1, bottom + 1)
    matrix = fmpq_mat(bottom, bottom, [entry(top + i - k) for i in indices for k in indices])
    try:
        q = matrix.solve(fmpq_mat(bottom, 1, [-entry(top + i) for i in indices]))
    except ZeroDivisionError:
        return []
    denominator = fmpq_poly([fmpq(1)] + [q[i, 0] for i in range(bottom)])
    roots: Any = denominator.numer().complex_roots()
    return sorted((complex(root) / scale for root, _ in roots), key=abs)


def pade_estimates(series: Sequence[float], harmonic: int = 0) -> list[Singularity]:
    """Poles on which three neighbouring Padé approximants agree, nearest first.

    The error is the largest distance between the three.

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
    half = (len(series) - 1) // 2
    shapes = ((half, half), (half - 1, half), (half - 1, half - 1))
    first, *others = (pade_poles(series, top, bottom) for top, bottom in shapes)
    found = []
    for pole in first:
        partners = [min(poles, key=lambda z: abs(z - pole), default=cmath.inf) for poles in others]
        error = max(abs(partner - pole) for partner in partners)
        if error <= _AGREE * abs(pole):
            found.append(Singularity(harmonic, "Padé", pole, error))
    return found


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
        """The nearest singularity on which the Padé approximants of some harmonic agree."""
        poles = [found for found in self.singularities if found.method == "Padé"]
        return min(poles, key=lambda found: abs(found.position), default=None)

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


def analyse_series(omega: float, order: int = 60) -> SeriesAnalysis:
    """Expand the string at Ω over doubles and look for the singularities of every harmonic.

    The amplitudes lose about four digits by order 60 (the tests measure them against balls), far
    less than what Padé approximants of that many terms need.

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
    for j in range(order + 2 - 2 * _FEWEST):
        series = harmonic_series(expansion, omega, j)
        if any(series):
            found += [*pade_estimates(series, j), ratio_estimate(series, j)]
    found.sort(key=lambda s: (s.method != "Padé", abs(s.position)))
    growth = []
    for n in range(1, order + 1):
        largest = max((2 if j else 1) * abs(c) for j, c in expansion.contact(n).items())
        growth.append(abs(math.sin(omega)) * largest ** (-1 / n))
    poles = sorted(
        ((j, resonance_pole(omega, j)) for j in range(1, order + 1)), key=lambda p: abs(p[1])
    )
    return SeriesAnalysis(float(omega), order, tuple(growth), tuple(found), tuple(poles))
