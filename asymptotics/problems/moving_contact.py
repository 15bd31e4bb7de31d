r"""The reader's own rope: a linear equation, a driven end, a contact, a ground.

    >>> import sympy as sp
    >>> from asymptotics import expand
    >>> from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
    >>> kappa = sp.Symbol("kappa")
    >>> rope = moving_contact(
    ...     equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
    ...     driven_end=[sp.Eq(W, 1 + epsilon * sp.cos(Omega * tau))],
    ...     contact=[W, W.diff(xi)],
    ... )
    >>> series = expand(rope, 2, at={kappa: 1.7, Omega: 2.2})
    >>> {j: round(2 * c, 12) for j, c in series.contact(1).items()}
    {1: 0.890012519029}

What is written is read by :mod:`asymptotics.problems.equation`; at values of its parameters it
becomes a :class:`~asymptotics.problems.problem.Problem`: every derivative at the static contact
point follows from matrices (:mod:`asymptotics.problems.fundamental`). A ground g(ξ), a polynomial,
is taken off: all that the problem says is of W − g.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np
import sympy

from asymptotics.errors import InputError
from asymptotics.problems.equation import (
    EndCondition,
    Letters,
    Linear,
    contact_order,
    derivative,
    end_condition,
    letters,
)
from asymptotics.problems.equation import (
    equation as read_equation,
)
from asymptotics.problems.problem import Problem
from asymptotics.rings.balls import rational

Arithmetic = Literal["doubles", "balls"]


@dataclass(frozen=True, eq=False)
class MovingContact:
    """A rope as it was written down; made by :func:`moving_contact`.

    Attributes
    ----------
    equation
        Of W − g: the coefficients c_{kt} and the load ℓ(ξ).
    driven_end
        The r − m + 1 conditions, of W − g.
    contact_order
        m.
    ground
        g(ξ).
    letters
        What its symbols stand for.
    springs
        κ of a ground that gives way; 0 for one that does not.
    """

    equation: Linear
    driven_end: tuple[EndCondition, ...]
    contact_order: int
    ground: sympy.Expr
    letters: Letters
    springs: sympy.Expr = sympy.S.Zero

    @property
    def order(self) -> int:
        """r, the equation's order in ξ."""
        return self.equation.order

    @property
    def varying(self) -> bool:
        """Whether a coefficient depends on ξ."""
        return any(value.has(self.letters.xi) for value in self.equation.terms.values())

    @property
    def irreversible(self) -> bool:
        """Whether ∂_τ occurs to an odd power: damping, gyroscopic terms."""
        statements = [self.equation.terms, *(c.terms for c in self.driven_end)]
        return any(t % 2 for terms in statements for _, t in terms)

    @property
    def depends_on_frequency(self) -> bool:
        """Whether Ω stands in a coefficient, or in the size of the drive."""
        return "Omega" in self._names()

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names that need a value, Ω the last."""
        known, names = self.letters, self._names()
        reserved = {known.xi.name, known.tau.name, "epsilon", "Omega"}
        return (*sorted(names - reserved), "Omega")

    def _names(self) -> set[str]:
        return {symbol.name for e in self._expressions() for symbol in e.free_symbols}

    def _expressions(self) -> list[sympy.Expr]:
        found = [*self.equation.terms.values(), self.equation.right, self.ground, self.springs]
        for condition in self.driven_end:
            found += [*condition.terms.values(), condition.constant, *condition.drive.values()]
        return found

    def values(self, at: Mapping[Any, Any] | None) -> dict[str, Fraction]:
        """Name ↦ value, exactly: a double is the binary fraction that it stands for.

        Raises
        ------
        InputError
            A parameter without a value, a value without a parameter, no number, or Ω ≤ 0.
        """
        given = {str(getattr(key, "name", key)): value for key, value in (at or {}).items()}
        names = self.parameters
        missing = [name for name in names if name not in given]
        extra = [name for name in given if name not in names]
        if missing or extra:
            what = [f"{name} has no value" for name in missing]
            what += [f"{name} is no parameter" for name in extra]
            listed = ", ".join(f"{name}: …" for name in names)
            raise InputError(f"{'; '.join(what)}; give at={{{listed}}}")
        found = {}
        for name in names:
            value = given[name]
            if isinstance(value, sympy.Rational):
                value = Fraction(int(value.p), int(value.q))
            number = rational(value)
            if number is None:
                raise InputError(
                    f"{name} = {given[name]!r} is not a finite number; give a number, or a decimal "
                    "in a string"
                )
            found[name] = number
        if found["Omega"] <= 0:
            raise InputError(f"Omega = {given['Omega']!r}; it must be positive")
        return found

    def at(self, at: Mapping[Any, Any] | None, arithmetic: Arithmetic = "doubles") -> Problem[Any]:
        """The problem at values of its parameters.

        Parameters
        ----------
        at
            Symbol or name ↦ number; decimals in strings and fractions are exact. Or arrays of
            doubles that broadcast: then the problem is at all their points
            (:mod:`asymptotics.problems.swept_rope`).
        arithmetic
            ``doubles``, expanded over balls and rounded, all digits right; or ``balls`` in the
            precision of the moment.

        Raises
        ------
        InputError
            Values that are missing or bad; no static shape, or one that is not above the ground; a
            ground that would have to pull; a leading coefficient that vanishes at a harmonic.
        PrecisionError
            Ω is at a resonance, or so close that 8192 bits do not tell.
        """
        from asymptotics.problems.contact_problem import double_problem, enclosed_problem

        if any(isinstance(value, np.ndarray | list) for value in (at or {}).values()):
            from asymptotics.problems.swept_rope import swept_problem

            return swept_problem(self, at or {})
        values = tuple(sorted(self.values(at).items()))
        if arithmetic == "balls":
            return enclosed_problem(self, values)
        if arithmetic != "doubles":
            raise InputError(f"arithmetic = {arithmetic!r}; choose doubles or balls")
        return double_problem(self, values)

    def check_resonance(self, at: Mapping[Any, Any] | None, harmonics: Sequence[int]) -> None:
        """Raise a ResonanceError where a harmonic is numerically at a free frequency.

        Of one point; arrays are checked where they are expanded.
        """
        if any(isinstance(value, np.ndarray | list) for value in (at or {}).values()):
            return
        from asymptotics.problems.free_frequencies import check_resonance

        check_resonance(self, at or {}, harmonics)

    def __str__(self) -> str:
        ends = [
            f"{_sum(c.terms)} = {c.constant + self.letters.epsilon * c.forcing}"
            for c in self.driven_end
        ]
        on = f", on springs {self.springs}" if self.springs != 0 else ""
        return f"rope {_sum(self.equation.terms)} = {self.equation.right}, {', '.join(ends)}{on}"


def _sum(terms: Mapping[tuple[int, int], sympy.Expr]) -> str:
    """In the spelling of problem files.

    >>> _sum({(0, 0): sympy.Symbol("kappa"), (0, 2): sympy.S(1), (2, 0): sympy.S(-1)})
    'W*kappa + W_tautau - W_xixi'
    """
    return str(sympy.Add(*(c * sympy.Symbol(derivative(k, t)) for (k, t), c in terms.items())))


def moving_contact(
    *,
    equation: Any,
    driven_end: Sequence[Any],
    contact: Sequence[Any],
    ground: Any = 0,
    springs: Any = 0,
) -> MovingContact:
    r"""A rope on a ground, from its equations.

    Parameters
    ----------
    equation
        Σ c_{kt} ∂_ξ^k ∂_τ^t W = ℓ, an ``Eq`` in W(ξ, τ), of order r ≤ 8 in ξ; constants and
        parameters as coefficients, or polynomials in ξ. With the latter there are numbers, balls,
        proof and ξ_c, and formulas in impedances; not modules that compute these, nor arrays of
        points, nor the profile.
    driven_end
        r − m + 1 conditions at ξ = 0, ``Eq`` of derivatives below r in ξ; one or more with
        ε times a finite sum of cos(nΩτ + φ) on the right.
    contact
        The m things that equal the ground's at the contact point: W, W_ξ, …, without a gap.
    ground
        g(ξ), a polynomial; 0 by default.
    springs
        κ > 0, for a ground that gives way: the rope lies on springs and moves there too (a
        unilateral Winkler foundation, :mod:`asymptotics.problems.compliant`). Then ``contact`` is
        [W] alone, W and its derivatives below r being continuous there, and the driven end has r/2
        conditions. 0 by default: a ground that does not.

    Raises
    ------
    InputError
        What is not well posed or not of this form: the error says which term.
    """
    statements = [equation, *driven_end, *contact]
    known = letters(statements)
    lifted = read_equation(equation, known)
    stiff = _springs(springs, known, lifted.order)
    m = contact_order(contact, known, lifted.order, on_springs=stiff != 0)
    wanted = lifted.order - m + 1 if stiff == 0 else lifted.order // 2
    if len(driven_end) != wanted:
        why = (
            f"with m = {m} contact conditions needs r - m + 1"
            if stiff == 0
            else "on springs needs r/2"
        )
        raise InputError(
            f"driven end: {len(driven_end)} conditions; an equation of order r = {lifted.order} in "
            f"{known.xi} {why} = {wanted}"
        )
    conditions = [end_condition(statement, known, lifted.order) for statement in driven_end]
    if not any(condition.drive for condition in conditions):
        raise InputError(
            "driven end: no condition is driven; put epsilon*cos(Omega*tau), or another finite "
            "Fourier sum, on the right of one"
        )
    height = sympy.sympify(ground)
    # A letter is known by its name, with or without assumptions.
    named = {known.xi.name: known.xi, known.tau.name: known.tau}
    height = height.subs({x: named[x.name] for x in height.free_symbols if x.name in named})
    polynomial = height.is_polynomial(known.xi) and not height.has(known.tau, known.epsilon)
    if not polynomial:
        raise InputError(f"ground: {ground} is not a polynomial in {known.xi}")
    if stiff != 0 and any(value.has(known.xi) for value in lifted.terms.values()):
        raise InputError("springs: they are for equations with constant coefficients")
    rope = _over(lifted, tuple(conditions), m, sympy.expand(height), known)
    return replace(rope, springs=stiff)


def _springs(springs: Any, known: Letters, r: int) -> sympy.Expr:
    """Their stiffness, a constant."""
    stiff = sympy.sympify(springs)
    if not isinstance(stiff, sympy.Expr) or stiff.has(known.xi, known.tau, known.epsilon, known.W):
        raise InputError(f"springs: {springs} is not a constant")
    if stiff != 0 and r % 2:
        raise InputError(f"springs: the equation's order r = {r} in {known.xi} has to be even")
    return stiff


def _over(
    lifted: Linear,
    conditions: tuple[EndCondition, ...],
    m: int,
    ground: sympy.Expr,
    known: Letters,
) -> MovingContact:
    """The same for W − g, which vanishes at the contact point."""

    def applied(terms: Mapping[tuple[int, int], sympy.Expr]) -> sympy.Expr:
        return sympy.Add(
            *(value * ground.diff(known.xi, k) for (k, t), value in terms.items() if not t)
        )

    load = sympy.expand(lifted.right - applied(lifted.terms))
    if not load.is_polynomial(known.xi):
        raise InputError(f"equation: the load {load} is not a polynomial in {known.xi}")
    ends = tuple(
        replace(
            condition,
            constant=condition.constant - applied(condition.terms).subs(known.xi, 0),
        )
        for condition in conditions
    )
    return MovingContact(Linear(lifted.terms, load), ends, m, ground, known)
