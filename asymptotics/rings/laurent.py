r"""Truncated Laurent series in μ = Ω − pπ/q: the ring that finds the tongues.

An element is Σ_k a_k μ^k + O(μ^P) with exact coefficients, polynomials in π over ℚ(cot(pπ/q))
(:mod:`asymptotics.rings.resonance_field`).

Precision is absolute and honest: P is carried through sums and products, a leading coefficient that
cancellation has eaten raises :class:`TruncationError`, and an element without any known coefficient
is not zero. ``terms`` bounds how many coefficients are kept, counted from the leading one, as the
length of a mantissa does.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from flint import fmpq

from asymptotics.errors import InputError, RopewaveError
from asymptotics.rings.resonance_field import ONE, ZERO, C, Coefficient, ResonanceField, constant


class TruncationError(RopewaveError, ArithmeticError):
    """A coefficient that the O-term of a truncated series covers."""


@dataclass(frozen=True, slots=True, eq=False)
class LaurentElement:
    """Σ_i coefficients[i] μ^{valuation + i} + O(μ^precision); exact when ``precision`` is None.

    Products are left unreduced modulo the minimal polynomial of c, and with leading zeros in place,
    because the engine sums many of them before anybody looks at one; :meth:`LaurentRing.sum` puts
    them in canonical form.
    """

    valuation: int
    coefficients: tuple[Coefficient, ...]
    precision: int | None = None

    def __mul__(self, other: LaurentElement) -> LaurentElement:
        if self.is_exact_zero() or other.is_exact_zero():
            return LaurentElement(0, ())
        valuation = self.valuation + other.valuation
        bounds = []
        if self.precision is not None:
            bounds.append(self.precision + other.valuation)
        if other.precision is not None:
            bounds.append(other.precision + self.valuation)
        precision = min(bounds, default=None)
        length = len(self.coefficients) + len(other.coefficients) - 1
        if precision is not None:
            length = min(length, precision - valuation)
        products = [ZERO] * max(length, 0)
        for i, a in enumerate(self.coefficients):
            for j, b in enumerate(other.coefficients[: max(length - i, 0)]):
                products[i + j] = products[i + j] + a * b
        return LaurentElement(valuation, tuple(products), precision)

    def is_exact_zero(self) -> bool:
        """No coefficient and no O-term."""
        return not self.coefficients and self.precision is None

    def coefficient(self, k: int) -> Coefficient:
        """The coefficient of μ^k, a polynomial in π and c.

        Raises
        ------
        TruncationError
            The O-term covers it.
        """
        if self.precision is not None and k >= self.precision:
            raise TruncationError(
                f"the coefficient of mu^{k} is not determined: the series is known up to "
                f"O(mu^{self.precision}). Give the ring more terms"
            )
        i = k - self.valuation
        return self.coefficients[i] if 0 <= i < len(self.coefficients) else ZERO

    def leading(self) -> tuple[int, Coefficient]:
        """(k, a_k) of the first non-zero term of a canonical element.

        Raises
        ------
        TruncationError
            No coefficient is known: all that is left is the O-term.
        ValueError
            The element is exactly zero.
        """
        if self.is_exact_zero():
            raise ValueError("zero has no leading term")
        if not self.coefficients:
            raise TruncationError(
                f"the leading coefficient is not determined: only O(mu^{self.precision}) is left. "
                "Give the ring more terms"
            )
        return self.valuation, self.coefficients[0]

    def __repr__(self) -> str:
        parts = [
            f"({a})*mu^{self.valuation + i}"
            for i, a in enumerate(self.coefficients)
            if not a.is_zero()
        ]
        if self.precision is not None:
            parts.append(f"O(mu^{self.precision})")
        return " + ".join(parts) or "0"


class LaurentRing:
    """Laurent series in μ at the resonance Ω = pπ/q, ``terms`` coefficients each.

    Raises
    ------
    InputError
        p/q is not in lowest terms, or ``terms`` is below 1.

    Examples
    --------
    >>> ring = LaurentRing(1, 2, terms=3)
    >>> ring.omega                           # π/2 + μ, exactly
    (1/2*pi)*mu^0 + (1)*mu^1
    >>> ring.cot(2)                          # cot(π + 2μ)
    (1/2)*mu^-1 + (-2/3)*mu^1 + O(mu^2)
    >>> ring.cot(1)                          # cot(π/2 + μ)
    (-1)*mu^1 + (-1/3)*mu^3 + O(mu^4)
    """

    even = True
    zero = LaurentElement(0, ())
    one = LaurentElement(0, (ONE,))

    def __init__(self, p: int, q: int, terms: int = 2) -> None:
        self.field = ResonanceField(p, q)
        if isinstance(terms, bool) or not isinstance(terms, int) or terms < 1:
            raise InputError(f"terms = {terms!r}; keep at least 1 coefficient")
        self.p, self.q, self.terms = p, q, terms
        self.omega = LaurentElement(0, (self.field.centre, ONE))

    def rational(self, numerator: int, denominator: int = 1) -> LaurentElement:
        """The image of a rational number, exact."""
        if numerator == 0:
            return self.zero
        return LaurentElement(0, (constant(fmpq(numerator, denominator)),))

    def conjugate(self, element: LaurentElement) -> LaurentElement:
        """The element itself: the state is even in time."""
        return element

    def is_zero(self, element: LaurentElement) -> bool:
        """Exactly zero; O(μ^P) alone is unknown, not zero."""
        return element.precision is None and all(
            self.field.reduce(a).is_zero() for a in element.coefficients
        )

    def sum(self, terms: Iterable[LaurentElement]) -> LaurentElement:
        """Σ terms in canonical form: reduced, a non-zero first coefficient, at most ``terms``."""
        precision: int | None = None
        total: dict[int, Coefficient] = {}
        for term in terms:
            if term.precision is not None:
                bound = term.precision
                precision = bound if precision is None else min(precision, bound)
            for k, a in enumerate(term.coefficients, start=term.valuation):
                known = total.get(k)
                total[k] = a if known is None else known + a
        reduced = {
            k: a
            for k, raw in total.items()
            if (precision is None or k < precision) and not (a := self.field.reduce(raw)).is_zero()
        }
        if not reduced:
            return self.zero if precision is None else LaurentElement(precision, (), precision)
        first, last = min(reduced), max(reduced)
        if last - first >= self.terms:
            last, precision = first + self.terms - 1, first + self.terms
        return LaurentElement(
            first, tuple(reduced.get(k, ZERO) for k in range(first, last + 1)), precision
        )

    def cot(self, j: int) -> LaurentElement:
        """κⱼ = cot jΩ: a pole 1/(jμ) where q divides j, a Taylor series elsewhere."""
        if j % self.q == 0:
            return self._pole(j)
        # y = cot(jΩ₀ + jμ) obeys y′ = −j (1 + y²); a zero of the cotangent is of first order, so
        # one coefficient beyond ``terms`` is enough.
        y = [self.field.cot(j)]
        for n in range(self.terms):
            square = sum((y[i] * y[n - i] for i in range(n + 1)), ONE if n == 0 else ZERO)
            y.append(self.field.reduce(square * fmpq(-j, n + 1)))
        return self.sum([LaurentElement(0, tuple(y), len(y))])

    def _pole(self, j: int) -> LaurentElement:
        """cot jμ = Σ (−4)^k B_{2k} (jμ)^{2k−1}/(2k)!."""
        coefficients = [ZERO] * self.terms
        factorial = fmpq(1)
        for i in range(self.terms):
            if i:
                factorial = factorial * i
            if i % 2 == 0:
                value = fmpq(-4) ** (i // 2) * fmpq.bernoulli(i) / factorial * fmpq(j) ** (i - 1)
                coefficients[i] = constant(value)
        return LaurentElement(-1, tuple(coefficients), self.terms - 1)

    @cached_property
    def cosecant_power(self) -> LaurentElement:
        r"""sin^{−q} Ω, which turns ε̂^q into ε^q.

        At the resonance sin^q Ω₀ (c + i)^q = (−1)^p, so that sin^{−q} Ω₀ = (−1)^p P_q(c) is in the
        field; sin Ω₀ itself is not when q is even. Beside it, 1/sin Ω has a pole when q = 1.
        """
        size = self.terms
        sign = -1 if self.p % 2 else 1
        sine, cosine = _circular(size + 1)
        if self.q == 1:
            unit = [constant(sign * a) for a in sine[1:]]
            return LaurentElement(-1, tuple(self._inverse_series(unit, size)), size - 1)
        unit = [constant(a) + C * b for a, b in zip(cosine, sine, strict=True)]
        series = self._inverse_series(unit[:size], size)
        power = LaurentElement(0, (self.field.cosecant_power(),))
        for _ in range(self.q):
            power = self.sum([power * LaurentElement(0, tuple(series), size)])
        return power

    def _inverse_series(self, unit: list[Coefficient], size: int) -> list[Coefficient]:
        """Coefficients of 1/Σ unit[k] μ^k, where unit[0] = ±1 is its own inverse."""
        first = unit[0]
        inverse = [first]
        for n in range(1, size):
            rest = sum((unit[k] * inverse[n - k] for k in range(1, n + 1)), ZERO)
            inverse.append(self.field.reduce(-first * rest))
        return inverse


def _circular(size: int) -> tuple[list[fmpq], list[fmpq]]:
    """Taylor coefficients of sin and cos."""
    sine, cosine, factorial = [], [], fmpq(1)
    for n in range(size):
        if n:
            factorial = factorial * n
        value = fmpq(-1) ** (n // 2) / factorial
        sine.append(value if n % 2 else fmpq(0))
        cosine.append(fmpq(0) if n % 2 else value)
    return sine, cosine
