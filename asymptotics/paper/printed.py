r"""The paper's printed formulas, as printed.

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
a difference in :func:`asymptotics.paper.check.compare`.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import sympy
from sympy import cos, exp, sec, sin, sinc, sqrt, tan

from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import symbols

_SYMBOLS = symbols()
Omega, epsilon, s = _SYMBOLS["Omega"], _SYMBOLS["epsilon"], _SYMBOLS["s"]
x, t, x_0, Z_0, g, c, T, rho, omega, p = sympy.symbols("x t x_0 Z_0 g c T rho omega p")
x_1, DeltaZ, A = (sympy.Function(name) for name in ("x_1", "DeltaZ", "A"))


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


_STATIC = (
    PaperFormula("w_0", "leading", g * (x - x_0) ** 2 / (2 * c**2), 0, "the static shape"),
    PaperFormula(
        "x_0^2",
        "leading",
        sympy.Tuple(2 * c**2 * Z_0 / g, 2 * T * Z_0 / (rho * g)),
        0,
        "the static contact point, in two forms (c² = T/ρ)",
    ),
)

_LINEAR = (
    PaperFormula(
        "linear",
        "linear",
        sympy.Eq(
            x_1(t) - x_1(t - 2 * x_0 / c),
            (2 * c / g) * sympy.Derivative(DeltaZ(t - x_0 / c), t),
        ),
        1,
        "the contact point's linear response to any drive ε ΔZ(t)",
    ),
    PaperFormula(
        "x_1",
        "linresponse1",
        x_0 * cos(omega * t) / (2 * sinc(omega * x_0 / c)),
        1,
        "its response to ΔZ/Z₀ = cos ωt",
    ),
    PaperFormula(
        "x_1(t)",
        "linresponse2",
        x_0
        / 2
        * sympy.Integral(
            A(omega) * exp(sympy.I * omega * t) / sinc(omega * x_0 / c),
            (omega, -sympy.oo, sympy.oo),
        ),
        1,
        "its response to ΔZ/Z₀ = ∫ A(ω) exp(iωt) dω",
    ),
    PaperFormula("f_p", "resonance1", p * sqrt(g / (8 * Z_0)), 1, "resonances, p = 1, 2, …"),
)

_PROFILE = (
    PaperFormula("F_0", "expandw", s**2, 1, "mean profile in the frame of the contact point"),
    PaperFormula(
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
    ),
    PaperFormula(
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
    ),
    PaperFormula(
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
    ),
)

PAPER = MappingProxyType({formula.name: formula for formula in (*_STATIC, *_LINEAR, *_PROFILE)})
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
