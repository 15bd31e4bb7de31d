r"""The boundary ε_G(Ω) of the wave-less state of the paper's ropes, point by point, two ways.

Numerics: the branch of periodic states from rest is followed until it is lost
(:mod:`numerics.periodic.loss`; for β = 0 the last circle found). Algebra: the fold or the tongue's
edge of the nearest resonance's normal form, where that is in its range. If asked for, from both
sides: the contact simulator started on the state a tenth below, and a tenth above
(:mod:`numerics.thresholds.from_state`). Where they differ by more than their errors they are named.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from derivations.cross_check.ropes import by_frequency

FORMAT = 4
"""Counts up whenever older points are no longer comparable."""

ORDER = 9
RESONANCES = (*((p, q, 1) for p in (1, 2) for q in (1, 2, 3, 4)), (1, 1, 2))
"""(p, q, s) of the normal forms that are tried, sω_p/q."""

MARGIN = 0.1
"""Part of ε, below and above, at which the simulator starts."""
FEWEST_PERIODS, MOST_PERIODS = 60, 600
"""Of the drive that it runs."""
STEEP, NARROWEST = 2.0, 1e-3
"""Of neighbours in ε, above which one is put between them; and in Ω, below which none is."""

Point = dict[str, Any]


def tasks(beta: float, driven_end: str, omegas: list[float], started: bool = False) -> list[Point]:
    """One for each Ω; ``started``: with runs of the simulator.

    >>> tasks(0.01, "pinned", [3.2])
    [{'beta': 0.01, 'driven_end': 'pinned', 'omega': 3.2}]
    """
    task = {"beta": beta, "driven_end": driven_end, **({"started": True} if started else {})}
    return [{**task, "omega": omega} for omega in omegas]


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
    row = {
        "omega": omega,
        **found,
        "normal_form": known,
        "agrees": None if known is None else _agrees(found, known),
    }
    if task.get("started") and beta and found["lower"]:
        row["started"] = _both_sides(_stated(beta, task["driven_end"])(omega), found)
    return row


def _string(omega: float) -> Point:
    from numerics.exact_string.last_circle import largest_circle

    low, _ = largest_circle(omega)
    return _lower_bound(low)


def _lower_bound(low: float, mechanism: str = "loss of regularity") -> Point:
    return {
        "lower": low,
        "upper": None,
        "mechanism": mechanism,
        "harmonic": None,
        "beyond": None,
        "growth": None,
        "harmonics": None,
        "decay": None,
        "amplitude": None,
        "end": low,
        "end_mechanism": mechanism,
    }


def _stated(beta: float, driven_end: str) -> Callable[[float], Any]:
    """The paper's rope for the numerics, by Ω."""
    from asymptotics.problems.presets import beam

    return by_frequency(beam(driven_end=driven_end), {"beta": beta})


def _rope(beta: float, driven_end: str, omega: float) -> Point:
    from numerics.periodic.linear_rope import NoPeriodicStateError
    from numerics.periodic.loss import loss

    try:
        found = loss(_stated(beta, driven_end), omega)
    except NoPeriodicStateError:
        return _lower_bound(0.0, "resonance")
    return {
        "lower": found.lower,
        "upper": found.upper,
        "mechanism": found.mechanism.value,
        "harmonic": found.harmonic,
        "beyond": found.beyond,
        "growth": found.growth,
        "harmonics": found.harmonics,
        "decay": found.decay,
        "amplitude": found.amplitude,
        "end": found.end,
        "end_mechanism": found.end_mechanism.value,
    }


