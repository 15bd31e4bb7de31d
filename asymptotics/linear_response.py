r"""The linear response of the contact point to any small motion of the driven end.

To first order w₁ = F(t − x/c) + G(t + x/c). With the shift E: f(t) ↦ f(t − x₀/c) and D = ∂_t the
driven end and the two contact conditions of the paper are linear equations over the commutative
ring ℚ(g, c)[E, E⁻¹, D]:

.. math:: F + G = ΔZ, \qquad E F + E^{-1} G = 0, \qquad -E D F + E^{-1} D G = -(g/c)\, x_1 .

:func:`eliminate` solves them by Cramer's rule and substitutes the solution back. What comes out,
(1 − E²) x₁ = (2c/g) E D ΔZ, is eq. (linear); on ΔZ = e^{iωt}, where E = e^{−iωx₀/c} and D = iω, it
is eq. (linresponse2).

In the units of the paper's eq. (beam2) — ξ₁ = x₁/x₀, τ = ct/x₀, ΔZ in units of Z₀ — the factor is
(2c/g) Z₀ (c/x₀)/x₀ = 1 by eq. (leading):

.. math:: ξ_1(τ) - ξ_1(τ - 2) = ΔZ'(τ - 1), \qquad
          ξ_1 = \frac{Ω}{2 \sin Ω} e^{iΩτ} \text{ for } ΔZ = e^{iΩτ}.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx
from numpy.typing import ArrayLike, NDArray

from asymptotics.closed_form import ClosedForm, symbols
from asymptotics.errors import InputError, ResonanceError

if TYPE_CHECKING:
    import sympy

_RING = fmpz_mpoly_ctx.get(["E", "D", "g", "c"], Ordering.lex)
_E, _D, _G, _C = _RING.gens()
_ONE, _ZERO = _RING.constant(1), _RING.constant(0)

_Row = tuple[fmpz_mpoly, ...]
_Matrix = tuple[_Row, ...]

# Beyond, doubles cannot tell a resonance from its neighbours: the bound of check_frequency.
_LARGEST = 1.0e6
# Evaluations of a drive's rate: about a minute.
_MOST = 10**9


@dataclass(frozen=True)
class Elimination:
    """F, G and x₁ as operators on ΔZ: ``determinant`` · unknown = operator · ΔZ.

    Attributes
    ----------
    determinant, forward, backward, contact
        Polynomials in E, D, g, c; the operators of F, G and x₁ in this order.
    residuals
        What the three conditions leave after substitution, times the determinant.
    difference
        (p, q) with p x₁ = q ΔZ, common factors removed: the paper's eq. (linear).
    """

    determinant: fmpz_mpoly
    forward: fmpz_mpoly
    backward: fmpz_mpoly
    contact: fmpz_mpoly
    residuals: tuple[fmpz_mpoly, fmpz_mpoly, fmpz_mpoly]
    difference: tuple[fmpz_mpoly, fmpz_mpoly]

    @property
    def holds(self) -> bool:
        """Whether the three residuals are identically zero and the solution is not empty."""
        return all(r.is_zero() for r in self.residuals) and not self.determinant.is_zero()

    def __str__(self) -> str:
        p, q = self.difference
        residuals = ", ".join(str(r) for r in self.residuals)
        verdict = "proved" if self.holds else "REFUTED"
        return f"({p}) x_1 = ({q}) DeltaZ: {verdict} (residuals {residuals})"


@cache
def eliminate() -> Elimination:
    """Eliminate d'Alembert's F and G: eq. (linear), exactly and proved by substitution.

    Dividing by 1 − E² is legitimate for a rope at rest before some time: there 1/(1 − E²) is the
    sum of E^{2k}, of which finitely many terms act.

    >>> print(eliminate())
    (-E^2*g + g) x_1 = (2*E*D*c) DeltaZ: proved (residuals 0, 0, 0)
    """
    # The three conditions, times 1, E and cE: rows of the unknowns (F, G, x₁), and ΔZ's factor.
    rows = (
        (_ONE, _ONE, _ZERO),
        (_E**2, _ONE, _ZERO),
        (-(_E**2) * _D * _C, _D * _C, _E * _G),
    )
    drive = (_ONE, _ZERO, _ZERO)
    determinant = _determinant(rows)
    forward, backward, contact = (_determinant(_replaced(rows, k, drive)) for k in range(3))
    first, second, third = (
        row[0] * forward + row[1] * backward + row[2] * contact - r * determinant
        for row, r in zip(rows, drive, strict=True)
    )
    common = determinant.gcd(contact)
    return Elimination(
        determinant,
        forward,
        backward,
        contact,
        residuals=(first, second, third),
        difference=(determinant / common, contact / common),
    )


def _replaced(rows: _Matrix, column: int, values: _Row) -> _Matrix:
    return tuple(
        (*row[:column], value, *row[column + 1 :]) for row, value in zip(rows, values, strict=True)
    )


def _determinant(rows: _Matrix) -> fmpz_mpoly:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def difference_equation() -> sympy.Eq:
    """Eq. (linear) in physical units, from :func:`eliminate`.

    The symbols are t, g, c, x_0 and the functions x_1, DeltaZ; ε ΔZ(t) is the drive's deviation
    from Z₀, and ε x₁(t) the contact point's from x₀.

    >>> difference_equation()
    Eq(x_1(t) - x_1(t - 2*x_0/c), 2*c*Derivative(DeltaZ(t - x_0/c), t)/g)
    """
    import sympy

    t, g = sympy.symbols("t g")
    x_1, drive = sympy.Function("x_1"), sympy.Function("DeltaZ")
    left, right = eliminate().difference
    return sympy.Eq(_applied(left, x_1, t) / g, _applied(right, drive, t) / g).expand()


def _applied(operator: fmpz_mpoly, function: Any, t: Any) -> sympy.Expr:
    """Σ a E^k D^d g^m c^n, applied to a function of t."""
    import sympy

    g, c, x_0 = sympy.symbols("g c x_0")
    total = sympy.Integer(0)
    for powers, coefficient in operator.terms():
        k, d, m, n = (int(power) for power in powers)
        shifted = function(t - k * x_0 / c)
        total += (
            int(coefficient) * g**m * c**n * (sympy.Derivative(shifted, (t, d)) if d else shifted)
        )
    return total


def transfer_function() -> ClosedForm:
    """ξ₁ per unit of ΔZ/Z₀ = e^{iΩτ}: H = Ω/(2 sin Ω), eq. (linresponse2) over x₀.

    It is the ratio of the two operators of eq. (linear) at E = e^{−iΩ}, D = iΩ, in the units where
    g = 2 and c = 1 (x₀ = Z₀ = 1, so that 2c²Z₀/g = x₀² is eq. (leading)).

    >>> transfer_function().expression
    Omega/(2*sin(Omega))
    """
    import sympy

    omega = symbols()["Omega"]
    left, right = eliminate().difference

    # Both operators over E, the symmetric point of the delay: 1/E − E becomes 2i sin Ω.
    def at_frequency(operator: fmpz_mpoly) -> sympy.Expr:
        total = sympy.Integer(0)
        for powers, coefficient in operator.terms():
            k, d, m = (int(power) for power in powers[:3])
            phase = (k - 1) * omega
            shift = sympy.cos(phase) - sympy.I * sympy.sin(phase)
            total += int(coefficient) * shift * (sympy.I * omega) ** d * 2**m
        return sympy.expand(total)

    ratio = at_frequency(right) / at_frequency(left)
    return ClosedForm("xi_1/DeltaZ", ratio, "linresponse2", 1, "at Ω = pπ, p ≠ 0")


def harmonic_response() -> ClosedForm:
    """ξ₁(τ) for ΔZ/Z₀ = cos Ωτ: eq. (linresponse1) over x₀.

    >>> harmonic_response().expression
    Omega*cos(Omega*tau)/(2*sin(Omega))
    """
    import sympy

    names = symbols()
    # The transfer function is real, so the real part of H e^{iΩτ} is H cos Ωτ.
    expression = transfer_function().expression * sympy.cos(names["Omega"] * names["tau"])
    return ClosedForm("xi_1", expression, "linresponse1", 1, "at Ω = pπ")


def transfer(omega: ArrayLike) -> NDArray[Any]:
    """H(Ω) = Ω/(2 sin Ω), the amplitude of ξ₁ per unit amplitude of ΔZ/Z₀: eq. (linresponse2).

    Parameters
    ----------
    omega
        Ω = ωx₀/c, any shape, either sign; complex when the drive grows or decays. H(0) = 1/2, the
        static change of x₀ ∝ √Z₀.

    Returns
    -------
    numpy.ndarray
        Same shape, float64 or complex128.

    Raises
    ------
    InputError
        Not numbers, NaN or infinite, or beyond 10⁶ in size.
    ResonanceError
        Some Ω is at, or numerically at, pπ with p ≠ 0; the error names p/1.

    Examples
    --------
    >>> transfer([0.0, 1.0])
    array([0.5       , 0.59419755])
    """
    values = _numbers("omega", omega)
    if values.size and np.max(np.abs(values)) > _LARGEST:
        raise InputError(
            f"omega holds a number beyond {_LARGEST:g}, where double precision cannot tell a "
            "resonance from its neighbours; give smaller frequencies"
        )
    sine = np.sin(values)
    nearest = np.rint(values.real / math.pi)
    # As in check_frequency: any closer than √u and half the digits of sin Ω are rounding.
    bad = (nearest != 0) & (np.abs(sine) <= 2.0**-26 * np.maximum(1.0, np.abs(values)))
    if np.any(bad):
        p = abs(int(nearest[bad].flat[0]))
        raise ResonanceError(
            f"omega = {values[bad].flat[0]!s} is numerically at the resonance p/q = {p}/1 "
            f"(Omega = {p}π = {p * math.pi:.15g}), where the linear response is infinite; move "
            "omega away, or use contact_response for the growth in time",
            p,
            1,
        )
    result = np.full(values.shape, 0.5, dtype=values.dtype)
    np.divide(values, 2.0 * sine, out=result, where=values != 0)
    return result


def contact_response(rate: Callable[[NDArray[Any]], ArrayLike], tau: ArrayLike) -> NDArray[Any]:
    r"""ξ₁(τ) for any drive that starts from rest: eq. (linear) solved, without error.

    .. math:: ξ_1(τ) = \sum_{k ≥ 0} ΔZ'(τ - 1 - 2k), \qquad ΔZ' = 0 \text{ before } τ = 0

    A finite sum: it holds at resonance too.

    Parameters
    ----------
    rate
        ΔZ′(τ), the derivative of ΔZ/Z₀ in τ = ct/x₀; takes and returns arrays of one shape. It is
        asked at τ ≥ 0 only, the rope being at rest before.
    tau
        Times, any shape.

    Returns
    -------
    numpy.ndarray
        x₁/x₀ at these times, float64 or complex128, same shape.

    Raises
    ------
    InputError
        ``rate`` is not callable, or returns another shape or not finite numbers; ``tau`` is not
        real and finite; or the sum has more than 10⁹ terms.

    Examples
    --------
    A bump of ΔZ between τ = 0 and 1, seen at the contact point after its travel and each echo:

    >>> def rate(tau):
    ...     return np.where(tau < 1, np.pi * np.sin(2 * np.pi * tau), 0.0)
    >>> contact_response(rate, [0.5, 1.25, 2.5, 3.25]).round(6) + 0.0
    array([0.      , 3.141593, 0.      , 3.141593])
    """
    if not callable(rate):
        raise InputError(
            f"rate = {rate!r} is not callable; give the function τ ↦ ΔZ′(τ), arrays in and out"
        )
    times = _real("tau", tau)
    late = np.maximum(times + 1.0, 0.0) // 2.0  # how many echoes have arrived
    if np.sum(late) > _MOST:
        raise InputError(
            f"tau asks for {np.sum(late):.3g} echoes, more than {_MOST:g}; give fewer or earlier "
            "times, or use contact_response_spectrum"
        )
    # In the order of time each further echo reaches a shorter tail of the sorted times.
    order = np.argsort(times, axis=None)
    ordered = times.ravel()[order]
    total: NDArray[Any] = np.zeros(ordered.shape)
    for k in range(int(np.max(late, initial=0.0))):
        first = int(np.searchsorted(ordered, 1.0 + 2.0 * k))
        wanted = ordered[first:] - (1.0 + 2.0 * k)
        values = _numbers("rate(tau)", rate(wanted))
        if values.shape != wanted.shape:
            raise InputError(
                f"rate returned the shape {values.shape} for times of shape {wanted.shape}; it "
                "must work entry by entry"
            )
        total = total.astype(np.result_type(total, values), copy=False)
        total[first:] += values
    result = np.empty_like(total)
    result[order] = total
    return result.reshape(times.shape)


def contact_response_spectrum(
    frequencies: ArrayLike, amplitudes: ArrayLike, tau: ArrayLike
) -> NDArray[np.complex128]:
    """Eq. (linresponse2) as a sum: ξ₁ = Σ H(Ω_m) A_m e^{iΩ_m τ} for ΔZ/Z₀ = Σ A_m e^{iΩ_m τ}.

    Parameters
    ----------
    frequencies
        Ω_m, one-dimensional; complex ones shift the Fourier integral's contour.
    amplitudes
        A_m, same shape. A real drive has a partner −Ω_m with conj(A_m) for each Ω_m; or take the
        real part of the result.
    tau
        Real times, any shape.

    Returns
    -------
    numpy.ndarray
        x₁/x₀, complex128, the shape of ``tau``.

    Raises
    ------
    InputError
        Shapes differ, entries that are no finite numbers, or what :func:`transfer` refuses.
    ResonanceError
        Some Ω_m is at pπ.

    Examples
    --------
    >>> contact_response_spectrum([1.0, -1.0], [0.5, 0.5], [0.0]).real     # ΔZ = cos τ
    array([0.59419755])
    """
    omega, a = _numbers("frequencies", frequencies), _numbers("amplitudes", amplitudes)
    if omega.ndim != 1 or omega.shape != a.shape:
        raise InputError(
            f"frequencies have the shape {omega.shape}, amplitudes {a.shape}; give two "
            "one-dimensional lists of one length"
        )
    times = _real("tau", tau)
    weights = transfer(omega) * a
    result = np.zeros(times.shape, dtype=np.complex128)
    for frequency, weight in zip(omega, weights, strict=True):
        result += weight * np.exp(1j * frequency * times)
    return result


def _numbers(name: str, values: Any) -> NDArray[Any]:
    """An array of finite float64 or complex128."""
    try:
        array = np.asarray(values)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "iufc" and array.size:
        raise InputError(f"{name} = {values!r} is not an array of numbers")
    array = array.astype(np.complex128 if array.dtype.kind == "c" else np.float64)
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name} holds NaN or an infinity; all entries must be finite")
    return array


def _real(name: str, values: Any) -> NDArray[np.float64]:
    array = _numbers(name, values)
    if array.dtype.kind == "c":
        raise InputError(f"{name} is complex; give real times")
    return array
