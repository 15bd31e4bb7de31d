r"""A rope as its reader writes it down: equations in SymPy become operators, or are refused.

The equation :math:`\sum_k c_k(∂_τ)\, ∂_ξ^k W = ℓ`, k ≤ r, holds between the driven end ξ = 0 and
the contact point ξ_c(τ), where W and its first m − 1 slopes equal those of the ground g(ξ). At the
driven end there are r − m + 1 conditions :math:`\sum_k e_k(∂_τ)\, ∂_ξ^k W = d + ε ΔZ(τ)`, each with
a finite Fourier sum ΔZ in multiples of Ω, or with none. Everything else in them is a parameter.

Here only letters are moved; numbers, and what depends on them, are
:mod:`asymptotics.problems.moving_contact`'s.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy
from sympy.core.function import AppliedUndef

from asymptotics.errors import InputError

LARGEST_ORDER = 8

Powers = Mapping[tuple[int, int], sympy.Expr]
"""(k, t) ↦ the coefficient of ∂_ξ^k ∂_τ^t W."""


@dataclass(frozen=True)
class Linear:
    """One linear statement Σ c_{kt} ∂_ξ^k ∂_τ^t W = right."""

    terms: Powers
    right: sympy.Expr

    @property
    def order(self) -> int:
        """The highest k."""
        return max((k for k, _ in self.terms), default=-1)


@dataclass(frozen=True)
class EndCondition:
    """One condition at the driven end.

    Attributes
    ----------
    terms
        (k, t) ↦ e_{kt}.
    constant
        d.
    forcing
        ΔZ(τ).
    drive
        n ↦ the amplitude of e^{inΩτ} in ΔZ, of both signs.
    """

    terms: Powers
    constant: sympy.Expr
    forcing: sympy.Expr
    drive: Mapping[int, sympy.Expr]


@dataclass(frozen=True)
class Letters:
    """Which symbols stand for what in one reader's equations."""

    W: AppliedUndef
    xi: sympy.Symbol
    tau: sympy.Symbol
    epsilon: sympy.Symbol
    Omega: sympy.Symbol


def letters(statements: Iterable[Any]) -> Letters:
    """The letters of these statements: the one function of (ξ, τ), and what is called ε and Ω.

    Raises
    ------
    InputError
        No function, more than one, or one not of two symbols.
    """
    found: set[AppliedUndef] = set()
    names: dict[str, sympy.Symbol] = {}
    for statement in statements:
        expression = sympy.sympify(statement)
        found |= expression.atoms(AppliedUndef)
        names |= {symbol.name: symbol for symbol in expression.free_symbols}
    if len(found) != 1:
        listed = ", ".join(sorted(map(str, found))) or "none"
        raise InputError(
            f"the equations have {listed} as unknown; write them for one function W(xi, tau)"
        )
    (W,) = found
    if len(W.args) != 2 or not all(isinstance(x, sympy.Symbol) for x in W.args):
        raise InputError(
            f"the unknown is {W}; write W(xi, tau), of two symbols, position first, and let the "
            "conditions mean their place by where they stand"
        )
    xi, tau = W.args
    epsilon, Omega = (
        names.get(name, sympy.Symbol(name, real=True)) for name in ("epsilon", "Omega")
    )
    return Letters(W, xi, tau, epsilon, Omega)


