"""The string over balls: enclosures at one frequency."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import acb, arb, fmpq

from asymptotics.errors import InputError
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import driven_string, string_problem
from asymptotics.rings.balls import AcbRing, ArbRing, frequency, rational
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import Ring


@remembering
def ball_string(omega: Any) -> Problem[Any]:
    """The string over real balls, for :func:`asymptotics.expansion.order_loop.expand`.

    The small parameter is ε̂ = ε/sin Ω. Make it, and expand it, within
    :func:`~asymptotics.rings.precision.at_precision`.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.rings.precision import at_precision
    >>> with at_precision(128):
    ...     print(expand(ball_string("pi/2 + 1e-9"), 2).contact(2)[2].str(20))
    [-121118268.51374002570 +/- 3.25e-12]
    """
    exact = frequency(omega)
    ball = exact.ball()
    return string_problem(
        ArbRing(), ball, lambda j: (j * ball).cot(), name=f"string at {exact} in balls"
    )


@remembering
def ball_damped_string(
    omega: Any, damping: Any, viscosity: Any = 0, drive: Mapping[int, acb] | None = None
) -> Problem[Any]:
    """:func:`asymptotics.problems.damped.damped_string` over complex balls; arguments as decimals
    are exact.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.rings.precision import at_precision
    >>> with at_precision(128):
    ...     c = expand(ball_damped_string("pi", "1e-9"), 1).contact(1)[1]
    >>> round(2e-9 * float(c.abs_upper()), 12)        # |ξ₁| → π/(2ζ)
    1.570796326795
    """
    ring: Ring[Any] = AcbRing()
    ball, numbers = frequency(omega).ball(), []
    for name, value in (("damping", damping), ("viscosity", viscosity)):
        number = rational(value)
        if number is None or number < 0:
            raise InputError(f"{name} = {value!r}; give a finite number ≥ 0")
        numbers.append(arb(fmpq(number.numerator, number.denominator)))
    zeta, eta = numbers

    def square(j: int) -> acb:
        return inertia(j) / acb(1, eta * j * ball)

    def inertia(j: int) -> acb:
        return acb((j * ball) ** 2, -2 * zeta * j * ball)

    def k(j: int) -> acb:
        return square(j).sqrt()

    name = f"string at {omega!r}, damping {damping!r}, viscosity {viscosity!r} in balls"
    return driven_string(
        name if drive is None else f"{name} under {drive!r}",
        ring,
        stiffness=square,
        impedance=lambda j: k(j) * k(j).cot(),
        source=lambda j: k(j) * k(j).csc(),
        drive={1: ring.rational(1, 2)} if drive is None else dict(drive),
        equation_residual=lambda j, w: acb(1, eta * j * ball) * w[2] + inertia(j) * w[0],
        end_residual=lambda j, w: k(j).cos() * w[0] - k(j).sin() / k(j) * w[1],
        end_unit=lambda j: ring.one,
    )
