"""SymPy's expressions of parameters as balls, in the precision of the moment."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy
from flint import acb, arb, fmpq, fmpz

from asymptotics.errors import InputError

_FUNCTIONS = {
    sympy.exp: acb.exp,
    sympy.log: acb.log,
    sympy.sin: acb.sin,
    sympy.cos: acb.cos,
    sympy.tan: acb.tan,
    sympy.cot: acb.cot,
    sympy.sinh: acb.sinh,
    sympy.cosh: acb.cosh,
    sympy.tanh: acb.tanh,
}


def enclose(expression: sympy.Expr, values: Mapping[str, Fraction]) -> acb:
    """A ball that holds the expression where its symbols have these values, by name.

    Doubles in the expression are the binary fractions they stand for.

    Raises
    ------
    InputError
        A symbol without a value, or a function that is none of exp, log and the circular and
        hyperbolic ones.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> enclose(sympy.sqrt(x) + sympy.pi, {"x": Fraction(2)}).real.str(12, radius=False)
    '4.55580621596'
    """
    if isinstance(expression, sympy.Symbol):
        if expression.name not in values:
            raise InputError(f"{expression.name} has no value; give at={{{expression.name}: …}}")
        return _of_fraction(values[expression.name])
    if isinstance(expression, sympy.Float):
        sign, mantissa, exponent, _ = expression._mpf_
        size = arb((fmpz(int(mantissa)), fmpz(int(exponent))))
        return acb(-size if sign else size)
    if isinstance(expression, sympy.Rational):
        return _of_fraction(Fraction(int(expression.p), int(expression.q)))
    constants = {sympy.pi: acb(arb.pi()), sympy.E: acb(1).exp(), sympy.I: acb(0, 1)}
    if expression in constants:
        return constants[expression]
    inside = [enclose(argument, values) for argument in expression.args]
    if isinstance(expression, sympy.Add):
        return sum(inside, acb(0))
    if isinstance(expression, sympy.Mul):
        product = acb(1)
        for factor in inside:
            product = product * factor
        return product
    if isinstance(expression, sympy.Pow):
        base, power = inside
        if expression.exp.is_Integer:
            return base ** int(expression.exp)
        return base.sqrt() if expression.exp == sympy.S.Half else base**power
    if expression.func in _FUNCTIONS:
        return _FUNCTIONS[expression.func](*inside)
    raise InputError(
        f"{expression} holds {expression.func.__name__}, whose values are not known here; use "
        "numbers, parameters, roots, exp, log, circular and hyperbolic functions"
    )


def _of_fraction(value: Fraction) -> acb:
    return acb(arb(fmpq(value.numerator, value.denominator)))
