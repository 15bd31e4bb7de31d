"""What the simulator's tests share: any start, taken through time step by step; orders."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from numerics.simulation.contact import Scheme, run_steps
from numerics.simulation.observables import COLUMNS
from numerics.simulation.semi_discrete import SemiDiscrete, State

EPS = float(np.finfo(float).eps)


class Motion(NamedTuple):
    """Times, heights after each step (the start included), rows of observables, and the end."""

    times: np.ndarray
    heights: np.ndarray
    rows: np.ndarray
    state: State


def move(
    system: SemiDiscrete,
    scheme: Scheme,
    dt: float,
    steps: int,
    start: np.ndarray,
    velocity: np.ndarray,
    before: np.ndarray,
    restitution: float = 0.0,
) -> Motion:
    """From W = ``start``, W_τ = ``velocity``; ``before`` is W one step earlier, for Verlet.

    The end stays at Z = 0. The first row of Verlet's ledger begins with an energy that is half a
    step off: look at the others.
    """
    speed = (start - before) / dt if scheme is Scheme.VERLET else velocity
    state = State(start.copy(), speed.copy(), system.obstacle & (start <= 0))
    ledger = np.array([system.energy(start, velocity), 0.0, 0.0, 0.0])
    rows = np.empty((steps, COLUMNS))
    heights = np.empty((steps + 1, system.size))
    heights[0] = start
    for k in range(steps):
        done = run_steps(
            system, scheme, dt, restitution, np.zeros(3), state, ledger, rows[k : k + 1]
        )
        assert done == 1
        heights[k + 1] = state.height
    return Motion(dt * np.arange(steps + 1), heights, rows, state)


def undriven(system: SemiDiscrete) -> SemiDiscrete:
    """The same rope, its end at Z = 0 on the ground and no longer pulling."""
    return system._replace(drive=(0.0, 0.0), end_stiffness=0.0, end_load=0.0)


def order(sizes, errors) -> float:
    """p of error ∝ size^p: the slope of the straight line through the logarithms."""
    assert len(sizes) >= 3
    assert (np.asarray(errors) > 0).all()
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def richardson(values) -> float:
    """p from values at sizes h, h/2, h/4, …: the slope of their successive differences."""
    changes = [float(np.sqrt(np.mean((b - a) ** 2))) for a, b in itertools.pairwise(values)]
    return order(0.5 ** np.arange(len(changes)), changes)
