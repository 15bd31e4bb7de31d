r"""The emitted closed forms beside the exact string: the numbers of the cross-check.

The exact string (:mod:`numerics.exact_string.characteristics`) is brought from rest to a periodic
state by a ramp. What the ramp leaves, and rounding, is the *floor*: the distance of that state from
the invariant circle, which is the exact periodic one with mean height W(0) = 1, plus one rounding.
(The simulator's part is in :mod:`derivations.cross_check.runs`.)

No floor knows of the series. An order N is judged at the amplitudes where its error exceeds
``keep`` floors and ε does not exceed ``top``, which the series gives before anything is compared
(:func:`~derivations.cross_check.forms.largest_amplitudes`). All norms are root mean squares, over a
period and, for W, over PLACES: consecutive orders hold harmonics of different parity and are
orthogonal, so that the following terms change a slope by O(q²) only.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asymptotics.errors import InputError
from derivations.cross_check.forms import (
    SHARE,
    Array,
    JudgedForm,
    largest_amplitudes,
    phases,
    rms,
    term_sizes,
)
from numerics.exact_string.characteristics import exact_string_motion
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.problems.drive import Drive, ramped_cosine

EPS = 2.0**-52
PLACES: Array = np.arange(1, 7) * np.float64(0.1)
"""ξ at which W is compared: nodes of all grids used, and lifted at all amplitudes used."""
EXACT_KEEP = 10.0
SETTLE = 4.0
"""Time after a ramp by which the characteristics that left during it are back."""


def ramped(omega: float, epsilon: float, length: float) -> Drive:
    """1 + ε cos Ωτ, ramped up in the given time: :func:`numerics.problems.drive.ramped_cosine`.

    >>> round(float(ramped(2.0, 0.1, 30.0).height(np.array(20 * np.pi))), 12)
    1.1
    """
    return ramped_cosine(omega, epsilon, length * omega / (2 * math.pi))


Row = tuple[list[tuple[float, float]], tuple[float, float]]
"""At one ε: the errors of ξ_c and W, order by order, and the floors of the two."""


@dataclass(frozen=True, eq=False)
class Errors:
    """Of one quantity: of the orders 1, 2, …, shape (orders, k), and the floor, shape (k,)."""

    error: Array
    floor: Array


@dataclass(frozen=True, eq=False)
class Comparison:
    """Closed forms against one solution, over a ladder of amplitudes from large to small.

    Attributes
    ----------
    omega, beta
        Of which rope; β is nan where that is a reader's own.
    epsilon
        ε, shape (k,), decreasing.
    top
        The largest ε at which each order is judged, shape (orders,).
    keep
        How many floors an error must exceed.
    sizes
        ‖ξ_1‖, ‖ξ_2‖, … .
    contact, shape
        Errors of ξ_c and of W, the latter where W was compared.
    """

    omega: float
    beta: float
    epsilon: Array
    top: Array
    keep: float
    sizes: Array
    contact: Errors
    shape: Errors | None

    @property
    def orders(self) -> range:
        """1, 2, … N."""
        return range(1, len(self.top) + 1)

    def judged(self, errors: Errors, order: int) -> NDArray[np.bool_]:
        """Which amplitudes judge an order: from ``top`` down to the first error near the floor."""
        below = self.epsilon <= self.top[order - 1]
        clear = errors.error[order - 1] > self.keep * errors.floor
        return np.asarray(below & np.logical_and.accumulate(clear | ~below))

    def slope(self, errors: Errors, order: int) -> float:
        """The exponent of ε in an order's error, by least squares in the logarithms.

        Raises
        ------
        InputError
            Fewer than two amplitudes judge this order.
        """
        inside = self.judged(errors, order)
        if inside.sum() < 2:
            raise InputError(
                f"order {order} is judged by {inside.sum()} amplitudes of {inside.size}, and a "
                "slope takes two: lower the floor, or give more amplitudes"
            )
        x, y = np.log(self.epsilon[inside]), np.log(errors.error[order - 1, inside])
        return float(np.polyfit(x, y, 1)[0])

    def uncertainty(self, errors: Errors, order: int) -> float:
        """By how much that slope may be off: the floor's share of each error, and SHARE² for the
        terms that follow, see the module's docstring.
        """
        inside = self.judged(errors, order)
        x = np.log(self.epsilon[inside])
        weights = (x - x.mean()) / ((x - x.mean()) ** 2).sum()
        share = errors.floor[inside] / errors.error[order - 1, inside]
        return float((np.abs(weights) * share).sum()) + SHARE**2

    def decades(self, errors: Errors, order: int) -> tuple[float, float]:
        """The decades of ε, and of the error, that were judged."""
        inside = self.judged(errors, order)
        if not inside.any():
            return 0.0, 0.0
        ends = self.epsilon[inside], errors.error[order - 1, inside]
        first, second = (float(np.log10(v[0] / v[-1])) for v in ends)
        return first, second

    def prefactor(self, order: int) -> float:
        """‖error of ξ_c‖/(‖ξ_{N+1}‖ ε^{N+1}) at the smallest ε judged: 1 if all is right."""
        last = int(np.flatnonzero(self.judged(self.contact, order))[-1])
        expected = self.sizes[order] * self.epsilon[last] ** (order + 1)
        return float(self.contact.error[order - 1, last] / expected)


def against_exact_string(
    omega: float,
    forms: Sequence[JudgedForm],
    length: float = 400.0,
    points: int = 4,
    decades: float = 2.0,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Closed forms of orders 1 … N against the exact string after a ramp of the given length.

    The ladder has ``points`` amplitudes a decade, from the largest ``top`` to ``decades`` below the
    smallest. ``progress`` is called with how many are done, and of how many.

    Raises
    ------
    CircleNotFoundError, SonicContactError
        An amplitude at which no such state exists.
    """
    top = largest_amplitudes(term_sizes(omega, 0.0, len(forms) + 3), len(forms))
    # One step more than asked, so that rounding cannot cost the last.
    steps = math.ceil(points * (math.log10(top.max() / top.min()) + decades)) + 1
    epsilon = top.max() * 10.0 ** (-np.arange(steps + 1) / points)
    rows = []
    for e in epsilon.tolist():
        rows.append(_exact_row(omega, e, forms, length))
        if progress is not None:
            progress(len(rows), epsilon.size)
    return comparison(omega, 0.0, epsilon, len(forms), EXACT_KEEP, rows)


