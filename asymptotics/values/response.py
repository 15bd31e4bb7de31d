r"""Contact point and profile of any problem, from its expansion over numbers.

The drive may have several frequencies and phases, the coefficients may be complex (damping), and
the equation of a harmonic may be of any degree (bending):

.. math:: ξ_c ∼ ξ_0 + \sum_{n≤N} ε^n ξ_n(τ), \qquad
          \frac{w}{Z_0} ∼ \sum_l G_l ψ_l(s) + \sum_k \sum_l G_{k,l} ψ_{k,l}(s)

with ξ₀ the problem's static contact point, the G of :mod:`asymptotics.expansion.moving_frame`
through ε^N and the solutions ψ of :mod:`asymptotics.expansion.solutions`: the powers of s below m
are those that the contact conditions cancel, and are left out rather than computed.

**Where there is a rope.** The profile belongs to −ξ_c(τ) ≤ s ≤ 0 alone. Beyond the driven end the
formulas go on, but say nothing of a rope, and are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.checks import axis, finite_number, positions
from asymptotics.errors import InputError, OrderingError
from asymptotics.expansion.moving_frame import MovingFrame, moving_frame
from asymptotics.expansion.order_loop import Expansion, Progress
from asymptotics.expansion.solutions import solutions
from asymptotics.problems.string import LARGEST_PHASE, RESOLUTION
from asymptotics.rings.harmonics import Harmonics

Array = npt.NDArray[Any]
Phase = Callable[[int], Array]

MOST = 10**8
"""Values of one profile: 0.8 GB."""

_UNIT = 2.0**-53
# Roundings that a coefficient of the profile has gone through before it meets its solution.
_ROUNDINGS = 64


@dataclass(frozen=True)
class Response:
    """ξ_c and w/Z₀ on a grid.

    Attributes
    ----------
    epsilon
        The value of the small parameter.
    s, tau
        Positions s = (x − x_c)/x₀ ≤ 0, shape (S,) or (T, S), and times τ = ct/x₀, shape (T,).
    contact
        ξ_c = x_c/x₀ at each τ, shape (T,).
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
    progress: Progress | None = None,
) -> Response:
    """Evaluate an expansion over floats or complex numbers.

    Parameters
    ----------
    expansion
        Of any problem over numbers that states its static contact point:
        :func:`~asymptotics.problems.forcing.forced_string`,
        :func:`~asymptotics.problems.damped.damped_string`,
        :func:`~asymptotics.problems.beam.float_beam`.
    phase
        (j, τ) ↦ θ_j, as :meth:`asymptotics.problems.forcing.FourierDrive.phase`.
    epsilon
        The problem's small parameter: the forcing amplitude ε in units of Z₀ for the problems
        above, ε/sin Ω for :func:`~asymptotics.problems.string.float_string`.
    s
        A number or a one-dimensional list, the same at all times, or a table with a row for each
        time; −ξ_c(τ) ≤ s ≤ 0. Where the ground gives way also s > 0.
    tau
        A number or a one-dimensional list.
    progress
        Called with n when order n of the profile is known.

    Raises
    ------
    InputError
        Values that are not finite; s outside the lifted part; τ so large that a phase is not
        resolved; more than 10⁸ values; an expansion that is not over numbers, or whose problem does
        not state ξ₀; or boundary layers so thin that rounding has the profile.
    OrderingError
        ε so large that a later order exceeds the first, or that the first exceeds ξ₀.

    Examples
    --------
    >>> from asymptotics import expand
    >>> from asymptotics.problems.forcing import forced_string, fourier_drive
    >>> drive = fourier_drive([0.83, 1.31], {(1, 0): 1.0}, {(0, 1): 0.5})
    >>> result = response(expand(forced_string(drive, 6), 6), drive.phase, 0.02, [-1.0], [0.0])
    >>> result.contact.round(8), result.profile.round(8)
    (array([1.01116192]), array([[0.99763133]]))

    With bending:

    >>> from asymptotics.problems.beam import float_beam
    >>> solution = expand(float_beam(0.01, 2.2, 3), 3)
    >>> result = response(solution, lambda j, tau: 2.2 * j * tau, 0.02, [-0.5], [0.0])
    >>> result.contact.round(8), result.profile.round(8)
    (array([1.13039172]), array([[0.16698635]]))
    """
    epsilon, times = finite_number("epsilon", epsilon), axis("tau", tau)
    places = positions(s, times.size, beyond=expansion.problem.ground is not None)
    count = times.size * places.shape[-1]
    if count > MOST:
        raise InputError(
            f"{times.size} times × {places.shape[-1]} positions are {count} values, more than "
            f"{MOST:g}; give fewer at once"
        )
    rest = _rest(expansion)
    terms = check_ordering(expansion, epsilon, rest)
    phases = cache(lambda j: _resolved(j, phase(j, times), times))
    try:
        contact = np.full(times.shape, rest)
        for n in range(1, expansion.order + 1):
            contact += epsilon**n * real_series(expansion.contact(n), phases, times)
        _check_driven_end(places, times, contact)
        profile = np.zeros((times.size, places.shape[-1]))
        if count:
            frame = moving_frame(expansion, progress)
            profile = _profile(frame, phases, epsilon, np.minimum(places, 0.0), times)
            if frame.right is not None and places.max() > 0:
                there = np.maximum(places, 0.0)
                right = _profile(frame.right, phases, epsilon, there, times, beyond=True)
                profile = np.where(places > 0, right, profile)
    except MemoryError:
        raise InputError(
            f"not enough memory for a profile at {times.size} times × {places.shape[-1]} "
            "positions; give fewer at once"
        ) from None
    return Response(epsilon, expansion.order, places, times, contact, profile, terms)


