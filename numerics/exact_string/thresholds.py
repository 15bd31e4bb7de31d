r"""When, and from which drive on, the exact string's contact point reaches the wave speed.

The first sonic contact of many runs at once, and the smallest ε that has one, for the harmonic
drive Z = 1 + ε r(τ) cos Ωτ of :func:`numerics.problems.drive.ramped_cosine`: ramped for some
periods, held for some more. The map is compiled (:mod:`numerics.exact_string.kernels`).

What a threshold means: below the break-up of the invariant circle a run of finite ramp is not on
the circle, and whatever the ramp leaves is sheared until it folds, later the smaller it is; above
it the orbits drift through the gaps, slowly at first. So the threshold falls with the hold, and
depends on the ramp; :func:`threshold_study` shows by how much. At Ω = 2.9, ramp 100, the threshold
is .00861, .00836, .00814, .00785 for holds of 0, 100, 200, 400 periods, and at Ω = 2.7 it is .0319,
.0284, .0232, .0229.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.exact_string.kernels import many_sonic
from numerics.problems.drive import check_amplitude, non_negative, positive

Array = NDArray[Any]
# Scan of the threshold: points of the first sweep, and points a refinement.
SWEEP, ZOOM = 96, 16


def sonic_times(
    omegas: ArrayLike,
    epsilons: ArrayLike,
    ramp_periods: ArrayLike = 100.0,
    hold_periods: ArrayLike = 100.0,
    labels: int = 256,
) -> Array:
    r"""The first time at which ξ_c′ = −1 in each run from rest; nan where there is none.

    The drive is ``ramped_cosine(Ω, ε, ramp_periods)``, held for ``hold_periods`` more. All four
    arguments broadcast; the result has their shape. The instants are exact to rounding and do not
    depend on ``labels``, the number of orbits followed in each 2a of departures; whether a zero of
    D is seen does: see :func:`threshold_study`. For a drive so strong that h′ < −1 the profile may
    have failed before; ``exact_string_motion`` tells, by ``SonicContact.monotone_until``.

    Raises
    ------
    InputError
        Some Ω is not positive, |ε| ≥ 1, a period count is negative (the ramp's: not positive),
        the shapes do not broadcast, or labels < 8.

    Examples
    --------
    >>> times = sonic_times(2.9, [0.004, 0.02], ramp_periods=20, hold_periods=20)
    >>> bool(np.isnan(times[0])), bool(times[1] < 40 * 2 * np.pi / 2.9)
    (True, True)

    Source: the exact string reduces to a map; see :mod:`numerics.exact_string.characteristics`.
    """
    given = (omegas, epsilons, ramp_periods, hold_periods)
    times, _ = many_sonic(*_flat(given), _check_labels(labels))
    return times.reshape(np.broadcast_shapes(*(np.shape(value) for value in given)))


def _flat(given: tuple[ArrayLike, ...]) -> tuple[Array, Array, Array, Array]:
    """Ω, ε, ramp length and end of the run, one-dimensional and checked."""
    try:
        arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in given))
    except (TypeError, ValueError):
        shapes = [np.shape(value) for value in given]
        raise InputError(
            f"omegas, epsilons, ramp_periods, hold_periods have shapes {shapes}: give numbers or "
            "arrays of numbers that broadcast against each other"
        ) from None
    omega, epsilon, rise, hold = (np.array(array).ravel() for array in arrays)
    if omega.size:
        for value in (omega.min(), omega.max()):
            positive("Omega", value)
        for value in (epsilon.min(), epsilon.max()):
            check_amplitude(1.0, value)
        for value in (rise.min(), rise.max()):
            positive("ramp_periods", value)
        for value in (hold.min(), hold.max()):
            non_negative("hold_periods", value)
    period = 2 * math.pi / omega
    return omega, epsilon, rise * period, (rise + hold) * period


def _check_labels(labels: int) -> int:
    if not isinstance(labels, int) or labels < 8:
        raise InputError(f"labels = {labels!r}: give a whole number ≥ 8, e.g. 256")
    return labels


@dataclass(frozen=True)
class SonicThreshold:
    """The least ε with a sonic contact, of those tried, and what it was found with.

    Attributes
    ----------
    omega
        Ω.
    lower, upper
        None of the ε tried up to ``lower`` has a sonic contact during the run; ``upper`` has one.
    ramp_periods, hold_periods, labels
        The run; a longer hold can only lower the threshold.
    """

    omega: float
    lower: float
    upper: float
    ramp_periods: float
    hold_periods: float
    labels: int


def sonic_threshold(
    omega: float,
    ramp_periods: float = 100.0,
    hold_periods: float = 100.0,
    labels: int = 256,
    rtol: float = 1e-4,
) -> SonicThreshold:
    r"""The smallest ε at which the ramped run has a sonic contact, as [lower, upper].

    The ε with a contact need not form an interval. So ε is swept upwards on a geometric grid, and
    the gap before the first contact is swept again on a finer one, until it is narrower than
    ``rtol`` relative to ε: the first contact *on these grids* is bracketed, and a window of
    contacts that falls between all ε tried below it would be missed.

    Raises
    ------
    InputError
        As :func:`sonic_times`; rtol outside (1e-12, 1); or no ε < 1 has a contact.

    Examples
    --------
    >>> found = sonic_threshold(2.9, ramp_periods=20, hold_periods=20)
    >>> found.upper - found.lower <= 1e-4 * found.upper
    True
    """
    omega = positive("Omega", omega)
    if not 1e-12 < rtol < 1:
        raise InputError(f"rtol = {rtol!r}: give a relative width between 1e-12 and 1, e.g. 1e-4")
    # The standard map at K = 2εΩ² = 4 folds within a few returns of the full drive.
    highest = min(1 - 1e-9, 2 / omega**2)
    grid = np.r_[0.0, np.geomspace(1e-6 * highest, highest, SWEEP)]
    while True:
        times = sonic_times(omega, grid, ramp_periods, hold_periods, labels)
        events = np.flatnonzero(~np.isnan(times))
        if events.size == 0:
            raise InputError(
                f"Omega = {omega!r}: no ε up to {highest:.6g} has a sonic contact within "
                f"{ramp_periods!r} + {hold_periods!r} periods; hold the drive for longer"
            )
        lower, upper = float(grid[events[0] - 1]), float(grid[events[0]])
        if upper - lower <= rtol * upper:
            break
        grid = np.linspace(lower, upper, ZOOM + 1)
    return SonicThreshold(
        omega, lower, upper, float(ramp_periods), float(hold_periods), _check_labels(labels)
    )


def threshold_study(
    omega: float,
    ramp_periods: float = 100.0,
    hold_periods: float = 100.0,
    labels: int = 256,
    rtol: float = 1e-4,
) -> tuple[SonicThreshold, ...]:
    """The threshold with each of ramp, hold and labels halved and doubled, the given run first.

    The spread of the seven is what the threshold means: the number for one run is no more certain
    than that.

    Examples
    --------
    >>> rows = threshold_study(2.9, ramp_periods=20, hold_periods=20, labels=128, rtol=1e-2)
    >>> [(row.ramp_periods, row.hold_periods, row.labels) for row in rows[:3]]
    [(20.0, 20.0, 128), (10.0, 20.0, 128), (40.0, 20.0, 128)]
    """
    run = (ramp_periods, hold_periods, labels)
    runs = [run]
    for place in range(3):
        for factor in (0.5, 2):
            changed = [value * (factor if i == place else 1) for i, value in enumerate(run)]
            runs.append((changed[0], changed[1], int(changed[2])))
    return tuple(sonic_threshold(omega, rise, hold, count, rtol) for rise, hold, count in runs)
