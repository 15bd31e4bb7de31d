"""Periodic states and their multipliers: known values, pairs, the exact string, refinement."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.periodic.linear_rope import LinearRope, NoPeriodicStateError, Terms
from numerics.periodic.modes import Modes
from numerics.periodic.stability import multipliers, stability
from numerics.periodic.states import PeriodicState, periodic_state, solve
from tests.command import said

REST = {0.0: 1.0, 0.01: 1.1049840680200076}
STRING: Terms = {(0, 2): 1.0, (2, 0): -1.0}


def rope(omega: float, beta: float = 0.01, damping: float = 0.0) -> LinearRope:
    """The paper's rope."""
    held: tuple[Terms, float, Callable[[Any], Any]] = (
        {(0, 0): 1.0},
        1.0,
        lambda t: np.cos(omega * t),
    )
    still: tuple[Terms, float, Callable[[Any], Any]] = ({(2, 0): 1.0}, 0.0, lambda t: 0.0 * t)
    terms = {**STRING, (0, 1): 2 * damping}
    if not beta:
        return LinearRope(terms, -2.0, [held], 2, omega, 1.0)
    return LinearRope({**terms, (4, 0): beta}, -2.0, [held, still], 3, omega, REST[beta])


def test_the_matrix_is_that_of_the_equations() -> None:
    for stated in (rope(2.2), rope(2.2, 0.0), replace(rope(2.2, 0.0), contacts=1, springs=400.0)):
        modes = Modes(stated, 9)
        generator = np.random.default_rng(1)
        contact = stated.rest + 0.05 * np.cos(modes.phase) + 0.02 * np.sin(2 * modes.phase)
        unknown = modes.start(contact, 0.03)
        left, matrix, by_epsilon = modes.equations(unknown, 0.03)
        way, step = generator.standard_normal(unknown.size), 1e-5
        up, down = (modes.equations(unknown + d * step * way, 0.03)[0] for d in (1, -1))
        assert np.allclose((up - down) / (2 * step), matrix @ way, rtol=1e-6, atol=1e-6)
        up, down = (modes.equations(unknown, 0.03 + d)[0] for d in (1e-3, -1e-3))
        assert np.allclose((up - down) / 2e-3, by_epsilon, atol=1e-10)
        assert left.shape == unknown.shape


def test_the_string_has_the_circle_s_contact_point_and_multipliers() -> None:
    found, circle = periodic_state(rope(2.2, 0.0), 0.02), invariant_circle(2.2, 0.02)
    exact = circle.contact(found.modes.tau)
    assert abs(found.values - exact).max() <= found.error + 1e-12
    # f∘h = f: the multipliers are e^{2πik/ν}; the lowest of fourteen modes have them.
    known = np.exp(1j * 4 * np.pi**2 / circle.rotation_number * np.arange(-3, 4))
    values = multipliers(found, 14)
    assert all(abs(values - x).min() < 1e-4 for x in known if abs(x - 1) > 1e-12)
    assert stability(found).verdict == "neutral"


def test_an_even_drive_s_state_obeys_the_symmetry_of_half_a_period() -> None:
    """ε → −ε is half a period later."""
    one, other = (periodic_state(rope(2.2), size) for size in (0.03, -0.03))
    tau = np.linspace(0, 5, 40)
    assert one.even
    assert np.allclose(one.contact(tau + np.pi / 2.2), other.contact(tau), atol=1e-10)


def test_the_shape_obeys_the_contact_conditions_and_the_equation() -> None:
    state, h = periodic_state(rope(2.2), 0.03), 1e-3
    tau, xi = np.linspace(0.1, 2, 9), 0.4
    contact = state.contact(tau) - 1e-9
    for d in range(3):
        assert abs(state.shape(contact, tau, d)).max() < 1e-6
    acceleration = sum(
        c * state.shape(xi, tau + n * h)
        for n, c in ((-2, -1 / 12), (-1, 4 / 3), (0, -5 / 2), (1, 4 / 3), (2, -1 / 12))
    )
    force = state.shape(xi, tau, 2) - 2 - 0.01 * state.shape(xi, tau, 4)
    assert np.allclose(acceleration / h**2, force, atol=2e-6)


@pytest.mark.parametrize(
    ("omega", "epsilon", "angle"),
    [(3.2, 0.00100, 0.0786), (3.2, 0.00130, 0.0528), (3.2, 0.00138, 0.0278)],
)
def test_a_pair_meets_at_one_next_to_the_fold(omega: float, epsilon: float, angle: float) -> None:
    """e^{±iφ} → 1 at ε = 1.38788e-3; the state found is the one before the fold."""
    state = periodic_state(rope(omega), epsilon)
    found = stability(state)
    assert found.verdict == "stable"
    nearest = found.multipliers[np.argmin(abs(found.multipliers - 1))]
    assert abs(np.angle(nearest)) == pytest.approx(angle, abs=3e-4)


