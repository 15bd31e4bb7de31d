"""Values of any problem: bending, a foundation, other numbers; and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp

from asymptotics import exact_string, expand
from asymptotics.errors import InputError, OrderingError
from asymptotics.expansion.order_loop import Expansion
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.printing.beam_numpy import beam_numpy
from asymptotics.problems.beam import beam_problem, float_beam
from asymptotics.problems.damped import damped_string
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import driven_string
from asymptotics.rings.numbers import digits
from asymptotics.rings.ring import FloatRing
from asymptotics.values.response import response

OMEGA = 2.2
TAU = np.linspace(0, 2.8, 7)


def phase(j: int, tau: np.ndarray) -> np.ndarray:
    return j * OMEGA * tau


def foundation(kappa: float, omega: float) -> Problem[Any]:
    """W_ττ = W_ξξ − 2 − κW, the string on an elastic foundation: another ξ₀, another shape."""
    rest = math.acosh(1 + kappa / 2) / math.sqrt(kappa)

    def wavenumber(j: int) -> complex:
        return complex((j * omega) ** 2 - kappa) ** 0.5

    def impedance(j: int) -> float:
        k = wavenumber(j)
        return (k * np.cos(k * rest) / np.sin(k * rest)).real

    problem = driven_string(
        "foundation",
        FloatRing(),
        stiffness=lambda j: (j * omega) ** 2 - kappa,
        impedance=impedance,
        source=lambda j: (wavenumber(j) / np.sin(wavenumber(j) * rest)).real,
        drive={1: 0.5},
        equation_residual=lambda j, w: w[2] + ((j * omega) ** 2 - kappa) * w[0],
        end_residual=lambda j, w: w[0],
        end_unit=lambda j: 1.0,
    )
    mean = replace(problem.mode(0), reduction=(kappa, 0.0), impedance=((1.0, impedance(0)),))
    return replace(
        problem,
        static=lambda d: 0.0 if d < 2 or d % 2 else 2.0 * kappa ** (d // 2 - 1),
        static_reduction=(0.0, kappa, 0.0),
        mode=lambda j: problem.mode(j) if j else mean,
        rest=rest,
    )


def left_over(solution: Expansion[Any], epsilon: float) -> float:
    """What profile and contact point leave of W(0) = 1 + ε cos Ωτ."""
    contact = response(solution, phase, epsilon, [], TAU).contact
    ends = response(solution, phase, epsilon, -contact[:, None], TAU).profile[:, 0]
    return float(np.abs(ends - 1 - epsilon * np.cos(OMEGA * TAU)).max())


@pytest.mark.parametrize(
    "problem",
    [
        foundation(1.7, OMEGA),
        foundation(0.3, OMEGA),
        float_beam(1.0, OMEGA, 4),
        float_beam(0.01, OMEGA, 4),
        float_beam(0.1, OMEGA, 4, "clamped"),
        damped_string(OMEGA, 0.3, 0.1),
    ],
    ids=lambda problem: problem.name,
)
@pytest.mark.parametrize("order", [2, 3, 4])
def test_the_driven_end_is_met_to_the_next_order(problem: Problem[Any], order: int) -> None:
    """Truncated separately, profile and position leave ε^{N+1}."""
    solution = expand(problem, order)
    coarse, fine = left_over(solution, 4e-3), left_over(solution, 2e-3)
    assert np.log2(coarse / fine) == pytest.approx(order + 1, abs=0.15)
    assert left_over(solution, 0.0) < 1e-10  # the static shape


def test_a_foundation_against_its_own_theory() -> None:
    """ξ₀ = arcosh(1 + κ/2)/√κ, W₀ = (2/κ)(cosh √κ s − 1); ξ₁ from a Galerkin solution."""
    solution = expand(foundation(1.7, OMEGA), 4)
    rest = response(solution, phase, 0.0, [-0.4], [0.3])
    assert rest.contact[0] == math.acosh(1.85) / math.sqrt(1.7)
    assert rest.profile[0, 0] == pytest.approx(
        2 / 1.7 * (math.cosh(math.sqrt(1.7) * 0.4) - 1), rel=1e-14
    )
    linear = response(solution, phase, 1e-7, [], [0.0]).contact[0] - rest.contact[0]
    assert linear / 1e-7 == pytest.approx(2 * 0.445006259515, rel=1e-6)


@pytest.mark.parametrize("driven_end", ["pinned", "clamped"])
@pytest.mark.parametrize("beta", [0.01, 0.5])
def test_a_beam_is_the_emitted_beam(beta: float, driven_end: str) -> None:
    """ξ_c to rounding; W at one place, whose two truncations differ by ε^{N+1}."""
    module: dict[str, Any] = {}
    exec(beam_numpy(expand_symbolic(3), driven_end), module)
    solution = expand(float_beam(beta, OMEGA, 3, driven_end), 3)
    differences = []
    for epsilon in (4e-3, 2e-3):
        contact = response(solution, phase, epsilon, [], TAU).contact
        expected = module["contact"](TAU, OMEGA, epsilon, beta)
        np.testing.assert_allclose(contact, expected, rtol=1e-14)
        s = np.array([-0.8, -0.3])
        found = response(solution, phase, epsilon, s, TAU).profile
        shape = module["shape"](contact[:, None] + s, TAU[:, None], OMEGA, epsilon, beta)
        differences.append(np.abs(found - shape).max())
    assert np.log2(differences[0] / differences[1]) == pytest.approx(4, abs=0.2)


def test_near_the_contact_a_beam_is_right_relative_to_its_own_size() -> None:
    """w ∼ −a₃ |s|³/6: nothing larger than w is subtracted on the way."""
    with mp.workdps(40):
        beta, omega = mpmath.mpf(0.01), mpmath.mpf(OMEGA)
        exact = expand(beam_problem(beta, omega, numbers=digits()), 3)
        reference = response(exact, phase, 2e-3, [-1e-6, -1e-3], [0.4]).profile
    found = response(expand(float_beam(0.01, OMEGA, 3), 3), phase, 2e-3, [-1e-6, -1e-3], [0.4])
    np.testing.assert_allclose(found.profile, reference, rtol=1e-12)
    third = -found.profile[0, 0] / (-1e-6) ** 3 * 6
    assert abs(third) == pytest.approx(20.0, rel=0.1)


def test_thin_layers_are_refused_before_rounding_has_them() -> None:
    """Where the profile is given, the driven end stays within the bound that lets it through."""
    for beta in (0.05, 0.01, 0.005, 0.003):
        assert left_over(expand(float_beam(beta, OMEGA, 2), 2), 1e-6) < 2.0**-26
    thin = expand(float_beam(1e-3, OMEGA, 2), 2)
    assert response(thin, phase, 1e-4, [], [0.0]).contact[0] == pytest.approx(1.0322, abs=1e-3)
    # Already where one rounding of such terms would still leave half the digits.
    for solution in (thin, expand(float_beam(1.5e-3, OMEGA, 2), 2)):
        with pytest.raises(InputError, match=r"cancels terms of size .*beam_numpy"):
            response(solution, phase, 1e-4, [-0.9], [0.0])
    # A layer at the driven end alone is known from there: e^{−80} at the contact point.
    assert left_over(expand(damped_string(OMEGA, 3000.0), 2), 1e-2) < 1e-15


def test_what_has_no_numbers_is_refused() -> None:
    for solution in (expand(exact_string(), 2), expand_symbolic(2)):
        with pytest.raises(InputError, match="not over numbers at one frequency"):
            response(solution, phase, 0.01, [-0.5], [0.0])
    swept = expand(beam_problem(0.01, np.array([2.2, 2.3])), 2)
    with pytest.raises(InputError, match="at one frequency"):
        response(swept, phase, 0.01, [-0.5], [0.0])
    unknown = expand(replace(float_beam(0.01, OMEGA, 2), rest=None), 2)
    with pytest.raises(InputError, match="where the contact point rests"):
        response(unknown, phase, 0.01, [-0.5], [0.0])


def test_the_first_order_may_not_pass_the_driven_end() -> None:
    """It is ξ₀ that it must stay below: 1.10 for this beam."""
    solution = expand(float_beam(0.01, OMEGA, 1), 1)
    size = 2 * abs(solution.contact(1)[1])
    response(solution, phase, 1.05 / size, [], [0.0])
    with pytest.raises(OrderingError, match="linear response"):
        response(solution, phase, 1.11 / size, [], [0.0])
