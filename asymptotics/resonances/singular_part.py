r"""The leading singular part of the contact point at pπ/q, exact.

The unchanged engine over :class:`~asymptotics.rings.laurent.LaurentRing` gives, at Ω = pπ/q + μ and
order N = qn, ξ_c ≈ 1 + ε^{qn} μ^{−(2n−1)} Σ_k a_{kq} cos kqθ.

**Which μ.** The resonance is centred where the non-resonant motion has the rotation number 2pπ/q,
at μ = γε² + O(ε⁴), not at μ = 0 (:func:`centre_shift`). In powers of ε²/μ that shift is weaker than
the pendulum (:mod:`asymptotics.resonances.pendulum`) for q ≤ 3, equally strong at q = 4, and
stronger for q ≥ 5, where the expansion in μ has at order qn, n ≥ 2, poles that are the shift's, and
worse ones at the orders before. For q ≥ 5 and n ≥ 2 the law is therefore that of the leading
singular part in μ_eff = μ − γε²; ``variable`` says which.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from flint import fmpq

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.string import string_problem
from asymptotics.resonances.pendulum import coefficient
from asymptotics.rings.laurent import LaurentElement, LaurentRing, TruncationError
from asymptotics.rings.resonance_field import (
    ONE,
    ZERO,
    C,
    Coefficient,
    ResonanceField,
    check_resonance,
)

MOST_Q = 60
"""Seconds; the degree of the field ℚ(cot pπ/q) grows with q."""
MOST_MULTIPLE = 80
"""n of order qn: seconds; by then C is within 12 % of the limit law's, and creeps."""


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
    return expand(string_problem(ring, ring.omega, ring.cot, name=f"string near {p}/{q}"), order)


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


class _OneSidedRing(LaurentRing):
    """Laurent series of a state driven by e^{iθ} alone: nothing is reflected.

    At order n the harmonic e^{inθ} is made of the e^{imθ} of orders m < n only, since every
    reflected factor e^{−imθ} costs an order and lowers the harmonic. Leaving reflections out
    therefore leaves ξ_{n,n} as it is, and nothing but the ξ_{n,n} to compute.
    """

    even = False

    def conjugate(self, element: LaurentElement) -> LaurentElement:
        """Zero: the coefficient of e^{−ijθ}."""
        return self.zero


@lru_cache(maxsize=64, typed=True)
def singular_part(p: int, q: int, order: int) -> SingularPart:
    """The leading singular part that the expansion through ``order`` has at pπ/q.

    The pole a_q/μ of order q comes from the order loop, those of orders 2q, 3q, … from the
    pendulum; :func:`expanded_part` has them all from the order loop.

    Raises
    ------
    InputError
        p/q not in lowest terms, ``order`` not a whole number ≥ 1, q > ``order``, or numbers beyond
        what is useful: q > 60 or ``order`` ≥ 81q.

    Examples
    --------
    Eq. (expandw2): 2a_j/(jΩ₀) = (−)^p (pπ)⁴/(32 j).

    >>> singular_part(1, 1, 3).text(), singular_part(1, 1, 3).exponent
    ({1: '-pi**5/64', 3: '-pi**5/64'}, Fraction(5, 3))
    """
    n = _check_part(p, q, order)
    if n > 1:
        return _pendulum_part(singular_part(p, q, q), n)
    ring = _OneSidedRing(p, q, 1)
    expansion = expand(string_problem(ring, ring.omega, ring.cot, name=f"string near {p}/{q}"), q)
    harmonics = _leading(amplitudes(expansion, 1), 1)
    return SingularPart(p, q, q, 1, "mu", harmonics, ring.field)


def expanded_part(p: int, q: int, order: int) -> SingularPart:
    """:func:`singular_part` from the whole expansion, without the pendulum; q ≤ 4 where n ≥ 2.

    Raises
    ------
    InputError
        As :func:`singular_part`; or q ≥ 5 at order 2q and beyond, where worse poles than the
        pendulum's stand in the expansion in μ.

    Examples
    --------
    >>> expanded_part(1, 2, 4).text() == singular_part(1, 2, 4).text()
    True
    """
    n = _check_part(p, q, order)
    if q >= 5 and n >= 2:
        raise InputError(
            f"at p/q = {p}/{q}, order {order}, the leading part is one in mu_eff: use singular_part"
        )
    terms = 1
    while True:
        series = amplitudes(laurent_expansion(p, q, q * n, terms), n)
        try:
            harmonics = _leading(series, 2 * n - 1)
            break
        except TruncationError:
            terms *= 2
    return SingularPart(p, q, q * n, 2 * n - 1, "mu", harmonics, ResonanceField(p, q))


