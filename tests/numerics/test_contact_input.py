"""Bad input gets one clear error: what was given, what is allowed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.problems.drive import Drive, at_rest, cosine, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid, falling_bar, string_on_obstacle

GOOD = RopeProblem(0.01, at_rest())


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: ramped_cosine(0.0, 0.1), "Omega"),
        (lambda: ramped_cosine(math.nan, 0.1), "Omega.*finite"),
        (lambda: ramped_cosine(2.5, 1.2), "Z = -0.2"),
        (lambda: ramped_cosine(2.5, "much"), "epsilon = 'much': give a number"),
        (lambda: ramped_cosine(2.5, 0.1, 0), "ramp periods"),
        (lambda: cosine(-1.0, 0.1), "Omega"),
        (lambda: at_rest(0.0), "height = 0.0.*> 0"),
        (lambda: at_rest().period, "no period"),
        (lambda: Drive(np.cos, np.sin, ""), "label"),
        (lambda: Drive(np.cos, np.sin, "x", -1.0), "Omega"),
        (lambda: RopeProblem(-0.1, at_rest()), "beta = -0.1.*≥ 0"),
        (lambda: RopeProblem(1.1, at_rest()), "0 ≤ β ≤ 1"),
        (lambda: RopeProblem(math.inf, at_rest()), "finite"),
        (lambda: RopeProblem(0.1, at_rest(), "free"), "pinned.*clamped"),
        (lambda: RopeProblem(0.1, at_rest(), damping=-1), "damping"),
        (lambda: RopeProblem(0.1, at_rest(), restitution=1.1), "restitution"),
        (lambda: RopeProblem(0.1, at_rest(), restitution=-0.1), "restitution"),
        (lambda: Simulator(GOOD, Grid(dx=0.05)), "√β/4"),
        (lambda: Simulator(GOOD, Grid(dx=0.0)), "dx = 0.0"),
        (lambda: Simulator(GOOD, Grid(dx=-0.01)), "dx = -0.01"),
        (lambda: Simulator(GOOD, Grid(length=0.0)), "length"),
        (lambda: Simulator(GOOD, Grid(length=2.0, sponge=1.5)), "too short"),
        (lambda: Simulator(GOOD, Grid(sponge=-1.0)), "sponge"),
        (lambda: Simulator(GOOD, Grid(sponge=math.nan)), "sponge"),
        (lambda: Simulator(GOOD, Grid(strength=-1.0)), "strength"),
        (lambda: Simulator(GOOD, Grid(strength=math.nan)), "strength"),
        (lambda: Simulator(GOOD, Grid(length=math.inf)), "length"),
        (lambda: Simulator(RopeProblem(0.01, at_rest(4.0)), Grid(length=2, sponge=0)), "too short"),
        (lambda: Grid(dx="fine"), "dx = 'fine': give a number"),
        (lambda: Grid(sponge=None), "sponge = None: give a number"),
        (lambda: Grid(dx=1e-9), "more than 10000000 nodes"),
        (lambda: RopeProblem(0.01, None), "drive = None: give a Drive"),
        (lambda: Drive(1.0, 0.0, "constant"), "functions"),
        (lambda: Simulator(GOOD, dt=1e-200), "lost in rounding"),
        (lambda: Simulator(GOOD, dt=0.0), "dt = 0.0"),
        (lambda: Simulator(GOOD, dt=math.nan), "dt"),
        (lambda: Simulator(GOOD, dt=0.01, scheme="verlet"), "stability limit"),
        (lambda: Simulator(GOOD, scheme="euler"), "trapezoidal.*verlet"),
        (lambda: next(Simulator(GOOD).blocks(-1.0)), "until"),
        (lambda: next(Simulator(GOOD).blocks(1.0, every=0)), "every"),
        (lambda: next(Simulator(GOOD).blocks(1.0, every=2.5)), "every = 2.5: give a whole"),
        (lambda: next(Simulator(GOOD).blocks(1e308)), "until = 1e.308 is more than"),
        (lambda: simulate(GOOD, 1.0, snapshots=0.0), "snapshots"),
        (lambda: simulate(GOOD, 1.0, snapshots=1e308), "snapshots = 1e.308 is more than"),
        (lambda: simulate(GOOD, 1.0, record_from=math.nan), "record_from"),
        (lambda: simulate(GOOD, math.inf), "until"),
        (lambda: string_on_obstacle(3), "at least 8"),
        (lambda: string_on_obstacle(10.5), "nodes = 10.5"),
        (lambda: falling_bar(3), "at least 8"),
        (lambda: falling_bar(20, g=math.nan), "g = nan"),
        (lambda: falling_bar(20, modulus=0.0), "modulus"),
        (lambda: falling_bar(20, density=-1.0), "density"),
    ],
)
def test_bad_input(wrong, said):
    with pytest.raises(InputError, match=said):
        wrong()


@pytest.mark.parametrize(
    ("height", "words"),
    [
        (lambda t: 1 - t, r"Z = 0 at tau = 1; it must stay above the ground"),
        (lambda t: np.where(t > 0.5, np.nan, 1.0), r"Z = nan at tau = 0\.52"),
        (lambda t: 1.0, r"shape \(\) for one of shape \(1,\)"),
    ],
)
def test_a_drive_into_the_ground(height, words):
    """Found while running; what was done before is kept."""
    problem = RopeProblem(0.01, Drive(height, np.zeros_like, "falls"))
    with pytest.raises(InputError, match=f"'falls' .*{words}"):
        list(Simulator(problem, Grid(0.02)).blocks(3.0))


def test_a_drive_may_go_where_it_will_after_the_end_of_the_run():
    problem = RopeProblem(0.01, Drive(lambda t: 1 - 0.1 * t**2, np.zeros_like, "falls later"))
    simulator = Simulator(problem, Grid(0.02))
    assert sum(len(block.times) for block in simulator.blocks(2.0)) == 100
