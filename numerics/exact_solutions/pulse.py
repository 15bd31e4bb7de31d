"""The pulse that the rope with bending stiffness carries along the ground, exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.exact_solutions.rest import check_order, contact_series, polynomial
from numerics.problems.drive import finite, positive

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TravellingPulse:
    r"""A hump that runs along the ground faster than the waves of the string.

    W(ξ − cτ) with k = c² − 1 > 0, m = √(k/β), tan ϖ = ϖ, ℓ = ϖ/m: with z = m(ℓ − |ζ|),

    .. math:: W = \frac{ℓ^2 − ζ^2}{k} + \frac{2(\cos ϖ − \cos mζ)}{k m^2 \cos ϖ}
                = \frac{2β}{k^2}\bigl[ϖ(z − \sin z) − (\tfrac12 z^2 − 1 + \cos z)\bigr] .

    W = W′ = W″ = 0 at ±ℓ leaves only even shapes, one for each root ϖ > 0; ϖₙ has n humps and is
    positive inside. W‴ jumps by 2ϖ/√(βk) at **both** ends: each end presses on the ground with the
    point force 2ϖ√(β/k), half the weight in flight. R ≥ 0 and W_τ = 0 where R acts, so that all
    roots solve the unilateral problem without loss. For c ≤ 1 there is no pulse.

    Attributes
    ----------
    beta, speed, humps
        β > 0, c > 1 (in units of the string's wave speed) and n.
    root, half_length
        ϖₙ and ℓ.
    """

    beta: float
    speed: float
    humps: int = 1
    root: float = field(init=False)
    half_length: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "beta", positive("beta", self.beta))
        if finite("speed", self.speed) <= 1:
            raise InputError(f"speed = {self.speed!r}: the pulse is faster than waves, c > 1")
        if not isinstance(self.humps, int) or self.humps < 1:
            raise InputError(f"humps = {self.humps!r}: give their number, 1, 2, …")
        # tan ϖ = ϖ just below (n + ½)π; a contraction by 1/(1 + ϖ²).
        root = (self.humps + 0.5) * math.pi
        for _ in range(30):
            root = self.humps * math.pi + math.atan(root)
        object.__setattr__(self, "root", root)
        object.__setattr__(self, "half_length", root / self._wavenumber)

    @property
    def _excess(self) -> float:
        return (self.speed - 1) * (self.speed + 1)

    @property
    def _wavenumber(self) -> float:
        return math.sqrt(self._excess / self.beta)

    @property
    def height(self) -> float:
        """The highest point, for one hump at ζ = 0: β/k² [ϖ² + 2 − 2/cos ϖ]."""
        secant = (-1) ** self.humps * math.hypot(1, self.root)
        middle = self.root**2 + 2 - 2 * secant
        if self.humps % 2:
            return self.beta / self._excess**2 * middle
        # sin z = z/√(1 + ϖ²) has one root in (π/2, π): the hump next to the middle.
        from scipy.optimize import brentq

        ratio = math.hypot(1, self.root)
        z = brentq(lambda z: ratio * math.sin(z) - z, 0.5 * math.pi, math.pi, rtol=1e-15)
        return float(self.shape(z / self._wavenumber))

    @property
    def contact_force(self) -> float:
        """The point force 2ϖ√(β/k) of the ground on each end of the pulse, in units of TZ₀/x₀."""
        return 2 * self.root / self._wavenumber

    @property
    def _energy_unit(self) -> float:
        return self.root**3 * self.beta**1.5 / self._excess**3.5

    @property
    def kinetic_energy(self) -> float:
        """∫½W_τ² dξ = (10/3)c² ϖ³ β^{3/2} k^{−7/2}."""
        return 10 / 3 * self.speed**2 * self._energy_unit

    @property
    def potential_energy(self) -> float:
        """∫(½W_ξ² + ½βW_ξξ² + 2W) dξ = (10/3 + 14k/3) ϖ³ β^{3/2} k^{−7/2}."""
        return (10 + 14 * self._excess) / 3 * self._energy_unit

    @property
    def energy(self) -> float:
        """Kinetic and potential energy, in units of TZ₀²/x₀."""
        return self.kinetic_energy + self.potential_energy

    def shape(self, zeta: ArrayLike, order: int = 0) -> Array:
        """∂^order W at ζ = ξ − cτ; zero for |ζ| ≥ ℓ."""
        check_order(order)
        x = np.asarray(zeta, dtype=float)
        m, q = self._wavenumber, self.root
        y = m * np.maximum(self.half_length - np.abs(x), 0.0)
        turn = 0.5 * math.pi * order
        far = polynomial(y, q, -1, order) - 2 * (q * np.sin(y + turn) + np.cos(y + turn))
        near = contact_series(np.minimum(y, 2.0), q, -1, order)
        # Left of the middle y grows with ζ, right of it it falls.
        inward = np.where(x > 0, -m, m) ** order
        value = self.beta / self._excess**2 * inward * np.where(y < 2, near, far)
        return np.where(np.abs(x) < self.half_length, value, 0.0)

    def velocity(self, zeta: ArrayLike) -> Array:
        """W_τ = −cW′ at ζ = ξ − cτ."""
        return -self.speed * self.shape(zeta, 1)


def travelling_pulse(beta: float, speed: float, humps: int = 1) -> TravellingPulse:
    """The pulse of one speed; see :class:`TravellingPulse`.

    Raises
    ------
    InputError
        β ≤ 0, c ≤ 1, or a number of humps that is not 1, 2, …

    Examples
    --------
    >>> pulse = travelling_pulse(0.01, 1.5)
    >>> print(f"{pulse.root:.12f} {pulse.half_length:.9f} {pulse.height:.9f}")
    4.493409457909 0.401902760 0.200943400
    """
    return TravellingPulse(beta, speed, humps)
