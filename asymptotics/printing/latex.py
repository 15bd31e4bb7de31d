r"""Closed forms as LaTeX that fits a journal's column.

===============  ====================================================  ========================
``contact.tex``  ξ̂_n(τ), x_c/x₀ ∼ 1 + Σ ε̂^n ξ̂_n, ε̂ = ε/sin Ω          eq. (expand)
``shape.tex``    ŵ_n(ξ, τ), w/Z₀ ∼ (ξ − 1)² + Σ ε̂^n ŵ_n                eq. (leading) ff.
``profile.tex``  F_j(s, ε), w/Z₀ ∼ Σ ε̂^j F_j cos jωt                   eq. (expandw)
===============  ====================================================  ========================

Each file is a fragment that needs amsmath only and defines its own notation; ``supplement.tex`` is
a document around the three. Here stand the left-hand sides, the text and the files; what stands on
the right comes as a tree from :mod:`asymptotics.printing.latex_trees`, which
:mod:`asymptotics.printing.widths` cuts into the rows of :mod:`asymptotics.printing.equations`.

A single equation from :func:`contact_equation` and its kin is an ``align`` alone. Between ``BEGIN``
and ``END`` of :mod:`asymptotics.printing.equations`, as in the files, no row of it leaves the
column.
"""

from __future__ import annotations

import re

from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.printing.equations import (
    BEGIN,
    COLUMNS,
    END,
    aligned,
    check_column,
    equation,
    room_beside,
)
from asymptotics.printing.latex_trees import contact_tree, cosine_sum, profile_tree, shape_tree
from asymptotics.printing.widths import Term

# -- equations -----------------------------------------------------------------------------------


def contact_equation(forms: ClosedForms, n: int, column: str = "two") -> str:
    r"""ξ̂_n(τ), n = 1 … N, in numbered lines of an ``align``.

    >>> from asymptotics import exact_string, expand
    >>> print(contact_equation(ClosedForms(expand(exact_string(), order=2)), 2))
    \begin{align}
    \hat\xi_{2}={}&{-}\frac{\Omega^{2}}{16}\Bigl[1+2\Omega\kappa_{2}\cos 2\theta\Bigr] \label{eq:rope:xi2}
    \end{align}
    <BLANKLINE>
    """  # noqa: E501 - a printed line is a source line
    return aligned(_contact(forms, _check(forms, n, 1, "n", column), column))


def _contact(forms: ClosedForms, n: int, column: str) -> list[str]:
    room = room_beside(rf"\hat\xi_{{{forms.order}}}=", column)
    return [equation(rf"\hat\xi_{{{n}}}", contact_tree(forms, n, room), f"xi{n}", room)]


def shape_equation(forms: ClosedForms, n: int, column: str = "two") -> str:
    r"""ŵ_n(ξ, τ), n = 0 … N; n = 0 is the static shape.

    >>> from asymptotics import exact_string, expand
    >>> print(shape_equation(ClosedForms(expand(exact_string(), order=1)), 1))
    \begin{align}
    \hat w_{1}={}&{-}\sin[\Omega(\xi-1)]\cos\theta \label{eq:rope:w1}
    \end{align}
    <BLANKLINE>
    """
    return aligned(_shape(forms, _check(forms, n, 0, "n", column), column))


def _shape(forms: ClosedForms, n: int, column: str) -> list[str]:
    room = room_beside(rf"\hat w_{{{forms.order}}}=", column)
    if n == 0:
        return [equation("w_{0}", (Term(False, (r"(\xi-1)^{2}",)),), "w0", room)]
    return [equation(rf"\hat w_{{{n}}}", shape_tree(forms, n, room), f"w{n}", room)]


