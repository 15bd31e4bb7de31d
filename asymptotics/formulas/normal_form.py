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

from flint import fmpz_mpoly, fmpz_poly

from asymptotics.formulas.partial_fractions import Monomial, partial_fractions
from asymptotics.rings.cotangent import CotangentElement, CotangentRing, Poles, resonance_polynomial

Rows = dict[int, dict[Monomial, int]]
"""``{a: {(q, m, i): v}}`` for Σ v Ω^a κ_q^m κ₁^i, in ascending order of all four."""

CotangentTerms = dict[tuple[int, int, int, int], Fraction]
"""``{(a, q, m, i): r}`` for Σ r Ω^a κ_q^m κ₁^i; i = 0 when q = 1, and q = 1, m = 0 without κ."""


@dataclass(frozen=True, slots=True)
class CotangentForm:
    """content · Σ v Ω^a κ_q^m κ₁^i, the integers v coprime, the first of them positive.

    Elements that differ by a rational factor share their ``rows``: read them, do not change them.
    """

    content: Fraction
    rows: Rows

    @property
    def lowest(self) -> int:
        """The lowest power of Ω."""
        return next(iter(self.rows))


class _Primitive:
    """The numerator and poles of an element without its rational factor, as a key."""

    __slots__ = ("mark", "numerator", "poles")

    def __init__(self, numerator: fmpz_mpoly, poles: Poles) -> None:
        self.numerator, self.poles = numerator, poles
        first, last = (int(numerator.coefficient(i)) for i in (0, len(numerator) - 1))
        self.mark = hash((len(numerator), first, last, poles))

    def __hash__(self) -> int:
        return self.mark

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, _Primitive)
            and self.poles == other.poles
            and bool(self.numerator == other.numerator)
        )

    def element(self) -> CotangentElement:
        """The element that stands for all its multiples."""
        return CotangentElement(self.numerator, 1, self.poles)


def _primitive(element: CotangentElement) -> tuple[Fraction, _Primitive]:
    """(r, key): the element, not 0, is r times the key's."""
    content, numerator = element.numerator.primitive()
    if numerator.leading_coefficient() < 0:
        content, numerator = -content, -numerator
    return Fraction(int(content), element.denominator), _Primitive(numerator, element.poles)


def cotangent_form(element: CotangentElement) -> CotangentForm:
    """The cotangent form of an element in integers; computed once for all its rational multiples.

    >>> k = CotangentRing().cot
    >>> cotangent_form(k(2) * k(3))     # κ₂κ₃ = −(3 − κ₁² + 2κ₁κ₃)/2
    CotangentForm(content=Fraction(-1, 2), rows={0: {(1, 0, 0): 3, (1, 2, 0): -1, (3, 1, 1): 2}})
    """
    if element.is_zero():
        return CotangentForm(Fraction(0), {})
    ratio, key = _primitive(element)
    form = _cotangent_form(key)
    return CotangentForm(ratio * form.content, form.rows)


