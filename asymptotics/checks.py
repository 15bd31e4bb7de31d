"""Checks of arguments that several entry points share; each answers in one clear error."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.errors import InputError


def finite_number(name: str, value: Any) -> float:
    """The value as a finite float.

    >>> finite_number("epsilon", 1)
    1.0
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r} is not a number") from None
    if not math.isfinite(number):
        raise InputError(f"{name} = {number!r}; give a finite number")
    return number


def positions(s: npt.ArrayLike, times: int, beyond: bool = False) -> npt.NDArray[np.float64]:
    """Positions s = (x − x_c)/x₀ ≤ 0, one list for all times or a row for each of them.

    ``beyond`` allows s > 0, where the ground gives way and the rope on it moves.

    >>> positions([-0.5, 0.0], 3)
    array([-0.5,  0. ])
    """
    table = np.ndim(s) == 2 if not isinstance(s, str) else False
    if table and np.shape(s)[0] != times:
        raise InputError(
            f"s has {np.shape(s)[0]} rows for {times} times; give one list, or a row for each time"
        )
    array = axis("s", np.ravel(s) if table else s)
    if array.size and array.max() > 0 and not beyond:
        raise InputError(
            f"s = {float(array.max())!r} is beyond the contact point; "
            "the profile is defined for s = (x − x_c)/x₀ ≤ 0"
        )
    return array.reshape(np.shape(s)) if table else array


def axis(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """A number or a one-dimensional list as an array of finite numbers.

    >>> axis("tau", 0.5)
    array([0.5])
    """
    try:
        array = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"{name} = {values!r} is not a list of numbers") from None
    if array.ndim != 1:
        raise InputError(
            f"{name} has shape {array.shape}; give a number or a one-dimensional list (a result "
            "over two such lists is a table, rows over tau and columns over s)"
        )
    if not np.isfinite(array).all():
        worst = float(array[~np.isfinite(array)][0])
        raise InputError(f"{name} contains {worst!r}; give finite numbers")
    return array


def whole_number(name: str, value: Any, most: int) -> int:
    """A whole number from 1 to ``most``, for p, q and counts.

    Raises
    ------
    InputError
        Anything else.

    >>> whole_number("q", 3, 8)
    3
    """
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise InputError(f"{name} = {value!r}; give a whole number from 1 to {most}")
    return value


def check_order(order: Any) -> int:
    """The order as an int ≥ 1, or an :class:`InputError` that says what is allowed."""
    if isinstance(order, bool) or not hasattr(order, "__index__"):
        raise InputError(f"order = {order!r} is not an integer; give a whole number N ≥ 1")
    value = int(order.__index__())
    if value < 1:
        raise InputError(f"order = {value}; the expansion starts at order 1: give N ≥ 1")
    return value
