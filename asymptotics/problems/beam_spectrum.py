r"""Linear spectrum of the rope with bending stiffness, in double precision.

Small vibrations φ(ξ) e^{iΩτ} of the lifted part solve (the paper's eq. beam2, linearised)

.. math:: β ∂^4 φ − ∂^2 φ = Ω^2 φ, \qquad φ(0) = 0, \quad φ = ∂φ = 0 \text{ at } ξ_0(β)

— the third contact condition only says how the contact point moves — with ∂²φ(0) = 0 (*pinned*) or
∂φ(0) = 0 (*clamped*). These Ω_n are where the linear response is infinite, eq. (resonance1) with
bending. With k²(1 + βk²) = Ω² and p² = k² + 1/β the modes are those of a beam under unit tension.
Seen from its middle a clamped–clamped beam has even and odd modes; a pinned–clamped one is half of
a clamped–clamped one of twice the length, with its odd modes only. With a the half length, u = ka
and v = pa = √(u² + a²/β), ∂φ = 0 at the contact point reads

.. math:: \text{odd: } u \cot u = v \coth v, \qquad \text{even: } u \tan u = −v \tanh v.

On every branch of cot and tan the left side is monotone and takes all values that the right side
can have, and the right side is monotone in the other direction: **one root on each branch and no
other** (none before the first pole, where u cot u < 1 < v coth v and u tan u > 0), so that none can
be missed. Written u = c + arctan g, g = (u/v) tanh v or (u/v) coth v, with c = nπ (pinned) or nπ/2
(clamped), root n lies in (c, c + π/2), and Ω_n(β) is finite from β = 0 (nπ) to β = ∞.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asymptotics.errors import InputError
from asymptotics.problems.static_shape import (
    Array,
    DrivenEnd,
    bracketed_newton,
    check_derivative,
    check_driven_end,
    check_stiffness,
    contact_point,
    lifted_positions,
    single_stiffness,
)

# Roots asked for at once: a bound on memory, far beyond what a beam equation describes.
_MOST = 100_000
_OVERFLOWING_SQUARE = 1e300


def check_count(count: Any) -> int:
    """How many resonances: a whole number 1 ≤ count ≤ 100000, or an :class:`InputError`."""
    if isinstance(count, bool) or not hasattr(count, "__index__"):
        raise InputError(f"count = {count!r} is not a whole number; give count >= 1")
    value = int(count.__index__())
    if not 1 <= value <= _MOST:
        raise InputError(f"count = {value}; give a whole number from 1 to {_MOST}")
    return value


def wavenumbers(stretch: ArrayLike, count: int, driven_end: str = "pinned") -> Array:
    r"""k_n ξ₀, n = 1 … count, of a beam under tension whose length is ``stretch`` boundary layers.

    Parameters
    ----------
    stretch
        z = ξ₀/√β from 0 (no tension: a beam) to ∞ (no stiffness: a string), any shape (…).
    count
        N ≥ 1.
    driven_end
        ``pinned`` or ``clamped``; the other end is clamped.

    Returns
    -------
    Array
        Shape (…, N); nπ < k_n ξ₀ < (n + ½)π pinned, < (n + 1)π clamped.

    Raises
    ------
    InputError
        z negative or not a number, a bad count, an unknown driven end.

    Examples
    --------
    >>> wavenumbers([0.0, np.inf], 2).round(6)      # tan x = tanh x, and nπ
    array([[3.926602, 7.068583],
           [3.141593, 6.283185]])
    """
    pinned = check_driven_end(driven_end) == "pinned"
    n = np.arange(1, check_count(count) + 1)
    z = np.asarray(stretch, dtype=float)[..., None]
    if not np.all(z >= 0):
        raise InputError(f"stretch = {stretch!r}; give xi_0/sqrt(beta) >= 0")
    half = z if pinned else z / 2
    odd = np.full(n.shape, True) if pinned else n % 2 == 0
    base = n * np.pi if pinned else n * (np.pi / 2)
    # v = ∞ is harmless in g, but not in its derivative; beyond 1e300 g is zero or one to rounding.
    half = np.minimum(half, _OVERFLOWING_SQUARE)

    def function(u: Array) -> tuple[Array, Array]:
        """u − c − arctan g and its derivative."""
        v = np.hypot(u, half)
        tanh = np.tanh(v)
        factor = np.where(odd, tanh, 1 / tanh)
        g = u / v * factor
        # d(tanh)/dv = 1 − tanh², d(coth)/dv = 1 − coth²; dv/du = u/v
        rate = (factor + u / v * u * ((1 - factor * factor) - factor / v)) / v
        return u - base - np.arctan(g), 1 - rate / (1 + g * g)

    shape = np.broadcast_shapes(half.shape, base.shape)
    low = np.broadcast_to(base, shape)
    start = low + np.arctan(low / np.hypot(low, half))
    roots = bracketed_newton(function, low, low + np.pi / 2, start)
    return roots if pinned else 2 * roots


def linear_frequencies(beta: ArrayLike, count: int, driven_end: str = "pinned") -> Array:
    r"""Ω₁(β) … Ω_N(β): the linear resonances in units of c/x₀, eq. (resonance1) with bending.

    .. math:: Ω_n = \frac{x_n}{ξ_0^2} \sqrt{ξ_0^2 + β x_n^2}, \qquad x_n = k_n ξ_0 .

    Since Ω = ω√(2Z₀/g), Ω_n/π is the frequency in units of √(g/8Z₀).

    Parameters
    ----------
    beta
        β ≥ 0, any shape (…); 0 gives nπ exactly as rounded, ∞ the finite limit x_n²/√12 (pinned) or
        x_n²/6 (clamped) of a beam without tension.
    count, driven_end
        As in :func:`wavenumbers`.

    Returns
    -------
    Array
        Shape (…, N), ascending in n.

    Raises
    ------
    InputError
        β negative or not a number, a bad count, an unknown driven end.

    Examples
    --------
    >>> linear_frequencies([0.0, 1e-3, 1e-2, np.inf], 3).round(4)
    array([[ 3.1416,  6.2832,  9.4248],
           [ 3.1546,  6.3961,  9.807 ],
           [ 3.25  ,  7.1777, 12.2343],
           [ 4.4509, 14.4236, 30.0937]])
    """
    stiffness = check_stiffness(beta, infinite=True)
    place = contact_point(stiffness, driven_end)
    string, beam = stiffness == 0, np.isinf(stiffness)
    between = ~(string | beam)
    stretch = np.where(string, np.inf, 0.0)
    stretch[between] = place[between] / np.sqrt(stiffness[between])
    x = wavenumbers(stretch, count, driven_end)
    limit = x * x / math.sqrt(12.0 if driven_end == "pinned" else 36.0)
    length = np.where(beam, 1.0, place)[..., None]
    root = np.where(beam, 1.0, np.sqrt(stiffness))[..., None]
    omega = np.where(beam[..., None], limit, x / length * np.hypot(1.0, root * x / length))
    n = np.arange(1, x.shape[-1] + 1)
    return np.where(string[..., None], n * np.pi, omega)


def stiffness_of(omega: float, n: int = 1, driven_end: str = "pinned") -> float:
    """The β at which Ω_n(β) = Ω, by bisection in log β; Ω_n increases with β.

    Raises
    ------
    InputError
        Ω outside the range of Ω_n, nπ ≤ Ω < Ω_n(∞), or not a number.

    Examples
    --------
    >>> f"{stiffness_of(3.2):.6f}", f"{stiffness_of(6.4, 2):.6f}"      # the paper's Fig. 2
    ('0.004931', '0.001036')
    """
    n = check_count(n)
    lowest, highest = n * math.pi, float(linear_frequencies(math.inf, n, driven_end)[-1])
    if not (isinstance(omega, int | float) and lowest <= omega < highest):
        raise InputError(
            f"Omega = {omega!r} is not a linear resonance number {n} of any {driven_end} rope; "
            f"they lie in {lowest:.6g} <= Omega < {highest:.6g}"
        )
    if omega == lowest:
        return 0.0
    # Ω_n − nπ is below one ulp at e^{−90}, and Ω_n(∞) − Ω_n at e^{90}.
    low, high = -90.0, 90.0
    while high - low > 8 * float(np.finfo(float).eps) * max(1.0, abs(low)):
        middle = 0.5 * (low + high)
        if float(linear_frequencies(math.exp(middle), n, driven_end)[-1]) < omega:
            low = middle
        else:
            high = middle
    return math.exp(0.5 * (low + high))


@dataclass(frozen=True)
class Spectrum:
    """The linear resonances of one rope and their mode shapes.

    Attributes
    ----------
    beta, driven_end, contact_point
        Which rope, and the length ξ₀ of its lifted part in units of x₀.
    omega
        Ω_n, n = 1 … N, ascending.
    wavenumber
        k_n in units of 1/x₀.
    """

    beta: float
    driven_end: DrivenEnd
    contact_point: float
    omega: tuple[float, ...]
    wavenumber: tuple[float, ...]

    def mode(self, n: int, xi: ArrayLike, d: int = 0) -> Array:
        r"""∂^d φ_n(ξ), 0 ≤ ξ ≤ ξ₀, its trigonometric part of unit amplitude; sin nπξ as β → 0.

        With X measured from the middle of the (doubled) beam, φ = sin kX − sin u sinh pX/sinh v or
        cos kX − cos u cosh pX/cosh v, the hyperbolic quotients in decaying exponentials.

        Raises
        ------
        InputError
            n not in 1 … N, a position outside the lifted part, d not a whole number ≥ 0.

        Examples
        --------
        >>> spectrum = linear_spectrum(0.01, 2)
        >>> spectrum.mode(1, [0.0, 0.5, spectrum.contact_point]).round(6) + 0.0
        array([0.      , 1.000327, 0.      ])
        """
        check_derivative(d)
        if not 1 <= check_count(n) <= len(self.omega):
            raise InputError(f"n = {n}; this spectrum holds n = 1 ... {len(self.omega)}")
        x, k = lifted_positions(xi, self.contact_point), self.wavenumber[n - 1]
        if self.beta == 0:
            return k**d * np.sin(k * x + d * np.pi / 2)
        pinned = self.driven_end == "pinned"
        half = self.contact_point if pinned else self.contact_point / 2
        place = x if pinned else x - half
        odd = pinned or n % 2 == 0
        # a cosine is a sine a quarter period on; the sign makes φ leave ξ = 0 upwards
        phase = 0.0 if odd else np.pi / 2
        sign = 1 if pinned else (-1) ** (n // 2)
        p = math.sqrt(k * k + 1 / self.beta)
        wave = k**d * np.sin(k * place + phase + d * np.pi / 2)
        edge = math.sin(k * half + phase)
        return sign * (wave - edge * p**d * _hyperbolic(p * place, p * half, odd, d))


def _hyperbolic(x: Array, v: float, odd: bool, d: int) -> Array:
    """The d-th derivative of sinh x/sinh v (odd) or cosh x/cosh v, |x| ≤ v, without overflow."""
    parity = -1 if odd else 1
    rising, falling = np.exp(x - v), np.exp(-x - v)
    return (rising + parity * (-1) ** d * falling) / (1 + parity * math.exp(-2 * v))


def linear_spectrum(beta: float, count: int, driven_end: str = "pinned") -> Spectrum:
    """The first ``count`` linear resonances of one rope, 0 ≤ β < ∞.

    Raises
    ------
    InputError
        β negative, infinite or not a number, a bad count, an unknown driven end.

    Examples
    --------
    >>> [round(value, 4) for value in linear_spectrum(0.01, 3, "clamped").omega]
    [3.2427, 7.0423, 11.7768]
    """
    end, value = check_driven_end(driven_end), single_stiffness(beta)
    place = float(contact_point(value, end))
    stretch = place / math.sqrt(value) if value else math.inf
    return Spectrum(
        value,
        end,
        place,
        tuple(linear_frequencies(value, count, end).tolist()),
        tuple((wavenumbers(stretch, count, end) / place).tolist()),
    )
