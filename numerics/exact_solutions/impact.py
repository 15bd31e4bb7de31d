r"""A string that strikes the ground with a smooth minimum: exact, by d'Alembert's waves.

The paper's rebound after eq. (grazing) takes the reaction of the ground to be
(1 + r)ρV δ(x − x*) δ(t − t*), which is short of a length: a piece of string of the length λ that
rebounds with restitution r receives (1 + r)ρVλ, and leaves behind a plateau of the height
½(1 + r)Vλ/c that widens at the speed c on either side. The paper's ½(1 + r)V x₀/c is λ = x₀; a
single node of a grid is λ = dx, and its plateau vanishes with the grid. This module finds the λ of
a smooth impact. Near the first touch, at ζ = ξ − ξ* = 0 and τ = 0, the string falls freely as

.. math:: W = \tfrac12 aζ^2 − Vτ + \tfrac12(a − 2)τ^2, \qquad κ = 1 − 2/a .

In the lengths V/a of x = aζ/V and t = aτ/V it strikes along x² = 2t − κt², at the front speed
U = (1 − κt)/x and with the velocity −V√(1 − κx²). As long as U > 1 no wave runs ahead, and each
point is struck in free fall. By momentum, a front that turns the velocity −v into rv leaves the
impulse (1 + r)v(1 − U⁻²) on a unit of length: all of it at the first instant, nothing once the
front has slowed down to the wave speed. That is, with S = √(1 + κ), at x = 1/S, t = 1/(S(S + 1)):

.. math:: I = (1 + r)Vλ, \qquad λ = \frac{2V}{a} J, \qquad
          J = ∫_0^{1/S} \frac{1 − S^2x^2}{\sqrt{1 − κx^2}}\, dx
            = \frac{1}{2κ}\Bigl[1 − (1 − κ)\frac{\arctan\sqrt{κ}}{\sqrt{κ}}\Bigr] ;

J = 2/3 at a = 2, a string that was curved as at rest, and ½ as a → ∞. So the plateau ½I grows as
V², not V. For r = 0 the string then stays on the ground over |ζ| < (V − (a − 2)τ)/a, carried,
until a > 2 lifts it off: its whole plateau is V²/(2(a − 2)), the depth that it would have reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.problems.drive import finite, positive

Array = NDArray[np.float64]


def point_plateau(velocity: float, restitution: float, length: float) -> float:
    """½(1 + r)Vλ, the height of the plateau left by a short piece λ of string that rebounds.

    W, V and λ in units of Z₀, Z₀c/x₀ and x₀; the paper's w* after eq. (grazing) is λ = 1.

    Raises
    ------
    InputError
        V or λ not positive, or r outside [0, 1].

    Examples
    --------
    >>> round(point_plateau(0.2, 0.5, 0.01), 9)
    0.0015
    """
    _check_restitution(restitution)
    return 0.5 * (1 + restitution) * positive("velocity", velocity) * positive("length", length)


@dataclass(frozen=True)
class StringImpact:
    """The impact of a smooth minimum of the string (β = 0); see the module.

    Attributes
    ----------
    velocity
        V > 0, the speed of fall at the first touch, in units of Z₀c/x₀.
    curvature
        a = W_ξξ > 1 there, in units of Z₀/x₀². At a ≤ 1 the front never slows down to the wave
        speed.
    restitution
        r, 0 ≤ r ≤ 1.

    Raises
    ------
    InputError
        A parameter outside its range.

    Examples
    --------
    >>> impact = StringImpact(velocity=0.3, curvature=2.0, restitution=0.0)
    >>> print(f"{impact.sonic_half_width:.3f} {impact.sonic_time:.3f} {impact.impulse:.3f}")
    0.150 0.075 0.060
    """

    velocity: float
    curvature: float
    restitution: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "velocity", positive("velocity", self.velocity))
        object.__setattr__(self, "curvature", finite("curvature", self.curvature))
        object.__setattr__(self, "restitution", _check_restitution(self.restitution))
        if self.curvature <= 1:
            raise InputError(
                f"curvature = {self.curvature!r}: give W_ξξ > 1; else the front never slows down "
                "to the wave speed"
            )

    @property
    def _kappa(self) -> float:
        return 1 - 2 / self.curvature

    @property
    def _s(self) -> float:
        return math.sqrt(1 + self._kappa)

    @property
    def scale(self) -> float:
        """V/a, the unit of length and time of the impact; heights scale with V²/a."""
        return self.velocity / self.curvature

    @property
    def sonic_half_width(self) -> float:
        """Where the front has slowed down to the wave speed: V/√(2a(a − 1)); V/a at a = 2."""
        return self.scale / self._s

    @property
    def sonic_time(self) -> float:
        """When: (V/a)/(S(S + 1)); V/(2a) at a = 2."""
        return self.scale / (self._s * (self._s + 1))

    @property
    def rebound_length(self) -> float:
        """λ = 2JV/a, the length that belongs into the paper's rebound."""
        return 2 * self.scale * float(self._density_integral(np.array(1 / self._s)))

    @property
    def impulse(self) -> float:
        """I = (1 + r)Vλ, left by the ground while the front is faster than the waves."""
        return (1 + self.restitution) * self.velocity * self.rebound_length

    @property
    def plateau(self) -> float:
        """½I, by which that impulse lifts the string, in the end, above its free fall."""
        return 0.5 * self.impulse

    @property
    def depth(self) -> float:
        """V²/(2(a − 2)), how deep the string would have fallen; ∞ for a ≤ 2, where it sinks on."""
        excess = self.curvature - 2
        return 0.5 * self.velocity**2 / excess if excess > 0 else math.inf

    def free_fall(self, zeta: ArrayLike, tau: ArrayLike) -> Array:
        """½aζ² − Vτ + ½(a − 2)τ², the string if there were no ground."""
        place, time = np.asarray(zeta, dtype=float), np.asarray(tau, dtype=float)
        a = self.curvature
        return 0.5 * a * place**2 - self.velocity * time + 0.5 * (a - 2) * time**2

    def half_width(self, tau: ArrayLike) -> Array:
        """The half-width that has been struck, √((2Vτ − (a − 2)τ²)/a) up to the sonic time.

        After it, for r = 0, that of the part which rests on the ground, (V − (a − 2)τ)/a or zero;
        for r > 0 the string has left the ground and the half-width is zero. Zero before τ = 0.
        """
        t = np.asarray(tau, dtype=float) / self.scale
        kappa, end = self._kappa, self.sonic_time / self.scale
        striking = np.sqrt(np.clip(2 * t - kappa * t * t, 0, None))
        resting = np.maximum(1 - kappa * t, 0.0) if self.restitution == 0 else np.zeros_like(t)
        return self.scale * np.where(t <= end, np.where(t > 0, striking, 0.0), resting)

    def height(self, zeta: ArrayLike, tau: ArrayLike) -> Array:
        """W(ζ, τ): free fall and the waves of the impact, broadcast.

        For r > 0 this is the field of the first impact alone: it holds until it becomes negative
        somewhere, which is where its weight brings the string down again. For r = 0 it holds for
        all times.
        """
        x, t = np.broadcast_arrays(
            np.abs(np.asarray(zeta, dtype=float)) / self.scale,
            np.asarray(tau, dtype=float) / self.scale,
        )
        lift = self._sticking_lift(x, t) if self.restitution == 0 else self._rebound_lift(x, t)
        return self.free_fall(zeta, tau) + self.velocity * self.scale * lift

    def _rebound_lift(self, x: Array, t: Array) -> Array:
        """Half of the impulses in the past of (x, t), in units of V²/a."""
        right, left = (self._density_integral(self._struck_at(q)) for q in (t + x, t - x))
        return 0.5 * (1 + self.restitution) * np.maximum(right + left, 0.0)

    def _struck_at(self, q: Array) -> Array:
        """Where the characteristic t + x = q crosses the front; its ends for q beyond it."""
        s, kappa = self._s, self._kappa
        inside = np.clip(q, -1 / (s + 1), (2 + s) / (s * (s + 1)))
        root = np.sqrt(np.maximum(1 + (2 - kappa * inside) * inside, 0.0))
        return np.clip((root - 1 + kappa * inside) / (1 + kappa), -1 / s, 1 / s)

    def _density_integral(self, x: Array) -> Array:
        """∫₀ˣ (1 − S²y²)/√(1 − κy²) dy, an odd function; without cancellation near κ = 0."""
        from scipy.special import hyp2f1

        z = self._kappa * x * x
        first, third = hyp2f1(0.5, 0.5, 1.5, z), hyp2f1(0.5, 1.5, 2.5, z)
        return x * (first - (1 + self._kappa) * x * x / 3 * third)

    def _sticking_lift(self, x: Array, t: Array) -> Array:
        """For r = 0: what holds the string on the ground, and the waves that this sends out."""
        s, kappa = self._s, self._kappa
        edge = self.half_width(t * self.scale) / self.scale
        end = 1 / (s * (s + 1))
        # Waves leave the edge x = 1 − κt with u = t − x, until it closes at t = 1/κ.
        u = np.clip(t - x, -1 / (s + 1), 1 / kappa if kappa > 0 else np.inf)
        outgoing = 0.5 + u - 0.5 * kappa * ((u + 1) / s) ** 2
        held = -(0.5 * x * x - t + 0.5 * kappa * t * t)
        return np.where(x < edge, held, np.where(t > end, outgoing, 0.0))


def _check_restitution(restitution: float) -> float:
    r = finite("restitution", restitution)
    if not 0 <= r <= 1:
        raise InputError(f"restitution = {restitution!r}: give a number from 0 to 1")
    return r
