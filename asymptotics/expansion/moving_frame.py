r"""The shape seen from the moving contact point: F_j(s, ε) of the paper's eq. (expandw).

A harmonic k of the shape solves a linear equation χ_k(∂)w = 0 of degree r, so the shift from the
static to the moving contact point reduces to finitely many series,

.. math:: e^{δ∂} ≡ \sum_{i<r} E_{k,i}(δ)\, ∂^i \mod χ_k(∂), \qquad
          \frac{dE_{k,i}}{dε} = \frac{dδ}{dε}\,(E_{k,i-1} + χ_{k,i} E_{k,r-1}).

(String: E₀ = cos kΩδ, E₁ = sin(kΩδ)/kΩ.) The differential equation in ε gives them order by order.
Nothing here uses the Taylor sums in d of :mod:`asymptotics.expansion.order_loop`, so that this
module also serves to prove them (:mod:`asymptotics.expansion.proof`). With φ_{k,l} the solution of
χ_k whose only non-zero derivative below r at 0 is ∂^l φ = 1,

.. math:: W(ξ_c + s, τ) = \sum_l G_l(θ) φ_l(s) + \sum_k \sum_l G_{k,l}(θ) φ_{k,l}(s),

the first sum being the static shape's.

Where the equation's coefficients vary with ξ nothing reduces: G_{k,l} are then Taylor coefficients
of W at the contact point, W = Σ G_l s^l/l! + …, and all reductions are zero.

Where the ring is not even in time, φ_{k,l} may be complex; the sum over k > 0 is then understood
with its complex conjugate added, and its G_{k,l} are complex functions of θ, stored for j < 0 too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any, Generic

from asymptotics.expansion.order_loop import Expansion, Progress, derivative_towers
from asymptotics.expansion.rounded import RoundedExpansion
from asymptotics.expansion.swept import SweptExpansion
from asymptotics.problems.problem import ContactCondition, Ground, Problem
from asymptotics.rings.harmonics import (
    Harmonics,
    Terms,
    both_sides,
    collect,
    convolve_into,
    folded,
    multiply_into,
)
from asymptotics.rings.ring import E, Ring
from asymptotics.rings.rounding import to_double

Series = list[Harmonics[E]]
"""A power series in the small parameter, entry n a Fourier series in θ."""


@dataclass(frozen=True)
class MovingFrame(Generic[E]):
    """The coefficients G of the module's docstring.

    Attributes
    ----------
    static
        ``static[l][n]``: Fourier coefficients of G_l at order n.
    modes
        ``modes[k][l][n]``: the same of G_{k,l}; on both sides when k > 0 and the ring is not even.
    right
        Where the ground gives way, the same of the rope beyond the contact point, s > 0.
    """

    expansion: Expansion[E]
    static: tuple[Series[E], ...]
    modes: dict[int, tuple[Series[E], ...]]
    right: MovingFrame[E] | None = None

    def left_at_contact(self, condition: ContactCondition, n: int) -> Harmonics[E]:
        """What order n leaves of a contact condition at s = 0: nothing, if it is right."""
        left = self.slope_at_contact(condition.derivative, n)
        if not condition.jump:
            return left
        assert self.right is not None
        ring = self.expansion.problem.ring
        minus = ring.rational(-1)
        terms: Terms[E] = {j: [minus * c] for j, c in left.items()}
        for j, c in self.right.slope_at_contact(condition.derivative, n).items():
            terms.setdefault(j, []).append(c)
        return collect(terms, ring)

    def slope_at_contact(self, l: int, n: int) -> Harmonics[E]:  # noqa: E741
        """∂^l W at s = 0, order n; l below every r."""
        ring = self.expansion.problem.ring
        terms: Terms[E] = {}
        for k, series in ((0, self.static), *self.modes.items()):
            real = series[l][n] if k == 0 or ring.even else folded(series[l][n], ring)
            for j, c in real.items():
                terms.setdefault(j, []).append(c)
        return collect(terms, ring)


def moving_frame(expansion: Expansion[E], progress: Progress | None = None) -> MovingFrame[E]:
    """Carry an expansion into the frame of the contact point.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> frame = moving_frame(expand(exact_string(), order=2))
    >>> frame.modes[1][0][2]         # cos Ωs at order ε̂²: −Ω²/4 (1 + cos 2θ)
    {2: (-Omega^2)/(8), 0: (-Omega^2)/(4)}
    """
    if isinstance(expansion, RoundedExpansion) and expansion.is_rounded():
        return _rounded_frame(expansion, progress)
    if isinstance(expansion, SweptExpansion) and expansion.is_swept():
        return _swept_frame(expansion, progress)
    ground = expansion.problem.ground
    if ground is None:
        return _one_side(expansion, None, progress)
    right = _one_side(expansion, ground, progress)
    return replace(_one_side(expansion, None, progress), right=right)


def _one_side(
    expansion: Expansion[E], ground: Ground[E] | None, progress: Progress | None
) -> MovingFrame[E]:
    """Left of the contact point, or on the ground right of it."""
    problem, last = expansion.problem, expansion.order
    ring = problem.ring
    derivative = derivative_towers(expansion, right=ground is not None)
    reduction = (lambda j: problem.mode(j).reduction) if ground is None else ground.reduction
    static_side: Problem[E] | Ground[E] = problem if ground is None else ground
    static_reduction = static_side.static_reduction
    if problem.varying is not None:
        # No finite set of functions is carried into itself by a shift. W's Taylor series at the
        # contact point is known as far as the orders reach.
        depth = last + problem.contact_order
        static_reduction = (ring.zero,) * (depth + 1)
        reduction = lambda j: (ring.zero,) * depth  # noqa: E731
    first = {}
    for n in range(last, 0, -1):
        for k in expansion.shape(n):
            first[k] = n
    shifts = {k: _Shift(ring, reduction(k), last - start) for k, start in first.items()}
    static_shift = _Shift(ring, static_reduction, last)
    R = len(static_reduction)
    static: tuple[Series[E], ...] = tuple([] for _ in range(R))
    modes: dict[int, tuple[Series[E], ...]] = {
        k: tuple([] for _ in range(shift.degree)) for k, shift in shifts.items()
    }
    for n in range(last + 1):
        deltas = [_stored(expansion.contact(i), ring) for i in range(1, n + 1)]
        static_shift.advance(deltas)
        for l in range(R):  # noqa: E741
            terms: Terms[E] = {}
            for i in range(R):
                value = static_side.static(l + i)
                if not ring.is_zero(value):
                    _multiply_into(terms, static_shift.series[i][n], {0: value}, ring)
            static[l].append(_half(collect(terms, ring)))
        for k, shift in shifts.items():
            shift.advance(deltas)
            for l, series in enumerate(modes[k]):  # noqa: E741
                terms = {}
                for source in range(first[k], n + 1):
                    if k not in expansion.shape(source):
                        continue
                    for i in range(shift.degree):
                        value = derivative(source, k, l + i)
                        if not ring.is_zero(value):
                            factor = shift.series[i][n - source]
                            _multiply_into(terms, factor, {k: value}, ring)
                series.append(_half(collect(terms, ring)) if k == 0 else collect(terms, ring))
        if progress is not None and n:
            progress(n)
    return MovingFrame(expansion, static, modes)


def _rounded_frame(expansion: RoundedExpansion, progress: Progress | None) -> MovingFrame[Any]:
    """From the balls, rounded as they are."""

    def groups(frame: MovingFrame[Any]) -> Iterator[Iterable[Any]]:
        for orders in zip(*chain(frame.static, *frame.modes.values()), strict=True):
            yield [c for harmonics in orders for c in harmonics.values()]
        if frame.right is not None:
            yield from groups(frame.right)

    def rounded(series: Series[Any]) -> Series[Any]:
        name = expansion.problem.name
        return [{j: to_double(c, name) for j, c in harmonics.items()} for harmonics in series]

    frame = expansion.certain(lambda balls: moving_frame(balls, progress), groups, progress)

    def each(frame: MovingFrame[Any]) -> MovingFrame[Any]:
        static = tuple(rounded(series) for series in frame.static)
        modes = {k: tuple(rounded(series) for series in rows) for k, rows in frame.modes.items()}
        right = None if frame.right is None else each(frame.right)
        return MovingFrame(expansion, static, modes, right)

    return each(frame)


def _swept_frame(expansion: SweptExpansion, progress: Progress | None) -> MovingFrame[Any]:
    """From the bounded doubles, and from balls where these lose too much."""

    def orders(frame: MovingFrame[Any]) -> list[Harmonics[Any]]:
        return [order for series in chain(frame.static, *frame.modes.values()) for order in series]

    frame, groups = expansion.settled(lambda each: moving_frame(each, progress), orders)
    settled = iter(groups)
    static = tuple([next(settled) for _ in series] for series in frame.static)
    modes = {
        k: tuple([next(settled) for _ in series] for series in rows)
        for k, rows in frame.modes.items()
    }
    return MovingFrame(expansion, static, modes)


def _stored(harmonics: Harmonics[E], ring: Ring[E]) -> Harmonics[E]:
    """A real series as the products below want it: both sides where they may be complex."""
    return harmonics if ring.even else both_sides(harmonics, ring)


def _multiply_into(terms: Terms[E], left: Harmonics[E], right: Harmonics[E], ring: Ring[E]) -> None:
    if ring.even:
        multiply_into(terms, left, right, ring)
    else:
        convolve_into(terms, left, right)


def _half(harmonics: Harmonics[E]) -> Harmonics[E]:
    """The stored half of a real series."""
    return {j: c for j, c in harmonics.items() if j >= 0}


class _Shift(Generic[E]):
    """The series E_{k,i} of e^{δ∂} modulo one harmonic's equation, an order at a time."""

    def __init__(self, ring: Ring[E], reduction: tuple[E, ...], last: int) -> None:
        self.ring, self.reduction, self.last = ring, reduction, last
        self.degree = len(reduction)
        self.series: list[Series[E]] = [[] for _ in range(self.degree)]

    def advance(self, deltas: Sequence[Harmonics[E]]) -> None:
        """Append order n = len(deltas), when it is still needed."""
        n, ring = len(deltas), self.ring
        if n > self.last:
            return
        if n == 0:
            for i, series in enumerate(self.series):
                series.append({0: ring.one} if i == 0 else {})
            return
        new = []
        for i in range(self.degree):
            terms: Terms[E] = {}
            for k in range(1, n + 1):
                weight = ring.rational(k, n)
                rate = {j: weight * c for j, c in deltas[k - 1].items()}
                if i > 0:
                    _multiply_into(terms, rate, self.series[i - 1][n - k], ring)
                if not ring.is_zero(self.reduction[i]):
                    rate = {j: c * self.reduction[i] for j, c in rate.items()}
                    _multiply_into(terms, rate, self.series[-1][n - k], ring)
            new.append(collect(terms, ring))
        for series, values in zip(self.series, new, strict=True):
            series.append(values)
