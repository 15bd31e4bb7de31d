r"""Closed forms of the string: SymPy expressions for the contact point, the shape and the profile.

===========================  ==================================================  ================
:meth:`ClosedForms.contact`  ξ_c's harmonics                                   eq. (expand)
:meth:`ClosedForms.shape`    w_n(ξ, τ)                                         eq. (leading) ff.
:meth:`ClosedForms.profile`  F_j(s, ε), w/Z₀ = Σ_j (ε/sin Ω)^j F_j cos jΩτ     eq. (expandw)
===========================  ==================================================  ================

The contact conditions make F_j vanish doubly at s = 0, so F_j is written in functions that do so
one by one: 1 − cos kΩs and kΩs − sin kΩs (and s² in F₀).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, Literal, get_args

from asymptotics.errors import InputError
from asymptotics.expansion.moving_frame import MovingFrame, moving_frame
from asymptotics.expansion.order_loop import Expansion
from asymptotics.formulas.normal_form import (
    circular_form,
    common_factor,
    cotangent_form,
    cotangent_terms,
    resonance_cosines,
)
from asymptotics.rings.cotangent import CotangentElement, CotangentRing

if TYPE_CHECKING:
    import sympy

Style = Literal["cotangent", "circular"]
Kind = Literal["versine", "defect"]
STYLES: tuple[str, ...] = get_args(Style)
KINDS: tuple[str, ...] = get_args(Kind)


@dataclass(frozen=True)
class ProfileTerm:
    """amplitude · f(kΩs), with f(x) = 1 − cos x (``versine``) or x − sin x (``defect``)."""

    k: int
    kind: Kind
    amplitude: CotangentElement


@dataclass(frozen=True)
class ClosedForm:
    """A named formula.

    Attributes
    ----------
    name
        What it is called in text and code, e.g. ``F_2``.
    expression
        The SymPy expression, in the symbols of :func:`symbols`.
    label
        The paper's equation.
    order
        It is exact through this power of ε.
    singular
        Where it has poles.
    """

    name: str
    expression: sympy.Expr
    label: str
    order: int
    singular: str


def symbols() -> dict[str, Any]:
    """The symbols of all closed forms, by name: Omega, epsilon, s, xi, tau.

    They carry no assumptions, so that ``sympy.sympify`` of a printed formula gives it back.
    """
    import sympy

    return {name: sympy.Symbol(name) for name in ("Omega", "epsilon", "s", "xi", "tau")}


def check_style(style: str) -> Style:
    """``cotangent`` or ``circular``."""
    if style not in STYLES:
        raise InputError(f"style = {style!r}; choose one of {', '.join(STYLES)}")
    return style  # type: ignore[return-value]


def to_sympy(element: CotangentElement, style: Style = "cotangent") -> sympy.Expr:
    """An element of the exact ring as a SymPy expression in Ω.

    >>> ring = CotangentRing()
    >>> to_sympy(ring.omega * ring.cot(2))
    Omega*cot(2*Omega)
    >>> to_sympy(ring.omega * ring.cot(2), "circular")
    Omega*cos(2*Omega)/sin(2*Omega)
    """
    return _cotangent_expression(element) if style == "cotangent" else _circular(element)


def _rational(value: Fraction) -> sympy.Rational:
    import sympy

    return sympy.Rational(value.numerator, value.denominator)


def _cotangent_expression(
    element: CotangentElement, factor: tuple[Fraction, int] = (Fraction(1), 0)
) -> sympy.Expr:
    """Σ r Ω^a κ_q^m κ₁^i, every term divided by factor[0] Ω^factor[1]."""
    import sympy

    omega = symbols()["Omega"]
    return sympy.Add(
        *(
            _rational(r / factor[0])
            * omega ** (a - factor[1])
            * _cotangent(q) ** m
            * _cotangent(1) ** i
            for (a, q, m, i), r in cotangent_terms(element).items()
        )
    )


@cache
def _cotangent(q: int) -> sympy.Expr:
    """cot qΩ, made once: SymPy examines every cotangent anew for special angles."""
    import sympy

    return sympy.cot(q * symbols()["Omega"])


def _circular(element: CotangentElement) -> sympy.Expr:
    import sympy

    omega = symbols()["Omega"]
    if element.is_zero():
        return sympy.Integer(0)
    form = circular_form(element)
    numerator = sympy.Add(
        *(
            omega**a * v * function(k * omega)
            for part, function in ((form.cosines, sympy.cos), (form.sines, sympy.sin))
            for a, row in part.items()
            for k, v in row.items()
        )
    )
    cosine_power = form.poles[0] if form.poles else 0
    paired = min(form.sine_power, cosine_power)  # sin Ω cos Ω = sin(2Ω)/2
    below = (
        sympy.sin(omega) ** (form.sine_power - paired)
        * sympy.cos(omega) ** (cosine_power - paired)
        * sympy.sin(2 * omega) ** paired
    )
    for q, power in enumerate(form.poles[1:], start=3):
        cosines = sympy.Add(*(v * sympy.cos(k * omega) for k, v in resonance_cosines(q)))
        below *= cosines**power
    return _rational(form.content) * 2**paired * numerator / below


class ClosedForms:
    """Everything the exact expansion of the string says, as SymPy expressions.

    Parameters
    ----------
    expansion
        An expansion over the exact ring.
    frame
        Its moving frame, when already computed.
    style
        ``cotangent`` (short, the default) or ``circular`` (the paper's sines and cosines).

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> forms = ClosedForms(expand(exact_string(), order=3))
    >>> forms.contact(2).expression
    -Omega**3*cos(2*Omega*tau)*cot(2*Omega)/(8*sin(Omega)**2) - Omega**2/(16*sin(Omega)**2)
    >>> forms.contact_harmonic(3, 1)
    (Omega**5*cot(Omega)**2/64 + Omega**4*cot(Omega)/32)/sin(Omega)**3
    >>> forms.profile(2).expression
    Omega**2*(-(2*Omega*s - sin(2*Omega*s))*cot(2*Omega) - 2*cos(Omega*s) + cos(2*Omega*s) + 1)/8
    """

    def __init__(
        self,
        expansion: Expansion[Any],
        frame: MovingFrame[Any] | None = None,
        style: str = "cotangent",
    ) -> None:
        if not isinstance(expansion.problem.ring, CotangentRing):
            raise InputError(
                f"closed forms need an expansion over the exact ring, not {expansion.problem.name}"
                "; make it with expand(exact_string(), order)"
            )
        self.expansion = expansion
        self.style: Style = check_style(style)
        self._frame = frame
        self._contact: dict[tuple[int, int], CotangentElement] = {}
        self._profile: dict[tuple[int, int], tuple[ProfileTerm, ...]] = {}

    @property
    def order(self) -> int:
        """N: formulas hold through ε^N."""
        return self.expansion.order

    @cached_property
    def frame(self) -> MovingFrame[Any]:
        """The expansion seen from the moving contact point."""
        return moving_frame(self.expansion) if self._frame is None else self._frame

    # -- contact point ---------------------------------------------------------------------------

    def contact_amplitude(self, n: int, j: int) -> CotangentElement:
        """The ring element multiplying (ε/sin Ω)^n cos jΩτ in ξ_c."""
        known = self._contact.get((n, j))
        if known is None:
            c = self.expansion.contact(n).get(j, CotangentRing.zero)
            known = self._contact[n, j] = c if j == 0 else c + c
        return known

    def contact_harmonic(self, n: int, j: int) -> sympy.Expr:
        """The coefficient of ε^n cos jΩτ in ξ_c = x_c/x₀."""
        import sympy

        omega = symbols()["Omega"]
        return to_sympy(self.contact_amplitude(n, j), self.style) / sympy.sin(omega) ** n

    def contact(self, n: int) -> ClosedForm:
        """ξ_n(τ) with ξ_c ∼ 1 + Σ ε^n ξ_n: eq. (expand), in units of x₀."""
        import sympy

        harmonics = sorted(self.expansion.contact(n))
        return ClosedForm(
            f"xi_{n}",
            sympy.Add(*(self.contact_harmonic(n, j) * _phase(j) for j in harmonics)),
            "expand" if n > 1 else "linresponse1",
            n,
            _poles(n),
        )

    # -- shape -----------------------------------------------------------------------------------

    def shape_parts(self, n: int, j: int) -> tuple[tuple[CotangentElement, str], ...]:
        """The coefficient of (ε/sin Ω)^n cos jΩτ in w/Z₀ as Σ amplitude · function of ξ."""
        value, slope = self.expansion.shape(n)[j]
        if j == 0:
            return ((value, "xi"),)
        x = f"{j}*Omega*(xi - 1)" if j > 1 else "Omega*(xi - 1)"
        sine = ((slope + slope) * CotangentRing().rational(1, j)).divided_by_omega()
        return ((value + value, f"cos({x})"), (sine, f"sin({x})"))

    def shape_harmonic(self, n: int, j: int) -> sympy.Expr:
        """The coefficient of ε^n cos jΩτ in w/Z₀, as a function of ξ."""
        import sympy

        return (
            sympy.Add(
                *(
                    to_sympy(amplitude, self.style) * sympy.sympify(function)
                    for amplitude, function in self.shape_parts(n, j)
                )
            )
            / sympy.sin(symbols()["Omega"]) ** n
        )

    def shape(self, n: int) -> ClosedForm:
        """w_n(ξ, τ)/Z₀; n = 0 is the static shape (ξ − 1)², eq. (leading)."""
        import sympy

        if n == 0:
            xi = symbols()["xi"]
            return ClosedForm("w_0", (xi - 1) ** 2, "leading", 0, "nowhere")
        harmonics = sorted(self.expansion.shape(n))
        return ClosedForm(
            f"w_{n}",
            sympy.Add(*(self.shape_harmonic(n, j) * _phase(j) for j in harmonics)),
            "leading ff.",
            n,
            _poles(n),
        )

    # -- profile ---------------------------------------------------------------------------------

    def profile_terms(self, j: int, n: int) -> tuple[ProfileTerm, ...]:
        """F_j's part that multiplies (ε/sin Ω)^n cos jΩτ in w/Z₀, without the s² of F₀.

        The coefficients of 1 and s are not looked up: W = W_ξ = 0 at s = 0, proved order by order,
        makes them what 1 − cos kΩs and kΩs − sin kΩs need.
        """
        known = self._profile.get((j, n))
        if known is None:
            known = self._profile[j, n] = tuple(self._profile_terms(j, n))
        return known

    def _profile_terms(self, j: int, n: int) -> Iterator[ProfileTerm]:
        ring = CotangentRing()
        for k, (value, slope) in sorted(self.frame.modes.items()):
            if k == 0:
                continue
            sign = ring.rational(-1 if j == 0 else -2)
            if j in value[n]:
                yield ProfileTerm(k, "versine", ring.sum([sign * value[n][j]]))
            if j in slope[n]:
                amplitude = ring.sum([sign * slope[n][j] * ring.rational(1, k)])
                yield ProfileTerm(k, "defect", amplitude.divided_by_omega())

    def profile_part(self, j: int, n: int) -> sympy.Expr:
        """The coefficient of (ε/sin Ω)^n cos jΩτ in w/Z₀, as a function of s."""
        import sympy

        omega, s = (symbols()[name] for name in ("Omega", "s"))
        static = s**2 if j == 0 and n == 0 else sympy.Integer(0)
        terms = self.profile_terms(j, n)
        if not terms:
            return static
        functions = [
            1 - sympy.cos(term.k * omega * s)
            if term.kind == "versine"
            else term.k * omega * s - sympy.sin(term.k * omega * s)
            for term in terms
        ]
        if self.style == "circular":
            amplitudes = [_circular(term.amplitude) for term in terms]
            return static + sympy.Add(*map(sympy.Mul, amplitudes, functions))
        ratio, power = common_factor(cotangent_form(term.amplitude) for term in terms)
        bracket = sympy.Add(
            *(
                _cotangent_expression(term.amplitude, (ratio, power)) * function
                for term, function in zip(terms, functions, strict=True)
            )
        )
        return static + _rational(ratio) * omega**power * bracket

    def profile(self, j: int) -> ClosedForm:
        """F_j(s, ε) through the powers of ε that order N allows: eq. (expandw).

        F_j is even in ε, so with the terms ε⁰ … ε^{2i} it is known through ε^{2i+1}.
        """
        import sympy

        if not 0 <= j <= self.order:
            raise InputError(f"F_{j} is not part of order {self.order}; give 0 ≤ j ≤ {self.order}")
        names = symbols()
        small = names["epsilon"] / sympy.sin(names["Omega"])
        parts = [small ** (n - j) * self.profile_part(j, n) for n in range(j, self.order + 1, 2)]
        return ClosedForm(
            f"F_{j}", sympy.Add(*parts), "expandw", 2 * len(parts) - 1, _poles(self.order)
        )


def _phase(j: int) -> sympy.Expr:
    import sympy

    names = symbols()
    return sympy.cos(j * names["Omega"] * names["tau"])


def _poles(order: int) -> str:
    return (
        f"at the resonances Ω = pπ/q, p ≥ 1, 1 ≤ q ≤ {order}" if order > 1 else "at Ω = pπ, p ≥ 1"
    )
