"""Springs instead of ground: a third method, which goes to the simulators' answer as κ → ∞."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from numerics.errors import InputError, NumericsError
from numerics.exact_solutions.index import static_contact_point
from numerics.problems.drive import Drive, at_rest, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme
from numerics.simulation.penalty import PenaltyGround, penalty_ground, solve
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid
from tests.numerics.by_hand import order

DX, UNTIL, SAMPLES = 0.05, 1.8, 18
GRID = Grid(DX, 2.5, 0.0)
HARD = np.array([1e6, 4e6, 1.6e7])


@pytest.fixture(scope="module")
def forced() -> RopeProblem:
    return RopeProblem(0.04, ramped_cosine(2.5, 0.05, 0.4))


def unilateral(problem: RopeProblem, restitution: float, scheme: Scheme, dt: float):
    problem = RopeProblem(problem.beta, problem.drive, restitution=restitution)
    spacing = UNTIL / SAMPLES
    run = simulate(problem, UNTIL, GRID, dt, scheme, record_from=0.0, snapshots=spacing)
    step = round(spacing / dt)
    return run.heights[1:], run.rows[step - 1 :: step, 0]


@pytest.fixture(scope="module")
def springs(forced):
    times = UNTIL / SAMPLES * np.arange(1, SAMPLES + 1)
    return [
        solve(penalty_ground(forced, GRID, kappa), times, "LSODA", 1e-7, 1e-10) for kappa in HARD
    ]


@pytest.mark.slow
@pytest.mark.parametrize("scheme", list(Scheme))
def test_limit_of_hard_springs(forced, springs, scheme):
    """dx fixed, κ ≫ ω_max²: first order in 1/κ, the time a strike lasts being of order 1/√κ."""
    restitution = springs_restitution(forced) if scheme is Scheme.TRAPEZOIDAL else 0.0
    dt = 5e-5 if scheme is Scheme.TRAPEZOIDAL else 1e-4
    height, contact = unilateral(forced, restitution, scheme, dt)
    errors = [np.abs(run.heights - height).max() for run in springs]
    assert 0.6 < order(1 / HARD, errors) < 1.4
    assert errors[-1] < 1e-5 < errors[0]
    difference = np.sqrt(np.mean((springs[-1].contact - contact) ** 2))
    assert difference < 0.01 * np.ptp(contact)
    assert np.ptp(contact) > 0.02


def springs_restitution(problem: RopeProblem) -> float:
    return penalty_ground(problem, GRID, 1e6).restitution


def test_soft_springs_are_felt(forced, springs):
    """Below ω_max² = 4/dx² + 16β/dx⁴ = 1e5 the rope sinks in: the contact point is elsewhere."""
    soft = solve(penalty_ground(forced, GRID, 1e3), springs[0].times)
    assert np.abs(soft.contact - springs[-1].contact).max() > 0.05
    # A rope at rest sinks by 2/κ; at the contact point there is a point force more.
    for kappa, run in zip([1e3, *HARD], [soft, *springs], strict=True):
        assert -40 < run.heights.min() * kappa < -2


@pytest.mark.parametrize("method", ["LSODA", "BDF", "Radau", "RK45"])
def test_any_method(method):
    drive = ramped_cosine(2.5, 0.05, 0.4)
    ground = penalty_ground(RopeProblem(0.04, drive), Grid(0.05, 2.0, 0.0), 1e5)
    run = solve(ground, [0.25, 0.5], method, 1e-6, 1e-9)
    other = solve(ground, [0.25, 0.5], "DOP853", 1e-9, 1e-12)
    np.testing.assert_allclose(run.heights, other.heights, rtol=0, atol=1e-5)
    assert run.evaluations > 10


@pytest.mark.parametrize("eta", [0.0, 0.3, 1.0, 1.7])
def test_restitution_of_a_strike(eta):
    """m Ẅ = λ from W = 0, Ẇ = −1: the ground lets go at the speed r."""
    ground = penalty_ground(RopeProblem(0.04, at_rest()), GRID, 1e4, eta)
    one = np.zeros(ground.system.size)

    def rate(_, y):
        height, velocity = one - 1.0, one
        height[0], velocity[0] = y
        return [y[1], ground.reaction(height, velocity)[0] / DX]

    end = solve_ivp(rate, (0, 0.5), [-1e-12, -1.0], method="LSODA", rtol=1e-10, atol=1e-13)
    # 0.5 is long against 1/√κ = 0.01; for η > 1 the ground lets go before the node is out of it.
    assert end.y[1, -1] == pytest.approx(ground.restitution, abs=1e-5)


def test_equations(forced):
    """The right-hand side is m Ẅ = λ − cẆ − KW − bZ − f, by dense algebra."""
    problem = RopeProblem(0.04, forced.drive, damping=0.3)
    ground = penalty_ground(problem, GRID, 1e4, 0.5)
    system, n = ground.system, ground.system.size
    generator = np.random.default_rng(1)
    y = generator.normal(size=2 * n)
    k0, k1, k2 = system.stiffness
    full = np.diag(k0)
    for k, band in ((1, k1), (2, k2)):
        full += np.diag(band[:-k], k) + np.diag(band[:-k], -k)
    height, velocity = y[::2], y[1::2]
    push = np.where(height < 0, np.maximum(-1e4 * height - 100 * velocity, 0), 0) * DX
    pull = np.zeros(n)
    pull[:2] = np.array(system.drive) * float(forced.drive.height(np.array(0.7)))
    total = push - 2 * 0.3 * DX * velocity - full @ height - pull - 2 * DX
    rate = ground.rhs(0.7, y)
    np.testing.assert_array_equal(rate[::2], velocity)
    np.testing.assert_allclose(rate[1::2], total / DX, rtol=1e-12, atol=1e-8)
    assert (push > 0).any()


@pytest.mark.parametrize("kappa", [1e3, 1e7])
def test_at_rest(kappa):
    ground = penalty_ground(RopeProblem(0.04, at_rest()), GRID, kappa)
    assert np.abs(ground.rhs(0.0, ground.start)).max() < 1e-9 * kappa
    assert ground.start[2 * 40] == pytest.approx(-2 / kappa, rel=0.05 if kappa < 1e4 else 1e-4)
    if kappa > 1e6:
        found = ground.contact(ground.start[::2])
        assert found == pytest.approx(static_contact_point(0.04), abs=DX**2)


def test_bad_input(forced):
    for stiffness, damping, said in [(0.0, 1.0, "stiffness"), (1e4, -1.0, "damping")]:
        with pytest.raises(InputError, match=said):
            penalty_ground(forced, GRID, stiffness, damping)
    with pytest.raises(InputError, match="√β/4"):
        penalty_ground(forced, Grid(0.2), 1e4)
    ground = penalty_ground(forced, GRID, 1e4)
    for times in ([0.2, 0.1], [], [-1.0, 1.0], [0.0], [[1.0]], [math.nan]):
        with pytest.raises(InputError, match="increasing times"):
            solve(ground, times)

    for options in ({"method": "euler"}, {"rtol": -1.0}, {"atol": math.nan}, {"times": ["soon"]}):
        with pytest.raises(InputError, match=next(iter(options))):
            solve(ground, **({"times": [0.1]} | options))


def test_no_answer_is_said(forced):
    drive = Drive(lambda t: np.where(t > 0.1, np.nan, 1.0), np.zeros_like, "stops")
    ground = penalty_ground(RopeProblem(0.04, drive), GRID, 1e4)
    assert isinstance(ground, PenaltyGround)
    with pytest.raises(NumericsError, match="gave up"):
        solve(ground, [0.5])
