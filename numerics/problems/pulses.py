r"""The travelling pulse's height, length and speed, each from another: what fits on a grid.

A wave that runs along the ground at c > 1 without change has the half-length ϖ√(β/(c² − 1)), with
tan ϖ = ϖ, and the height PULSE β/(c² − 1)². Its shape is :mod:`numerics.exact_solutions.pulse`'s.
"""

from __future__ import annotations

import math

from numerics.problems.drive import non_negative, positive

ROOT = 4.493409457909064
"""ϖ, the smallest positive root of tan ϖ = ϖ."""

PULSE = ROOT**2 + 2 + 2 * math.hypot(1, ROOT)
"""31.397…: a pulse of the speed c has the height PULSE β/(c² − 1)²."""


def smallest_wave(beta: float, dx: float, cells: float = 6) -> float:
    """The height of the pulse that is ``cells`` dx long: no smaller wave fits on the grid.

    PULSE β/k² with the half-length ϖ√(β/k) = ½ cells dx. For β = 0, where there is no pulse, the
    height dx² of a parabola W = s² at the first node.

    Examples
    --------
    >>> print(f"{smallest_wave(0.01, 0.01):.2e} {smallest_wave(0.0, 0.01):.2e}")
    6.24e-06 1.00e-04
    """
    beta, dx = non_negative("beta", beta), positive("dx", dx)
    if beta == 0:
        return dx * dx
    return PULSE / beta * (0.5 * positive("cells", cells) * dx / ROOT) ** 4


def pulse_length(beta: float, height: float, dx: float) -> float:
    """2ℓ = 2ϖ(β height/PULSE)^{1/4}, the length of the pulse of one height; 6 dx for β = 0.

    Examples
    --------
    >>> print(f"{pulse_length(0.01, 1e-5, 0.01):.4f}")
    0.0675
    """
    beta, height, dx = non_negative("beta", beta), positive("height", height), positive("dx", dx)
    if beta == 0:
        return 6 * dx
    return 2 * ROOT * (beta * height / PULSE) ** 0.25


def pulse_speed(beta: float, height: float) -> float:
    """The speed c = √(1 + √(PULSE β/height)) of the travelling pulse of one height; 1 for β = 0.

    Examples
    --------
    >>> round(pulse_speed(0.01, 0.2009434), 6)
    1.5
    """
    beta, height = non_negative("beta", beta), positive("height", height)
    return math.sqrt(1 + math.sqrt(PULSE * beta / height))
