r"""Where the circle of a rotation number breaks up: K_c(ν), and with it Ω(ν) and ε_c(ν).

Greene's criterion: the residues of two successive convergents of ν are equal at a K that converges
to K_c, since both then are near the value of the critical circle (0.25009 for noble numbers). For
the golden number the crossings alternate around K_c and close in by −0.376 a step, so that three of
them give it to two digits more than the last; the same holds of the Ω of the orbits. Where the
quotients of ν repeat after m, orbits m convergents apart are compared. Where they do not repeat,
the crossings close in without a common ratio: the last is taken, and twice the largest of the last
three changes is its error.

The second opinion uses circles instead of orbits: the norm ‖U″‖ of the last ones grows like
:math:`(K_s − K)^{−B}`, and three of them give K_s. It is good to three digits: the law is that of
the limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from numerics.errors import InputError, NumericsError
from numerics.exact_string.circle_state import InvariantCircle
from numerics.exact_string.greene import PeriodicOrbit, periodic_orbit
from numerics.exact_string.invariant_circle import NO_CIRCLE, circle_at_rotation
from numerics.exact_string.rotation import Noble

# Denominators of the orbits that are compared: shorter ones say little, longer ones lose digits.
_SHORTEST, _LONGEST = 8, 3000
# Of a residue, as a trace less two.
_ROUNDING = 1e-11
# A common ratio of the crossings' differences that is worth extrapolating.
_SETTLED = 0.7
# Circles for the second opinion, below K_c by these shares of it.
_BELOW = (8e-3, 4e-3, 2e-3)


@dataclass(frozen=True)
class Crossing:
    """K at which the orbits p/q and p′/q′ have one residue, and Ω of the longer."""

    shorter: tuple[int, int]
    longer: tuple[int, int]
    strength: float
    residue: float
    omega: float


@dataclass(frozen=True)
class BreakUp:
    """The end of one circle.

    Attributes
    ----------
    rotation
        ν.
    strength, strength_error
        K_c, and how much the last crossing changed it.
    omega, omega_error
        Ω there.
    crossings
        By orbits of growing length.
    last_circle
        The circle nearest to K_c that the second opinion found; None where it found none.
    by_norms
        K_s by the growth of ‖U″‖; None without three circles.
    """

    rotation: Noble
    strength: float
    strength_error: float
    omega: float
    omega_error: float
    crossings: tuple[Crossing, ...] = field(repr=False)
    last_circle: InvariantCircle | None = field(repr=False)
    by_norms: float | None

    @property
    def epsilon(self) -> float:
        """ε_c = K_c/(2Ω²)."""
        return self.strength / (2 * self.omega**2)

    @property
    def epsilon_error(self) -> float:
        """Of ε_c, the two errors added."""
        return self.epsilon * (
            self.strength_error / self.strength + 2 * self.omega_error / self.omega
        )


def break_up(rotation: Noble, progress: Callable[[int, int], None] | None = None) -> BreakUp:
    """K_c, Ω and ε_c of the circle with the rotation number ν.

    Parameters
    ----------
    rotation
        ν; :func:`numerics.exact_string.rotation.noble` makes it from digits.
    progress
        Called with the crossings found and their number.

    Raises
    ------
    InputError
        ν is so near a rational that fewer than four of its convergents have 8 ≤ q ≤ 3000.
    NumericsError
        An orbit or a crossing was not found.

    Examples
    --------
    >>> from numerics.exact_string.rotation import Noble
    >>> golden = break_up(Noble((0,)))
    >>> round(golden.strength, 8), round(golden.omega, 7), golden.strength_error < 1e-8
    (0.97163541, 1.9387855, True)
    """
    orbits = [(p, q, a) for p, q, a in rotation.convergents(_LONGEST) if q >= _SHORTEST]
    if len(orbits) < 4:
        raise InputError(
            f"rotation = {rotation.value!r} has the continued fraction {list(rotation.head)}…, "
            f"and only {len(orbits)} convergents with {_SHORTEST} ≤ q ≤ {_LONGEST}; its circle is "
            "that of a resonance for all that orbits tell. Take a number farther from p/q"
        )
    period = _period([a for _, _, a in orbits])
    compared = [(p, q) for p, q, _ in orbits[:: -(period or 1)]][::-1]
    crossings: list[Crossing] = []
    guess = _first_guess(*compared[0])
    for shorter, longer in pairwise(compared):
        crossings.append(_crossing(shorter, longer, guess))
        guess = crossings[-1].strength
        if progress is not None:
            progress(len(crossings), len(compared) - 1)
    strength, strength_error = _limit([x.strength for x in crossings], period is not None)
    omega, omega_error = _limit([x.omega for x in crossings], period is not None)
    circles = _circles(rotation.value, strength)
    return BreakUp(
        rotation,
        strength,
        strength_error,
        omega,
        omega_error,
        tuple(crossings),
        circles[-1] if circles else None,
        _by_norms(circles),
    )


def _period(quotients: list[int]) -> int | None:
    """The period of the last quotients, each of which repeats at least thrice.

    >>> _period([7, 1, 2, 1, 2, 1, 2, 1, 2]), _period([1, 1, 4, 1, 1, 6])
    (2, None)
    """
    for period in range(1, len(quotients) // 4 + 1):
        tail = quotients[-4 * period :]
        if tail == tail[:period] * 4:
            return period
    return None


def _first_guess(p: int, q: int) -> float:
    """K at which the residue of p/q passes ¼, Greene's first estimate."""
    low, high = 0.0, 1 / 16
    while high < 4 and _residue(p, q, high) < 0.25:
        low, high = high, high + 1 / 16
    if high >= 4:
        raise NumericsError(f"the residue of the orbit {p}/{q} stays below 1/4 up to K = 4")
    if low == 0.0:
        return high
    return float(brentq(lambda k: _residue(p, q, k) - 0.25, low, high, xtol=1e-6))


