"""The beam over numbers: statics, impedances by a second route, residuals, and the string limit."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb
from mpmath import mpf

from asymptotics import Expansion, expand, moving_frame, string_problem
from asymptotics.errors import InputError, ResonanceError
from asymptotics.expansion.order_loop import derivative_towers
from asymptotics.expansion.proof import prove, residuals
from asymptotics.problems.beam import beam_problem, float_beam, static_beam
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.beam_waves import end_residuals, static_end_residuals, waves
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.numbers import NumberRing, balls, digits, doubles
from asymptotics.rings.precision import at_precision

EPS = float(np.finfo(float).eps)
CASES = [(0.1, 0.83), (0.01, 2.2), (0.001, 5.1), (1e-4, 2.2)]


def test_static_contact_points_of_the_paper_s_parameters() -> None:
    """ξ₀² − 2√β ξ₀ tanh(ξ₀/(2√β)) = 1 to the printed digits."""
    points = [float(static_beam(beta).contact_point) for beta in (1e-4, 1e-3, 1e-2, 1e-1)]
    assert points == pytest.approx([1.01005000, 1.03212265, 1.10498407, 1.35384357], abs=5e-9)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", ["1e-3", "0.01", "3"])
def test_the_static_shape_by_its_own_profile(driven_end: str, beta: str) -> None:
    """W₀ = Σ a_d s^d/d! has height 1 and its second condition at the driven end; W₀″ − βW₀⁗ = 2."""
    with mpmath.workdps(120):
        numbers = digits()
        shape = static_beam(beta, driven_end, numbers)
        s = -shape.contact_point

        def profile(e: int) -> mpf:
            # p s reaches 33 at β = 1e-3: 300 terms leave 33^300/300! < 1e-150.
            terms = (shape.derivative(d + e) * s**d / mpmath.factorial(d) for d in range(300))
            return mpmath.fsum(terms)

        assert abs(profile(0) - 1) < mpf(10) ** -80
        assert abs(profile(2 if driven_end == "pinned" else 1)) < mpf(10) ** -80
        assert abs(shape.derivative(2) - mpf(beta) * shape.derivative(4) - 2) < mpf(10) ** -100
        assert all(
            abs(x) < mpf(10) ** -100 for x in static_end_residuals(shape, shape.derivative, numbers)
        )
        assert shape.a3 < 0


@pytest.mark.parametrize(("driven_end", "factor"), [("pinned", 12), ("clamped", 36)])
def test_without_tension_the_contact_point_grows_like_the_fourth_root(
    driven_end: str, factor: int
) -> None:
    """ξ₀⁴/β → 12 (pinned) and 36 (clamped), with a correction of order β^{−1/2}."""
    ratios = [
        float(static_beam(f"1e{k}", driven_end, digits()).contact_point) ** 4 / (factor * 10.0**k)
        for k in (6, 8, 10)
    ]
    errors = [ratio - 1 for ratio in ratios]
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.05)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_no_overflow_over_sixteen_decades(driven_end: str) -> None:
    for exponent in range(-8, 9):
        solution = expand(beam_problem(10.0**exponent, 1.3, driven_end), 3)
        for n in (1, 2, 3):
            values = np.array(list(solution.contact(n).values()))
            assert np.isfinite(values).all()
            assert (values != 0).all()


@pytest.mark.parametrize("j", [0, 1, 3])
@pytest.mark.parametrize("beta", [1e-4, 0.01, 1.0])
def test_pinned_impedances_in_closed_form(beta: float, j: int) -> None:
    """With Δ = p S − T cos kL, S = sin(kL)/k, T = tanh pL, the 2×2 system has a short solution."""
    problem, length = beam_problem(beta, 2.2), static_beam(beta).contact_point
    rate = 2.2 * j
    root = math.sqrt(1 + 4 * beta * rate**2)
    k, p = math.sqrt(2 * rate**2 / (1 + root)), math.sqrt((1 + root) / (2 * beta))
    S = math.sin(k * length) / k if j else length
    C, T, total = math.cos(k * length), math.tanh(p * length), p * p + k * k
    e = math.exp(-p * length)
    sech = 2 * e / (1 + e * e)
    delta = p * S - T * C
    by_value = (-(k * k * p * S + p * p * T * C) / delta, -p * total * C / delta)
    by_slope = (total * S * T / delta, (k * k * T * C + p**3 * S) / delta)
    driven = p * p + k * k * sech * C
    source = (T * driven / delta + k * k * sech, p * driven / delta)
    mode = problem.mode(j)
    assert mode.impedance[0][:2] == (1, 0)
    assert mode.impedance[1][:2] == (0, 1)
    assert mode.source[:2] == (0, 0)
    # Some thirty roundings; Δ cancels by p S/|Δ| at most.
    bound = 30 * EPS * max(1.0, p * abs(S) / abs(delta))
    assert mode.impedance[0][2:] == pytest.approx(by_value, rel=bound)
    assert mode.impedance[1][2:] == pytest.approx(by_slope, rel=bound)
    assert mode.source[2:] == pytest.approx(source, rel=bound)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_determinant_vanishes_at_the_linear_resonances(driven_end: str) -> None:
    shape, numbers = static_beam(0.01, driven_end), doubles()
    for omega in linear_frequencies(0.01, 4, driven_end):
        below, above = (
            waves(shape, omega * (1 + sign * 1e-12), numbers).solve(0, 0, 1)[1] for sign in (-1, 1)
        )
        assert below * above < 0


def sizes(expansion: Expansion[Any], n: int) -> tuple[float, float, float]:
    """The residuals of order n, each over the sum of its terms' absolute values."""
    problem, frame = expansion.problem, moving_frame(expansion)
    beta = 1 / problem.mode(0).reduction[2]
    derivative = derivative_towers(expansion)
    equation = end = contact = 0.0
    for j, start in expansion.shape(n).items():
        stiffness = problem.mode(j).reduction[0]
        for d in range(expansion.order - n + 3):
            w = [derivative(n, j, d + i) for i in range(5)]
            scale = beta * (stiffness * abs(w[0]) + abs(w[2]) / beta + abs(w[4]))
            equation = max(equation, abs(problem.equation_residual(j, w)) / scale)
        p = beta**-0.5
        scale = sum(abs(x) / p**i for i, x in enumerate(start))
        for left, unit in zip(problem.end_residual(j, start), problem.end_unit(j), strict=True):
            drive = problem.drive[1] if n == 1 else 0
            end = max(end, abs(left - drive * unit) / scale)
    for e in range(3):
        parts = [series[e][n] for series in (frame.static, *frame.modes.values())]
        for j in {j for part in parts for j in part}:
            terms = [part[j] for part in parts if j in part]
            scale = max(map(abs, terms))
            contact = max(contact, abs(sum(terms)) / scale)
    return equation, end, contact


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("beta", "omega"), CASES)
def test_residuals_in_double_precision(beta: float, omega: float, driven_end: str) -> None:
    order = 5
    solution = expand(float_beam(beta, omega, order, driven_end), order)
    for n in range(1, order + 1):
        equation, end, contact = sizes(solution, n)
        # One product and sum a term; a score of roundings in the modes; N³ products in a condition.
        assert equation <= 8 * EPS
        assert end <= 64 * EPS
        assert contact <= order**3 * EPS


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_residuals_at_fifty_digits(driven_end: str) -> None:
    order = 5
    with mpmath.workdps(50):
        problem = beam_problem("0.01", "2.2", driven_end, digits())
        solution = expand(problem, order)
        frame = moving_frame(solution)
        for n in range(1, order + 1):
            left = residuals(solution, frame, n)
            assert max(abs(x) for x in left) < mpf(10) ** -30
            for j, start in solution.shape(n).items():
                wave = waves(
                    static_beam("0.01", driven_end, digits()), j * mpf("2.2") if j else 0, digits()
                )
                # Each of the two conditions by itself; half a unit drive is e^{iθ}'s.
                drive = [mpf(0.5) if n == 1 else 0, 0]
                for found, wanted in zip(end_residuals(wave, start), drive, strict=True):
                    assert abs(found - wanted) < mpf(10) ** -30 * wave.decay
            assert set(solution.contact(n)) == reachable([1], n)
            assert all(abs(c) > mpf(10) ** -3 for c in solution.contact(n).values())


