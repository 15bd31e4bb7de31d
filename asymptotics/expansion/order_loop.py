r"""The expansion of shape and contact point in the forcing amplitude, to any order.

With ξ_c = ξ₀ + δ, the contact conditions e = 0 … m − 1 say that

.. math:: \sum_d \frac{δ^d}{d!} ∂_ξ^{d+e} W(ξ_0) = 0

order by order in ε (the paper's eq. BC3 to every order). Both factors are unknown, but
triangularly: at order n, conditions e ≤ m − 2 do not contain ξ_n and give the contact data of w_n;
the impedances give all its other derivatives; condition e = m − 1 then gives ξ_n.

The loop reads its conditions from a list: which derivative of which side; the last one determines
ξ_n, the others are the contact data. On a ground that gives way these are that nothing jumps,
:math:`\sum δ^d/d!\,[∂^{d+e}W] = 0` for e < r, and W = 0 from the left is the last.

The sums are nested as in Horner's rule. With T_d = ∂^d W(ξ₀) and

.. math:: H^{(e)}_d = T_{d+e} + \frac{δ}{d+1} H^{(e)}_{d+1}, \qquad ∂_ξ^e W(ξ_c) = H^{(e)}_0,

order n needs only the *tails* H_d with order + d = n, each one product of two series. That is
N⁵/240 ring products to order N instead of the N⁵/60 of explicit powers of δ, and an order,
once computed, is never touched again: extending an expansion appends to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Protocol

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.problems.problem import ContactCondition, Problem, Varying
from asymptotics.rings.harmonics import Harmonics, Terms, collect, multiply_into, reachable
from asymptotics.rings.precision import PrecisionError
from asymptotics.rings.ring import E

Progress = Callable[[int], None]


class Rope(Protocol):
    """What becomes a problem at values of its parameters."""

    def at(self, at: Mapping[Any, Any] | None) -> Problem[Any]:
        """The problem there."""

    def check_resonance(self, at: Mapping[Any, Any] | None, harmonics: Sequence[int]) -> None:
        """Raise a ResonanceError where one of the harmonics has a pole there."""


@dataclass(frozen=True)
class Order(Generic[E]):
    """What order n of the small parameter adds.

    Attributes
    ----------
    contact
        ξ_n as Fourier coefficients ``{j: c_j}``, ξ_n = c₀ + Σ 2 c_j cos jθ.
    shape
        For each harmonic j of w_n its first r derivatives at ξ₀; from the left and then from the
        right where the ground gives way.
    tails
        ``tails[e][d − 1]`` is H^{(e)}_d at order n − d, for d = 1 … n − 1; e counts the conditions.
    """

    contact: Harmonics[E]
    shape: dict[int, tuple[E, ...]]
    tails: tuple[tuple[Harmonics[E], ...], ...]


@dataclass(frozen=True)
class Expansion(Generic[E]):
    """An immutable expansion to order ``len(orders)``; extend it with :func:`expand`."""

    problem: Problem[E]
    orders: tuple[Order[E], ...] = field(repr=False)

    @property
    def order(self) -> int:
        """The highest order N."""
        return len(self.orders)

    def contact(self, n: int) -> Harmonics[E]:
        """ξ_n, the coefficient of the n-th power of the small parameter in ξ_c."""
        return self._at(n).contact

    def shape(self, n: int) -> dict[int, tuple[E, ...]]:
        """First r derivatives at ξ₀ of each harmonic of w_n."""
        return self._at(n).shape

    def _at(self, n: int) -> Order[E]:
        if not 1 <= n <= self.order:
            raise InputError(
                f"order n = {n!r} is not in this expansion, which holds orders 1 … {self.order}; "
                f"extend it with expand(..., order={n!r}, start=expansion)"
            )
        return self.orders[n - 1]


class _Towers(Generic[E]):
    """∂^d w_n(ξ₀) for any d, harmonic by harmonic, by the PDE's own recurrence."""

    def __init__(self, problem: Problem[E]) -> None:
        self.problem = problem
        self.known: dict[tuple[int, int], list[E]] = {}
        self.beyond: dict[tuple[int, int], list[E]] = {}

    def add(self, n: int, shape: dict[int, tuple[E, ...]]) -> None:
        for j, start in shape.items():
            r = len(self.problem.mode(j).reduction)
            self.known[n, j] = list(start[:r])
            if self.problem.ground is not None:
                self.beyond[n, j] = list(start[r:])

    def at(self, condition: ContactCondition, n: int, j: int, d: int) -> E:
        """∂^d of what a condition is about."""
        left = self.derivative(n, j, d)
        if not condition.jump:
            return left
        ring = self.problem.ring
        return ring.sum([self.right(n, j, d), ring.rational(-1) * left])

    def derivative(self, n: int, j: int, d: int) -> E:
        if self.problem.varying is not None:
            return self._by_leibniz(self.known[n, j], self.problem.varying, j, d)
        return self._grown(self.known[n, j], self.problem.mode(j).reduction, d)

    def right(self, n: int, j: int, d: int) -> E:
        assert self.problem.ground is not None
        return self._grown(self.beyond[n, j], self.problem.ground.reduction(j), d)

    def _by_leibniz(self, tower: list[E], varying: Varying[E], j: int, d: int) -> E:
        while len(tower) <= d:
            weights = varying.weights(j, len(tower))
            products = [chi * t for chi, t in zip(weights, tower, strict=True)]
            tower.append(self.problem.ring.sum(products))
        return tower[d]

    def _grown(self, tower: list[E], reduction: tuple[E, ...], d: int) -> E:
        ring, r = self.problem.ring, len(reduction)
        while len(tower) <= d:
            below = tower[-r:]
            tower.append(
                ring.sum(
                    [
                        chi * t
                        for chi, t in zip(reduction, below, strict=True)
                        if not ring.is_zero(chi) and not ring.is_zero(t)
                    ]
                )
            )
        return tower[d]


