r"""The exact ring: polynomials in Ω and all the cotangents κⱼ = cot jΩ.

Every coefficient of the string's expansion is a polynomial in Ω, κ₁, κ₂, … with rational
coefficients. Those generators are not independent — cot(a+b)(cot a + cot b) = cot a cot b − 1 —
so the same coefficient has many such polynomials, and their length grows 2.65-fold an order. Here
everything is written in the one variable c = κ₁ instead. From

.. math:: (c + i)^j = P_j(c) + i Q_j(c), \qquad κ_j = P_j / Q_j,

the only denominators are those of the resonances: Q_j is, up to an integer, the product of Ψ_q over
the divisors q ≥ 2 of j, where Ψ_q is the primitive integer polynomial whose roots are cot(pπ/q)
with gcd(p, q) = 1. (The resonances p/1 are the pole of c itself.) An element is

.. math:: \frac{A(Ω, c)}{d \, \prod_q Ψ_q(c)^{m_q}}, \qquad A ∈ ℤ[Ω, c],

unique once d and the content of A are coprime and no Ψ_q with m_q > 0 divides A. The Ψ_q are known
beforehand, squarefree and without a common root (and irreducible unless 4 divides q), so finding
that form takes trial divisions only, never a gcd of polynomials; the exponent m_q is the order of
the pole at the nonlinear resonances Ω = pπ/q.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from math import gcd, lcm
from typing import Any

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from asymptotics.errors import InputError

_CONTEXT = fmpz_mpoly_ctx.get(["Omega", "c"], Ordering.lex)
_OMEGA, _C = _CONTEXT.gens()
_ZERO, _ONE = _CONTEXT.constant(0), _CONTEXT.constant(1)

Poles = tuple[int, ...]
"""Exponents (m₂, m₃, …) of Ψ₂, Ψ₃, …, without trailing zeros."""

MOST = 100_000
"""No exponent is larger: degrees grow like a power of the order, to 391 at order 20."""


@cache
def cotangent_powers(j: int) -> tuple[fmpz_poly, fmpz_poly]:
    """(P_j, Q_j) with (c + i)^j = P_j(c) + i Q_j(c), so that cot jΩ = P_j/Q_j.

    >>> cotangent_powers(3)
    (x^3 + (-3)*x, 3*x^2 + (-1))
    """
    if j == 0:
        return fmpz_poly([1]), fmpz_poly([0])
    p, q = cotangent_powers(j - 1)
    c = fmpz_poly([0, 1])
    return c * p - q, p + c * q


@cache
def resonance_polynomial(q: int) -> fmpz_poly:
    """Ψ_q(c), the primitive polynomial with the roots cot(pπ/q), gcd(p, q) = 1; q ≥ 2.

    >>> [str(resonance_polynomial(q)) for q in (2, 3, 4, 6)]
    ['x', '3*x^2 + (-1)', 'x^2 + (-1)', 'x^2 + (-3)']
    """
    rest = cotangent_powers(q)[1]
    for divisor in range(2, q):
        if q % divisor == 0:
            rest = rest / resonance_polynomial(divisor)
    return rest / rest.content()


def _in_c(poly: fmpz_poly) -> fmpz_mpoly:
    return _CONTEXT.from_dict({(0, i): a for i, a in enumerate(poly.coeffs()) if a})


@cache
def _factor(q: int) -> fmpz_mpoly:
    return _in_c(resonance_polynomial(q))


@lru_cache(maxsize=4096)
def _product(poles: Poles) -> fmpz_mpoly:
    """∏ Ψ_q^{m_q}."""
    product = _ONE
    for q, power in enumerate(poles, start=2):
        if power:
            product = product * _factor(q) ** power
    return product


@dataclass(frozen=True, slots=True, eq=False)
class CotangentElement:
    """A(Ω, c) / (d ∏ Ψ_q(c)^{m_q}), see the module's docstring.

    A product is left unreduced, because the engine sums many products before anybody looks at one;
    :meth:`CotangentRing.sum` and :meth:`canonical` reduce.
    """

    numerator: fmpz_mpoly
    denominator: int = 1
    poles: Poles = ()

    def __mul__(self, other: CotangentElement) -> CotangentElement:
        long, short = self.poles, other.poles
        if len(long) < len(short):
            long, short = short, long
        poles = tuple(a + b for a, b in zip(long, short, strict=False)) + long[len(short) :]
        return CotangentElement(
            self.numerator * other.numerator, self.denominator * other.denominator, poles
        )

    def __add__(self, other: CotangentElement) -> CotangentElement:
        return _sum((self, other))

    def __neg__(self) -> CotangentElement:
        return CotangentElement(-self.numerator, self.denominator, self.poles)

    def __sub__(self, other: CotangentElement) -> CotangentElement:
        return _sum((self, -other))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CotangentElement) and _sum((self, -other)).is_zero()

    def __hash__(self) -> int:
        form = self.canonical()
        terms = tuple(sorted((tuple(map(int, m)), int(a)) for m, a in form.numerator.terms()))
        return hash((terms, form.denominator, form.poles))

    def __repr__(self) -> str:
        below = [str(self.denominator)] if self.denominator != 1 else []
        below += [
            f"({_factor(q)})" + (f"^{m}" if m > 1 else "")
            for q, m in enumerate(self.poles, start=2)
            if m
        ]
        return f"({self.numerator})" + (f"/({'*'.join(below)})" if below else "")

    def is_zero(self) -> bool:
        """Exact: the numerator vanishes."""
        return bool(self.numerator.is_zero())

    def canonical(self) -> CotangentElement:
        """The same element with every common factor removed."""
        return _sum((self,))

    def rows(self) -> dict[int, fmpz_poly]:
        """The numerator by powers of Ω: ``{a: A_a(c)}`` with A = Σ Ω^a A_a(c)."""
        rows: dict[int, dict[int, int]] = {}
        for (a, i), coefficient in self.numerator.terms():
            rows.setdefault(int(a), {})[int(i)] = int(coefficient)
        return {
            a: fmpz_poly([row.get(i, 0) for i in range(max(row) + 1)])
            for a, row in sorted(rows.items())
        }

    def divided_by_omega(self) -> CotangentElement:
        """The element over Ω; exact, and an ArithmeticError when Ω does not divide it."""
        quotient, remainder = divmod(self.numerator, _OMEGA)
        if not remainder.is_zero():
            raise ArithmeticError(f"Ω does not divide {self!r}")
        return CotangentElement(quotient, self.denominator, self.poles)


def _sum(terms: Iterable[CotangentElement]) -> CotangentElement:
    """Σ terms over the smallest common denominator, in canonical form."""
    groups: dict[tuple[Poles, int], fmpz_mpoly] = {}
    for term in terms:
        key = (term.poles, term.denominator)
        known = groups.get(key)
        groups[key] = term.numerator if known is None else known + term.numerator
    denominator = lcm(*(d for _, d in groups))
    width = max((len(poles) for poles, _ in groups), default=0)
    highest = [0] * width
    by_poles: dict[Poles, fmpz_mpoly] = {}
    for (poles, d), numerator in groups.items():
        for i, power in enumerate(poles):
            highest[i] = max(highest[i], power)
        if d != denominator:
            numerator = numerator * (denominator // d)
        known = by_poles.get(poles)
        by_poles[poles] = numerator if known is None else known + numerator
    total = _ZERO
    for poles, numerator in by_poles.items():
        missing = tuple(top - (poles[i] if i < len(poles) else 0) for i, top in enumerate(highest))
        total = total + (numerator * _product(missing) if any(missing) else numerator)
    return _reduced(total, denominator, highest)


def _reduced(numerator: fmpz_mpoly, denominator: int, poles: list[int]) -> CotangentElement:
    """Trial division by each Ψ_q that stands below, then by the common content."""
    if numerator.is_zero():
        return CotangentElement(_ZERO)
    for i, power in enumerate(poles):
        while power:
            quotient, remainder = divmod(numerator, _factor(i + 2))
            if not remainder.is_zero():
                break
            numerator, power = quotient, power - 1
        poles[i] = power
    while poles and poles[-1] == 0:
        poles.pop()
    common = gcd(int(numerator.content()), denominator)  # type: ignore[attr-defined]
    if common != 1:
        numerator, denominator = numerator / _CONTEXT.constant(common), denominator // common
    return CotangentElement(numerator, denominator, tuple(poles))


def check_element(terms: Iterable[Sequence[Any]], denominator: Any, poles: Sequence[Any]) -> None:
    """Whether Σ v Ω^a c^i over d ∏ Ψ_q^{m_q} is an element, given as (a, i, v), d and (m₂, m₃, …).

    Whole numbers throughout; d > 0, the v not zero, each (a, i) once, and no exponent, of Ω, c or a
    Ψ_q, negative or above :data:`MOST`.

    Raises
    ------
    InputError
        It is not, and why.

    Examples
    --------
    >>> check_element([(0, 1, -3)], 0, ())
    Traceback (most recent call last):
        ...
    asymptotics.errors.InputError: the denominator 0 is not a whole number > 0
    """
    if type(denominator) is not int or denominator < 1:
        raise InputError(f"the denominator {_quoted(denominator)} is not a whole number > 0")
    seen = set()
    for a, i, v in terms:
        if not (_is_exponent(a) and _is_exponent(i)) or (a, i) in seen:
            raise InputError(
                f"the exponents {_quoted((a, i))} of a term are not whole numbers from 0 to "
                f"{MOST}, each pair once"
            )
        if type(v) is not int or v == 0:
            raise InputError(f"the coefficient {_quoted(v)} is not a whole number other than 0")
        seen.add((a, i))
    if len(poles) > MOST or not all(map(_is_exponent, poles)):
        raise InputError(
            f"the exponents {_quoted(poles)} of the poles are not whole numbers from 0 to {MOST}"
        )


def _is_exponent(value: Any) -> bool:
    return type(value) is int and 0 <= value <= MOST


def _quoted(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


class CotangentRing:
    """ℚ[Ω, cot Ω, cot 2Ω, …] with an exact zero test.

    >>> ring = CotangentRing()
    >>> k = ring.cot
    >>> ring.is_zero(k(3) * (k(1) + k(2)) - k(1) * k(2) + ring.one)
    True
    >>> k(2)
    (c^2 - 1)/(2*(c))
    """

    even = True
    zero = CotangentElement(_ZERO)
    one = CotangentElement(_ONE)
    omega = CotangentElement(_OMEGA)

    def rational(self, numerator: int, denominator: int = 1) -> CotangentElement:
        """A rational number; the denominator is positive."""
        return CotangentElement(_CONTEXT.constant(numerator), denominator)

    def cot(self, j: int) -> CotangentElement:
        """κⱼ = cot jΩ, j ≥ 1, or an :class:`InputError`."""
        if j < 1:
            raise InputError(f"cot({j}*Omega) is not in the ring; give a harmonic j ≥ 1")
        p, q = cotangent_powers(j)
        poles = tuple(int(j % k == 0) for k in range(2, j + 1))
        return CotangentElement(_in_c(p), int(q.content()), poles)

    def element(
        self, terms: Mapping[tuple[int, ...], int], denominator: int, poles: Poles
    ) -> CotangentElement:
        """Σ terms[a, i] Ω^a c^i over d ∏ Ψ_q^{m_q}, as read back from a saved derivation.

        Raises
        ------
        InputError
            What :func:`check_element` refuses.
        """
        check_element(((a, i, v) for (a, i), v in terms.items()), denominator, poles)
        return CotangentElement(
            _CONTEXT.from_dict(dict(terms)), denominator, tuple(poles)
        ).canonical()

    def sum(self, terms: Iterable[CotangentElement]) -> CotangentElement:
        """Σ terms, in canonical form."""
        return _sum(terms)

    def conjugate(self, element: CotangentElement) -> CotangentElement:
        """The element itself: the state is even in time."""
        return element

    def is_zero(self, element: CotangentElement) -> bool:
        """Whether the element vanishes identically in Ω."""
        return element.is_zero()
