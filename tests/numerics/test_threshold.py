"""Thresholds: what brackets claim, when run again; what they depend on; how a loss is named."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from numerics.errors import InputError
from numerics.events.finder import Event, EventKind
from numerics.exact_string.thresholds import sonic_threshold, sonic_times
from numerics.problems.drive import at_rest
from numerics.problems.problem import RopeProblem
from numerics.problems.pulses import smallest_wave
from numerics.simulation.contact import Scheme
from numerics.thresholds.ramped_run import Outcome, Settings, base_settings, run_once
from numerics.thresholds.threshold import (
    Mechanism,
    ThresholdNotFoundError,
    bracket,
    mechanism,
    threshold,
    variations,
)

BETA = 0.01
COARSE = Settings(dx=0.025, height=1e-3, ramp=10, hold=5)


@pytest.fixture(scope="module")
def found():
    seen = []
    result = threshold(
        2.9, BETA, COARSE, relative=0.02, progress=lambda done, total: seen.append((done, total))
    )
    return result, seen


def test_a_bracket_holds_when_it_is_run_again(found):
    for run in found[0].runs:
        assert run_once(2.9, run.lower, BETA, run.settings) == run.stayed
        assert run_once(2.9, run.upper, BETA, run.settings) == run.lost
        assert run.stayed.stayed
        assert not run.lost.stayed
        assert run.lower < run.upper <= 1.02 * run.lower * (1 + 1e-12)


def test_the_interval_covers_every_setting(found):
    result, seen = found
    changes = list(variations(COARSE))
    assert [run.change for run in result.runs] == changes
    assert seen == [(k + 1, len(changes)) for k in range(len(changes))]
    assert result.lower == min(run.lower for run in result.runs)
    assert result.upper == max(run.upper for run in result.runs)
    # Settings matter here: a single bracket would be over-confident.
    assert result.upper / result.lower > 1.05
    assert {run.settings.scheme for run in result.runs} == set(Scheme)


def test_every_variation_changes_one_thing_that_matters():
    for base in (COARSE, replace(COARSE, scheme=Scheme.VERLET)):
        cases = variations(base)
        assert len(set(cases.values())) == len(cases) == 8
    fine = replace(COARSE, refine=2, scheme=Scheme.VERLET)
    problem = RopeProblem(BETA, at_rest())
    whole = replace(fine, refine=1).simulator(problem).dt
    assert math.isclose(fine.simulator(problem).dt, whole / 2)


def test_the_integrators_agree_on_a_fine_grid():
    base = replace(base_settings(BETA), ramp=10, hold=5)
    one = bracket(2.9, BETA, base)
    other = bracket(2.9, BETA, replace(base, scheme=Scheme.VERLET, dx=0.02, height=1e-4), near=0.03)
    # Two integrators on two grids: a few per cent, of which 1 % is the width of a bracket.
    assert abs(one.lower / other.lower - 1) < 0.1
    assert one.lower != other.lower


def test_a_slower_ramp_comes_closer_to_the_resonance():
    base = base_settings(BETA, 0.02)
    brackets = [bracket(2.9, BETA, replace(base, ramp=ramp)) for ramp in (5, 20, 80)]
    assert brackets[0].upper < brackets[1].lower
    assert brackets[1].upper < brackets[2].lower
    # The order of the first is that of the theory sheet's ramp: 0.0149, 0.0376, 0.0411.
    assert 0.01 < brackets[0].lower < brackets[2].upper < 0.05


def test_a_higher_wave_leaves_later():
    times = [
        run_once(2.9, 0.06, BETA, replace(COARSE, height=height)).periods
        for height in (1e-5, 1e-4, 1e-3, 1e-2)
    ]
    assert times == sorted(times)
    assert times[0] < times[-1]


def test_nothing_at_all_is_lifted_well_below_the_threshold():
    base = replace(base_settings(BETA), height=1e-300)
    assert run_once(2.5, 0.05, BETA, base).stayed
    assert not run_once(2.5, 0.15, BETA, base).stayed


def test_a_scan_from_further_below_finds_no_later_loss():
    # The loss is not monotone: a scan that begins lower may well find an earlier one.
    free = bracket(3.1, BETA, COARSE)
    below = bracket(3.1, BETA, COARSE, near=free.upper / 2)
    assert below.count > free.count
    assert below.upper < free.upper * 1.01


def test_base_heights_fit_on_the_grid():
    for beta in (0.1, 0.01, 1e-3, 1e-4):
        base = base_settings(beta)
        assert base.height == pytest.approx(1e-3 * beta)
        assert base.height > smallest_wave(beta, base.dx)
        coarse = base_settings(beta, math.sqrt(beta) / 5)
        assert coarse.height == smallest_wave(beta, coarse.dx) > base.height
    assert base_settings(0.0).height == pytest.approx(1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("omega", [2.7, 6.0])
def test_the_interval_of_a_string_is_that_of_the_exact_string(omega):
    """No ramp between those that were tried refutes it, and their brackets are those of
    ``sonic_threshold``; the grid with the same ramps gave [.0333, .0422] and [.0033, .0090]."""
    seen = []
    result = threshold(omega, 0.0, progress=lambda done, total: seen.append((done, total)))
    assert [run.change.value for run in result.runs] == [
        "base", "ramp × 2", "ramp × 4", "hold × 4", "labels × 2",
    ]  # fmt: skip
    assert [(run.settings.ramp, run.settings.hold, run.settings.labels) for run in result.runs] == [
        (20, 20, 256), (40, 20, 256), (80, 20, 256), (20, 80, 256), (20, 20, 512),
    ]  # fmt: skip
    assert seen == [(k + 1, 5) for k in range(5)]
    assert result.mechanism is Mechanism.SONIC_CONTACT
    assert result.upper < (0.03 if omega == 2.7 else 0.0028)
    for ramp, hold in ((20, 20), (40, 20), (60, 20), (80, 20), (20, 80), (40, 80), (80, 80)):
        found = sonic_threshold(omega, ramp, hold, rtol=1e-3)
        assert result.lower <= found.upper
        assert found.lower <= result.upper * 1.01
    for run in result.runs:
        s = run.settings
        tried = [run.lower, run.upper]
        times = sonic_times(omega, tried, s.ramp, s.hold, s.labels) * omega / (2 * math.pi)
        assert math.isnan(times[0])
        assert times[1] == run.periods <= s.ramp + s.hold


def test_the_string_s_ramp_and_hold_are_those_of_the_base():
    base = Settings(dx=0.02, height=4e-4, ramp=10, hold=5)
    (run,) = threshold(2.7, 0.0, base, quick=True).runs
    assert (run.settings.ramp, run.settings.hold) == (10, 5)
    assert run.upper / run.lower <= 1.0102


def outcome(growth=1.0, cut=0.0, speed=0.5, error=0.05):
    wave = Event(EventKind.SEPARATED_WAVE, 1, 2, 2, 1.2, 1e-3)
    fastest = Event(EventKind.SONIC_CONTACT, 1, 2, 1.5, 1.1, speed, error)
    return Outcome(0.1, wave, 20.0, growth, cut, fastest)


@pytest.mark.parametrize(
    ("lost", "name"),
    [
        (outcome(growth=1.2, cut=0.1, speed=1.3), Mechanism.RESONANT_GROWTH),
        (outcome(growth=math.nan, cut=0.1, speed=1.3), Mechanism.NEW_CONTACT),
        (outcome(cut=0.1), Mechanism.NEW_CONTACT),
        (outcome(cut=0.01, speed=1.3), Mechanism.SONIC_CONTACT),
        (outcome(cut=0.01, speed=-1.3), Mechanism.SONIC_CONTACT),
        (outcome(cut=0.01, speed=1.03), Mechanism.UNDECIDED),
        (replace(outcome(cut=0.01), speed=None), Mechanism.UNDECIDED),
    ],
)
def test_a_mechanism_is_read_off_the_evidence(lost, name):
    assert mechanism(lost, length=0.06) is name


def test_close_to_a_resonance_the_swing_grows_while_the_drive_is_steady():
    run = bracket(3.2, BETA, base_settings(BETA))
    assert run.lost.periods > 15
    assert run.lost.growth > 1.1
    assert run.mechanism is Mechanism.RESONANT_GROWTH


@pytest.mark.parametrize(
    "bad", [{"omega": 0}, {"relative": 0}, {"relative": 1e-17}, {"near": -1}, {"beta": -1}]
)
def test_bad_parameters(bad):
    with pytest.raises(InputError):
        threshold(**({"omega": 2.9, "beta": BETA, "base": COARSE, "quick": True} | bad))


@pytest.mark.parametrize(
    "bad",
    [
        {"dx": 0},
        {"height": math.nan},
        {"dt": -1},
        {"ramp": 0},
        {"hold": -1},
        {"sponge": -1},
        {"refine": 0},
        {"scheme": "euler"},
    ],
)
def test_bad_settings(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        replace(COARSE, **bad)


@pytest.mark.parametrize("near", [1e-6, 5.0])
def test_a_wild_guess_is_brought_into_the_range(near):
    run = bracket(2.9, BETA, COARSE, relative=0.05, near=near)
    assert 1e-3 < run.lower < run.upper < 0.9


def test_no_loss_at_any_amplitude_is_said():
    deaf = Settings(dx=0.025, height=10.0, ramp=2, hold=1)
    with pytest.raises(ThresholdNotFoundError, match="no wave left up to"):
        bracket(2.9, BETA, deaf, near=0.8)


def test_a_loss_at_every_amplitude_is_said(monkeypatch):
    monkeypatch.setattr("numerics.thresholds.threshold.LOWEST", 0.1)
    with pytest.raises(ThresholdNotFoundError, match="even at"):
        bracket(2.9, BETA, COARSE, near=0.3)
