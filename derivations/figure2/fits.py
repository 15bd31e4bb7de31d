r"""Local exponents of ε_c(Ω), and how far each law is from what was computed.

The centre is that of the linear spectrum, Ω_p(β)/q, and is never fitted. On each side and in each
window log ε = log C + r log |μ| is fitted by weighted least squares, the point's value being the
middle of its interval in log ε and its error half the interval's width there. If the points scatter
about the line by more than that, χ²/(n − 2) > 1, the error of r is enlarged by the root of it: then
it is no power law, and the error says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from asymptotics.errors import InputError
from derivations.figure2.data import LIMIT_OMEGAS, centres
from derivations.figure2.laws import Law
from derivations.figure2.points import Point

WINDOWS = {"near": (0.01, 0.1), "far": (0.07, 0.6)}
"""|μ| between which an exponent is fitted."""

CLOSE = 0.1
"""Relative deviation up to which a law is said to match."""

FEWEST = 3
"""Points without which no exponent is given."""


@dataclass(frozen=True)
class Curve:
    """One computed boundary: Ω, and the interval of ε at each, arrays of shape (n,)."""

    name: str
    beta: float
    omega: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @property
    def middle(self) -> np.ndarray:
        """√(lower · upper)."""
        return np.sqrt(self.lower * self.upper)

    @property
    def error(self) -> np.ndarray:
        """Half the interval's width in log ε."""
        return 0.5 * np.log(self.upper / self.lower)


@dataclass(frozen=True)
class Exponent:
    """ε ≈ coefficient · |μ|^value on one side of a resonance.

    Attributes
    ----------
    curve, resonance, side, window
        Where; ``side`` is the sign of μ, ``window`` a key of :data:`WINDOWS`.
    value, error, coefficient
        r, its standard error, and C.
    count, scatter
        Points, and χ²/(n − 2).
    """

    curve: str
    resonance: str
    side: int
    window: str
    value: float
    error: float
    coefficient: float
    count: int
    scatter: float


@dataclass(frozen=True)
class Deviation:
    """A law against a curve, on one side.

    Attributes
    ----------
    law, curve, side
        Which.
    mu, ratio
        |μ|, and computed over law at each point.
    inside
        Whether the point's interval holds the law's value.
    """

    law: Law
    curve: str
    side: int
    mu: np.ndarray
    ratio: np.ndarray
    inside: np.ndarray

    @property
    def matched(self) -> tuple[float, float] | None:
        """The longest run of neighbouring points that the law meets to :data:`CLOSE`, in |μ|."""
        good = np.abs(self.ratio - 1) <= CLOSE
        runs = _runs(good)
        if not runs:
            return None
        first, last = max(runs, key=lambda run: run[1] - run[0])
        return float(self.mu[first]), float(self.mu[last])

    @property
    def crossings(self) -> list[float]:
        """|μ| at which the computed curve crosses the law, by interpolation in the logarithms."""
        y, x = np.log(self.ratio), np.log(self.mu)
        places = np.flatnonzero(np.sign(y[1:]) * np.sign(y[:-1]) < 0)
        return [float(np.exp(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i]))) for i in places]


