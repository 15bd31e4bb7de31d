r"""A periodic state of the string, evaluated: contact point, shape and speed from the circle.

The state is ϱ and :math:`U(ψ) = \sum_{k≥1} b_k \sin kψ`, which
:mod:`numerics.exact_string.invariant_circle` defines. On the circle :math:`Ωt = ψ + U(ψ)`, and the
characteristic that leaves ξ = 0 at the time t comes back at h(t), with ψ + ϱ in place of ψ.
Halfway, at χ = ψ + ϱ/2, it meets the contact point:

.. math:: Ωτ = χ + \sum_k b_k \cos(kϱ/2) \sin kχ, \qquad
          Ωξ_c = ϱ/2 + \sum_k b_k \sin(kϱ/2) \cos kχ .

So the contact point takes the inversion of an increasing function and a sum, and so do the two
travelling waves of the shape, with Ωt = ψ + U(ψ) inverted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError

Array = NDArray[Any]
EPS = 2.0**-52
# Exponentials held at once in a sum over harmonics and places.
_PRODUCTS = 2**20


class CircleStatus(Enum):
    """How the search ended."""

    CONVERGED = "converged: resolved to rounding"
    STALLED = "Newton's iteration did not converge"
    FOLDED = "the curve found is not a graph, |ξ_c′| ≥ 1 somewhere, so it is no circle"
    UNRESOLVED = "the Fourier series of the circle does not fit on the nodes allowed"


@dataclass(frozen=True, eq=False)
class InvariantCircle:
    """The periodic state at one (Ω, ε); ``invariant_circle`` finds it.

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
        >>> from numerics.exact_string.invariant_circle import invariant_circle
        >>> state = invariant_circle(omega=0.83, epsilon=0.02)
        >>> linear = 1 + 0.02 * 0.83 / 2 / np.sin(0.83)          # eq. (linresponse1) at τ = 0
        >>> bool(abs(state.contact(0.0) - linear) < 0.02**2)
        True
        """
        chi = _invert(self._phase(tau), self._middle)
        return (self.rotation_number / 2 + _cosines(chi, self._jumps)) / self.omega

    def contact_curve(self, size: int) -> tuple[Array, Array]:
        """τ and ξ_c at χ = 2πj/size, one period: all at once, where harmonics are many.

        ``size`` is raised to what the harmonics need.

        Examples
        --------
        >>> from numerics.exact_string.invariant_circle import invariant_circle
        >>> state = invariant_circle(omega=0.83, epsilon=0.02)
        >>> tau, xi = state.contact_curve(64)
        >>> bool(np.abs(state.contact(tau) - xi).max() < 1e-14)
        True
        """
        size = max(size, 2 * len(self.sines) + 2)
        chi = np.arange(size) * (2 * math.pi / size)
        tau = (chi + _on_grid(-1j * self._middle, size)) / self.omega
        return tau, (self.rotation_number / 2 + _on_grid(self._jumps, size)) / self.omega

    def shape(self, xi: ArrayLike, tau: ArrayLike) -> Array:
        """W(ξ, τ) in units of Z₀, by d'Alembert; 0 on the ground, ξ > ξ_c. Arguments broadcast.

        Raises
        ------
        InputError
            Some ξ is negative or not finite: the rope starts at ξ = 0.

        Examples
        --------
        >>> from numerics.exact_string.invariant_circle import invariant_circle
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
        size = 8 * len(k) + 32
        speed = _on_grid(-1j * numerator, size) / (1 + _on_grid(denominator, size))
        best, centre = float(np.abs(speed).max()), 2 * math.pi / size * int(np.abs(speed).argmax())
        width = 2 * math.pi / size
        while width > math.sqrt(EPS):  # a maximum is flat: √eps in place is eps in value
            chi = np.linspace(centre - width, centre + width, 33)
            speed = np.abs(_sines(chi, numerator) / (1 + _cosines(chi, denominator)))
            best, centre = max(best, float(speed.max())), float(chi[speed.argmax()])
            width /= 16
        return best

    @cached_property
    def graph_margin(self) -> float:
        """min l = min(1 + U′) over the nodes; positive on a circle, 0 where it breaks."""
        return float((1 + _on_grid(self._k * self.sines, 4 * max(self.nodes, 8))).min())

    @property
    def _k(self) -> Array:
        return np.arange(1, len(self.sines) + 1)

    @property
    def _middle(self) -> Array:
        """(U(ψ + ϱ) + U(ψ))/2 as a sine series in χ = ψ + ϱ/2."""
        return self.sines * np.cos(self._k * (self.rotation_number / 2))

    @property
    def _jumps(self) -> Array:
        """(U(ψ + ϱ) − U(ψ))/2 as a cosine series in χ = ψ + ϱ/2."""
        return self.sines * np.sin(self._k * (self.rotation_number / 2))

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
        return (mean * psi + 2 * _waves(psi, rest).real) / self.omega

    def _outgoing_slope(self, t: Array) -> Array:
        """f′(t) = (h(t) − t)/2."""
        psi, half = _invert(self.omega * t, self.sines), self.rotation_number / 2
        return (half + _cosines(psi + half, self._jumps)) / self.omega

    @cached_property
    def _primitive(self) -> tuple[float, Array]:
        """Mean of D (1 + U′), and the Fourier coefficients of its oscillating part's integral."""
        k, half = self._k, self.rotation_number / 2
        size = 4 * (len(k) + 1)  # the product of two series of degree n has degree 2n: exact
        jump = 2 * _on_grid(self._jumps * np.exp(1j * k * half), size)
        stretch = 1 + _on_grid(k * self.sines, size)
        product = np.fft.rfft((2 * half + jump) / (2 * self.omega) * stretch) / size
        harmonics = np.arange(1, 2 * len(k) + 1)
        return float(product[0].real), product[1 : 2 * len(k) + 1] / (1j * harmonics)


