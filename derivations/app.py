"""The ``ropewave`` command.

Imports of our own packages happen inside the commands: first :mod:`derivations.clash` looks whether
they are ours.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from derivations import (
    figure2_command,
    resonance_commands,
    simulation_commands,
    threshold_command,
)
from derivations.clash import find_clash
from derivations.options import (
    JsonOption,
    OmegaOption,
    OrderOption,
    PlotOption,
    number_of,
    numbers_of,
    order_of,
)

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Asymptotics with a moving contact: exact, to any order, proved.",
)

# The golden rotation: of all Ω < π the one farthest from every resonance pπ/q.
GOLDEN = 1.941611038725466

# Longer texts stay in their files when there are files; the screen gets the proofs.
SCREEN = 20_000


def cache_folder() -> Path:
    """Where derivations are kept: ROPEWAVE_CACHE, or the user's cache folder."""
    named = os.environ.get("ROPEWAVE_CACHE")
    if named:
        return Path(named)
    import platformdirs

    return platformdirs.user_cache_path("ropewave")


@app.command()
def derive(
    order: OrderOption = "4",
    format: Annotated[
        str | None, typer.Option(help="text, latex, numpy or json; without it all, or text.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the files.")] = None,
    style: Annotated[str, typer.Option(help="cotangent, or circular: sines, cosines.")] = (
        "cotangent"
    ),
    column: Annotated[str, typer.Option(help="LaTeX lines for a two- or one-column page.")] = (
        "two"
    ),
    plot: PlotOption = None,
    omega: Annotated[str, typer.Option(metavar="Ω", help="Ω of the plot.")] = str(GOLDEN),
    epsilon: Annotated[str, typer.Option(metavar="ε", help="ε of the plot.")] = "0.1",
    cache: Annotated[bool, typer.Option(help="Keep and reuse derivations.")] = True,
    as_json: JsonOption = False,
) -> None:
    """Derive F_0 … F_N and ξ_c, prove every order, and write the formulas."""
    from derivations.formats import FORMATS, render, write_files
    from derivations.formats import as_json as json_object
    from derivations.progress import progress

    formats = _formats(format, out, FORMATS)
    N = order_of(order)
    written: list[Path] = []
    if plot is not None:  # first: it is quick, and knows whether Ω and ε make sense
        from derivations.plots import plot_period

        plot_period(number_of("--omega", omega), number_of("--epsilon", epsilon), N, plot)
        written.append(plot)
    forms, proofs = _derivation(N, style, column, cache, quiet=as_json)
    pages: dict[str, dict[str, str]] = {}
    if out is not None:
        with progress("writing", len(formats), quiet=as_json) as report:
            for done, name in enumerate(formats, start=1):
                pages[name] = render(forms, proofs, name, column)
                written += write_files(pages[name], out)
                report(done)
    if as_json:
        result = json_object(forms, proofs)
        result["files"] = [str(path) for path in written]
        print(json.dumps(result))
        return
    shown = "text" if out is not None else formats[0]
    text = "\n".join((pages.get(shown) or render(forms, proofs, shown, column)).values())
    if out is not None and len(text) > SCREEN:
        text = f"{proofs}\n"
    print(text, end="")
    for path in written:
        print(f"wrote {path}", file=sys.stderr)


def _formats(format: str | None, out: Path | None, known: tuple[str, ...]) -> tuple[str, ...]:
    from asymptotics.errors import InputError

    if format is None:
        return known if out is not None else ("text",)
    if format not in known:
        raise InputError(f"--format {format!r}: choose one of {', '.join(known)}")
    return (format,)


def _derivation(order: int, style: str, column: str, cache: bool, quiet: bool) -> tuple[Any, Any]:
    """Closed forms and their proofs; arguments are checked before any long work."""
    from asymptotics.closed_form import ClosedForms, check_style
    from asymptotics.errors import InputError
    from asymptotics.expansion import expand
    from asymptotics.problem import exact_string
    from asymptotics.profile import moving_frame
    from asymptotics.proof import prove
    from asymptotics.storage import derive as derive_saved
    from derivations.progress import progress

    check_style(style)
    if column not in ("one", "two"):
        raise InputError(f"--column {column!r}: choose one or two")
    problem = exact_string()
    with progress("deriving", order, quiet) as report:
        if cache:
            expansion = derive_saved(problem, order, cache_folder() / problem.name, report)
        else:
            expansion = expand(problem, order, progress=report)
    with progress("proving", order, quiet) as report:
        frame = moving_frame(expansion, report)
        proofs = prove(expansion, frame)
    return ClosedForms(expansion, frame, style), proofs


@app.command()
def evaluate(
    omega: OmegaOption,
    epsilon: Annotated[str, typer.Option(metavar="ε", help="Forcing amplitude, units of Z₀.")],
    order: OrderOption = "4",
    s: Annotated[str, typer.Option(help="Positions (x − x_c)/x₀ ≤ 0, comma-separated.")] = (
        "-1,-0.75,-0.5,-0.25,0"
    ),
    tau: Annotated[str, typer.Option(help="Times ct/x₀, comma-separated.")] = "0",
    plot: PlotOption = None,
    as_json: JsonOption = False,
) -> None:
    """Evaluate ξ_c and w/Z₀: the series in ε truncated at order N."""
    from asymptotics.evaluate import evaluate as compute

    point = (number_of("--omega", omega), number_of("--epsilon", epsilon), order_of(order))
    result = compute(*point, numbers_of("--s", s), numbers_of("--tau", tau))
    if plot is not None:
        from derivations.plots import plot_period

        plot_period(*point, plot)
    if as_json:
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
        print(json.dumps(fields))
        return
    print(f"Omega = {result.omega:g}, epsilon = {result.epsilon:g}, order {result.order}")
    heads = ["tau", "x_c/x0", *(f"w/Z0(s={value:g})" for value in result.s)]
    print("  ".join(f"{head:>16}" for head in heads))
    for time, contact, row in zip(result.tau, result.contact, result.profile, strict=True):
        print("  ".join(f"{value:16.10g}" for value in (time, contact, *row)))
    if plot is not None:
        print(f"wrote {plot}", file=sys.stderr)


app.command()(resonance_commands.resonances)
app.command()(resonance_commands.tongue)
app.command()(resonance_commands.fold)
app.command()(simulation_commands.simulate)
app.command()(threshold_command.threshold)
app.command()(figure2_command.figure2)


@app.command()
def regenerate(
    check: Annotated[
        bool, typer.Option("--check", help="Compare with the committed files instead of writing.")
    ] = False,
) -> None:
    """Regenerate every committed artefact, or check that none differs."""
    from derivations.catalogue import GENERATED, artefacts, differences
    from derivations.formats import write_files

    if not check:
        for path in write_files(artefacts(), GENERATED):
            print(path.relative_to(GENERATED.parent.parent))
        return
    lines = differences()
    if lines:
        print("\n".join(lines), file=sys.stderr)
        print("run: python -m derivations, and look at what changed", file=sys.stderr)
        raise typer.Exit(1)
    print("every committed artefact is what the engine yields now")


def main(arguments: list[str] | None = None) -> None:
    """Run the command; errors of ours are one line on standard error, exit code 2."""
    clash = find_clash()
    if clash is not None:
        print(f"ropewave: error: {clash}", file=sys.stderr)
        raise SystemExit(2)
    from asymptotics.errors import RopewaveError
    from numerics.errors import NumericsError

    try:
        app(args=arguments, prog_name="ropewave")
    except (RopewaveError, NumericsError) as error:
        print(f"ropewave: error: {error}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
