"""Polynomials in generators as they are written: sums of products, sorted by some of them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import fmpq_mpoly

Powers = tuple[tuple[str, int], ...]
"""A product of generators: each name with its exponent > 0."""

Bracket = list[tuple[Fraction, Powers]]
"""Σ coefficient · product."""


def brackets(element: fmpq_mpoly, outside: Sequence[str]) -> list[tuple[Powers, Bracket]]:
    """Σ product · [bracket], the products in the generators ``outside``, highest powers first.

    >>> from asymptotics.rings.ring import GeneratorRing
    >>> ring = GeneratorRing(["s", "x", "S"])
    >>> half = ring.rational(1, 2)
    >>> for product, bracket in brackets(ring["S"] * (ring["S"] * ring["x"] ** 2 + half), ["S"]):
    ...     print(product, bracket)
    (('S', 2),) [(Fraction(1, 1), (('x', 2),))]
    (('S', 1),) [(Fraction(1, 2), ())]
    """
    names = element.context().names()
    found: dict[tuple[int, ...], Bracket] = {}
    for powers, coefficient in element.terms():
        count = {name: int(power) for name, power in zip(names, powers, strict=True)}
        key = tuple(count.pop(name) for name in outside)
        inside = tuple((name, power) for name, power in count.items() if power)
        value = Fraction(int(coefficient.p), int(coefficient.q))
        found.setdefault(key, []).append((value, inside))
    return [
        (tuple((name, n) for name, n in zip(outside, key, strict=True) if n), found[key])
        for key in sorted(found, reverse=True)
    ]
