"""The exact ring: a ring, canonical, and what it says is what numbers say."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpz
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from asymptotics.errors import InputError
from asymptotics.expansion.modular import ModularPoint
from asymptotics.formulas.normal_form import (
    circular_form,
    cotangent_terms,
    from_cotangent_terms,
    resonance_cosines,
)
from asymptotics.rings.cotangent import (
    MOST,
    CotangentElement,
    CotangentRing,
    check_element,
    resonance_polynomial,
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


@pytest.mark.parametrize("j", [0, -1, -7])
def test_cotangents_that_are_not_in_the_ring(j: int) -> None:
    """Reflected harmonics are understood, not stored: there is no κ for them."""
    with pytest.raises(InputError, match=rf"cot\({j}\*Omega\) is not in the ring"):
        RING.cot(j)


@pytest.mark.parametrize(
    ("terms", "denominator", "poles", "said"),
    [
        ({(0, 0): 1}, 0, (), "denominator 0"),
        ({(0, 0): 1}, -2, (), "denominator -2"),
        ({(0, 0): 1}, True, (), "denominator True"),
        ({(0, 0): 1}, 1.0, (), r"denominator 1\.0"),
        ({(0, 0): 1}, "1", (), "denominator '1'"),
        ({(0, 0): 0}, 1, (), "coefficient 0"),
        ({(0, 0): 0.5}, 1, (), r"coefficient 0\.5"),
        ({(0, 0): True}, 1, (), "coefficient True"),
        ({(-1, 0): 1}, 1, (), r"exponents \(-1, 0\)"),
        ({(0, MOST + 1): 1}, 1, (), r"exponents \(0, 100001\)"),
        ({(0.0, 0): 1}, 1, (), r"exponents \(0\.0, 0\)"),
        ({(False, 0): 1}, 1, (), r"exponents \(False, 0\)"),
        ({(0, 0): 1}, 1, (-1,), r"exponents \(-1,\) of the poles"),
        ({(0, 0): 1}, 1, (0, MOST + 1), "of the poles"),
        ({(0, 0): 1}, 1, (None,), r"exponents \(None,\)"),
        ({(0, 0): 1}, 1, (0,) * (MOST + 1), r"exponents \(0, 0, .*\.\.\. of the poles"),
    ],
)
def test_elements_that_are_none(terms: Any, denominator: Any, poles: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        RING.element(terms, denominator, poles)


def test_a_term_given_twice_is_no_element() -> None:
    check_element([(0, 1, 1), (1, 0, 1)], 1, ())
    with pytest.raises(InputError, match="each pair once"):
        check_element([(0, 1, 1), (0, 1, 1)], 1, ())


def test_elements_are_put_in_lowest_terms() -> None:
    """c (c² + 1)/(2 c²) over Ψ₂ = c."""
    element = RING.element({(0, 1): 2, (0, 3): 2}, 4, (2,))
    assert (element.denominator, element.poles) == (2, (1,))
    assert element == (RING.cot(1) + RING.element({(0, 0): 1}, 1, (1,))) * RING.rational(1, 2)
    assert RING.element({(MOST, 0): 1}, 1, ()).is_zero() is False


# -- modulo a prime --------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(elements(), elements())
def test_values_modulo_a_prime_respect_sums_and_products(
    a: CotangentElement, b: CotangentElement
) -> None:
    for point in (ModularPoint(), ModularPoint(10_007, omega=12, c=345)):
        prime, value_at = point.prime, point.value
        assert value_at(a * b) == value_at(a) * value_at(b) % prime
        assert value_at(a + b) == (value_at(a) + value_at(b)) % prime
        assert point.ring.sum([value_at(a), value_at(b)]) == value_at(a + b)
        assert point.ring.is_zero(value_at(a)) == a.is_zero() or point.prime == 10_007
        assert value_at(a.canonical()) == value_at(a)


@pytest.mark.parametrize("j", range(1, 13))
def test_cotangents_modulo_a_prime(j: int) -> None:
    """(c + i)^j by its own recurrence."""
    point = ModularPoint()
    real, imaginary = 1, 0
    for _ in range(j):
        real, imaginary = point.c * real - imaginary, real + point.c * imaginary
    assert point.value(RING.cot(j)) * imaginary % point.prime == real % point.prime
    assert point.value(RING.omega) == point.omega
    assert point.value(RING.rational(-3, 7)) * 7 % point.prime == point.prime - 3


def test_points_and_primes_are_drawn_anew() -> None:
    points = [ModularPoint() for _ in range(4)]
    assert len({point.prime for point in points}) == 4
    assert all(2**61 < point.prime < 2**62 and fmpz(point.prime).is_prime() for point in points)
    assert len({point.omega for point in points}) == len({point.c for point in points}) == 4
    with pytest.raises(ZeroDivisionError, match="denominator is zero at the point"):
        ModularPoint(7, omega=1, c=0).value(RING.cot(2))
    with pytest.raises(ZeroDivisionError, match="denominator is zero at the point"):
        ModularPoint(7, omega=1, c=1).value(RING.rational(1, 14))
