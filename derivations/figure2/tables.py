"""The tables of Fig. 2 as markdown: all numbers that its description discusses, and the others.

The text is a function of the points alone, byte for byte.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from derivations.figure2.data import BETAS, LIMIT_OMEGAS, centres, specification
from derivations.figure2.fits import WINDOWS, Exponent, approach, base_middle, deviations, exponents
from derivations.figure2.laws import Family, Law, laws
from derivations.figure2.points import MECHANISMS, Point

NAMES = {"1/2": "Ω₁/2", "1/1": "Ω₁", "2/1": "Ω₂"}
"""Resonance ↦ how it is written."""

RAMPED = "beta = 0"
"""The exact string's curve under the ramp."""

NONE = "–"
"""The cell of what the points do not tell."""

DIP = 0.3
"""|μ| up to which a tongue's lowest point is looked for."""

_SIDES = {-1: "below", 1: "above"}

_WINDOWS = ", ".join(f'"{name}" is {a:g} ≤ |μ| ≤ {b:g}' for name, (a, b) in WINDOWS.items())

_HEAD = f"""# Fig. 2 in tables

Written by `ropewave figure2 --tables`; in words: [figure2.md](figure2.md).

{{}}.

* Points: the width is upper over lower end; the mechanism is that of the base settings.
* Lowest points: of the base settings, within {DIP:g} of each linear resonance, with the interval.
* Local exponents: d log ε/d log |μ| ± standard error (points), μ from the linear resonance;
  {_WINDOWS}.
* Laws: computed over law at each |μ| from 0.01 to 0.6, computed being the middle of the interval
  and |μ| the distance from the law's own centre; * where the interval contains the law. The
  truncated tongues are also moved to the linear resonances of β > 0.
* β → 0: base settings [interval], × the base over that of β = 0, same ramp and hold.
"""


