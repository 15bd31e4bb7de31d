"""Ropes whose foundation, tension, mass, weight and ground vary, and drives from samples."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from numerics.errors import InputError
from numerics.files.checkpoint import resume, save_checkpoint
from numerics.files.sealed import specification
from numerics.problems.along import Along, along, table
from numerics.problems.drive import Drive, at_rest, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.problems.sampled import read_samples, sampled
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid, rope

EPS = float(np.finfo(float).eps)


def random_rope(generator: np.random.Generator) -> RopeProblem:
    between = generator.uniform
    beta = float(generator.choice([0.0, 10 ** between(-3, -1)]))
    places = np.linspace(0.0, 12.0, 30)
    bumps = 0.2 * between(-1, 1) * np.sin(places) * places / 12
    return RopeProblem(
        beta,
        ramped_cosine(between(1, 4), between(0.02, 0.5), between(0.1, 1)),
        str(generator.choice(["pinned", "clamped"])),
        float(generator.choice([0.0, 0.1])),
        foundation=[between(0, 2), between(0, 0.3)],
        tension=[between(0.5, 2), between(0, 0.3)],
        mass=[between(0.5, 2), between(0, 0.2)],
        weight=[between(1, 3), between(0, 0.2)],
        ground=table("ground", places, bumps),
    )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("scheme", list(Scheme))
def test_energy_and_complementarity_stay_identities(scheme: Scheme, seed: int) -> None:
    """Whatever varies: what driving, damping and contact explain of the energy is all of it."""
    generator = np.random.default_rng([seed, 3])
    for _ in range(8):
        problem = random_rope(generator)
        grid = Grid(0.02 if problem.beta == 0 else max(0.005, math.sqrt(problem.beta) / 8), 8.0)
        simulator = Simulator(problem, grid, None, scheme)
        until = min(3.0, 300 * simulator.dt)
        rows = np.concatenate([block.rows for block in simulator.blocks(until)])
        stiffest = float(np.abs(simulator.system.stiffness[0]).max())
        scale = stiffest * max(1.0, float(np.max(np.abs(simulator.state.height)))) ** 2
        assert simulator.unexplained <= 100 * EPS * scale
        assert simulator.lowest >= 0
        assert simulator.reaction >= -200 * EPS * scale / grid.dx
        assert rows[:, Column.LOST].min() > -1e-12


def test_tension_and_foundation_at_rest_meet_a_boundary_value_solver() -> None:
    """(T W′)′ = 2 + κW over g: solve_bvp for the lifted part, of free length."""
    problem = RopeProblem(
        0.0, at_rest(), tension=[1.0, 0.4], foundation=[0.6, 0.5], ground=[0.0, 0.05, -0.02]
    )

    def ground(x: float | np.ndarray) -> np.ndarray:
        return 0.05 * x - 0.02 * x**2

    def right(s: np.ndarray, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        x = s * p[0]
        pull = y[1]  # T W′
        return p[0] * np.vstack([pull / (1 + 0.4 * x), 2 + (0.6 + 0.5 * x) * y[0]])

    def ends(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
        slope = (0.05 - 0.04 * p[0]) * (1 + 0.4 * p[0])
        return np.array([a[0] - 1, b[0] - ground(p[0]), b[1] - slope])

    s = np.linspace(0, 1, 60)
    found = solve_bvp(right, ends, s, np.vstack([(1 - s) ** 2, 2 * (s - 1)]), [1.0], tol=1e-10)
    assert found.success
    place = float(found.p[0])
    for dx in (0.04, 0.02, 0.01, 0.005, 0.0025):
        simulator = Simulator(problem, Grid(dx, 6.0, 2.0))
        x = simulator.system.positions
        lifted = x < place - 0.1
        exact = found.sol(x[lifted] / place)[0] - ground(x[lifted])
        # Second order, with a constant that depends on where ξ₀ lies between two nodes.
        assert np.max(np.abs(simulator.state.height[lifted] - exact)) < 0.25 * dx**2


@pytest.mark.parametrize("scheme", list(Scheme))
def test_waves_run_at_the_speed_of_tension_and_mass(scheme: Scheme) -> None:
    """c = √(T/m): a rope with T = 4, m = 1 and twice the load is the paper's in half the time."""
    plain = RopeProblem(0.0, ramped_cosine(2.2, 0.05, 3))
    drive = plain.drive
    quick = RopeProblem(
        0.0,
        Drive(lambda t: drive.height(2 * t), lambda t: 2 * drive.slope(2 * t), "quick", 4.4),
        tension=4.0,
        weight=8.0,
    )
    grid = Grid(0.01)
    first = simulate(plain, 12.0, grid, 0.008, scheme, record_from=0.0)
    second = simulate(quick, 6.0, grid, 0.004, scheme, record_from=0.0)
    left, right = first.column(Column.CONTACT), second.column(Column.CONTACT)
    assert np.max(np.abs(left - right)) < 1e-9
    # And mass alone slows it: m = 4 and the paper's tension, twice the time.
    slow = RopeProblem(
        0.0,
        Drive(lambda t: drive.height(t / 2), lambda t: drive.slope(t / 2) / 2, "slow", 1.1),
        mass=4.0,
    )
    third = simulate(slow, 24.0, grid, 0.016, scheme, record_from=0.0)
    assert np.max(np.abs(third.column(Column.CONTACT) - left)) < 1e-9


