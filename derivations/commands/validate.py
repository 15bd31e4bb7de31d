"""``ropewave validate``: closed forms on trial, order by order."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from derivations.commands.options import (
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    OrderOption,
    PlotOption,
    RopeBetaOption,
    omega_of,
)
from derivations.commands.ropes import (
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
    from derivations.cross_check.validation import Validation


def validate(
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    beta: RopeBetaOption = 0.0,
    order: OrderOption = 3,
    form: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.py",
            help="Your own closed form, contact(tau, omega, epsilon), right through order N; "
            "the file is run.",
        ),
    ] = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer amplitudes, coarser grid.")] = False,
    plot: PlotOption = None,
    as_json: JsonOption = False,
) -> None:
    """Does each order's error fall like the next power of ε?

    Against the exact string, or (β > 0) the contact simulator; of a rope by --problem, --damping,
    --drive or --driven-end against its periodic state.
    """
    from derivations.cross_check.ladder import draw_validation
    from derivations.cross_check.validation import read_form, validate_rope
    from derivations.cross_check.validation import validate as judge
    from derivations.figures.plots import check_plot_path, save_figure
    from derivations.progress import announce_compiling, progress

    omega = omega_of(omega, hz, height)
    if plot is not None:
        check_plot_path(plot)
    own = None if form is None else read_form(form)
    kin = [problem, values, driven_end, damping, drive]
    rope = None
    if any(option is not None for option in kin):
        rope = asked(problem, values, beta or None, driven_end, damping, drive)
    else:
        need("numba")
        announce_compiling(as_json)
    with progress("comparing", 1.0, as_json, fine=True) as report:

        def told(done: int, of: int) -> None:
            report(done / of)

        if rope is None:
            found = judge(omega, beta, order, quick, own, told)
        else:
            found = validate_rope(rope.rope, {**rope.at, "Omega": omega}, order, quick, own, told)
    if plot is not None:
        save_figure(draw_validation(found), plot)
    fields = {"command": "validate", "order": order, "form": None if form is None else str(form)}
    show({**fields, **found.as_json()}, _in_words(found, form), as_json)
    wrote(plot)


def _in_words(found: Validation, form: Path | None) -> str:
    one = found.comparison
    beta = "" if math.isnan(one.beta) else f", beta = {one.beta:g}"
    lines = [
        f"Omega = {one.omega:g}{beta}, against {found.judge}",
        "error of xi_c, root mean square over a period, at epsilon = "
        f"{one.epsilon[0]:.3g} … {one.epsilon[-1]:.3g}; its floor {one.contact.floor[-1]:.1e}",
        "order   wanted  slope          decades of epsilon  verdict",
    ]
    for judged in found.orders:
        slope = "-" if judged.slope is None else f"{judged.slope:.3f} ± {judged.uncertainty:.2f}"
        whose = f"  ({form})" if form is not None and judged.order == one.orders[-1] else ""
        lines.append(
            f"{judged.order:<6}  {judged.order + 1:<6}  {slope:<13}  {judged.decades:<18.2f}  "
            f"{judged.verdict}{whose}"
        )
    return "\n".join(lines)
