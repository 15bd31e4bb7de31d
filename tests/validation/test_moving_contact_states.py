"""The reader's own rope against its periodic states, which share nothing with the expansion."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand, prove
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.presets import beam as make_beam
from asymptotics.problems.presets import string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from derivations.cross_check.ropes import in_numbers
from numerics.periodic.collocation import periodic_contact
from numerics.periodic.linear_rope import LinearRope, Terms
from numerics.periodic.states import periodic_state

OMEGA = 2.2
kappa, beta, rho, v, gamma, zeta, eta = sp.symbols("kappa beta rho v gamma zeta eta")
COSINE = epsilon * sp.cos(Omega * tau)
STRING = [W, W.diff(xi)]
BEAM = [W, W.diff(xi), W.diff(xi, 2)]
BENDING = W.diff(xi, 2) - 2 - beta * W.diff(xi, 4)


def cosine(t: Any) -> Any:
    return np.cos(OMEGA * t)


def nothing(t: Any) -> Any:
    return 0.0 * t


class Case(NamedTuple):
    """A rope as its reader writes it, and again in numbers."""

    rope: MovingContact
    at: dict[Any, float]
    terms: Terms
    ends: list[tuple[Terms, float, Callable[[Any], Any]]]
    load: float = -2.0
    ground: tuple[float, ...] = (0.0,)  # of ξ, descending


B = 0.05
ON_BEAM: Terms = {(0, 2): 1.0, (2, 0): -1.0, (4, 0): B}
HELD: tuple[Terms, float, Callable[[Any], Any]] = ({(0, 0): 1.0}, 1.0, cosine)


def cases() -> dict[str, Case]:
    found = {}
    found["foundation"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
            driven_end=[sp.Eq(W, 1 + COSINE)],
            contact=STRING,
        ),
        {kappa: 1.7},
        {(0, 2): 1.0, (2, 0): -1.0, (0, 0): 1.7},
        [HELD],
    )
    found["travelling"] = Case(
        moving_contact(
            equation=sp.Eq(
                W.diff(tau, 2) + 2 * v * W.diff(xi, tau) - (1 - v**2) * W.diff(xi, 2), -2
            ),
            driven_end=[sp.Eq(W, 1 + COSINE)],
            contact=STRING,
        ),
        {v: 0.3},
        {(0, 2): 1.0, (1, 1): 0.6, (2, 0): -0.91},
        [HELD],
    )
    found["slope"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), BENDING),
            driven_end=[sp.Eq(W, 1 + COSINE), sp.Eq(W.diff(xi), 0)],
            contact=BEAM,
            ground=gamma * xi,
        ),
        {beta: B, gamma: 0.3},
        ON_BEAM,
        [HELD, ({(1, 0): 1.0}, 0.0, nothing)],
        ground=(0.3, 0.0),
    )
    found["curved ground"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
            driven_end=[sp.Eq(W, 1 + COSINE)],
            contact=STRING,
            ground=gamma * xi**2 + gamma * xi,
        ),
        {kappa: 1.7, gamma: 0.1},
        {(0, 2): 1.0, (2, 0): -1.0, (0, 0): 1.7},
        [HELD],
        ground=(0.1, 0.1, 0.0),
    )
    found["rotary inertia"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2) - rho * W.diff(xi, 2, tau, 2), BENDING),
            driven_end=[sp.Eq(W, 1 + COSINE), sp.Eq(W.diff(xi, 2), 0)],
            contact=BEAM,
        ),
        {beta: B, rho: 0.02},
        {**ON_BEAM, (2, 2): -0.02},
        [HELD, ({(2, 0): 1.0}, 0.0, nothing)],
    )
    found["guided"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), BENDING),
            driven_end=[sp.Eq(W.diff(xi), 0), sp.Eq(W.diff(xi, 3), 20 * (1 + COSINE))],
            contact=BEAM,
        ),
        {beta: B},
        ON_BEAM,
        [({(1, 0): 1.0}, 0.0, nothing), ({(3, 0): 1.0}, 20.0, lambda t: 20 * cosine(t))],
    )
    found["no shear"] = Case(
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), BENDING),
            driven_end=[sp.Eq(W, 1 + COSINE), sp.Eq(W.diff(xi, 3), 0)],
            contact=BEAM,
        ),
        {beta: B},
        ON_BEAM,
        [HELD, ({(3, 0): 1.0}, 0.0, nothing)],
    )
    found["damped, clamped, two frequencies"] = Case(
        moving_contact(
            equation=sp.Eq(
                W.diff(tau, 2) + 2 * zeta * W.diff(tau), BENDING + eta * W.diff(xi, 2, tau)
            ),
            driven_end=[
                sp.Eq(
                    W,
                    1 + COSINE + epsilon * sp.cos(3 * Omega * tau + sp.Rational(1, 2)) / 5,
                ),
                sp.Eq(W.diff(xi), 0),
            ],
            contact=BEAM,
        ),
        {beta: B, zeta: 0.1, eta: 0.03},
        {**ON_BEAM, (0, 1): 0.2, (2, 1): -0.03},
        [
            ({(0, 0): 1.0}, 1.0, lambda t: cosine(t) + np.cos(3 * OMEGA * t + 0.5) / 5),
            ({(1, 0): 1.0}, 0.0, nothing),
        ],
    )
    return found


CASES = cases()
EPSILONS = (0.02, 0.04)
TIMES, POINTS = 17, 16


def errors(name: str) -> list[list[float]]:
    """max |ξ_c − series| for N = 1, 2, 3, a row for each ε."""
    case = CASES[name]
    series = expand(case.rope, 3, at={**case.at, Omega: OMEGA})
    assert prove(series).holds
    rest = float(np.real(series.problem.rest))

    stated = LinearRope(
        case.terms, case.load, case.ends, case.rope.contact_order, OMEGA, rest, case.ground
    )
    t = 2 * np.pi / OMEGA * np.arange(TIMES) / TIMES
    found = []
    for small in EPSILONS:
        state = periodic_contact(stated, small, TIMES, POINTS)
        partial, row = np.full(TIMES, rest), []
        for n in (1, 2, 3):
            for j, c in series.contact(n).items():
                wave = np.real(complex(c) * np.exp(1j * j * OMEGA * t))
                partial = partial + small**n * (2 if j else 1) * wave
            row.append(float(np.abs(partial - state).max()))
        found.append(row)
    return found


@pytest.mark.parametrize(
    "name",
    [
        name if name == "foundation" else pytest.param(name, marks=pytest.mark.slow)
        for name in CASES
    ],
)
def test_the_error_falls_like_the_next_power_of_epsilon(name: str) -> None:
    fine, coarse = errors(name)
    for n in (1, 2, 3):
        order = math.log2(coarse[n - 1] / fine[n - 1])
        # The order after it is not small at ε = 0.04.
        assert n + 0.5 < order < n + 1.7, (n, order)
    assert fine[2] < 2e-4


@pytest.mark.parametrize(
    ("rope", "at", "small"),
    [
        (string(), {}, 0.01),
        (make_beam(), {"beta": 0.01}, 0.01),
        (make_beam(driven_end="clamped"), {"beta": 0.05}, 0.005),
        (CASES["travelling"].rope, {"v": 0.3}, 0.005),
    ],
    ids=["string", "pinned", "clamped", "travelling"],
)
def test_states_are_what_the_series_converges_to(
    rope: MovingContact, at: dict[str, float], small: float
) -> None:
    """By order 12, within the error that the state states: some 1e-13."""
    values = {**at, "Omega": OMEGA}
    rest = complex(rope.at(values).rest or 1).real
    state = periodic_state(in_numbers(rope, rope.values(values), rest), small)
    series, t = expand(rope, 12, at=values), np.linspace(0, 2 * np.pi / OMEGA, 60)
    total = np.full(t.shape, rest)
    for n in range(1, 13):
        for j, c in series.contact(n).items():
            wave = np.real(complex(c) * np.exp(1j * j * OMEGA * t))
            total = total + small**n * (2 if j else 1) * wave
    assert state.error < 1e-11
    assert abs(total - state.contact(t)).max() < 3 * state.error + 1e-14
