r"""The normal form of any simple resonance JΩ/s ≈ ω_p of an undamped rope, through order N.

Harmonics are counted in units of Ω/s: the drive has the multiples of s, and harmonic J is nearly
resonant. Its b = ∂^{m−1}w_J at ξ₀ is the second small parameter, and what the reduction
(:mod:`asymptotics.resonances.rope_fold`) leaves is

.. math:: G(ε, b; Ω) = D b + F ε^{J/s} + κ ε b + γ ε^2 b + α b^3 + … = 0,

exact through order N at the given Ω. Where s divides J the drive forces b, and a double root,
G = ∂G/∂b = 0, is a *fold*, where the wave-less state that begins at rest ends. Where it does not,
b = 0 is a state, and another one, whose period is s times the drive's, branches off where
∂G/∂b = 0 at b = 0: an edge of the *tongue*. ε = 0 is the backbone of free motions.

**The range.** It ends where another harmonic j ≤ N resonates as near: |Ω − sω_n/j| ≤ |Ω − sω_p/J|.
One amplitude does not suffice there; for the string, and next to a resonance as β → 0, that is
everywhere. Within, folds and edges are those of order N only as far as lower orders agree. One
parity of orders may add nothing to one of them, so orders N, N − 2 and, from N = 7 on, N − 4 are
compared. The error is twice the larger change; where it exceeds :data:`ACCURACY` of ε, or one of
the orders has no such point, Ω is outside the range: there is no number then. Harmonics above N
that resonate themselves can cut the branch in narrow loops of which no order up to N knows.

States even in time have a real b. For s = 2 and J odd they stand on one edge; those on the other
are even about the middle of the drive's period, which turns the sign of its odd harmonics.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import arb

from asymptotics.checks import finite_number, whole_number
from asymptotics.errors import InputError
from asymptotics.problems.free_frequencies import free_frequencies
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.resonances.fold_range import ACCURACY
from asymptotics.resonances.rope_fold import LARGEST_Q, Resonant, reduced, reducible
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.precision import PrecisionError, at_precision

Array = npt.NDArray[np.float64]

LEAST_ORDER, MOST_ORDER = 5, 25
"""N: from the first with two lower orders of its own parity that have a cubic, or nearly."""

_BITS = (160, 320, 640, 1280, 2560, 5120)
MOST_FREQUENCIES = 200
"""Free frequencies among which a rival is sought."""

_ROUNDING = 1e-9
# Around the resonance, as a share of Ω: farther off another free frequency is as near.
_FARTHEST = 0.5
# Of the curve G = 0, in units in which the leading terms are of order one.
_STEP, _REACH, _MOST_STEPS = 0.02, 4.0, 4000


@dataclass(frozen=True)
class Point:
    """A fold or an edge of a tongue.

    Attributes
    ----------
    epsilon, error
        ε, and twice the larger change between orders N, N − 2, N − 4.
    amplitude
        Of cos(JΩτ/s) in ξ_c, to leading order: −2b/a_m. 0 at an edge.
    """

    epsilon: float
    error: float
    amplitude: float


@dataclass(frozen=True)
class NormalForm:
    """G at one Ω.

    Attributes
    ----------
    p, q, subharmonic
        ω_p, J and s: JΩ/s ≈ ω_p.
    frequency
        ω_p.
    omega, order
        Ω and N.
    rows
        Row n − 1 holds g_{n−k,k}, the coefficient of ε^{n−k} b^k, k = 0 … n.
    mirrored
        The rows for the drive half a period later; None where they say nothing new.
    leading
        a_m, the first derivative of the static shape at ξ₀ that is not zero.
    rival
        (n, j) where another harmonic's resonance sω_n/j is as near to Ω; None where none is.
    """

    p: int
    q: int
    subharmonic: int
    frequency: float
    omega: float
    order: int
    rows: tuple[Array, ...] = field(repr=False)
    mirrored: tuple[Array, ...] | None = field(repr=False)
    leading: float
    rival: tuple[int, int] | None

    @property
    def resonance(self) -> float:
        """sω_p/J."""
        return self.subharmonic * self.frequency / self.q

    @property
    def forced(self) -> bool:
        """Whether the drive forces b, s | J, so that there are folds and no tongue."""
        return self.subharmonic == 1

    def folds(self) -> tuple[Point, ...]:
        """The folds on the branch that begins at rest, in its order; () where no order has any.

        The first ends the wave-less state. Later ones are given as far as all orders have them.

        Raises
        ------
        InputError
            Ω is outside the range.
        """
        if not self.forced:
            return ()
        return self._agreed("fold", [folds_of(polynomial) for polynomial in self._compared()])

    def edge(self) -> Point | None:
        """Where the tongue begins at this Ω: another state branches off b = 0; None for s | J.

        Raises
        ------
        InputError
            Ω is outside the range.
        """
        if self.forced:
            return None
        found = self._agreed("edge", [edge_of(polynomial) for polynomial in self._compared()])
        return found[0] if found else None

    def branch(self, order: int | None = None) -> tuple[Array, Array]:
        """ε and the amplitude −2b/a_m along G = 0: from rest, or from the tongue's edge.

        By ``order`` ≤ N; as far as the leading balance reaches.
        """
        polynomial = self.polynomial(order)
        places = followed(polynomial) if self.forced else followed_from_edge(polynomial)
        curve = np.array(places).reshape(-1, 2)
        return curve[:, 0], -2 * curve[:, 1] / self.leading

    def polynomial(self, order: int | None = None) -> Polynomial:
        """G through an order; of the two drives, for s even, the one whose edge comes first."""
        rows = [self.rows] if self.mirrored is None else [self.rows, self.mirrored]
        both = [polynomial_of(each[: order or self.order]) for each in rows]
        edges = [edge_of(each) for each in both]
        first = [edge[0][0] if edge else math.inf for edge in edges]
        return both[first.index(min(first))]

    def _compared(self) -> list[Polynomial]:
        return [self.polynomial(n) for n in self.compared]

    @property
    def compared(self) -> tuple[int, ...]:
        """N, N − 2 and, where that has a cubic, N − 4."""
        return tuple(n for n in (self.order, self.order - 2, self.order - 4) if n >= 3)

    def _agreed(
        self, what: str, found: Sequence[Sequence[tuple[float, float]]]
    ) -> tuple[Point, ...]:
        """The points of order N, in the branch's order, as far as the lower orders have them."""
        if self.rival is not None:
            n, j = self.rival
            raise InputError(
                f"Omega = {self.omega!r} is outside the range of the normal form at "
                f"{self.resonance:.8g}: harmonic {j} resonates with omega_{n} as near, and one "
                "amplitude does not suffice. Move Omega towards the resonance, lower the order, or "
                "look for the state itself (ropewave state)"
            )
        points: list[Point] = []
        for same in zip(*found, strict=False):
            changes = [abs(a[0] - b[0]) for a, b in pairwise(same)]
            error = 2 * max(changes)
            point = Point(same[0][0], error, -2 * same[0][1] / self.leading)
            if not point.error <= ACCURACY * point.epsilon:
                break
            points.append(point)
        if points or not any(found):
            return tuple(points)
        tried = ", ".join(
            f"at epsilon = {points[0][0]:.4g} by order {n}" if points else f"nowhere by order {n}"
            for n, points in zip(self.compared, found, strict=True)
        )
        raise InputError(
            f"Omega = {self.omega!r} is outside the range of the normal form at "
            f"{self.resonance:.8g}: the {what} is {tried}. Move Omega towards the resonance, or "
            "look for the state itself (ropewave state)"
        )

    def amplitudes(self, epsilon: float) -> Array:
        """The real roots b of G at one ε by order N, increasing, as amplitudes −2b/a_m."""
        polynomial = self.polynomial()
        coefficients = np.zeros(self.order + 1)
        terms = polynomial.size * float(epsilon) ** polynomial.across
        np.add.at(coefficients, polynomial.along, terms)
        roots = np.roots(coefficients[::-1])
        real = roots[np.abs(roots.imag) <= 1e-9 * (np.abs(roots) + 1e-300)].real
        return np.sort(-2 * real / self.leading)


