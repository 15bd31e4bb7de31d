r"""A bifurcation equation G(ε, b) = 0 as a polynomial: its branches, folds and edges.

Without damping and phases b is real and G one real equation. Otherwise b is complex and
:math:`G(ε, b, \bar b) = \sum g_{ilm} ε^i b^l \bar b^m` two real equations for ε, Re b, Im b. A
branch is followed by pseudo-arclength; on it ε turns, a *fold*, where the determinant of the
derivatives by b vanishes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Index = npt.NDArray[np.intp]

# Of the curve G = 0, in units in which the leading terms are of order one.
_STEP, _REACH, _MOST_STEPS = 0.02, 4.0, 4000
_BISECTIONS = 60


@dataclass(frozen=True)
class Polynomial:
    """Σ g ε^i b^l b̄^m: i, l, m and g as arrays ``across``, ``along``, ``back``, ``size``.

    ``real``: b and g are real, and m = 0. A place is (ε, b), or (ε, Re b, Im b).
    """

    across: Index
    along: Index
    back: Index
    size: Array
    real: bool

    def __call__(self, place: Array) -> tuple[Array, Array]:
        """G, shape (d,), and its derivatives, shape (d, d + 1); d = 1 or 2 real equations."""
        i, j, m = self.across, self.along, self.back
        b = place[1] if self.real else complex(place[1], place[2])
        x = float(place[0]) ** np.arange(i.max() + 1)
        y = b ** np.arange(j.max() + 1)
        z = np.conj(b) ** np.arange(m.max() + 1)
        size = self.size
        g = size @ (x[i] * y[j] * z[m])
        by_x = size @ (i * x[i - 1] * y[j] * z[m])
        by_b = size @ (x[i] * j * y[j - 1] * z[m])
        if self.real:
            return np.array([g]), np.array([[by_x, by_b]])
        by_conjugate = size @ (x[i] * y[j] * m * z[m - 1])
        by_real, by_imaginary = by_b + by_conjugate, 1j * (by_b - by_conjugate)
        columns = np.array([by_x, by_real, by_imaginary])
        return np.array([g.real, g.imag]), np.array([columns.real, columns.imag])

    @property
    def unknowns(self) -> int:
        """Real numbers in b."""
        return 1 if self.real else 2

    @property
    def is_forced(self) -> bool:
        """Whether there is a term without b."""
        return bool((self.along + self.back == 0).any())

    def linear(self, back: int) -> Array:
        """The polynomial in ε, lowest power first, beside b (``back`` = 0) or b̄ (1)."""
        found = np.zeros(int(self.across.max()) + 1, dtype=self.size.dtype)
        rows = (self.along == 1 - back) & (self.back == back)
        np.add.at(found, self.across[rows], self.size[rows])
        return found

    def scaled(self, epsilon: float, b: float) -> Polynomial:
        """In ε and b over these units, the largest coefficient one."""
        size = self.size * float(epsilon) ** self.across * float(b) ** (self.along + self.back)
        return replace(self, size=size / np.abs(size).max())


def polynomial_of(rows: Sequence[Array]) -> Polynomial:
    """G of its orders, without the coefficients that are zero.

    Order n holds g_{n−k,k} as a vector over k, or as a matrix over (k, l), k − l the power of b̄.
    """
    real = rows[0].ndim == 1
    terms = []
    for n, row in enumerate(rows, start=1):
        for place in zip(*np.nonzero(row), strict=True):
            k = int(place[0])
            power = k if real else int(place[1])
            terms.append((n - k, power, k - power, row[place]))
    across, along, back, size = zip(*terms, strict=True)
    return Polynomial(np.array(across), np.array(along), np.array(back), np.array(size), real)


def followed(polynomial: Polynomial) -> list[Array]:
    """Places along G = 0 from rest, by arclength; from the tongue's edge where G(ε, 0) = 0.

    It ends where ε returns to 0, on the backbone, or where ε or b have left the leading balance far
    behind; it is empty where there is no edge.
    """
    units, _, places = _followed(polynomial)
    return [place * units for place in places]


def folds_of(polynomial: Polynomial) -> list[tuple[float, complex]]:
    """(ε, b) of the folds on the branch G = 0 that begins at rest.

    >>> cubic = [np.array([-1.0, 1.5]), np.zeros(3), np.array([0.0, 0.0, 0.0, -0.5])]
    >>> [(round(x, 6), round(y, 6)) for x, y in folds_of(polynomial_of(cubic))]
    [(1.0, 1.0)]
    """
    units, scaled, places = _followed(polynomial)
    signs = [_determinant(scaled, place) for place in places]
    found = []
    for i, (before, after) in enumerate(pairwise(signs)):
        if before * after < 0:
            tangent = _tangent(scaled, places[i], places[i + 1] - places[i])
            fold = _located(scaled, places[i], tangent, before) * units
            b = float(fold[1]) if polynomial.real else complex(fold[1], fold[2])
            found.append((float(fold[0]), b))
    return found


def edge_of(polynomial: Polynomial) -> list[tuple[float, complex]]:
    """(ε, 0) at the least ε > 0 at which the part linear in b is singular; empty for none.

    With A b + B b̄ that is |A| = |B|.

    >>> edge_of(polynomial_of([np.array([0.0, 1.0]), np.array([0.0, -4.0, 0.0])]))
    [(0.25, 0.0)]
    """
    a, b = polynomial.linear(0), polynomial.linear(1)
    if polynomial.real:
        coefficients = a
    else:
        coefficients = (np.convolve(a, a.conj()) - np.convolve(b, b.conj())).real
    roots = np.roots(coefficients[::-1])
    real = roots[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0)].real
    return [(float(real.min()), 0.0)] if real.size else []


def roots_at(polynomial: Polynomial, epsilon: float) -> list[complex]:
    """The complex b with G(ε, b, b̄) = 0 on the branch that is followed, in its order."""
    units, scaled, places = _followed(polynomial)
    target, found = epsilon / units[0], []
    for one, other in pairwise(places):
        below, above = one[0] - target, other[0] - target
        if below * above > 0 or below == above:
            continue
        place = one + (other - one) * below / (below - above)
        place[0] = target
        for _ in range(20):
            value, matrix = scaled(place)
            step = np.linalg.solve(matrix[:, 1:], value)
            place[1:] -= step
            if np.abs(step).max() < 1e-13:
                break
        found.append(complex(*place[1:] * units[1]))
    return found


def _followed(polynomial: Polynomial) -> tuple[Array, Polynomial, list[Array]]:
    """Units, G in them, and the places along the branch in them."""
    epsilon, b = _units(polynomial)
    units = np.array([epsilon, *[b] * polynomial.unknowns])
    if not math.isfinite(epsilon):
        return units, polynomial, []
    scaled = polynomial.scaled(epsilon, b)
    place = np.zeros(len(units))
    if polynomial.is_forced:
        # Into ε > 0; where ε stands still, b > 0.
        tangent = _tangent(scaled, place, np.array([1.0, *[1e-9] * polynomial.unknowns]))
    else:
        place[0] = 1.0
        # b = 0 is a branch, too: the other one leaves along the kernel.
        kernel = np.linalg.svd(scaled(place)[1][:, 1:])[2][-1]
        kernel *= 1 if kernel[np.argmax(np.abs(kernel))] > 0 else -1
        tangent = np.array([0.0, *kernel])
    return units, scaled, _traced(scaled, place, tangent)


def _units(polynomial: Polynomial) -> tuple[float, float]:
    """ε and b at which D b, the cubic and the first other term are alike; ε = ∞ for no edge."""
    detuning = abs(polynomial.linear(0)[0])
    degree = polynomial.along + polynomial.back
    own = polynomial.along - polynomial.back == 1
    cubics = polynomial.size[(polynomial.across == 0) & (degree == 3) & (own | polynomial.real)]
    b = math.sqrt(detuning / abs(cubics[0])) if cubics.size else 1.0
    if polynomial.is_forced:
        rows = np.flatnonzero(degree == 0)
        row = rows[np.argmin(polynomial.across[rows])]
        power, drive = int(polynomial.across[row]), abs(polynomial.size[row])
        return float((detuning * b / drive) ** (1 / power)), b
    edge = edge_of(polynomial)
    return (edge[0][0] if edge else math.inf), b


def _traced(scaled: Polynomial, place: Array, tangent: Array) -> list[Array]:
    """Pseudo-arclength from a place along a unit tangent."""
    places = [place]
    for _ in range(_MOST_STEPS):
        place = _along(scaled, place, tangent, _STEP)
        if not (0 < place[0] < _REACH and np.linalg.norm(place[1:]) < _REACH):
            break
        places.append(place)
        tangent = _tangent(scaled, place, tangent)
    return places


def _along(scaled: Polynomial, place: Array, tangent: Array, length: float) -> Array:
    """The place on G = 0 whose part along the tangent is ``length`` farther."""
    target = place + length * tangent
    for _ in range(8):
        g, derivatives = scaled(target)
        matrix = np.vstack([derivatives, tangent])
        step = np.linalg.solve(matrix, [*g, float(tangent @ (target - place)) - length])
        target = target - step
        if np.abs(step).max() < 1e-13:
            break
    return target


def _tangent(scaled: Polynomial, place: Array, towards: Array) -> Array:
    """The unit tangent of G = 0 that has a positive part along ``towards``."""
    direction = np.linalg.svd(scaled(place)[1])[2][-1]
    return direction if direction @ towards > 0 else -direction


def _determinant(scaled: Polynomial, place: Array) -> float:
    """Of the derivatives by b: zero at a fold."""
    return float(np.linalg.det(scaled(place)[1][:, 1:]))


def _located(scaled: Polynomial, place: Array, tangent: Array, before: float) -> Array:
    """Where the determinant vanishes within the step that begins at a place, by bisection."""
    low, high = 0.0, 1.5 * _STEP
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        found = _along(scaled, place, tangent, middle)
        if _determinant(scaled, found) * before > 0:
            low = middle
        else:
            high = middle
    return _along(scaled, place, tangent, (low + high) / 2)
