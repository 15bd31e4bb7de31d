"""What the clamped driven end puts in the place of :mod:`asymptotics.printing.emitted.beam`'s
functions.
"""

from typing import Any

import numpy as np


def _excess(y: Any, beta: Any) -> Any:
    """1/beta - sigma**2, exponentially small for small beta."""
    e = np.exp(-2.0 * y)
    small = (4.0 * y * e - 2.0 * e * (1.0 - e)) / ((1.0 - e) * (1.0 - e))  # 1 - g, g = a3/(-2 p0)
    return -small * (2.0 - small) / ((1.0 - small) * (1.0 - small)) / beta


def _height(y: Any, beta: Any) -> Any:
    """2 sqrt(beta) (y coth y - 1) = 1: value and derivative."""
    e = np.exp(-2.0 * y)
    coth = (1.0 + e) / (1.0 - e)
    slope = coth - 4.0 * y * e / ((1.0 - e) * (1.0 - e))
    return y * coth - 1.0 - 0.5 / np.sqrt(beta), slope


def _start(beta: Any) -> Any:
    return 1.0 + 0.5 / np.sqrt(beta)


def _third(y: Any, beta: Any) -> Any:
    return -2.0 / np.sqrt(beta) * _height(y, beta)[1]


def _layer(y: Any) -> Any:
    """(1 - g) exp(2y) with a3 = -2 g/sqrt(beta)."""
    e = np.exp(-2.0 * y)
    return (4.0 * y - 2.0 * (1.0 - e)) / ((1.0 - e) * (1.0 - e))


def _end(a: Any, b: Any, c: Any, d: Any, w: Any) -> Any:
    """(w, w_xi) at the driven end for coefficients of the four solutions."""
    slope = a * w["k2"] * w["sine"] + b * w["cosine"] + w["p"] * (c * w["decay"] - d)
    return a * w["cosine"] - b * w["sine"] + c * w["decay"] + d, slope


def _size(w: Any, sine: Any) -> Any:
    """The size of the terms of the determinant, with the largest sin(kL)/k."""
    return (w["p2"] + w["k2"]) * sine + 2.0 * w["p"]
