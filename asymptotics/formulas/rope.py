r"""Closed forms of any rope that was written down, in its impedances.

Through order N

.. math:: ξ_c = ξ_0 + \mathrm{Re} \sum_{n=1}^{N} \hat ε^n \sum_{j ≥ 0} ξ_{n,j} e^{ijθ}, \qquad
          W = W_0 + \mathrm{Re} \Bigl[ε \sum_j Λ_j(ξ) e^{ijθ}
          + a_m \sum_{n=2}^{N} \hat ε^n \sum_j \sum_{i ≤ m−2} u^{(i)}_{n,j} Φ^{(j)}_i(ξ)
          e^{ijθ}\Bigr],

ε̂ = ε/a_m, with polynomials ξ_{n,j} and u in the generators of
:mod:`asymptotics.problems.generators`. Φ_i^{(j)} meets the driven end at rest and has
∂^k Φ_i = δ_ki at ξ₀ for k ≤ m − 2; Λ_j has no contact data and the drive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import sympy
from flint import fmpq_mpoly

from asymptotics.errors import InputError
from asymptotics.expansion.certificates import Proof
from asymptotics.expansion.order_loop import Expansion, Progress, expand
from asymptotics.expansion.proof import prove
from asymptotics.problems.generators import Generator, Generators, generator_rope, values_of
from asymptotics.problems.moving_contact import MovingContact


@dataclass(frozen=True, eq=False)
class RopeForms:
    """The closed forms of one rope; made by :func:`rope_forms`.

    Attributes
    ----------
    rope
        As it was written down.
    generators
        Which numbers tell it from others of its kind.
    expansion
        Over the polynomials in them.
    """

    rope: MovingContact
    generators: Generators
    expansion: Expansion[fmpq_mpoly]

    @property
    def order(self) -> int:
        """N."""
        return self.expansion.order

    @cached_property
    def sources(self) -> list[str]:
        """The generators that the drive brings in: formulas are sorted by their powers."""
        return [g.name for g in self.generators.listed() if g.kind == "source"]

    def contact(self, n: int, j: int) -> fmpq_mpoly:
        """ξ_{n,j}; zero where there is none."""
        c = self.expansion.contact(n).get(j, self.expansion.problem.ring.zero)
        return c if j == 0 else c + c

    def data(self, n: int, j: int) -> tuple[fmpq_mpoly, ...]:
        """u^{(0)}_{n,j}, …, u^{(m−2)}_{n,j}."""
        values = self.expansion.shape(n)[j][: self.generators.contact_order - 1]
        return values if j == 0 else tuple(u + u for u in values)

    def places(self) -> list[tuple[int, int]]:
        """(n, j) of all ξ_{n,j}."""
        N = self.order
        return [(n, j) for n in range(1, N + 1) for j in sorted(self.expansion.contact(n))]

    def shapes(self) -> list[tuple[int, int]]:
        """(n, j) of all u_{n,j}, n ≥ 2, that do not vanish."""
        found = [(n, j) for n in range(2, self.order + 1) for j in sorted(self.expansion.shape(n))]
        return [place for place in found if any(not u.is_zero() for u in self.data(*place))]

    def prove(self, progress: Progress | None = None) -> Proof:
        """Each order put back into the contact conditions, whatever the generators' values.

        The equation and the driven end, which define the generators, are proved in numbers: see
        :func:`asymptotics.prove` of ``expand(rope, …, at=…)``.
        """
        return prove(self.expansion, progress=progress)

    def closed_contact(self, n: int, j: int) -> sympy.Expr:
        """The coefficient of ε^n e^{ijΩτ} in ξ_c in closed form; its real part counts for j > 0.

        In the parameters, Ω and ξ₀, for an equation of second order with W given at the driven end.

        Raises
        ------
        InputError
            Another equation, or coefficients that vary.

        Examples
        --------
        >>> from asymptotics.problems.presets import string
        >>> rope_forms(string(foundation=sympy.Symbol("kappa")), 1).closed_contact(1, 1)
        sqrt(Omega**2 - kappa)/(2*sin(xi_0*sqrt(Omega**2 - kappa)))
        """
        closed = _SecondOrder(self.rope)
        total = sympy.Integer(0)
        kinds = {g.name: g for g in self.generators.listed()}
        for powers, coefficient in self.contact(n, j).terms():
            term = sympy.Rational(int(coefficient.p), int(coefficient.q))
            for name, power in zip(kinds, powers, strict=True):
                if power:
                    term *= closed.value(kinds[name]) ** int(power)
            total += term
        return total / closed.static(2) ** n

    def values(self, at: Mapping[Any, Any]) -> dict[str, Any]:
        """The generators' values, and a_m as ``a_m``, at values of the rope's parameters.

        Raises
        ------
        InputError, PrecisionError
            As :meth:`~asymptotics.problems.moving_contact.MovingContact.at`.

        Examples
        --------
        >>> from asymptotics.problems.presets import string
        >>> from asymptotics.rings.ring import FloatRing
        >>> forms = rope_forms(string(foundation=1.7), 2)
        >>> values = forms.values({"Omega": 2.2})
        >>> ring = forms.expansion.problem.ring
        >>> found = ring.evaluate(forms.contact(2, 2), values, FloatRing())
        >>> round(found / values["a_m"] ** 2, 12)
        -0.794087307576
        """
        problem = self.rope.at(at)
        return {**values_of(problem, self.generators), "a_m": 1 / problem.inverse_leading}


class _SecondOrder:
    """The generators of c_2 W″ + c_1 W′ + c_0 W = ℓ with W = d at the driven end.

    With 2c₂μ = c₁ and k² = c₀/c₂ − μ²: Y₁ = k cot kξ₀ − μ, S₁ = −d k e^{−μξ₀}/sin kξ₀, and their
    limits where k = 0.
    """

    def __init__(self, rope: MovingContact) -> None:
        ends = [set(condition.terms) for condition in rope.driven_end]
        if rope.order != 2 or rope.contact_order != 2 or rope.varying or ends != [{(0, 0)}]:
            raise InputError(
                f"{rope}: closed forms are of equations of second order with constant coefficients "
                "and W given at the driven end; of others the impedances have numbers"
            )
        self.rope = rope
        self.place = sympy.Symbol("xi_0")
        self.static, self.value = cache(self._static), cache(self._value)

    def rates(self, j: int) -> list[sympy.Expr]:
        """c_0, c_1, c_2 at harmonic j, or its conjugate −j."""
        rate = sympy.I * j * sympy.Symbol("Omega")
        found = [sympy.Integer(0)] * 3
        for (k, t), c in self.rope.equation.terms.items():
            found[k] += c * rate**t
        return [sympy.expand(c) for c in found]

    def _static(self, d: int) -> sympy.Expr:
        """a_d, from ℓ at ξ₀."""
        c0, c1, c2 = self.rates(0)
        xi, load = self.rope.letters.xi, self.rope.equation.right
        tower = [sympy.Integer(0), sympy.Integer(0)]
        while len(tower) <= d:
            pull = load.diff(xi, len(tower) - 2).subs(xi, self.place)
            tower.append((pull - c1 * tower[-1] - c0 * tower[-2]) / c2)
        return tower[d]

    def _value(self, generator: Generator) -> sympy.Expr:
        """The generator's expression."""
        if generator.kind == "static":
            return self.static(generator.derivative) / self.static(2)
        j = -generator.harmonic if generator.conjugate else generator.harmonic
        c0, c1, c2 = self.rates(j)
        mu = c1 / (2 * c2)
        square = sympy.expand(sympy.cancel(c0 / c2 - mu**2))
        k = sympy.sqrt(square)
        angle = k * self.place
        if generator.kind == "impedance":
            slope = (1 / self.place if square == 0 else k * sympy.cot(angle)) - mu
            tower = [sympy.Integer(1), slope]
        else:
            (condition,) = self.rope.driven_end
            amplitude = condition.drive.get(j, 0) / condition.terms[0, 0] * (2 if j else 1)
            falling = 1 / self.place if square == 0 else k / sympy.sin(angle)
            tower = [sympy.Integer(0), -amplitude * sympy.exp(-mu * self.place) * falling]
        while len(tower) <= generator.derivative:
            tower.append(-(c1 * tower[-1] + c0 * tower[-2]) / c2)
        return tower[generator.derivative]