@lru_cache(maxsize=4096)
def _cotangent_form(key: _Primitive) -> CotangentForm:
    pieces = [
        (a, piece)
        for a, row in key.element().rows().items()
        for piece in partial_fractions(row, key.poles)
    ]
    below = lcm(*(denominator for _, (*_, denominator) in pieces))
    above = gcd(*(below // denominator * gcd(*values) for _, (_, values, denominator) in pieces))
    found: dict[int, list[tuple[Monomial, int]]] = {}
    for a, (monomials, values, denominator) in pieces:
        factor = below // denominator
        found.setdefault(a, []).extend(
            (monomial, value * factor // above)
            for monomial, value in zip(monomials, values, strict=True)
            if value
        )
    rows = {a: dict(sorted(row)) for a, row in found.items()}
    if next(iter(rows[min(rows)].values())) < 0:
        above = -above
        rows = {a: {monomial: -v for monomial, v in row.items()} for a, row in rows.items()}
    return CotangentForm(Fraction(above, below), rows)


def cotangent_terms(element: CotangentElement) -> CotangentTerms:
    """The cotangent form of an element, term by term.

    >>> k = CotangentRing().cot
    >>> cotangent_terms(k(2) * k(3))     # κ₂κ₃ = κ₁²/2 − 3/2 − κ₁κ₃
    ... # doctest: +NORMALIZE_WHITESPACE
    {(0, 1, 0, 0): Fraction(-3, 2), (0, 1, 2, 0): Fraction(1, 2), (0, 3, 1, 1): Fraction(-1, 1)}
    """
    form = cotangent_form(element)
    return {
        (a, *monomial): form.content * v
        for a, row in form.rows.items()
        for monomial, v in row.items()
    }


def common_factor(forms: Iterable[CotangentForm]) -> tuple[Fraction, int]:
    """(r, a) so that every term of every form, none of them 0, is r Ω^a times integers and powers.

    >>> ring = CotangentRing()
    >>> half = ring.rational(3, 2) * ring.omega * ring.omega
    >>> common_factor([cotangent_form(half), cotangent_form(half * ring.cot(2))])
    (Fraction(3, 2), 2)
    """
    known = list(forms)
    return common_content(form.content for form in known), min(form.lowest for form in known)


def common_content(values: Iterable[Fraction]) -> Fraction:
    """The largest positive rational of which all values are integer multiples.

    >>> common_content([Fraction(3, 2), Fraction(-9, 4)])
    Fraction(3, 4)
    """
    known = list(values)
    return Fraction(gcd(*(v.numerator for v in known)), lcm(*(v.denominator for v in known)))


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
    ratio, key = _primitive(element)
    form = _circular_form(key)
    cosines, sines = form.cosines, form.sines
    if ratio < 0:
        cosines, sines = _negated(cosines), _negated(sines)
    return CircularForm(abs(ratio) * form.content, cosines, sines, form.sine_power, form.poles)


def _negated(part: dict[int, dict[int, int]]) -> dict[int, dict[int, int]]:
    return {a: {k: -v for k, v in row.items()} for a, row in part.items()}


@lru_cache(maxsize=4096)
def _circular_form(key: _Primitive) -> CircularForm:
    element = key.element().canonical()
    rows = element.rows()
    below = sum(
        power * resonance_polynomial(q).degree() for q, power in enumerate(element.poles, start=2)
    )
    degree = max([below, *(row.degree() for row in rows.values())])
    angles = {a: multiple_angles(row, degree) for a, row in rows.items()}
    content = gcd(*(v for parts in angles.values() for part in parts for v in part.values()))
    cosines, sines = (
        {
            a: {k: v // content for k, v in parts[i].items()}
            for a, parts in angles.items()
            if parts[i]
        }
        for i in (0, 1)
    )
    scale = Fraction(content, element.denominator * 2**degree)
    for q, power in enumerate(element.poles, start=2):
        scale /= _cosine_content(q) ** power
    return CircularForm(scale, cosines, sines, degree - below, element.poles)


def multiple_angles(row: fmpz_poly, degree: int) -> tuple[dict[int, int], dict[int, int]]:
    """2^D Σ a_i cos^i Ω sin^{D−i} Ω as cosines and sines of multiples of Ω, D = ``degree``.

    >>> multiple_angles(fmpz_poly([-1, 0, 1]), 2)     # 4 (cos² − sin²) = 4 cos 2Ω
    ({2: 4}, {})
    """
    # With z = e^{2iΩ}: 2 cos Ω = (z + 1)/√z and 2 sin Ω = −i (z − 1)/√z. Even and odd D − i apart,
    # the powers of −i are signs, and a factor −i of the odd ones.
    real, imaginary = (_collected(row, degree - odd) * _MINUS**odd for odd in (0, 1))
    cosines, sines = {}, {}
    for k in range(degree % 2, degree + 1, 2):
        # (a − ib) z^{k/2} and its conjugate: 2a cos kΩ + 2b sin kΩ, half of it at k = 0.
        a, b = (int(part[(degree + k) // 2]) for part in (real, imaginary))
        if a:
            cosines[k] = a if k == 0 else 2 * a
        if b:
            sines[k] = 2 * b
    return cosines, sines


_PLUS, _MINUS = fmpz_poly([1, 1]), fmpz_poly([-1, 1])


def _collected(row: fmpz_poly, degree: int) -> fmpz_poly:
    """Σ_k a_{D−2k} (z + 1)^{D−2k} (−(z − 1)²)^k for D = ``degree``, as in Horner's rule."""
    total, power = fmpz_poly([0]), fmpz_poly([1])
    for i in range(degree, -1, -2):
        total = total * _PLUS**2 + power * row[i]
        power = power * -(_MINUS**2)
    return total * _PLUS ** (degree % 2) if total else total


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
