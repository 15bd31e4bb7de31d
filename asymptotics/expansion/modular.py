r"""The exact ring at a random point modulo a random prime.

Reduction modulo p, with Ω and c = cot Ω replaced by numbers, maps :math:`ℤ[Ω, c, 1/d, 1/Ψ_q]` to
the integers modulo p and respects sums and products. So the engine over the image yields the image
of what it yields over the exact ring, at the price of small integers. An element that is not zero
has the image zero with a probability below (its degree)/p plus (the digits of its coefficients)/18
over the number of primes to choose from, about 2⁵⁵: an equation that holds at the point is false
with less than 10⁻¹⁰. Point and prime are drawn anew each time, so nothing can be made to fit them.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from random import SystemRandom

from flint import fmpz

from asymptotics.expansion.images import image_of_expansion, image_of_problem
from asymptotics.expansion.order_loop import Expansion, Order, expand
from asymptotics.problems.problem import Problem
from asymptotics.rings.cotangent import CotangentElement, resonance_polynomial

_BITS = 61

Orders = tuple[Order[int], ...]


class ModularRing:
    """Integers modulo a prime; products are reduced when they are summed.

    >>> ring = ModularRing(7)
    >>> ring.sum([ring.rational(1, 2) * 2, 6])
    0
    """

    even = True
    zero = 0
    one = 1

    def __init__(self, prime: int) -> None:
        self.prime = prime

    def rational(self, numerator: int, denominator: int = 1) -> int:
        """numerator/denominator modulo the prime."""
        return numerator * pow(denominator, -1, self.prime) % self.prime

    def sum(self, terms: Iterable[int]) -> int:
        """Σ terms, reduced."""
        return sum(terms) % self.prime

    def conjugate(self, element: int) -> int:
        """The element itself."""
        return element

    def is_zero(self, element: int) -> bool:
        """Divisible by the prime."""
        return element % self.prime == 0


class ModularPoint:
    """A value of Ω and one of c, and the prime they are taken modulo; random by default.

    >>> from asymptotics.rings.cotangent import CotangentRing
    >>> ring, point = CotangentRing(), ModularPoint(101, omega=5, c=7)
    >>> point.value(ring.omega * ring.cot(2))       # 5 (7² − 1)/(2 · 7)
    46
    >>> 46 * 14 % 101 == 5 * 48 % 101
    True
    """

    def __init__(
        self, prime: int | None = None, omega: int | None = None, c: int | None = None
    ) -> None:
        random = SystemRandom()
        self.prime = _random_prime(random) if prime is None else prime
        self.ring = ModularRing(self.prime)
        self.omega = random.randrange(self.prime) if omega is None else omega
        self.c = random.randrange(self.prime) if c is None else c
        self._powers = cache(lambda x, k: pow(x, k, self.prime))
        self._below = cache(self._resonance)

    def value(self, element: CotangentElement) -> int:
        """The element's image.

        Raises
        ------
        ZeroDivisionError
            Its denominator is zero there.
        """
        return self.value_of(
            ((int(a), int(i), int(v)) for (a, i), v in element.numerator.terms()),
            element.denominator,
            element.poles,
        )

    def value_of(
        self, terms: Iterable[tuple[int, int, int]], denominator: int, poles: Iterable[int]
    ) -> int:
        """The same of Σ v Ω^a c^i over d ∏ Ψ_q^{m_q}, given as (a, i, v), d and (m₂, m₃, …)."""
        prime, powers = self.prime, self._powers
        above = sum(v * powers(self.omega, a) % prime * powers(self.c, i) for a, i, v in terms)
        below = denominator % prime
        for q, power in enumerate(poles, start=2):
            if power:
                below = below * powers(self._below(q), power) % prime
        if below == 0:
            raise ZeroDivisionError("the denominator is zero at the point")
        return above * pow(below, -1, prime) % prime

    def _resonance(self, q: int) -> int:
        total = 0
        for coefficient in reversed(resonance_polynomial(q).coeffs()):
            total = (total * self.c + int(coefficient)) % self.prime
        return total


def _random_prime(random: SystemRandom) -> int:
    while True:
        candidate = random.getrandbits(_BITS) | 1 << _BITS | 1
        if fmpz(candidate).is_prime():
            return candidate


def engine_image(problem: Problem[CotangentElement], point: ModularPoint, order: int) -> Orders:
    """What the engine yields at the point, order by order."""
    return expand(image_of_problem(problem, point.ring, point.value), order).orders


def wrong_tails(expansion: Expansion[CotangentElement]) -> tuple[int, ...]:
    """The orders whose tails, from which :func:`expand` continues, are not the engine's.

    With less than 10⁻¹⁰ probability a wrong one is not found, see the module's docstring.

    >>> from asymptotics import exact_string
    >>> wrong_tails(expand(exact_string(), 4))
    ()
    """
    point = ModularPoint()
    found = image_of_expansion(expansion, point.ring, point.value).orders
    known = engine_image(expansion.problem, point, expansion.order)
    pairs = enumerate(zip(found, known, strict=True), start=1)
    return tuple(n for n, (saved, engine) in pairs if saved.tails != engine.tails)
