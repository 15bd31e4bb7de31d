r"""The contact simulator started on a periodic state: does it stay there?

Ramped runs mix two questions: is the state stable, and does the ramp lead to it. Here there is no
ramp. W and W_τ of a state of :mod:`numerics.periodic.states` are put on the nodes, a small push is
added, and the drive goes on. Kept is

.. math:: d(τ) = ξ_c(τ) − ξ_c^{state}(τ), \qquad g(τ) = d(τ + T) − d(τ),

T the drive's period: g is zero for what follows the state up to the constant error of a grid, and a
disturbance with multiplier λ changes it by λ in a period. The least-squares slope of its logarithm
is the rate at which disturbances grow, to be compared with log|λ|/T of
:mod:`numerics.periodic.stability`, with which it shares no equation. A grid damps: nodes that are
laid down lose energy (:mod:`numerics.simulation.trapezoidal`), and the rate is too low by an amount
that falls with dx.

A rope that sheds a wave, or whose ξ_c is farther from the state than the state's own
amplitude, has *left*. At an ε where the state has ended, start on the last one before it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope, Terms
from numerics.periodic.modes import Complex, check_constant
from numerics.periodic.states import PeriodicState
from numerics.problems.along import along
from numerics.problems.drive import finite, fourier, whole
from numerics.problems.problem import DrivenEnd, RopeProblem
from numerics.problems.pulses import smallest_wave
from numerics.simulation.contact import Simulator
from numerics.simulation.observables import Column
from numerics.simulation.semi_discrete import Grid

PUSH = 3e-3
"""Velocity of the push, in units of Z₀c/x₀."""

Keys = tuple[tuple[int, int], ...]
_SAMPLES = 257
# Of a drive's largest amplitude: what counts as one.
_HEARD = 1e-13
# Of the amplitude of the state: farther off the rope has left.
_FAR = 1.0
# Periods in the beginning that are not looked at: the push spreads over modes that then decay.
_SETTLED = 0.25
# Growth is sure if it exceeds so many standard errors and g has grown by the first factor; in doubt
# if by the second.
_SURE, _GROWN, _DOUBTFUL = 3.0, 2.0, 1.5
_FEWEST, _FOLDINGS = 8, 4.0


class Outcome(Enum):
    """What the rope did."""

    STAYS = "stays"
    LEAVES = "leaves"
    UNDECIDED = "undecided"


@dataclass(frozen=True, eq=False)
class Departure:
    """A run that began on a state.

    Attributes
    ----------
    times, distance, change
        Per s periods of the drive: the middle, the rms of d, and that of g.
    rate, rate_error
        Slope of log g, and its standard error.
    left
        τ at which the rope had left; None if it had not.
    shed
        Whether it had shed a wave.
    outcome
        *leaves* if it had left, or g grows for sure and its maximum has doubled from the second
        last to the last third; *stays* if it had not and g grew by less than half; else
        *undecided*.
    """

    times: Array
    distance: Array
    change: Array
    rate: float
    rate_error: float
    left: float | None
    shed: bool
    outcome: Outcome


def rope_problem(rope: LinearRope, epsilon: float, begin: float | None = None) -> RopeProblem:
    """The rope at ε as the simulator states it; from another ε to it within five periods.

    Raises
    ------
    InputError
        A term, an end or a coefficient that the simulator has not.

    Examples
    --------
    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> problem = rope_problem(string, 0.02)
    >>> problem.beta, float(problem.drive.height(np.array(0.0)))
    (0.0, 1.02)
    """
    check_constant(rope, 3)
    epsilon = finite("epsilon", epsilon)
    first = 1.0 if begin is None or not epsilon else finite("begin", begin) / epsilon
    terms = {key: float(np.ravel(c)[0]) for key, c in rope.terms.items()}
    sign = math.copysign(1.0, terms.get((0, 2), 0.0))
    known = {(0, 2), (2, 0), (4, 0), (0, 0), (0, 1)}
    others = sorted(key for key, c in terms.items() if c and key not in known)
    if others or rope.springs or np.ndim(rope.load):
        raise InputError(
            f"the simulator has no term {others}, no springs below and no load that varies; it "
            "takes W_tautau, W_tau, W_xixi, W_xixixixi, W, a number as load and rigid ground"
        )
    mass, damping, tension, beta, foundation = (
        sign * terms.get(key, 0.0) * s
        for key, s in [((0, 2), 1), ((0, 1), 0.5), ((2, 0), -1), ((4, 0), 1), ((0, 0), 1)]
    )
    level, waves, kind = _driven(rope, beta)
    return RopeProblem(
        beta,
        fourier(rope.omega, {j: epsilon * a for j, a in waves.items()}, level, first),
        kind,
        damping,
        foundation=along("foundation", foundation),
        tension=along("tension", tension),
        mass=along("mass", mass),
        weight=along("weight", -sign * float(np.ravel(rope.load)[0])),
        ground=along("ground", [float(c) for c in reversed(rope.ground)]),
    )


def _driven(rope: LinearRope, beta: float) -> tuple[float, dict[int, complex], DrivenEnd]:
    """Mean height, harmonics per ε, and the second condition."""
    tau = 2 * np.pi / rope.omega * np.arange(_SAMPLES) / _SAMPLES
    rows: dict[Keys, tuple[Terms, float, Complex]] = {}
    for terms, level, drive in rope.ends:
        waves = np.fft.fft(np.broadcast_to(drive(tau), tau.shape)) / _SAMPLES
        rows[tuple(sorted(key for key, c in terms.items() if c))] = terms, level, waves
    height = rows.pop(((0, 0),), None)
    second: dict[Keys, DrivenEnd] = {((2, 0),): DrivenEnd.PINNED, ((1, 0),): DrivenEnd.CLAMPED}
    kinds = [second.get(key) for key in rows]
    still = all(level == 0 and abs(waves).max() == 0 for _, level, waves in rows.values())
    if height is None or None in kinds or not still or len(kinds) != (1 if beta else 0):
        raise InputError(
            "the simulator drives W at the end, with W_xixi = 0 or W_xi = 0 besides where the rope "
            "bends"
        )
    size, level, waves = float(np.ravel(height[0][0, 0])[0]), height[1], height[2]
    heard = abs(waves) > _HEARD * abs(waves).max()
    found = {
        j: complex(2 * waves[j] / size if j else waves[0] / size)
        for j in range(_SAMPLES // 2 + 1)
        if heard[j]
    }
    return level / size, found, kinds[0] or DrivenEnd.PINNED if kinds else DrivenEnd.PINNED


def started(
    state: PeriodicState,
    grid: Grid | None = None,
    epsilon: float | None = None,
    push: float = 0.0,
    dt: float | None = None,
) -> Simulator:
    """A simulator that stands on a state at τ = 0.

    Parameters
    ----------
    state
        The state.
    grid, dt
        As of :class:`~numerics.simulation.contact.Simulator`.
    epsilon
        To which the drive goes on, in five periods; by default the state's own.
    push
        Added to the velocity: ``push`` (1 − s)² sin πs of s = ξ/ξ_c.

    Raises
    ------
    InputError
        What the simulator is not for.
    """
    rope = state.modes.rope
    problem = rope_problem(rope, state.epsilon if epsilon is None else epsilon, state.epsilon)
    simulator = Simulator(problem, grid, dt)
    places, contact = simulator.system.positions, float(state.contact(0.0))
    s = np.minimum(places / contact, 1.0)
    now = simulator.state
    now.height[:] = np.maximum(state.shape(places, 0.0), 0.0)
    now.velocity[:] = state.shape(places, 0.0, rate=1)
    now.velocity[:] += finite("push", push) * (1 - s) ** 2 * np.sin(np.pi * s)
    now.active[:] = places >= contact
    end = float(problem.drive.height(np.zeros(1))[0])
    simulator.ledger[0] = simulator.system.energy(now.height, now.velocity, end)
    return simulator


def departure(
    state: PeriodicState,
    periods: int = 60,
    grid: Grid | None = None,
    epsilon: float | None = None,
    push: float = PUSH,
) -> Departure:
    """Start on a state and see whether the rope stays.

    Parameters
    ----------
    state, grid, epsilon, push
        As of :func:`started`; by default :func:`usual_grid`.
    periods
        Of the drive, at least 8.

    Raises
    ------
    InputError
        As :func:`started`; too few periods.

    Examples
    --------
    A string on an elastic foundation, far from resonance:

    >>> from numerics.periodic.states import periodic_state
    >>> end = ({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))
    >>> terms = {(0, 2): 1.0, (2, 0): -1.0, (0, 0): 3.0}
    >>> rope = LinearRope(terms, -2.0, [end], 2, 2.2, math.acosh(2.5) / math.sqrt(3))
    >>> departure(periodic_state(rope, 0.02), 20).outcome.value
    'stays'
    """
    periods, s = whole("periods", periods, _FEWEST), state.modes.subharmonic
    rope = state.modes.rope
    period = 2 * math.pi / rope.omega
    grid = usual_grid(rope) if grid is None else grid
    simulator = started(state, grid, epsilon, push)
    wave = 20 * smallest_wave(simulator.problem.beta, grid.dx)
    blocks = list(simulator.blocks((periods + 1) * period))
    times = np.concatenate([block.times for block in blocks])
    contact, bump = (
        np.nan_to_num(np.concatenate([block.rows[:, column] for block in blocks]))
        for column in (Column.CONTACT, Column.BUMP)
    )
    off = contact - state.contact(times)
    change = np.interp(times + period, times, off) - off
    windows = periods // s
    which = (times / (s * period)).astype(int)
    inside = which < windows
    distance, grown = (_rms(x[inside], which[inside]) for x in (off, change))
    waves = np.zeros(windows)
    np.maximum.at(waves, which[inside], bump[inside])
    middles = np.asarray(s * period * (np.arange(windows) + 0.5), dtype=float)
    far = _FAR * state.amplitude
    gone = np.flatnonzero((distance > far) | (waves > wave))
    left = float(middles[gone[0]]) if gone.size else None
    last = int(gone[0]) if gone.size else windows
    first = min(int(_SETTLED * windows), max(last - 4, 0))
    rate, error = _slope(middles[first:last], grown[first:last])
    outcome = Outcome.STAYS
    if rate > _SURE * error:
        third = (last - first) // 3
        # Beats of a stable state grow, too, for a while: the last third against the one before.
        before, end = grown[last - 2 * third : last - third], grown[last - third : last]
        if third and end.max() > _GROWN * before.max():
            outcome = Outcome.LEAVES
        elif rate * middles[-1] > math.log(_DOUBTFUL):
            outcome = Outcome.UNDECIDED
    if left is not None:
        outcome = Outcome.LEAVES
    shed = bool((waves > wave).any())
    return Departure(middles, distance, grown, rate, error, left, shed, outcome)


def periods_needed(multipliers: Complex, subharmonic: int = 1) -> int:
    """The drive's periods in which the fastest disturbance grows by e⁴: less, and it is missed.

    >>> periods_needed(np.array([-1.0517519 + 0j]))
    80
    """
    return math.ceil(_FOLDINGS / math.log(abs(multipliers).max()) * subharmonic)


def usual_grid(rope: LinearRope, finer: int = 1) -> Grid:
    """dx = .005, or √β/20 where that is less, divided by ``finer``.

    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> usual_grid(LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0), 2).dx
    0.0025
    """
    beta = abs(float(np.ravel(rope.terms.get((4, 0), 0.0))[0]))
    return Grid((min(0.005, math.sqrt(beta) / 20) if beta else 0.005) / finer, 5.0, 2.0)


def outcome(
    state: PeriodicState, periods: int, epsilon: float | None = None
) -> tuple[Outcome, Departure]:
    """What the rope does, if grids of the usual and of half its spacing agree; and the finer run.

    Raises
    ------
    InputError
        As :func:`departure`.
    """
    rope = state.modes.rope
    coarse, fine = (departure(state, periods, usual_grid(rope, n), epsilon) for n in (1, 2))
    same = coarse.outcome is fine.outcome
    return fine.outcome if same else Outcome.UNDECIDED, fine


def _rms(values: Array, which: NDArray[Any]) -> Array:
    """The root mean square in each window."""
    return np.sqrt(np.bincount(which, values**2) / np.bincount(which))


def _slope(times: Array, sizes: Array) -> tuple[float, float]:
    """Of log sizes, and its standard error; nan where there are fewer than three."""
    if len(times) < 3:
        return math.nan, math.nan
    fit, covariance = np.polyfit(times, np.log(np.maximum(sizes, 1e-300)), 1, cov="unscaled")
    left = np.log(np.maximum(sizes, 1e-300)) - np.polyval(fit, times)
    spread = math.sqrt(float(left @ left) / max(len(times) - 2, 1))
    return float(fit[0]), float(spread * math.sqrt(covariance[0, 0]))
