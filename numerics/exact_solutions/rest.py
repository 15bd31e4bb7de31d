r"""The rope at rest, exactly: W_ξξ − βW_ξξξξ = 2 over ground; the paper's eq. (beam2).

W(0) = z, W_ξξ(0) = 0 (pinned) or W_ξ(0) = 0 (clamped), and W = W_ξ = W_ξξ = 0 at ξ₀. Next to a
point where rope meets ground, both this shape and the travelling pulse's are

.. math:: \frac{W}{h} = 2\sum_{n ≥ 0} s^n \Bigl(q \frac{y^{3+2n}}{(3+2n)!}
          − \frac{y^{4+2n}}{(4+2n)!}\Bigr) ,

y the distance from that point in the rope's own length: at rest s = 1 (hyperbolic functions), in
the pulse s = −1 (circular ones). The series serves where the closed form would cancel.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.problems.drive import non_negative, positive
from numerics.problems.problem import DrivenEnd

Array = NDArray[np.float64]


def static_contact_point(
    beta: float, driven_end: DrivenEnd | str = DrivenEnd.PINNED, height: float = 1.0
) -> float:
    r"""ξ₀, where the rope at rest meets the ground.

    With h = ξ₀/(2√β), the end at W(0) = 1,

    .. math:: 4βh(h − \tanh h) = 1 \text{ (pinned)}, \qquad
              2\sqrt{β}(h \coth h − 1) = 1 \text{ (clamped)} .

    An end at W(0) = z scales: ξ₀(β, z) = √z ξ₀(β/z, 1).

    Parameters
    ----------
    beta
        β ≥ 0; 0 is the string, ξ₀ = √z.
    driven_end
        A :class:`DrivenEnd` or its name.
    height
        z > 0.

    Raises
    ------
    InputError
        β < 0, z ≤ 0, or an unknown driven end.

    Examples
    --------
    >>> [round(static_contact_point(b), 8) for b in (0, 1e-4, 1e-3, 1e-2, 1e-1)]
    [1.0, 1.01005, 1.03212265, 1.10498407, 1.35384357]
    """
    end, height = DrivenEnd(driven_end), positive("height", height)
    stiffness = non_negative("beta", beta) / height
    if stiffness == 0:
        return math.sqrt(height)
    return 2 * math.sqrt(stiffness * height) * _half_length(stiffness, end)


def static_shape(
    xi: ArrayLike,
    beta: float,
    driven_end: DrivenEnd | str = DrivenEnd.PINNED,
    height: float = 1.0,
    order: int = 0,
) -> Array:
    r"""∂^order W(ξ) of the rope at rest; zero on the ground, ξ ≥ ξ₀.

    With y = (ξ₀ − ξ)/√β and L = ξ₀/√β,

    .. math:: \frac{W}{2β} = σ(\sinh y − y) − (\cosh y − 1 − \tfrac12 y^2), \qquad
              σ = \tanh \tfrac12 L \text{ or (clamped) } \frac{\sinh L − L}{\cosh L − 1} .

    The string is (√z − ξ)². An end at W(0) = z scales: W = z W₁(ξ/√z; β/z).

    Parameters
    ----------
    xi
        Positions ξ ≥ 0, any shape.
    beta, driven_end, height
        As for :func:`static_contact_point`.
    order
        Which derivative with respect to ξ.

    Raises
    ------
    InputError
        As for :func:`static_contact_point`; a position ξ < 0 or not a number; order < 0.

    Examples
    --------
    >>> static_shape([0.0, 0.5, 1.0, 2.0], 0.01).round(6)
    array([1.      , 0.264831, 0.003025, 0.      ])
    """
    start = static_contact_point(beta, driven_end, height)
    x = np.asarray(xi, dtype=float)
    if not np.all(x >= 0):
        raise InputError(f"xi = {np.min(x)!r}: the rope lies at ξ ≥ 0")
    check_order(order)
    distance = np.maximum(start - x, 0.0)
    if beta == 0:
        powers = (distance**2, -2 * distance, np.where(x < start, 2.0, 0.0))
        return powers[order] if order < 3 else np.zeros_like(x)
    width = math.sqrt(beta)
    slope, growing = _boundary_layer(start / width, DrivenEnd(driven_end))
    y = distance / width
    far = polynomial(y, slope, 1, order) - growing * np.exp(y - start / width)
    far -= (-1) ** order * (1 + slope) * np.exp(-y)
    value = np.where(y < 2, contact_series(np.minimum(y, 2.0), slope, 1, order), far)
    return np.where(x < start, beta * (-width) ** -order * value, 0.0)


def _half_length(beta: float, end: DrivenEnd) -> float:
    """h = ξ₀/(2√β) for an end at height 1, to a few roundings for all β."""
    from scipy.optimize import brentq

    pinned, root = end is DrivenEnd.PINNED, math.sqrt(beta)

    def excess(h: float) -> float:
        t = _coth_excess(h)
        return (
            math.log(4 * h * h * t / (1 + t)) + math.log(beta) if pinned else math.log(2 * root * t)
        )

    # h − 1 < t < h and t ≤ h²/3, and h − 1 ≤ h − tanh h ≤ min(h, h³/3); widened by a little.
    low = max(0.5 / root, (0.75 / beta) ** 0.25 if pinned else math.sqrt(1.5 / root))
    high = 0.5 * (1 + math.hypot(1, 1 / root)) if pinned else 1 + 0.5 / root
    return float(brentq(excess, low * (1 - 1e-9), high * (1 + 1e-9), xtol=1e-300, rtol=1e-15))


def _coth_excess(h: float) -> float:
    """t = h coth h − 1, without cancellation: below 1 from the series of h cosh h − sinh h."""
    if h > 1:
        return h / math.tanh(h) - 1
    terms = (2 * k * h ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(10, 0, -1))
    return sum(terms) / math.sinh(h)


def _boundary_layer(length: float, end: DrivenEnd) -> tuple[float, float]:
    """σ, and γ = (1 − σ)e^L without overflow."""
    decay = math.exp(-length)
    if end is DrivenEnd.PINNED:
        return math.tanh(length / 2), 2 / (1 + decay)
    growing = 2 * (length + math.expm1(-length)) / math.expm1(-length) ** 2
    if length > 2:
        return 1 - growing * decay, growing
    tail = sum(length ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(14, 0, -1))
    return tail / (2 * math.sinh(length / 2) ** 2), growing


def check_order(order: int) -> None:
    """An order of differentiation, or an :class:`InputError`."""
    if not isinstance(order, int) or order < 0:
        raise InputError(f"order = {order!r}: give the order of the derivative, 0, 1, 2, …")


def polynomial(y: Array, q: float, sign: int, order: int) -> Array:
    """∂^order of the part s(y² − 2qy) + 2 that both shapes share."""
    if order > 2:
        return np.zeros_like(y)
    return sign * (y * y - 2 * q * y + 2 * sign, 2 * (y - q), np.full_like(y, 2.0))[order]


def contact_series(y: Array, q: float, sign: int, order: int) -> Array:
    """∂^order of the module's series for 0 ≤ y ≤ 2; what is left out is below 2⁻⁵³ of it."""
    total = np.zeros_like(y)
    for k in range(order + 26, max(order, 3) - 1, -1):
        coefficient = 2.0 * sign ** ((k - 3) // 2) * (q if k % 2 else -1.0)
        total += coefficient * y ** (k - order) / math.factorial(k - order)
    return total
