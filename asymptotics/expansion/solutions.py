r"""Solutions of one harmonic's equation, seen from the contact point.

With ∂^r = Σ χ_i ∂^i let φ_l be the solution whose only non-zero derivative below r at s = 0 is
∂^l φ_l = 1. Where the first m derivatives of a sum of such solutions cancel, as they do at the
contact point, the terms that cancel are better left out than computed:

.. math:: ψ_l(s) = φ_l(s) − \begin{cases} s^l/l! & l < m \\ 0 & l ≥ m. \end{cases}

(String, m = 2: ψ₀ = cos ks − 1, ψ₁ = sin(ks)/k − s.) Every ψ_l is right relative to its own size
down to s = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

# 2^d/d! is below 2⁻⁵³ from here on.
_TERMS = 26


def solutions(reduction: Sequence[complex], m: int, s: Array) -> Array:
    """ψ_0(s) … ψ_{r−1}(s), one row each.

    Parameters
    ----------
    reduction
        χ_0 … χ_{r−1}.
    m
        How many leading terms are left out.
    s
        Distances, any shape.

    Examples
    --------
    >>> solutions([-4.0, 0.0], 2, np.array([-0.5])).ravel().round(6)     # cos 1 − 1, (1 − sin 1)/2
    array([-0.459698,  0.079265])
    >>> solutions([0.0, 0.0, 0.0], 2, np.array([-0.5])).ravel()          # s²/2
    array([0.   , 0.   , 0.125])
    """
    chi = np.asarray(reduction)
    r = chi.size
    if r == m == 2 and chi[1] == 0:
        return _wave(-chi[0], s)
    # No root of the characteristic polynomial is larger (Fujiwara); s and the derivatives are
    # measured in it, so that neither thin boundary layers nor slow waves unbalance the matrix.
    rate = 2.0 * max(abs(chi[i]) ** (1.0 / (r - i)) for i in range(r))
    if rate == 0:
        left_out = [np.zeros(s.shape)] * min(m, r)
        return np.stack(left_out + [s**l / math.factorial(l) for l in range(m, r)])  # noqa: E741
    matrix = np.eye(r, k=1, dtype=chi.dtype)
    matrix[-1] += chi / rate ** np.arange(r, 0, -1)
    powers = [np.eye(r, dtype=chi.dtype)]
    for d in range(1, _TERMS + r):
        powers.append(powers[-1] @ matrix / d)
    x = rate * s
    out = np.empty((r, *s.shape), dtype=chi.dtype)
    near = np.abs(x) <= 1.0
    out[:, near] = _series(powers, m, x[near])
    doublings = np.maximum(np.ceil(np.log2(np.maximum(np.abs(x), 1.0))), 0.0)
    for q in np.unique(doublings[~near]):
        at = ~near & (doublings == q)
        out[:, at] = _doubled(powers, int(q), m, x[at])
    return out / rate ** np.arange(r).reshape(r, *(1,) * s.ndim)


def _wave(square: complex, s: Array) -> Array:
    """(cos ks − 1, sin(ks)/k − s) with k² = ``square``."""
    k = np.sqrt(complex(square))
    if k == 0:
        return np.zeros((2, *s.shape))
    x = (k if k.imag else k.real) * s
    return np.stack([-versine(x), -sine_defect(x) / (k if k.imag else k.real)])


def _series(powers: Sequence[Array], m: int, x: Array) -> Array:
    """ψ_l for |x| ≤ 1 from the first rows of A^d/d!, without the terms left out."""
    total = np.zeros((powers[0].shape[0], x.size), dtype=powers[0].dtype)
    for d in range(len(powers) - 1, -1, -1):
        row = powers[d][0].copy()
        if d < m:
            row[d] = 0.0  # A^d has the first row e_d for d < r
        total = total * x + row[:, None]
    return total


def _doubled(powers: Sequence[Array], q: int, m: int, x: Array) -> Array:
    """ψ_l for 2^{q−1} < |x| ≤ 2^q: e^{xA} by q squarings of its Taylor sum."""
    h = (x / 2.0**q)[:, None, None]
    exponential = np.zeros((x.size, *powers[0].shape), dtype=powers[0].dtype)
    for power in reversed(powers):
        exponential = exponential * h + power
    for _ in range(q):
        exponential = exponential @ exponential
    out = exponential[:, 0, :].T.copy()
    for l in range(min(m, out.shape[0])):  # noqa: E741
        out[l] -= x**l / math.factorial(l)
    return out


def versine(x: Array) -> Array:
    """1 − cos x without cancellation: 2 sin²(x/2)."""
    half = np.sin(0.5 * x)
    return 2.0 * half * half


def sine_defect(x: Array) -> Array:
    """x − sin x; by its Taylor series where |x| < 1, where the difference would cancel.

    Eight terms leave a remainder below x³/6 · 6/19! < 2⁻⁵³ x³/6 there.
    """
    near = np.abs(x) < 1.0
    square = np.where(near, x, 0.0) ** 2
    series = np.zeros_like(square)
    for k in range(8, 0, -1):
        series = (1.0 - series) * square / ((2 * k + 1) * (2 * k))
    return np.where(near, x * series, x - np.sin(x))
