"""The simulator started on periodic states: orders, growth against multipliers, both sides."""

import math
from dataclasses import replace

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.periodic.linear_rope import LinearRope
from numerics.periodic.stability import stability
from numerics.periodic.states import periodic_state
from numerics.problems.drive import fourier
from numerics.problems.problem import DrivenEnd
from numerics.simulation.run import follow
from numerics.simulation.semi_discrete import Grid
from numerics.thresholds import from_state
from numerics.thresholds.from_state import (
    Outcome,
    departure,
    outcome,
    rope_problem,
    started,
)
from tests.numerics.by_hand import order
from tests.numerics.test_states import rope

FOLD = 1.387875e-3


@pytest.mark.slow
@pytest.mark.parametrize(("omega", "epsilon", "phase"), [(2.5, 0.05, 0.0), (4.7, 0.01, 1.1)])
def test_the_simulator_stays_with_observed_order(
    omega: float, epsilon: float, phase: float
) -> None:
    """Errors of ξ_c, smoothed, over two periods; see ``Run.smooth_contact`` on their order."""
    held, still = rope(omega).ends
    ends = [(held[0], held[1], lambda tau: np.cos(omega * tau + phase)), still]
    state = periodic_state(replace(rope(omega), ends=ends), epsilon)
    sizes, errors = [0.02, 0.01, 0.005], []
    for dx in sizes:
        simulator = started(state, Grid(dx, 3.0, 0.0))
        first = simulator.ledger[0]
        run = follow(simulator, 3 * 2 * math.pi / omega, record_from=math.pi / omega)
        times, contact = run.smooth_contact()
        errors.append(float(np.sqrt(np.mean((contact - state.contact(times)) ** 2))))
        energy, work, damped, lost = run.ledger
        assert energy == pytest.approx(first + work - damped - lost, abs=1e-7)
    assert errors[0] > 2 * errors[1] > 2.5 * errors[2]
    assert order(sizes, errors) > 1.1
    assert errors[-1] < 0.01 * np.ptp(state.values)


@pytest.mark.slow
def test_disturbances_grow_as_multipliers_say() -> None:
    """On the tongue at 2Ω₁; a grid damps, by less the finer it is."""
    state = periodic_state(rope(6.5), 0.005)
    wanted = stability(state).growth
    assert wanted == pytest.approx(0.05220, abs=1e-5)
    runs = [departure(state, 80, Grid(dx, 5.0, 2.0)) for dx in (0.01, 0.005, 0.0025)]
    assert all(run.outcome is Outcome.LEAVES for run in runs)
    missing = [wanted - run.rate for run in runs]
    assert missing[0] > 2 * missing[1] > 4 * missing[2] > 0
    assert missing[2] < 0.02 * wanted


def test_both_sides_of_a_fold() -> None:
    before = periodic_state(rope(3.2), 0.9 * FOLD)
    assert outcome(before, 120)[0] is Outcome.STAYS
    told, run = outcome(before, 120, 1.1 * FOLD)
    assert told is Outcome.LEAVES
    assert run.left is not None
    assert run.left > 20 * 2 * math.pi / 3.2  # the drive's change alone is not a departure
    assert run.shed
    assert math.isnan(run.rate) or run.rate > 0


def test_grids_have_to_agree() -> None:
    """At Ω = 6.4 the growth, .008, is about what the usual grid damps."""
    told, fine = outcome(periodic_state(rope(6.4), 0.00384), 500)
    assert told is Outcome.UNDECIDED
    assert fine.outcome is Outcome.LEAVES


def other(terms: dict, load: float, second: tuple[int, int], factor: float = 1.0) -> LinearRope:
    """A rope, all its statements times a factor."""
    drive = lambda tau: np.cos(2 * tau) + 0.2 * np.cos(6 * tau + 0.5)  # noqa: E731
    still = lambda tau: np.zeros_like(tau)  # noqa: E731
    ends = [({(0, 0): 2.0 * factor}, 2.4 * factor, lambda tau: 2 * factor * drive(tau))]
    ends.append(({second: 3.0}, 0.0, still))
    scaled = {key: factor * c for key, c in terms.items()}
    return LinearRope(scaled, factor * load, ends, 3, 2.0, 1.2, (0.1, 0.0))