def rope_forms(rope: MovingContact, order: int, progress: Progress | None = None) -> RopeForms:
    """The closed forms of a rope through an order.

    Raises
    ------
    InputError
        ``order`` is no whole number ≥ 1, or the rope lies on springs.

    Examples
    --------
    >>> from asymptotics.problems.presets import string
    >>> rope_forms(string(foundation=1.7), 2).contact(1, 1)
    -S1_1
    """
    if rope.springs != 0:
        raise InputError(
            f"{rope}: formulas in impedances are of ropes on a ground that does not give way; "
            "expand(rope, order, at=…) has this one's numbers"
        )
    harmonics = sorted({abs(j) for c in rope.driven_end for j in c.drive})
    generators = Generators(rope.contact_order, tuple(harmonics), order, is_even(rope))
    return RopeForms(rope, generators, expand(generator_rope(generators), order, None, progress))


def is_even(rope: MovingContact) -> bool:
    """Whether the state is even in τ whatever the parameters: no odd ∂_τ, no sine in the drive.

    >>> from asymptotics.problems.presets import string
    >>> is_even(string(foundation=1.7)), is_even(string(damping=0.1))
    (True, False)
    """
    return not rope.irreversible and all(
        sympy.expand(amplitude - c.drive.get(-j, 0)) == 0
        for c in rope.driven_end
        for j, amplitude in c.drive.items()
    )