def normal_form(
    rope: MovingContact,
    at: Mapping[Any, Any],
    p: int,
    q: int,
    omega: float,
    order: int = 9,
    subharmonic: int = 1,
) -> NormalForm:
    """G at Ω of the resonance qΩ/s ≈ ω_p.

    Parameters
    ----------
    rope
        As for :func:`asymptotics.resonances.rope_fold.rope_fold`. For s > 1 its coefficients may
        not hold Ω.
    at
        Symbol or name ↦ number, without Ω.
    p, q, subharmonic
        ω_p, J and s, without a common divisor of J and s.
    omega
        Ω, nearer to sω_p/J than half of it.
    order
        N, 5 … 25.

    Raises
    ------
    InputError
        Anything else; a harmonic that neither the drive nor a parametric term reaches; another
        resonance so close that the coefficients are lost.

    Examples
    --------
    >>> from asymptotics.problems.presets import beam
    >>> form = normal_form(beam(), {"beta": 0.01}, 1, 1, 3.2, order=7)
    >>> (fold,) = form.folds()
    >>> round(fold.epsilon, 6), fold.error < 1e-5
    (0.001386, True)
    """
    whole_number("q", q, LARGEST_Q)
    whole_number("subharmonic", subharmonic, LARGEST_Q)
    if math.gcd(q, subharmonic) > 1:
        raise InputError(
            f"harmonic {q} of Omega/{subharmonic} has a period of fewer than {subharmonic} of the "
            f"drive's; cancel the common divisor"
        )
    omega = finite_number("Omega", omega)
    if not isinstance(order, int) or not LEAST_ORDER <= order <= MOST_ORDER:
        raise InputError(f"order = {order!r}; give {LEAST_ORDER} … {MOST_ORDER}")
    if subharmonic > 1 and rope.depends_on_frequency:
        raise InputError(f"{rope}: its coefficients hold Omega; subharmonics need them without")
    values, start = reducible(rope, at, p)
    resonance = subharmonic * start / q
    if not abs(omega - resonance) < _FARTHEST * resonance:
        raise InputError(
            f"Omega = {omega!r} is not near the resonance {subharmonic} omega_{p}/{q} = "
            f"{resonance:.8g}; give one within half of it"
        )
    _check_excited(rope, q, subharmonic)
    rows, leading = _rows(rope, values, q, subharmonic, omega, order, mirrored=False)
    other = None
    if subharmonic % 2 == 0:
        other, _ = _rows(rope, values, q, subharmonic, omega, order, mirrored=True)
    rival = _rival(rope, at, p, q, subharmonic, omega, order)
    return NormalForm(p, q, subharmonic, start, omega, order, rows, other, leading, rival)


