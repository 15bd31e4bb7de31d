r"""Newton's iteration for an invariant circle of the standard map, by FFTs alone.

Sought are ϱ and the odd function :math:`U(ψ) = \sum_{k≥1} b_k \sin kψ` with

.. math:: U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ)), \qquad K = 2εΩ²,

and the mean height that :mod:`numerics.exact_string.invariant_circle` explains and :func:`_height`
spells out. On M nodes, with l = 1 + U′ and the correction l·w, Newton's linear equation reads, up
to a term of second order, :math:`∇_-(l\,l_+\,∇_+ w) = −l E`, with the residual E, the differences
∇± over ±ϱ and a subscript + for the shift by ϱ; each difference is inverted in Fourier space (M.
Levi & J. Moser, Proc. Symp. Pure Math. 69 (2001) 733). M doubles until the force K sin φ is
resolved to rounding.

By Birkhoff's theorem an invariant circle is a graph over φ, hence l > 0: a solution on M nodes with
l ≤ 0 is no circle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from numerics.exact_string.circle_state import EPS, Array, CircleStatus, InvariantCircle

_MOST_STEPS = 40


class _Guess(NamedTuple):
    """Where to begin: the b_k and ϱ."""

    sines: Array
    rotation_number: float


def search(
    omega: float,
    epsilon: float,
    nodes: int,
    max_nodes: int,
    start: InvariantCircle | None = None,
) -> InvariantCircle:
    """The circle at (Ω, ε); where Newton's iteration misses it, by way of smaller ε.

    >>> search(0.83, 0.02, nodes=32, max_nodes=64).status.name
    'CONVERGED'
    """
    state = _solve(omega, epsilon, nodes, max_nodes, start)
    reached: InvariantCircle | None = None
    for pieces in (2, 4, 8):
        if state.status is CircleStatus.CONVERGED:
            break
        for i in range(1, pieces):
            step = _solve(omega, epsilon * i / pieces, nodes, max_nodes, reached)
            if step.status is CircleStatus.CONVERGED:
                reached = step
        state = _solve(omega, epsilon, nodes, max_nodes, reached)
    return state


def _solve(
    omega: float, epsilon: float, nodes: int, max_nodes: int, start: InvariantCircle | None
) -> InvariantCircle:
    """Newton's iteration on nodes, 2 nodes, … until the force is resolved."""
    if start is None:
        guess = _linear_guess(omega, epsilon, nodes)
    else:
        guess = _Guess(start.sines, start.rotation_number)
        while nodes < max_nodes and nodes // 3 < len(guess.sines):
            nodes *= 2
    history: list[float] = []
    while True:
        grid = _Grid(nodes)
        c, rho, residuals, status = _newton(grid, guess, omega, epsilon)
        history += residuals
        last = _last_heard(grid, c) if epsilon else 0
        resolved = last <= nodes // 3
        if status is CircleStatus.CONVERGED and not resolved:
            status = CircleStatus.UNRESOLVED
        kept = np.array(-2 * c.imag[1 : (last if resolved else nodes // 2 - 1) + 1])
        if status is CircleStatus.CONVERGED or 2 * nodes > max_nodes:
            return InvariantCircle(omega, epsilon, rho, kept, nodes, status, tuple(history))
        if status is CircleStatus.UNRESOLVED:
            guess = _Guess(kept, rho)
        nodes *= 2


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
        """The sine series within c; the last coefficient cannot hold one."""
        out = 1j * c.imag
        out[0] = out[-1] = 0
        return out

    def from_sines(self, b: Array) -> Array:
        c = np.zeros(self.nodes // 2 + 1, complex)
        b = b[: len(c) - 2]
        c[1 : len(b) + 1] = -0.5j * b
        return c

    def sine_of_angle(self, c: Array) -> Array:
        """The coefficients of sin φ, φ = ψ + U."""
        return self.coefficients(np.sin(self.psi + self.values(c)))


def _linear_guess(omega: float, epsilon: float, nodes: int) -> _Guess:
    """The linear response, with ϱ to O(ε²), which keeps it off the resonances next to 2Ω."""
    strength = 2 * epsilon * omega**2
    sines = np.array([strength / (4 * math.sin(omega) ** 2)]) if epsilon else np.zeros(1)
    grid, rotation = _Grid(nodes), 2 * omega
    for _ in range(3):
        height = _height(grid, grid.from_sines(sines), rotation, omega, epsilon)
        rotation -= height.value / height.slope
    return _Guess(sines, rotation)


def _last_heard(grid: _Grid, c: Array) -> int:
    """The last harmonic of the force that is not rounding.

    Rounding puts about one unit into every coefficient of sin φ; 8 leave the FFT room.
    """
    heard = np.nonzero(np.abs(grid.sine_of_angle(c))[1:-1] > 8 * EPS)[0]
    return int(heard[-1]) + 1 if len(heard) else 0


class _Height(NamedTuple):
    """4Ω² times the mean-height equation, its derivative in ϱ, and in the c_k (as a weight)."""

    value: float
    slope: float
    weight: Array


def _height(grid: _Grid, c: Array, rho: float, omega: float, epsilon: float) -> _Height:
    """The equation of the mean height, in Fourier space.

    ϱ² + 2ϱ Σ k sin(kϱ) |c_k|² − Σ 4 sin²(kϱ/2) |c_k|² = 4Ω² (1 + ε ⟨cos φ⟩), sums over all k ≠ 0.
    """
    k, power = grid.k, 2 * np.abs(c) ** 2
    phi = grid.psi + grid.values(c)
    value = (
        rho**2
        + 2 * rho * float(power @ (k * np.sin(k * rho)))
        - float(power @ (4 * np.sin(k * rho / 2) ** 2))
        - 4 * omega**2 * (1 + epsilon * float(np.cos(phi).mean()))
    )
    slope = 2 * rho * (1 + float(power @ (k**2 * np.cos(k * rho))))
    weight = 4 * (2 * rho * k * np.sin(k * rho) - 4 * np.sin(k * rho / 2) ** 2) * c.imag
    sine = grid.coefficients(np.sin(phi)).imag
    return _Height(value, slope, weight + 8 * omega**2 * epsilon * sine)


def _newton(
    grid: _Grid, guess: _Guess, omega: float, epsilon: float
) -> tuple[Array, float, list[float], CircleStatus]:
    """Iterate until the residual no longer falls; converged if it is rounding by then."""
    c, rho = grid.from_sines(guess.sines), guess.rotation_number
    strength = 2 * epsilon * omega**2
    best: tuple[float, Array, float] | None = None
    history: list[float] = []
    status = CircleStatus.STALLED
    for _ in range(_MOST_STEPS):
        force = grid.odd(grid.sine_of_angle(c))
        defect = -4 * np.sin(grid.k * rho / 2) ** 2 * c + strength * force
        height = _height(grid, c, rho, omega, epsilon)
        scale = abs(strength) if strength else 1.0
        residual = max(float(np.abs(defect).max()) / scale, abs(height.value) / (4 * omega**2))
        history.append(residual)
        stretch = 1 + grid.values(1j * grid.k * c)
        if stretch.min() <= 0:
            status = CircleStatus.FOLDED
            break
        if not np.isfinite(residual) or (best is not None and residual > best[0] / 2):
            break
        best = (residual, c, rho)
        c, rho = _corrected(grid, c, rho, stretch, defect, height)
    if best is None:
        return c, rho, history, status
    # Rounding of the residual: a few units from sin φ, a unit from each sum of log₂ M terms, and
    # what the rounding of ϱ makes of the divisors 4 sin²(kϱ/2), which counts next to a resonance.
    _, c, rho = best
    divisors = float(np.abs(2 * grid.k * rho * np.sin(grid.k * rho) * c).max())
    if best[0] <= (16 + 2 * math.log2(grid.nodes) + divisors / scale) * EPS:
        status = CircleStatus.CONVERGED
    return best[1], best[2], history, status


def _corrected(
    grid: _Grid, c: Array, rho: float, stretch: Array, defect: Array, height: _Height
) -> tuple[Array, float]:
    """c and ϱ one step on: what the defect asks for, and the change of ϱ that the height needs."""
    step = _linear_solve(grid, stretch, rho, -defect)
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
