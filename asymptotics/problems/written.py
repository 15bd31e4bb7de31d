r"""A rope in a text file: TOML with equations in it, read by a small parser that knows no more.

.. code-block:: toml

    equation = "W_tautau = W_xixi - 2 - kappa*W"
    driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]
    contact = ["W", "W_xi"]
    ground = "0"
    springs = "0"

    [parameters]
    kappa = 1.7

Derivatives are W\_ and then xi's and tau's in any number and order. The text is never handed to
``eval`` or to SymPy's own reader: numbers, names, ``+ - * / ** ( )`` and the functions of
:data:`FUNCTIONS` are all there is, and exponents are small whole numbers, so that hostile text ends
in an error in bounded time.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import sympy

from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi

FUNCTIONS: dict[str, Callable[[sympy.Expr], sympy.Expr]] = {
    "cos": sympy.cos,
    "cosh": sympy.cosh,
    "exp": sympy.exp,
    "log": sympy.log,
    "sin": sympy.sin,
    "sinh": sympy.sinh,
    "sqrt": sympy.sqrt,
    "tan": sympy.tan,
    "tanh": sympy.tanh,
}
"""What may stand before a parenthesis."""

LONGEST = 2000
"""Characters of one equation."""
MOST_BYTES = 64_000
DEEPEST = 30
LARGEST_EXPONENT = 12
MOST_TERMS = 500
"""Of what an equation is when it is multiplied out."""
_MOST_CONDITIONS = 8
_MOST_DIGITS, _MOST_DECIMALS, _MOST_BITS = 40, 300, 4000
_MOST_FACTORS = 64

_TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)|(?P<sign>\*\*|[-+*/()]))"
)
_DERIVATIVE = re.compile(r"W(?:_((?:xi|tau)+))?")
_FIXED = {"xi": xi, "tau": tau, "epsilon": epsilon, "Omega": Omega, "pi": sympy.pi}


@dataclass(frozen=True)
class Written:
    """A rope from a file, and the values that the file gives its parameters."""

    rope: MovingContact
    parameters: Mapping[str, Any]


def read_problem(path: Path) -> Written:
    """The rope of a TOML file.

    Raises
    ------
    InputError
        No such file, one that is too large or no TOML, keys that are missing or unknown, text that
        is no equation; or what :func:`~asymptotics.problems.moving_contact.moving_contact` raises.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read: {error}") from None
    if len(content) > MOST_BYTES:
        raise InputError(f"{path} is larger than {MOST_BYTES} bytes, which no problem needs")
    try:
        data = tomllib.loads(content.decode("utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise InputError(f"{path} is no TOML file: {str(error)[:200]}") from None
    return problem_of(data, str(path))


def problem_of(data: Mapping[str, Any], where: str) -> Written:
    """The rope of a table as a TOML file holds it; see the module's docstring.

    Raises
    ------
    InputError
        As :func:`read_problem`.

    Examples
    --------
    >>> written = problem_of(
    ...     {
    ...         "equation": "W_tautau = W_xixi - 2 - kappa*W",
    ...         "driven_end": ["W = 1 + epsilon*cos(Omega*tau)"],
    ...         "contact": ["W", "W_xi"],
    ...         "parameters": {"kappa": 1.7},
    ...     },
    ...     "here",
    ... )
    >>> written.rope.parameters, written.parameters
    (('kappa', 'Omega'), {'kappa': 1.7})
    """
    wanted = {"equation", "driven_end", "contact"}
    known = wanted | {"ground", "springs", "parameters"}
    missing, extra = sorted(wanted - data.keys()), sorted(map(str, data.keys() - known))
    if missing or extra:
        what = [f"{name} is missing" for name in missing] + [
            f"{name!r} is unknown" for name in extra
        ]
        raise InputError(
            f"{where}: {'; '.join(what)}; a problem has equation, driven_end and contact, and may "
            "have ground, springs and parameters"
        )
    parameters = data.get("parameters", {})
    if not isinstance(parameters, Mapping):
        raise InputError(f"{where}: parameters is no table; write [parameters] and name = value")
    for name, value in parameters.items():
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise InputError(f"{where}: parameter {name} = {value!r} is no number")

    def conditions(key: str) -> list[Any]:
        value = data[key]
        texts = [value] if isinstance(value, str) else value
        if not isinstance(texts, list) or not 0 < len(texts) <= _MOST_CONDITIONS:
            raise InputError(f"{where}: {key} has to be a list of 1 to {_MOST_CONDITIONS} texts")
        return [statement(text, f"{where}: {key}") for text in texts]

    rope = moving_contact(
        equation=statement(data["equation"], f"{where}: equation"),
        driven_end=conditions("driven_end"),
        contact=conditions("contact"),
        ground=expression(data.get("ground", "0"), f"{where}: ground"),
        springs=expression(data.get("springs", "0"), f"{where}: springs"),
    )
    return Written(rope, dict(parameters))


def statement(text: Any, where: str) -> sympy.Expr:
    """'left = right' as left − right, or an expression that is zero.

    >>> statement("W_xixi = 2", "here")
    Derivative(W(xi, tau), (xi, 2)) - 2
    """
    if not isinstance(text, str):
        raise InputError(f"{where}: {text!r:.60} is no text; write it in quotation marks")
    sides = text.split("=")
    if len(sides) > 2:
        raise InputError(f"{where}: {_short(text)} has more than one =")
    left, *right = (expression(side, where) for side in sides)
    return left - right[0] if right else left


def expression(text: Any, where: str) -> sympy.Expr:
    """A text as a SymPy expression.

    Raises
    ------
    InputError
        Anything but the small language of this module; the error says what and where.

    Examples
    --------
    >>> expression("1/2*cos(3*Omega*tau) + W_xixitau", "here")
    cos(3*Omega*tau)/2 + Derivative(W(xi, tau), tau, (xi, 2))
    >>> expression("os.system", "here")
    Traceback (most recent call last):
    ...
    asymptotics.errors.InputError: here: 'os.system': '.' is not understood
    """
    if isinstance(text, int | float) and not isinstance(text, bool):
        text = repr(text)
    if not isinstance(text, str):
        raise InputError(f"{where}: {text!r:.60} is no text; write it in quotation marks")
    if len(text) > LONGEST:
        raise InputError(f"{where}: {len(text)} characters; an equation has at most {LONGEST}")
    return _Parser(text, where).whole()


def _bits(value: sympy.Expr) -> int:
    """Of the longest number in it."""
    numbers = value.atoms(sympy.Rational)
    return max((max(int(x.p).bit_length(), int(x.q).bit_length()) for x in numbers), default=0)


def _expanded(value: sympy.Expr, power: int = 1) -> int:
    """How many terms it has at most when it, or a power of it, is multiplied out.

    A circular function counts as the two exponentials that it is.
    """
    if isinstance(value, sympy.Add):
        terms = sum(map(_expanded, value.args))
    elif isinstance(value, sympy.Mul):
        terms = math.prod(map(_expanded, value.args))
    elif isinstance(value, sympy.Pow) and value.exp.is_Integer:
        terms = _expanded(value.base, abs(int(value.exp)))
    else:
        inside = [x for x in value.args if not isinstance(value, sympy.Derivative)]
        terms = max([1, *map(_expanded, inside)]) * (2 if isinstance(value, sympy.Function) else 1)
    terms = 1 if value.func == W.func else terms
    # n-fold products of t terms, without their order.
    return math.comb(terms + power - 1, power) if power > 1 else terms


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "…")


class _Parser:
    """Sums of products of powers, by recursive descent."""

    def __init__(self, text: str, where: str) -> None:
        self.text, self.where, self.depth = text, where, 0
        self.tokens = list(self._tokens())
        self.place = 0

    def _fail(self, why: str) -> InputError:
        return InputError(f"{self.where}: {_short(self.text)}: {why}")

    def _tokens(self) -> Iterator[tuple[str, str]]:
        place, end = 0, len(self.text.rstrip())
        while place < end:
            match = _TOKEN.match(self.text, place)
            if match is None or match.end() == place:
                raise self._fail(f"{self.text[place:].strip()[:1]!r} is not understood")
            place = match.end()
            yield str(match.lastgroup), match[str(match.lastgroup)]

    def _next(self) -> str:
        return self.tokens[self.place][1] if self.place < len(self.tokens) else ""

    def _accept(self, *signs: str) -> str:
        found = self._next()
        if found in signs and self.tokens[self.place][0] == "sign":
            self.place += 1
            return found
        return ""

    def whole(self) -> sympy.Expr:
        if not self.tokens:
            raise self._fail("nothing stands there")
        value = self._sum()
        if self.place < len(self.tokens):
            raise self._fail(f"{self._next()!r} is not expected there")
        if _expanded(value) > MOST_TERMS:
            raise self._fail(f"multiplied out it has more than {MOST_TERMS} terms")
        return value

    def _sum(self) -> sympy.Expr:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self._fail(f"more than {DEEPEST} parentheses inside one another")
        terms = [self._product()]
        while sign := self._accept("+", "-"):
            term = self._product()
            terms.append(term if sign == "+" else -term)
        self.depth -= 1
        return sympy.Add(*terms)

    def _product(self) -> sympy.Expr:
        value = self._signed()
        while sign := self._accept("*", "/"):
            factor = self._signed()
            if sign == "/" and factor == 0:
                raise self._fail("it divides by zero")
            value = value * factor if sign == "*" else value / factor
        return value

    def _signed(self) -> sympy.Expr:
        sign = 1
        while found := self._accept("+", "-"):
            sign = -sign if found == "-" else sign
        return sign * self._power()

    def _power(self) -> sympy.Expr:
        base = self._atom()
        if not self._accept("**"):
            return base
        minus = bool(self._accept("-"))
        kind, text = self.tokens[self.place] if self.place < len(self.tokens) else ("", "")
        if kind != "number" or not text.isdigit() or int(text[:9]) > LARGEST_EXPONENT:
            raise self._fail(
                f"exponents are whole numbers up to {LARGEST_EXPONENT}, not {text or 'nothing'!r}"
            )
        self.place += 1
        if self._next() == "**":
            raise self._fail("a power of a power needs parentheses")
        if minus and base == 0:
            raise self._fail("it divides by zero")
        power = int(text)
        degree = max([1, *(abs(int(x.exp)) for x in base.atoms(sympy.Pow) if x.exp.is_Integer)])
        large = _bits(base) * power > _MOST_BITS or degree * power > _MOST_FACTORS
        if large or _expanded(base, power) > MOST_TERMS:
            raise self._fail(f"a power {power} of that is too large")
        return base ** (-power if minus else power)

    def _atom(self) -> sympy.Expr:
        if self._accept("("):
            value = self._sum()
            self._close()
            return value
        if self.place >= len(self.tokens):
            raise self._fail("a number, name or ( is missing at the end")
        kind, text = self.tokens[self.place]
        if kind == "sign":
            raise self._fail(f"a number, name or ( is missing before {text!r}")
        self.place += 1
        return self._number(text) if kind == "number" else self._name(text)

    def _close(self) -> None:
        if not self._accept(")"):
            raise self._fail("a ) is missing")

    def _number(self, text: str) -> sympy.Expr:
        exponent = re.split("[eE]", text)[1:]
        if len(text) > _MOST_DIGITS or (exponent and abs(int(exponent[0])) > _MOST_DECIMALS):
            raise self._fail(f"{text[:20]!r} is too long or too large a number")
        value = Fraction(text)
        return sympy.Rational(value.numerator, value.denominator)

    def _name(self, text: str) -> sympy.Expr:
        if self._accept("("):
            if text not in FUNCTIONS:
                raise self._fail(f"{text}(…) is no function here; there are {', '.join(FUNCTIONS)}")
            argument = self._sum()
            self._close()
            return FUNCTIONS[text](argument)
        derivative = _DERIVATIVE.fullmatch(text)
        if derivative:
            letters = re.findall("xi|tau", derivative[1] or "")
            if len(letters) > 2 * _MOST_CONDITIONS:
                raise self._fail(f"{text[:20]}… has too many derivatives")
            counts = (letters.count("xi"), letters.count("tau"))
            return W.diff((xi, counts[0]), (tau, counts[1]))
        if "__" in text or text.startswith("W_") or len(text) > 30:
            raise self._fail(
                f"{text[:30]!r} is no name here; derivatives are W_xi, W_tautau, W_xixitau, …"
            )
        return _FIXED.get(text, sympy.Symbol(text))
