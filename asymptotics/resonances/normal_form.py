r"""The normal form of any simple resonance JΩ/s ≈ ω_p of a rope, through order N.

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

With damping, gyroscopic terms or phases in the drive b is complex, and G a polynomial in ε, b and
b̄. The loop takes b = r e^{iφ} with r as the letter, once for each of N + 1 phases φ; since a
coefficient of b^l b̄^m has the factor e^{i(l−m)φ}, a discrete Fourier transform parts them. An edge
then is |A| = |B| for the linear part A b + B b̄, and D does not vanish: ω_p is where it is least.
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
from flint import acb, fmpq

from asymptotics.checks import finite_number, whole_number
from asymptotics.errors import InputError
from asymptotics.problems.free_frequencies import free_frequencies
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.resonances.bifurcation_equation import (
    Polynomial,
    edge_of,
    folds_of,
    followed,
    polynomial_of,
    roots_at,
)
from asymptotics.resonances.fold_range import ACCURACY
from asymptotics.resonances.rope_fold import LARGEST_Q, Resonant, placed, reduced
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.precision import PrecisionError, at_precision

Array = npt.NDArray[Any]

LEAST_ORDER, MOST_ORDER = 5, 25
"""N: from the first with two lower orders of its own parity that have a cubic, or nearly."""

_BITS = (160, 320, 640, 1280, 2560, 5120)
MOST_FREQUENCIES = 200
"""Free frequencies among which a rival is sought."""

_ROUNDING = 1e-9
# Around the resonance, as a share of Ω: farther off another free frequency is as near.
_FARTHEST = 0.5


@dataclass(frozen=True)
class Point:
    """A fold or an edge of a tongue.

    Attributes
    ----------
    epsilon, error
        ε, and twice the larger change between orders N, N − 2, N − 4.
    amplitude
        Of cos(JΩτ/s) in ξ_c, to leading order: −2b/a_m, |2b/a_m| for a complex b. 0 at an edge.
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
        Row n − 1 holds g_{n−k,k}, the coefficient of ε^{n−k} b^k, k = 0 … n; for a complex b, as a
        matrix over (k, l), that of ε^{n−k} b^l b̄^{k−l}.
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
        places = np.array(followed(polynomial)).reshape(-1, 1 + polynomial.unknowns)
        b = places[:, 1] if polynomial.real else places[:, 1] + 1j * places[:, 2]
        return places[:, 0], self._amplitude(b)

    def _amplitude(self, b: Any) -> Any:
        return 2 * np.abs(b / self.leading) if self.is_complex else -2 * b / self.leading

    @property
    def is_complex(self) -> bool:
        """Whether b is complex: damping, gyroscopic terms, phases in the drive."""
        return self.rows[0].ndim == 2

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
        self, what: str, found: Sequence[Sequence[tuple[float, complex]]]
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
            point = Point(same[0][0], error, float(self._amplitude(same[0][1])))
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
        """The amplitudes at one ε by order N, increasing: of all real roots b; of the branch
        from rest or from the edge for a complex b."""
        polynomial = self.polynomial()
        if not polynomial.real:
            return np.sort(self._amplitude(np.array(roots_at(polynomial, epsilon))))
        coefficients = np.zeros(self.order + 1)
        terms = polynomial.size * float(epsilon) ** polynomial.across
        np.add.at(coefficients, polynomial.along, terms)
        roots = np.roots(coefficients[::-1])
        real = roots[np.abs(roots.imag) <= 1e-9 * (np.abs(roots) + 1e-300)].real
        return np.sort(self._amplitude(real))


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
        As it was written down, with constant coefficients and a ground that does not give way. For
        s > 1 its coefficients may not hold Ω.
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
    values, start = placed(rope, at, p)
    resonance = subharmonic * start / q
    if not abs(omega - resonance) < _FARTHEST * resonance:
        raise InputError(
            f"Omega = {omega!r} is not near the resonance {subharmonic} omega_{p}/{q} = "
            f"{resonance:.8g}; give one within half of it"
        )
    _check_excited(rope, q, subharmonic)
    rows, leading = _rows(rope, values, q, subharmonic, omega, order, mirrored=False)
    other = None
    if subharmonic % 2 == 0 and rows[0].ndim == 1:
        other, _ = _rows(rope, values, q, subharmonic, omega, order, mirrored=True)
    rival = _rival(rope, at, p, q, subharmonic, omega, order)
    return NormalForm(p, q, subharmonic, start, omega, order, rows, other, leading, rival)


def _rival(
    rope: MovingContact, at: Mapping[Any, Any], p: int, q: int, s: int, omega: float, order: int
) -> tuple[int, int] | None:
    """(n, j) of the resonance sω_n/j nearest to Ω, j ≤ N, if it is no farther than sω_p/q."""
    given = {key: x for key, x in at.items() if str(key) != "Omega"}
    count, highest = p + 1, 2 * order * omega / s
    spectrum = np.real(free_frequencies(rope, given, count).values)
    while spectrum[-1] < highest and count < MOST_FREQUENCIES:
        count = min(2 * count, MOST_FREQUENCIES)
        spectrum = np.real(free_frequencies(rope, given, count).values)
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
                made = resonant.at(rate)
                leading = made.static.derivative(rope.contact_order).real
                rows = (_real_rows if made.even else _complex_rows)(resonant, rate, q, order)
            except PrecisionError:
                continue
            return rows, float(leading.mid())
    raise InputError(
        f"the normal form at Omega = {omega!r} is lost in {_BITS[-1]} bits: another resonance is "
        "too close"
    )


def _real_rows(resonant: Resonant, rate: Fraction, q: int, order: int) -> tuple[Array, ...]:
    """Row n: g_{n−k,k} over k = 0 … n, each narrow against itself."""
    found = reduced(resonant, rate, q, order)
    return tuple(np.array([_in_doubles([acb(g)])[0].real for g in row]) for row in found)


def _complex_rows(resonant: Resonant, rate: Fraction, q: int, order: int) -> tuple[Array, ...]:
    """Row n: g_{n−k,l,k−l} over k, l = 0 … n, zeros for l > k."""
    phases = order + 1
    # e^{i(l−m)φ} with φ = πp/(N + 1) is e^{−ikφ} e^{2ilφ}: a transform of N + 1 points in l.
    turns = [acb(fmpq(p, phases)).exp_pi_i() for p in range(phases)]
    sampled = [reduced(resonant, rate, q, order, turn) for turn in turns]
    rows = []
    for n in range(1, order + 1):
        row = np.zeros((n + 1, n + 1), dtype=complex)
        for k in range(n + 1):
            values = [sampled[p][n - 1][k] * turns[p] ** k for p in range(phases)]
            parted = [
                sum((v * turns[p] ** (-2 * power) for p, v in enumerate(values)), acb(0)) / phases
                for power in range(k + 1)
            ]
            row[k, : k + 1] = _in_doubles(parted)
        rows.append(row)
    return tuple(rows)


def _in_doubles(balls: Sequence[acb]) -> Array:
    """Centres of balls that are narrow against the largest; one around zero is a zero.

    Raises
    ------
    PrecisionError
        They are not narrow.
    """
    bound = 2.0**-52 * max(2.0**-200, *(float(abs(x).upper()) for x in balls))
    if not all(x.real.rad() <= bound and x.imag.rad() <= bound for x in balls):
        raise PrecisionError("coefficients of a normal form", balls)
    return np.array([0j if x.contains(0) else complex(x.mid()) for x in balls])