def _exact_row(omega: float, epsilon: float, forms: Sequence[JudgedForm], length: float) -> Row:
    drive = ramped(omega, epsilon, length)
    tau, xi = phases(omega, length + SETTLE), PLACES[:, None]
    # Labels serve the search for a sonic contact only; that there is none the circle vouches for.
    motion = exact_string_motion(drive, float(tau[-1]) + 1, max_labels=64)
    circle = invariant_circle(omega, epsilon)
    contact, shape = motion.contact(tau), motion.shape(xi, tau)
    errors = []
    for form in forms:
        of_contact, of_shape = form.at(epsilon)
        errors.append((rms(of_contact(tau) - contact), rms(of_shape(xi, tau) - shape)))
    floor = rms(circle.contact(tau) - contact), rms(circle.shape(xi, tau) - shape)
    return errors, (floor[0] + EPS, floor[1] + EPS)


def comparison(
    omega: float, beta: float, epsilon: Any, orders: int, keep: float, rows: Sequence[Row]
) -> Comparison:
    """Rows, one an amplitude, as a Comparison."""
    sizes = term_sizes(omega, beta, orders + 3)
    errors = np.array([row[0] for row in rows]).T  # (quantity, orders, k)
    floors = np.array([row[1] for row in rows]).T
    contact, shape = (Errors(e, f) for e, f in zip(errors, floors, strict=True))
    top = largest_amplitudes(sizes, orders)
    return Comparison(omega, beta, np.array(epsilon), top, keep, sizes, contact, shape)
