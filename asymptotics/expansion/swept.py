r"""Sweeps: one expansion for whole arrays of β or Ω, with the error of every number.

The order loop runs over :class:`~asymptotics.rings.bounded.Bounded` arrays. In doubles it loses
digits where the problem is hard (a boundary layer, a near resonance, a high order), at some points
of the array and not at others. Where what is lost of order n at a point leaves more than

.. math:: 2^{−26} \max_j |c_j|

(half the digits) in a coefficient c_j of ξ_n, or of a derivative of w_n, that point is expanded
over balls, as :mod:`asymptotics.expansion.rounded` does for single numbers, and put in: all its
digits are right then. So easy sweeps cost a few NumPy operations a product, hard points some
milliseconds each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.expansion.order_loop import Expansion, Order, expansions
from asymptotics.problems.problem import Problem, Sweep
from asymptotics.problems.string import RESOLUTION
from asymptotics.rings.bounded import lifted
from asymptotics.rings.precision import PrecisionError

Array = npt.NDArray[Any]
# Numbers that belong together, as the harmonics of one order: their keys and values.
Group = dict[Any, Any]


@dataclass(frozen=True)
class SweptExpansion(Expansion[Any]):
    """An expansion in arrays of doubles, and how well each of them is known.

    Attributes
    ----------
    errors
        The bounds, built as ``orders``: ``errors[n − 1].contact[j]`` is that of ξ_n's harmonic j.
    bounded
        The expansion over bounded doubles.
    points
        Flat index in the arrays ↦ the point's own expansion, rounded from balls.
    """

    errors: tuple[Order[Any], ...] = field(repr=False)
    bounded: Expansion[Any] = field(repr=False)
    points: dict[int, Expansion[Any]] = field(repr=False)

    def is_swept(self) -> bool:
        """Whether its numbers are those computed; somebody may have put in others."""
        sweep = _sweep(self.problem)
        for n in range(1, self.order + 1):
            doubles, mixed = (_read(self.bounded.orders[n - 1], sweep.shape) for _ in range(2))
            for index in self.points:
                _put(mixed, index, _numbers(self._point(index, n).orders[n - 1]))
            groups = zip(doubles, mixed, _numbers(self.orders[n - 1]), strict=True)
            for plain, put, mine in groups:
                if plain.keys() != mine.keys():
                    return False
                # A point may have gone over balls at a later order only.
                if not all(
                    ((value == plain[key][0]) | (value == put[key][0])).all()
                    for key, value in mine.items()
                ):
                    return False
        return True

    def _point(self, index: int, order: int) -> Expansion[Any]:
        """The point's own expansion, to that order at least."""
        known = self.points.get(index)
        if known is None or known.order < order:
            known = self.points[index] = _at(_sweep(self.problem), index, order, known)
        return known

    def settled(
        self,
        compute: Callable[[Expansion[Any]], Any],
        groups: Callable[[Any], Iterable[Group]],
    ) -> tuple[Any, list[dict[Any, Array]]]:
        """What ``compute`` makes of the bounded doubles; and its groups of numbers, all known.

        Where the bounds of a group do not leave half the digits, the point goes over balls.
        """
        sweep = _sweep(self.problem)
        result = compute(self.bounded)
        found = [_arrays(group, sweep.shape) for group in groups(result)]
        hard = set(_uncertain(found, sweep.shape))
        for index in sorted(hard | self.points.keys()):
            point = compute(self._point(index, self.order))
            _put(found, index, list(groups(point)))
        return result, [{key: value for key, (value, _) in group.items()} for group in found]


