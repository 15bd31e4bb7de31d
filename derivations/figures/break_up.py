"""The break-up of a circle: residues that cross, and the contact point just before."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from derivations.figures.plots import drawing, save_figure
from numerics.errors import OrbitNotFoundError
from numerics.exact_string.greene import periodic_orbit

if TYPE_CHECKING:
    from numerics.exact_string.break_up import BreakUp

_INKS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9")
_DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
# Orbits drawn, and the range of K around the break-up in units of 1/q of the shortest.
_ORBITS, _REACH, _POINTS = 5, 0.5, 41
# Times a period at which ξ_c is drawn, at least.
_TIMES = 1024


def plot_break_up(found: BreakUp, path: Path) -> None:
    """Draw the residues of the longest orbits against K, and ξ_c(τ) on the last circle."""
    import matplotlib.pyplot as plt

    with drawing():
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(7.2, 3.0), layout="constrained", width_ratios=(1, 1)
        )
        _residues(left, found)
        _contact(right, found)
        save_figure(figure, path)
        plt.close(figure)


def _residues(axes: Any, found: BreakUp) -> None:
    first = found.crossings[0].shorter
    orbits = [first, *(crossing.longer for crossing in found.crossings)][-_ORBITS:]
    reach = _REACH / orbits[0][1]
    strengths = found.strength + reach * np.linspace(-1, 1, _POINTS)
    for (p, q), ink, dash in zip(orbits, _INKS, _DASHES, strict=False):
        values = []
        orbit = None
        for strength in strengths:
            try:
                orbit = periodic_orbit(p, q, float(strength), start=orbit)
            except OrbitNotFoundError:
                break
            values.append(orbit.residue)
        axes.plot(strengths[: len(values)], values, color=ink, linestyle=dash, label=f"{p}/{q}")
    axes.axvline(found.strength, color="black", linewidth=0.8)
    axes.set(
        xlabel=r"$K = 2\varepsilon\Omega^2$",
        ylabel="residue",
        ylim=(0, 1),
        xlim=(strengths[0], strengths[-1]),
        title=rf"break-up at $K = {found.strength:.7f}$",
    )
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=4)
    axes.legend(title="orbit", frameon=False, fontsize=8)


def _contact(axes: Any, found: BreakUp) -> None:
    circle = found.last_circle
    if circle is None:
        axes.set_axis_off()
        axes.text(0.5, 0.5, "no circle found", ha="center")
        return
    tau, contact = circle.contact_curve(_TIMES)
    stride = max(1, len(tau) // _TIMES)
    turns = circle.omega * tau / (2 * math.pi)
    axes.plot(turns[::stride], contact[::stride], color=_INKS[0])
    axes.set(
        xlabel=r"time $\Omega\tau/2\pi$",
        ylabel=r"contact point $\xi_c$ (units of $x_0$)",
        xlim=(0, 1),
        title=rf"$\Omega = {circle.omega:.5f}$, $\varepsilon = {circle.epsilon:.5f}$",
    )


def plot_envelope(rows: Sequence[Mapping[str, Any]], denominators: int, path: Path) -> None:
    """Draw the ends of many circles in the plane of Ω and ε, and the tongues between them."""
    import matplotlib.pyplot as plt

    known = [row for row in rows if row["reason"] is None]
    with drawing():
        figure, axes = plt.subplots(figsize=(7.2, 3.6), layout="constrained")
        omega, epsilon = ([row[name] for row in known] for name in ("omega", "epsilon"))
        if known:
            low, high = min(omega) / math.pi, max(omega) / math.pi
            for q in range(1, denominators // 2 + 1):
                for p in range(math.ceil(low * q), math.floor(high * q) + 1):
                    if math.gcd(p, q) == 1:
                        axes.axvline(math.pi * p / q, color="#BBBBBB", linewidth=1.2 / q, zorder=0)
            axes.axvline(math.nan, color="#BBBBBB", label=r"resonances $\Omega = \pi p/q$")
        axes.plot(omega, epsilon, "o", color="#0072B2", markersize=3, label="end of a noble circle")
        axes.set(
            yscale="log",
            xlabel=r"drive frequency $\Omega$",
            ylabel=r"$\varepsilon$ at the break-up (units of $Z_0$)",
            title=r"$\beta = 0$",
        )
        axes.legend(frameon=False, fontsize=8)
        save_figure(figure, path)
        plt.close(figure)
