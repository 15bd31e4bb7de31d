r"""Branches of periodic states in ε or Ω: pseudo-arclength continuation and its tests.

With z = (u, λ), u the unknowns of :mod:`numerics.periodic.modes` and λ either ε or Ω, a branch is a
curve F(z) = 0. A step goes along its tangent and corrects at right angles to it, in a metric that
sees ξ_c and λ only, each in units of the first step. It passes folds. Between two points the signs
of three numbers are compared:

* λ′ along the branch: a *fold*, where two states of one λ meet;
* the determinant of F's matrix bordered by the tangent: something *crosses*;
* that of the matrix for disturbances of twice the period: a *period doubling*, a multiplier −1;
  up to 96 harmonics, beyond which the test takes longer than all else.

In the last two, harmonics that the state does not need are eliminated first (a Schur complement):
the equations of the highest ones say more of the number of times than of the rope. A change is
located by bisection along the arc, and the dominant harmonic of the null vector is told. A low one
is another branch. A high one resonates with a free frequency: without damping that is a gap in the
branch, and narrower than the step where the branch has jumped it.

Two changes within one step are not seen: what a step cannot resolve is a loop shorter than it, and
the steps are part of the answer. A state that would be in the ground has ended before (a *graze*).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope, NoPeriodicStateError
from numerics.periodic.modes import Modes
from numerics.periodic.states import (
    ACCURACY,
    MOST,
    PeriodicState,
    periodic_state,
    refined,
    resolved,
)

Indices = NDArray[Any]
Ropes = Callable[[float], LinearRope]
"""Ω ↦ the rope driven at it."""

FREE = ("epsilon", "omega")

_ITERATIONS = 8
_GROWN, _SHRUNK, _SHORTEST = 1.5, 0.5, 2.0**-10
# Changes of a step that ends on a state that is not resolved.
_DODGES = (0.8, 0.7, 0.6, 0.5, 8.0)
# Cosine of the largest turn of the tangent within a step.
_STRAIGHT = 0.9
_TOLD = 1e-12
# Of a step: how narrowly a change of sign is bracketed.
_LOCATED = 2.0**-20
# Places and times at which a state is looked at for being in the ground.
_LOOK = (40, 96)
# Harmonics up to which period doublings are looked for.
_DOUBLED = 96
# Longest step where only the branch's own turns are to limit it.
_FREE = 1e6
# Of Ω, for the difference quotient by Ω: its error is the square of it.
_DIFFERENCE = 1e-5


@dataclass(frozen=True)
class BranchPoint:
    """A point of a branch.

    Attributes
    ----------
    state
        The periodic state.
    kind
        None, or what was located here: ``fold``, ``crossing``, ``period doubling``, ``graze``.
    arclength
        From the first point, in units of the first step.
    width
        Of a located one, in the same units: how far apart the two sides of it are at last.
    harmonic
        Of Ω/s (at a period doubling of Ω/2s), the dominant one in ξ_c of the null vector of what
        was located; else None. A fold of a high one is a gap that its resonance leaves.
    tangent
        Along the branch: of the unknowns, then of λ.
    """

    state: PeriodicState
    kind: str | None
    arclength: float
    tangent: Array = field(repr=False)
    width: float = 0.0
    harmonic: int | None = None

    @property
    def epsilon(self) -> float:
        """ε."""
        return self.state.epsilon

    @property
    def omega(self) -> float:
        """Ω."""
        return self.state.modes.rope.omega

    @property
    def amplitude(self) -> float:
        """Half of what ξ_c goes to and fro."""
        return self.state.amplitude


@dataclass(frozen=True)
class _Curve:
    """F(u, λ) = 0 on one number of times, and the metric of arclength."""

    ropes: Ropes
    free: str
    modes: Modes
    epsilon: float
    units: tuple[float, float]

    def at(self, value: float) -> tuple[Modes, float]:
        """The equations and ε at λ."""
        if self.free == "epsilon":
            return self.modes, value
        if value == self.modes.rope.omega:
            return self.modes, self.epsilon
        like = self.modes
        return Modes(self.ropes(value), like.times, like.subharmonic, like), self.epsilon

    def equations(self, z: Array) -> tuple[Array, Array]:
        """F, and its derivatives by u and, the last column, by λ."""
        modes, epsilon = self.at(z[-1])
        left, matrix, by_epsilon = modes.equations(z[:-1], epsilon)
        if self.free == "epsilon":
            return left, np.column_stack([matrix, by_epsilon])
        step = _DIFFERENCE * z[-1]
        up, down = (self.at(z[-1] + d * step)[0].equations(z[:-1], epsilon)[0] for d in (1, -1))
        return left, np.column_stack([matrix, (up - down) / (2 * step)])

    def state(self, z: Array) -> PeriodicState:
        modes, epsilon = self.at(z[-1])
        left, _, _ = modes.equations(z[:-1], epsilon)
        return PeriodicState(modes, float(epsilon), z[:-1], float(abs(left).max()))

    def metric(self, z: Array) -> Array:
        """The covector of z: ⟨z, y⟩ = metric(z) · y."""
        found = np.zeros_like(z)
        times = self.modes.times
        found[-times - 1 : -1] = z[-times - 1 : -1] / (times * self.units[0] ** 2)
        found[-1] = z[-1] / self.units[1] ** 2
        return found

    def unit(self, tangent: Any) -> Array:
        return np.asarray(tangent / math.sqrt(tangent @ self.metric(tangent)))

    def tangent(self, z: Array, like: Array) -> Array:
        """The unit tangent on the side of another vector."""
        _, matrix = self.equations(z)
        bordered = np.vstack([matrix, self.metric(like)])
        right = np.zeros(len(z))
        right[-1] = 1.0
        return self.unit(np.linalg.solve(bordered, right))

    def corrected(self, start: Array, tangent: Array) -> tuple[Array, int] | None:
        """Newton's iteration at right angles to the tangent, and its steps; None if it fails."""
        z, across = start, self.metric(tangent)
        rest, before = self.modes.rope.rest, math.inf
        with np.errstate(all="ignore"):
            for count in range(1, _ITERATIONS + 1):
                left, matrix = self.equations(z)
                right = -np.append(left, across @ (z - start))
                try:
                    step = np.linalg.solve(np.vstack([matrix, across]), right)
                except np.linalg.LinAlgError:
                    return None
                size = float(abs(step[-self.modes.times - 1 : -1]).max())
                if not size < rest:
                    return None
                z = z + step
                if size < _TOLD * rest or (size >= before / 2 and size < 1e-9 * rest):
                    return z, count
                before = size
        return None