def derivative_towers(expansion: Expansion[E], right: bool = False) -> Callable[[int, int, int], E]:
    """(n, j, d) ↦ ∂^d of harmonic j of w_n at ξ₀, for an expansion already computed.

    ``right`` asks for those beyond the contact point, of a ground that gives way.
    """
    towers = _Towers(expansion.problem)
    for n, order in enumerate(expansion.orders, start=1):
        towers.add(n, order.shape)
    return towers.right if right else towers.derivative


def expand(
    problem: Problem[E] | Rope,
    order: int,
    start: Expansion[E] | None = None,
    progress: Progress | None = None,
    *,
    at: Mapping[Any, Any] | None = None,
) -> Expansion[E]:
    """Expand a problem to the given order.

    Parameters
    ----------
    problem
        What to expand, see :class:`~asymptotics.problems.problem.Problem`; or a rope as it was
        written down, see :func:`~asymptotics.problems.moving_contact.moving_contact`.
    order
        N ≥ 1.
    start
        An expansion of the same problem to continue; its orders are kept as they are.
    progress
        Called with n when order n is done.
    at
        For a rope as it was written down the values of its parameters, Ω among them.

    Raises
    ------
    InputError
        ``order`` is not a whole number ≥ 1, or ``start`` belongs to another problem.
    ResonanceError
        A rope at Ω so close to one of its free frequencies over a harmonic in use that 8192 bits
        do not tell.

    Examples
    --------
    >>> from asymptotics.problems.string import exact_string
    >>> solution = expand(exact_string(), order=2)
    >>> solution.contact(1)          # ξ₁ = Ω/2 cos θ, eq. (linresponse1)
    {1: (Omega)/(4)}
    >>> solution.contact(2)          # ξ₂ = −Ω²/16 − Ω³/8 cot 2Ω cos 2θ
    {0: (-Omega^2)/(16), 2: (-Omega^3*c^2 + Omega^3)/(32*(c))}
    """
    if not isinstance(problem, Problem):
        rope, problem = problem, problem.at(at)
        steps = named_poles(expansions(problem, order, start), rope, at, check_order(order))
    elif at is not None:
        raise InputError(f"at = {at!r}: {problem.name} has its numbers already; leave it out")
    else:
        steps = expansions(problem, order, start)
    expansion = replace(start, orders=start.orders[: check_order(order)]) if start else None
    for expansion in steps:
        if progress is not None:
            progress(expansion.order)
    assert expansion is not None
    return expansion


def named_poles(
    steps: Iterator[Expansion[Any]], rope: Rope, at: Mapping[Any, Any] | None, order: int
) -> Iterator[Expansion[Any]]:
    """The same, but where no number of bits is enough the error names the resonance.

    Raises
    ------
    ResonanceError
        Ω is at a free frequency over a harmonic in use.
    """
    drive: list[int] = []
    try:
        for expansion in steps:
            drive = list(expansion.problem.drive)
            yield expansion
    except PrecisionError:
        excited = {j for n in range(1, order + 1) for j in reachable(drive or [1], n)}
        rope.check_resonance(at, sorted(excited))
        raise


