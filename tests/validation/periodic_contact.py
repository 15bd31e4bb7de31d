"""Periodic states of any linear moving-contact problem by collocation: nothing is shared with the
expansion.

On y = ξ/ξ_c(τ) the lifted part is a fixed strip. W is a table of Chebyshev points in y and equal
times in a period; ∂_ξ = ξ_c⁻¹ ∂_y and ∂_τ = ∂_t − y (ξ_c′/ξ_c) ∂_y are matrices, and so is the
equation. For a given ξ_c(τ) it is solved with all conditions but the last one at the contact point,
which Newton's iteration then meets by moving ξ_c.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Terms = Mapping[tuple[int, int], float]


@dataclass(frozen=True)
class Stated:
    """A problem in numbers.

    ``ends`` are rows (terms, constant, ε-part as a function of τ); ``ground`` is g and its
    derivatives, (ξ, k) ↦ ∂^k g.
    """

    terms: Terms
    load: float
    ends: Sequence[tuple[Terms, float, Callable[[Array], Array]]]
    contacts: int
    omega: float
    rest: float
    ground: Callable[[Array, int], Array] = lambda xi, k: np.zeros_like(xi)


def chebyshev(n: int) -> tuple[Array, Array]:
    """n + 1 points on [0, 1], from 1 to 0, and the matrix of d/dy."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.where((np.arange(n + 1) == 0) | (np.arange(n + 1) == n), 2.0, 1.0)
    c = c * (-1.0) ** np.arange(n + 1)
    d = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(n + 1))
    d -= np.diag(d.sum(axis=1))
    return (x + 1) / 2, 2 * d


def fourier_matrix(count: int, omega: float) -> Array:
    """d/dτ on an odd number of equal times in a period 2π/Ω."""
    assert count % 2
    i = np.arange(count)
    difference = i[:, None] - i[None, :] + np.eye(count)
    d = 0.5 * (-1.0) ** difference / np.sin(np.pi * difference / count)
    d[i, i] = 0.0
    return omega * d


def contact_point(problem: Stated, epsilon: float, times: int = 17, n: int = 22) -> Array:
    """ξ_c at ``times`` equal times from τ = 0."""
    tau = 2 * np.pi / problem.omega * np.arange(times) / times
    y, d_y = chebyshev(n)
    d_t = fourier_matrix(times, problem.omega)

    def last_condition(x: Array) -> Array:
        return _left(problem, epsilon, x, tau, y, d_y, d_t)

    x = np.full(times, problem.rest)
    for _ in range(20):
        value = last_condition(x)
        step = 1e-6
        jacobian = np.empty((times, times))
        for i in range(times):
            moved = x.copy()
            moved[i] += step
            back = x.copy()
            back[i] -= step
            jacobian[:, i] = (last_condition(moved) - last_condition(back)) / (2 * step)
        change = np.linalg.solve(jacobian, -value)
        x = x + change
        if np.abs(change).max() < 1e-8:  # quadratic: what is left is rounding, about 1e-10
            return x
    raise AssertionError("Newton's iteration does not settle")


def _left(
    problem: Stated, epsilon: float, x: Array, tau: Array, y: Array, d_y: Array, d_t: Array
) -> Array:
    """∂^{m−1}(W − g) at the contact point, when all other conditions hold."""
    times, points = tau.size, y.size
    rate = d_t @ x / x
    d_xi = np.kron(np.diag(1 / x), d_y)
    d_tau = np.kron(d_t, np.eye(points)) - np.kron(np.diag(rate), np.diag(y) @ d_y)
    size = times * points
    operators: dict[tuple[int, int], Any] = {(0, 0): np.eye(size)}

    def operator(k: int, t: int) -> Any:
        if (k, t) not in operators:
            below = operator(k - 1, t) if k else operator(k, t - 1)
            operators[k, t] = (d_xi if k else d_tau) @ below
        return operators[k, t]

    r = max(k for k, _ in problem.terms)
    matrix = sum(c * operator(k, t) for (k, t), c in problem.terms.items())
    right = np.full(size, problem.load)
    rows = np.arange(size).reshape(times, points)
    # Row 0 of a time is the contact point, the last one the driven end.
    near, far = range(problem.contacts - 1), range(r - problem.contacts + 1)
    free = [rows[:, i] for i in (*near, *(points - 1 - i for i in far))]
    for e in range(problem.contacts - 1):
        matrix[free[e]] = operator(e, 0)[rows[:, 0]]
        right[free[e]] = problem.ground(x, e)
    for i, (terms, constant, drive) in enumerate(problem.ends):
        place = free[problem.contacts - 1 + i]
        matrix[place] = sum(c * operator(k, t)[rows[:, -1]] for (k, t), c in terms.items())
        right[place] = constant + epsilon * drive(tau)
    w = np.linalg.solve(matrix, right)
    m = problem.contacts
    return np.asarray((operator(m - 1, 0) @ w)[rows[:, 0]] - problem.ground(x, m - 1))
