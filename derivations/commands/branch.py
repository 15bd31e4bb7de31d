"""``ropewave branch``: periodic states along ε or Ω, past folds, and where their number changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

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
from derivations.output import show, wrote

if TYPE_CHECKING:
    from numerics.periodic.branches import BranchPoint
    from numerics.periodic.loci import LocusPoint

FEWEST_STEPS = 20
"""Of the first length in the way that is asked for."""


def branch(
    epsilon: EpsilonOption,
    to: Annotated[float, typer.Option("--to", metavar="X", help="ε or Ω to go to.")],
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    free: Annotated[
        Literal["epsilon", "omega"], typer.Option("--free", help="What is varied.")
    ] = "epsilon",
    step: Annotated[
        float | None, typer.Option("--step", metavar="ΔX", help="First step; default: way/20.")
    ] = None,
    points: Annotated[int, typer.Option("--points", min=2, max=5000, help="The most.")] = 200,
    subharmonic: Annotated[
        int,
        typer.Option(
            "--subharmonic", min=1, max=2, help="2: change to the branch of the doubled period."
        ),
    ] = 1,
    stable: Annotated[
        bool, typer.Option("--stability/--no-stability", help="Floquet multipliers at each point.")
    ] = True,
    curve: Annotated[
        float | None,
        typer.Option(
            metavar="Ω", help="Follow the first fold or period doubling in the plane, to this Ω."
        ),
    ] = None,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """The branch of periodic states that begins at --epsilon and --omega, by its arclength.

    It is followed past folds until ε or Ω leaves the interval between where it began and --to (0
    and --to, for ε). Folds, period doublings and other branches are located on the way. With
    --curve the first fold or period doubling is followed further, ε as a function of Ω.
    """
    from asymptotics.checks import finite_number
    from asymptotics.errors import InputError
    from asymptotics.problems.presets import string

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    omega = finite_number("--omega", omega_of(omega, hz, height))
    epsilon, to = finite_number("--epsilon", epsilon), finite_number("--to", to)
    begin = epsilon if free == "epsilon" else omega
    if not omega > 0 or (free == "omega" and not to > 0):
        raise InputError("--omega and, with --free omega, --to have to be positive")
    if to == begin:
        raise InputError(f"--to {to!r} is where the branch begins; give another number")
    rope = asked(problem, values, beta, driven_end, damping, drive) or Asked(string(), {})
    first = (to - begin) / FEWEST_STEPS if step is None else finite_number("--step", step)
    found, ended = _followed(
        rope, epsilon, omega, free, first, (begin, to), points, subharmonic, as_json
    )
    verdicts: list[str | None] = _verdicts(found, as_json) if stable else [None] * len(found)
    fields = _fields(rope, free, found, verdicts, ended)
    words = _in_words(rope, free, found, verdicts, ended)
    if curve is not None:
        kind, followed, lost = _curve(rope, found, finite_number("--curve", curve), as_json)
        fields["curve"] = {
            "kind": kind,
            "points": [{"omega": p.omega, "epsilon": p.epsilon, "kind": p.kind} for p in followed],
            "ended": lost,
        }
        words += "\n" + _curve_in_words(kind, followed, lost)
        if plot is not None:
            from derivations.figures.branch import plot_curve

            plot_curve(kind, followed, plot)
    elif plot is not None:
        from derivations.figures.branch import plot_branch

        plot_branch(found, verdicts, free, plot)
    show(fields, words, as_json)
    wrote(plot)


def _curve(
    rope: Asked, found: list[BranchPoint], to: float, quiet: bool
) -> tuple[str, list[LocusPoint], str | None]:
    """Its kind, the points, and why there are no more."""
    from asymptotics.errors import InputError
    from derivations.cross_check.ropes import by_frequency
    from derivations.progress import progress
    from numerics.periodic.linear_rope import NoPeriodicStateError
    from numerics.periodic.loci import KINDS, locus

    start = next((point for point in found if point.kind in KINDS), None)
    if start is None or start.state.modes.subharmonic > 1:
        raise InputError(
            "--curve: there is no fold and no period doubling of the drive's period on this "
            "branch; go farther by --to, or begin elsewhere"
        )
    if not to > 0 or to == start.omega:
        raise InputError(f"--curve {to!r}: give a positive Omega other than {start.omega!r}")
    limits = (min(to, start.omega) * 0.999, to) if to > start.omega else (to, start.omega * 1.001)
    followed: list[LocusPoint] = []
    ended: str | None = None
    with progress(f"following the {start.kind}", 100, quiet) as report:  # per cent
        try:
            step = (to - start.omega) / FEWEST_STEPS
            for point in locus(by_frequency(rope.rope, rope.at), start, step, limits):
                followed.append(point)
                report(round(100 * min(abs((point.omega - start.omega) / (to - start.omega)), 1.0)))
        except NoPeriodicStateError as error:
            ended = str(error)
    return start.kind or "", followed, ended


def _curve_in_words(kind: str, followed: list[LocusPoint], ended: str | None) -> str:
    lines = [f"the curve of the {kind}", f"{'Omega':>12}  {'epsilon':>14}"]
    for point in followed:
        told = "" if point.kind is None else f"  <- {point.kind}"
        lines.append(f"{point.omega:12.9g}  {point.epsilon:14.9g}{told}")
    return "\n".join(lines if ended is None else [*lines, f"ended: {ended}"])


def _followed(
    rope: Asked,
    epsilon: float,
    omega: float,
    free: str,
    step: float,
    ends: tuple[float, float],
    points: int,
    subharmonic: int,
    quiet: bool,
) -> tuple[list[BranchPoint], str | None]:
    """The points, and why there are no more; of the doubled branch where it is asked for."""
    from asymptotics.errors import InputError
    from derivations.cross_check.ropes import by_frequency
    from derivations.progress import progress
    from numerics.periodic.branches import follow, switched
    from numerics.periodic.linear_rope import NoPeriodicStateError
    from numerics.periodic.states import periodic_state

    stated = by_frequency(rope.rope, rope.at)
    low, high = min(ends), max(ends)
    if free == "epsilon":
        low, high = min(low, 0.0), max(high, 0.0)
    found: list[BranchPoint] = []
    ended: str | None = None
    with progress("following the branch", points, quiet, fine=True) as report:
        start, tangent = periodic_state(stated(omega), epsilon), None
        if subharmonic == 2:
            walk = follow(stated, start, free, step, (low, high), points)
            doubling = next((point for point in walk if point.kind == "period doubling"), None)
            if doubling is None:
                raise InputError(
                    f"no period doubling between {free} = {ends[0]!r} and {ends[1]!r}; try near "
                    "twice a free frequency, or without --subharmonic 2 first"
                )
            start, tangent = switched(doubling)
        try:
            # The first step onto another branch is a small one.
            longest = 4.0 if tangent is None else 64.0
            walk = follow(stated, start, free, step, (low, high), points, tangent, longest)
            for count, point in enumerate(walk):
                found.append(point)
                report(min(count, points))
        except NoPeriodicStateError as error:
            ended = str(error)
    return found, ended


def _verdicts(found: list[BranchPoint], quiet: bool) -> list[str | None]:
    """Stable or not, at each point."""
    from derivations.progress import progress
    from numerics.errors import InputError
    from numerics.periodic.stability import stability

    verdicts: list[str | None] = []
    with progress("Floquet multipliers", len(found), quiet, fine=True) as report:
        for point in found:
            try:
                verdicts.append(stability(point.state).verdict)
            except InputError:
                verdicts.append("undecided")
            report(len(verdicts))
    return verdicts


def _fields(
    rope: Asked,
    free: str,
    found: list[BranchPoint],
    verdicts: list[str | None],
    ended: str | None,
) -> dict[str, Any]:
    def numbers(point: BranchPoint) -> dict[str, Any]:
        return {"epsilon": point.epsilon, "omega": point.omega, "amplitude": point.amplitude}

    return {
        "command": "branch",
        "problem": str(rope.rope),
        "free": free,
        "subharmonic": found[0].state.modes.subharmonic,
        "points": [
            {**numbers(point), "stable": verdict}
            for point, verdict in zip(found, verdicts, strict=True)
            if point.kind is None
        ],
        "bifurcations": [
            {**numbers(point), "kind": point.kind, "harmonic": point.harmonic}
            for point in found
            if point.kind is not None
        ],
        "ended": ended,
    }


def _in_words(
    rope: Asked,
    free: str,
    found: list[BranchPoint],
    verdicts: list[str | None],
    ended: str | None,
) -> str:
    lines = [
        f"{rope.rope}, along {free}",
        f"{'epsilon':>14}  {'Omega':>12}  {'amplitude':>10}  {'stable':>9}",
    ]
    for point, verdict in zip(found, verdicts, strict=True):
        told = "" if point.kind is None else f"  <- {point.kind}"
        if point.harmonic is not None:
            told += f", harmonic {point.harmonic}"
        lines.append(
            f"{point.epsilon:14.9g}  {point.omega:12.9g}  {point.amplitude:10.6f}  "
            f"{verdict or '':>9}{told}"
        )
    if ended is not None:
        lines.append(f"ended: {ended}")
    return "\n".join([*lines, "loops within one step are not seen; --step sets the first one"])
