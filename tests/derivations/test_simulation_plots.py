"""What the figures and the animation of a simulated rope show, and that they are the same twice."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from PIL import Image, ImageSequence

from asymptotics.errors import InputError
from derivations.figures.animation import FRAMES_PER_PERIOD, animate_run, animation_frames
from derivations.figures.simulation import LEAST_HEIGHT, magnified_top, plot_run, run_figure
from derivations.reports.watched_run import Watched, drive_of, watch
from numerics.problems.drive import at_rest
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import follow, simulate
from numerics.simulation.semi_discrete import Grid

DX = 0.0125


def watched(omega: float, epsilon: float, keep: float = 3.0) -> Watched:
    problem = RopeProblem(0.01, drive_of(omega, epsilon, 3.0))
    return watch(problem, epsilon, ramp=3.0, periods=7.0, grid=Grid(dx=DX), keep=keep)


@pytest.fixture(scope="module")
def following() -> Watched:
    return watched(2.5, 0.05)


@pytest.fixture(scope="module")
def shedding() -> Watched:
    return watched(3.1, 0.08)


def beyond(watched: Watched) -> tuple[np.ndarray, np.ndarray]:
    """The heights that the diagram shows more than three cells beyond the contact point, and ξ."""
    run = watched.run
    figure = run_figure(run)
    [image] = figure.subfigs[0].axes[0].images
    shown = np.asarray(image.get_array()).T
    left, right, low, high = image.get_extent()
    count, nodes = shown.shape
    places = low + (high - low) * (np.arange(nodes) + 0.5) / nodes
    times = left + (right - left) * (np.arange(count) + 0.5) / count
    period = run.problem.drive.period
    contact = np.interp(times * period, run.times, run.column(Column.CONTACT))
    heights = np.where(places > contact[:, None] + 3 * DX, shown, 0.0)
    return heights, places


def test_the_diagram_of_a_rope_that_follows_is_empty_beyond_the_contact(
    following: Watched,
) -> None:
    heights, _ = beyond(following)
    assert heights.max() < LEAST_HEIGHT
    assert following.run.heights.max() == pytest.approx(1.05, abs=0.05)


def test_the_diagram_of_a_rope_that_sheds_waves_shows_them_travel_away(shedding: Watched) -> None:
    heights, places = beyond(shedding)
    far = np.where(places > 2.0, heights, 0.0)
    assert far.max() > 10 * LEAST_HEIGHT
    # Along the streak of the highest wave the crest moves outwards, about as fast as waves do.
    frame = int(far.max(axis=1).argmax())
    period, dt = shedding.run.problem.drive.period, np.diff(shedding.run.snapshot_times).mean()
    assert dt < period / 100
    later = frame + round(0.3 / dt)
    crests = places[far[frame].argmax()], places[far[later].argmax()]
    speed = (crests[1] - crests[0]) / (dt * (later - frame))
    assert 1.0 < speed < 5.0


def test_the_lines_are_those_of_the_run(shedding: Watched) -> None:
    run, period = shedding.run, shedding.run.problem.drive.period
    upper, lower = run_figure(run, 0.08).subfigs
    diagram, contact, energy = upper.axes[:3]
    for axes in (diagram, contact):
        time, place = axes.lines[0].get_data()
        assert np.array_equal(np.asarray(time) * period, run.times, equal_nan=True) or np.allclose(
            np.asarray(time) * period, run.times, rtol=4 * np.finfo(float).eps
        )
        assert np.array_equal(np.asarray(place), run.column(Column.CONTACT), equal_nan=True)
    work, gone = (np.asarray(line.get_ydata()) for line in energy.lines[:2])
    stored = run.column(Column.ENERGY)
    assert work - gone == pytest.approx(stored - stored[0], abs=1e-9)
    assert gone[-1] > 0.01
    rope, ground = lower.axes
    assert len(rope.lines) == len(ground.lines) == 6  # five instants and the ground
    top = max(float(np.max(line.get_ydata()[1:])) for line in rope.lines)
    assert top == pytest.approx(1.0, abs=0.1)
    # Some instant shows the wave that the magnified panel is there for.
    crests = [line.get_ydata()[np.asarray(line.get_xdata()) > 1.0] for line in ground.lines[:5]]
    assert any(
        ((part[1:-1] > part[:-2]) & (part[1:-1] > part[2:]) & (part[1:-1] > 1)).any()
        for part in map(np.asarray, crests)
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["following", "shedding"])
def test_no_two_labels_overlap(name: str, request: pytest.FixtureRequest) -> None:
    run = request.getfixturevalue(name).run
    figure = run_figure(run, 0.05)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    boxes = [text.get_window_extent(canvas.get_renderer()) for text in texts]
    page = figure.bbox
    energy = figure.subfigs[0].axes[2]
    assert energy.get_legend().get_window_extent().y0 > energy.bbox.y1 - 1  # above the lines
    # Tick labels just outside the limits are not drawn, and sit where they like.
    shown = [
        (text.get_text(), box)
        for text, box in zip(texts, boxes, strict=True)
        if not _hidden_tick(figure, text)
    ]
    assert len(shown) > 40
    for i, (first, box) in enumerate(shown):
        assert page.x0 <= box.x0, first
        assert box.x1 <= page.x1, first
        for second, other in shown[:i]:
            assert not box.overlaps(other), (first, second)


def _hidden_tick(figure: Any, text: Text) -> bool:
    for axes in (axes for part in figure.subfigs for axes in part.axes):
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-9 * (high - low)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if text in (tick.label1, tick.label2):
                    drawn = tick.label1.get_visible() and text is tick.label1
                    drawn = drawn or (tick.label2.get_visible() and text is tick.label2)
                    return not (drawn and low - slack <= tick.get_loc() <= high + slack)
    return False


@pytest.mark.slow
def test_figures_are_the_same_bytes_every_time(shedding: Watched, tmp_path: Path) -> None:
    first, second = tmp_path / "a.svg", tmp_path / "b.svg"
    for path in (first, second):
        plot_run(shedding.run, path, 0.08)
    assert first.read_bytes() == second.read_bytes()
    assert 20_000 < first.stat().st_size < 1_000_000


@pytest.mark.slow
def test_the_animation(tmp_path: Path) -> None:
    run = watched(3.1, 0.08, keep=1.0).run
    first, second = (tmp_path / "new" / f"{name}.gif" for name in "ab")
    done: list[int] = []
    animate_run(run, first, 0.08, done.append)
    animate_run(run, second, 0.08)
    assert first.read_bytes() == second.read_bytes()
    assert done == list(range(1, FRAMES_PER_PERIOD + 1))
    assert first.stat().st_size < 1_500_000
    with Image.open(first) as picture:
        assert picture.n_frames == FRAMES_PER_PERIOD
        assert picture.info["duration"] == 40  # 25 frames a second
        assert picture.info["loop"] == 0  # for ever
        frames = [
            np.asarray(frame.convert("RGB")).astype(int)
            for frame in ImageSequence.Iterator(picture)
        ]
    moved = [np.abs(b - a).sum() > 0 for a, b in pairwise(frames)]
    assert all(moved)
    blue = np.array([0x00, 0x72, 0xB2])
    for frame in frames[::10]:
        rope = (np.abs(frame - blue).sum(axis=2) < 30).sum()
        black = (frame.sum(axis=2) < 30).sum(axis=1)
        assert rope > 500
        # The ground's bar, at least two pixels thick, and an axis, in either panel.
        assert (black > 250).sum() >= 6


def test_the_animation_loops_over_whole_periods(following: Watched) -> None:
    """The frame after the last would be the first: of a periodic state no jump is seen."""
    run, period = following.run, following.run.problem.drive.period
    frames = animation_frames(run)
    times = run.snapshot_times[frames]
    assert len(frames) == 2 * FRAMES_PER_PERIOD
    step, spacing = period / FRAMES_PER_PERIOD, np.diff(run.snapshot_times).max()
    assert np.diff(times) == pytest.approx(step, abs=1.01 * spacing)
    assert times[0] + 2 * period == pytest.approx(times[-1] + step, abs=1.01 * spacing)
    assert times[-1] <= run.snapshot_times[-1]


def test_the_magnified_panel_fits_the_highest_wave(following: Watched, shedding: Watched) -> None:
    assert magnified_top(following.run) == pytest.approx(9.8e-3)
    highest = shedding.run.column(Column.BUMP).max()
    assert magnified_top(shedding.run) >= 1.4 * highest > 0


def test_what_cannot_be_drawn(following: Watched, tmp_path: Path) -> None:
    problem = following.run.problem
    bare = simulate(problem, 1.0, Grid(dx=DX))
    resting = simulate(RopeProblem(0.01, at_rest()), 1.0, Grid(dx=DX), snapshots=0.1)
    for run in (bare, resting):
        for draw, name in ((plot_run, "a.png"), (animate_run, "a.gif")):
            with pytest.raises(InputError, match="simulate again with snapshots"):
                draw(run, tmp_path / name)
    with pytest.raises(InputError, match=r"ends in \.gif"):
        animate_run(following.run, tmp_path / "a.png")
    with pytest.raises(InputError, match=r"ends in \.pdf"):
        plot_run(following.run, tmp_path / "a.gif")
    assert list(tmp_path.iterdir()) == []


def test_snapshots_need_not_be_even() -> None:
    """A run that was taken up between two snapshots begins with one out of step."""
    drive = drive_of(2.5, 0.05, 1.0)
    simulator = Simulator(RopeProblem(0.01, drive), Grid(dx=0.025))
    follow(simulator, 0.05)
    run = follow(simulator, 1.5 * drive.period, record_from=0.0, snapshots=0.1)
    steps = np.diff(run.snapshot_times)
    assert steps.min() < 0.6 * steps.max()
    [image] = run_figure(run).subfigs[0].axes[0].images
    left, right, _, _ = image.get_extent()
    shown = np.asarray(image.get_array()).T
    times = drive.period * (left + (right - left) * (np.arange(len(shown)) + 0.5) / len(shown))
    for row, time in zip(shown, times, strict=True):
        apart = np.abs(run.snapshot_times - time)
        assert apart.min() < steps.max()
        lifted = row >= LEAST_HEIGHT
        nearest = np.flatnonzero(apart < apart.min() + 1e-9)  # two, if it is halfway
        heights = run.heights[nearest][:, : len(row)][:, lifted]
        assert (heights == row[lifted]).all(axis=1).any()
        assert lifted.sum() > 30
