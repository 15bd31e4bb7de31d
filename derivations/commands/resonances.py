"""``ropewave resonances``, ``tongue`` and ``fold``: where the wave-less state meets resonance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from derivations.commands.options import (
    BetaOption,
    EndOption,
    JsonOption,
    LatexOption,
    OrderOption,
    PlotOption,
)
from derivations.commands.ropes import (
    Asked,
    BendingOption,
    DampingOption,
    DriveOption,
    ProblemOption,
    SetOption,
    asked,
)
from derivations.commands.ropes import EndOption as BendingEndOption
from derivations.output import show, wrote

_TONGUE_ORDER = 3

Ratio = Annotated[str, typer.Argument(metavar="P/Q", help="The resonance, e.g. 1/2.")]


def resonances(
    beta: BetaOption = 0.0,
    driven_end: EndOption = "pinned",
    count: Annotated[
        int, typer.Option(metavar="COUNT", min=1, help="How many linear resonances.")
    ] = 5,
    order: OrderOption = 3,
    problem: ProblemOption = None,
    values: SetOption = None,
    damping: DampingOption = None,
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """Linear resonances Ω_n(β), and the nonlinear Ω_p(β)/q with q ≤ N between them.

    With --problem or --damping: the free frequencies ω_p of that rope, and ω_p/q.
    """
    from derivations.reports import resonances as report

    check_extras(latex, plot)
    if problem is not None or values or damping is not None:
        end = driven_end if beta else None
        _of_rope(problem, values, beta or None, end, damping, count, order, plot, latex, as_json)
        return
    table = report.resonance_table(beta, driven_end, count, order)
    if plot is not None:
        report.plot_spectrum(plot, table)
    show(report.as_json(table), report.as_text(table), as_json)
    write_extras(latex, report.latex_table(table), plot)


def _of_rope(
    problem: Path | None,
    values: list[str] | None,
    beta: float | None,
    driven_end: str | None,
    damping: float | None,
    count: int,
    order: int,
    plot: Path | None,
    latex: Path | None,
    as_json: bool,
) -> None:
    """The free frequencies of any rope."""
    from asymptotics.errors import InputError
    from asymptotics.problems.free_frequencies import free_frequencies
    from derivations.reports import free_frequencies as report

    if latex is not None or plot is not None:
        raise InputError(
            "--plot and --latex are of the paper's ropes, by --beta and --driven-end; of others "
            "there are the table and --json"
        )
    rope = asked(problem, values, beta, driven_end, damping, None)
    assert rope is not None
    found = free_frequencies(rope.rope, rope.at, count)
    show(report.as_json(rope.rope, found, order), report.as_text(rope.rope, found, order), as_json)


def tongue(
    ratio: Ratio,
    order: OrderOption = _TONGUE_ORDER,
    subharmonic: Annotated[
        int, typer.Option(metavar="S", min=1, max=2, help="2: the parametric tongue at 2ω_p.")
    ] = 1,
    beta: BendingOption = None,
    driven_end: BendingEndOption = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    drive: DriveOption = None,
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The tongue of p/q where the order-N expansion touches the ground, and its limit law.

    With p/1 --subharmonic 2 and a rope by --beta, --drive or --problem: the tongue at Ω = 2ω_p in
    which that rope, undamped, answers with half the frequency.
    """
    from asymptotics.errors import InputError
    from asymptotics.resonances.tongues import parse_fraction
    from asymptotics.resonances.tongues import tongue as compute
    from derivations.reports import tongues as report

    check_extras(latex, plot)
    rope = asked(problem, values, beta, driven_end, None, drive)
    if rope is not None or subharmonic == 2:
        if order != _TONGUE_ORDER:
            raise InputError("--order is of the string's tongues; leave it out")
        _parametric(ratio, rope, subharmonic, latex or plot, as_json)
        return
    p, q = parse_fraction(ratio)
    result = compute(p, q, order)
    if plot is not None:
        report.plot_tongues([(p, q)], result.order, plot)
    show(report.as_json(result), report.as_text(result), as_json)
    write_extras(latex, report.latex_table([result]), plot)


