"""Tension and mass that vary along the rope: against Bessel functions, and the simulator."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from flint import acb, arb
from scipy.optimize import fsolve
from scipy.special import jv, yv

from asymptotics import expand, prove
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion
from asymptotics.formulas.rope import rope_forms
from asymptotics.printing.rope_latex import rope_latex
from asymptotics.printing.rope_modules import rope_javascript, rope_numpy
from asymptotics.problems.fundamental import Propagator
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.problems.varying import VaryingPropagator
from asymptotics.rings.precision import at_precision
from asymptotics.rings.ring import FloatRing
from asymptotics.values.rope import evaluate_rope
from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid

GAMMA, BETA = sp.symbols("gamma beta")
DRIVE = sp.Eq(W, 1 + epsilon * sp.cos(Omega * tau))


def string_of(tension: sp.Expr, mass: sp.Expr = sp.S.One) -> MovingContact:
    return moving_contact(
        equation=sp.Eq(mass * W.diff(tau, 2), (tension * W.diff(xi)).diff(xi) - 2),
        driven_end=[DRIVE],
        contact=[W, W.diff(xi)],
    )


def state_under_tension(
    gamma: float, omega: float, size: float, rest: float, harmonics: int
) -> np.ndarray:
    """ξ_c at equal times for T = 1 + γξ, from Bessel functions of 2jΩ√T/γ; nothing is expanded."""
    count = 2 * harmonics + 1
    times = 2 * np.pi * np.arange(count) / count

    def solutions(j: int, x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """(W, T W′) of one that vanishes at the driven end, and of one that is 1 there."""
        k, root = 2 * j * omega / abs(gamma), np.sqrt(1 + gamma * x)
        j0, y0 = jv(0, k * root), yv(0, k * root)
        # T d/dξ f(k√T) = kγ√T f′(k√T)/2, and f′ = −f₁ for both.
        j1, y1 = -k * gamma * root / 2 * jv(1, k * root), -k * gamma * root / 2 * yv(1, k * root)
        a, b = jv(0, k), yv(0, k)
        free = (b * j0 - a * y0, b * j1 - a * y1)
        size = a * a + b * b
        return [free, ((a * j0 + b * y0) / size, (a * j1 + b * y1) / size)]

    def left_over(place: np.ndarray) -> np.ndarray:
        columns, sides = [], []
        for i in (0, 1):
            log = np.log(1 + gamma * place) / gamma
            rest_part = [1 + 2 * place / gamma - 2 * log / gamma, 2 * place][i]
            row, side = [[log, np.ones(count)][i]], -rest_part
            for j in range(1, harmonics + 1):
                free, one = solutions(j, place)
                row += [free[i] * np.cos(j * times), free[i] * np.sin(j * times)]
                if j == 1:
                    side = side - size * one[i] * np.cos(times)
            columns.append(np.stack(row, axis=1))
            sides.append(side)
        # The slope vanishes for weights that are linear; the height is then to vanish, too.
        weights = np.linalg.solve(columns[1], sides[1])
        return columns[0] @ weights - sides[0]

    found, _, status, message = fsolve(
        left_over, np.full(count, rest), full_output=True, xtol=1e-13
    )
    assert status == 1 or np.max(np.abs(left_over(found))) < 1e-11, message
    return np.asarray(found)


def partial_sums(series: Expansion, size: float, theta: np.ndarray) -> list[np.ndarray]:
    total = np.full(len(theta), complex(series.problem.rest or 0).real)
    found = []
    for n in range(1, series.order + 1):
        for j, c in series.contact(n).items():
            total = total + size**n * ((2 if j else 1) * c * np.exp(1j * j * theta)).real
        found.append(total)
    return found


@pytest.mark.parametrize("gamma", [0.3, -0.25])
def test_each_order_removes_one_power_of_the_error(gamma: float) -> None:
    series = expand(string_of(1 + GAMMA * xi), 4, at={GAMMA: gamma, Omega: 2.0})
    assert prove(series).holds
    rest = complex(series.problem.rest or 0).real
    # (1 + γξ)W′ = 2(ξ − ξ₀) from W = 1: the length in closed form.
    c = 1 + 2 * rest / gamma - 2 * (1 / gamma + rest) * np.log(1 + gamma * rest) / gamma
    assert abs(c) < 1e-13
    theta = 2 * np.pi * np.arange(15) / 15
    errors = []
    for size in (2e-2, 1e-2):
        state = state_under_tension(gamma, 2.0, size, rest, 7)
        errors.append([np.max(np.abs(p - state)) for p in partial_sums(series, size, theta)])
    for n, (coarse, fine) in enumerate(zip(*errors, strict=True), start=1):
        assert fine < 1e-11 or abs(np.log2(coarse / fine) - (n + 1)) < 0.3, (n, errors)


def test_constant_coefficients_in_disguise() -> None:
    """γ = 0 is the string, and both propagators are one: the Taylor steps against FLINT's exp."""
    plain = expand(string_of(sp.S.One), 3, at={Omega: 2.2})
    same = expand(string_of(1 + GAMMA * xi), 3, at={GAMMA: 0, Omega: 2.2})
    for n in range(1, 4):
        assert plain.contact(n) == same.contact(n)
    with at_precision(160):
        numbers = (3.0, 0.5, -1.0, 0.25, 0.7)
        load = [acb(-2), acb(1), acb(0.5)]
        one = VaryingPropagator(tuple([acb(c)] for c in numbers), load, arb(1.3))
        other = Propagator(tuple(map(acb, numbers)), one.load)
        for found in (one.backwards(arb(1.3)), one.stepwise(arb(1.3))):
            left = found - other.backwards(arb(1.3))
            assert all(x.contains(0) for x in left.entries())
            assert max(float(abs(x).upper()) for x in left.entries()) < 1e-35


