r"""Two ways to write an element of the exact ring, each unique.

**Cotangents.** Every element is, in one way only,

.. math:: \sum_{a, q, m} Ω^a κ_q^m \, p_{a,q,m}(κ_1), \qquad \deg p_{a,q,m} < φ(q),

a partial fraction whose poles are those of the cotangents themselves: κ_q^m carries the pole of
order m at Ω = pπ/q, gcd(p, q) = 1, and the φ(q) coefficients of p its φ(q) residues (κ_q^m also
has poles at the divisors of q; they are taken off in turn, q descending). It is short — F₄ needs
six terms for its longest coefficient — and well conditioned in floating point where the expanded
polynomial in cot Ω loses all digits by order 14.

**Sines and cosines.** One fraction as the paper prints it: the numerator in cosines and sines of
multiples of Ω, the denominator a product of sin Ω, cos Ω, 1 + 2 cos 2Ω, cos 2Ω, …, one factor for
the resonances of each q.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from math import gcd, lcm

from flint import fmpq_poly, fmpz_poly

from asymptotics.cotangent import (
    CotangentElement,
    CotangentRing,
    Poles,
    cotangent_powers,
    resonance_polynomial,
)

CotangentTerms = dict[tuple[int, int, int, int], Fraction]
"""``{(a, q, m, i): r}`` for Σ r Ω^a κ_q^m κ₁^i; i = 0 when q = 1, and q = 1, m = 0 without κ."""


@cache
def _psi(q: int) -> fmpq_poly:
    return fmpq_poly(resonance_polynomial(q))


def _inverse(a: fmpq_poly, modulus: fmpq_poly) -> fmpq_poly:
    return (a % modulus).xgcd(modulus)[1] % modulus


@cache
def _split(q: int) -> tuple[fmpq_poly, fmpq_poly, fmpq_poly]:
    """(P_q, Q_q/Ψ_q, (Q_q/Ψ_q)/P_q mod Ψ_q)."""
    p, full = (fmpq_poly(x) for x in cotangent_powers(q))
    rest = full // _psi(q)
    return p, rest, rest * _inverse(p, _psi(q)) % _psi(q)


def _power_modulo(base: fmpq_poly, exponent: int, modulus: fmpq_poly) -> fmpq_poly:
    result = fmpq_poly([1])
    for _ in range(exponent):
        result = result * base % modulus
    return result


@lru_cache(maxsize=4096)
def _denominator(poles: Poles) -> fmpq_poly:
    product = fmpq_poly([1])
    for q, m in enumerate(poles, start=2):
        if m:
            product = product * _psi(q) ** m
    return product


def cotangent_terms(element: CotangentElement) -> CotangentTerms:
    """The cotangent form of an element.

    >>> k = CotangentRing().cot
    >>> cotangent_terms(k(2) * k(3))     # κ₂κ₃ = κ₁²/2 − 3/2 − κ₁κ₃
    ... # doctest: +NORMALIZE_WHITESPACE
    {(0, 3, 1, 1): Fraction(-1, 1), (0, 1, 0, 0): Fraction(-3, 2), (0, 1, 2, 0): Fraction(1, 2)}
    """
    element = element.canonical()
    terms: CotangentTerms = {}
    for a, row in element.rows().items():
        for (q, m, i), value in _row_terms(
            fmpq_poly(row) / element.denominator, element.poles
        ).items():
            terms[a, q, m, i] = value
    return terms


def _row_terms(numerator: fmpq_poly, poles: Poles) -> dict[tuple[int, int, int], Fraction]:
    """Partial fractions of numerator/∏Ψ_q^{m_q} in powers of the cotangents, q descending."""
    terms: dict[tuple[int, int, int], Fraction] = {}
    powers = list(poles)
    for q in range(len(powers) + 1, 1, -1):
        psi, (p, rest, ratio) = _psi(q), _split(q)
        while powers[q - 2]:
            m = powers[q - 2]
            others = _denominator((*powers[: q - 2],))
            leading = numerator * _inverse(others, psi) % psi * _power_modulo(ratio, m, psi) % psi
            for i in range(leading.degree() + 1):
                if leading[i]:
                    terms[q, m, i] = Fraction(int(leading[i].p), int(leading[i].q))
            # κ_q^m = P^m / (rest Ψ_q)^m brings poles of order m at the divisors of q.
            raised = [
                max(power, m) if q % d == 0 and d < q else power
                for d, power in enumerate(powers, start=2)
            ]
            common = _denominator((*raised,))
            numerator = numerator * (common // _denominator((*powers,))) - leading * p**m * (
                common // (rest * psi) ** m
            )
            powers = raised
            numerator = numerator // psi
            powers[q - 2] -= 1
            for d in (d for d in range(2, q + 1) if q % d == 0):
                while powers[d - 2]:
                    quotient, remainder = divmod(numerator, _psi(d))
                    if remainder:
                        break
                    numerator, powers[d - 2] = quotient, powers[d - 2] - 1
    for i in range(numerator.degree() + 1):
        if numerator[i]:
            terms[1, i, 0] = Fraction(int(numerator[i].p), int(numerator[i].q))
    return terms


def common_factor(forms: Iterable[CotangentTerms]) -> tuple[Fraction, int]:
    """(r, a) so that every term of every form is r Ω^a times integers and powers of Ω.

    >>> ring = CotangentRing()
    >>> half = ring.rational(3, 2) * ring.omega * ring.omega
    >>> common_factor([cotangent_terms(half), cotangent_terms(half * ring.cot(2))])
    (Fraction(3, 2), 2)
    """
    keys = [(a, r) for form in forms for (a, *_), r in form.items()]
    above = gcd(*(r.numerator for _, r in keys))
    below = lcm(*(r.denominator for _, r in keys))
    return Fraction(above, below), min(a for a, _ in keys)


def from_cotangent_terms(terms: CotangentTerms) -> CotangentElement:
    """The element with the given cotangent form: the inverse of :func:`cotangent_terms`."""
    ring = CotangentRing()
    products = []
    for (a, q, m, i), value in terms.items():
        product = ring.rational(value.numerator, value.denominator)
        for factor, power in ((ring.omega, a), (ring.cot(q), m), (ring.cot(1), i)):
            for _ in range(power):
                product = product * factor
        products.append(product)
    return ring.sum(products)


@dataclass(frozen=True)
class CircularForm:
    """content · Σ_a Ω^a Σ_k (cosines[a][k] cos kΩ + sines[a][k] sin kΩ) / (sin^f Ω ∏ T_q^{m_q}).

    The integers in the numerator are coprime. ``poles`` are the m_q, q ≥ 2; ``sine_power`` is f.
    T_q is the cosine polynomial :func:`resonance_cosines`.
    """

    content: Fraction
    cosines: dict[int, dict[int, int]]
    sines: dict[int, dict[int, int]]
    sine_power: int
    poles: Poles


def circular_form(element: CotangentElement) -> CircularForm:
    """The element as one fraction in sines and cosines.

    >>> form = circular_form(CotangentRing().cot(2))
    >>> form.content, form.cosines, form.sine_power, form.poles     # cos 2Ω/(2 sin Ω cos Ω)
    (Fraction(1, 2), {0: {2: 1}}, 1, (1,))
    """
    element = element.canonical()
    rows = element.rows()
    below = sum(
        power * resonance_polynomial(q).degree() for q, power in enumerate(element.poles, start=2)
    )
    degree = max([below, *(row.degree() for row in rows.values())])
    cosines: dict[int, dict[int, int]] = {}
    sines: dict[int, dict[int, int]] = {}
    for a, row in rows.items():
        real, imaginary = multiple_angles(row, degree)
        if real:
            cosines[a] = real
        if imaginary:
            sines[a] = imaginary
    content = gcd(*(v for part in (cosines, sines) for row in part.values() for v in row.values()))
    for part in (cosines, sines):
        for multiples in part.values():
            for k in multiples:
                multiples[k] //= content
    scale = Fraction(content, element.denominator * 2**degree)
    for q, power in enumerate(element.poles, start=2):
        scale /= _cosine_content(q) ** power
    return CircularForm(scale, cosines, sines, degree - below, element.poles)


def multiple_angles(row: fmpz_poly, degree: int) -> tuple[dict[int, int], dict[int, int]]:
    """2^D Σ a_i cos^i Ω sin^{D−i} Ω as cosines and sines of multiples of Ω, D = ``degree``.

    >>> multiple_angles(fmpz_poly([-1, 0, 1]), 2)     # 4 (cos² − sin²) = 4 cos 2Ω
    ({2: 4}, {})
    """
    # With y = e^{iΩ}: 2 cos Ω = (y² + 1)/y and 2 sin Ω = −i (y² − 1)/y. Collect by powers of −i.
    plus, minus = fmpz_poly([1, 0, 1]), fmpz_poly([-1, 0, 1])
    parts = [fmpz_poly([0]) for _ in range(4)]
    for i in range(row.degree() + 1):
        if row[i]:
            parts[(degree - i) % 4] += row[i] * plus**i * minus ** (degree - i)
    real, imaginary = parts[0] - parts[2], parts[3] - parts[1]
    cosines, sines = {}, {}
    for k in range(degree + 1):
        # (a + ib) y^k and its conjugate: 2a cos kΩ − 2b sin kΩ, half of it at k = 0.
        a, b = int(real[degree + k]), int(imaginary[degree + k])
        if a:
            cosines[k] = a if k == 0 else 2 * a
        if b:
            sines[k] = -2 * b
    return cosines, sines


@cache
def _resonance_cosines(q: int) -> tuple[Fraction, tuple[tuple[int, int], ...]]:
    psi = resonance_polynomial(q)
    cosines, _ = multiple_angles(psi, psi.degree())
    content = gcd(*cosines.values())
    return Fraction(content, 2 ** psi.degree()), tuple(
        (k, v // content) for k, v in sorted(cosines.items())
    )


def _cosine_content(q: int) -> Fraction:
    return _resonance_cosines(q)[0]


def resonance_cosines(q: int) -> tuple[tuple[int, int], ...]:
    """T_q as ``((k, a_k), …)``: Σ a_k cos kΩ, coprime integers, zero exactly at pπ/q.

    >>> resonance_cosines(2), resonance_cosines(3), resonance_cosines(6)
    (((1, 1),), ((0, 1), (2, 2)), ((0, -1), (2, 2)))
    """
    return _resonance_cosines(q)[1]
