"""Closed forms as plain text that both a person and ``sympy.sympify`` read.

Written straight from the normal forms: at order 12 the text of a derivation is a megabyte, which
SymPy's own printer needs minutes for.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cache

from asymptotics.formulas.closed_form import ClosedForms, ProfileTerm, Style
from asymptotics.formulas.normal_form import (
    CotangentForm,
    circular_form,
    common_factor,
    cotangent_form,
    resonance_cosines,
)
from asymptotics.formulas.partial_fractions import Monomial
from asymptotics.rings.cotangent import CotangentElement

Signed = tuple[int, str]
"""A term of a sum: its sign and the text of its size."""


def element_text(element: CotangentElement, style: Style = "cotangent") -> str:
    """An element of the exact ring.

    >>> from asymptotics.rings.cotangent import CotangentRing
    >>> ring = CotangentRing()
    >>> element_text(ring.rational(-3, 4) * ring.omega * ring.cot(2) * ring.cot(2))
    '-3*Omega*cot(2*Omega)**2/4'
    >>> element_text(ring.cot(3), "circular")
    'cos(3*Omega)/(sin(Omega)*(1 + 2*cos(2*Omega)))'
    """
    if element.is_zero():
        return "0"
    if style == "circular":
        return _sum([_circular_signed(element)])
    return _sum([_factored(cotangent_form(element))])


def contact_text(forms: ClosedForms, n: int, j: int) -> str:
    """The coefficient of ε^n cos jΩτ in x_c/x₀.

    >>> from asymptotics import exact_string, expand
    >>> contact_text(ClosedForms(expand(exact_string(), 2)), 2, 2)
    '-Omega**3*cot(2*Omega)/8/sin(Omega)**2'
    """
    return _over_sine(element_text(forms.contact_amplitude(n, j), forms.style), n)


def shape_text(forms: ClosedForms, n: int, j: int) -> str:
    """The coefficient of ε^n cos jΩτ in w/Z₀, as a function of xi = x/x₀."""
    parts = []
    for amplitude, function in forms.shape_parts(n, j):
        if not amplitude.is_zero():
            parts.append(f"({element_text(amplitude, forms.style)})*{function}")
    return _over_sine(parts[0] if len(parts) == 1 else f"({' + '.join(parts)})", n)


def profile_text(forms: ClosedForms, j: int) -> str:
    """F_j(s, ε) through the powers of ε that the order allows: eq. (expandw).

    >>> from asymptotics import exact_string, expand
    >>> forms = ClosedForms(expand(exact_string(), 2))
    >>> print(profile_text(forms, 0))
    s**2 + (epsilon/sin(Omega))**2*Omega**2/4*(1 - cos(Omega*s))
    >>> print(profile_text(forms, 2))  # doctest: +NORMALIZE_WHITESPACE
    Omega**2/8*(2*(1 - cos(Omega*s)) - (1 - cos(2*Omega*s))
                - cot(2*Omega)*(2*Omega*s - sin(2*Omega*s)))
    """
    parts = ["s**2"] if j == 0 else []
    for n in range(j, forms.order + 1, 2):
        terms = forms.profile_terms(j, n)
        if not terms:
            continue
        part = _circular_part(terms) if forms.style == "circular" else _cotangent_part(terms)
        if n > j:
            part = f"(epsilon/sin(Omega))**{n - j}*{part}"
        parts.append(part)
    return " + ".join(parts)


def _cotangent_part(terms: tuple[ProfileTerm, ...]) -> str:
    forms = [cotangent_form(term.amplitude) for term in terms]
    ratio, power = common_factor(forms)
    signed: list[Signed] = []
    for term, form in zip(terms, forms, strict=True):
        sign, size = _factored(form, ratio, power)
        function = _function(term)
        signed.append((sign, function if size == "1" else f"{size}*{function}"))
    factor = _product(ratio, [_power("Omega", power)])
    if len(signed) == 1 and signed[0][0] == 1:
        return signed[0][1] if factor == "1" else f"{factor}*{signed[0][1]}"
    bracket = _sum(signed)
    return f"({bracket})" if factor == "1" else f"{factor}*({bracket})"


def _circular_part(terms: tuple[ProfileTerm, ...]) -> str:
    signed = []
    for term in terms:
        sign, size = _circular_signed(term.amplitude)
        function = _function(term)
        signed.append((sign, function if size == "1" else f"{size}*{function}"))
    text = _sum(signed)
    return text if len(signed) == 1 and signed[0][0] == 1 else f"({text})"


def _function(term: ProfileTerm) -> str:
    x = _multiple(term.k, "Omega*s")
    return f"(1 - cos({x}))" if term.kind == "versine" else f"({x} - sin({x}))"


def _factored(form: CotangentForm, ratio: Fraction = Fraction(1), power: int = 0) -> Signed:
    """The form over ratio Ω^power: its sign, and the rest with its common factor pulled out."""
    content = form.content / ratio
    factor = _product(abs(content), [_power("Omega", form.lowest - power)])
    bracket = _bracket(form)
    if bracket == "1":
        size = factor
    elif _is_product(form):
        size = _product(abs(content), [_power("Omega", form.lowest - power), bracket])
    else:
        size = f"({bracket})" if factor == "1" else f"{factor}*({bracket})"
    return (1 if content > 0 else -1), size


def _is_product(form: CotangentForm) -> bool:
    return sum(map(len, form.rows.values())) == 1


def _bracket(form: CotangentForm) -> str:
    """The sum without its content and lowest power of Ω; its first term is positive."""
    parts: list[str] = []
    for a, row in form.rows.items():
        for monomial, v in row.items():
            names, size = _names(a - form.lowest, monomial), abs(v)
            parts.append(" - " if v < 0 else " + ")
            parts.append(
                names if size == 1 and names else f"{size}*{names}" if names else str(size)
            )
    return "".join(parts[1:])


@cache
def _names(a: int, monomial: Monomial) -> str:
    """Ω^a κ_q^m κ₁^i; empty for 1."""
    q, m, i = monomial
    factors = (
        _power("Omega", a),
        _power(f"cot({_multiple(q, 'Omega')})", m),
        _power("cot(Omega)", i),
    )
    return "*".join(factor for factor in factors if factor)


def _circular_signed(element: CotangentElement) -> Signed:
    """The sign of the leading term, and the text of the element times that sign."""
    form = circular_form(element)
    power = min(a for part in (form.cosines, form.sines) for a in part)
    numerator: list[Signed] = []
    for part, name in ((form.cosines, "cos"), (form.sines, "sin")):
        for a, row in sorted(part.items()):
            for k, v in row.items():
                factors = [_power("Omega", a - power), _circular(name, k)]
                numerator.append((1 if v > 0 else -1, _product(Fraction(abs(v)), factors)))
    lead = numerator[0][0] if form.content > 0 else -numerator[0][0]
    first = numerator[0][0]
    top = _sum([(sign * first, size) for sign, size in numerator])
    if len(numerator) > 1:
        top = f"({top})"
    cosine_power = form.poles[0] if form.poles else 0
    paired = min(form.sine_power, cosine_power)  # sin Ω cos Ω = sin(2Ω)/2
    content = abs(form.content) * 2**paired
    factors = [
        str(content.numerator) if content.numerator != 1 else "",
        _power("Omega", power),
        top if top != "1" else "",
    ]
    above = "*".join(factor for factor in factors if factor) or "1"
    below = [
        str(content.denominator) if content.denominator != 1 else "",
        _power("sin(Omega)", form.sine_power - paired),
        _power("cos(Omega)", cosine_power - paired),
        _power("sin(2*Omega)", paired),
        *(_resonance(q, m) for q, m in enumerate(form.poles[1:], start=3)),
    ]
    below = [factor for factor in below if factor]
    if not below:
        return lead, above
    bottom = "*".join(below)
    return lead, f"{above}/({bottom})" if len(below) > 1 else f"{above}/{bottom}"


def _resonance(q: int, power: int) -> str:
    """T_q to a power: the denominator's factor with zeros at pπ/q."""
    terms = [
        (1 if v > 0 else -1, _product(Fraction(abs(v)), [_circular("cos", k)]))
        for k, v in resonance_cosines(q)
    ]
    return _power(f"({_sum(terms)})" if len(terms) > 1 else _sum(terms), power)


def _circular(name: str, k: int) -> str:
    return f"{name}({_multiple(k, 'Omega')})" if k else ""


def _multiple(k: int, of: str) -> str:
    return of if k == 1 else f"{k}*{of}"


def _power(base: str, exponent: int) -> str:
    if exponent == 0:
        return ""
    return base if exponent == 1 else f"{base}**{exponent}"


def _product(factor: Fraction, parts: Iterable[str]) -> str:
    """A positive rational times named factors: 3*a*b/64."""
    names = [part for part in parts if part]
    if factor.numerator != 1 or not names:
        names.insert(0, str(factor.numerator))
    return "*".join(names) + (f"/{factor.denominator}" if factor.denominator != 1 else "")


def _sum(terms: list[Signed]) -> str:
    """Signed terms joined: a - b + c."""
    first, *rest = terms
    text = ("-" if first[0] < 0 else "") + first[1]
    return text + "".join(f" {'-' if sign < 0 else '+'} {size}" for sign, size in rest)


def _over_sine(text: str, n: int) -> str:
    return f"{text}/sin(Omega)" + (f"**{n}" if n > 1 else "")
