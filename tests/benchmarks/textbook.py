"""The textbook route, as a competent user of SymPy would write it.

Ansatz w_n = Σ_j (A_j cos jΩξ + B_j sin jΩξ) cos jθ and ξ_n = Σ_j C_j cos jθ with the harmonics
j ≡ n mod 2 only; Taylor's formula for W and W_ξ at ξ_c; the coefficient of εⁿ; its harmonics, by
z = e^{iθ}; linear equations for A_j, B_j, C_j; ``solve``; ``simplify``. Nothing is known here of
impedances or of cotangents.
"""

from __future__ import annotations

from typing import Any

import sympy as sp


def textbook(order: int) -> tuple[Any, dict[tuple[int, int], Any]]:
    """Ω, and the coefficient of εⁿ cos jθ in ξ_c under (n, j), n ≤ order."""
    omega, eps, xi, z = sp.symbols("Omega epsilon xi z")

    def phase(j: int) -> Any:
        return (z**j + z**-j) / 2

    shape, shift = (xi - 1) ** 2, sp.Integer(0)
    contact: dict[tuple[int, int], Any] = {}
    for n in range(1, order + 1):
        harmonics = range(n % 2, n + 1, 2)
        unknowns, equations = [], []
        new_shape, new_shift = sp.Integer(0), sp.Integer(0)
        for j in harmonics:
            a, b, c = sp.symbols(f"A{j} B{j} C{j}")
            unknowns += [a, b, c]
            mode = a * sp.cos(j * omega * xi) + b * sp.sin(j * omega * xi) if j else a + b * xi
            new_shape += mode * phase(j)
            new_shift += c * phase(j)
            equations.append(a - (1 if n == j == 1 else 0))
        trial, delta = shape + eps**n * new_shape, shift + eps**n * new_shift
        for e in (0, 1):
            taylor = sum(
                delta**d / sp.factorial(d) * sp.diff(trial, xi, d + e).subs(xi, 1)
                for d in range(n + 2)
            )
            condition = sp.expand(sp.expand(taylor).coeff(eps, n))
            equations += [condition.coeff(z, j) for j in harmonics]
        (solution,) = sp.solve(equations, unknowns, dict=True)
        solution = {name: sp.simplify(value) for name, value in solution.items()}
        shape, shift = (
            shape + eps**n * new_shape.subs(solution),
            shift + eps**n * new_shift.subs(solution),
        )
        for j in harmonics:
            contact[n, j] = solution[sp.Symbol(f"C{j}")]
    return omega, contact
