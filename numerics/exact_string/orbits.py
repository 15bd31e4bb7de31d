r"""Orbits of the string's return map, for :mod:`numerics.exact_string.characteristics`.

An orbit is written as its deviation from rest, t_k = (t_0 + 2ak) + x_k and
t_{k+1} = t_k + 2a + d_k, with x_0 = d_0 = 0 and

.. math:: x_k = x_{k−1} + d_{k−1}, \qquad d_k = d_{k−1} + 2Z'(t_k),

so that rounding is relative to the small deviation and not to the time. The derivative with
respect to the label t_0, D_k = 1 + x_k′ and D_{k+1} = D_k + d_k′, obeys the same with
2Z″(t_k) D_k as the kick.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.problems.drive import Drive

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
EPS = 2.0**-52
# Parts into which a bracket of labels is cut at a time.
ZOOM = 32
# A Newton step, in units of 2a, after which the label is as good as it gets.
SETTLED = 1e-10


@dataclass(frozen=True)
class Orbit:
    """The return k of the orbits with given labels, arrays of one shape.

    Attributes
    ----------
    time, jump
        t_k and d_k = t_{k+1} − t_k − 2a.
    stretch, jump_rate
        D_k and d_k′ = D_{k+1} − D_k.
    primitive
        F(t_k).
    error
        Σ_j D_j η_j over the kicks so far, η_j their rounding; see
        :mod:`numerics.exact_string.characteristics`.
    """

    time: Array
    jump: Array
    stretch: Array
    jump_rate: Array
    primitive: Array
    error: Array

    @property
    def next_stretch(self) -> Array:
        """D_{k+1}."""
        return self.stretch + self.jump_rate


@dataclass(frozen=True)
class ReturnMap:
    """The map of one drive: Z, Z′ and Z″ at times t ≥ 0, and a = √Z(0)."""

    height: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    curvature: Callable[[Array], Array]
    rest: float

    @property
    def reach(self) -> float:
        """2a, the return time at rest."""
        return 2 * self.rest

    def orbit(self, returns: NDArray[Any], labels: Array) -> Orbit:
        """Orbits with labels t_0 ≤ 0 after ``returns`` ≥ 0 steps each; shapes broadcast."""
        returns, labels = np.broadcast_arrays(returns, labels)
        shape, order = labels.shape, np.argsort(-returns.ravel(), kind="stable")
        steps, start = returns.ravel()[order], labels.ravel()[order]
        state = np.zeros((6, start.size))
        for step in range(1, int(steps.max(initial=0)) + 1):
            n = int(np.searchsorted(-steps, -step, side="right"))  # orbits that go this far
            self._advance(state[:, :n], start[:n], step)
        x, d, dx, dd, primitive, error = state
        back = np.empty_like(order)
        back[order] = np.arange(order.size)
        time = (start + self.reach * steps) + x
        values = (time, d, 1 + dx, dd, primitive, error)
        return Orbit(*(value[back].reshape(shape) for value in values))

    def _advance(self, state: Array, start: Array, step: int) -> None:
        """One return, in place: state holds x, d, their label derivatives, F and the error."""
        x, d, dx, dd, primitive, error = state
        x += d
        dx += dd
        t = (start + self.reach * step) + x
        kick, bend, stretch = 2 * self.slope(t), 2 * self.curvature(t), 1 + dx
        primitive += (d / 2) ** 2 + (self.height(t) - self.rest**2)
        d += kick
        dd += bend * stretch
        error += EPS * np.abs(stretch) * (np.abs(bend) * (t + 1) + np.abs(kick) + np.abs(d))

    def table(self, labels: Array, until: float) -> tuple[Array, Array]:
        """t_k and D_k, a row a return, till all midpoints have passed ``until`` or D_k ≤ 0."""
        state = np.zeros((6, len(labels)))
        times, stretches = [labels], [np.ones(len(labels))]
        last = False
        while not last:
            self._advance(state, labels, len(times))
            times.append((labels + self.reach * len(times)) + state[0])
            stretches.append(1 + state[2])
            self._check_row(times[-1])
            last = float((times[-1] + times[-2]).min()) >= 2 * until
            last |= bool((stretches[-1] <= 0).any())
        return np.array(times), np.array(stretches)

    def _check_row(self, times: Array) -> None:
        heights = self.height(times)
        if not (np.isfinite(times).all() and (heights > 0).all()):
            raise InputError(
                f"the drive gives Z = {float(np.min(heights)):.6g} or a slope that is not finite "
                f"between τ = {float(times.min()):.6g} and {float(times.max()):.6g}; Z(τ) must "
                "stay above the ground, Z > 0, and both callables must be finite"
            )

    def midpoint(self, orbit: Orbit) -> Array:
        """τ = (t_k + t_{k+1})/2, when the characteristic meets the contact point."""
        return orbit.time + (self.rest + orbit.jump / 2)

    def contact(self, orbit: Orbit) -> Array:
        """ξ_c = (t_{k+1} − t_k)/2."""
        return self.rest + orbit.jump / 2

    def shifted(self, orbit: Orbit, amount: Array, half: bool) -> Orbit:
        """The orbits whose t_k (or midpoint) is later by a rounding error, to first order.

        Where D is large neighbouring floating-point labels are D eps apart in time; the rest of the
        way is made up here, with F′(t_k) = d_k/2.
        """
        rate = orbit.stretch + orbit.jump_rate / 2 if half else orbit.stretch
        with np.errstate(divide="ignore", invalid="ignore"):
            move = np.nan_to_num(amount / rate)
        # At a sonic contact the rate is 0 and there is nothing to be gained.
        move = np.clip(move, -SETTLED * self.reach, SETTLED * self.reach)
        return replace(
            orbit,
            time=orbit.time + orbit.stretch * move,
            jump=orbit.jump + orbit.jump_rate * move,
            primitive=orbit.primitive + orbit.jump / 2 * orbit.stretch * move,
        )

    def invert(self, target: Array, returns: Counts, low: Array, high: Array, half: bool) -> Array:
        """The labels whose t_k (or midpoint, if ``half``) is ``target``; arrays of one dimension.

        Newton's iteration inside the bracket of labels, which it never leaves: a step that would is
        replaced by a bisection.
        """
        labels = (low + high) / 2
        open_ = np.arange(labels.size)
        for _ in range(60):  # bisection alone would need 53
            here = labels[open_]
            orbit = self.orbit(returns[open_], here)
            value = self.midpoint(orbit) if half else orbit.time
            rate = orbit.stretch + orbit.jump_rate / 2 if half else orbit.stretch
            excess = value - target[open_]
            low[open_] = np.where(excess <= 0, here, low[open_])
            high[open_] = np.where(excess >= 0, here, high[open_])
            with np.errstate(divide="ignore", invalid="ignore"):
                trial = here - excess / rate
            inside = (trial >= low[open_]) & (trial <= high[open_])
            labels[open_] = np.where(inside, trial, (low[open_] + high[open_]) / 2)
            # Newton squares a step this small down to rounding: no further one is needed, and
            # none would help, the map being monotone only as far as its rounding lets it.
            move = np.abs(labels[open_] - here)
            done = (inside & (move <= SETTLED * self.reach)) | (move <= EPS * self.reach)
            open_ = open_[~done]
            if open_.size == 0:
                break
        return labels

    def lowest_stretch(self, returns: Counts, low: Array, high: Array) -> tuple[Array, Array]:
        """Where D_k is least in each bracket of labels, and how much."""
        weights = np.linspace(0, 1, ZOOM + 1)
        for _ in range(6):  # a minimum is flat: ZOOM⁻⁶ < √eps in place is eps in value
            grid = low[:, None] + (high - low)[:, None] * weights
            values = self.orbit(returns[:, None], grid).stretch
            best = values.argmin(axis=1)
            rows = np.arange(len(best))
            place, least = grid[rows, best], values[rows, best]
            low, high = (
                grid[rows, np.maximum(best - 1, 0)],
                grid[rows, np.minimum(best + 1, ZOOM)],
            )
        return place, least

    def first_zero(self, returns: int, low: float, high: float) -> tuple[float, float]:
        """The first label in [low, high] where D_k ≤ 0, bracketed to rounding; D_k(high) ≤ 0."""
        weights = np.linspace(0, 1, ZOOM + 1)
        for _ in range(13):  # ZOOM⁻¹³ = 2⁻⁶⁵
            grid = low + (high - low) * weights
            values = self.orbit(np.asarray(returns), grid).stretch
            values[-1] = min(values[-1], 0.0)
            first = int((values <= 0).argmax())
            low, high = float(grid[max(first - 1, 0)]), float(grid[first])
        return low, high


def return_map(drive: Drive, until: float, rest: float) -> ReturnMap:
    """The map of ``drive``, with Z″ by central differences of Z′ unless the drive has it."""
    second = drive.curvature
    if second is None:
        second = differentiate(drive.slope, until)
    return ReturnMap(drive.height, drive.slope, second, rest)


def differentiate(slope: Callable[[Array], Array], until: float) -> Callable[[Array], Array]:
    r"""Z″ from Z′ by central differences of order 12, their step δ chosen by the function itself.

    :math:`Z'' ≈ \frac1δ \sum_{m=1}^6 w_m (Z'(t+mδ) − Z'(t−mδ))`,
    w_m = (−1)^{m+1} 6!²/(m (6−m)! (6+m)!). Of δ = 1, ½, ¼, … the one is taken whose result changes
    least when δ is halved; for a cosine that leaves an error of about 10⁻¹⁴ max|Z″|.

    Examples
    --------
    >>> second = differentiate(np.sin, 100.0)
    >>> t = np.linspace(0, 100, 7)
    >>> bool(np.abs(second(t) - np.cos(t)).max() < 1e-13)
    True
    """
    samples = until * np.linspace(0, 1, 2048)
    steps = 2.0 ** -np.arange(14)
    values = [_difference(slope, step, samples) for step in steps]
    changes = [np.abs(b - a).max() for a, b in pairwise(values)]
    best = float(steps[int(np.argmin(changes)) + 1])
    return partial(_difference, slope, best)


def _difference(slope: Callable[[Array], Array], step: float, t: Array) -> Array:
    weights = [6 / 7, -15 / 56, 5 / 63, -1 / 56, 1 / 385, -1 / 5544]
    shifts = step * np.arange(1, 7).reshape((6,) + (1,) * np.ndim(t))
    return np.tensordot(weights, slope(t + shifts) - slope(t - shifts), 1) / step
