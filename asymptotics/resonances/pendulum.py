r"""The pendulum behind every tongue: the leading singular part of ξ_c near pπ/q, to all orders.

The string is the standard map, and next to a resonance the slow motion of that map is a pendulum,
½P² − V cos qφ with the momentum's mean ⟨P⟩ over the phase φ = θ − pπ/q held at 2μ by the mean
height W(0) = 1. The contact point follows the momentum, ξ_c − 1 ≈ (P − 2μ)/(2Ω₀), so that with

.. math:: Λ = \frac{Ω_0 a_1 ε^q}{μ^2}, \qquad
          ξ_{q,q} \cos qθ ≈ \frac{a_1}{μ} \cos qθ,

(a₁, the leading pole of the first resonant order, fixes V: |V| = v_q ε^q, v_q = 4Ω₀|a₁|)

.. math:: ξ_c - 1 ≈ \frac{μ}{Ω_0} \bigl[ϖ(Λ, qθ) - 1\bigr], \qquad
          ϖ = \sqrt{2e + 2Λ \cos x}, \quad ⟨ϖ⟩_x = 1.

ϖ knows nothing of p and q. Its power series ϖ = 1 + Σ Λ^n Σ_k A_{n,k} cos kx gives all leading
singular coefficients: ε^{qn} cos(kqθ)/μ^{2n−1} has the coefficient Ω₀^{n−1} a₁^n A_{n,k}. Two ways
to A are given, a recurrence and a closed form, and the engine is a third.

For q ≥ 4 powers of the O(ε²) shift of the resonance's centre are as singular: there the law is one
in μ_eff = μ − γε² (:func:`centre_shift`), the distance of half the rotation number of the non-
resonant motion from pπ/q.

**Resummation.** With the parameter m of the complete elliptic integral E(m),

.. math:: |Λ| = \frac{π^2 m}{16 E(m)^2}, \qquad
          ϖ = \frac{π}{2E(m)} \sqrt{1 - m \sin^2(x/2)} \quad (Λ > 0),

and dΛ/dm = π²K(m)/(16 E³) ≠ 0: Λ ↦ m is analytic up to the image of the cut m ≥ 1, whose point next
to 0 is m = 1 itself. The radius of convergence is therefore |Λ| = π²/16, the separatrix; beyond it
the circle is gone. In ε this is the limit of all tongues, ε = (π²μ²/(4v_q))^{1/q}.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import cache

import numpy as np
import numpy.typing as npt
from flint import fmpq, fmpq_poly

from asymptotics.errors import InputError

RADIUS = math.pi**2 / 16
"""|Λ| at the separatrix, and the radius of convergence of the series in Λ."""

Row = dict[int, Fraction]
"""``{k: A_{n,k}}`` at one n, only k ≡ n mod 2."""


def series(order: int) -> list[Row]:
    r"""A_{n,k} for n = 1 … ``order`` by a recurrence.

    The square of ϖ = Σ Λ^n ϖ_n is 2e + 2Λ cos x, so 2ϖ_n + Σ ϖ_i ϖ_{n−i} is a constant for n ≥ 2;
    what the constant is follows from ⟨ϖ_n⟩ = 0.

    Returns
    -------
    list of ``{k: A_{n,k}}``; entry n − 1 is order n.

    >>> series(3)
    [{1: Fraction(1, 1)}, {2: Fraction(-1, 4)}, {1: Fraction(1, 8), 3: Fraction(1, 8)}]
    """
    return [row for row, _ in zip(_rows(), range(_check(order)), strict=False)]


def _rows() -> Iterator[Row]:
    # ϖ_n = (2/4^n) Σ C_k e^{ikx}, C_{−k} = C_k: integers with C_n = −Σ C_i C_{n−i}.
    integers = [{1: 1}]
    while True:
        n = len(integers)
        yield {k: Fraction(v, 4 ** (n - 1)) for k, v in sorted(integers[-1].items())}
        total: dict[int, int] = {}
        for left, right in zip(integers, reversed(integers), strict=True):
            for a, x in left.items():
                for b, y in right.items():
                    for k in (a + b, abs(a - b)):
                        total[k] = total.get(k, 0) - x * y
        integers.append({k: v for k, v in total.items() if k})


@cache
def coefficient(n: int, k: int) -> Fraction:
    r"""A_{n,k} in closed form, a finite sum.

    With u = Λ/(2e): √(1 + 2u cos x) = Σ h_k(u) cos kx, M = h₀, and Λ = u/M², ϖ = Σ (h_k/M) cos kx.
    Lagrange's inversion of the first gives

    .. math:: A_{n,k} = \frac1n [u^{n-1}] (h_k' M - h_k M') M^{2n-2}, \qquad
              h_k = (2 - δ_{k0}) \sum_j \binom{1/2}{k+2j} \binom{k+2j}{j} u^{k+2j}.

    >>> coefficient(3, 1), coefficient(4, 4)
    (Fraction(1, 8), Fraction(-5, 64))
    """
    if _check(n) and (k < 1 or k > n or (n - k) % 2):
        return Fraction(0)
    mean, harmonic = _root_harmonic(0, n), _root_harmonic(k, n)
    rate = harmonic.derivative() * mean - harmonic * mean.derivative()
    value = (rate * _power(mean, 2 * n - 2, n))[n - 1] / n
    return Fraction(int(value.p), int(value.q))


def _root_harmonic(k: int, n: int) -> fmpq_poly:
    """h_k(u) through u^n: harmonic k of √(1 + 2u cos x)."""
    coefficients, binomial = [fmpq(0)] * (n + 1), fmpq(1)
    for i in range(n + 1):
        if i:
            binomial = binomial * (fmpq(3, 2) - i) / i
        if i >= k and (i - k) % 2 == 0:
            coefficients[i] = binomial * math.comb(i, (i - k) // 2) * (2 if k else 1)
    return fmpq_poly(coefficients)


def _power(base: fmpq_poly, exponent: int, length: int) -> fmpq_poly:
    """base^exponent, its first ``length`` coefficients."""
    result = fmpq_poly([1])
    for _ in range(exponent):
        result = fmpq_poly((result * base).coeffs()[:length])
    return result


def elliptic(m: float) -> tuple[float, float]:
    """(K(m), E(m)), 0 ≤ m < 1, by the arithmetic–geometric mean.

    >>> elliptic(0.0)[1] == math.pi / 2, round(elliptic(0.5)[0], 12)
    (True, 1.854074677301)
    """
    a, b, weight = 1.0, math.sqrt(1.0 - m), 1.0
    rest = 0.5 * m
    while abs(a - b) > 4e-16 * a:
        a, b, c = 0.5 * (a + b), math.sqrt(a * b), 0.5 * (a - b)
        rest += weight * c * c
        weight *= 2
    K = 0.5 * math.pi / a
    return K, K * (1.0 - rest)


def parameter(strength: float) -> float:
    """m of |Λ| = π²m/(16 E(m)²); 0 at rest, 1 at the separatrix.

    Raises
    ------
    InputError
        |Λ| ≥ π²/16: beyond the separatrix there is no such state.

    >>> parameter(0.0), round(parameter(0.5), 6)
    (0.0, 0.93539)
    """
    size = abs(strength)
    if not size < RADIUS:
        raise InputError(
            f"|Lambda| = {size!r} is not below π²/16 = {RADIUS:.6g}, the separatrix of the "
            "pendulum: the wave-less state is lost there; give a smaller epsilon or a larger mu"
        )
    if size == 0.0:
        return 0.0
    low, high = 0.0, 1.0
    m = min(4 * size, 0.5)
    for _ in range(200):
        K, E = elliptic(m)
        excess = m * RADIUS / (E * E) - size
        low, high = (m, high) if excess <= 0 else (low, m)
        step = m - excess * E**3 / (RADIUS * K)
        following = step if low < step < high else 0.5 * (low + high)
        # Four units of rounding of m: the bracket or Newton's step cannot shrink below.
        if abs(following - m) <= 8.9e-16 * m:
            break
        m = following
    return m


def momentum(strength: float, x: npt.ArrayLike) -> npt.NDArray[np.float64]:
    r"""ϖ(Λ, x), resummed.

    Parameters
    ----------
    strength
        Λ, of either sign, |Λ| < π²/16.
    x
        qθ, any shape.

    Raises
    ------
    InputError
        Λ at or beyond the separatrix.

    >>> momentum(0.3, [0.0, math.pi]).round(6)
    array([1.283114, 0.668118])
    """
    m = parameter(strength)
    _, E = elliptic(m)
    phase = np.asarray(x, float) + (0.0 if strength >= 0 else math.pi)
    result: npt.NDArray[np.float64] = (
        0.5 * math.pi / E * np.sqrt(1.0 - m * np.sin(0.5 * phase) ** 2)
    )
    return result


def truncated(strength: float, x: npt.ArrayLike, order: int) -> npt.NDArray[np.float64]:
    """ϖ(Λ, x) from its series through Λ^order: what the expansion of order q·``order`` holds."""
    total = np.ones_like(np.asarray(x, float))
    for n, row in enumerate(series(order), start=1):
        for k, value in row.items():
            total = total + strength**n * float(value) * np.cos(k * np.asarray(x, float))
    return total


def _check(order: int) -> int:
    if isinstance(order, bool) or not isinstance(order, int) or order < 1:
        raise InputError(f"order n = {order!r}; the series in Lambda starts at n = 1")
    return order
