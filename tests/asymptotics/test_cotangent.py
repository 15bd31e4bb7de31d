"""The exact ring: a ring, canonical, and what it says is what numbers say."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from asymptotics.cotangent import CotangentElement, CotangentRing, resonance_polynomial
from asymptotics.normal_form import (
    circular_form,
    cotangent_terms,
    from_cotangent_terms,
    resonance_cosines,
)

RING = CotangentRing()
OMEGA = mpf("0.8137")


@st.composite
def elements(draw: st.DrawFn) -> CotangentElement:
    """Random polynomials in Ω and κ₁ … κ₆."""
    terms = []
    for _ in range(draw(st.integers(1, 4))):
        term = RING.rational(draw(st.integers(-9, 9)), draw(st.integers(1, 9)))
        for _ in range(draw(st.integers(0, 3))):
            j = draw(st.integers(0, 6))
            term = term * (RING.cot(j) if j else RING.omega)
        terms.append(term)
    return RING.sum(terms)


def value(element: CotangentElement) -> mpf:
    c = mpmath.cot(OMEGA)
    numerator = sum(
        int(v) * OMEGA ** int(a) * c ** int(i) for (a, i), v in element.numerator.terms()
    )
    below = mpf(element.denominator)
    for q, m in enumerate(element.poles, start=2):
        poly = resonance_polynomial(q)
        below *= sum(int(poly[i]) * c**i for i in range(poly.degree() + 1)) ** m
    return numerator / below


def close(a: mpf, b: mpf) -> bool:
    return abs(a - b) <= mpf(10) ** -35 * (1 + abs(a) + abs(b))


@settings(max_examples=60, deadline=None)
@given(elements(), elements(), elements())
def test_arithmetic_is_that_of_numbers_and_of_a_ring(
    a: CotangentElement, b: CotangentElement, c: CotangentElement
) -> None:
    with mp.workdps(50):
        assert close(value(a * b), value(a) * value(b))
        assert close(value(RING.sum([a, b, c])), value(a) + value(b) + value(c))
    assert (a + b) * c == a * c + b * c
    assert RING.is_zero(a - a)


@settings(max_examples=60, deadline=None)
@given(elements(), elements())
def test_equal_elements_look_equal(a: CotangentElement, b: CotangentElement) -> None:
    there_and_back = (a + b) - b
    assert repr(there_and_back) == repr(a.canonical())
    assert hash(there_and_back) == hash(a)


@settings(max_examples=60, deadline=None)
@given(elements())
def test_both_normal_forms_keep_the_element(a: CotangentElement) -> None:
    assert from_cotangent_terms(cotangent_terms(a)) == a
    if a.is_zero():
        return
    form = circular_form(a)
    with mp.workdps(50):
        top = sum(
            OMEGA**power * v * function(k * OMEGA)
            for part, function in ((form.cosines, mpmath.cos), (form.sines, mpmath.sin))
            for power, row in part.items()
            for k, v in row.items()
        )
        bottom = mpmath.sin(OMEGA) ** form.sine_power
        for q, m in enumerate(form.poles, start=2):
            bottom *= sum(v * mpmath.cos(k * OMEGA) for k, v in resonance_cosines(q)) ** m
        scale = mpf(form.content.numerator) / form.content.denominator
        assert close(scale * top / bottom, value(a))


@pytest.mark.parametrize("a", range(1, 7))
@pytest.mark.parametrize("b", range(1, 7))
def test_addition_theorem(a: int, b: int) -> None:
    k = RING.cot
    assert RING.is_zero(k(a + b) * (k(a) + k(b)) - k(a) * k(b) + RING.one)


def test_addition_theorem_can_fail() -> None:
    k = RING.cot
    assert not RING.is_zero(k(5) * (k(2) + k(3)) - k(2) * k(3) - RING.one)


@pytest.mark.parametrize("q", range(2, 13))
def test_resonance_polynomials_vanish_at_their_resonances_only(q: int) -> None:
    poly = resonance_polynomial(q)
    for p in range(1, q):
        c = mpmath.cot(p * mpmath.pi / q)
        size = abs(sum(int(poly[i]) * c**i for i in range(poly.degree() + 1)))
        assert (size < 1e-9) == (Fraction(p, q).denominator == q)


def test_products_of_cotangents_become_sums() -> None:
    # κ₂κ₃ = κ₁²/2 − 3/2 − κ₁κ₃: two spellings of one element, one form.
    k = RING.cot
    assert cotangent_terms(k(2) * k(3)) == {
        (0, 3, 1, 1): Fraction(-1),
        (0, 1, 0, 0): Fraction(-3, 2),
        (0, 1, 2, 0): Fraction(1, 2),
    }
    assert repr(k(2) * k(3) * RING.one + RING.zero) == repr(
        k(3) * k(1) * RING.rational(-1) + k(1) * k(1) * RING.rational(1, 2) - RING.rational(3, 2)
    )


def test_division_by_omega_is_exact_or_refused() -> None:
    assert (RING.omega * RING.cot(3)).divided_by_omega() == RING.cot(3)
    with pytest.raises(ArithmeticError, match="Ω does not divide"):
        (RING.omega + RING.one).divided_by_omega()
