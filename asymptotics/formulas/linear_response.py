r"""The linear response of the contact point to any small motion of the driven end, exactly.

To first order w₁ = F(t − x/c) + G(t + x/c). With the shift E: f(t) ↦ f(t − x₀/c) and D = ∂_t the
driven end and the two contact conditions of the paper are linear equations over the commutative
ring ℚ(g, c)[E, E⁻¹, D]:

.. math:: F + G = ΔZ, \qquad E F + E^{-1} G = 0, \qquad -E D F + E^{-1} D G = -(g/c)\, x_1 .

:func:`eliminate` solves them by Cramer's rule and substitutes the solution back. What comes out,
(1 − E²) x₁ = (2c/g) E D ΔZ, is eq. (linear); on ΔZ = e^{iωt}, where E = e^{−iωx₀/c} and D = iω, it
is eq. (linresponse2).

In the units of the paper's eq. (beam2) — ξ₁ = x₁/x₀, τ = ct/x₀, ΔZ in units of Z₀ — the factor is
(2c/g) Z₀ (c/x₀)/x₀ = 1 by eq. (leading):

.. math:: ξ_1(τ) - ξ_1(τ - 2) = ΔZ'(τ - 1), \qquad
          ξ_1 = \frac{Ω}{2 \sin Ω} e^{iΩτ} \text{ for } ΔZ = e^{iΩτ}.

:mod:`asymptotics.values.linear_response` evaluates both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

from asymptotics.formulas.closed_form import ClosedForm, symbols

if TYPE_CHECKING:
    import sympy

_RING = fmpz_mpoly_ctx.get(["E", "D", "g", "c"], Ordering.lex)
_E, _D, _G, _C = _RING.gens()
_ONE, _ZERO = _RING.constant(1), _RING.constant(0)

_Row = tuple[fmpz_mpoly, ...]
_Matrix = tuple[_Row, ...]


@dataclass(frozen=True)
class Elimination:
    """F, G and x₁ as operators on ΔZ: ``determinant`` · unknown = operator · ΔZ.

    Attributes
    ----------
    determinant, forward, backward, contact
        Polynomials in E, D, g, c; the operators of F, G and x₁ in this order.
    residuals
        What the three conditions leave after substitution, times the determinant.
    difference
        (p, q) with p x₁ = q ΔZ, common factors removed: the paper's eq. (linear).
    """

    determinant: fmpz_mpoly
    forward: fmpz_mpoly
    backward: fmpz_mpoly
    contact: fmpz_mpoly
    residuals: tuple[fmpz_mpoly, fmpz_mpoly, fmpz_mpoly]
    difference: tuple[fmpz_mpoly, fmpz_mpoly]

    @property
    def holds(self) -> bool:
        """Whether the three residuals are identically zero and the solution is not empty."""
        return all(r.is_zero() for r in self.residuals) and not self.determinant.is_zero()

    def __str__(self) -> str:
        p, q = self.difference
        residuals = ", ".join(str(r) for r in self.residuals)
        verdict = "proved" if self.holds else "REFUTED"
        return f"({p}) x_1 = ({q}) DeltaZ: {verdict} (residuals {residuals})"


@cache
def eliminate() -> Elimination:
    """Eliminate d'Alembert's F and G: eq. (linear), exactly and proved by substitution.

    Dividing by 1 − E² is legitimate for a rope at rest before some time: there 1/(1 − E²) is the
    sum of E^{2k}, of which finitely many terms act.

    >>> print(eliminate())
    (-E^2*g + g) x_1 = (2*E*D*c) DeltaZ: proved (residuals 0, 0, 0)
    """
    # The three conditions, times 1, E and cE: rows of the unknowns (F, G, x₁), and ΔZ's factor.
    rows = (
        (_ONE, _ONE, _ZERO),
        (_E**2, _ONE, _ZERO),
        (-(_E**2) * _D * _C, _D * _C, _E * _G),
    )
    drive = (_ONE, _ZERO, _ZERO)
    determinant = _determinant(rows)
    forward, backward, contact = (_determinant(_replaced(rows, k, drive)) for k in range(3))
    first, second, third = (
        row[0] * forward + row[1] * backward + row[2] * contact - r * determinant
        for row, r in zip(rows, drive, strict=True)
    )
    common = determinant.gcd(contact)
    return Elimination(
        determinant,
        forward,
        backward,
        contact,
        residuals=(first, second, third),
        difference=(determinant / common, contact / common),
    )


def _replaced(rows: _Matrix, column: int, values: _Row) -> _Matrix:
    return tuple(
        (*row[:column], value, *row[column + 1 :]) for row, value in zip(rows, values, strict=True)
    )


def _determinant(rows: _Matrix) -> fmpz_mpoly:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def difference_equation() -> sympy.Eq:
    """Eq. (linear) in physical units, from :func:`eliminate`.

    The symbols are t, g, c, x_0 and the functions x_1, DeltaZ; ε ΔZ(t) is the drive's deviation
    from Z₀, and ε x₁(t) the contact point's from x₀.

    >>> difference_equation()
    Eq(x_1(t) - x_1(t - 2*x_0/c), 2*c*Derivative(DeltaZ(t - x_0/c), t)/g)
    """
    import sympy

    t, g = sympy.symbols("t g")
    x_1, drive = sympy.Function("x_1"), sympy.Function("DeltaZ")
    left, right = eliminate().difference
    return sympy.Eq(_applied(left, x_1, t) / g, _applied(right, drive, t) / g).expand()


def _applied(operator: fmpz_mpoly, function: Any, t: Any) -> sympy.Expr:
    """Σ a E^k D^d g^m c^n, applied to a function of t."""
    import sympy

    g, c, x_0 = sympy.symbols("g c x_0")
    total = sympy.Integer(0)
    for powers, coefficient in operator.terms():
        k, d, m, n = (int(power) for power in powers)
        shifted = function(t - k * x_0 / c)
        total += (
            int(coefficient) * g**m * c**n * (sympy.Derivative(shifted, (t, d)) if d else shifted)
        )
    return total


def transfer_function() -> ClosedForm:
    """ξ₁ per unit of ΔZ/Z₀ = e^{iΩτ}: H = Ω/(2 sin Ω), eq. (linresponse2) over x₀.

    It is the ratio of the two operators of eq. (linear) at E = e^{−iΩ}, D = iΩ, in the units where
    g = 2 and c = 1 (x₀ = Z₀ = 1, so that 2c²Z₀/g = x₀² is eq. (leading)).

    >>> transfer_function().expression
    Omega/(2*sin(Omega))
    """
    import sympy

    omega = symbols()["Omega"]
    left, right = eliminate().difference

    # Both operators over E, the symmetric point of the delay: 1/E − E becomes 2i sin Ω.
    def at_frequency(operator: fmpz_mpoly) -> sympy.Expr:
        total = sympy.Integer(0)
        for powers, coefficient in operator.terms():
            k, d, m = (int(power) for power in powers[:3])
            phase = (k - 1) * omega
            shift = sympy.cos(phase) - sympy.I * sympy.sin(phase)
            total += int(coefficient) * shift * (sympy.I * omega) ** d * 2**m
        return sympy.expand(total)

    ratio = at_frequency(right) / at_frequency(left)
    return ClosedForm("xi_1/DeltaZ", ratio, "linresponse2", 1, "at Ω = pπ, p ≠ 0")


def harmonic_response() -> ClosedForm:
    """ξ₁(τ) for ΔZ/Z₀ = cos Ωτ: eq. (linresponse1) over x₀.

    >>> harmonic_response().expression
    Omega*cos(Omega*tau)/(2*sin(Omega))
    """
    import sympy

    names = symbols()
    # The transfer function is real, so the real part of H e^{iΩτ} is H cos Ωτ.
    expression = transfer_function().expression * sympy.cos(names["Omega"] * names["tau"])
    return ClosedForm("xi_1", expression, "linresponse1", 1, "at Ω = pπ")
