r"""The paper's printed formulas, as printed, and the proof that the engine derives them.

G. Kozyreff and B. Seron, *Dynamical elastic contact of a rope with the ground*. Look a
formula up by its label, or by its name:

================  ======================================  ==========================
label             names                                   what it is
================  ======================================  ==========================
``leading``       ``w_0``, ``x_0^2``                      static shape, contact point
``linear``        ``linear``                              linear response, any drive
``linresponse1``  ``x_1``                                 linear response, harmonic
``linresponse2``  ``x_1(t)``                              linear response, Fourier
``resonance1``    ``f_p``                                 resonance frequencies
``expandw``       ``F_0``, ``F_1``, ``F_2``               profile, near the contact
``F3``            ``F_3``                                 profile, third harmonic
================  ======================================  ==========================

(F₀, F₁ and F₂ stand in the text after eq. (expandw) and have no label of their own.) Nothing here
is rewritten: signs, groupings and functions are the paper's, so that a slip in print would show as
a difference in :func:`compare`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from types import MappingProxyType

import sympy
from sympy import cos, exp, sec, sin, sinc, sqrt, tan

from asymptotics.closed_form import ClosedForms, symbols
from asymptotics.errors import InputError
from asymptotics.linear_response import difference_equation, transfer_function
from asymptotics.zero_test import are_equal, are_equal_through

_SYMBOLS = symbols()
Omega, epsilon, s = _SYMBOLS["Omega"], _SYMBOLS["epsilon"], _SYMBOLS["s"]
x, t, x_0, Z_0, g, c, T, rho, omega, p = sympy.symbols("x t x_0 Z_0 g c T rho omega p")
_x_1, _DeltaZ, _A = (sympy.Function(name) for name in ("x_1", "DeltaZ", "A"))


@dataclass(frozen=True)
class PaperFormula:
    """A formula of the paper.

    Attributes
    ----------
    name
        Its left-hand side.
    label
        The LaTeX label of its equation in the paper, or of the equation it belongs to.
    expression
        The right-hand side as printed; for ``linear`` the whole equation.
    order
        The power of ε through which it is printed; the terms left out are of the next order that
        symmetry allows.
    text
        What it says.
    """

    name: str
    label: str
    expression: sympy.Basic
    order: int
    text: str


def _formulas() -> Iterator[PaperFormula]:
    yield PaperFormula("w_0", "leading", g * (x - x_0) ** 2 / (2 * c**2), 0, "the static shape")
    yield PaperFormula(
        "x_0^2",
        "leading",
        sympy.Tuple(2 * c**2 * Z_0 / g, 2 * T * Z_0 / (rho * g)),
        0,
        "the static contact point, in two forms (c² = T/ρ)",
    )
    yield PaperFormula(
        "linear",
        "linear",
        sympy.Eq(
            _x_1(t) - _x_1(t - 2 * x_0 / c),
            (2 * c / g) * sympy.Derivative(_DeltaZ(t - x_0 / c), t),
        ),
        1,
        "the contact point's linear response to any drive ε ΔZ(t)",
    )
    yield PaperFormula(
        "x_1",
        "linresponse1",
        x_0 * cos(omega * t) / (2 * sinc(omega * x_0 / c)),
        1,
        "its response to ΔZ/Z₀ = cos ωt",
    )
    yield PaperFormula(
        "x_1(t)",
        "linresponse2",
        x_0
        / 2
        * sympy.Integral(
            _A(omega) * exp(sympy.I * omega * t) / sinc(omega * x_0 / c),
            (omega, -sympy.oo, sympy.oo),
        ),
        1,
        "its response to ΔZ/Z₀ = ∫ A(ω) exp(iωt) dω",
    )
    yield PaperFormula("f_p", "resonance1", p * sqrt(g / (8 * Z_0)), 1, "resonances, p = 1, 2, …")
    yield PaperFormula("F_0", "expandw", s**2, 1, "mean profile in the frame of the contact point")
    yield PaperFormula(
        "F_1",
        "expandw",
        (Omega * s - sin(Omega * s))
        * (
            1
            + epsilon**2
            * Omega**4
            * cos(Omega) ** 2
            / (32 * sin(Omega) ** 4)
            * (1 + 2 * tan(Omega) / Omega)
        )
        + epsilon**2
        * Omega**4
        * sec(Omega)
        / (16 * sin(Omega) ** 3)
        * (sin(2 * Omega) - sin(2 * Omega + Omega * s))
        * sin(Omega * s),
        3,
        "first harmonic",
    )
    yield PaperFormula(
        "F_2",
        "expandw",
        Omega**2
        / 8
        * (
            (1 - cos(Omega * s)) ** 2
            - sin(Omega * s) ** 2
            - cos(2 * Omega) / sin(2 * Omega) * (2 * Omega * s - sin(2 * Omega * s))
        ),
        1,
        "second harmonic",
    )
    yield PaperFormula(
        "F_3",
        "F3",
        Omega**4
        / 32
        * (
            sin(Omega * s)
            + sin(3 * Omega * s)
            - 2 * sin(2 * Omega * s)
            + (2 - cos(2 * Omega) + cos(4 * Omega))
            / (2 * (1 + 2 * cos(2 * Omega)) * sin(Omega) ** 2)
            * (3 * Omega * s - sin(3 * Omega * s))
            - 4 * cos(2 * Omega) / sin(2 * Omega) * (1 - 2 * cos(Omega * s)) * sin(Omega * s) ** 2
        ),
        1,
        "third harmonic",
    )


PAPER = MappingProxyType({formula.name: formula for formula in _formulas()})
"""The printed formulas by name."""


def printed(name_or_label: str) -> tuple[PaperFormula, ...]:
    """The printed formulas with this name, or under this label of the paper.

    Raises
    ------
    InputError
        Neither a name nor a label; the error lists both.

    Examples
    --------
    >>> [formula.name for formula in printed("leading")]
    ['w_0', 'x_0^2']
    >>> printed("F_2")[0].label, printed("f_p")[0].expression
    ('expandw', sqrt(2)*p*sqrt(g/Z_0)/4)
    """
    found = tuple(f for f in PAPER.values() if name_or_label in (f.name, f.label))
    if not found:
        labels = dict.fromkeys(f.label for f in PAPER.values())
        raise InputError(
            f"the paper's formulas hold no {name_or_label!r}; names are {', '.join(PAPER)}, "
            f"labels {', '.join(labels)}"
        )
    return found


@dataclass(frozen=True)
class Comparison:
    """A printed formula against the derived one; ``equal`` is a proof either way."""

    name: str
    label: str
    equal: bool
    variables: str
    through: int | None = None

    def __str__(self) -> str:
        verdict = "equal" if self.equal else "DIFFERENT"
        if self.through is not None:
            verdict += f" through epsilon^{self.through}"
        link = "identically in" if self.equal else "compared identically in"
        return f"{self.name} (eq. {self.label}): {verdict}, {link} {self.variables}"


def compare(
    forms: ClosedForms, formulas: Iterable[PaperFormula] | None = None
) -> tuple[Comparison, ...]:
    """Prove each printed formula equal to the derived one, or different, by the exact zero test.

    Parameters
    ----------
    forms
        Closed forms of any order N; harmonics above N are left out, and F₁ needs N ≥ 3 to be
        compared as far as it is printed.
    formulas
        What to compare, all of ``PAPER`` by default; the names must be among the paper's.

    Raises
    ------
    InputError
        ``forms`` are no closed forms, or a formula's name is not the paper's.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> print(*compare(ClosedForms(expand(exact_string(), order=3))), sep="\\n")
    w_0 (eq. leading): equal, identically in x, x_0, g and c
    x_0^2 (eq. leading): equal, identically in Z_0, T, rho and g
    linear (eq. linear): equal, identically in the drive
    x_1 (eq. linresponse1): equal, identically in t, omega, x_0 and c
    x_1(t) (eq. linresponse2): equal, identically in the drive
    f_p (eq. resonance1): equal, identically in p, g and Z_0
    F_0 (eq. expandw): equal, identically in s
    F_1 (eq. expandw): equal, identically in Omega and s
    F_2 (eq. expandw): equal, identically in Omega and s
    F_3 (eq. F3): equal, identically in Omega and s
    """
    if not isinstance(forms, ClosedForms):
        raise InputError(
            f"compare needs ClosedForms, not {type(forms).__name__}; make them with "
            "ClosedForms(expand(exact_string(), order=3))"
        )
    results = []
    for formula in PAPER.values() if formulas is None else formulas:
        if formula.name not in PAPER:
            raise InputError(
                f"{formula.name!r} is not a formula of the paper; names are {', '.join(PAPER)}"
            )
        if formula.name in _PROFILES:
            if _PROFILES[formula.name] <= forms.order:
                results.append(_compare_profile(forms, formula))
            continue
        equal, variables = _CHECKS[formula.name](forms, formula.expression)
        results.append(Comparison(formula.name, formula.label, equal, variables))
    return tuple(results)


# -- the derived side of each comparison ---------------------------------------------------------

_PHYSICAL = {Omega: omega * x_0 / c, _SYMBOLS["tau"]: c * t / x_0}
"""Ω and τ in physical units; with them Ωτ = ωt."""

_PROFILES = {"F_0": 0, "F_1": 1, "F_2": 2, "F_3": 3}


def _compare_profile(forms: ClosedForms, formula: PaperFormula) -> Comparison:
    j = _PROFILES[formula.name]
    # ε → −ε is a shift of time by half a period: F_j is even in ε, and known one power further
    # when N − j is even.
    available = (forms.order - j) // 2 * 2 + 1
    through = min(formula.order, available)
    return Comparison(
        formula.name,
        formula.label,
        are_equal_through(formula.expression, forms.profile(j).expression, epsilon, through),
        "s" if j == 0 else "Omega and s",
        through if through < formula.order else None,
    )


def _static_shape(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    derived = Z_0 * forms.shape(0).expression.subs(_SYMBOLS["xi"], x / x_0)
    return are_equal(formula, derived.subs(Z_0, _height())), "x, x_0, g and c"


def _static_contact(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    # At rest c² w″ = g, and w″ = Z₀ W₀″/x₀².
    curvature = sympy.diff(forms.shape(0).expression, _SYMBOLS["xi"], 2)
    derived = c**2 * Z_0 * curvature / g
    first, second = formula.args
    equal = are_equal(first, derived) and are_equal(second, derived.subs(c**2, T / rho))
    return equal, "Z_0, T, rho and g"


def _height() -> sympy.Expr:
    """Z₀ by eq. (leading)."""
    return g * x_0**2 / (2 * c**2)


def _general_drive(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    derived = difference_equation()
    equal = are_equal(_symbol(formula), _symbol(derived))
    return equal, "the drive"


def _symbol(equation: sympy.Basic) -> sympy.Expr:
    """An equation of shifts and derivatives on x₁ = X e^{iωt}, ΔZ = Y e^{iωt}, over e^{iωt}.

    Its coefficients are constant, so this function of ω determines it.
    """
    amplitudes = sympy.symbols("X Y")
    left_minus_right = equation.args[0] - equation.args[1]
    for function, amplitude in zip((_x_1, _DeltaZ), amplitudes, strict=True):
        left_minus_right = left_minus_right.replace(
            function, lambda time, a=amplitude: a * exp(sympy.I * omega * time)
        )
    return left_minus_right.doit() / exp(sympy.I * omega * t)


def _harmonic_drive(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    derived = x_0 * forms.contact(1).expression.subs(_PHYSICAL)
    return are_equal(formula, derived), "t, omega, x_0 and c"


def _fourier_drive(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    # One frequency: A(ω) dω is the amplitude, and the integral its integrand.
    integral = next(iter(formula.atoms(sympy.Integral)))
    single = formula.subs(integral, integral.function.subs(_A(omega), 1))
    engine = forms.contact(1).expression.subs(_SYMBOLS["tau"], 0)
    derived = [
        x_0 * amplitude.subs(_PHYSICAL) * exp(sympy.I * omega * t)
        for amplitude in (transfer_function().expression, engine)
    ]
    return all(are_equal(single, each) for each in derived), "the drive"


def _resonances(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    # ξ₁ sin Ω is entire and not zero at Ω = pπ ≠ 0: there ξ₁ has its poles, f_p = pc/(2x₀).
    response = forms.contact(1).expression * sin(Omega)
    entire = are_equal(response, Omega * cos(Omega * _SYMBOLS["tau"]) / 2)
    # Both sides are positive; their squares are rational.
    derived = (p * c / (2 * x_0)) ** 2
    equal = are_equal(formula.subs(Z_0, _height()) ** 2, derived)
    return entire and equal, "p, g and Z_0"


_CHECKS: dict[str, Callable[[ClosedForms, sympy.Basic], tuple[bool, str]]] = {
    "w_0": _static_shape,
    "x_0^2": _static_contact,
    "linear": _general_drive,
    "x_1": _harmonic_drive,
    "x_1(t)": _fourier_drive,
    "f_p": _resonances,
}
