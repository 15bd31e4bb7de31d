r"""Periodic states of ropes with constant coefficients, of the drive's period or a multiple.

Newton's iteration on the equations of :mod:`numerics.periodic.modes`. How many harmonics a state
needs is read off its own spectrum: their number grows by half until the last third of ξ_c's
coefficients is below 5e-12. The error is the distance to the state on half as many harmonics again.

A state is reached from the rope at rest along its branch, in steps that pass no fold: what is found
is the wave-less state that the expansion in ε describes. Others are reached along branches
(:mod:`numerics.periodic.branches`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope, NoPeriodicStateError
from numerics.periodic.modes import Complex, Modes

FIRST, MOST = 8, 192
"""Harmonics to begin with, and to give up at."""

_STEPS = 25
# Times at which ξ_c is looked at for its extremes.
_FINE = 1024
ACCURACY = 5e-12
"""Relative size of coefficients that are left out: rounding of what m derivatives cost is near.

Far from rest it is more. The harmonics that decay along the rope are continued from ξ_c to ξ_c, and
what e^{λξ} gains on the way multiplies the rounding: 1e-9 at an amplitude of ξ_c of 0.15, β = .01.
"""
_HALVINGS = 8
# More harmonics than this and a branch that ends is believed.
_FOLDS_KNOWN = 60


@dataclass(frozen=True)
class PeriodicState:
    """A periodic state.

    Attributes
    ----------
    modes
        The equations that it solves; among them the rope and s.
    epsilon
        ε.
    unknown
        Their solution.
    residual
        What is left of W − g and its m − 1 slopes at ξ_c, the largest at any of the times.
    error
        The largest distance of ξ_c from the state on half as many harmonics again; nan where it was
        not computed.
    """

    modes: Modes
    epsilon: float
    unknown: Array
    residual: float
    error: float = math.nan

    @property
    def values(self) -> Array:
        """ξ_c at the equal times ``modes.tau``."""
        return self.unknown[-self.modes.times :]

    @cached_property
    def waves(self) -> Complex:
        """c_j of ξ_c = Re Σ_j c_j e^{−ijΩτ/s}: cosines are the real parts, sines the others."""
        found = np.conj(np.fft.rfft(self.values)) / self.modes.times
        found[1:] *= 2
        return np.asarray(found)

    def contact(self, tau: Any, derivative: int = 0) -> Array:
        """ξ_c, or a derivative of it, at any times."""
        rates = -1j * self.modes.rope.omega / self.modes.subharmonic * np.arange(self.waves.size)
        turning = np.exp(np.asarray(tau, dtype=float)[..., None] * rates)
        return np.asarray((turning @ (rates**derivative * self.waves)).real)

    def shape(self, xi: Any, tau: Any, derivative: int = 0, rate: int = 0) -> Array:
        """∂_ξ^d ∂_τ^rate (W − g) at places and times; zero on the ground."""
        x, t = np.broadcast_arrays(np.asarray(xi, dtype=float), np.asarray(tau, dtype=float))
        lifted = x < self.contact(t)
        found = np.zeros(x.shape)
        found[lifted] = self.modes.shape(
            self.unknown, self.epsilon, x[lifted], t[lifted], derivative, rate
        )
        return found

    @cached_property
    def amplitude(self) -> float:
        """Half of what ξ_c goes to and fro, on a thousand times of a period."""
        # Backwards in time and with another mean: neither matters here.
        found = np.fft.irfft(self.waves, n=_FINE) * _FINE / 2
        return float(np.ptp(found)) / 2

    @property
    def even(self) -> bool:
        """Whether ξ_c is a series of cosines."""
        return bool(abs(self.waves.imag).max() <= 1e-10 * abs(self.waves).max())

    def clearance(self, places: int = 60, times: int | None = None) -> float:
        """The least of (W − g)/(1 − ξ/ξ_c)^m over places and times, part of what it is at rest.

        ``times`` of a period; by default four for each of the state's. Not positive where the rope
        would be in the ground: then this is no state of the rope.
        """
        modes, m = self.modes, self.modes.rope.contacts
        s = (np.arange(places) + 0.5) / places
        count = 4 * modes.times if times is None else times
        tau = np.linspace(0, modes.tau[-1] + modes.tau[1], count, endpoint=False)
        contact = self.contact(tau)

        def quotient(ends: Array, at: Array, unknown: Array, epsilon: float) -> Array:
            x, t = (ends[:, None] * s).ravel(), np.repeat(at, places)
            lifted = modes.shape(unknown, epsilon, x, t).reshape(-1, places)
            # Between its own times a state meets the contact conditions to its accuracy only, which
            # (1 − s)^m would magnify: its own Taylor polynomial at the end is taken off.
            for e in range(m):
                left = modes.shape(unknown, epsilon, ends, at, e)
                lifted -= (left * (-ends) ** e)[:, None] * (1 - s) ** e / math.factorial(e)
            last = modes.shape(unknown, epsilon, ends, at, m) * (-ends) ** m / math.factorial(m)
            return np.column_stack([lifted / (1 - s) ** m, last])

        rest = np.full(modes.times, modes.rope.rest)
        still = quotient(rest[:1], np.zeros(1), modes.start(rest, 0.0), 0.0)[0]
        return float((quotient(contact, tau, self.unknown, self.epsilon) / still).min())


def solve(modes: Modes, unknown: Array, epsilon: float) -> PeriodicState | None:
    """Newton's iteration; None where it does not settle."""
    rest = modes.rope.rest
    before = np.inf
    with np.errstate(all="ignore"):
        for _ in range(_STEPS):
            left, matrix, _ = modes.equations(unknown, epsilon)
            try:
                step = np.linalg.solve(matrix, -left)
            except np.linalg.LinAlgError:
                return None
            size = float(abs(step[-modes.times :]).max())
            if not size < rest:
                return None
            unknown = unknown + step
            # Steps that no longer shrink are rounding, where they are small.
            if size < 1e-13 * rest or (size >= before / 2 and size < 1e-8 * rest):
                left, _, _ = modes.equations(unknown, epsilon)
                return PeriodicState(modes, epsilon, unknown, float(abs(left).max()))
            before = size
    return None


