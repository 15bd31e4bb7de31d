"""``ropewave state``: the periodic wave-less state of a rope, and whether it is stable."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import (
    EpsilonOption,
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    PlotOption,
    omega_of,
)
from derivations.commands.ropes import (
    Asked,
    BendingOption,
    DampingOption,
    DriveOption,
    EndOption,
    ProblemOption,
    SetOption,
    asked,
)
from derivations.commands.simulation import need
from derivations.output import show, wrote

if TYPE_CHECKING:
    from numerics.periodic.stability import Stability
    from numerics.periodic.states import PeriodicState


def state(
    epsilon: EpsilonOption,
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    subharmonic: Annotated[
        int,
        typer.Option(metavar="s", min=1, max=2, help="2: of twice the drive's period."),
    ] = 1,
    simulate: Annotated[
        int | None,
        typer.Option(metavar="COUNT", min=8, help="Periods of a simulation that starts on it."),
    ] = None,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """The periodic wave-less state at Ω and ε, not expanded in ε, and its Floquet multipliers.

    It is the one that begins at rest: beyond a fold there is none. With --subharmonic 2 it is on
    the branch that leaves this one at its first period doubling. The rope has constant
    coefficients. --simulate starts the contact simulator on the state, on two grids, and says
    whether it stays.
    """
    from asymptotics.checks import finite_number
    from asymptotics.errors import InputError
    from asymptotics.problems.presets import string
    from derivations.cross_check.ropes import by_frequency
    from derivations.progress import progress
    from numerics.periodic.branches import doubled_state
    from numerics.periodic.states import periodic_state

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    omega = finite_number("--omega", omega_of(omega, hz, height))
    epsilon = finite_number("--epsilon", epsilon)
    if not omega > 0:
        raise InputError(f"--omega {omega!r}: the frequency has to be positive")
    rope = asked(problem, values, beta, driven_end, damping, drive) or Asked(string(), {})
    stated = by_frequency(rope.rope, rope.at)(omega)
    if simulate is not None:
        need("numba")
    with progress("finding the state", 1.0, as_json):
        if subharmonic == 2:
            found = doubled_state(stated, epsilon)
        else:
            found = periodic_state(stated, epsilon)
    height_left = found.clearance()
    if not height_left > 0:
        raise InputError(
            f"at epsilon = {epsilon:g}, Omega = {omega:g} the periodic solution is below the "
            f"ground (clearance {height_left:.3g} of that at rest): the rope touches the ground "
            "elsewhere, and the wave-less state has ended; give a smaller epsilon"
        )
    judged, reason = _judged(found)
    run = None if simulate is None else _simulated(found, simulate, as_json)
    if plot is not None:
        from derivations.figures.state import plot_state

        plot_state(found, judged, plot)
    fields = {
        "command": "state",
        "omega": omega,
        "epsilon": epsilon,
        "problem": str(rope.rope),
        "static_contact": stated.rest,
        "contact": [float(c) for c in found.waves.real],
        **({} if found.even else {"contact_sine": [float(c) for c in found.waves.imag]}),
        "subharmonic": found.modes.subharmonic,
        "residual": found.residual,
        "error": found.error,
        "clearance": height_left,
        "stable": "undecided" if judged is None else judged.verdict,
        "reason": reason,
        "modes": None if judged is None else judged.modes,
        "multipliers": None
        if judged is None
        else [[float(x.real), float(x.imag)] for x in judged.multipliers],
        **({} if run is None else {"simulated": run}),
    }
    words = _in_words(str(rope.rope), found, judged, reason, height_left)
    if run is not None:
        words += "\n" + _run_in_words(run, found, judged)
    show(fields, words, as_json)
    wrote(plot)


def _simulated(found: PeriodicState, periods: int, quiet: bool) -> dict[str, Any]:
    """What a rope does that starts on the state."""
    from derivations.progress import announce_compiling, progress
    from numerics.thresholds.from_state import outcome

    announce_compiling(quiet)
    with progress("simulating", 1.0, quiet):
        told, run = outcome(found, periods)
    return {
        "outcome": told.value,
        "periods": periods,
        "rate": None if math.isnan(run.rate) else run.rate,
        "rate_error": None if math.isnan(run.rate_error) else run.rate_error,
        "left": run.left,
        "shed": run.shed,
    }


def _run_in_words(run: dict[str, Any], found: PeriodicState, judged: Stability | None) -> str:
    from numerics.thresholds.from_state import periods_needed

    told = f"simulated {run['periods']} periods, started on the state: {run['outcome']}"
    if judged is not None and judged.verdict == "unstable" and run["outcome"] != "leaves":
        wanted = periods_needed(judged.multipliers, found.modes.subharmonic)
        told += f" (the fastest disturbance needs some {wanted} periods to be seen)"
    if run["rate"] is not None:
        told += f"; disturbances change at {run['rate']:.5f} +- {run['rate_error']:.5f} per tau"
        if judged is not None:
            told += f" on the finer grid, by multipliers {judged.growth:.5f}"
    if run["shed"]:
        told += "; waves are shed"
    return told


def _judged(found: PeriodicState) -> tuple[Stability | None, str | None]:
    """The verdict, or why there is none."""
    from numerics.errors import InputError
    from numerics.periodic.stability import stability

    try:
        return stability(found), None
    except InputError as error:
        return None, str(error)


def _in_words(
    name: str,
    found: PeriodicState,
    judged: Stability | None,
    reason: str | None,
    height_left: float,
) -> str:
    from numerics.periodic.states import resolved

    lines = [
        f"{name}, epsilon = {found.epsilon:g}",
        f"xi_c: error {found.error:.1e}, {resolved(found)} harmonics; least height "
        f"{height_left:.3g} of that at rest",
    ]
    angle = "theta" if found.modes.subharmonic == 1 else f"theta/{found.modes.subharmonic}"
    for j, c in enumerate(found.waves[:9].tolist()):
        sine = "" if found.even else f"  {c.imag:+.14g} sin {j} {angle}"
        lines.append(f"  {c.real:+.14g} cos {j} {angle}{sine}")
    if judged is None:
        return "\n".join([*lines, f"stability: undecided; {reason}"])
    largest = judged.multipliers[0]
    return "\n".join(
        [
            *lines,
            f"stability: {judged.verdict}, by {judged.modes} modes; largest multiplier "
            f"{largest:.8g}, |.| = {abs(largest):.10g}",
        ]
    )
