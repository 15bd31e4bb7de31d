r"""Finite Fourier series in the phase θ, with coefficients in a ring.

A real series :math:`\sum_j c_j e^{ij\theta}` is stored as ``{j: c_j}`` for j ≥ 0 only; the other
half is the reflection :math:`c_{-j} = \overline{c_j}`. A time-even problem has
:math:`\overline{c} = c`, so the series is :math:`c_0 + \sum_{j>0} 2 c_j \cos j\theta`.

Several drive frequencies need no other code: a tuple of indices packed into one integer,
:func:`pack`, adds and reflects like the tuple.

>>> from asymptotics.rings.ring import E, FloatRing
>>> terms = {}
>>> multiply_into(terms, {1: 0.5}, {1: 0.5}, FloatRing())   # cos² θ
>>> collect(terms, FloatRing())                             # 1/2 + cos(2θ)/2
{2: 0.25, 0: 0.5}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from asymptotics.rings.ring import E, Ring

Harmonics = dict[int, E]
Terms = dict[int, list[E]]

# Half the width of one digit of a packed index: a bound on |j| for each drive frequency.
_DIGIT = 1 << 20


def pack(indices: Sequence[int]) -> int:
    """One integer for a tuple of harmonic indices, additive and odd in the tuple.

    >>> pack((2, -1)) + pack((-1, 3)) == pack((1, 2)), -pack((2, -1)) == pack((-2, 1))
    (True, True)
    """
    packed = 0
    for index in indices:
        packed = packed * 2 * _DIGIT + index
    return packed


def unpack(packed: int, count: int) -> tuple[int, ...]:
    """The tuple of ``count`` indices that :func:`pack` made into one integer.

    >>> unpack(pack((2, -1)), 2)
    (2, -1)
    """
    indices = []
    for _ in range(count - 1):
        index = (packed + _DIGIT) % (2 * _DIGIT) - _DIGIT
        indices.append(index)
        packed = (packed - index) // (2 * _DIGIT)
    return (packed, *reversed(indices))


def multiply_into(
    terms: Terms[E], left: Mapping[int, E], right: Mapping[int, E], ring: Ring[E]
) -> None:
    """Add the products that make up ``left · right`` to ``terms``, unsummed.

    The products stay in lists so that the ring may add all of them at once (:func:`collect`).
    Where reflection is trivial, one ring product serves both e^{i(a+b)θ} and e^{i(a−b)θ}.
    """
    for a, x in left.items():
        for b, y in right.items():
            product = x * y
            terms.setdefault(a + b, []).append(product)
            if a == 0 or b == 0:
                continue
            if not ring.even:
                product = x * ring.conjugate(y)
            if a > b:
                terms.setdefault(a - b, []).append(product)
            elif a < b:
                terms.setdefault(b - a, []).append(ring.conjugate(product))
            else:
                terms.setdefault(0, []).extend((product, ring.conjugate(product)))


def both_sides(harmonics: Mapping[int, E], ring: Ring[E]) -> Harmonics[E]:
    """A real series with its reflected half written out: ``{j: c_j}`` for all j.

    >>> from asymptotics.rings.ring import ComplexRing
    >>> both_sides({0: 1 + 0j, 2: 3 - 1j}, ComplexRing())
    {0: (1+0j), 2: (3-1j), -2: (3+1j)}
    """
    return dict(harmonics) | {-j: ring.conjugate(c) for j, c in harmonics.items() if j}


def folded(harmonics: Mapping[int, E], ring: Ring[E]) -> Harmonics[E]:
    """The real series f + f̄ of a complex one given on both sides, stored as real ones are.

    >>> from asymptotics.rings.ring import ComplexRing
    >>> folded({1: 2j, -1: 5 + 1j, 0: 1 + 1j}, ComplexRing())
    {1: (5+1j), 0: (2+0j)}
    """
    terms: Terms[E] = {}
    for j, c in harmonics.items():
        terms.setdefault(abs(j), []).append(c if j >= 0 else ring.conjugate(c))
        if j == 0:
            terms[0].append(ring.conjugate(c))
    return collect(terms, ring)


def convolve_into(terms: Terms[E], left: Mapping[int, E], right: Mapping[int, E]) -> None:
    """As :func:`multiply_into` for complex series, given on both sides."""
    for a, x in left.items():
        for b, y in right.items():
            terms.setdefault(a + b, []).append(x * y)


def collect(terms: Terms[E], ring: Ring[E], factor: E | None = None) -> Harmonics[E]:
    """Sum the products of each harmonic, times ``factor``; harmonics that vanish are left out."""
    out = {}
    for j, products in terms.items():
        if factor is not None:
            products = [factor * product for product in products]
        total = ring.sum(products)
        if not ring.is_zero(total):
            out[j] = total
    return out


def reachable(drive: Sequence[int], order: int) -> set[int]:
    """Harmonics j ≥ 0 that products of exactly ``order`` drive harmonics can excite.

    >>> sorted(reachable([1], 5))
    [1, 3, 5]
    """
    signed = {sign * j for j in drive for sign in (1, -1)}
    indices = {0}
    for _ in range(order):
        indices = {i + j for i in indices for j in signed}
    return {i for i in indices if i >= 0}
