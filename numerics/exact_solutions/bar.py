r"""An elastic bar that falls on rigid ground and bounces: exact, by d'Alembert's waves.

The benchmark of Doyen, Ern and Piperno (SIAM J. Sci. Comput. 33, 2011, 223–249), for any data. A
vertical bar of length L, Young modulus E and density ρ, at rest and unstressed at height h₀, falls
under g; only its lower end meets the ground. With c = √(E/ρ) and T = 2L/c, its displacement is

.. math:: u(x, t) = h_0 − \tfrac12 g t^2 + a(t − x/c) + a(t − T + x/c), \qquad a(t ≤ 0) = 0 ,

so that the upper end is free. What the lower end would do if it met nothing is known one T before,

.. math:: v(t) = 2a'(t − T) − gt ,

and the ground reflects it: u_t(0, t) = v, or max(v, 0) where u(0, t) = 0, with the pressure
p = ρc (u_t − v) ≥ 0 and a′ = u_t + gt − a′(t − T). Hence a′ is piecewise linear, with jumps,
and the motion is found piece by piece, without error but for rounding. No energy is lost: p acts
only where u_t = 0. The pieces of data that are not periodic multiply with every echo.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.problems.drive import positive

Array = NDArray[np.float64]

_EPS = float(np.finfo(float).eps)
_MOST_PIECES = 100_000


@dataclass(frozen=True)
class _Piece:
    """From ``start`` on, a′ = rate + growth·(t − start); a and the end's height at ``start``."""

    start: float
    rate: float
    growth: float
    value: float
    height: float
    touching: bool

    def wave(self, t: float) -> float:
        return self.value + (self.rate + 0.5 * self.growth * (t - self.start)) * (t - self.start)