def _next_to(modes: Modes, contact: Array, epsilon: float) -> PeriodicState | None:
    """The state that Newton's iteration finds from a contact point, if any."""
    try:
        return solve(modes, modes.start(contact, epsilon), epsilon)
    except np.linalg.LinAlgError:
        return None


def refined(state: PeriodicState) -> PeriodicState | None:
    """The same state on half as many harmonics again, if Newton's iteration finds it."""
    coarse = state.modes
    modes = Modes(coarse.rope, 3 * (coarse.times // 2) // 2 * 2 + 1, coarse.subharmonic)
    return _next_to(modes, state.contact(modes.tau), state.epsilon)


def periodic_contact(rope: LinearRope, epsilon: float, times: int) -> Array:
    """ξ_c of the periodic state at ``times`` equal times of a period, from τ = 0.

    Parameters
    ----------
    epsilon
        ε.
    times
        Odd; harmonics up to (times − 1)/2 are resolved.

    Raises
    ------
    InputError
        A coefficient that varies, a wrong number of conditions, or an even number of times.
    NoPeriodicStateError
        The iteration does not settle: ε beyond the state's end.

    Examples
    --------
    The string at rest, W = (1 − ξ)², and moved by ξ₁ = Ω/(2 sin Ω) cos Ωτ:

    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> moved = periodic_contact(string, 1e-3, 9)
    >>> round(float(moved[0] - 1) / 1e-3, 2), round(1.1 / np.sin(2.2), 2)
    (1.36, np.float64(1.36))
    """
    modes = Modes(rope, times)
    # So few times may have folds of their own: first straight from rest.
    found = _next_to(modes, np.full(times, rope.rest), epsilon)
    return (found or _from_rest(modes, epsilon)).values


def _on(
    rope: LinearRope, epsilon: float, times: int, subharmonic: int, near: PeriodicState | None
) -> PeriodicState:
    """The state on so many times: next to a known one, or the wave-less one."""
    try:
        modes = Modes(rope, times, subharmonic)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"Omega = {rope.omega!r}: the exponents of its harmonics are beyond doubles"
        ) from error
    if near is not None:
        contact = near.contact(modes.tau)
        found = _next_to(modes, contact, epsilon)
        # A tail that was missing is small; farther away is another state.
        if found is not None and abs(found.values - contact).max() <= 0.1 * np.ptp(contact):
            return found
    return _from_rest(modes, epsilon)


def _from_rest(modes: Modes, epsilon: float) -> PeriodicState:
    """Along the tangent of the branch that begins at rest, in steps that keep to it.

    A step is kept when the correction is small beside it and no fold or branch point was passed:
    the determinant of the equations keeps its sign.
    """
    found = _next_to(modes, np.full(modes.times, modes.rope.rest), 0.0)
    if found is None:
        raise NoPeriodicStateError(
            f"no state of rest next to xi_0 = {modes.rope.rest:.6g} at Omega = "
            f"{modes.rope.omega!r}; where a harmonic resonates move Omega"
        )
    tangent, side = _tangent(modes, found)
    step = epsilon
    while found.epsilon != epsilon:
        last = abs(epsilon - found.epsilon) <= abs(step) * (1 + 1e-9)
        target = epsilon if last else found.epsilon + step
        step = target - found.epsilon
        moved = step * tangent
        ended = solve(modes, found.unknown + moved, target)
        if ended is not None and _near(modes, ended, found, moved):
            ahead, new_side = _tangent(modes, ended)
            if new_side == side:
                found, tangent, step = ended, ahead, 2 * step
                continue
        step /= 2
        if abs(step) < abs(epsilon) / 2**_HALVINGS:
            raise NoPeriodicStateError(
                f"no wave-less state found at epsilon = {epsilon!r}, Omega = "
                f"{modes.rope.omega!r} on {modes.times} times: followed from rest it ends between "
                f"{found.epsilon:.6g} and {target:.6g}. Give a smaller epsilon"
            )
    return found


def _tangent(modes: Modes, state: PeriodicState) -> tuple[Array, float]:
    """Of its branch, per ε, and the sign of the determinant of the equations."""
    _, matrix, rate = modes.equations(state.unknown, state.epsilon)
    try:
        tangent = np.linalg.solve(matrix, -rate)
    except np.linalg.LinAlgError as error:
        raise NoPeriodicStateError(
            f"the equations at epsilon = {state.epsilon!r}, Omega = {modes.rope.omega!r} on "
            f"{modes.times} times are singular: a harmonic resonates; move Omega"
        ) from error
    return np.asarray(tangent, dtype=float), float(np.linalg.slogdet(matrix)[0])


def _near(modes: Modes, ended: PeriodicState, found: PeriodicState, moved: Array) -> bool:
    """Whether the correction of a step is small beside the step, in ξ_c."""
    ahead = moved[-modes.times :]
    correction = ended.values - found.values - ahead
    return bool(abs(correction).max() <= 0.5 * abs(ahead).max())


def periodic_state(
    rope: LinearRope,
    epsilon: float,
    subharmonic: int = 1,
    near: PeriodicState | None = None,
    accuracy: float = ACCURACY,
) -> PeriodicState:
    """The periodic state at ε, with the harmonics it needs and an estimate of its error.

    Parameters
    ----------
    rope
        With constant coefficients; Ω is its own.
    epsilon
        ε, of either sign.
    subharmonic
        s: the period is s that of the drive, with ``near``; without, the state has the drive's
        period whatever s is.
    near
        A state to begin from, in the place of rest.
    accuracy
        Relative size of the harmonics of ξ_c that are left out.

    Raises
    ------
    InputError
        What modes are not for; ε or s out of range.
    NoPeriodicStateError
        There is none that the iteration finds, or none that :data:`MOST` harmonics resolve.

    Examples
    --------
    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> state = periodic_state(string, 0.02)
    >>> state.even, state.error < 1e-12, state.clearance() > 0.5
    (True, True, True)
    """
    if not math.isfinite(epsilon):
        raise InputError(f"epsilon = {epsilon!r}; the drive's amplitude must be finite")
    if subharmonic not in range(1, 9):
        raise InputError(f"subharmonic = {subharmonic!r}; give a whole number from 1 to 8")
    harmonics = FIRST * subharmonic
    if near is not None:
        harmonics = max(harmonics, resolved(near, accuracy))
    while True:
        try:
            state = _on(rope, epsilon, 2 * harmonics + 1, subharmonic, near)
        except NoPeriodicStateError:
            # Too few harmonics have folds of their own.
            if harmonics > _FOLDS_KNOWN * subharmonic:
                raise
        else:
            if resolved(state, accuracy) <= 2 * harmonics // 3:
                break
            near = state
        harmonics += (harmonics + 1) // 2
        if harmonics > MOST:
            raise NoPeriodicStateError(
                f"the state at epsilon = {epsilon!r}, Omega = {rope.omega!r} is not resolved by "
                f"{MOST} harmonics; give a smaller epsilon"
            )
    finer = _on(rope, epsilon, 3 * harmonics + 1 + harmonics % 2, subharmonic, state)
    error = float(abs(state.contact(finer.modes.tau) - finer.values).max())
    return replace(state, error=max(error, state.residual))


def resolved(state: PeriodicState, accuracy: float = ACCURACY) -> int:
    """The last harmonic of ξ_c that counts."""
    size = abs(state.waves)
    heard = np.flatnonzero(size > accuracy * size.max())
    return int(heard[-1])


def decay(state: PeriodicState, accuracy: float = ACCURACY) -> float:
    """The rate at which the harmonics of ξ_c decay, |c_j| ~ e^{−rate j}: over its last half.

    A state that loses its regularity has ever less of it: 0 is a ξ_c that is not smooth.
    """
    size, last = abs(state.waves), resolved(state, accuracy)
    # From the top, so that gaps in the spectrum do not count.
    envelope = np.maximum.accumulate(size[last::-1])[::-1]
    first = last // 2
    return float(math.log(envelope[first] / envelope[last]) / max(last - first, 1))
