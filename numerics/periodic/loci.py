r"""Curves of folds and of period doublings in the plane of Ω and ε.

A point of such a curve solves F(u; ε, Ω) = 0 of :mod:`numerics.periodic.modes` together with g = 0,
where the square matrix A (∂F/∂u at a fold; at a period doubling that of the same state over twice
the period) is singular. With fixed vectors b, c near its null vectors,

.. math:: \begin{pmatrix} A & b \\ c^T & 0 \end{pmatrix} \begin{pmatrix} v \\ g \end{pmatrix} =
          \begin{pmatrix} 0 \\ 1 \end{pmatrix}, \qquad
          \begin{pmatrix} A^T & c \\ b^T & 0 \end{pmatrix} \begin{pmatrix} w \\ g \end{pmatrix} =
          \begin{pmatrix} 0 \\ 1 \end{pmatrix}, \qquad dg = −w^T\,dA\,v,

g is smooth, and zero exactly where A is singular. dA is taken by central differences along v, ε and
Ω. The curve is followed by its arclength in (ξ_c, ε, Ω), so that it may turn in either. At a fold
the quadratic coefficient :math:`w^T F_{uu} v v` changes its sign at a *cusp*, where two folds meet.

Source: W. J. F. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria (SIAM, 2000),
chapters 3 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from numerics.errors import InputError
from numerics.periodic.branches import BranchPoint, Ropes, embedded, lifted
from numerics.periodic.linear_rope import Array, NoPeriodicStateError
from numerics.periodic.modes import Modes
from numerics.periodic.states import ACCURACY, MOST, PeriodicState, resolved

KINDS = ("fold", "period doubling")

_ITERATIONS, _TOLD = 10, 1e-11
_GROWN, _SHRUNK, _SHORTEST = 1.5, 0.5, 2.0**-10
_STRAIGHT = 0.9
# Singular vectors among which the border is chosen.
_CANDIDATES = 16
# Of what is moved, for central differences: the cube root of the rounding.
_DIFFERENCE = 1e-5


@dataclass(frozen=True)
class LocusPoint:
    """A fold or a period doubling.

    Attributes
    ----------
    state
        The state there.
    kind
        None, or ``cusp`` where two folds met since the point before.
    residual
        |g|, the distance of the matrix from a singular one in the units of its border.
    tangent
        Along the curve: of the unknowns, then of ε and of Ω.
    """

    state: PeriodicState
    kind: str | None
    residual: float
    tangent: Array = field(repr=False)

    @property
    def epsilon(self) -> float:
        """ε."""
        return self.state.epsilon

    @property
    def omega(self) -> float:
        """Ω."""
        return float(self.state.modes.rope.omega)


class _Locus:
    """F = 0, g = 0 on one number of times; z is u, ε, Ω."""

    def __init__(self, ropes: Ropes, kind: str, modes: Modes, units: Array) -> None:
        self.ropes, self.kind, self.modes, self.units = ropes, kind, modes, units
        self.big = Modes(modes.rope, 2 * modes.times - 1, 2) if kind != "fold" else None
        self.border: tuple[Array, Array] | None = None

    def modes_at(self, omega: float) -> Modes:
        like = self.modes
        if omega == like.rope.omega:
            return like
        return Modes(self.ropes(omega), like.times, 1, like)

    def singular(self, z: Array) -> Array:
        """A."""
        modes = self.modes_at(z[-1])
        if self.big is None:
            return modes.equations(z[:-2], z[-2])[1]
        big = self._doubled(modes)
        return big.equations(embedded(z[:-2], modes, big), z[-2])[1]

    def _doubled(self, modes: Modes) -> Modes:
        assert self.big is not None
        if modes.rope is self.big.rope:
            return self.big
        return Modes(modes.rope, self.big.times, 2, self.big)

    def take_border(self, z: Array, like: Array | None = None) -> None:
        """b and c: the null vectors of A here, the one whose ξ_c is most like the given.

        High harmonics that resonate have small singular values, too.
        """
        left, _, right = np.linalg.svd(self.singular(z))
        which = -1
        if like is not None:
            parts = right[-_CANDIDATES:, -len(like) :]
            alike = abs(parts @ like) / np.linalg.norm(parts, axis=1)
            which = int(np.argmax(alike)) - len(parts)
        self.border = left[:, which], right[which]

    @property
    def null_contact(self) -> Array:
        """ξ_c's part of the null vector, at the times of A."""
        assert self.border is not None
        times = self.modes.times if self.big is None else self.big.times
        return self.border[1][-times:]

    def null(self, z: Array) -> tuple[float, Array, Array]:
        """g, v, w."""
        assert self.border is not None
        matrix, (b, c) = self.singular(z), self.border
        bordered = np.zeros((len(b) + 1, len(b) + 1))
        bordered[:-1, :-1], bordered[:-1, -1], bordered[-1, :-1] = matrix, b, c
        right = np.zeros(len(b) + 1)
        right[-1] = 1.0
        v, w = np.linalg.solve(bordered, right), np.linalg.solve(bordered.T, right)
        return float(v[-1]), np.asarray(v[:-1], dtype=float), np.asarray(w[:-1], dtype=float)

    def equations(self, z: Array) -> tuple[Array, Array]:
        """F and g, and their derivatives by u, ε and Ω."""
        modes, epsilon, omega = self.modes_at(z[-1]), z[-2], z[-1]
        left, matrix, by_epsilon = modes.equations(z[:-2], epsilon)
        h = _DIFFERENCE * omega
        up, down = (self.modes_at(omega + d * h).equations(z[:-2], epsilon)[0] for d in (1, -1))
        g, v, w = self.null(z)
        rows = np.zeros((len(z) - 1, len(z)))
        rows[:-1] = np.column_stack([matrix, by_epsilon, (up - down) / (2 * h)])
        rows[-1, :-2] = self._along(z, v, w)
        for place, size in ((-2, max(abs(epsilon), 1e-3)), (-1, omega)):
            step = np.zeros_like(z)
            step[place] = _DIFFERENCE * size
            change = self.singular(z + step) - self.singular(z - step)
            rows[-1, place] = -(w @ change @ v) / (2 * step[place])
        return np.append(left, g), rows

    def _along(self, z: Array, v: Array, w: Array) -> Array:
        """∂g/∂u = −wᵀ F_uu v."""
        modes, epsilon = self.modes_at(z[-1]), z[-2]
        length = _DIFFERENCE / max(float(abs(v[-self.modes.times :]).max()), 1e-300)
        if self.big is None:
            up, down = (modes.equations(z[:-2] + d * length * v, epsilon)[1] for d in (1, -1))
            return np.asarray(-(w @ (up - down)) / (2 * length))
        big = self._doubled(modes)
        start = embedded(z[:-2], modes, big)
        up, down = (big.equations(start + d * length * v, epsilon)[1] for d in (1, -1))
        row = -(w @ (up - down)) / (2 * length)
        units = np.eye(len(z) - 2)
        # embedded is linear, and keeps the mean of nothing: its matrix, column by column.
        return np.array([row @ embedded(unit, modes, big) for unit in units])

    def bend(self, z: Array) -> tuple[float, Array]:
        """wᵀ F_uu v v at a fold, and wᵀ (F_ε, F_Ω) in their units, w of either sign."""
        _, v, w = self.null(z)
        _, rows = self.equations(z)
        slope = w @ rows[:-1, -2:] * self.units[1:]
        return float(-(rows[-1, :-2] @ v)), np.asarray(slope, dtype=float)

    def metric(self, y: Array) -> Array:
        found = np.zeros_like(y)
        t = self.modes.times
        found[-t - 2 : -2] = y[-t - 2 : -2] / (t * self.units[0] ** 2)
        found[-2:] = y[-2:] / self.units[1:] ** 2
        return found

    def unit(self, y: Array) -> Array:
        return np.asarray(y / math.sqrt(y @ self.metric(y)))

    def tangent(self, z: Array, like: Array) -> Array:
        _, rows = self.equations(z)
        right = np.zeros(len(z))
        right[-1] = 1.0
        found = np.linalg.solve(np.vstack([rows, self.metric(like)]), right)
        return self.unit(np.asarray(found, dtype=float))

    def corrected(self, start: Array, across: Array) -> tuple[Array, int] | None:
        """Newton's iteration with across · (z − start) = 0; None if it fails."""
        z, before, rest = start, math.inf, self.modes.rope.rest
        with np.errstate(all="ignore"):
            for count in range(1, _ITERATIONS + 1):
                try:
                    left, rows = self.equations(z)
                    right = -np.append(left, across @ (z - start))
                    step = np.linalg.solve(np.vstack([rows, across]), right)
                except (np.linalg.LinAlgError, ValueError):
                    return None
                size = float(abs(step[-self.modes.times - 2 :]).max())
                if not size < rest or not z[-1] + step[-1] > 0:
                    return None
                z = z + step
                if size < _TOLD * rest or (size >= before / 2 and size < 1e-8 * rest):
                    return z, count
                before = size
        return None

    def state(self, z: Array) -> PeriodicState:
        modes = self.modes_at(z[-1])
        left, _, _ = modes.equations(z[:-2], z[-2])
        return PeriodicState(modes, float(z[-2]), z[:-2], float(abs(left).max()))