def test_enclosures_hold_the_solution_where_terms_are_few() -> None:
    """Airy's equation w″ = ξw over a long way: the ball of few bits holds the one of many."""

    def way(bits: int) -> list[acb]:
        with at_precision(bits):
            equation = VaryingPropagator(([acb(0), acb(-1)], [acb(0)], [acb(1)]), [], arb(4))
            return list(equation.between(arb(4), arb(-3)).entries())

    for coarse, fine in zip(way(60), way(300), strict=True):
        assert coarse.contains(fine)
        assert float(abs(coarse).rad()) < 1e-8
    # Thin layers, large coefficients, a load: few bits must still hold what many bits know.
    numbers = (40.0, 0.3, -1.0, 0.2, 1e-3)

    def layers(bits: int) -> list[acb]:
        with at_precision(bits):
            load = [acb(-200), acb(30), acb(7)]
            equation = VaryingPropagator(tuple([acb(c)] for c in numbers), load, arb(2))
            return list(equation.between(arb(2), arb(1)).entries())

    with at_precision(300):
        exact_load = VaryingPropagator(([acb(1)], [acb(1)]), [acb(-200), acb(30), acb(7)], arb(2))
        other = Propagator(tuple(map(acb, numbers)), exact_load.load)
        exact_layers = list(other.backwards(arb(1)).entries())
    for coarse, fine in zip(layers(80), exact_layers, strict=True):
        assert coarse.contains(fine)
    with at_precision(100):
        value = way(100)[0]
        # Ai(−3) Bi′(4) − Bi(−3) Ai′(4) over the Wronskian 1/π.
        pi = arb.pi()
        exact = pi * (
            arb(-3).airy_ai() * arb(4).airy_bi(derivative=1)
            - arb(-3).airy_bi() * arb(4).airy_ai(derivative=1)
        )
        assert (value - acb(exact)).contains(0)


