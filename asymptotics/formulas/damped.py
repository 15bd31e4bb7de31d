"""The damped string's coefficients as expressions, and its linear response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.damped import damped_string
from asymptotics.rings.harmonics import Harmonics
from asymptotics.rings.ring import GeneratorRing

if TYPE_CHECKING:
    import sympy


def contact_harmonic(expansion: Expansion[Any], n: int, j: int) -> sympy.Expr:
    """The coefficient of ε^n e^{ijΩτ} in ξ_c, as an expression in Ω and ζ (both real).

    Parameters
    ----------
    expansion
        Of :func:`generator_damped_string`.

    Raises
    ------
    InputError
        The expansion is of another problem, or lacks order n.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.problems.damped import generator_damped_string
    >>> contact_harmonic(expand(generator_damped_string(2), 2), 1, 1)
    sqrt(Omega**2 - 2*I*Omega*zeta)/(4*sin(sqrt(Omega**2 - 2*I*Omega*zeta)))
    """
    import sympy

    ring = expansion.problem.ring
    if not isinstance(ring, GeneratorRing) or expansion.problem.name != "damped string":
        raise InputError(
            f"{expansion.problem.name} has no such closed form; expand generator_damped_string"
        )
    harmonics: Harmonics[Any] = expansion.contact(n)
    omega, zeta = sympy.symbols("Omega zeta", positive=True)

    def generator(name: str) -> sympy.Expr:
        if name in ("a", "b"):
            return omega**2 if name == "a" else 2 * sympy.I * zeta * omega
        conjugate, head = name.endswith("_"), name.rstrip("_")
        j = int(head[1:] or 1)
        sign = 1 if conjugate else -1
        k = sympy.sqrt((j * omega) ** 2 + sign * 2 * sympy.I * zeta * j * omega)
        return k / sympy.sin(k) if head == "g" else k * sympy.cot(k)

    total = sympy.Integer(0)
    for powers, coefficient in harmonics.get(j, ring.zero).terms():
        term = sympy.Rational(int(coefficient.p), int(coefficient.q))
        for name, power in zip(ring.names, powers, strict=True):
            if power:
                term *= generator(name) ** int(power)
        total += term
    return total


def linear_response(omega: float, damping: float, viscosity: float = 0.0) -> complex:
    """X with ξ₁ = Re X e^{iΩτ} for ΔZ = cos Ωτ: X = k_1/(2 sin k_1), finite at every Ω.

    Raises
    ------
    InputError
        As :func:`damped_string`.

    Examples
    --------
    >>> import math
    >>> round(abs(linear_response(math.pi, 0.01)) * 0.01, 4)       # π/2
    1.5708
    """
    return 2 * expand(damped_string(omega, damping, viscosity), 1).contact(1)[1]