def profile_equation(forms: ClosedForms, j: int, column: str = "two") -> str:
    r"""F_j(s, ε), j = 0 … N: its leading part, then each power of ε̂² that order N allows.

    >>> from asymptotics import exact_string, expand
    >>> print(profile_equation(ClosedForms(expand(exact_string(), order=1)), 1))
    \begin{align}
    F_{1}\sim{}&(\Omega s-\sin\Omega s)+O(\epsilon^{2}) \label{eq:rope:F1}
    \end{align}
    <BLANKLINE>
    """
    return aligned(_profile(forms, _check(forms, j, 0, "j", column), column))


def _profile(forms: ClosedForms, j: int, column: str) -> list[str]:
    room = room_beside(rf"F_{{{forms.order}}}^{{({forms.order})}}=", column)
    terms = list(profile_tree(forms, j, j, room)) if j else [Term(False, ("s^{2}",))]
    corrections = range(j + 2, forms.order + 1, 2)
    for n in corrections:
        terms.append(Term(False, (rf"\hat\epsilon^{{{n - j}}}F_{{{j}}}^{{({n - j})}}",)))
    terms.append(Term(False, (rf"O(\epsilon^{{{2 * len(corrections) + 2}}})",)))
    equations = [equation(f"F_{{{j}}}", terms, f"F{j}", room, r"\sim")]
    for n in corrections:
        part, left = profile_tree(forms, j, n, room), f"F_{{{j}}}^{{({n - j})}}"
        equations.append(equation(left, part, f"F{j}:{n - j}", room))
    return equations


# -- files ---------------------------------------------------------------------------------------

_COMMON = r"""Here $\theta\equiv\omega t=\Omega\tau$, $\Omega=\omega x_{0}/c$, $\xi=x/x_{0}$ and
$\hat\epsilon\equiv\epsilon/\sin\Omega$."""

_STYLE_NOTES = {
    "cotangent": r"""
We write $\kappa_{j}\equiv\cot j\Omega$.""",
    "circular": "",
}

_TEXTS = {
    "contact.tex": (
        "the contact point: xi_n(tau), n = 1 ... {order}; paper's eq. (expand)",
        r"""\begin{{equation}}
x_{{c}}/x_{{0}}\sim1+\sum_{{n=1}}^{{{order}}}\hat\epsilon^{{n}}\hat\xi_{{n}}(\tau)
+O(\epsilon^{{{next}}}). \label{{eq:rope:contact}}
\end{{equation}}
""",
    ),
    "shape.tex": (
        "the shape at fixed xi: w_n(xi, tau), n = 0 ... {order}; paper's eq. (leading) ff.",
        r"""\begin{{equation}}
w/Z_{{0}}\sim w_{{0}}+\sum_{{n=1}}^{{{order}}}\hat\epsilon^{{n}}\hat w_{{n}}(\xi,\tau)
+O(\epsilon^{{{next}}}). \label{{eq:rope:shape}}
\end{{equation}}
""",
    ),
    "profile.tex": (
        "the profile seen from the contact point: F_j(s, epsilon), j = 0 ... {order}; "
        "paper's eq. (expandw)",
        r"""\begin{{equation}}
w/Z_{{0}}\sim\sum_{{j=0}}^{{{order}}}\hat\epsilon^{{j}}F_{{j}}(s,\epsilon)\cos j\theta
+O(\epsilon^{{{next}}}). \label{{eq:rope:profile}}
\end{{equation}}
""",
    ),
}

_FILE_NOTES = {
    "contact.tex": r"""
The paper's $x_{n}$ is $x_{0}\hat\xi_{n}/\sin^{n}\Omega$.""",
    "shape.tex": r"""
The functions $\sigma_{j}\equiv\sin j\Omega\xi/\sin j\Omega$ vanish at the driven end.
The paper's $w_{n}$, $n\geq1$, is $Z_{0}\hat w_{n}/\sin^{n}\Omega$.""",
    "profile.tex": r"""
The coordinate $s=(x-x_{c})/x_{0}$ moves with the contact point, and $F_{j}^{(i)}$ multiplies
$\hat\epsilon^{i}$ in $F_{j}$.""",
}


