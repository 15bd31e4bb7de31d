"""The rope at rest as equations for ξ₀, on a ground that is rigid or gives way, over balls.

In W − g the rope at rest has y(ξ₀) = (0, …, 0, a_m, …, a_{r−1}). The n conditions at the driven end
are linear in the n − 1 numbers a_m, …, which leaves one scalar equation F(ξ₀) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations

import sympy
from flint import acb, acb_mat, arb, ctx

from asymptotics.problems.compliant import Beyond, stiffness
from asymptotics.problems.enclosed_expressions import enclose
from asymptotics.problems.fundamental import Propagator, magnitude, product, solve
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.varying import VaryingPropagator, derivatives, polynomial
from asymptotics.rings.precision import PrecisionError

Values = tuple[tuple[str, Fraction], ...]
"""The parameters' names and values, sorted."""

SAMPLES = 200
"""Places at which a shape's height is looked at."""


def polynomials(
    rope: MovingContact, values: Mapping[str, Fraction], rate: acb | None
) -> list[list[acb]]:
    """c_k(ξ) at p = ``rate``, at rest without one, as coefficients of 1, ξ, …."""
    found: list[list[acb]] = [[acb(0)] for _ in range(rope.order + 1)]
    for (k, t), expression in rope.equation.terms.items():
        if rate is None and t:
            continue
        factor = rate**t if rate is not None and t else acb(1)
        for i, x in enumerate(polynomial(expression, rope.letters.xi, values)):
            if i == len(found[k]):
                found[k].append(acb(0))
            found[k][i] = found[k][i] + x * factor
    return found


def rates_of(propagator: Propagator | VaryingPropagator) -> list[list[acb]]:
    """c_k and their derivatives at ξ₀."""
    if isinstance(propagator, Propagator):
        return [[c] for c in propagator.coefficients]
    return [derivatives(c, acb(propagator.point)) for c in propagator.polynomials]


class Rest:
    """The equation at rest, in the precision of the moment."""

    def __init__(self, rope: MovingContact, values: Mapping[str, Fraction]) -> None:
        self.rope, self.values, self.r, self.m = rope, values, rope.order, rope.contact_order
        self.known: dict[float, acb_mat] = {}
        self.polynomials = polynomials(rope, values, None)
        self.coefficients = [c[0] for c in self.polynomials]
        self.rows = [
            [
                sum(
                    (enclose(v, values) for (k, t), v in c.terms.items() if (k, t) == (i, 0)),
                    acb(0),
                )
                for i in range(self.r)
            ]
            for c in rope.driven_end
        ]
        self.constants = tuple(enclose(c.constant, values) for c in rope.driven_end)
        xi = rope.letters.xi
        powers = sympy.Poly(rope.equation.right, xi).all_coeffs()[::-1]
        self.load = [enclose(x, values) for x in powers]

    def loads(self, point: arb) -> tuple[acb, ...]:
        """ℓ, ℓ′, … at a place."""
        found, current = [], list(self.load)
        while current:
            value = acb(0)
            for x in reversed(current):
                value = value * acb(point) + x
            found.append(value)
            current = [k * x for k, x in enumerate(current)][1:]
        return tuple(found)

    def propagator(self, point: arb) -> Propagator | VaryingPropagator:
        """Of the equation at rest, with its load at a place."""
        if self.rope.varying:
            return VaryingPropagator(tuple(self.polynomials), self.load, point, self.known)
        return Propagator(tuple(self.coefficients), self.loads(point))

    def system(self, point: arb) -> tuple[list[list[acb]], list[acb]]:
        """Columns M_m … M_{r−1}, and E p − d."""
        equation = self.propagator(point)
        table = product(self.rows, equation.backwards(point))
        left = []
        for row, constant in zip(table, self.constants, strict=True):
            terms = [row[self.r + p] * x for p, x in enumerate(equation.load)]
            left.append(sum(terms, -constant))
        return [row[self.m : self.r] for row in table], left

    def height(self, point: arb) -> arb:
        """F(ξ₀), real, scaled by a positive factor."""
        columns, left = self.system(point)
        rows = []
        for row, x in zip(columns, left, strict=True):
            size = max((abs(y).upper() for y in row), key=magnitude, default=arb(0))
            size = size if size > 0 else arb(1)
            rows.append([*(y / acb(size.mid()) for y in row), x / acb(size.mid())])
        return acb_mat(rows).det().real

    def first(self, point: arb) -> list[acb]:
        """W₀ … ∂^{r−1}W₀ at ξ₀."""
        return [*[acb(0)] * self.m, *self._shape(point)]

    def _shape(self, point: arb) -> list[acb]:
        """a_m … a_{r−1}, from the n − 1 conditions that tell them best."""
        columns, left = self.system(point)
        n = len(left)
        failed: PrecisionError | None = None
        for chosen in combinations(range(n - 1, -1, -1), n - 1):
            try:
                return solve(
                    [columns[i] for i in chosen], [-left[i] for i in chosen], "the static shape"
                )
            except PrecisionError as error:
                failed = error
        raise failed if failed else PrecisionError("the static shape", None)

    def lifted_beyond(self, point: arb) -> float | None:
        """Where beyond ξ₀ the ground would have to pull; of a rigid one nobody asks here."""
        return None


class RestOnSprings(Rest):
    """The same where the rope lies on springs: both sides of ξ₀ belong to one shape."""

    def __init__(self, rope: MovingContact, values: Mapping[str, Fraction]) -> None:
        super().__init__(rope, values)
        self.springs = stiffness(rope, values)

    def _system(self, point: arb) -> tuple[Beyond, list[list[acb]], list[acb]]:
        left = self.propagator(point)
        assert isinstance(left, Propagator)
        left = left if left.load else replace(left, load=(acb(0),))
        beyond = Beyond.at(left, self.springs)
        return beyond, *beyond.system(self.rows, self.constants, left, point)

    def height(self, point: arb) -> arb:
        """F(ξ₀)."""
        beyond, lines, sides = self._system(point)
        return beyond.height(lines, sides)

    def first(self, point: arb) -> list[acb]:
        """W₀ … ∂^{r−1}W₀ at ξ₀."""
        beyond, lines, sides = self._system(point)
        return beyond.state(lines, sides)

    def lifted_beyond(self, point: arb) -> float | None:
        """A place beyond ξ₀ where the rope is above the springs."""
        beyond, lines, sides = self._system(point)
        state = beyond.state(lines, sides)
        slowest = min((float(abs(x.real).mid()) for x in beyond.exponents), default=1.0)
        for i in range(1, SAMPLES + 1):
            length = 20 * i / SAMPLES / slowest
            if beyond.depth(state, arb(length)) > 0:
                return float(point) + length
        return None


def rest_of(rope: MovingContact, values: Mapping[str, Fraction]) -> Rest:
    """Of a rope, in the precision of the moment; made once in each."""
    return _made_rest(rope, tuple(sorted(values.items())), ctx.prec)


@lru_cache(maxsize=32)
def _made_rest(rope: MovingContact, values: Values, bits: int) -> Rest:
    """In the precision of the moment, which is ``bits``."""
    return (Rest if rope.springs == 0 else RestOnSprings)(rope, dict(values))
