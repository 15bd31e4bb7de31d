"""A periodic state: its contact point over a period, and its Floquet multipliers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from derivations.figures.plots import drawing, save_figure

if TYPE_CHECKING:
    from numerics.periodic.stability import Stability
    from numerics.periodic.states import PeriodicState

_INKS = {"stable": "#009E73", "neutral": "#0072B2", "unstable": "#D55E00", "undecided": "#999999"}
_TIMES = 601


def plot_state(found: PeriodicState, judged: Stability | None, path: Path) -> None:
    """Draw ξ_c(τ) and, where they are known, the multipliers on the unit circle."""
    import matplotlib.pyplot as plt

    with drawing():
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(7.2, 3.0), layout="constrained", width_ratios=(1.4, 1)
        )
        turns = np.linspace(0, found.modes.subharmonic, _TIMES)
        omega = found.modes.rope.omega
        left.plot(turns, found.contact(2 * np.pi * turns / omega), color="#0072B2")
        left.axhline(found.modes.rope.rest, color="black", linewidth=0.6, linestyle=":")
        left.set(
            xlabel=r"time $\Omega\tau/2\pi$",
            ylabel=r"contact point $\xi_c$ (units of $x_0$)",
            xlim=(0, turns[-1]),
            title=rf"$\Omega = {omega:.6g}$, $\varepsilon = {found.epsilon:.6g}$",
        )
        _multipliers(right, judged)
        save_figure(figure, path)
        plt.close(figure)


def _multipliers(axes: Any, judged: Stability | None) -> None:
    turn = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(turn), np.sin(turn), color="black", linewidth=0.6)
    title = "stability undecided"
    if judged is not None:
        values = judged.multipliers
        axes.plot(values.real, values.imag, "o", color=_INKS[judged.verdict], markersize=4)
        title = f"{judged.verdict}, {judged.modes} modes"
    axes.set(xlabel=r"Re $\lambda$", ylabel=r"Im $\lambda$", title=title, aspect="equal")
