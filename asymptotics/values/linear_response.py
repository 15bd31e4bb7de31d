r"""The linear response of the contact point in numbers: arrays in, arrays out.

In the units of the paper's eq. (beam2) — ξ₁ = x₁/x₀, τ = ct/x₀, ΔZ in units of Z₀ —

.. math:: ξ_1(τ) - ξ_1(τ - 2) = ΔZ'(τ - 1), \qquad
          ξ_1 = H(Ω) e^{iΩτ} \text{ for } ΔZ = e^{iΩτ}, \quad H(Ω) = \frac{Ω}{2 \sin Ω}

as :mod:`asymptotics.formulas.linear_response` proves. :func:`contact_response` solves the first
equation for a drive that starts from rest, :func:`contact_response_spectrum` adds up the second
over a spectrum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asymptotics.errors import InputError, ResonanceError
from asymptotics.expansion.order_loop import expand
from asymptotics.problems.damped import damped_string
from asymptotics.problems.string import LARGEST_PHASE, RESOLUTION

# Beyond, doubles cannot tell a resonance from its neighbours: the bound of check_frequency.
_LARGEST = 1.0e6
# Evaluations of a drive's rate: about a minute.
_MOST = 10**9


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
    # H is even, and e^{−iΩ} overflows where Im Ω ≫ 1: there sin Ω is what e^{iΩ} makes of it.
    far = np.abs(values.imag) > 1.0
    sine = np.sin(np.where(far, 1.0, values))
    nearest = np.where(far, 0, np.rint(values.real / math.pi))
    # As in check_frequency: any closer than √u and half the digits of sin Ω are rounding.
    bad = (nearest != 0) & (np.abs(sine) <= RESOLUTION * np.maximum(1.0, np.abs(values)))
    if np.any(bad):
        p = abs(int(nearest[bad].flat[0]))
        raise ResonanceError(
            f"omega = {values[bad].flat[0]!s} is numerically at the resonance p/q = {p}/1 "
            f"(Omega = {p}π = {p * math.pi:.15g}), where the linear response is infinite; move "
            "omega away, or use contact_response for the growth in time",
            p,
            1,
        )
    result = np.full(values.shape, 0.5, dtype=values.dtype)  # H = 1/2 + Ω²/12 + …
    np.divide(values, 2.0 * sine, out=result, where=~far & (np.abs(values) > 2.0**-27))
    if far.any():
        upper = np.where(values[far].imag < 0, -values[far], values[far])
        result[far] = -1j * upper * np.exp(1j * upper) / (1.0 - np.exp(2j * upper))
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
        real and finite; or the sum has more than 10⁹ terms, or overflows.

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
            "times, or ask contact_response_spectrum for the state after the transient"
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
        with np.errstate(over="ignore", invalid="ignore"):
            total[first:] += values
    result = np.empty_like(total)
    result[order] = total
    return _finite(result).reshape(times.shape)


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
        Shapes differ, entries that are no finite numbers, or what :func:`transfer` refuses; a phase
        Ω_m τ beyond 2²⁷, which doubles do not resolve to half their digits; or a sum that
        overflows.
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
    with np.errstate(over="ignore", invalid="ignore"):
        for frequency, weight in zip(omega, weights, strict=True):
            _check_phase(frequency * times)
            result += weight * np.exp(1j * frequency * times)
    return _finite(result)


def _check_phase(phase: NDArray[Any]) -> None:
    largest = np.max(np.abs(phase.real), initial=0.0)
    if not largest <= LARGEST_PHASE:
        raise InputError(
            f"tau reaches the phase {largest:.3g}, beyond {LARGEST_PHASE:.3g}, where double "
            "precision does not resolve it; take whole periods off tau"
        )


def _finite(result: NDArray[Any]) -> NDArray[Any]:
    if not np.isfinite(result).all():
        raise InputError(
            "the response overflows double precision; give smaller amplitudes, or times at which a "
            "growing drive is smaller"
        )
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


def damped_response(omega: float, damping: float, viscosity: float = 0.0) -> complex:
    """X with ξ₁ = Re X e^{iΩτ} for ΔZ = cos Ωτ: X = k_1/(2 sin k_1), finite at every Ω.

    Raises
    ------
    InputError
        As :func:`asymptotics.problems.damped.damped_string`.

    Examples
    --------
    >>> import math
    >>> round(abs(damped_response(math.pi, 0.01)) * 0.01, 4)       # π/2
    1.5708
    """
    first: complex = expand(damped_string(omega, damping, viscosity), 1).contact(1)[1]
    return 2 * first
