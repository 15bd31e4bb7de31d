"""The coefficient rings the engine runs over.

The engine adds, multiplies and scales by rationals; it never divides and never simplifies. So any
commutative ring that contains the rationals will do, and the ring decides what comes out:

==============================  =================================================================
:class:`FloatRing`              numbers at one frequency, to high order
:class:`~asymptotics.cotangent.CotangentRing`  closed forms, exact in Ω
==============================  =================================================================

A new ring implements :class:`Ring`, and nothing else has to change.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol, TypeVar


class Element(Protocol):
    """What ring elements have in common: a product."""

    def __mul__(self, other: Any, /) -> Any:
        """The product in the ring."""


E = TypeVar("E", bound=Element)


class Ring(Protocol[E]):
    """What the engine asks of its coefficients; elements also support ``*``.

    ``even`` says that :meth:`conjugate` is the identity, which holds for every problem without
    damping (the state is even in time) and saves half the products.
    """

    even: bool

    @property
    def zero(self) -> E:
        """The neutral element of addition."""

    @property
    def one(self) -> E:
        """The neutral element of multiplication."""

    def rational(self, numerator: int, denominator: int = 1) -> E:
        """The image of a rational number."""

    def sum(self, terms: Iterable[E]) -> E:
        """Σ terms, in canonical form where the ring has one."""

    def conjugate(self, element: E) -> E:
        """The coefficient of e^{−ijθ} that belongs to ``element`` at e^{ijθ}."""

    def is_zero(self, element: E) -> bool:
        """Whether the element is exactly zero."""


class FloatRing:
    """Double precision numbers, or NumPy arrays of them (one entry a frequency).

    >>> ring = FloatRing()
    >>> ring.sum([ring.rational(1, 4), 0.5 * ring.one])
    0.75
    """

    even = True
    zero: Any = 0.0
    one: Any = 1.0

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        """numerator/denominator, rounded once."""
        return numerator / denominator

    def sum(self, terms: Iterable[Any]) -> Any:
        """Σ terms, left to right."""
        return sum(terms, 0.0)

    def conjugate(self, element: Any) -> Any:
        """The element itself: the state is even in time."""
        return element

    def is_zero(self, element: Any) -> bool:
        """Exact zero only; a small number is a number."""
        if isinstance(element, float):
            return element == 0.0
        return not element.any()
