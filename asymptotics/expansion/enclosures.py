r"""The string's problem itself, in balls at random frequencies.

Over the exact ring Ω and c are letters: a proof there holds whatever they stand for. Here they get
their meaning. At a frequency Ω, with c = cot Ω, the coefficients become balls, and the truncated
series are put into

.. math:: W_{ττ} = W_{ξξ} − 2, \quad W(0, τ) = 1 + ε\, ΔZ(τ), \quad W = W_ξ = 0 \text{ at } ξ_c(τ)

(the paper's eqs. rope, forcing), stated here once more and with nothing of the engine, of the
problem or of the ring's relations: the static shape is (ξ − 1)², harmonic j is
:math:`[v \cos jΩ(ξ − 1) + v' \sin jΩ(ξ − 1)/jΩ] \cos jΩτ`, which solves the equation, and the
amplitude at the driven end is A_j sin jΩ (for ΔZ = cos Ωτ and ε̂ = ε/sin Ω: ½ sin Ω). With
ξ_c = 1 + δ a power series in ε̂ at a random time, so are cos jΩδ, sin jΩδ, W and W_ξ, and every
coefficient through ε̂^N has to contain zero.

The balls are narrow, at most :data:`WIDEST` of the terms: what is not zero by more is seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from flint import arb, arb_poly, fmpq

from asymptotics.expansion.order_loop import Expansion
from asymptotics.rings.cotangent import CotangentElement, resonance_polynomial
from asymptotics.rings.precision import at_precision

WIDEST = 1e-30
"""No residual's radius is larger, over the sum of its terms' magnitudes."""

POINTS = 3
_MOST_BITS = 1 << 14

Pair = tuple[arb, arb]
"""A residual and the sum of the magnitudes of its terms."""


@dataclass(frozen=True)
class Enclosure:
    """What the string's problem leaves at one frequency and time.

    Attributes
    ----------
    omega, tau
        Ω and τ, exactly.
    static
        Whether the static shape is (ξ − 1)².
    orders
        For each order n ≥ 1 whether all its residuals contain zero.
    radius
        The largest radius, over the sum of the terms' magnitudes.
    """

    omega: Fraction
    tau: Fraction
    static: bool
    orders: tuple[bool, ...]
    radius: float

    @property
    def holds(self) -> bool:
        """Static shape and every order."""
        return self.static and all(self.orders)


def enclosures(
    expansion: Expansion[CotangentElement], points: int = POINTS
) -> tuple[Enclosure, ...]:
    """The expansion put into the string's problem at random Ω and τ.

    The points are drawn from 0 < Ω, τ < 2π, the same ones each time for the same order.

    Parameters
    ----------
    expansion
        Over :class:`~asymptotics.rings.cotangent.CotangentRing`; θ = Ωτ, and the small parameter
        and the scaled drive are those of :func:`asymptotics.problems.string.string_problem`.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> [point.holds for point in enclosures(expand(exact_string(), 3))]
    [True, True, True]
    """
    values = _Values(expansion)
    random = Random(expansion.order)

    def draw() -> Fraction:
        return Fraction(random.randrange(1, 6 << 20), 1 << 20)

    return tuple(values.enclose(draw(), draw()) for _ in range(points))


class _Values:
    """The numerators of an expansion, made ready for values at several frequencies."""

    def __init__(self, expansion: Expansion[CotangentElement]) -> None:
        self.expansion, problem = expansion, expansion.problem
        elements = {id(element): element for element in self._elements()}
        self.rows = {key: (element, element.rows()) for key, element in elements.items()}
        parabola = {0: 0, 1: 0, 2: 2}
        ring = problem.ring
        self.static = problem.contact_order == 2 and all(
            ring.is_zero(ring.sum([problem.static(d), ring.rational(-parabola.get(d, 0))]))
            for d in range(expansion.order + 3)
        )

    def _elements(self) -> Iterator[CotangentElement]:
        yield from self.expansion.problem.drive.values()
        for order in self.expansion.orders:
            yield from order.contact.values()
            for start in order.shape.values():
                yield from start

    def enclose(self, omega: Fraction, tau: Fraction) -> Enclosure:
        """With as many bits as make the balls narrow."""
        bits = 128
        while True:
            with at_precision(bits):
                orders = self._residuals(omega, tau)
                residuals = [residual for pairs in orders for residual, _ in pairs]
                width = max(
                    (float(r.rad() / scale) for pairs in orders for r, scale in pairs), default=0.0
                )
                narrow = width <= WIDEST and all(r.is_finite() for r in residuals)
                if narrow or bits >= _MOST_BITS:
                    holds = tuple(narrow and all(r.contains(0) for r, _ in o) for o in orders)
                    return Enclosure(omega, tau, self.static, holds, width)
            bits *= 2

    def _residuals(self, omega: Fraction, tau: Fraction) -> list[list[Pair]]:
        """What each order leaves, in the precision of the current context."""
        place, time = (arb(fmpq(x.numerator, x.denominator)) for x in (omega, tau))
        value = self._at(place)
        last = self.expansion.order
        contact = [{j: value[id(c)] for j, c in o.contact.items()} for o in self.expansion.orders]
        shape = [
            {j: [value[id(x)] for x in start] for j, start in o.shape.items()}
            for o in self.expansion.orders
        ]
        drive = {j: value[id(a)] for j, a in self.expansion.problem.drive.items()}
        harmonics = {j for row in shape for j in row}
        weight = {j: (j * place * time).cos() * (2 if j else 1) for j in harmonics.union(*contact)}
        delta = [arb(0)] + [_total([weight[j] * c for j, c in row.items()])[0] for row in contact]
        waves = {j: _Waves(j * place, delta) for j in harmonics}
        found = []
        for n in range(1, last + 1):
            pairs = []
            for j, (v, slope) in shape[n - 1].items():
                moved = drive.get(j, arb(0)) if n == 1 else arb(0)
                pairs.append(_driven_end(j * place, v, slope, moved))
            for e in (0, 1):
                terms = (
                    [delta[k] * delta[n - k] for k in range(n + 1)] if e == 0 else [2 * delta[n]]
                )
                for m in range(1, n + 1):
                    for j, (v, slope) in shape[m - 1].items():
                        left, right = waves[j].coefficients(e, n - m)
                        terms += [weight[j] * v * left, weight[j] * slope * right]
                pairs.append(_total(terms))
            found.append(pairs)
        return found

    def _at(self, omega: arb) -> Mapping[int, arb]:
        """Every coefficient at Ω and c = cot Ω."""
        c = omega.cot()
        top = max((max(rows, default=0) for _, rows in self.rows.values()), default=0)
        powers = [omega**a for a in range(top + 1)]
        below: dict[int, arb] = {}

        def resonance(q: int) -> arb:
            if q not in below:
                below[q] = arb_poly(resonance_polynomial(q))(c)
            return below[q]

        out = {}
        for key, (element, rows) in self.rows.items():
            total = arb(0)
            for a, row in rows.items():
                total += powers[a] * arb_poly(row)(c)
            for q, power in enumerate(element.poles, start=2):
                if power:
                    total /= resonance(q) ** power
            out[key] = total / element.denominator
        return out


class _Waves:
    """cos kδ and sin kδ/k (or 1 and δ) as power series, and their derivatives in δ."""

    def __init__(self, k: arb, delta: list[arb]) -> None:
        self.minus_square = -k * k
        self.cosine, self.sine = [arb(1)], [arb(0)]
        for n in range(1, len(delta)):
            rates = [(i * delta[i], n - i) for i in range(1, n + 1)]
            sine = sum((rate * self.cosine[rest] for rate, rest in rates), arb(0)) / n
            cosine = sum((rate * self.sine[rest] for rate, rest in rates), arb(0)) / n
            self.sine.append(sine)
            self.cosine.append(self.minus_square * cosine)

    def coefficients(self, e: int, n: int) -> tuple[arb, arb]:
        """Of order n in the e-th derivative of both, e = 0 or 1."""
        if e == 0:
            return self.cosine[n], self.sine[n]
        return self.minus_square * self.sine[n], self.cosine[n]


def _driven_end(k: arb, v: arb, slope: arb, amplitude: arb) -> Pair:
    """Harmonic k at ξ = 0, where it has to be A sin k (the mean, k = 0: A)."""
    if k == 0:
        return _total([v, -slope, -amplitude])
    return _total([v * k.cos(), -slope * k.sin() / k, -amplitude * k.sin()])


def _total(terms: list[arb]) -> Pair:
    scale = sum((abs(term).abs_upper() for term in terms), arb(0))
    return sum(terms, arb(0)), scale if scale > 0 else arb(1)
