"""The boundary of the wave-less state: ε against Ω, a colour and a mark for each mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from derivations.figures.plots import drawing, save_figure

_MARKS = {
    "fold": ("o", "#D55E00"),
    "gap of a high harmonic": ("o", "#D55E00"),
    "period doubling": ("s", "#009E73"),
    "other instability": ("D", "#CC79A7"),
    "interior graze": ("X", "black"),
    "not resolved": ("^", "#0072B2"),
    "loss of regularity": ("v", "#0072B2"),
    "none": ("1", "#999999"),
}
_GAP = "gap of a high harmonic"
# Folds of higher harmonics are gaps that a rope passes.
_HIGHEST = 4
# Rows of one resonance's normal form are joined when they are this near, part of Ω.
_JOINED = 0.05


def plot_boundary(
    points: Sequence[Mapping[str, Any]],
    beta: float,
    ramped: Sequence[tuple[float, float, float]],
    path: Path,
) -> None:
    """Draw the points, normal forms as lines, ramped thresholds as bars behind them."""
    import matplotlib.pyplot as plt

    with drawing():
        figure, axes = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
        if ramped:
            omega, low, high = np.array(ramped).T
            axes.vlines(omega, low, high, color="#BBBBBB", linewidth=3, label="ramped simulation")
        _forms(axes, points)
        for mechanism, (mark, ink) in _MARKS.items():
            rows = [p for p in points if _shown(p) == mechanism and p["lower"] > 0]
            if rows:
                bound = mechanism in ("not resolved", "loss of regularity", "none")
                axes.plot(
                    [p["omega"] for p in rows],
                    [p["lower"] for p in rows],
                    mark,
                    color=ink,
                    markersize=4,
                    markerfacecolor="white" if bound or mechanism == _GAP else ink,
                    label=f"{mechanism} (lower bound)" if bound else mechanism,
                    linestyle="none",
                )
        for row in points:
            if row["agrees"] is False:
                axes.plot(row["omega"], row["lower"], "o", color="black", markersize=10, mfc="none")
        axes.set(
            yscale="log",
            xlabel=r"drive frequency $\Omega$",
            ylabel=r"$\varepsilon$ at which the wave-less state is lost",
            title=rf"$\beta = {beta:g}$",
        )
        axes.legend(frameon=False, fontsize=7, ncols=2)
        save_figure(figure, path)
        plt.close(figure)


def _shown(row: Mapping[str, Any]) -> str:
    """The mechanism, folds of high harmonics told from others."""
    high = row["mechanism"] == "fold" and (row.get("harmonic") or 0) > _HIGHEST
    return _GAP if high else str(row["mechanism"])


def _forms(axes: Any, points: Sequence[Mapping[str, Any]]) -> None:
    """ε by normal forms, a line for each run of neighbours with one resonance on one side."""
    known = [(p["omega"], p["normal_form"]) for p in points if p["normal_form"] is not None]
    label = "normal form, in its range"
    run: list[tuple[float, float]] = []
    before: list[int] | None = None
    for omega, form in [*known, (np.inf, {"resonance": None, "epsilon": np.nan})]:
        near = bool(run) and omega - run[-1][0] <= _JOINED * omega
        if run and not (near and form["resonance"] == before):
            axes.plot(*np.array(run).T, color="black", linewidth=1, label=label, zorder=1)
            label, run = "_", []
        run.append((omega, form["epsilon"]))
        before = form["resonance"]