def _rival(
    rope: MovingContact, at: Mapping[Any, Any], p: int, q: int, s: int, omega: float, order: int
) -> tuple[int, int] | None:
    """(n, j) of the resonance sω_n/j nearest to Ω, j ≤ N, if it is no farther than sω_p/q."""
    given = {key: x for key, x in at.items() if str(key) != "Omega"}
    count, highest = p + 1, 2 * order * omega / s
    spectrum = np.array(free_frequencies(rope, given, count).values)
    while spectrum[-1] < highest and count < MOST_FREQUENCIES:
        count = min(2 * count, MOST_FREQUENCIES)
        spectrum = np.array(free_frequencies(rope, given, count).values)
    drive = sorted({q, *(s * abs(j) for c in rope.driven_end for j in c.drive)})
    harmonics = sorted({j for n in range(1, order + 1) for j in reachable(drive, n) if j})
    harmonics = [j for j in harmonics if j <= order]
    distance = abs(s * spectrum / np.array(harmonics)[:, None] - omega)
    if q in harmonics:
        distance[harmonics.index(q), p - 1] = math.inf
    row, n = np.unravel_index(np.argmin(distance), distance.shape)
    # Multiples of one frequency, the string's, are equally far but for rounding.
    own = abs(s * spectrum[p - 1] / q - omega) * (1 + _ROUNDING) + _ROUNDING * omega
    return (int(n) + 1, harmonics[row]) if distance[row, n] <= own else None


def _check_excited(rope: MovingContact, q: int, subharmonic: int) -> None:
    """For s = 1 the drive has to reach harmonic q; else b = 0 is a state, whatever it reaches."""
    drive = sorted({abs(j) for c in rope.driven_end for j in c.drive})
    if subharmonic == 1 and not any(q in reachable(drive, n) for n in range(1, 2 * LARGEST_Q)):
        raise InputError(f"harmonic {q} is not excited by a drive of harmonics {drive}")


