r"""The leading singular part of the contact point at pπ/q, exact.

The unchanged engine over :class:`~asymptotics.laurent.LaurentRing` gives, at Ω = pπ/q + μ and order
N = qn, ξ_c ≈ 1 + ε^{qn} μ^{−(2n−1)} Σ_k a_{kq} cos kqθ.

**Which μ.** The resonance is centred where the non-resonant motion has the rotation number 2pπ/q,
at μ = γε² + O(ε⁴), not at μ = 0 (:func:`centre_shift`). In powers of ε²/μ that shift is weaker than
the pendulum (:mod:`asymptotics.pendulum`) for q ≤ 3, equally strong at q = 4, and stronger for
q ≥ 5, where the expansion in μ has at order qn, n ≥ 2, poles that are the shift's, and worse ones
at the orders before. For q ≥ 5 and n ≥ 2 the law is therefore that of the leading singular part in
μ_eff = μ − γε²; ``variable`` says which.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from flint import fmpq

from asymptotics.errors import InputError
from asymptotics.expansion import Expansion, check_order, expand
from asymptotics.laurent import LaurentElement, LaurentRing, PrecisionError
from asymptotics.pendulum import coefficient
from asymptotics.problem import string
from asymptotics.resonance_field import ONE, C, Coefficient, ResonanceField, check_resonance


@dataclass(frozen=True)
class SingularPart:
    """The leading singular part of ξ_c at Ω = pπ/q, exact.

    Attributes
    ----------
    p, q
        The resonance.
    order
        N = qn, the order in ε.
    pole
        E = 2n − 1: it grows like μ^{−E}.
    variable
        ``"mu"``, or ``"mu_eff"`` = μ − γε² where q ≥ 5 and n ≥ 2.
    harmonics
        ``{j: a_j}``, ξ_c ≈ 1 + ε^N μ^{−E} Σ a_j cos jθ, the a_j in ``field``.
    """

    p: int
    q: int
    order: int
    pole: int
    variable: str
    harmonics: Mapping[int, Coefficient]
    field: ResonanceField

    @property
    def exponent(self) -> Fraction:
        """(2n − 1)/(qn)."""
        return Fraction(self.pole, self.order)

    def text(self) -> dict[int, str]:
        """The a_j as text that SymPy parses."""
        return {j: self.field.text(a) for j, a in self.harmonics.items()}

    def values(self) -> dict[int, float]:
        """The a_j as floats, correctly rounded but for the last bit."""
        return {j: float(self.field.value(a)) for j, a in self.harmonics.items()}


def laurent_expansion(p: int, q: int, order: int, terms: int = 1) -> Expansion[LaurentElement]:
    """The string's expansion in ε̂ over Laurent series in μ, ``terms`` coefficients each.

    >>> laurent_expansion(1, 2, order=2).contact(2)[2]    # half of −(π/2)³/8 cot 2Ω
    (-1/256*pi^3)*mu^-1 + O(mu^0)
    """
    ring = LaurentRing(p, q, terms)
    return expand(string(ring, ring.omega, ring.cot, name=f"string near {p}/{q}"), order)


def amplitudes(expansion: Expansion[LaurentElement], n: int) -> dict[int, LaurentElement]:
    """``{j: a_j(μ)}`` of ε^{qn} cos jθ in ξ_c, as Laurent series in μ."""
    ring = expansion.problem.ring
    assert isinstance(ring, LaurentRing)
    out = {}
    for j, element in expansion.contact(n * ring.q).items():
        series = element if j == 0 else element * ring.rational(2)
        for _ in range(n):
            series = ring.sum([series * ring.cosecant_power])
        out[j] = series
    return out


@lru_cache(maxsize=64, typed=True)
def singular_part(p: int, q: int, order: int) -> SingularPart:
    """The leading singular part that the expansion through ``order`` has at pπ/q.

    Raises
    ------
    InputError
        p/q not in lowest terms, ``order`` not a whole number ≥ 1, or q > ``order``.

    Examples
    --------
    Eq. (expandw2): 2a_j/(jΩ₀) = (−)^p (pπ)⁴/(32 j).

    >>> singular_part(1, 1, 3).text(), singular_part(1, 1, 3).exponent
    ({1: '-pi**5/64', 3: '-pi**5/64'}, Fraction(5, 3))
    """
    check_resonance(p, q)
    n = check_order(order) // q
    if n == 0:
        raise InputError(
            f"order = {order} has no pole at p/q = {p}/{q}: the resonance enters at order q; give "
            f"an order ≥ {q}"
        )
    if q >= 5 and n >= 2:
        return _pendulum_part(singular_part(p, q, q), n)
    terms = 1
    while True:
        series = amplitudes(laurent_expansion(p, q, q * n, terms), n)
        try:
            harmonics = _leading(series, 2 * n - 1)
            break
        except PrecisionError:
            terms *= 2
    foreign = [j for j in harmonics if j % q or j == 0]
    if not harmonics or foreign:
        raise ArithmeticError(
            f"the leading part at {p}/{q}, order {q * n}, has harmonics {sorted(harmonics)}; "
            f"expected multiples of {q}"
        )
    field = ResonanceField(p, q)
    return SingularPart(p, q, q * n, 2 * n - 1, "mu", harmonics, field)


def _leading(series: Mapping[int, LaurentElement], pole: int) -> dict[int, Coefficient]:
    """The non-zero coefficients of μ^{−pole}; nothing may be more singular."""
    worst = min((a.valuation for a in series.values() if a.coefficients), default=-pole)
    if worst < -pole:
        raise ArithmeticError(f"a pole of order {-worst} where {pole} was expected")
    found = {j: a.coefficient(-pole) for j, a in sorted(series.items())}
    return {j: a for j, a in found.items() if not a.is_zero()}


def _pendulum_part(first: SingularPart, n: int) -> SingularPart:
    """Ω₀^{n−1} a₁^n A_{n,k}: order qn in the variable μ_eff."""
    field, q = first.field, first.q
    power = field.centre ** (n - 1)
    for _ in range(n):
        power = field.reduce(power * first.harmonics[q])
    harmonics = {}
    for k in range(n % 2 or 2, n + 1, 2):
        value = coefficient(n, k)
        harmonics[k * q] = power * fmpq(value.numerator, value.denominator)
    return SingularPart(first.p, q, q * n, 2 * n - 1, "mu_eff", harmonics, field)


def pole_orders(p: int, q: int, order: int) -> tuple[int, ...]:
    """Order of the pole in μ of ε^m in ξ_c, for m = 1 … ``order``; 0 where it is regular.

    The expansion cut off at ``order`` loses its ordering first where pole/m is largest: at the
    multiples of q for q ≤ 4, elsewhere for larger q.

    >>> pole_orders(1, 2, 4), pole_orders(1, 5, 10)
    ((0, 1, 0, 3), (0, 0, 0, 0, 1, 1, 2, 2, 3, 3))
    """
    check_resonance(p, q)
    extra = 1 if q == 1 else 0  # ε̂ = ε/sin Ω has a pole of its own
    terms, out = 1, list[int]()
    expansion = laurent_expansion(p, q, check_order(order), terms)
    while len(out) < order:
        contact = expansion.contact(len(out) + 1).values()
        # valuation is where the known coefficients begin, or where the O-term does.
        lowest = min(a.valuation for a in contact)
        if all(a.coefficients or a.valuation > min(lowest, 0) for a in contact):
            out.append(max(extra * (len(out) + 1) - lowest, 0))
            continue
        terms *= 2
        expansion = laurent_expansion(p, q, order, terms)
    return tuple(out)


def centre_shift(p: int, q: int) -> Coefficient:
    r"""γ of the resonance's centre μ = γε² + O(ε⁴), for q ≥ 2.

    Half the rotation number of the non-resonant motion is Ω − γ(Ω) ε² + O(ε⁴) with

    .. math:: γ = \frac{Ω^3 (1 + 2Ω \cot Ω)}{16 \sin^2 Ω},

    which follows from the mean height to second order, and is what makes the simple pole of
    ξ_{q,q} a double one in ξ_{q+2,q}.

    Raises
    ------
    InputError
        q = 1, where γ has a pole, or p/q not in lowest terms.

    >>> ResonanceField(1, 2).text(centre_shift(1, 2))
    'pi**3/128'
    """
    field = ResonanceField(p, q)
    if q == 1:
        raise InputError(
            f"p/q = {p}/1: the shift is singular there and belongs to the pendulum; give q ≥ 2"
        )
    shift = field.centre**3 * (ONE + 2 * field.centre * C) * (ONE + C * C) / 16
    return field.reduce(shift)
