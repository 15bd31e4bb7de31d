"""A simulated run from beginning to end, and what is kept of it.

:func:`simulate` starts from rest, :func:`follow` goes on from where a
:class:`~numerics.simulation.contact.Simulator` stands. By default they keep the last forcing
period, or the last ROWS rows where the drive has none; memory grows with what is asked for, not
with the length of the run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from numerics.errors import InputError
from numerics.problems.drive import Array, finite
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import BLOCK, Block, Scheme, Simulator, stride
from numerics.simulation.observables import COLUMNS, Column
from numerics.simulation.semi_discrete import Flags, Grid, State

ROWS = 100_000
"""Rows that are kept at most of a run whose drive has no period: 11 MB."""


# Of the polynomial that smooths ξ_c, and of its window in units of √dx.
_DEGREE, _SPAN = 4, 5.0


class ContactHistory(NamedTuple):
    """ξ_c at some times, shape (k,) each."""

    times: Array
    contact: Array


@dataclass(frozen=True, eq=False)
class Run:
    """What :func:`simulate` kept of a run.

    Attributes
    ----------
    problem, grid, dt, scheme
        Of which run.
    times, rows
        The rows kept, shapes (k,) and (k, COLUMNS).
    snapshot_times, heights, velocities, held
        Snapshots, shapes (s,) and (s, n); ``held`` is the contact set.
    positions
        ξ of the nodes, shape (n,).
    end, end_time
        The state at the end, and when that is.
    ledger
        (E, work, damped, lost) at the end.
    unexplained
        Largest change of energy in any step that the ledger does not explain: rounding.
    lowest, reaction
        Complementarity residuals: the smallest W and the smallest λ per unit length. All three are
        of all steps since the rope was at rest.
    """

    problem: RopeProblem
    grid: Grid
    dt: float
    scheme: Scheme
    times: Array
    rows: Array
    snapshot_times: Array
    heights: Array
    velocities: Array
    held: Flags
    positions: Array
    end: State
    end_time: float
    ledger: Array
    unexplained: float
    lowest: float
    reaction: float

    def column(self, name: Any) -> Array:
        """One :class:`~numerics.simulation.observables.Column` of the rows, shape (k,)."""
        return self.rows[:, int(name)]

    def smooth_contact(self) -> ContactHistory:
        """ξ_c without the noise of single nodes, at the times of the rows.

        A quartic is fitted over 5√dx around each time, at most a third of a forcing period
        (Savitzky–Golay). Jumps of ξ_c, when a wave leaves, are smeared.

        The error has three parts. The harmonics of the forcing that ξ_c carries are of second
        order. The noise has the frequency |ξ_c′|/dx at which nodes are laid down, and those of the
        ringing that this excites; it is of first order, 0.1 dx to 0.2 dx, and only averaging over
        many nodes lowers it, so a window must not shrink like dx. And the free oscillation that a
        ramp leaves does not depend on dx: 5e-4 at Ω = 2.5, β = 0.01, ε = 0.05 after 20 periods.
        Rms errors, raw and smoothed; for β = 0.01 with ε = 0.05, started from the periodic state,
        for β = 0 of a ramped drive with ε = 0.02 against the exact string:

        ======  =================  =================  ===============
        dx      β = .01, Ω = 2.5   β = .01, Ω = 1.3   β = 0, Ω = 2.2
        ======  =================  =================  ===============
        0.02    2.1e-3, 4.8e-4     1.0e-3, 4.1e-4     1.1e-3, 5.1e-4
        0.01    1.1e-3, 1.6e-4     2.9e-4, 1.1e-4     5.4e-4, 1.7e-4
        0.005   4.9e-4, 8.0e-5     1.1e-4, 3.2e-5     2.8e-4, 5.0e-5
        0.0025  5.9e-4, 8.4e-5     1.2e-4, 2.1e-5     1.4e-4, 1.8e-5
        ======  =================  =================  ===============

        So the order is 1.3 to 1.8 down to dx = √β/20, and nothing is gained beyond.

        Raises
        ------
        InputError
            Fewer rows than the window holds.

        Examples
        --------
        >>> from numerics.problems.drive import ramped_cosine
        >>> drive = ramped_cosine(2.5, 0.05, periods=5)
        >>> run = simulate(RopeProblem(0.01, drive), 6 * drive.period, Grid(dx=0.02))
        >>> times, contact = run.smooth_contact()
        >>> times.shape == contact.shape == run.times.shape
        True
        """
        from scipy.signal import savgol_filter

        span, drive = _SPAN * math.sqrt(self.grid.dx), self.problem.drive
        if drive.omega is not None:
            span = min(span, drive.period / 3)
        window = max(2 * round(span / self.dt / 2) + 1, _DEGREE + 3)
        if len(self.times) < window:
            raise InputError(
                f"{len(self.times)} rows are kept of this run and smoothing spans {window}; keep "
                "more, with an earlier record_from"
            )
        smooth = savgol_filter(self.column(Column.CONTACT), window, _DEGREE)
        return ContactHistory(self.times, np.asarray(smooth))


def simulate(
    problem: RopeProblem,
    until: float,
    grid: Grid | None = None,
    dt: float | None = None,
    scheme: Scheme | str = Scheme.TRAPEZOIDAL,
    record_from: float | None = None,
    snapshots: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """Simulate from rest to the time ``until``.

    Parameters
    ----------
    problem, grid, dt, scheme
        See :class:`Simulator`.
    record_from
        Rows are kept from this time on. By default of the last forcing period only, so that memory
        does not grow with the run; of a drive without a period all, up to the last ROWS.
    snapshots
        Time between snapshots of the whole rope, rounded to steps; by default there are none.
    progress
        Called with the steps done and their total.

    Raises
    ------
    InputError, ActiveSetError
        As the :class:`Simulator`.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> drive = ramped_cosine(2.5, 0.05, periods=5)
    >>> run = simulate(RopeProblem(0.01, drive), 6 * drive.period, snapshots=drive.period / 8)
    >>> run.heights.shape, bool(run.lowest >= 0), bool(run.reaction > -1e-6)
    ((49, 799), True, True)
    """
    simulator = Simulator(problem, grid, dt, scheme)
    return follow(simulator, until, record_from, snapshots, progress)


def follow(
    simulator: Simulator,
    until: float,
    record_from: float | None = None,
    snapshots: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """As :func:`simulate`, from wherever the simulator stands."""
    last = simulator.last_step(until)
    drive = simulator.problem.drive
    if record_from is not None:
        record_from = finite("record_from", record_from)
    else:
        length = ROWS * simulator.dt if drive.omega is None else drive.period
        record_from = float(until) - length
    frame = 0 if snapshots is None else stride("snapshots", snapshots, simulator.dt)
    every = frame or BLOCK
    times_seen, frames = ([simulator.time], [_copy(simulator.state)]) if frame else ([], [])
    kept: list[Block] = []
    for times, rows in simulator.blocks(until, every):
        late = times >= record_from
        if late.any():
            kept.append(Block(times[late], rows[late]))
        if frame and simulator.step % frame == 0:
            times_seen.append(simulator.time)
            frames.append(_copy(simulator.state))
        if progress is not None:
            progress(simulator.step, last)
    return Run(
        problem=simulator.problem,
        grid=simulator.grid,
        dt=simulator.dt,
        scheme=simulator.scheme,
        times=np.concatenate([np.empty(0), *(block.times for block in kept)]),
        rows=np.concatenate([np.empty((0, COLUMNS)), *(block.rows for block in kept)]),
        snapshot_times=np.array(times_seen, float),
        heights=_stack([state.height for state in frames], simulator),
        velocities=_stack([state.velocity for state in frames], simulator),
        held=_stack([state.active for state in frames], simulator).astype(bool),
        positions=simulator.system.positions,
        end=_copy(simulator.state),
        end_time=simulator.time,
        ledger=simulator.ledger.copy(),
        unexplained=simulator.unexplained,
        lowest=simulator.lowest,
        reaction=simulator.reaction,
    )


def _copy(state: State) -> State:
    return State(state.height.copy(), state.velocity.copy(), state.active.copy())


def _stack(parts: list[Any], simulator: Simulator) -> Any:
    return np.array(parts).reshape(-1, simulator.system.size)
