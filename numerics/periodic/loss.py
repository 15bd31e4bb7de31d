r"""Where the wave-less state is lost as ε is raised at fixed Ω, and by what.

The branch from rest is followed in ε (:mod:`numerics.periodic.branches`). What comes first is the
loss:

* a *fold*: there is no state beyond;
* a *period doubling*: a multiplier passes −1, waves of twice the period grow;
* another *instability*: a pair of multipliers leaves the unit circle elsewhere (two free modes
  whose frequencies add up to a multiple of Ω), by two numbers of modes;
* an interior *graze*: the lifted part comes down to the ground before ξ_c;
* *not resolved*: the state needs more harmonics than there are, or is lost in the rounding of the
  highest; that is a lower bound only. How fast the harmonics still decay tells whether the state is
  losing its regularity there.

An unstable state still exists: what ends the branch is told, too. Everything is done on two numbers
of harmonics, and the interval covers both. Multipliers are looked at whenever ε has grown by 15 %:
a narrower window of instability is not seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from numerics.errors import InputError
from numerics.periodic.branches import BranchPoint, Ropes, check_graze, follow
from numerics.periodic.linear_rope import NoPeriodicStateError
from numerics.periodic.stability import TOLERANCE, multipliers, stability
from numerics.periodic.states import PeriodicState, decay, periodic_state, refined, resolved

_FIRST, _LEAST = 1e-3, 1e-9
"""The first ε, part of the largest; and below which no state is sought."""
FEW_MODES = 10
"""Of the multipliers that are looked at first."""
ACCURACY = 1e-8
"""Harmonics that are left out, relative: what rounding leaves where the state is large."""
_STEPS, _LONGEST = 400, 60.0
# Relative width to which instabilities and grazes are bracketed.
_WIDTH = 1e-3
# Multipliers of later points are not computed closer together than this, part of ε.
_APART = 0.03
# And not farther apart than this: windows of instability that are narrower may be missed.
_GAP = 0.15


class Mechanism(Enum):
    """How the state is lost."""

    FOLD = "fold"
    DOUBLING = "period doubling"
    INSTABILITY = "other instability"
    GRAZE = "interior graze"
    UNRESOLVED = "not resolved"
    NONE = "none"


@dataclass(frozen=True)
class Loss:
    """Where one state is lost.

    Attributes
    ----------
    omega
        Ω.
    lower, upper
        ε at which the state is there and stable, and at which it is not; upper is None where only
        a lower bound is known.
    mechanism
        What happens between.
    harmonic
        Of a fold (of Ω) or a period doubling (of Ω/2): the dominant one of what happens; else None.
        A high one is resonant itself, and the gap in the branch is the narrower the higher it is.
    beyond, growth
        ε of the first point beyond that was looked at, and the rate of the fastest disturbance
        there; None where there is no state.
    harmonics, decay
        Of Ω that the state needs there, and the rate at which they decay.
    amplitude
        Half the way of ξ_c at ``lower``.
    end, end_mechanism
        What ends the branch itself, at which ε.
    """

    omega: float
    lower: float
    upper: float | None
    mechanism: Mechanism
    harmonic: int | None
    beyond: float | None
    growth: float | None
    harmonics: int
    decay: float
    amplitude: float
    end: float
    end_mechanism: Mechanism


def loss(ropes: Ropes, omega: float, highest: float = 0.5) -> Loss:
    """The loss of the wave-less state at Ω.

    Parameters
    ----------
    ropes
        The rope by Ω.
    omega
        Ω.
    highest
        ε up to which the state is followed.

    Raises
    ------
    InputError
        A largest ε that is not positive; a rope that modes or multipliers are not for.
    NoPeriodicStateError
        No state at the smallest ε: Ω is a resonance.

    Examples
    --------
    A string on an elastic foundation, next to its first free frequency:

    >>> import numpy as np
    >>> def rope(omega):
    ...     end = ({(0, 0): 1.0}, 1.0, lambda tau: np.cos(omega * tau))
    ...     terms = {(0, 2): 1.0, (2, 0): -1.0, (0, 0): 3.0}
    ...     return LinearRope(terms, -2.0, [end], 2, omega, math.acosh(2.5) / math.sqrt(3))
    >>> from numerics.periodic.linear_rope import LinearRope
    >>> found = loss(rope, 3.885)
    >>> found.mechanism.value, 2.2e-5 < found.lower < 2.3e-5
    ('fold', True)
    """
    if not (math.isfinite(highest) and highest > 0):
        raise InputError(f"highest = {highest!r}; give a positive amplitude")
    walk = _Walk(ropes, omega, highest)
    walk.go()
    return walk.result()


class _Walk:
    """Along the branch from rest."""

    def __init__(self, ropes: Ropes, omega: float, highest: float) -> None:
        self.ropes, self.omega, self.highest = ropes, omega, highest
        self.rope = ropes(omega)
        self.last: BranchPoint | None = None
        self.judged = 0.0
        self.doubling: BranchPoint | None = None
        self.found: tuple[float, float | None, Mechanism, float | None] | None = None
        self.at_loss: PeriodicState | None = None
        self.harmonic: int | None = None
        self.end: tuple[float, Mechanism] = (highest, Mechanism.NONE)

    def _start(self) -> PeriodicState:
        epsilon = _FIRST * self.highest
        while True:
            try:
                return periodic_state(self.rope, epsilon)
            except NoPeriodicStateError:
                epsilon /= 10
                if epsilon < _LEAST * self.highest:
                    raise

    def go(self) -> None:
        """Until the branch ends."""
        start = self._start()
        step = min(start.epsilon, self.highest - start.epsilon)
        limits = (0.0, self.highest)
        try:
            for point in follow(
                self.ropes,
                start,
                "epsilon",
                step,
                limits,
                _STEPS,
                longest=_LONGEST,
                accuracy=ACCURACY,
            ):
                if self._seen(point):
                    return
        except NoPeriodicStateError:
            assert self.last is not None
            self.end = self.last.epsilon, Mechanism.UNRESOLVED
            if self.found is None:
                self._lost(self.last.epsilon, None, Mechanism.UNRESOLVED, None, self.last.state)

    def _seen(self, point: BranchPoint) -> bool:
        """Whether the branch ends here."""
        if point.kind == "fold":
            low, high = self._twice(point)
            self.end = low, Mechanism.FOLD
            if self.found is None:
                self._lost(low, high, Mechanism.FOLD, None, point.state)
                self.harmonic = point.harmonic
            return True
        if point.kind == "graze":
            low, high = self._graze(point)
            self.end = low, Mechanism.GRAZE
            if self.found is None:
                self._lost(low, high, Mechanism.GRAZE, None, point.state)
            return True
        if point.kind == "period doubling":
            self.doubling = point
        elif point.kind is None:
            self._judge(point)
            self.last = point
        return False

    def _lost(
        self,
        low: float,
        high: float | None,
        mechanism: Mechanism,
        growth: float | None,
        state: PeriodicState,
    ) -> None:
        self.found, self.at_loss = (low, high, mechanism, growth), state

    def _judge(self, point: BranchPoint) -> None:
        """Multipliers at a point, and on the way to it, where no loss was found before."""
        if self.found is not None:
            return
        if self.last is not None and point.epsilon < self.judged * (1 + _APART):
            return
        between = []
        if self.last is not None and point.epsilon > self.last.epsilon:
            count = math.ceil(math.log(point.epsilon / self.judged) / math.log(1 + _GAP))
            ratio = point.epsilon / self.judged
            between = [self.judged * ratio ** (k / count) for k in range(1, count)]
        for epsilon in between:
            try:
                state = periodic_state(self.rope, epsilon, accuracy=ACCURACY)
            except NoPeriodicStateError:
                continue
            if self._unstable(state):
                return
            self.judged = epsilon
        if not self._unstable(point.state):
            self.judged = point.epsilon

    def _unstable(self, state: PeriodicState) -> bool:
        """Whether a state is, for sure; then the loss is located."""
        if abs(multipliers(state, FEW_MODES)).max() <= 1 + TOLERANCE:
            return False
        verdict = stability(state)
        if verdict.verdict != "unstable":
            return False
        worst = verdict.multipliers[0]
        # −1 is passed along the real axis, and the path there may be short.
        doubled = worst.real < 0 and abs(worst.imag) <= 1e-6 * abs(worst)
        mechanism = Mechanism.DOUBLING if doubled else Mechanism.INSTABILITY
        low, high = self._onset(state.epsilon)
        if doubled and self.doubling is not None:
            near, far = self._twice(self.doubling)
            if low * (1 - _WIDTH) <= near and far <= high * (1 + _WIDTH):
                low, high, self.harmonic = near, far, self.doubling.harmonic
        self._lost(low, high, mechanism, verdict.growth, state)
        return True

    def _onset(self, above: float) -> tuple[float, float]:
        """Between the last stable ε and an unstable one, by bisection."""

        def unstable(epsilon: float) -> bool:
            state = periodic_state(self.rope, epsilon, accuracy=ACCURACY)
            return bool(abs(multipliers(state, FEW_MODES)).max() > 1 + TOLERANCE)

        return _bisected(unstable, self.judged, above)

    def _graze(self, point: BranchPoint) -> tuple[float, float]:
        """Where the clearance ends, and that the state above is in the ground however resolved."""

        def below(epsilon: float) -> bool:
            return periodic_state(self.rope, epsilon, accuracy=ACCURACY).clearance() <= 0

        first = 0.0 if self.last is None else self.last.epsilon
        low, high = _bisected(below, first, point.epsilon)
        check_graze(periodic_state(self.rope, high, accuracy=ACCURACY), True)
        return low, high

    def _twice(self, point: BranchPoint) -> tuple[float, float]:
        """A located point's ε, and the same on half as many harmonics again; in order."""
        here = point.epsilon
        last = self.last
        if last is None:
            return here, here
        found = refined(last.state)
        if found is None:
            return here, here
        step = max((here - last.epsilon) / 4, 1e-6 * here)
        try:
            for other in follow(
                self.ropes, found, "epsilon", step, (0.0, self.highest), 60, accuracy=ACCURACY
            ):
                if other.kind == point.kind:
                    near, apart = other.epsilon, abs(other.epsilon - here)
                    return min(near, here) - apart, max(near, here) + apart
        except NoPeriodicStateError:
            pass
        return last.epsilon, here + (here - last.epsilon)

    def result(self) -> Loss:
        """What was found."""
        if self.found is None:
            assert self.last is not None
            self._lost(self.last.epsilon, None, Mechanism.NONE, None, self.last.state)
        assert self.found is not None
        assert self.at_loss is not None
        low, high, mechanism, growth = self.found
        state = self.at_loss
        return Loss(
            self.omega,
            low,
            high,
            mechanism,
            self.harmonic,
            None if growth is None else state.epsilon,
            growth,
            resolved(state, ACCURACY),
            decay(state, ACCURACY),
            state.amplitude,
            *self.end,
        )


def _bisected(bad: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """ε between good and bad, to a relative width."""
    while high - low > _WIDTH * high:
        middle = (low + high) / 2
        try:
            worse = bad(middle)
        except NoPeriodicStateError:
            break
        low, high = (low, middle) if worse else (middle, high)
    return low, high
