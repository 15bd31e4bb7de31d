r"""Exact solutions that a contact simulator can be held against, gathered under one name.

============================================  ==========================  ======================
:mod:`~numerics.exact_solutions.rest`         the rope at rest            W_ξξ − βW_ξξξξ = 2
:mod:`~numerics.exact_solutions.pulse`        the pulse on the ground     β > 0, c > 1, two contacts
here                                          the plucked string          all of it strikes at once
:mod:`~numerics.exact_solutions.bar`          the bouncing bar            contact at one end
:mod:`~numerics.exact_solutions.impact`       a minimum that strikes      β = 0, restitution r
============================================  ==========================  ======================

Units as in the paper's eq. (beam2): ξ = x/x₀, W = w/Z₀, τ = ct/x₀,

.. math:: W_{ττ} = W_{ξξ} − 2 − βW_{ξξξξ} + R, \qquad W ≥ 0 ⟂ R ≥ 0 ;

but for the plucked string, which has no weight, and the bar, which has its own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError
from numerics.exact_solutions.bar import BouncingBar, bouncing_bar
from numerics.exact_solutions.impact import StringImpact, point_plateau
from numerics.exact_solutions.pulse import TravellingPulse, travelling_pulse
from numerics.exact_solutions.rest import static_contact_point, static_shape
from numerics.problems.drive import finite

__all__ = [
    "BouncingBar",
    "StringImpact",
    "TravellingPulse",
    "bouncing_bar",
    "plucked_string",
    "point_plateau",
    "static_contact_point",
    "static_shape",
    "travelling_pulse",
]

Array = NDArray[np.float64]


def plucked_string(x: ArrayLike, t: ArrayLike, restitution: float) -> Array:
    r"""The string u_tt = u_xx over flat ground, plucked to sin πx and let go; no weight.

    .. math:: u(x, t) = e^n |\cos πt| \sin πx, \qquad n = \lfloor t + \tfrac12 \rfloor .

    All points strike the ground together, at t = ½, 3/2, …, with the speed eⁿ⁻¹π sin πx, and leave
    with e times that; in between u is a free vibration. With e = 0 the string stays down. The
    energy is ¼π² e²ⁿ. Every e solves the same equations: the impact law is part of the model.

    Parameters
    ----------
    x, t
        Positions 0 ≤ x ≤ 1 and times t ≥ 0, broadcast against each other.
    restitution
        0 ≤ e ≤ 1.

    Raises
    ------
    InputError
        An argument outside its range.

    Examples
    --------
    >>> plucked_string(0.5, [0.0, 0.25, 0.5, 1.0, 2.0], 0.8).round(6)
    array([1.      , 0.707107, 0.      , 0.8     , 0.64    ])
    """
    e = finite("restitution", restitution)
    if not 0 <= e <= 1:
        raise InputError(f"restitution = {restitution!r}: give a number from 0 to 1")
    place, time = np.asarray(x, dtype=float), np.asarray(t, dtype=float)
    if not np.all((place >= 0) & (place <= 1)) or not np.all(time >= 0):
        raise InputError("give positions 0 ≤ x ≤ 1 and times t ≥ 0; another was among them")
    return e ** np.floor(time + 0.5) * np.abs(np.cos(np.pi * time)) * np.sin(np.pi * place)
