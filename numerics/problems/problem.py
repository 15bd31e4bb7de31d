r"""The rope as an initial-value problem with unilateral contact, stated for the simulators.

.. math:: W_{ττ} + 2ζ W_τ = W_{ξξ} − 2 − βW_{ξξξξ} + R, \qquad W ≥ 0 ⟂ R ≥ 0,

W(0, τ) = Z(τ), with W_ξξ(0) = 0 (pinned) or W_ξ(0) = 0 (clamped): the paper's eq. (beam2) with the
ground's reaction R. With what may vary along the rope it is

.. math:: m W_{ττ} + 2ζ W_τ = (T W_ξ)_ξ − q − κW − βW_{ξξξξ} + R, \qquad W ≥ g ⟂ R ≥ 0,

and what is simulated is the height W − g above the ground. Where rope meets ground at a finite
speed V it leaves with rV: the coefficient of restitution r is part of the model, for the limit of
fine grids depends on it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import Enum

from numerics.errors import InputError
from numerics.problems.along import Along, along
from numerics.problems.drive import Drive, finite, non_negative

NOTHING, ONE, TWO = Along((0.0,)), Along((1.0,)), Along((2.0,))


class DrivenEnd(Enum):
    """The second condition at ξ = 0, where β > 0."""

    PINNED = "pinned"
    CLAMPED = "clamped"

    @classmethod
    def _missing_(cls, value: object) -> DrivenEnd:
        raise InputError(f"driven end {value!r}: choose pinned (W_ξξ = 0) or clamped (W_ξ = 0)")


@dataclass(frozen=True)
class RopeProblem:
    """What is simulated.

    Attributes
    ----------
    beta
        β = B/(T x₀²), 0 ≤ β ≤ 1.
    drive
        Z(τ).
    driven_end
        A :class:`DrivenEnd` or its name.
    damping
        ζ: free waves decay as e^{−ζτ}.
    restitution
        r in [0, 1]: the part of an impact's speed with which the rope leaves the ground.
    foundation, tension, mass, weight, ground
        κ ≥ 0, T > 0, m > 0, q and g of the second equation: each a number, the coefficients of a
        polynomial in ξ, or a :func:`~numerics.problems.along.table`. g(0) = 0: heights are
        measured from the ground below the driven end.

    Raises
    ------
    InputError
        A parameter outside its range.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> RopeProblem(0.01, ramped_cosine(2.5, 0.05)).driven_end
    <DrivenEnd.PINNED: 'pinned'>
    """

    beta: float
    drive: Drive
    driven_end: DrivenEnd = DrivenEnd.PINNED
    damping: float = 0.0
    restitution: float = 0.0
    foundation: Along = NOTHING
    tension: Along = ONE
    mass: Along = ONE
    weight: Along = TWO
    ground: Along = NOTHING

    def __post_init__(self) -> None:
        beta = check_stiffness(self.beta)
        if not isinstance(self.drive, Drive):
            raise InputError(f"drive = {self.drive!r}: give a Drive, such as ramped_cosine(…)")
        object.__setattr__(self, "beta", beta)
        object.__setattr__(self, "driven_end", DrivenEnd(self.driven_end))
        object.__setattr__(self, "damping", non_negative("damping", self.damping))
        restitution = finite("restitution", self.restitution)
        if not 0 <= restitution <= 1:
            raise InputError(
                f"restitution = {restitution!r}: give a number from 0 (the rope stays on the "
                "ground) to 1 (it leaves as fast as it came)"
            )
        object.__setattr__(self, "restitution", restitution)
        for name in VARYING:
            object.__setattr__(self, name, along(name, getattr(self, name)))
        below = float(self.ground(0.0))
        if below != 0:
            raise InputError(
                f"the ground is at g(0) = {below!r} below the driven end; measure heights from "
                "there, g(0) = 0"
            )

    @property
    def varying(self) -> dict[str, str]:
        """Which of its parts are not the paper's, by their labels."""
        usual = {field.name: field.default for field in fields(self)}
        return {
            name: getattr(self, name).label
            for name in VARYING
            if getattr(self, name) != usual[name]
        }


VARYING = ("foundation", "tension", "mass", "weight", "ground")
"""What may vary along the rope."""


def check_stiffness(beta: float) -> float:
    """0 ≤ β ≤ 1."""
    number = non_negative("beta", beta)
    if number > 1:
        raise InputError(
            f"beta = {beta!r}: the simulators take 0 ≤ β ≤ 1; a stiffer rope is a beam whose "
            "tension does not matter"
        )
    return number
