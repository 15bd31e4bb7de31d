"""The first event of a run, and what it depends on: dx, dt, the height that counts, the integrator.

An event without such a study is a number without an error: near the loss of the wave-less state the
first wave may leave a period earlier or later on another grid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

from numerics.events.finder import Event, EventFinder, EventKind
from numerics.problems.problem import RopeProblem
from numerics.problems.pulses import smallest_wave
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.semi_discrete import Grid


class Variant(Enum):
    """What :func:`study` changes."""

    BASE = "base"
    GRID = "dx/2"
    STEP = "dt/2"
    HEIGHT = "height × 10"
    SCHEME = "other integrator"


@dataclass(frozen=True)
class EventStudy:
    """The first event of a kind, and what it depends on.

    Attributes
    ----------
    kind
        Of which event.
    events
        For each variant the first such event, None where there was none.
    """

    kind: EventKind
    events: dict[Variant, Event | None]

    def spread(self, name: str = "time") -> float:
        """Largest difference from the base among the variants; ∞ if one has no such event.

        ``name`` is an attribute of :class:`Event`.
        """
        base, *others = (
            math.nan if event is None else getattr(event, name) for event in self.events.values()
        )
        differences = [abs(other - base) for other in others]
        return math.inf if any(map(math.isnan, differences)) else max(differences)


def study(
    problem: RopeProblem,
    until: float,
    kind: EventKind,
    grid: Grid | None = None,
    height: float | None = None,
) -> EventStudy:
    """Run again with dx/2, dt/2, ten times the height and the other integrator.

    Parameters
    ----------
    problem, grid
        See :class:`~numerics.simulation.contact.Simulator`.
    until
        When to give up.
    kind
        The event to look for; the first one counts.
    height
        See :class:`EventFinder`; by default twice :func:`smallest_wave`.

    Raises
    ------
    InputError
        As the simulators; restitution with bending is refused, for the explicit one gains energy.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> drive = ramped_cosine(2.9, 0.06, periods=10)
    >>> found = study(RopeProblem(0.01, drive), 12 * drive.period, EventKind.SEPARATED_WAVE,
    ...               Grid(dx=0.02))
    >>> found.spread() < 2 * drive.period
    True
    """
    grid = Grid() if grid is None else grid
    kind = EventKind(kind)
    if height is None:
        height = 2 * smallest_wave(problem.beta, grid.dx)
    fine, dt = replace(grid, dx=grid.dx / 2), grid.dx
    cases = {
        Variant.BASE: (grid, dt, height, Scheme.TRAPEZOIDAL),
        Variant.GRID: (fine, dt, height, Scheme.TRAPEZOIDAL),
        Variant.STEP: (grid, dt / 2, height, Scheme.TRAPEZOIDAL),
        Variant.HEIGHT: (grid, dt, 10 * height, Scheme.TRAPEZOIDAL),
        Variant.SCHEME: (grid, None, height, Scheme.VERLET),
    }
    # All of them before the first run: what one refuses is said at once.
    simulators = {
        name: Simulator(problem, where, step, scheme)
        for name, (where, step, _, scheme) in cases.items()
    }
    events = {
        name: first_event(simulators[name], until, kind, level)
        for name, (_, _, level, _) in cases.items()
    }
    return EventStudy(kind, events)


def first_event(simulator: Simulator, until: float, kind: EventKind, height: float) -> Event | None:
    """The first event of a kind from where the simulator stands; it stops soon after.

    Raises
    ------
    InputError
        ``until`` is not after the simulator's time.
    """
    simulator.last_step(until)
    kind = EventKind(kind)
    finder = EventFinder(simulator.system.dx, simulator.dt, height)
    for block in simulator.blocks(until):
        for event in finder.feed(block):
            if event.kind is kind:
                return event
    return next((event for event in finder.finish() if event.kind is kind), None)
