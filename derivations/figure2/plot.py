"""Fig. 2 at working resolution: the boundary of the wave-less state, and the laws around it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from derivations.figure2.data import centres
from derivations.figure2.fits import Curve, approach, base_middle, curves
from derivations.figure2.laws import Family, Law, laws
from derivations.figure2.points import Point
from derivations.figures.plots import check_plot_path, drawing, save_figure

# Okabe and Ito's colours: told apart without red and green, and in grey.
COLOURS = {0.01: "#0072B2", 0.001: "#D55E00", 1e-4: "#CC79A7", 0.0: "#117755"}
_PAPER, _GREY = "#E69F00", "0.45"
_MARKERS = {
    "resonant growth": "o",
    "new contact": "v",
    "sonic contact": "^",
    "undecided": "D",
}
_NAMES = {"1/2": r"$\Omega_1/2$", "1/1": r"$\Omega_1$", "2/1": r"$\Omega_2$"}
_OMEGA, _MU = (1.0, 7.9), (0.01, 0.6)
_HEIGHTS = {"1/2": (0.006, 0.8), "1/1": (4e-5, 0.2), "2/1": (4e-5, 0.2)}
# Where the label of a law begins, |μ|; the pendulum's stands under its line.
_PLACES = {
    (Family.TRUNCATED, "1/2"): 0.055,
    (Family.TRUNCATED, "1/1"): 0.12,
    (Family.TRUNCATED, "2/1"): 0.12,
    (Family.PENDULUM, "1/2"): 0.014,
    (Family.PENDULUM, "1/1"): 0.037,
    (Family.PENDULUM, "2/1"): 0.066,
    (Family.FOLD, "1/2"): 0.0115,
    (Family.FOLD, "1/1"): 0.0105,
    (Family.FOLD, "2/1"): 0.02,
}
_SHORT = {Family.TRUNCATED: "truncated", Family.PENDULUM: "pendulum", Family.FOLD: "fold"}


def plot_figure2(points: Sequence[Point], path: Path) -> None:
    """Draw all points, laws and fits; the same bytes for the same points.

    Raises
    ------
    InputError, StorageError
        The file's name ends in something else than .png, .pdf or .svg, or cannot be written.
    """
    check_plot_path(path)
    from matplotlib.figure import Figure

    with drawing(font_size=8, lines_linewidth=1.1):
        figure = Figure(figsize=(7.2, 8.6))
        margins = {"left": 0.082, "right": 0.985, "top": 0.99, "bottom": 0.045}
        grid = figure.add_gridspec(
            3, 3, height_ratios=(1.45, 1, 1), hspace=0.27, wspace=0.23, **margins
        )
        points = sorted(points, key=lambda point: (point["beta"], point["omega"]))
        found = curves(points)
        _main(figure.add_subplot(grid[0, :]), points, found)
        for column, resonance in enumerate(_HEIGHTS):
            for row, side in enumerate((-1, 1)):
                axes = figure.add_subplot(grid[1 + row, column])
                _zoom(axes, points, found, resonance, side)
                if column == 0:
                    axes.set_ylabel(r"amplitude $\epsilon$")
        save_figure(figure, path)


def _main(axes: Any, points: Sequence[Point], found: list[Curve]) -> None:
    """Ω against ε: every point, and the paper's fits."""
    for curve in found:
        if curve.beta == 0:
            _string(axes, curve, curve.omega)
    for law in laws(Family.PAPER):
        omega = law.centre + np.r_[-np.geomspace(0.6, 1e-3, 80), np.geomspace(1e-3, 0.6, 80)]
        axes.plot(omega, law.epsilon(omega), "--", color=_PAPER, lw=1.3, zorder=4)
    _intervals(axes, points, lambda point: point["omega"])
    for beta in (0.01, 0.001, 0.0):
        for centre in centres(beta).values():
            axes.plot([centre], [0.0], "|", color=COLOURS[beta], ms=9, mew=1.4, clip_on=False,
                      transform=axes.get_xaxis_transform(), zorder=5)  # fmt: skip
    axes.set(
        xlim=_OMEGA,
        ylim=(2e-5, 3),
        yscale="log",
        xlabel=r"drive frequency $\Omega$",
        ylabel=r"amplitude $\epsilon$ at which waves appear",
    )
    first, second = centres(0.01)["1/1"], centres(0.01)["2/1"]
    others = (
        (second / 2, 4.2e-3, 2.6e-3, r"$\Omega_2/2$"),
        (2 * first, 0.022, 0.036, r"$2\Omega_1$"),
    )
    for place, tip, height, text in others:
        axes.annotate(
            text, (place, tip), xytext=(place, height), ha="center",
            va="top" if height < tip else "bottom", color=COLOURS[0.01], fontsize=7,
            arrowprops={"arrowstyle": "-", "lw": 0.6, "color": COLOURS[0.01], "shrinkA": 0,
            "shrinkB": 0},
        )  # fmt: skip
    _legend(axes, found)
    _limit(axes, points)


