r"""Any moving contact with its impedances as generators: one derivation serves all ropes.

A harmonic of order n ≥ 2 is what its contact data make it, and what the order loop asks of it are
derivatives at the static contact point ξ₀,

.. math:: ∂^d w_{n,j} = \sum_{i ≤ m−2} Y^{(j)}_{d,i} ∂^i w_{n,j}, \qquad
          ∂^d w_{1,j} = S^{(j)}_d, \qquad ∂^d W_0 = a_m α_d .

The impedances Y, the sources S and the static derivatives α_d = a_d/a_m are all that differs from
one rope to the next: neither the order r of its equation nor its coefficients occur. So over the
polynomials in them the loop is run once for a number m of contact conditions and a set of drive
harmonics, whatever the rope; a rope only supplies the values (:func:`values_of`).

W is measured in units of a_m, so that nothing is divided by; the small parameter is ε̂ = ε/a_m, and
S⁽ʲ⁾_d are the derivatives per unit of ε of the harmonic's cosine amplitude: w₁ = Re Σ S⁽ʲ⁾ e^{ijθ}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.problems.problem import Mode, Problem
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import GeneratorRing

Kind = Literal["static", "source", "impedance"]


@dataclass(frozen=True, order=True)
class Generator:
    """One number that tells a rope from another.

    Attributes
    ----------
    kind
        ``static``: α_d; ``source``: S⁽ʲ⁾_d; ``impedance``: Y⁽ʲ⁾_{d,i}.
    derivative
        d.
    harmonic, datum
        j and i; 0 where there is none.
    conjugate
        Whether it is the complex conjugate of that.
    """

    kind: Kind
    derivative: int
    harmonic: int = 0
    datum: int = 0
    conjugate: bool = False

    @property
    def name(self) -> str:
        """As an identifier.

        >>> Generator("impedance", 3, 2, 1).name, Generator("source", 2, 1, conjugate=True).name
        ('Y2_3_1', 'S1_2_')
        """
        d, mark = self.derivative, "_" if self.conjugate else ""
        if self.kind == "static":
            return f"alpha{d}"
        if self.kind == "source":
            return f"S{self.harmonic}_{d}{mark}"
        return f"Y{self.harmonic}_{d}_{self.datum}{mark}"


@dataclass(frozen=True)
class Generators:
    """What tells all ropes of a kind apart, up to an order.

    Attributes
    ----------
    contact_order
        m.
    drive
        The driven harmonics, increasing.
    order
        N.
    even
        Whether all are real: no odd ∂_τ, no sine in the drive.
    """

    contact_order: int
    drive: tuple[int, ...]
    order: int
    even: bool

    @property
    def depth(self) -> int:
        """How many derivatives of a harmonic the loop may ask for."""
        return self.order + self.contact_order - 1

    def listed(self) -> list[Generator]:
        """All of them, in the order of the ring's generators.

        >>> [generator.name for generator in Generators(2, (1,), 2, True).listed()]
        ['S1_1', 'S1_2', 'alpha3', 'Y0_1_0', 'Y2_1_0']
        """
        m, N = self.contact_order, self.order
        found: list[Generator] = []
        for j in self.drive:
            found += self._paired("source", range(m - 1, self.depth), j, 0)
        found += [Generator("static", d) for d in range(m + 1, N + m)]
        later = {j for n in range(2, N + 1) for j in reachable(self.drive, n)}
        for j in sorted(later):
            for i in range(m - 1):
                found += self._paired("impedance", range(m - 1, max(m, N + m - 2)), j, i)
        return found

    def _paired(self, kind: Kind, derivatives: range, j: int, i: int) -> list[Generator]:
        marks = (False,) if self.even or j == 0 else (False, True)
        return [Generator(kind, d, j, i, mark) for d in derivatives for mark in marks]


@remembering
def generator_rope(generators: Generators) -> Problem[Any]:
    """The problem over polynomials in a rope's generators, for expansions up to its order.

    What a generator is, the rope says: the equation and its driven end define them and have nothing
    left to prove here. What an order's proof shows of it is the contact.

    Raises
    ------
    InputError
        An order that is no whole number ≥ 1, or a drive without harmonics ≥ 0.

    Examples
    --------
    ξ₁ = −S₁ cos θ for every rope with W = W_ξ = 0 at the contact point (m = 2):

    >>> from asymptotics import expand
    >>> solution = expand(generator_rope(Generators(2, (1,), 2, True)), 2)
    >>> solution.contact(1)
    {1: -1/2*S1_1}
    >>> solution.contact(2)[2]
    -1/8*S1_1^2*alpha3 - 1/8*S1_1^2*Y2_1_0 + 1/4*S1_1*S1_2
    """
    check_order(generators.order)
    m, depth = generators.contact_order, generators.depth
    drive = list(generators.drive)
    if not drive or drive != sorted(set(drive)) or drive[0] < 0:
        raise InputError(f"drive harmonics {drive}: give whole numbers ≥ 0, each once, increasing")
    listed = generators.listed()
    known = {generator.name for generator in listed}
    conjugates: dict[str, tuple[int, str]] = {}
    for generator in listed:
        if generator.name + "_" in known:
            conjugates |= {
                generator.name: (1, generator.name + "_"),
                generator.name + "_": (1, generator.name),
            }
    ring = GeneratorRing([generator.name for generator in listed], conjugates)

    def value(generator: Generator) -> Any:
        # What lies beyond is never asked for up to its order.
        return ring[generator.name] if generator.name in known else ring.zero

    @cache
    def static(d: int) -> Any:
        if d <= m:
            return ring.one if d == m else ring.zero
        return value(Generator("static", d))

    @cache
    def mode(j: int) -> Mode[Any]:
        rows = []
        for i in range(m - 1):
            data = [ring.one if d == i else ring.zero for d in range(m - 1)]
            rest = [value(Generator("impedance", d, j, i)) for d in range(m - 1, depth)]
            rows.append((*data, *rest))
        forced = [value(Generator("source", d, j)) for d in range(m - 1, depth)]
        return Mode((ring.zero,) * depth, tuple(rows), (*[ring.zero] * (m - 1), *forced))

    def end_residual(j: int, w: Sequence[Any]) -> tuple[Any, ...]:
        minus, rows = ring.rational(-1), mode(j).impedance
        return tuple(
            ring.sum([w[d], *(minus * row[d] * w[i] for i, row in enumerate(rows))])
            for d in range(m - 1, depth)
        )

    half = ring.rational(1, 2)
    return Problem(
        name=f"m = {m} contact conditions, harmonics {drive}, order {generators.order}, "
        + ("even" if generators.even else "complex"),
        ring=ring,
        contact_order=m,
        static=static,
        static_reduction=(ring.zero,) * (depth + 1),
        mode=mode,
        drive={j: half if j else ring.one for j in drive},
        inverse_leading=ring.one,
        equation_residual=lambda j, w: ring.zero,
        end_residual=end_residual,
        end_unit=lambda j: mode(j).source[m - 1 :],
        load=(),
        static_end_residual=lambda a: (),
    )


def values_of(problem: Problem[Any], generators: Generators) -> dict[str, Any]:
    """What a problem over numbers makes of the generators.

    Examples
    --------
    >>> from asymptotics.problems.string import float_string
    >>> values = values_of(float_string(2.2, 2), Generators(2, (1,), 2, True))
    >>> sorted(values), values["alpha3"]
    (['S1_1', 'S1_2', 'Y0_1_0', 'Y2_1_0', 'alpha3'], 0.0)
    """
    ring = problem.ring
    towers: dict[tuple[int, int | None], list[Any]] = {}

    def derivative(j: int, datum: int | None, d: int) -> Any:
        mode = problem.mode(j)
        start = mode.source if datum is None else mode.impedance[datum]
        tower = towers.setdefault((j, datum), list(start))
        while len(tower) <= d and problem.varying is not None:
            weights = problem.varying.weights(j, len(tower))
            tower.append(ring.sum([chi * x for chi, x in zip(weights, tower, strict=True)]))
        while len(tower) <= d:
            below = tower[-len(mode.reduction) :]
            products = [chi * x for chi, x in zip(mode.reduction, below, strict=True)]
            tower.append(ring.sum(products))
        return tower[d]

    def value(generator: Generator) -> Any:
        d, j = generator.derivative, generator.harmonic
        if generator.kind == "static":
            return problem.static(d) * problem.inverse_leading
        if generator.kind == "impedance":
            return derivative(j, generator.datum, d)
        amplitude = problem.drive[j]
        return (amplitude + amplitude if j else amplitude) * derivative(j, None, d)

    return {
        generator.name: ring.conjugate(value(generator))
        if generator.conjugate
        else value(generator)
        for generator in generators.listed()
    }
