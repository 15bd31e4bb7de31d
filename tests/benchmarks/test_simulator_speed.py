"""How fast the contact simulators are; nothing here fails on time.

One forcing period of a rope that follows: Ω = 2.5, ε = 0.05, β = 0.01, dx = 0.01. The rival is the
same semi-discrete rope over springs (:mod:`numerics.simulation.penalty`) under
``scipy.integrate.solve_ivp``, by the fastest of its methods that were tried, LSODA told of the
bandwidth, on a domain cut to what moves. Its κ and rtol are the cheapest of a table with which ξ_c
comes as close to a reference in time (Verlet, same grid) as that of the implicit scheme with dt =
dx, over the same period.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.penalty import penalty_ground, solve
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid
from numerics.simulation.trapezoidal import factor, revise, substituted

OMEGA, EPSILON, BETA, DX = 2.5, 0.05, 0.01, 0.01
PERIODS = 1
SAMPLES = 25
CUT = Grid(DX, 2.0, 0.0)
# Cheapest first: κ, rtol; atol = rtol/1000.
TRIES = ((1e4, 1e-3), (1e5, 1e-3), (1e5, 1e-4), (1e6, 1e-4), (1e6, 1e-5), (1e7, 1e-5), (1e8, 1e-6))

FRESH = """
import time
begin = time.perf_counter()
from numerics.simulation.run import simulate
from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
loaded = time.perf_counter()
drive = ramped_cosine(2.5, 0.05)
simulate(RopeProblem(0.01, drive), drive.period)
print(loaded - begin, time.perf_counter() - loaded)
"""


def problem(ramp: float) -> RopeProblem:
    return RopeProblem(BETA, ramped_cosine(OMEGA, EPSILON, ramp))


@pytest.mark.benchmark(group="one forcing period, dx = 0.01")
@pytest.mark.parametrize("scheme", list(Scheme), ids=lambda scheme: scheme.value)
def test_one_period(benchmark, scheme):
    if scheme is Scheme.TRAPEZOIDAL:
        benchmark.extra_info["goal in seconds"] = 0.0015
    rope = problem(20)
    simulator = Simulator(rope, Grid(DX), scheme=scheme)
    period = rope.drive.period
    for _ in simulator.blocks(21 * period):
        pass

    def advance() -> None:
        for _ in simulator.blocks(simulator.time + period):
            pass

    benchmark.pedantic(advance, rounds=60 if scheme is Scheme.TRAPEZOIDAL else 10)
    assert simulator.unexplained < 1e-8
    assert simulator.time > 30 * period


@pytest.mark.benchmark(group="a step while waves are shed, β = 1e-3, dx = 2e-3")
def test_a_step_while_waves_are_shed(benchmark):
    """Many rounds, most of which change little: a step over rounds that look at all nodes."""
    drive = ramped_cosine(2.9, 0.3, 0.5)
    simulator = Simulator(RopeProblem(1e-3, drive), Grid(2e-3))
    for _ in simulator.blocks(8.0):
        pass
    system, state, n = simulator.system, simulator.state, simulator.system.size
    bands = system.stiffness.copy()
    bands[0] += 4 * system.mass / simulator.dt**2
    right, active = bands[0] * state.height, state.active.copy()
    factors, y, x, changed = np.zeros((3, n)), np.zeros(n), np.zeros(n), np.empty(n, np.int64)

    def whole_round() -> None:
        factor(bands, active, 0, n, factors)
        substituted(factors, right, active, 0, 0, n, y, x)
        revise(bands, right, system.obstacle, 0, n, np.inf, False, x, active.copy(), changed, 0)

    def steps() -> tuple[float, float]:
        begin, first, rounds = time.process_time(), simulator.step, 0.0
        for block in simulator.blocks(simulator.time + 0.25):
            rounds += block.rows[:, Column.ROUNDS].sum()
        taken = simulator.step - first
        return (time.process_time() - begin) / taken, rounds / taken

    whole_round()
    begin = time.process_time()
    for _ in range(200):
        whole_round()
    each = (time.process_time() - begin) / 200
    seconds, rounds = benchmark.pedantic(steps, rounds=5)
    benchmark.extra_info.update(
        {
            "processor seconds a step": seconds,
            "rounds a step": rounds,
            "a step over so many rounds that look at all nodes": seconds / (rounds * each),
        }
    )
    assert rounds > 3


def contact_by_simulator(scheme: Scheme, dt: float, until: float) -> tuple[np.ndarray, float]:
    begin = time.process_time()
    run = simulate(problem(0.5), until, CUT, dt, scheme, record_from=0.0)
    spent = time.process_time() - begin
    times = until / SAMPLES * np.arange(1, SAMPLES + 1)
    nearest = np.abs(run.times[:, None] - times).argmin(axis=0)
    return run.rows[nearest, 0], spent


def distance(contact: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean((contact - reference) ** 2)))


@pytest.mark.benchmark(group="the same rope by solve_ivp")
def test_against_solve_ivp(benchmark):
    rope = problem(0.5)
    # A whole number of both schemes' steps in each sample.
    until = round(PERIODS * rope.drive.period / SAMPLES / DX) * DX * SAMPLES
    times = until / SAMPLES * np.arange(1, SAMPLES + 1)
    reference, _ = contact_by_simulator(Scheme.VERLET, DX / 400, until)
    ours, _ = contact_by_simulator(Scheme.TRAPEZOIDAL, DX, until)
    goal, seconds = distance(ours, reference), np.inf
    for _ in range(5):
        seconds = min(seconds, contact_by_simulator(Scheme.TRAPEZOIDAL, DX, until)[1])
    for kappa, rtol in TRIES:
        ground = penalty_ground(rope, CUT, kappa)
        begin = time.process_time()
        run = solve(ground, times, "LSODA", rtol, rtol / 1000)
        spent = time.process_time() - begin
        found = distance(run.contact, reference)
        if found <= goal:
            break
    benchmark.extra_info.update(
        {
            "kappa": kappa,
            "rtol": rtol,
            "rms error of the contact point": found,
            "that of the implicit scheme": goal,
            "processor seconds of solve_ivp": spent,
            "processor seconds of the implicit scheme": seconds,
            "ratio": spent / seconds,
            "right-hand sides": run.evaluations,
        }
    )
    benchmark.pedantic(contact_by_simulator, (Scheme.TRAPEZOIDAL, DX, until), rounds=20)
    assert found <= goal
    assert np.ptp(reference) > 0.05


@pytest.mark.benchmark(group="a fresh process")
def test_fresh_process(benchmark):
    """Compilation is cached between processes: import, and the first period."""

    def run() -> list[float]:
        command = [sys.executable, "-c", FRESH]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ)
        return [float(word) for word in done.stdout.split()]

    run()
    loading, first = benchmark.pedantic(run, rounds=3)
    benchmark.extra_info.update({"import, seconds": loading, "first period, seconds": first})
    assert first > 0
