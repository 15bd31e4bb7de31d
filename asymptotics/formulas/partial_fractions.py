r"""Partial fractions whose poles are those of the cotangents.

What is taken apart is A(c)/∏ Ψ_q(c)^{m_q}, c = κ₁, into

.. math:: \sum_{q, m} κ_q^m \, p_{q,m}(κ_1) + p_1(κ_1), \qquad \deg p_{q,m} < φ(q).

**Half the degree.** Cotangents are odd in c, so even and odd parts go separately: with
f = c^σ g(c²) everything happens in u = c². There κ_q = c K_q(u), Ψ_q is a polynomial of degree
φ(q)/2 (u for q = 2), and κ_q^m κ_1^i is c^σ u^h K_q^m times a power of u below that degree.

**Local parts.** Of g only its principal part at each Ψ_q is kept, a polynomial modulo a power of
Ψ_q, and its polynomial part. Taken in descending q, the leading coefficient of the principal part
at Ψ_q is p_{q,m}; what κ_q^m p_{q,m} has at the divisors of q, and at infinity, is taken off there.
Principal parts have the degree of a few Ψ_q, the numerator A has that of all of them together. What
does not depend on A, inverses above all, is computed once.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, lru_cache

from flint import fmpq_poly, fmpz_poly

from asymptotics.rings.cotangent import Poles, cotangent_powers, resonance_polynomial

Monomial = tuple[int, int, int]
"""(q, m, i) for κ_q^m κ₁^i; i = 0 when q = 1, and (1, 0, 0) for 1."""

Piece = tuple[list[Monomial], list[int], int]
"""Monomials, their integer coefficients, and the denominator of them all."""

_ONE = fmpq_poly([1])


def partial_fractions(numerator: fmpz_poly, poles: Poles) -> Iterator[Piece]:
    """The cotangent form of A/∏ Ψ_q^{m_q}, q descending.

    >>> list(partial_fractions(fmpz_poly([-1, 0, 1]), (1,)))     # (c² − 1)/c = 2κ₂
    [([(2, 1, 0)], [2], 1)]
    """
    coefficients = numerator.coeffs()
    below = poles[0] if poles else 0
    for a in (0, 1):
        half = fmpq_poly(coefficients[a::2])
        if half:
            odd = (a + below) % 2
            orders = ((odd + below - a) // 2, *poles[1:]) if poles else ()
            yield from _parts(half, orders, odd)


def _parts(numerator: fmpq_poly, orders: Poles, odd: int) -> Iterator[Piece]:
    """The form of c^odd times numerator(u)/∏ Ψ_q^orders, c² = u."""
    tops = _tops(orders, odd)
    principal = {
        q: numerator % _power(q, top) * _cofactor(q, orders, top) % _power(q, top)
        for q, top in enumerate(tops, start=2)
        if top
    }
    regular = numerator // _denominator(orders)
    for q in sorted(principal, reverse=True):
        rest, psi = principal.pop(q), _psi(q)
        for order in range(tops[q - 2], 0, -1):
            m, i, h = _exponents(q, order, odd)
            leading = rest * _unit(q, m, h, order) % psi
            if leading:
                monomials = [(q, m, i + 2 * k) for k in range(leading.degree() + 1)]
                yield _piece(monomials, leading)
                rest = (rest - leading * _local(q, m, h, q, order)) % _power(q, order)
                for d in principal:
                    if q % d == 0:
                        known = leading * _local(q, m, h, d, tops[d - 2])
                        principal[d] = (principal[d] - known) % _power(d, tops[d - 2])
                shift = _half_degree(q) - 1
                regular = regular - (leading * _at_infinity(q, m, h, shift)).right_shift(shift)
            rest = rest // psi
    if regular:
        yield _piece([(1, 2 * k + odd, 0) for k in range(regular.degree() + 1)], regular)


def _piece(monomials: list[Monomial], coefficients: fmpq_poly) -> Piece:
    return monomials, [int(a) for a in coefficients.numer().coeffs()], int(coefficients.denom())


@lru_cache(maxsize=4096)
def _tops(orders: Poles, odd: int) -> Poles:
    """The order of the pole at each Ψ_q that the cotangents of its multiples may raise it to."""
    tops = list(orders)
    for q in range(len(orders) + 1, 2, -1):
        for d in range(3, q // 2 + 1):
            if q % d == 0:
                tops[d - 2] = max(tops[d - 2], tops[q - 2])
        if q % 2 == 0:
            tops[0] = max(tops[0], (tops[q - 2] + odd) // 2)
    return tuple(tops)


def _exponents(q: int, order: int, odd: int) -> tuple[int, int, int]:
    """(m, i, h): c^odd times a pole of this order in u is κ_q^m κ₁^i = c^odd u^h K_q^m."""
    if q == 2:
        return 2 * order - odd, 0, order - odd
    i = (order + odd) % 2
    return order, i, (order + i - odd) // 2


def _half_degree(q: int) -> int:
    return int(_psi(q).degree())


# -- what does not depend on the numerator ---------------------------------------------------------


@cache
def _psi(q: int) -> fmpq_poly:
    """Ψ_q in u; u itself, the square of Ψ₂, for q = 2."""
    return fmpq_poly([0, 1] if q == 2 else resonance_polynomial(q).coeffs()[::2])


@cache
def _power(q: int, exponent: int) -> fmpq_poly:
    return _psi(q) ** exponent


@lru_cache(maxsize=4096)
def _denominator(orders: Poles) -> fmpq_poly:
    product = _ONE
    for q, order in enumerate(orders, start=2):
        product = product * _power(q, order)
    return product


@lru_cache(maxsize=1 << 16)
def _cofactor(q: int, orders: Poles, top: int) -> fmpq_poly:
    """Ψ_q^top/∏ Ψ^orders modulo Ψ_q^top: the numerator times this is the principal part."""
    modulus = _power(q, top)
    product = _power(q, top - orders[q - 2])
    for other, order in enumerate(orders, start=2):
        if order and other != q:
            product = product * _inverse_power(other, order, q, top) % modulus
    return product


@cache
def _inverse_power(other: int, exponent: int, q: int, top: int) -> fmpq_poly:
    """Ψ_other^{−exponent} modulo Ψ_q^top."""
    modulus = _power(q, top)
    if exponent == 1:
        return _inverse(_psi(other), modulus)
    before = _inverse_power(other, exponent - 1, q, top)
    return before * _inverse_power(other, 1, q, top) % modulus


def _inverse(a: fmpq_poly, modulus: fmpq_poly) -> fmpq_poly:
    return (a % modulus).xgcd(modulus)[1] % modulus


@cache
def _cotangent(q: int) -> tuple[fmpq_poly, tuple[int, ...]]:
    """K_q = κ_q/c as a numerator and the q's of the factors Ψ_q below it."""
    p, full = cotangent_powers(q)
    return fmpq_poly(p.coeffs()[q % 2 :: 2]) / full.content(), tuple(
        d for d in range(2, q + 1) if q % d == 0
    )


