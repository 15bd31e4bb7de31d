r"""Tongues: where the truncated expansion touches the ground, and where all of them lead.

At Ω = pπ/q + μ the expansion of order N = qn has the leading singular part

.. math:: ξ_c ≈ 1 + \frac{ε^{qn}}{μ^{2n-1}} \sum_k a_{kq} \cos kqθ, \qquad
          W ≈ s^2 + \frac{ε^{qn}}{μ^{2n-1}} \sum_k 2a_{kq} \cos kqθ
          \Bigl(s - \frac{\sin kqΩ_0s}{kqΩ_0}\Bigr)

(eq. expandw2 for q = 1, n = 3), which reaches the ground at ε = C |μ|^{(2n−1)/(qn)} (eq. grazing).
The a_j are exact (:mod:`asymptotics.resonances.singular_part`, which also says what μ is for q ≥
4). Only the place and time of the touch are numbers (:mod:`asymptotics.resonances.first_touch`). As
n grows these laws approach that of the pendulum (:mod:`asymptotics.resonances.pendulum`), ε =
(π²μ²/(4v_q))^{1/q}.

**Where they hold.** The series in ε converges below the pendulum's law only, so a touch above it is
one of a divergent series. C|μ|^{(2n−1)/(qn)} = C_∞|μ|^{2/q} at |μ| = (C/C_∞)^{qn}, and below that
distance the touch is above; usually that is farther than the next resonance, and the law then holds
nowhere as a law of the rope, only as one of the truncated expansion. The pendulum's law is the
first term as μ → 0. What the next terms change is estimated by :meth:`LimitLaw.error`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import pi, sqrt
from typing import Any

from flint import arb

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.resonances.first_touch import graze
from asymptotics.resonances.singular_part import (
    SingularPart,
    centre_shift,
    next_terms,
    singular_part,
)
from asymptotics.rings.precision import at_precision
from asymptotics.rings.resonance_field import ZERO, check_resonance

__all__ = [
    "LimitLaw",
    "SingularPart",
    "Tongue",
    "Touch",
    "centre_shift",
    "limit_law",
    "parse_fraction",
    "singular_part",
    "tongue",
]


@dataclass(frozen=True)
class Touch:
    """One side of a tongue: ε = coefficient · |μ|^exponent.

    Attributes
    ----------
    coefficient
        C.
    s, theta
        Where and when the rope touches: s = (x − x_c)/x₀, and θ = Ωτ in [0, π/q]; by the symmetries
        of the leading part also at ±θ + 2πi/q.
    height
        Largest elevation, in units of Z₀, between the touching point and the contact point at that
        time: the pinched-off bump.
    gap
        Certified relative gap between C^N and its lower bound over all places and times.
    divergent
        |μ| below which the touch lies where the series diverges.
    """

    coefficient: float
    s: float
    theta: float
    height: float
    gap: float
    divergent: float


@dataclass(frozen=True)
class LimitLaw:
    """ε = coefficient · |μ_eff|^{2/q}: the pendulum's separatrix, the limit of the tongues.

    Attributes
    ----------
    strength
        v_q as text that SymPy parses: the pendulum's V = v_q ε^q.
    shift
        γ as text, μ_eff = μ − γε²; "0" for q ≤ 2, where the shift vanishes against μ or, at q = 1,
        is part of the pendulum.
    next_terms
        b and c of :func:`asymptotics.resonances.singular_part.next_terms`; None for q > 4.
    """

    p: int
    q: int
    exponent: Fraction
    coefficient: float
    strength: str
    shift: str
    shift_value: float
    next_terms: tuple[float, float] | None

    def epsilon(self, distance: Any) -> Any:
        """ε of the law at |μ_eff|, a number or an array."""
        return self.coefficient * distance ** float(self.exponent)

    def error(self, distance: float) -> float | None:
        r"""Estimate of the law's relative error at |μ_eff|: 4(|bμ_eff| + |c|ε²)/q.

        The 4 is for what the terms of higher order in Λ add on the way to the separatrix: their
        share of the next term grows with the order like that of a shifted singularity, twice the
        first one's at q = 1, and the circle breaks before the separatrix. Held against the last
        invariant circle at eight resonances, on both sides, q ≤ 4. At q ≥ 5 it is None: there
        ε ∼ μ^{2/q} is no longer small and tongues of other resonances break the circle first.

        >>> round(limit_law(1, 1).error(0.1), 4)
        0.1273
        """
        if self.next_terms is None:
            return None
        b, c = self.next_terms
        return 4 * (abs(b) * distance + abs(c) * self.epsilon(distance) ** 2) / self.q

    @property
    def range(self) -> float | None:
        """|μ_eff| up to which :meth:`error` is at most 10 %; None where it is not known.

        >>> round(limit_law(1, 2).range, 4), limit_law(1, 5).range
        (0.0262, None)
        """
        if self.next_terms is None:
            return None
        low, high = 0.0, half_way(self.p, self.q)
        while high - low > 1e-12 * high:
            middle = 0.5 * (low + high)
            estimate = self.error(middle)
            assert estimate is not None
            low, high = (middle, high) if estimate <= TOLERANCE else (low, middle)
        return low

    @property
    def radius(self) -> float:
        r"""R of the series' radius of convergence, ε = R|μ|^{2/q}: C_∞ but at q = 4.

        At q = 4 the series is one in μ, where γε² ∼ μ. It ends at the nearest complex solution of
        ε⁴ = C_∞⁴(μ − γε²)², which is |ε|² = |μ|/(C_∞^{−2} + |γ|).
        """
        if self.q != 4:
            return self.coefficient
        return 1 / sqrt(self.coefficient**-2 + abs(self.shift_value))


@dataclass(frozen=True)
class Tongue:
    """The tongue of p/q from the expansion through ``order``.

    ``singular.order`` is the largest qn ≤ ``order``, which is the order that sets it. ``sides`` has
    the keys "+" (μ > 0) and "-".
    """

    order: int
    singular: SingularPart
    sides: Mapping[str, Touch]
    limit: LimitLaw

    @property
    def exponent(self) -> Fraction:
        """(2n − 1)/(qn)."""
        return self.singular.exponent

    @property
    def half_way(self) -> float:
        """|μ| half way to the next resonance, see :func:`half_way`."""
        return half_way(self.singular.p, self.singular.q)

    def window(self, sign: str) -> tuple[float, float] | None:
        """From which to which |μ| the law may hold for the rope; None if nowhere.

        >>> tongue(1, 1, 3).window("+") is None
        True
        """
        low = self.sides[sign].divergent
        return (low, self.half_way) if low < self.half_way else None


TOLERANCE = 0.1
"""The estimated relative error up to which a law is given."""

MOST_ESTIMATED = 4
"""q up to which :meth:`LimitLaw.error` was seen to hold; at 2/5 the circle is lost before."""


def half_way(p: int, q: int) -> float:
    """|Ω − pπ/q| half way to the next resonance whose denominator is at most q.

    >>> half_way(1, 1) / pi, half_way(1, 2) / pi, round(half_way(1, 3) / pi * 12, 14)
    (0.5, 0.25, 1.0)
    """
    # The neighbours of p/q in the Farey sequence of order q have denominators r with pr ≡ ±1.
    nearest = max(r for r in range(1, q + 1) if (p * r - 1) % q == 0 or (p * r + 1) % q == 0)
    return pi / (2 * q * nearest)


def parse_fraction(text: str) -> tuple[int, int]:
    """(p, q) of a resonance given as text "p/q", or "p" for p/1.

    Raises
    ------
    InputError
        Anything else, zero or negative numbers, or a fraction that can be reduced.

    >>> parse_fraction("1/2"), parse_fraction(" 3 ")
    ((1, 2), (3, 1))
    """
    found = re.fullmatch(r"\s*([0-9]{1,9})\s*(?:/\s*([0-9]{1,9})\s*)?", str(text), re.ASCII)
    if found is None:
        raise InputError(
            f"resonance {text!r}: give p/q, two positive whole numbers such as 1/2, for the "
            "frequency Omega = p*pi/q"
        )
    p, q = int(found[1]), int(found[2] or 1)
    check_resonance(p, q)
    return p, q


@lru_cache(maxsize=64, typed=True)
def limit_law(p: int, q: int) -> LimitLaw:
    r"""The pendulum's law ε = (π²μ_eff²/(4v_q))^{1/q} of any resonance.

    v_q = 4Ω₀|a_q| from the simple pole a_q/μ of the first resonant order.

    Raises
    ------
    InputError
        p/q not in lowest terms.

    Examples
    --------
    q = 1: ε = μ²/(8p²). q = 2, p = 1: ε = 4μ/π.

    >>> limit_law(1, 1).coefficient, limit_law(1, 1).strength
    (0.125, '2*pi**2')
    >>> limit_law(1, 2).coefficient * pi / 4, limit_law(1, 2).exponent
    (1.0, Fraction(1, 1))
    """
    check_resonance(p, q)
    first = singular_part(p, q, q)
    field = first.field
    signed = field.reduce(4 * field.centre * first.harmonics[q])
    strength = signed if float(field.value(signed)) > 0 else -signed
    shift = centre_shift(p, q) if q > 2 else ZERO
    with at_precision(128):
        bound = (arb.pi() ** 2 / (4 * field.value(strength))) ** (arb(1) / q)
    return LimitLaw(
        p=p,
        q=q,
        exponent=Fraction(2, q),
        coefficient=float(bound),
        strength=field.text(strength),
        shift=field.text(shift),
        shift_value=float(field.value(shift)),
        next_terms=next_terms(p, q) if q <= MOST_ESTIMATED else None,
    )


def tongue(p: int, q: int, order: int) -> Tongue:
    r"""The tongue of p/q from the expansion through ``order``, on both sides.

    Parameters
    ----------
    p, q
        The resonance Ω₀ = pπ/q, in lowest terms.
    order
        N ≥ q; the largest multiple qn ≤ N is what sets the tongue.

    Raises
    ------
    InputError
        p/q not in lowest terms, or N < q.

    Examples
    --------
    Eq. (grazing): 0.309, 5/3, s pπ = −1.13 at ωt = pπ, bump 0.085/(pπ)²; and the 3/4 law, 1.815.

    >>> result = tongue(1, 1, 3)
    >>> side = result.sides["+"]
    >>> round(side.coefficient, 3), str(result.exponent), round(side.s * pi, 2), side.theta == pi
    (0.309, '5/3', -1.13, True)
    >>> round(side.height * pi**2, 3), round(tongue(1, 2, 4).sides["+"].coefficient, 3)
    (0.085, 1.815)
    """
    check_resonance(p, q)
    part, limit = singular_part(p, q, check_order(order)), limit_law(p, q)
    sides = {"+": _touch(part, limit, 1), "-": _touch(part, limit, -1)}
    return Tongue(int(order), part, sides, limit)


def _touch(part: SingularPart, limit: LimitLaw, side: int) -> Touch:
    """Scale the harmonics to size 1, graze, and scale back."""
    sign = side**part.pole
    values = part.values()
    scale = max(abs(a) for a in values.values())
    touch = graze({j // part.q: sign * a / scale for j, a in values.items()})
    width = part.p * pi
    coefficient = (touch.amplitude / (width * scale)) ** (1 / part.order)
    return Touch(
        coefficient=coefficient,
        s=-touch.y / width,
        theta=touch.x / part.q,
        height=touch.height / width**2,
        gap=touch.gap,
        divergent=(coefficient / limit.radius) ** part.order,
    )
