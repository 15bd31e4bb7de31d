"""``ropewave resonances``, ``tongue`` and ``fold``: where the wave-less state meets resonance."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from derivations.options import (
    BetaOption,
    EndOption,
    JsonOption,
    LatexOption,
    OrderOption,
    PlotOption,
    number_of,
    order_of,
)

Ratio = Annotated[str, typer.Argument(metavar="P/Q", help="The resonance, e.g. 1/2.")]


def resonances(
    beta: BetaOption = "0",
    driven_end: EndOption = "pinned",
    count: Annotated[str, typer.Option(help="How many linear resonances.")] = "5",
    order: OrderOption = "3",
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """Linear resonances Ω_n(β), and the nonlinear Ω_p(β)/q with q ≤ N between them."""
    from derivations import resonance_report as report

    table = report.resonance_table(
        number_of("--beta", beta), driven_end, order_of(count, "--count"), order_of(order)
    )
    if plot is not None:
        report.plot_spectrum(plot, table)
    show(report.as_json(table), report.as_text(table), as_json)
    write_extras(latex, report.latex_table(table), plot)


def tongue(
    ratio: Ratio,
    order: OrderOption = "3",
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The tongue of p/q where the order-N expansion touches the ground, and its limit law."""
    from asymptotics.tongues import parse_fraction
    from asymptotics.tongues import tongue as compute
    from derivations import tongue_report as report

    p, q = parse_fraction(ratio)
    result = compute(p, q, order_of(order))
    if plot is not None:
        report.plot_tongues([(p, q)], result.order, plot)
    show(report.as_json(result), report.as_text(result), as_json)
    write_extras(latex, report.latex_table([result]), plot)


def fold(
    ratio: Ratio,
    beta: BetaOption = "0.01",
    driven_end: EndOption = "pinned",
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The fold near Ω_p(β)/q of the rope that bends: what it ends, and how far its law holds."""
    from asymptotics.folds import fold as compute
    from asymptotics.tongues import parse_fraction
    from derivations import fold_report as report

    p, q = parse_fraction(ratio)
    result = compute(p, q, number_of("--beta", beta), driven_end)
    if plot is not None:
        report.plot_fold(result, plot)
    show(result.as_json(), report.fold_text(result), as_json)
    write_extras(latex, report.fold_table([result]), plot)


def show(fields: dict[str, Any], text: str, as_json: bool) -> None:
    """One JSON object, or text."""
    print(json.dumps(fields) if as_json else text.rstrip("\n"))


def write_extras(latex: Path | None, table: str, plot: Path | None) -> None:
    """Write the LaTeX table where one is asked for, and say what was written."""
    from derivations.formats import write_files

    written = [] if plot is None else [plot]
    if latex is not None:
        written += write_files({latex.name: table.rstrip("\n") + "\n"}, latex.parent)
    for path in written:
        print(f"wrote {path}", file=sys.stderr)
