"""What must hold in every run: energy, W ≥ 0, one limit for both integrators, restarts, errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.errors import ActiveSetError, InputError
from numerics.exact_solutions.index import travelling_pulse
from numerics.problems.drive import Drive, at_rest, cosine, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation import run as simulation
from numerics.simulation.contact import Scheme, Simulator, equilibrium, run_steps
from numerics.simulation.observables import (
    COLUMNS,
    Column,
    contact_point,
    elastic_force,
    moving_size,
)
from numerics.simulation.run import follow, simulate
from numerics.simulation.semi_discrete import Grid, State, falling_bar, rope, string_on_obstacle
from tests.numerics.by_hand import EPS, move, order, richardson, undriven

both = pytest.mark.parametrize("scheme", list(Scheme))


# ---- energy, W ≥ 0, λ ≥ 0: many runs


def random_simulator(generator: np.random.Generator, scheme: Scheme) -> Simulator:
    """Somewhere in a wide box: β ≤ 1 or 0, |ε| ≤ .95, Ω ≤ 20, coarse and fine, either end."""
    choose, between = generator.choice, generator.uniform
    beta = float(choose([0.0, 1.0, 10 ** between(-4, 0)], p=[0.1, 0.1, 0.8]))
    epsilon = float(choose([0.95, -0.9, between(0.01, 0.9)], p=[0.1, 0.1, 0.8]))
    drive = ramped_cosine(10 ** between(-0.5, math.log10(20)), epsilon, between(0.05, 2))
    implicit = scheme is Scheme.TRAPEZOIDAL
    restitution = float(choose([0.0, 0.3, 0.8, 1.0])) if implicit else 0.0
    end, damping = choose(["pinned", "clamped"]), float(choose([0.0, 0.1, 2.0]))
    problem = RopeProblem(beta, drive, end, damping, restitution)
    coarsest = math.sqrt(beta) / 4 if 0 < beta < 1 else 0.25
    dx = max(coarsest * 10 ** between(-1.0, 0), min(coarsest, 0.006))
    sponge = float(choose([0.0, 0.3]))
    grid = Grid(dx, between(2.7, 4.0) + sponge, sponge, between(0, 20))
    dt = dx * 10 ** between(-1, 0.7) if implicit else None
    return Simulator(problem, grid, dt, scheme)


@pytest.mark.parametrize("seed", range(8))
@both
def test_energy_and_complementarity(scheme, seed):
    """25 runs each. The energy sums 5n products k₀W² and more; each is rounded once."""
    generator = np.random.default_rng([seed, 2026])
    lifted = lost = 0.0
    for _ in range(25):
        simulator = random_simulator(generator, scheme)
        until = min(250 * simulator.dt, 4.0)
        rows = np.concatenate([block.rows for block in simulator.blocks(until)])
        system = simulator.system
        bands = system.stiffness[0].max()
        highest = max(2.0, simulator.state.height.max(), np.nanmax(rows[:, Column.BUMP]))
        rounding = EPS * bands * highest**2
        assert 0 < simulator.unexplained <= 4 * system.size * rounding
        assert (np.diff(rows[:, Column.LOST], prepend=0.0) >= -rounding).all()
        assert (np.diff(rows[:, Column.DAMPED], prepend=0.0) >= 0).all()
        assert rows[:, Column.LOWEST].min() >= 0
        push = EPS * (bands + 4 * system.mass[0] / simulator.dt**2) * highest / system.dx
        assert rows[:, Column.REACTION].min() >= -64 * push
        change = rows[-1, Column.ENERGY] - system.energy(*start_of(simulator))
        done = rows[-1, Column.WORK] - rows[-1, Column.DAMPED] - rows[-1, Column.LOST]
        assert change == pytest.approx(done, abs=len(rows) * simulator.unexplained)
        lifted, lost = max(lifted, np.abs(done)), max(lost, rows[-1, Column.LOST])
    assert lifted > 1e-2
    assert lost > 1e-3


def start_of(simulator: Simulator) -> tuple[np.ndarray, np.ndarray, float]:
    end = float(simulator.problem.drive.height(np.zeros(1))[0])
    state = equilibrium(simulator.system, end)
    return state.height, state.velocity, end


@both
def test_energy_is_that_of_the_state(scheme):
    """The ledger's E, recomputed from the state; Verlet's is that of two neighbouring times."""
    simulator = Simulator(RopeProblem(0.01, cosine(2.5, 0.3)), Grid(0.02, 3.0, 0.0), scheme=scheme)
    (block,) = simulator.blocks(1.0)
    end = float(simulator.problem.drive.height(np.array(simulator.time)))
    energy = simulator.system.energy(simulator.state.height, simulator.state.velocity, end)
    tolerance = 1e-11 if scheme is Scheme.TRAPEZOIDAL else 5 * simulator.dt
    assert block.rows[-1, Column.ENERGY] == pytest.approx(energy, abs=tolerance)


# ---- one limit


@pytest.fixture(scope="module")
def forced() -> RopeProblem:
    return RopeProblem(0.04, ramped_cosine(2.5, 0.05, 0.5))


def history(problem, dx, dt, scheme, samples=40, until=4.0) -> tuple[np.ndarray, np.ndarray]:
    """ξ_c and the height at ξ = ½, at ``samples`` times."""
    run = simulate(
        problem, until, Grid(dx, 2.5, 0.0), dt, scheme, record_from=0.0, snapshots=until / samples
    )
    step = round(until / samples / dt)
    middle = round(0.5 / dx) - 1
    return run.rows[step - 1 :: step, Column.CONTACT], run.heights[1:, middle]


def test_verlet_order_in_dt(forced):
    runs = [history(forced, 0.05, 0.00125 / 2**k, Scheme.VERLET) for k in range(5)]
    contact, height = zip(*runs, strict=True)
    assert 1.5 < richardson(height) < 2.5
    assert 1.5 < richardson(contact) < 2.5


def test_trapezoidal_order_in_dt(forced):
    """Same grid: it comes to the explicit integrator's limit. Limited by what is not smooth: nodes
    come down and are released at times rounded to a step, which leaves grid-scale bending waves;
    ξ_c, formed from forces, feels them and is of first order, the height better than that."""
    limit = history(forced, 0.05, 0.00125 / 16, Scheme.VERLET)
    steps, contact, height = 0.05 / 4.0 ** np.arange(5), [], []
    for dt in steps:
        run = history(forced, 0.05, float(dt), Scheme.TRAPEZOIDAL)
        contact.append(np.sqrt(np.mean((run[0] - limit[0]) ** 2)))
        height.append(np.abs(run[1] - limit[1]).max())
    assert 0.6 < order(steps, contact) < 1.3
    assert 1.3 < order(steps, height) < 2.1
    assert contact[-1] < 2e-4
    assert height[-1] < 2e-6
    assert np.ptp(limit[0]) > 0.05


def test_both_integrators_have_one_limit(forced):
    """dx → 0, dt with dx or dx²: they approach each other and a limit."""
    sizes, contact, height = [0.05, 0.025, 0.0125], [], []
    implicit, explicit = [], []
    for dx in sizes:
        implicit.append(history(forced, dx, dx / 2, Scheme.TRAPEZOIDAL))
        explicit.append(history(forced, dx, dx * dx / 2, Scheme.VERLET))
        contact.append(np.sqrt(np.mean((implicit[-1][0] - explicit[-1][0]) ** 2)))
        height.append(np.abs(implicit[-1][1] - explicit[-1][1]).max())
    assert 0.9 < order(sizes, contact) < 2.2
    assert 1.4 < order(sizes, height) < 2.6
    assert contact[-1] < 0.02 * np.ptp(explicit[-1][0])
    implicit.append(history(forced, 0.00625, 0.003125, Scheme.TRAPEZOIDAL))
    assert 1.4 < richardson([run[1] for run in implicit]) < 2.6
    assert 0.9 < richardson([run[0] for run in implicit]) < 2.2


# ---- damping and the absorbing end


@both
def test_damping(scheme):
    """A string that never meets the obstacle: sin πx cos-like, decaying as e^{−ζτ}."""
    zeta, errors, cells = 0.7, [], [20, 40, 80]
    for count in cells:
        system = string_on_obstacle(count - 1)
        system = system._replace(
            damping=2 * zeta * system.mass, obstacle=np.zeros(system.size, bool)
        )
        shape, omega = np.sin(np.pi * system.positions), math.sqrt(math.pi**2 - zeta**2)
        dt, steps = 0.5 / count, 4 * count

        def exact(t, omega=omega):
            return math.exp(-zeta * t) * (math.cos(omega * t) + zeta / omega * math.sin(omega * t))

        run = move(system, scheme, dt, steps, shape, 0 * shape, exact(-dt) * shape)
        errors.append(np.abs(run.heights[-1] - exact(2.0) * shape).max())
        taken = run.rows[-1, Column.DAMPED] / system.energy(shape, 0 * shape)
    assert 1.8 < order(1 / np.array(cells), errors) < 2.2
    assert taken > 0.9


def test_no_damping_without_it(forced):
    run = simulate(forced, 2.0, Grid(0.05, 2.5, 0.0), record_from=0.0)
    assert (run.column(Column.DAMPED) == 0).all()
    damped = RopeProblem(forced.beta, forced.drive, damping=0.5)
    assert simulate(damped, 2.0, Grid(0.05, 2.5, 0.0)).ledger[2] > 1e-5


def after_the_pulse(length: float, sponge: float, strength: float) -> np.ndarray:
    """Energy taken by damping and by contact, and left, of a pulse sent against the end."""
    beta, speed, dx, begin = 0.01, 1.2, 0.02, 0.9
    pulse = travelling_pulse(beta, speed)
    grid = Grid(dx, length, sponge, strength)
    system = undriven(rope(RopeProblem(beta, at_rest()), grid))
    zeta, dt = system.positions - begin, 0.5 * dx
    steps = round(2 * (length - begin) / speed / dt)
    early = pulse.shape(zeta + speed * dt)
    run = move(
        system, Scheme.TRAPEZOIDAL, dt, steps, pulse.shape(zeta), pulse.velocity(zeta), early
    )
    return run.rows[-1, [Column.DAMPED, Column.LOST, Column.ENERGY]] / pulse.energy


def test_absorbing_end():
    """The sponge takes the pulse; nothing comes back. What it leaves strikes the hard end."""
    damped, lost, left = after_the_pulse(5.0, 3.0, 3.0)
    assert damped > 0.9
    assert 0 < lost < 0.1
    assert abs(left) < 1e-12
    stronger = after_the_pulse(5.0, 3.0, 10.0)
    assert stronger[1] < 0.5 * lost
    hard = after_the_pulse(5.0, 0.0, 0.0)
    assert hard[0] == 0
    assert hard[1] > 0.9


# ---- restarts


@both
def test_pieces_are_bit_for_bit_one_run(forced, scheme):
    grid = Grid(0.02, 3.0, 0.5)
    whole, pieces = (Simulator(forced, grid, 0.0007, scheme) for _ in range(2))
    rows = np.concatenate([block.rows for block in whole.blocks(2.5)])
    parts = []
    for until in (0.001, 0.3, 0.301, 0.7168, 0.9, 1.777, 2.5):
        parts += [block.rows for block in pieces.blocks(until, every=37)]
    assert len(parts) > 50
    np.testing.assert_array_equal(np.concatenate(parts), rows)
    np.testing.assert_array_equal(pieces.ledger, whole.ledger)
    for mine, theirs in zip(pieces.state, whole.state, strict=True):
        np.testing.assert_array_equal(mine, theirs)
    assert pieces.step == whole.step == math.ceil(2.5 / 0.0007)
    assert list(pieces.blocks(2.5)) == []


def test_follow_continues(forced):
    grid, period = Grid(0.05, 2.5, 0.0), forced.drive.period
    simulator = Simulator(forced, grid)
    follow(simulator, period)
    second = follow(simulator, 2 * period, snapshots=0.25)
    whole = simulate(forced, 2 * period, grid)
    np.testing.assert_array_equal(second.end.height, whole.end.height)
    assert len(second.heights) == len(second.snapshot_times) == len(second.held)
    # Snapshots are taken at multiples of 0.25, and where it begins.
    assert np.diff(second.snapshot_times[1:]) == pytest.approx(0.25)
    with pytest.raises(InputError, match="later time"):
        follow(simulator, period)


def test_contact_set_is_the_ground(forced):
    """``held`` nodes are at W = 0 exactly, the others above."""
    run = simulate(forced, 3.0, Grid(0.05, 2.5, 0.0), snapshots=0.1)
    assert (run.heights[run.held] == 0).all()
    assert (run.heights[~run.held] > 0).all()
    assert 0 < run.held.mean() < 1


@pytest.mark.parametrize("push", [2.5, -2.5])
def test_a_single_node_on_the_ground_is_pushed_up_or_not_at_all(push):
    """P is the elastic force that presses the node down, never one that would lift it."""
    system = rope(RopeProblem(0.01, at_rest()), Grid(0.02, 2.5, 0.0))
    held, force = np.zeros(system.size, bool), np.zeros(system.size)
    held[40], force[40] = True, push
    assert contact_point(system, force, held) == (system.positions[40], max(push, 0.0), 40)


@pytest.mark.parametrize("size", range(4, 11))
def test_the_elastic_force_is_that_of_the_whole_matrix(size):
    """Every entry of K counts at its place, also where a rope would have equal ones."""
    rng = np.random.default_rng(size)
    n = 10
    bands, height, force = rng.normal(size=(3, n)), rng.normal(size=n), np.zeros(n)
    bands[1, -1:] = bands[2, -2:] = 0.0
    height[size:] = 0.0
    k0, k1, k2 = bands
    matrix = np.diag(k0) + np.diag(k1[:-1], 1) + np.diag(k2[:-2], 2)
    matrix += np.triu(matrix, 1).T
    elastic_force(bands, height, size, force)
    np.testing.assert_allclose(force[:size], (matrix @ height)[:size], rtol=0, atol=1e-14)


@pytest.mark.parametrize("last", range(6))
def test_the_moving_part_ends_with_the_last_node_that_is_not_at_rest(last):
    for up, down in ((1.0, 0.0), (0.0, -1.0)):
        height, velocity = np.zeros(6), np.zeros(6)
        height[last], velocity[last] = up, down
        assert moving_size(height, velocity, False) == last + 1
        assert moving_size(height, velocity, True) == 6
    assert moving_size(np.zeros(6), np.zeros(6), False) == 0


def test_weightless_string_at_rest():
    """No load, no force, so no contact point between the nodes; and no division by it."""
    system = string_on_obstacle(20)
    for scheme in Scheme:
        still = np.zeros(system.size)
        # Verlet holds only nodes that are pushed: here every second one.
        state = State(still.copy(), still.copy(), np.arange(20) % 3 > 0)
        rows = np.empty((3, COLUMNS))
        assert run_steps(system, scheme, 0.01, 0.0, np.zeros(5), state, np.zeros(4), rows) == 3
        assert (state.height == 0).all()


def test_rows_are_kept_of_a_drive_without_a_period(monkeypatch):
    """Sampled or spline drives know no Ω: all rows, or the last of too many."""
    table = np.linspace(0, 2, 41)
    sampled = Drive(
        lambda t: np.interp(t, table, 1 + 0.01 * table**2),
        lambda t: np.interp(t, table, 0.02 * table),
        "sampled",
    )
    run = simulate(RopeProblem(0.01, sampled), 2.0, Grid(0.02, 2.5, 0.0))
    np.testing.assert_allclose(run.times, 0.02 * np.arange(1, 101))
    times, contact = run.smooth_contact()
    assert contact[-1] > contact[0]
    assert len(times) == len(contact) == 100
    monkeypatch.setattr(simulation, "ROWS", 70)
    run = simulate(RopeProblem(0.01, sampled), 2.0, Grid(0.02, 2.5, 0.0))
    assert len(run.times) in (70, 71)
    assert run.times[-1] == pytest.approx(2.0)


def test_a_step_that_does_not_end_is_an_error_and_the_state_before_it_is_kept(monkeypatch):
    def three(system, scheme, dt, restitution, heights, state, ledger, rows):
        steps = min(3, len(rows))
        return run_steps(
            system, scheme, dt, restitution, heights[: steps + 2], state, ledger, rows[:steps]
        )

    problem = RopeProblem(0.01, ramped_cosine(2.5, 0.05, 5))
    broken, whole = (Simulator(problem, Grid(0.02, 3.0, 0.0)) for _ in range(2))
    for _ in whole.blocks(3 * whole.dt):
        pass
    monkeypatch.setattr("numerics.simulation.contact.run_steps", three)
    with pytest.raises(ActiveSetError, match=r"the active set of step 4 \(tau = 0\.06\)"):
        next(broken.blocks(1.0))
    assert broken.step == 3
    np.testing.assert_array_equal(broken.state.height, whole.state.height)
    assert broken.unexplained == whole.unexplained


def test_nodes_stand_where_they_say():
    """Equally spaced, from the driven end; the bar's first node is its lower end itself."""
    system = Simulator(RopeProblem(0.01, cosine(2.5, 0.05)), Grid(dx=0.02, length=6.0)).system
    nodes = np.arange(system.positions.size)
    assert np.array_equal(system.positions, 0.02 * (nodes + 1))
    bar = falling_bar(50)
    assert np.array_equal(bar.positions, bar.dx * np.arange(bar.positions.size))
    assert bar.positions[-1] == pytest.approx(10.0, abs=1.01 * bar.dx)