def locus(
    ropes: Ropes,
    point: BranchPoint,
    step: float,
    limits: tuple[float, float],
    points: int = 200,
    accuracy: float = ACCURACY,
) -> Iterator[LocusPoint]:
    """The curve through a fold or a period doubling of a branch, as Ω moves.

    Parameters
    ----------
    ropes
        The rope by Ω.
    point
        As :func:`numerics.periodic.branches.follow` has located it.
    step
        Of Ω, the first one, with the sign of the way to go.
    limits
        Ω at which the curve is left; the last point is there.
    points
        The most steps.
    accuracy
        As of :func:`~numerics.periodic.states.periodic_state`.

    Raises
    ------
    InputError
        Another kind of point; a step of zero; a point outside the limits.
    NoPeriodicStateError
        The curve is lost: no step of 2⁻¹⁰ of the first one keeps to it, or more than 192 harmonics
        are needed.

    Examples
    --------
    The folds above the first free frequency of a string on an elastic foundation:

    >>> from numerics.periodic.branches import follow
    >>> from numerics.periodic.linear_rope import LinearRope
    >>> from numerics.periodic.states import periodic_state
    >>> def rope(omega):
    ...     end = ({(0, 0): 1.0}, 1.0, lambda tau: np.cos(omega * tau))
    ...     terms = {(0, 2): 1.0, (2, 0): -1.0, (0, 0): 3.0}
    ...     return LinearRope(terms, -2.0, [end], 2, omega, math.acosh(2.5) / math.sqrt(3))
    >>> walk = follow(rope, periodic_state(rope(3.885), 1e-5), "epsilon", 2e-6, (0.0, 1e-4))
    >>> fold = next(point for point in walk if point.kind == "fold")
    >>> *_, last = locus(rope, fold, 1e-3, (3.88, 3.89))
    >>> last.omega, last.epsilon > 2 * fold.epsilon
    (3.89, True)
    """
    first = _checked(point, step, limits)
    curve = _Locus(ropes, point.kind or "", point.state.modes, np.ones(3))
    z = np.concatenate([point.state.unknown, [point.epsilon, first]])
    curve.take_border(z)
    _, rows = curve.equations(z)
    still = np.zeros(len(z))
    still[-1] = 1.0
    found = curve.corrected(z, still)
    if found is None:
        raise NoPeriodicStateError(f"the {point.kind} at Omega = {first!r} is not found again")
    z = found[0]
    way: Array = np.append(np.linalg.solve(rows[:, :-1], -rows[:, -1]), 1.0) * step
    moved_by = [float(np.sqrt(np.mean(way[-curve.modes.times - 2 : -2] ** 2))), abs(way[-2])]
    curve.units = np.array([*np.maximum(moved_by, 1e-9), abs(step)])
    # In the first step ξ_c, ε and Ω move by one unit each.
    length = math.sqrt(3.0)
    longest, tangent = 4 * length, curve.unit(np.asarray(way, dtype=float))
    bent = curve.bend(z) if point.kind == "fold" else None
    yield _told(curve, z, None, tangent)
    for _ in range(points):
        moved = _step(curve, z, tangent, length)
        if moved is None:
            length *= _SHRUNK
            if length < _SHORTEST * longest:
                here = curve.state(z)
                raise NoPeriodicStateError(
                    f"the curve of {point.kind}s is lost at Omega = {here.modes.rope.omega:.8g}, "
                    f"epsilon = {here.epsilon:.8g}: no step keeps to it. Give a smaller first step"
                )
            continue
        ahead, way, count = moved
        if not limits[0] <= ahead[-1] <= limits[1]:
            end = _end(curve, z, ahead, limits)
            if end is not None:
                yield _told(curve, end, None, way)
            return
        curve, ahead, way = _resolved(curve, ahead, way, accuracy)
        curve.take_border(ahead, curve.null_contact)
        kind = None
        if bent is not None:
            new = curve.bend(ahead)
            # The slopes turn little within a step: they tell the sign of w.
            kind = "cusp" if new[0] * bent[0] * float(new[1] @ bent[1]) < 0 else None
            bent = new
        yield _told(curve, ahead, kind, way)
        z, tangent = ahead, way
        length = min(longest, length * _GROWN) if count <= 4 else length


