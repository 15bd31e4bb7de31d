r"""The Lindstedt series of the exact string: its periodic state at a fixed rotation number.

The periodic wave-less state is an invariant circle φ = ψ + U(ψ) of the standard map with K = 2εΩ²
(φ = Ωt, t the times at which a characteristic leaves the driven end). At a fixed rotation number ϱ,

.. math:: U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ)), \qquad U = \sum_n K^n U_n,

has the small divisors −4 sin²(kϱ/2), and for Diophantine ϱ the series converges up to where the
circle breaks up in the complex plane of K. The drive frequency Ω is then a function of K; at fixed
Ω it is ϱ that moves, and the series diverges, see :mod:`asymptotics.values.series_analysis`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.problems.string import check_frequency

Array = npt.NDArray[np.float64]


def lindstedt(rotation: float, order: int) -> Array:
    r"""U_n(ψ) of the invariant circle φ = ψ + Σ K^n U_n(ψ) at fixed ϱ, on equispaced nodes.

    .. math:: U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ))

    Parameters
    ----------
    rotation
        ϱ in radians.
    order
        N ≥ 1.

    Returns
    -------
    numpy.ndarray
        Shape (N + 1, M), row n is U_n at 2πi/M; M > 2N + 2, so that no harmonic is aliased.

    Examples
    --------
    >>> first = lindstedt(1.66, 2)[1]
    >>> round(float(first.max()) * 4 * math.sin(0.83) ** 2, 12)      # sin ψ/(4 sin²(ϱ/2))
    1.0
    """
    order = check_order(order)
    check_frequency(rotation, 0)
    nodes = 1 << (2 * order + 3).bit_length()
    k = np.arange(nodes // 2 + 1)
    divisor = -4 * np.sin(k * rotation / 2) ** 2
    divisor[0] = 1.0  # U has no mean, and neither has its force
    u = np.zeros((order + 1, nodes))
    wave = np.zeros((order + 1, nodes), dtype=complex)  # e^{i(ψ+U)}
    wave[0] = np.exp(2j * np.pi * np.arange(nodes) / nodes)
    for n in range(1, order + 1):
        c = np.fft.rfft(-wave[n - 1].imag) / divisor
        c[0], c[n + 1 :] = 0, 0
        u[n] = np.fft.irfft(c, nodes)
        weighted = (np.arange(1, n + 1) / n)[:, None] * u[1 : n + 1]
        wave[n] = 1j * (weighted * wave[n - 1 :: -1]).sum(axis=0)
    return u


@dataclass(frozen=True)
class BreakUp:
    """Radius of convergence in K at fixed rotation number: :func:`break_up`.

    Attributes
    ----------
    radius, error
        The last extrapolation, and its largest distance to the two before it.
    slopes, extrapolations
        What they come from, by increasing order.
    diagonal
        The same extrapolation for the harmonics k = n of U_n alone. They are a map of their own
        (the semi-standard one), with a larger radius, and dominate ‖U_n‖ at n = q up to order 400.
    """

    rotation: float
    order: int
    radius: float
    error: float
    slopes: tuple[float, ...]
    extrapolations: tuple[float, ...]
    diagonal: float


def break_up(convergents: Sequence[int], rotation: float) -> BreakUp:
    r"""Where the circle of rotation number ϱ breaks up, from the norms of its Lindstedt series.

    ‖U_n‖, the sum of U_n's Fourier amplitudes, climbs in steps at the denominators q of ϱ/2π's
    convergents, where the small divisors are. So ln ‖U_n‖ is fitted by a line
    over windows of two steps each, [q_{k−2}, q_k]; with :math:`\|U_n\| ∼ C n^a R^{−n}` its slope
    is −ln R up to O(1/q), which two windows eliminate.

    Parameters
    ----------
    convergents
        At least six denominators, increasing; the last one is the order N.
    rotation
        ϱ in radians.

    Raises
    ------
    InputError
        Denominators that are too few or do not increase; ϱ not positive.

    Examples
    --------
    >>> found = break_up([8, 13, 21, 34, 55, 89], math.pi * (math.sqrt(5) - 1))
    >>> abs(found.radius - 0.971635) < found.error < 0.05
    True
    """
    q = list(convergents)
    if len(q) < 6 or any(b <= a for a, b in pairwise(q)) or q[0] < 1:
        raise InputError(f"convergents {q!r}: give at least six increasing denominators")
    u = lindstedt(rotation, q[-1])
    amplitudes = 2 * np.abs(np.fft.rfft(u, axis=1)) / u.shape[1]
    logs = np.log(amplitudes[1:].sum(axis=1))
    slopes = []
    for low, high in zip(q, q[2:], strict=False):
        n = np.arange(low, high + 1)
        slopes.append(math.exp(-np.polyfit(n, logs[n - 1], 1)[0]))
    extrapolations = _extrapolated(slopes, q[2:])
    diagonal = [math.log(amplitudes[n, n]) for n in q]
    steps = [
        math.exp((a - b) / (n - m)) for (m, a), (n, b) in pairwise(zip(q, diagonal, strict=True))
    ]
    last = extrapolations[-1]
    return BreakUp(
        rotation,
        q[-1],
        last,
        max(abs(last - value) for value in extrapolations[-3:]),
        tuple(slopes),
        tuple(extrapolations),
        _extrapolated(steps, q[1:])[-1],
    )


def _extrapolated(values: Sequence[float], q: Sequence[int]) -> list[float]:
    """R from R + b/q at two successive q."""
    pairs = pairwise(zip(values, q, strict=True))
    return [(n * b - m * a) / (n - m) for (a, m), (b, n) in pairs]