def _on_grid(a: Array, size: int) -> Array:
    """Re Σ a_k e^{ikψ} at ψ = 2πj/size, 0 ≤ j < size, for more than 2k nodes."""
    return np.fft.irfft(np.r_[0, np.asarray(a) / 2], size) * size


def _cosines(x: ArrayLike, a: Array) -> Array:
    """Σ a_k cos kx."""
    return _waves(x, a).real


def _sines(x: ArrayLike, a: Array) -> Array:
    """Σ a_k sin kx."""
    return _waves(x, a).imag


def _waves(x: ArrayLike, a: Array) -> Array:
    """Σ a_k e^{ikx}, by pieces of x: next to the break-up there are 10⁵ harmonics."""
    flat, k = np.ravel(x), np.arange(1, len(a) + 1)
    out = np.empty(flat.size, complex)
    piece = max(1, _PRODUCTS // max(1, len(a)))
    for i in range(0, flat.size, piece):
        out[i : i + piece] = np.exp(1j * np.multiply.outer(flat[i : i + piece], k)) @ a
    return out.reshape(np.shape(x))


def _invert(y: ArrayLike, a: Array) -> Array:
    """x with x + Σ a_k sin kx = y, the left side increasing: Newton kept inside a bracket."""
    y = np.asarray(y, float)
    k = np.arange(1, len(a) + 1)
    reach = float(np.abs(a).sum())
    low, high, x = y - reach, y + reach, np.array(y)
    # Rounding of the left side; the bracket halves whenever Newton leaves it, so 60 steps suffice.
    target = 4 * EPS * (float(np.abs(y).max(initial=1.0)) + reach)
    for _ in range(60):
        excess = x + _sines(x, a) - y
        if (np.abs(excess) <= target).all():
            break
        low, high = np.where(excess < 0, x, low), np.where(excess > 0, x, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            trial = x - excess / (1 + _cosines(x, k * a))
        inside = (trial >= low) & (trial <= high)
        x = np.where(inside, trial, (low + high) / 2)
    return x
