"""The coefficient rings the engine runs over.

The engine adds, multiplies and scales by rationals; it never divides and never simplifies. So any
commutative ring that contains the rationals will do, and the ring decides what comes out:

======================  =========================================================================
:class:`FloatRing`      numbers at one frequency, to high order
:class:`ComplexRing`    the same with damping, or with a drive that is not even in time
:class:`GeneratorRing`  polynomials in named quantities: closed forms of any problem
``BoundedRing``         doubles, or arrays of them, that bound their own errors (``rings.bounded``)
``ArbRing``             certified enclosures, real or (``AcbRing``) complex (``rings.balls``)
``CotangentRing``       closed forms, exact in Ω (``rings.cotangent``)
======================  =========================================================================

A new ring implements :class:`Ring`, and nothing else has to change.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from asymptotics.errors import InputError
from asymptotics.rings.pickling import register

register()


class Element(Protocol):
    """What ring elements have in common: a product."""

    def __mul__(self, other: Any, /) -> Any:
        """The product in the ring."""


E = TypeVar("E", bound=Element)
F = TypeVar("F", bound=Element)


class Ring(Protocol[E]):
    """What the engine asks of its coefficients; elements also support ``*``.

    ``even`` says that :meth:`conjugate` is the identity: the state is even in time, which it is
    without damping when the drive is. It saves half the products.
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

    What an expansion over them loses to rounding nobody counts: :class:`BoundedRing
    <asymptotics.rings.bounded.BoundedRing>` does.

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
        if isinstance(element, float | complex):
            return element == 0.0
        return not element.any()


class ComplexRing:
    """Complex double precision numbers, or NumPy arrays of them.

    >>> ring = ComplexRing()
    >>> ring.conjugate(ring.sum([1j * ring.rational(1, 4), ring.one]))
    (1-0.25j)
    """

    even = False
    zero: Any = 0j
    one: Any = 1.0 + 0j

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        """numerator/denominator, rounded once."""
        return complex(numerator / denominator)

    def sum(self, terms: Iterable[Any]) -> Any:
        """Σ terms, left to right."""
        return sum(terms, 0j)

    def conjugate(self, element: Any) -> Any:
        """The complex conjugate."""
        return element.conjugate()

    def is_zero(self, element: Any) -> bool:
        """Exact zero only."""
        return not (element.any() if hasattr(element, "any") else element)


class GeneratorRing:
    """ℚ[x₁, x₂, …]: polynomials in named generators, on which nothing else is known.

    Parameters
    ----------
    names
        The generators.
    conjugates
        ``{name: (sign, name)}`` of each generator that is not its own conjugate: x̄ = sign · y. It
        has to be an involution. Empty, the ring is even.

    Raises
    ------
    InputError
        Names that repeat, or conjugates that are no involution on them.

    Examples
    --------
    >>> ring = GeneratorRing(["a", "y", "y_"], {"y": (1, "y_"), "y_": (1, "y"), "a": (-1, "a")})
    >>> ring.conjugate(ring["a"] * ring["y"])
    -a*y_
    """

    def __init__(
        self, names: Sequence[str], conjugates: Mapping[str, tuple[int, str]] | None = None
    ) -> None:
        conjugates = conjugates or {}
        partner = [conjugates.get(name, (1, name)) for name in names]
        if len(set(names)) != len(names):
            raise InputError(f"generators {list(names)!r} repeat; give each name once")
        known = dict(zip(names, partner, strict=True))
        if not set(conjugates) <= set(names) or any(
            known.get(other) != (sign, name) for name, (sign, other) in known.items()
        ):
            raise InputError(
                f"conjugates {dict(conjugates)!r} are no involution of {list(names)!r}: whenever "
                "x ↦ (sign, y), also y ↦ (sign, x)"
            )
        self.names = tuple(names)
        self.even = not conjugates
        self._context = fmpq_mpoly_ctx.get(list(names), Ordering.lex)
        self._generators = dict(zip(names, self._context.gens(), strict=True))
        self._place = [self.names.index(name) for _, name in partner]
        self._odd = [i for i, (sign, _) in enumerate(partner) if sign < 0]
        self.zero: fmpq_mpoly = self._context.constant(0)
        self.one: fmpq_mpoly = self._context.constant(1)

    def __getitem__(self, name: str) -> fmpq_mpoly:
        """The generator of that name.

        Raises
        ------
        InputError
            There is none, as where a problem is expanded beyond the order it was made for.
        """
        try:
            return self._generators[name]
        except KeyError:
            raise InputError(
                f"there is no generator {name!r} among {', '.join(self.names)}; a problem over "
                "generators is made for an order: give that of the expansion"
            ) from None

    def evaluate(self, element: fmpq_mpoly, values: Mapping[str, F], ring: Ring[F]) -> F:
        """The polynomial at elements of another ring, one for each generator that occurs.

        Over doubles a polynomial that cancels loses digits without a word; over balls the result's
        radius says how many.

        >>> ring = GeneratorRing(["x", "y"])
        >>> half = ring["x"] * ring["y"] * ring.rational(1, 2)
        >>> ring.evaluate(half, {"x": 3.0, "y": 4.0}, FloatRing())
        6.0
        """
        products = []
        for powers, coefficient in element.terms():
            product = ring.rational(int(coefficient.p), int(coefficient.q))
            for name, power in zip(self.names, powers, strict=True):
                for _ in range(int(power)):
                    product = product * values[name]
            products.append(product)
        return ring.sum(products)

    def rational(self, numerator: int, denominator: int = 1) -> fmpq_mpoly:
        """A constant."""
        return self._context.constant(fmpq(numerator, denominator))

    def sum(self, terms: Iterable[fmpq_mpoly]) -> fmpq_mpoly:
        """Σ terms."""
        return sum(terms, self.zero)

    def conjugate(self, element: fmpq_mpoly) -> fmpq_mpoly:
        """Each generator replaced by its conjugate."""
        if self.even:
            return element
        terms = {}
        for powers, coefficient in element.terms():
            sign = -1 if sum(int(powers[i]) for i in self._odd) % 2 else 1
            terms[tuple(int(powers[i]) for i in self._place)] = sign * coefficient
        return self._context.from_dict(terms)

    def is_zero(self, element: fmpq_mpoly) -> bool:
        """Whether the polynomial vanishes; relations between the generators are not known to it."""
        return bool(element.is_zero())
