r"""Equations whose coefficients are polynomials in ξ, over balls: tension or mass that varies.

Harmonics are Taylor series in short steps. In a disc of radius R around a place let α bound the
norm of the companion matrix, from the coefficients' own Taylor series; then what a state y grows to
in the disc is at most |y|e^{αR}, and by Cauchy's estimate the terms from the N-th on of its series
at |t| ≤ R/4 are together at most

.. math:: |y|\, e^{αR}\, \frac{4^{−N}}{1 − 1/4} .

Derivatives at the static contact point follow from the equation differentiated (Leibniz' rule).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, comb, factorial, log2, perm
from typing import Any

import sympy
from flint import acb, acb_mat, arb, ctx

from asymptotics.errors import InputError
from asymptotics.problems.enclosed_expressions import enclose
from asymptotics.rings.precision import PrecisionError

Polynomial = list[acb]
"""Coefficients of 1, ξ, ξ², …."""

_GROWTH = 2.0
"""αR at most: longer steps need more terms, shorter ones more of them."""


def polynomial(expression: sympy.Expr, xi: sympy.Symbol, values: Mapping[str, Fraction]) -> Any:
    """An expression's coefficients of 1, ξ, …, as balls."""
    if not expression.has(xi):
        return [enclose(expression, values)]
    return [enclose(c, values) for c in sympy.Poly(expression, xi).all_coeffs()[::-1]]


def shifted(coefficients: Sequence[acb], place: acb) -> Polynomial:
    """The polynomial in t = ξ − place."""
    found = list(coefficients)
    for start in range(len(found) - 1):
        for i in range(len(found) - 2, start - 1, -1):
            found[i] = found[i] + place * found[i + 1]
    return found


def value_at(coefficients: Sequence[acb], place: acb) -> acb:
    """The polynomial's value."""
    total = acb(0)
    for c in reversed(coefficients):
        total = total * place + c
    return total


def derivatives(coefficients: Sequence[acb], place: acb) -> list[acb]:
    """Its value and all derivatives there."""
    found, factorial = [], 1
    for i, c in enumerate(shifted(coefficients, place)):
        factorial *= i or 1
        found.append(c * factorial)
    return found


