r"""The exact periodic, wave-less state of the string (β = 0): an invariant circle.

With :math:`W = ξ² + f(τ−ξ) + g(τ+ξ)` the contact conditions W = W_ξ = 0 at ξ_c say
:math:`f'(τ−ξ_c) = −g'(τ+ξ_c) = ξ_c`. A characteristic that leaves ξ = 0 at the time t comes back at
h(t), reflected at the contact point halfway in time and space, so f′(t) = (h(t) − t)/2, and the
drive W(0, τ) = Z(τ) = 1 + ε cos Ωτ becomes :math:`h(t) − 2t + h^{-1}(t) = 2Z'(t)`: in φ = Ωt the
Chirikov standard map with K = 2εΩ². A periodic state is an invariant circle of it,

.. math:: φ = ψ + U(ψ), \quad h: ψ ↦ ψ + ϱ, \qquad
          U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ)).

The map knows Z′ only. The mean height enters by the integral of the contact condition,
:math:`f(h(u)) − f(u) = ξ_c² + Z(h(u))`; its mean over the circle fixes ϱ = 2Ω + O(ε²):

.. math:: \frac{ϱ}{Ω} ⟨D (1 + U')⟩ = ⟨D²⟩ + 1 + ε ⟨\cos(ψ + U)⟩, \qquad
          D(ψ) = \frac{ϱ + U(ψ+ϱ) − U(ψ)}{2Ω}.

The drive is even in time, so U is odd: :math:`U = \sum_{k≥1} b_k \sin kψ`.

**Method.** On M nodes, Newton's linear equation is solved with FFTs alone: with l = 1 + U′ and the
correction l·w it reads, up to a term of second order, :math:`∇_-(l\,l_+\,∇_+ w) = −l E`, with the
residual E, the differences ∇± over ±ϱ and a subscript + for the shift by ϱ; each difference is
inverted in Fourier space (M. Levi & J. Moser, Proc. Symp. Pure Math. 69 (2001) 733). M doubles
until the force K sin φ is resolved to rounding.

By Birkhoff's theorem an invariant circle is a graph over φ, hence l > 0, which is |ξ_c′| < 1: a
solution on M nodes with l ≤ 0 is no circle. The circle breaks up well before its contact point
reaches the wave speed (the last ones found next to Ω = π have max |ξ_c′| between 0.1 and 0.25); the
motion that follows, no longer periodic, is what folds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import CircleNotFoundError, InputError

Array = NDArray[Any]
EPS = 2.0**-52

# No circle winds around the cylinder beyond this K, proved with interval arithmetic by
# R. S. MacKay & I. C. Percival, Commun. Math. Phys. 98 (1985) 469.
NO_CIRCLE = 63 / 64


class CircleStatus(Enum):
    """How the search ended."""

    CONVERGED = "converged: resolved to rounding"
    STALLED = "Newton's iteration did not converge"
    FOLDED = "the curve found is not a graph, |ξ_c′| ≥ 1 somewhere, so it is no circle"
    UNRESOLVED = "the Fourier series of the circle does not fit on the nodes allowed"


@dataclass(frozen=True, eq=False)
class InvariantCircle:
    r"""The periodic state at one (Ω, ε); made by :func:`invariant_circle`.

    Attributes
    ----------
    omega, epsilon
        Ω and ε.
    rotation_number
        ϱ, in radians: the characteristic's return time times Ω, on average.
    sines
        b_1, b_2, … of U(ψ) = Σ b_k sin kψ, up to the last that is not rounding.
    nodes
        M, on which the iteration ended.
    status
        Whether it is what it says it is.
    residuals
        Newton's residuals in order, over all M: the larger of max_k |E_k|/|K|, the map's, and the
        relative one of the mean height.
    """

    omega: float
    epsilon: float
    rotation_number: float
    sines: Array = field(repr=False)
    nodes: int
    status: CircleStatus
    residuals: tuple[float, ...] = field(repr=False)

    def contact(self, tau: ArrayLike) -> Array:
        """ξ_c(τ), the contact point in units of x₀, for times τ of any shape.

        Inverts Ωτ = χ + Σ b_k cos(kϱ/2) sin kχ and returns (ϱ/2 + Σ b_k sin(kϱ/2) cos kχ)/Ω, which
        are τ = (h(t) + t)/2 and ξ_c = (h(t) − t)/2 on the circle.

        Examples
        --------
        >>> state = invariant_circle(omega=0.83, epsilon=0.02)
        >>> linear = 1 + 0.02 * 0.83 / 2 / np.sin(0.83)          # eq. (linresponse1) at τ = 0
        >>> bool(abs(state.contact(0.0) - linear) < 0.02**2)
        True
        """
        chi = _invert(self._phase(tau), self._middle)
        k, half = self._k, self.rotation_number / 2
        return (half + np.cos(np.multiply.outer(chi, k)) @ (self.sines * np.sin(k * half))) / (
            self.omega
        )

    def shape(self, xi: ArrayLike, tau: ArrayLike) -> Array:
        """W(ξ, τ) in units of Z₀, by d'Alembert; 0 on the ground, ξ > ξ_c. Arguments broadcast.

        Raises
        ------
        InputError
            Some ξ is negative or not finite: the rope starts at ξ = 0.

        Examples
        --------
        >>> state = invariant_circle(omega=0.83, epsilon=0.02)
        >>> abs(state.shape(0.0, 0.7) - (1 + 0.02 * np.cos(0.83 * 0.7))) < 1e-14
        np.True_
        """
        xi, tau = np.broadcast_arrays(np.asarray(xi, float), np.asarray(tau, float))
        if not (np.isfinite(xi).all() and (xi >= 0).all()):
            raise InputError(
                f"xi = {xi!r}: give finite positions ξ ≥ 0, the driven end being ξ = 0"
            )
        time = self._phase(tau) / self.omega
        right = time + xi
        left_value, right_value = self._outgoing(time - xi), self._outgoing(right)
        drive = 1 + self.epsilon * np.cos(self.omega * right)
        lifted = xi * xi + drive + (left_value - right_value)
        return np.where(xi <= self.contact(tau), lifted, 0.0)

    def slope(self, xi: ArrayLike, tau: ArrayLike) -> Array:
        """W_ξ(ξ, τ), as :meth:`shape`."""
        xi, tau = np.broadcast_arrays(np.asarray(xi, float), np.asarray(tau, float))
        time = self._phase(tau) / self.omega
        left, right = time - xi, time + xi
        drive = -self.epsilon * self.omega * np.sin(self.omega * right)
        lifted = 2 * xi - self._outgoing_slope(left) + drive - self._outgoing_slope(right)
        return np.where(xi <= self.contact(tau), lifted, 0.0)

    def profile(self, s: ArrayLike, tau: ArrayLike) -> Array:
        """W(ξ_c(τ) + s, τ): the shape seen from the contact point, −ξ_c ≤ s."""
        return self.shape(np.asarray(s, float) + self.contact(tau), tau)

    @cached_property
    def contact_speed(self) -> float:
        """max |ξ_c′(τ)| in units of the wave speed; below 1 on every circle."""
        k, half = self._k, self.rotation_number / 2
        numerator, denominator = k * self.sines * np.sin(k * half), k * self._middle
        centre, width = math.pi / 2, math.pi / 2
        best = 0.0
        points = 8 * len(k) + 32
        while width > math.sqrt(EPS):  # a maximum is flat: √eps in place is eps in value
            chi = np.linspace(centre - width, centre + width, points)
            angles = np.multiply.outer(chi, k)
            speed = np.abs(np.sin(angles) @ numerator / (1 + np.cos(angles) @ denominator))
            best, centre = max(best, float(speed.max())), float(chi[speed.argmax()])
            width *= 4 / points
        return best

    @cached_property
    def graph_margin(self) -> float:
        """min l = min(1 + U′) over the nodes; positive on a circle, 0 where it breaks."""
        grid = np.arange(4 * max(self.nodes, 8)) * (2 * math.pi / (4 * max(self.nodes, 8)))
        return float((1 + np.cos(np.multiply.outer(grid, self._k)) @ (self._k * self.sines)).min())

    @property
    def _k(self) -> Array:
        return np.arange(1, len(self.sines) + 1)

    @property
    def _middle(self) -> Array:
        return self.sines * np.cos(self._k * (self.rotation_number / 2))

    def _phase(self, tau: ArrayLike) -> Array:
        """Ωτ in [−π, π]: the state is periodic, and a small argument keeps its digits."""
        times = np.asarray(tau, float)
        if not np.isfinite(times).all():
            raise InputError(f"tau = {tau!r}: give finite times")
        turns = np.asarray(self.omega * times)
        return turns - 2 * math.pi * np.round(turns / (2 * math.pi))

    def _outgoing(self, t: Array) -> Array:
        """f(t) = ∫ f′ dt up to a constant, as a function of ψ(t)."""
        psi = _invert(self.omega * t, self.sines)
        mean, rest = self._primitive
        angles = np.exp(1j * np.multiply.outer(psi, np.arange(1, len(rest) + 1)))
        return (mean * psi + 2 * (angles @ rest).real) / self.omega

    def _outgoing_slope(self, t: Array) -> Array:
        """f′(t) = (h(t) − t)/2."""
        psi, half = _invert(self.omega * t, self.sines), self.rotation_number / 2
        k = self._k
        amplitude = self.sines * np.sin(k * half)
        return (half + np.cos(np.multiply.outer(psi + half, k)) @ amplitude) / self.omega

    @cached_property
    def _primitive(self) -> tuple[float, Array]:
        """Mean of D (1 + U′), and the Fourier coefficients of its oscillating part's integral."""
        k, half = self._k, self.rotation_number / 2
        size = 4 * (len(k) + 1)  # the product of two series of degree n has degree 2n: exact
        psi = np.arange(size) * (2 * math.pi / size)
        jump = 2 * np.cos(np.multiply.outer(psi + half, k)) @ (self.sines * np.sin(k * half))
        stretch = 1 + np.cos(np.multiply.outer(psi, k)) @ (k * self.sines)
        product = np.fft.rfft((2 * half + jump) / (2 * self.omega) * stretch) / size
        harmonics = np.arange(1, 2 * len(k) + 1)
        return float(product[0].real), product[1 : 2 * len(k) + 1] / (1j * harmonics)


