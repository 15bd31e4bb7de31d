"""What varies along the rope: a polynomial in ξ, or a table of values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from numerics.errors import InputError
from numerics.problems.drive import Array, finite

LONGEST = 10**5
"""Entries of a table."""


@dataclass(frozen=True)
class Along:
    """A function of ξ that can be told from others, as files have to.

    Attributes
    ----------
    coefficients
        c_0, c_1, … of c_0 + c_1 ξ + …; or none.
    places, values
        Then a table, ξ increasing, with a monotone cubic between its entries.

    Examples
    --------
    >>> Along((1.0, -0.5))(np.array([0.0, 1.0])).tolist()
    [1.0, 0.5]
    >>> Along((), (0.0, 1.0, 2.0), (0.0, 1.0, 1.0))(np.array([1.5])).tolist()
    [1.0]
    """

    coefficients: tuple[float, ...] = (0.0,)
    places: tuple[float, ...] = ()
    values: tuple[float, ...] = ()

    def __call__(self, xi: ArrayLike) -> Array:
        """The values there.

        Raises
        ------
        InputError
            A place beyond the table.
        """
        x = np.asarray(xi, float)
        if self.coefficients:
            return np.asarray(np.polynomial.polynomial.polyval(x, self.coefficients), float)
        if x.size and not self.places[0] <= x.min() <= x.max() <= self.places[-1]:
            raise InputError(
                f"a table from ξ = {self.places[0]:g} to {self.places[-1]:g} is asked for ξ = "
                f"{x.min():.6g} … {x.max():.6g}; let it cover the domain"
            )
        from scipy.interpolate import PchipInterpolator

        return np.asarray(PchipInterpolator(self.places, self.values)(x), float)

    @property
    def label(self) -> str:
        """What tells it from others, in files."""
        if self.coefficients:
            return "polynomial " + " ".join(map(repr, self.coefficients))
        pairs = zip(self.places, self.values, strict=True)
        return "table " + " ".join(f"{x!r}:{y!r}" for x, y in pairs)


def along(name: str, given: Any) -> Along:
    """A number, the coefficients of a polynomial, or an :class:`Along`, as an Along.

    Raises
    ------
    InputError
        Anything else, or what is not finite.

    Examples
    --------
    >>> along("tension", [1, 0.1]).label
    'polynomial 1.0 0.1'
    """
    if isinstance(given, Along):
        return given
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        return Along((finite(name, given),))
    if not len(given):
        raise InputError(f"{name}: no coefficient is given; write c0, or c0, c1, …")
    return Along(tuple(finite(name, c) for c in given))


def table(name: str, places: ArrayLike, values: ArrayLike) -> Along:
    """A table of values along the rope.

    Raises
    ------
    InputError
        Two lists of different lengths, fewer than two entries or more than LONGEST, what is not
        finite, or places that do not increase.

    Examples
    --------
    >>> float(table("ground", [0, 1, 8], [0, -0.2, -0.2])(5.0))
    -0.2
    """
    try:
        x, y = np.asarray(places, float), np.asarray(values, float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: a table needs two lists of numbers") from None
    if x.ndim != 1 or x.shape != y.shape or not 2 <= x.size <= LONGEST:
        raise InputError(
            f"{name}: a table of shapes {x.shape} and {y.shape}; give two lists of equal length, "
            f"2 … {LONGEST} entries"
        )
    if not (np.isfinite(x).all() and np.isfinite(y).all() and (np.diff(x) > 0).all()):
        raise InputError(f"{name}: give finite numbers, ξ increasing")
    return Along((), tuple(x.tolist()), tuple(y.tolist()))
