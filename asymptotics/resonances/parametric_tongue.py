r"""The parametric tongue at twice a free frequency of any undamped rope, and how far its law holds.

Driven near Ω = 2ω_p the rope can answer with half the frequency. In units of Ω/2 the drive has the
even harmonics, harmonic 1 is nearly resonant, and the reduction of
:mod:`asymptotics.resonances.rope_fold` leaves, for a small amplitude b of it,

.. math:: G = \bigl(D(Ω/2) + κ ε + γ ε^2 + …\bigr)\, b + O(b^3) = 0 .

Where the bracket vanishes a state of twice the period branches off the wave-less one: that is an
edge of the tongue, and the wave-less state is unstable between the two. Cosines of θ/2 have one
edge. Sines of θ/2 are cosines after half a period of the drive, which turns the sign of its odd
harmonics: the other edge. To leading order

.. math:: |Ω − 2ω_p| ≤ C ε, \qquad C = 2 |κ / D'(ω_p)| .

The law is compared with the bracket's own zeros at order N: for an edge Ω_N(ε)

.. math:: e(ε) = \frac{|Ω_N − 2ω_p ∓ Cε| + |Ω_N − Ω_{N-2}|}{C ε}

estimates its error over the half-width, the second term because an edge that still moves with the
order is no measure. ε doubles as long as e ≤ :data:`ACCURACY`; there the range ends.
The error printed is the largest e/ε met on the way, times ε. The next resonance may be close: at
β = 0.3 ω₃ = 2.019ω₂, and the law at 2ω₂ ends at ε = 4e-6.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.resonances.fold_range import ACCURACY
from asymptotics.resonances.rope_fold import Resonant, reduced, reducible
from asymptotics.rings.precision import PrecisionError, at_precision

ORDER = 5
"""N: the orders that the law is compared with."""

_BITS = 320
# The search for the range: from here down until the law holds, then up as long as it does.
_FIRST, _LEAST, _MOST = 2.0**-14, 2.0**-40, 0.25
# Secant steps; from the law, and a sixteenth of its half-width further up.
_STEPS, _TOLD = 30, 1e-12


@dataclass(frozen=True)
class ParametricTongue:
    """What :func:`parametric_tongue` found.

    Attributes
    ----------
    p
        Of ω_p.
    frequency
        ω_p; the tongue stands on Ω = 2ω_p.
    coefficient
        C: the edges are at Ω − 2ω_p = ± Cε to leading order.
    error
        A bound on what rounding leaves of C.
    reach
        The largest ε at which the law was seen to hold to :data:`ACCURACY` of Cε; 0 for none.
    edges
        Ω of the two edges at that ε, by order N; the lower one first.
    slope
        The error of an edge is about ``slope``·ε of the half-width Cε; 0 without a range.
    """

    p: int
    frequency: float
    coefficient: float
    error: float
    reach: float
    edges: tuple[float, float] | None
    slope: float

    @property
    def resonance(self) -> float:
        """2ω_p."""
        return 2 * self.frequency

    def epsilon(self, omega: float) -> float:
        """The ε at which the wave-less state becomes unstable at Ω, by the law.

        Raises
        ------
        InputError
            Outside the range of the law.
        """
        found = abs(omega - self.resonance) / self.coefficient
        if not found <= self.reach:
            raise InputError(
                f"Omega = {omega!r} is outside the range of the tongue's law, which ends at "
                f"|Omega - {self.resonance:.8g}| = {self.coefficient * self.reach:.3g}"
            )
        return found

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "command": "tongue",
            "p": self.p,
            "subharmonic": 2,
            "frequency": self.frequency,
            "resonance": self.resonance,
            "coefficient": self.coefficient,
            "error": self.error,
            "range": {"epsilon": self.reach, "edges": self.edges and list(self.edges)},
            "slope": self.slope,
            "accuracy": ACCURACY,
            "order": ORDER,
        }


class _Edge:
    """One edge: the bracket of G for a drive whose odd harmonics have one sign."""

    def __init__(self, rope: MovingContact, values: Mapping[str, Fraction], sign: int) -> None:
        driven = tuple(
            replace(c, drive={2 * j: a * sign ** (j % 2) for j, a in c.drive.items()})
            for c in rope.driven_end
        )
        self.resonant = Resonant(replace(rope, driven_end=driven), values, 1)

    def terms(self, omega: float | Fraction, order: int) -> list[arb]:
        """D, κ, γ, … at Ω."""
        return [row[1] for row in reduced(self.resonant, Fraction(omega) / 2, 1, order)]

    def zero(self, start: float, width: float, epsilon: float) -> tuple[float, float] | None:
        """The edge at ε through order N, and how far order N − 2 is from it; None where lost."""

        def bracket(omega: float) -> tuple[float, float]:
            terms = [
                float((g * arb(epsilon) ** k).mid()) for k, g in enumerate(self.terms(omega, ORDER))
            ]
            return sum(terms), sum(terms[-2:])

        before, here = start, start + width / 16
        known, _ = bracket(before)
        for _ in range(_STEPS):
            value, tail = bracket(here)
            if value == known:
                return None
            slope = (value - known) / (here - before)
            before, known, here = here, value, here - value / slope
            if not abs(here - start) <= 8 * width:
                return None
            if abs(here - before) <= _TOLD * abs(here):
                return here, abs(tail / slope)
        return None


def parametric_tongue(rope: MovingContact, at: Mapping[Any, Any], p: int) -> ParametricTongue:
    """The tongue at Ω = 2ω_p of a rope at values of its parameters.

    Parameters
    ----------
    rope
        As for :func:`asymptotics.resonances.rope_fold.rope_fold`, Ω in the drive's phases only.
    at
        Symbol or name ↦ number, without Ω.
    p
        Which free frequency.

    Raises
    ------
    InputError
        Anything else; a drive without harmonic 1; a resonance that is not simple.

    Examples
    --------
    >>> from asymptotics.problems.presets import beam
    >>> found = parametric_tongue(beam(), {"beta": 0.01}, 1)
    >>> round(found.resonance, 4), round(1 / found.coefficient, 5)
    (6.5, 0.04674)
    """
    if rope.depends_on_frequency:
        raise InputError(f"{rope}: its coefficients hold Omega, which the tongue has to vary")
    if not any(1 in c.drive for c in rope.driven_end):
        raise InputError("the tongue at 2 omega_p belongs to harmonic 1 of the drive; it has none")
    values, start = reducible(rope, at, p)
    try:
        with at_precision(_BITS):
            return _found(rope, values, start, p)
    except PrecisionError as error:
        raise InputError(
            f"the tongue at 2 omega_{p} of {rope} is lost in {_BITS} bits: another resonance is "
            "too close"
        ) from error


def _found(
    rope: MovingContact, values: Mapping[str, Fraction], start: float, p: int
) -> ParametricTongue:
    """The law and its range, in the precision of the moment."""
    edges = [_Edge(rope, values, sign) for sign in (1, -1)]
    rate, slope = edges[0].resonant.resonance(Fraction(start))
    pair = [edge.terms(2 * rate, 2)[1] for edge in edges]
    ball = 2 * abs(pair[0] / slope)
    coefficient, error = float(ball.mid()), float(ball.rad()) + 2.0**-53 * float(ball.mid())
    if not error < coefficient:
        raise InputError(f"the drive does not couple to omega_{p} at order epsilon: no tongue")
    centre = 2 * float(rate)
    sides = [float(np.sign(float((-g / slope).mid()))) for g in pair]

    def seen(epsilon: float) -> tuple[float, tuple[float, float]] | None:
        found = []
        width = coefficient * epsilon
        for edge, side in zip(edges, sides, strict=True):
            law = centre + side * width
            zero = edge.zero(law, width, epsilon)
            if zero is None:
                return None
            found.append((zero[0], (abs(zero[0] - law) + zero[1]) / width))
        low, high = sorted(x for x, _ in found)
        return max(e for _, e in found), (low, high)

    reach, slope_of_error = 0.0, 0.0
    ends: tuple[float, float] | None = None
    epsilon = _FIRST
    here = seen(epsilon)
    while (here is None or here[0] > ACCURACY) and epsilon > _LEAST:
        epsilon /= 4
        here = seen(epsilon)
    while here is not None and here[0] <= ACCURACY:
        reach, ends = epsilon, here[1]
        slope_of_error = max(slope_of_error, here[0] / epsilon)
        epsilon *= 2
        here = seen(epsilon) if epsilon <= _MOST else None
    return ParametricTongue(p, centre / 2, coefficient, error, reach, ends, slope_of_error)


def tongue_in_words(found: ParametricTongue) -> list[str]:
    """The tongue as lines of text."""
    lines = [
        f"omega_{found.p} = {found.frequency:.12g}, tongue at Omega = 2 omega_{found.p} = "
        f"{found.resonance:.12g}",
        f"unstable, to a state of twice the period, where epsilon > "
        f"{1 / found.coefficient:.8g} |Omega - {found.resonance:.8g}|",
    ]
    if found.edges is None:
        return [*lines, "range  none: no epsilon was found at which the law holds"]
    low, high = found.edges
    return [
        *lines,
        f"range  epsilon <= {found.reach:.3g}: there the edges of order {ORDER} are Omega = "
        f"{low:.8g} and {high:.8g}; an edge is off by about {found.slope:.2g} epsilon of the "
        f"half-width, {found.slope * found.reach:.1%} at the end",
    ]