def test_balls_enclose_zero_and_the_numbers() -> None:
    with at_precision(200):
        solution = expand(beam_problem("0.01", "2.2", "pinned", balls()), 4)
        frame = moving_frame(solution)
        with mpmath.workdps(60):
            numbers = expand(beam_problem("0.01", "2.2", "pinned", digits()), 4)
        for n in range(1, 5):
            for residual in residuals(solution, frame, n):
                assert residual.contains(0)
                assert residual.rad() < 1e-40
            for j, c in solution.contact(n).items():
                assert abs(c - arb(mpmath.nstr(numbers.contact(n)[j], 55))) < 1e-52
                assert 0 < c.rad() < 1e-45


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_static_shape_carries_its_weight(driven_end: str) -> None:
    """Order 0 of the proof: W₀ − βW₀⁗ … = 2, its derivatives 0, and both driven-end conditions."""
    with at_precision(200):
        problem = beam_problem("0.01", "2.2", driven_end, balls())
        for d in range(6):
            left = problem.equation_residual(0, [problem.static(d + i) for i in range(5)])
            left = left - (problem.load[0] if d == 0 else 0)
            assert left.contains(0)
            assert left.rad() < 1e-40
        assert problem.load == (2,)
        ends = problem.static_end_residual(problem.static)
        assert len(ends) == 2
        for end in ends:
            assert end.contains(0)
            assert end.rad() < 1e-40
    for rope in (
        beam_problem(0.01, 2.2, driven_end),
        beam_problem(np.array([0.01, 0.1]), 2.2, driven_end),
    ):
        left = rope.equation_residual(0, [rope.static(i) for i in range(5)])
        assert left == pytest.approx(rope.load[0], rel=8 * EPS)


