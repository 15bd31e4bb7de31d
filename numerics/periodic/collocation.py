r"""Periodic states of any linear rope with a moving contact, by collocation.

On y = ξ/ξ_c(τ) the lifted part is a fixed strip. W is a table of Chebyshev points in y and an odd
number of equal times in a period; there

.. math:: ∂_ξ = ξ_c^{−1} ∂_y, \qquad ∂_τ = ∂_t − y \frac{ξ_c'}{ξ_c} ∂_y

are matrices, and so is the equation Σ c_{kt}(ξ) ∂_ξ^k ∂_τ^t W = ℓ(ξ). For given ξ_c(τ) it is
solved with all conditions but the last one at the contact point, which Newton's iteration then
meets by moving ξ_c. Nothing here is expanded in ε.

Dense matrices: some hundred unknowns are well under a second. Rounding costs what r derivatives on
n points cost, about n^{2r} ulp.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope, NoPeriodicStateError

# Part of ξ₀: steps that no longer shrink are rounding only below it.
_SETTLED = 1e-6

# The matrix of slopes is kept while it serves; by then the iteration has settled, or will not.
_MOST_STEPS = 30


def periodic_contact(rope: LinearRope, epsilon: float, times: int, points: int) -> Array:
    """ξ_c of the periodic state at ``times`` equal times of a period, from τ = 0.

    Parameters
    ----------
    epsilon
        ε.
    times
        Odd; harmonics up to (times − 1)/2 are resolved.
    points
        Chebyshev points in y.

    Raises
    ------
    InputError
        A wrong number of conditions, an even number of times, or too few points.
    NoPeriodicStateError
        The iteration does not settle: ε beyond the state's end, or too few points.

    Examples
    --------
    The string at rest, W = (1 − ξ)², and moved by ξ₁ = Ω/(2 sin Ω) cos Ωτ:

    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> moved = periodic_contact(string, 1e-3, 9, 12)
    >>> round(float(moved[0] - 1) / 1e-3, 2), round(1.1 / np.sin(2.2), 2)
    (1.36, np.float64(1.36))
    """
    if rope.springs:
        raise InputError("springs: collocation is of a ground that does not give way; use modes")
    if len(rope.ends) != rope.order - rope.contacts + 1:
        raise InputError(
            f"{len(rope.ends)} conditions at the driven end; an equation of order {rope.order} "
            f"with {rope.contacts} at the contact point needs {rope.order - rope.contacts + 1}"
        )
    if times < 3 or times % 2 == 0 or points < rope.order + 2:
        raise InputError(
            f"times = {times}, points = {points}; give an odd number of times ≥ 3 and at least "
            f"{rope.order + 2} points"
        )
    grid = _Strip(rope, epsilon, times, points)
    found = _settled(grid.left, float(rope.rest), times)
    if found is None:
        raise NoPeriodicStateError(
            f"no periodic state found at epsilon = {epsilon!r} on {times} times and {points} "
            "points; give a smaller epsilon, or more points"
        )
    return found


def _settled(left: Callable[[Array], Array], rest: float, times: int) -> Array | None:
    """The contact point at equal times at which nothing is left, by Newton's iteration from rest.

    None where it does not settle.
    """
    contact = np.full(times, rest)
    with np.errstate(all="ignore"):
        inverse, before = _inverse_slopes(left, contact), np.inf
        for _ in range(_MOST_STEPS):
            change = -inverse @ left(contact)
            contact = contact + change
            size = float(np.abs(change).max())
            if not size < rest:
                break
            # It has settled when what is left is rounding, which no further step makes smaller.
            if size < 1e-9 * rest or (size >= before and size < _SETTLED * rest):
                return contact
            if size > 0.02 * before and size > _SETTLED * rest:
                inverse = _inverse_slopes(left, contact)
            before = size
    return None


def _inverse_slopes(function: Callable[[Array], Array], place: Array) -> Array:
    """The inverse of the matrix of derivatives, by central differences."""
    step = 1e-6
    columns = []
    for i in range(place.size):
        unit = np.zeros_like(place)
        unit[i] = step
        columns.append((function(place + unit) - function(place - unit)) / (2 * step))
    return np.linalg.inv(np.stack(columns, axis=1))


class _Strip:
    """The equation on the fixed strip.

    Operators are tables with four indices, (time, point) from (time, point): in that form ∂_ξ acts
    on each time alone, and ∂_t on each point alone.
    """

    def __init__(self, rope: LinearRope, epsilon: float, times: int, points: int) -> None:
        self.rope, self.epsilon = rope, epsilon
        self.tau = 2 * np.pi / rope.omega * np.arange(times) / times
        self.y, d_y = chebyshev(points)
        self.powers = [np.linalg.matrix_power(d_y, k) for k in range(rope.order + 1)]
        self.d_t = fourier(times, rope.omega)
        self.unit = np.eye(times * points).reshape(times, points, times, points)
        self.ground = [np.polyder(np.poly1d(list(rope.ground)), k) for k in range(rope.contacts)]
        statements = [rope.terms, *(terms for terms, _, _ in rope.ends)]
        self.highest = max(t for terms in statements for _, t in terms)

    def _in_time(self, contact: Array) -> list[Array]:
        """∂_τ^t for all t in use."""
        rate = self.d_t @ contact / contact
        stretched = rate[:, None, None] * (self.y[:, None] * self.powers[1])
        found = [self.unit]
        for _ in range(self.highest):
            moved = np.einsum("ij,jpkq->ipkq", self.d_t, found[-1], optimize=True)
            found.append(moved - np.einsum("ipr,irkq->ipkq", stretched, found[-1], optimize=True))
        return found

    def left(self, contact: Array) -> Array:
        """∂^{m−1}(W − g) at the contact point, when all else holds."""
        rope, times, points = self.rope, self.tau.size, self.y.size
        size, m = times * points, rope.contacts
        in_time = self._in_time(contact)

        def operator(k: int, t: int, rows: slice = slice(None)) -> Any:
            """∂_ξ^k ∂_τ^t, or some of its points' rows."""
            scaled = contact[:, None, None] ** -k * self.powers[k][None, rows]
            return np.einsum("ipr,irjq->ipjq", scaled, in_time[t], optimize=True)

        place = contact[:, None] * self.y
        matrix = sum(
            np.polyval(np.atleast_1d(c), place)[..., None, None] * operator(k, t)
            for (k, t), c in rope.terms.items()
        )
        right = np.polyval(np.atleast_1d(rope.load), place)
        # Point 0 is the contact point, the last one the driven end; the equation gives way to the
        # conditions on the points next to both.
        near, far = slice(0, 1), slice(points - 1, points)
        for e in range(m - 1):
            matrix[:, e] = operator(e, 0, near)[:, 0]
            right[:, e] = self.ground[e](contact)
        for i, (terms, constant, drive) in enumerate(rope.ends):
            row = sum(c * operator(k, t, far)[:, 0] for (k, t), c in terms.items())
            matrix[:, points - 1 - i] = row
            right[:, points - 1 - i] = constant + self.epsilon * drive(self.tau)
        w = np.linalg.solve(matrix.reshape(size, size), right.reshape(size))
        last = operator(m - 1, 0, near)[:, 0].reshape(times, size)
        return np.asarray(last @ w - self.ground[m - 1](contact))


def chebyshev(points: int) -> tuple[Array, Array]:
    """Points on [0, 1] from 1 down to 0, and the matrix of d/dy on them.

    >>> y, d = chebyshev(8)
    >>> bool(np.allclose(d @ y**3, 3 * y**2))
    True
    """
    i = np.arange(points)
    x = np.cos(np.pi * i / (points - 1))
    c = np.where((i == 0) | (i == points - 1), 2.0, 1.0) * (-1.0) ** i
    d = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(points))
    d -= np.diag(d.sum(axis=1))
    return (x + 1) / 2, 2 * d


def fourier(times: int, omega: float) -> Array:
    """d/dτ on an odd number of equal times in a period 2π/Ω.

    >>> tau = 2 * np.pi / 3 * np.arange(7) / 7
    >>> bool(np.allclose(fourier(7, 3.0) @ np.sin(3 * tau), 3 * np.cos(3 * tau)))
    True
    """
    i = np.arange(times)
    apart = i[:, None] - i[None, :] + np.eye(times)
    d = 0.5 * (-1.0) ** apart / np.sin(np.pi * apart / times)
    d[i, i] = 0.0
    return omega * d