@dataclass(frozen=True)
class VaryingPropagator:
    """The equation Σ c_k(ξ) ∂^k w = ℓ(ξ) as :class:`~asymptotics.problems.fundamental.Propagator`.

    Attributes
    ----------
    polynomials
        c_0 … c_r.
    right
        ℓ; empty for a harmonic.
    point
        ξ₀, where derivatives are asked for.
    known
        Place ↦ the way from there to 0, in this precision; shared by propagators of one equation.
    """

    polynomials: tuple[Polynomial, ...]
    right: Polynomial
    point: arb
    known: dict[float, acb_mat] = field(default_factory=dict, repr=False, compare=False)

    @property
    def order(self) -> int:
        """r."""
        return len(self.polynomials) - 1

    @property
    def coefficients(self) -> tuple[acb, ...]:
        """c_0 … c_r at ξ₀."""
        return tuple(value_at(c, acb(self.point)) for c in self.polynomials)

    @property
    def load(self) -> tuple[acb, ...]:
        """ℓ, ℓ′, … at ξ₀."""
        return tuple(derivatives(self.right, acb(self.point))) if self.right else ()

    def backwards(self, length: arb) -> acb_mat:
        """The states at ξ = 0 from those at ξ₀ = ``length``; what is known helps."""
        exact = length.rad() == 0
        place = float(length.mid())
        nearest = max((x for x in self.known if x <= place), default=0.0)
        found = self.between(length, arb(nearest))
        if nearest:
            found = self.known[nearest] * found
        if exact and arb(place) == length:
            self.known[place] = found
        return found

    def stepwise(self, length: arb) -> acb_mat:
        """The same from the other end: the way there, inverted. For the proof."""
        try:
            return self.between(arb(0), length).inv()
        except ZeroDivisionError:
            raise PrecisionError("the way back from the driven end", None) from None

    def steps(self, length: arb, count: int) -> Iterator[acb_mat]:
        """From ξ₀ = ``length`` to 0 in equal steps."""
        for i in range(count):
            yield self.between(length * (count - i) / count, length * (count - i - 1) / count)

    def between(self, start: arb, end: arb) -> acb_mat:
        """The states at one place from those at another."""
        size = self.order + len(self.right)
        total = acb_mat([[acb(i == k) for k in range(size)] for i in range(size)])
        here = start.mid() if start.rad() == 0 else start
        left = float((end - start).mid())
        # In a ball of places the last step goes to the end's ball itself.
        while left:
            step = self._step(here, left)
            last = step == left
            to = end if last else here + arb(step)
            total = self._carry(here, to) * total
            here, left = to, 0.0 if last else float((end - to).mid())
        return total

    def _step(self, here: arb, left: float) -> float:
        """A step towards the end whose disc, four times as wide, the solution grows little in."""
        size = abs(left)
        for _ in range(200):
            if self._growth(here, 4 * size)[0] <= _GROWTH:
                return left if size == abs(left) else size * (1 if left > 0 else -1)
            size /= 2
        raise InputError(
            f"equation: the coefficient of the highest derivative in ξ vanishes near xi = "
            f"{float(here.mid()):.6g}, where the order of the equation drops"
        )

    def _growth(self, here: arb, radius: float) -> tuple[float, float, float]:
        """(αR, ρ, |c_r|): the bound on the growth in a disc, in units ρ^k of the k-th derivative,
        and one on the leading coefficient from below."""
        bounds = []
        for c in self.polynomials:
            local = shifted(c, acb(here))
            bounds.append(sum(float(abs(x).upper()) * radius**i for i, x in enumerate(local)))
        top = shifted(self.polynomials[-1], acb(here))
        least = float(abs(top[0]).lower())
        least -= sum(float(abs(x).upper()) * radius**i for i, x in enumerate(top) if i)
        if not least > 0:
            return float("inf"), 1.0, 0.0
        r = self.order
        rate = max([1.0, *((bounds[k] / least) ** (1 / (r - k)) for k in range(r))])
        row = sum(bounds[k] / least / rate ** (r - 1 - k) for k in range(r))
        return radius * max(rate, row) * (1 + 1e-9), rate, least

    def _disc(self, here: arb, step: float) -> tuple[float, float, float, float]:
        """A radius R ≥ 4·step as large as the growth allows, and what :meth:`_growth` says there.

        The wider the disc, the faster the terms of a short step fall off.
        """
        radius = 4 * step
        found = (radius, *self._growth(here, radius))
        while radius < 1e6:
            wider = self._growth(here, 2 * radius)
            if wider[0] > max(_GROWTH, found[1]):
                break
            radius *= 2
            found = (radius, *wider)
        return found

    def _carry(self, here: arb, to: arb) -> acb_mat:
        """One step of Taylor's series, with the bound on what is left of it."""
        r, p = self.order, len(self.right)
        t = acb(to - here)
        size = float(abs(t).upper())
        radius, growth, rate, least = self._disc(here, size)
        ratio = size / radius
        terms = ceil((ctx.prec + 8) / -log2(ratio)) + 2
        local = [shifted(c, acb(here)) for c in self.polynomials]
        entries = [(k, i, x) for k, c in enumerate(local) for i, x in enumerate(c) if x != 0]
        right = shifted(self.right, acb(here)) if p else []
        columns = [_series(entries, r, [], k, terms) for k in range(r)]
        # The load's own states are ℓ^{(q)} at the place the step begins: ℓ = Σ ℓ^{(q)} t^q/q!.
        columns += [_series(entries, r, [*[0] * q, 1], None, terms) for q in range(len(right))]
        tail = abs(arb(growth)).exp() * (r + p + 1) / (1 - ratio)
        found = [[acb(0)] * (r + p) for _ in range(r + p)]
        for column, series in enumerate(columns):
            divisor = factorial(max(column - r, 0))
            current = series
            for d in range(r):
                total = acb(0)
                for x in reversed(current):
                    total = total * t + x
                current = [n * x for n, x in enumerate(current)][1:]
                # In units rate^k the state that the column starts from has size 1/rate^column;
                # a load t^q makes one of at most R^{q+1}/|c_r| in the disc.
                left = tail * arb(ratio) ** (terms + r - 1 - d)
                left = left * arb(rate) ** (d - min(column, r - 1))
                if column >= r:
                    left = left * arb(radius) ** (column - r + 1) / arb(least)
                bound = arb(0, float(left.upper()))
                found[d][column] = (total + acb(bound, bound)) / divisor
        for q in range(p):
            power = acb(1)
            for i in range(q, p):
                found[r + q][r + i] = power / factorial(i - q)
                power = power * t
        return acb_mat(found)


def _series(
    entries: Sequence[tuple[int, int, acb]],
    r: int,
    load: Sequence[int],
    unit: int | None,
    terms: int,
) -> list[acb]:
    """Taylor coefficients of the solution with one unit derivative, or one power as load.

    ``entries`` are the non-zero coefficients (k, i, c_{k,i}) of t^i ∂^k.
    """
    series = [acb(0)] * (terms + r)
    if unit is not None:
        series[unit] = acb(1) / factorial(unit)
    (leading,) = (x for k, i, x in entries if k == r and i == 0)
    others = [(k, i, x / leading) for k, i, x in entries if (k, i) != (r, 0)]
    for n in range(terms):
        total = load[n] / leading if n < len(load) and load[n] else acb(0)
        for k, i, x in others:
            if i <= n and series[n - i + k] != 0:
                total = total - x * series[n - i + k] * perm(n - i + k, k)
        series[n + r] = total / perm(n + r, r)
    return series


def weights(at: Sequence[Sequence[acb]], d: int) -> list[acb]:
    """∂^d w, d ≥ r, in terms of w … ∂^{d−1}w, from derivatives c_k^{(i)} at the place.

    From Σ_k Σ_i C(q, i) c_k^{(i)} w^{(k+q−i)} = 0 with q = d − r.
    """
    found = differentiated(at, d - len(at) + 1)
    leading = found.pop()
    return [-x / leading for x in found]


def differentiated(at: Sequence[Sequence[acb]], q: int) -> list[acb]:
    """The weights of w … w^{(r+q)} in the q-th derivative of Σ c_k ∂^k w."""
    r = len(at) - 1
    found = [acb(0)] * (r + q + 1)
    for k, rates in enumerate(at):
        for i, x in enumerate(rates[: q + 1]):
            found[k + q - i] = found[k + q - i] + comb(q, i) * x
    return found
