"""``ropewave normal-form``: the amplitude equation of a resonance, and its folds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from derivations.commands.options import (
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    PlotOption,
    omega_of,
)
from derivations.commands.ropes import (
    BendingOption,
    DampingOption,
    DriveOption,
    EndOption,
    ProblemOption,
    SetOption,
    asked,
)
from derivations.output import show, wrote

if TYPE_CHECKING:
    from asymptotics.resonances.normal_form import NormalForm, Point


def normal_form(
    ratio: Annotated[str, typer.Argument(metavar="N/J", help="ω_N over harmonic J, e.g. 1/1.")],
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    subharmonic: Annotated[
        int, typer.Option("--subharmonic", metavar="s", min=1, help="Harmonic J of Ω/s.")
    ] = 1,
    order: Annotated[int, typer.Option("--order", "-N", metavar="N", help="5 to 25.")] = 9,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """G(ε, b) = 0 at a resonance JΩ/s ≈ ω_N of a rope; its folds, or its tongue's edge.

    They are given where orders N, N − 2 and N − 4 agree; elsewhere Ω is outside the range. Without
    --omega: the coefficients at the resonance. With damping or phases b is complex, G has its
    conjugate b* too, and N + 1 expansions take the place of one.
    """
    from asymptotics.errors import InputError
    from asymptotics.problems.free_frequencies import free_frequencies
    from asymptotics.resonances.normal_form import normal_form as compute

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    p, _, q = ratio.partition("/")
    if not (p.isdecimal() and q.isdecimal() and int(p) and int(q)):
        raise InputError(f"{ratio!r} is not N/J with positive whole numbers, such as 1/1 or 2/2")
    rope = asked(problem, values, beta, driven_end, damping, drive)
    if rope is None:
        raise InputError(
            "the string has no simple resonance: all multiples of one frequency resonate together "
            "(its law is the pendulum, ropewave tongue); give --beta > 0 or --problem"
        )
    if omega is None and hz is None and height is None:
        if plot is not None:
            raise InputError("--plot draws the states at one frequency; give --omega")
        spectrum = free_frequencies(rope.rope, rope.at, int(p)).values
        at_resonance = subharmonic * float(spectrum[int(p) - 1]) / int(q)
        found = compute(rope.rope, rope.at, int(p), int(q), at_resonance, order, subharmonic)
        show(_as_json(found, rope, (), None), _in_words(found, rope, (), None), as_json)
        return
    found = compute(
        rope.rope, rope.at, int(p), int(q), omega_of(omega, hz, height), order, subharmonic
    )
    points: tuple[Point, ...] = ()
    outside = None
    try:
        edge = found.edge()
        points = found.folds() if found.forced else (() if edge is None else (edge,))
    except InputError as error:
        outside = str(error)
    if plot is not None:
        from derivations.figures.normal_form import plot_normal_form

        plot_normal_form(found, points, plot)
    show(_as_json(found, rope, points, outside), _in_words(found, rope, points, outside), as_json)
    wrote(plot)


def _as_json(
    found: NormalForm, rope: Any, points: tuple[Point, ...], outside: str | None
) -> dict[str, Any]:
    listed = [
        {
            "omega": found.omega,
            "epsilon": point.epsilon,
            "error": point.error,
            "amplitude": point.amplitude,
        }
        for point in points
    ]
    return {
        "command": "normal-form",
        "problem": str(rope.rope),
        "p": found.p,
        "q": found.q,
        "subharmonic": found.subharmonic,
        "frequency": found.frequency,
        "resonance": found.resonance,
        "omega": found.omega,
        "order": found.order,
        "complex": found.is_complex,
        "coefficients": [_plain(row) for row in found.rows],
        "fold": listed if found.forced else [],
        "edge": [] if found.forced else listed,
        "outside": outside,
    }


def _plain(row: Any) -> list[Any]:
    """Order n: over k the coefficient of ε^{n−k} b^k; over k and l ≤ k [Re, Im] of b^l b̄^{k−l}."""
    if row.ndim == 1:
        return [float(g) for g in row]
    return [
        [[float(g.real), float(g.imag)] for g in powers[: k + 1]] for k, powers in enumerate(row)
    ]


def _terms(n: int, row: Any) -> list[str]:
    """The terms of order n that are not zero."""
    if row.ndim == 1:
        return [
            f"{g:+.6g}{_power(' epsilon', n - k)}{_power(' b', k)}" for k, g in enumerate(row) if g
        ]
    return [
        f"+({g.real:.6g}{g.imag:+.6g}i){_power(' epsilon', n - k)}{_power(' b', power)}"
        f"{_power(' b*', k - power)}"
        for k, powers in enumerate(row)
        for power, g in enumerate(powers[: k + 1])
        if g
    ]


def _in_words(found: NormalForm, rope: Any, points: tuple[Point, ...], outside: str | None) -> str:
    over = f"/{found.subharmonic}" if found.subharmonic > 1 else ""
    lines = [
        str(rope.rope),
        f"omega_{found.p} = {found.frequency:.10g}; harmonic {found.q} of Omega{over} resonates at "
        f"Omega = {found.resonance:.10g}",
        f"G(epsilon, b) at Omega = {found.omega:.10g}, through order {found.order}:",
    ]
    for n, row in enumerate(found.rows, start=1):
        terms = _terms(n, row)
        if terms:
            lines.append(f"  order {n}: {'  '.join(terms)}")
    if outside is not None:
        return "\n".join([*lines, outside])
    what = "fold" if found.forced else "edge of the tongue"
    if not points:
        lines.append(f"no {what} at this Omega, by any of orders {_orders(found)}")
    for point in points:
        size = f", amplitude {point.amplitude:.4g} in xi_c" if found.forced else ""
        lines.append(
            f"{what}: epsilon = {point.epsilon:.8g} +- {point.error:.1e}{size} (orders "
            f"{_orders(found)})"
        )
    return "\n".join(lines)


def _orders(found: NormalForm) -> str:
    return ", ".join(map(str, found.compared))


def _power(letter: str, n: int) -> str:
    return "" if n == 0 else letter if n == 1 else f"{letter}^{n}"
