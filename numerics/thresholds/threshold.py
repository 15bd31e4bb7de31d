r"""ε_c(Ω, β): where a ramped run loses the wave-less state, as an interval.

ε_c is bracketed by a scan from below, for the loss is not monotone in ε, and bisection. Everything
that the answer depends on and should not, dx, dt, ramp, hold, the height that counts as a wave and
the integrator (:mod:`numerics.thresholds.ramped_run`), is then changed one at a time, and the
interval covers all of these brackets.

It bounds the loss in *ramped runs of finite length*, with the ramps and holds that were tried, and
not the quasi-static loss: near a resonance a state that has ended is left slowly, over many
periods, and a short hold does not see it; a ramp excites beats, which lose it too early. At Ω =
3.15, β = 0.01 the state ends at a fold at ε = 0.0049, and the interval, from ramps of 20 to 80
periods, is [0.0031, 0.0044]. Nor is the loss monotone in the ramp: at Ω = 2.7 it is lost at 0.131,
0.120, 0.134 (dx = 0.02) after ramps of 20, 40, 80 periods. Ramps shorter than the base's are not
tried; they lose it earlier.

For β = 0 no grid is needed: the brackets are those of the exact string,
:mod:`numerics.thresholds.string`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from numerics.errors import InputError, ThresholdNotFoundError
from numerics.problems.drive import Array, Drive, check_amplitude, frequency, positive
from numerics.problems.problem import check_stiffness
from numerics.problems.pulses import pulse_length
from numerics.simulation.contact import Scheme
from numerics.thresholds.kinds import Change, Mechanism, mechanism
from numerics.thresholds.ramped_run import (
    Outcome,
    Settings,
    Watching,
    base_settings,
    run_once,
    watch_ramp,
)
from numerics.thresholds.string import StringBracket, string_brackets

LOWEST, HIGHEST = 1e-4, 0.9
"""The amplitudes between which the loss is looked for."""

START, STEP = 1.5, 1.1
"""How far below a guess the scan begins, and the ratio of its amplitudes."""

NARROWEST = 1e-9
"""The smallest relative width of a bracket that bisection is asked for."""

AGREEING = 2 / 3
"""The part of the runs that must show one mechanism for it to be that of the threshold."""


@dataclass(frozen=True)
class Bracket:
    """ε_c under one set of settings: ``stayed`` at lower, ``lost`` at upper.

    Attributes
    ----------
    change, settings
        Which.
    lower, upper
        The largest amplitude below the first loss that stayed, and the smallest that did not.
    mechanism
        Of the lost run.
    stayed, lost
        The two runs. Where ``stayed.growth`` exceeds 1 the hold was too short to tell.
    count
        How many runs it took.
    """

    change: Change
    settings: Settings
    lower: float
    upper: float
    mechanism: Mechanism
    stayed: Outcome
    lost: Outcome
    count: int


@dataclass(frozen=True)
class Threshold:
    """ε_c as an interval.

    Attributes
    ----------
    omega, beta
        Ω and β.
    lower, upper
        The smallest ``lower`` and the largest ``upper`` of all runs.
    mechanism
        What two thirds of the runs show; UNDECIDED if there is no such agreement.
    runs
        The brackets, the base first; for β = 0 those of the exact string.
    """

    omega: float
    beta: float
    lower: float
    upper: float
    mechanism: Mechanism
    runs: tuple[Bracket, ...] | tuple[StringBracket, ...]


def bracket(
    omega: float,
    beta: float,
    settings: Settings,
    change: Change = Change.BASE,
    relative: float = 0.01,
    near: float | None = None,
    watching: Watching | None = None,
) -> Bracket:
    """The first loss from below, to the relative width given.

    The scan starts at ⅔ of ``near``, or lower while that is lost, and goes up by 10 % a run; a loss
    below its start, or between two of its runs that both stay, is not seen. Without ``near``
    it is where a run is lost whose amplitude doubles every 8 periods. ``watching`` is told of every
    run, see :data:`~numerics.thresholds.ramped_run.Watching`.

    Raises
    ------
    InputError
        A parameter outside its range.
    ThresholdNotFoundError
        Lost at the smallest amplitude that is tried, or not at the largest.

    Examples
    --------
    >>> coarse = Settings(dx=0.025, height=1e-3, ramp=5, hold=2)
    >>> found = bracket(2.9, 0.01, coarse, relative=0.05)
    >>> found.lower < found.upper <= 1.05 * found.lower * (1 + 1e-12)
    True
    """
    omega, relative = frequency(omega), positive("relative", relative)
    if not NARROWEST <= relative <= 1:
        raise InputError(f"relative = {relative!r}: give a width from {NARROWEST} to 1")
    guess = _sweep(omega, beta, settings, watching) if near is None else positive("near", near)
    epsilon = min(max(guess / START, LOWEST), HIGHEST)
    stayed, lost, count = None, None, 0
    while stayed is None or lost is None:
        _check_range(omega, beta, epsilon)
        outcome = run_once(omega, epsilon, beta, settings, watching)
        count += 1
        if outcome.stayed:
            stayed, epsilon = outcome, _next(epsilon, STEP)
        elif stayed is None:
            epsilon = _next(epsilon, 1 / START)
        else:
            lost = outcome
    while lost.epsilon > stayed.epsilon * (1 + relative):
        middle = math.sqrt(stayed.epsilon * lost.epsilon)
        outcome = run_once(omega, middle, beta, settings, watching)
        count += 1
        stayed, lost = (outcome, lost) if outcome.stayed else (stayed, outcome)
    how = mechanism(lost, pulse_length(beta, settings.height, settings.dx))
    return Bracket(change, settings, stayed.epsilon, lost.epsilon, how, stayed, lost, count)


def threshold(
    omega: float,
    beta: float,
    base: Settings | None = None,
    quick: bool = False,
    relative: float = 0.01,
    near: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    watching: Watching | None = None,
) -> Threshold:
    """ε_c(Ω, β) as the interval that covers all settings, or with ``quick`` the base alone.

    Parameters
    ----------
    omega, beta
        Ω > 0 and 0 ≤ β ≤ 1.
    base
        By default :func:`~numerics.thresholds.ramped_run.base_settings`; for β = 0 only ramp and
        hold matter.
    quick
        Only the base settings: a bracket, which says nothing about its error.
    relative
        Width of each bracket.
    near
        A guess, e.g. the threshold at a neighbouring Ω.
    progress
        Called with the brackets done and their total.
    watching
        Called within every run with its amplitude and the part of it that is done.

    Raises
    ------
    InputError, ThresholdNotFoundError
        As :func:`bracket`.

    Examples
    --------
    >>> coarse = Settings(dx=0.025, height=1e-3, ramp=5, hold=2)
    >>> found = threshold(2.9, 0.01, coarse, quick=True, relative=0.05)
    >>> len(found.runs), found.lower == found.runs[0].lower
    (1, True)
    """
    omega, beta = frequency(omega), check_stiffness(beta)
    base = base_settings(beta) if base is None else base
    runs: tuple[Bracket, ...] | tuple[StringBracket, ...]
    if beta == 0:
        runs = string_brackets(omega, base.ramp, base.hold, quick, relative, progress)
    else:
        runs = _brackets(omega, beta, base, quick, relative, near, progress, watching)
    seen = [run.mechanism for run in runs]
    most = max(Mechanism, key=seen.count)
    return Threshold(
        omega,
        beta,
        min(run.lower for run in runs),
        max(run.upper for run in runs),
        most if seen.count(most) >= AGREEING * len(seen) else Mechanism.UNDECIDED,
        runs,
    )


def _brackets(
    omega: float,
    beta: float,
    base: Settings,
    quick: bool,
    relative: float,
    near: float | None,
    progress: Callable[[int, int], None] | None,
    watching: Watching | None,
) -> tuple[Bracket, ...]:
    cases = {Change.BASE: base} if quick else variations(base)
    runs: list[Bracket] = []
    for change, settings in cases.items():
        guess = runs[0].upper if runs else near
        runs.append(bracket(omega, beta, settings, change, relative, guess, watching))
        if progress is not None:
            progress(len(runs), len(cases))
    return tuple(runs)


def variations(base: Settings) -> dict[Change, Settings]:
    """The base settings and those that differ from them in one thing.

    A dt that is given goes with that thing: on dx/2 it is quartered, for the limit of the explicit
    scheme falls like dx², and the other integrator takes its default.

    Examples
    --------
    >>> [change.value for change in variations(base_settings(0.01))]
    ['base', 'dx/2', 'dt/2', 'ramp × 2', 'ramp × 4', 'hold × 4', 'height × 10', 'other integrator']
    """
    implicit = base.scheme is Scheme.TRAPEZOIDAL
    other = Scheme.VERLET if implicit else Scheme.TRAPEZOIDAL
    return {
        Change.BASE: base,
        Change.GRID: replace(base, dx=base.dx / 2, dt=None if base.dt is None else base.dt / 4),
        Change.STEP: replace(base, refine=2 * base.refine),
        Change.RAMP_TWICE: replace(base, ramp=2 * base.ramp),
        Change.RAMP: replace(base, ramp=4 * base.ramp),
        Change.HOLD: replace(base, hold=4 * base.hold),
        Change.HEIGHT: replace(base, height=10 * base.height),
        Change.SCHEME: replace(base, scheme=other, dt=None),
    }


def _sweep(omega: float, beta: float, settings: Settings, watching: Watching | None) -> float:
    """Where a run is lost whose amplitude, LOWEST (cosh gτ − 1), doubles every 8 periods."""
    omega, highest = check_amplitude(omega, HIGHEST)
    rate = math.log(2) / 8 * omega / (2 * math.pi)

    def amplitude(t: Array) -> Array:
        return np.asarray(LOWEST * (np.cosh(rate * t) - 1))

    drive = Drive(
        lambda t: 1 + amplitude(t) * np.cos(omega * t),
        lambda t: (
            LOWEST * rate * np.sinh(rate * t) * np.cos(omega * t)
            - omega * amplitude(t) * np.sin(omega * t)
        ),
        f"sweep {omega!r}",
        omega,
    )
    until = math.acosh(1 + highest / LOWEST) / rate
    lost = watch_ramp(drive, highest, amplitude, beta, settings, until, watching)
    return max(float(amplitude(np.array(lost.periods * drive.period))), 2 * LOWEST)


def _next(epsilon: float, factor: float) -> float:
    """The scan's next amplitude: it leaves the range only from one of its two ends."""
    if epsilon in (LOWEST, HIGHEST):
        return epsilon * factor
    return min(max(epsilon * factor, LOWEST), HIGHEST)


def _check_range(omega: float, beta: float, epsilon: float) -> None:
    if epsilon > HIGHEST:
        raise ThresholdNotFoundError(
            f"Omega = {omega!r}, beta = {beta!r}: no wave left up to epsilon = {HIGHEST}; hold "
            "longer, or take a higher Omega"
        )
    if epsilon < LOWEST:
        raise ThresholdNotFoundError(
            f"Omega = {omega!r}, beta = {beta!r}: a wave leaves even at epsilon = {LOWEST}; ramp "
            "longer, or let only higher waves count"
        )