def test_floats_are_the_digits_rounded() -> None:
    for beta, omega in CASES:
        found = expand(float_beam(beta, omega, 5), 5)
        with mpmath.workdps(60):
            exact = expand(beam_problem(beta, omega, "pinned", digits()), 5)
        for n in range(1, 6):
            # The Taylor sums hold p^n-fold larger terms that cancel: what the roundings refer to.
            scale = max(abs(x) for w in found.shape(n).values() for x in w) * abs(
                float(found.problem.inverse_leading)
            )
            for j, c in exact.contact(n).items():
                assert abs(found.contact(n)[j] - float(c)) <= 5**3 * EPS * scale


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_string_is_met_with_its_boundary_layer(driven_end: str) -> None:
    """ξ_c = ξ_c⁰ + √(β/(1 − ξ_c′²)) + O(β), harmonic by harmonic to order 3 in ε."""
    with mpmath.workdps(60):
        omega = mpf("2.2")
        limit = expand(string_problem(NumberRing(mpf), omega, lambda j: mpmath.cot(j * omega)), 3)
        sine = mpmath.sin(omega)
        a = 2 * limit.contact(1)[1] / sine
        b = 2 * limit.contact(2)[2] / sine**2
        # ½ξ_c′² with ξ_c′ = −εΩa sin θ − 2ε²Ωb sin 2θ, as c_j with c₀ + Σ 2c_j cos jθ.
        layer = {
            (2, 0): omega**2 * a**2 / 4,
            (2, 2): -(omega**2) * a**2 / 8,
            (3, 1): omega**2 * a * b / 2,
            (3, 3): -(omega**2) * a * b / 2,
        }
        errors: dict[tuple[int, int], list[mpf]] = {}
        for exponent in (6, 8, 10):
            beta = mpf(10) ** -exponent
            solution = expand(beam_problem(beta, omega, driven_end, digits()), 3)
            for n in (1, 2, 3):
                for j, c in solution.contact(n).items():
                    known = limit.contact(n)[j] / sine**n
                    known += mpmath.sqrt(beta) * layer.get((n, j), 0)
                    errors.setdefault((n, j), []).append(c - known)
        assert len(errors) == 5
        for first, second, third in errors.values():
            # Rate β, whose own correction is √β ≤ 1e-3 times a factor below 50 at order 3.
            assert first / second == pytest.approx(100, rel=0.1)
            assert second / third == pytest.approx(100, rel=0.02)


