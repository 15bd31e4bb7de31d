"""What a point of Fig. 2 is, and that what was read from a file is one."""

from __future__ import annotations

import math
import reprlib
from typing import Any

from numerics.errors import FileError

Point = dict[str, Any]

MECHANISMS = ("resonant growth", "new contact", "sonic contact", "undecided")

STIFFNESSES = (0.01, 0.001, 1e-4, 0.0)
"""The β that are computed."""

LARGEST_OMEGA = 10.0
"""Beyond Ω₂ and all that is computed around it."""


def check_points(points: Any, source: str) -> list[Point]:
    """The points, if each is one: known β and mechanism, intervals that are intervals.

    Raises
    ------
    FileError
        What is wrong with which.

    Examples
    --------
    >>> check_points(None, "points.json")
    Traceback (most recent call last):
    numerics.errors.FileError: points.json does not hold points of figure 2: a list of them is \
missing. Compute them anew
    """
    try:
        _require(isinstance(points, list) and len(points) > 0, "a list of them is missing")
        for number, point in enumerate(points, start=1):
            try:
                _check_point(point)
            except ValueError as error:
                raise ValueError(f"in number {number}, {error}") from None
        places = [(point["beta"], point["omega"]) for point in points]
        _require(len(set(places)) == len(places), "two are of the same β and Ω")
    except ValueError as error:
        raise FileError(
            f"{source} does not hold points of figure 2: {error}. Compute them anew"
        ) from None
    return list(points)


def _check_point(point: Any) -> None:
    _require(isinstance(point, dict), "which is no object")
    beta, brackets = point.get("beta"), point.get("brackets")
    _require(_number(beta) and beta in STIFFNESSES, f"beta is {reprlib.repr(beta)}")
    omega = point.get("omega")
    _require(_number(omega) and 0 < omega < LARGEST_OMEGA, f"omega is {reprlib.repr(omega)}")
    mechanism = point.get("mechanism")
    _require(mechanism in MECHANISMS, f"mechanism is {reprlib.repr(mechanism)}")
    _check_interval(point, "the point")
    _require(isinstance(brackets, list) and len(brackets) > 0, "brackets are missing")
    for row in brackets:
        _require(isinstance(row, dict) and isinstance(row.get("change"), str), "a bracket is none")
        _check_interval(row, f"the bracket {reprlib.repr(row['change'])}")
        growth = row.get("growth")
        _require(growth is None or _number(growth), f"growth is {reprlib.repr(growth)}")
    ends = min(row["lower"] for row in brackets), max(row["upper"] for row in brackets)
    _require(ends == (point["lower"], point["upper"]), "the brackets do not span the interval")
    circle = point.get("circle")
    if beta > 0:
        _require(circle is None, f"circle is {reprlib.repr(circle)}, with beta > 0")
    else:
        _require(isinstance(circle, list) and len(circle) == 2, f"circle is {reprlib.repr(circle)}")
        _check_interval(dict(zip(("lower", "upper"), circle, strict=True)), "circle")


def _check_interval(row: Point, name: str) -> None:
    lower: Any = row.get("lower")
    upper: Any = row.get("upper")
    _require(
        _number(lower) and _number(upper) and 0 < lower < upper < 1,
        f"{name} is from {reprlib.repr(lower)} to {reprlib.repr(upper)}, no interval of amplitudes",
    )


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf


def _require(holds: bool, what: str) -> None:
    if not holds:
        raise ValueError(what)