@dataclass(frozen=True)
class BouncingBar:
    """The bouncing bar up to ``until``; see the module. Any consistent units.

    Attributes
    ----------
    until
        The motion is known for 0 ≤ t ≤ until.
    young, density, length, gravity, drop
        E, ρ, L, g, h₀, all positive; the defaults are the benchmark's.
    contacts
        The intervals (begin, end) in which the lower end is on the ground; the last one may be cut
        off by ``until``.
    """

    until: float
    young: float = 900.0
    density: float = 1.0
    length: float = 10.0
    gravity: float = 10.0
    drop: float = 5.0
    contacts: tuple[tuple[float, float], ...] = field(init=False)
    _pieces: tuple[_Piece, ...] = field(init=False, repr=False)
    _table: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("until", "young", "density", "length", "gravity", "drop"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        pieces = self._march()
        rows = [(p.start, p.rate, p.growth, p.value, p.height, p.touching) for p in pieces]
        object.__setattr__(self, "_pieces", tuple(pieces))
        object.__setattr__(self, "_table", np.array(rows, dtype=float).T)
        object.__setattr__(self, "contacts", self._intervals())

    @property
    def wave_speed(self) -> float:
        """c = √(E/ρ)."""
        return math.sqrt(self.young / self.density)

    @property
    def echo_time(self) -> float:
        """T = 2L/c, up the bar and back."""
        return 2 * self.length / self.wave_speed

    def bottom(self, t: ArrayLike) -> Array:
        """u(0, t), the height of the lower end over the ground: piecewise quadratic."""
        time = self._times(t)
        # Where it lands, rounding must not take it below the ground.
        free = np.maximum(self.displacement(0.0, time), 0.0)
        return np.where(self._lookup(time)[5] > 0, 0.0, free)

    def pressure(self, t: ArrayLike) -> Array:
        """p = ρc (a′(t) − a′(t − T)), the ground's pressure; at a jump the value after it."""
        time = self._times(t)
        difference = self._rate(time) - self._rate(time - self.echo_time)
        impedance = self.density * self.wave_speed
        return np.where(self._lookup(time)[5] > 0, impedance * difference, 0.0)

    def displacement(self, x: ArrayLike, t: ArrayLike) -> Array:
        """u(x, t), 0 ≤ x ≤ L and 0 ≤ t ≤ until, broadcast."""
        time, up, down = self._characteristics(x, t)
        return self.drop - 0.5 * self.gravity * time**2 + self._wave(up) + self._wave(down)

    def velocity(self, x: ArrayLike, t: ArrayLike) -> Array:
        """u_t(x, t), broadcast; at a jump the value after it."""
        time, up, down = self._characteristics(x, t)
        return self._rate(up) + self._rate(down) - self.gravity * time

    def strain(self, x: ArrayLike, t: ArrayLike) -> Array:
        """u_x(x, t), broadcast; the stress is E u_x, and −E u_x(0, t) the pressure."""
        _, up, down = self._characteristics(x, t)
        return (self._rate(down) - self._rate(up)) / self.wave_speed

    def _characteristics(self, x: ArrayLike, t: ArrayLike) -> tuple[Array, Array, Array]:
        """t, t − x/c and t − T + x/c."""
        place, time = np.asarray(x, dtype=float), self._times(t)
        if not np.all((place >= 0) & (place <= self.length)):
            raise InputError(f"give places 0 ≤ x ≤ L = {self.length!r}")
        c = self.wave_speed
        return time, time - place / c, time - (2 * self.length - place) / c

    def _march(self) -> list[_Piece]:
        """The pieces of a′, each from what happened one T before."""
        echo, g = self.echo_time, self.gravity
        pieces = [_Piece(0.0, 0.0, 0.0, 0.0, self.drop, False)]
        first_hit = math.sqrt(2 * self.drop / g)
        start, old = first_hit, -1
        while start < self.until:
            if len(pieces) > _MOST_PIECES:
                raise InputError(f"until = {self.until!r}: too many echoes; give a shorter time")
            while old + 1 < len(pieces) and pieces[old + 1].start + echo <= start:
                old += 1
            past = pieces[old] if old >= 0 else _Piece(-math.inf, 0.0, 0.0, 0.0, 0.0, False)
            end = (pieces[old + 1].start if old + 1 < len(pieces) else start) + echo
            piece, length = self._next_piece(pieces[-1], past, start, end - start)
            pieces.append(piece)
            start = end if length == end - start else start + length
        return pieces

    def _next_piece(
        self, last: _Piece, past: _Piece, start: float, longest: float
    ) -> tuple[_Piece, float]:
        """The piece that begins at ``start``, and how long it lasts."""
        echo, g = self.echo_time, self.gravity
        since = start - echo - past.start
        back = past.rate + past.growth * since if past.growth else past.rate
        value = last.wave(start)
        height = self.drop - 0.5 * g * start**2 + value
        height += past.wave(start - echo) if math.isfinite(past.start) else 0.0
        # Below this height and speed, rounding decides.
        level = 64 * _EPS * g * max(start, echo) ** 2
        if height < level:
            height = 0.0
        v, acceleration = 2 * back - g * start, 2 * past.growth - g
        if abs(v) < 64 * _EPS * g * max(start, echo):
            v = 0.0
        grounded = height == 0 and (v < 0 or (v == 0 and acceleration < 0))
        if grounded:
            length = -v / acceleration if acceleration > 0 else math.inf
            rate, growth = g * start - back, g - past.growth
        else:
            length = _landing(height, v, acceleration)
            rate, growth = back, past.growth
        snap = 64 * _EPS * max(start, echo)
        length = longest if length > longest - snap else length
        return _Piece(start, rate, growth, value, height, grounded), length

    def _intervals(self) -> tuple[tuple[float, float], ...]:
        spans: list[tuple[float, float]] = []
        ends = [p.start for p in self._pieces[1:]] + [self.until]
        for piece, end in zip(self._pieces, ends, strict=True):
            if piece.touching and spans and spans[-1][1] == piece.start:
                spans[-1] = (spans[-1][0], end)
            elif piece.touching:
                spans.append((piece.start, end))
        return tuple(spans)

    def _lookup(self, t: Array) -> Array:
        index = np.searchsorted(self._table[0], t, side="right") - 1
        return self._table[:, np.maximum(index, 0)]

    def _wave(self, t: Array) -> Array:
        start, rate, growth, value, _, _ = self._lookup(t)
        since = t - start
        return np.where(t < 0, 0.0, value + (rate + 0.5 * growth * since) * since)

    def _rate(self, t: Array) -> Array:
        start, rate, growth, _, _, _ = self._lookup(t)
        return np.where(t < 0, 0.0, rate + growth * (t - start))

    def _times(self, t: ArrayLike) -> Array:
        time = np.asarray(t, dtype=float)
        if not np.all((time >= 0) & (time <= self.until)):
            raise InputError(f"give times 0 ≤ t ≤ until = {self.until!r}, or a later until")
        return time


def _landing(height: float, speed: float, acceleration: float) -> float:
    """The first s > 0 with height + speed·s + ½ acceleration·s² = 0, or ∞."""
    if height == 0:
        # It leaves the ground; it is back where the parabola has its other root.
        return -2 * speed / acceleration if acceleration < 0 else math.inf
    square = speed * speed - 2 * acceleration * height
    if square < 0 or (speed >= 0 and acceleration >= 0):
        return math.inf
    # One form cancels where the other does not.
    if speed < 0:
        return 2 * height / (math.sqrt(square) - speed)
    return -(speed + math.sqrt(square)) / acceleration


def bouncing_bar(
    until: float,
    young: float = 900.0,
    density: float = 1.0,
    length: float = 10.0,
    gravity: float = 10.0,
    drop: float = 5.0,
) -> BouncingBar:
    """The bouncing bar up to the time ``until``; see :class:`BouncingBar`.

    With the default data the motion has the period 16/3: contact in (1, 5/3) under the pressure
    300 t, and in (11/3, 13/3) under 300 (16/3 − t).

    Raises
    ------
    InputError
        An argument that is not positive.

    Examples
    --------
    >>> bar = bouncing_bar(6.0)
    >>> bar.bottom([0.5, 1.7, 2.0, 8 / 3, 3.2, 4.5]).round(5)
    array([3.75   , 0.11667, 1.66667, 3.88889, 2.64444, 1.52778])
    >>> [(round(float(a), 6), round(float(b), 6)) for a, b in bar.contacts]
    [(1.0, 1.666667), (3.666667, 4.333333)]
    """
    return BouncingBar(until, young, density, length, gravity, drop)
