"""Closed forms: substituted back by SymPy itself, both styles equal, text and expressions equal."""

from __future__ import annotations

import pytest
import sympy
from sympy import cos, diff

from asymptotics import ClosedForms, Expansion, expand, float_string
from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import symbols
from asymptotics.formulas.zero_test import are_equal, is_identically_zero
from asymptotics.printing.text import contact_text, profile_text, shape_text

S = symbols()
OMEGA, EPSILON, POSITION, XI, TAU = (S[n] for n in ("Omega", "epsilon", "s", "xi", "tau"))


@pytest.fixture(scope="module")
def fourth(sixth: Expansion) -> ClosedForms:
    return ClosedForms(Expansion(sixth.problem, sixth.orders[:4]))


@pytest.mark.parametrize("n", range(1, 5))
def test_the_wave_equation_and_the_driven_end(fourth: ClosedForms, n: int) -> None:
    """w_ττ = w_ξξ for every order's expression, differentiated by SymPy; w(0) is the drive."""
    w = fourth.shape(n).expression
    assert is_identically_zero(diff(w, TAU, 2) - diff(w, XI, 2))
    drive = cos(OMEGA * TAU) if n == 1 else sympy.Integer(0)
    assert is_identically_zero(w.subs(XI, 0) - drive)
    assert w != 0


def test_the_static_shape(fourth: ClosedForms) -> None:
    w = fourth.shape(0).expression
    assert (diff(w, XI, 2), w.subs(XI, 0), w.subs(XI, 1), diff(w, XI).subs(XI, 1)) == (2, 1, 0, 0)


@pytest.mark.slow
@pytest.mark.parametrize("n", range(1, 4))
def test_contact_conditions_by_taylor(fourth: ClosedForms, n: int) -> None:
    """W(ξ_c) = W_ξ(ξ_c) = 0 through ε³, eq. (BC3) written out by SymPy."""
    delta = sum(EPSILON**k * fourth.contact(k).expression for k in range(1, n + 1))
    for e in (0, 1):
        total = sympy.Integer(0)
        for d in range(n + 1):
            for k in range(n + 1):
                slope = diff(fourth.shape(k).expression, XI, d + e).subs(XI, 1)
                total += delta**d / sympy.factorial(d) * EPSILON**k * slope
        coefficient = sympy.expand(total).coeff(EPSILON, n)
        assert is_identically_zero(coefficient)


def test_both_styles_are_the_same_functions(forms: ClosedForms, circular: ClosedForms) -> None:
    for j in range(5):
        assert are_equal(forms.profile(j).expression, circular.profile(j).expression)
    for n in range(1, 5):
        assert are_equal(forms.contact(n).expression, circular.contact(n).expression)
        assert are_equal(forms.shape(n).expression, circular.shape(n).expression)


@pytest.mark.slow
@pytest.mark.parametrize("which", ["forms", "circular"])
def test_text_is_the_expression(which: str, request: pytest.FixtureRequest) -> None:
    found: ClosedForms = request.getfixturevalue(which)
    for j in range(5):
        assert are_equal(sympy.sympify(profile_text(found, j)), found.profile(j).expression)
    for n in range(1, 5):
        for j in found.expansion.contact(n):
            assert are_equal(sympy.sympify(contact_text(found, n, j)), found.contact_harmonic(n, j))
        for j in found.expansion.shape(n):
            assert are_equal(sympy.sympify(shape_text(found, n, j)), found.shape_harmonic(n, j))


@pytest.mark.slow
def test_profile_is_the_shape_seen_from_the_contact_point(fourth: ClosedForms) -> None:
    """Σ ε̂^j F_j cos jΩτ at s against w at ξ_c + s: their difference falls like ε⁵."""
    values = {OMEGA: sympy.Rational(83, 100), TAU: sympy.Rational(7, 10)}
    differences = []
    for size in (sympy.Rational(1, 100), sympy.Rational(1, 200)):
        here = {**values, EPSILON: size}
        contact = 1 + sum(size**n * fourth.contact(n).expression.subs(here) for n in range(1, 5))
        place = {**here, XI: contact - sympy.Rational(2, 5)}
        shape = sum(size**n * fourth.shape(n).expression.subs(place) for n in range(5))
        small = size / sympy.sin(values[OMEGA])
        profile = sum(
            small**j
            * fourth.profile(j).expression.subs({**here, POSITION: -sympy.Rational(2, 5)})
            * cos(j * values[OMEGA] * values[TAU])
            for j in range(5)
        )
        differences.append(abs(sympy.N(shape - profile, 30)))
    assert sympy.log(differences[0] / differences[1], 2).n() == pytest.approx(5, abs=0.1)


def test_readable(forms: ClosedForms) -> None:
    """F₂ to leading order fits one line, as the issue of readability asks."""
    leading = profile_text(forms, 2).split(" + (epsilon")[0]
    assert len(leading) <= 100
    assert leading == (
        "Omega**2/8*(2*(1 - cos(Omega*s)) - (1 - cos(2*Omega*s))"
        " - cot(2*Omega)*(2*Omega*s - sin(2*Omega*s)))"
    )


def test_profile_says_how_far_it_holds(forms: ClosedForms) -> None:
    assert [forms.profile(j).order for j in range(7)] == [7, 5, 5, 3, 3, 1, 1]


def test_bad_arguments(forms: ClosedForms, sixth: Expansion) -> None:
    with pytest.raises(InputError, match="choose one of cotangent, circular"):
        ClosedForms(sixth, style="sine")
    with pytest.raises(InputError, match="exact ring"):
        ClosedForms(expand(float_string(0.8, 2), 2))
    for j in (-1, 7):
        with pytest.raises(InputError, match="give 0 ≤ j ≤ 6"):
            forms.profile(j)