def test_a_straight_slope_loads_only_what_feels_heights() -> None:
    """Without foundation its stiffness acts on curvature: not a node is loaded otherwise."""
    plain = rope(RopeProblem(0.01, at_rest()), Grid(0.02))
    sloping = rope(RopeProblem(0.01, at_rest(), ground=[0.0, 0.3]), Grid(0.02))
    scale = float(np.abs(plain.stiffness).max())
    assert np.max(np.abs(sloping.load - plain.load)) < 64 * EPS * scale
    founded = rope(RopeProblem(0.01, at_rest(), ground=[0.0, 0.3], foundation=2.0), Grid(0.02))
    extra = founded.load - plain.load - 0.02 * 2.0 * 0.3 * founded.positions
    assert np.max(np.abs(extra)) < 64 * EPS * scale


def test_even_ground_given_in_words_changes_no_bit() -> None:
    plain = RopeProblem(0.01, ramped_cosine(2.5, 0.05, 2))
    spelled = RopeProblem(
        0.01,
        plain.drive,
        foundation=0.0,
        tension=[1.0],
        mass=table("mass", [0, 20], [1, 1]),
        weight=2,
        ground=table("ground", [0, 20], [0, 0]),
    )
    for ours, theirs in zip(rope(plain), rope(spelled), strict=True):
        assert np.array_equal(ours, theirs)
    assert (
        specification(Simulator(plain)).keys()
        == specification(Simulator(RopeProblem(0.01, plain.drive, tension=1.0))).keys()
    )


def test_a_checkpoint_of_another_ground_is_refused(tmp_path: Path) -> None:
    sloping = RopeProblem(0.01, ramped_cosine(2.5, 0.05, 2), ground=[0, -0.01])
    simulator = Simulator(sloping, Grid(0.02))
    for _ in simulator.blocks(0.5):
        pass
    save_checkpoint(simulator, tmp_path / "a.npz")
    again = resume(tmp_path / "a.npz", sloping, Grid(0.02))
    assert np.array_equal(again.state.height, simulator.state.height)
    flat = RopeProblem(0.01, sloping.drive)
    with pytest.raises(Exception, match=r"ground = 'polynomial 0.0 -0.01' there, None here"):
        resume(tmp_path / "a.npz", flat, Grid(0.02))


