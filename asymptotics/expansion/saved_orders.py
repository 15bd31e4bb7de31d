r"""Orders of an expansion as text, and back: nothing that is read is taken on trust.

An order of the exact ring is JSON: Fourier series as objects, an element
:math:`\sum v\, Ω^a c^i / (d ∏ Ψ_q^{m_q})` as ``[d, [m₂, m₃, …], [[a, i, v], …]]``. Reading is
bounded in time and memory, whatever the file holds: what is compressed is inflated up to
:func:`largest_size` and no further, and only whole numbers, strings, arrays and objects of the one
form are let through. Everything else is a :class:`ValueError` that says what was found.
"""

from __future__ import annotations

import gzip
import json
import re
import zlib
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from asymptotics.expansion.order_loop import Order
from asymptotics.rings.cotangent import CotangentElement
from asymptotics.rings.harmonics import Harmonics
from asymptotics.rings.ring import Element

F = TypeVar("F", bound=Element)

Terms = list[tuple[int, int, int]]
Make = Callable[[Terms, int, tuple[int, ...]], F]
"""From the terms (a, i, v), the denominator d and the exponents (m₂, m₃, …)."""

_INDEX = re.compile(r"0|[1-9][0-9]{0,8}")
_GZIP = 16 + zlib.MAX_WBITS


def largest_size(highest: int) -> int:
    """Bytes of an order whose highest harmonic this is, some three times what it takes.

    Measured, in kB: 1, 22, 265, 1,898 and 9,455 for orders 4, 8, 12, 16 and 20 of the string.

    >>> [largest_size(n) // 1000 for n in (4, 8, 12, 16, 20)]
    [65, 117, 961, 6776, 32065]
    """
    return 65536 + highest**7 // 40


def packed(content: dict[str, Any]) -> bytes:
    """The content as a compressed file, the same bytes every time."""
    return gzip.compress(json.dumps(content, separators=(",", ":")).encode(), 6, mtime=0)


def unpacked(data: bytes, limit: int) -> Any:
    """What a compressed file says.

    Raises
    ------
    ValueError
        It is not one gzip member, or is larger than ``limit``, or not JSON without repeated keys,
        fractions, NaN and infinities, or nested too deeply.

    Examples
    --------
    >>> unpacked(packed({"n": 1}), 100)
    {'n': 1}
    """
    inflate = zlib.decompressobj(_GZIP)
    try:
        text = inflate.decompress(data, limit + 1)
    except zlib.error as error:
        raise ValueError(f"it is not compressed as it should be ({error})") from error
    if len(text) > limit:
        raise ValueError(f"it holds more than {limit} bytes, which no such order does")
    if not inflate.eof or inflate.unused_data:
        raise ValueError("it is cut off" if not inflate.eof else "something follows its end")
    try:
        return json.loads(
            text.decode(), object_pairs_hook=_object, parse_float=_refuse, parse_constant=_refuse
        )
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _refuse(literal: str) -> Any:
    raise ValueError(f"it holds {literal[:20]}, which is not a whole number")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("it names something twice")
    return found


def fields(data: Any, names: Iterable[str], what: str) -> dict[str, Any]:
    """An object with exactly these names."""
    if not isinstance(data, dict) or data.keys() != set(names):
        found = ", ".join(sorted(data)[:9]) if isinstance(data, dict) else type(data).__name__
        raise ValueError(f"{what} should have {', '.join(names)}, not {found[:200]}")
    return data


def order_to(order: Order[CotangentElement]) -> dict[str, Any]:
    """An order as plain data."""
    return {
        "contact": _harmonics_to(order.contact),
        "shape": {str(j): [_element_to(d) for d in start] for j, start in order.shape.items()},
        "tails": [[_harmonics_to(tail) for tail in chain] for chain in order.tails],
    }


def order_from(data: Any, make: Make[F]) -> Order[F]:
    """An order from plain data, its elements made by ``make``.

    Raises
    ------
    ValueError
        The data have not the form of an order; what ``make`` raises.
    """
    parts = fields(data, ("contact", "shape", "tails"), "an order")
    return Order(
        contact=_harmonics_from(parts["contact"], make),
        shape={
            _index(j): tuple(_element_from(d, make) for d in _array(start, "a harmonic"))
            for j, start in _mapping(parts["shape"], "the shape").items()
        },
        tails=tuple(
            tuple(_harmonics_from(tail, make) for tail in _array(chain, "a chain of tails"))
            for chain in _array(parts["tails"], "the tails")
        ),
    )


def _harmonics_to(harmonics: Harmonics[CotangentElement]) -> dict[str, Any]:
    return {str(j): _element_to(c) for j, c in sorted(harmonics.items())}


def _harmonics_from(data: Any, make: Make[F]) -> Harmonics[F]:
    series = _mapping(data, "a Fourier series")
    return {_index(j): _element_from(c, make) for j, c in series.items()}


def _element_to(element: CotangentElement) -> list[Any]:
    form = element.canonical()
    terms = [[int(a), int(i), int(v)] for (a, i), v in form.numerator.terms()]
    return [form.denominator, list(form.poles), terms]


def _element_from(data: Any, make: Make[F]) -> F:
    parts = _array(data, "a coefficient")
    if len(parts) != 3:
        raise ValueError(f"a coefficient has 3 parts, not {len(parts)}")
    denominator, poles, terms = parts
    rows = [_term(term) for term in _array(terms, "a numerator")]
    return make(rows, denominator, tuple(_array(poles, "the poles")))


def _term(data: Any) -> tuple[int, int, int]:
    if not isinstance(data, list) or len(data) != 3:
        raise ValueError("a term should be [a, i, v]")
    a, i, v = data
    return a, i, v


def _index(text: str) -> int:
    if not _INDEX.fullmatch(text):
        raise ValueError(f"{text[:20]!r} is not the index of a harmonic")
    return int(text)


def _array(data: Any, what: str) -> list[Any]:
    if not isinstance(data, list):
        raise ValueError(f"{what} should be an array, not {type(data).__name__}")
    return data


def _mapping(data: Any, what: str) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise ValueError(f"{what} should be an object, not {type(data).__name__}")
    return data
