r"""Periodic orbits of the standard map and Greene's residue.

An orbit of the type p/q, φ_{j+q} = φ_j + 2πp with

.. math:: φ_{j+1} − 2φ_j + φ_{j−1} = −K \sin φ_j,

is a motion of the string that repeats after p periods of the drive and q returns of its
characteristics. Of the two that every resonance has, the one through φ_0 = 0 is elliptic for small
K > 0. It is symmetric, φ_{−j} = −φ_j, so half of it is sought, as the deviation
:math:`u_j = φ_j − 2πpj/q` so that long orbits keep their digits: Newton's matrix is tridiagonal.

Its *residue* :math:`R = (2 − \mathrm{tr} M)/4`, M the tangent map once around, is between 0 and 1
where the orbit is elliptic. For p/q → ν it tends to 0 while the circle of ν lasts, and grows
without bound afterwards; at the break-up it settles (J. M. Greene, J. Math. Phys. 20 (1979) 1183).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import LinAlgError, solve_banded

from numerics.compiled import njit
from numerics.errors import InputError, OrbitNotFoundError
from numerics.exact_string.circle_newton import frequency
from numerics.exact_string.circle_state import EPS, Array

_MOST_STEPS = 40
# Steps in K from the integrable map, tried in turn; the orbit moves the more the larger K is.
_CONTINUED = (12, 48, 192)
# Longer ones have no digits of the residue left.
LONGEST = 10_000


@dataclass(frozen=True)
class PeriodicOrbit:
    """The symmetric orbit p/q through φ = 0 at K.

    Attributes
    ----------
    p, q, strength
        What was asked for, K = 2εΩ².
    deviations
        u_j = φ_j − 2πpj/q, 0 ≤ j < q.
    residue
        Greene's R.
    """

    p: int
    q: int
    strength: float
    deviations: Array = field(repr=False)
    residue: float

    @property
    def omega(self) -> float:
        """Ω from the mean height, the orbit taken for q points of a circle with ν = p/q."""
        order = np.argsort(np.arange(self.q) * self.p % self.q)
        c = np.fft.rfft(self.deviations[order]) / self.q
        turn = 2 * math.pi * self.p / self.q
        return frequency(c, self.q, turn, self.strength)


def periodic_orbit(
    p: int, q: int, strength: float, start: PeriodicOrbit | None = None
) -> PeriodicOrbit:
    """The symmetric p/q orbit through φ = 0, elliptic for small K.

    Parameters
    ----------
    p, q
        Coprime, p > 0, 3 ≤ q ≤ 10⁴.
    strength
        K > 0.
    start
        The same orbit at a near K to begin from, instead of continuing from K = 0.

    Raises
    ------
    InputError
        An argument is not what is allowed.
    OrbitNotFoundError
        Newton's iteration lost it.

    Examples
    --------
    >>> round(periodic_orbit(55, 89, 0.971653413793).residue, 8)
    0.25
    """
    if not all(isinstance(n, int) and n > 0 for n in (p, q)) or math.gcd(p, q) > 1:
        raise InputError(f"p/q = {p!r}/{q!r}; give coprime whole numbers p > 0, q ≥ 3")
    if not 3 <= q <= LONGEST:
        raise InputError(f"q = {q}; give 3 ≤ q ≤ {LONGEST}")
    if not isinstance(strength, int | float) or not 0 < strength < math.inf:
        raise InputError(f"strength = {strength!r}; K must be positive and finite")
    psi = 2 * math.pi * ((p * np.arange(1, (q + 1) // 2)) % q / q)
    half = None if start is None else _solve(start.deviations[1 : len(psi) + 1], psi, q, strength)
    for steps in _CONTINUED:
        if half is None:
            half = _from_zero(psi, q, strength, steps)
    if half is None:
        raise OrbitNotFoundError(
            f"the orbit {p}/{q} was lost before K = {strength!r}; take a smaller K or a shorter "
            "orbit"
        )
    mirrored = -half[::-1]
    middle = [] if q % 2 else [0.0]
    deviations = np.r_[0.0, half, middle, mirrored]
    phases = 2 * math.pi * ((p * np.arange(q)) % q / q) + deviations
    residue = (2 - tangent_trace(strength * np.cos(phases))) / 4
    return PeriodicOrbit(p, q, float(strength), deviations, float(residue))


def _from_zero(psi: Array, q: int, strength: float, steps: int) -> Array | None:
    """By continuation in K, each step from the secant of the last two."""
    last, u = np.zeros_like(psi), np.zeros_like(psi)
    for step in range(1, steps + 1):
        found = _solve(2 * u - last, psi, q, strength * step / steps)
        if found is None:
            return None
        last, u = u, found
    return u


def _solve(u: Array, psi: Array, q: int, strength: float) -> Array | None:
    """Newton's iteration for u_1 … u_m, m = ⌊(q − 1)/2⌋, until the residual is rounding."""
    matrix = np.ones((3, len(u)))
    for _ in range(_MOST_STEPS):
        phases = psi + u
        # Beyond the last: u_{m+1} = −u_m (q odd), 0 (q even), by the symmetry.
        after = np.r_[u[1:], -u[-1] if q % 2 else 0.0]
        defect = after - 2 * u + np.r_[0.0, u[:-1]] + strength * np.sin(phases)
        # A unit from each of the five terms; 2u is the largest, the phase as large in the sine.
        terms = strength * (1 + 2 * math.pi) + 4 * float(np.abs(u).max())
        size = float(np.abs(defect).max())
        if size <= 2 * EPS * terms:
            return u
        if not math.isfinite(size):
            return None
        matrix[1] = -2 + strength * np.cos(phases)
        if q % 2:
            matrix[1, -1] -= 1
        try:
            u = u - solve_banded((1, 1), matrix, defect)
        except LinAlgError:
            return None
    return None


@njit(cache=True)
def tangent_trace(bends):  # type: ignore[no-untyped-def]
    """tr M of the tangent maps (φ, r) ↦ (φ + r − Kcos φ · φ, r − Kcos φ · φ), one after another."""
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    for bend in bends:
        a, b, c, d = a + c - bend * a, b + d - bend * b, c - bend * a, d - bend * b
    return a + d
