"""Doubles with all digits right: every float path against digits, where doubles alone lose them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import acb, arb, ctx

from asymptotics import Expansion, expand, float_string, moving_frame, string_problem
from asymptotics.errors import InputError
from asymptotics.expansion.rounded import RoundedExpansion
from asymptotics.formulas.beam import contact_amplitude, expand_symbolic, impedances
from asymptotics.problems.beam import beam_problem, float_beam
from asymptotics.problems.damped import damped_string
from asymptotics.problems.enclosed import ball_string
from asymptotics.problems.forcing import FourierDrive, forced_string, fourier_drive
from asymptotics.problems.forcing_generators import generator_string
from asymptotics.problems.forcing_generators import generator_values as forced_values
from asymptotics.problems.problem import Problem
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.problems.string import driven_string
from asymptotics.rings.balls import AcbRing
from asymptotics.rings.numbers import NumberRing, balls, digits, doubles
from asymptotics.rings.precision import PrecisionError, at_precision
from asymptotics.rings.ring import ComplexRing
from asymptotics.rings.rounding import accurate, rounded_value

EPS = 2.0**-52


class DigitRing(NumberRing):
    """mpmath's complex numbers."""

    even = False

    def __init__(self) -> None:
        super().__init__(mpmath.mpc)

    def conjugate(self, element: Any) -> Any:
        return mpmath.conj(element)


def worst(found: Expansion[Any], exact: Expansion[Any], derivatives: bool = True) -> float:
    """The largest relative error of any coefficient, contact point and shape."""
    errors = []
    for n in range(1, found.order + 1):
        assert set(found.contact(n)) == set(exact.contact(n))
        for j, c in exact.contact(n).items():
            errors.append(abs(found.contact(n)[j] - c) / abs(c))
        for j, start in exact.shape(n).items() if derivatives else ():
            for x, y in zip(found.shape(n)[j], start, strict=True):
                errors.append(abs(x - y) / abs(y) if y else abs(x))
    return float(max(errors))


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-30, 1e-10, 1e-8, 1e-6, 1e-2, 1e8])
def test_the_beam_at_any_stiffness(beta: float, driven_end: str) -> None:
    order = 7
    found = expand(float_beam(beta, 2.2, order, driven_end), order)
    with mpmath.workdps(300):
        exact = expand(beam_problem(beta, 2.2, driven_end, digits()), order)
        assert worst(found, exact) <= EPS
    assert all(isinstance(c, float) for c in found.contact(order).values())
    # The same by the default arithmetic of `beam`.
    assert expand(beam_problem(beta, 2.2, driven_end), 3).contact(3) == pytest.approx(
        found.contact(3), rel=2 * EPS
    )


def test_what_doubles_alone_make_of_a_thin_boundary_layer() -> None:
    """The reason for the balls: 712 where the coefficient is 568."""
    problem = float_beam(1e-8, 2.2, 6)
    found, alone = expand(problem, 6), expand(replace(problem, balls=None), 6)
    assert 2 * found.contact(6)[6] == pytest.approx(568.34362859, rel=1e-10)
    assert abs(alone.contact(6)[6] / found.contact(6)[6] - 1) > 0.1


@pytest.mark.parametrize(
    ("omega", "order"),
    [
        (0.83, 20),
        (math.pi / 2 + 1e-6, 12),
        (math.pi / 2 - 3e-8, 16),
        (math.pi / 7 + 1e-7, 12),
        (math.pi + 1e-7, 12),
        (1e-6, 12),
        (1e5, 12),
    ],
)
def test_the_string_near_resonances_and_at_high_order(omega: float, order: int) -> None:
    found = expand(float_string(omega, order), order)
    with mpmath.workdps(600):
        ring, exact_omega = NumberRing(mpmath.mpf), mpmath.mpf(omega)
        exact = expand(
            string_problem(ring, exact_omega, lambda j: mpmath.cot(j * exact_omega)), order
        )
        assert worst(found, exact) <= EPS


def digits_string(wavenumber: Callable[[int], Any], drive: dict[int, complex]) -> Problem[Any]:
    """Any driven string over mpmath's complex numbers; only what the engine calls."""

    def ratio(j: int) -> Any:
        return wavenumber(j) / mpmath.sin(wavenumber(j)) if wavenumber(j) else mpmath.mpc(1)

    return driven_string(
        "digits",
        DigitRing(),
        stiffness=lambda j: wavenumber(j) ** 2,
        impedance=lambda j: ratio(j) * mpmath.cos(wavenumber(j)),
        source=ratio,
        drive={j: mpmath.mpc(c) for j, c in drive.items()},
        equation_residual=lambda j, w: w[0],
        end_residual=lambda j, w: w[0],
        end_unit=lambda j: mpmath.mpc(1),
    )


