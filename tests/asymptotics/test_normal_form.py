"""Both ways to write an element of the exact ring: unique, complete, shared by its multiples."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations_with_replacement
from math import gcd

import mpmath
import pytest
from mpmath import mp, mpf

from asymptotics import ClosedForms, Expansion
from asymptotics.formulas import normal_form as module
from asymptotics.formulas.normal_form import (
    CircularForm,
    CotangentForm,
    circular_form,
    common_factor,
    cotangent_form,
    cotangent_terms,
    from_cotangent_terms,
    multiple_angles,
)
from asymptotics.rings.cotangent import CotangentElement, CotangentRing

RING = CotangentRing()


def totient(q: int) -> int:
    return sum(gcd(p, q) == 1 for p in range(1, q + 1))


def product(*factors: CotangentElement) -> CotangentElement:
    result = RING.one
    for factor in factors:
        result = result * factor
    return result


def check(element: CotangentElement) -> CotangentForm:
    """The form says what the element says, in the monomials that make it unique."""
    form = cotangent_form(element)
    assert from_cotangent_terms(cotangent_terms(element)) == element
    entries = [(a, m, v) for a, row in form.rows.items() for m, v in row.items()]
    assert entries == sorted(entries)
    assert entries[0][2] > 0
    assert gcd(*(v for *_, v in entries)) == 1
    for _, (q, m, i), v in entries:
        assert v
        assert i == 0 if q == 1 else (m > 0 and i < totient(q))
    return form


@pytest.mark.parametrize("q", range(2, 13))
def test_powers_of_a_cotangent_are_their_own_form(q: int) -> None:
    for m in (1, 2, 3, 4):
        for i in range(totient(q)):
            element = product(*[RING.cot(q)] * m, *[RING.cot(1)] * i)
            form = check(element)
            assert (form.content, form.rows) == (Fraction(1), {0: {(q, m, i): 1}})


@pytest.mark.parametrize("first", [1, 2, 3, 4, 6, 8, 9, 12])
def test_products_of_cotangents_that_share_poles(first: int) -> None:
    for others in combinations_with_replacement((1, 2, 3, 4, 6, 8, 9, 12), 2):
        check(product(*map(RING.cot, (first, *others))))


@pytest.mark.parametrize("q", range(2, 13))
def test_poles_at_one_resonance_only(q: int) -> None:
    """1/Ψ_q^m has none at the divisors of q, where every cotangent that is needed has."""
    for m in (1, 2, 3):
        for factor in (RING.one, RING.cot(1), RING.omega + RING.cot(1)):
            check(CotangentElement(factor.numerator, 1, (0,) * (q - 2) + (m,)))


def test_even_and_odd_parts_and_powers_of_omega_at_once() -> None:
    k, omega = RING.cot, RING.omega
    parts = [k(4) * k(6), k(2), omega * k(5) * k(10), omega * k(1), RING.rational(3, 7) * k(9)]
    form = check(RING.sum(parts))
    assert sorted(form.rows) == [0, 1]


def test_a_pole_that_is_not_there() -> None:
    """Poles too many in the denominator change nothing."""
    element = RING.cot(3)
    c = RING.cot(1)
    padded = CotangentElement(element.numerator * c.numerator, element.denominator, (1, 1))
    assert padded == element
    assert cotangent_form(padded) == cotangent_form(element)
    assert circular_form(padded) == circular_form(element)


def test_zero_has_no_terms() -> None:
    assert cotangent_terms(RING.zero) == {}
    assert cotangent_form(RING.zero) == CotangentForm(Fraction(0), {})


def amplitudes(expansion: Expansion) -> list[CotangentElement]:
    forms = ClosedForms(expansion)
    found = [
        forms.contact_amplitude(n, j)
        for n in range(1, forms.order + 1)
        for j in forms.expansion.contact(n)
    ]
    for n in range(1, forms.order + 1):
        for j in forms.expansion.shape(n):
            found += [amplitude for amplitude, _ in forms.shape_parts(n, j)]
        for j in range(n + 1):
            found += [term.amplitude for term in forms.profile_terms(j, n)]
    return [element for element in found if not element.is_zero()]


def test_shared_forms_are_those_computed_alone(sixth: Expansion) -> None:
    elements = amplitudes(sixth)
    together = [(cotangent_form(x), circular_form(x)) for x in elements]
    alone = []
    for element in elements:
        module._cotangent_form.cache_clear()
        module._circular_form.cache_clear()
        alone.append((cotangent_form(element), circular_form(element)))
    assert together == alone
    for element in elements[::7]:
        check(element)


def test_a_form_is_computed_once_for_all_multiples(sixth: Expansion) -> None:
    elements = amplitudes(sixth)
    module._cotangent_form.cache_clear()
    for element in elements:
        first = cotangent_form(element)
        for ratio in (Fraction(-1), Fraction(3, 4), Fraction(-8, 5)):
            other = cotangent_form(element * RING.rational(*ratio.as_integer_ratio()))
            assert other.rows is first.rows
            assert other.content == ratio * first.content
    info = module._cotangent_form.cache_info()
    assert info.misses == info.currsize < len(elements)


def test_keys_tell_elements_apart() -> None:
    """Same length, first and last coefficient, same poles: still two elements."""
    k, omega = RING.cot, RING.omega
    first = RING.sum([omega * omega, omega * k(1), RING.one])
    second = RING.sum([omega * omega, omega * k(1) * k(1), RING.one])
    keys = [module._primitive(x)[1] for x in (first, second)]
    assert hash(keys[0]) == hash(keys[1])
    assert keys[0] != module._Primitive(first.numerator, (1,))
    assert cotangent_form(first) != cotangent_form(second)


def number(form: CircularForm, omega: mpf) -> mpf:
    top = sum(
        omega**power * v * function(k * omega)
        for part, function in ((form.cosines, mpmath.cos), (form.sines, mpmath.sin))
        for power, row in part.items()
        for k, v in row.items()
    )
    bottom = mpmath.sin(omega) ** form.sine_power
    for q, m in enumerate(form.poles, start=2):
        bottom *= sum(v * mpmath.cos(k * omega) for k, v in module.resonance_cosines(q)) ** m
    return mpf(form.content.numerator) / form.content.denominator * top / bottom


def test_circular_forms_of_multiples_have_a_positive_content() -> None:
    element = RING.sum([RING.cot(4) * RING.omega, RING.cot(3)])
    with mp.workdps(40):
        omega = mpf("0.8137")
        for ratio in (Fraction(1), Fraction(-2, 3)):
            form = circular_form(element * RING.rational(*ratio.as_integer_ratio()))
            wanted = omega * mpmath.cot(4 * omega) + mpmath.cot(3 * omega)
            wanted *= mpf(ratio.numerator) / ratio.denominator
            assert abs(number(form, omega) - wanted) < mpf(10) ** -35
            assert form.content > 0


@pytest.mark.parametrize("degree", range(7))
def test_multiple_angles(degree: int) -> None:
    from flint import fmpz_poly

    row = fmpz_poly([3, -1, 4, 1, -5, 9, -2][: degree + 1])
    with mp.workdps(30):
        omega = mpf("0.71")
        cosines, sines = multiple_angles(row, degree)
        found = sum(v * mpmath.cos(k * omega) for k, v in cosines.items())
        found += sum(v * mpmath.sin(k * omega) for k, v in sines.items())
        wanted = sum(
            int(row[i]) * mpmath.cos(omega) ** i * mpmath.sin(omega) ** (degree - i)
            for i in range(degree + 1)
        )
        assert abs(found - 2**degree * wanted) < mpf(10) ** -25


def test_common_factor() -> None:
    k, omega = RING.cot, RING.omega
    first = cotangent_form(RING.rational(3, 4) * omega * omega * k(2))
    second = cotangent_form(RING.rational(-9, 10) * omega * k(3))
    assert common_factor([first, second]) == (Fraction(3, 20), 1)
