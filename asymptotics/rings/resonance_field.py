r"""The coefficients at a resonance: polynomials in π over the real field ℚ(c), c = cot(pπ/q).

For q = 1, 2, 4 the field is ℚ. In general c is a root of the resonance polynomial Ψ_q
(:func:`~asymptotics.rings.cotangent.resonance_polynomial`), or of that one of its factors over ℚ:
Ψ_q is irreducible unless 4 divides q, when it is a product of two. Reduced modulo the minimal
polynomial of c a coefficient is unique, because π is transcendental; so zero is seen exactly.
"""

from __future__ import annotations

from fractions import Fraction
from math import gcd

from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpq_poly, fmpz_poly

from asymptotics.errors import InputError
from asymptotics.rings.cotangent import cotangent_powers, resonance_polynomial
from asymptotics.rings.precision import at_precision

_CONTEXT = fmpq_mpoly_ctx.get(["pi", "c"], Ordering.lex)
PI, C = _CONTEXT.gens()

Coefficient = fmpq_mpoly
"""A polynomial in π and c."""


def constant(value: int | fmpq) -> Coefficient:
    """A rational number as a coefficient."""
    return _CONTEXT.constant(value)


ZERO, ONE = constant(0), constant(1)


def check_resonance(p: int, q: int) -> None:
    """An :class:`InputError` unless p/q is a resonance in lowest terms, p, q ≥ 1."""
    for name, value in (("p", p), ("q", q)):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise InputError(f"{name} = {value!r}; a resonance p/q has whole numbers p, q ≥ 1")
    common = gcd(p, q)
    if common > 1:
        raise InputError(
            f"p/q = {p}/{q} is not in lowest terms: the resonance Ω = pπ/q is "
            f"{p // common}/{q // common}; give that"
        )


class ResonanceField:
    """ℚ(c)[π] at Ω₀ = pπ/q.

    Raises
    ------
    InputError
        p/q is not in lowest terms.

    Examples
    --------
    >>> field = ResonanceField(1, 6)
    >>> field.minimal                        # cot(π/6) = √3
    x^2 + (-3)
    >>> field.reduce(field.cot(1) * field.cot(1)), field.cot(2)
    (3, 1/3*c)
    """

    def __init__(self, p: int, q: int) -> None:
        check_resonance(p, q)
        self.p, self.q = p, q
        self.minimal = _minimal_polynomial(p, q)
        self._modulus = embed(fmpq_poly(self.minimal))
        self.centre = PI * fmpq(p, q)

    def reduce(self, coefficient: Coefficient) -> Coefficient:
        """The coefficient modulo the minimal polynomial of c."""
        if coefficient.degrees()[1] < self.minimal.degree():
            return coefficient
        return divmod(coefficient, self._modulus)[1]

    def cot(self, j: int) -> Coefficient:
        """cot jΩ₀ = P_j/Q_j as a polynomial in c; q must not divide j, then Q_j is a unit."""
        above, below = (fmpq_poly(x) for x in cotangent_powers(j))
        modulus = fmpq_poly(self.minimal)
        return embed(above * (below % modulus).xgcd(modulus)[1] % modulus)

    def cosecant_power(self) -> Coefficient:
        r"""sin^{−q} Ω₀ = (−1)^p P_q(c), q ≥ 2, because sin^q Ω₀ (c + i)^q = (−1)^p.

        The field need not contain sin Ω₀ itself when q is even.
        """
        return self.reduce(embed(fmpq_poly(cotangent_powers(self.q)[0])) * (-1) ** self.p)

    def value(self, coefficient: Coefficient, bits: int = 128) -> arb:
        """An enclosure of a coefficient, with ``bits`` significant bits.

        >>> field = ResonanceField(1, 3)
        >>> field.value(field.centre).mid().str(15, radius=False)
        '1.04719755119660'
        """
        terms = list(self.reduce(coefficient).terms())
        if not terms:
            return arb(0)
        working = 2 * bits
        while True:  # a reduced coefficient is zero only without terms, so this ends
            with at_precision(working):
                pi, c = arb.pi(), _cot_pi(self.p, self.q) if self.q > 1 else arb(0)
                total = arb(0)
                for (a, i), r in terms:
                    total += arb(r) * pi ** int(a) * c ** int(i)
            if total.rel_accuracy_bits() >= bits:
                return total
            working *= 2

    def text(self, coefficient: Coefficient) -> str:
        """The coefficient as text that SymPy parses; c is written cot(p*pi/q).

        >>> field = ResonanceField(2, 3)
        >>> field.text(field.cot(1) * field.centre)
        '2*pi*cot(2*pi/3)/3'
        """
        angle = f"cot({'' if self.p == 1 else f'{self.p}*'}pi/{self.q})"
        out = ""
        for (a, i), r in coefficient.terms():
            value = Fraction(int(r.p), int(r.q))
            factors = [str(abs(value.numerator))] if abs(value.numerator) != 1 else []
            for name, power in (("pi", int(a)), (angle, int(i))):
                if power:
                    factors.append(name if power == 1 else f"{name}**{power}")
            term = "*".join(factors) or "1"
            if value.denominator != 1:
                term += f"/{value.denominator}"
            out += (" - " if value < 0 else " + ") + term
        if not out:
            return "0"
        return f"-{out[3:]}" if out.startswith(" - ") else out[3:]


def embed(poly: fmpq_poly) -> Coefficient:
    """A polynomial in c as a coefficient."""
    return _CONTEXT.from_dict({(0, i): a for i, a in enumerate(poly.coeffs()) if a})


def _minimal_polynomial(p: int, q: int) -> fmpz_poly:
    """The minimal polynomial of cot(pπ/q); for q = 1, where it is not used, c itself."""
    if q == 1:
        return fmpz_poly([0, 1])
    for bits in (64, 256, 1024, 4096):
        with at_precision(bits):
            root = _cot_pi(p, q)
            candidates = [
                factor
                for factor, _ in resonance_polynomial(q).factor()[1]
                if _at(factor, root).contains(0)
            ]
        if len(candidates) == 1:
            return candidates[0]
    raise ArithmeticError(f"no factor of the resonance polynomial of {q} isolates cot({p}π/{q})")


def _at(poly: fmpz_poly, x: arb) -> arb:
    total = arb(0)
    for a in reversed(poly.coeffs()):
        total = total * x + a
    return total


def _cot_pi(p: int, q: int) -> arb:
    return (arb(p) / q).cot_pi()
