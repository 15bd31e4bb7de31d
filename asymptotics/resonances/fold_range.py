r"""How far a fold's law holds: it is compared with the reduced equation's own fold.

The law of :mod:`asymptotics.resonances.folds` is the fold of the leading terms. The reduced
equation of order N = max(5, q + 2) has all terms that come next, and its fold, G = ∂G/∂b = 0, is
where a root is double. At one μ

.. math:: e(μ) = |ε_{\text{law}}/ε_{N+2} − 1| + |ε_N/ε_{N+2} − 1|

estimates the law's relative error, the second term because a reduced fold that still moves with the
order is no measure. All terms left out by the law are smaller by a factor of order μ, for every q,
so that e ∝ |μ| as μ → 0. The estimate is therefore c|μ|, with the largest e/|μ| found on a ladder
of detunings that ends where e is :data:`ACCURACY`; that is where the range ends, too.

It ends earlier where another harmonic j ≤ N + 2 resonates, jΩ = Ω_n: half way to that pole, where a
series in μ still gains a factor two a term. Low orders of the reduced equation do not see all of
these (harmonic 5 acts back on harmonic 1 at order 9 only). Higher harmonics yet can cut a branch in
narrow loops inside the range; no law here knows of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from asymptotics.expansion.reduced_equation import Array

ACCURACY = 0.1
"""The relative error in ε at which a law's range ends."""

LEAST = 1e-40
"""|μ| over Ω_p/q at which the search for a range gives up."""

# Of the search: downwards in steps of four, up again in steps of √2.
_DOWN, _UP, _CLIMBS, _RUNGS = 4.0, math.sqrt(2), 4, 4
# Where e is linear in μ, for its steepest slope if it flattens.
_FARTHER = 64
# Rounding of the spectrum, a few units in 2e-16, is a thousandth of this.
_TOLD = 1e-12
# Newton from the law converges in a few steps where the law is good to ACCURACY.
# In log x and log y; e² away it is another fold.
_STEPS, _STRIDE, _FAR = 40, 0.5, 2.0


class Resonant(Protocol):
    """What is asked of a resonance ω_p/q."""

    @property
    def p(self) -> int:
        """Of ω_p."""

    @property
    def q(self) -> int:
        """The harmonic."""

    @property
    def value(self) -> float:
        """ω_p/q."""

    def spectrum(self, count: int) -> Array:
        """The lowest free frequencies."""

    def scaled(self, mu: float, epsilon: float, amplitude: float, order: int) -> list[Array]:
        """G's orders at ω_p/q + μ as g_{n−k,k} ε^{n−k} b^k, over the largest of them."""


class Law(Protocol):
    """What is asked of a fold."""

    @property
    def resonant(self) -> Resonant:
        """Which resonance it belongs to."""

    @property
    def mu_sign(self) -> int:
        """The side of it on which it lies."""

    def epsilon(self, mu: Any) -> Array:
        """The law, nan where it has none."""

    def amplitude(self, epsilon: float) -> float:
        """The amplitude a at the double root."""


@dataclass(frozen=True)
class Range:
    """Where a fold's law holds to :data:`ACCURACY`, and how good it is there.

    Attributes
    ----------
    mu, epsilon
        The largest |μ| and the amplitude there.
    slope
        c: the relative error of ε at μ is estimated as c|μ|.
    order
        N + 2 of the reduced equation behind the estimate.
    pole
        (n, j) of the resonance Ω_n/j half way to which the range ends; None otherwise.
    lost
        Whether it ends because the reduced equation has no such fold beyond.
    """

    mu: float
    epsilon: float
    slope: float
    order: int
    pole: tuple[int, int] | None = None
    lost: bool = False

    @property
    def error(self) -> float:
        """The estimated relative error at the end, c|μ| ≤ :data:`ACCURACY`."""
        return self.slope * self.mu

    @property
    def reason(self) -> str:
        """Why it ends there."""
        if self.pole is not None:
            n, j = self.pole
            return f"it ends half way to Omega_{n}/{j}, where harmonic {j} resonates"
        if self.lost:
            return f"beyond, the reduced equation of order {self.order} has no such fold"
        return f"beyond, terms through order {self.order} move the fold by more than {ACCURACY:.0%}"


def compared_order(q: int) -> int:
    """N, the order with all terms next to the leading ones."""
    return max(5, q + 2)