@pytest.mark.parametrize("viscosity", [0.0, 0.05])
@pytest.mark.parametrize("damping", [1e-12, 1e-4, 0.1, 100.0])
@pytest.mark.parametrize("omega", [0.83, math.pi, math.pi / 3])
def test_the_damped_string(omega: float, damping: float, viscosity: float) -> None:
    order = 6
    found = expand(damped_string(omega, damping, viscosity), order)
    with mpmath.workdps(200):

        def k(j: int) -> Any:
            rate = j * mpmath.mpf(omega)
            square = rate**2 - 2j * mpmath.mpf(damping) * rate
            return mpmath.sqrt(square / (1 + 1j * mpmath.mpf(viscosity) * rate))

        assert worst(found, expand(digits_string(k, {1: 0.5}), order)) <= EPS


@pytest.mark.parametrize(
    "drive",
    [
        fourier_drive([math.pi / 2 + 1e-7], {1: 1.0, 3: 0.25}),
        fourier_drive([0.8, 1.3], {(1, 0): 1.0, (0, 1): 0.5}),
        fourier_drive([0.1, 0.3], {(1, 0): 1.0, (0, 1): 1.0}),
        fourier_drive([0.8], {1: 1.0}, {1: 0.25, 2: 0.5}),
    ],
)
def test_the_forced_string(drive: FourierDrive) -> None:
    order = 5
    found = expand(forced_string(drive, order), order)
    with mpmath.workdps(200):

        def k(j: int) -> Any:
            exact = drive.exact_rate(j)
            return mpmath.mpf(exact.numerator) / exact.denominator

        exact = expand(digits_string(k, dict(drive.amplitudes)), order)
        for n in range(1, order + 1):
            for j, c in exact.contact(n).items():
                # Over digits a coefficient that vanishes is a rounding.
                vanishes = abs(c) < mpmath.mpf(10) ** -150
                error = abs(found.contact(n).get(j, 0.0) - c)
                assert error <= (mpmath.mpf(10) ** -150 if vanishes else EPS * abs(c))


def test_a_coefficient_that_vanishes_ends_the_doubling() -> None:
    """A sine of 2Ω beside a cosine of Ω: some coefficients are exactly 0."""
    found = expand(forced_string(fourier_drive([0.8], {1: 1.0}, {2: 0.3}), 4), 4)
    assert isinstance(found, RoundedExpansion)
    assert 1024 < found.bits <= 4096
    assert rounded_value(lambda: arb(2).sqrt() ** 2 - 2, "zero") == 0.0
    with at_precision(64):
        zero = arb(0, arb(2) ** -1000)
        assert not accurate([arb(1), zero])
        assert accurate([arb(1), arb(0)])
        assert accurate([arb(1), arb(0, arb(2) ** -1100)])
        assert not accurate([arb(1), arb(1) / 3 + arb(0, 1e-16)])
        assert not accurate([arb("nan")])
        assert not accurate([acb(arb(1), arb(0, 1e-16))])
        assert accurate([acb(arb(1), arb(0, 1e-18))])


@pytest.mark.parametrize(
    ("problem", "order"),
    [
        (float_string(math.pi / 2 + 1e-6, 8), 8),
        (damped_string(math.pi, 1e-6), 5),
        (float_beam(1e-8, 2.2, 4), 4),
        (float_beam(1e-4, 2.2, 6, "clamped"), 6),
    ],
)
def test_the_moving_frame_is_rounded_from_balls_too(problem: Problem[Any], order: int) -> None:
    solution = expand(problem, order)
    frame = moving_frame(solution)
    assert frame.expansion is solution
    with at_precision(1500):
        assert problem.balls is not None
        exact = moving_frame(expand(problem.balls(), order))
        pairs = list(zip(frame.static, exact.static, strict=True))
        for k, rows in exact.modes.items():
            pairs += zip(frame.modes[k], rows, strict=True)
        for series, wanted in pairs:
            for found, harmonics in zip(series, wanted, strict=True):
                assert set(harmonics) == set(found)
                for j, c in harmonics.items():
                    number = acb(found[j]) if isinstance(c, acb) else arb(found[j])
                    if abs(c) > 1e-40:
                        assert abs(c - number) <= EPS * abs(c)
                    else:
                        assert abs(number) < 1e-40


