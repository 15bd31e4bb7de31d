r"""Where and how the wave-less state is lost: events read off the rows of a run, block by block.

* **New contact**: the rope comes down at a place before the contact point. The bracket is the step
  in which the first node met the ground.
* **Near miss**: the smallest interior minimum of the height, GAP, has a minimum in time, but not at
  the ground; a parabola through three steps gives its height. Tangent touches are found this way:
  a sign change between two steps is never asked for.
* **Separated wave**: something higher than a threshold stands beyond the contact point.
* **Sonic contact**: |ξ_c′| ≥ 1, with ξ_c′ the slope of a least-squares line through ξ_c(τ) over a
  span of some dx/c.

**What a sonic contact means.** For β = 0 it ends the solution by characteristics. For β > 0 there
is no such end, for bending waves are faster than 1, and the ground takes no energy from a contact
point that runs at c > 1. But in its frame the rope then obeys βW⁗ + (c² − 1)W″ + 2 = 0: it
oscillates with the wavelength 2π√(β/(c² − 1)) about a falling parabola, and is back on the ground
where the travelling pulse would be. A contact point that runs outwards at c > 1 for long enough is
the front of a pulse, and the new contact behind it cuts the pulse off.

**Resolution.** A pulse of half-length ℓ has the height h = 31.4 ℓ⁴/(ϖ⁴β): see
:func:`numerics.problems.pulses.smallest_wave`. Lifted nodes below that height are ripples of the
grid.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numerics.errors import InputError
from numerics.problems.drive import Array, positive
from numerics.simulation.contact import Block, stride
from numerics.simulation.observables import COLUMNS, Column

LONGEST = 8192
"""Steps that one line through the contact point may take."""
_PART = 1 << 22  # numbers that are made at a time

SPAN = 12
"""Default span of the contact speed's line, in units of dx/c."""


class EventKind(Enum):
    """What happened."""

    NEW_CONTACT = "new contact"
    NEAR_MISS = "near miss"
    SEPARATED_WAVE = "separated wave"
    SONIC_CONTACT = "sonic contact"

    @classmethod
    def _missing_(cls, value: object) -> EventKind:
        raise InputError(f"event {value!r}: choose one of {', '.join(k.value for k in cls)}")


@dataclass(frozen=True)
class Event:
    """One event.

    Attributes
    ----------
    kind
        What.
    before, after
        The bracket in time. New contact, separated wave: the last step without and the first with
        it. Near miss: the steps on either side of the lowest. Sonic contact: the span of the first
        line that is steeper than 1.
    time, place
        τ and ξ. Of a sonic contact: where the speed is greatest.
    value
        New contact: the largest height that it cuts off, in the first step. Near miss: the lowest
        height, from a parabola. Separated wave: its height in the first step. Sonic contact: the
        greatest speed, < 0 towards the driven end.
    error
        Sonic contact: the standard error of the slope. New contact: the height of the interior
        minimum in the step before, NaN if there was none. Else NaN.
    """

    kind: EventKind
    before: float
    after: float
    time: float
    place: float
    value: float
    error: float = math.nan

    def __post_init__(self) -> None:
        for name in ("before", "after", "time", "place", "value", "error"):
            object.__setattr__(self, name, float(getattr(self, name)))