@pytest.mark.parametrize("factor", [1.0, -2.0])
def test_a_rope_is_restated(factor: float) -> None:
    terms = {(0, 2): 1.5, (0, 1): 0.3, (2, 0): -1.2, (4, 0): 0.01, (0, 0): 0.7}
    scale = abs(factor)
    problem = rope_problem(other(terms, -2.5, (1, 0), factor), 0.05)
    assert problem.driven_end is DrivenEnd.CLAMPED
    found = (problem.beta, problem.damping, problem.mass(0.0), problem.tension(0.0))
    assert np.array(found) / scale == pytest.approx([0.01, 0.15, 1.5, 1.2], rel=1e-14)
    assert problem.foundation(0.0) / scale == pytest.approx(0.7, rel=1e-14)
    assert problem.weight(0.0) / scale == pytest.approx(2.5, rel=1e-14)
    assert float(problem.ground(2.0)) == pytest.approx(0.2)
    tau = np.linspace(0, 5, 40)
    moved = np.cos(2 * tau) + 0.2 * np.cos(6 * tau + 0.5)
    assert problem.drive.height(tau) == pytest.approx(1.2 + 0.05 * moved, abs=1e-13)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({(1, 1): 0.2}, r"no term \[\(1, 1\)\]"),
        ({(2, 1): 0.2}, r"\(2, 1\)"),
        ({(0, 2): 1.5, (4, 0): 1.7}, "0 ≤ β ≤ 1"),
    ],
)
def test_what_the_simulator_has_not(change: dict, message: str) -> None:
    terms = {(0, 2): 1.5, (2, 0): -1.2, (4, 0): 0.01, **change}
    with pytest.raises(InputError, match=message):
        rope_problem(other(terms, -2.5, (1, 0)), 0.05)


def test_ends_and_runs_that_there_are_none_of() -> None:
    terms = {(0, 2): 1.5, (2, 0): -1.2, (4, 0): 0.01}
    with pytest.raises(InputError, match="drives W at the end"):
        rope_problem(other(terms, -2.5, (3, 0)), 0.05)
    state = periodic_state(rope(2.2), 0.01)
    for given in ({"periods": 7}, {"periods": 10, "push": math.nan}):
        with pytest.raises(InputError):
            departure(state, **given)


@pytest.mark.parametrize("begin", [1.0, 0.4])
def test_a_drive_of_several_harmonics(begin: float) -> None:
    drive, h = fourier(1.3, {0: 0.01, 1: 0.1, 2: 0.02 + 0.03j}, 1.1, begin, 2.0), 1e-4
    tau = np.linspace(0.01, 12, 50)
    for function, rate in ((drive.height, drive.slope), (drive.slope, drive.curvature)):
        assert rate is not None
        quotient = (function(tau + h) - function(tau - h)) / (2 * h)
        assert quotient == pytest.approx(rate(tau), abs=1e-7)
    first = float(drive.height(np.array(0.0)))
    assert first == pytest.approx(1.1 + begin * 0.13)
    for waves in ({1: math.nan}, {1: math.inf}):
        with pytest.raises(InputError, match="finite"):
            fourier(1.3, waves)


def test_waves_alone_are_a_departure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(from_state, "_FAR", math.inf)
    run = departure(periodic_state(rope(3.2), 0.9 * FOLD), 80, epsilon=1.2 * FOLD)
    assert run.shed
    assert run.left is not None


@pytest.mark.slow
def test_beats_are_no_departure() -> None:
    """Next to the tongue at Ω = 6.6 disturbances of the stable state rise and fall again."""
    state = periodic_state(rope(6.6), 0.00382, accuracy=1e-8)
    assert stability(state).verdict == "stable"
    told, run = outcome(state, 80)
    assert told is not Outcome.LEAVES
    assert run.change.max() > 4 * run.change[0]
