r"""Static shape of the rope with bending stiffness, in double precision.

The lifted part at rest solves (the paper's eq. beam2)

.. math:: ∂^2 W_0 − 2 − β ∂^4 W_0 = 0, \qquad W_0(0) = 1, \quad
          W_0 = ∂W_0 = ∂^2 W_0 = 0 \text{ at } ξ_0

with no moment (*pinned*, ∂²W₀ = 0) or no rotation (*clamped*, ∂W₀ = 0) at the driven end ξ = 0.
With h = ξ₀/(2√β) and t(h) = h coth h − 1 the two driven ends leave

.. math:: ξ_0^2 − 2\sqrt{β}\, ξ_0 \tanh h = ξ_0^2 \frac{t}{1 + t} = 1, \qquad
          ξ_0 \coth h − 2\sqrt{β} = 2\sqrt{β}\, t = 1 .

(Clamped, the height is the square of the left side, which is positive.) The forms with t do not
cancel at any h, so that ξ₀ has full precision for every 0 < β < ∞.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asymptotics.errors import InputError

Array = NDArray[np.float64]
DrivenEnd = Literal["pinned", "clamped"]
DRIVEN_ENDS: tuple[str, ...] = get_args(DrivenEnd)

_EPS = float(np.finfo(float).eps)


def check_driven_end(driven_end: Any) -> DrivenEnd:
    """``pinned`` or ``clamped``, or an :class:`InputError`."""
    if driven_end not in DRIVEN_ENDS:
        raise InputError(f"driven_end = {driven_end!r}; choose one of {', '.join(DRIVEN_ENDS)}")
    return driven_end


def check_stiffness(beta: Any, infinite: bool = False) -> Array:
    """β as an array of numbers 0 ≤ β < ∞ (≤ ∞ where ``infinite``), or an :class:`InputError`."""
    try:
        array = np.asarray(beta, dtype=float)
    except (TypeError, ValueError):
        raise InputError(
            f"beta = {beta!r} is not a number; give the bending stiffness B/(T x0^2), e.g. 0.01"
        ) from None
    for value in array.ravel()[~((array >= 0) & (infinite | np.isfinite(array))).ravel()]:
        advice = "; for its limit use stiff_limit" if value == math.inf else ""
        raise InputError(
            f"beta = {float(value)!r}; beta = B/(T x0^2) must be finite and not negative{advice}"
        )
    return array


def contact_point(beta: ArrayLike, driven_end: str = "pinned") -> Array:
    """The static contact point ξ₀(β) = x_c/x₀ at rest; see the module's docstring.

    Parameters
    ----------
    beta
        β = B/(T x₀²) ≥ 0, any shape; ∞ is allowed and gives ∞.
    driven_end
        ``pinned`` or ``clamped``.

    Returns
    -------
    Array
        ξ₀ in units of x₀, the shape of ``beta``; 1 at β = 0. For large β it is (12β)^{1/4} pinned,
        (36β)^{1/4} clamped.

    Raises
    ------
    InputError
        β negative or not a number; an unknown driven end.

    Examples
    --------
    >>> contact_point([0, 1e-4, 1e-3, 1e-2, 1e-1]).round(8)
    array([1.        , 1.01005   , 1.03212265, 1.10498407, 1.35384357])
    """
    pinned = check_driven_end(driven_end) == "pinned"
    flat = check_stiffness(beta, infinite=True)
    result = np.where(np.isinf(flat), np.inf, 1.0)
    inside = (flat > 0) & np.isfinite(flat)
    root = np.sqrt(flat[inside])

    def function(x: Array) -> tuple[Array, Array]:
        """log of the left side of the condition and its derivative: both are almost straight."""
        t, rate = _coth_excess(x / (2 * root))
        if pinned:
            return np.log(x * (x * (t / (1 + t)))), (2 + rate / (1 + t)) / x
        return np.log(2 * root * t), rate / x

    # 0 < t/(1 + t) ≤ h²/3, 0 < t ≤ h²/3, t ≥ h − 1 and tanh h ≤ 1; widened by a few roundings.
    power, scale = (12.0, 1.0) if pinned else (36.0, 2.0)
    low = np.maximum(1.0, power**0.25 * np.sqrt(root)) * (1 - 16 * _EPS)
    high = (root + np.hypot(1.0, root) if pinned else 1 + scale * root) * (1 + 16 * _EPS)

    result[inside] = bracketed_newton(function, low, high, np.minimum(high, low + root))
    return result


def boundary_slope(h: ArrayLike, driven_end: str) -> Array:
    r"""σ = −½√β ∂³W₀(ξ₀) from h = ξ₀/(2√β): tanh h or (clamped) t′ = coth h − h/sinh² h."""
    half = np.asarray(h, dtype=float)
    if check_driven_end(driven_end) == "pinned":
        return np.tanh(half)
    t, rate = _coth_excess(half)
    return t * rate / half


def _coth_excess(h: Array) -> tuple[Array, Array]:
    """t = h coth h − 1 and h t′/t, to a few roundings for all h > 0."""
    # Lambert's continued fraction of tanh, t = h²/(3 + h²/(5 + …)); for h ≤ 1 what follows the
    # partial denominator 17 changes t by less than 2⁻⁵³ of it. With h t′ = h² − t(1 + t), the
    # Riccati equation of coth, h t′/t = 2 + h²/(5 + …) − t.
    square = np.minimum(h, 1.0) ** 2
    rest = np.zeros_like(h)
    for odd in range(17, 3, -2):
        rest = square / (odd + rest)
    t = square / (3 + rest)
    large = np.maximum(h, 1.0)
    t_large = large / np.tanh(large) - 1
    e = np.exp(-large)
    rate_large = (1 + t_large - (2 * large * e / (1 - e * e)) ** 2) / t_large
    return np.where(h < 1, t, t_large), np.where(h < 1, 2 + rest - t, rate_large)


def bracketed_newton(
    function: Callable[[Array], tuple[Array, Array]], low: Array, high: Array, start: Array
) -> Array:
    """Roots of increasing functions by Newton's iteration, kept inside shrinking brackets.

    A step that leaves its bracket, or is not half the one before, is replaced by bisection. The
    iteration stops where the step or the bracket is 16 ulp: what is left is the function's own
    rounding.
    """
    x, before = start, high - low
    for _ in range(400):
        value, slope = function(x)
        low, high = np.where(value < 0, x, low), np.where(value > 0, x, high)
        step = value / slope
        size = 16 * _EPS * np.abs(x)
        done = (np.abs(step) <= size) | (high - low <= size)
        newton = (x - step >= low) & (x - step <= high) & (2 * np.abs(step) <= before)
        target = np.where(newton | (np.abs(step) <= size), x - step, 0.5 * (low + high))
        before, x = np.abs(target - x), target
        if np.all(done):
            return x
    raise ArithmeticError("the function is not increasing, or not a number, inside its bracket")


@dataclass(frozen=True)
class StaticShape:
    r"""W₀(ξ) and its derivatives.

    With y = (ξ₀ − ξ)/√β, ℓ = ξ₀/√β and h = ℓ/2,

    .. math:: W_0 = 2β [σ (\sinh y − y) − (\cosh y − 1 − y²/2)], \qquad
              σ = \tanh h \text{ or (clamped) } \coth h − h/\sinh^2 h ;

    evaluated with e^{−y} and γe^{y−ℓ}, 1 − σ = γe^{−ℓ}, which never overflow.

    Attributes
    ----------
    beta, driven_end
        Of which rope; β = 0 is the string, W₀ = (1 − ξ)².
    contact_point
        ξ₀ in units of x₀.
    contact_order
        m: the first derivative that is not zero at ξ₀, 3 with bending, 2 without.
    sigma, gamma
        σ and γ; 1 and 0 for the string.
    """

    beta: float
    driven_end: DrivenEnd
    contact_point: float
    contact_order: int
    sigma: float
    gamma: float

    def derivative(self, d: int) -> float:
        """a_d = ∂^d W₀(ξ₀): −2β^{1−d/2} for even d > 2, −2σβ^{1−d/2} for odd, 0 below 3.

        For the string a₂ = 2 is the only one that is not zero.

        >>> shape = static_shape(0.01)
        >>> [round(shape.derivative(d), 6) for d in (2, 3, 4, 5)]
        [0.0, -19.999364, -200.0, -1999.936442]
        """
        check_derivative(d)
        if self.beta == 0:
            return 2.0 if d == 2 else 0.0
        return -2 * (self.sigma if d % 2 else 1.0) * self.beta ** (1 - d / 2) if d > 2 else 0.0

    def profile(self, xi: ArrayLike, d: int = 0) -> Array:
        """∂^d W₀(ξ), 0 ≤ ξ ≤ ξ₀, in units of Z₀ and x₀; the shape of ``xi``.

        Raises
        ------
        InputError
            A position outside the lifted part, or d not a whole number ≥ 0.

        Examples
        --------
        >>> shape = static_shape(0.01)
        >>> shape.profile([0.0, 0.5, shape.contact_point]).round(6)
        array([1.      , 0.264831, 0.      ])
        """
        check_derivative(d)
        x = lifted_positions(xi, self.contact_point)
        if self.beta == 0:
            return ((1 - x) ** 2, 2 * (x - 1), np.full_like(x, 2.0))[d] if d < 3 else 0 * x
        root = math.sqrt(self.beta)
        y = (self.contact_point - x) / root
        length = self.contact_point / root
        rising = self.gamma * np.exp(y - length)
        falling = (1 + self.sigma) * np.exp(-y)
        waves = rising + (-1) ** d * falling
        polynomial = (y * y + 2 - 2 * self.sigma * y, 2 * (y - self.sigma), np.full_like(y, 2.0))
        far = (polynomial[d] if d < 3 else 0.0) - waves
        value = np.where(y < 3, self._near(np.minimum(y, 3.0), d), far)
        return (-1) ** d * self.beta ** (1 - d / 2) * value

    def _near(self, y: Array, d: int) -> Array:
        """∂_y^d W₀/β for y ≤ 3, where the closed form would cancel: by its power series.

        Terms through y³⁰/30! leave less than 2⁻⁵³ of the first one.
        """
        total = np.zeros_like(y)
        for k in range(d + 30, max(d, 3) - 1, -1):
            coefficient = 2 * (self.sigma if k % 2 else -1.0)
            total = total + coefficient * y ** (k - d) / math.factorial(k - d)
        return total


def static_shape(beta: float, driven_end: str = "pinned") -> StaticShape:
    """The static shape of one rope, 0 ≤ β < ∞.

    Raises
    ------
    InputError
        β negative, infinite or not a number; an unknown driven end.

    Examples
    --------
    >>> shape = static_shape(0.01, "clamped")
    >>> print(f"{shape.contact_point:.9f} {shape.derivative(3):.6f}")
    1.199985252 -19.997296
    """
    end = check_driven_end(driven_end)
    value = single_stiffness(beta)
    if value == 0:
        return StaticShape(value, end, 1.0, 2, 1.0, 0.0)
    place = float(contact_point(value, end))
    h = place / (2 * math.sqrt(value))
    sigma = float(boundary_slope(h, end))
    if end == "pinned":
        return StaticShape(value, end, place, 3, sigma, 2 / (1 + math.exp(-2 * h)))
    # γ = 2(2h − 1 + e^{−2h})/(1 − e^{−2h})²
    gamma = 2 * (2 * h + math.expm1(-2 * h)) / math.expm1(-2 * h) ** 2
    return StaticShape(value, end, place, 3, sigma, gamma)


def single_stiffness(beta: Any) -> float:
    """One number 0 ≤ β < ∞, or an :class:`InputError`."""
    array = check_stiffness(beta)
    if array.ndim:
        raise InputError(f"beta = {beta!r}; give one number here")
    return float(array)


def check_derivative(d: Any) -> None:
    """A whole number d ≥ 0, or an :class:`InputError`."""
    if isinstance(d, bool) or not isinstance(d, int) or d < 0:
        raise InputError(f"d = {d!r}; the order of a derivative is a whole number d >= 0")


def lifted_positions(xi: ArrayLike, end: float) -> Array:
    """ξ as an array when all of it is on the lifted part, or an :class:`InputError`."""
    try:
        x = np.asarray(xi, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"xi = {xi!r} is not an array of numbers") from None
    if not np.all((x >= 0) & (x <= end)):
        raise InputError(f"xi must lie on the lifted part, 0 <= xi <= xi_0 = {end!r}")
    return x
