"""The exact zero test: identities, near-identities, and what it refuses."""

from __future__ import annotations

import random

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import I, Rational, cos, cot, csc, exp, sec, sin, sinc, tan

from asymptotics import ClosedForms, exact_string, expand
from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import symbols
from asymptotics.formulas.zero_test import (
    angle_of,
    are_equal,
    are_equal_through,
    is_identically_zero,
)

NAMES = symbols()
W, E, S, XI, TAU = (NAMES[name] for name in ("Omega", "epsilon", "s", "xi", "tau"))

IDENTITIES = {
    "Pythagoras": sin(W) ** 2 + cos(W) ** 2 - 1,
    "cotangents": cot(5 * W) * (cot(2 * W) + cot(3 * W)) - cot(2 * W) * cot(3 * W) + 1,
    "two angles": sin(2 * W + W * S) - sin(2 * W) * cos(W * S) - cos(2 * W) * sin(W * S),
    "shifted": cos(2 * W * (XI - 1)) - cos(2 * W * XI) * cos(2 * W) - sin(2 * W * XI) * sin(2 * W),
    "time": cos(W * TAU) ** 3 - (3 * cos(W * TAU) + cos(3 * W * TAU)) / 4,
    "all functions": sec(W) * csc(W) - tan(W) - cot(W),
    "half angles": tan(W / 2) - (1 - cos(W)) / sin(W),
    "fractions of angles": sin(W * S / 2) ** 2 - (1 - cos(W * S)) / 2,
    "exponentials": exp(I * W * S) - cos(W * S) - I * sin(W * S),
    "sinc": sinc(2 * W) - sin(W) * cos(W) / W,
    "no parity": (W + sin(S)) / (W + cos(S)) - 1 - (sin(S) - cos(S)) / (W + cos(S)),
    "mixed denominators": 1 / (W + I) - (W - I) / (W**2 + 1),
    "cosine polynomial": (1 + 2 * cos(2 * W)) * sin(W) - sin(3 * W),
    "symbols only": (W**2 - S**2) / (W - S) - W - S,
    "dimensional": sinc(W * S / XI) * W * S - XI * sin(W * S / XI),
    "numbers": sympy.Integer(0),
}

# One coefficient, sign, multiple or power away from an identity.
SLIPS = {
    "sign": sin(2 * W + W * S) - sin(2 * W) * cos(W * S) + cos(2 * W) * sin(W * S),
    "multiple": (1 + 2 * cos(2 * W)) * sin(W) - sin(4 * W),
    "coefficient": cos(W * TAU) ** 3 - (3 * cos(W * TAU) + 2 * cos(3 * W * TAU)) / 4,
    "power": W * sin(W) - W**2 * sin(W),
    "pole only": cot(W) - cot(W + 2 * W * S),
    "tiny": Rational(1, 10**60) * sin(W * S),
    "imaginary": exp(I * W) - cos(W),
    "number": sympy.Integer(3),
}


@pytest.mark.parametrize("name", IDENTITIES)
def test_identities_vanish(name):
    assert is_identically_zero(IDENTITIES[name])


@pytest.mark.parametrize("name", SLIPS)
def test_slips_do_not(name):
    assert not is_identically_zero(SLIPS[name])


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 4, 6])
def test_the_two_styles_of_closed_forms_are_the_same_functions(order):
    solution = expand(exact_string(), order=order)
    one, two = ClosedForms(solution), ClosedForms(solution, style="circular")
    pairs = [(one.profile(j), two.profile(j)) for j in range(order + 1)]
    pairs += [(one.shape(n), two.shape(n)) for n in range(order + 1)]
    pairs += [(one.contact(n), two.contact(n)) for n in range(1, order + 1)]
    for a, b in pairs:
        assert are_equal(a.expression, b.expression), a.name
        assert not are_equal(a.expression, b.expression + W * cot(W) * sin(W * S)), a.name


def expressions() -> st.SearchStrategy[sympy.Expr]:
    leaves = st.sampled_from(
        [W, S, E, sympy.Integer(2), Rational(-3, 5), I]
        + [f(a) for f in (sin, cos, tan, cot, sec, csc) for a in (W, 2 * W, W + W * S, W / 2)]
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.builds(lambda a, b: a + b, inner, inner),
            st.builds(lambda a, b: a * b, inner, inner),
            st.builds(lambda a: a**2, inner),
            st.builds(lambda a: 1 / (a + E), inner),
        ),
        max_leaves=7,
    )