def tables(points: Sequence[Point], coarse: bool = False) -> str:
    """Every table, under one heading each.

    Raises
    ------
    InputError
        As :func:`derivations.figure2.fits.power`.

    Examples
    --------
    >>> rows = [{"beta": 0.0, "omega": 2.9, "lower": 1.0, "upper": 2.0, "circle": [0.5, 0.6],
    ...          "mechanism": "sonic contact", "brackets": [{"lower": 1.0, "upper": 1.5}]}]
    >>> text = tables(rows)
    >>> [line for line in text.splitlines() if line.startswith("| 0 | 1 ")]
    ['| 0 | 1 | 2.00 | 2.0 | 0 | 0 | 1 | 0 |']
    """
    folds = [law for beta in BETAS for law in laws(Family.FOLD, beta)]
    sections = {
        "Points": _kinds(points),
        "Lowest points": _dips(points),
        "Local exponents": _exponents(points),
        "Bending folds": _ratios(points, folds),
        "Pendulum": _ratios(points, laws(Family.PENDULUM)),
        "Truncated tongues": _ratios(points, _truncated()),
        "The paper's fits": _ratios(points, laws(Family.PAPER)),
        "β → 0": _approach(points),
    }
    body = [f"\n## {name}\n\n{table}\n" for name, table in sections.items()]
    return _HEAD.format(specification(coarse)) + "".join(body)


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A markdown table; a bar within a cell is escaped."""
    names = list(head)
    body = [names, ["---"] * len(names), *(list(row) for row in rows)]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in body
    )


def _of_beta(points: Sequence[Point]) -> dict[float, list[Point]]:
    """The points by β, the largest first, each ordered by Ω."""
    betas = sorted({point["beta"] for point in points}, reverse=True)
    ordered = sorted(points, key=lambda point: float(point["omega"]))
    return {beta: [point for point in ordered if point["beta"] == beta] for beta in betas}


def _kinds(points: Sequence[Point]) -> str:
    rows = []
    for beta, mine in _of_beta(points).items():
        widths = [math.log(point["upper"] / point["lower"]) for point in mine]
        median, largest = math.exp(float(np.median(widths))), math.exp(max(widths))
        seen = Counter(point["mechanism"] for point in mine)
        counts = [f"{seen[name]}" for name in MECHANISMS]
        rows.append((f"{beta:g}", f"{len(mine)}", f"{median:.2f}", f"{largest:.1f}", *counts))
    return _table(("β", "points", "median width", "largest", *MECHANISMS), rows)


def _dips(points: Sequence[Point]) -> str:
    rows = []
    for beta, mine in _of_beta(points).items():
        if beta not in (*BETAS, 0.0):
            continue  # followed at a few Ω only, which tell of no dip
        for resonance, centre in centres(beta).items():
            near = [point for point in mine if abs(point["omega"] - centre) <= DIP]
            if near:
                low = min(near, key=base_middle)
                ends = f"[{low['lower']:.3g}, {low['upper']:.3g}]"
                place, mu = f"{low['omega']:.4f}", f"{low['omega'] - centre:+.4f}"
                name = f"{NAMES[resonance]} = {centre:.4f}"
                rows.append((f"{beta:g}", name, place, mu, f"{base_middle(low):.3g} {ends}"))
    return _table(("β", "resonance", "Ω", "μ", "ε_c [interval]"), rows)


def _exponents(points: Sequence[Point]) -> str:
    fits = {(fit.curve, fit.resonance, fit.side, fit.window): fit for fit in exponents(points)}
    names = list(dict.fromkeys(curve for curve, *_ in fits))
    rows = [
        [f"{_SIDES[side]} {name}", window]
        + [_exponent(fits.get((curve, resonance, side, window))) for curve in names]
        for resonance, name in NAMES.items()
        for side in _SIDES
        for window in WINDOWS
    ]
    return _table(("side", "window", *(_greek(name) for name in names)), rows)


def _greek(curve: str) -> str:
    return "β = 0, ramped" if curve == RAMPED else curve.replace("beta", "β")


def _exponent(fit: Exponent | None) -> str:
    if fit is None:
        return NONE
    digits = 3 if fit.curve == "last circle" else 2
    return f"{fit.value:.{digits}f} ± {fit.error:.{digits}f} ({fit.count})"


def _truncated() -> list[Law]:
    """The truncated tongues where they are derived, and moved to the ropes that resist bending."""
    derived = laws(Family.TRUNCATED)
    moved = [
        replace(law, beta=beta, centre=centres(beta)[law.resonance])
        for beta in BETAS
        for law in derived
    ]
    return [*derived, *moved]


def _ratios(points: Sequence[Point], some: Iterable[Law]) -> str:
    """Computed over law; at β = 0 the laws are those of the last circle, not of a ramp."""
    rows = []
    for found in deviations(points, some):
        if found.curve == RAMPED:
            continue
        law, order = found.law, zip(found.mu, found.ratio, found.inside, strict=True)
        cell = ", ".join(f"{mu:.3g}: {ratio:.2f}{'*' * bool(on)}" for mu, ratio, on in order)
        place = f"{_greek(found.curve)}, {_SIDES[found.side]} {law.centre:.4f}"
        distance = "|μ − γε²/2|" if law.shifted else "|μ|"
        rows.append((f"{law.coefficient:.4g} {distance}^{law.exponent}", place, cell))
    return _table(("law", "curve", "computed over law at |μ|"), rows)


def _approach(points: Sequence[Point]) -> str:
    cells: dict[tuple[float, float], dict[str, Any]] = {
        (row["omega"], row["beta"]): row for row in approach(points)
    }
    betas = sorted({beta for _, beta in cells}, reverse=True)
    rows = [
        [f"{omega:g}", *(_limit(cells.get((omega, beta))) for beta in betas)]
        for omega in LIMIT_OMEGAS
    ]
    return _table(("Ω", *(f"β = {beta:g}" for beta in betas)), rows)


def _limit(row: dict[str, Any] | None) -> str:
    if row is None:
        return NONE
    ends = f"[{row['lower']:.5f}, {row['upper']:.5f}]"
    return f"{row['middle']:.5f} {ends}, ×{row['ratio']:.2f}"