def _parametric(
    ratio: str, rope: Asked | None, subharmonic: int, file: Path | None, as_json: bool
) -> None:
    """The tongue at 2ω_p of any undamped rope but the string."""
    from asymptotics.errors import InputError
    from asymptotics.resonances.parametric_tongue import parametric_tongue, tongue_in_words

    if subharmonic != 2:
        raise InputError(
            "the tongues p/q in which the rope touches the ground are the string's; of other ropes "
            "there are the one at 2 omega_p, by p/1 --subharmonic 2, and ropewave fold"
        )
    if rope is None:
        raise InputError(
            "on the string all multiples of omega_p resonate with it, and one amplitude is not "
            "enough; give --beta > 0, or a rope of your own by --problem"
        )
    if file is not None:
        raise InputError("--plot and --latex are of the string's tongues; here there is --json")
    p, _, q = ratio.partition("/")
    if not (p.isdigit() and len(p) < 5 and q == "1"):
        raise InputError(f"{ratio!r}: with --subharmonic 2 give p/1, as 1/1 for Omega = 2 omega_1")
    found = parametric_tongue(rope.rope, rope.at, int(p))
    fields = {**found.as_json(), "problem": str(rope.rope)}
    show(fields, "\n".join([str(rope.rope), *tongue_in_words(found)]), as_json)


def fold(
    ratio: Ratio,
    beta: BetaOption = 0.01,
    driven_end: EndOption = "pinned",
    problem: ProblemOption = None,
    values: SetOption = None,
    drive: DriveOption = None,
    plot: PlotOption = None,
    latex: LatexOption = None,
    as_json: JsonOption = False,
) -> None:
    """The fold near Ω_p(β)/q of the rope that bends: what it ends, and how far its law holds.

    With --problem or --drive: the amplitude equation of that rope at ω_p/q, and the law of its
    fold.
    """
    from asymptotics.resonances.folds import fold as compute
    from asymptotics.resonances.tongues import parse_fraction
    from derivations.reports import folds as report

    check_extras(latex, plot)
    if problem is not None or values or drive is not None:
        given = None if problem is not None else beta
        end = None if problem is not None else driven_end
        _fold_of_rope(ratio, problem, values, given, end, drive, plot, latex, as_json)
        return
    p, q = parse_fraction(ratio)
    result = compute(p, q, beta, driven_end)
    if plot is not None:
        report.plot_fold(result, plot)
    show(result.as_json(), report.fold_text(result), as_json)
    write_extras(latex, report.fold_table([result]), plot)


def _fold_of_rope(
    ratio: str,
    problem: Path | None,
    values: list[str] | None,
    beta: float | None,
    driven_end: Literal["pinned", "clamped"] | None,
    drive: str | None,
    plot: Path | None,
    latex: Path | None,
    as_json: bool,
) -> None:
    """The amplitude equation of any undamped rope."""
    from asymptotics.errors import InputError
    from asymptotics.resonances.rope_fold import law_in_words, rope_fold

    if latex is not None or plot is not None:
        raise InputError(
            "--plot and --latex are of the paper's ropes, by --beta and --driven-end; of others "
            "there are the numbers and --json"
        )
    p, _, q = ratio.partition("/")
    if not (p.isdigit() and q.isdigit()):
        raise InputError(f"{ratio!r} is not p/q with whole numbers p and q, such as 1/2")
    rope = asked(problem, values, beta, driven_end, None, drive)
    assert rope is not None
    found = rope_fold(rope.rope, rope.at, int(p), int(q))
    lines = [
        str(rope.rope),
        f"omega_{p} = {found.frequency:.12g}, resonance at Omega = {found.frequency / int(q):.12g}",
        f"({q} mu - gamma epsilon^2) a = F epsilon^{found.excited} + alpha a^3, a the amplitude of "
        f"cos {q} theta in x_c/x0:",
        f"F = {found.F:.10g}, alpha = {found.alpha:.10g}, gamma = {found.gamma:.10g}",
        *law_in_words(found),
    ]
    fields = {**found.as_json(), "problem": str(rope.rope)}
    show(fields, "\n".join(lines), as_json)


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