class EventFinder:
    """Reads blocks of rows as they come, and remembers no more than a few of them.

    Parameters
    ----------
    dx, dt
        Of the run.
    height
        A wave has separated when something this high stands beyond the contact point.
    span
        Length in time of the line whose slope is the contact speed; by default 12 dx/c.

    Attributes
    ----------
    window
        The span, in steps.
    fastest
        The greatest contact speed so far, as an event whether sonic or not; None before there is
        one.

    Raises
    ------
    InputError
        A parameter that is not positive, or dt so small that the lines have more than 8192 steps.

    Examples
    --------
    >>> from numerics.simulation.contact import Simulator
    >>> from numerics.problems.drive import ramped_cosine
    >>> from numerics.problems.problem import RopeProblem
    >>> from numerics.simulation.semi_discrete import Grid
    >>> drive = ramped_cosine(2.9, 0.06, periods=10)
    >>> simulator = Simulator(RopeProblem(0.01, drive), Grid(dx=0.02))
    >>> finder = EventFinder(0.02, simulator.dt, height=1e-3)
    >>> blocks = simulator.blocks(12 * drive.period)
    >>> waves = [e for block in blocks for e in finder.feed(block) if e.kind.name[:3] == "SEP"]
    >>> waves[0].after - waves[0].before < 1.01 * simulator.dt
    True
    """

    def __init__(self, dx: float, dt: float, height: float, span: float | None = None) -> None:
        self.dx, self.dt = positive("dx", dx), positive("dt", dt)
        self.height = positive("height", height)
        span = SPAN * self.dx if span is None else span
        self.window = max(stride("span", span, self.dt), 3)
        if self.window > LONGEST:
            raise InputError(
                f"dt = {dt!r}: a line through the contact point would take {self.window} steps, "
                f"more than {LONGEST}; a step that is small against dx = {dx!r} resolves nothing "
                f"that the grid has: give dt >= {span / LONGEST:.2g}"
            )
        self._times, self._rows = np.empty(0), np.empty((0, COLUMNS))
        self._sonic: Event | None = None
        self.fastest: Event | None = None

    def feed(self, block: Block) -> list[Event]:
        """The events that the block completes, in the order of their brackets' ends."""
        keep = self.window + 1
        old = len(self._times)
        times = np.concatenate([self._times, block.times])
        rows = np.concatenate([self._rows, block.rows])
        found = [
            *self._new_contacts(times, rows, old),
            *self._near_misses(times, rows, old),
            *self._waves(times, rows, old),
            *self._speeds(times, rows, old),
        ]
        self._times, self._rows = times[-keep:].copy(), rows[-keep:].copy()
        return sorted(found, key=lambda event: event.after)

    def finish(self) -> list[Event]:
        """The sonic contact that was under way at the end, if any."""
        last, self._sonic = self._sonic, None
        return [] if last is None else [last]

    def _new_contacts(self, times: Array, rows: Array, old: int) -> Iterator[Event]:
        contact, bump = rows[:, Column.CONTACT], rows[:, Column.BUMP]
        top, low = rows[:, Column.BUMP_AT], rows[:, Column.GAP_AT]
        with np.errstate(invalid="ignore"):
            # What is now beyond the contact point was before it: it has been cut off.
            cut = (bump[1:] > 0) & (top[1:] > contact[1:]) & (top[1:] < contact[:-1] + self.dx / 2)
            # The largest wave may be an older one; then the contact jumps to the minimum.
            jump = contact[:-1] - contact[1:] > 3 * self.dx
            came_down = jump & (np.abs(low[:-1] - contact[1:]) <= 2 * self.dx)
        for k in np.flatnonzero(cut | came_down) + 1:
            if k >= old:
                yield Event(
                    EventKind.NEW_CONTACT,
                    times[k - 1],
                    times[k],
                    times[k],
                    contact[k],
                    bump[k],
                    rows[k - 1, Column.GAP],
                )

    def _near_misses(self, times: Array, rows: Array, old: int) -> Iterator[Event]:
        gap, place = rows[:, Column.GAP], rows[:, Column.GAP_AT]
        with np.errstate(invalid="ignore"):
            same = np.abs(np.diff(place)) <= 3 * self.dx
            lowest = (gap[1:-1] < gap[:-2]) & (gap[1:-1] <= gap[2:]) & same[1:] & same[:-1]
        for k in np.flatnonzero(lowest) + 1:
            if k + 1 >= old:
                left, middle, right = gap[k - 1 : k + 2]
                shift = 0.5 * (left - right) / (left - 2 * middle + right)
                yield Event(
                    EventKind.NEAR_MISS,
                    times[k - 1],
                    times[k + 1],
                    times[k] + shift * self.dt,
                    place[k],
                    max(middle - 0.25 * (left - right) * shift, 0.0),
                )

    def _waves(self, times: Array, rows: Array, old: int) -> Iterator[Event]:
        bump = rows[:, Column.BUMP]
        above = bump >= self.height
        for k in np.flatnonzero(above[1:] & ~above[:-1]) + 1:
            if k >= old:
                yield Event(
                    EventKind.SEPARATED_WAVE,
                    times[k - 1],
                    times[k],
                    times[k],
                    rows[k, Column.BUMP_AT],
                    bump[k],
                )

    def _speeds(self, times: Array, rows: Array, old: int) -> Iterator[Event]:
        n, contact = self.window, rows[:, Column.CONTACT]
        if len(contact) <= n:
            return
        slope, error, good = contact_speed(contact, rows[:, Column.BUMP], self.dt, self.dx, n)
        for k in range(max(old - n, 0), len(slope)):
            if not good[k]:
                yield from self.finish()
                continue
            fast = abs(slope[k])
            if fast < 1:
                yield from self.finish()
            is_record = self.fastest is None or fast > abs(self.fastest.value)
            if not is_record and fast < 1:
                continue
            seen = _line(times, contact, slope[k], error[k], k, n)
            if is_record:
                self.fastest = seen
            if fast < 1:
                continue
            if self._sonic is not None and self._sonic.value * slope[k] < 0:
                yield from self.finish()
            if self._sonic is None:
                self._sonic = seen
            elif fast > abs(self._sonic.value):
                self._sonic = replace(seen, before=self._sonic.before, after=self._sonic.after)


