"""Every printed formula is what the engine derives, and the comparison can tell when it is not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest
import sympy
from sympy import Rational, cos, cot, sin

from asymptotics import ClosedForms, exact_string, expand
from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import symbols
from asymptotics.formulas.zero_test import are_equal, are_equal_through
from asymptotics.paper.check import PaperCheck, compare
from asymptotics.paper.printed import PAPER, PaperFormula, printed

NAMES = symbols()
W, E, S, TAU = (NAMES[name] for name in ("Omega", "epsilon", "s", "tau"))


@pytest.fixture(scope="module")
def forms() -> ClosedForms:
    return ClosedForms(expand(exact_string(), order=4))


def test_every_printed_formula_equals_the_derived_one(forms):
    comparisons = compare(forms)
    assert [c.name for c in comparisons] == list(PAPER)
    assert [c for c in comparisons if not c.equal] == []
    assert all(c.through is None for c in comparisons)
    assert str(comparisons[-1]) == "F_3 (eq. F3): equal, identically in Omega and s"


@pytest.mark.parametrize("order", [1, 2, 3, 6])
def test_any_order_compares_what_it_has(order):
    comparisons = {c.name: c for c in compare(ClosedForms(expand(exact_string(), order=order)))}
    assert [f"F_{j}" in comparisons for j in range(4)] == [j <= order for j in range(4)]
    assert all(c.equal for c in comparisons.values())
    assert comparisons["F_1"].through == (1 if order < 3 else None)
    if order < 3:
        expected = "F_1 (eq. expandw): equal through epsilon^1, identically in Omega and s"
        assert str(comparisons["F_1"]) == expected


def test_circular_style_compares_as_well():
    forms = ClosedForms(expand(exact_string(), order=3), style="circular")
    assert all(c.equal for c in compare(forms))


def sign_slips(expression: sympy.Basic) -> Iterator[sympy.Basic]:
    """The expression with the sign of one term of one sum flipped, for every term of every sum."""
    for i, part in enumerate(expression.args):
        others = expression.args
        if isinstance(expression, sympy.Add):
            yield expression - 2 * part
        for slip in sign_slips(part):
            yield expression.func(*others[:i], slip, *others[i + 1 :])


def number_slips(expression: sympy.Basic) -> Iterator[sympy.Basic]:
    """The expression with one of its numbers raised by one, for every number."""
    for i, part in enumerate(expression.args):
        others = expression.args
        slips = [part + 1] if part.is_Rational else number_slips(part)
        for slip in slips:
            yield expression.func(*others[:i], slip, *others[i + 1 :])


@pytest.mark.parametrize("name", ["w_0", "x_1", "F_0", "F_1", "F_2", "F_3"])
def test_any_single_slip_shows(forms, name):
    formula = PAPER[name]
    expression = formula.expression
    candidates = [*sign_slips(expression), *number_slips(expression), 2 * expression, -expression]
    # −(x − x₀)² is the same square; such a slip is none.
    slips = [slip for slip in candidates if sympy.expand(slip - expression) != 0]
    assert len(slips) >= (20 if name in ("F_1", "F_2", "F_3") else 3)
    for slip in slips:
        (comparison,) = compare(forms, [replace(formula, expression=slip)])
        assert not comparison.equal, slip


def test_a_slip_beyond_the_printed_power_is_not_held_against_it(forms):
    slip = replace(PAPER["F_2"], expression=PAPER["F_2"].expression + E**2 * sin(W * S))
    assert compare(forms, [slip])[0].equal
    slip = replace(PAPER["F_1"], expression=PAPER["F_1"].expression + E**3 * sin(W * S))
    assert not compare(forms, [slip])[0].equal


def test_slips_in_the_equations_show(forms):
    linear, general = PAPER["linear"], PAPER["x_1(t)"]
    left, right = linear.expression.args
    g, x_0, z, rho = sympy.symbols("g x_0 Z_0 rho")
    first, second = PAPER["x_0^2"].expression.args
    slips = [
        replace(linear, expression=sympy.Eq(left, -right)),
        replace(linear, expression=sympy.Eq(left, right.subs(x_0, 2 * x_0))),
        replace(linear, expression=sympy.Eq(left, right / 2)),
        replace(general, expression=general.expression * 2),
        replace(general, expression=general.expression.subs(x_0, g)),
        replace(PAPER["f_p"], expression=PAPER["f_p"].expression.subs(g, 2 * g)),
        replace(PAPER["f_p"], expression=PAPER["f_p"].expression.subs(z, 2 * z)),
        replace(PAPER["x_0^2"], expression=sympy.Tuple(first * 2, second)),
        replace(PAPER["x_0^2"], expression=sympy.Tuple(first, second * rho)),
    ]  # fmt: skip
    for slip in slips:
        (comparison,) = compare(forms, [slip])
        assert not comparison.equal, slip


def test_a_difference_reads_as_one(forms):
    slip = replace(PAPER["F_3"], expression=-PAPER["F_3"].expression)
    assert str(compare(forms, [slip])[0]) == (
        "F_3 (eq. F3): DIFFERENT, compared identically in Omega and s"
    )
    assert str(PaperCheck("F_1", "expandw", False, "s", 1)) == (
        "F_1 (eq. expandw): DIFFERENT through epsilon^1, compared identically in s"
    )


def test_worked_values_of_the_design(forms):
    """First terms derived by hand: ξ₁, ξ₂ and F₂'s leading part."""
    small, theta = 1 / sin(W), W * TAU
    assert are_equal(forms.contact(1).expression, W / 2 * cos(theta) * small)
    assert are_equal(
        forms.contact(2).expression,
        (-(W**2) / 16 - W**3 / 8 * cot(2 * W) * cos(2 * theta)) * small**2,
    )
    second = (
        W**2 / 8 * (1 - 2 * cos(W * S) + cos(2 * W * S) + cot(2 * W) * (sin(2 * W * S) - 2 * W * S))
    )
    assert are_equal_through(forms.profile(2).expression, second, E, 1)
    assert are_equal(PAPER["F_2"].expression, second)
    assert not are_equal_through(forms.profile(2).expression, second, E, 2)


