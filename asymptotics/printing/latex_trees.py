r"""Closed forms as trees of LaTeX: prefactors, brackets, and the summands inside them.

A formula is a sum of amplitudes from the exact ring times functions of the coordinates. Each
amplitude becomes a :class:`LatexCoefficient`, read from its normal form in either style; the sum
becomes a tree of :class:`asymptotics.printing.widths.Term`, which that module cuts into lines.
Common rational factors and powers of Ω are pulled out of every bracket, so that all numbers inside
are coprime integers, except where that would make them large.

=======================  ==================================================  ==================
:func:`contact_tree`     ξ̂_n(τ)                                              eq. (expand)
:func:`shape_tree`       ŵ_n(ξ, τ)                                           eq. (leading) ff.
:func:`profile_tree`     what multiplies ε̂^{n−j} in F_j(s, ε)                eq. (expandw)
=======================  ==================================================  ==================
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import gcd

from asymptotics.formulas.closed_form import ClosedForms, Style
from asymptotics.formulas.normal_form import (
    CircularForm,
    circular_form,
    common_content,
    cotangent_form,
    resonance_cosines,
)
from asymptotics.formulas.partial_fractions import Monomial
from asymptotics.printing.widths import Term, pieces, width
from asymptotics.rings.cotangent import CotangentElement, CotangentRing

_NARROW = 0.4  # a fraction wider than this part of the line is written another way
_WIDEST = 0.6  # and one wider than this is cut: an indent, a sign and a bracket go with it
_LARGEST_MULTIPLE = 100  # beyond, terms keep their own denominators

Row = tuple[int, tuple[tuple[int, str], ...]]
"""A power of Ω and the integer combination of monomials that it multiplies."""


@dataclass(frozen=True)
class LatexCoefficient:
    """content · Ω^omega · Σ rows / below, the integers in ``rows`` coprime, the first positive.

    ``below`` are the factors of the denominator, each spelled out and as the symbol T_q, which
    differ only where T_q is a sum.
    """

    content: Fraction
    omega: int
    rows: tuple[Row, ...]
    below: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Product:
    """coefficient · before[…]after: one summand of a formula."""

    coefficient: LatexCoefficient
    before: str = ""
    after: str = ""


def coefficient(element: CotangentElement, style: Style) -> LatexCoefficient:
    """An element of the exact ring, other than 0, in the given style.

    >>> ring = CotangentRing()
    >>> found = coefficient(ring.rational(-2, 3) * ring.omega * ring.cot(2), "cotangent")
    >>> found.content, found.omega, found.rows
    (Fraction(-2, 3), 1, ((0, ((1, '\\\\kappa_{2}'),)),))
    """
    if style == "cotangent":
        form = cotangent_form(element)
        return LatexCoefficient(
            form.content,
            form.lowest,
            tuple(
                (a - form.lowest, tuple((v, _cotangents(monomial)) for monomial, v in row.items()))
                for a, row in form.rows.items()
            ),
        )
    return _circular_coefficient(circular_form(element))


def _circular_coefficient(form: CircularForm) -> LatexCoefficient:
    rows: dict[int, list[tuple[int, str]]] = {}
    for a in sorted({*form.cosines, *form.sines}):
        row = rows.setdefault(a, [])
        for k, v in sorted(form.cosines.get(a, {}).items()):
            row.append((v, _angle(r"\cos", k, r"\Omega") if k else ""))
        for k, v in sorted(form.sines.get(a, {}).items()):
            row.append((v, _angle(r"\sin", k, r"\Omega")))
    cosines = form.poles[0] if form.poles else 0
    paired = min(form.sine_power, cosines)  # sin Ω cos Ω = sin(2Ω)/2
    # Parentheses before sines: sin Ω(1 + …) would read as the sine of the product.
    below = [_resonance(q, m) for q, m in enumerate(form.poles[1:], start=3) if m]
    below.sort(key=lambda factor: factor[0].startswith("\\"))
    below += [
        (rf"{name}{_power(m)}{argument}",) * 2
        for name, argument, m in (
            (r"\sin", r"\Omega", form.sine_power - paired),
            (r"\cos", r"\Omega", cosines - paired),
            (r"\sin", r" 2\Omega", paired),
        )
        if m
    ]
    lowest = min(rows)
    content = gcd(*(v for row in rows.values() for v, _ in row))
    if rows[lowest][0][0] < 0:
        content = -content
    scaled = tuple(
        (a - lowest, tuple((v // content, tex) for v, tex in row)) for a, row in rows.items()
    )
    return LatexCoefficient(form.content * 2**paired * content, lowest, scaled, tuple(below))


def _power(m: int) -> str:
    return f"^{{{m}}}" if m != 1 else ""


@cache
def _cotangents(monomial: Monomial) -> str:
    q, m, i = monomial
    factors = [rf"\kappa_{{1}}{_power(i)}"] if i else []
    return "".join(factors + ([rf"\kappa_{{{q}}}{_power(m)}"] if m else []))


def _multiple(k: int, argument: str) -> str:
    return argument if k == 1 else f"{k}{argument}"


def _angle(function: str, k: int, argument: str) -> str:
    return function + (" " if k != 1 else "") + _multiple(k, argument)


def _resonance(q: int, power: int) -> tuple[str, str]:
    """T_q^power, spelled out and as a symbol; a T_q that is one cosine is always spelled out."""
    cosines = resonance_cosines(q)
    if len(cosines) == 1:
        return (rf"\cos{_power(power)} {cosines[0][0]}\Omega",) * 2
    return f"({cosine_sum(q)}){_power(power)}", f"T_{{{q}}}{_power(power)}"


def cosine_sum(q: int) -> str:
    r"""T_q, the factor of the denominators with zeros at pπ/q, spelled out.

    >>> cosine_sum(3)
    '1+2\\cos 2\\Omega'
    """
    terms = [(v, _angle(r"\cos", k, r"\Omega") if k else "") for k, v in resonance_cosines(q)]
    return "".join(piece.tex for piece in pieces(_monomials(terms)))


# -- trees ---------------------------------------------------------------------------------------


def _fraction(value: Fraction, omega: int, monomial: str, below: Sequence[str] = ()) -> str:
    """|value| Ω^omega · monomial / below; empty when it is 1."""
    above = (rf"\Omega{_power(omega)}" if omega else "") + monomial
    if abs(value.numerator) != 1 or not above:
        above = f"{abs(value.numerator)}{above}"
    under = "".join([str(value.denominator)] if value.denominator != 1 else []) + "".join(below)
    if under:
        return rf"\frac{{{above}}}{{{under}}}"
    return "" if above == "1" else above


def _fractions(
    value: Fraction, omega: int, monomial: str, below: Sequence[str], room: float
) -> tuple[str, ...]:
    """The same as factors, cut between those of the denominator so that lines may break there."""
    whole = _fraction(value, omega, monomial, below)
    if width(whole) <= _WIDEST * room:
        return (whole,)
    found: list[str] = []
    group: list[str] = []
    for factor in below:
        longer = _fraction(value, omega, monomial, [*group, factor])
        if group and width(longer) > _WIDEST * room:
            found.append(_fraction(value, omega, monomial, group))
            value, omega, monomial, group = Fraction(1), 0, "", []
        group.append(factor)
    return (*found, _fraction(value, omega, monomial, group))


def _monomials(entries: Iterable[tuple[int, str]], omega: int = 0) -> tuple[Term, ...]:
    return tuple(Term(v < 0, (_fraction(Fraction(v), omega, tex),)) for v, tex in entries)


def _body(rows: Sequence[Row]) -> tuple[Term, ...]:
    """Σ rows, a bracket for each power of Ω that has several terms."""
    terms: list[Term] = []
    for a, entries in rows:
        common = gcd(*(v for v, _ in entries)) * (-1 if entries[0][0] < 0 else 1)
        if len(entries) == 1 or (a == 0 and abs(common) == 1) or len(rows) == 1:
            terms += _monomials(entries, a)
        else:
            inner = _monomials((v // common, tex) for v, tex in entries)
            terms.append(Term(common < 0, (_fraction(Fraction(common), a, ""),), inner))
    return tuple(terms)


def _product(
    item: Product, outer: Fraction, omega: int, room: float, short: bool
) -> tuple[Term, ...]:
    """The summand over ``outer`` Ω^omega; ``short`` writes T_q in its denominator."""
    c, value = item.coefficient, item.coefficient.content / outer
    negative, power = value < 0, item.coefficient.omega - omega
    below = [factor[short] for factor in c.below]
    if len(c.rows) == 1 and len(c.rows[0][1]) == 1:
        head = _fractions(value, power, c.rows[0][1][0][1], below, room)
        return (Term(negative, (*head, item.before), (), item.after),)
    body = _body(c.rows)
    inline = "".join(piece.tex for piece in pieces(body, depth=2))
    if below and width(inline) < _NARROW * room:
        bare = abs(value.numerator) == 1 and not power
        head = _fractions(value, power, inline if bare else f"({inline})", below, room)
        return (Term(negative, (*head, item.before), (), item.after),)
    head = _fractions(value, power, "", below, room)
    if not (any(head) or item.before or item.after):
        return tuple(term.flipped() for term in body) if negative else body
    return (Term(negative, (*head, item.before), body, item.after),)


def _sum(items: Sequence[Product], room: float) -> tuple[Term, ...]:
    """Σ items, with their common factor before one bracket."""
    denominators = ("".join(spelled for spelled, _ in item.coefficient.below) for item in items)
    short = any(width(below) > _NARROW * room for below in denominators)
    if len(items) == 1:
        return _product(items[0], Fraction(1), 0, room, short)
    outer = common_content(item.coefficient.content for item in items)
    if max(abs(item.coefficient.content / outer) for item in items) > _LARGEST_MULTIPLE:
        outer = Fraction(1)
    omega = min(item.coefficient.omega for item in items)
    prefactor = _fraction(outer, omega, "")
    negative = bool(prefactor) and items[0].coefficient.content < 0
    signed = -outer if negative else outer
    terms = tuple(term for item in items for term in _product(item, signed, omega, room, short))
    return (Term(negative, (prefactor,), terms),) if prefactor else terms


# -- formulas ------------------------------------------------------------------------------------


def contact_tree(forms: ClosedForms, n: int, room: float) -> tuple[Term, ...]:
    r"""ξ̂_n(τ), n ≥ 1, for lines of ``room`` points.

    >>> from asymptotics import exact_string, expand
    >>> contact_tree(ClosedForms(expand(exact_string(), order=1)), 1, 200.0)
    (Term(negative=False, factors=('\\frac{\\Omega}{2}', ''), body=(), tail='\\cos\\theta'),)
    """
    items = []
    for j in sorted(forms.expansion.contact(n)):
        amplitude = forms.contact_amplitude(n, j)
        if not amplitude.is_zero():
            items.append(Product(coefficient(amplitude, forms.style), after=_phase(j)))
    return _sum(items, room)


def shape_tree(forms: ClosedForms, n: int, room: float) -> tuple[Term, ...]:
    """ŵ_n(ξ, τ), n ≥ 1, with σ_j for sin jΩξ/sin jΩ."""
    ring, items = CotangentRing(), []
    for j, (value, slope) in sorted(forms.expansion.shape(n).items()):
        if j == 0:
            parts = [(value, r"\xi")]
        else:
            # v cos jΩ(ξ−1) + (v′/jΩ) sin jΩ(ξ−1); undriven, it vanishes at ξ = 0 and is v σ_j.
            driven = ring.sum([slope * ring.rational(1, j), -(value * ring.cot(j) * ring.omega)])
            driven = driven.divided_by_omega()
            parts = [
                (value + value, rf"\sigma_{{{j}}}{_phase(j)}"),
                (driven + driven, rf"\sin[{_multiple(j, '')}\Omega(\xi-1)]{_phase(j)}"),
            ]
        items += [
            Product(coefficient(amplitude, forms.style), after=tail)
            for amplitude, tail in parts
            if not amplitude.is_zero()
        ]
    return _sum(items, room)


def profile_tree(forms: ClosedForms, j: int, n: int, room: float) -> tuple[Term, ...]:
    """F_j's part that multiplies ε̂^n cos jΩτ in w/Z₀, without the s² of F₀."""
    items = []
    for term in forms.profile_terms(j, n):
        if term.amplitude.is_zero():
            continue
        angle = _multiple(term.k, r"\Omega s")
        cosine, sine = (_angle(name, term.k, r"\Omega s") for name in (r"\cos", r"\sin"))
        function = f"(1-{cosine})" if term.kind == "versine" else f"({angle}-{sine})"
        items.append(Product(coefficient(term.amplitude, forms.style), before=function))
    return _sum(items, room)


def _phase(j: int) -> str:
    return _angle(r"\cos", j, r"\theta") if j else ""
