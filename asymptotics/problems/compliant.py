r"""A ground that gives way: the rope lies on springs κ, and moves there too.

.. math:: P W = ℓ \;(ξ < ξ_c), \qquad (P + κ) W = ℓ \;(ξ > ξ_c), \qquad W = 0 \text{ at } ξ_c,

W and its first r − 1 derivatives continuous at ξ_c, waves beyond it decaying or carrying energy
away (a unilateral Winkler foundation: springs push, they do not pull). The sign before κ is that of
W_ττ in P.

At rest ∂^d W₀ is continuous for d ≤ r, so at order n the jumps of w_n … ∂^{r−1}w_n follow from
lower orders, and with R the derivatives of the r/2 solutions allowed on the right,

.. math:: (M R)\,c = \text{drive} + M J, \qquad y_L = R c − J, \quad y_R = R c,

M = E e^{−Aξ₀} as in :mod:`asymptotics.problems.fundamental`, J the jumps. W = 0 then gives ξ_n.
Resonances are the zeros of det M R: none, where waves radiate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import sympy
from flint import acb, acb_mat, acb_poly, arb, ctx

from asymptotics.errors import InputError
from asymptotics.problems.enclosed_expressions import enclose
from asymptotics.problems.fundamental import Propagator, magnitude, product, solve
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.varying import value_at
from asymptotics.rings.precision import PrecisionError

Vector = list[acb]


def stiffness(rope: MovingContact, values: Mapping[str, Fraction]) -> acb:
    """±κ, what the springs add to the coefficient of W."""
    size = enclose(rope.springs, values)
    if not (size.real > 0 and size.imag == 0):
        raise InputError(f"springs = {rope.springs}: their stiffness has to be positive")
    inertia = rope.equation.terms.get((0, 2))
    if inertia is None:
        raise InputError(
            "springs: the equation has no W_tautau, and so says not which way they push"
        )
    return size if enclose(inertia, values).real > 0 else -size


def on_springs(coefficients: Sequence[acb], springs: acb) -> tuple[acb, ...]:
    """The coefficients of P + κ."""
    return (coefficients[0] + springs, *coefficients[1:])


def allowed(coefficients: Sequence[acb], growth: Sequence[acb], what: str) -> list[acb]:
    """The exponents λ of the solutions e^{λ(ξ − ξ₀)} that decay or carry energy away.

    Parameters
    ----------
    coefficients
        c_0 … c_r of the equation on the right, at p = ijΩ.
    growth
        dc_k/dp: with a little growth in time an outgoing wave decays, Re dλ/dp < 0.

    Raises
    ------
    InputError
        Not half of them are such.
    PrecisionError
        Too few bits to tell.
    """
    try:
        roots = acb_poly(list(coefficients)).roots(
            tol=arb(2) ** (8 - ctx.prec), maxprec=2 * ctx.prec
        )
    except ValueError:
        raise PrecisionError(f"{what}: exponents on the ground", None) from None
    found = []
    for root in roots:
        real = root.real
        if real.contains(0):
            slope = value_at([k * c for k, c in enumerate(coefficients)][1:], root)
            rate = -value_at(growth, root) / slope
            real = rate.real
            if real.contains(0):
                raise PrecisionError(f"{what}: which way a wave on the ground goes", root)
        if real < 0:
            found.append(root)
    if 2 * len(found) != len(roots):
        raise InputError(
            f"{what}: {len(found)} of {len(roots)} solutions on the ground decay or leave; the "
            "contact needs half of them"
        )
    return found


def powers_of(exponents: Sequence[acb], r: int) -> list[Vector]:
    """Rows ∂^d, d < r, of the columns e^{λ(ξ − ξ₀)} at ξ₀."""
    return [[x**d if d else acb(1) for x in exponents] for d in range(r)]


def real_basis(exponents: Sequence[acb], r: int) -> list[Vector]:
    """The same in real combinations, for exponents that come in conjugate pairs."""
    columns: list[Vector] = []
    for x in exponents:
        powers = [x**d if d else acb(1) for d in range(r)]
        if x.imag.contains(0):
            columns.append([acb(p.real) for p in powers])
        elif x.imag > 0:
            columns += [[acb(p.real) for p in powers], [acb(p.imag) for p in powers]]
    return [list(row) for row in zip(*columns, strict=True)]


def particular(coefficients: Sequence[acb], load: Sequence[acb]) -> list[acb]:
    """W, W′, … of the polynomial solution of Σ c_k ∂^k W = ℓ, from ℓ, ℓ′, … at the same place."""
    found: list[acb] = []
    for value in reversed(load):
        above = sum((c * w for c, w in zip(coefficients[1:], found, strict=False)), acb(0))
        found.insert(0, (value - above) / coefficients[0])
    return found


@dataclass(frozen=True)
class Beyond:
    """The rope at rest on its springs.

    Attributes
    ----------
    propagator
        Of the equation there, with its load at ξ₀.
    basis
        Rows ∂^d of the decaying solutions, real.
    exponents
        Theirs.
    all_forced, forced
        W, W′, … of the polynomial one; as many as an order r has data.
    """

    propagator: Propagator
    basis: list[Vector]
    exponents: list[acb]
    all_forced: list[acb]
    forced: list[acb]

    @classmethod
    def at(cls, propagator: Propagator, springs: acb) -> Beyond:
        """From the equation on the left, with its load at the place in question."""
        there = replace(propagator, coefficients=on_springs(propagator.coefficients, springs))
        r = there.order
        exponents = allowed(there.coefficients, [acb(0)] * (r + 1), "the rope at rest")
        forced = particular(there.coefficients, there.load)
        first = [*forced[:r], *[acb(0)] * (r - len(forced))]
        return cls(there, real_basis(exponents, r), exponents, forced, first)

    def system(
        self, rows: Sequence[Vector], constants: Sequence[acb], left: Propagator, point: arb
    ) -> tuple[list[Vector], list[acb]]:
        """The driven end and W = 0 at ξ₀ as equations for the weights of the decaying solutions."""
        r = left.order
        table = product(rows, left.backwards(point))
        lines, sides = [], []
        for row, constant in zip(table, constants, strict=True):
            lines.append([_dot(row, column) for column in zip(*self.basis, strict=True)])
            load = _dot(row[r:], left.load)
            sides.append(constant - load - _dot(row, self.forced))
        return [*lines, self.basis[0]], [*sides, -self.forced[0]]

    def height(self, lines: list[Vector], sides: list[acb]) -> arb:
        """Zero at the static contact point: one equation more than there are weights."""
        rows = []
        for line, side in zip(lines, sides, strict=True):
            size = max((abs(x).upper() for x in line), key=magnitude)
            rows.append([*(x / acb(size.mid()) for x in line), side / acb(size.mid())])
        return acb_mat(rows).det().real

    def depth(self, state: Sequence[acb], length: arb) -> arb:
        """W at a distance beyond ξ₀, from W … ∂^{r−1}W there."""
        order = len(self.forced)
        weights = solve(
            powers_of(self.exponents, order)[: len(self.exponents)],
            [x - f for x, f in zip(state, self.forced, strict=True)][: len(self.exponents)],
            "the rope at rest on its springs",
        )
        total, power = acb(0), acb(1)
        for d, value in enumerate(self.all_forced):
            total = total + value * power
            power = power * acb(length) / (d + 1)
        for weight, x in zip(weights, self.exponents, strict=True):
            total = total + weight * (x * acb(length)).exp()
        return total.real

    def state(self, lines: list[Vector], sides: list[acb]) -> list[acb]:
        """W … ∂^{r−1}W at ξ₀."""
        weights = solve(lines[:-1], sides[:-1], "the rope at rest on its springs")
        state = [_dot(row, weights) + f for row, f in zip(self.basis, self.forced, strict=True)]
        return [acb(0), *state[1:]]


def _dot(row: Sequence[acb], column: Sequence[acb]) -> acb:
    return sum((x * y for x, y in zip(row, column, strict=False)), acb(0))


def growth_rates(rope: MovingContact, values: Mapping[str, Fraction], j: int, r: int) -> list[acb]:
    """dc_k/dp at p = ijΩ."""
    rate = acb(0, 1) * j * enclose(sympy.Symbol("Omega"), values)
    found = [acb(0)] * (r + 1)
    for (k, t), value in rope.equation.terms.items():
        if t:
            power = rate ** (t - 1) if t > 1 else acb(1)
            found[k] = found[k] + enclose(value, values) * t * power
    return found


def two_sided(
    rows: Sequence[Vector], amplitudes: Sequence[acb], basis: list[Vector], what: str
) -> tuple[list[Vector], Vector]:
    """One harmonic's derivatives at ξ₀, left and then right, per unit jump and driven.

    ``rows`` are M, ``basis`` R.
    """
    r = len(basis)
    block = [[_dot(row, column) for column in zip(*basis, strict=True)] for row in rows]

    def beyond(right: Sequence[acb]) -> Vector:
        weights = solve(block, right, what)
        return [_dot(line, weights) for line in basis]

    jumps = []
    for e in range(r):
        there = beyond([row[e] for row in rows])
        here = [x - 1 if d == e else x for d, x in enumerate(there)]
        jumps.append([*here, *there])
    driven = beyond(amplitudes)
    return jumps, [*driven, *driven]


def annihilators(basis: list[Vector], what: str) -> list[Vector]:
    """Rows that vanish on a basis, solved for their last entries: what is left of other states."""
    r, free = len(basis), len(basis[0])
    upper = [list(row) for row in zip(*basis[:free], strict=True)]
    rows = []
    for d in range(free, r):
        weights = solve(upper, [-x for x in basis[d]], what)
        rows.append([*weights, *(acb(k == d) for k in range(free, r))])
    return rows


def ground_of(made: Any) -> Any:
    """The :class:`~asymptotics.problems.problem.Ground` of an enclosed problem on springs."""
    from asymptotics.problems.problem import Ground

    element, ring, r = made.element, made.ring, made.r

    def residual(j: int, w: Sequence[Any]) -> Any:
        found = on_springs(made.rates(made.rope.equation.terms, j, r + 1), made.springs)
        return ring.sum([element(c) * x for c, x in zip(found, w, strict=True)])

    def reduction(j: int) -> tuple[Any, ...]:
        c = on_springs(made.propagator(j).coefficients, made.springs)
        return tuple(element(-x / c[r]) for x in c[:r])

    def end_residual(j: int, w: Sequence[Any]) -> tuple[Any, ...]:
        return tuple(
            ring.sum([element(c) * x for c, x in zip(row, w, strict=True)])
            for row in annihilators(made.beyond(j), f"harmonic {j} on the ground")
        )

    beyond = made.static_beyond
    return Ground(
        static=lambda d: element(beyond.derivative(d)),
        static_reduction=tuple(map(element, beyond.reduction)),
        reduction=reduction,
        equation_residual=residual,
        load=tuple(map(element, beyond.load)),
        end_residual=end_residual,
    )
