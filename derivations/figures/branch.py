"""A branch of periodic states: the amplitude of the contact point, stable or not, bifurcations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from derivations.figures.plots import drawing, save_figure

if TYPE_CHECKING:
    from numerics.periodic.branches import BranchPoint
    from numerics.periodic.loci import LocusPoint

_MARKS = {
    "fold": ("o", "#D55E00"),
    "period doubling": ("s", "#009E73"),
    "crossing": ("D", "#CC79A7"),
    "graze": ("x", "black"),
}
_LABELS = {
    "epsilon": r"drive amplitude $\varepsilon$ (units of $Z_0$)",
    "omega": r"drive frequency $\Omega$",
}


def plot_branch(
    found: Sequence[BranchPoint], verdicts: Sequence[str | None], free: str, path: Path
) -> None:
    """Draw the branch: solid where it is not known to be unstable, dashed where it is."""
    import matplotlib.pyplot as plt

    with drawing():
        figure, axes = plt.subplots(figsize=(4.6, 3.2), layout="constrained")
        places = [getattr(point, free) for point in found]
        sizes = [point.amplitude for point in found]
        named: set[bool] = set()
        for i in range(len(found) - 1):
            unstable = "unstable" in verdicts[i : i + 2]
            label = ("unstable" if unstable else "periodic state") if unstable not in named else ""
            named.add(unstable)
            axes.plot(
                places[i : i + 2],
                sizes[i : i + 2],
                color="#0072B2",
                linestyle="--" if unstable else "-",
                label=label or None,
            )
        for kind, (mark, ink) in _MARKS.items():
            here = [i for i, point in enumerate(found) if point.kind == kind]
            if here:
                axes.plot(
                    [places[i] for i in here],
                    [sizes[i] for i in here],
                    mark,
                    color=ink,
                    markersize=5,
                    label=kind,
                )
        state = found[0].state
        other = (
            rf"$\Omega = {state.modes.rope.omega:.6g}$"
            if free == "epsilon"
            else rf"$\varepsilon = {state.epsilon:.6g}$"
        )
        periods = state.modes.subharmonic
        axes.set(
            xlabel=_LABELS[free],
            ylabel=r"amplitude of $\xi_c$ (units of $x_0$)",
            title=other + ("" if periods == 1 else f", period {periods} of the drive's"),
        )
        axes.set_ylim(0, None)
        axes.ticklabel_format(axis="x", style="sci", scilimits=(-2, 3))
        axes.legend(frameon=False, fontsize=8)
        save_figure(figure, path)
        plt.close(figure)


def plot_curve(kind: str, found: Sequence[LocusPoint], path: Path) -> None:
    """Draw a curve of folds or period doublings in the plane of Ω and ε, cusps marked."""
    import matplotlib.pyplot as plt

    mark, ink = _MARKS[kind]
    with drawing():
        figure, axes = plt.subplots(figsize=(4.6, 3.2), layout="constrained")
        omegas, epsilons = [p.omega for p in found], [p.epsilon for p in found]
        axes.plot(omegas, epsilons, "-", marker=mark, color=ink, markersize=3, label=kind)
        cusps = [p for p in found if p.kind == "cusp"]
        if cusps:
            axes.plot(
                [p.omega for p in cusps],
                [p.epsilon for p in cusps],
                "*",
                color="black",
                markersize=9,
                label="cusp",
            )
        axes.set(xlabel=_LABELS["omega"], ylabel=_LABELS["epsilon"])
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
        axes.legend(frameon=False, fontsize=8)
        save_figure(figure, path)
        plt.close(figure)
