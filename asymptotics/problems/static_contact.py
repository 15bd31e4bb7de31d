r"""The static shape of a reader's rope: where it meets the ground, and whether it may.

In W − g the rope at rest has y(ξ₀) = (0, …, 0, a_m, …, a_{r−1}). With Y = e^{−Aξ₀}, the load in the
matrix, the n conditions at the driven end are linear in the n − 1 numbers a_m, …, so that one
scalar equation is left for ξ₀:

.. math:: F(ξ_0) = \det\,[\,M_{\cdot m}\; …\; M_{\cdot, r−1} \;|\; E p(ξ_0) − d\,] = 0

with p the part of y(0) that is due to the load alone. Of its zeros the smallest with a shape above
the ground is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
from flint import acb, acb_mat, arb, ctx

from asymptotics.errors import InputError
from asymptotics.problems.compliant import on_springs
from asymptotics.problems.fundamental import Propagator
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.rest import (
    SAMPLES,
    Rest,
    Values,
    rates_of,
    rest_of,
)
from asymptotics.problems.varying import (
    VaryingPropagator,
    differentiated,
    polynomial,
    value_at,
)
from asymptotics.rings.precision import PrecisionError, at_precision

# Where zeros are looked for, in units of x₀: a rope that is lifted over less or more of it has its
# lengths measured in the wrong unit.
NEAREST, FARTHEST = 1e-3, 1e3
_SCAN = 400
_MOST_BITS = 1 << 13


@dataclass(frozen=True)
class StaticData:
    """The static shape at one precision.

    Attributes
    ----------
    point
        ξ₀.
    propagator
        Of the equation at rest, with its load.
    load
        ℓ, ℓ′, … at ξ₀.
    first
        a_0 … a_{r−1}.
    constants
        d of each condition.
    reduction
        ∂^R on the static shape in terms of lower derivatives.
    """

    point: arb
    propagator: Propagator | VaryingPropagator
    load: tuple[acb, ...]
    first: tuple[acb, ...]
    constants: tuple[acb, ...]
    reduction: tuple[acb, ...]

    def on_springs(self, springs: acb) -> StaticData:
        """The same from the right, where springs add to the coefficient of W."""
        assert isinstance(self.propagator, Propagator)
        there = replace(
            self.propagator, coefficients=on_springs(self.propagator.coefficients, springs)
        )
        return replace(
            self, propagator=there, reduction=static_reduction(there.coefficients, len(self.load))
        )

    def derivative(self, d: int) -> acb:
        """a_d, from ℓ and the equation differentiated."""
        tower, r = list(self.first), self.propagator.order
        while len(tower) <= d:
            q = len(tower) - r
            load = self.load[q] if q < len(self.load) else acb(0)
            *lower, leading = differentiated(self.rates(), q)
            below = sum((c * w for c, w in zip(lower, tower, strict=True)), acb(0))
            tower.append((load - below) / leading)
        return tower[d]

    def rates(self) -> list[list[acb]]:
        """c_k and their derivatives at ξ₀."""
        return rates_of(self.propagator)


def static_reduction(c: Sequence[acb], p: int) -> tuple[acb, ...]:
    """∂^{r+p} on solutions of Σ c_k ∂^k W = ℓ, ∂^p ℓ = 0, in terms of lower derivatives."""
    r = len(c) - 1
    return (*[acb(0)] * p, *(-c[k] / c[r] for k in range(r)))


@lru_cache(maxsize=256)
def bracket(rope: MovingContact, values: Values) -> tuple[float, float]:
    """Two places around ξ₀: the smallest zero of F with a shape above the ground.

    Raises
    ------
    InputError
        There is none, with what was wrong with the zeros that there are; or a ground that would
        have to pull.
    """
    given, why, bits = dict(values), [], 64
    places = np.geomspace(NEAREST, FARTHEST, _SCAN).tolist()
    before: tuple[float, bool] | None = None
    for place in places:
        try:
            sign, bits = _sign(rope, given, place, bits)
        except PrecisionError:
            why.append(f"beyond xi = {place:.3g} layers are too thin to look")
            break
        except InputError as error:  # a leading coefficient that vanishes there
            why.append(str(error))
            break
        if before is not None and before[1] != sign:
            wrong = _inadmissible(rope, given, (before[0], place), bits)
            if wrong is None:
                _check_reaction(rope, given, before[0])
                return before[0], place
            why.append(wrong)
        before = place, sign
    raise InputError(
        f"there is no static shape above the ground with {NEAREST} < xi_0 < {FARTHEST}"
        + (": " + "; ".join(why) if why else "; look at the load and at the driven end's constant")
    )


def _sign(
    rope: MovingContact, values: Mapping[str, Fraction], place: float, bits: int
) -> tuple[bool, int]:
    """Whether F > 0 at a place, and the bits that it took."""
    while bits <= _MOST_BITS:
        with at_precision(bits):
            value = rest_of(rope, values).height(arb(place))
            if value > 0 or value < 0:
                return bool(value > 0), bits
        bits *= 2
    raise PrecisionError("the sign", None)


def _inadmissible(
    rope: MovingContact, values: Mapping[str, Fraction], ends: tuple[float, float], bits: int
) -> str | None:
    """Why the zero of F between two places is no rope on a ground; None if it is."""
    while bits <= 2 * _MOST_BITS:
        bits *= 2
        with at_precision(bits):
            try:
                rest = rest_of(rope, values)
                point = enclosed_root(rest.height, *ends)
                heights = _heights(rest, point)
            except PrecisionError:
                continue
            lifted = rest.lifted_beyond(point)
            if lifted is not None:
                return (
                    f"the shape that meets the springs at xi = {float(point):.6g} is above them "
                    f"at xi = {lifted:.3g}, where they would have to pull"
                )
            below = [i for i, height in enumerate(heights) if height < 0]
            if below:
                place = float(point) * (1 - (below[0] + 1) / SAMPLES)
                return (
                    f"the shape that meets the ground at xi = {float(point):.6g} is below it at "
                    f"xi = {place:.3g}"
                )
            if all(height > 0 for height in heights[:-1]):
                return None
    return f"the shape that meets the ground near xi = {ends[0]:.6g} lies on it"


def _heights(rest: Rest, point: arb) -> list[arb]:
    """W₀ − g at equal steps from next to the contact point to the driven end."""
    equation = rest.propagator(point)
    state = acb_mat([[x] for x in (*rest.first(point), *equation.load)])
    found = []
    for step in equation.steps(point, SAMPLES):
        state = step * state
        found.append(state[0, 0].real)
    return found


def _check_reaction(rope: MovingContact, values: Mapping[str, Fraction], contact: float) -> None:
    """The ground must not pull where the rope lies: what carries the load there is ≥ 0."""
    inertia = rope.equation.terms.get((0, 2))
    if inertia is None:
        return  # nothing says which way the equation's right-hand side pushes
    with at_precision(64):
        mass = polynomial(inertia, rope.letters.xi, values)
        sign = 1.0 if value_at(mass, acb(contact)).real > 0 else -1.0
        load = [-sign * float(x.real.mid()) for x in Rest(rope, values).load]
    roots = np.roots(load[::-1])
    turning = sorted(float(x.real) for x in roots if abs(x.imag) < 1e-12 and x.real > contact)
    ends = [contact, *turning]
    places = [(a + b) / 2 for a, b in zip(ends, [*turning, 2 * ends[-1] + 1], strict=True)]

    def reaction(place: float) -> float:
        return float(np.polyval(load[::-1], place))

    worst = min([contact, *places], key=reaction)
    if reaction(worst) < 0:
        raise InputError(
            f"the ground would have to pull at xi = {worst:.4g}, where the rope lies on it: its "
            f"reaction there is {reaction(worst):.3g}; let the ground fall less, or the load be "
            "larger"
        )


def at_rest(rope: MovingContact, values: Mapping[str, Fraction]) -> Values:
    """The parameters that the static shape depends on."""
    names: set[str] = set()
    expressions = [value for (_, t), value in rope.equation.terms.items() if not t]
    expressions.append(rope.equation.right)
    for condition in rope.driven_end:
        expressions += [value for (_, t), value in condition.terms.items() if not t]
        expressions.append(condition.constant)
    expressions.append(rope.springs)
    if (0, 2) in rope.equation.terms:
        expressions.append(rope.equation.terms[0, 2])
    for expression in expressions:
        names |= {symbol.name for symbol in expression.free_symbols}
    return tuple((name, value) for name, value in sorted(values.items()) if name in names)


def check_static_shape(rope: MovingContact, values: Mapping[str, Fraction]) -> None:
    """Raise what :func:`bracket` raises."""
    bracket(rope, at_rest(rope, values))


def static_data(rope: MovingContact, values: Mapping[str, Fraction]) -> StaticData:
    """The static shape in the precision of the moment.

    Raises
    ------
    PrecisionError
        Too few bits.
    """
    return _static_data(rope, at_rest(rope, values), ctx.prec)


@lru_cache(maxsize=256)
def _static_data(rope: MovingContact, given: Values, bits: int) -> StaticData:
    rest = rest_of(rope, dict(given))
    lower, upper = bracket(rope, given)
    point = enclosed_root(rest.height, lower, upper)
    equation = rest.propagator(point)
    load = equation.load or (acb(0),)
    reduction = static_reduction(equation.coefficients, len(load))
    return StaticData(point, equation, load, tuple(rest.first(point)), rest.constants, reduction)


def enclosed_root(function: Callable[[arb], arb], lower: float, upper: float) -> arb:
    """A ball around the simple zero between two places where the function's signs differ."""
    low, high = arb(lower), arb(upper)
    rising = bool(function(high) > 0)
    x, before = (low + high) / 2, low
    f_before = function(before)
    for _ in range(200):
        x = x.mid()
        value = function(x)
        slope = (value - f_before).mid() / (x - before).mid()
        before, f_before = x, value
        step = (value.mid() / slope).mid() if slope != 0 else arb(0)
        new = (x - step).mid()
        if value > 0 or value < 0:
            if bool(value > 0) == rising:
                high = x
            else:
                low = x
        if not (new > low and new < high):
            new = ((low + high) / 2).mid()
        if not abs(new - x) > x * arb(2) ** (4 - ctx.prec):
            x = new
            break
        x = new
    bits = 4
    while bits < ctx.prec:
        radius = abs(x) * arb(2) ** (bits - ctx.prec)
        left, right = function(x - radius), function(x + radius)
        if (left < 0 and right > 0) or (left > 0 and right < 0):
            return arb(x, radius)
        bits += max(4, bits // 4)
    raise PrecisionError(f"{ctx.prec} bits are too few to enclose the static contact point", x)