def _rows(
    rope: MovingContact,
    values: Mapping[str, Fraction],
    q: int,
    s: int,
    omega: float,
    order: int,
    mirrored: bool,
) -> tuple[tuple[Array, ...], float]:
    """G in doubles, each coefficient with all its digits, and a_m."""
    driven = tuple(
        replace(c, drive={s * j: a * (-1) ** (j * mirrored) for j, a in c.drive.items()})
        for c in rope.driven_end
    )
    resonant = Resonant(replace(rope, driven_end=driven), values, q)
    rate = Fraction(omega) * q / s
    for bits in _BITS:
        with at_precision(bits):
            try:
                found = reduced(resonant, rate, q, order)
                leading = resonant.at(rate).static.derivative(rope.contact_order).real
            except PrecisionError:
                continue
            if all(_narrow(g) for row in found for g in row):
                rows = tuple(np.array([float(g.mid()) for g in row]) for row in found)
                return rows, float(leading.mid())
    raise InputError(
        f"the normal form at Omega = {omega!r} is lost in {_BITS[-1]} bits: another resonance is "
        "too close"
    )


def _narrow(ball: arb) -> bool:
    return bool(ball.rad() <= 2.0**-52 * max(float(ball.abs_upper()), 2.0**-200))


@dataclass(frozen=True)
class Polynomial:
    """Σ g ε^i b^j: i, j and g as arrays ``across``, ``along``, ``size``."""

    across: npt.NDArray[np.intp]
    along: npt.NDArray[np.intp]
    size: Array

    def __call__(self, place: Array) -> tuple[float, list[float]]:
        """G and ∂G/∂ε, ∂G/∂b, ∂²G/∂b∂ε, ∂²G/∂b² at (ε, b)."""
        i, j = self.across, self.along
        x, y = (place[0] ** np.arange(i.max() + 1), place[1] ** np.arange(j.max() + 1))
        by_x, by_y, by_yy = i * x[i - 1], j * y[j - 1], j * (j - 1) * y[j - 2]
        parts = (x[i] * y[j], by_x * y[j], x[i] * by_y, by_x * by_y, x[i] * by_yy)
        g, *rest = (float(self.size @ part) for part in parts)
        return g, rest

    def first(self, i: int | None = None, j: int | None = None) -> tuple[int, float]:
        """The lowest power of the one letter where the other has the power given, and its size."""
        fixed, free = (self.across, self.along) if i is not None else (self.along, self.across)
        rows = np.flatnonzero(fixed == (i if i is not None else j))
        row = rows[np.argmin(free[rows])]
        return int(free[row]), float(self.size[row])

    def scaled(self, epsilon: float, b: float) -> Polynomial:
        """In ε and b over these units, the largest coefficient one."""
        size = self.size * float(epsilon) ** self.across * float(b) ** self.along
        return replace(self, size=size / np.abs(size).max())

    def over_b(self) -> Polynomial:
        """G/b, for a G without a term free of b."""
        return replace(self, along=self.along - 1)


def polynomial_of(rows: Sequence[Array]) -> Polynomial:
    """G of rows g_{n−k,k}, without the coefficients that are zero."""
    terms = [(n - k, k, g) for n, row in enumerate(rows, start=1) for k, g in enumerate(row) if g]
    across, along, size = zip(*terms, strict=True)
    return Polynomial(np.array(across), np.array(along), np.array(size, dtype=float))


def _units(polynomial: Polynomial) -> tuple[float, float]:
    """ε and b at which D b, α b³ and the first other term are alike."""
    detuning = abs(polynomial.first(i=0)[1])
    cubics = polynomial.size[(polynomial.across == 0) & (polynomial.along == 3)]
    b = math.sqrt(detuning / abs(cubics[0])) if cubics.size else 1.0
    if (polynomial.along == 0).any():
        power, drive = polynomial.first(j=0)
        return float((detuning * b / abs(drive)) ** (1 / power)), b
    edge = edge_of(polynomial)
    return (edge[0][0] if edge else 1.0), b


