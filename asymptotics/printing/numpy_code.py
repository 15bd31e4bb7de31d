r"""Closed forms as a NumPy module: readable, importable without SymPy, the same bytes every time.

What is shared is found by structure, not by search: every amplitude is written in its cotangent
form, each power of Ω then multiplies a linear combination of cotangent monomials, and those
combinations, scaled to coprime integers, recur over and over. Each becomes one named bracket.

**Rounding.** Three things keep the digits.

1. cot qΩ is evaluated for the double Ω as it stands (the rounding of the product qΩ is put back),
   so it is right to a few ulp right up to its pole.
2. The cotangent form is a partial fraction: next to a resonance one family of terms dominates, and
   there is little to cancel. (The same coefficients as polynomials in cot Ω lose all digits by
   order 14.)
3. 1 − cos x and x − sin x are computed without cancellation, so the profile is right relative to
   its own size down to the contact point.

What cancellation remains is bounded, not hoped away. Let M be the same formula with every
coefficient, cotangent and sign replaced by its absolute value. A term passes through at most R
roundings on its way into the result, R counted here at emission, so that to first order in the unit
roundoff u of the format that is computed in (2⁻⁵³ for doubles) the error is at most R u M. The
emitted ``contact_error`` and ``profile_error`` return that bound; near a resonance it grows like
the terms themselves.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from importlib.resources import files
from math import gcd

from asymptotics.formulas.closed_form import KINDS, ClosedForms
from asymptotics.formulas.normal_form import cotangent_form
from asymptotics.formulas.partial_fractions import Monomial
from asymptotics.rings.cotangent import CotangentElement

_WIDTH = 96
_BLOCK = 24  # terms in one statement: longer expressions strain compilers' recursion
_EXACT = 2**53  # integers below are doubles without rounding

Statement = tuple[str, str]
"""A variable, and the expression that it becomes: sums and products of variables and numbers, the
same in Python as in JavaScript."""


def numpy_module(forms: ClosedForms) -> str:
    """The source of a module with ``contact`` and ``profile`` through the order of ``forms``.

    It is :mod:`asymptotics.printing.emitted.string` with the amplitudes of this order: it depends
    on NumPy only, broadcasts over all arguments and takes any Array-API namespace as ``xp``;
    ``contact_error`` and ``profile_error`` bound the rounding. What it answers where there is no
    result, its docstring says.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> namespace = {}
    >>> exec(numpy_module(ClosedForms(expand(exact_string(), order=4))), namespace)
    >>> round(float(namespace["contact"](0.0, 0.83, 0.02)), 8)
    1.01122152
    """
    contact, profile = Function(), Function()
    bodies = {
        "_contact_harmonics": _contact_body(forms, contact),
        "_profile_amplitudes": _profile_body(forms, profile),
    }
    constants = {
        "ORDER": forms.order,
        "POWER": max(contact.highest, profile.highest),
        "ROUNDINGS": _roundings(forms.order, contact, profile),
    }
    source = with_definitions(emitted_source("string"), bodies, constants)
    return titled(source, forms.order, "numpy_code")


def emitted_source(name: str) -> str:
    """The source of one of the modules that other orders are written into."""
    return (files("asymptotics.printing.emitted") / f"{name}.py").read_text(encoding="utf-8")


def with_definitions(
    source: str,
    bodies: Mapping[str, str],
    constants: Mapping[str, int],
    functions: Mapping[str, str] | None = None,
) -> str:
    """A module's source with other constants and functions.

    Parameters
    ----------
    bodies
        What follows the docstring of a function, by its name.
    constants, functions
        Values, and whole definitions, by the name.

    Examples
    --------
    >>> print(with_definitions("N = 1", {}, {"N": 7}), end="")
    N = 7
    """
    lines = source.splitlines()
    for node in reversed(ast.parse(source).body):
        if isinstance(node, ast.FunctionDef) and node.name in bodies:
            first = node.body[1 if ast.get_docstring(node) is not None else 0]
            lines[first.lineno - 1 : node.end_lineno] = bodies[node.name].splitlines()
        elif isinstance(node, ast.FunctionDef) and node.name in (functions or {}):
            assert functions is not None
            lines[node.lineno - 1 : node.end_lineno] = functions[node.name].splitlines()
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            if name in constants:
                lines[node.lineno - 1] = f"{name} = {constants[name]}"
    return "\n".join(lines) + "\n"


def functions_of(source: str) -> dict[str, str]:
    """The definitions of a module's functions, by name.

    >>> functions_of("def f():\\n    return 0")
    {'f': 'def f():\\n    return 0'}
    """
    return {
        node.name: ast.get_source_segment(source, node) or ""
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef)
    }


def titled(source: str, order: int, module: str) -> str:
    """The source with its docstring's first lines those of an emitted module of this order."""
    return source.replace("through order 1", f"through order {order}", 1).replace(
        f"Order 1 is written by hand; asymptotics.printing.{module} "
        "puts in the amplitudes of the others.",
        "Generated by ropewave from the exact expansion: regenerate it rather than edit it.",
    )


