"""The response curves of a normal form by its last orders, with the folds they agree on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from derivations.figures.plots import drawing, save_figure

if TYPE_CHECKING:
    from asymptotics.resonances.normal_form import NormalForm, Point

_INKS, _DASHES = ("#0072B2", "#D55E00", "#999999"), ("-", "--", ":")


def plot_normal_form(found: NormalForm, points: tuple[Point, ...], path: Path) -> None:
    """Draw |amplitude| against ε by orders N, N − 2, N − 4, and the points in the range."""
    import matplotlib.pyplot as plt

    kind = "fold" if found.forced else "edge of the tongue"
    with drawing():
        figure, axes = plt.subplots(figsize=(4.6, 3.2), layout="constrained")
        top = 0.0
        for order, ink, dash in zip(found.compared, _INKS, _DASHES, strict=False):
            epsilon, amplitude = found.branch(order)
            axes.plot(epsilon, np.abs(amplitude), color=ink, linestyle=dash, label=f"order {order}")
            top = max(top, float(epsilon.max(initial=0.0)))
        if not found.forced:
            axes.axhline(0, color="black", linewidth=0.8)
        for i, point in enumerate(points):
            axes.errorbar(
                point.epsilon,
                abs(point.amplitude),
                xerr=point.error,
                color="black",
                marker="o",
                markersize=4,
                linestyle="none",
                label=f"{kind}, ε = {point.epsilon:.5g}" if i == 0 else None,
            )
        over = f"/{found.subharmonic}" if found.subharmonic > 1 else ""
        times = str(found.q) if found.q > 1 else ""
        missing = "" if points else f"\n(no {kind}, or outside the range)"
        axes.set(
            xlabel=r"drive amplitude $\varepsilon$ (units of $Z_0$)",
            ylabel=rf"amplitude of $\cos({times}\Omega\tau{over})$ in $\xi_c$",
            title=rf"$\Omega = {found.omega:.6g}$, resonance at {found.resonance:.6g}" + missing,
        )
        axes.set_xlim(0, 1.05 * (min(top, 3 * points[0].epsilon) if points else top))
        axes.ticklabel_format(axis="x", style="sci", scilimits=(-2, 3))
        axes.legend(frameon=False, fontsize=8)
        save_figure(figure, path)
        plt.close(figure)
