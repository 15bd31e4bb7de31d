"""When is a residual zero?  That depends on the ring.

========================  =====================================  ==============================
ring                      a residual is as it should be when     verdict
========================  =====================================  ==============================
exact                     it is the zero of the ring             proved, or REFUTED
Laurent series            no coefficient of it is known          proved up to O(μ^k), or REFUTED
balls                     it contains zero, and is finite        enclosed within r, or REFUTED
floating-point numbers    it is what rounding may leave of the   consistent to r, or inconsistent
                          sum of its terms' magnitudes
========================  =====================================  ==============================

What rounding leaves of numbers is measured and stated, over that sum. With u the distance from 1 to
the next number it may leave

* of the driven end √u: a problem refuses frequencies where less than half the digits of its
  impedances are right (:data:`asymptotics.problems.string.RESOLUTION`), and more it does not
  promise;
* of the equation and the contact conditions 64 (N + 1)³ u: no impedance enters, only some N³
  products, each after a few roundings.

The number says how well the equations are met. How much of a coefficient was lost where large terms
cancelled, it does not say.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from numbers import Number, Rational
from typing import Any, Literal

import numpy as np
from flint import acb, arb

from asymptotics.rings.laurent import LaurentElement
from asymptotics.rings.ring import Ring

Kind = Literal["exact", "truncated", "balls", "numbers"]


def kind_of(ring: Ring[Any]) -> Kind:
    """Which line of the table a ring is on.

    >>> from asymptotics.rings.balls import ArbRing
    >>> from asymptotics.rings.ring import FloatRing
    >>> kind_of(FloatRing()), kind_of(ArbRing())
    ('numbers', 'balls')
    """
    one = ring.one
    if isinstance(one, arb | acb):
        return "balls"
    if isinstance(one, LaurentElement):
        return "truncated"
    return "numbers" if isinstance(one, Number) and not isinstance(one, Rational) else "exact"


@dataclass(frozen=True)
class Verdict:
    """What became of all residuals of one statement.

    Attributes
    ----------
    holds
        Whether each is as it should be.
    size
        Exact: 0. Balls: the largest radius. Numbers: the largest residual over the sum of its
        terms' magnitudes. Laurent series: the k of the largest O(μ^k).
    """

    holds: bool
    size: float


def verdict(
    kind: Kind, residuals: Iterable[tuple[Any, Any]], ring: Ring[Any], allowed: float
) -> Verdict:
    """All residuals of one statement, each with the sum of its terms' magnitudes.

    Only numbers need the latter, and what may be left of it, :func:`allowed_by_rounding`.

    >>> from asymptotics.rings.ring import FloatRing
    >>> verdict("numbers", [(1e-16, 1.0), (0.0, 0.0)], FloatRing(), 1e-15)
    Verdict(holds=True, size=1e-16)
    >>> verdict("numbers", [(1e-3, 1.0)], FloatRing(), 1e-15)
    Verdict(holds=False, size=0.001)
    """
    if kind == "exact":
        return Verdict(all(ring.is_zero(element) for element, _ in residuals), 0.0)
    if kind == "truncated":
        left = [ring.sum([element]) for element, _ in residuals]
        known = [element.precision for element in left if element.precision is not None]
        return Verdict(
            not any(element.coefficients for element in left), min(known, default=math.inf)
        )
    if kind == "balls":
        left = [acb(element) for element, _ in residuals]
        radii = [float(arb.max(x.real.rad(), x.imag.rad())) for x in left]
        finite = all(x.is_finite() for x in left)
        holds = finite and all(x.contains(0) for x in left)
        return Verdict(holds, max(radii, default=0.0) if finite else math.inf)
    sizes = [_scaled(element, scale) for element, scale in residuals]
    size = max(sizes, default=0.0) if all(math.isfinite(x) for x in sizes) else math.inf
    return Verdict(size <= allowed, size)


def allowed_by_rounding(ring: Ring[Any], order: int, impedances: bool) -> float:
    """What an expansion to that order may leave over its terms' magnitudes, see the docstring.

    >>> from asymptotics.rings.ring import FloatRing
    >>> allowed_by_rounding(FloatRing(), 4, impedances=True) == 2.0**-26
    True
    """
    u = 2.0**-52
    if not isinstance(ring.one, float | complex | np.number):
        import mpmath

        u = float(mpmath.mp.eps)
    return math.sqrt(u) if impedances else 64 * (order + 1) ** 3 * u


def _scaled(element: Any, scale: Any) -> float:
    """|element|/scale, 0 for 0/0; of arrays the largest."""
    values, scales = np.broadcast_arrays(abs(element), scale)
    sizes = [0.0]
    with np.errstate(invalid="ignore", over="ignore"):
        for value, size in zip(values.flat, scales.flat, strict=True):
            sizes.append(float(value / size) if size else math.inf if value else 0.0)
    return math.nan if any(map(math.isnan, sizes)) else max(sizes)


def in_words(kind: Kind, holds: bool, size: float) -> str:
    """The verdict on an order.

    >>> in_words("exact", True, 0.0), in_words("numbers", True, 3e-16)
    ('proved', 'consistent to 3e-16')
    """
    if not holds:
        return "inconsistent" if kind == "numbers" else "REFUTED"
    if kind == "balls":
        return f"enclosed within {_short(size)}"
    if kind == "numbers":
        return f"consistent to {_short(size)}"
    if kind == "truncated" and math.isfinite(size):
        return f"proved up to O(mu^{size:.0f})"
    return "proved"


def residual_in_words(kind: Kind, holds: bool, size: float) -> str:
    """The verdict on one statement."""
    if kind == "numbers":
        return _short(size)
    if not holds:
        return "NOT 0"
    return "contains 0" if kind == "balls" else "0"


def _short(size: float) -> str:
    return f"{size:.0e}" if size else "0"
