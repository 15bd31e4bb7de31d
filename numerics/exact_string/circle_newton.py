r"""Newton's iteration for an invariant circle of the standard map, by FFTs alone.

Sought is the odd function :math:`U(ψ) = \sum_{k≥1} b_k \sin kψ` with

.. math:: U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ)), \qquad K = 2εΩ²,

and with it, of ϱ and Ω, the one that is not given: the mean height, which
:mod:`numerics.exact_string.invariant_circle` explains and :func:`_height` spells out, ties the two.
On M nodes, with l = 1 + U′ and the correction l·w, Newton's linear equation reads, up to a term of
second order, :math:`∇_-(l\,l_+\,∇_+ w) = −l E`, with the residual E, the differences ∇± over ±ϱ
and a subscript + for the shift by ϱ; each difference is inverted in Fourier space (M. Levi &
J. Moser, Proc. Symp. Pure Math. 69 (2001) 733).

Two things carry the iteration up to the break-up. Harmonics above M/3 are left out, which keeps the
aliases of the products away from the rest: without that the iteration is unstable there. And each
grid begins where the next coarser one ended, so that the many modes are there before the small
divisors among them count. M doubles until the residual with *all* harmonics of the force is
rounding. Where a curve is lost, K is approached in shorter steps.

By Birkhoff's theorem an invariant circle is a graph over φ, hence l > 0: a solution on M nodes with
l ≤ 0 is no circle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from numerics.exact_string.circle_state import EPS, Array, CircleStatus, InvariantCircle

_MOST_STEPS = 40
# Relative residual below which a curve is worth a finer grid; above it, the step in K was too long.
_NEAR = 1e-5
_SHORTEST = 2.0**-10


@dataclass(frozen=True)
class Sought:
    """The circle that is looked for.

    Attributes
    ----------
    strength
        K, of either sign.
    omega
        Ω; None when ϱ is given, and Ω read off from the mean height.
    rotation_number
        ϱ: given, or what to begin with.
    """

    strength: float
    omega: float | None
    rotation_number: float

    def at(self, share: float) -> Sought:
        """The same with less K."""
        return replace(self, strength=self.strength * share)


class _Curve(NamedTuple):
    """An iterate: c_k, ϱ, how far it got, and its residuals on the way."""

    c: Array
    rotation_number: float
    nodes: int
    residual: float
    status: CircleStatus


def search(
    sought: Sought, nodes: int, max_nodes: int, start: InvariantCircle | None = None
) -> InvariantCircle:
    """The circle, or the last iterate with a status that says why it is none.

    >>> search(Sought(0.6, None, 2 * math.pi * 0.618034), nodes=32, max_nodes=512).status.name
    'CONVERGED'
    """
    history: list[float] = []
    if start is not None:
        while nodes < max_nodes and nodes // 3 < len(start.sines):
            nodes *= 2
        grid = _Grid(nodes)
        guess = (grid.from_sines(start.sines), start.rotation_number)
        curve = _resolved(sought, guess, nodes, max_nodes, history)
        if curve.status is CircleStatus.CONVERGED:
            return _circle(sought, curve, history)
    return _from_rest(sought, nodes, max_nodes, history)


def _from_rest(sought: Sought, nodes: int, max_nodes: int, history: list[float]) -> InvariantCircle:
    """All K at once, and where that fails, in steps; two failures running ask for a finer grid."""
    reached: list[tuple[float, _Curve]] = []  # shares of K and their curves; the last two count
    share, step, failures = 0.0, 1.0, 0
    while True:
        target = min(share + step, 1.0)
        here = sought.at(target)
        guess = _predicted(here, target, reached, nodes)
        curve = _resolved(here, guess, nodes, max_nodes, history)
        if curve.status is CircleStatus.CONVERGED:
            if target == 1.0:
                return _circle(here, curve, history)
            reached = [*reached[-1:], (target, curve)]
            share, nodes, failures, step = target, curve.nodes, 0, 1.5 * step
            continue
        step, failures = step / 2, failures + 1
        if curve.status is CircleStatus.UNRESOLVED or step < _SHORTEST:
            return _circle(here, curve, history)
        if failures == 2:
            nodes, failures = 2 * nodes, 0
            if nodes > max_nodes:
                return _circle(here, curve, history)


def _predicted(
    sought: Sought, share: float, reached: list[tuple[float, _Curve]], nodes: int
) -> tuple[Array, float]:
    """Where to begin: on the secant of the last two curves, at first on the linear response."""
    grid = _Grid(nodes)
    if not reached:
        return _linear_guess(grid, sought)
    last_share, last = reached[-1]
    c = grid.padded(last.c)
    if len(reached) == 1:
        return c, last.rotation_number
    other_share, other = reached[-2]
    ratio = (share - last_share) / (last_share - other_share)
    turn = last.rotation_number + ratio * (last.rotation_number - other.rotation_number)
    return c + ratio * (c - grid.padded(other.c)), turn


def _resolved(
    sought: Sought,
    guess: tuple[Array, float],
    nodes: int,
    max_nodes: int,
    history: list[float],
) -> _Curve:
    """Newton's iteration on nodes, 2 nodes, …, each from the last, until all of E is rounding."""
    while True:
        grid = _Grid(nodes)
        curve = _newton(grid, sought, grid.padded(guess[0]), guess[1], history)
        if curve.status is not CircleStatus.UNRESOLVED or 2 * nodes > max_nodes:
            return curve
        guess, nodes = (curve.c, curve.rotation_number), 2 * nodes


