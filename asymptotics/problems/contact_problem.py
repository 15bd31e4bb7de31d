"""A reader's rope at values of its parameters, as a problem over balls or rounded doubles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

import sympy
from flint import acb, ctx

from asymptotics.errors import InputError
from asymptotics.problems.compliant import (
    allowed,
    ground_of,
    growth_rates,
    on_springs,
    powers_of,
    stiffness,
    two_sided,
)
from asymptotics.problems.enclosed_expressions import enclose
from asymptotics.problems.fundamental import Propagator, product, solve
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.problem import Mode, Problem, Varying
from asymptotics.problems.rest import Values, polynomials, rates_of
from asymptotics.problems.rounded_problem import rounded_problem
from asymptotics.problems.static_contact import check_static_shape, static_data
from asymptotics.problems.varying import VaryingPropagator, differentiated, weights
from asymptotics.rings.balls import AcbRing, ArbRing
from asymptotics.rings.pickling import remembering
from asymptotics.rings.precision import PrecisionError


class Enclosed:
    """All that :class:`~asymptotics.problems.problem.Problem` asks, in one precision."""

    def __init__(self, rope: MovingContact, values: Values) -> None:
        self.rope, self.values = rope, dict(values)
        self.omega = enclose(sympy.Symbol("Omega"), self.values)
        self.r = rope.order
        # With n conditions at the driven end r − n numbers are free there: the contact data, or the
        # solutions that the springs leave.
        self.free = self.r - len(rope.driven_end)
        self.springs = stiffness(rope, self.values) if rope.springs != 0 else None
        self.drive = [self._amplitudes(dict(c.drive)) for c in rope.driven_end]
        self.harmonics = sorted({j for row in self.drive for j in row})
        self.even = self.springs is None and self._is_even()
        self.ring: Any = ArbRing() if self.even else AcbRing()
        self.static = static_data(rope, self.values)
        if self.springs is not None:
            self.static_beyond = self.static.on_springs(self.springs)
        self.beyond = cache(self._beyond)
        self.mode, self.end_rows = cache(self._mode), cache(self._end_rows)
        self.static_end_rows = cache(self._static_end_rows)

    def _amplitudes(self, drive: dict[int, sympy.Expr]) -> dict[int, acb]:
        """j ≥ 0 ↦ the amplitude of e^{ijΩτ}, when the drive is real."""
        values = {j: enclose(amplitude, self.values) for j, amplitude in drive.items()}
        for j, amplitude in values.items():
            mirrored = values.get(-j, acb(0))
            if not (amplitude - mirrored.conjugate()).contains(0):
                raise InputError("driven end: the drive is not real at these parameters")
        return {j: amplitude for j, amplitude in values.items() if j >= 0}

    def _is_even(self) -> bool:
        """Whether state and coefficients are real: no odd ∂_τ, cosines only."""
        real = all(x.imag.contains(0) for row in self.drive for x in row.values())
        return real and not self.rope.irreversible

    def rates(self, terms: Any, j: int, length: int) -> list[acb]:
        """Σ_t c_{kt} (ijΩ)^t for k = 0 … length − 1."""
        found = [acb(0)] * length
        rate = acb(0, 1) * j * self.omega
        for (k, power), value in terms.items():
            found[k] = found[k] + enclose(value, self.values) * (rate**power if power else 1)
        return found

    def propagator(self, j: int) -> Propagator | VaryingPropagator:
        """Of harmonic j, when its leading coefficient does not vanish."""
        if self.rope.varying:
            rate = acb(0, 1) * j * self.omega
            varying = polynomials(self.rope, self.values, rate)
            return VaryingPropagator(tuple(varying), [], self.static.point)
        found = self.rates(self.rope.equation.terms, j, self.r + 1)
        leading = found[self.r]
        if leading.contains(0):
            self._refuse_vanishing(j)
            raise PrecisionError(f"the leading coefficient of harmonic {j}", leading)
        return Propagator(tuple(found))

    def _refuse_vanishing(self, j: int) -> None:
        exact = sympy.Integer(0)
        names = {
            name: sympy.Rational(x.numerator, x.denominator) for name, x in self.values.items()
        }
        for (k, power), value in self.rope.equation.terms.items():
            if k == self.r:
                at = {symbol: names[symbol.name] for symbol in value.free_symbols}
                exact += value.subs(at) * (sympy.I * j * names["Omega"]) ** power
        if sympy.simplify(exact) == 0:
            raise InputError(
                f"equation: the coefficient of the highest derivative in ξ vanishes at harmonic "
                f"{j}, where the order of the equation drops; change Omega or a parameter"
            )

    def rows(self, j: int) -> list[list[acb]]:
        """E(ijΩ)."""
        return [self.rates(condition.terms, j, self.r) for condition in self.rope.driven_end]

    def amplitudes(self, j: int) -> list[acb]:
        """What drives harmonic j in each condition."""
        return [row.get(j, acb(0)) for row in self.drive]

    def element(self, ball: acb) -> Any:
        """As an element of the ring: real where the problem is even."""
        return ball.real if self.even else ball

    def _mode(self, j: int) -> Mode[Any]:
        r, free, what = self.r, self.free, f"harmonic {j}"
        equation = self.propagator(j)
        reduction = [-c / equation.coefficients[r] for c in equation.coefficients[:r]]
        table = product(self.rows(j), equation.backwards(self.static.point))
        if self.springs is not None:
            impedance, source = two_sided(table, self.amplitudes(j), self.beyond(j), what)
        else:
            block, impedance = [row[free:] for row in table], []
            for i in range(free):
                found = solve(block, [-row[i] for row in table], what)
                impedance.append([*(acb(k == i) for k in range(free)), *found])
            source = [acb(0)] * free + solve(block, self.amplitudes(j), what)
        element = self.element
        return Mode(
            tuple(map(element, reduction)),
            tuple(tuple(map(element, row)) for row in impedance),
            tuple(map(element, source)),
        )

    def _beyond(self, j: int) -> list[list[acb]]:
        """Rows ∂^d at ξ₀ of what harmonic j may be on springs."""
        assert self.springs is not None
        there = on_springs(self.propagator(j).coefficients, self.springs)
        growth = growth_rates(self.rope, self.values, j, self.r)
        return powers_of(allowed(there, growth, f"harmonic {j}"), self.r)

    def varying(self) -> Varying[Any] | None:
        """The equation differentiated, where its coefficients vary."""
        if not self.rope.varying:
            return None
        rates = cache(lambda j: rates_of(self.propagator(j)))

        def row(j: int, d: int) -> tuple[Any, ...]:
            return tuple(map(self.element, weights(rates(j), d)))

        def residual(j: int, q: int, w: Sequence[Any]) -> Any:
            found = differentiated(rates(j), q)
            return self.ring.sum([self.element(c) * x for c, x in zip(found, w, strict=True)])

        return Varying(cache(row), residual)

    def equation_residual(self, j: int, w: Sequence[Any]) -> Any:
        """The polynomials c_k themselves, on w, w′, …."""
        if self.rope.varying:
            found = list(self.propagator(j).coefficients)
        else:
            found = self.rates(self.rope.equation.terms, j, self.r + 1)
        return self.ring.sum([self.element(c) * x for c, x in zip(found, w, strict=True)])

    def _end_rows(self, j: int) -> tuple[list[list[Any]], list[Any]]:
        """The conditions at the driven end on w … w^{(r−1)} at ξ₀, solved for the last n of them.

        So scaled, no growing solution hides the others.
        """
        equation = self.propagator(j)
        table = product(self.rows(j), equation.stepwise(self.static.point))
        block, what = [row[self.free :] for row in table], f"driven end of harmonic {j}"
        columns = [solve(block, [row[i] for row in table], what) for i in range(self.free)]
        unit = solve(block, self.amplitudes(j), what)
        count = len(unit)
        rows = [
            [*(columns[i][k] for i in range(self.free)), *(acb(k == i) for i in range(count))]
            for k in range(count)
        ]
        return [[self.element(x) for x in row] for row in rows], [self.element(x) for x in unit]

    def _static_end_rows(self) -> tuple[list[list[Any]], list[Any]]:
        """The same for the static shape: rows on a_0 … a_{r−1} and what they leave without any."""
        static = self.static
        table = product(self.rows(0), static.propagator.stepwise(static.point))
        block, what = [row[self.free : self.r] for row in table], "driven end at rest"
        columns = [solve(block, [row[i] for row in table], what) for i in range(self.free)]
        left = [
            sum((row[self.r + p] * x for p, x in enumerate(static.load)), -constant)
            for row, constant in zip(table, static.constants, strict=True)
        ]
        constants = solve(block, left, what)
        count = len(constants)
        rows = [
            [*(columns[i][k] for i in range(self.free)), *(acb(k == i) for i in range(count))]
            for k in range(count)
        ]
        return [[self.element(x) for x in row] for row in rows], [
            self.element(x) for x in constants
        ]


def _named(rope: MovingContact, values: Values, kind: str) -> str:
    spelled = ", ".join(f"{name} = {_spelled(value)}" for name, value in values)
    ends = "; ".join(
        str(dict(condition.terms)) + str(dict(condition.drive)) for condition in rope.driven_end
    )
    return f"rope {rope} with {ends} at {spelled}{kind}"


def _spelled(value: Fraction) -> str:
    return repr(float(value)) if Fraction(float(value)) == value else str(value)


@lru_cache(maxsize=64)
def _enclosed(rope: MovingContact, values: Values, bits: int) -> Enclosed:
    """In the precision of the moment, which is ``bits``."""
    assert bits == ctx.prec
    return Enclosed(rope, values)


@remembering
def enclosed_problem(rope: MovingContact, values: Values) -> Problem[Any]:
    """The problem over balls, in the precision of the moment; see :meth:`MovingContact.at`."""
    check_static_shape(rope, dict(values))
    made = _enclosed(rope, values, ctx.prec)
    ring, static = made.ring, made.static

    def end_residual(j: int, w: Sequence[Any]) -> tuple[Any, ...]:
        rows, _ = made.end_rows(j)
        return tuple(_inner(ring, row, w) for row in rows)

    def static_end_residual(a: Callable[[int], Any]) -> tuple[Any, ...]:
        rows, constants = made.static_end_rows()
        first = [a(d) for d in range(made.r)]
        return tuple(
            ring.sum([constant, _inner(ring, row, first)])
            for row, constant in zip(rows, constants, strict=True)
        )

    return Problem(
        name=_named(rope, values, " in balls"),
        ring=ring,
        contact_order=rope.contact_order,
        static=cache(lambda d: made.element(static.derivative(d))),
        static_reduction=tuple(map(made.element, static.reduction)),
        mode=made.mode,
        drive=dict.fromkeys(made.harmonics, ring.one),
        inverse_leading=made.element(1 / static.derivative(rope.contact_order)),
        equation_residual=made.equation_residual,
        end_residual=end_residual,
        end_unit=lambda j: tuple(made.end_rows(j)[1]),
        load=tuple(map(made.element, static.load)),
        static_end_residual=static_end_residual,
        rest=made.element(acb(static.point)),
        varying=made.varying(),
        ground=None if made.springs is None else ground_of(made),
    )


def _inner(ring: Any, row: Sequence[Any], w: Sequence[Any]) -> Any:
    return ring.sum([c * x for c, x in zip(row, w, strict=False)])


@remembering
def double_problem(rope: MovingContact, values: Values) -> Problem[Any]:
    """The problem in doubles, each rounded from balls; its expansion is, too."""
    check_static_shape(rope, dict(values))
    return rounded_problem(_named(rope, values, ""), lambda: enclosed_problem(rope, values))
