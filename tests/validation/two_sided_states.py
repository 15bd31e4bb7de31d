"""Periodic states of a rope on springs by collocation in time, for small and not so small ε.

Both sides are sums of solutions e^{λξ} of each harmonic; their weights and the contact point at
equally spaced times follow from the conditions at the moving contact point itself, by Newton's
method. Nothing is expanded in ε.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import fsolve

Array = npt.NDArray[Any]


class Side:
    """Solutions of −W_ττ + W_ξξ − βW_ξξξξ − κW = 2 on one side, harmonic by harmonic."""

    def __init__(self, beta: float, kappa: float, omega: float) -> None:
        self.beta, self.kappa, self.omega = beta, kappa, omega

    def exponents(self, j: int) -> Array:
        square = self.kappa - (j * self.omega) ** 2
        if not self.beta:
            return np.array([1.0, -1.0]) * np.sqrt(square + 0j)
        root = np.sqrt(1 - 4 * self.beta * square + 0j)
        squares = np.array([1 + root, 1 - root]) / (2 * self.beta)
        # (1 − root)/(2β) cancels where β is small.
        squares[1] = 2 * square / (1 + root)
        return np.concatenate([np.sqrt(squares), -np.sqrt(squares)])

    def decaying(self, j: int) -> Array:
        """Those that decay as ξ → ∞, or carry energy there: e^{i(jΩτ − kξ)}, k > 0 for j > 0."""
        found = self.exponents(j)
        keep = (found.real < -1e-9) | ((abs(found.real) <= 1e-9) & (found.imag * j < 0))
        return found[keep]


def powers(exponents: Array, place: Array, d: int) -> Array:
    """∂^d e^{λξ}, a row a place."""
    return exponents**d * np.exp(np.outer(place, exponents))


def pinned_left(side: Side, j: int) -> Callable[[Array, int], tuple[Array, Array]]:
    """(ξ, d) ↦ derivatives of the solutions that meet W = 0 (and W_ξξ = 0) at ξ = 0, and of the
    one with W = 1 there."""
    if j == 0:
        p = 1 / np.sqrt(side.beta) if side.beta else 0.0

        def at_rest(x: Array, d: int) -> tuple[Array, Array]:
            line = [x, np.ones_like(x)][d] if d < 2 else 0 * x
            load = [x * x, 2 * x, 2 + 0 * x][d] if d < 3 else 0 * x
            one = 1.0 + 0 * x if d == 0 else 0 * x
            if not side.beta:
                return np.stack([line], axis=-1).astype(complex), one + load
            # W = 1 + ξ² + 2β(e^{−pξ} − 1) has W_ξξ = 4 e^… at 0: the layer takes the load's 2.
            layer = -2 * side.beta * (-p) ** d * np.exp(-p * x) + (2 * side.beta if d == 0 else 0)
            odd = p**d * (np.sinh(p * x) if d % 2 == 0 else np.cosh(p * x))
            return np.stack([line, odd], axis=-1).astype(complex), one + load + layer

        return at_rest
    found = side.exponents(j)
    half = len(found) // 2
    up = found[:half]

    def moving(x: Array, d: int) -> tuple[Array, Array]:
        sines = (powers(up, x, d) - powers(-up, x, d)) / 2
        cosines = (powers(up, x, d) + powers(-up, x, d)) / 2
        if half == 1:
            return sines, cosines[:, 0]
        a, b = up[0] ** 2, up[1] ** 2
        return sines, (b * cosines[:, 0] - a * cosines[:, 1]) / (b - a)

    return moving


def contact_of(
    beta: float, kappa: float, omega: float, epsilon: float, rest: float, harmonics: int = 8
) -> Array:
    """The contact point at 2H + 1 equal times of a period, drive ε cos Ωτ, pinned end."""
    H = harmonics
    times = 2 * np.pi * np.arange(2 * H + 1) / (2 * H + 1)
    left, right = Side(beta, 0.0, omega), Side(beta, kappa, omega)
    count = 2 if beta else 1
    order = 2 * count
    lefts = {j: pinned_left(left, j) for j in range(H + 1)}
    decays = {j: right.decaying(j) for j in range(H + 1)}

    def columns(place: Array, d: int) -> tuple[Array, Array, Array]:
        """What the real weights do on the left and on the right, and what is there without."""
        here, there, forced = [], [], np.zeros(len(times))
        for j in range(H + 1):
            phase = np.exp(1j * j * times)[:, None]
            free, driven = lefts[j](place, d)
            drive = 1.0 if j == 0 else epsilon if j == 1 else 0.0
            forced += (drive * driven * phase[:, 0]).real
            for found, side in (
                (free, here),
                (powers(decays[j], place - rest, d), there),
            ):
                if j == 0 and np.any(found.imag):  # a conjugate pair, and real weights
                    found = np.stack([found[:, 0].real, found[:, 0].imag], axis=-1)
                side.append((found * phase).real)
                if j:
                    side.append(-(found * phase).imag)
        return np.hstack(here), np.hstack(there), forced

    def height(place: Array) -> Array:
        """W at the contact point from the left, when nothing jumps there: linear in the weights."""
        rows, sides = [], []
        for d in range(order):
            here, there, forced = columns(place, d)
            rows.append(np.hstack([here, -there]))
            sides.append(-forced - (2 / kappa if d == 0 else 0.0))
        weights = np.linalg.solve(np.vstack(rows), np.concatenate(sides))
        here, _, forced = columns(place, 0)
        return here @ weights[: here.shape[1]] + forced

    found, _, status, message = fsolve(
        height, np.full(len(times), rest), full_output=True, xtol=1e-13
    )
    assert status == 1 or np.max(np.abs(height(found))) < 1e-12, message
    return np.asarray(found)
