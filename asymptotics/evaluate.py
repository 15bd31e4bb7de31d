r"""Numbers at one frequency and amplitude: the engine over floats, no closed form in between.

Both quantities are the plain series in ε truncated at order N:

.. math:: ξ_c ∼ 1 + \sum_{n≤N} ε̂^n ξ_n(τ), \qquad
          \frac{w}{Z_0} ∼ s^2 + \sum_{n≤N} ε̂^n \sum_k
          \bigl[A_{n,k}(τ) (1 − \cos kΩs) + B_{n,k}(τ) (kΩs − \sin kΩs)\bigr].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.checks import axis, finite_number, positions
from asymptotics.errors import OrderingError
from asymptotics.expansion import Expansion, check_order, expand
from asymptotics.problem import float_string
from asymptotics.profile import moving_frame

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Evaluation:
    """ξ_c and w/Z₀ on a grid.

    Attributes
    ----------
    s, tau
        Dimensionless positions s = (x − x_c)/x₀ ≤ 0, shape (S,), and times τ = ct/x₀, shape (T,).
    contact
        ξ_c = x_c/x₀ at each τ, shape (T,).
    profile
        w/Z₀, rows over τ and columns over s, shape (T, S).
    terms
        Bound on the n-th order's share of ξ_c, Σ_j |ε̂^n ξ_{n,j}|, for n = 1 … N.
    """

    omega: float
    epsilon: float
    order: int
    s: Array
    tau: Array
    contact: Array
    profile: Array
    terms: tuple[float, ...]


def evaluate(
    omega: float, epsilon: float, order: int, s: npt.ArrayLike, tau: npt.ArrayLike
) -> Evaluation:
    """Contact point and profile of the string from the expansion of the given order.

    Parameters
    ----------
    omega, epsilon
        Ω = ωx₀/c and the forcing amplitude ε in units of Z₀.
    order
        N ≥ 1: powers of ε beyond N are dropped.
    s, tau
        Numbers or one-dimensional arrays; s ≤ 0.

    Raises
    ------
    InputError
        An argument that is not finite, has the wrong shape or range.
    ResonanceError
        Ω at a resonance pπ/q with q ≤ N; the error names p/q.
    OrderingError
        ε/sin Ω so large that the series has lost its ordering.

    Examples
    --------
    >>> result = evaluate(0.83, 0.02, order=4, s=[-0.5, 0.0], tau=[0.0])
    >>> result.contact.round(8), result.profile.round(8)
    (array([1.01122152]), array([[0.2496802, 0.       ]]))
    """
    order = check_order(order)
    problem = float_string(omega, order)
    omega = float(omega)
    epsilon = finite_number("epsilon", epsilon)
    places, times = positions(s), axis("tau", tau)
    expansion = expand(problem, order)
    small = epsilon / math.sin(omega)
    terms = _check_ordering(expansion, omega, epsilon, small)
    phases = omega * times
    contact = np.ones_like(times)
    for n in range(1, order + 1):
        contact += small**n * fourier_sum(expansion.contact(n), phases)
    profile = _profile(expansion, omega, small, places, phases)
    return Evaluation(omega, epsilon, order, places, times, contact, profile, terms)


def _profile(
    expansion: Expansion[Any], omega: float, small: float, s: Array, phases: Array
) -> Array:
    frame = moving_frame(expansion)
    profile = np.broadcast_to(s * s, (phases.size, s.size)).copy()
    for k, (value, slope) in frame.modes.items():
        if k == 0:
            continue
        a, b = np.zeros_like(phases), np.zeros_like(phases)
        for n in range(1, expansion.order + 1):
            a -= small**n * fourier_sum(value[n], phases)
            b -= small**n * fourier_sum(slope[n], phases) / (k * omega)
        x = k * omega * s
        profile += a[:, None] * versine(x) + b[:, None] * sine_defect(x)
    return profile


def fourier_sum(harmonics: dict[int, float], phases: Array) -> Array:
    """c₀ + Σ 2 c_j cos jθ at each phase.

    >>> fourier_sum({0: 1.0, 1: 0.5}, np.array([0.0]))
    array([2.])
    """
    total = np.full_like(phases, harmonics.get(0, 0.0))
    for j, c in harmonics.items():
        if j:
            total += 2.0 * c * np.cos(j * phases)
    return total


def versine(x: Array) -> Array:
    """1 − cos x without cancellation: 2 sin²(x/2)."""
    half = np.sin(0.5 * x)
    return 2.0 * half * half


def sine_defect(x: Array) -> Array:
    """x − sin x; by its Taylor series where |x| < 1, where the difference would cancel.

    Eight terms leave a remainder below x³/6 · 6/19! < 2⁻⁵³ x³/6 there.
    """
    square = x * x
    series = np.zeros_like(x)
    for k in range(8, 0, -1):
        series = (1.0 - series) * square / ((2 * k + 1) * (2 * k))
    return np.where(np.abs(x) < 1.0, x * series, x - np.sin(x))


def order_sizes(expansion: Expansion[Any], small: float) -> tuple[float, ...]:
    """Σ_j |small^n ξ_{n,j}| for n = 1 … N: a bound on what each order adds to ξ_c."""
    return tuple(
        abs(small) ** n
        * sum((1.0 if j == 0 else 2.0) * abs(c) for j, c in expansion.contact(n).items())
        for n in range(1, expansion.order + 1)
    )


def is_ordered(sizes: tuple[float, ...]) -> bool:
    """No order exceeds the first, and the first leaves the contact point on the rope.

    An asymptotic series means something while its terms decrease; and when already the first
    exceeds 1, the contact point would pass the driven end.
    """
    return max(sizes) <= sizes[0] < 1.0


def _check_ordering(
    expansion: Expansion[Any], omega: float, epsilon: float, small: float
) -> tuple[float, ...]:
    """The size of each order; an OrderingError when they are not ordered."""
    terms = order_sizes(expansion, small)
    if is_ordered(terms):
        return terms
    worst = max(range(len(terms)), key=terms.__getitem__)
    what = (
        f"order {worst + 1} contributes up to {terms[worst]:.2g} to x_c/x0, "
        f"order 1 only {terms[0]:.2g}"
        if worst
        else f"already the linear response moves the contact point by {terms[0]:.2g} x0"
    )
    raise OrderingError(
        f"epsilon = {epsilon!r} is too large for order {expansion.order} at Omega = {omega!r} "
        f"(sin Omega = {math.sin(omega):.3g}): {what}. Give a smaller epsilon, a lower order, or "
        "an Omega farther from its resonances"
    )
