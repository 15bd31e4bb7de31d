r"""Where the ε-series of the string ends: the nearest singularities of its harmonics.

ξ_c's harmonic j is a series :math:`\sum_i c_i x^i` in x = ε², times ε^j. What it tells of its
singularities is estimated in :mod:`asymptotics.values.singularities`.

**What they find at fixed Ω.** A characteristic's mean return time times Ω is
:math:`ϱ = 2Ω + γ(Ω) ε^2 + O(ε^4)`, with γ of :func:`rotation_shift`. Harmonic j resonates not at
jΩ = pπ but at jϱ/2 = pπ, so the series has a pole near

.. math:: ε_j^2 = \frac{2 (pπ − jΩ)}{j\, γ(Ω)}

and, |pπ − jΩ| being below 1/j for infinitely many j, such poles come arbitrarily close to ε = 0, on
the real or the imaginary axis, ever weaker. Unless they all cancel, **the series at fixed Ω
diverges at every Ω** and is asymptotic only; the positions are confirmed here for the poles within
reach, the divergence is their consequence and not proved. At a fixed Diophantine ϱ, with Ω
following, no harmonic resonates and it converges: that is the Lindstedt series of the standard map
with K = 2εΩ², see :mod:`asymptotics.values.lindstedt`.

**A pole only from afar.** Resonant harmonic q acts on itself from order 3q on, and the pole gives
way to branch points within one :func:`island_width` of it. Lower orders do not know of them, and n
coefficients beyond that order do not resolve what is nearer than |x_c|/n: so much is added to every
error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import arb

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.expansion.rounded import RoundedExpansion
from asymptotics.problems.string import float_string
from asymptotics.rings.precision import at_precision
from asymptotics.values.singularities import (
    AGREE,
    FEWEST,
    SETTLED,
    Singularity,
    pade_estimates,
    ratio_estimate,
)


def harmonic_series(expansion: Expansion[float], omega: float, j: int) -> list[float]:
    """c_i: the coefficients of ε^{j+2i} cos jΩτ in ξ_c (of ε^{2+2i} for j = 0), up to order N.

    >>> series = harmonic_series(expand(float_string(0.83, 5), 5), 0.83, 1)
    >>> len(series), round(series[0], 6)           # Ω/(2 sin Ω)
    (3, 0.562383)
    """
    return _series(expansion, 1 / math.sin(omega), expansion.order, j)


def _series(expansion: Expansion[Any], small: Any, order: int, j: int) -> list[Any]:
    """The same for ε̂ = ``small`` · ε."""
    orders = range(j or 2, order + 1, 2)
    return [(2 if j else 1) * small**n * expansion.contact(n).get(j, 0 * small) for n in orders]


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


def island_width(omega: float, strength: float) -> float:
    r"""How far from its pole at x_c, in x = ε², a resonance bends the series.

    Next to the pole the return map of ψ = qΩτ is a pendulum: ψ gains 2qΩh, and h, by which ξ_c is
    off the resonance, loses F sin ψ. To first order h = h₀ + A cos ψ, A = F/(2qΩh₀), which has the
    pole: h₀ = γ(x − x_c)/(2Ω). Its islands reach to |h| = √(2F/qΩ) = 2√(A h₀), that is

    .. math:: |x − x_c| = 2 \sqrt{2Ω S/|γ|}, \qquad S = |x_c|^{q/2} |r|

    where harmonic q, a series in x times ε^q, has the residue r. There circulation ends, and with
    it the tori on which the series expands. Branch points are found nearer to the pole, at 0.4 of
    it where that is known (4Ω near π, 5Ω near 4π).

    >>> round(island_width(0.83, 1e-6), 5)
    0.00448
    """
    return 2 * math.sqrt(2 * omega * strength / abs(rotation_shift(omega)))


def _with_islands(found: Sequence[Singularity], omega: float, order: int) -> list[Singularity]:
    """Padé estimates with what is unresolved of the islands in their errors.

    q is the harmonic that is largest at the singularity, among those in which it was found.
    """
    out = []
    for one in found:
        distance = abs(one.position)
        strength, q = max(
            (distance ** (other.harmonic / 2) * abs(other.residue), other.harmonic)
            for other in found
            if abs(other.position - one.position) <= one.error + other.error
        )
        width = island_width(omega, strength)
        if order > 3 * q:
            width = min(width, 2 * distance / (order - 3 * q))
        error = one.error + width
        if error <= AGREE * distance:
            # n coefficients tell a pole of a width w from a point only by n w/|x_c|.
            spread = one.exponent_error + (order - one.harmonic) / 2 * width / distance
            kind = one.kind if spread <= SETTLED else "undecided"
            out.append(replace(one, error=error, exponent_error=spread, kind=kind))
    return out


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

        The best of those harmonics that may have the same one, its error widened to cover what
        others say that are nearly as good, within twice its error. None where no two estimates
        agree. Nearer ones, too weak to be seen at this order, are not excluded.
        """
        poles = [found for found in self.singularities if found.method == "Padé"]
        first = min(poles, key=lambda found: abs(found.position), default=None)
        if first is None:
            return None
        same = [f for f in poles if abs(f.position - first.position) <= f.error + first.error]
        best = min(same, key=lambda found: found.error)
        gaps = [abs(f.position - best.position) for f in same if f.error <= 2 * best.error]
        return replace(best, error=max(best.error, *gaps))

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
    """Expand the string at Ω and look for the singularities of every harmonic.

    The approximants are made of the balls behind
    :func:`~asymptotics.problems.string.float_string`, of 64 + 4N bits or more: the rounding of
    doubles makes poles of its own.

    Raises
    ------
    InputError, ResonanceError
        As :func:`~asymptotics.problems.string.float_string`; also where no harmonic has 8
        coefficients.

    Examples
    --------
    >>> found = analyse_series(0.83, 36)
    >>> round(found.nearest.position.real, 4), round(resonance_pole(0.83, 19), 4)
    (0.0196, 0.0198)
    """
    order = check_order(order)
    if order < 2 * FEWEST:
        raise InputError(f"order = {order} gives too few coefficients; give at least 16")
    expansion = expand(float_string(omega, order), order)
    found: list[Singularity] = []
    ratios: list[Singularity] = []
    for j, values in enumerate(_ball_series(expansion, omega)):
        found += pade_estimates(values, j)
        ratios.append(ratio_estimate([float(value) for value in values], j))
    found = _with_islands(found, omega, order) + ratios
    found.sort(key=lambda s: (s.method != "Padé", abs(s.position)))
    growth = []
    for n in range(1, order + 1):
        largest = max((2 if j else 1) * abs(c) for j, c in expansion.contact(n).items())
        growth.append(abs(math.sin(omega)) * largest ** (-1 / n))
    poles = sorted(
        ((j, resonance_pole(omega, j)) for j in range(1, order + 1)), key=lambda p: abs(p[1])
    )
    return SeriesAnalysis(float(omega), order, tuple(growth), tuple(found), tuple(poles))


def _ball_series(expansion: Expansion[float], omega: float) -> list[list[arb]]:
    """As :func:`harmonic_series`, in balls, of every harmonic that has enough coefficients."""
    assert isinstance(expansion, RoundedExpansion)
    with at_precision(expansion.bits):
        small, order = 1 / arb(float(omega)).sin(), expansion.order
        return [_series(expansion.balls, small, order, j) for j in range(order + 2 - 2 * FEWEST)]
