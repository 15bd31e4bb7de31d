r"""When a leading singular profile touches the ground: one minimisation, certified.

Close to pπ/q the profile is s² + Σ 2d_j cos jθ (s − sin(jΩ₀s)/(jΩ₀)), eq. (expandw2), its harmonics
j = kq. In x = qθ and y = −qΩ₀s = −pπs > 0, and with d_j = a_k g/(pπ), it is (pπ)^{−2} times

.. math:: y^2 \bigl[1 - g R(x, y)\bigr], \qquad
          R = 2 \sum_k a_k k \cos kx \, ψ(ky), \quad ψ(z) = \frac{z - \sin z}{z^2},

so it first touches the ground at g = 1/max R, at the place and time of that maximum. Because
ψ(z) = ∫₀¹ (1 − u) sin zu du, |ψ| ≤ 1/2, |ψ′| ≤ 1/6 and |ψ″| ≤ 1/12 for every z: Taylor's formula
bounds R above on any cell of the (x, y) plane, and cells whose bound is below a value already found
are discarded. What is left encloses the global maximum.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from asymptotics.errors import InputError
from asymptotics.expansion.solutions import sine_defect, versine

Array = npt.NDArray[np.float64]
EPS = 2.0**-52

# Cells are discarded down to this relative gap between the bound and the value found. At a smooth
# maximum it leaves cells of a relative size of its root: small enough for Newton's iteration.
GAP = 1e-7
_MOST_CELLS = 400_000


@dataclass(frozen=True)
class Grazing:
    """The first touch of a profile y² [1 − g R(x, y)].

    Attributes
    ----------
    amplitude
        g = 1/max R.
    x, y
        Where it touches: x in [0, π], the earliest if there are several, and y > 0.
    gap
        Certified: no g below (1 − gap)·amplitude touches anywhere, at any time.
    height
        Largest y² [1 − g R] between the touching point and the contact point, at that time: the
        pinched-off bump.
    """

    amplitude: float
    x: float
    y: float
    gap: float
    height: float


def graze(harmonics: Mapping[int, float]) -> Grazing:
    """First touch for the coefficients ``{k: a_k}`` of cos kx, k ≥ 1.

    Raises
    ------
    InputError
        No non-zero finite coefficient, or an index below 1.

    Examples
    --------
    Eq. (expandw2): both harmonics equal; the paper's 1.13 is y.

    >>> touch = graze({1: 1.0, 3: 1.0})
    >>> touch.x, round(touch.y, 5), round(touch.height, 4)
    (0.0, 1.12919, 0.0849)
    """
    profile = _Profile(harmonics)
    best, bound, cells = _search(profile)
    x, y = _polish(profile, cells[0], cells[1])
    value = float(profile.value(np.array(x), np.array(y)))
    best = max(best, value)
    return Grazing(
        amplitude=1 / best,
        x=x,
        y=y,
        gap=max(bound / best - 1, 0.0),
        height=_height(profile, x, y, value),
    )


class _Profile:
    """R, its gradient, and bounds on its second derivatives."""

    def __init__(self, harmonics: Mapping[int, float]) -> None:
        if any(k < 1 for k in harmonics) or not all(map(math.isfinite, harmonics.values())):
            raise InputError(f"harmonics = {dict(harmonics)!r}; give finite a_k for k ≥ 1")
        scale = max((abs(a) for a in harmonics.values()), default=0.0)
        if scale == 0.0:
            raise InputError("no harmonic is non-zero: the profile s² never touches the ground")
        self.k = np.array(sorted(harmonics), float)
        self.weight = 2 * self.k * np.array([harmonics[int(k)] for k in self.k])
        size = np.abs(self.weight) @ self.k**2
        self.xx, self.xy, self.yy = size / 2, size / 6, size / 12

    def value(self, x: Array, y: Array) -> Array:
        angles = np.multiply.outer(x, self.k)
        return (np.cos(angles) * _psi(np.multiply.outer(y, self.k))) @ self.weight

    def gradient(self, x: Array, y: Array) -> tuple[Array, Array]:
        angles, z = np.multiply.outer(x, self.k), np.multiply.outer(y, self.k)
        rate = self.weight * self.k
        return -(np.sin(angles) * _psi(z)) @ rate, (np.cos(angles) * _psi_slope(z)) @ rate

    def reach(self, value: float) -> float:
        """y beyond which R < value: z ψ(z) ≤ 1 + 1/z ≤ 5/4 where z = ky ≥ 4."""
        return max(4.0, 1.25 * float((np.abs(self.weight) / self.k).sum()) / value)

    def bound(self, x: Array, y: Array, dx: float, dy: float) -> tuple[Array, Array]:
        """R at the centres of cells of half sizes dx, dy, and an upper bound on each cell."""
        value = self.value(x, y)
        along_x, along_y = self.gradient(x, y)
        bound = value + np.abs(along_x) * dx + np.abs(along_y) * dy
        return value, bound + 0.5 * (self.xx * dx * dx + 2 * self.xy * dx * dy + self.yy * dy * dy)


def _psi(z: Array) -> Array:
    """(z − sin z)/z², and z/6 where it is that to rounding."""
    small = np.abs(z) < 1e-8
    safe = np.where(small, 1.0, z)
    return np.where(small, z / 6, sine_defect(safe) / (safe * safe))


def _psi_slope(z: Array) -> Array:
    """ψ′ = (1 − cos z)/z² − 2ψ/z, and 1/6 where it is that to rounding."""
    small = np.abs(z) < 1e-8
    safe = np.where(small, 1.0, z)
    return np.where(small, 1 / 6, versine(safe) / (safe * safe) - 2 * _psi(safe) / safe)


def _search(profile: _Profile) -> tuple[float, float, tuple[float, float]]:
    """(largest value found, upper bound on R anywhere, the cell to refine) by branch and bound."""
    period = math.pi
    start = np.multiply.outer(np.linspace(0, period, 65), np.ones(256)).ravel()
    heights = np.multiply.outer(np.ones(65), np.linspace(0, 4, 257)[1:]).ravel()
    best = float(profile.value(start, heights).max())
    reach = profile.reach(best)
    # Cells short against the highest harmonic's wavelength: there Taylor's formula is sharp.
    columns = int(4 * profile.k[-1]) + 1
    rows = int(4 * profile.k[-1] * reach / math.pi) + 1
    dx, dy = period / columns / 2, reach / rows / 2
    x = np.repeat((2 * np.arange(columns) + 1) * dx, rows)
    y = np.tile((2 * np.arange(rows) + 1) * dy, columns)
    while True:
        value, bound = profile.bound(x, y, dx, dy)
        best = max(best, float(value.max()))
        keep = bound >= best
        x, y, value, bound = x[keep], y[keep], value[keep], bound[keep]
        top = float(bound.max())
        if top <= best * (1 + GAP) or 4 * len(x) > _MOST_CELLS:
            # Of equal maxima the earliest: equal to the size of a cell's own bound.
            near = value >= best - (top - best)
            first = np.lexsort((-value[near], np.round(x[near] / (4 * dx))))[0]
            return best, top, (float(x[near][first]), float(y[near][first]))
        dx, dy = dx / 2, dy / 2
        x = np.concatenate([x - dx, x - dx, x + dx, x + dx])
        y = np.concatenate([y - dy, y + dy, y - dy, y + dy])


def _polish(profile: _Profile, x: float, y: float) -> tuple[float, float]:
    """Newton's iteration for ∇R = 0; x at 0 or π, where R is even, stays there."""
    near = min((0.0, math.pi), key=lambda end: abs(x - end))
    if abs(x - near) < 1e-2 and _is_even_maximum(profile, near, y):
        x = near
    for _ in range(50):
        step = EPS ** (1 / 3)
        gx, gy = (float(g) for g in profile.gradient(np.array(x), np.array(y)))
        jacobian = np.empty((2, 2))
        for column, (sx, sy) in enumerate(((step, 0.0), (0.0, step))):
            above = profile.gradient(np.array(x + sx), np.array(y + sy))
            below = profile.gradient(np.array(x - sx), np.array(y - sy))
            jacobian[:, column] = [
                float(a - b) / (2 * step) for a, b in zip(above, below, strict=True)
            ]
        if x == near:
            change = np.array([0.0, gy / jacobian[1, 1]])
        else:
            change = np.linalg.solve(jacobian, np.array([gx, gy]))
        x, y = x - float(change[0]), y - float(change[1])
        if np.abs(change).max() <= 8 * EPS * (1 + y):
            break
    return x, y


def _is_even_maximum(profile: _Profile, x: float, y: float) -> bool:
    """Whether R curves down in x at a point where it is even in x."""
    k = profile.k
    return float((np.cos(k * x) * _psi(k * y) * k * k) @ profile.weight) > 0


def _height(profile: _Profile, x: float, y: float, value: float) -> float:
    """max over 0 < t < y of t² [1 − R(x, t)/R(x, y)], by repeated refinement of a grid."""
    low, high, best = 0.0, y, 0.0
    # A maximum is flat: root EPS in place is EPS in value.
    while high - low > math.sqrt(EPS) * y:
        t = np.linspace(low, high, 129)
        bump = t * t * (1 - profile.value(np.full_like(t, x), t) / value)
        i = int(bump.argmax())
        best = max(best, float(bump[i]))
        low, high = float(t[max(i - 1, 0)]), float(t[min(i + 1, 128)])
    return best