def real_series(harmonics: Harmonics[Any], phase: Phase, like: Array) -> Array:
    """c₀ + 2 Re Σ_{j>0} c_j e^{iθ_j}, with the shape of ``like``.

    >>> real_series({0: 1.0, 1: 0.5j}, lambda j: np.array([np.pi / 2]), np.zeros(1))
    array([0.])
    """
    total = np.zeros_like(like)
    for j, c in harmonics.items():
        value = complex(c)
        if j == 0:
            total += value.real
            continue
        total += 2.0 * value.real * np.cos(phase(j))
        if value.imag:
            total -= 2.0 * value.imag * np.sin(phase(j))
    return total


def _rest(expansion: Expansion[Any]) -> float:
    """ξ₀, when the expansion is over numbers."""
    name = expansion.problem.name
    try:
        values = [complex(c) for n in expansion.orders for c in n.contact.values()]
        if expansion.problem.rest is None:
            raise TypeError
        return float(np.real(expansion.problem.rest)) + 0.0 * len(values)
    except (TypeError, ValueError):
        raise InputError(
            f"the expansion of {name!r} is not over numbers at one frequency, or does not state "
            "where the contact point rests; expand forced_string, damped_string or float_beam"
        ) from None


def _resolved(j: int, phase: Array, times: Array) -> Array:
    """The phase of harmonic j, when doubles know it to half their digits."""
    unresolved = ~(np.abs(phase) <= LARGEST_PHASE)
    if unresolved.any():
        worst = int(np.flatnonzero(unresolved)[0])
        raise InputError(
            f"tau = {times[worst]!s}: the phase of harmonic {j}, {phase[worst]:.3g}, is beyond "
            f"{LARGEST_PHASE:.3g}, where double precision does not resolve it; take whole "
            "periods off tau"
        )
    return phase