def test_complex_frequencies_continue_the_real_ones() -> None:
    """f(Ω̄) = conj f(Ω), and the mean over a circle is the value at its centre."""
    circle = 2.2 + 0.05 * np.exp(2j * np.pi * np.arange(32) / 32)
    around, centre = expand(beam_problem(0.01, circle), 3), expand(beam_problem(0.01, 2.2), 3)
    for n in (1, 2, 3):
        for j, c in centre.contact(n).items():
            values = around.contact(n)[j]
            assert values[1] == pytest.approx(values[-1].conjugate(), rel=1e3 * EPS)
            # The nearest pole, Ω₂/3, is 0.19 away: (0.05/0.19)^32 < 1e-18.
            assert values.mean() == pytest.approx(c, rel=1e3 * EPS)
            assert abs(values - c).max() > 1e-3 * abs(c)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-8, 5e-5, 0.01, 10.0])
def test_both_conditions_of_the_driven_end_enter_its_residual(beta: float, driven_end: str) -> None:
    """Each over its terms' magnitudes, of which the growing solution is none in the first."""
    solution = expand(float_beam(beta, 2.2, 2, driven_end), 2)
    assert max(proof.sizes[1] for proof in prove(solution)) < 1e-11
    problem, right = solution.problem, solution.shape(2)[2]
    rows = [problem.end_residual(2, [float(i == k) for i in range(4)]) for k in range(4)]
    conditions = list(zip(*rows, strict=True))
    sizes = [sum(abs(x * y) for x, y in zip(c, right, strict=True)) for c in conditions]

    def left(second: float, third: float) -> list[float]:
        found = problem.end_residual(2, [*right[:2], right[2] + second, right[3] + third])
        return [abs(x) / size for x, size in zip(found, sizes, strict=True)]

    for own, (_, _, x, y) in enumerate(conditions):
        change = 1e-3 * right[2]
        for wrong in (left(change, 0), left(0, 1e-3 * right[3])):
            assert min(wrong) > 5e-8
            assert wrong[1] > 9e-5
        unseen = left(change, -x / y * change)
        assert unseen[own] < 1e-11
        assert unseen[1 - own] > 2e-7


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 2.2, 3), "for β = 0 use the string"),
        ((-0.01, 2.2, 3), "beta = -0.01 is not positive"),
        ((math.nan, 2.2, 3), "beta = nan"),
        (("stiff", 2.2, 3), "beta = 'stiff' is not a number"),
        ((0.01, -1.0, 3), "Omega = -1.0"),
        ((0.01, "fast", 3), "Omega = 'fast' is not a number"),
        ((0.01, 2.2, 3, "free"), "choose one of pinned, clamped"),
    ],
)
def test_bad_input(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        float_beam(*arguments)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (1, 2), (2, 3)])
@pytest.mark.parametrize("beta", [1e-6, 1e-2, 1e2])
def test_resonances_are_refused_by_name(beta: float, p: int, q: int, driven_end: str) -> None:
    omega = float(linear_frequencies(beta, p, driven_end)[-1]) / q
    with pytest.raises(ResonanceError, match=f"p/q = {p}/{q}") as caught:
        float_beam(beta, omega, 3, driven_end)
    assert (caught.value.p, caught.value.q) == (p, q)
    float_beam(beta, omega * (1 + 1e-5), 3, driven_end)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [3e-10, 1e-8, 1e-2, 1e4])
def test_resonances_with_a_common_factor_are_poles_of_their_own(
    beta: float, driven_end: str
) -> None:
    """Ω₂(β)/2 is not Ω₁(β), not even where both are within the tolerance: β = 3e-10."""
    omega = float(linear_frequencies(beta, 2, driven_end)[-1]) / 2
    with pytest.raises(ResonanceError, match=r"Omega_2\(beta\)/2 .* p/q = 2/2, ") as caught:
        float_beam(beta, omega, 3, driven_end)
    assert (caught.value.p, caught.value.q) == (2, 2)
    if beta > 1e-9:
        assert "or ask for an order below 2" in str(caught.value)
        float_beam(beta, omega, 1, driven_end)
    else:
        assert str(caught.value).endswith("move Omega away")
