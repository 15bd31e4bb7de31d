r"""Tongues: where the truncated expansion touches the ground, and where all of them lead.

At Ω = pπ/q + μ the expansion of order N = qn has the leading singular part

.. math:: ξ_c ≈ 1 + \frac{ε^{qn}}{μ^{2n-1}} \sum_k a_{kq} \cos kqθ, \qquad
          W ≈ s^2 + \frac{ε^{qn}}{μ^{2n-1}} \sum_k 2a_{kq} \cos kqθ
          \Bigl(s - \frac{\sin kqΩ_0s}{kqΩ_0}\Bigr)

(eq. expandw2 for q = 1, n = 3), which reaches the ground at ε = C |μ|^{(2n−1)/(qn)} (eq. grazing).
The a_j are exact (:mod:`asymptotics.singular`, which also says what μ is for q ≥ 4). Only the place
and time of the touch are numbers (:mod:`asymptotics.grazing`). As n grows these laws approach
that of the pendulum (:mod:`asymptotics.pendulum`), ε = (π²μ²/(4v_q))^{1/q}.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import pi

from flint import arb

from asymptotics.errors import InputError
from asymptotics.expansion import check_order
from asymptotics.grazing import graze
from asymptotics.precision import at_precision
from asymptotics.resonance_field import ZERO, check_resonance
from asymptotics.singular import SingularPart, centre_shift, singular_part

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
    """

    coefficient: float
    s: float
    theta: float
    height: float
    gap: float


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
    """

    p: int
    q: int
    exponent: Fraction
    coefficient: float
    strength: str
    shift: str
    shift_value: float


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
    part = singular_part(p, q, check_order(order))
    return Tongue(
        order=int(order),
        singular=part,
        sides={"+": _touch(part, 1), "-": _touch(part, (-1) ** part.pole)},
        limit=limit_law(p, q),
    )


def _touch(part: SingularPart, sign: int) -> Touch:
    """Scale the harmonics to size 1, graze, and scale back."""
    values = part.values()
    scale = max(abs(a) for a in values.values())
    touch = graze({j // part.q: sign * a / scale for j, a in values.items()})
    width = part.p * pi
    return Touch(
        coefficient=(touch.amplitude / (width * scale)) ** (1 / part.order),
        s=-touch.y / width,
        theta=touch.x / part.q,
        height=touch.height / width**2,
        gap=touch.gap,
    )
