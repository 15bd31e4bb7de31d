"""Both integrators against exact solutions, with the orders at which they approach them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.exact_solutions.index import (
    bouncing_bar,
    plucked_string,
    static_contact_point,
    static_shape,
    travelling_pulse,
)
from numerics.exact_string.characteristics import exact_string_motion
from numerics.problems.drive import at_rest, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid, falling_bar, rope, string_on_obstacle
from tests.numerics.by_hand import Motion, move, order, undriven

both = pytest.mark.parametrize("scheme", list(Scheme))


# ---- the rope at rest


def worst_at_rest(beta: float, end: str, size: float, scheme: Scheme) -> tuple[float, float]:
    """Errors of ξ_c and W; they depend on where ξ₀ lies between two nodes: the worst of nine."""
    exact, contact, shape = static_contact_point(beta, end), 0.0, 0.0
    for dx in size * np.linspace(0.84, 1.16, 9):
        grid = Grid(dx, dx * round(2.5 / dx), 0.0)
        simulator = Simulator(RopeProblem(beta, at_rest(), end), grid, scheme=scheme)
        (block,) = simulator.blocks(3 * simulator.dt)
        found = block.rows[:, Column.CONTACT]
        assert np.ptp(found) <= 1e-10  # it stays at rest: K is worth 1e5 roundings
        contact = max(contact, abs(found[-1] - exact))
        difference = simulator.state.height - static_shape(simulator.system.positions, beta, end)
        shape = max(shape, np.abs(difference).max())
    return contact, shape


@both
@pytest.mark.parametrize("end", ["pinned", "clamped"])
@pytest.mark.parametrize("beta", [0.0, 1e-3, 1e-2, 1e-1])
def test_rope_at_rest(beta, end, scheme):
    """Lift-off point and shape: second order."""
    coarse = 0.05 if beta == 0 else min(0.04, math.sqrt(beta) / 5)
    sizes = coarse / 2.0 ** np.arange(3)
    contact, shape = zip(*(worst_at_rest(beta, end, dx, scheme) for dx in sizes), strict=True)
    assert 1.6 < order(sizes, contact) < 2.4
    assert 1.6 < order(sizes, shape) < 2.4
    assert contact[-1] < 2 * sizes[-1] ** 2 / (math.sqrt(beta) or 1)
    assert shape[-1] < sizes[-1] ** 2 / (math.sqrt(beta) or 1)


# ---- the pulse that runs along the ground

BETA, SPEED, BEGIN, TIME = 0.01, 1.5, 1.0, 0.6


def pulse_run(scheme: Scheme, dx: float) -> Motion:
    pulse = travelling_pulse(BETA, SPEED)
    system = undriven(rope(RopeProblem(BETA, at_rest()), Grid(dx, 3.0, 0.0)))
    longest = 0.5 * dx if scheme is Scheme.TRAPEZOIDAL else 0.9 * system.explicit_limit
    steps = math.ceil(TIME / longest)
    zeta, dt = system.positions - BEGIN, TIME / steps
    early = pulse.shape(zeta + SPEED * dt)
    return move(system, scheme, dt, steps, pulse.shape(zeta), pulse.velocity(zeta), early)


@both
def test_radiated_pulse(scheme):
    """Shape and speed of second order; contact takes energy that falls as fast."""
    pulse = travelling_pulse(BETA, SPEED)
    sizes = np.array([0.02, 0.01, 0.005])
    shape, speed, lost = [], [], []
    for dx in sizes:
        run = pulse_run(scheme, dx)
        places, end = dx * np.arange(1, run.heights.shape[1] + 1), run.heights[-1]
        shape.append(np.abs(end - pulse.shape(places - BEGIN - SPEED * TIME)).max() / pulse.height)
        speed.append(abs((places @ end / end.sum() - BEGIN) / TIME - SPEED))
        lost.append(run.rows[-1, Column.LOST] / pulse.energy)
        # It is there: as high as it was, and lifted from the ground.
        assert end.max() == pytest.approx(pulse.height, rel=100 * dx**2)
        balance = run.rows[1:, Column.UNEXPLAINED]
        assert np.abs(balance).max() < 1e-10 * pulse.energy
        assert (run.rows[:, Column.LOWEST] >= 0).all()
    assert 1.7 < order(sizes, shape) < 2.4
    assert 1.7 < order(sizes, speed) < 2.4
    # Nodes come down one by one, at instants that the steps do not know: a window, not a number.
    assert 1.4 < order(sizes, lost) < 3.3
    assert 0 < lost[-1] < 1e-3
    assert shape[-1] < 3e-3
    assert speed[-1] < 3e-4


# ---- the plucked string


def plucked(
    scheme: Scheme, restitution: float, cells: int, steps: int
) -> tuple[Motion, np.ndarray]:
    system, dt = string_on_obstacle(cells - 1), 1 / steps
    start = np.sin(np.pi * system.positions)
    early = math.cos(math.pi * dt) * start
    still = np.zeros_like(start)
    run = move(system, scheme, dt, steps, start, still, early, restitution)
    return run, plucked_string(system.positions, run.times[:, None], restitution)


@both
@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_plucked_string_rebounds(scheme, restitution):
    """|cos πt| sin πx and its like: first order at the rebound, second at t = 1.

    At t = ½ the whole string strikes between two steps, so that the worst error is a step's way;
    after it that error is a shift in time, which a string at its turning point does not feel.
    """
    sizes, worst, last = [32, 64, 128, 256], [], []
    for cells in sizes:
        run, exact = plucked(scheme, restitution, cells, 2 * cells)
        worst.append(np.abs(run.heights - exact).max())
        last.append(np.abs(run.heights[-1] - exact[-1]).max())
        assert run.heights[-1].max() == pytest.approx(restitution, abs=20 / cells**2)
    steps = 1 / np.array(sizes)
    assert 0.9 < order(steps, worst) < 1.1
    assert 1.8 < order(steps, last) < 2.2
    # Energy: ¼π² before, times r² after.
    left = run.rows[-1, Column.ENERGY] / (math.pi**2 / 4)
    assert left == pytest.approx(restitution**2, rel=1e-3)


@both
def test_plucked_string_stays_down(scheme):
    steps, errors = [32, 64, 128], []
    for cells in steps:
        run, exact = plucked(scheme, 0.0, cells, 2 * cells)
        errors.append(np.abs(run.heights - exact).max())
        assert (run.heights[run.times > 0.5 + 1 / cells] == 0).all()
        assert run.heights[run.times < 0.45].max() > 0.1
    assert 1.8 < order(1 / np.array(steps), errors) < 2.2
    assert run.rows[-1, Column.LOST] == pytest.approx(math.pi**2 / 4, rel=1e-2)


# ---- the bouncing bar


def bar(scheme: Scheme, cells: int, restitution: float = 0.0) -> Motion:
    system = falling_bar(cells + 1)
    dt = (1.0 if scheme is Scheme.TRAPEZOIDAL else 0.8) * system.dx / 30
    start = np.full(system.size, 5.0)
    still, early = np.zeros(system.size), start - 5 * dt**2
    return move(system, scheme, dt, math.ceil(5.4 / dt), start, still, early, restitution)


@pytest.mark.parametrize(
    ("scheme", "restitution"),
    [(Scheme.TRAPEZOIDAL, 0.0), (Scheme.TRAPEZOIDAL, 1.0), (Scheme.VERLET, 0.0)],
)
def test_bouncing_bar(scheme, restitution):
    """Order 2/3: the exact velocity jumps, and second-order schemes smear jumps that fast.

    The limit does not depend on the restitution of its only node, whose mass vanishes.
    """
    exact = bouncing_bar(5.5)
    cells, worst, events = [50, 100, 200, 400], [], []
    for count in cells:
        run = bar(scheme, count, restitution)
        bottom = run.heights[:, 0]
        worst.append(np.abs(bottom - exact.bottom(run.times)).max())
        down = np.flatnonzero(bottom <= 0) if restitution == 0 else np.array([])
        if restitution == 0:
            (gap,) = np.flatnonzero(np.diff(down) > 1)
            touches = run.times[[down[0], down[gap], down[gap + 1], down[-1]]]
            events.append(np.abs(touches - [1, 5 / 3, 11 / 3, 13 / 3]).max())
        heights = np.interp([0.5, 1.7, 2, 8 / 3, 3.2, 4.5], run.times, bottom)
        sheet = [3.75, 0.11667, 1.66667, 3.88889, 2.64444, 1.52778]
        np.testing.assert_allclose(heights, sheet, rtol=0, atol=worst[-1])
        assert (bottom >= 0).all()
    sizes = 1 / np.array(cells)
    assert 0.5 < order(sizes, worst) < 0.95
    assert worst[-1] < 0.13
    if events:
        assert events[-1] < 0.02
        assert events[-1] < events[0] / 2


def test_bouncing_bar_comes_back():
    """Period 16/3: all of it is back at the height it fell from; what contact takes vanishes."""
    cells, errors, lost = [50, 100, 200, 400], [], []
    for count in cells:
        run = bar(Scheme.TRAPEZOIDAL, count)
        step = round(16 / 3 / run.times[1])  # 16/3 is a multiple of dt = L/(30 cells)
        errors.append(np.abs(run.heights[step] - 5).max())
        lost.append(run.rows[step - 1, Column.LOST] / 500)
    sizes = 1 / np.array(cells)
    assert 0.5 < order(sizes, errors) < 1.1
    assert errors[-1] < 0.15
    # The mass of the node that strikes, L/(2 cells): first order.
    assert 0.8 < order(sizes, lost) < 1.3


# ---- bending goes to zero: the exact string


@pytest.fixture(scope="module")
def exact_string():
    drive = ramped_cosine(2.2, 0.02, 2.0)
    return exact_string_motion(drive, 3.1 * drive.period)


def against_string(exact, beta: float, dx: float, scheme: Scheme) -> tuple[np.ndarray, np.ndarray]:
    """ξ_c − ξ_c⁰ of simulator and exact string, and the boundary-layer correction."""
    problem = RopeProblem(beta, exact.drive)
    until = 3 * exact.drive.period
    run = simulate(problem, until, Grid(dx, 2.5, 0.0), scheme=scheme, record_from=0.0)
    some = slice(None, None, max(len(run.times) // 300, 1))
    times = run.times[some]
    speed = exact.contact_velocity(times)
    assert np.abs(speed).max() > 0.05
    layer = np.sqrt(beta / (1 - speed**2)) + beta / 2
    return run.rows[some, Column.CONTACT] - exact.contact(times), layer


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@both
def test_string(exact_string, scheme):
    """β = 0. In motion of first order: the last node on the ground changes from step to step."""
    sizes, errors = [0.02, 0.01, 0.005], []
    for dx in sizes:
        difference, _ = against_string(exact_string, 0.0, dx, scheme)
        errors.append(rms(difference))
    assert 0.8 < order(sizes, errors) < 1.4
    assert errors[-1] < 3e-4


def test_the_noise_of_single_nodes_averages_out(exact_string):
    """β = 0: smoothing lowers the error on every grid, and the more the finer it is."""
    sizes, raw, smooth = [0.01, 0.005, 0.0025], [], []
    until = 3 * exact_string.drive.period
    for dx in sizes:
        run = simulate(
            RopeProblem(0.0, exact_string.drive), until, Grid(dx, 2.5, 0.0), record_from=0.5
        )
        exact = exact_string.contact(run.times)
        times, contact = run.smooth_contact()
        assert times is run.times
        raw.append(rms(run.column(Column.CONTACT) - exact))
        smooth.append(rms(contact - exact))
    gain = np.array(raw) / smooth
    assert (np.diff(gain) > 0).all()
    assert gain[0] > 2.5
    assert gain[-1] > 5
    assert 1.4 < order(sizes, smooth) < 2.2
    with pytest.raises(InputError, match="earlier record_from"):
        simulate(RopeProblem(0.0, exact_string.drive), 1.0, record_from=0.98).smooth_contact()


@both
def test_what_contact_takes_from_a_rope_that_follows_falls_with_the_grid(scheme):
    """Nothing is lost in the continuum; a node that is laid down has a speed of first order."""
    drive, lost, sizes = ramped_cosine(1.3, 0.05, 3.0), [], [0.02, 0.01, 0.005]
    for dx in sizes:
        run = simulate(
            RopeProblem(0.01, drive), 5 * drive.period, Grid(dx, 2.5, 0.0), scheme=scheme
        )
        assert run.column(Column.BUMP).max() <= 0
        lost.append(np.ptp(run.column(Column.LOST)))
    assert 0 < lost[-1] < 1e-8
    assert 1.8 < order(sizes, lost) < 4


@pytest.mark.parametrize(
    ("scheme", "nodes", "betas"),
    [(Scheme.TRAPEZOIDAL, 12, [1e-2, 1e-3, 1e-4]), (Scheme.VERLET, 8, [1e-2, 3e-3, 1e-3])],
)
def test_bending_goes_to_zero(exact_string, scheme, nodes, betas):
    """ξ_c = ξ_c⁰ + √β + O(β) and, with the boundary layer, a residual that falls about like β."""
    raw, left = [], []
    for beta in betas:
        difference, layer = against_string(exact_string, beta, math.sqrt(beta) / nodes, scheme)
        raw.append(rms(difference))
        left.append(rms(difference - layer))
        # β/2 is seen: the mean is met to a tenth of it, but for the grid.
        assert abs(np.mean(difference - layer)) < 0.1 * beta + 1e-5
        assert left[-1] < 2 * beta
    assert 0.45 < order(betas, raw) < 0.6
    assert 0.7 < order(betas, left) < 1.1
