"""Bad input gets one clear error: what was given, what is allowed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.contact import Simulator
from numerics.drive import Drive, at_rest, cosine, ramped_cosine
from numerics.errors import InputError
from numerics.problem import RopeProblem
from numerics.semi_discrete import Grid, falling_bar, string_on_obstacle
from numerics.simulation import simulate

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
        (lambda: Simulator(GOOD, dt=0.0), "dt = 0.0"),
        (lambda: Simulator(GOOD, dt=math.nan), "dt"),
        (lambda: Simulator(GOOD, dt=0.01, scheme="verlet"), "stability limit"),
        (lambda: Simulator(GOOD, scheme="euler"), "trapezoidal.*verlet"),
        (lambda: next(Simulator(GOOD).blocks(-1.0)), "until"),
        (lambda: next(Simulator(GOOD).blocks(1.0, every=0)), "every"),
        (lambda: simulate(GOOD, 1.0, snapshots=0.0), "snapshots"),
        (lambda: simulate(GOOD, math.inf), "until"),
        (lambda: string_on_obstacle(3), "at least 8"),
        (lambda: falling_bar(3), "at least 8"),
        (lambda: falling_bar(20, modulus=0.0), "modulus"),
        (lambda: falling_bar(20, density=-1.0), "density"),
    ],
)
def test_bad_input(wrong, said):
    with pytest.raises(InputError, match=said):
        wrong()


@pytest.mark.parametrize(
    "height",
    [
        lambda t: 1 - t,
        lambda t: np.where(t > 0.5, np.nan, 1.0),
        lambda t: 1.0,
    ],
)
def test_a_drive_into_the_ground(height):
    """Found while running; what was done before is kept."""
    problem = RopeProblem(0.01, Drive(height, np.zeros_like, "falls"))
    with pytest.raises(InputError, match="'falls' does not keep the driven end above"):
        list(Simulator(problem, Grid(0.02)).blocks(3.0))
