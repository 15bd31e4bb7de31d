"""The string as a problem: any that obeys W_ξξ = k² W, and the paper's, exact and in doubles."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems.problem import Mode, Problem
from asymptotics.rings.cotangent import CotangentRing
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import E, FloatRing, Ring


def driven_string(
    name: str,
    ring: Ring[E],
    *,
    stiffness: Callable[[int], E],
    impedance: Callable[[int], E],
    source: Callable[[int], E],
    drive: Mapping[int, E],
    equation_residual: Callable[[int, Sequence[E]], E],
    end_residual: Callable[[int, Sequence[E]], E],
    end_unit: Callable[[int], E],
) -> Problem[E]:
    r"""Any string, W_ξξ = k_j² W for harmonic j > 0, held at W = 1 and driven at ξ = 0.

    With the value v at the static contact point and the amplitude a at the driven end a harmonic is
    :math:`v (\cos k_js + \cot k_j \sin k_js) - a \sin k_js / \sin k_j`, s = ξ − 1. So all that is
    needed is

    * ``stiffness``: j ↦ k_j²,
    * ``impedance``: j ↦ k_j cot k_j, the slope per unit value,
    * ``source``: j ↦ k_j/sin k_j, minus the slope per unit of ``drive``.

    The mean, j = 0, is their limit k → 0: 0, 1, 1. Both residuals and ``end_unit``, of the one
    condition at the driven end, are asked for j > 0 only.
    """
    one, minus = ring.one, ring.rational(-1)

    @cache
    def mode(j: int) -> Mode[E]:
        if j == 0:
            return Mode((ring.zero, ring.zero), ((one, one),), (ring.zero, minus))
        return Mode(
            (ring.sum([minus * stiffness(j)]), ring.zero),
            ((one, impedance(j)),),
            (ring.zero, ring.sum([minus * source(j)])),
        )

    return Problem(
        name=name,
        ring=ring,
        contact_order=2,
        static=lambda d: ring.rational(2) if d == 2 else ring.zero,
        static_reduction=(ring.zero, ring.zero, ring.zero),
        mode=mode,
        drive=drive,
        inverse_leading=ring.rational(1, 2),
        equation_residual=lambda j, w: equation_residual(j, w) if j else w[2],
        end_residual=lambda j, w: (end_residual(j, w) if j else ring.sum([w[0], minus * w[1]]),),
        end_unit=lambda j: (end_unit(j) if j else ring.one,),
        load=(ring.rational(2),),
        # A parabola in ξ − 1 is a₀ − a₁ + a₂/2 at ξ = 0, where it is held at 1.
        static_end_residual=lambda a: (
            ring.sum([a(0), minus * a(1), ring.rational(1, 2) * a(2), minus]),
        ),
        rest=ring.one,
    )


@remembering
def string_problem(
    ring: Ring[E],
    omega: E,
    cot: Callable[[int], E],
    name: str = "string",
    drive: Mapping[int, E] | None = None,
) -> Problem[E]:
    r"""The rope without bending (β = 0), driven by ε ΔZ(θ) with θ = Ωτ.

    .. math:: W_{ττ} = W_{ξξ} − 2, \quad W(0, τ) = 1 + ε ΔZ, \quad W = W_ξ = 0
              \text{ at } ξ_c(τ)

    (the paper's eqs. rope, forcing). For its ΔZ = cos θ, the default, the small parameter is
    ε̂ = ε/sin Ω, which keeps every coefficient in ℚ[Ω, cot Ω, cot 2Ω, …].

    Parameters
    ----------
    ring, omega, cot
        Any commutative ring over the rationals, Ω in it, and j ↦ cot jΩ in it.
    drive
        For another ΔZ = Σ a_j e^{ijθ}: the scaled amplitudes A_j = a_j/sin jΩ for j > 0, and
        A₀ = a₀. The small parameter is then ε itself.
    """

    @cache
    def times(j: int) -> E:
        return ring.sum([ring.rational(j) * omega])

    def circular(j: int) -> tuple[E, E]:
        # (cos jΩ, sin jΩ)/sin^j Ω are the real and imaginary part of (c + i)^j, so that cot jΩ
        # itself is not used.
        c, cosine, sine = cot(1), ring.one, ring.zero
        for _ in range(j):
            cosine, sine = (
                ring.sum([c * cosine, ring.rational(-1) * sine]),
                ring.sum([cosine, c * sine]),
            )
        return cosine, sine

    def equation_residual(j: int, w: Sequence[E]) -> E:
        rate = times(j)
        return ring.sum([w[2], rate * rate * w[0]])

    def end_residual(j: int, w: Sequence[E]) -> E:
        # W(0) of harmonic j is w cos jΩ − w′ sin(jΩ)/(jΩ).
        cosine, sine = circular(j)
        return ring.sum([times(j) * cosine * w[0], ring.rational(-1) * sine * w[1]])

    return driven_string(
        name,
        ring,
        stiffness=lambda j: times(j) * times(j),
        impedance=lambda j: ring.sum([times(j) * cot(j)]),
        # The amplitude at the driven end is A_j sin jΩ.
        source=times,
        drive={1: ring.rational(1, 2)} if drive is None else drive,
        equation_residual=equation_residual,
        end_residual=end_residual,
        end_unit=lambda j: ring.sum([times(j) * circular(j)[1]]),
    )


@remembering
def exact_string() -> Problem[Any]:
    """The string over the exact ring: closed forms in Ω."""
    ring = CotangentRing()
    return string_problem(ring, ring.omega, ring.cot, name="string")


@remembering
def float_string(omega: float, order: int) -> Problem[Any]:
    """The string in double precision at one Ω; refuses the resonances of ``order``.

    The expansion is computed over balls and rounded: see :mod:`asymptotics.expansion.rounded`.

    Raises
    ------
    InputError
        Ω is not a positive finite number.
    ResonanceError
        Ω is at, or numerically at, pπ/q with q ≤ order; the error names p/q.
    """
    from asymptotics.problems.enclosed import ball_string

    omega = check_frequency(omega, order)
    problem = string_problem(
        FloatRing(), omega, lambda j: accurate_cot(j, omega), name=f"string at {omega!r}"
    )
    return replace(problem, balls=lambda: ball_string(omega))


def accurate_cot(j: int, omega: float) -> float:
    """cot(jΩ) for the double Ω as it stands: the rounding of the product jΩ is put back.

    Near a pole that rounding, not the tangent, costs the digits.

    >>> from mpmath import mp, cot, mpf
    >>> x = 7.330382858376183        # 7 π/3 to 16 digits, next to a pole of cot 3Ω
    >>> with mp.workdps(40):
    ...     exact = cot(3 * mpf(x))
    >>> abs(accurate_cot(3, x) / float(exact) - 1) < 1e-15
    True
    """
    product = j * omega
    # Veltkamp splitting: both halves times the small integer j are exact.
    scaled = 134217729.0 * omega
    high = scaled - (scaled - omega)
    lost = (j * high - product) + j * (omega - high)
    tangent = math.tan(product)
    return (1.0 - lost * tangent) / (tangent + lost)


# √u, u = 2⁻⁵²: closer than that to a pole, half the digits of a cotangent are rounding.
RESOLUTION = 2.0**-26


# The same of a phase jΩτ: beyond, its own rounding is more than that.
LARGEST_PHASE = RESOLUTION * 2.0**53


def pole_at(x: float) -> int:
    """p when x > 0 is numerically at the pole pπ of the cotangent, p ≥ 1, and 0 otherwise.

    >>> pole_at(6.283185307), pole_at(6.2831), pole_at(0.0)
    (2, 0, 0)
    """
    at = abs(math.sin(x)) <= RESOLUTION * max(1.0, x)
    return round(x / math.pi) if at else 0


def check_frequency(omega: float, order: int) -> float:
    """Ω as a float when it is positive, finite and clear of the resonances q ≤ order.

    'Numerically at' means |qΩ − pπ| ≤ √u max(1, qΩ), u = 2⁻⁵²: closer than that, half the digits of
    cot qΩ are rounding, and the expansion holds powers of it.
    """
    try:
        value = float(omega)
    except (TypeError, ValueError):
        raise InputError(
            f"Omega = {omega!r} is not a number; give the dimensionless frequency ωx₀/c, e.g. 2.2"
        ) from None
    if not math.isfinite(value) or value <= 0:
        raise InputError(
            f"Omega = {value!r}; the dimensionless frequency ωx₀/c must be positive and finite"
        )
    if value > 1e6:
        raise InputError(
            f"Omega = {value!r}; above 1e6 double precision cannot tell a resonance from its "
            "neighbours: give a smaller frequency"
        )
    for q in range(1, order + 1):
        nearest = pole_at(q * value)
        if nearest:
            p, reduced = nearest // math.gcd(nearest, q), q // math.gcd(nearest, q)
            lower = f", or ask for an order below {reduced}" if reduced > 1 else ""
            raise ResonanceError(
                f"Omega = {value!r} is numerically at the resonance p/q = {p}/{reduced} "
                f"(Omega = pπ/q = {p * math.pi / reduced:.15g}), where an expansion of order "
                f"{reduced} or more has a pole; move Omega away{lower}",
                p,
                reduced,
            )
    return value