def followed(polynomial: Polynomial) -> list[Array]:
    """(ε, b) along G = 0 from rest, by arclength.

    It ends where ε returns to 0, on the backbone, or where ε or b have left the leading balance far
    behind.
    """
    units = np.array(_units(polynomial))
    scaled = polynomial.scaled(*units)
    by_x, by_y = scaled(np.zeros(2))[1][:2]
    return [place * units for place in _traced(scaled, np.zeros(2), np.array([by_y, -by_x]))]


def followed_from_edge(polynomial: Polynomial) -> list[Array]:
    """(ε, b) along G/b = 0 from the tongue's edge, b > 0; empty where there is no edge."""
    edge = edge_of(polynomial)
    if not edge:
        return []
    units = np.array(_units(polynomial))
    scaled = polynomial.over_b().scaled(*units)
    return [
        place * units for place in _traced(scaled, np.array(edge[0]) / units, np.array([0.0, 1.0]))
    ]


def _traced(scaled: Polynomial, place: Array, tangent: Array) -> list[Array]:
    """Pseudo-arclength from a place, towards ε > 0 or, where ε stands still, b > 0."""
    tangent = tangent / np.linalg.norm(tangent)
    if tangent @ np.array([1.0, 1e-9]) < 0:
        tangent = -tangent
    places = [place]
    for _ in range(_MOST_STEPS):
        place, tangent = _along(scaled, place, tangent)
        if not (0 < place[0] < _REACH and abs(place[1]) < _REACH):
            break
        places.append(place)
    return places


def folds_of(polynomial: Polynomial) -> list[tuple[float, float]]:
    """(ε, b) of the folds on the branch G = 0 that begins at rest.

    >>> cubic = [np.array([-1.0, 1.5]), np.zeros(3), np.array([0.0, 0.0, 0.0, -0.5])]
    >>> [(round(x, 6), round(y, 6)) for x, y in folds_of(polynomial_of(cubic))]
    [(1.0, 1.0)]
    """
    units = np.array(_units(polynomial))
    scaled = polynomial.scaled(*units)
    found = []
    places = [place / units for place in followed(polynomial)]
    slopes = [scaled(place)[1][1] for place in places]
    for place, before, after in zip(places[1:], slopes, slopes[1:], strict=False):
        fold = _refined(scaled, place) if before * after < 0 else None
        if fold is not None:
            found.append((float(fold[0] * units[0]), float(fold[1] * units[1])))
    return found


def _along(scaled: Polynomial, place: Array, tangent: Array) -> tuple[Array, Array]:
    """One step along G = 0, and the tangent there."""
    target = place + _STEP * tangent
    for _ in range(8):
        g, gradient = scaled(target)
        matrix = np.array([gradient[:2], list(tangent)])
        step = np.linalg.solve(matrix, np.array([g, float(tangent @ (target - place)) - _STEP]))
        target = target - step
        if np.abs(step).max() < 1e-12:
            break
    gradient = scaled(target)[1]
    turned = np.array([gradient[1], -gradient[0]])
    turned /= np.linalg.norm(turned)
    return target, turned if turned @ tangent > 0 else -turned


def _refined(scaled: Polynomial, place: Array) -> Array | None:
    """The double root next to a place, by Newton."""
    start = place
    for _ in range(20):
        g, (by_x, by_y, by_xy, by_yy) = scaled(place)
        step = np.linalg.solve(np.array([[by_x, by_y], [by_xy, by_yy]]), [g, by_y])
        place = place - step
        if not np.abs(place - start).max() < 4 * _STEP:
            return None
        if np.abs(step).max() < 1e-13:
            break
    return place


def edge_of(polynomial: Polynomial) -> list[tuple[float, float]]:
    """(ε, 0) at the least ε > 0 with ∂G/∂b = 0 at b = 0; empty where there is none.

    >>> edge_of(polynomial_of([np.array([0.0, 1.0]), np.array([0.0, -4.0, 0.0])]))
    [(0.25, 0.0)]
    """
    linear = polynomial.along == 1
    coefficients = np.zeros(int(polynomial.across.max()) + 1)
    np.add.at(coefficients, polynomial.across[linear], polynomial.size[linear])
    roots = np.roots(coefficients[::-1])
    real = roots[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0)].real
    return [(float(real.min()), 0.0)] if real.size else []