def invariant_circle(
    omega: float,
    epsilon: float,
    nodes: int = 32,
    max_nodes: int = 4096,
    start: InvariantCircle | None = None,
) -> InvariantCircle:
    r"""The exact periodic wave-less state of the string driven by Z(τ) = 1 + ε cos Ωτ.

    Parameters
    ----------
    omega
        Ω > 0; with ε ≠ 0 not a linear resonance pπ.
    epsilon
        ε, of either sign (ε → −ε shifts the time by half a period).
    nodes, max_nodes
        Powers of two, M to begin with and M to give up at.
    start
        A circle at nearby parameters to begin from, instead of the linear response.

    Returns
    -------
    InvariantCircle
        With status ``CONVERGED``. Force and mean height hold to rounding; b_k is then good to
        about 2⁻⁵² K/(4 sin²(kϱ/2)), the small divisors of a nearby resonance.

    Raises
    ------
    InputError
        Ω or ε is not what is allowed.
    CircleNotFoundError
        There is no such state as far as M nodes can tell; carries the last iterate.

    Examples
    --------
    >>> state = invariant_circle(omega=0.83, epsilon=0.02)
    >>> f"{state.rotation_number - 2 * 0.83:.3e}"
    '-1.322e-04'
    >>> state.status.name, round(state.contact_speed, 6)
    ('CONVERGED', 0.009335)

    Source: the string with β = 0 reduces to the standard map; see the module's docstring.
    """
    omega, epsilon = _check_input(omega, epsilon)
    _check_nodes(nodes, max_nodes)
    strength = 2 * epsilon * omega**2
    if abs(strength) >= NO_CIRCLE:
        raise CircleNotFoundError(
            f"Omega = {omega!r}, epsilon = {epsilon!r} make K = 2εΩ² = {strength:.6g}; for "
            "|K| ≥ 63/64 no invariant circle exists at any Omega, and the string makes waves: take "
            f"|epsilon| < {NO_CIRCLE / (2 * omega**2):.6g}",
            None,
        )
    state = _solve(omega, epsilon, nodes, max_nodes, start)
    reached: InvariantCircle | None = None
    for pieces in (2, 4, 8):  # a linear predictor too far off: walk there from smaller ε
        if state.status is CircleStatus.CONVERGED:
            return state
        for i in range(1, pieces):
            step = _solve(omega, epsilon * i / pieces, nodes, max_nodes, reached)
            if step.status is CircleStatus.CONVERGED:
                reached = step
        state = _solve(omega, epsilon, nodes, max_nodes, reached)
    if state.status is not CircleStatus.CONVERGED:
        raise CircleNotFoundError(
            f"no invariant circle found at Omega = {omega!r}, epsilon = {epsilon!r} with up to "
            f"{max_nodes} nodes (K = {strength:.6g}; residual {state.residuals[-1]:.1e}): "
            f"{state.status.value}. Take a smaller |epsilon| or move Omega away from the nearest "
            "resonance pπ/q with small q; close to the break-up itself, raise max_nodes",
            state,
        )
    return state


