"""A problem in doubles, every number of it rounded from balls that were made accurate first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from flint import arb, ctx

from asymptotics.problems.problem import Ground, Mode, Problem, Varying
from asymptotics.rings.balls import ArbRing
from asymptotics.rings.precision import at_precision, until
from asymptotics.rings.ring import ComplexRing, FloatRing
from asymptotics.rings.rounding import accurate, to_double

Balls = Problem[Any]


def rounded_problem(name: str, made: Callable[[], Balls]) -> Problem[Any]:
    """What :func:`asymptotics.expand` expands over balls and rounds; its own numbers rounded too.

    Parameters
    ----------
    made
        Makes the problem over balls, in the precision of the moment; called once for each.
    """

    @cache
    def at(bits: int) -> Balls:
        assert bits == ctx.prec
        return made()

    def numbers(pick: Callable[[Balls], Sequence[Any]]) -> tuple[Any, ...]:
        def settled(balls: Sequence[Any]) -> bool:
            return all(accurate([ball]) or bool(abs(ball) < arb(2) ** -1074) for ball in balls)

        found, bits = until(settled, lambda: pick(at(ctx.prec)), name)
        with at_precision(bits):
            return tuple(to_double(ball, name) for ball in found)

    def one(pick: Callable[[Balls], Any]) -> Any:
        return numbers(lambda balls: [pick(balls)])[0]

    first, _ = until(lambda balls: True, lambda: at(ctx.prec), name)
    ring: Any = FloatRing() if isinstance(first.ring, ArbRing) else ComplexRing()
    r = len(first.static_reduction) - len(first.load)

    @cache
    def mode(j: int) -> Mode[Any]:
        def row(i: int) -> tuple[Any, ...]:
            return numbers(lambda balls: balls.mode(j).impedance[i])

        return Mode(
            numbers(lambda balls: balls.mode(j).reduction),
            tuple(row(i) for i in range(len(first.conditions) - 1)),
            numbers(lambda balls: balls.mode(j).source),
        )

    def side(balls: Balls, beyond: bool) -> Any:
        return balls.ground if beyond else balls

    def units(balls: Balls, length: int) -> list[list[Any]]:
        one, zero = balls.ring.one, balls.ring.zero
        return [[one if i == k else zero for i in range(length)] for k in range(length)]

    @cache
    def equation(j: int, beyond: bool) -> tuple[Any, ...]:
        return numbers(
            lambda balls: [
                side(balls, beyond).equation_residual(j, unit) for unit in units(balls, r + 1)
            ]
        )

    @cache
    def ends(j: int, beyond: bool) -> list[tuple[Any, ...]]:
        def columns(balls: Balls) -> list[tuple[Any, ...]]:
            return [side(balls, beyond).end_residual(j, unit) for unit in units(balls, r)]

        table = numbers(lambda balls: [x for column in columns(balls) for x in column])
        count = len(table) // r
        return [table[i::count] for i in range(count)]

    @cache
    def static_ends() -> list[tuple[Any, ...]]:
        """For each condition the constant, and the weights of a_0 … a_{r−1}."""

        def columns(balls: Balls) -> list[Any]:
            residual, minus = balls.static_end_residual, balls.ring.rational(-1)
            constants = residual(lambda d: balls.ring.zero)
            found = list(constants)
            for unit in units(balls, r):
                pairs = zip(residual(unit.__getitem__), constants, strict=True)
                found += [balls.ring.sum([x, minus * constant]) for x, constant in pairs]
            return found

        table = numbers(columns)
        count = len(table) // (r + 1)
        return [table[i::count] for i in range(count)]

    def static_end_residual(a: Callable[[int], Any]) -> tuple[Any, ...]:
        values = [ring.one, *(a(d) for d in range(r))]
        return tuple(_inner(ring, row, values) for row in static_ends())

    def varying() -> Varying[Any]:
        @cache
        def residual(j: int, q: int) -> tuple[Any, ...]:
            def rows(balls: Balls) -> list[Any]:
                one: Any = balls.varying
                return [one.residual(j, q, unit) for unit in units(balls, r + q + 1)]

            return numbers(rows)

        def weights(j: int, d: int) -> tuple[Any, ...]:
            def row(balls: Balls) -> Sequence[Any]:
                one: Any = balls.varying
                return tuple(one.weights(j, d))

            return numbers(row)

        return Varying(cache(weights), lambda j, q, w: _inner(ring, residual(j, q), w))

    def ground() -> Ground[Any]:
        return Ground(
            static=cache(lambda d: one(lambda balls: side(balls, True).static(d))),
            static_reduction=numbers(lambda balls: side(balls, True).static_reduction),
            reduction=cache(lambda j: numbers(lambda balls: side(balls, True).reduction(j))),
            equation_residual=lambda j, w: _inner(ring, equation(j, True), w),
            load=numbers(lambda balls: side(balls, True).load),
            end_residual=lambda j, w: tuple(_inner(ring, row, w) for row in ends(j, True)),
        )

    return Problem(
        name=name,
        ring=ring,
        contact_order=first.contact_order,
        static=cache(lambda d: one(lambda balls: balls.static(d))),
        static_reduction=numbers(lambda balls: balls.static_reduction),
        mode=mode,
        drive=dict.fromkeys(first.drive, ring.one),
        inverse_leading=one(lambda balls: balls.inverse_leading),
        equation_residual=lambda j, w: _inner(ring, equation(j, False), w),
        end_residual=lambda j, w: tuple(_inner(ring, row, w) for row in ends(j, False)),
        end_unit=cache(lambda j: numbers(lambda balls: balls.end_unit(j))),
        load=numbers(lambda balls: balls.load),
        static_end_residual=static_end_residual,
        rest=one(lambda balls: balls.rest),
        balls=made,
        varying=None if first.varying is None else varying(),
        ground=None if first.ground is None else ground(),
    )


def _inner(ring: Any, row: Sequence[Any], w: Sequence[Any]) -> Any:
    return ring.sum([c * x for c, x in zip(row, w, strict=False)])
