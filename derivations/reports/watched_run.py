"""One simulated run, watched to its end: the last periods are kept, the rest is summed up."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from derivations.figures.simulation import FRAMES_PER_PERIOD
from numerics.errors import InputError
from numerics.events.finder import Event, EventFinder, EventKind
from numerics.files.checkpoint import save_checkpoint, saving, start_or_resume
from numerics.problems.drive import Drive, cosine, non_negative, positive, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.problems.pulses import smallest_wave
from numerics.simulation.contact import (
    Block,
    Scheme,
    Simulator,
    check_resolution,
    equilibrium,
    steps_until,
    stride,
)
from numerics.simulation.observables import Column, contact_point
from numerics.simulation.run import Run, follow
from numerics.simulation.semi_discrete import Grid


class Verdict(Enum):
    """What the rope did."""

    FOLLOWS = "follows"
    DOUBTFUL = "in doubt"
    SHEDS = "sheds waves"


@dataclass(frozen=True)
class Bump:
    """A wave beyond the contact point: its height, and where and when it was that high."""

    height: float
    place: float
    time: float


@dataclass(frozen=True, eq=False)
class Watched:
    """A run to its end.

    Attributes
    ----------
    run
        Rows and snapshots of the last periods, see :class:`~numerics.simulation.run.Run`; its
        residuals are those since ``begun``.
    epsilon, ramp, periods
        What was asked for; ``periods`` in all, ``ramp`` of them to raise ε.
    begun
        τ at which this process began: 0, or where a checkpoint stood.
    highest
        The highest bump since; None if there was none.
    heights, first
        Two heights from which a bump counts as a wave, and for each the first such bump, or None.
    counts, events
        For every kind of event their number since, and the first; of near misses the lowest.
    fastest
        The greatest speed of the contact point since, as an event.
    rest
        ξ_c and E at rest.
    """

    run: Run
    epsilon: float
    ramp: float
    periods: float
    begun: float
    highest: Bump | None
    heights: tuple[float, float]
    first: tuple[Bump | None, Bump | None]
    counts: dict[EventKind, int]
    events: dict[EventKind, Event | None]
    fastest: Event | None
    rest: tuple[float, float]

    @property
    def verdict(self) -> Verdict:
        """Whether the highest bump exceeds none, one or both of ``heights``."""
        return list(Verdict)[sum(bump is not None for bump in self.first)]

    @property
    def contact_range(self) -> tuple[float, float]:
        """The least and the greatest ξ_c in the last period; NaN where nothing lay down."""
        late = self.run.times > self.run.times[-1] - self.run.problem.drive.period
        contact = self.run.column(Column.CONTACT)[late]
        contact = contact[np.isfinite(contact)]
        if len(contact) == 0:
            return math.nan, math.nan
        return float(contact.min()), float(contact.max())


def wave_heights(beta: float, dx: float) -> tuple[float, float]:
    """Twice the smallest wave that the grid can hold, and ten times that.

    A result that depends on which of them makes a wave is no result yet.
    """
    least = 2 * smallest_wave(beta, dx)
    return least, 10 * least


class _History:
    """What :class:`Watched` says of rows that are not kept."""

    def __init__(self, simulator: Simulator) -> None:
        self.begun = simulator.time
        self.heights = wave_heights(simulator.problem.beta, simulator.grid.dx)
        self.highest: Bump | None = None
        self.first: list[Bump | None] = [None, None]
        self.finder = EventFinder(simulator.grid.dx, simulator.dt, self.heights[0])
        self.counts = dict.fromkeys(EventKind, 0)
        self.events: dict[EventKind, Event | None] = dict.fromkeys(EventKind)

    def add(self, run: Run) -> None:
        """Take note of all rows of a run."""
        self.note(self.finder.feed(Block(run.times, run.rows)))
        height = np.nan_to_num(run.column(Column.BUMP))
        highest = _bump(run, int(height.argmax()))
        if highest.height > (0.0 if self.highest is None else self.highest.height):
            self.highest = highest
        for i, least in enumerate(self.heights):
            if self.first[i] is None and highest.height >= least:
                self.first[i] = _bump(run, int((height >= least).argmax()))

    def note(self, events: list[Event]) -> None:
        """Count events; remember the first of a kind, of near misses the lowest."""
        for event in events:
            self.counts[event.kind] += 1
            known = self.events[event.kind]
            lower = event.kind is EventKind.NEAR_MISS and known and event.value < known.value
            if known is None or lower:
                self.events[event.kind] = event


def _bump(run: Run, row: int) -> Bump:
    height, place = run.rows[row, [Column.BUMP, Column.BUMP_AT]]
    return Bump(float(height), float(place), float(run.times[row]))


def seconds(nodes: int, steps: float, scheme: str) -> float:
    """How long so many steps take, roughly: waves, and the machine, make up to ten of it.

    >>> seconds(1000, 1e6, "trapezoidal")
    20.0
    """
    return nodes * steps * (2e-8 if scheme == Scheme.TRAPEZOIDAL.value else 3e-9)


def default_dx(beta: float) -> float:
    """0.01, or the next round number below √β/20 where that is less.

    The contact point is content with √β/10; the small waves that leave the rope are not.

    >>> [default_dx(beta) for beta in (0.0, 0.01, 1e-3, 1e-4)]
    [0.01, 0.005, 0.001, 0.0005]
    """
    limit = math.sqrt(beta) / 20 if beta > 0 else math.inf
    if limit >= 0.01:
        return 0.01
    decade = math.floor(math.log10(limit))
    return next(
        float(f"{digit}e{decade}")
        for digit in (5, 2.5, 2, 1)
        if digit * 10.0**decade <= limit * (1 + 1e-12)
    )


def drive_of(omega: float, epsilon: float, ramp: float) -> Drive:
    """1 + ε cos Ωτ, ramped up over so many periods; at once for 0."""
    if non_negative("ramp", ramp) == 0:
        return cosine(omega, epsilon)
    return ramped_cosine(omega, epsilon, ramp)


def watch(
    problem: RopeProblem,
    epsilon: float,
    ramp: float,
    periods: float,
    grid: Grid,
    dt: float | None = None,
    scheme: Scheme | str = Scheme.TRAPEZOIDAL,
    keep: float = 4.0,
    checkpoint: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    begin: Callable[[int, int], None] | None = None,
) -> Watched:
    """Simulate ``periods`` forcing periods from rest, and keep the last ``keep`` of them.

    With a ``checkpoint`` the run is resumed where the file exists, saved every few seconds until
    the periods to be kept begin, and saved when it is interrupted (Ctrl-C), which then raises
    KeyboardInterrupt. ``begin`` is told the nodes and the steps to be done, before the first.

    Raises
    ------
    InputError, FileError, ActiveSetError
        As the simulator and its checkpoints.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> problem = RopeProblem(0.01, ramped_cosine(2.5, 0.02, 3))
    >>> watched = watch(problem, 0.02, ramp=3, periods=5, grid=Grid(dx=0.02))
    >>> watched.verdict, watched.highest is None
    (<Verdict.FOLLOWS: 'follows'>, True)
    """
    period = problem.drive.period
    until = positive("periods", periods) * period
    if periods <= ramp:
        raise InputError(
            f"periods = {periods:g} end before the ramp of {ramp:g} periods is over and epsilon = "
            f"{epsilon:g} is reached; take more periods, or a shorter ramp"
        )
    if checkpoint is None:
        simulator = Simulator(problem, grid, dt, scheme)
    else:
        simulator = start_or_resume(checkpoint, problem, grid, dt, scheme)
    check_resolution(simulator.dt, period)
    last = steps_until(until, simulator.dt)
    if simulator.step >= last:
        raise InputError(
            f"{checkpoint} already stands at tau = {simulator.time:.6g}, not before the end "
            f"{until:.6g} of these {periods:g} periods; ask for more periods, or for another file"
        )
    every = stride("snapshots", period / FRAMES_PER_PERIOD, simulator.dt)
    kept = min(positive("keep", keep), periods)
    window = max(last - math.ceil(kept * period / simulator.dt), 0)
    window -= window % every
    history = _History(simulator)
    if begin is not None:
        begin(simulator.system.size, last - simulator.step)
    with _interruptible() as check:

        def done(step: int, _: int) -> None:
            if progress is not None:
                progress(step, last)
            check()

        try:
            saved = (
                nullcontext(done)
                if checkpoint is None
                else saving(simulator, checkpoint, progress=done)
            )
            with saved as tell:
                while simulator.step < window:
                    stop = min(simulator.time + period, window * simulator.dt)
                    history.add(follow(simulator, stop, simulator.time, progress=tell))
            run = follow(simulator, until, simulator.time, every * simulator.dt, progress=done)
        except KeyboardInterrupt:
            if checkpoint is not None and simulator.step <= window:
                save_checkpoint(simulator, checkpoint)
            raise
    history.add(run)
    history.note(history.finder.finish())
    return Watched(
        run=run,
        epsilon=epsilon,
        ramp=ramp,
        periods=periods,
        begun=history.begun,
        highest=history.highest,
        heights=history.heights,
        first=(history.first[0], history.first[1]),
        counts=history.counts,
        events=history.events,
        fastest=history.finder.fastest,
        rest=_rest(simulator),
    )


def _rest(simulator: Simulator) -> tuple[float, float]:
    """ξ_c and E of the rope at rest under Z(0)."""
    system = simulator.system
    end = float(simulator.problem.drive.height(np.zeros(1))[0])
    state = equilibrium(system, end)
    # Next to the contact point neither the load nor the driven end belongs to the elastic force.
    force = system.force(state.height) - system.load
    contact = float(contact_point(system, force, state.active)[0])
    return contact, system.energy(state.height, state.velocity, end)


@contextmanager
def _interruptible() -> Iterator[Callable[[], None]]:
    """Ctrl-C waits for the next call of the function yielded: between blocks, state is whole."""
    if threading.current_thread() is not threading.main_thread():
        yield lambda: None
        return
    asked = threading.Event()
    before: Any = signal.signal(signal.SIGINT, lambda *_: asked.set())

    def check() -> None:
        if asked.is_set():
            raise KeyboardInterrupt

    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