def _checked(point: BranchPoint, step: float, limits: tuple[float, float]) -> float:
    if point.kind not in KINDS:
        raise InputError(f"a {point.kind or 'regular point'} has no curve; give one of {KINDS}")
    if point.state.modes.subharmonic != 1:
        raise InputError("curves are of states of the drive's period")
    if not (math.isfinite(step) and step):
        raise InputError(f"step = {step!r}; give a finite number other than zero")
    first = point.omega
    if not limits[0] <= first <= limits[1]:
        raise InputError(f"the curve begins at Omega = {first!r}, outside its limits {limits!r}")
    return first


def _step(
    curve: _Locus, z: Array, tangent: Array, length: float
) -> tuple[Array, Array, int] | None:
    start = z + length * tangent
    if not start[-1] > 0:
        return None
    found = curve.corrected(start, curve.metric(tangent))
    if found is None:
        return None
    ahead, count = found
    way = curve.tangent(ahead, tangent)
    return None if curve.metric(tangent) @ way < _STRAIGHT else (ahead, way, count)


def _end(curve: _Locus, z: Array, ahead: Array, limits: tuple[float, float]) -> Array | None:
    limit = limits[0] if ahead[-1] < limits[0] else limits[1]
    start = z + (limit - z[-1]) / (ahead[-1] - z[-1]) * (ahead - z)
    start[-1] = limit
    still = np.zeros_like(start)
    still[-1] = 1.0
    found = curve.corrected(start, still)
    return None if found is None else found[0]