def formula_sets(forms: ClosedForms, column: str = "two") -> dict[str, str]:
    """The three formula sets, and a document around them, by file name.

    Parameters
    ----------
    forms
        Closed forms of either style; their order decides how many formulas there are.
    column
        ``two`` for REVTeX's columns of 246 pt, ``one`` for lines of 469 pt.

    Raises
    ------
    InputError
        ``forms`` are not closed forms, or there is no such column.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> sorted(formula_sets(ClosedForms(expand(exact_string(), order=2))))
    ['contact.tex', 'profile.tex', 'shape.tex', 'supplement.tex']
    """
    _check(forms, 0, 0, "n", column)
    indices = range(forms.order + 1)
    equations = {
        "contact.tex": [row for n in indices[1:] for row in _contact(forms, n, column)],
        "shape.tex": [row for n in indices for row in _shape(forms, n, column)],
        "profile.tex": [row for j in indices for row in _profile(forms, j, column)],
    }
    files = {name: _fragment(name, forms, column, aligned(e)) for name, e in equations.items()}
    return {**files, "supplement.tex": _supplement(forms, column)}


def _fragment(name: str, forms: ClosedForms, column: str, equations: str) -> str:
    what, series = _TEXTS[name]
    numbers = {"order": forms.order, "next": forms.order + 1}
    used = sorted({int(q) for q in re.findall(r"T_\{(\d+)\}", equations)})
    symbols = ", ".join(f"$T_{{{q}}}\\equiv {cosine_sum(q)}$" for q in used)
    notes = _STYLE_NOTES[forms.style] + (
        f"\nWhere short of room we write\n{symbols}." if used else ""
    )
    return (
        f"% {name}: {what.format(**numbers)}\n"
        f"% Order {forms.order}, {forms.style} style, lines of {COLUMNS[column].points:.0f} pt.\n"
        "% Generated by ropewave: generate again rather than edit. Needs amsmath.\n"
        "% Notation: theta = omega t, Omega = omega x_0/c, s = (x - x_c)/x_0,\n"
        "% kappa_j = cot(j Omega), hat epsilon = epsilon/sin(Omega); see the text below.\n"
        f"{BEGIN}"
        f"{_COMMON}{notes}{_FILE_NOTES[name]}\n"
        f"{series.format(**numbers)}{equations}{END}"
    )


def _supplement(forms: ClosedForms, column: str) -> str:
    sections = (
        ("Contact point", "contact"),
        ("Shape at fixed position", "shape"),
        ("Profile in the frame of the contact point", "profile"),
    )
    inputs = "".join(f"\\section{{{title}}}\n\\input{{{name}}}\n" for title, name in sections)
    return (
        "% supplement.tex: the sets contact.tex, shape.tex and profile.tex in one document.\n"
        f"{COLUMNS[column].preamble}"
        "\\begin{document}\n"
        "\\title{Dynamical elastic contact of a rope with the ground:\\\\\n"
        f"closed forms to order {forms.order}}}\n{COLUMNS[column].date}\n\\maketitle\n"
        f"{inputs}\\end{{document}}\n"
    )


def _check(forms: ClosedForms, index: int, lowest: int, name: str, column: str) -> int:
    """The index, or an error that says what is allowed."""
    if not isinstance(forms, ClosedForms):
        raise InputError(
            f"forms = {forms!r} are not closed forms; give ClosedForms(expand(exact_string(), N))"
        )
    check_column(column)
    if isinstance(index, bool) or not hasattr(index, "__index__"):
        raise InputError(f"{name} = {index!r} is not an integer; give a whole number")
    if not lowest <= index <= forms.order:
        raise InputError(
            f"{name} = {index} is not part of order {forms.order}; give {lowest} ≤ {name} ≤ "
            f"{forms.order}, or expand further"
        )
    return int(index)
