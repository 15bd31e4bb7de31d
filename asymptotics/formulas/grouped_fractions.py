"""Fractions of polynomials over ℚ(i), added without multiplying out.

A value is a sum of fractions *grouped by denominator*, a denominator being a multiset of
irreducible polynomials, each factored out once and known by its number from then on. Sums with the
same denominator add their numerators; multiplying out waits until two sums meet in a product, or
until the end. Numbers a + ib are pairs over ℚ, and denominators are made real.
"""

from __future__ import annotations

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

Denominator = tuple[tuple[int, int], ...]
"""Sorted (number of an irreducible factor, its power > 0)."""

Pair = tuple[fmpq_mpoly, fmpq_mpoly]
"""(a, b) for a + ib."""

Value = dict[Denominator, Pair]
"""Σ (a + ib)/denominator."""


class FractionField:
    """The field ℚ(i)(x0, x1, …), and what its denominators are made of.

    Examples
    --------
    1/x + i/(x + 1), which is the fraction (x + 1 + ix)/(x² + x):

    >>> field = FractionField(1)
    >>> x, one, zero = field.generators[0], field.one, field.zero
    >>> value = field.total([field.over((one, zero), x), field.over((zero, one), x + 1)])
    >>> value
    {((0, 1),): (1, 0), ((1, 1),): (0, 1)}
    >>> field.fraction(value)
    ((x0 + 1, x0), x0^2 + x0)
    >>> product = field.times(value, field.inverse(value))
    >>> (real, imaginary), below = field.fraction(product)
    >>> real == below, imaginary
    (True, 0)
    """

    def __init__(self, variables: int) -> None:
        names = [f"x{i}" for i in range(variables)]
        self.context = fmpq_mpoly_ctx.get(names, Ordering.lex)
        self.generators: tuple[fmpq_mpoly, ...] = self.context.gens()
        self.zero, self.one = self.constant(0), self.constant(1)
        self.factors: list[fmpq_mpoly] = []
        self.numbers: dict[tuple, int] = {}

    def constant(self, value: fmpq | int) -> fmpq_mpoly:
        """A rational number as a polynomial."""
        return self.context.constant(value)

    def total(self, values: list[Value]) -> Value:
        """Σ values, group by group."""
        result: Value = {}
        for value in values:
            for below, (a, b) in value.items():
                known = result.get(below)
                result[below] = (a, b) if known is None else (known[0] + a, known[1] + b)
        return result

    def times(self, left: Value, right: Value) -> Value:
        """A product; two sums are brought to a common denominator first."""
        if len(left) > 1 and len(right) > 1:
            left, right = self.combined(left), self.combined(right)
        return self.total(
            [{_joined(d, e): _product(p, q)} for d, p in left.items() for e, q in right.items()]
        )

    def product(self, below: Denominator) -> fmpq_mpoly:
        """A denominator multiplied out."""
        result = self.one
        for number, power in below:
            result = result * self.factors[number] ** power
        return result

    def combined(self, value: Value) -> Value:
        """The same value as one fraction over the least common denominator."""
        highest: dict[int, int] = {}
        for below in value:
            for number, power in below:
                highest[number] = max(highest.get(number, 0), power)
        real, imaginary = self.zero, self.zero
        for below, (a, b) in value.items():
            present = dict(below)
            missing = self.product(tuple((n, m - present.get(n, 0)) for n, m in highest.items()))
            real, imaginary = real + a * missing, imaginary + b * missing
        return {tuple(sorted(highest.items())): (real, imaginary)}

    def fraction(self, value: Value) -> tuple[Pair, fmpq_mpoly]:
        """Numerator and denominator, multiplied out."""
        ((below, pair),) = self.combined(value).items()
        return pair, self.product(below)

    def over(self, pair: Pair, below: fmpq_mpoly) -> Value:
        """(a + ib)/below, the denominator split into irreducible factors."""
        content, factors = below.factor()
        denominator: dict[int, int] = {}
        for factor, power in factors:
            leading = factor.leading_coefficient()
            content = content * leading ** int(power)
            factor = factor / leading
            number = self.numbers.setdefault(tuple(factor.terms()), len(self.factors))
            if number == len(self.factors):
                self.factors.append(factor)
            denominator[number] = int(power)
        return {tuple(sorted(denominator.items())): (pair[0] / content, pair[1] / content)}

    def inverse(self, value: Value) -> Value:
        """1/value: (a − ib)/(a² + b²), a real denominator; ZeroDivisionError for 0."""
        ((below, (a, b)),) = self.combined(value).items()
        if a.is_zero() and b.is_zero():
            raise ZeroDivisionError("a sum of fractions that vanishes has no inverse")
        above = self.product(below)
        if a.is_zero():
            return self.over((self.zero, -above), b)
        if b.is_zero():
            return self.over((above, self.zero), a)
        return self.over((above * a, -above * b), a * a + b * b)

    def power(self, value: Value, exponent: int) -> Value:
        """value^exponent, exponent ≥ 1, by repeated squaring."""
        value = self.combined(value)
        result: Value | None = None
        while True:
            if exponent & 1:
                result = value if result is None else self.times(result, value)
            exponent >>= 1
            if not exponent:
                return result or value
            value = self.times(value, value)


def _joined(left: Denominator, right: Denominator) -> Denominator:
    if not left or not right:
        return left or right
    powers = dict(left)
    for number, power in right:
        powers[number] = powers.get(number, 0) + power
    return tuple(sorted(powers.items()))


def _product(left: Pair, right: Pair) -> Pair:
    (a, b), (c, d) = left, right
    return a * c - b * d, a * d + b * c
