r"""The boundary ε_G(Ω) of the wave-less state of the paper's ropes, point by point, two ways.

Numerics: the branch of periodic states from rest is followed until it is lost
(:mod:`numerics.periodic.loss`; for β = 0 the last circle found). Algebra: the fold or the tongue's
edge of the nearest resonance's normal form, where that is in its range. Where the two differ by
more than their errors they are named.
"""

from __future__ import annotations

from typing import Any

from derivations.cross_check.ropes import in_numbers

FORMAT = 1
"""Counts up whenever older points are no longer comparable."""

ORDER = 9
RESONANCES = (*((p, q, 1) for p in (1, 2) for q in (1, 2, 3, 4)), (1, 1, 2))
"""(p, q, s) of the normal forms that are tried, sω_p/q."""

Point = dict[str, Any]


def tasks(beta: float, driven_end: str, omegas: list[float]) -> list[Point]:
    """One for each Ω.

    >>> tasks(0.01, "pinned", [3.2])
    [{'beta': 0.01, 'driven_end': 'pinned', 'omega': 3.2}]
    """
    return [{"beta": beta, "driven_end": driven_end, "omega": omega} for omega in omegas]


def specification() -> str:
    """What the points depend on besides."""
    return f"boundary, format {FORMAT}, normal forms of order {ORDER}"


def point(task: Point) -> Point:
    """The loss at one Ω, and what the normal form says.

    >>> found = point({"beta": 0.01, "driven_end": "pinned", "omega": 3.24})
    >>> found["mechanism"], found["normal_form"]["kind"], found["agrees"]
    ('fold', 'fold', True)
    """
    beta, omega = task["beta"], task["omega"]
    found = _string(omega) if beta == 0 else _rope(beta, task["driven_end"], omega)
    known = None if beta == 0 else _normal_form(beta, task["driven_end"], omega)
    return {
        "omega": omega,
        **found,
        "normal_form": known,
        "agrees": None if known is None else _agrees(found, known),
    }


def _string(omega: float) -> Point:
    from numerics.exact_string.last_circle import largest_circle

    low, _ = largest_circle(omega)
    return _lower_bound(low)


def _lower_bound(low: float, mechanism: str = "loss of regularity") -> Point:
    return {
        "lower": low,
        "upper": None,
        "mechanism": mechanism,
        "growth": None,
        "harmonics": None,
        "amplitude": None,
        "end": low,
        "end_mechanism": mechanism,
    }


def _rope(beta: float, driven_end: str, omega: float) -> Point:
    from asymptotics.problems.presets import beam
    from numerics.periodic.linear_rope import NoPeriodicStateError
    from numerics.periodic.loss import loss

    rope = beam(driven_end=driven_end)

    def stated(value: float) -> Any:
        at = {"beta": beta, "Omega": value}
        return in_numbers(rope, rope.values(at), complex(rope.at(at).rest or 0).real)

    try:
        found = loss(stated, omega)
    except NoPeriodicStateError:
        return _lower_bound(0.0, "resonance")
    return {
        "lower": found.lower,
        "upper": found.upper,
        "mechanism": found.mechanism.value,
        "growth": found.growth,
        "harmonics": found.harmonics,
        "amplitude": found.amplitude,
        "end": found.end,
        "end_mechanism": found.end_mechanism.value,
    }


def _normal_form(beta: float, driven_end: str, omega: float) -> Point | None:
    """Of the nearest resonance, where Ω is in its range."""
    from asymptotics.errors import InputError
    from asymptotics.problems.presets import beam
    from asymptotics.resonances.normal_form import normal_form

    rope, at = beam(driven_end=driven_end), {"beta": str(beta)}
    places = _resonances(beta, driven_end)
    p, q, s = min(RESONANCES, key=lambda key: abs(omega - places[key]))
    try:
        form = normal_form(rope, at, p, q, omega, ORDER + q % 2 - 1, s)
        edge = form.edge()
        points = form.folds() if form.forced else (() if edge is None else (edge,))
    except InputError:
        return None
    if not points:
        return None
    return {
        "kind": "fold" if form.forced else "period doubling",
        "resonance": [p, q, s],
        "epsilon": points[0].epsilon,
        "error": points[0].error,
    }


def _resonances(beta: float, driven_end: str) -> dict[tuple[int, int, int], float]:
    from asymptotics.problems.beam_spectrum import linear_frequencies

    spectrum = linear_frequencies(beta, 2, driven_end)
    return {(p, q, s): s * float(spectrum[p - 1]) / q for p, q, s in RESONANCES}


def _agrees(found: Point, known: Point) -> bool:
    """Whether the intervals meet; a lower bound contradicts only what is below it."""
    low, high = known["epsilon"] - known["error"], known["epsilon"] + known["error"]
    if found["upper"] is None:
        return bool(high >= found["lower"])
    return bool(
        found["mechanism"] == known["kind"] and low <= found["upper"] and high >= found["lower"]
    )


def disagreements(points: list[Point]) -> list[str]:
    """A line for each point at which the two ways differ by more than their errors.

    >>> row = {"omega": 3.0, "lower": 1.0, "upper": 1.1, "mechanism": "fold", "agrees": False,
    ...        "normal_form": {"kind": "fold", "epsilon": 2.0, "error": 0.1}}
    >>> disagreements([row])
    ['Omega = 3: fold at 1 ... 1.1 by states, fold at 2 +- 0.1 by the normal form']
    """
    lines = []
    for row in points:
        if row["agrees"] is not False:
            continue
        known = row["normal_form"]
        reach = f"{row['lower']:.6g} ..." + ("" if row["upper"] is None else f" {row['upper']:.6g}")
        lines.append(
            f"Omega = {row['omega']:.6g}: {row['mechanism']} at {reach} by states, "
            f"{known['kind']} at {known['epsilon']:.6g} +- {known['error']:.2g} by the normal form"
        )
    return lines
