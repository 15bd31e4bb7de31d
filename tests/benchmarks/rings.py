"""The rivals' rings: the same engine, the same algorithm, other coefficients.

All three hold polynomials in Ω and the raw cotangents k₁, k₂, …, which are not independent, so that
lengths grow 2.65-fold an order; ``sum`` expands, which makes polynomials canonical.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import symengine
import sympy
from sympy.polys.domains import QQ
from sympy.polys.rings import ring as polynomial_ring


class SympyRing:
    """SymPy expressions."""

    even = True
    zero: Any = sympy.Integer(0)
    one: Any = sympy.Integer(1)

    def __init__(self, order: int) -> None:
        self.omega: Any = sympy.Symbol("Omega")
        self.cotangents: list[Any] = [sympy.Symbol(f"k{j}") for j in range(1, order + 1)]

    def cot(self, j: int) -> Any:
        return self.cotangents[j - 1]

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        return sympy.Rational(numerator, denominator)

    def sum(self, terms: Iterable[Any]) -> Any:
        return sympy.expand(sympy.Add(*terms))

    def conjugate(self, element: Any) -> Any:
        return element

    def is_zero(self, element: Any) -> bool:
        return element == self.zero

    def evaluate(self, element: Any, values: list[float]) -> float:
        """The element at Ω, k₁, k₂, …"""
        symbols = [self.omega, *self.cotangents]
        return float(element.subs(dict(zip(symbols, values, strict=True))))

    def length(self, element: Any) -> int:
        """The number of monomials."""
        return len(sympy.Add.make_args(element))


class SymengineRing(SympyRing):
    """SymEngine expressions: SymPy's design in C++."""

    zero = symengine.Integer(0)
    one = symengine.Integer(1)

    def __init__(self, order: int) -> None:
        self.omega = symengine.Symbol("Omega")
        self.cotangents = [symengine.Symbol(f"k{j}") for j in range(1, order + 1)]

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        return symengine.Rational(numerator, denominator)

    def sum(self, terms: Iterable[Any]) -> Any:
        return symengine.expand(symengine.Add(*terms))


class PolynomialRing(SympyRing):
    """Elements of ``sympy.polys.rings``: sparse polynomials as dictionaries."""

    def __init__(self, order: int) -> None:
        names = ["Omega", *(f"k{j}" for j in range(1, order + 1))]
        self.ring, self.omega, *self.cotangents = polynomial_ring(names, QQ)
        self.zero, self.one = self.ring.zero, self.ring.one

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        return self.ring.ground_new(QQ(numerator, denominator))

    def sum(self, terms: Iterable[Any]) -> Any:
        return self.ring.add(*terms)

    def is_zero(self, element: Any) -> bool:
        return not element

    def evaluate(self, element: Any, values: list[float]) -> float:
        total = 0.0
        for monomial, coefficient in element.terms():
            product = float(coefficient)
            for value, power in zip(values, monomial, strict=True):
                product *= value**power
            total += product
        return total

    def length(self, element: Any) -> int:
        return len(element)
