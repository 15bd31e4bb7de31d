"""A simulated rope in motion: an animated GIF that loops, the same bytes every time."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asymptotics.errors import InputError
from derivations.figures.plots import drawing
from derivations.figures.simulation import caption, check_drawable, magnified_top, visible_end
from derivations.files import check_writable, write_file

if TYPE_CHECKING:
    from numerics.simulation.run import Run

FRAMES_A_SECOND = 25
FRAMES_PER_PERIOD = 50
"""Two seconds for a forcing period."""

_MOST_PERIODS = 2
_DOTS_PER_INCH = 100
_ROPE, _END = "#0072B2", "#D55E00"
# The paper fades into every ink in so many steps, and the rope into the ground's black.
_SHADES = 20


def check_animation_path(path: Path) -> Path:
    """A path that ends in .gif, where a file can be written."""
    if path.suffix.lower() != ".gif":
        raise InputError(f"cannot animate {path.name!r}: give a file name that ends in .gif")
    check_writable(path)
    return path


def animate_run(
    run: Run,
    path: Path,
    epsilon: float | None = None,
    report: Callable[[int], None] | None = None,
) -> None:
    """Animate the last periods that a run kept, two at most; ``report`` gets the frames done.

    ε is for the caption.

    Raises
    ------
    InputError
        A suffix other than .gif; a run without snapshots, rows or period.
    StorageError
        The file cannot be written.
    """
    check_animation_path(path)
    check_drawable(run)
    images = _images(run, epsilon, report)
    drawn = io.BytesIO()
    images[0].save(
        drawn,
        format="GIF",
        save_all=True,
        append_images=images[1:],
        duration=1000 // FRAMES_A_SECOND,
        loop=0,
        optimize=False,
    )
    write_file(path, drawn.getvalue())


def animation_frames(run: Run) -> NDArray[np.intp]:
    """Which snapshots are shown: whole periods, so that a periodic state loops without a jump."""
    period, times = run.problem.drive.period, run.snapshot_times
    periods = min(int((times[-1] - times[0]) / period * (1 + 1e-9)), _MOST_PERIODS)
    count = max(periods, 1) * FRAMES_PER_PERIOD
    start = max(times[-1] - max(periods, 1) * period, times[0])
    wanted = start + period / FRAMES_PER_PERIOD * np.arange(count)
    nearest: NDArray[np.intp] = np.abs(times[:, None] - wanted[wanted <= times[-1]]).argmin(axis=0)
    return nearest


@dataclass
class _Stage:
    """The panels, and the artists that move, each with its panel."""

    upper: Any
    lower: Any
    time: Any
    lines: list[Any]
    grounds: list[Any]
    end: Any

    def draw(self) -> None:
        """Draw what moves, over what does not."""
        for axes, line, ground in zip(
            (self.upper, self.lower), self.lines, self.grounds, strict=True
        ):
            axes.draw_artist(ground)
            axes.draw_artist(line)
        self.upper.draw_artist(self.end)
        self.upper.draw_artist(self.time)


def _images(run: Run, epsilon: float | None, report: Callable[[int], None] | None) -> list[Any]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from PIL import Image

    places = np.concatenate([[0.0], run.positions])
    ends = run.problem.drive.height(run.snapshot_times)
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    images: list[Any] = []
    with drawing():
        figure = Figure(figsize=(7.0, 3.9), dpi=_DOTS_PER_INCH, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        stage = _set(figure, run, epsilon, float(ends.max()))
        canvas.draw()
        background = canvas.copy_from_bbox(figure.bbox)
        for done, index in enumerate(animation_frames(run), start=1):
            height = np.concatenate([ends[index : index + 1], run.heights[index]])
            stage.end.set_data([0.0], [ends[index]])
            for line, ground, unit in zip(stage.lines, stage.grounds, (1.0, 1e-3), strict=True):
                line.set_data(places, height / unit)
                ground.set_data(run.positions, np.where(run.held[index], 0.0, np.nan))
            turns = run.snapshot_times[index] / run.problem.drive.period
            stage.time.set_text(f"{turns:.2f}")
            canvas.restore_region(background)
            stage.draw()
            picture = Image.frombytes("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
            images.append(
                picture.convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE)
            )
            if report is not None:
                report(done)
    return images


def _palette() -> list[int]:
    """Mixtures of white with black, the rope's and the end's colour, and of rope with black."""
    from matplotlib.colors import to_rgb

    part = np.linspace(0.0, 1.0, _SHADES)[:, None]
    inks = [(1 - part) + part * np.array(to_rgb(ink)) for ink in ("black", _ROPE, _END)]
    inks.append((1 - part) * np.array(to_rgb(_ROPE)))
    return [int(value) for value in np.rint(255 * np.concatenate(inks)).ravel()]


def _set(figure: Any, run: Run, epsilon: float | None, highest: float) -> _Stage:
    """Two panels above each other: the rope to scale, and the ground magnified."""
    from matplotlib.transforms import offset_copy

    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.45, 1))
    lines, grounds = [], []
    for axes in (upper, lower):
        lines += axes.plot([], [], color=_ROPE, lw=1.8, zorder=3, animated=True)
        below = offset_copy(axes.transData, figure, y=-2.6, units="points")
        grounds += axes.plot(
            [], [], color="black", lw=2.4, solid_capstyle="butt", transform=below, animated=True
        )
        axes.axhline(0, color="0.6", lw=0.6, zorder=0)
    (end,) = upper.plot([], [], "o", color=_END, ms=6, clip_on=False, animated=True)
    top = 1e3 * magnified_top(run)
    upper.set(ylim=(-0.08, 1.08 * highest), ylabel=r"height $w/Z_0$", aspect="equal")
    lower.set(
        xlim=(0, visible_end(run)),
        ylim=(-0.08 * top, top),
        ylabel=r"height $10^3\,w/Z_0$",
        xlabel=r"position $x/x_0$",
    )
    upper.set_title(caption(run, epsilon), fontsize=9)
    lower.set_title(
        "near the ground, magnified; black: where the ground holds the rope", fontsize=9
    )
    # The formula is typeset once; typesetting takes longer than drawing all the rest.
    upper.text(0.93, 0.88, r"$\omega t/2\pi=$", transform=upper.transAxes, ha="right")
    time = upper.text(0.935, 0.88, "", transform=upper.transAxes, animated=True)
    for artist in (*lines, *grounds, end, time):
        artist.set_in_layout(False)  # still empty, or in nobody's way
    figure.align_ylabels()
    return _Stage(upper, lower, time, lines, grounds, end)