def _solve(
    omega: float,
    epsilon: float,
    nodes: int,
    max_nodes: int,
    start: InvariantCircle | None = None,
) -> InvariantCircle:
    """Newton's iteration on nodes, 2 nodes, … until the force is resolved."""
    strength = 2 * epsilon * omega**2
    if start is None:
        sines = np.array([strength / (4 * math.sin(omega) ** 2)]) if epsilon else np.zeros(1)
        guess, rotation = sines, 2 * omega
        for _ in range(3):  # ϱ to O(ε²), which keeps it off the resonances next to 2Ω
            height = _height(_Grid(nodes).from_sines(sines), rotation, omega, epsilon)
            rotation -= height[0] / height[1]
    else:
        guess, rotation = start.sines, start.rotation_number
        while nodes < max_nodes and nodes // 3 < len(guess):
            nodes *= 2
    sines, history = guess, []
    while True:
        grid = _Grid(nodes)
        c, rho, residuals, status = _newton(grid, grid.from_sines(sines), rotation, omega, epsilon)
        history += residuals
        force = np.abs(grid.coefficients(np.sin(grid.psi + grid.values(c))))
        # Rounding puts about one unit into every coefficient of sin φ; 8 leave the FFT room.
        heard = np.nonzero(force[1:-1] > 8 * EPS)[0]
        last = int(heard[-1]) + 1 if epsilon and len(heard) else 0
        resolved = last <= nodes // 3
        if status is CircleStatus.CONVERGED and not resolved:
            status = CircleStatus.UNRESOLVED
        kept = np.array(-2 * c.imag[1 : (last if resolved else nodes // 2 - 1) + 1])
        state = InvariantCircle(omega, epsilon, rho, kept, nodes, status, tuple(history))
        if status is CircleStatus.CONVERGED or 2 * nodes > max_nodes:
            return state
        if status is CircleStatus.UNRESOLVED:
            sines, rotation = kept, rho
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


def _height(c: Array, rho: float, omega: float, epsilon: float) -> tuple[float, float, Array]:
    """4Ω² times the mean-height equation, its derivative in ϱ, and in the c_k (as a weight).

    ϱ² + 2ϱ Σ k sin(kϱ) |c_k|² − Σ 4 sin²(kϱ/2) |c_k|² = 4Ω² (1 + ε ⟨cos φ⟩), sums over all k ≠ 0.
    """
    grid = _Grid(2 * (len(c) - 1))
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
    return value, slope, weight + 8 * omega**2 * epsilon * sine


def _newton(
    grid: _Grid, c: Array, rho: float, omega: float, epsilon: float
) -> tuple[Array, float, list[float], CircleStatus]:
    """Iterate until the residual no longer falls; converged if it is rounding by then."""
    k, strength = grid.k, 2 * epsilon * omega**2
    best: tuple[float, Array, float] | None = None
    history: list[float] = []
    # Rounding of the residual: a few units from sin φ, a unit from each sum of log₂ M terms.
    tolerance = (16 + 2 * math.log2(grid.nodes)) * EPS
    status = CircleStatus.STALLED
    for _ in range(40):
        force = grid.odd(grid.coefficients(np.sin(grid.psi + grid.values(c))))
        defect = -4 * np.sin(k * rho / 2) ** 2 * c + strength * force
        height, height_rho, weight = _height(c, rho, omega, epsilon)
        scale = abs(strength) if strength else 1.0
        residual = max(float(np.abs(defect).max()) / scale, abs(height) / (4 * omega**2))
        history.append(residual)
        stretch = 1 + grid.values(1j * k * c)
        if stretch.min() <= 0:
            status = CircleStatus.FOLDED
        if not np.isfinite(residual) or stretch.min() <= 0:
            break
        if best is not None and residual > best[0] / 2:
            break
        best = (residual, c, rho)
        step = _linear_solve(grid, stretch, rho, -defect)
        turn = _linear_solve(grid, stretch, rho, 2 * k * np.sin(k * rho) * c)
        change = -(height + float(weight @ step.imag)) / (height_rho + float(weight @ turn.imag))
        c, rho = c + step + change * turn, rho + change
    if best is None:
        return c, rho, history, status
    if best[0] <= tolerance:
        status = CircleStatus.CONVERGED
    return best[1], best[2], history, status


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


def _invert(y: ArrayLike, a: Array) -> Array:
    """x with x + Σ a_k sin kx = y, the left side increasing: Newton kept inside a bracket."""
    y = np.asarray(y, float)
    k = np.arange(1, len(a) + 1)
    reach = float(np.abs(a).sum())
    low, high, x = y - reach, y + reach, np.array(y)
    # Rounding of the left side; the bracket halves whenever Newton leaves it, so 60 steps suffice.
    target = 4 * EPS * (float(np.abs(y).max(initial=1.0)) + reach)
    for _ in range(60):
        angles = np.multiply.outer(x, k)
        excess = x + np.sin(angles) @ a - y
        if (np.abs(excess) <= target).all():
            break
        low, high = np.where(excess < 0, x, low), np.where(excess > 0, x, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            trial = x - excess / (1 + np.cos(angles) @ (k * a))
        inside = (trial >= low) & (trial <= high)
        x = np.where(inside, trial, (low + high) / 2)
    return x


def _check_input(omega: float, epsilon: float) -> tuple[float, float]:
    try:
        values = float(omega), float(epsilon)
    except (TypeError, ValueError):
        raise InputError(
            f"Omega = {omega!r}, epsilon = {epsilon!r}: give two numbers, e.g. 2.2 and 0.02"
        ) from None
    if not math.isfinite(values[0]) or values[0] <= 0:
        raise InputError(
            f"Omega = {values[0]!r}; the dimensionless frequency ωx₀/c must be positive and finite"
        )
    if not math.isfinite(values[1]):
        raise InputError(f"epsilon = {values[1]!r}; the relative drive amplitude must be finite")
    # Closer than √eps half the digits of sin Ω are rounding, and no ε > 1e-16 has a circle.
    if values[1] and abs(math.sin(values[0])) <= math.sqrt(EPS) * max(1.0, values[0]):
        p = round(values[0] / math.pi)
        raise InputError(
            f"Omega = {values[0]!r} is numerically at the resonance p/q = {p}/1 (sin Omega = 0), "
            f"where any drive makes waves; move Omega away from {p}π, or take epsilon = 0"
        )
    return values


def _check_nodes(nodes: int, max_nodes: int) -> None:
    for name, value in (("nodes", nodes), ("max_nodes", max_nodes)):
        if not isinstance(value, int) or value < 8 or value & (value - 1):
            raise InputError(f"{name} = {value!r}; give a power of two ≥ 8, e.g. 32")
    if nodes > max_nodes:
        raise InputError(f"nodes = {nodes} exceeds max_nodes = {max_nodes}; swap them")