def test_an_expansion_is_continued_from_its_balls() -> None:
    problem = float_beam(1e-8, 2.2, 6)
    first = expand(problem, 2)
    longer = expand(problem, 6, start=first)
    assert longer.orders[:2] == first.orders
    once = expand(problem, 6)
    for n in range(1, 7):
        assert longer.contact(n) == pytest.approx(once.contact(n), rel=2 * EPS)
    shorter = expand(problem, 3, start=longer)
    assert shorter.order == 3
    assert moving_frame(shorter).static[0][1:] == moving_frame(expand(problem, 3)).static[0][1:]
    seen: list[int] = []
    expand(problem, 4, progress=seen.append)
    assert seen == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (beam_problem(0.01, 2.2), beam_problem(0.02, 2.2)),
        (beam_problem(0.01, 2.2), beam_problem(0.01, 2.3)),
        (beam_problem(np.array([0.01, 0.02]), 2.2), beam_problem(np.array([0.01, 0.03]), 2.2)),
        (damped_string(1.0, 0.1), damped_string(1.0, 0.1, drive={1: 0.25})),
    ],
)
def test_another_rope_s_expansion_is_not_continued(
    first: Problem[Any], second: Problem[Any]
) -> None:
    with pytest.raises(InputError, match="the expansion to continue belongs to"):
        expand(second, 3, start=expand(first, 2))


def test_the_callers_precision_is_left_alone() -> None:
    before = ctx.prec
    solution = expand(float_beam(1e-8, 2.2, 3), 3)
    moving_frame(solution)
    assert ctx.prec == before
    with at_precision(30):
        assert expand(float_beam(1e-8, 2.2, 3), 3).orders == solution.orders


def test_beyond_the_range_of_doubles() -> None:
    with pytest.raises(InputError, match="beyond what a double can hold"):
        expand(float_beam(1e-100, 2.2, 8), 8)
    # Below it a number is 0: k/sin k at k = 1e4 (1 + i).
    assert set(expand(damped_string(50.0, 1e7), 1).contact(1).values()) == {0}
    with mpmath.workdps(400):
        exact = expand(beam_problem("1e300", 2.2, "pinned", digits()), 3)
        found = expand(float_beam(1e300, 2.2, 3), 3)
        assert found.contact(3)[1] == pytest.approx(float(exact.contact(3)[1]), rel=1e-12)
    with at_precision(64), pytest.raises(PrecisionError, match="64 bits are too few"):
        beam_problem(1e300, 2.2, "pinned", balls())


def test_polynomials_in_impedances() -> None:
    """The beam's closed forms at a thin boundary layer, where their terms cancel."""
    amplitude = contact_amplitude(expand_symbolic(5), 5, 5)
    point, alone = impedances(1e-8, 2.2, 5), impedances(1e-8, 2.2, 5, numbers=doubles())
    with mpmath.workdps(100):
        exact = impedances(1e-8, 2.2, 5, numbers=digits()).evaluate(amplitude, mpmath.mpf)
        assert abs(point.evaluate(amplitude) / exact - 1) <= EPS
        assert abs(alone.evaluate(amplitude) / exact - 1) > 1e-3
    several = impedances(np.array([1e-4, 1e-3]), 2.2, 5)
    assert several.evaluate(amplitude).shape == (2,)


def test_generators_of_strings_over_balls() -> None:
    """The radius bounds the error: at 53 bits the ball holds the one at 200."""
    omega, order = math.pi / 2 + 1e-6, 6
    drive = fourier_drive([omega], {1: 1.0})
    problem: Problem[Any] = generator_string([1], order, sines=False)
    ring: Any = problem.ring
    solution = expand(problem, order)
    reference = expand(forced_string(drive, order), order)
    for j, element in solution.contact(order).items():
        enclosures = []
        for bits in (53, 200):
            with at_precision(bits):
                values = forced_values(drive, order, enclosed=True)
                enclosures.append(ring.evaluate(element, values, AcbRing()))
        rough, ball = enclosures
        c = reference.contact(order)[j]
        assert abs(complex(ball) / c - 1) <= EPS
        assert rough.contains(ball)
        assert ball.rel_accuracy_bits() > 150
        alone = ring.evaluate(element, forced_values(drive, order), ComplexRing())
        assert abs(alone / c - 1) < 1e-12


def test_a_resonance_that_no_precision_resolves() -> None:
    """At Ω = π/2 in balls cot Ω is a ball around 0 and cot 2Ω is none: the doubling ends."""
    problem = replace(float_string(1.0, 2), balls=lambda: ball_string("pi/2"))
    with pytest.raises(PrecisionError, match="needs more than 8192 bits") as caught:
        expand(problem, 2)
    assert caught.value.partial.order == 2
