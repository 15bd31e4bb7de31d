"""``ropewave critical``: where the periodic state of the exact string with one rotation ends."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import DataOption, JsonOption, PlotOption, WorkersOption
from derivations.output import show, wrote

if TYPE_CHECKING:
    from numerics.exact_string.break_up import BreakUp

SPECIFICATION = "break-up of circles, format 1"
SECONDS = 0.3
"""Of processor time for a number, more or less."""

# Fewer leave too many numbers open: 0.6 may be the golden one.
LEAST_DIGITS = 5

_DECIMAL = re.compile(r"[+-]?(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d{1,4}))?")


def critical(
    rotation: Annotated[
        str | None,
        typer.Option(
            "--rotation",
            metavar="ν",
            help="Rotation number: golden, an expression as sqrt(2)-1, or digits.",
        ),
    ] = None,
    between: Annotated[
        str | None,
        typer.Option(metavar="ν:ν", help="In its place: all noble numbers of a range."),
    ] = None,
    denominators: Annotated[
        int, typer.Option(metavar="q", help="With --between: of how large Farey neighbours.")
    ] = 8,
    data: DataOption = None,
    workers: WorkersOption = 1,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """The string (β = 0): K = 2εΩ², Ω and ε at which the circle of a rotation number breaks up.

    ν is the mean return time of the characteristics in periods of the drive, nearly Ω/π. Of digits
    the noble number that they leave open is taken: the one whose circle lasts longest. With
    --between the ends of many circles trace the boundary of the string's periodic states.
    """
    from asymptotics.errors import InputError

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    if (rotation is None) == (between is None):
        raise InputError("give one of --rotation, a number, and --between, a range as 0.25:1")
    if between is not None:
        _envelope(between, denominators, data, workers, as_json, plot)
        return
    if data is not None or workers != 1:
        raise InputError("--data and --workers are for many numbers: give --between")
    _single(rotation or "", as_json, plot)


def _single(rotation: str, as_json: bool, plot: Path | None) -> None:
    """One rotation number."""
    from derivations.progress import progress
    from numerics.exact_string.break_up import break_up
    from numerics.exact_string.rotation import noble

    value, uncertainty = number_of(rotation)
    meant = noble(value, uncertainty)
    with progress("comparing orbits", 100, as_json) as report:  # per cent
        found = break_up(meant, lambda done, total: report(round(100 * done / total)))
    if plot is not None:
        from derivations.figures.break_up import plot_break_up

        plot_break_up(found, plot)
    show(_as_json(found), _in_words(found), as_json)


def _envelope(
    between: str,
    denominators: int,
    data: Path | None,
    workers: int,
    as_json: bool,
    plot: Path | None,
) -> None:
    """The ends of all noble numbers of a range."""
    from derivations.progress import announce, progress
    from numerics.exact_string.envelope import end_of, nobles_between
    from numerics.sweeps.sweep import sweep

    low, high = _range(between)
    todo = [{"head": list(one.head)} for one in nobles_between(low, high, denominators)]
    announce(f"{len(todo)} numbers, less those kept", len(todo) * SECONDS / workers)
    with progress("breaking circles", len(todo), as_json, fine=True) as report:
        rows = sweep(end_of, todo, data, SPECIFICATION, workers, lambda done, _: report(done))
    if plot is not None:
        from derivations.figures.break_up import plot_envelope

        plot_envelope(rows, denominators, plot)
    fields = {
        "command": "critical",
        "between": [low, high],
        "denominators": denominators,
        "points": rows,
    }
    show(fields, _rows_in_words(rows), as_json)
    wrote(plot)


def _range(text: str) -> tuple[float, float]:
    from asymptotics.errors import InputError

    parts = text.split(":")
    try:
        low, high = map(float, parts)
    except ValueError:
        raise InputError(
            f"--between {text!r}: give two numbers, as 0.25:1, or golden by --rotation"
        ) from None
    return low, high


def _rows_in_words(rows: list[dict[str, Any]]) -> str:
    lines = [f"{'rotation':>12}  {'Omega':>12}  {'epsilon':>13}  {'error':>8}  {'K':>12}"]
    for row in rows:
        if row["reason"] is not None:
            lines.append(f"{row['rotation']:12.9f}  {row['reason']}")
            continue
        lines.append(
            f"{row['rotation']:12.9f}  {row['omega']:12.9f}  {row['epsilon']:13.10f}  "
            f"{row['epsilon_error']:8.1e}  {row['K']:12.9f}"
        )
    return "\n".join(lines)


def number_of(text: str) -> tuple[float, float | None]:
    """ν and by how much it may be off: half a unit of the last digit, or None for rounding only.

    >>> number_of("0.61803"), number_of("sqrt(2)-1")
    ((0.61803, 5e-06), (0.41421356237309503, None))
    """
    from asymptotics.errors import InputError
    from asymptotics.problems.written import expression

    if text.strip().lower() == "golden":
        return (5**0.5 - 1) / 2, None
    decimal = _DECIMAL.fullmatch(text.strip())
    if decimal is not None and (decimal[1] or decimal[2]):
        digits = len((decimal[1] + (decimal[2] or "")).lstrip("0"))
        if digits < LEAST_DIGITS:
            raise InputError(
                f"--rotation {text!r} has {digits} digits, with which too many numbers begin; give "
                f"{LEAST_DIGITS} or more, or an expression as sqrt(2)-1, or golden"
            )
        value = float(text)
        unit = 10.0 ** (int(decimal[3] or 0) - len(decimal[2] or ""))
        return value, None if unit / 2 <= 2.0**-52 * abs(value) else unit / 2
    number = expression(text, "--rotation")
    if number.free_symbols or not number.is_real:
        raise InputError(
            f"--rotation {text!r} is no real number; give digits, golden, or an expression such as "
            "sqrt(2)-1"
        )
    if number.is_rational:
        raise InputError(
            f"--rotation {text!r} is rational: there the string is at a resonance and has no "
            "circle. Give an irrational number as golden or sqrt(2)-1, or its digits"
        )
    return float(number), None


def _as_json(found: BreakUp) -> dict[str, Any]:
    from numerics.exact_string.envelope import numbers_of

    circle = found.last_circle
    return {
        "command": "critical",
        "rotation": found.rotation.value,
        "continued_fraction": list(found.rotation.head),
        **numbers_of(found),
        "residue": found.crossings[-1].residue,
        "last_circle": None
        if circle is None
        else {
            "K": 2 * circle.epsilon * circle.omega**2,
            "omega": circle.omega,
            "epsilon": circle.epsilon,
            "nodes": circle.nodes,
            "contact_speed": circle.contact_speed,
        },
        "crossings": [
            {
                "orbits": [list(crossing.shorter), list(crossing.longer)],
                "K": crossing.strength,
                "residue": crossing.residue,
                "omega": crossing.omega,
            }
            for crossing in found.crossings
        ],
    }


def _in_words(found: BreakUp) -> str:
    head = [*map(str, found.rotation.head), "1, 1, 1"]
    lines = [
        f"rotation number {found.rotation.value:.15g} = [{head[0]}; {', '.join(head[1:])}, ...]",
        "its circle breaks up at",
        f"  K       = {found.strength:.10g}  +- {found.strength_error:.1e}",
        f"  Omega   = {found.omega:.10g}  +- {found.omega_error:.1e}",
        f"  epsilon = {found.epsilon:.10g}  +- {found.epsilon_error:.1e}",
        f"{'orbits':>24}  {'K of equal residue':>18}  residue",
    ]
    for crossing in found.crossings:
        pair = " ".join(f"{p}/{q}" for p, q in (crossing.shorter, crossing.longer))
        lines.append(f"{pair:>24}  {crossing.strength:18.12f}  {crossing.residue:.5f}")
    circle = found.last_circle
    if circle is None:
        lines.append("no circle was found just below: only orbits speak for K")
    else:
        strength = 2 * circle.epsilon * circle.omega**2
        lines.append(
            f"a circle is found at K = {strength:.6f}, epsilon = {circle.epsilon:.8g} on "
            f"{circle.nodes} nodes; its contact point moves at up to {circle.contact_speed:.3f} of "
            "the wave speed"
        )
    if found.by_norms is not None:
        lines.append(f"second opinion, growth of the circles' norms: K = {found.by_norms:.5f}")
    return "\n".join(lines)
