r"""Lines of mathematics: how wide they print, and where to break them.

**Widths.** A formula here is made of some thirty symbols, so their widths (Computer Modern, 10 pt)
are a table, and TeX's own rules give the space between atoms. That is right to a few points a line,
on the safe side, and costs microseconds a term; typesetting the same strings with a general
renderer costs milliseconds each, and its fraction bars and operator spaces are not TeX's.

**Breaks.** A formula is a tree: a :class:`Term` is a sign, factors, and possibly a bracket of
further terms. Lines may break before the sign of any term, also inside brackets, whose delimiters
have fixed sizes for that reason, and, at a price, before a factor. Among all ways to fill the lines
the cheapest is taken: few lines, broken in the outer brackets, of even length.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

_WIDTHS = {
    **dict.fromkeys("0123456789/", 5.0),
    **{"s": 4.69, "O": 7.91, "F": 7.82, "T": 7.24, "w": 7.43, "S": 6.71, "Y": 8.04},
    **{"b": 4.29, "B": 8.09, "u": 5.72, "v": 5.21},
    **{
        r"\alpha": 6.4,
        r"\xi": 4.84,
        r"\tau": 5.51,
        r"\theta": 4.98,
        r"\kappa": 5.77,
        r"\sigma": 6.08,
    },
    **{r"\epsilon": 4.06, r"\Omega": 7.23, r"\sin": 12.28, r"\cos": 13.39, r"\times": 7.78},
    **{"(": 3.89, ")": 3.89, "[": 2.78, "]": 2.78, ",": 2.78, ".": 2.78, "+": 7.78, "-": 7.78},
    **{r"\bigl": 1.39, r"\bigr": 1.39, r"\Bigl": 1.95, r"\Bigr": 1.95, "=": 7.78, r"\sim": 7.78},
    **{r"\quad": 10.0, r"\qquad": 20.0},
}
"""Points, at 10 pt; a ``\\big`` is what it adds to the bracket it enlarges."""

_SCRIPT = {**dict.fromkeys("0123456789", 3.99), "(": 3.13, ")": 3.13, ",": 2.82}
_SCRIPT_SPACE = 0.5
_FRACTION_EDGES = 2.4
_OVERLINE = {"Y": 1.5}  # its slant, where no script uses it; of others it is nothing to speak of

_THIN, _MEDIUM, _THICK = 1.67, 2.23, 2.78
_CLASSES = {
    **dict.fromkeys((r"\sin", r"\cos"), "operator"),
    **dict.fromkeys(("+", "-", r"\times"), "binary"),
    **dict.fromkeys(("=", r"\sim"), "relation"),
    **dict.fromkeys(("(", "["), "open"),
    **dict.fromkeys((")", "]"), "close"),
}
_THIN_PAIRS = {
    (left, right)
    for left in ("ordinary", "operator", "close", "fraction")
    for right in ("ordinary", "operator", "fraction", "open")
    if "operator" in (left, right) or "fraction" in (left, right)
} - {("operator", "open")}

_TOKEN = re.compile(r"\\[A-Za-z]+|[^\s]")


def width(tex: str) -> float:
    r"""How wide ``tex`` prints in display style, in points at 10 pt.

    Understands what :mod:`asymptotics.printing.latex` writes: the symbols of the table, ``\frac``,
    ``\hat``, ``\overline``, scripts, ``\bigl`` and its kin. The string counts as following an
    ordinary symbol: its first sign is binary, its first fraction or sine has a thin space before.

    >>> round(width(r"\frac{\Omega^{2}}{8}"), 1), round(width(r"\sin 2\Omega s"), 1)
    (15.8, 32.5)
    """
    return _of_string(tex.translate(_ALIKE))


_ALIKE = str.maketrans("123456789", "000000000")  # digits are equally wide


@lru_cache(maxsize=65536)
def _of_string(tex: str) -> float:
    return _width(tuple(_TOKEN.findall(tex)))


def _width(tokens: tuple[str, ...]) -> float:
    total, i, left = 0.0, 0, "ordinary"
    while i < len(tokens):
        token = tokens[i]
        if token in "^_":
            added, i = _scripts(tokens, i)
            total += added
            continue
        if token in (r"\bigl", r"\bigr", r"\Bigl", r"\Bigr", r"\quad", r"\qquad"):
            total, i = total + _WIDTHS[token], i + 1
            continue
        if token in (r"\hat", r"\overline", "{"):
            end = _group_end(tokens, i) if token == "{" else i + 1
            inside = _width(tokens[i + 1 : end - 1]) if token == "{" else 0.0
            if token == r"\overline":
                inside = _OVERLINE.get(tokens[i + 2], 0.0)
            total, i = total + inside, end
            continue
        here = "fraction" if token == r"\frac" else _CLASSES.get(token, "ordinary")
        total += _space(left, here)
        if token == r"\frac":
            middle = _group_end(tokens, i + 1)
            end = _group_end(tokens, middle)
            parts = (tokens[i + 2 : middle - 1], tokens[middle + 1 : end - 1])
            total, i = total + max(map(_width, parts)) + _FRACTION_EDGES, end
        else:
            total, i = total + _WIDTHS[token], i + 1
        left = here
    return total


def _space(left: str, right: str) -> float:
    if "relation" in (left, right):
        return _THICK
    if right == "binary":
        return 0.0 if left in ("open", "binary", "operator") else _MEDIUM
    if left == "binary":
        return _MEDIUM
    return _THIN if (left, right) in _THIN_PAIRS else 0.0


def _group_end(tokens: tuple[str, ...], start: int) -> int:
    depth = 0
    for i in range(start, len(tokens)):
        depth += (tokens[i] == "{") - (tokens[i] == "}")
        if depth == 0:
            return i + 1
    raise ValueError(f"unbalanced braces in {''.join(tokens)}")


def _scripts(tokens: tuple[str, ...], i: int) -> tuple[float, int]:
    """The wider of a subscript and a superscript, both in braces."""
    widest = 0.0
    while i < len(tokens) and tokens[i] in "^_":
        end = _group_end(tokens, i + 1)
        widest = max(widest, sum(_SCRIPT[t] for t in tokens[i + 2 : end - 1]) + _SCRIPT_SPACE)
        i = end
    return widest, i


@dataclass(frozen=True)
class Term:
    """± factors · [body] · tail, the body a sum of further terms, or none."""

    negative: bool
    factors: tuple[str, ...]
    body: tuple[Term, ...] = ()
    tail: str = ""

    def flipped(self) -> Term:
        """The same term with the other sign."""
        return replace(self, negative=not self.negative)


@dataclass(frozen=True)
class Piece:
    """What stays on one line: ``tex`` starts with its sign unless it continues a product."""

    tex: str
    depth: int
    product: bool = False


# Points: a factor may stand on the line before its bracket when it is wider than this alone, or
# than that with the first term in the bracket.
_WIDE, _WIDE_OPENING = 90.0, 170.0
_BRACKETS = ((r"\Bigl[", r"\Bigr]"), (r"\bigl[", r"\bigr]"), ("(", ")"))


def pieces(terms: Sequence[Term], depth: int = 0) -> list[Piece]:
    """A sum, cut at every place where a line may break.

    >>> inner = (Term(False, ("1",)), Term(True, ("s",)))
    >>> [piece.tex for piece in pieces([Term(False, ("F",)), Term(False, ("2",), inner)])]
    ['F', '+2\\\\Bigl[1', '-s\\\\Bigr]']
    """
    found: list[Piece] = []
    for i, term in enumerate(terms):
        sign = "-" if term.negative else "+" if i else ""
        factors = [f for f in term.factors if f] or ([] if term.body or term.tail else ["1"])
        if term.tail and not term.body:
            factors.append(term.tail)
        own = [Piece(factor, depth, product=True) for factor in factors]
        if term.body:
            left, right = _BRACKETS[min(depth, len(_BRACKETS) - 1)]
            inside = pieces(term.body, depth + 1)
            joined = bool(own) and (
                width(own[-1].tex) < _WIDE
                and width(own[-1].tex + left + inside[0].tex) < _WIDE_OPENING
            )
            opening = own.pop() if joined else Piece("", depth)
            inside[0] = Piece(opening.tex + left + inside[0].tex, depth, product=bool(own))
            inside[-1] = replace(inside[-1], tex=inside[-1].tex + right + term.tail)
            own += inside
        own[0] = Piece(sign + own[0].tex, depth)
        found += own
    return found


@dataclass(frozen=True)
class Limits:
    """What a line may hold: its width, less ``tag`` in the last one, in points."""

    line: float
    tag: float = 0.0


_LINE_COST, _DEPTH_COST, _PRODUCT_COST, _RAGGED_COST = 400.0, 150.0, 900.0, 60.0
_INDENTS = ("", r"\quad", r"\qquad")


def _start(piece: Piece) -> str:
    """What a line that begins with this piece puts before it."""
    indent = _INDENTS[min(piece.depth + piece.product, len(_INDENTS) - 1)]
    return indent + (r"\times " if piece.product else "")


def break_lines(items: Sequence[Piece], limits: Limits) -> list[str]:
    r"""Fill lines with pieces so that none is wider than allowed; the cheapest such filling.

    A piece that is too wide by itself gets a line of its own.

    >>> items = [Piece("s", 0), Piece("+s", 0), Piece("+s", 0)]
    >>> break_lines(items, Limits(30.0))
    ['s+s', '+s']
    """
    # A factor follows a fraction or a bracket, after which TeX may leave a thin space.
    widths = [width(item.tex) + (_THIN if item.product else 0.0) for item in items]
    n = len(items)
    best: list[tuple[float, int]] = [(0.0, 0)] + [(float("inf"), 0)] * n
    for start in range(n):
        if best[start][0] == float("inf"):
            continue
        for end, cost in _line_costs(items, widths, start, limits):
            if best[start][0] + cost < best[end][0]:
                best[end] = (best[start][0] + cost, start)
    cuts = [n]
    while cuts[-1]:
        cuts.append(best[cuts[-1]][1])
    cuts.reverse()
    return [
        (_start(items[a]) if a else "") + "".join(item.tex for item in items[a:b])
        for a, b in pairwise(cuts)
    ]


def _line_costs(
    items: Sequence[Piece], widths: Sequence[float], start: int, limits: Limits
) -> Iterator[tuple[int, float]]:
    """Each (end, cost) of a line of pieces ``start`` … ``end − 1``."""
    first = items[start]
    # Together, for TeX leaves space after the sign that the line may begin with.
    used = width(_start(first) + first.tex) if start else widths[0]
    base = _LINE_COST
    if start:
        base += _DEPTH_COST * first.depth**2 + _PRODUCT_COST * first.product
    for end in range(start + 1, len(items) + 1):
        used += widths[end - 1] if end > start + 1 else 0.0
        last = end == len(items)
        room = limits.line - (limits.tag if last else 0.0)
        if used > room:
            excess = used - room
            if end == start + 1:
                yield end, base + 1e6 * (1.0 + excess)
            elif used > limits.line:
                return
            continue
        slack = 0.0 if last else (room - used) / room
        yield end, base + _RAGGED_COST * slack**2