@pytest.mark.parametrize(
    ("varying", "says"),
    [
        ({"tension": 0.0}, "tension = 0 at"),
        ({"tension": [1.0, -0.5]}, "it has to be > 0"),
        ({"mass": -1.0}, "mass = -1 at"),
        ({"foundation": [1.0, -0.5]}, "foundation = .* at least 0"),
        ({"ground": 0.1}, r"g\(0\) = 0"),
        ({"ground": [0.0, 0.0, 1.5]}, "not down before"),
        ({"weight": -2.0}, "not down before"),
        ({"ground": table("ground", [0, 1], [0, 0])}, "cover the domain"),
        ({"tension": "x"}, "give a number"),
        ({"tension": [1.0, math.nan]}, "finite"),
        ({"tension": []}, "no coefficient"),
    ],
)
def test_bad_ropes_are_refused(varying: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        Simulator(RopeProblem(0.01, at_rest(), **varying), Grid(0.02))  # type: ignore[arg-type]


def test_bad_tables_are_refused() -> None:
    for places, values in (([0, 1], [0]), ([0], [0]), ([1, 0], [0, 0]), ([0, "a"], [0, 0])):
        with pytest.raises(InputError, match="ground"):
            table("ground", places, values)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="cover the domain"):
        table("mass", [1, 9], [1, 1])(0.5)
    with pytest.raises(InputError, match="cover the domain"):
        table("mass", [0, 1, 2], [1, 1, 1])(2.5)
    assert along("a", Along((1.0,))) == Along((1.0,))


# ---- drives from samples


def test_a_sampled_cosine_drives_like_the_cosine(tmp_path: Path) -> None:
    """Fine samples of a ramped cosine: the same run, to the spline's fourth order."""
    exact = ramped_cosine(2.2, 0.05, 2)
    errors = []
    for count in (200, 400):
        times = np.linspace(0, 9.0, count)
        heights = exact.height(times)
        path = tmp_path / "Z.csv"
        lines = [f"{t!r},{z!r}" for t, z in zip(times.tolist(), heights.tolist(), strict=True)]
        path.write_text("tau,Z\n" + "\n".join(lines))
        drive = read_samples(path)
        x = np.linspace(0, 7.0, 1000)
        errors.append(float(np.max(np.abs(drive.height(x) - exact.height(x)))))
        assert np.max(np.abs(drive.slope(x) - exact.slope(x))) < 1e-3
    assert 10 < errors[0] / errors[1] < 24
    first = simulate(RopeProblem(0.01, exact), 7.0, record_from=0.0)
    second = simulate(RopeProblem(0.01, drive), 7.0)  # rows are kept without a period
    assert len(second.times) > 500
    left = first.column(Column.ENERGY)[-len(second.times) :]
    assert np.max(np.abs(left - second.column(Column.ENERGY))) < 1e-4


def test_samples_pickle_and_rest_outside() -> None:
    drive = pickle.loads(pickle.dumps(sampled([0, 1, 2, 4], [1, 1.2, 1.1, 1.0], "monotone")))
    assert drive.height(np.array([-1.0, 0.0, 1.0, 4.0, 9.0])).tolist() == [1, 1, 1.2, 1, 1]
    assert drive.slope(np.array([-1.0, 9.0])).tolist() == [0, 0]
    x = np.linspace(1, 4, 300)
    assert np.all(np.diff(drive.height(x)) <= 0)
    assert drive.label != sampled([0, 1, 2, 4], [1, 1.2, 1.1, 1.0]).label


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "no samples"),
        ("tau,Z\n", "no samples"),
        ("0,1\n1,1\n2,1\n", "4 … "),
        ("0,1\n1,1\n1,1\n2,1\n", "increase"),
        ("1,1\n2,1\n3,1\n4,1\n", "from 0 on"),
        ("0,1\n1,-1\n2,1\n3,1\n", "above the ground"),
        ("0,1\n1,nan\n2,1\n3,1\n", "finite"),
        ("0,1\n1,1,1\n", "sample 2"),
        ("0,1\nx,y\n", "sample 2"),
        ("\x00\x01", "no samples|is not tau|no CSV"),
    ],
)
def test_bad_samples_are_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "Z.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=says):
        read_samples(path)
    with pytest.raises(InputError, match="cannot read"):
        read_samples(tmp_path / "none.csv")
