r"""Contact point and profile of any string problem, from its expansion over numbers.

:mod:`asymptotics.evaluate` does this for the paper's drive; here the drive may have several
frequencies and phases, and the wavenumbers k_j may be complex (damping):

.. math:: ξ_c ∼ 1 + \sum_{n≤N} ε^n ξ_n(τ), \qquad
          \frac{w}{Z_0} ∼ s^2 - \sum_j \Bigl[G_{j,0} (1 − \cos k_js)
                          + G_{j,1} \Bigl(s − \frac{\sin k_js}{k_j}\Bigr)\Bigr]

with the G of :mod:`asymptotics.profile`; the terms in 1 and s are those that the contact conditions
cancel, and are left out rather than computed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.checks import axis, finite_number, positions
from asymptotics.errors import OrderingError
from asymptotics.evaluate import is_ordered, order_sizes, sine_defect, versine
from asymptotics.expansion import Expansion
from asymptotics.harmonics import Harmonics
from asymptotics.profile import moving_frame

Array = npt.NDArray[Any]
Phase = Callable[[int], Array]


@dataclass(frozen=True)
class Response:
    """ξ_c and w/Z₀ on a grid.

    Attributes
    ----------
    s, tau
        Positions s = (x − x_c)/x₀ ≤ 0, shape (S,), and times τ = ct/x₀, shape (T,).
    contact
        ξ_c at each τ, shape (T,).
    profile
        w/Z₀, rows over τ and columns over s, shape (T, S).
    terms
        Bound on the n-th order's share of ξ_c, Σ_j |ε^n ξ_{n,j}|, for n = 1 … N.
    """

    epsilon: float
    order: int
    s: Array
    tau: Array
    contact: Array
    profile: Array
    terms: tuple[float, ...]

    def as_json(self) -> dict[str, Any]:
        """The fields as plain lists and numbers."""
        return {
            "epsilon": self.epsilon,
            "order": self.order,
            "s": self.s.tolist(),
            "tau": self.tau.tolist(),
            "contact": self.contact.tolist(),
            "profile": self.profile.tolist(),
            "terms": list(self.terms),
        }


def response(
    expansion: Expansion[Any],
    phase: Callable[[int, Array], Array],
    epsilon: float,
    s: npt.ArrayLike,
    tau: npt.ArrayLike,
) -> Response:
    """Evaluate an expansion in ε over floats or complex numbers.

    Parameters
    ----------
    expansion
        Of :func:`~asymptotics.forcing.forced_string` or :func:`~asymptotics.damped.damped_string`.
    phase
        (j, τ) ↦ θ_j, as :meth:`asymptotics.forcing.Drive.phase`.
    epsilon
        Forcing amplitude in units of Z₀.
    s, tau
        Numbers or one-dimensional lists; s ≤ 0.

    Raises
    ------
    InputError
        Values that are not finite, s > 0.
    OrderingError
        ε so large that a later order exceeds the first, or that the first exceeds 1.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.forcing import forced_string, fourier_drive
    >>> drive = fourier_drive([0.83, 1.31], {(1, 0): 1.0}, {(0, 1): 0.5})
    >>> result = response(expand(forced_string(drive, 6), 6), drive.phase, 0.02, [-1.0], [0.0])
    >>> result.contact.round(8), result.profile.round(8)
    (array([1.01116192]), array([[0.99763133]]))
    """
    places, times = positions(s), axis("tau", tau)
    epsilon = finite_number("epsilon", epsilon)
    terms = _check_ordering(expansion, epsilon)
    contact = np.ones_like(times)
    for n in range(1, expansion.order + 1):
        contact += epsilon**n * real_series(expansion.contact(n), lambda j: phase(j, times), times)
    profile = _profile(expansion, lambda j: phase(j, times), epsilon, places, times)
    return Response(epsilon, expansion.order, places, times, contact, profile, terms)


def real_series(harmonics: Harmonics[Any], phase: Phase, like: Array) -> Array:
    """c₀ + 2 Re Σ_{j>0} c_j e^{iθ_j}, with the shape of ``like``.

    >>> real_series({0: 1.0, 1: 0.5j}, lambda j: np.array([np.pi / 2]), np.zeros(1))
    array([0.])
    """
    total = np.zeros_like(like)
    for j, c in harmonics.items():
        wave = c * np.exp(1j * phase(j)) if j else np.full(like.shape, c)
        total += (2.0 if j else 1.0) * wave.real
    return total


def _profile(
    expansion: Expansion[Any], phase: Phase, epsilon: float, s: Array, times: Array
) -> Array:
    problem, frame = expansion.problem, moving_frame(expansion)
    profile = np.broadcast_to(s * s, (times.size, s.size)).copy()
    for k, (value, slope) in frame.modes.items():
        wavenumber = np.sqrt(complex(-problem.mode(k).reduction[0]))
        if wavenumber == 0:
            continue  # the mean has no part but 1 and s
        amplitudes = []
        for series in (value, slope):
            total = np.zeros(times.shape, dtype=complex)
            for n in range(1, expansion.order + 1):
                if problem.ring.even:
                    total += epsilon**n * real_series(series[n], phase, times)
                else:
                    for j, c in series[n].items():
                        total += 2.0 * epsilon**n * c * np.exp(1j * phase(j))
            amplitudes.append(total)
        x = wavenumber * s
        profile -= (
            np.multiply.outer(amplitudes[0], versine(x))
            + np.multiply.outer(amplitudes[1], sine_defect(x) / wavenumber)
        ).real
    return profile


def _check_ordering(expansion: Expansion[Any], epsilon: float) -> tuple[float, ...]:
    """Each order's bound; see :class:`asymptotics.errors.OrderingError`."""
    terms = order_sizes(expansion, epsilon)
    if not is_ordered(terms):
        raise OrderingError(
            f"epsilon = {epsilon!r} is too large for order {expansion.order} of "
            f"{expansion.problem.name}: the orders move x_c/x0 by up to "
            + ", ".join(f"{term:.2g}" for term in terms)
            + "; give a smaller epsilon, a lower order, or frequencies farther from resonance"
        )
    return terms