@pytest.mark.slow
def test_a_beam_of_varying_mass_against_the_simulator() -> None:
    """β = .05, m = 1 + ξ/5, T = 1 + ξ/10: ξ_c of the simulated rope, to its grid's error.

    Not at Ω = 1.6, where the ramp leaves a free oscillation of 5e-4 next to 2Ω.
    """
    rope = moving_contact(
        equation=sp.Eq(
            (1 + xi / 5) * W.diff(tau, 2),
            ((1 + xi / 10) * W.diff(xi)).diff(xi) - 2 - BETA * W.diff(xi, 4),
        ),
        driven_end=[DRIVE, sp.Eq(W.diff(xi, 2), 0)],
        contact=[W, W.diff(xi), W.diff(xi, 2)],
    )
    omega, size = 1.9, 0.02
    series = expand(rope, 3, at={BETA: 0.05, Omega: omega})
    assert prove(series).holds
    drive = ramped_cosine(omega, size, 20)
    problem = RopeProblem(0.05, drive, tension=[1.0, 0.1], mass=[1.0, 0.2])
    run = simulate(problem, 22 * drive.period, Grid(0.01, 8.0), record_from=20 * drive.period)
    times, contact = run.smooth_contact()
    inner = (times > 20.5 * drive.period) & (times < 21.5 * drive.period)
    errors = [
        float(np.sqrt(np.mean((p[inner] - contact[inner]) ** 2)))
        for p in partial_sums(series, size, omega * times)
    ]
    amplitude = size * 2 * abs(series.contact(1)[1])
    assert errors[2] < 0.02 * amplitude
    assert errors[2] < errors[0] / 2


def test_the_proof_sees_a_wrong_coefficient() -> None:
    series = expand(string_of(1 + GAMMA * xi), 2, at={GAMMA: 0.3, Omega: 2.0})
    order = series.orders[1]
    moved = {j: c * (1 + 1e-6) for j, c in order.contact.items()}
    wrong = Expansion(
        series.problem, (series.orders[0], type(order)(moved, order.shape, order.tails))
    )
    with pytest.raises(Exception, match="inconsistent"):
        prove(wrong)


def test_formulas_in_impedances_hold_for_them_too() -> None:
    rope, at = string_of(1 + GAMMA * xi), {GAMMA: 0.3, Omega: 2.0}
    forms, series = rope_forms(rope, 3), expand(string_of(1 + GAMMA * xi), 3, at=at)
    values = forms.values(at)
    for n, j in forms.places():
        element = forms.contact(n, j)
        found = forms.expansion.problem.ring.evaluate(element, values, FloatRing())
        direct = series.contact(n)[j] * (2 if j else 1)
        assert abs(found / values["a_m"] ** n / direct - 1) < 1e-12
    assert "companion" not in rope_latex(forms)
    for printer in (rope_numpy, rope_javascript):
        with pytest.raises(InputError, match="constant coefficients"):
            printer(forms)


def test_what_is_not_offered_is_refused() -> None:
    rope, at = string_of(1 + GAMMA * xi), {GAMMA: 0.3, Omega: 2.0}
    result = evaluate_rope(rope, at, 0.01, 2, None, [0.0, 1.0])
    assert result.contact.shape == (2,)
    assert result.profile.size == 0
    with pytest.raises(InputError, match="profile is not offered"):
        evaluate_rope(rope, at, 0.01, 2, [-0.1], [0.0])
    with pytest.raises(InputError, match="one by one"):
        expand(rope, 2, at={GAMMA: np.array([0.1, 0.2]), Omega: 2.0})
    with pytest.raises(InputError, match="polynomial in xi"):
        string_of(sp.exp(xi))
    with pytest.raises(InputError, match="constant coefficients"):
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), (1 + xi) * W.diff(xi, 2) - 2),
            driven_end=[DRIVE],
            contact=[W],
            springs=3,
        )
    with pytest.raises(InputError, match=r"vanishes near xi = 0\.2"):
        expand(string_of(1 - 5 * xi), 1, at={Omega: 2.0})