def linear(statement: Any, known: Letters, what: str) -> Linear:
    """A statement as a linear one in W and its derivatives.

    Parameters
    ----------
    statement
        ``sympy.Eq``, or an expression that is zero.
    what
        How to call it in errors.

    Raises
    ------
    InputError
        A term that is not linear in W; the error names it.

    Examples
    --------
    >>> from asymptotics.problems.symbols import W, tau, xi
    >>> found = linear(sympy.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2), letters([W]), "equation")
    >>> found.terms, found.right
    ({(0, 2): 1, (2, 0): -1}, -2)
    """
    expression = _zero_of(statement, what).doit()
    places: dict[Any, tuple[int, int]] = {}
    dummies: dict[Any, sympy.Dummy] = {}
    for item in sorted(expression.atoms(sympy.Derivative, AppliedUndef), key=str):
        if item == known.W:
            places[item] = (0, 0)
        elif isinstance(item, sympy.Derivative) and item.expr == known.W:
            places[item] = _orders(item, known, what)
        elif item.has(known.W):
            raise InputError(f"{what}: {item} is not a derivative of {known.W}; expand it")
        else:
            raise InputError(f"{what}: {item} is unknown; only {known.W} may be")
        dummies[item] = sympy.Dummy()
    # Derivatives first: they contain W itself.
    for item in sorted(dummies, key=lambda x: -sum(places[x])):
        expression = expression.xreplace({item: dummies[item]})
    expanded = sympy.expand(expression)
    back = {dummy: item for item, dummy in dummies.items()}
    terms: dict[tuple[int, int], sympy.Expr] = {}
    rest: list[sympy.Expr] = []
    for term in sympy.Add.make_args(expanded):
        inside = [dummy for dummy in back if term.has(dummy)]
        if not inside:
            rest.append(term)
            continue
        factor = sympy.cancel(term / inside[0])
        if len(inside) > 1 or factor.has(inside[0]):
            raise InputError(
                f"{what}: the term {term.xreplace(back)} is not linear in {known.W}; the expansion "
                "is of linear equations with a moving contact"
            )
        key = places[back[inside[0]]]
        terms[key] = terms.get(key, sympy.S.Zero) + factor
    left = {key: value for key, value in sorted(terms.items()) if value != 0}
    return Linear(left, -sympy.Add(*rest))


def _zero_of(statement: Any, what: str) -> sympy.Expr:
    if isinstance(statement, sympy.Equality):
        return statement.lhs - statement.rhs
    expression = sympy.sympify(statement)
    if not isinstance(expression, sympy.Expr):
        raise InputError(f"{what}: {statement!r} is no equation; give sympy.Eq(left, right)")
    return expression


def _orders(item: sympy.Derivative, known: Letters, what: str) -> tuple[int, int]:
    counts = dict(item.variable_count)
    if not set(counts) <= {known.xi, known.tau}:
        raise InputError(f"{what}: {item} is not a derivative in {known.xi} and {known.tau}")
    return int(counts.get(known.xi, 0)), int(counts.get(known.tau, 0))


def equation(statement: Any, known: Letters) -> Linear:
    """The equation of the lifted part, when its coefficients are polynomials in ξ without τ and ε.

    Raises
    ------
    InputError
        It is not; no derivative in ξ; or more than :data:`LARGEST_ORDER` of them.
    """
    found = linear(statement, known, "equation")
    for (k, t), value in found.terms.items():
        if value.has(known.tau) or not value.is_polynomial(known.xi):
            raise InputError(
                f"equation: the coefficient {value} of {derivative(k, t)} has to be a constant, or "
                f"a polynomial in {known.xi}"
            )
    if found.right.has(known.tau):
        raise InputError(f"equation: the load {found.right} depends on {known.tau}")
    if any(x.has(known.epsilon) for x in (*found.terms.values(), found.right)):
        raise InputError("equation: ε stands in it; only the driven end is driven")
    if not 1 <= found.order <= LARGEST_ORDER:
        raise InputError(
            f"equation: its order in {known.xi} is {max(found.order, 0)}; it has to be between 1 "
            f"and {LARGEST_ORDER}"
        )
    return found


def contact_order(
    conditions: Sequence[Any], known: Letters, r: int, *, on_springs: bool = False
) -> int:
    """m, when the conditions are W = W_ξ = … = ∂^{m−1}W = 0 in some order.

    Raises
    ------
    InputError
        Other conditions, or more than r of them.
    """
    orders = []
    for condition in conditions:
        found = linear(condition, known, "contact")
        if found.right != 0 or len(found.terms) != 1 or next(iter(found.terms))[1] != 0:
            raise InputError(
                f"contact: {condition} is not W or a derivative of it in {known.xi}, which vanish "
                "there (a ground that is not flat is given as ground=g)"
            )
        orders.append(found.order)
    m = len(orders)
    if on_springs:
        if orders != [0]:
            raise InputError(
                f"contact: on springs the rope's height alone vanishes where it meets them; give "
                f"[W], not {[derivative(k, 0) for k in orders]}"
            )
        return 1
    if sorted(orders) != list(range(m)) or not 1 < m <= r:
        names = ", ".join(derivative(k, 0) for k in range(m or 1))
        raise InputError(
            f"contact: the conditions are on {[derivative(k, 0) for k in orders]}; they have to be "
            f"{names} without a gap, at least two and at most the equation's order {r}"
        )
    return m


