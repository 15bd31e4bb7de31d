"""A reader's own rope on trial: its expansion beside periodic states that are not expanded.

The state (:mod:`numerics.periodic.states`, or :mod:`numerics.periodic.collocation` where
coefficients vary along the rope) knows of the equation, the conditions and of ξ₀, where it starts,
and of nothing else. Its floor is its distance from the one on fewer times and points.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.moving_contact import MovingContact
from derivations.cross_check.data import Comparison, Errors
from derivations.cross_check.forms import Array, largest_amplitudes, rms
from numerics.periodic import states
from numerics.periodic.collocation import periodic_contact
from numerics.periodic.linear_rope import LinearRope, NoPeriodicStateError

KEEP = 3.0
"""Floors that an error must exceed: it adds as a square, and is 5 % of the error then."""

_POINTS = {True: (14, 18), False: (18, 22)}


def in_numbers(rope: MovingContact, values: Mapping[str, Fraction], rest: float) -> LinearRope:
    """The same rope for the numerics, W itself and not W − g."""
    import sympy

    exact = {name: sympy.Rational(x.numerator, x.denominator) for name, x in values.items()}

    known = rope.letters

    def number(expression: Any) -> Any:
        """With all symbols but ξ replaced."""
        at = {symbol: exact[symbol.name] for symbol in expression.free_symbols - {known.xi}}
        return expression.subs(at)

    ground = sympy.expand(number(rope.ground))

    def applied(terms: Mapping[tuple[int, int], Any]) -> Any:
        return sympy.Add(
            *(number(c) * ground.diff(known.xi, k) for (k, t), c in terms.items() if not t)
        )

    def coefficient(expression: Any) -> Any:
        """A number, or the coefficients of a polynomial in ξ."""
        value = sympy.expand(number(expression))
        if not value.has(known.xi):
            return float(value)
        return [float(c) for c in sympy.Poly(value, known.xi).all_coeffs()]

    load = number(rope.equation.right) + applied(rope.equation.terms)
    ends = []
    for condition in rope.driven_end:
        constant = number(condition.constant) + applied(condition.terms).subs(known.xi, 0)
        waves = {n: complex(number(c)) for n, c in condition.drive.items()}
        terms = {key: float(number(c)) for key, c in condition.terms.items()}
        ends.append((terms, float(constant), _drive(waves, float(values["Omega"]))))
    return LinearRope(
        {key: coefficient(c) for key, c in rope.equation.terms.items()},
        coefficient(load),
        ends,
        rope.contact_order,
        float(values["Omega"]),
        rest,
        [float(c) for c in sympy.Poly(ground, known.xi).all_coeffs()],
        float(number(rope.springs)),
    )


def by_frequency(rope: MovingContact, at: Mapping[str, Any]) -> Callable[[float], LinearRope]:
    """Ω ↦ the rope for the numerics, at values of its other parameters."""

    def stated(omega: float) -> LinearRope:
        values = {**at, "Omega": omega}
        rest = complex(rope.at(values).rest or 0).real
        return in_numbers(rope, rope.values(values), rest)

    return stated


def _drive(waves: Mapping[int, complex], omega: float) -> Callable[[Array], Array]:
    def drive(tau: Array) -> Array:
        total = np.zeros(np.shape(tau), dtype=complex)
        for n, amplitude in waves.items():
            total += amplitude * np.exp(1j * n * omega * tau)
        return total.real

    return drive


def judge_of(rope: MovingContact) -> str:
    """Which numerics a rope is judged by, in words."""
    return f"the periodic state, by {'collocation' if rope.varying else 'modes'}"


def against_states(
    rope: MovingContact,
    at: Mapping[Any, Any],
    order: int,
    quick: bool,
    form: Callable[[Array, float], Array] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Orders 1 … N of a rope against its periodic states.

    Parameters
    ----------
    form
        (τ, ε) ↦ ξ_c in the place of order N.

    Raises
    ------
    InputError
        What the expansion refuses; a rope without a periodic state at the smallest amplitude.
    """
    values = rope.values(at)
    series: Expansion[Any] = expand(rope, order + 3, at=at)
    rest, omega = complex(series.problem.rest or 0).real, float(values["Omega"])
    sizes = np.array([_size(series, n) for n in range(1, order + 4)])
    stated = in_numbers(rope, values, rest)
    highest = max(j for n in range(1, order + 2) for j in series.contact(n))
    times = 2 * highest + 9  # the state has harmonics that no order judged has
    few, many = _POINTS[quick]
    state = periodic_contact if rope.varying else _by_modes
    # From the largest amplitude at which an order is judged to a quarter of the smallest.
    rungs, top = 6 if quick else 12, largest_amplitudes(sizes, order)
    ladder = np.geomspace(top.max(), top.min() / 4, rungs)
    tau = 2 * np.pi / omega * np.arange(times + 4) / (times + 4)
    kept, errors, floors = [], [], []
    for done, epsilon in enumerate(ladder.tolist(), start=1):
        try:
            coarse = state(stated, epsilon, times, few)
            fine = state(stated, epsilon, times + 4, many)
        except NoPeriodicStateError:
            continue  # the ladder begins where the series still falls off, which is no promise
        finally:
            if progress is not None:
                progress(done, rungs)
        partial, row = np.full(tau.size, rest), []
        for n in range(1, order + 1):
            partial = partial + epsilon**n * _wave(series, n, omega * tau)
            own = form is not None and n == order
            row.append(rms((form(tau, epsilon) if own and form else partial) - fine))
        kept.append(epsilon)
        errors.append(row)
        floors.append(rms(_interpolated(coarse, omega, tau) - fine))
    if not kept:
        raise InputError(
            f"no periodic state of this rope is found at epsilon = {ladder[-1]:.3g} … "
            f"{ladder[0]:.3g}; move Omega away from a resonance, or thicken the layers"
        )
    return Comparison(
        omega,
        float("nan"),
        np.array(kept),
        top,
        KEEP,
        sizes,
        Errors(np.array(errors).T, np.array(floors)),
        None,
    )


def _by_modes(rope: LinearRope, epsilon: float, times: int, points: int) -> Array:
    """Modes need no points."""
    return states.periodic_contact(rope, epsilon, times)


def _size(series: Expansion[Any], n: int) -> float:
    """‖ξ_n‖, the root mean square over a period."""
    return math.sqrt(sum((2 if j else 1) * abs(c) ** 2 for j, c in series.contact(n).items()))


def _wave(series: Expansion[Any], n: int, theta: Array) -> Array:
    total = np.zeros(theta.shape)
    for j, c in series.contact(n).items():
        total += (2 if j else 1) * (complex(c) * np.exp(1j * j * theta)).real
    return total


def _interpolated(values: Array, omega: float, tau: Array) -> Array:
    """The trigonometric polynomial through equal times, elsewhere."""
    count = values.size
    waves = np.fft.rfft(values) / count
    total = np.full(tau.shape, waves[0].real)
    for j, c in enumerate(waves[1:], start=1):
        total = total + 2 * (c * np.exp(1j * j * omega * tau)).real
    return total
