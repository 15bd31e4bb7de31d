"""``ropewave boundary``: ε at which the wave-less state is lost, along Ω, with its mechanism."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import (
    LIST,
    DataOption,
    EndOption,
    JsonOption,
    PlotOption,
    WorkersOption,
    numbers_of,
)
from derivations.commands.simulation import need
from derivations.output import show, wrote

if TYPE_CHECKING:
    from derivations.cross_check.boundary import Point

SECONDS, STARTED_SECONDS = 12.0, 8.0
"""Of processor time that a point takes, more or less, and its simulations."""


def boundary(
    omegas: Annotated[str, typer.Option("--omega", metavar=LIST, help="Drive frequencies Ω.")],
    beta: Annotated[float, typer.Option("--beta", metavar="β", min=0, max=1)] = 0.01,
    driven_end: EndOption = "pinned",
    data: DataOption = None,
    workers: WorkersOption = 1,
    refine: Annotated[
        int,
        typer.Option(
            metavar="ROUNDS",
            min=0,
            max=8,
            help="Of halving Ω where mechanism or ε change much between neighbours.",
        ),
    ] = 0,
    simulated: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Ramped thresholds to draw too: of ropewave figure2."),
    ] = None,
    started: Annotated[
        bool,
        typer.Option(help="Start the simulator on the state, a tenth below and above each point."),
    ] = False,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """Where the wave-less state from rest is lost, at each Ω: by states and by normal forms.

    States are followed in ε until a fold, an instability, a graze, or until more harmonics are
    needed than there are, which is a lower bound. Points at which the two ways differ by more than
    their errors are named.
    """
    from asymptotics.errors import InputError
    from derivations.cross_check.boundary import between, disagreements, point, specification, tasks
    from derivations.progress import announce, progress
    from numerics.sweeps.sweep import sweep

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    if simulated is not None and plot is None:
        raise InputError("--simulated adds points to a figure; give --plot as well")
    if started:
        need("numba")
        if beta == 0:
            raise InputError(
                "--started is for ropes that bend: for beta = 0 the last circle is found at fixed "
                "Omega, and ropewave critical --between has the ends; leave it out"
            )
    values = sorted(set(numbers_of("--omega", omegas)))
    if not values[0] > 0:
        raise InputError(f"--omega {values[0]!r}: frequencies have to be positive")
    drawn = [] if simulated is None else _ramped(simulated, beta)
    points: list[Point] = []
    for _ in range(refine + 1):
        todo = tasks(beta, driven_end, between(points) if points else values, started)
        if not todo:
            break
        each = SECONDS + (STARTED_SECONDS if started else 0)
        announce(f"{len(todo)} points, less those kept", len(todo) * each / workers)
        with progress("boundary", len(todo), as_json, fine=True) as report:
            new = sweep(point, todo, data, specification(), workers, lambda n, _: report(n))
        points = sorted([*points, *new], key=lambda row: float(row["omega"]))
    named = disagreements(points)
    if plot is not None:
        from derivations.figures.boundary import plot_boundary

        plot_boundary(points, beta, drawn, plot)
    fields = {
        "command": "boundary",
        "beta": beta,
        "driven_end": driven_end,
        "points": points,
        "disagreements": named,
    }
    show(fields, _in_words(points, named, beta, driven_end), as_json)
    wrote(plot)


def _ramped(path: Path, beta: float) -> list[tuple[float, float, float]]:
    """Ω, lower and upper of the ramped thresholds at β in a collected file."""
    from derivations.figure2.data import read_collected

    points, _ = read_collected(path)
    return [(p["omega"], p["lower"], p["upper"]) for p in points if p["beta"] == beta]


def _in_words(points: list[Point], named: list[str], beta: float, driven_end: str) -> str:
    from derivations.cross_check.boundary import named as mechanism

    started = any("started" in row for row in points)
    heads = (
        f"{'Omega':>10}  {'epsilon from':>13}  {'to':>13}  {'mechanism':<29}  {'normal form':<24}"
    )
    lines = [
        f"beta = {beta:g}, {driven_end}" if beta else "beta = 0",
        heads + ("  simulator below, above" if started else ""),
    ]
    for row in points:
        upper = "-" if row["upper"] is None else f"{row['upper']:.8g}"
        known: dict[str, Any] | None = row["normal_form"]
        told = "" if known is None else f"{known['epsilon']:.8g} +- {known['error']:.1e}"
        sides = row.get("started")
        seen = "" if sides is None else f"  {sides['below']}, {sides['above'] or '-'}"
        lines.append(
            f"{row['omega']:10.6g}  {row['lower']:13.8g}  {upper:>13}  {mechanism(row):<29}  "
            f"{told:<24}{seen}".rstrip()
        )
    both = sum(row["agrees"] is not None for row in points)
    lines.append(
        f"normal forms in their range: {both} points, {len(named)} of them differ by more than "
        "the errors"
    )
    return "\n".join([*lines, *named])
