r"""One ramped run, watched for the first wave that leaves: the experiment behind a threshold.

A run starts at rest, ramps ε smoothly up over some forcing periods, holds it, and stops at the
first *separated wave*: something higher than h that stands beyond the contact point.

**The height h.** As long as nothing has separated, BUMP is exactly zero. The first lifted nodes
beyond the contact point are ripples of the grid: waves lower than
:func:`~numerics.problems.pulses.smallest_wave` do not fit on it. A pulse on the ground of the
height ηβ has the half-length ϖ(η/PULSE)^{1/4} √β, so heights are best measured in β: h = 10⁻³β is
six cells long on dx = √β/10, and 10⁻²β on √β/5. Larger h find the loss later, most so where it sets
in with small waves, away from resonances.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numerics.events.finder import Event, EventFinder, EventKind, fastest_contact
from numerics.problems.drive import (
    Array,
    Drive,
    frequency,
    non_negative,
    positive,
    ramped_cosine,
    smooth_step,
)
from numerics.problems.problem import RopeProblem, check_stiffness
from numerics.problems.pulses import smallest_wave
from numerics.simulation.contact import Block, Scheme, Simulator, check_resolution, steps_until
from numerics.simulation.observables import Column
from numerics.simulation.semi_discrete import Grid, check_spacing

Envelope = Callable[[Array], Array]
Watching = Callable[[float, float], None]
"""Gets the amplitude of the run under way, and the part of it that is done at most."""

MEMORY = 5
"""Periods over which the growth of the swing is measured."""


@dataclass(frozen=True)
class Settings:
    """How a run is made, and what counts as lost.

    Attributes
    ----------
    dx, dt
        Spacing and step; dt None is the scheme's default.
    height
        h, in units of Z₀.
    ramp, hold
        Forcing periods of the smooth ramp and after it.
    scheme
        The integrator.
    length, sponge
        Of the domain.
    refine
        dt, given or default, is divided by this.

    Raises
    ------
    InputError
        A number that is not positive; ``hold`` and ``sponge`` may be 0.
    """

    dx: float
    height: float
    dt: float | None = None
    ramp: float = 20.0
    hold: float = 20.0
    scheme: Scheme = Scheme.TRAPEZOIDAL
    length: float = 8.0
    sponge: float = 3.0
    refine: float = 1.0

    def __post_init__(self) -> None:
        checks = dict.fromkeys(("dx", "height", "ramp", "length", "refine"), positive)
        checks |= dict.fromkeys(("hold", "sponge"), non_negative)
        if self.dt is not None:
            checks["dt"] = positive
        for name, check in checks.items():
            object.__setattr__(self, name, check(name, getattr(self, name)))
        object.__setattr__(self, "scheme", Scheme(self.scheme))

    @property
    def grid(self) -> Grid:
        """The domain."""
        return Grid(self.dx, self.length, self.sponge)

    def simulator(self, problem: RopeProblem) -> Simulator:
        """A simulator at rest."""
        simulator = Simulator(problem, self.grid, self.dt, self.scheme)
        if self.refine == 1:
            return simulator
        return Simulator(problem, self.grid, simulator.dt / self.refine, self.scheme)


@dataclass(frozen=True)
class Outcome:
    """One run, and what can be said about how it ended.

    Attributes
    ----------
    epsilon
        Its amplitude.
    loss
        The separated wave, None if the rope stayed wave-less.
    periods
        When: forcing periods since the start of the ramp; of a run that stayed, its length.
    growth
        The swing max ξ_c − min ξ_c of the last period over that of five periods before, less the
        growth of ε between them: 1 in a steady state. NaN if the run was shorter.
    cut
        How far the contact point jumped back, ξ_c before − ξ_c after, in the step of the loss: the
        length that a new contact cut off. NaN if the run stayed.
    speed
        The contact point's fastest motion in the last period, as a line over 12 dx/c, jumps left
        out: not sonic, perhaps. None if it did nothing but jump.
    """

    epsilon: float
    loss: Event | None
    periods: float
    growth: float
    cut: float
    speed: Event | None

    @property
    def stayed(self) -> bool:
        """No wave has left."""
        return self.loss is None


def base_settings(beta: float, dx: float | None = None) -> Settings:
    """dx = √β/10, or what is given; h = 10⁻³β, but no less than the grid carries.

    For β = 0, where there is no length to resolve, dx = 0.01 and h = dx².

    Raises
    ------
    InputError
        β outside [0, 1]; dx ≤ 0, too coarse for β, or too fine for any machine.

    Examples
    --------
    >>> base_settings(0.01).dx, base_settings(0.01).height
    (0.01, 1e-05)
    """
    beta = check_stiffness(beta)
    if dx is None:
        dx = math.sqrt(beta) / 10 if beta > 0 else 0.01
    check_spacing(beta, Grid(dx).dx)
    return Settings(dx, max(1e-3 * beta, smallest_wave(beta, dx)))


def run_length(omega: float, beta: float, settings: Settings) -> tuple[int, int]:
    """The nodes and, at the default dt of its scheme or the one given, the steps of a run.

    >>> run_length(2.5, 0.01, base_settings(0.01))
    (799, 10054)
    """
    omega, beta = frequency(omega), check_stiffness(beta)
    dx, dt = settings.dx, settings.dt
    if dt is None:
        dt = dx
        if settings.scheme is Scheme.VERLET:
            dt = min(0.9 / math.sqrt(1 / dx**2 + 4 * beta / dx**4), dx)
    time = (settings.ramp + settings.hold) * 2 * math.pi / omega
    return round(settings.length / dx) - 1, steps_until(time, dt / settings.refine)


def run_once(
    omega: float,
    epsilon: float,
    beta: float,
    settings: Settings,
    watching: Watching | None = None,
) -> Outcome:
    """Ramp, hold, and stop at the first separated wave.

    Raises
    ------
    InputError
        As the simulator.

    Examples
    --------
    >>> coarse = Settings(dx=0.025, height=1e-3, ramp=5, hold=2)
    >>> run_once(2.5, 0.02, 0.01, coarse).stayed, run_once(2.5, 0.3, 0.01, coarse).stayed
    (True, False)
    """
    drive = ramped_cosine(omega, epsilon, settings.ramp)
    length = settings.ramp * drive.period
    until = length + settings.hold * drive.period
    return watch_ramp(
        drive, epsilon, lambda t: smooth_step(t / length)[0], beta, settings, until, watching
    )


def watch_ramp(
    drive: Drive,
    epsilon: float,
    envelope: Envelope,
    beta: float,
    settings: Settings,
    until: float,
    watching: Watching | None = None,
) -> Outcome:
    """As :func:`run_once`, for any drive; ``envelope`` is its amplitude, a function of τ."""
    simulator = settings.simulator(RopeProblem(beta, drive))
    check_resolution(simulator.dt, drive.period)
    dx, dt, height = settings.dx, simulator.dt, settings.height
    tail = _Tail((MEMORY + 1) * drive.period)
    lost = False
    for times, rows in simulator.blocks(until):
        high = rows[:, Column.BUMP] >= height
        lost = bool(high.any())
        stop = int(np.argmax(high)) + 1 if lost else len(times)
        tail.feed(Block(times[:stop], rows[:stop]))
        if watching is not None:
            watching(epsilon, min(simulator.time / until, 1.0))
        if lost:
            break
    end = tail.end
    loss, cut = None, math.nan
    if lost:
        last = tail.between(end - 1.5 * dt, end)
        events = EventFinder(dx, dt, height).feed(last)
        loss = next(event for event in events if event.kind is EventKind.SEPARATED_WAVE)
        cut = float(-np.diff(last.rows[:, Column.CONTACT])[0])
    return Outcome(
        epsilon=epsilon,
        loss=loss,
        periods=end / drive.period,
        growth=_growth(tail, drive.period, envelope, dt),
        cut=cut,
        speed=fastest_contact(tail.between(end - drive.period, end), dx, dt),
    )


class _Tail:
    """The last rows of a run, over at least the length given."""

    def __init__(self, length: float) -> None:
        self._length = length
        self._blocks: list[Block] = []

    def feed(self, block: Block) -> None:
        self._blocks.append(block)
        while len(self._blocks) > 1 and self._blocks[1].times[0] < self.end - self._length:
            self._blocks.pop(0)

    @property
    def end(self) -> float:
        return float(self._blocks[-1].times[-1])

    def between(self, start: float, end: float) -> Block:
        times, rows = (np.concatenate(part) for part in zip(*self._blocks, strict=True))
        inside = (times >= start) & (times <= end)
        return Block(times[inside], rows[inside])


def _growth(tail: _Tail, period: float, envelope: Envelope, dt: float) -> float:
    # The step of the loss itself has jumped.
    end = tail.end - dt / 2
    ratio = 1.0
    for when, power in ((end, 1), (end - MEMORY * period, -1)):
        contact = tail.between(when - period, when).rows[:, Column.CONTACT]
        drive = float(envelope(np.array(when)))
        if when < period or len(contact) < 2 or drive == 0:
            return math.nan
        ratio *= (float(np.ptp(contact)) / drive) ** power
    return ratio
