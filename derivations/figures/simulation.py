"""A simulated rope, drawn: space-time diagram, contact point, energies, and the rope itself."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asymptotics.errors import InputError
from derivations.figures.plots import check_plot_path, drawing, save_figure

if TYPE_CHECKING:
    from numerics.simulation.run import Run

Array = NDArray[np.float64]

FRAMES_PER_PERIOD = 200
"""Snapshots that a figure wants of a forcing period."""

# Heights are drawn over these decades: waves on the ground are 10⁻³ to 10⁻² high.
LEAST_HEIGHT = 1e-4
# More points than the page can show would only make the file large.
_MOST_ROWS = 640
# Instants at which the rope itself is drawn, in the last period shown.
_INSTANTS = 5


def plot_run(run: Run, path: Path, epsilon: float | None = None) -> None:
    """Draw what a run kept: W(ξ, τ) with ξ_c over it, ξ_c(τ), the energies, and a few shapes.

    ε is for the caption: a run knows its drive by label only.

    Raises
    ------
    InputError
        A suffix other than .png, .pdf, .svg; a run without snapshots, rows or period.
    """
    check_plot_path(path)
    check_drawable(run)
    save_figure(run_figure(run, epsilon), path)


def check_drawable(run: Run) -> None:
    """Snapshots and rows of a periodically driven rope, or one clear error."""
    if len(run.snapshot_times) < 2 or len(run.times) < 2 or run.problem.drive.omega is None:
        raise InputError(
            "this run kept no snapshots, no rows, or has no forcing period: simulate again with "
            "snapshots=… and record_from=… to draw it"
        )


def run_figure(run: Run, epsilon: float | None = None) -> Any:
    """The figure that :func:`plot_run` writes."""
    from matplotlib.figure import Figure

    with drawing():
        figure = Figure(figsize=(7.0, 7.2), layout="constrained")
        parts: Any = figure.subfigures(2, 1, height_ratios=(5.2, 2.0))
        upper, lower = parts
        diagram, contact, energy = upper.subplots(3, 1, sharex=True, height_ratios=(3.2, 1.2, 1.3))
        bar = upper.colorbar(_space_time(diagram, run), ax=diagram, aspect=22, extend="min")
        bar.set_label(r"height $w/Z_0$")
        bar.outline.set_linewidth(0.6)
        instants = _instants(run)
        _contact(contact, run)
        _mark(contact, run, instants)
        _energies(energy, run)
        upper.align_ylabels()
        rope, ground = lower.subplots(1, 2, width_ratios=(1, 1.5))
        _shapes(rope, run, instants, magnified=False)
        _shapes(ground, run, instants, magnified=True)
        figure.suptitle(caption(run, epsilon), fontsize=9)
    return figure


def caption(run: Run, epsilon: float | None) -> str:
    """Which run: Ω, ε, β and the grid."""
    amplitude = "" if epsilon is None else rf"$\epsilon={epsilon:.4g}$,  "
    return (
        rf"$\Omega={run.problem.drive.omega:.5g}$,  {amplitude}$\beta={run.problem.beta:.4g}$,  "
        rf"simulated with the {run.scheme.value} scheme, "
        rf"$\Delta\xi={run.grid.dx:.3g}$, $\Delta\tau={run.dt:.3g}$"
    )


def visible_end(run: Run) -> float:
    """Where the drawing ends: beyond all that is lifted, and before the absorbing end."""
    lifted = (run.heights > LEAST_HEIGHT).any(axis=0)
    farthest = float(run.positions[lifted].max(initial=0.0))
    end = max(2 * float(np.nanmax(_column(run, "CONTACT"))), 1.1 * farthest)
    return min(end, run.grid.length - run.grid.sponge, float(run.positions[-1]))


def magnified_top(run: Run) -> float:
    """The height up to which the ground is shown magnified."""
    return 1.4 * max(float(np.nanmax(_column(run, "BUMP"))), 7e-3)


def _space_time(axes: Any, run: Run) -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    times, frames = _even_frames(run)
    end = visible_end(run)
    count = int(np.count_nonzero(run.positions <= end))
    step = max(math.ceil(count / _MOST_ROWS), 1)
    places = run.positions[:count:step]
    heights = np.maximum(run.heights[frames, :count:step].T, LEAST_HEIGHT / 10)
    shades = colormaps["cividis_r"](np.linspace(0.0, 0.93, 256))
    colours = LinearSegmentedColormap.from_list("heights", shades).with_extremes(under="white")
    half_time, half_place = (times[1] - times[0]) / 2, (places[1] - places[0]) / 2
    image = axes.imshow(
        heights,
        norm=LogNorm(LEAST_HEIGHT, max(float(run.heights.max()), 10 * LEAST_HEIGHT)),
        cmap=colours,
        origin="lower",
        aspect="auto",
        interpolation="bilinear",
        extent=(
            times[0] - half_time,
            times[-1] + half_time,
            places[0] - half_place,
            places[-1] + half_place,
        ),
    )
    axes.plot(run.times / run.problem.drive.period, _column(run, "CONTACT"), color="black", lw=0.9)
    axes.set(
        ylabel="position\n" + r"$x/x_0$",
        ylim=(0, end),
        xlim=(times[0], times[-1]),
        title="height of the rope; white: below $10^{-4}$; black line: contact point",
    )
    axes.title.set_fontsize(9)
    return image


def _even_frames(run: Run) -> tuple[Array, NDArray[np.intp]]:
    """Times ωt/2π at equal steps, as an image needs them, and the snapshots nearest to them."""
    times = run.snapshot_times
    wanted = np.linspace(times[0], times[-1], len(times))
    return wanted / run.problem.drive.period, np.abs(times[:, None] - wanted).argmin(axis=0)


def _column(run: Run, name: str) -> Array:
    from numerics.simulation.observables import Column

    return run.column(Column[name])


def _contact(axes: Any, run: Run) -> None:
    period = run.problem.drive.period
    contact = _column(run, "CONTACT")
    axes.plot(run.times / period, contact, color="black", lw=1.1)
    axes.set(ylabel="contact point\n" + r"$x_c/x_0$")
    # Less than a cell is no motion: the axis must not magnify rounding.
    middle, half = (np.nanmin(contact) + np.nanmax(contact)) / 2, run.grid.dx
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, middle - half), max(high, middle + half))


def _energies(axes: Any, run: Run) -> None:
    time = run.times / run.problem.drive.period
    work = _column(run, "WORK")
    gone = _column(run, "DAMPED") + _column(run, "LOST")
    work, gone = work - work[0], gone - gone[0]
    axes.fill_between(time, gone, work, color="0.88", lw=0, label="change of stored energy")
    axes.plot(time, work, color="#0072B2", label="work of the driven end")
    axes.plot(time, gone, color="#D55E00", ls=(0, (4, 1.8)), label="lost on the ground + damped")
    axes.set(ylabel="energy\n" + r"$[TZ_0^2/x_0]$", xlabel=r"time $\omega t/2\pi$")
    axes.legend(
        frameon=False,
        ncols=3,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        borderaxespad=0.0,
        columnspacing=1.4,
        handlelength=1.6,
        fontsize=8,
    )


def _instants(run: Run) -> NDArray[np.intp]:
    """Indices of snapshots: about the passage of the highest wave, or over half a period."""
    period, last = run.problem.drive.period, float(run.snapshot_times[-1])
    late = (run.times > last - 1.3 * period) & (run.times <= last - 0.3 * period)
    bump = np.where(late, np.nan_to_num(_column(run, "BUMP")), 0.0)
    if bump.max(initial=0.0) > LEAST_HEIGHT:
        first, step = float(run.times[bump.argmax()]) - period / 16, period / 16
    else:
        first, step = last - 1.0 * period, period / 8
    wanted = first + step * np.arange(_INSTANTS)
    return np.abs(run.snapshot_times[:, None] - wanted).argmin(axis=0)


def _colours() -> Array:
    from matplotlib import colormaps

    return colormaps["cividis"](np.linspace(0.0, 0.9, _INSTANTS))


def _mark(axes: Any, run: Run, instants: NDArray[np.intp]) -> None:
    contact = _column(run, "CONTACT")
    for index, colour in zip(instants, _colours(), strict=True):
        time = run.snapshot_times[index]
        row = int(np.abs(run.times - time).argmin())
        axes.plot(
            time / run.problem.drive.period, contact[row], "o", color=colour, ms=4.5, zorder=3
        )


def _shapes(axes: Any, run: Run, instants: NDArray[np.intp], magnified: bool) -> None:
    """The rope at the instants; ``magnified``: near the ground, heights in thousandths."""
    unit = 1e-3 if magnified else 1.0
    ends = run.problem.drive.height(run.snapshot_times[instants])
    for index, end, colour in zip(instants, ends, _colours(), strict=True):
        height = np.concatenate([[end], run.heights[index]]) / unit
        axes.plot(np.concatenate([[0.0], run.positions]), height, color=colour)
    axes.axhline(0, color="0.6", lw=0.6, zorder=0)
    if magnified:
        limits = (visible_end(run), 1e3 * magnified_top(run))
        title, name = "the same near the ground, magnified", r"height $10^3\,w/Z_0$"
    else:
        down = 1.25 * float(np.nanmax(_column(run, "CONTACT")))
        limits = (min(down, visible_end(run)), 1.05 * float(run.heights.max()))
        title, name = "rope at the dots", r"height $w/Z_0$"
    axes.set(
        xlim=(0, limits[0]),
        ylim=(-0.04 * limits[1], limits[1]),
        xlabel=r"position $x/x_0$",
        ylabel=name,
        title=title,
    )
    axes.title.set_fontsize(9)
