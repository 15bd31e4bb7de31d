"""After the loss: the exact impact of a string, heights against ε, waves against the pulse."""

from __future__ import annotations

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.events.waves import WaveTrack, track_waves
from numerics.exact_solutions.impact import StringImpact, point_plateau
from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.problems.pulses import pulse_speed
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.semi_discrete import Grid
from numerics.thresholds.grazing import fit_power, strike, wave_heights
from numerics.thresholds.ramped_run import Settings

SPACINGS = (0.01, 0.005, 0.0025, 0.00125)


def errors(impact, until, scheme, courant=0.9, spacings=SPACINGS):
    """Mean error of W and relative error of the kick ∫(W − free fall)dζ, per spacing."""
    found = []
    for dx in spacings:
        zeta, height, tau = strike(impact, until, dx, scheme, courant)
        exact = impact.height(zeta, tau)
        # Up to rounding of terms of the size of one.
        assert exact.min() > -1e-15, "the exact field of one impact has ended"
        lift = exact - impact.free_fall(zeta, tau)
        found.append((np.abs(height - exact).mean(), (height - exact).sum() / lift.sum()))
    return np.array(found).T


def _until(impact):
    """Past the sonic time, but before its weight brings the string down again."""
    return {2.0: 0.1, 4.0: 0.06}[impact.curvature] if impact.restitution == 0.5 else 0.12


@pytest.mark.parametrize("curvature", [2.0, 4.0])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_the_explicit_scheme_rebounds_as_the_exact_string(curvature, restitution):
    impact = StringImpact(0.3, curvature, restitution)
    mean, kick = errors(impact, _until(impact), Scheme.VERLET)
    # First order: fronts are sharp. Over a factor of eight, not between neighbours.
    assert np.log(mean[0] / mean[-1]) / np.log(8) > 0.7
    assert abs(kick[-1]) < 0.01


@pytest.mark.parametrize("curvature", [2.0, 4.0])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_the_implicit_scheme_rebounds_as_the_exact_string(curvature, restitution):
    impact = StringImpact(0.3, curvature, restitution)
    mean, kick = errors(impact, _until(impact), Scheme.TRAPEZOIDAL, courant=1.0)
    # The front meets the nodes in phases that change with dx: the order is 0.66 to 1.14.
    assert np.log(mean[0] / mean[-1]) / np.log(8) > 0.5
    assert abs(kick[-1]) < 0.01


def test_at_restitution_one_the_implicit_scheme_needs_short_steps():
    # With dt = dx some 4 % of the kick are lost however fine the grid; shorter steps restore it.
    impact = StringImpact(0.3, 2.0, 1.0)
    deficits = [
        -errors(impact, 0.12, Scheme.TRAPEZOIDAL, courant, SPACINGS[-1:])[1][0]
        for courant in (1.0, 0.5, 0.25)
    ]
    assert 0.02 < deficits[0] < 0.06
    assert deficits[2] < deficits[1] / 1.5 < deficits[0] / 3


def test_the_plateau_is_that_of_a_length_not_of_a_node_nor_of_x0():
    impact = StringImpact(0.3, 2.0, 1.0)
    plateaus, middle = [], 0.02
    for dx in (0.005, 0.00125):
        zeta, height, tau = strike(impact, 0.12, dx)
        lift = height - impact.free_fall(zeta, tau)
        near = np.abs(zeta) < middle
        plateaus.append(lift[near].mean())
        exact = (impact.height(zeta, tau) - impact.free_fall(zeta, tau))[near].mean()
        assert plateaus[-1] == pytest.approx(exact, rel=0.02)
    # The paper's w* with the missing length set to x₀, and to one node of the grid.
    assert plateaus[1] < 0.25 * point_plateau(0.3, 1.0, 1.0)
    assert plateaus[1] > 50 * point_plateau(0.3, 1.0, 0.00125)


def test_the_fit_recovers_a_power_and_an_offset():
    excess = np.geomspace(0.002, 0.05, 12)
    for power in (0.5, 1.0, 2.0):
        height = 0.0004 + 0.3 * excess**power
        fit = fit_power(0.1 + excess, height, 0.0999, 0.1001)
        assert fit.exponent == pytest.approx(power, abs=1e-4)
        assert fit.offset == pytest.approx(0.0004, rel=1e-3)
        assert power - 0.1 < fit.low <= fit.high < power + 0.1
        assert fit.error < 1e-3
    bare = fit_power(0.1 + excess, 0.3 * excess, 0.1, 0.1, offset=False)
    assert bare.exponent == pytest.approx(1, abs=1e-8)
    assert bare.offset == 0


def test_a_fit_without_data_is_refused():
    with pytest.raises(InputError, match="five or more"):
        fit_power(np.full(4, 0.2), np.ones(4), 0.1, 0.1)
    with pytest.raises(InputError, match="five or more"):
        fit_power(np.linspace(0.05, 0.2, 9), np.ones(9), 0.1, 0.11)


def test_a_fit_to_no_interval_or_unequal_columns_is_refused():
    epsilon = np.linspace(0.12, 0.2, 9)
    with pytest.raises(InputError, match="as many heights"):
        fit_power(epsilon, np.ones(8), 0.1, 0.1)
    with pytest.raises(InputError, match="ends of an interval"):
        fit_power(epsilon, np.ones(9), np.nan, 0.1)


def test_heights_start_at_the_threshold_and_rise():
    settings = Settings(dx=0.02, height=1e-4, ramp=40, hold=20)
    curve = wave_heights(2.9, 0.01, [0.03, 0.045, 0.05, 0.06], settings)
    assert curve.mean[0] == curve.first[0] == 0
    assert np.all(np.diff(curve.mean) > 0)
    assert np.all(curve.scatter[1:] < curve.mean[1:])
    with pytest.raises(InputError, match="hold"):
        wave_heights(2.9, 0.01, [0.03], Settings(dx=0.02, height=1e-4, hold=1))
    with pytest.raises(InputError, match="empty"):
        wave_heights(2.9, 0.01, [], settings)


def test_waves_that_left_run_at_the_speed_of_their_pulse():
    drive = ramped_cosine(2.9, 0.1, periods=10)
    simulator = Simulator(RopeProblem(0.01, drive), Grid(0.01, 10.0, 3.0))
    seen = 0
    for track in track_waves(simulator, 16 * drive.period, 0.05, height=5e-3):
        waves = tuple(wave for wave in track.waves if wave.left > 2 and wave.right < 7)
        if len(waves) < 20:
            continue
        free = WaveTrack(waves)
        seen += 1
        # They breathe about the pulse, by half their height; the string's waves have speed 1.
        assert free.speed == pytest.approx(pulse_speed(0.01, free.height), rel=0.03)
        assert free.speed > 1.9
        assert free.speed_error < 0.01
    assert seen >= 3


def test_an_impact_that_would_feel_the_ends_is_refused():
    with pytest.raises(InputError, match="unfelt"):
        strike(StringImpact(0.3, 2.0), 1.5, 0.01)
