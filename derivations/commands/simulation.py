"""``ropewave simulate``: the rope in contact with the ground, step by step."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from derivations.commands.options import (
    EndOption,
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    PlotOption,
    RopeBetaOption,
    numbers_of,
    omega_of,
)
from derivations.output import note, show, wrote

if TYPE_CHECKING:
    from derivations.reports.watched_run import Watched
    from numerics.problems.drive import Drive
    from numerics.simulation.contact import Simulator

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


COEFFICIENTS = "C0,C1,…"


def simulate(
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    epsilon: Annotated[
        float | None, typer.Option("--epsilon", metavar="ε", help="Forcing amplitude, units of Z₀.")
    ] = None,
    beta: RopeBetaOption = 0.01,
    periods: Annotated[
        float | None,
        typer.Option(metavar="COUNT", help="Forcing periods in all; default: ramp + 10."),
    ] = None,
    ramp: Annotated[
        float,
        typer.Option(metavar="COUNT", min=0, help="Periods over which ε rises; 0: at once."),
    ] = 20.0,
    keep: Annotated[
        float,
        typer.Option(metavar="COUNT", help="Periods at the end for --out, --plot, --animate."),
    ] = 4.0,
    dx: Annotated[
        float | None,
        typer.Option(metavar="Δξ", help="Spacing; default: 0.01, or round below √β/20."),
    ] = None,
    dt: Annotated[
        float | None, typer.Option(metavar="Δτ", help="Time step; default: dx, or stable.")
    ] = None,
    length: Annotated[float, typer.Option(metavar="LENGTH", help="Of the domain, in x₀.")] = 8.0,
    sponge: Annotated[
        float, typer.Option(metavar="LENGTH", min=0, help="Its last part, which absorbs waves.")
    ] = 3.0,
    scheme: Annotated[
        Literal["trapezoidal", "verlet"], typer.Option(help="Implicit, or explicit.")
    ] = "trapezoidal",
    driven_end: EndOption = "pinned",
    damping: Annotated[
        float, typer.Option(metavar="ζ", min=0, help="Free waves decay as exp(−ζτ).")
    ] = 0.0,
    restitution: Annotated[
        float, typer.Option(metavar="r", min=0, max=1, help="Of speed in an impact.")
    ] = 0.0,
    foundation: Annotated[
        str | None, typer.Option(metavar=COEFFICIENTS, help="κ(ξ) ≥ 0, a polynomial.")
    ] = None,
    tension: Annotated[
        str | None, typer.Option(metavar=COEFFICIENTS, help="T(ξ) > 0; 1 by default.")
    ] = None,
    mass: Annotated[
        str | None, typer.Option(metavar=COEFFICIENTS, help="m(ξ) > 0; 1 by default.")
    ] = None,
    weight: Annotated[
        str | None, typer.Option(metavar=COEFFICIENTS, help="q(ξ); 2 by default.")
    ] = None,
    ground: Annotated[
        str | None, typer.Option(metavar=COEFFICIENTS, help="g(ξ), g(0) = 0; W is measured above.")
    ] = None,
    samples: Annotated[
        Path | None,
        typer.Option("--samples", metavar="FILE.csv", help="Drive: lines τ,Z; not Ω and ε."),
    ] = None,
    until: Annotated[
        float | None, typer.Option(metavar="τ", help="With --samples: by default their last.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a netCDF file, .nc.")
    ] = None,
    plot: PlotOption = None,
    animate: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write an animation, .gif.")
    ] = None,
    checkpoint: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Save the state here as it goes, and resume from it."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Simulate a rope that is shaken: does it follow, or does it shed waves?"""
    need("numba")
    from derivations.progress import announce, announce_compiling, progress
    from derivations.reports import simulation as report
    from derivations.reports.watched_run import default_dx, drive_of, seconds, watch
    from numerics.problems.problem import DrivenEnd, RopeProblem
    from numerics.simulation.contact import Simulator
    from numerics.simulation.semi_discrete import Grid

    varying = _varying(
        foundation=foundation, tension=tension, mass=mass, weight=weight, ground=ground
    )
    if hz is not None or height is not None:
        omega = omega_of(omega, hz, height)
    if samples is None:
        omega, epsilon = _both(omega, epsilon, until)
        drive = drive_of(omega, epsilon, ramp)
    else:
        drive = _sampled(samples, omega, epsilon, plot, animate, checkpoint)
    problem = RopeProblem(beta, drive, DrivenEnd(driven_end), damping, restitution, **varying)
    grid = Grid(default_dx(problem.beta) if dx is None else dx, length, sponge)
    if epsilon is None:
        announce_compiling(as_json)
        _recorded(Simulator(problem, grid, dt, scheme), until, out, as_json)
        return
    total = ramp + 10 if periods is None else periods
    announce_compiling(as_json)
    simulator = Simulator(problem, grid, dt, scheme)
    _check_files(simulator, total * drive.period, out, plot, animate, checkpoint)
    try:
        with progress("simulating", 1.0, as_json, fine=True) as tell:
            watched = watch(
                problem,
                epsilon,
                ramp,
                total,
                grid,
                dt,
                scheme,
                keep,
                checkpoint,
                lambda done, last: tell(done / last),
                lambda nodes, steps: announce(
                    f"{steps} steps of {nodes} nodes", seconds(nodes, steps, scheme)
                ),
            )
    except KeyboardInterrupt:
        if checkpoint is not None:
            note(f"interrupted; the same command goes on from {checkpoint}")
        raise typer.Exit(INTERRUPTED) from None
    # First what was found: a full disk does not take it away.
    show(report.as_json(watched), report.as_text(watched), as_json)
    _write(watched, out, plot, animate, as_json)
    wrote(out, plot, animate)


