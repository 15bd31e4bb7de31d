"""Balls tight enough to be rounded, and the doubles they are rounded to."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from flint import acb, arb

from asymptotics.errors import InputError
from asymptotics.rings.precision import until

# Three bits beyond half a unit in the last place of a double.
_RELATIVE = 56


# A coefficient smaller than this part of its order's largest is given to that absolute accuracy.
_VANISHING = 1024


def accurate(group: Iterable[arb | acb], vanishing: int = _VANISHING) -> bool:
    """Whether each ball is tight enough to be rounded, as the module's docstring says."""
    balls = list(group)
    if all(ball.rel_accuracy_bits() > _RELATIVE for ball in balls):
        return True
    if not all(ball.is_finite() for ball in balls):
        return False
    largest = max((ball.abs_lower() for ball in balls), key=lambda x: x.mid(), default=arb(0))
    floor = largest * arb(2) ** -vanishing
    return all(
        bool(_radius(ball) <= (ball.abs_lower() + floor) * arb(2) ** -_RELATIVE) for ball in balls
    )


def _radius(ball: arb | acb) -> arb:
    return ball.rad() if isinstance(ball, arb) else ball.real.rad() + ball.imag.rad()


def rounded_value(compute: Callable[[], arb | acb], what: str) -> float | complex:
    """A ball computed at a precision doubled until it is accurate, rounded to a double.

    A value that vanishes is 0 to 2⁻¹⁰⁷⁴.

    >>> rounded_value(lambda: arb(0.1).exp() - 1 - arb(0.1), "a difference")
    0.005170918075647625
    """

    def settled(ball: arb | acb) -> bool:
        tiny = bool(abs(ball) < arb(2) ** -1074)
        return tiny or accurate([ball])

    return to_double(until(settled, compute, what)[0], what)


def to_double(ball: arb | acb, what: str) -> float | complex:
    """The double nearest to the ball's centre.

    Raises
    ------
    InputError
        It is beyond 10³⁰⁸ in size.
    """
    number = float(ball) if isinstance(ball, arb) else complex(ball)
    if not (math.isfinite(number.real) and math.isfinite(number.imag)):
        raise InputError(
            f"{what}: the expansion holds {ball.str(6, radius=False)}, beyond what a double can "
            "hold; ask for a lower order, or expand it over balls or digits"
        )
    return number
