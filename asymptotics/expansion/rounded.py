r"""Doubles with every digit right: the engine over balls, rounded.

In doubles the order loop loses digits. Its Taylor sums about the static contact point hold terms
that cancel: with bending the boundary layer of width √β makes those of order n larger than their
sum by β^{−(n−1)/2}, on the string high orders and the neighbourhood of a resonance do the same. So
a :class:`~asymptotics.problems.problem.Problem` that states itself over balls too is expanded
there, at a precision doubled until every coefficient is known to

.. math:: |\text{error}| ≤ 2^{−56} (|c| + 2^{−1024} \max |c|),

the maximum over its order, and then rounded: to within one unit in the last place. (The second term
ends the doubling where a coefficient vanishes.) Arrays have no balls and stay in doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from asymptotics.expansion.order_loop import Expansion, Order, Progress, expansions
from asymptotics.problems.problem import Problem
from asymptotics.rings.precision import PrecisionError, at_precision, doubled, until
from asymptotics.rings.rounding import accurate, to_double


def first_bits(order: int) -> int:
    """Where the doubling begins: the string loses some three bits an order."""
    return 64 + 4 * order


@dataclass(frozen=True)
class RoundedExpansion(Expansion[Any]):
    """An expansion in doubles with the balls that it was rounded from.

    Attributes
    ----------
    balls
        The expansion over balls, at least as long.
    bits
        The precision they were computed in.

    The doubles' ``tails`` are empty: what continues the expansion is in the balls.
    """

    balls: Expansion[Any] = field(repr=False)
    bits: int

    def is_rounded(self) -> bool:
        """Whether its doubles are the balls rounded; somebody may have put in others."""
        balls = self.balls.orders[: self.order]
        return all(
            _same(mine, _rounded_order(each, self.problem.name))
            for mine, each in zip(self.orders, balls, strict=True)
        )

    def certain(
        self,
        compute: Callable[[Expansion[Any]], Any],
        parts: Callable[[Any], Any],
        progress: Progress | None = None,
    ) -> Any:
        """``compute`` of the balls' expansion, at a precision that makes its balls accurate.

        ``parts`` lists the result's balls, order by order. One below 2⁻²⁵⁶ of its order's largest
        is right to that absolute accuracy: sums over many terms often vanish. ``progress`` is
        called with 0, as a sign of life, whenever an order has been expanded with more bits.
        """
        known = [Expansion(self.balls.problem, self.balls.orders[: self.order])]

        def attempt() -> Any:
            if not known:
                for longer in expansions(over_balls(self.problem), self.order):
                    known[:] = [longer]
                    if progress is not None:
                        progress(0)
            return compute(known.pop())

        def settled(result: Any) -> bool:
            return all(accurate(group, 256) for group in parts(result))

        return until(settled, attempt, self.problem.name, self.bits)[0]


def rounded_expansions(
    problem: Problem[Any], order: int, start: Expansion[Any] | None = None
) -> Iterator[Expansion[Any]]:
    """What :func:`asymptotics.expansion.order_loop.expansions` yields for a problem that has balls.

    Raises
    ------
    PrecisionError
        More than 8192 bits would be needed.
    InputError
        A number beyond what doubles hold.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.problems.beam import float_beam
    >>> solution = expand(float_beam(1e-8, 2.2, 6), 6)         # doubles alone: 712
    >>> solution.bits, round(2 * solution.contact(6)[6], 8)
    (176, 568.34362859)
    """
    orders, bits, known = [], first_bits(order), None
    if start is not None:
        orders = list(start.orders)
    if isinstance(start, RoundedExpansion):
        bits, known = start.bits, start.balls
    while len(orders) < order:
        balls = known
        for balls in _at_each_step(bits, problem, order, known):
            with at_precision(bits):
                new = balls.orders[-1]
                groups = [new.contact.values(), [x for w in new.shape.values() for x in w]]
                settled = all(accurate(group) for group in groups)
            if not settled:
                break
            if balls.order > len(orders):
                orders.append(_rounded_order(new, problem.name))
                yield RoundedExpansion(problem, tuple(orders), balls, bits)
        if len(orders) < order:
            bits, known = doubled(bits, problem.name, balls), None


def _at_each_step(
    bits: int, problem: Problem[Any], order: int, start: Expansion[Any] | None
) -> Iterator[Expansion[Any]]:
    """The expansions over balls, as far as they go; in between the precision is the caller's."""
    with at_precision(bits):
        try:
            exact = over_balls(problem) if start is None else start.problem
        except PrecisionError:
            return
        steps = expansions(exact, order, start)
    while True:
        with at_precision(bits):
            try:
                step = next(steps, None)
            except PrecisionError:
                return
        if step is None:
            return
        yield step


def over_balls(problem: Problem[Any]) -> Problem[Any]:
    """The same problem over balls, in the precision of the moment."""
    assert problem.balls is not None
    return problem.balls()


def _same(left: Order[Any], right: Order[Any]) -> bool:
    """Whether two orders in doubles differ by no more than balls of other precision round to."""
    if left.contact.keys() != right.contact.keys() or left.shape.keys() != right.shape.keys():
        return False
    pairs = [(c, right.contact[j]) for j, c in left.contact.items()]
    for j, start in left.shape.items():
        pairs += zip(start, right.shape[j], strict=True)
    # The floor is for coefficients that vanish, see _VANISHING.
    return all(abs(a - b) <= 2.0**-52 * max(abs(a), abs(b)) + 1e-300 for a, b in pairs)


def _rounded_order(order: Order[Any], name: str) -> Order[Any]:
    return Order(
        contact={j: to_double(c, name) for j, c in order.contact.items()},
        shape={j: tuple(to_double(x, name) for x in w) for j, w in order.shape.items()},
        tails=(),
    )
