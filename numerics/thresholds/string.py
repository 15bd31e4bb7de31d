r"""ε_c(Ω) of the string, β = 0: where the exact motion from rest has its first sonic contact.

The same ramped run as for β > 0 (:mod:`numerics.thresholds.ramped_run`), by
:func:`numerics.exact_string.thresholds.sonic_threshold` and without a grid. What is left to vary
is the ramp, the hold and the number of orbits, and the first two matter: whatever a ramp leaves is
sheared until it folds, sooner after a short ramp. At Ω = 6 the loss is at 0.0007, 0.0021, 0.0026
after ramps of 20, 40, 80 periods and a hold of 20, and at 0.0003 for ramp 20 and hold 80.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from numerics.exact_string.thresholds import sonic_threshold, sonic_times
from numerics.thresholds.kinds import Change, Mechanism

LABELS = 256
"""Orbits that are followed in each 2a of departures."""


@dataclass(frozen=True)
class StringSettings:
    """The run: forcing periods of the ramp and after it, and the number of orbits."""

    ramp: float
    hold: float
    labels: int = LABELS


@dataclass(frozen=True)
class StringBracket:
    """ε_c under one set of settings: no sonic contact at lower, one at upper.

    Attributes
    ----------
    change, settings
        Which.
    lower, upper
        The largest amplitude below the first loss that has none, and the smallest that has one.
    mechanism
        Sonic contact: nothing else ends the exact motion.
    periods
        When, at upper: forcing periods since the start of the ramp.
    """

    change: Change
    settings: StringSettings
    lower: float
    upper: float
    mechanism: Mechanism
    periods: float


def string_brackets(
    omega: float,
    ramp: float,
    hold: float,
    quick: bool = False,
    relative: float = 0.01,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[StringBracket, ...]:
    """The brackets of :func:`numerics.thresholds.threshold.threshold` for β = 0, the base first.

    Raises
    ------
    InputError
        As :func:`~numerics.exact_string.thresholds.sonic_threshold`.

    Examples
    --------
    >>> runs = string_brackets(2.7, 20.0, 20.0)
    >>> [(run.change.value, round(run.upper, 3)) for run in runs][:3]
    [('base', 0.022), ('ramp × 2', 0.029), ('ramp × 4', 0.029)]
    """
    cases = string_variations(ramp, hold)
    if quick:
        cases = {Change.BASE: cases[Change.BASE]}
    runs: list[StringBracket] = []
    for change, each in cases.items():
        found = sonic_threshold(omega, each.ramp, each.hold, each.labels, relative)
        time = float(sonic_times(omega, found.upper, each.ramp, each.hold, each.labels))
        runs.append(
            StringBracket(
                change,
                each,
                found.lower,
                found.upper,
                Mechanism.SONIC_CONTACT,
                time * found.omega / (2 * math.pi),
            )
        )
        if progress is not None:
            progress(len(runs), len(cases))
    return tuple(runs)


def string_variations(ramp: float, hold: float) -> dict[Change, StringSettings]:
    """The run given and those that differ from it in one thing.

    >>> [change.value for change in string_variations(20.0, 20.0)]
    ['base', 'ramp × 2', 'ramp × 4', 'hold × 4', 'labels × 2']
    """
    return {
        Change.BASE: StringSettings(ramp, hold),
        Change.RAMP_TWICE: StringSettings(2 * ramp, hold),
        Change.RAMP: StringSettings(4 * ramp, hold),
        Change.HOLD: StringSettings(ramp, 4 * hold),
        Change.LABELS: StringSettings(ramp, hold, 2 * LABELS),
    }