def expansions(
    problem: Problem[E], order: int, start: Expansion[E] | None = None
) -> Iterator[Expansion[E]]:
    """Yield the expansion after each new order up to ``order``, for callers that save as they go.

    Raises what :func:`expand` raises.
    """
    order = check_order(order)
    if start is not None and start.problem.name != problem.name:
        raise InputError(
            f"the expansion to continue belongs to {start.problem.name!r}, not to {problem.name!r}"
        )
    if problem.balls is not None:
        from asymptotics.expansion.rounded import rounded_expansions

        yield from rounded_expansions(problem, order, start)
        return
    if problem.sweep is not None:
        from asymptotics.expansion.swept import swept_expansions

        yield from swept_expansions(problem, order, start)
        return
    orders = list(start.orders) if start is not None else []
    towers = _Towers(problem)
    for n, known in enumerate(orders, start=1):
        towers.add(n, known.shape)
    while len(orders) < order:
        new = _next_order(problem, orders, towers)
        orders.append(new)
        towers.add(len(orders), new.shape)
        yield Expansion(problem, tuple(orders))


def _next_order(problem: Problem[E], orders: list[Order[E]], towers: _Towers[E]) -> Order[E]:
    """Order n = len(orders) + 1 from all orders before it."""
    n, ring, conditions = len(orders) + 1, problem.ring, problem.conditions
    tails: list[tuple[Harmonics[E], ...]] = []
    left: list[Terms[E]] = []
    for index, condition in enumerate(conditions):
        diagonal: list[Harmonics[E]] = []
        for d in range(n - 1, 0, -1):
            terms = _delta_times_tail(problem, orders, diagonal, index, d, n)
            inverse = ring.rational(1, d + 1)
            scaled = {j: [inverse * x for x in xs] for j, xs in terms.items()}
            for j in orders[n - d - 1].shape:
                value = towers.at(condition, n - d, j, d + condition.derivative)
                scaled.setdefault(j, []).append(value)
            diagonal.append(collect(scaled, ring))
        left.append(_delta_times_tail(problem, orders, diagonal, index, 0, n))
        tails.append(tuple(reversed(diagonal)))
    shape = _shape(problem, left[:-1], n)
    last = left[-1]
    for j, start in shape.items():
        last.setdefault(j, []).append(start[conditions[-1].derivative])
    minus = ring.sum([ring.rational(-1) * problem.inverse_leading])
    return Order(collect(last, ring, minus), shape, tuple(tails))


def _delta_times_tail(
    problem: Problem[E],
    orders: list[Order[E]],
    diagonal: list[Harmonics[E]],
    index: int,
    d: int,
    n: int,
) -> Terms[E]:
    """The known part of δ · H_{d+1} of a condition at order n − d, before the factor 1/(d + 1).

    ``diagonal`` holds the tails of order n found so far, from d = n − 1 downwards. For d = 0 the
    term ξ_n a_{e+1} is left out: it is what the last condition determines.
    """
    ring = problem.ring
    terms: Terms[E] = {}
    length = n - d
    for k in range(1, length):
        # H_{d+1} at order n − d − k: computed at this order for k = 1, at an earlier one otherwise.
        order = d + 1 + length - k
        tail = diagonal[n - d - 2] if order == n else orders[order - 1].tails[index][d]
        multiply_into(terms, orders[k - 1].contact, tail, ring)
    condition = problem.conditions[index]
    static = problem.static_at(condition, d + 1 + condition.derivative)
    if d > 0 and not ring.is_zero(static):
        multiply_into(terms, orders[length - 1].contact, {0: static}, ring)
    return terms


def _shape(problem: Problem[E], conditions: list[Terms[E]], n: int) -> dict[int, tuple[E, ...]]:
    """First r derivatives of w_n at ξ₀ from its contact data and, at order 1, the drive."""
    ring = problem.ring
    minus = ring.rational(-1)
    data = [collect(terms, ring, minus) for terms in conditions]
    harmonics = {j for datum in data for j in datum}
    if n == 1:
        harmonics |= set(problem.drive)
    shape = {}
    for j in sorted(harmonics):
        mode = problem.mode(j)
        columns = [
            [datum[j] * x for x in row]
            for datum, row in zip(data, mode.impedance, strict=True)
            if j in datum
        ]
        if n == 1 and j in problem.drive:
            columns.append([problem.drive[j] * x for x in mode.source])
        shape[j] = tuple(ring.sum(list(terms)) for terms in zip(*columns, strict=True))
    return shape