def _runs(good: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.r_[False, good, False].astype(int)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def curves(points: Sequence[Point]) -> list[Curve]:
    """The computed boundaries by β, largest first; for β = 0 the last circle as a second one.

    >>> rows = [{"beta": 0.0, "omega": 2.9, "lower": 1.0, "upper": 2.0, "circle": [0.5, 0.6]}]
    >>> [(curve.name, curve.lower.tolist()) for curve in curves(rows)]
    [('beta = 0', [1.0]), ('last circle', [0.5])]
    """
    result = []
    for beta in sorted({point["beta"] for point in points}, reverse=True):
        rows = sorted((p for p in points if p["beta"] == beta), key=lambda p: p["omega"])
        result.append(
            _curve(f"beta = {beta:g}", beta, rows, [(p["lower"], p["upper"]) for p in rows])
        )
        if beta == 0:
            result.append(_curve("last circle", beta, rows, [p["circle"] for p in rows]))
    return result


def _curve(name: str, beta: float, rows: list[Point], limits: list[Any]) -> Curve:
    lower, upper = np.array(limits, dtype=float).T
    return Curve(name, beta, np.array([p["omega"] for p in rows]), lower, upper)


def exponents(points: Sequence[Point]) -> list[Exponent]:
    """The exponents of all curves, resonances, sides and windows that have enough points."""
    found = []
    for curve in curves(points):
        for resonance, centre in centres(curve.beta).items():
            for side in (-1, 1):
                for window, limits in WINDOWS.items():
                    place = side * (curve.omega - centre)
                    near = (place >= limits[0]) & (place <= limits[1])
                    if near.sum() >= FEWEST:
                        fit = power(place[near], curve.middle[near], curve.error[near])
                        found.append(Exponent(curve.name, resonance, side, window, *fit))
    return found


def power(
    mu: np.ndarray, epsilon: np.ndarray, error: np.ndarray
) -> tuple[float, float, float, int, float]:
    """r, its error, C, n and χ²/(n − 2) of ε = C μ^r; errors are those of log ε.

    Raises
    ------
    InputError
        Fewer than three points, or an error that is not positive.

    Examples
    --------
    >>> mu = np.array([0.1, 0.2, 0.4])
    >>> fit = power(mu, 3 * mu**1.5, np.full(3, 0.01))
    >>> [round(value, 3) for value in fit]
    [1.5, 0.01, 3.0, 3, 0.0]
    """
    if len(mu) < FEWEST or not (np.asarray(error) > 0).all():
        raise InputError(f"{len(mu)} points: an exponent needs {FEWEST}, each with an error")
    x, y, weight = np.log(mu), np.log(epsilon), np.asarray(error, dtype=float) ** -2
    mean_x, mean_y = np.average(x, weights=weight), np.average(y, weights=weight)
    spread = np.sum(weight * (x - mean_x) ** 2)
    slope = np.sum(weight * (x - mean_x) * (y - mean_y)) / spread
    rest = y - mean_y - slope * (x - mean_x)
    scatter = float(np.sum(weight * rest**2) / (len(mu) - 2))
    deviation = math.sqrt(max(scatter, 1.0) / spread)
    return float(slope), deviation, float(np.exp(mean_y - slope * mean_x)), len(mu), scatter


def deviations(points: Sequence[Point], laws: Iterable[Law]) -> list[Deviation]:
    """Each law against each curve of its β, on each side on which it stands."""
    found = []
    for law in laws:
        for curve in curves(points):
            if curve.beta != law.beta:
                continue
            for side in law.sides:
                mu = side * (curve.omega - law.centre)
                near = (mu >= 0.01) & (mu <= 0.6)
                if not near.any():
                    continue
                order = np.argsort(mu[near])
                value = law.epsilon(curve.omega[near])
                ratio = curve.middle[near] / value
                inside = (curve.lower[near] <= value) & (value <= curve.upper[near])
                found.append(
                    Deviation(law, curve.name, side, mu[near][order], ratio[order], inside[order])
                )
    return found


def approach(points: Sequence[Point]) -> list[dict[str, Any]]:
    """ε_c(β)/ε_c(0) at the Ω where β → 0 was followed, from the base settings of each."""
    found = []
    for omega in LIMIT_OMEGAS:
        rows = sorted((p for p in points if p["omega"] == omega), key=lambda p: -p["beta"])
        if not rows or rows[-1]["beta"] > 0:
            continue
        base = base_middle(rows[-1])
        found += [
            {
                "omega": omega,
                "beta": row["beta"],
                "lower": row["lower"],
                "upper": row["upper"],
                "middle": base_middle(row),
                "ratio": base_middle(row) / base,
            }
            for row in rows
        ]
    return found


def base_middle(point: Point) -> float:
    """The middle of the bracket with the base settings."""
    row = point["brackets"][0]
    return math.sqrt(row["lower"] * row["upper"])
