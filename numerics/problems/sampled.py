"""A drive from samples: the motion of a vessel as it was recorded."""

from __future__ import annotations

import csv
import hashlib
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from numerics.errors import InputError
from numerics.problems.drive import Array, Drive, picklable

Between = Literal["spline", "monotone"]
BETWEEN: tuple[str, ...] = get_args(Between)

MOST_BYTES = 64 * 2**20
FEWEST, MOST = 4, 10**6


@picklable
def sampled(times: ArrayLike, heights: ArrayLike, between: str = "spline") -> Drive:
    """Z(τ) through samples; it rests before the first and after the last.

    Parameters
    ----------
    times, heights
        τ, increasing, from 0 on, and Z > 0.
    between
        ``spline``: a cubic spline with Z′ = 0 at both ends, so that a rope may start from rest;
        ``monotone``: no overshoot between samples, Z″ jumps at them.

    Raises
    ------
    InputError
        Samples that are no increasing times and positive heights, or too few or many of them.

    Examples
    --------
    >>> drive = sampled([0, 1, 2, 3], [1.0, 1.1, 1.05, 1.0])
    >>> drive.height(np.array([0.0, 1.0, 9.0])).round(12).tolist(), drive.omega
    ([1.0, 1.1, 1.0], None)
    """
    if between not in BETWEEN:
        raise InputError(f"between = {between!r}; choose one of {', '.join(BETWEEN)}")
    try:
        t, z = np.asarray(times, float), np.asarray(heights, float)
    except (TypeError, ValueError):
        raise InputError("samples: give two lists of numbers, tau and Z") from None
    if t.ndim != 1 or t.shape != z.shape or not FEWEST <= t.size <= MOST:
        raise InputError(
            f"samples of shapes {t.shape} and {z.shape}; give two lists of equal length, {FEWEST} "
            f"… {MOST} samples"
        )
    if not (np.isfinite(t).all() and np.isfinite(z).all()):
        raise InputError("samples: give finite numbers")
    if t[0] != 0 or not (np.diff(t) > 0).all() or not (z > 0).all():
        raise InputError("samples: tau has to increase from 0 on, and Z to stay above the ground")
    from scipy.interpolate import CubicSpline, PchipInterpolator

    curve: Any = (
        CubicSpline(t, z, bc_type="clamped") if between == "spline" else PchipInterpolator(t, z)
    )
    last = float(t[-1])

    def part(order: int) -> Any:
        function = curve.derivative(order) if order else curve

        def value(x: Array) -> Array:
            inside = np.clip(x, 0.0, last)
            found = np.asarray(function(inside), float)
            return found if order == 0 else np.where((x >= 0) & (x <= last), found, 0.0)

        return value

    digest = hashlib.sha256(t.tobytes() + z.tobytes()).hexdigest()[:16]
    label = f"{t.size} samples to tau = {last!r}, {between}, {digest}"
    return Drive(part(0), part(1), label, curvature=part(2))


def read_samples(path: Path | str, between: str = "spline") -> Drive:
    """The drive in a CSV file: two columns, τ and Z, with or without a line of names.

    Raises
    ------
    InputError
        No such file, one that is too large, or what is not two columns of numbers.
    """
    path = Path(path)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path}: more than {MOST_BYTES} bytes; give fewer samples")
        with path.open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path} is no CSV file of two columns, tau and Z: {error}") from None
    if rows and not _number(rows[0][0]):
        rows = rows[1:]
    numbers = []
    for line, row in enumerate(rows, start=1):
        if len(row) != 2 or not all(map(_number, row)):
            raise InputError(f"{path}, sample {line}: {','.join(row)[:60]!r} is not tau, Z")
        numbers.append((float(row[0]), float(row[1])))
    if not numbers:
        raise InputError(f"{path} holds no samples: write a line tau, Z for each")
    times, heights = zip(*numbers, strict=True)
    return sampled(times, heights, between)


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
