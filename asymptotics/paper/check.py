"""The proof that the engine derives the paper's printed formulas, one by one.

:func:`compare` puts each formula of :mod:`asymptotics.paper.printed` beside what the closed forms
and the linear response say, in the paper's physical units where it prints those, and asks the exact
zero test of :mod:`asymptotics.formulas.zero_test` whether the two are the same function.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import sympy
from sympy import cos, exp, sin

from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import ClosedForms, symbols
from asymptotics.formulas.linear_response import difference_equation, transfer_function
from asymptotics.formulas.zero_test import are_equal, are_equal_through
from asymptotics.paper.printed import (
    PAPER,
    Z_0,
    A,
    DeltaZ,
    Omega,
    PaperFormula,
    T,
    c,
    epsilon,
    g,
    omega,
    p,
    rho,
    t,
    x,
    x_0,
    x_1,
)

_XI, _TAU = (symbols()[name] for name in ("xi", "tau"))


@dataclass(frozen=True)
class PaperCheck:
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
) -> tuple[PaperCheck, ...]:
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
        results.append(PaperCheck(formula.name, formula.label, equal, variables))
    return tuple(results)


# -- the derived side of each comparison ---------------------------------------------------------

_PHYSICAL = {Omega: omega * x_0 / c, _TAU: c * t / x_0}
"""Ω and τ in physical units; with them Ωτ = ωt."""

_PROFILES = {"F_0": 0, "F_1": 1, "F_2": 2, "F_3": 3}


def _compare_profile(forms: ClosedForms, formula: PaperFormula) -> PaperCheck:
    j = _PROFILES[formula.name]
    # ε → −ε is a shift of time by half a period: F_j is even in ε, and known one power further
    # when N − j is even.
    available = (forms.order - j) // 2 * 2 + 1
    through = min(formula.order, available)
    return PaperCheck(
        formula.name,
        formula.label,
        are_equal_through(formula.expression, forms.profile(j).expression, epsilon, through),
        "s" if j == 0 else "Omega and s",
        through if through < formula.order else None,
    )


def _static_shape(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    derived = Z_0 * forms.shape(0).expression.subs(_XI, x / x_0)
    return are_equal(formula, derived.subs(Z_0, _height())), "x, x_0, g and c"


def _static_contact(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    # At rest c² w″ = g, and w″ = Z₀ W₀″/x₀².
    curvature = sympy.diff(forms.shape(0).expression, _XI, 2)
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
    for function, amplitude in zip((x_1, DeltaZ), amplitudes, strict=True):
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
    single = formula.subs(integral, integral.function.subs(A(omega), 1))
    engine = forms.contact(1).expression.subs(_TAU, 0)
    derived = [
        x_0 * amplitude.subs(_PHYSICAL) * exp(sympy.I * omega * t)
        for amplitude in (transfer_function().expression, engine)
    ]
    return all(are_equal(single, each) for each in derived), "the drive"


def _resonances(forms: ClosedForms, formula: sympy.Basic) -> tuple[bool, str]:
    # ξ₁ sin Ω is entire and not zero at Ω = pπ ≠ 0: there ξ₁ has its poles, f_p = pc/(2x₀).
    response = forms.contact(1).expression * sin(Omega)
    entire = are_equal(response, Omega * cos(Omega * _TAU) / 2)
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