@dataclass
class Function:
    """One emitted function: the powers, cotangent monomials and brackets its result needs."""

    brackets: dict[tuple[tuple[Monomial, int], ...], str] = field(default_factory=dict)
    monomials: set[Monomial] = field(default_factory=set)
    omega_power: int = 1
    small_power: int = 1
    longest: int = 1

    @property
    def highest(self) -> int:
        """The highest power of anything that is large or small with Ω."""
        cotangents = max((m + i for _, m, i in self.monomials), default=0)
        return max(self.omega_power, self.small_power, cotangents)

    def row(self, row: Mapping[Monomial, int]) -> tuple[int, str]:
        """(factor, code) with Σ v κ_q^m κ₁^i = factor · code; a bracket when it has two terms."""
        factor = gcd(*row.values())
        ordered = sorted(row.items(), key=lambda item: (item[0][0], -item[0][1], item[0][2]))
        if ordered[0][1] < 0:
            factor = -factor
        primitive = tuple((m, v // factor) for m, v in ordered)
        self.monomials.update(row)
        self.longest = max(self.longest, len(row))
        if len(primitive) == 1:
            return factor, _monomial(primitive[0][0])
        return factor, self.brackets.setdefault(primitive, f"b{len(self.brackets) + 1}")

    def amplitude(self, parts: Mapping[int, CotangentElement]) -> str:
        """Σ_n e^n Σ_a o^a (row), over the orders n of one amplitude, as code."""
        terms = []
        for n, element in sorted(parts.items()):
            form = cotangent_form(element)
            for a, row in form.rows.items():
                factor, code = self.row(row)
                self.omega_power = max(self.omega_power, a)
                self.small_power = max(self.small_power, n)
                terms.append(_term(form.content * factor, [_power("e", n), _power("o", a), code]))
        return _sum(terms)

    def preamble(self) -> list[Statement]:
        """Powers, monomials and brackets, in the order of their dependence."""
        lines = _power_lines("o", self.omega_power) + _power_lines("e", self.small_power)
        powers: dict[int, int] = {}
        for q, m, i in self.monomials:
            powers[q] = max(powers.get(q, 0), m)
            powers[1] = max(powers.get(1, 0), i)
        for q, highest in sorted(powers.items()):
            lines += [
                (f"k{q}p{m}", f"{_power(f'k{q}', m - 1, 'p')} * k{q}")
                for m in range(2, highest + 1)
            ]
        for q, m, i in sorted(self.monomials):
            if m and i:
                product = f"{_power(f'k{q}', m, 'p')} * {_power('k1', i, 'p')}"
                lines.append((_monomial((q, m, i)), product))
        for primitive, name in self.brackets.items():
            lines += _assignment(name, [_integer_term(v, m) for m, v in primitive])
        return lines


def contact_statements(
    forms: ClosedForms, function: Function
) -> tuple[list[Statement], dict[int, str]]:
    """What computes the harmonics of ξ_c, and the variable (or 0.0) of each."""
    names, assignments = {}, []
    for j in range(forms.order + 1):
        parts = {
            n: forms.contact_amplitude(n, j)
            for n in range(1, forms.order + 1)
            if j in forms.expansion.contact(n)
        }
        if parts:
            assignments.append((f"h{j}", function.amplitude(parts)))
        names[j] = f"h{j}" if parts else "0.0"
    return function.preamble() + assignments, names


def profile_statements(
    forms: ClosedForms, function: Function
) -> tuple[list[Statement], dict[int, dict[tuple[int, int], str]]]:
    """The same of the profile's amplitudes, by j, then k and kind."""
    order = forms.order
    parts: dict[tuple[int, int, int], dict[int, CotangentElement]] = {}
    for n in range(1, order + 1):
        for j in range(n % 2, n + 1, 2):
            for term in forms.profile_terms(j, n):
                kind = KINDS.index(term.kind)
                parts.setdefault((j, term.k, kind), {})[n] = term.amplitude
    assignments = []
    table: dict[int, dict[tuple[int, int], str]] = {j: {} for j in range(order + 1)}
    for (j, k, kind), orders in sorted(parts.items()):
        name = f"{'vd'[kind]}{k}_{j}"
        assignments.append((name, function.amplitude(orders)))
        table[j][k, kind] = name
    return function.preamble() + assignments, table


def _contact_body(forms: ClosedForms, function: Function) -> str:
    statements, names = contact_statements(forms, function)
    lines = _python(forms.order, statements)
    result = "{" + ", ".join(f"{j}: {name}" for j, name in names.items()) + "}"
    return _indent(lines + _wrapped("return", result))


def _profile_body(forms: ClosedForms, function: Function) -> str:
    statements, table = profile_statements(forms, function)
    lines = [*_python(forms.order, statements), "return {"]
    for j, entries in table.items():
        lines += _entries(
            f"    {j}: ", [f"({k}, {kind}): {name}" for (k, kind), name in entries.items()]
        )
    return _indent([*lines, "}"])


def _python(order: int, statements: list[Statement]) -> list[str]:
    """The cotangents unpacked, and the statements."""
    names = ", ".join(f"k{q}" for q in range(1, order + 1))
    lines = [f"{names} = k" if order > 1 else f"({names},) = k"]
    for name, expression in statements:
        lines += _wrapped(name, expression)
    return lines


def _entries(head: str, entries: list[str]) -> list[str]:
    """``head{entry, entry, …},`` over as many lines as the width asks for."""
    line = f"{head}{{{', '.join(entries)}}},"
    if len(line) + 4 <= _WIDTH:
        return [line]
    lines, current = [f"{head}{{"], ""
    for entry in entries:
        if current and len(current) + len(entry) + 14 > _WIDTH:
            lines.append(f"        {current}")
            current = ""
        current += ("" if not current else " ") + f"{entry},"
    return [*lines, f"        {current}", "    },"]


def _roundings(order: int, *functions: Function) -> int:
    """R of the module's docstring: the longest chain of roundings that any term passes through."""
    cotangent = 6  # tan to 1 ulp, the product put back, a sum and a quotient
    worst = 0
    for function in functions:
        degree = max((m + i for _, m, i in function.monomials), default=0)
        chain = degree * (cotangent + 1)  # powers and products of cotangents
        chain += min(function.longest, _BLOCK) + function.longest // _BLOCK + 2  # the bracket
        # Powers, ε/sin Ω, the factor; integers, which formats narrower than a double round.
        chain += function.omega_power + 3 * function.small_power + 3 + 3
        worst = max(worst, chain)
    # Σ over the powers of Ω and ε in one amplitude, over j, over k and both kinds; the recurrence
    # of the cosines loses up to a few ulp a step.
    return worst + 3 * order + 8 * order + 8


def _monomial(monomial: Monomial) -> str:
    """The variable that holds κ_q^m κ₁^i; empty for 1."""
    q, m, i = monomial
    return (_power(f"k{q}", m, "p") if m else "") + (_power("k1", i, "p") if i else "")


def _power(base: str, exponent: int, mark: str = "") -> str:
    """The variable that holds a power: o, o2, o3 … or k2, k2p2, k2p3 …; empty for exponent 0."""
    if exponent == 0:
        return ""
    return base if exponent == 1 else f"{base}{mark}{exponent}"


def _power_lines(base: str, highest: int) -> list[Statement]:
    return [(f"{base}{a}", f"{_power(base, a - 1)} * {base}") for a in range(2, highest + 1)]


def _term(factor: Fraction, parts: Iterable[str]) -> str:
    """One signed product: +3 * e2 * o4 * b1 / 64."""
    names = [part for part in parts if part]
    above, below = abs(factor.numerator), factor.denominator
    sign = "-" if factor < 0 else "+"
    if above >= _EXACT or below >= _EXACT:
        return sign + " * ".join([repr(above / below), *names])
    if above != 1 or not names:
        names.insert(0, str(above) if names else f"{above}.0")
    return sign + " * ".join(names) + (f" / {below}" if below != 1 else "")


def _integer_term(value: int, monomial: Monomial) -> str:
    return _term(Fraction(value), [_monomial(monomial)])


def _sum(terms: list[str]) -> str:
    """Signed terms joined to one expression."""
    text = " ".join(f"{term[0]} {term[1:]}" for term in terms)
    return "-" + text[2:] if text.startswith("- ") else text[2:]


def _assignment(name: str, terms: list[str]) -> list[Statement]:
    """``name = Σ terms``, in statements of at most a block of terms each."""
    statements = [(name, _sum(terms[:_BLOCK]))]
    for start in range(_BLOCK, len(terms), _BLOCK):
        block = terms[start : start + _BLOCK]
        statements.append((name, f"{name} " + " ".join(f"{t[0]} {t[1:]}" for t in block)))
    return statements


def _wrapped(name: str, expression: str) -> list[str]:
    """``name = expression`` (or ``return expression``), broken at spaces between terms."""
    head = "return " if name == "return" else f"{name} = "
    if len(head) + len(expression) + 4 <= _WIDTH:
        return [head + expression]
    lines, current = [], ""
    for piece in expression.replace(" + ", "\n+ ").replace(" - ", "\n- ").split("\n"):
        if current and len(current) + len(piece) + 9 > _WIDTH:
            lines.append(current)
            current = piece
        else:
            current = f"{current} {piece}" if current else piece
    return [f"{head}(", *(f"    {line}" for line in [*lines, current]), ")"]


def _indent(lines: Iterable[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)