def _varying(**texts: str | None) -> dict[str, Any]:
    """The polynomials that were given, by name."""
    return {name: numbers_of(f"--{name}", text) for name, text in texts.items() if text is not None}


def _both(omega: float | None, epsilon: float | None, until: float | None) -> tuple[float, float]:
    from asymptotics.errors import InputError

    if omega is None or epsilon is None:
        raise InputError(
            "give --omega (or --hz and --height) and --epsilon, or --samples FILE.csv with lines "
            "tau,Z"
        )
    if until is not None:
        raise InputError("--until belongs to --samples; a periodic drive is followed for --periods")
    return omega, epsilon


def _sampled(
    samples: Path,
    omega: float | None,
    epsilon: float | None,
    plot: Path | None,
    animate: Path | None,
    checkpoint: Path | None,
) -> Drive:
    """The recorded drive; what needs a forcing period goes without it."""
    from asymptotics.errors import InputError
    from numerics.problems.sampled import read_samples

    periodic = {
        "--omega": omega,
        "--epsilon": epsilon,
        "--plot": plot,
        "--animate": animate,
        "--checkpoint": checkpoint,
    }
    given = [name for name, value in periodic.items() if value is not None]
    if given:
        raise InputError(
            f"--samples and {', '.join(given)}: samples say all of the drive, and have no period; "
            "--out keeps the run"
        )
    return read_samples(samples)


def _recorded(simulator: Simulator, until: float | None, out: Path | None, as_json: bool) -> None:
    """A run under a drive without a period: followed to a time, summed up, kept."""
    from derivations.progress import progress
    from derivations.reports.simulation import of_any_drive
    from numerics.simulation.run import follow

    last = simulator.problem.drive.label.split("tau = ")[1].split(",")[0]
    end = float(last) if until is None else until
    _check_files(simulator, end, out, None, None, None)
    with progress("simulating", 1.0, as_json, fine=True) as tell:
        run = follow(simulator, end, 0.0, None, lambda done, of: tell(done / of))
    show(*of_any_drive(run), as_json)
    if out is not None:
        from derivations.files import make_folder_of
        from numerics.files.runs import dataset, save

        make_folder_of(out)
        save(dataset(run), out)
    wrote(out)


def need(package: str) -> None:
    """That an optional package is there, or one clear error."""
    from numerics.errors import MissingPackageError

    try:
        importlib.import_module(package)
    except ImportError:
        raise MissingPackageError(
            f"{package} is needed to simulate; pip install 'ropewave[sim]'"
        ) from None


def _check_files(
    simulator: Simulator,
    until: float,
    out: Path | None,
    plot: Path | None,
    animate: Path | None,
    checkpoint: Path | None,
) -> None:
    """All that can be wrong with the files to be written, before the long work."""
    from asymptotics.errors import InputError
    from derivations.figures.animation import check_animation_path
    from derivations.figures.plots import check_plot_path
    from derivations.files import check_writable
    from numerics.files.sealed import is_there, specification

    given = [path for path in (out, plot, animate, checkpoint) if path is not None]
    named = [os.path.realpath(path) for path in given]
    for path, name in zip(given, named, strict=True):
        if named.count(name) > 1:
            raise InputError(f"{path.name} is named twice; each file needs a name of its own")
    if plot is not None:
        check_plot_path(plot)
    if animate is not None:
        check_animation_path(animate)
    if out is not None:
        if out.suffix.lower() != ".nc":
            raise InputError(f"--out {out.name!r}: netCDF files end in .nc")
        for package in ("xarray", "h5netcdf", "h5py"):
            need(package)
        check_writable(out)
        if is_there(out):
            from numerics.files.runs import check_replaceable

            check_replaceable(out, specification(simulator), until + simulator.dt)


def _write(
    watched: Watched, out: Path | None, plot: Path | None, animate: Path | None, quiet: bool
) -> None:
    if out is not None:
        from derivations.files import make_folder_of
        from numerics.files.runs import dataset, save

        make_folder_of(out)
        asked = {"epsilon": watched.epsilon, "ramp": watched.ramp, "periods": watched.periods}
        save(dataset(watched.run).assign_attrs(asked), out)
    if plot is not None:
        from derivations.figures.simulation import plot_run

        plot_run(watched.run, plot, watched.epsilon)
    if animate is not None:
        from derivations.figures.animation import animate_run, animation_frames
        from derivations.progress import progress

        frames = len(animation_frames(watched.run))
        with progress("animating", frames, quiet, fine=True) as report:
            animate_run(watched.run, animate, watched.epsilon, report)