def _check_driven_end(s: Array, times: Array, contact: Array) -> None:
    """No position beyond the driven end.

    ξ_c is known to half the digits at least, see :data:`~asymptotics.problems.string.RESOLUTION`:
    a position that misses the driven end by less than that is the driven end.
    """
    if not s.size:
        return
    beyond = s.min(axis=-1) < -contact - RESOLUTION
    if beyond.any():
        i = int(np.flatnonzero(beyond)[0])
        least = float(s.min() if s.ndim == 1 else s[i].min())
        raise InputError(
            f"s = {least!r} is beyond the driven end, which is at s = {-contact[i]:.10g} when "
            f"tau = {times[i]:.10g}; give {-contact[i]:.10g} <= s <= 0 there"
            + (f", or {-contact.min():.10g} <= s <= 0 for all tau" if times.size > 1 else "")
        )


def _profile(
    frame: MovingFrame[Any],
    phase: Phase,
    epsilon: float,
    s: Array,
    times: Array,
    beyond: bool = False,
) -> Array:
    """W at s from the coefficients of one side's frame."""
    problem = frame.expansion.problem
    ring, m = problem.ring, problem.contact_order
    side: Any = problem.ground if beyond else problem

    def amplitude(series: Sequence[Harmonics[Any]], real: bool) -> Array:
        total: Array = np.zeros(times.shape, dtype=float if real else complex)
        for n, harmonics in enumerate(series):
            if real:
                total += epsilon**n * real_series(harmonics, phase, times)
            else:
                for j, c in harmonics.items():
                    total += 2.0 * epsilon**n * c * np.exp(1j * phase(j))
        return total

    parts = [(side.static_reduction, frame.static, True)]
    for k, series in frame.modes.items():
        reduction = side.reduction(k) if beyond else problem.mode(k).reduction
        parts.append((reduction, series, ring.even or k == 0))
    profile, size = np.zeros((times.size, s.shape[-1])), 0.0
    for reduction, rows, real in parts:
        chi = [complex(x).real if real else complex(x) for x in reduction]
        factors, psi = np.stack([amplitude(row, real) for row in rows]), solutions(chi, m, s)
        size = max(
            size, *(np.abs(f).max() * np.abs(p).max() for f, p in zip(factors, psi, strict=True))
        )
        profile += (factors.T @ psi if s.ndim == 1 else np.einsum("lt,lts->ts", factors, psi)).real
    if not size * _ROUNDINGS * _UNIT <= RESOLUTION:
        raise InputError(
            f"the profile of {problem.name!r} cancels terms of size {size:.2g}: its layers are "
            "thinner than double precision resolves from the contact point; with bending, use the "
            "module that asymptotics.printing.beam_numpy writes, which holds for every beta"
        )
    return profile


def check_ordering(expansion: Expansion[Any], epsilon: float, rest: float) -> tuple[float, ...]:
    """Σ_j |ε^n ξ_{n,j}| for n = 1 … N: a bound on what each order adds to ξ_c.

    An asymptotic series means something while its terms decrease; and when already the first
    exceeds ξ₀, the contact point would pass the driven end.

    Raises
    ------
    OrderingError
        One of the two is lost.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        sizes = [
            float(np.float64(abs(epsilon)) ** n * _size(expansion.contact(n)))
            for n in range(1, expansion.order + 1)
        ]
    first, worst = sizes[0], max(range(len(sizes)), key=sizes.__getitem__)
    if max(sizes) <= first < rest:
        return tuple(sizes)
    what = (
        f"already the linear response moves the contact point by {first:.2g} x0"
        if not first < rest
        else f"order {worst + 1} contributes up to {sizes[worst]:.2g} to x_c/x0, "
        f"order 1 only {first:.2g}"
    )
    raise OrderingError(
        f"epsilon = {epsilon!r} is too large for order {expansion.order} of "
        f"{expansion.problem.name}: {what}. Give a smaller epsilon, a lower order, or a frequency "
        "farther from resonance"
    )


def _size(harmonics: Harmonics[Any]) -> float:
    return float(sum((1.0 if j == 0 else 2.0) * abs(complex(c)) for j, c in harmonics.items()))
