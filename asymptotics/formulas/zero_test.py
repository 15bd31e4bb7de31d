r"""Does an expression in Ω, s, … and circular functions vanish identically?  Exactly, no sampling.

An *angle* is a sum of monomials in the symbols with rational coefficients, such as 2Ω + Ωs,
2Ω(ξ − 1) or ωx₀/c. Let m₁, m₂, … be the monomials of all angles of an expression and L_k the
common denominator of the coefficients of m_k. With

.. math:: y_k = e^{i m_k / L_k}

every circular function is a rational function of the y_k. The m_k are linearly independent over ℚ
modulo constants, so the y_k are algebraically independent over ℂ(Ω, s, …) (Ostrowski's theorem,
Lindemann–Weierstrass for functions): **an expression vanishes identically exactly when its
numerator, a polynomial in the symbols and the y_k, is the zero polynomial.**

This shares nothing with :mod:`asymptotics.rings.cotangent`. It is fast because
:mod:`asymptotics.formulas.grouped_fractions`, the arithmetic, multiplies out late.
"""

from __future__ import annotations

from fractions import Fraction
from math import lcm
from typing import Any

import sympy
from flint import fmpq, fmpq_mpoly

from asymptotics.errors import InputError
from asymptotics.formulas.grouped_fractions import FractionField, Pair, Value

Angle = dict[Any, Fraction]
"""{monomial: coefficient}."""

# With e^{ia} = P/Q in coprime monomials, C = P² + Q², D = P² − Q² and M = 2PQ: the numerator, the
# denominator and the power of i of each circular function of a.
_CIRCULAR = {
    sympy.cos: ("C", "M", 0),
    sympy.sin: ("D", "M", 3),
    sympy.tan: ("D", "C", 3),
    sympy.cot: ("C", "D", 1),
    sympy.sec: ("M", "C", 0),
    sympy.csc: ("M", "D", 1),
    sympy.exp: ("P", "Q", 0),
    sympy.sinc: ("D", "M", 3),
}
_ALLOWED = "sin, cos, tan, cot, sec, csc, sinc, and exp of an imaginary angle"


def is_identically_zero(expression: Any) -> bool:
    """Whether the expression is zero for all values of its symbols.

    Parameters
    ----------
    expression
        A SymPy expression: rational in its symbols, in I and in sin, cos, tan, cot, sec, csc, sinc
        of angles, and in exp of I times an angle. All numbers are exact.

    Raises
    ------
    InputError
        The expression holds something else, or a denominator that vanishes identically; the
        message quotes that sub-expression.

    Examples
    --------
    >>> from sympy import cos, cot, sin, symbols
    >>> O, s = symbols("Omega s")
    >>> is_identically_zero(cot(3*O) * (cot(O) + cot(2*O)) - cot(O)*cot(2*O) + 1)
    True
    >>> is_identically_zero(sin(2*O + O*s) - sin(2*O)*cos(O*s) + cos(2*O)*sin(O*s))
    False
    >>> is_identically_zero(0.5*sin(O))      # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    asymptotics.errors.InputError: zero test: 0.5... is a float, not an exact number; use Rational
    """
    return are_equal(expression, 0)


def are_equal(a: Any, b: Any) -> bool:
    """Whether two expressions are the same function; see :func:`is_identically_zero`.

    >>> from sympy import sin, sec, symbols, tan
    >>> O = symbols("Omega")
    >>> are_equal(tan(O), sin(O) * sec(O))
    True
    """
    first, second = _checked(a), _checked(b)
    together = _Expressions((first, second))
    real, imaginary = together.difference(first, second)[0]
    return bool(real.is_zero() and imaginary.is_zero())


