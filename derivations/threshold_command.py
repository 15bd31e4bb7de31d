"""``ropewave threshold``: the amplitude at which the rope begins to shed waves."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.options import JsonOption, OmegaOption, RopeBetaOption
from derivations.output import finite, show
from derivations.simulation_commands import need

if TYPE_CHECKING:
    from numerics.ramped_run import Settings
    from numerics.threshold import Threshold

RUNS = 10
"""That a bracket takes, more or less."""


def threshold(
    omega: OmegaOption,
    beta: RopeBetaOption = 0.01,
    dx: Annotated[
        float | None,
        typer.Option(metavar="Δξ", help="Spacing of the base runs; default: √β/10."),
    ] = None,
    relative: Annotated[
        float, typer.Option(metavar="WIDTH", min=1e-9, max=1, help="Relative width of a bracket.")
    ] = 0.01,
    quick: Annotated[bool, typer.Option("--quick", help="The base settings only.")] = False,
    as_json: JsonOption = False,
) -> None:
    """ε_c: where a ramped run loses the wave-less state, as an interval, and how."""
    need("numba")
    from derivations.progress import announce, announce_compiling, progress
    from numerics.ramped_run import base_settings
    from numerics.threshold import threshold as compute
    from numerics.threshold import variations

    base = base_settings(beta, dx)
    cases = [base] if quick else list(variations(base).values())
    announce(*_effort(omega, beta, cases))
    announce_compiling(as_json)
    done = 0
    with progress("bracketing", len(cases), as_json) as report:

        def advance(brackets: int, _: int) -> None:
            nonlocal done
            done = brackets
            report(done)

        def watching(epsilon: float, part: float) -> None:
            report(done, f"a run at epsilon = {epsilon:.4g}, {100 * part:.0f} % of it")

        found = compute(omega, beta, base, quick, relative, progress=advance, watching=watching)
    show(threshold_json(found), threshold_text(found), as_json)


def _effort(omega: float, beta: float, cases: list[Settings]) -> tuple[str, float]:
    """What is to be done, in words and roughly in seconds."""
    from derivations.simulation_run import seconds
    from numerics.ramped_run import run_length

    nodes, steps = run_length(omega, beta, cases[0])
    total = sum(RUNS * seconds(*run_length(omega, beta, case), case.scheme.value) for case in cases)
    return f"about {RUNS * len(cases)} runs, the first of {steps} steps of {nodes} nodes", total


def threshold_json(found: Threshold) -> dict[str, Any]:
    """All of a threshold as plain numbers and words, the brackets in ``runs``."""
    plain: dict[str, Any] = finite({"command": "threshold", **asdict(found)})
    return plain


def threshold_text(found: Threshold) -> str:
    """The interval, how the state is lost, and a line for each setting."""
    lines = [
        f"Omega = {found.omega:g}, beta = {found.beta:g}",
        f"the wave-less state is lost at {found.lower:.4g} < epsilon < {found.upper:.4g}; "
        f"mechanism: {found.mechanism.value}",
        f"{'setting':>16}  {'lower':>9}  {'upper':>9}  {'lost after':>10}  {'runs':>4}  mechanism",
    ]
    for run in found.runs:
        when = f"{run.lost.periods:.1f} of {run.settings.ramp + run.settings.hold:g}"
        lines.append(
            f"{run.change.value:>16}  {run.lower:9.6f}  {run.upper:9.6f}  {when:>10}  "
            f"{run.count:4d}  {run.mechanism.value}"
        )
    base = found.runs[0].settings
    lines.append(
        f"base: dx = {base.dx:g}, ramp {base.ramp:g} and hold {base.hold:g} forcing periods, a "
        f"wave is higher than {base.height:.2g} Z0"
    )
    if len(found.runs) == 1:
        lines.append("one setting only: what the answer depends on was not tried")
    return "\n".join(lines)