def _both_sides(rope: Any, found: Point) -> Point:
    """What the simulator does on either side, where, and for how many periods it was watched.

    Below: on the state a tenth of ε below. Above: on the unstable state that was found, or, beyond
    a fold, from the state below to a tenth above. There it turns as slowly as the nearest
    multiplier does before; else the fastest disturbance takes its time. Where that is more than
    there is, the grids' own shift of Ω is as large as the distance to the resonance, too: then
    nothing is said.
    """
    from numerics.periodic.linear_rope import NoPeriodicStateError
    from numerics.periodic.loss import ACCURACY, FEW_MODES
    from numerics.periodic.stability import multipliers
    from numerics.periodic.states import periodic_state
    from numerics.thresholds.from_state import outcome, periods_needed

    low, high = found["lower"] * (1 - MARGIN), found["beyond"]
    told: Point = {"below_at": low, "below": "undecided", "above_at": high, "above": None}
    try:
        stable = beyond = periodic_state(rope, low, accuracy=ACCURACY)
        needed = 0
        if found["upper"] is not None and high is None:
            told["above_at"] = high = found["upper"] * (1 + MARGIN)
            needed = math.ceil(2 * math.pi / abs(np.angle(multipliers(stable, FEW_MODES))).min())
        elif high is not None:
            beyond = periodic_state(rope, high, accuracy=ACCURACY)
            needed = periods_needed(multipliers(beyond, FEW_MODES))
    except NoPeriodicStateError:  # in a gap that a high harmonic makes
        return {**told, "periods": 0, "needed": None}
    periods = min(max(needed, FEWEST_PERIODS), MOST_PERIODS)
    told |= {"periods": periods, "needed": needed}
    if high is not None:
        told["above"] = "undecided" if needed > periods else outcome(beyond, periods, high)[0].value
    if needed <= periods:
        told["below"] = outcome(stable, periods)[0].value
    return told


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


def between(points: list[Point]) -> list[float]:
    """Ω halfway between neighbours of another mechanism, or an ε that differs by more than two.

    >>> row = {"omega": 3.0, "lower": 1e-3, "mechanism": "fold"}
    >>> between([row, {**row, "omega": 3.1}, {**row, "omega": 3.2, "lower": 3e-3}])
    [3.15]
    """
    found = []
    for one, two in pairwise(sorted(points, key=lambda row: row["omega"])):
        apart = (two["omega"] - one["omega"]) / one["omega"]
        low, high = sorted((one["lower"], two["lower"]))
        if apart > NARROWEST and (one["mechanism"] != two["mechanism"] or high > STEEP * low):
            found.append(round((one["omega"] + two["omega"]) / 2, 12))
    return found


def disagreements(points: list[Point]) -> list[str]:
    """A line for each point at which the two ways differ by more than their errors.

    >>> row = {"omega": 3.0, "lower": 1.0, "upper": 1.1, "mechanism": "fold", "agrees": False,
    ...        "normal_form": {"kind": "fold", "epsilon": 2.0, "error": 0.1}}
    >>> disagreements([row])
    ['Omega = 3: fold at 1 ... 1.1 by states, fold at 2 +- 0.1 by the normal form']
    """
    lines = []
    for row in points:
        lines += _contradicted(row)
        if row["agrees"] is not False:
            continue
        known = row["normal_form"]
        reach = f"{row['lower']:.6g} ..." + ("" if row["upper"] is None else f" {row['upper']:.6g}")
        lines.append(
            f"Omega = {row['omega']:.6g}: {named(row)} at {reach} by states, "
            f"{known['kind']} at {known['epsilon']:.6g} +- {known['error']:.2g} by the normal form"
        )
    return lines


def _contradicted(row: Point) -> list[str]:
    """What the simulator did on the wrong side, if it did."""
    told = row.get("started")
    if told is None:
        return []
    sides = [("below", "leaves", "lower"), ("above", "stays", "upper")]
    return [
        f"Omega = {row['omega']:.6g}: {named(row)} at {row[bound]:.6g} by states, but started "
        f"{side}, at {told[side + '_at']:.6g}, the simulator {wrong} ({told['periods']} periods)"
        for side, wrong, bound in sides
        if told[side] == wrong
    ]


def named(row: Point) -> str:
    """The mechanism, and its harmonic where it has one."""
    harmonic = row.get("harmonic")
    return row["mechanism"] + ("" if harmonic is None else f" of harmonic {harmonic}")