def _intervals(axes: Any, points: Sequence[Point], x_of: Callable[[Point], float]) -> None:
    """Simulated points: the intervals, and the base brackets marked by how the state was lost."""
    for beta, colour in COLOURS.items():
        mine = [point for point in points if point["beta"] == beta > 0]
        ends = [(point["lower"], point["upper"]) for point in mine]
        if not mine:
            continue
        lower, upper = np.array(ends).T
        axes.vlines([x_of(p) for p in mine], lower, upper, color=colour, lw=0.9, zorder=2)
        for name, marker in _MARKERS.items():
            some = [point for point in mine if point["mechanism"] == name]
            axes.plot(
                [x_of(p) for p in some], [base_middle(p) for p in some], marker, color=colour,
                mfc="white", ms=3.2, mew=0.8, zorder=3,
            )  # fmt: skip


def _string(axes: Any, curve: Curve, x: np.ndarray) -> None:
    """The exact string: a band for the ramped run, a line for the last circle found."""
    colour = COLOURS[0.0]
    order = np.argsort(x)
    if curve.name == "last circle":
        axes.plot(x[order], curve.middle[order], color=colour, lw=0.8, zorder=1)
    else:
        axes.fill_between(
            x[order], curve.lower[order], curve.upper[order], color=colour, alpha=0.28, lw=0,
            zorder=0,
        )  # fmt: skip