def swept_expansions(
    problem: Problem[Any], order: int, start: Expansion[Any] | None = None
) -> Iterator[Expansion[Any]]:
    """What :func:`asymptotics.expansion.order_loop.expansions` yields for a problem that is a
    sweep.

    Raises
    ------
    PrecisionError
        At one of the points more than 8192 bits would be needed; the error says at which.
    InputError
        A number beyond what doubles hold.

    Examples
    --------
    >>> import numpy as np
    >>> from asymptotics import expand
    >>> from asymptotics.problems.beam import beam_problem
    >>> solution = expand(beam_problem(np.array([1e-2, 1e-8]), 2.2), 4)
    >>> sorted(solution.points)                 # the thin layer took balls
    [1]
    >>> (2 * solution.contact(4)[4]).round(6)
    array([ 5.751165, 85.361819])
    """
    sweep = _sweep(problem)
    orders, errors = [] if start is None else list(start.orders), []
    points: dict[int, Expansion[Any]] = {}
    bounded = None
    if isinstance(start, SweptExpansion):
        errors, bounded, points = list(start.errors), start.bounded, dict(start.points)
    for step in expansions(sweep.bounded(), order, bounded):
        n = step.order
        if n <= len(errors):
            continue
        found = _read(step.orders[-1], sweep.shape)
        for index in sorted(set(_uncertain(found, sweep.shape)) | points.keys()):
            points[index] = _at(sweep, index, n, points.get(index))
            _put(found, index, _numbers(points[index].orders[n - 1]))
        errors.append(_order([{j: e for j, (_, e) in group.items()} for group in found]))
        if n > len(orders):
            orders.append(_order([{j: v for j, (v, _) in group.items()} for group in found]))
        yield SweptExpansion(problem, tuple(orders[:n]), tuple(errors), step, dict(points))


def _sweep(problem: Problem[Any]) -> Sweep:
    assert problem.sweep is not None
    return problem.sweep


def _at(
    sweep: Sweep, index: int, order: int, start: Expansion[Any] | None = None
) -> Expansion[Any]:
    """The expansion at one point of the arrays, over balls and rounded."""
    from asymptotics.expansion.order_loop import expand

    problem = sweep.at(index)
    try:
        return expand(problem, order, start)
    except PrecisionError as error:
        place = tuple(int(i) for i in np.unravel_index(index, sweep.shape))
        raise PrecisionError(f"point {place} of the sweep: {error}", error.partial) from None


def _numbers(order: Order[Any]) -> list[Group]:
    """An order's groups: the contact point's harmonics, then each derivative's."""
    width = max((len(start) for start in order.shape.values()), default=0)
    rows = [{j: start[i] for j, start in order.shape.items()} for i in range(width)]
    return [dict(order.contact), *rows]


def _order(groups: list[Group]) -> Order[Any]:
    """The inverse of :func:`_numbers`; what continues the expansion is in the bounded one."""
    contact, *rows = groups
    harmonics = rows[0] if rows else {}
    shape = {j: tuple(row[j] for row in rows) for j in harmonics}
    return Order(contact=contact, shape=shape, tails=())


def _read(order: Order[Any], shape: tuple[int, ...]) -> list[Group]:
    return [_arrays(group, shape) for group in _numbers(order)]


def _arrays(group: Group, shape: tuple[int, ...]) -> Group:
    """Values and bounds of bounded numbers, as arrays of their own."""
    return {
        key: (
            np.broadcast_to(lifted(number).value, shape).copy(),
            np.broadcast_to(lifted(number).error, shape).copy(),
        )
        for key, number in group.items()
    }


def _uncertain(groups: Iterable[Group], shape: tuple[int, ...]) -> list[int]:
    """The flat indices of the points where a group's bounds leave too little."""
    hard = np.zeros(shape, dtype=bool)
    for group in groups:
        if not group:
            continue
        largest = np.max([np.abs(value) for value, _ in group.values()], axis=0)
        worst = np.max([error for _, error in group.values()], axis=0)
        with np.errstate(invalid="ignore"):
            hard |= ~(worst <= RESOLUTION * largest) & (worst > 0)
    return np.flatnonzero(hard).tolist()


def _put(groups: list[Group], index: int, numbers: list[Group]) -> None:
    """One point's own numbers, right to a unit in the last place, into the arrays."""
    for group, mine in zip(groups, numbers, strict=True):
        for key, (value, error) in group.items():
            number = mine.get(key, 0.0)
            value.flat[index] = number
            error.flat[index] = 2.0**-52 * abs(number)
