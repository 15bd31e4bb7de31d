"""The ``ropewave`` command.

Imports of our own packages happen inside the commands: first :mod:`derivations.clash` looks whether
they are ours.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

import typer

from derivations.cache import cache_folder, without_cache
from derivations.clash import find_clash
from derivations.commands import figure2 as figure2_command
from derivations.commands import resonances as resonance_commands
from derivations.commands import simulation as simulation_commands
from derivations.commands import threshold as threshold_command
from derivations.commands import validate as validate_command
from derivations.commands.boundary import boundary
from derivations.commands.branch import branch
from derivations.commands.critical import critical
from derivations.commands.normal_form import normal_form
from derivations.commands.options import (
    LIST,
    EpsilonOption,
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    OrderOption,
    PlotOption,
    numbers_of,
    omega_of,
)
from derivations.commands.periodic import state
from derivations.commands.ropes import (
    BendingOption,
    DampingOption,
    DriveOption,
    EndOption,
    ProblemOption,
    SetOption,
    asked,
    derived,
    evaluated,
    formulas,
    table,
)
from derivations.output import guarded, json_text, note, open_streams, show, wrote

app = typer.Typer(
    pretty_exceptions_enable=False,
    context_settings={"max_content_width": 100},
    rich_markup_mode=None,  # plain help: in any terminal, and in half the time
    help="Asymptotics with a moving contact: exact, to any order, proved.",
)

# What is wrong with a command line; the class has moved between releases of typer.
UsageError: Any = typer.BadParameter.__mro__[1]

# The golden rotation: of all Ω < π the one farthest from every resonance pπ/q.
GOLDEN = 1.941611038725466

# Numbers in one table: more are no text.
MOST_VALUES = 1_000_000

# Formulas in impedances know no relation among them: they are as long as the string's some orders
# further on.
MORE_PAGES = 6

MODULES = ("numpy", "javascript")

# Longer texts stay in their files when there are files; the screen gets the proofs.
SCREEN = 20_000


@app.command()
def derive(
    order: OrderOption = 4,
    format: Annotated[
        Literal["text", "latex", "numpy", "javascript", "json"] | None,
        typer.Option(help="Which; without it all of them with --out, or text."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder for the files.")
    ] = None,
    style: Annotated[
        Literal["cotangent", "circular"], typer.Option(help="Or circular: sines, cosines.")
    ] = "cotangent",
    column: Annotated[
        Literal["one", "two"], typer.Option(help="LaTeX lines for a one- or two-column page.")
    ] = "two",
    plot: PlotOption = None,
    omega: Annotated[
        float, typer.Option(metavar="Ω", help="Ω of the plot, and of a rope in numbers.")
    ] = GOLDEN,
    epsilon: Annotated[float, typer.Option(metavar="ε", help="ε of the plot.")] = 0.1,
    cache: Annotated[bool, typer.Option(help="Keep and reuse derivations.")] = True,
    problem: ProblemOption = None,
    values: SetOption = None,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    as_json: JsonOption = False,
) -> None:
    """Derive F_0 … F_N and ξ_c, prove every order, and write the formulas.

    With --problem, --beta, --damping or --drive: of that rope, in its impedances, with --format or
    --out; without either its expansion at one Ω, in numbers.
    """
    from asymptotics.errors import InputError
    from asymptotics.printing.written_out import as_json as json_object
    from derivations.files import check_folder
    from derivations.progress import progress, share_of_orders
    from derivations.reports.formats import render, write_files

    rope = asked(problem, values, beta, driven_end, damping, drive)
    if rope is not None and plot is not None:
        raise InputError(
            "--plot draws the string with Z = 1 + ε cos θ; of other ropes evaluate --plot draws"
        )
    if rope is not None and format is None and out is None:
        show(*derived(rope, omega, order, as_json), as_json)
        return
    formats = _formats(format, out, order if rope is None else order + MORE_PAGES)
    if format is None and rope is not None and rope.rope.varying:
        formats = tuple(name for name in formats if name not in MODULES)
        note("no modules: they compute impedances of equations with constant coefficients only")
    written: list[Path] = []
    if out is not None:
        check_folder(out)
    if plot is not None:  # first: it is quick, and knows whether Ω and ε make sense
        from derivations.figures.plots import plot_period

        with progress("drawing", 1.0, quiet=as_json, fine=True) as report:
            plot_period(omega, epsilon, order, plot, share_of_orders(report, order))
        written.append(plot)
    if rope is None:
        forms, proofs = _derivation(order, style, cache, quiet=as_json)
    else:
        forms, proofs = formulas(rope, order, as_json)
    text: dict[str, str] = {}
    if out is not None:
        with progress("writing", len(formats), quiet=as_json) as report:
            for done, name in enumerate(formats, start=1):
                pages = render(forms, proofs, name, column)
                written += write_files(pages, out)
                text = pages if name == "text" else text
                report(done)
    if as_json:
        result = json_object(forms, proofs)
        result["files"] = [str(path) for path in written]
        print(json_text(result))
        return
    if out is None and formats:
        text = render(forms, proofs, formats[0], column)
    _show("\n".join(text.values()), proofs, always=out is None)
    if format is None and "text" not in formats:
        note(_left_out(order, out))
    wrote(*written)


def _formats(format: str | None, out: Path | None, order: int) -> tuple[str, ...]:
    """What to write into a folder, or to show where there is none."""
    from derivations.reports.formats import FORMATS, LAST_PAGE

    if format is not None:
        return (format,)
    known = FORMATS if out is not None else ("text",)
    pages = () if order <= LAST_PAGE else ("text", "latex")
    return tuple(name for name in known if name not in pages)


def _left_out(order: int, out: Path | None) -> str:
    """Why nobody gets a text of this order unasked, and how to get it."""
    what = "text and LaTeX are" if out is not None else "the formulas are"
    how = "--format text or --format latex writes them"
    if out is None:
        how = "--out writes them as NumPy and JSON, --format text prints them"
    return f"order {order} would fill hundreds of pages: {what} left out; {how}"


def _show(text: str, proofs: Any, always: bool) -> None:
    """The formulas, or the proofs alone where the formulas are long and stand in a file."""
    if not text or (len(text) > SCREEN and not always):
        text = f"{proofs}\n"
    print(text, end="")


def _derivation(order: int, style: str, cache: bool, quiet: bool) -> tuple[Any, Any]:
    """Closed forms and their proofs."""
    from asymptotics.errors import UnwritableError
    from asymptotics.expansion.moving_frame import moving_frame
    from asymptotics.expansion.order_loop import expand
    from asymptotics.expansion.proof import prove
    from asymptotics.expansion.storage import saved_expansion
    from asymptotics.formulas.closed_form import ClosedForms
    from asymptotics.problems.string import exact_string
    from derivations.progress import progress

    problem = exact_string()
    folder = cache_folder(problem.name) if cache else None
    with progress("deriving", order, quiet) as report:
        if folder is None:
            expansion = expand(problem, order, progress=report)
        else:
            try:
                expansion = saved_expansion(problem, order, folder, report)
            except UnwritableError as error:
                without_cache(error)
                expansion = expand(problem, order, progress=report)
    with progress("proving", order, quiet) as report:
        frame = moving_frame(expansion, report)
        proofs = prove(expansion, frame)
    return ClosedForms(expansion, frame, style), proofs


@app.command()
def evaluate(
    epsilon: EpsilonOption,
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    order: OrderOption = 4,
    s: Annotated[
        str | None,
        typer.Option(metavar=LIST, help="Positions (x − x_c)/x₀ ≤ 0; by default quarters."),
    ] = None,
    tau: Annotated[str, typer.Option(metavar=LIST, help="Times ct/x₀.")] = "0",
    problem: ProblemOption = None,
    values: SetOption = None,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    plot: PlotOption = None,
    as_json: JsonOption = False,
) -> None:
    """Evaluate ξ_c and w/Z₀: the series in ε truncated at order N."""
    from asymptotics.errors import InputError
    from asymptotics.values.evaluate import evaluate as compute
    from derivations.progress import progress, share_of_orders

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    point = (omega_of(omega, hz, height), epsilon, order)
    places = None if s is None else numbers_of("--s", s)
    times = numbers_of("--tau", tau)
    if len(times) * len(places or ()) > MOST_VALUES:
        raise InputError(
            f"--tau and --s ask for a table of {len(times)} × {len(places or ())} numbers, more "
            f"than {MOST_VALUES}; give fewer, or use asymptotics.values.evaluate in Python"
        )
    rope = asked(problem, values, beta, driven_end, damping, drive)
    if rope is not None:
        show(*evaluated(rope, *point, places, times, plot), as_json)
        wrote(plot)
        return
    with progress("expanding", 1.0, fine=True) as report:
        result = compute(*point, places, times, share_of_orders(report, order))
    if plot is not None:
        from derivations.figures.plots import plot_period

        with progress("drawing", 1.0, fine=True) as report:
            plot_period(*point, plot, share_of_orders(report, order))
    fields = {
        "command": "evaluate",
        "omega": result.omega,
        "epsilon": result.epsilon,
        "order": result.order,
        "s": result.s.tolist(),
        "tau": result.tau.tolist(),
        "contact": result.contact.tolist(),
        "profile": result.profile.tolist(),
    }
    head = f"Omega = {result.omega:g}, epsilon = {result.epsilon:g}, order {result.order}"
    show(fields, f"{head}\n{table(result)}", as_json)
    wrote(plot)


app.command()(resonance_commands.resonances)
app.command()(resonance_commands.tongue)
app.command()(resonance_commands.fold)
app.command()(simulation_commands.simulate)
app.command()(threshold_command.threshold)
app.command()(validate_command.validate)
app.command()(state)
app.command()(boundary)
app.command()(branch)
app.command()(critical)
app.command()(normal_form)
app.command()(figure2_command.figure2)


@app.command()
def regenerate(
    check: Annotated[
        bool, typer.Option("--check", help="Compare with the committed files instead of writing.")
    ] = False,
) -> None:
    """Regenerate every committed artefact, or check that none differs."""
    from derivations.reports.catalogue import GENERATED, artefacts, differences
    from derivations.reports.formats import write_files

    if not check:
        for path in write_files(artefacts(), GENERATED):
            print(path.relative_to(GENERATED.parent.parent))
        return
    lines = differences()
    if lines:
        note("\n".join(lines))
        note("run: python -m derivations, and look at what changed")
        raise typer.Exit(1)
    print("every committed artefact is what the engine yields now")


def _print_version(asked: bool) -> None:
    from importlib.metadata import PackageNotFoundError, version

    if asked:
        try:
            number = version("ropewave")
        except PackageNotFoundError:
            number = "(a source tree, not installed)"
        print(f"ropewave {number}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, callback=_print_version, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    pass


def main(arguments: list[str] | None = None) -> None:
    """Run the command; whatever stands in the way is one line on standard error, exit code 2."""
    clash = find_clash()
    if clash is not None:
        note(f"ropewave: error: {clash}")
        raise SystemExit(2)
    from asymptotics.errors import RopewaveError
    from numerics.errors import NumericsError

    try:
        open_streams()
        code = guarded(lambda: _run(arguments))
    except (RopewaveError, NumericsError) as error:
        _fail(str(error))
    except UsageError as error:
        _fail(_usage(error))
    except MemoryError:
        _fail("out of memory: ask for fewer points, a lower order or a coarser grid")
    raise SystemExit(code)


def _run(arguments: list[str] | None) -> int:
    """The exit code; without arguments, help."""
    given = sys.argv[1:] if arguments is None else arguments
    return app(args=given or ["--help"], prog_name="ropewave", standalone_mode=False) or 0


def _usage(error: Any) -> str:
    """What is wrong with the command line, with what was given where the message leaves it out."""
    message = error.format_message().replace("Value error, ", "")
    found: Any = getattr(error.__cause__, "errors", list)()
    given = repr(found[0]["input"]) if found else ""
    return message if given in message else f"{message}, not {given}"


def _fail(message: str) -> NoReturn:
    note(f"ropewave: error: {' '.join(message.split())}")
    raise SystemExit(2) from None


if __name__ == "__main__":
    main()
