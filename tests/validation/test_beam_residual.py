"""The beam's truncated series in the full problem: what it leaves falls like ε^{N+1}.

The series is written out as a function of ξ and τ — exact exponentials, cosines and the static
profile in closed form — and put into the nonlinear conditions W = W_ξ = W_ξξ = 0 at the moving
contact point ξ_c(τ), with nothing of the engine's Taylor sums or moving frame in between. A wrong
coefficient at order n leaves a residual that falls like εⁿ only. Forty digits keep rounding out of
sight; the amplitudes halve, and over the last halving the exponent is N + 1 up to the share of the
next order, ε r with r ≈ 10 the growth of the orders at these parameters.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable

import mpmath
import pytest
from mpmath import mpf

from asymptotics import Expansion, expand
from asymptotics.problems.beam import beam_problem, static_beam
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.rings.numbers import digits

ORDER = 5
BETA, OMEGA = "0.01", "2.2"
DIGITS = 60
PHASES = [mpf(k) / 7 for k in range(8)]
SMALL = [mpf(2) ** -k for k in (14, 15, 16)]

Shape = Callable[[mpf, int], mpf]
"""(s, e) ↦ ∂^e of a function of s = ξ − ξ₀."""


def static_profile(driven_end: str) -> Shape:
    """W₀ = s² + 2β(1 − cosh ks) + D(sinh ks − ks), k² = 1/β, D from a₃."""
    shape = static_beam(BETA, driven_end, digits())
    beta, k = shape.beta, 1 / mpmath.sqrt(shape.beta)
    D = shape.a3 / k**3

    def profile(s: mpf, e: int) -> mpf:
        polynomial = [s * s + 2 * beta - D * k * s, 2 * s - D * k, mpf(2)][e]
        even, odd = (mpmath.cosh, mpmath.sinh) if e % 2 == 0 else (mpmath.sinh, mpmath.cosh)
        return polynomial + k**e * (D * odd(k * s) - 2 * beta * even(k * s))

    return profile


def harmonic(j: int, start: tuple[mpf, ...]) -> Shape:
    """The solution with the derivatives ``start`` at s = 0: four exponentials e^{zs}.

    βz⁴ − z² = (jΩ)²; for j = 0 the double root z = 0 gives 1 and s.
    """
    beta, rate = mpf(BETA), j * mpf(OMEGA)
    root = mpmath.sqrt(1 + 4 * beta * rate**2)
    p, k = mpmath.sqrt((1 + root) / (2 * beta)), mpmath.sqrt((root - 1) / (2 * beta))
    w0, w1, w2, w3 = start
    total = p * p + k * k
    c, g = (k * k * w0 + w2) / total, (k * k * w1 + w3) / total / p
    a, b = w0 - c, w1 - p * g

    def shape(s: mpf, e: int) -> mpf:
        even, odd = (mpmath.cosh, mpmath.sinh) if e % 2 == 0 else (mpmath.sinh, mpmath.cosh)
        value = p**e * (c * even(p * s) + g * odd(p * s))
        if j == 0:
            return value + [a + b * s, b, 0][e]
        quarter = e * mpmath.pi / 2
        return value + k**e * (
            a * mpmath.cos(k * s + quarter) + b / k * mpmath.sin(k * s + quarter)
        )

    return shape


@functools.cache
def solution(driven_end: str) -> Expansion[mpf]:
    with mpmath.workdps(DIGITS):
        return expand(beam_problem(BETA, OMEGA, driven_end, digits()), ORDER)


def largest_residual(series: Expansion[mpf], driven_end: str, order: int, e: int) -> list[mpf]:
    """max over τ of |∂^e W(ξ_c)| for each ε of SMALL, the series cut off at ``order``."""
    static = static_profile(driven_end)
    terms = [
        (n, j, harmonic(j, start))
        for n in range(1, order + 1)
        for j, start in series.shape(n).items()
    ]
    found = []
    for epsilon in SMALL:
        sizes = []
        for phase in PHASES:
            theta = phase * mpmath.pi

            def cosine(j: int, theta: mpf = theta) -> mpf:
                return mpmath.cos(j * theta) * (1 if j == 0 else 2)

            s = mpmath.fsum(
                epsilon**n * c * cosine(j)
                for n in range(1, order + 1)
                for j, c in series.contact(n).items()
            )
            w = mpmath.fsum(epsilon**n * cosine(j) * shape(s, e) for n, j, shape in terms)
            sizes.append(abs(static(s, e) + w))
        found.append(max(sizes))
    return found


def exponent(sizes: list[mpf]) -> float:
    return float(mpmath.log(sizes[-2] / sizes[-1], 2))


# The next order's share ε r at ε = 2⁻¹⁵ is 3e-4, times a few for its combinatorial factor.
TOLERANCE = 0.01


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("order", range(1, ORDER + 1))
def test_contact_conditions(order: int, driven_end: str) -> None:
    with mpmath.workdps(DIGITS):
        for e in range(3):
            sizes = largest_residual(solution(driven_end), driven_end, order, e)
            assert sizes[0] > mpf(10) ** -45
            # ξ₁ w₁′ = 0 = ξ₁² W₀″ leave w₂(ξ₀) = 0, so that order 1 already meets W = 0 to ε².
            expected = 3 if (order, e) == (1, 0) else order + 1
            assert exponent(sizes) == pytest.approx(expected, abs=TOLERANCE)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_driven_end(driven_end: str) -> None:
    """W(0) = 1 + ε cos θ and the second condition, order by order, by the exact exponentials."""
    with mpmath.workdps(DIGITS):
        left = -static_beam(BETA, driven_end, digits()).contact_point
        second = 2 if driven_end == "pinned" else 1
        static = static_profile(driven_end)
        assert abs(static(left, 0) - 1) < mpf(10) ** -50
        assert abs(static(left, second)) < mpf(10) ** -50
        for n in range(1, ORDER + 1):
            for j, start in solution(driven_end).shape(n).items():
                shape = harmonic(j, start)
                wanted = mpf(1) / 2 if n == 1 else mpf(0)
                assert abs(shape(left, 0) - wanted) < mpf(10) ** -45
                assert abs(shape(left, second)) < mpf(10) ** -45
                assert max(abs(shape(left / 2, 0)), abs(start[3])) > mpf(10) ** -3


@pytest.mark.parametrize("order", range(1, ORDER + 1))
def test_a_wrong_coefficient_shows(order: int) -> None:
    """A relative error of 0.1 in one harmonic of ξ_n pulls the exponent down to n."""
    series = solution("pinned")
    orders = list(series.orders)
    contact = dict(orders[order - 1].contact)
    contact[order] *= mpf("1.1")
    orders[order - 1] = dataclasses.replace(orders[order - 1], contact=contact)
    spoilt = dataclasses.replace(series, orders=tuple(orders))
    with mpmath.workdps(DIGITS):
        assert exponent(largest_residual(spoilt, "pinned", order, 2)) < order + 0.1
