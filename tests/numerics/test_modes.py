"""Periodic states by modes: against collocation, against the exact string, and themselves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.periodic import collocation
from numerics.periodic.linear_rope import LinearRope, NoPeriodicStateError, Terms
from numerics.periodic.states import periodic_contact
from tests.validation.two_sided_states import contact_of

OMEGA = 2.2
STRING: Terms = {(0, 2): 1.0, (2, 0): -1.0}


def shaken(t: Any) -> Any:
    return np.cos(OMEGA * t)


def still(t: Any) -> Any:
    return 0.0 * t


HELD = ({(0, 0): 1.0}, 1.0, shaken)
ROPES = {
    "string": LinearRope(STRING, -2.0, [HELD], 2, OMEGA, 1.0),
    "damped, on a curved ground": LinearRope(
        {**STRING, (0, 1): 0.3, (0, 0): 1.7}, -2.0, [HELD], 2, OMEGA, 0.9, (0.05, 0.02, 0.0)
    ),
    "clamped beam, load that varies": LinearRope(
        {**STRING, (4, 0): 0.05},
        [-0.2, -2.0],
        [HELD, ({(1, 0): 1.0}, 0.0, still)],
        3,
        OMEGA,
        1.5,
    ),
    "travelling": LinearRope(
        {(0, 2): 1.0, (1, 1): 0.6, (2, 0): -0.91}, -2.0, [HELD], 2, OMEGA, 0.95
    ),
}


def test_conditions_in_other_units_are_the_same_conditions() -> None:
    rope = ROPES["damped, on a curved ground"]
    tripled = LinearRope(
        rope.terms,
        rope.load,
        [({(0, 0): 3.0}, 3.0, lambda t: 3 * shaken(t))],
        rope.contacts,
        rope.omega,
        rope.rest,
        rope.ground,
    )
    one, other = (periodic_contact(x, 0.02, 13) for x in (rope, tripled))
    assert np.max(np.abs(one - other)) < 1e-12


@pytest.mark.parametrize("name", ROPES)
def test_modes_are_what_collocation_converges_to(name: str) -> None:
    rope = ROPES[name]
    found = periodic_contact(rope, 0.02, 13)
    errors = [
        float(np.max(np.abs(collocation.periodic_contact(rope, 0.02, 13, n) - found)))
        for n in (10, 14)
    ]
    assert errors[1] < 1e-6
    assert errors[1] < errors[0] / 8 or errors[1] < 1e-9


def test_the_exact_string_has_the_same_state() -> None:
    """At ε = .02 and 25 times; the invariant circle knows neither modes nor harmonics."""
    circle = invariant_circle(OMEGA, 0.02)
    times = 25
    tau = 2 * np.pi / OMEGA * np.arange(times) / times
    found = periodic_contact(ROPES["string"], 0.02, times)
    assert np.max(np.abs(circle.contact(tau) - found)) < 1e-10


def test_harmonics_that_are_left_out_are_what_is_missing() -> None:
    rope = ROPES["string"]
    fine = periodic_contact(rope, 0.05, 45)
    errors = [abs(periodic_contact(rope, 0.05, n)[0] - fine[0]) for n in (5, 15, 31)]
    assert errors[0] > 50 * errors[1] > 2500 * errors[2]


def test_springs_against_the_two_sides_written_out() -> None:
    for kappa in (2.0, 400.0):
        rest = np.sqrt(1 + 1 / kappa) - 1 / np.sqrt(kappa)
        rope = LinearRope(STRING, -2.0, [HELD], 1, OMEGA, rest, (0.0,), kappa)
        found = periodic_contact(rope, 0.01, 15)
        assert np.max(np.abs(found - contact_of(0.0, kappa, OMEGA, 0.01, rest, 7))) < 1e-11
    # On a slope the rope on springs is the flat one seen from it: a line is carried by tension.
    tilted = LinearRope(STRING, -2.0, [HELD], 1, OMEGA, rest, (0.3, 0.0), 400.0)
    assert np.max(np.abs(periodic_contact(tilted, 0.01, 15) - found)) < 1e-12


@pytest.mark.parametrize(
    ("rope", "times", "says"),
    [
        (ROPES["string"], 4, "odd"),
        (LinearRope({**STRING, (2, 0): [-1.0, -1.0]}, -2.0, [HELD], 2, OMEGA, 1.0), 5, "varies"),
        (LinearRope(STRING, -2.0, [HELD, HELD], 2, OMEGA, 1.0), 5, "needs 1"),
        (LinearRope(STRING, -2.0, [HELD], 2, OMEGA, 1.0, (0.0,), 3.0), 5, "needs 1"),
    ],
)
def test_bad_ropes(rope: LinearRope, times: int, says: str) -> None:
    with pytest.raises(InputError, match=says):
        periodic_contact(rope, 0.01, times)


def test_too_violent_a_drive_has_no_state() -> None:
    with pytest.raises(NoPeriodicStateError, match="smaller epsilon"):
        periodic_contact(ROPES["string"], 0.9, 15)
    with pytest.raises(InputError, match="modes"):
        collocation.periodic_contact(
            LinearRope(STRING, -2.0, [HELD], 1, OMEGA, 0.95, (0.0,), 3.0), 0.01, 5, 10
        )