def test_beyond_the_fold_there_is_no_such_state() -> None:
    for epsilon in (0.0014, 0.0016, 0.002):
        with pytest.raises(NoPeriodicStateError, match="followed from rest it ends"):
            periodic_state(rope(3.2), epsilon)


def test_the_tongue_at_twice_the_first_frequency_has_its_multiplier() -> None:
    state = periodic_state(rope(6.5), 0.005)
    values = multipliers(state, 14)
    assert values[0] == pytest.approx(-1.05175, abs=1e-5)
    # Symplectic: with each multiplier its inverse.
    assert all(abs(values * x - 1).min() < 1e-8 for x in values)
    # Fourth order in the step.
    few, more, many = (multipliers(state, 8, steps)[0].real for steps in (60, 120, 240))
    assert abs(few - more) / abs(more - many) == pytest.approx(16, rel=0.5)
    found = stability(state)
    assert found.verdict == "unstable"
    assert found.growth == pytest.approx(0.0522, abs=2e-4)


def test_damping_shrinks_areas_at_its_rate() -> None:
    """The determinant of the map over a period is e^{−2ζnT}, and small damping is stability."""
    state = periodic_state(rope(2.2, damping=0.05), 0.02)
    assert not state.even
    values = multipliers(state, 10)
    period = 2 * np.pi / 2.2
    assert np.log(abs(np.prod(values))) == pytest.approx(-2 * 0.05 * 10 * period, rel=1e-9)
    assert stability(state).verdict == "stable"


def moving(stated: LinearRope, contact: Any, times: int = 41) -> PeriodicState:
    """A rope whose contact point is given; of a state the multipliers know nothing else."""
    modes = Modes(stated, times)
    unknown = np.concatenate([np.zeros(modes.unknowns - times), contact(modes.phase)])
    return PeriodicState(modes, 0.0, unknown, 0.0)


def lopsided(theta: Any) -> Any:
    return 1 + 0.05 * np.cos(theta) + 0.04 * np.sin(2 * theta + 0.3)


def test_damping_is_decay_and_a_negative_foundation() -> None:
    """v = e^{−ζτ} u turns v_ττ + 2ζ v_τ into u_ττ − ζ² u, wherever the end moves."""
    zeta, omega = 0.3, 2.2
    damped = multipliers(moving(rope(omega, damping=zeta), lopsided), 6)
    stated = rope(omega)
    light = replace(stated, terms={**stated.terms, (0, 0): -(zeta**2)})
    other = np.exp(-zeta * 2 * np.pi / omega) * multipliers(moving(light, lopsided), 6)
    assert all(abs(damped - x).min() < 1e-8 for x in other)


@pytest.mark.parametrize("V", [0.0, 0.3, -0.3])
def test_waves_in_a_travelling_string_have_the_multipliers_of_their_characteristics(
    V: float,
) -> None:
    """Speeds 1 + V out and 1 − V back: f∘h = f, hence λ = e^{2πik T/ϱ}, ϱ the mean step of h."""
    omega = 1.3
    stated = replace(rope(omega, 0.0), terms={(0, 2): 1.0, (1, 1): 2 * V, (2, 0): -(1 - V**2)})
    left, right = 0.0, 0.0
    count = 20_000
    for _ in range(count):
        # Leaves 0 at ``left``, meets the end at ``right``.
        for _ in range(60):
            before, right = right, left + lopsided(omega * right) / (1 + V)
            if abs(right - before) < 1e-13 * right:
                break
        left = right + lopsided(omega * right) / (1 - V)
    known = np.exp(2j * np.pi * 2 * np.pi / omega / (left / count) * np.arange(1, 3))
    values = multipliers(moving(stated, lopsided), 20)
    assert max(abs(values - x).min() for x in known) < 2e-3


def test_a_state_in_the_ground_is_told() -> None:
    state = periodic_state(rope(2.2, 0.0), 0.02)
    assert 0.5 < state.clearance() < 1
    lower = PeriodicState(state.modes, -3.0, state.modes.start(state.values, -3.0), 0.0)
    assert lower.clearance() < 0


def test_twice_the_period_holds_the_same_state() -> None:
    state = periodic_state(rope(2.2), 0.02)
    doubled = Modes(rope(2.2), 81, 2)
    found = solve(doubled, doubled.start(state.contact(doubled.tau), 0.02), 0.02)
    assert found is not None
    assert abs(found.waves[1::2]).max() < 1e-11
    assert np.allclose(found.waves[0:20:2], state.waves[:10], atol=1e-11)


