"""The arithmetics a beam is computed in: doubles, mpmath's numbers, python-flint's balls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from asymptotics.rings.pickling import Remembered, remembering
from asymptotics.rings.precision import PrecisionError
from asymptotics.rings.ring import FloatRing


class NumberRing(FloatRing):
    """Numbers other than doubles, made by ``number`` from an integer."""

    def __init__(self, number: Callable[[int], Any]) -> None:
        self.number = number
        self.zero, self.one = number(0), number(1)

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        """numerator/denominator, rounded or enclosed once."""
        return self.number(numerator) / denominator

    def sum(self, terms: Any) -> Any:
        """Σ terms, left to right."""
        return sum(terms, self.zero)

    def is_zero(self, element: Any) -> bool:
        """Exact zero only; a ball around zero is not zero."""
        return bool(element == 0)


@dataclass(frozen=True)
class Numbers(Remembered):
    """An arithmetic: its ring, its elementary functions and its monotone Newton iteration.

    ``solve`` takes y ↦ (f, f′), f convex and increasing, and a start to the right of the zero. It
    is None for doubles, whose static shape is :mod:`asymptotics.problems.static_shape`'s:
    conditions that cancel cost them digits, where other arithmetics add digits or say what they
    lost.
    """

    ring: FloatRing
    convert: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]
    exp: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    solve: Callable[[Callable[[Any], tuple[Any, Any]], Any], Any] | None


@remembering
def doubles() -> Numbers:
    """Double precision, real or complex; arrays broadcast."""

    def convert(value: Any) -> Any:
        return np.asarray(value, dtype=complex if np.iscomplexobj(value) else float)[()]

    return Numbers(FloatRing(), convert, np.sqrt, np.exp, np.sin, np.cos, None)


@remembering
def digits() -> Numbers:
    """mpmath numbers at mpmath's own working precision, ``mpmath.mp.dps`` digits.

    >>> import mpmath
    >>> from asymptotics.problems.beam import static_beam
    >>> with mpmath.workdps(30):
    ...     print(static_beam("0.01", numbers=digits()).contact_point)
    1.10498406802000764016217708659
    """
    import mpmath

    def solve(f: Callable[[Any], tuple[Any, Any]], y: Any) -> Any:
        while True:
            value, slope = f(y)
            if not value / slope > 4 * mpmath.mp.eps * y:
                return y
            y = y - value / slope

    functions = (mpmath.sqrt, mpmath.exp, mpmath.sin, mpmath.cos)
    return Numbers(NumberRing(mpmath.mpf), mpmath.mpmathify, *functions, solve)


@remembering
def balls() -> Numbers:
    """Real balls at python-flint's working precision, ``flint.ctx.prec`` bits: enclosures.

    >>> from asymptotics.problems.beam import static_beam
    >>> static_beam("0.01", numbers=balls()).contact_point
    [1.10498406802001 +/- 4.98e-15]
    """
    from flint import arb, ctx

    def solve(f: Callable[[Any], tuple[Any, Any]], y: Any) -> Any:
        y = y.mid()
        while True:
            value, slope = f(y)
            step = (value / slope).mid()
            if not step > y * arb(2) ** (2 - ctx.prec):
                break
            y = (y - step).mid()
        # f increases, so a change of sign encloses the only zero.
        for bits in range(4, ctx.prec, 4):
            radius = y * arb(2) ** (bits - ctx.prec)
            if f(y - radius)[0] < 0 and f(y + radius)[0] > 0:
                return arb(y, radius)
        raise PrecisionError(
            f"{ctx.prec} bits are too few, or beta is too wide a ball, to enclose the static "
            "contact point; give more bits, or narrow beta",
            y,
        )

    sqrt, exp, sin, cos = _methods(arb)
    return Numbers(NumberRing(arb), arb, sqrt, exp, sin, cos, solve)


@remembering
def complex_balls() -> Numbers:
    """The same for complex Ω; the static shape is real, and comes from :func:`balls`."""
    from flint import acb

    sqrt, exp, sin, cos = _methods(acb)
    return Numbers(NumberRing(acb), acb, sqrt, exp, sin, cos, None)


def _methods(kind: type) -> tuple[Callable[[Any], Any], ...]:
    """√, exp, sin and cos of balls. Called unbound, those methods read any other type's memory."""

    def method(name: str) -> Callable[[Any], Any]:
        return lambda ball: getattr(kind(ball), name)()

    return method("sqrt"), method("exp"), method("sin"), method("cos")
