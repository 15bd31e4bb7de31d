"""``ropewave threshold``: the amplitude at which the rope begins to shed waves."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import (
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    RopeBetaOption,
    omega_of,
)
from derivations.commands.simulation import need
from derivations.output import finite, show

if TYPE_CHECKING:
    from numerics.thresholds.ramped_run import Settings
    from numerics.thresholds.threshold import Threshold

RUNS = 10
"""That a bracket takes, more or less."""


def threshold(
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
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
    from numerics.errors import InputError
    from numerics.thresholds.ramped_run import base_settings
    from numerics.thresholds.string import string_variations
    from numerics.thresholds.threshold import threshold as compute
    from numerics.thresholds.threshold import variations

    omega = omega_of(omega, hz, height)
    base = base_settings(beta, dx)
    if beta == 0 and dx is not None:
        raise InputError(
            f"dx = {dx}: with beta = 0 the motion is exact and has no grid; leave --dx out"
        )
    if beta == 0:
        count = len(string_variations(base.ramp, base.hold))
    else:
        settings = list(variations(base).values())
        count = len(settings)
        announce(*_effort(omega, beta, settings[:1] if quick else settings))
    announce_compiling(as_json)
    done = 0
    with progress("bracketing", 1 if quick else count, as_json) as report:

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
    from derivations.reports.watched_run import seconds
    from numerics.thresholds.ramped_run import run_length

    nodes, steps = run_length(omega, beta, cases[0])
    total = sum(RUNS * seconds(*run_length(omega, beta, case), case.scheme.value) for case in cases)
    return f"about {RUNS * len(cases)} runs, the first of {steps} steps of {nodes} nodes", total


def threshold_json(found: Threshold) -> dict[str, Any]:
    """All of a threshold as plain numbers and words, the brackets in ``runs``."""
    plain: dict[str, Any] = finite(
        {"command": "threshold", "bounds": _bounds(found), **asdict(found)}
    )
    return plain


def threshold_text(found: Threshold) -> str:
    """The interval, how the state is lost, and a line for each setting."""
    from numerics.thresholds.string import StringBracket, StringSettings

    lines = [
        f"Omega = {found.omega:g}, beta = {found.beta:g}",
        f"the wave-less state is lost at {found.lower:.4g} < epsilon < {found.upper:.4g}; "
        f"mechanism: {found.mechanism.value}",
        f"{'setting':>16}  {'lower':>9}  {'upper':>9}  {'lost after':>10}  {'runs':>4}  mechanism",
    ]
    for run in found.runs:
        if isinstance(run, StringBracket):
            lost, count = run.periods, ""
        else:
            lost, count = run.lost.periods, str(run.count)
        when = f"{lost:.1f} of {run.settings.ramp + run.settings.hold:g}"
        lines.append(
            f"{run.change.value:>16}  {run.lower:9.6f}  {run.upper:9.6f}  {when:>10}  "
            f"{count:>4}  {run.mechanism.value}"
        )
    base = found.runs[0].settings
    periods = f"ramp {base.ramp:g} and hold {base.hold:g} forcing periods"
    if isinstance(base, StringSettings):
        lines.append(f"base: the exact string, {periods}, {base.labels} orbits")
    else:
        wave = f"a wave is higher than {base.height:.2g} Z0"
        lines.append(f"base: dx = {base.dx:g}, {periods}, {wave}")
    lines.append(_bounds(found))
    if len(found.runs) == 1:
        lines.append("one setting only: what the answer depends on was not tried")
    return "\n".join(lines)


def _bounds(found: Threshold) -> str:
    """What the interval is one of."""
    ramps = sorted({run.settings.ramp for run in found.runs})
    holds = sorted({run.settings.hold for run in found.runs})
    length = " and ".join(
        f"{name} of {' or '.join(f'{value:g}' for value in values)}"
        for name, values in (("ramps", ramps), ("holds", holds))
    )
    return (
        f"this bounds the loss in runs with {length} forcing periods, not the quasi-static loss "
        "or a fold of the state, which may lie outside"
    )