def end_condition(statement: Any, known: Letters, r: int) -> EndCondition:
    """A condition at the driven end, its right-hand side taken apart.

    Raises
    ------
    InputError
        Derivatives of order ≥ r in ξ; ε or time in a coefficient; what is driven is not
        proportional to ε, or not a finite Fourier sum in multiples of Ω.
    """
    found = linear(statement, known, "driven end")
    if not found.terms:
        raise InputError(f"driven end: {statement} says nothing of {known.W}")
    if found.order >= r:
        raise InputError(
            f"driven end: {statement} holds {derivative(found.order, 0)}, but the equation of "
            f"order {r} fixes that; conditions are on lower derivatives"
        )
    for value in found.terms.values():
        if value.has(known.xi, known.tau, known.epsilon):
            raise InputError(f"driven end: the coefficient {value} in {statement} is no constant")
    right = sympy.expand(found.right)
    if right.has(known.xi):
        raise InputError(f"driven end: {right} depends on {known.xi}, which is 0 there")
    constant = right.subs(known.epsilon, 0)
    forcing = sympy.diff(right, known.epsilon)
    if constant.has(known.tau) or forcing.has(known.epsilon):
        raise InputError(
            f"driven end: {right} has to be a constant plus epsilon times a periodic function of "
            f"{known.tau}"
        )
    return EndCondition(found.terms, constant, forcing, fourier(forcing, known))


def fourier(function: sympy.Expr, known: Letters) -> dict[int, sympy.Expr]:
    """n ↦ the amplitude of e^{inΩτ}.

    Raises
    ------
    InputError
        A term that is none of finitely many harmonics; the error names it.

    Examples
    --------
    >>> from asymptotics.problems.symbols import Omega, W, tau
    >>> phase = sympy.Symbol("phi", real=True)
    >>> sorted(fourier(sympy.cos(Omega * tau) ** 2 + sympy.sin(3 * Omega * tau), letters([W])))
    [-3, -2, 0, 2, 3]
    """
    Omega = sympy.Symbol("Omega", real=True)
    function = function.xreplace({known.Omega: Omega})
    exponentials = sympy.expand(function.rewrite(sympy.exp))
    amplitudes: dict[int, sympy.Expr] = {}
    for term in sympy.Add.make_args(exponentials):
        found = _harmonic(term, known.tau, Omega)
        if found is None:
            raise InputError(
                f"driven end: {function} is not a finite sum of cos(n Omega tau + phi), n whole; "
                "a periodic drive of another form has to be expanded first"
            )
        n, amplitude = found
        amplitudes[n] = amplitudes.get(n, sympy.S.Zero) + amplitude
    return {n: value for n, value in sorted(amplitudes.items()) if value != 0}


def _harmonic(
    term: sympy.Expr, tau: sympy.Symbol, Omega: sympy.Symbol
) -> tuple[int, sympy.Expr] | None:
    """(n, amplitude) of one term amplitude · e^{inΩτ}, or None."""
    amplitude, exponent = sympy.S.One, sympy.S.Zero
    for factor in sympy.Mul.make_args(term):
        if not factor.has(tau):
            amplitude *= factor
            continue
        base, power = factor, sympy.S.One
        if isinstance(factor, sympy.Pow) and factor.exp.is_Integer:
            base, power = factor.args
        if not isinstance(base, sympy.exp):
            return None
        exponent += base.exp * power
    exponent = sympy.expand(exponent)
    rate = sympy.simplify(sympy.diff(exponent, tau) / (sympy.I * Omega))
    if not rate.is_Integer:
        return None
    return int(rate), amplitude * sympy.exp(exponent.subs(tau, 0))


def derivative(k: int, t: int) -> str:
    """∂_ξ^k ∂_τ^t W as a problem file spells it.

    >>> derivative(2, 1), derivative(0, 0)
    ('W_xixitau', 'W')
    """
    return "W" + ("_" if k or t else "") + "xi" * k + "tau" * t
