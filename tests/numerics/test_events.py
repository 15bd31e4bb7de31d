"""Events: found by minima, the same however the rows are cut into blocks, right on exact waves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.events import finder as events
from numerics.events.finder import (
    EventFinder,
    EventKind,
    contact_speed,
    fastest_contact,
)
from numerics.events.study import Variant, first_event, study
from numerics.events.waves import lifted_waves, track_waves
from numerics.exact_solutions.index import travelling_pulse
from numerics.problems.drive import at_rest, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.problems.pulses import PULSE, ROOT, pulse_length, pulse_speed, smallest_wave
from numerics.simulation.contact import Block, Scheme, Simulator
from numerics.simulation.observables import COLUMNS, Column
from numerics.simulation.semi_discrete import Grid

DX = 0.01


def rows_of(times, **columns):
    rows = np.full((len(times), COLUMNS), np.nan)
    rows[:, Column.CONTACT], rows[:, Column.BUMP] = 1.1, 0.0
    for name, values in columns.items():
        rows[:, Column[name]] = values
    return Block(times, rows)


def shaken(omega=2.9, epsilon=0.06, dx=0.02, periods=12.0, beta=0.01):
    drive = ramped_cosine(omega, epsilon, periods=8)
    simulator = Simulator(RopeProblem(beta, drive), Grid(dx))
    times, rows = zip(*simulator.blocks(periods * drive.period), strict=True)
    return Block(np.concatenate(times), np.concatenate(rows)), simulator


def with_pulse(dx, speed=1.5, centre=3.5, scheme=Scheme.TRAPEZOIDAL):
    pulse = travelling_pulse(0.01, speed)
    simulator = Simulator(RopeProblem(0.01, at_rest()), Grid(dx, 10.0, 2.0), scheme=scheme)
    place = simulator.system.positions - centre
    lag = simulator.dt / 2 if scheme is Scheme.VERLET else 0.0
    simulator.state.height[:] += pulse.shape(place)
    simulator.state.velocity[:] += pulse.velocity(place + speed * lag)
    simulator.state.active[simulator.state.height > 0] = False
    return pulse, simulator


def test_a_near_miss_between_two_steps_is_found_with_its_height():
    times = DX * np.arange(1.0, 60)
    lowest, when = 3e-7, 0.3037
    gap = lowest + 0.8 * (times - when) ** 2
    finder = EventFinder(DX, DX, height=1e-3)
    events = finder.feed(rows_of(times, GAP=gap, GAP_AT=0.9))
    [miss] = [event for event in events if event.kind is EventKind.NEAR_MISS]
    # The parabola is exact: only the cancellation in gap − gap, eps × gap/curvature, is left.
    assert miss.time == pytest.approx(when, abs=1e-9)
    assert miss.value == pytest.approx(lowest, abs=1e-15)
    assert miss.before < when < miss.after < miss.before + 2.01 * DX
    assert miss.value < gap.min()


def test_a_minimum_that_moves_to_another_place_is_no_near_miss():
    times = DX * np.arange(1.0, 4)
    jumping = rows_of(times, GAP=[0.2, 0.1, 0.3], GAP_AT=[0.9, 0.5, 0.9])
    assert EventFinder(DX, DX, 1e-3).feed(jumping) == []


@pytest.mark.parametrize("older", [False, True])
def test_a_new_contact_is_bracketed_by_its_step(older):
    times = DX * np.arange(1.0, 5)
    contact = [1.2, 1.2, 0.9, 0.9]
    bump = [2e-3] * 4 if older else [0.0, 0.0, 1e-3, 1e-3]
    top = [3.0] * 4 if older else [np.nan, np.nan, 1.05, 1.05]
    gap, low = [2e-4, 1e-4, np.nan, np.nan], [0.9, 0.9, np.nan, np.nan]
    block = rows_of(times, CONTACT=contact, BUMP=bump, BUMP_AT=top, GAP=gap, GAP_AT=low)
    events = EventFinder(DX, DX, height=1e-2).feed(block)
    [event] = [event for event in events if event.kind is EventKind.NEW_CONTACT]
    assert (event.before, event.after) == (times[1], times[2])
    assert event.place == 0.9
    assert event.error == 1e-4


def test_a_contact_point_that_only_moves_is_no_new_contact():
    times = DX * np.arange(1.0, 40)
    block = rows_of(times, CONTACT=1.1 - 0.9 * times)
    assert EventFinder(DX, DX, height=1e-3).feed(block) == []


def test_the_contact_speed_is_of_second_order_in_its_span():
    times = 1e-3 * np.arange(4000.0)
    contact = 1 + 0.4 * np.sin(3 * times)
    errors = []
    for span in (0.4, 0.2, 0.1):
        finder = EventFinder(1e-3, 1e-3, 1e-3, span)
        events = finder.feed(rows_of(times, CONTACT=contact)) + finder.finish()
        # |1.2 cos 3τ| has maxima at 0, π/3, 2π/3, π, …, of which the first is cut off.
        whole = [event for event in events if event.time > 0.5]
        assert [event.kind for event in whole] == [EventKind.SONIC_CONTACT] * 3
        assert whole[0].value < -1 < 1 < whole[1].value
        assert whole[0].time == pytest.approx(math.pi / 3, abs=2e-3)
        errors.append(abs(whole[0].value + 1.2))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 1.9) & (orders < 2.1))


def test_a_contact_point_slower_than_waves_is_not_sonic_but_its_speed_is_known():
    times = 1e-3 * np.arange(3000.0)
    finder = EventFinder(1e-3, 1e-3, 1e-3)
    block = rows_of(times, CONTACT=1 + 0.3 * np.sin(3 * times))
    assert finder.feed(block) + finder.finish() == []
    assert finder.fastest is not None
    assert abs(finder.fastest.value) == pytest.approx(0.9, rel=1e-3)
    assert fastest_contact(block, 1e-3, 1e-3) == finder.fastest


def test_a_jump_of_the_contact_point_is_no_speed():
    times = DX * np.arange(1.0, 200)
    late = times > 1
    block = rows_of(times, CONTACT=np.where(late, 0.8, 1.2), BUMP=np.where(late, 1e-4, 0))
    block.rows[:, Column.BUMP_AT] = np.where(late, 1.0, np.nan)
    finder = EventFinder(DX, DX, height=1e-2)
    kinds = {event.kind for event in finder.feed(block) + finder.finish()}
    assert kinds == {EventKind.NEW_CONTACT}


@pytest.mark.parametrize("cut", [3, 100])
def test_events_do_not_depend_on_the_blocks(cut):
    block, simulator = shaken(epsilon=0.1)
    # No near miss in this run; so that there are some:
    block.rows[:, Column.GAP] = 0.1 + 0.05 * np.sin(3 * block.times)
    block.rows[:, Column.GAP_AT] = 0.5
    whole = EventFinder(0.02, simulator.dt, height=1e-3)
    expected = whole.feed(block) + whole.finish()
    parts, found = EventFinder(0.02, simulator.dt, height=1e-3), []
    for k in range(0, len(block.times), cut):
        found += parts.feed(Block(block.times[k : k + cut], block.rows[k : k + cut]))
    found += parts.finish()

    assert sorted(map(repr, found)) == sorted(map(repr, expected))
    assert {event.kind for event in expected} == set(EventKind)
    assert parts.fastest == whole.fastest


def test_the_finder_remembers_a_few_rows_only():
    block, simulator = shaken()
    finder = EventFinder(0.02, simulator.dt, height=1e-3)
    finder.feed(block)
    assert len(block.times) > 1000
    assert len(finder._rows) == finder.window + 1


def test_each_wave_is_preceded_by_the_contact_that_cuts_it_off():
    block, simulator = shaken(epsilon=0.1)
    events = EventFinder(0.02, simulator.dt, height=1e-3).feed(block)
    waves = [event for event in events if event.kind is EventKind.SEPARATED_WAVE]
    cuts = [event.after for event in events if event.kind is EventKind.NEW_CONTACT]
    assert len(waves) > 3
    for wave in waves:
        assert any(wave.after - 0.5 < cut <= wave.after for cut in cuts)
        assert wave.value >= 1e-3


def test_the_pulse_relations():
    for speed in (1.2, 2.0, 4.0):
        pulse = travelling_pulse(0.01, speed)
        assert math.isclose(PULSE * 0.01 / (speed**2 - 1) ** 2, pulse.height, rel_tol=1e-13)
        assert math.isclose(pulse_speed(0.01, pulse.height), speed, rel_tol=1e-13)
        assert math.isclose(pulse_length(0.01, pulse.height, DX), 2 * pulse.half_length)
    assert math.isclose(math.tan(ROOT), ROOT, rel_tol=1e-13)
    assert pulse_speed(0.0, 0.1) == 1
    height = smallest_wave(0.01, DX)
    assert math.isclose(pulse_length(0.01, height, DX), 6 * DX)


def test_a_wave_is_measured_to_second_order():
    errors = []
    for dx in (0.02, 0.01, 0.005):
        pulse, simulator = with_pulse(dx)
        [wave] = lifted_waves(simulator.system, simulator.state, 0.0, 1e-2)
        assert abs(wave.length - 2 * pulse.half_length) < 2 * dx
        assert abs(wave.crest - 3.5) < dx * dx
        errors.append(
            [
                abs(wave.energy / pulse.energy - 1),
                abs(wave.kinetic / pulse.kinetic_energy - 1),
            ]
        )
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(orders > 1.8)
    assert min(errors[-1]) > 0


@pytest.mark.parametrize("scheme", list(Scheme))
def test_the_exact_pulse_is_followed_at_its_speed(scheme):
    errors = []
    for dx in (0.02, 0.01):
        pulse, simulator = with_pulse(dx, scheme=scheme)
        [track] = track_waves(simulator, 1.5, 0.1, height=1e-2)
        assert abs(track.height / pulse.height - 1) < 0.05
        assert track.breathing < 0.1
        errors.append(abs(track.speed - pulse.speed))
    assert errors[1] < 0.01
    assert errors[1] < errors[0] / 2


def test_two_waves_are_not_mixed_up():
    _, simulator = with_pulse(0.02, 1.5, centre=4.0)
    slow = travelling_pulse(0.01, 1.3)
    place = simulator.system.positions - 2.5
    simulator.state.height[:] += slow.shape(place)
    simulator.state.velocity[:] += slow.velocity(place)
    simulator.state.active[simulator.state.height > 0] = False
    tracks = track_waves(simulator, 1.5, 0.05, height=1e-2)
    speeds = sorted(track.speed for track in tracks if len(track.waves) > 20)
    assert speeds == pytest.approx([1.3, 1.5], abs=0.03)


def test_a_study_tells_what_an_event_depends_on():
    drive = ramped_cosine(2.9, 0.1, periods=8)
    problem, until = RopeProblem(0.01, drive), 10 * drive.period
    found = study(problem, until, EventKind.SEPARATED_WAVE, Grid(dx=0.02), height=1e-3)
    assert set(found.events) == set(Variant)
    base = found.events[Variant.BASE]
    assert base is not None
    assert base.value >= 1e-3
    # Waves leave in certain phases of a period: another grid may lose it one period later.
    assert 0 < found.spread() < 2 * drive.period
    higher = found.events[Variant.HEIGHT]
    assert higher is not None
    assert higher.after > base.after
    none = study(problem, 1.0, EventKind.SEPARATED_WAVE, Grid(dx=0.02))
    assert none.spread() == math.inf


def test_the_first_event_needs_time():
    _, simulator = shaken(periods=1.0)
    with pytest.raises(InputError, match="later time"):
        first_event(simulator, 0.1, EventKind.NEW_CONTACT, 1e-3)


def test_a_study_refuses_before_it_runs():
    drive = ramped_cosine(2.9, 0.1, periods=8)
    with pytest.raises(InputError, match="choose one of new contact"):
        study(RopeProblem(0.01, drive), 1.0, "a wave", Grid(dx=0.02))
    with pytest.raises(InputError, match="restitution"):
        study(RopeProblem(0.01, drive, restitution=0.5), 1e6, EventKind.NEW_CONTACT, Grid(dx=0.02))


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: pulse_length(0.01, -1.0, DX),
        lambda: pulse_speed(-1.0, 0.1),
        lambda: fastest_contact(rows_of(DX * np.arange(30.0)), DX, DX, math.nan),
        lambda: track_waves(with_pulse(0.02)[1], -1.0, 0.1, 1e-2),
        lambda: track_waves(with_pulse(0.02)[1], 1.0, math.inf, 1e-2),
    ],
)
def test_bad_measures(wrong):
    with pytest.raises(InputError):
        wrong()


@pytest.mark.parametrize("bad", [{"dx": 0}, {"dt": -1}, {"height": 0}, {"span": 0}])
def test_bad_parameters(bad):
    with pytest.raises(InputError):
        EventFinder(**({"dx": DX, "dt": DX, "height": 1e-3} | bad))


def test_a_step_that_resolves_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="would take 30000 steps, more than 8192"):
        EventFinder(0.025, 1e-5, height=1e-3)


def test_lines_are_the_same_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    contact = 1 + 0.1 * np.random.default_rng(3).random(60)
    whole = contact_speed(contact, np.zeros(60), 0.1, 0.1, 7)
    monkeypatch.setattr(events, "_PART", 20)
    for one, other in zip(whole, contact_speed(contact, np.zeros(60), 0.1, 0.1, 7), strict=True):
        assert np.array_equal(one, other)
