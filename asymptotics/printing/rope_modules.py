"""The closed forms of any rope as a NumPy module and as a JavaScript module.

Both are :mod:`asymptotics.printing.emitted`'s ``rope``, a working module of the string on an
elastic foundation, with the amplitudes of this order and the equation, driven end and ground of
this rope put in. They compute the
impedances themselves, from the equation.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.resources import files
from math import lcm
from typing import Any

import sympy
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.numpy import NumPyPrinter

from asymptotics.errors import InputError
from asymptotics.formulas.polynomials import brackets
from asymptotics.formulas.rope import RopeForms
from asymptotics.printing.javascript import broken, emitted_javascript, with_bodies
from asymptotics.printing.numpy_code import emitted_source, with_definitions
from asymptotics.printing.polynomials import WIDTH, assignment, indented

_IMPORT = (
    "from asymptotics.problems.marching import along, impedances, rest, static_shape, towers\n"
)


def rope_numpy(forms: RopeForms) -> str:
    """The source of a NumPy module with ``contact`` and ``shape`` of a rope.

    It depends on NumPy only. What it answers where there is no result, its docstring says.

    Examples
    --------
    >>> from asymptotics.formulas.rope import rope_forms
    >>> from asymptotics.problems.presets import string
    >>> namespace = {}
    >>> exec(rope_numpy(rope_forms(string(foundation=1.7), 3)), namespace)
    >>> round(float(namespace["contact"](0.0, 2.2, 0.01)), 7)
    0.9488241
    """
    _check(forms)
    bodies = {
        "_amplitudes": _python_amplitudes(forms),
        "_contact_data": _python_data(forms),
        **_python_rope(forms),
    }
    constants: dict[str, Any] = {
        "ORDER": forms.order,
        "CONTACTS": forms.generators.contact_order,
        "EVEN": forms.generators.even,
        "PARAMETERS": _tuple(map(repr, _parameters(forms))),
        "DRIVE": _tuple(map(str, forms.generators.drive)),
    }
    source = with_definitions(emitted_source("rope"), bodies, constants)
    source = source.replace(
        'GENERATORS = ("S1_1", "S1_2", "alpha3", "Y0_1_0", "Y2_1_0")', _names(forms)
    )
    marching = (files("asymptotics.problems") / "marching.py").read_text(encoding="utf-8")
    body = marching.split("import numpy as np\n", 1)[1].strip("\n")
    return _titled(source.replace(_IMPORT, body + "\n"), forms)


def rope_javascript(forms: RopeForms) -> str:
    """The source of a JavaScript module with ``contact`` and ``harmonics`` of a rope.

    It depends on nothing, and agrees with :func:`rope_numpy`'s to rounding.

    Examples
    --------
    >>> from asymptotics.formulas.rope import rope_forms
    >>> from asymptotics.problems.presets import string
    >>> print(rope_javascript(rope_forms(string(foundation=1.7), 3)).splitlines()[0])
    // The rope 1.7*W + W_tautau - W_xixi = -2, through order 3 in epsilon.
    """
    _check(forms)
    rope, js = forms.rope, _JavaScript()
    x = sympy.Symbol("x")
    listed = [f"[{n}, {j}, x{n}_{j}]" for n, j in forms.places()]
    lines = [line for n, j in forms.places() for line in js.amplitude(f"x{n}_{j}", forms, n, j)]
    bodies = {
        "amplitudes": [*lines, *_listed("return [", listed, "];")],
        "equation": [f"return {js.row(_rates(rope.equation.terms, rope.order + 1, x))};"],
        "load": [f"return [{', '.join(map(js.real, _polynomial(forms, rope.equation.right)))}];"],
        "drivenEnd": [
            "return [",
            *(f"  {js.row(_rates(c.terms, rope.order, x))}," for c in rope.driven_end),
            "];",
        ],
        "constants": [f"return [{', '.join(js.real(c.constant) for c in rope.driven_end)}];"],
        "drive": [
            "return {",
            *(f"  {j}: {js.row(_amplitudes(forms, j))}," for j in forms.generators.drive),
            f"}}[j] ?? {js.row([sympy.Integer(0)] * len(rope.driven_end))};",
        ],
    }
    constants = {
        "ORDER": str(forms.order),
        "PARAMETERS": _javascript_list(_parameters(forms)),
        "CONTACTS": str(forms.generators.contact_order),
        "EVEN": str(forms.generators.even).lower(),
        "GENERATORS": _javascript_list(g.name for g in forms.generators.listed()),
    }
    source = with_bodies(emitted_javascript("rope"), bodies, constants)
    return _titled(source, forms)


def _check(forms: RopeForms) -> None:
    """That a module can compute the impedances."""
    if forms.rope.varying:
        raise InputError(
            f"{forms.rope}: modules compute impedances of equations with constant coefficients; "
            "text, LaTeX and JSON have the formulas, expand(rope, order, at=…) the numbers"
        )


def _parameters(forms: RopeForms) -> tuple[str, ...]:
    """Without Ω, which is an argument of its own."""
    return forms.rope.parameters[:-1]


def _titled(source: str, forms: RopeForms) -> str:
    title = str(forms.rope).split(",")[0].removeprefix("rope ")
    source = source.replace("W_tautau - W_xixi + kappa*W = -2", title, 1)
    source = source.replace("through order 2", f"through order {forms.order}", 1)
    return source.replace(
        "Order 2 of this rope is written by hand; asymptotics.printing.rope_modules puts in "
        "others.",
        "Generated by ropewave from the exact expansion: regenerate it rather than edit it.",
        1,
    )


def _names(forms: RopeForms) -> str:
    names = [repr(g.name).replace("'", '"') for g in forms.generators.listed()]
    return "\n".join(_listed("GENERATORS = (", names, ")"))


def _listed(head: str, entries: Iterable[str], tail: str) -> list[str]:
    """``head`` entries ``tail``, over as many lines as the width asks for."""
    lines, current = [head], ""
    for entry in entries:
        if current and len(current) + len(entry) + 6 > WIDTH:
            lines.append(f"    {current}")
            current = ""
        current += f"{' ' if current else ''}{entry},"
    return [*lines, f"    {current}", tail]


def _tuple(entries: Iterable[str]) -> str:
    found = list(entries)
    return f"({', '.join(found)}{',' if len(found) == 1 else ''})".replace("'", '"')


def _rates(terms: Any, length: int, x: sympy.Symbol) -> list[sympy.Expr]:
    """Σ_t c_{kt} (ix)^t for k = 0 … length − 1."""
    return [
        sympy.Add(*(c * (sympy.I * x) ** t for (i, t), c in terms.items() if i == k))
        for k in range(length)
    ]


def _polynomial(forms: RopeForms, expression: sympy.Expr) -> list[sympy.Expr]:
    """Its coefficients of 1, ξ, ξ², …."""
    found: list[sympy.Expr] = sympy.Poly(expression, forms.rope.letters.xi).all_coeffs()
    return found[::-1]


def _amplitudes(forms: RopeForms, j: int) -> list[sympy.Expr]:
    """Of ε e^{ijθ} in each condition, its real part counting."""
    return [(2 if j else 1) * c.drive.get(j, sympy.Integer(0)) for c in forms.rope.driven_end]


def _at_parameters(expression: sympy.Expr) -> sympy.Expr:
    """Each parameter as the entry of ``p`` that holds it."""
    names = {
        symbol: sympy.Symbol(f'p["{symbol.name}"]', real=True)
        for symbol in expression.free_symbols
        if symbol.name != "x"
    }
    return expression.subs(names, simultaneous=True)


def _python(expression: sympy.Expr) -> str:
    """As NumPy code; integers as floats, so that powers of them stay numbers."""
    text = NumPyPrinter().doprint(_at_parameters(expression)).replace("numpy.", "np.")
    return f"{float(expression)!r}" if expression.is_Rational else text


def _python_amplitudes(forms: RopeForms) -> str:
    lines = [_unpacked(forms)]
    for n, j in forms.places():
        lines += assignment(f"x{n}_{j}", forms.contact(n, j), forms.sources, minus="minus")
    lines += _listed("return {", [f"({n}, {j}): x{n}_{j}" for n, j in forms.places()], "}")
    return indented(lines)


def _python_data(forms: RopeForms) -> str:
    lines, entries = [_unpacked(forms)], []
    for n, j in forms.shapes():
        names = [f"u{n}_{j}_{i}" for i in range(forms.generators.contact_order - 1)]
        for name, u in zip(names, forms.data(n, j), strict=True):
            lines += assignment(name, u, forms.sources, minus="minus")
        entries.append(f"({n}, {j}): {_tuple(names)}")
    return indented([*lines, *_listed("return {", entries, "}")] if entries else ["return {}"])


def _unpacked(forms: RopeForms) -> str:
    names = [g.name for g in forms.generators.listed()]
    if len(names) == 1:
        return f"{names[0]} = v[GENERATORS[0]]"
    return "\n    ".join(_listed("(", names, ") = (v[name] for name in GENERATORS)"))


def _python_rope(forms: RopeForms) -> dict[str, str]:
    """The bodies of the functions that say which rope it is."""
    rope, x = forms.rope, sympy.Symbol("x")

    def row(expressions: Iterable[sympy.Expr]) -> str:
        return _tuple(_python(e) for e in expressions)

    def drive(j: int) -> str:
        return row(_amplitudes(forms, j))

    none = row([sympy.Integer(0)] * len(rope.driven_end))
    drives = [f"{j}: {drive(j)}" for j in forms.generators.drive]
    ground = " + ".join(
        f"({_python(c)}) * xi**{d}" for d, c in enumerate(_polynomial(forms, rope.ground)) if c
    )
    conditions = [f"({row(_rates(c.terms, rope.order, x))[1:-1]})" for c in rope.driven_end]
    return {
        "_equation": f"    return {row(_rates(rope.equation.terms, rope.order + 1, x))}",
        "_load": f"    return {row(_polynomial(forms, rope.equation.right))}",
        "_conditions": f"    return {_tuple(conditions)}",
        "_constants": f"    return {row(c.constant for c in rope.driven_end)}",
        "_drive": f"    return {{{', '.join(drives)}}}.get(j, {none})",
        "_ground": f"    return {ground or '0.0 * xi'}",
    }


def _javascript_list(names: Iterable[str]) -> str:
    quoted = [f'"{name}"' for name in names]
    text = f"[{', '.join(quoted)}]"
    return text if len(text) < WIDTH - 24 else "\n".join(_listed("[", quoted, "]"))


class _JavaScript:
    """Complex numbers as pairs, their sums and products as calls."""

    def real(self, expression: sympy.Expr) -> str:
        """A real expression in the parameters."""
        return self.number(_at_parameters(expression))

    def number(self, expression: sympy.Expr) -> str:
        """The same once its parameters are entries of ``p``."""
        if expression.is_Rational:
            return repr(float(expression))
        return JavascriptCodePrinter().doprint(expression)

    def row(self, expressions: Iterable[sympy.Expr]) -> str:
        """Complex expressions in real parameters as pairs."""
        pairs = []
        for e in expressions:
            at = _at_parameters(e).subs(sympy.Symbol("x"), sympy.Symbol("x", real=True))
            pairs.append("[" + ", ".join(self.number(part) for part in at.as_real_imag()) + "]")
        return f"[{', '.join(pairs)}]"

    def amplitude(self, name: str, forms: RopeForms, n: int, j: int) -> list[str]:
        """Statements that compute ξ_{n,j}."""
        lines: list[str] = []
        for product, bracket in brackets(forms.contact(n, j), forms.sources):
            below = lcm(*(value.denominator for value, _ in bracket))
            terms = []
            for value, powers in bracket:
                factors = ["minus"] if value < 0 else []
                size = abs(int(value * below))
                factors += [f"real({size})"] if size != 1 or not powers else []
                factors += [f"v.{base}" for base, count in powers for _ in range(count)]
                terms.append(_called("mul", factors))
            outside = [f"real(1 / {below})"] if below > 1 else []
            outside += [
                f"pow(v.{base}, {count})" if count > 1 else f"v.{base}" for base, count in product
            ]
            total = _called("add", terms)
            value_text = _called("mul", [*outside, total])
            head = (
                f"{name} = add({name}, {value_text});" if lines else f"let {name} = {value_text};"
            )
            lines.append(head)
        return [piece for line in lines for piece in broken(line)]


def _called(function: str, arguments: list[str]) -> str:
    return arguments[0] if len(arguments) == 1 else f"{function}({', '.join(arguments)})"