@pytest.mark.slow
@settings(max_examples=80, deadline=None, derandomize=True)
@given(expressions())
def test_against_evaluation_with_fifty_digits(expression):
    """A value away from zero refutes an identity; rewriting does not change the function."""
    if expression.has(sympy.zoo, sympy.nan):
        return
    point = {W: Rational(7, 5), S: Rational(-11, 13), E: Rational(2, 17)}
    vanishes = is_identically_zero(expression)
    value = expression.subs(point).evalf(50)
    assert vanishes == (abs(value) < 1e-30)
    functions = (sin, cos, tan, cot, sec, csc)
    rewritten = expression.replace(
        lambda part: isinstance(part, functions), lambda part: part.rewrite(exp)
    )
    assert are_equal(expression, rewritten)


def test_random_linear_combinations_of_independent_functions_vanish_only_trivially():
    generator = random.Random(5)
    basis = [W**a * f(k * W) * g for a in (0, 1) for f in (sin, cos) for k in (1, 2)
             for g in (1, cos(W * S), sin(W * S))]  # fmt: skip
    for _ in range(20):
        coefficients = [generator.randint(-2, 2) for _ in basis]
        total = sum(a * b for a, b in zip(coefficients, basis, strict=True))
        assert is_identically_zero(total) == (not any(coefficients))


def test_truncation_is_exact_in_the_power():
    series = sum((E * cot(W)) ** n for n in range(6))
    closed = 1 / (1 - E * cot(W))
    assert all(are_equal_through(series, closed, E, n) for n in range(6))
    assert not are_equal_through(series, closed, E, 6)
    assert not are_equal_through(series + sin(W) * E**3, closed, E, 3)
    assert are_equal_through(series + sin(W) * E**3, closed, E, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1 / E, 0, E, 1), "pole at epsilon = 0"),
        ((sin(E), 0, E, 1), "not a symbol outside"),
        ((E, 0, E + 1, 1), "not a symbol outside"),
        ((E, 0, E, -1), "whole number"),
        ((E, 0, E, 1.0), "whole number"),
        ((E, 0, E, True), "whole number"),
    ],
)
def test_truncation_refuses(arguments, message):
    with pytest.raises(InputError, match=message):
        are_equal_through(*arguments)


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (0.5 * sin(W), "is a float, not an exact number; use Rational"),
        (sin(sympy.Float(2) * W), "use Rational"),
        (0.25, "use Rational"),
        (sympy.sqrt(W) * S, r"sqrt\(Omega\); powers must be whole numbers"),
        (W**S, r"Omega\*\*s; powers must be whole numbers"),
        (sympy.besselj(0, W), r"besselj\(0, Omega\); allowed are sin"),
        (sympy.Function("f")(W), r"f\(Omega\); allowed are sin"),
        (sympy.sinh(W), r"sinh\(Omega\)"),
        (sympy.log(W), r"log\(Omega\)"),
        (exp(W), r"angle of exp\(Omega\)"),
        (sin(W + 1), r"angle of sin\(Omega \+ 1\)"),
        (sin(sin(W)), r"angle of sin\(sin\(Omega\)\)"),
        (sin(sympy.sqrt(2) * W), "angle of sin"),
        (sin(1 / (W + S)), "angle of sin"),
        (sin(sympy.Integer(1)), "angle of sin"),
        (sin(I * W + W), "angle of sin"),
        (sympy.pi * W, "the number pi"),
        (sympy.oo, "the number oo"),
        (sympy.nan, "the number nan"),
        (sympy.zoo, "the number zoo"),
        (S / (sin(W) ** 2 + cos(W) ** 2 - 1), "denominator .* vanishes identically"),
        ((tan(W) * cot(W) - 1) ** -2, "vanishes identically"),
        (W + sympy.Symbol("Omega", positive=True), "two different symbols are called Omega"),
        ("sin(Omega)", "is not an expression"),
        (True, "is not an expression"),
        (None, "not a commutative SymPy expression"),
        ([W], "not a commutative SymPy expression"),
        (sympy.Eq(W, S), "not a commutative SymPy expression"),
        (sympy.Symbol("A", commutative=False), "not a commutative SymPy expression"),
    ],
)
def test_refuses(expression, message):
    with pytest.raises(InputError, match=message):
        is_identically_zero(expression)


def test_a_numerator_of_zero_does_not_hide_a_vanishing_denominator():
    with pytest.raises(InputError, match="vanishes identically"):
        are_equal(0, (S - S * sec(W) * cos(W)) ** -1)


def test_angles():
    assert angle_of(cos(2 * W * (XI - 1))) == {W: -2, W * XI: 2}
    assert angle_of(exp(-I * W * TAU)) == {W * TAU: -1}
    assert angle_of(sin(W * S / XI)) == {W * S / XI: 1}


def test_an_angle_that_is_zero_unseen() -> None:
    hidden = sympy.cot(sympy.Add(W, -W, evaluate=False), evaluate=False)
    with pytest.raises(InputError, match="infinite identically"):
        is_identically_zero(hidden)
