r"""The beam's expansion with its impedances as generators: closed forms for any driven end.

What the order loop needs of a beam is, for each harmonic j, four numbers and for the drive two,

.. math:: w_j'' = Y^j_{20} w_j + Y^j_{21} w_j', \qquad w_j''' = Y^j_{30} w_j + Y^j_{31} w_j',
          \qquad (w'', w''')|_{\text{drive}} = (S_2, S_3),

all at the static contact point ξ₀. Over the polynomials in them the loop gives ξ_n and w_n for
every driven end, β and Ω at once. Two more things make that ring small:

* W is measured in units of a₃ = W₀‴(ξ₀). Then the static derivatives are 1, σ = a₄/a₃ = −2/(βa₃),
  1/β, σ/β, …, nothing is ever divided by, and the small parameter is **ε̂ = ε/a₃**.
* Ω and β enter through b = 1/β and the product b Ω² only, ∂⁴ = b ∂² + j² b Ω².

The first terms, θ = Ωτ:

    ξ₁ = −S₂ cos θ
    ξ₂ = ½S₂S₃ − ¼S₂²(σ + Y⁰₂₁) + [½S₂S₃ − ¼S₂²(σ + Y²₂₁)] cos 2θ

with the contact data w₁ = w₁′ = w₂ = 0, w₂′ = ½ξ₁², w₃ = −ξ₁³/6.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq_mpoly

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.beam import beam_problem, enclosed, static_beam, swept
from asymptotics.problems.beam_waves import StaticBeam
from asymptotics.problems.problem import Mode, Problem, Sweep
from asymptotics.problems.string import RESOLUTION
from asymptotics.rings.bounded import lifted
from asymptotics.rings.numbers import Numbers, doubles
from asymptotics.rings.pickling import Remembered, remembering
from asymptotics.rings.ring import GeneratorRing
from asymptotics.rings.rounding import rounded_value

ENTRIES = ("20", "21", "30", "31")
"""Y^j_{di}: derivative d of the harmonic per unit of its i-th datum."""

SOURCES = ("S2", "S3")
"""What the drive brings in: formulas are sorted by its powers."""


def generator_names(order: int) -> tuple[str, ...]:
    """``sigma, b, B, S2, S3`` and ``Y{j}_{di}`` for j = 0 … order; B = bΩ².

    >>> generator_names(1)[:6], generator_names(1)[-1]
    (('sigma', 'b', 'B', 'S2', 'S3', 'Y0_20'), 'Y1_31')
    """
    impedances = (f"Y{j}_{entry}" for j in range(order + 1) for entry in ENTRIES)
    return ("sigma", "b", "B", "S2", "S3", *impedances)


@remembering
def symbolic_beam(order: int) -> Problem[fmpq_mpoly]:
    """The beam over its generators, for expansions up to ``order``.

    The driven end is what defines the impedances, so its residuals substitute the two definitions;
    and since a₃ is itself a generator, defined by W₀(0) = 1, the static driven end has nothing left
    to prove: :mod:`asymptotics.problems.beam` proves both in numbers.

    Raises
    ------
    InputError
        ``order`` is not a whole number ≥ 1.

    Examples
    --------
    >>> solution = expand(symbolic_beam(2), 2)
    >>> solution.contact(1)
    {1: -1/2*S2}
    >>> solution.contact(2)[2]
    -1/8*sigma*S2^2 - 1/8*S2^2*Y2_21 + 1/4*S2*S3
    """
    ring = GeneratorRing(generator_names(check_order(order)))
    sigma, b, B = ring["sigma"], ring["b"], ring["B"]
    minus = ring.rational(-1)

    @cache
    def static(d: int) -> fmpq_mpoly:
        if d < 3:
            return ring.zero
        value = ring.one if d % 2 else sigma
        for _ in range((d - 3) // 2):
            value = value * b
        return value

    @cache
    def mode(j: int) -> Mode[fmpq_mpoly]:
        y20, y21, y30, y31 = (ring[f"Y{j}_{entry}"] for entry in ENTRIES)
        return Mode(
            (ring.rational(j * j) * B, ring.zero, b, ring.zero),
            ((ring.one, ring.zero, y20, y30), (ring.zero, ring.one, y21, y31)),
            (ring.zero, ring.zero, ring["S2"], ring["S3"]),
        )

    def end_residual(j: int, w: Any) -> tuple[fmpq_mpoly, ...]:
        y20, y21, y30, y31 = (ring[f"Y{j}_{entry}"] for entry in ENTRIES)
        second = ring.sum([w[2], minus * y20 * w[0], minus * y21 * w[1]])
        third = ring.sum([w[3], minus * y30 * w[0], minus * y31 * w[1]])
        return second, third

    return Problem(
        name="beam",
        ring=ring,
        contact_order=3,
        static=static,
        static_reduction=(ring.zero, ring.zero, ring.zero, b, ring.zero),
        mode=mode,
        drive={1: ring.rational(1, 2)},
        inverse_leading=ring.one,
        # Times b: ∂⁴ = b∂² + j²bΩ², with the load 2b = −σ in units of a₃.
        equation_residual=lambda j, w: ring.sum(
            [b * w[2], ring.rational(j * j) * B * w[0], minus * w[4]]
        ),
        end_residual=end_residual,
        end_unit=lambda j: (ring["S2"], ring["S3"]),
        load=(minus * sigma,),
        static_end_residual=lambda a: (),
    )


def expand_symbolic(order: int) -> Expansion[fmpq_mpoly]:
    """The expansion of :func:`symbolic_beam`; over ε̂ = ε/a₃, shapes in units of a₃."""
    return expand(symbolic_beam(order), order)


@dataclass(frozen=True)
class Impedances(Remembered):
    """Values of the generators at one β and Ω, and a₃ to turn ε into ε̂ = ε/a₃.

    ``balls`` makes the same values as balls, in the precision of the moment; where they are arrays,
    ``sweep`` makes them with bounds of their errors.
    """

    values: Mapping[str, Any]
    a3: Any
    balls: Callable[[], Impedances] | None = field(default=None, repr=False)
    sweep: Sweep | None = field(default=None, repr=False)

    def evaluate(self, element: fmpq_mpoly, number: Callable[[int], Any] = float) -> Any:
        """The element's value, term by term.

        Its terms cancel, the more the smaller β is. With ``balls`` a value in doubles is computed
        there and rounded, all digits right (:func:`asymptotics.rings.rounding.rounded_value`); so
        are the points of arrays where less than half the digits are sure.

        >>> point = impedances(0.01, 2.2, 1)
        >>> ring = GeneratorRing(generator_names(1))
        >>> float(point.evaluate(ring["b"] * ring.rational(1, 4)))
        25.0
        """
        if self.balls is not None and number is float:
            exact = self.balls
            return rounded_value(lambda: exact().evaluate(element, arb), f"a value of {element}")
        if self.sweep is not None and number is float:
            return _swept_value(self.sweep, element)
        names = element.context().names()
        total = number(0)
        for powers, coefficient in element.terms():
            term = number(int(coefficient.p)) / int(coefficient.q)
            for name, power in zip(names, powers, strict=True):
                if power:
                    term = term * self.values[name] ** int(power)
            total = total + term
        return total


def _swept_value(sweep: Sweep, element: fmpq_mpoly) -> Any:
    found = lifted(sweep.bounded().evaluate(element, lifted))
    value = np.broadcast_to(found.value, sweep.shape).copy()
    sure = np.broadcast_to(found.error <= RESOLUTION * np.abs(found.value), sweep.shape)
    for index in np.flatnonzero(~sure).tolist():
        value.flat[index] = sweep.at(index).evaluate(element)
    return value


@remembering
def impedances(
    beta: Any,
    omega: Any,
    order: int,
    driven_end: str = "pinned",
    numbers: Numbers | None = None,
    static: StaticBeam | None = None,
) -> Impedances:
    """The generators' values, from the modes of :func:`asymptotics.problems.beam.beam_problem`.

    Parameters
    ----------
    beta, omega, driven_end, numbers, static
        As for :func:`asymptotics.problems.beam.beam_problem`.
    order
        Highest harmonic wanted.

    Raises
    ------
    InputError
        What :func:`asymptotics.problems.beam.beam_problem` raises, or a bad order.

    Examples
    --------
    >>> point = impedances(0.01, 2.2, 2)
    >>> solution = expand_symbolic(2)
    >>> round(float(point.evaluate(solution.contact(2)[2]) / point.a3**2), 8)
    -0.62764207
    """
    order = check_order(order)
    if numbers is None:
        point = impedances(beta, omega, order, driven_end, doubles(), static)

        def made(b: Any, w: Any, end: str, kind: Numbers | None, shape: Any) -> Impedances:
            return impedances(b, w, order, end, kind, shape)

        if not np.ndim(beta) == np.ndim(omega) == 0:
            return replace(point, sweep=swept(beta, omega, driven_end, made))
        at = cache(lambda bits: enclosed(beta, omega, driven_end, made)())
        return replace(point, balls=lambda: at(ctx.prec))
    shape = static_beam(beta, driven_end, numbers) if static is None else static
    problem = beam_problem(shape.beta, omega, driven_end, numbers, shape)
    values = {
        "sigma": -2 / (shape.beta * shape.a3),
        "b": 1 / shape.beta,
        "B": problem.mode(1).reduction[0],
        "S2": problem.mode(1).source[2],
        "S3": problem.mode(1).source[3],
    }
    for j in range(order + 1):
        by_value, by_slope = problem.mode(j).impedance
        entries = (by_value[2], by_slope[2], by_value[3], by_slope[3])
        values |= {f"Y{j}_{entry}": y for entry, y in zip(ENTRIES, entries, strict=True)}
    return Impedances(values, shape.a3)


def contact_amplitude(expansion: Expansion[fmpq_mpoly], n: int, j: int) -> fmpq_mpoly:
    """The coefficient of ε̂ⁿ cos jθ in ξ_c.

    Raises
    ------
    InputError
        The expansion is not one over generators, or does not hold order n.
    """
    if not isinstance(expansion.problem.ring, GeneratorRing):
        raise InputError(
            f"closed forms of the beam need its generators, not {expansion.problem.name}; make the "
            "expansion with expand_symbolic(order)"
        )
    c = expansion.contact(n).get(j, expansion.problem.ring.zero)
    return c if j == 0 else c + c
