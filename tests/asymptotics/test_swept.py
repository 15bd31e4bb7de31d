"""Arrays of parameters: every number's bound holds, and hard points have all their digits."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asymptotics import expand, moving_frame, prove
from asymptotics.expansion.proof import RefutedError
from asymptotics.expansion.swept import SweptExpansion
from asymptotics.formulas.beam import expand_symbolic, impedances
from asymptotics.problems.beam import beam_problem
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.problems.string import RESOLUTION, string_problem
from asymptotics.rings.bounded import Bounded, BoundedRing, bounded
from asymptotics.rings.numbers import digits

EPS = 2.0**-52
ORDER = 5
BETAS = np.array([[10.0], [0.01], [1e-4], [1e-8]])
OMEGAS = np.array([0.83, 2.2, 3.0, 5.1])


def exact(beta: float, omega: Any, order: int, driven_end: str) -> Any:
    with mpmath.workdps(80):
        return expand(
            beam_problem(mpmath.mpf(beta), mpmath.mpmathify(omega), driven_end, digits()), order
        )


def distance(double: float, number: Any) -> float:
    with mpmath.workdps(80):
        return float(abs(mpmath.mpf(float(double)) - number))


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_every_bound_holds_and_none_is_empty(driven_end: str) -> None:
    found = expand(beam_problem(BETAS, OMEGAS, driven_end), ORDER)
    assert isinstance(found, SweptExpansion)
    easy = 0
    for index in np.ndindex(4, 4):
        wanted = exact(BETAS[index[0], 0], OMEGAS[index[1]], ORDER, driven_end)
        easy += int(np.ravel_multi_index(index, (4, 4))) not in found.points
        for n in range(1, ORDER + 1):
            largest = max(abs(float(c)) for c in wanted.contact(n).values())
            for j, c in wanted.contact(n).items():
                bound = found.errors[n - 1].contact[j][index]
                assert distance(found.contact(n)[j][index], c) <= bound
                assert bound <= RESOLUTION * largest
            for j, start in wanted.shape(n).items():
                for i, x in enumerate(start):
                    bound = found.errors[n - 1].shape[j][i][index]
                    assert distance(found.shape(n)[j][i][index], x) <= bound
    assert 0 < easy < 16  # doubles sufficed for some, not for all


def test_a_point_next_to_a_resonance_has_all_digits_and_its_neighbours_are_left() -> None:
    near = float(linear_frequencies(0.01, 1)[0]) / 2 * (1 + 1e-12)
    found = expand(beam_problem(0.01, np.array([2.2, near])), 2)
    assert isinstance(found, SweptExpansion)
    assert sorted(found.points) == [1]
    wanted = exact(0.01, near, 2, "pinned").contact(2)[2]
    assert found.contact(2)[2][1] == pytest.approx(float(wanted), rel=2 * EPS)


def test_complex_frequencies_one_by_one_and_as_an_array() -> None:
    omegas = np.array([2.2 + 0.1j, 1.3 - 0.02j])
    found = expand(beam_problem(1e-4, omegas), 4)
    assert isinstance(found, SweptExpansion)
    for i, omega in enumerate(omegas):
        single = expand(beam_problem(1e-4, complex(omega)), 4)
        wanted = exact(1e-4, complex(omega), 4, "pinned")
        for n in range(1, 5):
            for j, c in wanted.contact(n).items():
                assert single.contact(n)[j] == pytest.approx(complex(c), rel=4 * EPS)
                bound = found.errors[n - 1].contact[j][i]
                assert abs(found.contact(n)[j][i] - complex(c)) <= bound + EPS * abs(complex(c))


def test_a_sweep_is_continued_as_if_it_had_been_made_at_once() -> None:
    problem = beam_problem(np.array([0.01, 1e-6]), 2.2)
    short = expand(problem, 2)
    longer, once = expand(problem, 5, start=short), expand(problem, 5)
    assert longer.order == 5
    for n in range(1, 6):
        for j, c in once.contact(n).items():
            assert np.array_equal(longer.contact(n)[j], c)
    for left, right in zip(longer.orders[:2], short.orders, strict=True):
        assert left is right


def test_the_moving_frame_of_a_sweep_is_that_of_its_points() -> None:
    betas = np.array([0.01, 1e-7])
    frame = moving_frame(expand(beam_problem(betas, 2.2), 4))
    for i, beta in enumerate(betas):
        single = moving_frame(expand(beam_problem(float(beta), 2.2), 4))
        for k, rows in single.modes.items():
            for mine, series in zip(frame.modes[k], rows, strict=True):
                for n, harmonics in enumerate(series):
                    largest = max((abs(c) for c in harmonics.values()), default=0.0)
                    for j, c in harmonics.items():
                        assert abs(mine[n][j][i] - c) <= RESOLUTION * largest


def test_somebody_else_s_numbers_are_not_taken_for_the_sweep_s() -> None:
    solution = expand(beam_problem(np.array([0.01, 1e-6]), 2.2), 3)
    assert isinstance(solution, SweptExpansion)
    assert solution.is_swept()
    assert prove(solution).holds
    contact = dict(solution.contact(2))
    contact[2] = contact[2] * np.array([1.0, 1.001])
    orders = (solution.orders[0], replace(solution.orders[1], contact=contact), solution.orders[2])
    tampered = replace(solution, orders=orders)
    assert not tampered.is_swept()
    with pytest.raises(RefutedError, match="inconsistent"):
        prove(tampered)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_closed_forms_at_arrays_of_points(driven_end: str) -> None:
    betas, solution = np.array([0.1, 1e-3, 1e-7]), expand_symbolic(3)
    points = impedances(betas, 2.2, 3, driven_end)
    for j, element in solution.contact(3).items():
        values = points.evaluate(element)
        for beta, value in zip(betas, values, strict=True):
            single = impedances(float(beta), 2.2, 3, driven_end).evaluate(element)
            assert value == pytest.approx(single, rel=RESOLUTION), j


def test_the_string_over_bounded_doubles() -> None:
    omegas = np.array([0.83, 2.2, 3.14, 3.14159])
    kind = bounded()

    def cot(j: int) -> Bounded:
        return kind.cos(j * Bounded(omegas)) / kind.sin(j * Bounded(omegas))

    found = expand(string_problem(BoundedRing(), Bounded(omegas), cot), 6)
    for i, omega in enumerate(omegas):
        with mpmath.workdps(60):
            x = mpmath.mpf(float(omega))
            problem = string_problem(digits().ring, x, lambda j, x=x: mpmath.cot(j * x))
            wanted = expand(problem, 6).contact(6)
        for j, c in wanted.items():
            value, error = (
                part[i] for part in (found.contact(6)[j].value, found.contact(6)[j].error)
            )
            assert abs(value - float(c)) <= error
            assert error < 1e-3 * abs(value)


OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
FINITE = st.floats(-1e10, 1e10)


@settings(max_examples=200, deadline=None)
@given(FINITE, FINITE, st.floats(0, 1e-3), st.floats(0, 1e-3), st.sampled_from("+-*/"))
def test_operations_enclose(a: float, b: float, da: float, db: float, operation: str) -> None:
    """The exact result at the corners of both intervals is inside the bound."""
    found: Bounded = OPERATIONS[operation](Bounded(a, da), Bounded(b, db))
    if not np.isfinite(found.error):
        assert operation == "/"
        return
    for x in (Fraction(a) - Fraction(da), Fraction(a) + Fraction(da)):
        for y in (Fraction(b) - Fraction(db), Fraction(b) + Fraction(db)):
            exact_value = OPERATIONS[operation](x, y)
            assert abs(Fraction(float(found.value)) - exact_value) <= Fraction(float(found.error))


@settings(max_examples=100, deadline=None)
@given(st.floats(1e-6, 50), st.floats(0, 1e-3), st.sampled_from(["sqrt", "exp", "sin", "cos"]))
def test_functions_enclose(x: float, error: float, name: str) -> None:
    found = getattr(bounded(), name)(Bounded(x, error))
    with mpmath.workdps(40):
        for end in (mpmath.mpf(x) - error, mpmath.mpf(x) + error):
            if np.isfinite(found.error):
                assert abs(getattr(mpmath, name)(end) - float(found.value)) <= float(found.error)
            else:
                assert name == "sqrt"
                assert 2 * error > x


@settings(max_examples=100, deadline=None)
@given(
    st.floats(-3, 3), st.floats(-3, 3), st.floats(1e-12, 1e-3), st.floats(0, 6.3),
    st.sampled_from(["sqrt", "exp", "sin", "cos"]),
)  # fmt: skip
def test_functions_of_complex_numbers_enclose(
    x: float, y: float, error: float, angle: float, name: str
) -> None:
    z = complex(x, y)
    found = getattr(bounded(), name)(Bounded(z, error))
    if not np.isfinite(found.error):
        return
    with mpmath.workdps(40):
        moved = mpmath.mpc(z) + mpmath.mpf(error) * (1 - EPS) * mpmath.expj(angle)
        if name == "sqrt" and (moved.real < 0 or z.real < 0) and moved.imag * z.imag <= 0:
            return  # across the branch cut
        value = getattr(mpmath, name)(moved)
        assert abs(value - complex(found.value)) <= float(found.error)
