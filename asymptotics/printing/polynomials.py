"""Polynomials in generators as LaTeX and as code: sums of products with a bracket each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

from flint import fmpq_mpoly

from asymptotics.formulas.polynomials import Powers, brackets
from asymptotics.printing.widths import Term

Symbol = Callable[[str], str]
"""A generator's name ↦ how it is written."""

WIDTH = 96
"""Of a line of code."""


def latex_tree(element: fmpq_mpoly, outside: Sequence[str], symbol: Symbol) -> list[Term]:
    """A polynomial as a sum of products of ``outside`` with a bracket each."""
    terms: list[Term] = []
    for product, bracket in brackets(element, outside):
        below = lcm(*(value.denominator for value, _ in bracket))
        negative = bracket[0][0] < 0
        ones = [(int(-value * below if negative else value * below), n) for value, n in bracket]
        before = _latex_product(product, symbol)
        if len(ones) == 1:  # its integer goes into the fraction
            value, names = ones[0]
            factors = latex_fraction(value, below) + before + _latex_product(names, symbol)
            terms.append(Term(negative, (factors,)))
            continue
        inner = tuple(
            Term(value < 0, (latex_fraction(abs(value), 1) + _latex_product(names, symbol) or "1",))
            for value, names in ones
        )
        terms.append(Term(negative, (latex_fraction(1, below) + before,), inner))
    return terms


def latex_fraction(above: int, below: int) -> str:
    """A positive rational as a factor; empty when it is 1."""
    if below == 1:
        return "" if above == 1 else str(above)
    return rf"\frac{{{above}}}{{{below}}}"


def _latex_product(product: Powers, symbol: Symbol) -> str:
    factors = []
    for name, exponent in product:
        base = symbol(name)
        # A symbol that has a superscript already takes no second one.
        base = f"({base})" if "^" in base and exponent > 1 else base
        factors.append(base if exponent == 1 else f"{base}^{{{exponent}}}")
    return "".join(factors)


@dataclass(frozen=True)
class Language:
    """How a language writes what the languages write differently.

    Attributes
    ----------
    power
        Name and exponent ↦ the power.
    declare
        What stands before a new name.
    end
        What stands behind a statement.
    number
        A real number ↦ its literal.
    """

    power: Callable[[str, int], str]
    declare: str = ""
    end: str = ""
    number: Callable[[float], str] = repr


PYTHON = Language(lambda name, n: f"{name}**{n}")
JAVASCRIPT = Language(lambda name, n: f"{name} ** {n}", "let ", ";")


def assignment(
    name: str,
    element: fmpq_mpoly,
    outside: Sequence[str],
    language: Language = PYTHON,
    *,
    symbol: Symbol = str,
    minus: str | None = None,
) -> list[str]:
    """``name = …``, a statement a bracket: product * (bracket) / denominator.

    Parameters
    ----------
    symbol
        Generator ↦ variable.
    minus
        A variable that is multiplied by where a term is negative, in the place of a minus sign:
        with 1 for it, and magnitudes for the rest, the code adds up its terms' sizes.

    Examples
    --------
    >>> from asymptotics.rings.ring import GeneratorRing
    >>> ring = GeneratorRing(["x", "S"])
    >>> value = ring["S"] * (ring["S"] * ring["x"] + ring.rational(-1, 2))
    >>> print(*assignment("y", value, ["S"]), sep="\\n")
    y = S**2 * (x)
    y = y + S / 2 * (-1.0)
    """
    declared = language.declare
    if element.is_zero():
        return [f"{declared}{name} = 0.0{language.end}"]
    lines: list[str] = []
    for product, bracket in brackets(element, outside):
        below = lcm(*(value.denominator for value, _ in bracket))
        terms = [_code_term(value * below, powers, symbol, minus) for value, powers in bracket]
        terms[0] = terms[0].removeprefix("+ ").replace("- ", "-", 1)
        factors = [
            language.power(symbol(base), n) if n > 1 else symbol(base) for base, n in product
        ]
        factor = " * ".join(factors) + (f" / {below}" if below > 1 else "")
        factor = factor if factors else f"1.0{factor}"
        head = f"{name} = {name} + " if lines else f"{declared}{name} = "
        lines += _wrapped(f"{head}{factor} * (", terms, language.end)
    return lines


def _code_term(value: Fraction, powers: Powers, symbol: Symbol, minus: str | None) -> str:
    factors = [symbol(name) for name, n in powers for _ in range(n)]
    size = abs(int(value))
    if size != 1 or not factors:
        factors.insert(0, f"{size}.0")
    if value < 0 and minus is not None:
        return "+ " + " * ".join([minus, *factors])
    return ("- " if value < 0 else "+ ") + " * ".join(factors)


def _wrapped(head: str, terms: list[str], end: str) -> list[str]:
    """``head`` terms ``)``, over as many lines as the width asks for."""
    line = head + " ".join(terms) + ")" + end
    if len(line) + 4 <= WIDTH:
        return [line]
    lines, current = [head], ""
    for term in terms:
        if current and len(current) + len(term) + 9 > WIDTH:
            lines.append(f"    {current}")
            current = ""
        current += f"{' ' if current else ''}{term}"
    return [*lines, f"    {current}", f"){end}"]


def indented(lines: Sequence[str], by: str = "    ") -> str:
    """The lines of a body."""
    return "\n".join(f"{by}{line}" for line in lines)
