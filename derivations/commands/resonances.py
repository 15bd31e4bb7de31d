"""``ropewave resonances``, ``tongue`` and ``fold``: where the wave-less state meets resonance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from derivations.commands.options import (
    BetaOption,
    EndOption,
    JsonOption,
    LatexOption,
    OrderOption,
    PlotOption,
)
from derivations.output import show, wrote

Ratio = Annotated[str, typer.Argument(metavar="P/Q", help="The resonance, e.g. 1/2.")]


def resonances(
    beta: BetaOption = 0.0,
    driven_end: EndOption = "pinned",
    count: Annotated[
        int, typer.Option(metavar="COUNT", min=1, help="How many linear resonances.")
    ] = 5,
    order: OrderOption = 3,
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """Linear resonances Ω_n(β), and the nonlinear Ω_p(β)/q with q ≤ N between them."""
    from derivations.reports import resonances as report

    check_extras(latex, plot)
    table = report.resonance_table(beta, driven_end, count, order)
    if plot is not None:
        report.plot_spectrum(plot, table)
    show(report.as_json(table), report.as_text(table), as_json)
    write_extras(latex, report.latex_table(table), plot)


def tongue(
    ratio: Ratio,
    order: OrderOption = 3,
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The tongue of p/q where the order-N expansion touches the ground, and its limit law."""
    from asymptotics.resonances.tongues import parse_fraction
    from asymptotics.resonances.tongues import tongue as compute
    from derivations.reports import tongues as report

    check_extras(latex, plot)
    p, q = parse_fraction(ratio)
    result = compute(p, q, order)
    if plot is not None:
        report.plot_tongues([(p, q)], result.order, plot)
    show(report.as_json(result), report.as_text(result), as_json)
    write_extras(latex, report.latex_table([result]), plot)


def fold(
    ratio: Ratio,
    beta: BetaOption = 0.01,
    driven_end: EndOption = "pinned",
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The fold near Ω_p(β)/q of the rope that bends: what it ends, and how far its law holds."""
    from asymptotics.resonances.folds import fold as compute
    from asymptotics.resonances.tongues import parse_fraction
    from derivations.reports import folds as report

    check_extras(latex, plot)
    p, q = parse_fraction(ratio)
    result = compute(p, q, beta, driven_end)
    if plot is not None:
        report.plot_fold(result, plot)
    show(result.as_json(), report.fold_text(result), as_json)
    write_extras(latex, report.fold_table([result]), plot)


def check_extras(latex: Path | None, plot: Path | None) -> None:
    """That both files can be written, before the work."""
    from derivations.figures.plots import check_plot_path
    from derivations.files import check_writable

    if plot is not None:
        check_plot_path(plot)
    if latex is not None:
        check_writable(latex)


def write_extras(latex: Path | None, table: str, plot: Path | None) -> None:
    """Write the LaTeX table where one is asked for, and say what was written."""
    from derivations.reports.formats import write_files

    wrote(plot)
    if latex is not None:
        wrote(*write_files({latex.name: table.rstrip("\n") + "\n"}, latex.parent))
