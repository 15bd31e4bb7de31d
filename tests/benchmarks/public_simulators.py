"""What the accuracy of a contact point costs in public simulators.

``python -m tests.benchmarks.public_simulators`` runs the rope of
:mod:`tests.benchmarks.forced_rope` in PyElastica, in MoorDyn, in CableDyn and in
:mod:`numerics.simulation.contact`, and prints error against processor time, all of one run on one
core. Install the rivals with ``pip install pyelastica moordyn cabledyn``. ``--effects`` varies what
the rivals need and the rope has not: a ground that gives, extension, slopes that are not small.
CableDyn starts from rest (:mod:`tests.benchmarks.cabledyn_rope`) and is compared with ours from
rest.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from importlib.metadata import version

import numpy as np

from numerics.problems.drive import cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.run import follow
from numerics.simulation.semi_discrete import Grid
from tests.benchmarks.cabledyn_rope import cabledyn, ours_from_rest, settings
from tests.benchmarks.forced_rope import (
    BETA,
    EPSILON,
    LENGTH,
    OMEGA,
    ORDER,
    PERIOD,
    PERIODS,
    SAMPLES,
    SLOPE,
    TIMES,
    Outcome,
    contact_of,
    contact_series,
    need,
    profile,
    rms,
)
from tests.benchmarks.moordyn_rope import moordyn
from tests.benchmarks.pyelastica_rope import pyelastica

OUR_SPACINGS = (0.025, 0.02, 0.0125, 0.01, 0.005, 0.0025)
RIVALS: dict[str, Callable[..., Outcome]] = {
    "pyelastica": pyelastica,
    "moordyn": moordyn,
    "cabledyn": cabledyn,
}
MODULES = {"pyelastica": "elastica", "moordyn": "moordyn", "cabledyn": "cabledyn"}
EFFECTS = (("ground", 4.0), ("ground", 64.0), ("rigid", 60.0), ("slope", 2 * SLOPE))


def ours(dx: float) -> Outcome:
    """:mod:`numerics.simulation.contact` with its default scheme, step and domain."""
    simulator = _start(dx)
    # Steps of dx do not meet TIMES: ξ_c is interpolated between the steps.
    run = follow(simulator, (PERIODS + 0.1) * PERIOD, snapshots=simulator.dt)
    found = np.array([contact_of(run.positions, w) for w in run.heights])
    contact = np.interp(TIMES, run.snapshot_times, found)
    simulator, best = _start(dx), math.inf
    for _ in range(16):
        begin, last = time.process_time(), simulator.time
        follow(simulator, last + 2 * PERIOD)
        elapsed = time.process_time() - begin
        best = min(best, elapsed * PERIOD / (simulator.time - last))
    return Outcome("ropewave", simulator.system.size, simulator.dt, best, contact)


def _start(dx: float) -> Simulator:
    simulator = Simulator(RopeProblem(BETA, cosine(OMEGA, EPSILON)), Grid(dx=dx))
    positions, state = simulator.system.positions, simulator.state
    state.height[:] = profile(positions, 0.0)
    state.active[:] = positions >= contact_series(0.0)
    return simulator


def best_of(outcomes: list[Outcome]) -> list[Outcome]:
    """Those that no faster one beats, from the least to the most accurate."""
    front: list[Outcome] = []
    for outcome in sorted(outcomes, key=lambda o: o.seconds):
        if not front or outcome.error < front[-1].error:
            front.append(outcome)
    return front


def seconds_for(error: float, front: list[Outcome]) -> tuple[str, float]:
    """What ``error`` costs along ``front``, log–log between its runs; ``>`` before a bound."""
    if error > front[0].error:
        return ">", front[0].seconds
    if not error >= front[-1].error:
        return "", math.nan
    x = [-math.log(outcome.error) for outcome in front]
    y = [math.log(outcome.seconds) for outcome in front]
    return "", math.exp(np.interp(-math.log(error), x, y))


def row(label: str, outcome: Outcome, front: list[Outcome]) -> str:
    bound, cost = seconds_for(outcome.error, front)
    ratio = f"{bound} {outcome.seconds / cost:,.{0 if outcome.seconds > 10 * cost else 1}f}"
    numbers = f"{outcome.nodes:5d} {outcome.dt:9.1e} {outcome.error:9.1e}"
    own = "" if outcome.own is None else f"  by its own touchdown point {outcome.own:.1e}"
    return f"{label:18s} {numbers} {1e3 * outcome.seconds:10.2f} ms {ratio:>9s}{own}"


def reference_report() -> str:
    """How exact the reference is, and the fit of ξ_c on the exact profile."""
    xi, times = np.linspace(0.0, LENGTH, 181), TIMES[:SAMPLES]
    fitted = np.array([contact_of(xi, profile(xi, tau)) for tau in times])
    tail = np.abs(contact_series(times) - contact_series(times, ORDER - 3)).max()
    return (
        f"reference: series of order {ORDER}, its last three orders {tail:.0e}; "
        f"fit of xi_c off by {rms(fitted - contact_series(times)):.0e}"
    )


def table(rivals: list[str], spacings: list[float], effects: bool) -> None:
    """Print error, seconds and ratio of every run."""
    for name in rivals:  # say at once what is missing
        need(MODULES[name], name)
    print(reference_report())
    print("error: rms of xi_c over the third period; seconds: one forcing period")
    print("ratio: seconds over ours at the same error; '>' where our coarsest grid is better")
    print(f"{'':18s} {'nodes':>5s} {'dt':>9s} {'error':>9s} {'seconds':>13s} {'ratio':>9s}")
    ours(OUR_SPACINGS[0])  # compiles
    measured = [ours(dx) for dx in OUR_SPACINGS]
    front = best_of(measured)
    for outcome in measured:
        print(row(f"ropewave {version('ropewave')}", outcome, front), flush=True)
    for name in rivals:
        if name == "cabledyn":
            print(settings())
            rest = [
                ours_from_rest(dx, like) for dx, like in zip(OUR_SPACINGS, measured, strict=True)
            ]
            front = best_of(rest)
            for outcome in rest:
                print(row("ropewave from rest", outcome, front), flush=True)
        for dx in spacings:
            try:
                outcome = RIVALS[name](dx)
            except Exception as error:  # that a rival gives up is a result too
                print(f"{name} {version(name)} at dx = {dx:g} gives up: {error}", flush=True)
                continue
            print(row(f"{outcome.name} {version(name)}", outcome, front), flush=True)
        for key, value in EFFECTS if effects else ():
            outcome = RIVALS[name](spacings[len(spacings) // 2], **{key: value})
            print(row(f"  {key} = {value:g}", outcome, front), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rivals", nargs="+", choices=RIVALS, default=list(RIVALS))
    parser.add_argument("--spacings", nargs="+", type=float, default=[0.04, 0.02, 0.01])
    parser.add_argument("--effects", action="store_true", help="vary ground, extension, slopes")
    arguments = parser.parse_args()
    table(arguments.rivals, arguments.spacings, arguments.effects)
