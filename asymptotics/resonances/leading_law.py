r"""The detuning of a fold as a sum of two powers of ε, and the ε of a detuning.

The amplitude equation :math:`(qμ − γε^2)\, a = F ε^{n_0} + α a^3` has its double root where
:math:`qμ = κ ε^{2n_0/3} + γ ε^2`, κ = (27αF²/4)^{1/3}. For n₀ = 1 the γ is of higher order and is
left out. In x = ε^{2/3} these are powers n₀ and 3.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Terms = list[tuple[float, int]]

_BISECTIONS = 60  # of an interval of order one, to rounding


def cubic(F: float, alpha: float) -> float:
    """κ.

    >>> round(cubic(-2.0, 1.0), 9)
    3.0
    """
    return float(np.cbrt(27 * alpha / 4) * np.cbrt(F) ** 2)


def law_terms(excited: int, kappa: float, gamma: float | None) -> Terms:
    """qμ on the fold as Σ c x^m, x = ε^{2/3}, lowest power first.

    >>> law_terms(2, -3.0, 0.9), law_terms(1, -3.0, 0.9)
    ([(-3.0, 2), (0.9, 3)], [(-3.0, 1)])
    """
    if excited == 1 or gamma is None:
        return [(kappa, excited)]
    if excited == 3:
        return [(kappa + gamma, 3)]
    return sorted([(kappa, excited), (gamma, 3)], key=lambda term: term[1])


def detuning_at(terms: Terms, epsilon: npt.ArrayLike) -> Array:
    """qμ at ε ≥ 0."""
    x = np.asarray(epsilon, dtype=float) ** (2 / 3)
    return np.asarray(sum(c * x**m for c, m in terms))


def epsilon_at(terms: Terms, detuning: npt.ArrayLike) -> Array:
    """ε on the fold at qμ, from ε = 0 up to where qμ turns round, or ε = 1; else nan.

    >>> epsilon_at([(-3.0, 2), (0.9, 3)], [-1e-4, 1e-4]).round(6)
    array([0.000439,      nan])
    """
    (first, low), *rest = terms
    size = np.asarray(detuning, dtype=float) / first
    size = np.where(size > 0, size, math.nan)
    alone = size ** (1 / low)
    if not rest:
        return np.where(alone <= 1, alone, math.nan) ** 1.5
    [(second, high)] = rest
    ratio, extra = second / first, high - low
    # x^low (1 + ratio x^extra) = size; increasing up to ``turn``, where the bracket is
    # 1 − low/high. Bisection for x/alone, which lies between its values at the ends.
    turn = (low / (high * -ratio)) ** (1 / extra) if ratio < 0 else math.inf
    end = min(1.0, turn)
    left, right = sorted((1.0, (1 + ratio * end**extra) ** (-1 / low)))
    below, above = np.full(size.shape, left), np.full(size.shape, right)
    for _ in range(_BISECTIONS):
        middle = (below + above) / 2
        beyond = middle**low * (1 + ratio * (alone * middle) ** extra) > 1
        below, above = np.where(beyond, below, middle), np.where(beyond, middle, above)
    inside = size <= end**low * (1 + ratio * end**extra)
    return np.where(inside, alone * above, math.nan) ** 1.5
