r"""The rope with bending stiffness as a problem over numbers.

.. math:: W_{ττ} = W_{ξξ} − 2 − βW_{ξξξξ}, \qquad W(0, τ) = 1 + ε\cos Ωτ, \qquad
          W = W_ξ = W_{ξξ} = 0 \text{ at } ξ_c(τ)

(the paper's eq. beam2), with W_ξξ(0) = 0 (*pinned*, no moment applied) or W_ξ(0) = 0 (*clamped*).
Three conditions at the contact point, so m = 3: the contact data of a harmonic are w and w′ at the
static contact point ξ₀ = L, and the waves between them are in
:mod:`asymptotics.problems.beam_waves`. The small parameter is ε itself.

**Static shape.** With s = ξ − L and y = L/(2√β) the profile is
W₀ = s² + 2β(1 − cosh(s/√β)) + βa₃(√β sinh(s/√β) − s), and the driven end leaves

    pinned    4β y (y − tanh y) = 1,           a₃ = −(2/√β) tanh y
    clamped   2√β (y coth y − 1) = 1,          a₃ = −(2/√β) (coth y − y/sinh² y)

both convex and increasing in y, so that Newton's iteration from the right converges monotonically.
For β ≫ 1, y ≪ 1, the conditions and the clamped a₃ cancel by a factor y²: doubles take ξ₀ and a₃
from :mod:`asymptotics.problems.static_shape`, whose forms do not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems.beam_waves import (
    StaticBeam,
    Waves,
    end_residuals,
    static_end_residuals,
    waves,
)
from asymptotics.problems.problem import Mode, Problem, Sweep
from asymptotics.problems.static_shape import boundary_slope, check_driven_end, contact_point
from asymptotics.problems.string import RESOLUTION
from asymptotics.rings.bounded import Bounded, bounded
from asymptotics.rings.numbers import Numbers, balls, complex_balls, doubles
from asymptotics.rings.pickling import remembering


def check_beam(beta: Any, driven_end: str) -> str:
    """The driven end's name, when it and β are usable; β may be any number or an array.

    Raises
    ------
    InputError
        β is not a positive finite number, or the driven end is neither pinned nor clamped.
    """
    end = check_driven_end(driven_end)
    values = beta.ravel().tolist() if hasattr(beta, "ravel") else [beta]
    for value in values:
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise InputError(f"beta = {value!r} is not a number; give B/(T x0²) > 0") from None
        if not (math.isfinite(number) and number > 0):
            advice = "for β = 0 use the string" if number == 0 else "give B/(T x0²) > 0"
            raise InputError(f"beta = {number!r} is not positive and finite; {advice}")
    return end


def static_beam(
    beta: Any, driven_end: str = "pinned", numbers: Numbers | None = None
) -> StaticBeam:
    """The static contact point and shape.

    Parameters
    ----------
    beta
        β = B/(T x₀²) > 0: a number of the given kind, or an array.
    driven_end
        ``pinned``, W_ξξ(0) = 0, or ``clamped``, W_ξ(0) = 0.
    numbers
        One of :mod:`asymptotics.rings.numbers`'s; doubles by default.

    Raises
    ------
    InputError
        β is not positive and finite, or the driven end is unknown.

    Examples
    --------
    >>> [round(float(static_beam(beta).contact_point), 8) for beta in (1e-4, 1e-3, 1e-2, 1e-1)]
    [1.01005, 1.03212265, 1.10498407, 1.35384357]
    >>> round(float(static_beam(1e-2, "clamped").contact_point), 6)
    1.199985
    """
    check_beam(beta, driven_end)
    numbers = doubles() if numbers is None else numbers
    beta = numbers.convert(beta)
    root = numbers.sqrt(beta)
    if numbers.solve is None:
        place = contact_point(beta, driven_end)
        a3 = -2 / root * boundary_slope(place / (2 * root), driven_end)
        return StaticBeam(beta, driven_end, place[()], a3)
    if driven_end == "pinned":
        start = (1 + numbers.sqrt(1 + 1 / beta)) / 2
        y = numbers.solve(lambda y: _pinned_height(y, 1 / (4 * beta), numbers), start)
        a3 = -2 / root * _tanh(y, numbers)
    else:
        start = 1 + 1 / (2 * root)
        y = numbers.solve(lambda y: _clamped_height(y, 1 / (2 * root), numbers), start)
        a3 = -2 / root * _clamped_height(y, 0 * y, numbers)[1]
    return StaticBeam(beta, driven_end, 2 * root * y, a3)


def _tanh(y: Any, numbers: Numbers) -> Any:
    e = numbers.exp(-2 * y)
    return (1 - e) / (1 + e)


def _pinned_height(y: Any, target: Any, numbers: Numbers) -> tuple[Any, Any]:
    """y(y − tanh y) − target and its derivative."""
    t = _tanh(y, numbers)
    return y * (y - t) - target, 2 * y - t - y * (1 - t * t)


def _clamped_height(y: Any, target: Any, numbers: Numbers) -> tuple[Any, Any]:
    """y coth y − 1 − target and its derivative coth y − y/sinh² y."""
    e = numbers.exp(-2 * y)
    coth = (1 + e) / (1 - e)
    return y * coth - 1 - target, coth - 4 * y * e / ((1 - e) * (1 - e))


@remembering
def beam_problem(
    beta: Any,
    omega: Any,
    driven_end: str = "pinned",
    numbers: Numbers | None = None,
    static: StaticBeam | None = None,
) -> Problem[Any]:
    """The beam at given β and Ω, for :func:`asymptotics.expansion.order_loop.expand`.

    Parameters
    ----------
    beta, omega
        β > 0 and Ω = ωx₀/c: numbers of the given kind, or arrays that broadcast. Ω may be complex:
        then the expansion is the analytic continuation in Ω of the real one.
    driven_end
        ``pinned`` (default) or ``clamped``; the small parameter is ε.
    numbers
        One of :mod:`asymptotics.rings.numbers`'s. By default one β and Ω are expanded over balls
        and rounded to doubles (:mod:`asymptotics.expansion.rounded`); arrays in doubles with a
        bound of each number's error, and over balls at the points where that is large
        (:mod:`asymptotics.expansion.swept`).
    static
        The static shape, when already computed for this β.

    Raises
    ------
    InputError
        β, Ω or the driven end cannot be used. At a linear resonance a division by zero is left to
        the arithmetic: use :func:`float_beam` for checked double precision.

    Examples
    --------
    >>> from asymptotics import expand
    >>> solution = expand(beam_problem(0.01, 2.2), order=3)
    >>> {j: round(float(2 * c), 8) for j, c in solution.contact(3).items()}
    {3: -6.0428291, 1: -1.41119959}
    """
    if numbers is None:
        problem = beam_problem(beta, omega, driven_end, doubles(), static)
        if np.ndim(beta) == np.ndim(omega) == 0:
            return replace(problem, balls=enclosed(beta, omega, driven_end, beam_problem))
        return replace(problem, sweep=swept(beta, omega, driven_end, beam_problem))
    shape = static_beam(beta, driven_end, numbers) if static is None else static
    omega, beta, ring = numbers.convert(omega), shape.beta, numbers.ring

    @cache
    def wave(j: int) -> Waves:
        return waves(shape, j * omega if j else 0, numbers)

    @cache
    def mode(j: int) -> Mode[Any]:
        one, zero = ring.one, ring.zero
        columns = [wave(j).solve(*unit)[0] for unit in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        exact = [(one, zero), (zero, one), (zero, zero)]
        rows = [(*data, *column[2:]) for data, column in zip(exact, columns, strict=True)]
        stiffness = (j * omega) * (j * omega) / beta
        return Mode((stiffness, zero, 1 / beta, zero), (rows[0], rows[1]), rows[2])

    def equation_residual(j: int, w: Any) -> Any:
        return w[2] + (j * omega) * (j * omega) * w[0] - beta * w[4]

    return Problem(
        name=f"{driven_end} beam at beta = {_spelled(beta)}, Omega = {_spelled(omega)}",
        ring=ring,
        contact_order=3,
        static=cache(shape.derivative),
        static_reduction=(ring.zero, ring.zero, ring.zero, 1 / beta, ring.zero),
        mode=mode,
        drive={1: ring.rational(1, 2)},
        inverse_leading=1 / shape.a3,
        equation_residual=equation_residual,
        end_residual=lambda j, w: end_residuals(wave(j), w),
        end_unit=lambda j: (ring.one, ring.zero),
        load=(ring.rational(2),),
        static_end_residual=lambda a: static_end_residuals(shape, a, numbers),
        rest=shape.contact_point,
    )


def enclosed(beta: Any, omega: Any, driven_end: str, made: Callable[..., Any]) -> Callable[[], Any]:
    """What ``made``, called like :func:`beam_problem`, gives over balls of the doubles given.

    Ω may be complex: then the balls are, but for the static shape.
    """
    if not np.iscomplexobj(omega):
        return lambda: made(float(beta), float(omega), driven_end, balls(), None)

    def continued() -> Any:
        static = static_beam(float(beta), driven_end, balls())
        return made(float(beta), complex(omega), driven_end, complex_balls(), static)

    return continued


# To a few units in the last place, as the tests hold against digits; see static_shape.
_STATIC = 64 * 2.0**-53


def swept(beta: Any, omega: Any, driven_end: str, made: Callable[..., Any]) -> Sweep:
    """The same over bounded doubles for arrays, and at each of their points."""
    betas, omegas = np.broadcast_arrays(beta, omega)

    def bounded_doubles() -> Any:
        shape = static_beam(beta, driven_end)
        place, a3 = (Bounded(x, _STATIC * abs(x)) for x in (shape.contact_point, shape.a3))
        static = StaticBeam(Bounded(shape.beta), shape.driven_end, place, a3)
        return made(beta, omega, driven_end, bounded(), static)

    def at(index: int) -> Any:
        return made(betas.flat[index].item(), omegas.flat[index].item(), driven_end, None, None)

    return Sweep(betas.shape, bounded_doubles, at)


def _spelled(value: Any) -> str:
    """A number as it stands; an array by its ends and its size."""
    if np.ndim(value) == 0:
        return str(value)
    return f"{value.flat[0]} … {value.flat[-1]} ({value.size} values)"


@remembering
def float_beam(beta: float, omega: float, order: int, driven_end: str = "pinned") -> Problem[Any]:
    """The beam in double precision; refuses the resonances Ω_p(β)/q with q ≤ ``order``.

    The expansion is computed over balls and rounded, all digits right however small β is: see
    :mod:`asymptotics.expansion.rounded`.

    'Numerically at' means that the determinant of harmonic q is below √u of its terms, u = 2⁻⁵²:
    closer than that, half the digits of the impedances are rounding.

    Raises
    ------
    InputError
        β or Ω is not positive and finite, or the driven end is unknown.
    ResonanceError
        Ω is numerically at Ω_p(β)/q; the error names p and q, which may have a common factor:
        Ω₂(β)/2 is another pole than Ω₁(β).

    Examples
    --------
    >>> try:
    ...     float_beam(0.01, 3.250001296, 1)
    ... except ResonanceError as error:
    ...     print(str(error)[:74])
    Omega = 3.250001296 is numerically at the resonance Omega_1(beta)/1 of the
    """
    shape, numbers = static_beam(beta, driven_end), doubles()
    try:
        value = float(omega)
    except (TypeError, ValueError):
        raise InputError(f"Omega = {omega!r} is not a number; give ωx₀/c, e.g. 2.2") from None
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"Omega = {value!r}; ωx₀/c must be positive and finite")
    distance = {
        q: _from_resonance(waves(shape, q * value, numbers), q * value) for q in range(1, order + 1)
    }
    close = [q for q in distance if distance[q] <= RESOLUTION]
    if close:
        # As β → 0 the poles with one value of p/q merge: the nearest, or the first in order where
        # rounding hides which that is.
        q = min(close, key=lambda q: max(distance[q], 2.0**-48))
        k = math.sqrt(waves(shape, q * value, numbers).k2)
        p = math.floor(k * shape.contact_point / math.pi + 1e-6)
        lower = f", or ask for an order below {close[0]}" if close[0] > 1 else ""
        raise ResonanceError(
            f"Omega = {value!r} is numerically at the resonance Omega_{p}(beta)/{q} of the "
            f"{driven_end} beam with beta = {beta!r}, p/q = {p}/{q}, where the expansion "
            f"of order {order} ≥ q has a pole; move Omega away{lower}",
            p,
            q,
        )
    return beam_problem(beta, value, driven_end, static=shape)


def _from_resonance(wave: Waves, rate: float) -> float:
    """The determinant of one harmonic at the angular frequency ``rate``, over its terms' size."""
    k, p = math.sqrt(wave.k2), wave.p
    size = (wave.p2 + wave.k2) / k + (2 * p if wave.clamped else wave.p2 / p)
    size *= 1 if wave.clamped else p
    return float(abs(wave.solve(0, 0, 1)[1]) / (max(1.0, rate) * size))
