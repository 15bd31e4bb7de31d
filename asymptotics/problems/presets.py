"""The paper's ropes, and their kin, written down: one equation with terms filled in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy

from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.static_shape import check_driven_end
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi

DriveTable = Mapping[int, tuple[Any, Any]]
"""n ↦ (amplitude, phase): ΔZ = Σ amplitude · cos(nΩτ + phase)."""


def string(
    *,
    damping: Any = 0,
    viscosity: Any = 0,
    foundation: Any = 0,
    drive: DriveTable | None = None,
    ground: Any = 0,
    springs: Any = 0,
) -> MovingContact:
    """W_ττ + 2ζW_τ = W_ξξ + ηW_ξξτ − κW − 2, W(0, τ) = 1 + εΔZ, W = W_ξ = 0 at ξ_c.

    The paper's eq. (rope) for the defaults. Everything that is not 0 is a number or a symbol, which
    then is a parameter.

    Parameters
    ----------
    damping, viscosity, foundation
        ζ, η (Kelvin–Voigt) and κ.
    drive
        See :data:`DriveTable`; cos Ωτ by default.
    ground
        g(ξ), a polynomial.
    springs
        κ of a ground that gives way, see :mod:`asymptotics.problems.compliant`.

    Raises
    ------
    InputError
        A drive that is empty or of harmonics that are no whole numbers.

    Examples
    --------
    >>> from asymptotics import expand
    >>> series = expand(string(), 2, at={"Omega": 2.2})
    >>> round(2 * series.contact(1)[1], 9)               # Ω/(2 sin Ω)
    1.360550269
    """
    return moving_contact(
        equation=_equation(0, damping, viscosity, foundation),
        driven_end=[sympy.Eq(W, 1 + epsilon * _sum(drive))],
        contact=[W, W.diff(xi)] if springs == 0 else [W],
        ground=ground,
        springs=springs,
    )


def beam(
    *,
    beta: Any = sympy.Symbol("beta"),  # noqa: B008
    driven_end: str = "pinned",
    damping: Any = 0,
    viscosity: Any = 0,
    foundation: Any = 0,
    drive: DriveTable | None = None,
    ground: Any = 0,
    springs: Any = 0,
) -> MovingContact:
    """The same with −βW_ξξξξ on the right, and W_ξξ = 0 or (clamped) W_ξ = 0 at the driven end.

    The paper's eq. (beam2) for the defaults, with β a parameter.

    Examples
    --------
    A damped clamped beam under two frequencies:

    >>> from asymptotics import expand
    >>> rope = beam(driven_end="clamped", damping=0.1, drive={1: (1, 0), 3: (0.2, 0.5)})
    >>> series = expand(rope, 2, at={"beta": 0.01, "Omega": 2.2})
    >>> sorted(series.contact(2))
    [0, 2, 4, 6]
    """
    end = W.diff(xi, 2) if check_driven_end(driven_end) == "pinned" else W.diff(xi)
    return moving_contact(
        equation=_equation(beta, damping, viscosity, foundation),
        driven_end=[sympy.Eq(W, 1 + epsilon * _sum(drive)), sympy.Eq(end, 0)],
        contact=[W, W.diff(xi), W.diff(xi, 2)] if springs == 0 else [W],
        ground=ground,
        springs=springs,
    )


def _equation(beta: Any, damping: Any, viscosity: Any, foundation: Any) -> sympy.Eq:
    given = {"beta": beta, "damping": damping, "viscosity": viscosity, "foundation": foundation}
    for name, value in given.items():
        if isinstance(value, str) or not isinstance(sympy.sympify(value), sympy.Expr):
            raise InputError(f"{name} = {value!r}; give a number, or a SymPy symbol or expression")
    left = W.diff(tau, 2) + 2 * damping * W.diff(tau)
    right = W.diff(xi, 2) + viscosity * W.diff(xi, 2, tau) - foundation * W - 2
    return sympy.Eq(left, right - beta * W.diff(xi, 4))


def _sum(drive: DriveTable | None) -> sympy.Expr:
    terms = {1: (1, 0)} if drive is None else dict(drive)
    if not terms or not all(isinstance(n, int) and n >= 0 for n in terms):
        raise InputError(
            f"drive = {drive!r}; give {{harmonic: (amplitude, phase)}} with whole harmonics, e.g. "
            "{1: (1, 0), 3: (0.2, 0.5)}"
        )
    return sympy.Add(
        *(size * sympy.cos(n * Omega * tau + phase) for n, (size, phase) in terms.items())
    )
