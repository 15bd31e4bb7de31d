"""The closed forms of the cross-check, run as anyone would run them: from the emitted source."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asymptotics.expansion.order_loop import expand
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.printing.beam_numpy import beam_numpy
from asymptotics.printing.numpy_code import numpy_module
from asymptotics.problems.string import exact_string

Array = NDArray[np.float64]

SHARE = 0.3
"""q: by how much the following terms must fall off, see :func:`largest_amplitudes`."""
PHASES = 24
"""Instants of a period at which shapes are compared."""


@dataclass(frozen=True)
class JudgedForm:
    """ξ_c(τ, ε) and W(ξ, τ, ε) through one order, at one Ω and β."""

    order: int
    contact: Callable[[Any, Any], Array]
    shape: Callable[[Any, Any, Any], Array]

    def at(
        self, epsilon: float
    ) -> tuple[Callable[[Array], Array], Callable[[Array, Array], Array]]:
        """ξ_c(τ) and W(ξ, τ) at one amplitude."""
        return (
            lambda tau: self.contact(tau, epsilon),
            lambda xi, tau: self.shape(xi, tau, epsilon),
        )


@cache
def string_source(order: int) -> str:
    """The emitted module of the string."""
    return numpy_module(ClosedForms(expand(exact_string(), order)))


@cache
def beam_source(order: int) -> str:
    """The emitted module of the pinned rope with bending."""
    return beam_numpy(expand_symbolic(order))


def string_form(omega: float, order: int, source: str | None = None) -> JudgedForm:
    """The string's closed form at Ω; from another ``source`` than what is emitted if given.

    W at ξ is the emitted profile at s = ξ − ξ_c, both of this order, and 0 on the ground.

    Examples
    --------
    >>> form = string_form(0.83, 4)
    >>> round(float(form.contact(0.0, 0.02)), 8)
    1.01122152
    """
    module: dict[str, Any] = {}
    exec(string_source(order) if source is None else source, module)

    def contact(tau: Any, epsilon: Any) -> Array:
        return np.asarray(module["contact"](tau, omega, epsilon))

    def shape(xi: Any, tau: Any, epsilon: Any) -> Array:
        return np.asarray(module["profile"](xi - contact(tau, epsilon), tau, omega, epsilon))

    return JudgedForm(order, contact, shape)


def beam_form(omega: float, order: int, beta: float, source: str | None = None) -> JudgedForm:
    """As :func:`string_form`, for the pinned rope with bending.

    >>> round(float(beam_form(2.2, 3, beta=0.01).contact(0.0, 0.02)), 8)
    1.13039172
    """
    module: dict[str, Any] = {}
    exec(beam_source(order) if source is None else source, module)
    return JudgedForm(
        order,
        lambda tau, epsilon: np.asarray(module["contact"](tau, omega, epsilon, beta)),
        lambda xi, tau, epsilon: np.asarray(module["shape"](xi, tau, omega, epsilon, beta)),
    )


def closed_form(omega: float, order: int, beta: float) -> JudgedForm:
    """The one of the two that β asks for."""
    return beam_form(omega, order, beta) if beta > 0 else string_form(omega, order)


def term_sizes(omega: float, beta: float, highest: int) -> Array:
    """‖ξ_1‖ … ‖ξ_highest‖, as emitted: root mean squares over a period.

    >>> term_sizes(0.83, 0.0, 2)[0] == abs(0.83 / 2 / np.sin(0.83)) / np.sqrt(2)
    np.True_
    """
    tau = phases(omega, 0.0)
    # A polynomial in ε: the term of order n is the difference of two orders at ε = 1.
    rows = [closed_form(omega, n, beta).contact(tau, 1.0) for n in range(1, highest + 1)]
    rest = closed_form(omega, 1, beta).contact(tau, 0.0)
    return np.array([rms(row) for row in np.diff([rest, *rows], axis=0)])


def largest_amplitudes(sizes: Array, orders: int) -> Array:
    r"""For N = 1 … orders the largest ε at which the terms after the next still fall off:

    .. math:: ‖ξ_{N+2}‖ ε ≤ q‖ξ_{N+1}‖, \qquad ‖ξ_{N+3}‖ ε² ≤ q²‖ξ_{N+1}‖,

    from ‖ξ_1‖ … ‖ξ_{orders+3}‖.

    >>> largest_amplitudes(np.array([1.0, 2.0, 4.0, 8.0]), 1)
    array([0.15])
    """
    n = np.arange(orders)
    first, second, third = sizes[n + 1], sizes[n + 2], sizes[n + 3]
    return np.asarray(SHARE / np.maximum(second / first, np.sqrt(third / first)))


def rms(values: NDArray[Any]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def phases(omega: float, after: float) -> Array:
    """PHASES midpoints of the first whole period after a time.

    >>> phases(2.0, 0.1)[0] == np.pi * (1 + 0.5 / PHASES)
    np.True_
    """
    period = 2 * np.pi / omega
    return period * (np.ceil(after / period) + (np.arange(PHASES) + 0.5) / PHASES)
