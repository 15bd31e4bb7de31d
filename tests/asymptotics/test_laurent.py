"""The Laurent ring: values against balls, identities, honest precision."""

from __future__ import annotations

import flint
import pytest
import sympy
from flint import arb, fmpq

from asymptotics.errors import InputError
from asymptotics.rings.laurent import LaurentElement, LaurentRing, TruncationError
from asymptotics.rings.precision import at_precision
from asymptotics.rings.resonance_field import C, ResonanceField, constant

RESONANCES = [(1, 1), (2, 1), (1, 2), (3, 2), (2, 3), (1, 4), (3, 4), (2, 5), (1, 6), (3, 8)]
MU = fmpq(1, 2**40)
BITS = 400


def value(ring: LaurentRing, element: LaurentElement) -> arb:
    """Σ a_k μ^k at MU."""
    with at_precision(BITS):
        return sum(
            (
                ring.field.value(a, BITS) * arb(MU) ** k
                for k, a in enumerate(element.coefficients, start=element.valuation)
            ),
            arb(0),
        )


@pytest.mark.parametrize(("p", "q"), RESONANCES)
def test_series_are_those_functions(p: int, q: int) -> None:
    """Ω, cot jΩ and sin^{−q} Ω at μ = 2⁻⁴⁰; what is left is the O-term."""
    ring = LaurentRing(p, q, terms=5)
    with at_precision(BITS):
        omega = arb.pi() * p / q + arb(MU)
        assert value(ring, ring.omega).overlaps(omega)
        cases = [(ring.cot(j), (j * omega).cot()) for j in range(1, 2 * q + 3)]
        cases.append((ring.cosecant_power, omega.sin() ** -q))
        for element, exact in cases:
            assert element.precision is not None
            # Next to a pole at the distance π/(jq), j ≤ 2q + 2, coefficient k is below (jq)^{k+1}.
            growth = q * (2 * q + 2)
            remainder = arb(MU) ** element.precision * growth ** (element.precision + 1)
            assert abs(value(ring, element) - exact) < remainder
            assert element.leading()[1] != 0


@pytest.mark.parametrize(("p", "q"), RESONANCES)
def test_addition_theorem(p: int, q: int) -> None:
    """κ_{a+b}(κ_a + κ_b) − κ_a κ_b + 1 = 0, up to the O-term, with known coefficients to cancel."""
    ring = LaurentRing(p, q, terms=6)
    for a in range(1, q + 2):
        for b in range(1, q + 2):
            left, right, both = ring.cot(a), ring.cot(b), ring.cot(a + b)
            terms = [
                both * left, both * right, ring.rational(-1) * left * right, ring.one,
            ]  # fmt: skip
            total = ring.sum(terms)
            assert not total.coefficients
            assert total.precision is not None
            assert total.precision >= 2


def test_minimal_polynomials_are_irreducible_and_of_the_right_degree() -> None:
    """cot(pπ/q) has degree φ(q), halved where 4 divides q; each p finds its own factor."""
    for q in range(2, 25):
        for p in range(1, q):
            if flint.fmpz(p).gcd(q) != 1:
                continue
            minimal = ResonanceField(p, q).minimal
            totient = int(sympy.totient(q))
            assert minimal.degree() == (totient // 2 if q % 4 == 0 else totient)
            assert len(minimal.factor()[1]) == 1
    assert str(ResonanceField(1, 4).minimal) == "x + (-1)"
    assert str(ResonanceField(3, 4).minimal) == "x + 1"


def test_zero_is_seen_through_the_algebraic_relation() -> None:
    """cot²(π/6) = 3; and O(μ) is not zero."""
    ring = LaurentRing(1, 6)
    assert ring.is_zero(LaurentElement(0, (C * C - 3,)))
    assert not ring.is_zero(LaurentElement(0, (C * C - 2,)))
    assert not ring.is_zero(LaurentElement(1, (), 1))
    assert ring.is_zero(ring.rational(0))
    assert ring.is_zero(ring.sum([ring.omega, ring.rational(-1) * ring.omega]))


def test_precision_is_carried() -> None:
    """(μ⁻¹ + 2 + O(μ)) (3μ + O(μ³)) = 3 + 6μ + O(μ²), and cancellation leaves the O-term."""
    ring = LaurentRing(1, 1, terms=4)
    left = LaurentElement(-1, (constant(1), constant(2)), 1)
    right = LaurentElement(1, (constant(3),), 3)
    product = ring.sum([left * right])
    assert (product.valuation, product.precision) == (0, 2)
    assert [product.coefficient(k) for k in (0, 1)] == [3, 6]
    # O(μ) times 3μ binds where the other factor is exact, from either side.
    whole = LaurentElement(1, (constant(3),))
    assert [ring.sum([x]).precision for x in (left * whole, whole * left)] == [2, 2]
    nothing = ring.sum([left, ring.rational(-1) * left])
    assert repr(nothing) == "O(mu^1)"
    with pytest.raises(TruncationError, match="leading coefficient is not determined"):
        nothing.leading()
    with pytest.raises(TruncationError, match=r"mu\^2 is not determined"):
        product.coefficient(2)
    assert product.coefficient(-5) == 0
    with pytest.raises(ValueError, match="no leading term"):
        ring.zero.leading()


def test_a_short_mantissa_is_the_truncation_of_a_long_one() -> None:
    for p, q in RESONANCES:
        short, long = LaurentRing(p, q, 2), LaurentRing(p, q, 6)
        for j in range(1, 2 * q + 1):
            a, b = short.cot(j), long.cot(j)
            assert a.precision == a.valuation + 2
            assert [a.coefficient(k) - b.coefficient(k) for k in range(-1, a.precision)] == [0] * (
                a.precision + 1
            )


def test_text_is_parsed_by_sympy() -> None:
    field = ResonanceField(2, 5)
    element = field.cot(3) * field.centre**2 - field.cot(1) * fmpq(3, 7) + 1
    number = sympy.N(sympy.sympify(field.text(element)), 30)
    with at_precision(128):
        assert abs(arb(str(number)) - field.value(element)) < arb(10) ** -28
    assert field.text(constant(0)) == "0"
    assert field.text(constant(-1)) == "-1"


@pytest.mark.parametrize(
    ("p", "q", "said"),
    [
        (2, 4, "not in lowest terms.*1/2"),
        (0, 1, "p = 0"),
        (1, -2, "q = -2"),
        (True, 1, "p = True"),
        (1, 2.0, "q = 2.0"),
    ],
)
def test_bad_resonances(p: int, q: int, said: str) -> None:
    with pytest.raises(InputError, match=said):
        LaurentRing(p, q)


def test_bad_terms() -> None:
    with pytest.raises(InputError, match="terms = 0"):
        LaurentRing(1, 1, 0)
