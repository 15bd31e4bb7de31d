"""The letters a rope is written down with: W(ξ, τ), ε and Ω.

Functions and symbols of these names that a reader makes himself do as well; all other symbols of an
equation are its parameters.
"""

from __future__ import annotations

import sympy

xi, tau = sympy.symbols("xi tau", real=True)
epsilon, Omega = sympy.symbols("epsilon Omega", real=True)
W = sympy.Function("W")(xi, tau)

__all__ = ["Omega", "W", "epsilon", "tau", "xi"]
