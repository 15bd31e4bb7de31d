"""How a wave-less state was lost, and what a bracket of the loss has changed: words for both."""

from __future__ import annotations

from enum import Enum

from numerics.thresholds.ramped_run import Outcome

GROWING = 1.1
"""The growth in five periods from which on a swing is growing."""


class Mechanism(Enum):
    """How the wave-less state was lost: the first of these that the lost run shows."""

    RESONANT_GROWTH = "resonant growth"
    """The swing of ξ_c was growing faster than ε, by 10 % in the last five periods: the slow motion
    beyond a fold, or a beat with the free oscillation. Nothing damps the wave-less rope, so that
    only slower ramps tell the two apart."""
    NEW_CONTACT = "new contact"
    """The swing was steady, and the rope came down before the contact point and cut off at least
    half the length of the pulse of height h in one step: grazing."""
    SONIC_CONTACT = "sonic contact"
    """The swing was steady, no such cut was resolved, and in the last period the contact point had
    moved faster than 1, beyond the standard error."""
    UNDECIDED = "undecided"
    """None of these was seen, or too few of the runs agree."""


class Change(Enum):
    """Which of the base settings a bracket has changed."""

    BASE = "base"
    GRID = "dx/2"
    STEP = "dt/2"
    RAMP_TWICE = "ramp × 2"
    RAMP = "ramp × 4"
    HOLD = "hold × 4"
    HEIGHT = "height × 10"
    SCHEME = "other integrator"
    LABELS = "labels × 2"
    """Of the exact string; all other changes but those of ramp and hold are of the grid."""


def mechanism(lost: Outcome, length: float) -> Mechanism:
    """What a lost run shows; ``length`` is that of the smallest wave that counts."""
    if lost.growth > GROWING:
        return Mechanism.RESONANT_GROWTH
    if lost.cut >= length / 2:
        return Mechanism.NEW_CONTACT
    if lost.speed is not None and abs(lost.speed.value) - lost.speed.error > 1:
        return Mechanism.SONIC_CONTACT
    return Mechanism.UNDECIDED
