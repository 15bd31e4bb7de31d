r"""The data of Fig. 2 at working resolution: ε_c(Ω) by simulation, and by the exact string.

For β > 0 every point is the interval of :mod:`numerics.thresholds.threshold`: the base settings,
and each of dx, dt, ramp, hold, height and integrator changed once. For β = 0 it is the exact
string's first sonic contact (:mod:`numerics.exact_string.thresholds`) under the same ramp and hold,
with ramp, hold and labels changed, and beside it the largest ε at which a periodic wave-less state
is found, the last invariant circle (:mod:`numerics.exact_string.invariant_circle`), which knows of
no ramp.

Points are tasks of :func:`numerics.sweeps.sweep.sweep`, one sealed file each: a killed run goes on.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from asymptotics.problems.beam_spectrum import linear_frequencies
from derivations.figure2.points import Point, check_points
from derivations.output import json_text
from numerics.errors import FileError, ThresholdNotFoundError
from numerics.exact_string.last_circle import largest_circle
from numerics.files.sealed import read_json
from numerics.sweeps.sweep import sweep

FORMAT = 3
"""Counts up whenever older points are no longer comparable."""

BETAS = (0.01, 0.001)
LIMIT_BETA = 1e-4
LIMIT_OMEGAS = (2.7, 2.9, 3.3)
"""Where β → 0 is followed further down."""

RAMP, HOLD = 40.0, 20.0
"""Forcing periods of the base settings: at |μ| = 0.05 the slow time 1/μ is 10 of them."""

WIDTH, COARSE_WIDTH = 0.02, 0.05
"""Relative width of a bracket."""

SIDES = {0.01: 7, 0.001: 5, 0.0: 12}
"""Points on each side of a resonance, log-spaced in |μ|."""

NEAREST, FARTHEST = 0.0125, 0.5

FILLS = {
    0.01: (1.3, 2.2, 2.5, 3.589, 4.2, 4.7, 5.2, 5.7, 6.1, 6.3, 6.4, 6.5, 6.6),
    0.001: (2.3, 4.2, 4.8, 5.4),
    0.0: (2.2, 2.3, 2.4, 2.5, 3.8, 4.2, 4.5, 4.8, 5.1, 5.4, 5.6),
}
"""Ω between the resonances; at β = 0.01 denser around Ω₂/2 and 2Ω₁."""

COARSE_OMEGAS = (1.4, 1.55, 1.7, 2.3, 2.8, 3.1, 3.4, 4.2, 5.5, 6.2, 6.8)

Task = dict[str, Any]


def centres(beta: float) -> dict[str, float]:
    """Ω₁(β)/2, Ω₁(β) and Ω₂(β): where the tongues are, by the linear spectrum alone.

    >>> {name: round(value, 4) for name, value in centres(0.01).items()}
    {'1/2': 1.625, '1/1': 3.25, '2/1': 7.1777}
    >>> centres(0.0)["2/1"] == 2 * math.pi
    True
    """
    if beta == 0:
        return {"1/2": math.pi / 2, "1/1": math.pi, "2/1": 2 * math.pi}
    first, second = (float(value) for value in linear_frequencies(beta, 2))
    return {"1/2": first / 2, "1/1": first, "2/1": second}


def detunings(count: int) -> list[float]:
    """|μ| from NEAREST to FARTHEST, log-spaced."""
    ratio = math.log(FARTHEST / NEAREST) / (count - 1)
    return [NEAREST * math.exp(ratio * i) for i in range(count)]


def tasks(coarse: bool = False) -> list[Task]:
    """What is to be computed, ordered by β and Ω.

    >>> [len([task for task in tasks() if task["beta"] == beta]) for beta in (0.01, 0.001, 0.0)]
    [58, 37, 86]
    """
    found = {}
    for beta in (*BETAS, 0.0):
        if coarse:
            found[beta] = set(COARSE_OMEGAS)
            continue
        sides = detunings(SIDES[beta])
        near = {c + s * mu for c in centres(beta).values() for mu in sides for s in (-1, 1)}
        found[beta] = near | set(FILLS[beta]) | set(LIMIT_OMEGAS)
    if not coarse:
        found[LIMIT_BETA] = set(LIMIT_OMEGAS)
    return [
        {"beta": beta, "omega": omega, "coarse": coarse}
        for beta in sorted(found, reverse=True)
        for omega in sorted({round(omega, 6) for omega in found[beta]})
    ]


def specification(coarse: bool = False) -> str:
    """What the points depend on besides β and Ω; files of another are refused."""
    kind = "coarse" if coarse else "working resolution"
    return (
        f"figure 2, format {FORMAT}, {kind}: ramp {RAMP:g}, hold {HOLD:g}, "
        f"brackets of {COARSE_WIDTH if coarse else WIDTH:g}, dx/sqrt(beta) = "
        f"{_spacing(0.01, coarse):.3g} (beta = 0.01), {_spacing(0.001, coarse):.3g} (below)"
    )


def _spacing(beta: float, coarse: bool) -> float:
    """dx/√β: what a point costs grows as its inverse square or faster."""
    return 1 / 7 if beta == 0.01 and not coarse else 1 / 5


def point(task: Task) -> Point:
    """ε_c at one (Ω, β): ``lower``, ``upper`` and the brackets that they cover.

    >>> found = point({"beta": 0.0, "omega": 2.9, "coarse": True})
    >>> round(found["lower"], 4), found["mechanism"]
    (0.007, 'sonic contact')
    """
    beta, omega, coarse = task["beta"], task["omega"], task["coarse"]
    if beta == 0:
        brackets = _string_brackets(omega, coarse)
    else:
        brackets = _simulated_brackets(omega, beta, coarse)
    return {
        "beta": beta,
        "omega": omega,
        "lower": min(row["lower"] for row in brackets),
        "upper": max(row["upper"] for row in brackets),
        "mechanism": brackets[0].pop("mechanism"),
        "circle": list(largest_circle(omega)) if beta == 0 else None,
        "brackets": brackets,
    }


def _simulated_brackets(omega: float, beta: float, coarse: bool) -> list[dict[str, Any]]:
    from numerics.thresholds.kinds import Change
    from numerics.thresholds.ramped_run import base_settings
    from numerics.thresholds.threshold import bracket, variations

    settings = base_settings(beta, _spacing(beta, coarse) * math.sqrt(beta))
    base = replace(settings, ramp=RAMP, hold=HOLD)
    cases = {Change.BASE: base} if coarse else variations(base)
    cases.pop(Change.RAMP_TWICE, None)  # the ramp of this figure is twice the usual one already
    rows: list[dict[str, Any]] = []
    for change, changed in cases.items():
        near = rows[0]["upper"] if rows else None
        try:
            found = bracket(omega, beta, changed, change, COARSE_WIDTH if coarse else WIDTH, near)
        except ThresholdNotFoundError:
            if not rows:
                raise
            continue  # outside the amplitudes that are searched: the point goes without it
        limits = {"lower": found.lower, "upper": found.upper}
        rows.append({"change": change.value, **limits, "growth": found.stayed.growth})
        if len(rows) == 1:
            rows[0]["mechanism"] = found.mechanism.value
    return rows


def _string_brackets(omega: float, coarse: bool) -> list[dict[str, Any]]:
    from numerics.exact_string.thresholds import sonic_threshold

    cases = {"base": (RAMP, HOLD, 256)}
    if not coarse:
        cases |= {
            "ramp × 4": (4 * RAMP, HOLD, 256),
            "hold × 4": (RAMP, 4 * HOLD, 256),
            "labels × 2": (RAMP, HOLD, 512),
        }
    rows = []
    for change, (ramp, hold, labels) in cases.items():
        found = sonic_threshold(omega, ramp, hold, labels, rtol=1e-3)
        limits = {"lower": found.lower, "upper": found.upper}
        rows.append({"change": change, **limits, "growth": None})
    rows[0]["mechanism"] = "sonic contact"
    return rows


def compute(
    coarse: bool = False,
    folder: Path | None = None,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
    wanted: list[Task] | None = None,
) -> list[Point]:
    """All points, in the order of :func:`tasks`; resumed from ``folder`` if there is one.

    Raises
    ------
    InputError, FileError, ThresholdNotFoundError
        As the sweep and the thresholds; a point that was kept is none.
    """
    todo = tasks(coarse) if wanted is None else wanted
    points = sweep(point, todo, folder, specification(coarse), workers, progress)
    check_points(points, str(folder))
    return [_rounded(item) for item in points]


def collected(points: list[Point], coarse: bool) -> str:
    """The points as one JSON text, the same bytes for the same points.

    Raises
    ------
    ResultError
        A number that is infinite or none.
    """
    content = {"specification": specification(coarse), "coarse": coarse, "points": points}
    return json_text(content, indent=1, ensure_ascii=False) + "\n"


def read_collected(path: Path) -> tuple[list[Point], bool]:
    """The points of a collected file, and whether they are coarse.

    Raises
    ------
    FileError
        There is no such file, it holds something else, or what no computation has found.
    """
    remedy = "Compute it anew, with --collect"
    content = read_json(path, remedy)
    if not isinstance(content, dict) or {"points", "coarse", "specification"} - set(content):
        raise FileError(f"{path} is not collected data of figure 2. {remedy}")
    coarse = content["coarse"]
    if not isinstance(coarse, bool) or content["specification"] != specification(coarse):
        raise FileError(
            f"{path} holds {reprlib.repr(content['specification'])}, coarse = "
            f"{reprlib.repr(coarse)}, not {specification(coarse is True)!r}. {remedy}"
        )
    return check_points(content["points"], str(path)), coarse


def _rounded(value: Any) -> Any:
    """Numbers to 7 digits, far below any interval here."""
    if isinstance(value, float):
        return float(f"{value:.7g}")
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return value