def fold_range(law: Law) -> Range | None:
    """The range of a law; None when no detuning was found at which it holds.

    Raises what :meth:`asymptotics.expansion.reduced_equation.Resonance.scaled` raises.

    Examples
    --------
    >>> from asymptotics.resonances.folds import fold
    >>> found = fold(1, 1, 0.01).range
    >>> round(found.mu, 3), round(found.epsilon, 4), round(found.slope, 2)
    (0.05, 0.0012, 1.89)
    """
    bound, pole = next_pole(law)
    ladder = _ladder(law, bound)
    if not ladder:
        return None
    error = 0.0
    for _ in range(_CLIMBS):
        size = min(bound, ladder[0][0] * _UP)
        error = law_error(law, size)
        if error > ACCURACY:
            break
        ladder.insert(0, (size, error))
    ladder.append((far := ladder[-1][0] / _FARTHER, law_error(law, far)))
    slope = max(error / size for size, error in ladder)
    top = ladder[0][0]
    if not slope < math.inf:
        return None
    reach = min(top, ACCURACY / slope)
    return Range(
        reach,
        float(law.epsilon(law.mu_sign * reach)),
        slope,
        compared_order(law.resonant.q) + 2,
        pole if reach == bound else None,
        reach == top and math.isinf(error),
    )


def next_pole(law: Law) -> tuple[float, tuple[int, int] | None]:
    """Half the distance to the nearest Ω_n/j on the law's side, j ≤ N + 2, and (n, j).

    At most a quarter of Ω_p/q. Poles nearer than doubles can tell, those of Ω_{kp}/kq as β → 0, are
    left to the reduced equation, which has them for k = 2 and 3.

    >>> from asymptotics.resonances.folds import fold
    >>> bound, pole = next_pole(fold(2, 1, 0.01))
    >>> round(bound, 4), pole                  # 5Ω = Ω₆ where Ω is Ω₂ + 0.024
    (0.012, (6, 5))
    """
    resonance, order = law.resonant, compared_order(law.resonant.q) + 2
    # Ω_n grows at least like n, so that these reach beyond jΩ_p/q · 3/2 for all j.
    count = 3 * order * resonance.p // (2 * resonance.q) + 2
    spectrum = resonance.spectrum(count)
    distance = law.mu_sign * (spectrum / np.arange(1, order + 1)[:, None] - resonance.value)
    distance[distance < _TOLD * resonance.value] = math.inf
    j, n = np.unravel_index(np.argmin(distance), distance.shape)
    half = float(distance[j, n]) / 2
    if half > resonance.value / 4:
        return resonance.value / 4, None
    return half, (int(n) + 1, int(j) + 1)


def _ladder(law: Law, size: float) -> list[tuple[float, float]]:
    """(|μ|, e) of the first detunings in a row, each half the one before, with e ≤ ACCURACY."""
    found: list[tuple[float, float]] = []
    smallest = LEAST * law.resonant.value
    while len(found) < _RUNGS:
        error = law_error(law, size)
        if error <= ACCURACY:
            found.append((size, error))
            size /= 2
        else:
            found.clear()
            size /= _DOWN
        if size < smallest:
            return []
    return found


def law_error(law: Law, size: float) -> float:
    """e at |μ| = ``size``; inf where the law or one of the reduced folds does not exist."""
    resonance, mu = law.resonant, law.mu_sign * size
    epsilon = float(law.epsilon(mu))
    if not epsilon > 0:
        return math.inf
    order = compared_order(resonance.q)
    rows = resonance.scaled(mu, epsilon, law.amplitude(epsilon), order + 2)
    low, high = double_root(rows[:order]), double_root(rows)
    error = abs(1 / high - 1) + abs(low / high - 1)
    return error if math.isfinite(error) else math.inf


def double_root(rows: Sequence[Array]) -> float:
    """x of the fold of Σ g_{n−k,k} x^{n−k} y^k next to x = y = 1, by Newton; nan if there is none.

    In log x and log y, which keeps both positive.

    >>> rows = [np.array([-1.1, 1.5]), np.zeros(3), np.array([0.0, 0.0, 0.0, -0.5])]
    >>> round(double_root(rows), 6)                                          # 1/1.1
    0.909091
    """
    powers = [(n - k, k, g) for n, row in enumerate(rows, start=1) for k, g in enumerate(row) if g]
    across, along, size = (np.array(column, dtype=float) for column in zip(*powers, strict=True))
    place = np.zeros(2)
    for _ in range(_STEPS):
        terms = size * np.exp(across * place[0] + along * place[1])
        rows_of = ([across @ terms, along @ terms], [across @ (along * terms), along**2 @ terms])
        matrix = np.array(rows_of)
        if not abs(np.linalg.det(matrix)) > 0:
            return math.nan
        step = np.linalg.solve(matrix, [terms.sum(), along @ terms])
        place = place - step / max(1.0, abs(step).max() / _STRIDE)
        # At small ε the place of the double root y is as ill-conditioned as M is small; x is not.
        if abs(step[0]) < 1e-12 and abs(step[1]) < 1e-4:
            return math.exp(place[0])
        if not abs(place).max() < _FAR:
            break
    return math.nan