def contact_speed(
    contact: Array, bump: Array, dt: float, dx: float, steps: int
) -> tuple[Array, Array, np.ndarray]:
    """Slopes of least-squares lines through ξ_c over ``steps`` steps, and their standard errors.

    Shapes (k,) → (k − steps,) each. The third array tells which lines are to be used: those over
    which ξ_c is known, and does not jump because a wave separates or is caught.

    Raises
    ------
    InputError
        No step, or more than there are.

    Examples
    --------
    >>> times = 0.1 * np.arange(5)
    >>> slope, error, good = contact_speed(1 - 0.5 * times, np.zeros(5), 0.1, 0.1, 3)
    >>> slope.round(12).tolist(), good.tolist()
    ([-0.5, -0.5], [True, True])
    """
    if not 0 < steps < len(contact):
        raise InputError(f"steps = {steps!r}: give from 1 to {len(contact) - 1}")
    lines = sliding_window_view(contact, steps + 1)
    place = dt * (np.arange(steps + 1) - 0.5 * steps)
    weight = place @ place
    slope = lines @ place / weight
    squares, part = np.empty(len(slope)), max(_PART // (steps + 1), 1)
    for first in range(0, len(slope), part):
        some = lines[first : first + part]
        tilt = slope[first : first + part, None] * place
        rest = some - some.mean(axis=1, keepdims=True) - tilt
        squares[first : first + part] = (rest * rest).sum(axis=1)
    error = np.sqrt(squares / max(steps - 1, 1) / weight)
    with np.errstate(invalid="ignore"):
        cut = (bump[1:] > 0) | (bump[:-1] > 0)
        jump = cut & (np.abs(np.diff(contact)) > 3 * max(dx, dt))
    whole = ~sliding_window_view(jump, steps).any(axis=1)
    return slope, error, whole & np.isfinite(slope)


def fastest_contact(block: Block, dx: float, dt: float, span: float = SPAN) -> Event | None:
    """The contact point's greatest speed in the block, as a sonic contact whether sonic or not.

    ``span`` is in units of dx/c. None if no line can be used.
    """
    n = max(stride("span", positive("span", span) * positive("dx", dx), positive("dt", dt)), 3)
    if len(block.times) <= n:
        return None
    contact = block.rows[:, Column.CONTACT]
    slope, error, good = contact_speed(contact, block.rows[:, Column.BUMP], dt, dx, n)
    if not good.any():
        return None
    k = int(np.where(good, np.abs(slope), -1.0).argmax())
    return _line(block.times, contact, slope[k], error[k], k, n)


def _line(times: Array, contact: Array, slope: float, error: float, k: int, n: int) -> Event:
    """The line of n steps that begins at row k, as a sonic contact whether sonic or not."""
    start, end = times[k], times[k + n]
    middle = contact[k + n // 2]
    return Event(EventKind.SONIC_CONTACT, start, end, 0.5 * (start + end), middle, slope, error)
