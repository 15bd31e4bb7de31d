r"""Numbers at one frequency and amplitude: the engine over floats, no closed form in between.

Both quantities are the plain series in ε truncated at order N:

.. math:: ξ_c ∼ 1 + \sum_{n≤N} ε^n ξ_n(τ), \qquad
          \frac{w}{Z_0} ∼ s^2 + \sum_{n≤N} ε^n \sum_k
          \bigl[A_{n,k}(τ) (1 − \cos kΩs) + B_{n,k}(τ) (kΩs − \sin kΩs)\bigr].

The expansion is the one in ε itself, whose coefficients stay finite as Ω → 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from asymptotics.checks import axis, check_order, finite_number, positions
from asymptotics.expansion.order_loop import Expansion, Progress, expansions
from asymptotics.problems.forcing import FourierDrive, forced_string, fourier_drive
from asymptotics.problems.string import check_frequency
from asymptotics.values.response import Response, check_ordering, response


@dataclass(frozen=True)
class Evaluation(Response):
    """ξ_c and w/Z₀ on a grid: a :class:`~asymptotics.values.response.Response` at one Ω = ωx₀/c."""

    omega: float


def evaluate(
    omega: float,
    epsilon: float,
    order: int,
    s: npt.ArrayLike | None,
    tau: npt.ArrayLike,
    progress: Progress | None = None,
) -> Evaluation:
    """Contact point and profile of the string from the expansion of the given order.

    Parameters
    ----------
    omega, epsilon
        Ω = ωx₀/c and the forcing amplitude ε in units of Z₀.
    order
        N ≥ 1: powers of ε beyond N are dropped.
    s
        A number or a one-dimensional list, the same at all times, or a table with a row for each
        time; −ξ_c(τ) ≤ s ≤ 0. None for 0, −0.25, −0.5, −0.75 and −1, as far as the rope reaches at
        all times.
    tau
        A number or a one-dimensional list.
    progress
        Called with n when order n of the expansion is done, and with N + n when order n of the
        profile is.

    Raises
    ------
    InputError
        An argument that is not finite, has the wrong shape or range.
    ResonanceError
        Ω at a resonance pπ/q with q ≤ N; the error names p/q.
    OrderingError
        ε so large that the series has lost its ordering; at the first order that shows it.

    Examples
    --------
    >>> result = evaluate(0.83, 0.02, order=4, s=[-0.5, 0.0], tau=[0.0])
    >>> result.contact.round(8), result.profile.round(8)
    (array([1.01122152]), array([[0.2496802, 0.       ]]))
    """
    order, epsilon = check_order(order), finite_number("epsilon", epsilon)
    times = axis("tau", tau)
    places = positions([] if s is None else s, times.size)
    expansion, drive = string_expansion(omega, epsilon, order, progress)
    if s is None and times.size:
        lowest = response(expansion, drive.phase, epsilon, [], times).contact.min()
        places = np.array([x for x in (-1.0, -0.75, -0.5, -0.25, 0.0) if x >= -lowest])
    frame_done = None if progress is None else lambda n: progress(order + n)
    result = response(expansion, drive.phase, epsilon, places, times, frame_done)
    return Evaluation(**vars(result), omega=drive.frequencies[0])


def string_expansion(
    omega: float, epsilon: float, order: int, progress: Progress | None = None
) -> tuple[Expansion[float], FourierDrive]:
    """The string's expansion in ε at one Ω, and the drive ΔZ = cos Ωτ.

    Raises
    ------
    InputError, ResonanceError, OrderingError
        As :func:`evaluate`.
    """
    omega = check_frequency(omega, check_order(order))
    drive = fourier_drive([omega], {1: 1.0})
    problem = replace(forced_string(drive, order), name=f"the string at Omega = {omega!r}")
    for expansion in expansions(problem, order):
        check_ordering(expansion, epsilon, 1.0)
        if progress is not None:
            progress(expansion.order)
    return expansion, drive