def _circle(sought: Sought, curve: _Curve, history: list[float]) -> InvariantCircle:
    grid = _Grid(curve.nodes)
    omega = sought.omega
    if omega is None:
        omega = frequency(curve.c, grid.nodes, curve.rotation_number, sought.strength)
    last = _last_heard(grid, curve.c) if sought.strength else 0
    sines = np.array(-2 * curve.c.imag[1 : last + 1])
    epsilon = sought.strength / (2 * omega**2)
    return InvariantCircle(
        omega, epsilon, curve.rotation_number, sines, grid.nodes, curve.status, tuple(history)
    )


def frequency(c: Array, nodes: int, rho: float, strength: float) -> float:
    """Ω of the circle with the coefficients c_k, 0 ≤ k ≤ M/2, from the mean height.

    >>> frequency(np.zeros(9, complex), 16, 2.4, 0.0)
    1.2
    """
    grid = _Grid(nodes)
    cosine = float(np.cos(grid.psi + grid.values(c)).mean())
    return math.sqrt(_twice_squared(grid, c, rho) - 2 * strength * cosine) / 2


class _Grid:
    """M equispaced nodes on the circle and their Fourier coefficients c_k, 0 ≤ k ≤ M/2."""

    def __init__(self, nodes: int) -> None:
        self.nodes = nodes
        self.psi = np.arange(nodes) * (2 * math.pi / nodes)
        self.k = np.arange(nodes // 2 + 1)

    def values(self, c: Array) -> Array:
        return np.fft.irfft(c, self.nodes) * self.nodes

    def coefficients(self, values: Array) -> Array:
        return np.fft.rfft(values) / self.nodes

    def odd(self, c: Array) -> Array:
        """The sine series within c, up to the harmonic M/3."""
        out = 1j * c.imag
        out[0] = 0
        out[self.nodes // 3 + 1 :] = 0
        return out

    def padded(self, c: Array) -> Array:
        out = np.zeros(self.nodes // 2 + 1, complex)
        kept = min(len(c), self.nodes // 3 + 1)
        out[:kept] = c[:kept]
        return out

    def from_sines(self, b: Array) -> Array:
        return self.padded(np.r_[0, -0.5j * b])

    def sine_of_angle(self, c: Array) -> Array:
        """The coefficients of sin φ, φ = ψ + U."""
        return self.coefficients(np.sin(self.psi + self.values(c)))


def _linear_guess(grid: _Grid, sought: Sought) -> tuple[Array, float]:
    """The linear response, with ϱ to O(ε²), which keeps it off the resonances next to 2Ω."""
    rotation = sought.rotation_number
    amplitude = sought.strength / (4 * math.sin(rotation / 2) ** 2) if sought.strength else 0.0
    c = grid.from_sines(np.array([amplitude]))
    if sought.omega is not None:
        for _ in range(3):
            height = _height(grid, c, rotation, sought.omega, sought.strength)
            rotation -= height.value / height.slope
    return c, rotation


def _last_heard(grid: _Grid, c: Array) -> int:
    """The last harmonic of the force, up to M/3, that is not rounding.

    Rounding puts about one unit into every coefficient of sin φ; 8 leave the FFT room.
    """
    force = np.abs(grid.sine_of_angle(c))[1 : grid.nodes // 3 + 1]
    heard = np.nonzero(force > 8 * EPS)[0]
    return int(heard[-1]) + 1 if len(heard) else 0


class _Height(NamedTuple):
    """4Ω² times the mean-height equation, its derivative in ϱ, and in the c_k (as a weight)."""

    value: float
    slope: float
    weight: Array


def _twice_squared(grid: _Grid, c: Array, rho: float) -> float:
    """ϱ² + 2ϱ Σ k sin(kϱ) |c_k|² − Σ 4 sin²(kϱ/2) |c_k|², sums over all k ≠ 0."""
    k, power = grid.k, 2 * np.abs(c) ** 2
    turning = 2 * rho * float(power @ (k * np.sin(k * rho)))
    return rho**2 + turning - float(power @ (4 * np.sin(k * rho / 2) ** 2))


def _height(grid: _Grid, c: Array, rho: float, omega: float, strength: float) -> _Height:
    """The mean height in Fourier space: :func:`_twice_squared` is 4Ω² + 2K ⟨cos φ⟩."""
    k, power = grid.k, 2 * np.abs(c) ** 2
    phi = grid.psi + grid.values(c)
    mean = 4 * omega**2 + 2 * strength * float(np.cos(phi).mean())
    slope = 2 * rho * (1 + float(power @ (k**2 * np.cos(k * rho))))
    weight = 4 * (2 * rho * k * np.sin(k * rho) - 4 * np.sin(k * rho / 2) ** 2) * c.imag
    sine = grid.coefficients(np.sin(phi)).imag
    value = _twice_squared(grid, c, rho) - mean
    return _Height(value, slope, weight + 4 * strength * sine)


def _newton(grid: _Grid, sought: Sought, c: Array, rho: float, history: list[float]) -> _Curve:
    """Iterate until the residual no longer falls; resolved if that of all harmonics is rounding."""
    strength, omega = sought.strength, sought.omega
    scale = abs(strength) or 1.0
    best: _Curve | None = None
    for _ in range(_MOST_STEPS):
        force = grid.odd(grid.sine_of_angle(c))
        defect = -4 * np.sin(grid.k * rho / 2) ** 2 * c + strength * force
        residual = float(np.abs(defect).max()) / scale
        height = None if omega is None else _height(grid, c, rho, omega, strength)
        if height is not None and omega is not None:
            residual = max(residual, abs(height.value) / (4 * omega**2))
        history.append(residual)
        stretch = 1 + grid.values(1j * grid.k * c)
        if stretch.min() <= 0:
            return _Curve(c, rho, grid.nodes, residual, CircleStatus.FOLDED)
        if not np.isfinite(residual) or (best is not None and residual > best.residual / 2):
            break
        best = _Curve(c, rho, grid.nodes, residual, CircleStatus.STALLED)
        c, rho = _corrected(grid, c, rho, stretch, defect, height)
    if best is None:
        return _Curve(c, rho, grid.nodes, math.inf, CircleStatus.STALLED)
    if best.residual > _NEAR:
        return best
    left = _left_over(grid, best, strength)
    done = max(best.residual, left / scale) <= _rounding(grid, best, scale)
    status = CircleStatus.CONVERGED if done else CircleStatus.UNRESOLVED
    return best._replace(status=status)


def _left_over(grid: _Grid, curve: _Curve, strength: float) -> float:
    """max_k |E_k| with all harmonics up to M, of which those above M/3 were left out."""
    finer = _Grid(2 * grid.nodes)
    c = finer.padded(curve.c)
    turns = finer.k * (curve.rotation_number / 2)
    defect = -4 * np.sin(turns) ** 2 * c + 1j * strength * finer.sine_of_angle(c).imag
    return float(np.abs(defect).max())


def _rounding(grid: _Grid, curve: _Curve, scale: float) -> float:
    """What the residual is by rounding alone.

    A few units from sin φ, a unit from each sum of log₂ M terms, and what the rounding of ϱ makes
    of the divisors 4 sin²(kϱ/2), which counts next to a resonance.
    """
    k, rho = grid.k, curve.rotation_number
    divisors = float(np.abs(2 * k * rho * np.sin(k * rho) * curve.c).max())
    return (16 + 2 * math.log2(grid.nodes) + divisors / scale) * EPS


def _corrected(
    grid: _Grid, c: Array, rho: float, stretch: Array, defect: Array, height: _Height | None
) -> tuple[Array, float]:
    """c and ϱ one step on: what the defect asks for, and the change of ϱ that the height needs."""
    step = _linear_solve(grid, stretch, rho, -defect)
    if height is None:
        return c + step, rho
    turn = _linear_solve(grid, stretch, rho, 2 * grid.k * np.sin(grid.k * rho) * c)
    change = -(height.value + float(height.weight @ step.imag)) / (
        height.slope + float(height.weight @ turn.imag)
    )
    return c + step + change * turn, rho + change


def _linear_solve(grid: _Grid, stretch: Array, rho: float, right: Array) -> Array:
    """l·w with ∇₋(l l₊ ∇₊ w) = l · right, w odd, by two divisions in Fourier space."""
    k = grid.k[1:]
    forward = np.exp(1j * k * rho) - 1
    shifted = grid.values(grid.coefficients(stretch) * np.exp(1j * grid.k * rho))
    product = stretch * shifted
    flux = grid.coefficients(stretch * grid.values(right))
    flux[0] = 0
    flux[1:] /= -np.conj(forward)
    inner = grid.values(flux)
    gradient = (inner - (inner / product).mean() / (1 / product).mean()) / product
    w = grid.coefficients(gradient)
    w[0] = 0
    w[1:] /= forward
    return grid.odd(grid.coefficients(stretch * grid.values(w)))
