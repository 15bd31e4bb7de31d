r"""Expansions carried over to another ring.

A map φ of coefficients turns a problem and its expansion into others of the same form. Two serve to
check what there is:

* a homomorphism of rings, such as the values modulo a prime (:mod:`asymptotics.expansion.modular`):
  the image of the expansion is the expansion of the image;
* the absolute value, into :class:`MajorantRing`: every sum becomes the sum of the magnitudes of its
  terms, which is what its rounding is relative to.

What a problem leaves of its equation and its driven end is linear in the derivatives, hence known
from its values on unit vectors; these are mapped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, Generic, TypeVar

import numpy as np

from asymptotics.expansion.order_loop import Expansion, Order
from asymptotics.problems.problem import Ground, Mode, Problem, Varying
from asymptotics.rings.harmonics import Harmonics
from asymptotics.rings.ring import E, Element, Ring

F = TypeVar("F", bound=Element)


def image_of_problem(problem: Problem[E], ring: Ring[F], value: Callable[[E], F]) -> Problem[F]:
    """The problem with every coefficient mapped by ``value`` into ``ring``."""

    def row(elements: Sequence[E]) -> tuple[F, ...]:
        return tuple(value(element) for element in elements)

    @cache
    def mode(j: int) -> Mode[F]:
        known = problem.mode(j)
        impedance = tuple(row(entries) for entries in known.impedance)
        return Mode(row(known.reduction), impedance, row(known.source))

    weights = _Weights(problem, row)

    def static_end_residual(static: Callable[[int], F]) -> tuple[F, ...]:
        return tuple(
            ring.sum([constant, *(x * static(d) for d, x in enumerate(rest))])
            for constant, *rest in weights.static_end()
        )

    return Problem(
        name=problem.name,
        ring=ring,
        contact_order=problem.contact_order,
        static=cache(lambda d: value(problem.static(d))),
        static_reduction=row(problem.static_reduction),
        mode=mode,
        drive={j: value(amplitude) for j, amplitude in problem.drive.items()},
        inverse_leading=value(problem.inverse_leading),
        equation_residual=lambda j, w: _inner(weights.equation(j), w, ring),
        end_residual=lambda j, w: tuple(_inner(x, w, ring) for x in weights.end(j)),
        end_unit=cache(lambda j: row(problem.end_unit(j))),
        load=tuple(map(value, problem.load)),
        static_end_residual=static_end_residual,
        varying=None if problem.varying is None else _image_of_varying(problem, ring, row),
        ground=None if problem.ground is None else _image_of_ground(problem, ring, row),
    )


def _image_of_varying(
    problem: Problem[E], ring: Ring[F], row: Callable[[Sequence[E]], tuple[F, ...]]
) -> Varying[F]:
    varying, one, zero = problem.varying, problem.ring.one, problem.ring.zero
    assert varying is not None
    r = len(problem.mode(0).reduction)

    @cache
    def residual(j: int, q: int) -> tuple[F, ...]:
        length = r + q + 1
        units = [[one if i == k else zero for i in range(length)] for k in range(length)]
        return row([varying.residual(j, q, unit) for unit in units])

    return Varying(
        cache(lambda j, d: row(varying.weights(j, d))),
        lambda j, q, w: _inner(residual(j, q), w, ring),
    )


def _image_of_ground(
    problem: Problem[E], ring: Ring[F], row: Callable[[Sequence[E]], tuple[F, ...]]
) -> Ground[F]:
    ground = problem.ground
    assert ground is not None
    beyond = replace(
        problem,
        equation_residual=ground.equation_residual,
        end_residual=ground.end_residual,
    )
    weights = _Weights(beyond, row)
    return Ground(
        static=cache(lambda d: row([ground.static(d)])[0]),
        static_reduction=row(ground.static_reduction),
        reduction=cache(lambda j: row(ground.reduction(j))),
        equation_residual=lambda j, w: _inner(weights.equation(j), w, ring),
        load=row(ground.load),
        end_residual=lambda j, w: tuple(_inner(x, w, ring) for x in weights.end(j)),
    )


class _Weights(Generic[E, F]):
    """The mapped weights of the derivatives in what a problem leaves."""

    def __init__(self, problem: Problem[E], row: Callable[[Sequence[E]], tuple[F, ...]]) -> None:
        self.problem, self.row = problem, row
        self.equation = cache(self._equation)
        self.end = cache(self._end)
        self.static_end = cache(self._static_end)

    def _units(self, length: int) -> Iterator[list[E]]:
        one, zero = self.problem.ring.one, self.problem.ring.zero
        for k in range(length):
            yield [one if i == k else zero for i in range(length)]

    def _equation(self, j: int) -> tuple[F, ...]:
        length = len(self.problem.mode(j).reduction) + 1
        return self.row([self.problem.equation_residual(j, unit) for unit in self._units(length)])

    def _end(self, j: int) -> tuple[tuple[F, ...], ...]:
        """One row for each condition."""
        length = len(self.problem.mode(j).reduction)
        columns = [self.problem.end_residual(j, unit) for unit in self._units(length)]
        return tuple(map(self.row, zip(*columns, strict=True)))

    def _static_end(self) -> tuple[tuple[F, ...], ...]:
        """For each condition the constant, then the weights of a_0, a_1, …."""
        ring, residual = self.problem.ring, self.problem.static_end_residual
        constants = residual(lambda d: ring.zero)
        units = self._units(len(self.problem.static_reduction))
        columns = [residual(unit.__getitem__) for unit in units]
        return tuple(
            self.row([constant, *(ring.sum([x, ring.rational(-1) * constant]) for x in found)])
            for constant, *found in zip(constants, *columns, strict=True)
        )


def image_of_expansion(
    expansion: Expansion[E], ring: Ring[F], value: Callable[[E], F]
) -> Expansion[F]:
    """The expansion with every coefficient mapped by ``value`` into ``ring``.

    >>> from asymptotics import exact_string, expand
    >>> from asymptotics.rings.ring import FloatRing
    >>> solution = expand(exact_string(), 1)
    >>> image_of_expansion(solution, FloatRing(), lambda x: float(len(x.numerator))).contact(1)
    {1: 1.0}
    """

    def series(harmonics: Harmonics[E]) -> Harmonics[F]:
        return {j: value(c) for j, c in harmonics.items()}

    orders = tuple(
        Order(
            contact=series(order.contact),
            shape={j: tuple(map(value, start)) for j, start in order.shape.items()},
            tails=tuple(tuple(map(series, chain)) for chain in order.tails),
        )
        for order in expansion.orders
    )
    return Expansion(image_of_problem(expansion.problem, ring, value), orders)


def _inner(weights: Sequence[F], w: Sequence[F], ring: Ring[F]) -> F:
    return ring.sum([x * y for x, y in zip(weights, w, strict=False)])


class MajorantRing:
    """Magnitudes: numbers ≥ 0, or arrays of them, that only add up.

    >>> ring = MajorantRing(even=True)
    >>> ring.sum([ring.rational(-1, 2), abs(-3.0)])
    3.5
    """

    zero: Any = 0.0
    one: Any = 1.0

    def __init__(self, even: bool) -> None:
        self.even = even

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        """The magnitude of a rational number."""
        return abs(numerator) / denominator

    def sum(self, terms: Iterable[Any]) -> Any:
        """Σ terms."""
        return sum(terms, 0.0)

    def conjugate(self, element: Any) -> Any:
        """The same magnitude."""
        return element

    def is_zero(self, element: Any) -> bool:
        """Exact zero only."""
        return not np.any(element)