def _legend(axes: Any, found: list[Curve]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    names = {0.01: r"simulation, $\beta=0.01$", 0.001: r"simulation, $\beta=0.001$"}
    names[1e-4] = r"simulation, $\beta=0.0001$"
    shown: list[Any] = [
        Line2D([], [], color=COLOURS[curve.beta], label=names[curve.beta])
        for curve in found
        if curve.beta in names
    ]
    shown += [
        Patch(color=COLOURS[0.0], alpha=0.28, lw=0, label=r"exact string, $\beta=0$, same ramp"),
        Line2D([], [], color=COLOURS[0.0], lw=0.8, label="exact string, last periodic state found"),
        Line2D([], [], color=_PAPER, ls="--", label=r"the paper's fits, $\Omega_0=3.2$"),
        Line2D([], [], color="0.25", ls="", marker="|", ms=8, label="linear resonances"),
    ]
    style: dict[str, Any] = {"ls": "", "color": "0.25", "mfc": "white", "ms": 4}
    marks = [Line2D([], [], marker=m, label=name, **style) for name, m in _MARKERS.items()]
    first = axes.legend(handles=shown, frameon=False, loc="upper right", ncols=3, fontsize=7)
    axes.add_artist(first)
    axes.legend(
        handles=marks, frameon=False, loc="lower left", fontsize=7, title="lost by",
        title_fontsize=7, alignment="left",
    )  # fmt: skip


def _limit(axes: Any, points: Sequence[Point]) -> None:
    """β → 0 at fixed Ω, as an inset where the main panel is empty."""
    rows = approach(points)
    if not rows:
        return
    inset = axes.inset_axes((0.455, 0.085, 0.25, 0.34))
    zero = 2e-5
    for omega, marker in zip(sorted({row["omega"] for row in rows}), "sDo", strict=False):
        mine = [row for row in rows if row["omega"] == omega]
        x = [row["beta"] or zero for row in mine]
        inset.plot(x, [row["middle"] for row in mine], color="0.7", lw=0.7, zorder=1)
        for row, place in zip(mine, x, strict=True):
            colour = COLOURS[row["beta"]]
            inset.plot([place] * 2, [row["lower"], row["upper"]], color=colour, lw=0.9)
            inset.plot([place], [row["middle"]], marker, color=colour, mfc="white", ms=3)
        inset.annotate(
            rf"$\Omega={omega:g}$", (x[0], mine[0]["middle"]), xytext=(5, -2),
            textcoords="offset points", fontsize=6.5,
        )  # fmt: skip
    inset.set(xscale="log", yscale="log", xlim=(1.2e-5, 0.05))
    inset.set_xticks([zero, 1e-4, 1e-3, 1e-2], ["0", r"$10^{-4}$", r"$10^{-3}$", r"$10^{-2}$"])
    inset.set_xticks([], minor=True)
    inset.set_title(r"$\beta\to0$ at fixed $\Omega$", fontsize=7, pad=2)
    inset.tick_params(labelsize=6.5, pad=1.5, length=2)


def _zoom(
    axes: Any, points: Sequence[Point], found: list[Curve], resonance: str, side: int
) -> None:
    """|μ| against ε on one side of one resonance, with every derived law."""
    for curve in found:
        if curve.beta == 0:
            mu = side * (curve.omega - centres(0.0)[resonance])
            near = mu > 0
            part = Curve(curve.name, 0.0, mu[near], curve.lower[near], curve.upper[near])
            _string(axes, part, part.omega)

    def mu_of(point: Point) -> float:
        return side * (point["omega"] - places[point["beta"]])

    places = {beta: centres(beta)[resonance] for beta in COLOURS}
    _intervals(axes, [point for point in points if _MU[0] <= mu_of(point) <= _MU[1]], mu_of)
    for family, betas in (
        (Family.TRUNCATED, (0.0,)),
        (Family.PENDULUM, (0.0,)),
        (Family.FOLD, (0.01, 0.001)),
    ):
        for beta in betas:
            [law] = (law for law in laws(family, beta) if law.resonance == resonance)
            if side in law.sides:
                _line(axes, law, side)
    sign = "below" if side < 0 else "above"
    axes.set(xlim=_MU, ylim=_HEIGHTS[resonance], xscale="log", yscale="log")
    axes.set_title(f"{sign} {_NAMES[resonance]}", fontsize=8, pad=3)
    axes.set_xlabel(rf"$|\Omega-${_NAMES[resonance]}$|$", labelpad=1)
    axes.set_xticks([0.01, 0.03, 0.1, 0.3], ["0.01", "0.03", "0.1", "0.3"])
    axes.set_xticks([], minor=True)


def _line(axes: Any, law: Law, side: int) -> None:
    """A law: full within its window, dashed outside, named along the line."""
    from matplotlib.patheffects import withStroke
    from matplotlib.transforms import ScaledTranslation

    mu = np.geomspace(*_MU, 120)
    value = law.epsilon(law.centre + side * mu)
    colour, dashes = {
        Family.TRUNCATED: (_GREY, (0, (1, 1.5))),
        Family.PENDULUM: (COLOURS[0.0], (0, (5, 1.5))),
        Family.FOLD: (COLOURS[law.beta], (0, (3, 1.5))),
    }[law.family]
    axes.plot(mu, value, color=colour, ls=dashes, lw=0.9, zorder=1)
    if law.family is Family.FOLD:
        inside = np.where((mu >= law.window[0]) & (mu <= law.window[1]), value, math.nan)
        axes.plot(mu, inside, color=colour, lw=1.6, alpha=0.6, zorder=1)
    place = _PLACES[law.family, law.resonance]
    height = float(law.epsilon(law.centre + side * place))
    slope = float(law.exponent) * height / place
    under = law.family is Family.PENDULUM
    shift = ScaledTranslation(0, (-3.5 if under else 2.5) / 72, axes.figure.dpi_scale_trans)
    axes.text(
        place, height, f"{_SHORT[law.family]} {law.text}", color=colour, fontsize=6.5,
        ha="left", va="top" if under else "baseline", transform=axes.transData + shift,
        rotation=math.degrees(math.atan(slope)), rotation_mode="anchor",
        transform_rotates_text=True, zorder=1.5,
        path_effects=[withStroke(linewidth=1.6, foreground="white")],
    )  # fmt: skip
