"""Contact point and profile of a reader's own rope, in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import sympy

from asymptotics.checks import axis, check_order, finite_number, positions
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Progress, expansions, named_poles
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.problem import Problem
from asymptotics.values.response import Response, check_ordering, response


@dataclass(frozen=True)
class RopeEvaluation(Response):
    """What :func:`evaluate_rope` returns.

    Attributes
    ----------
    static_contact
        ξ₀.
    at
        The parameters' values, Ω among them, as doubles.
    """

    static_contact: float
    at: Mapping[str, float]


def evaluate_rope(
    rope: MovingContact,
    at: Mapping[Any, Any],
    epsilon: float,
    order: int,
    s: npt.ArrayLike | None,
    tau: npt.ArrayLike,
    progress: Progress | None = None,
) -> RopeEvaluation:
    """ξ_c and W at s = ξ − ξ_c, from the expansion of the given order.

    Parameters
    ----------
    rope, at
        As for :func:`asymptotics.expand`.
    epsilon, order, s, tau, progress
        As for :func:`asymptotics.values.evaluate.evaluate`; s None are quarters of ξ₀, or none
        where coefficients vary with ξ: of such a rope there is the contact point only.

    Raises
    ------
    InputError, OrderingError, PrecisionError
        As :func:`asymptotics.expand` and :func:`asymptotics.values.response.response`.

    Examples
    --------
    >>> from asymptotics.problems.presets import string
    >>> result = evaluate_rope(string(foundation=1.7), {"Omega": 2.2}, 0.01, 3, [-0.5, 0.0], [0.0])
    >>> round(result.static_contact, 9), result.contact.round(9), result.profile.round(9)
    (0.940043862, array([0.94882408]), array([[0.25730355, 0.        ]]))
    """
    order, small = check_order(order), finite_number("epsilon", epsilon)
    values, times = rope.values(at), axis("tau", tau)
    places = positions([] if s is None else s, times.size, beyond=rope.springs != 0)
    if rope.varying and places.size:
        raise InputError(
            "s: the profile is not offered where coefficients vary with xi; leave s out, or give "
            "an empty list, for the contact point alone"
        )
    problem: Problem[Any] = rope.at(at)
    rest = complex(problem.rest or 0).real
    for solution in named_poles(expansions(problem, order), rope, at, order):
        check_ordering(solution, small, rest)
        if progress is not None:
            progress(solution.order)
    omega = float(values["Omega"])

    def phase(j: int, t: Any) -> Any:
        return j * omega * t

    if s is None and times.size and not rope.varying:
        lowest = response(solution, phase, small, [], times).contact.min()
        places = np.array([x for x in rest * np.linspace(-1, 0, 5) if x >= -lowest])
    frame_done = None if progress is None else lambda n: progress(order + n)
    found = response(solution, phase, small, places, times, frame_done)
    ground = ground_height(rope, values, found.contact[:, None] + found.s)
    found = replace(found, profile=found.profile + ground)
    numbers = {name: float(value) for name, value in values.items()}
    return RopeEvaluation(**vars(found), static_contact=rest, at=numbers)


def ground_height(rope: MovingContact, values: Mapping[str, Any], x: Any) -> Any:
    """g at these places, its parameters' values as :meth:`MovingContact.values` has them."""
    exact = {
        symbol: sympy.Rational(value.numerator, value.denominator)
        for symbol in rope.ground.free_symbols
        for name, value in values.items()
        if symbol.name == name
    }
    coefficients = sympy.Poly(rope.ground.subs(exact), rope.letters.xi).all_coeffs()
    return np.polyval([float(c) for c in coefficients], x)