@cache
def _local(q: int, m: int, h: int, d: int, top: int) -> fmpq_poly:
    """Ψ_d^top u^h K_q^m modulo Ψ_d^top, for d = q or a divisor of q."""
    above, factors = _cotangent(q)
    modulus = _power(d, top)
    product = _power(d, top - (m - h if d == 2 else m)) * (above**m % modulus) % modulus
    for factor in factors:
        if factor not in (2, d):
            product = product * _inverse_power(factor, m, d, top) % modulus
    if d == 2:
        return product
    exponent = h - m * (2 in factors)  # of u
    power = _power(2, exponent) if exponent >= 0 else _inverse_power(2, -exponent, d, top)
    return product * power % modulus


@cache
def _unit(q: int, m: int, h: int, order: int) -> fmpq_poly:
    """What turns the leading part of the pole into p_{q,m}: 1/(Ψ_q^order u^h K_q^m) modulo Ψ_q."""
    return _inverse(_local(q, m, h, q, order), _psi(q))


@cache
def _at_infinity(q: int, m: int, h: int, shift: int) -> fmpq_poly:
    """The polynomial part of u^{h + shift} K_q^m."""
    above, factors = _cotangent(q)
    below = _ONE
    for factor in factors:
        below = below * _psi(factor)
    return above**m * _power(2, h + shift) // below**m