@dataclass(frozen=True)
class _Place:
    """A point with what is compared between points."""

    z: Array
    tangent: Array
    tests: dict[str, float]


class _Follower:
    """A branch on its way."""

    def __init__(self, curve: _Curve) -> None:
        self.curve, modes = curve, curve.modes
        self.tests = ["fold", "crossing"]
        self.doubled = None
        if modes.subharmonic == 1 and modes.times <= 2 * _DOUBLED + 1:
            self.tests.append("period doubling")
            self.doubled = Modes(modes.rope, 2 * modes.times - 1, 2)

    @property
    def kept(self) -> int:
        """The harmonics that a state may have before the times become more."""
        return 2 * (self.curve.modes.times // 2) // 3

    def place(self, z: Array, tangent: Array, tests: Sequence[str] | None = None) -> _Place:
        """With tests, by default all, as signed numbers."""
        found = {}
        for test in self.tests if tests is None else tests:
            if test == "fold":
                found[test] = float(tangent[-1]) / self.curve.units[1]
            else:
                found[test] = _Split.of(*self._tested(z, tangent, test)).sign
        return _Place(z, tangent, found)

    def step(
        self, place: _Place, length: float, tests: Sequence[str] | None = None
    ) -> tuple[_Place, int] | None:
        """One step; None where it does not keep to the branch."""
        start = place.z + length * place.tangent
        if self.curve.free == "omega" and not start[-1] > 0:
            return None
        found = self.curve.corrected(start, place.tangent)
        if found is None:
            return None
        z, count = found
        tangent = self.curve.tangent(z, place.tangent)
        if self.curve.metric(place.tangent) @ tangent < _STRAIGHT:
            return None
        return self.place(z, tangent, tests), count

    def doubled_at(self, modes: Modes) -> Modes:
        """The equations over two periods at the Ω of some modes."""
        assert self.doubled is not None
        if modes.rope is self.doubled.rope:
            return self.doubled
        return Modes(modes.rope, self.doubled.times, self.doubled.subharmonic, self.doubled)

    def end(self, place: _Place, ahead: _Place, limits: tuple[float, float]) -> _Place | None:
        """The point at the limit of λ that a step has passed; None if it is not found."""
        limit = limits[0] if ahead.z[-1] < limits[0] else limits[1]
        part = (limit - place.z[-1]) / (ahead.z[-1] - place.z[-1])
        start = place.z + part * (ahead.z - place.z)
        start[-1] = limit
        still = np.zeros_like(start)
        still[-1] = 1.0
        found = self.curve.corrected(start, still)
        return None if found is None else self.place(found[0], ahead.tangent, [])

    def located(self, place: _Place, length: float, test: str) -> BranchPoint:
        """The side before a test's change of sign."""
        low, high, before = 0.0, length, place
        values = [place.tests[test], math.nan]
        while high - low > _LOCATED * length:
            middle = (low + high) / 2
            if test == "fold" and math.isfinite(values[1]):  # a smooth test: secants, kept inside
                secant = low + (high - low) * values[0] / (values[0] - values[1])
                inset = (high - low) / 32
                middle = min(max(secant, low + inset), high - inset)
            moved = self.step(place, middle, [test])
            if moved is None:
                break
            value = moved[0].tests[test]
            if value * place.tests[test] < 0:
                high, values[1] = middle, value
            else:
                low, before, values[0] = middle, moved[0], value
        state = self.curve.state(before.z)
        if test == "fold":  # the tangent is the null vector
            waves = np.fft.rfft(before.tangent[-state.modes.times - 1 : -1])
            harmonic = int(np.argmax(abs(waves)))
        else:
            harmonic = _Split.of(*self._tested(before.z, before.tangent, test)).null_harmonic
        return BranchPoint(state, test, low, before.tangent, high - low, harmonic)

    def _tested(self, z: Array, tangent: Array, test: str) -> tuple[Modes, Array, Indices, int]:
        """Equations, matrix, which harmonics count, and the last of them that the state needs."""
        modes, epsilon = self.curve.at(z[-1])
        harmonics = np.arange(modes.times // 2 + 1)
        if test == "crossing":
            matrix = np.vstack([self.curve.equations(z)[1], self.curve.metric(tangent)])
            return modes, matrix, harmonics, self.kept
        big = self.doubled_at(modes)
        matrix = big.equations(embedded(z[:-1], modes, big), epsilon)[1]
        return big, matrix, np.arange(1, big.times // 2 + 1, 2), 2 * self.kept


@dataclass(frozen=True)
class _Split:
    """A matrix in harmonics, those that the state does not need eliminated.

    Attributes
    ----------
    sign
        Of the determinant of what is left.
    left
        It; its last columns belong to ξ_c's harmonics, cosine and sine.
    harmonics
        Of these columns.
    """

    sign: float
    left: Array
    harmonics: Indices

    @classmethod
    def of(cls, modes: Modes, matrix: Array, wanted: Indices, kept: int) -> _Split:
        """Of a matrix by times; a last row and column beyond it are kept."""
        basis, order = _fourier(modes)
        t, f = modes.times, modes.rope.contacts - 1
        rows = np.vstack([basis @ block for block in np.split(matrix[: (f + 1) * t], f + 1)])
        rows = np.vstack([rows, matrix[(f + 1) * t :]])
        contact = slice(f * t, (f + 1) * t)
        rows[:, contact] = rows[:, contact] @ basis.T
        top = modes.times // 2
        weights = np.concatenate([np.zeros(f), np.tile(np.repeat(np.arange(1, top + 1), f), 2)])
        extra = np.full(matrix.shape[1] - (f + 1) * t, -1.0)
        down, across = np.r_[np.tile(order, f + 1), extra], np.r_[weights, order, extra]
        own = [np.isin(index, wanted) | (index < 0) for index in (down, across)]
        low = [part & (index <= kept) for part, index in zip(own, (down, across), strict=True)]
        high = [part & (index > kept) for part, index in zip(own, (down, across), strict=True)]
        block = rows[np.ix_(high[0], high[1])]
        inner = np.linalg.solve(block, rows[np.ix_(high[0], low[1])])
        left = rows[np.ix_(low[0], low[1])] - rows[np.ix_(low[0], high[1])] @ inner
        sign = float(np.linalg.slogdet(left)[0])
        chosen = order[np.isin(order, wanted) & (order <= kept)]
        return cls(sign, left[:, : left.shape[1] - extra.size], chosen)

    @property
    def null_harmonic(self) -> int:
        """The dominant one in ξ_c of the vector that is nearly sent to zero."""
        _, _, vectors = np.linalg.svd(self.left)
        sizes = np.bincount(self.harmonics, vectors[-1][-self.harmonics.size :] ** 2)
        return int(np.argmax(sizes))


def _fourier(modes: Modes) -> tuple[Array, Indices]:
    """Times to harmonics, an orthogonal matrix, and the harmonic of each row: 0, 1, 1, 2, 2, …"""
    order = (np.arange(modes.times) + 1) // 2
    angles = np.outer(order, modes.phase) - (np.arange(modes.times) % 2 == 0)[:, None] * np.pi / 2
    basis = np.cos(angles) * np.sqrt(2 / modes.times)
    basis[0] = np.sqrt(1 / modes.times)
    return basis, order


def embedded(unknown: Array, modes: Modes, big: Modes) -> Array:
    """The unknowns of a state on other equations at the same Ω: more times, or k times the period.

    Harmonic j becomes kj; those that there were not are zero.
    """
    k = big.subharmonic // modes.subharmonic
    f = modes.left.free.shape[2]
    weights = modes.left.weights(unknown[: modes.left.unknowns])
    turned = np.zeros((big.left.free.shape[0], f), dtype=complex)
    # The same space at the same frequency; its columns may be others.
    for j, row in enumerate(weights):
        change = np.linalg.pinv(big.left.free[k * j]) @ modes.left.free[j]
        turned[k * j] = change @ row
    flat = [turned[0].real, turned[1:].real.ravel(), turned[1:].imag.ravel()]
    return np.concatenate([*flat, lifted(unknown[-modes.times :], big, k)])


def lifted(values: Array, modes: Modes, k: int = 1) -> Array:
    """A function at equal times of its period at those of others, k periods of its own."""
    waves = np.fft.rfft(values) / len(values)
    waves[1:] *= 2
    angles = np.exp(1j * k * np.outer(modes.phase, np.arange(waves.size)))
    return np.asarray((angles @ waves).real)


def follow(
    ropes: Ropes,
    start: PeriodicState,
    free: str,
    step: float,
    limits: tuple[float, float],
    points: int = 400,
    tangent: Array | None = None,
    longest: float = 4.0,
    accuracy: float = ACCURACY,
) -> Iterator[BranchPoint]:
    """The points of the branch through a state, one a step, located bifurcations between them.

    Parameters
    ----------
    ropes
        The rope by Ω; only asked for when Ω is free.
    start
        The first point.
    free
        λ: ``epsilon`` or ``omega``.
    step
        Of λ, the first one, with the sign of the way to go.
    limits
        λ at which the branch is left.
    points
        The most steps.
    tangent
        Where to go first, in the place of λ's own way: :func:`switched` gives one.
    longest
        The longest step in units of the first one.
    accuracy
        As of :func:`~numerics.periodic.states.periodic_state`.

    Raises
    ------
    InputError
        A free parameter that there is none of; a step of zero; a start outside the limits.
    NoPeriodicStateError
        The branch is lost: no step of 2⁻¹⁰ of the first one keeps to it, or more than 192 harmonics
        are needed, or more than there are to tell whether the rope is in the ground.

    Examples
    --------
    >>> from numerics.periodic.states import periodic_state
    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> first = periodic_state(string, 0.005)
    >>> found = list(follow(lambda omega: string, first, "epsilon", 0.005, (0, 0.02)))
    >>> found[-1].epsilon
    0.02
    """
    first = _checked(start, free, step, limits)
    follower, place = _begun(ropes, start, free, step, first, tangent)
    length, travelled, dodged, clear = 1.0, 0.0, 0, start.clearance(*_LOOK) > 0
    yield BranchPoint(start, None, 0.0, place.tangent)
    for _ in range(points):
        moved = follower.step(place, length)
        if moved is None:
            length *= _SHRUNK
            if length < _SHORTEST:
                raise NoPeriodicStateError(
                    f"the branch is lost at epsilon = {follower.curve.state(place.z).epsilon:.8g}, "
                    f"Omega = {follower.curve.at(place.z[-1])[0].rope.omega:.8g}: no step keeps to "
                    "it. Give a smaller first step"
                )
            continue
        ahead, count = moved
        inside = limits[0] <= ahead.z[-1] <= limits[1]
        try:
            further = _resolved(follower, ahead, accuracy) if inside else (follower, ahead)
        except NoPeriodicStateError:
            # In a gap that a high harmonic makes; a little before or behind it there is a state.
            if dodged == len(_DODGES):
                raise
            length, dodged = length * _DODGES[dodged], dodged + 1
            continue
        for test, value in ahead.tests.items():
            # Where two branches meet the tests have no sign.
            if value * place.tests[test] < 0 and (travelled > 0 or tangent is None):
                found = follower.located(place, length, test)
                yield replace(found, arclength=travelled + found.arclength)
        if not inside:
            end = follower.end(place, ahead, limits)
            if end is not None:
                yield BranchPoint(
                    follower.curve.state(end.z), None, travelled + length, end.tangent
                )
            return
        (follower, ahead), dodged = further, 0
        travelled += length
        state = follower.curve.state(ahead.z)
        if (state.clearance(*_LOOK) > 0) != clear:
            check_graze(state, clear)
            yield BranchPoint(state, "graze", travelled, ahead.tangent)
            return
        yield BranchPoint(state, None, travelled, ahead.tangent)
        place = ahead
        length = min(longest, length * _GROWN) if count <= 4 else length


def check_graze(state: PeriodicState, clear: bool) -> None:
    """That half as many harmonics again say so, too.

    A harmonic at the edge of what is resolved is small in ξ_c and may be large in ∂^m W there.

    Raises
    ------
    NoPeriodicStateError
        They do not.
    """
    finer = refined(state)
    if finer is None or (finer.clearance(*_LOOK) > 0) == clear:
        raise NoPeriodicStateError(
            f"whether the rope at epsilon = {state.epsilon:.8g}, Omega = "
            f"{state.modes.rope.omega:.8g} grazes the ground is not resolved by "
            f"{state.modes.times // 2} harmonics"
        )


def _resolved(follower: _Follower, place: _Place, accuracy: float) -> tuple[_Follower, _Place]:
    """A place on as many harmonics as it needs."""
    while resolved(follower.curve.state(place.z), accuracy) > follower.kept:
        follower, place = _finer(follower, place)
    return follower, place


def _checked(start: PeriodicState, free: str, step: float, limits: tuple[float, float]) -> float:
    """λ of the first point."""
    if free not in FREE:
        raise InputError(f"free = {free!r}; give one of {', '.join(FREE)}")
    if not (math.isfinite(step) and step):
        raise InputError(f"step = {step!r}; give a finite number other than zero")
    first = start.epsilon if free == "epsilon" else start.modes.rope.omega
    if not limits[0] <= first <= limits[1]:
        raise InputError(f"the branch begins at {first!r}, outside its limits {limits!r}")
    return first


def _begun(
    ropes: Ropes,
    start: PeriodicState,
    free: str,
    step: float,
    first: float,
    tangent: Array | None,
) -> tuple[_Follower, _Place]:
    """The curve with its units, and the first place."""
    modes = start.modes
    if modes.rope.springs:
        raise InputError("branches are of ropes on rigid ground; this one lies on springs")
    curve = _Curve(ropes, free, modes, start.epsilon, (1.0, 1.0))
    z = np.append(start.unknown, first)
    if tangent is None:
        _, matrix = curve.equations(z)
        way = np.append(np.linalg.solve(matrix[:, :-1], -matrix[:, -1]), 1.0) * step
    else:
        way = tangent * abs(step)
    contact = float(np.sqrt(np.mean(way[-modes.times - 1 : -1] ** 2)))
    curve = replace(curve, units=(max(contact, 1e-12), abs(step)))
    follower = _Follower(curve)
    return follower, follower.place(z, curve.unit(way))


def _finer(follower: _Follower, place: _Place) -> tuple[_Follower, _Place]:
    """The same place on half as many harmonics again."""
    curve = follower.curve
    coarse = curve.state(place.z)
    # A branch may begin on more than MOST: a second look at a located point does.
    harmonics = min(3 * (coarse.modes.times // 2) // 2, MOST)
    if harmonics <= coarse.modes.times // 2:
        raise NoPeriodicStateError(
            f"the state at epsilon = {coarse.epsilon:.8g}, Omega = {coarse.modes.rope.omega:.8g} "
            f"is not resolved by {MOST} harmonics"
        )
    modes = Modes(coarse.modes.rope, 2 * harmonics + 1, coarse.modes.subharmonic)
    finer = replace(curve, modes=modes)

    times = coarse.modes.times
    z = np.append(embedded(place.z[:-1], coarse.modes, modes), place.z[-1])
    way = np.zeros_like(z)
    way[-modes.times - 1 : -1] = lifted(place.tangent[-times - 1 : -1], modes)
    way[-1] = place.tangent[-1]
    found = finer.corrected(z, finer.unit(way))
    if found is None:
        raise NoPeriodicStateError(
            f"the state at epsilon = {coarse.epsilon:.8g} is not found on {harmonics} harmonics"
        )
    fresh = _Follower(finer)
    return fresh, fresh.place(found[0], finer.tangent(found[0], finer.unit(way)))


def switched(point: BranchPoint) -> tuple[PeriodicState, Array]:
    """The state at a period doubling over twice its period, and the way onto the other branch.

    Raises
    ------
    InputError
        The point is no period doubling.
    """
    if point.kind != "period doubling":
        raise InputError(f"a {point.kind or 'regular point'} has no branch of twice the period")
    modes = point.state.modes
    big = Modes(modes.rope, 2 * modes.times - 1, 2 * modes.subharmonic)
    unknown = embedded(point.state.unknown, modes, big)
    left, matrix, _ = big.equations(unknown, point.epsilon)
    _, _, vectors = np.linalg.svd(matrix)
    way = np.append(vectors[-1], 0.0)
    size = abs(way[-big.times - 1 : -1]).max()
    return PeriodicState(big, point.epsilon, unknown, float(abs(left).max())), way / size


def doubled_state(rope: LinearRope, epsilon: float, highest: float = 0.5) -> PeriodicState:
    """The state of twice the drive's period at ε, on the branch of the first period doubling.

    Parameters
    ----------
    rope
        The rope; Ω is its own.
    epsilon
        ε > 0, on either side of the period doubling.
    highest
        Up to where that is sought.

    Raises
    ------
    InputError
        An ε that is not between 0 and the highest.
    NoPeriodicStateError
        The branch from rest has no period doubling up to the highest ε, or the other branch does
        not come to ε.
    """
    if not 0 < epsilon <= highest:
        raise InputError(f"epsilon = {epsilon!r}; give a number above 0, up to {highest!r}")

    def ropes(_: float) -> LinearRope:
        return rope

    first = min(1e-3 * highest, epsilon / 2)
    walk = follow(
        ropes, periodic_state(rope, first), "epsilon", first, (0.0, highest), longest=60.0
    )
    doubling = None
    try:
        doubling = next((point for point in walk if point.kind == "period doubling"), None)
    except NoPeriodicStateError as error:
        raise NoPeriodicStateError(f"no period doubling; from rest {error}") from error
    if doubling is None:
        raise NoPeriodicStateError(
            f"Omega = {rope.omega!r}: the branch from rest has no period doubling up to epsilon = "
            f"{highest!r}; try nearer to twice a free frequency"
        )
    start, tangent = switched(doubling)
    limits = (epsilon, highest) if epsilon < doubling.epsilon else (0.0, epsilon)
    step = max(abs(epsilon - doubling.epsilon) / 20, 1e-6 * epsilon)
    last, ended = start, ""
    try:
        for point in follow(ropes, start, "epsilon", step, limits, 120, tangent, _FREE):
            last = point.state
    except NoPeriodicStateError as error:
        ended = f": {error}"
    if abs(last.epsilon - epsilon) > 1e-9 * epsilon:
        raise NoPeriodicStateError(
            f"the branch of twice the period, from epsilon = {doubling.epsilon:.8g} on, does not "
            f"come to {epsilon!r}; it was followed to {last.epsilon:.8g}{ended}"
        )
    return periodic_state(rope, epsilon, start.modes.subharmonic, last)
