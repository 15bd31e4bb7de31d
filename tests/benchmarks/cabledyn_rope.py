"""The forced rope in CableDyn: cubic Hermite elements with bending, seabed springs, generalised-α.

CableDyn solves for its own initial state and takes no other, so it starts from rest and Z(τ) is
ramped up over ``RAMP`` periods; ``ours_from_rest`` does the same, and the reference of both is a
run of :mod:`numerics.simulation.contact` on a fine grid. Its seabed does not act on the last 10⁻⁶
m, whatever the rope, which would lift a rope of x₀ = 1 m by 4·10⁻⁴ Z₀: here x₀ is ``UNIT`` metres,
at unit tension and mass per length. The fluid that it insists on weighs nothing. ρ∞ below 1 damps
the chatter of the nodes on the seabed and the waves of the rope alike.
"""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.run import follow, simulate
from numerics.simulation.semi_discrete import Grid
from tests.benchmarks.forced_rope import (
    BETA,
    EPSILON,
    GROUND,
    LENGTH,
    OMEGA,
    PERIOD,
    PERIODS,
    SAMPLES,
    SLOPE,
    TIMES,
    Array,
    Outcome,
    contact_of,
    need,
    rms,
    timed,
)

RAMP = 10
"""Forcing periods of the ramp; TIMES begins after it."""
UNIT, DEPTH, DIAMETER = 100.0, 10.0, 0.01
RIGID, RHO = 30.0, 0.9
SUBSTEPS = 16
"""Steps in a sample. With fewer the springs of fine grids make the nodes chatter."""
SOLVER = "dynamic_solver 1e-6 1e-10 20 10"
"""Relative and absolute tolerance of Newton's iteration, its steps and backtracks."""

DRIVE = ramped_cosine(OMEGA, EPSILON, RAMP)
START = RAMP * PERIOD


@cache
def reference() -> Array:
    """ξ_c at START + TIMES, of our simulator on a fine grid."""
    problem = RopeProblem(BETA, DRIVE)
    end = START + (PERIODS + 0.1) * PERIOD
    run = simulate(problem, end, Grid(0.0025, 3.0, 0.0), record_from=START - PERIOD)
    return np.asarray(np.interp(START + TIMES, *run.smooth_contact()))


def ours_from_rest(dx: float, like: Outcome) -> Outcome:
    """ξ_c by the same fit from the same start; a period costs what it cost in ``like``."""
    simulator = Simulator(RopeProblem(BETA, DRIVE), Grid(dx))
    end = START + (PERIODS + 0.1) * PERIOD
    run = follow(simulator, end, snapshots=simulator.dt)
    found = np.array([contact_of(run.positions, w) for w in run.heights])
    contact = np.interp(START + TIMES, run.snapshot_times, found)
    return replace(like, contact=contact, reference=reference())


def settings() -> str:
    """All that a run depends on besides its spacing."""
    return (
        f"CableDyn: from rest, ramp of {RAMP} periods, {SUBSTEPS} steps in 1/{SAMPLES} period, "
        f"{SOLVER} rhoInf {RHO}, EA = {RIGID:g} T, ground {GROUND:g} beta/dx^4 with half critical "
        f"damping, Z0 = {SLOPE:g} x0, x0 = {UNIT:g} m, length {LENGTH:g} x0"
    )


def cabledyn(
    dx: float,
    ground: float = GROUND,
    rigid: float = RIGID,
    slope: float = SLOPE,
    substeps: int = SUBSTEPS,
    rho: float = RHO,
) -> Outcome:
    """One run with spacing dx; LENGTH/dx is rounded. ``own`` is by its touchdown channel."""
    program = need("cabledyn", "cabledyn")
    n = round(LENGTH / dx)
    dt = PERIOD / SAMPLES / substeps
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "rope.dat"
        spring = ground * BETA / (LENGTH / n) ** 4
        deck.write_text(_deck(program, n, dt, spring, rigid, slope, rho))
        model = program.CableDyn(deck)
    line, step, touchdown = model.lines[0], [0], []
    times = dt * np.arange((RAMP + PERIODS) * SAMPLES * substeps + 1)
    height = UNIT * (slope * DRIVE.height(times) - DEPTH)
    speed, change = slope * DRIVE.slope(times), slope / UNIT * DRIVE.curvature(times)

    def advance() -> None:
        for _ in range(substeps):
            step[0] += 1
            i = step[0]
            model.step(dt * UNIT, [0, 0, height[i]], [0, 0, speed[i]], [0, 0, change[i]])

    def look() -> float:
        place = np.asarray(line.node_positions()).reshape(-1, 3) / UNIT
        touchdown.append(model.channel("TDP1x") / UNIT)
        return contact_of(place[:, 0], (place[:, 2] + DEPTH) / slope)

    for _ in range(RAMP * SAMPLES):
        advance()
    seconds, contact = timed(advance, look)
    model.close()
    own = rms((np.array(touchdown) - reference())[-SAMPLES:])
    return Outcome("CableDyn", n + 1, dt, seconds, contact, reference(), own)


def _deck(
    program: Any, n: int, dt: float, spring: float, rigid: float, slope: float, rho: float
) -> str:
    stretch, x0 = 1 + 1 / rigid, UNIT
    unstretched = (LENGTH + 2 / 3 * slope**2) / stretch
    deck = program.DeckWriter(title="a rope on flat ground")
    deck.add_line_type(
        "rope", diam=DIAMETER * x0, mass=LENGTH / unstretched, ea=rigid, ei=BETA * x0**2
    )
    deck.add_point(1, "Coupled", 0.0, 0.0, (slope - DEPTH) * x0)
    deck.add_point(2, "Fixed", LENGTH * x0, 0.0, -DEPTH * x0)
    deck.add_line(1, node_a=1, node_b=2)
    deck.add_section(line_id=1, line_type="rope", length=unstretched * x0, num_segs=n)
    options = {
        "g": 2 * slope / x0,
        "rhow": 1e-9,
        "WtrDpth": DEPTH * x0,
        "kBot": spring * stretch / (DIAMETER * x0**3),
        "cBot": math.sqrt(spring) * stretch / (DIAMETER * x0**2),
        "dtM": dt * x0,
        "TMax": dt * x0 * 10**6,
    }
    for name, value in options.items():
        deck.set_option(value, name)
    deck.add_output("TDP1x")
    head, tail = deck.text(caller_driven=True).split("--- OPTIONS ---\n")
    return f"{head}--- OPTIONS ---\n{SOLVER} {rho}\n{tail}"