def _check_part(p: int, q: int, order: int) -> int:
    """n of the largest qn ≤ order."""
    check_resonance(p, q)
    n = check_order(order) // q
    if n == 0:
        raise InputError(
            f"order = {order} has no pole at p/q = {p}/{q}: the resonance enters at order q; give "
            f"an order ≥ {q}"
        )
    if q > MOST_Q:
        raise InputError(
            f"p/q = {p}/{q}: exact coefficients at this resonance are polynomials of a degree "
            f"near q in cot(p*pi/q), which takes minutes and fills pages; give q ≤ {MOST_Q}"
        )
    if n > MOST_MULTIPLE:
        raise InputError(
            f"order = {order}: certifying where {n} harmonics touch takes minutes, and the law is "
            f"next to its limit; give an order ≤ {q * MOST_MULTIPLE}, or use the limit law"
        )
    return n


def _leading(series: Mapping[int, LaurentElement], pole: int) -> dict[int, Coefficient]:
    """The non-zero coefficients of μ^{−pole}; nothing may be more singular."""
    worst = min((a.valuation for a in series.values() if a.coefficients), default=-pole)
    if worst < -pole:
        raise ArithmeticError(f"a pole of order {-worst} where {pole} was expected")
    found = {j: a.coefficient(-pole) for j, a in sorted(series.items())}
    return {j: a for j, a in found.items() if not a.is_zero()}


def _pendulum_part(first: SingularPart, n: int) -> SingularPart:
    """Order qn from a₁: Ω₀^{n−1} a₁^n A_{n,k} in μ_eff, which is μ for q ≤ 3.

    At q = 4 the law stays one in μ. There order 4n also collects (γε²/μ)^{2(n−i)} from the orders
    4i before it: μ_eff^{−e} = μ^{−e} Σ_l C(e + l − 1, l) (γε²/μ)^l.
    """
    field, q = first.field, first.q
    shift = centre_shift(first.p, q) if q == 4 else ZERO
    harmonics: dict[int, Coefficient] = {}
    power = field.reduce(first.harmonics[q])
    for i in range(1, n + 1):
        lag = 2 * (n - i)
        if i > 1:
            power = field.reduce(power * field.centre * first.harmonics[q])
        if lag and shift.is_zero():
            continue
        weight = field.reduce(power * shift**lag) * math.comb(2 * i - 2 + lag, lag)
        for k in range(i % 2 or 2, i + 1, 2):
            value = coefficient(i, k)
            term = weight * fmpq(value.numerator, value.denominator)
            harmonics[k * q] = field.reduce(harmonics.get(k * q, ZERO) + term)
    found = {j: a for j, a in sorted(harmonics.items()) if not a.is_zero()}
    variable = "mu_eff" if q >= 5 else "mu"
    return SingularPart(first.p, q, q * n, 2 * n - 1, variable, found, field)


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


def next_terms(p: int, q: int) -> tuple[float, float]:
    r"""b and c of the terms next to the pole that makes the pendulum, relative to it.

    .. math:: \frac{a_q ε^q}{μ} \Bigl(1 + bμ + \frac{γε^2}{μ} + cε^2 + …\Bigr) \cos qθ.

    γ is the shift of the centre. c = 0 is returned for q ≤ 2: on the pendulum's separatrix,
    ε ∼ μ^{2/q}, it is of second order there.

    >>> b, c = next_terms(1, 1)
    >>> round(b * math.pi, 12), c
    (1.0, 0.0)
    """
    expansion = laurent_expansion(p, q, q if q <= 2 else q + 2, terms=2)
    ring = expansion.problem.ring
    assert isinstance(ring, LaurentRing)
    field = ring.field
    first = amplitudes(expansion, 1)[q]
    pole = field.value(first.coefficient(-1))
    b = float(field.value(first.coefficient(0)) / pole)
    if q <= 2:
        return b, 0.0
    # In ε̂, and with sin^{−2} Ω = sin^{−2} Ω₀ (1 − 2μ cot Ω₀ + …) taken to ε.
    first, second = expansion.contact(q)[q], expansion.contact(q + 2)[q]
    pole = field.value(first.coefficient(-1))
    double, simple = (field.value(second.coefficient(k)) / pole for k in (-2, -1))
    cot = field.value(field.cot(1))
    return b, float((simple - 2 * cot * double) * (1 + cot * cot))


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