def _residue(p: int, q: int, strength: float) -> float:
    return periodic_orbit(p, q, strength).residue


def _crossing(shorter: tuple[int, int], longer: tuple[int, int], guess: float) -> Crossing:
    """Where log(R′/R) changes sign upwards, in a bracket that grows around the guess."""
    known: dict[tuple[int, int], PeriodicOrbit] = {}

    def orbit(kind: tuple[int, int], strength: float) -> PeriodicOrbit:
        known[kind] = periodic_orbit(*kind, strength, start=known.get(kind))
        return known[kind]

    def excess(strength: float) -> float:
        one, other = orbit(shorter, strength).residue, orbit(longer, strength).residue
        if abs(other) < _ROUNDING and abs(one) < 0.25:  # far below the break-up
            return -1.0
        if not (one > 0 and other > 0):
            raise NumericsError(
                f"the orbits {shorter[0]}/{shorter[1]} and {longer[0]}/{longer[1]} have the "
                f"residues {one:.3g} and {other:.3g} at K = {strength:.6g}, which do not compare"
            )
        return math.log(other / one)

    # Around the break-up log R changes by one over a distance of about 1/q.
    width = 0.25 / shorter[1]
    low, high = guess - width, guess + width
    while excess(low) > 0:
        low -= width
        if low <= 0:
            raise NumericsError(
                f"the orbits {shorter[0]}/{shorter[1]} and {longer[0]}/{longer[1]} have no common "
                f"residue below K = {guess:.6g}"
            )
    while excess(high) < 0:
        high += width
        if high > NO_CIRCLE + width:
            raise NumericsError(
                f"the orbits {shorter[0]}/{shorter[1]} and {longer[0]}/{longer[1]} have no common "
                f"residue up to K = {high:.6g}"
            )
    strength = float(brentq(excess, low, high, xtol=1e-13))
    last = orbit(longer, strength)
    return Crossing(shorter, longer, strength, last.residue, last.omega)


def _limit(values: list[float], alike: bool) -> tuple[float, float]:
    """The limit and its error: by Aitken's rule where the differences fall by one ratio."""
    changes = [b - a for a, b in pairwise(values)]
    if alike and len(changes) >= 3 and all(changes[-3:]):
        ratios = [b / a for a, b in pairwise(changes[-3:])]
        if max(map(abs, ratios)) < _SETTLED:
            before, last = (
                value + change * ratio / (1 - ratio)
                for value, change, ratio in zip(values[-2:], changes[-2:], ratios, strict=True)
            )
            return last, abs(last - before) + 4 * math.ulp(last)
    return values[-1], 2 * max(map(abs, changes[-3:]))


def _circles(rotation: float, strength: float) -> list[InvariantCircle]:
    """Those below K_c that are found, in order."""
    found = []
    for share in _BELOW:
        target = strength * (1 - share)
        if target >= NO_CIRCLE:
            break
        try:
            found.append(circle_at_rotation(rotation, target))
        except NumericsError:
            break
    return found


def _by_norms(circles: list[InvariantCircle]) -> float | None:
    """K_s from ‖U″‖ ∝ (K_s − K)^{−B} at three circles."""
    if len(circles) < len(_BELOW):
        return None
    k = [2 * circle.epsilon * circle.omega**2 for circle in circles]
    norms = [
        float(np.linalg.norm(np.arange(1, len(circle.sines) + 1) ** 2 * circle.sines))
        for circle in circles
    ]
    growth = math.log(norms[2] / norms[1]) / math.log(norms[1] / norms[0])

    def excess(end: float) -> float:
        return (
            math.log((end - k[1]) / (end - k[2])) / math.log((end - k[0]) / (end - k[1])) - growth
        )

    low, high = k[2] + 1e-9, k[2] + 1.0
    if not excess(low) > 0 > excess(high):
        return None
    return float(brentq(excess, low, high))
