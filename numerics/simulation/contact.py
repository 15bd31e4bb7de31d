"""The contact simulator: method of lines with a unilateral ground, step by step.

A :class:`Simulator` carries a :class:`~numerics.simulation.semi_discrete.SemiDiscrete` system
through time with one of two independent, compiled integrators:
:mod:`numerics.simulation.trapezoidal` (implicit, the default) and :mod:`numerics.simulation.verlet`
(explicit). Every step yields a row of observables
(:class:`~numerics.simulation.observables.Column`) with its energy ledger and both complementarity
residuals. Rows are handed out block by block: memory does not grow with the length of a run.
:func:`numerics.simulation.run.simulate` runs one to the end and keeps what is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import Enum
from typing import NamedTuple

import numpy as np

from numerics.errors import ActiveSetError, InputError
from numerics.problems.drive import Array, positive, whole
from numerics.problems.problem import RopeProblem
from numerics.simulation import trapezoidal, verlet
from numerics.simulation.observables import COLUMNS, Column
from numerics.simulation.semi_discrete import Grid, SemiDiscrete, State, rope

BLOCK = 1024
"""Steps between two looks at the drive; blocks start at its multiples, also after a restart."""


LEAST_STEPS = 20
"""Steps that a forcing period must have at least."""

_MOST_STEPS = 2.0**53
# In steps shorter than this part of dx the stiffness is lost in the rounding of 4m/dt².
_SHORTEST = 1e-8


class Scheme(Enum):
    """The two integrators."""

    TRAPEZOIDAL = "trapezoidal"
    VERLET = "verlet"

    @classmethod
    def _missing_(cls, value: object) -> Scheme:
        raise InputError(f"scheme {value!r}: choose trapezoidal (implicit) or verlet (explicit)")


class Block(NamedTuple):
    """Consecutive steps: the times at their ends, shape (k,), and their rows, (k, COLUMNS)."""

    times: Array
    rows: Array


class Simulator:
    """A rope in contact with the ground, advanced in time.

    Parameters
    ----------
    problem
        What moves.
    grid
        Where; see :class:`~numerics.simulation.semi_discrete.Grid`.
    dt
        Time step; by default dx, or for Verlet 0.9 of its stability limit, at most dx.
    scheme
        A :class:`Scheme` or its name.

    Attributes
    ----------
    state, step, ledger
        Where it is: the state, the number of steps done, and (E, work, damped, lost).
    unexplained, lowest, reaction
        The worst of all steps: the largest change of energy that the ledger does not explain, the
        smallest W, and the smallest λ per unit length.

    Raises
    ------
    InputError
        dt ≤ 0, or beyond the stability limit; a grid that does not suit the problem; damping in
        which nothing moves; Verlet with restitution and bending, where it gains energy.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> simulator = Simulator(RopeProblem(0.01, ramped_cosine(2.5, 0.05, 5)), Grid(dx=0.02))
    >>> block = next(simulator.blocks(until=1.0))
    >>> simulator.step, block.rows.shape
    (50, (50, 14))
    >>> bool(abs(simulator.unexplained) < 1e-9)
    True
    """

    def __init__(
        self,
        problem: RopeProblem,
        grid: Grid | None = None,
        dt: float | None = None,
        scheme: Scheme | str = Scheme.TRAPEZOIDAL,
    ) -> None:
        self.problem = problem
        self.grid = Grid() if grid is None else grid
        self.scheme = Scheme(scheme)
        if self.scheme is Scheme.VERLET and problem.restitution > 0 and problem.beta > 0:
            raise InputError(
                f"restitution = {problem.restitution!r} with beta = {problem.beta!r}: the explicit "
                "scheme gains energy at the rebounds of a stiff rope; take the trapezoidal scheme, "
                "restitution = 0, or beta = 0"
            )
        self.system = rope(problem, self.grid)
        self.dt = _check_step(dt, self.system, self.scheme)
        if problem.damping * np.finfo(float).eps > self.dt:
            raise InputError(
                f"damping = {problem.damping!r} lets the rope creep by less than the rounding of "
                f"its height in a step of {self.dt:.3g}; take damping ≤ "
                f"{self.dt / np.finfo(float).eps:.3g}"
            )
        end = self._end(np.zeros(1), slice(None))[0]
        self.state = equilibrium(self.system, end)
        self._check_room()
        self.step = 0
        energy = self.system.energy(self.state.height, self.state.velocity, end)
        self.ledger = np.array([energy, 0.0, 0.0, 0.0])
        self.unexplained, self.lowest, self.reaction = 0.0, math.inf, math.inf

    def _check_room(self) -> None:
        """That the rope at rest is down before the domain ends, or its absorbing part begins."""
        held = np.flatnonzero(self.state.active)
        end = self.grid.length - self.grid.sponge
        place = float(self.system.positions[held[0]]) if held.size else math.inf
        if not place < end:
            raise InputError(
                f"the rope at rest is not down before ξ = {end:.6g}, where the domain ends or "
                "absorbs; take a longer one, a heavier rope or less tension"
            )

    @property
    def time(self) -> float:
        """τ of the state."""
        return self.step * self.dt

    def last_step(self, until: float) -> int:
        """The number of the step that ends at or after ``until``, a time still to come.

        Raises
        ------
        InputError
            The simulator is there already.
        """
        last = steps_until(until, self.dt)
        if last <= self.step:
            raise InputError(
                f"until = {until!r} is not after the time tau = {self.time:.6g} that the "
                "simulator has reached; give a later time"
            )
        return last

    def blocks(self, until: float, every: int = BLOCK) -> Iterator[Block]:
        """Advance to the first step at or after ``until``.

        Blocks end at multiples of ``every`` steps, and of BLOCK.

        Raises
        ------
        InputError
            The drive takes the end to the ground.
        ActiveSetError
            A step's active set did not end; the simulator stands before that step.
        """
        last, every = steps_until(until, self.dt), whole("every", every)
        while self.step < last:
            start = self.step - self.step % BLOCK
            stop = min(last, start + BLOCK, self.step - self.step % every + every)
            times = self.dt * np.arange(start - 1.0, start + BLOCK + 1)
            # The whole block, always: vectorised functions may round by position in the array.
            heights = self._end(times, slice(self.step - start, stop - start + 2))
            rows = np.empty((stop - self.step, COLUMNS))
            done = run_steps(
                self.system,
                self.scheme,
                self.dt,
                self.problem.restitution,
                heights,
                self.state,
                self.ledger,
                rows,
            )
            self.step += done
            if done:
                self._note(rows[:done])
            if done < len(rows):
                raise ActiveSetError(
                    f"the active set of step {self.step + 1} (tau = {self.time:.6g}) did not end; "
                    f"the state before it is kept. Take a smaller dt than {self.dt!r}, and please "
                    "report it: in exact arithmetic this cannot happen"
                )
            yield Block(self.dt * np.arange(self.step - done + 1.0, self.step + 1), rows)

    def _note(self, rows: Array) -> None:
        unexplained = float(np.abs(rows[:, Column.UNEXPLAINED]).max())
        self.unexplained = max(self.unexplained, unexplained)
        self.lowest = min(self.lowest, float(rows[:, Column.LOWEST].min()))
        self.reaction = min(self.reaction, float(rows[:, Column.REACTION].min()))

    def _end(self, times: Array, used: slice) -> Array:
        """Z at the times used, that of τ = 0 before it."""
        label = self.problem.drive.label
        heights = np.asarray(self.problem.drive.height(np.maximum(times, 0.0)), float)
        if heights.shape != times.shape:
            raise InputError(
                f"the drive {label!r} gives an array of shape {heights.shape} for one of shape "
                f"{times.shape}; Z must be a number for each time"
            )
        times, heights = times[used], heights[used]
        good = np.isfinite(heights) & (heights > 0)
        if not good.all():
            raise InputError(
                f"the drive {label!r} takes the driven end to Z = {heights[~good][0]:.6g} at tau = "
                f"{times[~good][0]:.6g}; it must stay above the ground, Z > 0"
            )
        return heights


def run_steps(
    system: SemiDiscrete,
    scheme: Scheme,
    dt: float,
    restitution: float,
    heights: Array,
    state: State,
    ledger: Array,
    rows: Array,
) -> int:
    """Take ``len(rows)`` steps in place; ``heights`` is Z from one step before the state on.

    The bare loop under :class:`Simulator`, for any system: see
    :func:`numerics.simulation.semi_discrete.string_on_obstacle`. Returns the number of steps taken.
    """
    if scheme is Scheme.VERLET:
        return int(verlet.advance(system, dt, restitution, heights, state, ledger, rows))
    return int(trapezoidal.advance(system, dt, restitution, heights[1:], state, ledger, rows))


def equilibrium(system: SemiDiscrete, end: float) -> State:
    """The state at rest with the driven end at Z = ``end``: KW + bZ + f = λ ⟂ W ≥ 0.

    >>> from numerics.problems.drive import at_rest
    >>> state = equilibrium(rope(RopeProblem(0.0, at_rest()), Grid(dx=0.01)), 1.0)
    >>> round(float(state.height[49]), 12)
    0.25
    """
    n = system.size
    right = -system.load
    right[0] -= system.drive[0] * end
    right[1] -= system.drive[1] * end
    height, active = np.zeros(n), np.ones(n, bool)
    factors, scratch = np.zeros((3, n)), np.zeros(n)
    trapezoidal.complementarity(
        system.stiffness, right, system.obstacle, n, 0, active, factors, scratch, height
    )
    return State(height, np.zeros(n), active)


def steps_until(until: float, dt: float) -> int:
    """The number of the first step that ends at or after the time ``until``, up to rounding.

    >>> steps_until(1.0, 0.1)
    10
    """
    return math.ceil(_steps("until", until, dt) * (1 - 4 * np.finfo(float).eps))


def stride(name: str, duration: float, dt: float) -> int:
    """A duration rounded to steps, at least one.

    >>> stride("every", 0.26, 0.1)
    3
    """
    return max(round(_steps(name, duration, dt)), 1)


def check_resolution(dt: float, period: float) -> None:
    """That a forcing period has LEAST_STEPS steps."""
    if dt > period / LEAST_STEPS:
        raise InputError(
            f"dt = {dt:.4g} is too long for a forcing period of {period:.4g}: take at least "
            f"{LEAST_STEPS} steps a period, dt ≤ {period / LEAST_STEPS:.4g}"
        )


def _steps(name: str, duration: float, dt: float) -> float:
    count = positive(name, duration) / dt
    if count > _MOST_STEPS:
        raise InputError(f"{name} = {duration!r} is more than 2^53 steps of {dt!r}; give less")
    return count


def _check_step(dt: float | None, system: SemiDiscrete, scheme: Scheme) -> float:
    limit = system.explicit_limit
    if dt is None:
        return system.dx if scheme is Scheme.TRAPEZOIDAL else min(0.9 * limit, system.dx)
    dt = positive("dt", dt)
    if dt < _SHORTEST * system.dx:
        raise InputError(
            f"dt = {dt!r} is so short that a step is lost in rounding; take dt ≥ "
            f"{_SHORTEST * system.dx:.3g}"
        )
    if scheme is Scheme.VERLET and dt >= limit:
        raise InputError(
            f"dt = {dt!r} is beyond the stability limit {limit:.6g} of the explicit scheme on this "
            "grid; take a smaller dt, or the trapezoidal scheme, which has none"
        )
    return dt