def are_equal_through(a: Any, b: Any, symbol: Any, power: int) -> bool:
    """Whether two expressions agree up to and including ``symbol**power``.

    Both are taken as power series in the symbol, which the circular functions must not contain.

    Raises
    ------
    InputError
        As :func:`is_identically_zero`; also when the difference has a pole at symbol = 0 that does
        not cancel by itself, or the symbol stands in an angle.

    Examples
    --------
    >>> from sympy import cos, symbols
    >>> O, e = symbols("Omega epsilon")
    >>> are_equal_through(cos(O) / (1 - e*cos(O)), cos(O) + e*cos(O)**2, e, 1)
    True
    >>> are_equal_through(cos(O) / (1 - e*cos(O)), cos(O) + e*cos(O)**2, e, 2)
    False
    """
    if isinstance(power, bool) or not isinstance(power, int) or power < 0:
        raise InputError(f"power = {power!r}; give a whole number ≥ 0")
    first, second, variable = _checked(a), _checked(b), _checked(symbol)
    together = _Expressions((first, second, variable))
    pair, below = together.difference(first, second)
    position = together.position(variable)
    if all(int(monomial[position]) for monomial in below.monoms()):
        raise InputError(
            f"zero test: the difference of the two expressions has a pole at {variable} = 0 and is "
            f"no power series in {variable}; multiply both by a power of {variable}"
        )
    # Without that pole the denominator is a unit of the power series: only the numerator counts.
    return not any(int(m[position]) <= power for part in pair for m in part.monoms())


def _quoted(expression: Any) -> str:
    text = str(expression)
    return text if len(text) <= 80 else text[:77] + "..."


def _checked(expression: Any) -> sympy.Expr:
    """The argument as a SymPy expression; text is refused because SymPy would evaluate it."""
    if isinstance(expression, (str, bool)):
        raise InputError(f"zero test: {expression!r} is not an expression; give a SymPy expression")
    try:
        result = sympy.sympify(expression, strict=True)
    except sympy.SympifyError:
        result = None
    if not isinstance(result, sympy.Expr) or result.is_commutative is False:
        raise InputError(
            f"zero test: {_quoted(expression)!r} is not a commutative SymPy expression; compare "
            "equations and matrices entry by entry"
        )
    return result


def _refuse_number(number: Any) -> InputError:
    if isinstance(number, sympy.Float):
        return InputError(f"zero test: {number} is a float, not an exact number; use Rational")
    return InputError(
        f"zero test: cannot handle the number {_quoted(number)}; rational numbers and I are allowed"
    )


def angle_of(function: Any) -> Angle:
    """The argument of a circular function as {monomial: coefficient}; exp is taken of I times it.

    >>> from sympy import sin, symbols
    >>> O, s = symbols("Omega s")
    >>> angle_of(sin(O * (2 - s/3)))
    {Omega: Fraction(2, 1), Omega*s: Fraction(-1, 3)}
    """
    argument = function.args[0]
    if function.func is sympy.exp:
        argument = -sympy.I * argument
    angle: Angle = {}
    for monomial, number in sympy.expand(argument).as_coefficients_dict().items():
        if isinstance(number, sympy.Float):
            raise _refuse_number(number)
        powers = monomial.as_powers_dict()
        good = all(base.is_Symbol and power.is_Integer for base, power in powers.items())
        if not (good and powers and number.is_Rational and monomial != 1):
            raise InputError(
                f"zero test: cannot handle the angle of {_quoted(function)}; an angle is a sum of "
                "monomials in the symbols with rational coefficients and without a constant"
            )
        angle[monomial] = Fraction(int(number.p), int(number.q))
    return dict(sorted(angle.items(), key=lambda item: str(item[0])))