def _resolved(curve: _Locus, z: Array, way: Array, accuracy: float) -> tuple[_Locus, Array, Array]:
    """The same point on as many harmonics as it needs, its equations stated at its own Ω."""
    while True:
        state = curve.state(z)
        times = curve.modes.times
        needed = resolved(state, accuracy) > 2 * (times // 2) // 3
        harmonics = min(3 * (times // 2) // 2, MOST) if needed else times // 2
        if needed and harmonics <= times // 2:
            raise NoPeriodicStateError(
                f"the state at epsilon = {state.epsilon:.8g}, Omega = "
                f"{state.modes.rope.omega:.8g} is not resolved by {MOST} harmonics"
            )
        if not needed:
            return curve, z, way
        modes = Modes(state.modes.rope, 2 * harmonics + 1)
        finer = _Locus(curve.ropes, curve.kind, modes, curve.units)
        unknown = embedded(z[:-2], state.modes, modes)
        still = np.zeros(len(unknown) + 2)
        still[-1] = 1.0
        start = np.concatenate([unknown, z[-2:]])
        finest = modes if finer.big is None else finer.big
        finer.take_border(start, lifted(curve.null_contact, finest))
        found = finer.corrected(start, still)
        if found is None:
            raise NoPeriodicStateError(
                f"the {curve.kind} at Omega = {state.modes.rope.omega:.8g} is not found on "
                f"{harmonics} harmonics"
            )
        further = np.zeros(len(still))
        further[-modes.times - 2 : -2] = lifted(way[-times - 2 : -2], modes)
        further[-2:] = way[-2:]
        curve, z = finer, found[0]
        way = curve.tangent(z, finer.unit(further))


def _told(curve: _Locus, z: Array, kind: str | None, tangent: Array) -> LocusPoint:
    return LocusPoint(curve.state(z), kind, abs(curve.null(z)[0]), tangent)