def test_the_shape_moves_as_its_rate_says() -> None:
    state, xi, h = periodic_state(rope(4.7), 0.01), np.linspace(0, 1.0, 9), 1e-4
    for tau in (0.2, 0.9):
        up, down = (state.shape(xi, tau + d * h) for d in (1, -1))
        assert np.allclose((up - down) / (2 * h), state.shape(xi, tau, rate=1), atol=1e-6)
        assert abs(state.shape(xi, tau, rate=1)).max() > 1e-2


def test_the_amplitude_does_not_depend_on_the_times() -> None:
    """At Ω = 2.334 the samples of 17 and of 25 times differ by half a percent."""
    sizes = []
    for epsilon in (8e-4, 8.001e-4):
        state = periodic_state(rope(2.334), epsilon)
        tau = np.linspace(0, 2 * np.pi / 2.334, 4001)
        assert state.amplitude == pytest.approx(np.ptp(state.contact(tau)) / 2, rel=2e-5)
        sizes.append(state.amplitude / epsilon)
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-5)


def test_the_iteration_keeps_to_the_branch() -> None:
    """Next to Ω₂/2 it ends at 5.2688e-4; there is another state beyond, of twice the amplitude."""
    assert periodic_state(rope(3.59), 5.2e-4).amplitude == pytest.approx(0.01288, abs=2e-4)
    with pytest.raises(NoPeriodicStateError, match="it ends between"):
        periodic_state(rope(3.59), 5.4e-4)


def test_bad_input() -> None:
    with pytest.raises(InputError, match="finite"):
        periodic_state(rope(2.2), float("nan"))
    with pytest.raises(InputError, match="1 to 8"):
        periodic_state(rope(2.2), 0.01, 0)
    state = periodic_state(rope(2.2), 0.001)
    with pytest.raises(InputError, match="2 to 40"):
        multipliers(state, 1)


def test_the_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wanted = ["state", "--omega", "6.5", "--epsilon", ".005", "--beta", ".01", "--json"]
    code, out, _ = said(wanted, capsys)
    found = json.loads(out)
    assert code == 0
    assert (found["stable"], found["subharmonic"]) == ("unstable", 1)
    assert found["multipliers"][0][0] == pytest.approx(-1.05175, abs=1e-5)
    assert found["error"] < 1e-9
    code, _, err = said([*wanted[:4], "1", *wanted[5:]], capsys)
    assert code != 0
    assert "wave-less state" in err
    assert "Traceback" not in err
    plots = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for plot in plots:
        asked = ["state", "--omega", "2.2", "--epsilon", "0.02", "--plot", str(plot)]
        code, out, _ = said(asked, capsys)
        assert code == 0
        assert "neutral" in out
    assert plots[0].read_bytes() == plots[1].read_bytes()


@pytest.mark.slow
def test_the_command_of_twice_the_period_and_the_simulator(
    capsys: pytest.CaptureFixture[str],
) -> None:
    wanted = ["state", "--omega", "6.45", "--beta", ".01", "--subharmonic", "2", "--epsilon"]
    code, out, _ = said([*wanted, "0.002", "--simulate", "200", "--json"], capsys)
    found = json.loads(out)
    assert code == 0
    assert (found["subharmonic"], found["stable"]) == (2, "unstable")
    assert abs(found["contact_sine"][1]) == pytest.approx(0.0381992, abs=1e-6)
    told = found["simulated"]
    assert told["outcome"] == "leaves"
    growth = math.log(math.hypot(*found["multipliers"][0])) / (4 * math.pi / 6.45)
    assert 0.5 * growth < told["rate"] < growth  # grids damp
    code, out, _ = said([*wanted, "0.002", "--simulate", "8"], capsys)
    assert "needs some 205 periods to be seen" in out
    code, out, err = said(["state", *wanted[3:], "0.01", "--omega", "2.2"], capsys)
    assert code != 0
    assert "no period doubling" in err


def test_the_command_without_a_verdict_says_why(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "free.toml"
    file.write_text(
        'equation = "W_tautau = W_xixi - 2 - W_xixixixi/20"\n'
        'driven_end = ["W = 1 + epsilon*cos(Omega*tau)", "W_xixixi = 0"]\n'
        'contact = ["W", "W_xi", "W_xixi"]\n'
    )
    code, out, _ = said(
        ["state", "--problem", str(file), "--omega", "2", "--epsilon", ".01", "--json"], capsys
    )
    found = json.loads(out)
    assert (code, found["stable"]) == (0, "undecided")
    assert "do work" in found["reason"]


def test_the_clearance_of_a_state_to_few_digits() -> None:
    """Next to ξ_c, (1 − ξ/ξ_c)³ would magnify what the contact conditions lack."""
    fine = periodic_state(rope(2.2, 0.01), 0.05)
    coarse = periodic_state(rope(2.2, 0.01), 0.05, accuracy=1e-3)
    assert coarse.modes.times < fine.modes.times
    for places in (16, 60, 400):
        assert coarse.clearance(places) == pytest.approx(fine.clearance(60), abs=0.02)
