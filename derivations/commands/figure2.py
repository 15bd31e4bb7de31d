"""``ropewave figure2``: Fig. 2 of the paper at working resolution, computed and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import JsonOption, WorkersOption
from derivations.output import show, wrote

if TYPE_CHECKING:
    from derivations.figure2.points import Point

SECONDS = {True: 2.0, False: 20.0}
"""Of processor time that a point takes, more or less, coarse or not."""


def figure2(
    coarse: Annotated[
        bool, typer.Option("--coarse", help="A sixth of the points, no error bars: a minute.")
    ] = False,
    out: Annotated[
        Path, typer.Option(metavar="FILE", help="The figure: .png, .pdf or .svg.")
    ] = Path("figure2.png"),
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER|FILE",
            help="Folder to keep the points in and resume from, or a collected .json.",
        ),
    ] = None,
    collect: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write all points as one .json.")
    ] = None,
    tables: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the tables, as markdown: .md.")
    ] = None,
    workers: WorkersOption = 1,
    as_json: JsonOption = False,
) -> None:
    """Compute where the wave-less state is lost, and draw it against every law."""
    from asymptotics.errors import InputError
    from derivations.figure2.fits import exponents
    from derivations.figure2.laws import all_laws
    from derivations.figure2.plot import plot_figure2
    from derivations.figures.plots import check_plot_path
    from derivations.files import check_writable, write_file

    check_plot_path(out)
    if tables is not None and tables.suffix != ".md":
        raise InputError(f"--tables {tables}: the file's name ends in .md")
    for path in (collect, tables):
        if path is not None:
            check_writable(path)
    points, coarse = _points(coarse, data, workers, as_json)
    written = [out]
    plot_figure2(points, out)
    if collect is not None:
        from derivations.figure2.data import collected

        write_file(collect, collected(points, coarse).encode())
        written.append(collect)
    if tables is not None:
        written.append(_write_tables(points, coarse, tables))
    fits = exponents(points)
    show(_report(points, fits, all_laws(), coarse, written), _text(points, fits), as_json)
    wrote(*written)


def _points(coarse: bool, data: Path | None, workers: int, quiet: bool) -> tuple[list[Point], bool]:
    """Read a collected file, or compute, in memory when coarse and without a folder."""
    from derivations.figure2.data import compute, read_collected, tasks
    from derivations.progress import announce, announce_compiling, progress

    if data is not None and data.suffix == ".json":
        return read_collected(data)
    from derivations.commands.simulation import need

    need("numba")
    announce_compiling(quiet)
    if data is None and not coarse:
        from derivations.cache import cache_folder

        data = cache_folder("figure2")
    folder = None if data is None else data / ("coarse" if coarse else "working")
    count = len(tasks(coarse))
    announce(f"{count} points, less those kept", count * SECONDS[coarse] / workers)
    with progress("figure 2", count, quiet, fine=True) as tell:
        return compute(coarse, folder, workers, lambda done, _: tell(done)), coarse


def _write_tables(points: list[Point], coarse: bool, path: Path) -> Path:
    from derivations.figure2 import tables as figure2_tables
    from derivations.reports.formats import write_files

    [written] = write_files({path.name: figure2_tables.tables(points, coarse)}, path.parent)
    return written


def _text(points: list[Point], fits: list[Any]) -> str:
    """How many points, and the exponents."""
    lines = [f"{len(points)} points"]
    for fit in fits:
        side = "below" if fit.side < 0 else "above"
        lines.append(
            f"{fit.curve:12} {side} {fit.resonance}, {fit.window:4} "
            f"epsilon ~ |mu|^({fit.value:.2f} +- {fit.error:.2f}), {fit.count} points"
        )
    return "\n".join(lines)


def _report(
    points: list[Point], fits: list[Any], laws: Any, coarse: bool, written: list[Path]
) -> dict[str, Any]:
    from derivations.figure2.data import specification

    return {
        "command": "figure2",
        "specification": specification(coarse),
        "points": points,
        "exponents": [vars(fit) for fit in fits],
        "laws": [
            {
                "family": law.family.value,
                "resonance": law.resonance,
                "beta": law.beta,
                "centre": law.centre,
                "coefficient": law.coefficient,
                "exponent": str(law.exponent),
                "sides": list(law.sides),
                # JSON has no infinity: null is a window without an end, or none at all.
                "window": [edge if abs(edge) < float("inf") else None for edge in law.window],
            }
            for law in laws
        ],
        "files": [str(path) for path in written],
    }