class _Expressions:
    """Some expressions as members of one field, ℚ(i)(symbols, y₁, y₂, …)."""

    def __init__(self, expressions: tuple[sympy.Expr, ...]) -> None:
        everything = sympy.Tuple(*expressions)
        self.symbols = sorted(everything.atoms(sympy.Symbol), key=str)
        for left, right in zip(self.symbols, self.symbols[1:], strict=False):
            if str(left) == str(right):
                raise InputError(
                    f"zero test: two different symbols are called {left} (their assumptions "
                    "differ); use the symbols of asymptotics.formulas.closed_form.symbols()"
                )
        self.angles = {f: angle_of(f) for f in everything.atoms(*_CIRCULAR)}
        self.units: dict[Any, int] = {}
        for angle in self.angles.values():
            for m, coefficient in angle.items():
                self.units[m] = lcm(self.units.get(m, 1), coefficient.denominator)
        self.field = FractionField(len(self.symbols) + len(self.units))
        generators = self.field.generators
        self.x = dict(zip(self.symbols, generators, strict=False))
        self.y = dict(zip(self.units, generators[len(self.symbols) :], strict=True))
        self.known: dict[Any, Value] = {}

    def position(self, symbol: Any) -> int:
        """The index of a symbol that no angle contains."""
        if symbol not in self.x or any(symbol in m.free_symbols for m in self.units):
            raise InputError(
                f"zero test: {_quoted(symbol)} is not a symbol outside of all circular functions; "
                "only in such a symbol can expressions be compared power by power"
            )
        return self.symbols.index(symbol)

    def difference(self, a: sympy.Expr, b: sympy.Expr) -> tuple[Pair, fmpq_mpoly]:
        """Numerator and denominator of a − b."""
        field = self.field
        minus = field.times(self.convert(b), {(): (-field.one, field.zero)})
        return field.fraction(field.total([self.convert(a), minus]))

    def convert(self, expression: Any) -> Value:
        """An expression as a value, each sub-expression once."""
        if expression not in self.known:
            self.known[expression] = self._convert(expression)
        return self.known[expression]

    def _convert(self, expression: Any) -> Value:
        if expression.is_Add:
            return self.field.total([self.convert(part) for part in expression.args])
        if expression.is_Mul:
            result: Value = {(): (self.field.one, self.field.zero)}
            for part in sorted(expression.args, key=lambda part: bool(part.is_Add)):
                result = self.field.times(result, self.convert(part))
            return result
        if expression in self.angles:
            return self._circular(expression)
        if expression.is_Pow and expression.exp.is_Integer:
            base, exponent = expression.base, int(expression.exp)
            value = self._inverse(base) if exponent < 0 else self.convert(base)
            return self.field.power(value, abs(exponent))
        return {(): self._leaf(expression)}

    def _inverse(self, expression: Any) -> Value:
        value = self.convert(expression)
        try:
            return self.field.inverse(value)
        except ZeroDivisionError:
            raise InputError(
                f"zero test: the denominator {_quoted(expression)} vanishes identically"
            ) from None

    def _leaf(self, expression: Any) -> Pair:
        if expression.is_Symbol:
            return self.x[expression], self.field.zero
        if expression.is_Rational:
            return self.field.constant(fmpq(int(expression.p), int(expression.q))), self.field.zero
        if expression is sympy.I:
            return self.field.zero, self.field.one
        if expression.is_number and expression.is_Atom:
            raise _refuse_number(expression)
        allowed = "powers must be whole numbers" if expression.is_Pow else f"allowed are {_ALLOWED}"
        raise InputError(f"zero test: cannot handle {_quoted(expression)}; {allowed}")

    def _circular(self, function: Any) -> Value:
        field = self.field
        up, down = field.one, field.one
        for m, coefficient in self.angles[function].items():
            exponent = int(coefficient * self.units[m])
            if exponent > 0:
                up = up * self.y[m] ** exponent
            else:
                down = down * self.y[m] ** -exponent
        c, d = up * up + down * down, up * up - down * down
        parts = {"P": up, "Q": down, "C": c, "D": d, "M": 2 * up * down}
        above, below, turns = _CIRCULAR[function.func]
        if parts[below].is_zero():
            raise InputError(
                f"zero test: {_quoted(function)} is infinite identically; simplify its angle"
            )
        number = parts[above] if turns < 2 else -parts[above]
        pair = (field.zero, number) if turns % 2 else (number, field.zero)
        value = field.over(pair, parts[below])
        if function.func is sympy.sinc:
            value = field.times(value, self._inverse(function.args[0]))
        return value