def test_profiles_touch_the_ground_doubly_as_printed():
    """W = W_s = 0 at s = 0, for the printed formulas themselves."""
    for name in ("F_0", "F_1", "F_2", "F_3"):
        expression = PAPER[name].expression
        assert are_equal(expression.subs(S, 0), 0), name
        assert are_equal(sympy.diff(expression, S).subs(S, 0), 0), name


def test_printed_finds_by_name_and_by_label():
    assert printed("F3") == printed("F_3") == (PAPER["F_3"],)
    assert [f.name for f in printed("expandw")] == ["F_0", "F_1", "F_2"]
    assert {f.label for f in PAPER.values()} == {
        "leading", "linear", "linresponse1", "linresponse2", "resonance1", "expandw", "F3",
    }  # fmt: skip
    assert printed("w_0")[0].expression.subs({"x": 0, "x_0": 2, "g": 3, "c": 1}) == 6
    frequency = printed("resonance1")[0].expression.subs({"p": 1, "Z_0": Rational(81, 100)})
    assert float(frequency.subs("g", Rational(981, 100))) == pytest.approx(1.23, abs=0.005)


@pytest.mark.parametrize("name", ["F_4", "", "expandw2", "Leading"])
def test_printed_refuses(name):
    with pytest.raises(InputError, match=r"names are w_0, .* labels leading"):
        printed(name)


def test_compare_refuses(forms):
    with pytest.raises(InputError, match="compare needs ClosedForms, not Expansion"):
        compare(forms.expansion)
    with pytest.raises(InputError, match="'F_9' is not a formula of the paper"):
        compare(forms, [PaperFormula("F_9", "F9", S, 0, "")])


def test_the_registry_cannot_be_changed():
    with pytest.raises(TypeError):
        PAPER["F_3"] = PAPER["F_2"]  # type: ignore[index]
