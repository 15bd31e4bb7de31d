"""The exact string against itself, 40-digit arithmetic, the circle and the linear response."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from numerics.errors import InputError, SonicContactError
from numerics.exact_string import kernels
from numerics.exact_string.characteristics import exact_string_motion
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.exact_string.orbits import EPS, differentiate
from numerics.exact_string.thresholds import sonic_threshold, sonic_times, threshold_study
from numerics.problems.drive import Drive, at_rest, cosine, ramped_cosine, smooth_step

# The sheet's §4: thresholds for a ramp of 100 periods, hold not stated there.
SHEET = {2.7: 0.0234, 2.8: 0.0177, 2.9: 0.0084, 3.3: 0.0027, 6.0: 0.0026}


@pytest.fixture(scope="module")
def gentle():
    """Ω = 2.2, ε = 0.02 for 40 periods, the first 20 a ramp."""
    drive = ramped_cosine(2.2, 0.02, periods=20)
    return exact_string_motion(drive, until=40 * drive.period)


@pytest.fixture(scope="module")
def steep():
    """Ω = 2.2, ε = 0.1 until it folds."""
    return exact_string_motion(ramped_cosine(2.2, 0.1, periods=5), until=60.0)


def gaussian(depth: float, width: float, centre: float) -> Drive:
    def bump(t):
        return depth * np.exp(-(((t - centre) / width) ** 2))

    return Drive(
        lambda t: 1 - bump(t), lambda t: 2 * (t - centre) / width**2 * bump(t), f"dip {depth!r}"
    )


def test_the_drive_and_the_contact_conditions_hold_to_rounding(gentle):
    tau = np.linspace(0, gentle.until, 23)
    contact = gentle.contact(tau)
    assert np.ptp(contact) > 0.05  # it moves
    assert np.array_equal(gentle.shape(0.0, tau), gentle.drive.height(tau))
    # Sums of O(1) terms over 60 returns whose times are rounded at eps τ.
    bound = 8 * EPS * gentle.until
    assert np.abs(gentle.shape(contact, tau)).max() < bound
    assert np.abs(gentle.slope(contact, tau)).max() < bound
    assert (gentle.shape(0.9 * contact, tau) > 1e-3).all()
    assert (gentle.shape(contact + 0.1, tau) == 0).all()


def test_the_wave_equation_holds_as_the_parallelogram_identity(gentle):
    """V = W − ξ² is a sum of two waves: V at the corners of a characteristic parallelogram."""
    rng = np.random.default_rng(4)
    tau, xi = rng.uniform(2, 70, 30), rng.uniform(0.25, 0.6, 30)
    a, b = rng.uniform(0.02, 0.12, (2, 30))

    def wave(place, time):
        return gentle.shape(place, time) - place**2

    corners = wave(xi + a - b, tau + a + b), wave(xi + a, tau + a), wave(xi - b, tau + b)
    assert np.abs(corners[0] - wave(xi, tau)).max() > 0.01
    defect = corners[0] + wave(xi, tau) - corners[1] - corners[2]
    assert np.abs(defect).max() < 8 * EPS * gentle.until


@pytest.mark.slow
def test_velocity_and_slope_are_the_derivatives(gentle):
    tau, step = np.linspace(10, 80, 9), 1e-3
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # order 6: (ΩΔ)⁶ = 1e-16

    def derivative(function, at):
        pairs = ((w, function(at + m * step), function(at - m * step)) for m, w in weights)
        return sum(w * (right - left) for w, right, left in pairs) / step

    velocity = gentle.contact_velocity(tau)
    assert np.abs(velocity).max() > 0.03
    rounding = 8 * EPS * gentle.until / step
    assert np.abs(derivative(gentle.contact, tau) - velocity).max() < rounding
    place = np.full(tau.shape, 0.5)
    slope = gentle.slope(place, tau)
    assert np.abs(derivative(lambda x: gentle.shape(x, tau), place) - slope).max() < rounding
    assert (slope < 0).all()


def mp_contact(omega, epsilon, length, tau, label, returns):
    """ξ_c(τ) by the same map in 40 digits: secant iteration on the label."""
    omega, epsilon, length, tau = (mp.mpf(value) for value in (omega, epsilon, length, tau))

    def slope(t):
        if t <= 0:
            return mp.mpf(0)
        if t >= length:
            return -epsilon * omega * mp.sin(omega * t)
        x = t / length
        r = 1 / (1 + mp.exp(1 / x - 1 / (1 - x)))
        rate = r * (1 - r) * (1 / x**2 + 1 / (1 - x) ** 2) / length
        return epsilon * (rate * mp.cos(omega * t) - omega * r * mp.sin(omega * t))

    def run(start):
        before, now = start, start + 2
        for _ in range(returns):
            before, now = now, 2 * now - before + 2 * slope(now)
        return before, now

    start, other = mp.mpf(label), mp.mpf(label) + mp.mpf(10) ** -9
    excess = sum(run(start)) / 2 - tau
    for _ in range(6):
        next_excess = sum(run(other)) / 2 - tau
        if abs(next_excess) < mp.mpf(10) ** -30:
            break
        move = next_excess * (other - start) / (next_excess - excess)
        start, excess, other = other, next_excess, other - move
    before, now = run(other)
    return (now - before) / 2


@pytest.mark.parametrize("periods", [15.5, 40.2, 99.7])
def test_forty_digits_agree_within_the_error_estimate(periods):
    """The resolution study: 15 digits after 100 periods, and the estimate says which."""
    drive = ramped_cosine(2.2, 0.02, periods=20)
    motion = exact_string_motion(drive, until=periods * drive.period)
    tau = motion.until
    orbit = motion._at_contact(np.array(tau))
    returns = round((float(orbit.time) + 1) / 2)
    found = None
    with mp.workdps(40):
        for k in (returns - 1, returns, returns + 1):  # the label must lie in (−2, 0]
            guess = float(orbit.time) - 2 * k
            if -2.1 < guess < 0.1 and found is None:
                found = mp_contact(2.2, 0.02, 20 * drive.period, tau, guess, k)
        error = abs(float(mp.mpf(float(motion.contact(tau))) - found))
    estimate = float(motion.error_estimate(tau))
    assert abs(float(motion.contact(tau)) - 1) > 1e-4
    assert error <= estimate < 16 * EPS * tau


def test_a_long_ramp_leads_to_the_invariant_circle():
    """The ramp's transient falls faster than any power: the observed order itself increases."""
    omega, epsilon = 0.83, 0.02
    circle = invariant_circle(omega, epsilon)
    errors = []
    for ramp in (8, 16, 32):
        drive = ramped_cosine(omega, epsilon, ramp)
        tau = (ramp + 2 + np.linspace(0, 1, 5)) * drive.period
        motion = exact_string_motion(drive, until=float(tau[-1]))
        errors.append(float(np.abs(motion.contact(tau) - circle.contact(tau)).max()))
    early, late = np.log2(np.array(errors[:-1]) / errors[1:])
    assert 1e-9 > errors[-1] > 1e-12
    assert late > early + 0.5 > 2.5


def test_linear_response_with_an_error_of_second_order():
    """Eq. (linear), dimensionless: ξ₁(τ) − ξ₁(τ−2) = ΔZ′(τ−1)."""
    tau = np.linspace(4.0, 14.0, 17)
    errors = []
    for epsilon in (4e-3, 2e-3, 1e-3, 5e-4):
        motion = exact_string_motion(cosine(2.2, epsilon), until=14.0)
        rest = np.sqrt(1 + epsilon)
        jump = motion.contact(tau) - motion.contact(tau - 2 * rest)
        kick = motion.drive.slope(tau - rest)
        assert np.abs(kick).max() > epsilon
        errors.append(float(np.abs(jump - kick).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] > 1e-8
    assert (np.abs(orders - 2) < 0.05).all()


def test_at_rest_nothing_happens():
    motion = exact_string_motion(at_rest(2.25), until=30.0)
    xi, tau = np.linspace(0, 1.4, 5), 17.3
    assert motion.contact(tau) == 1.5
    assert np.abs(motion.shape(xi, tau) - (xi - 1.5) ** 2).max() <= 4 * EPS
    assert motion.least_stretch == 1
    assert motion.contact(-5.0) == 1.5
    assert motion.sonic is None


def test_sonic_contact_is_where_the_speed_reaches_one(steep):
    sonic = steep.sonic
    assert sonic is not None
    before, after = sonic.bracket
    assert 0 <= after - before <= 8 * EPS * sonic.time
    tau = sonic.time - np.array([1e-5, 1e-6, 1e-7])
    velocity = steep.contact_velocity(tau)
    # h′ passes 0 linearly: 1 + ξ_c′ ∝ τ* − τ.
    assert (np.abs(np.diff(np.log10(1 + velocity)) + 1) < 0.03).all()
    assert abs(steep.contact(sonic.time) - sonic.place) < 1e-9
    dense = np.linspace(0, sonic.time - 0.02, 200)
    assert np.abs(steep.contact_velocity(dense)).max() < 1
    with pytest.raises(SonicContactError, match="wave speed") as caught:
        steep.contact(sonic.time + 1e-6)
    assert caught.value.sonic is sonic


def test_finding_the_sonic_contact_uses_minima_not_the_grid():
    """Just above threshold D < 0 on a sliver no grid of 64 labels can see."""
    omega, ramp, hold = 2.9, 5, 5
    threshold = sonic_threshold(omega, ramp, hold, rtol=1e-8)
    drive = ramped_cosine(omega, threshold.upper, ramp)
    motion = exact_string_motion(drive, until=(ramp + hold) * drive.period)
    below = ramped_cosine(omega, threshold.lower * (1 - 1e-7), ramp)
    assert motion.sonic is not None
    calm = exact_string_motion(below, until=motion.until)
    assert calm.sonic is None
    assert 0 < calm.least_stretch < 1e-4


def test_compiled_and_plain_map_find_the_same_instant():
    for omega, epsilon, ramp, hold in ((2.2, 0.1, 5, 15), (2.9, 0.02, 10, 20), (6.0, 0.02, 8, 9)):
        drive = ramped_cosine(omega, epsilon, ramp)
        motion = exact_string_motion(drive, until=(ramp + hold) * drive.period)
        time = float(sonic_times(omega, epsilon, ramp, hold))
        assert motion.sonic is not None
        # Simple zero of D: rounding of t over the slope of D at it, of order one here.
        assert abs(time - motion.sonic.time) < 1e3 * EPS * time


def test_the_compiled_ramp_and_sine_are_the_drive_s():
    x = np.linspace(0.001, 0.999, 301)
    values = np.array([kernels.ramp(value) for value in x])
    rise, rate, bend = smooth_step(x)
    assert np.abs(values[:, 0] - rise).max() <= 4 * EPS
    assert np.abs(values[:, 1] - rate).max() <= 64 * EPS
    second = differentiate(lambda at: smooth_step(at)[1], 1.0)
    inner = (x > 0.05) & (x < 0.95)
    assert np.abs(bend[inner] - second(x[inner])).max() < 1e-9
    assert np.abs(values[:, 2] - bend).max() <= 1024 * EPS * np.abs(bend).max()
    assert np.abs(values[:, 2]).max() > 1
    times, state = np.linspace(0, 2000, 4001), np.zeros((4, 4001))
    kernels.advance_held(times, state, 1.7, 1.0)
    assert np.abs(state[1] + np.sin(1.7 * times)).max() <= 2 * EPS
    assert np.abs(state[3] / 1.7 + np.cos(1.7 * times)).max() <= 2 * EPS


def test_sonic_times_broadcasts_and_is_independent_of_labels():
    times = sonic_times(np.array([[2.2], [2.9]]), [0.001, 0.05, 0.1], 5, 15)
    assert times.shape == (2, 3)
    assert np.isnan(times[:, 0]).all()
    assert np.isnan(times[0, 1])
    assert np.isfinite(times[[0, 1, 1], [2, 1, 2]]).all()
    again = sonic_times(2.2, 0.1, 5, 15, labels=101)
    assert abs(float(again) - times[0, 2]) < 1e3 * EPS * times[0, 2]


@pytest.mark.parametrize("omega", [2.8, 2.9, 3.3, 6.0])
def test_the_sheet_s_thresholds_lie_between_holds_of_0_and_400_periods(omega):
    short = sonic_threshold(omega, 100, 0, rtol=1e-2)
    long = sonic_threshold(omega, 100, 400, rtol=1e-2)
    assert long.upper < short.lower  # longer holds fold at weaker drives
    assert long.upper < SHEET[omega] < short.upper * (1 + 0.03)


@pytest.mark.slow
def test_threshold_study_shows_labels_matter_least():
    rows = threshold_study(2.9, 20, 20, labels=256, rtol=1e-4)
    base, half_ramp, double_ramp, short, held, coarse, fine = (row.upper for row in rows)
    assert held <= base <= short
    assert abs(coarse - fine) <= 2e-4 * base
    assert abs(half_ramp - double_ramp) > 1e-2 * base


def test_a_violent_drive_ends_the_solution_before_it_is_sonic():
    """A deep narrow dip touches the ground in front of the contact point, ahead of the news."""
    dip = gaussian(depth=0.3, width=0.1, centre=0.8)
    motion = exact_string_motion(dip, until=5.0)
    sonic = motion.sonic
    assert sonic is not None
    tau = sonic.time - 1e-3
    xi = np.linspace(0, 0.9, 200)
    before_the_news = (xi - 1) ** 2 + dip.height(tau - xi) - 1
    assert before_the_news.min() < -0.01
    assert motion.valid_until == sonic.monotone_until < tau
    with pytest.raises(SonicContactError):
        motion.shape(0.5, tau)
    shape = motion.shape(xi, motion.valid_until - 1e-3)
    assert (np.diff(shape) < 0).all()


def test_a_given_curvature_and_the_differences_agree():
    drive = cosine(2.2, 0.01)
    exact = exact_string_motion(drive, until=15.0)
    plain = exact_string_motion(replace(drive, curvature=None), until=15.0)
    tau = np.linspace(0, 15, 31)
    gap = np.abs(exact.contact_velocity(tau) - plain.contact_velocity(tau)).max()
    assert gap < 64 * EPS
    assert np.abs(exact.contact(tau) - plain.contact(tau)).max() <= 16 * EPS


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: exact_string_motion(at_rest(), until=-1.0), "until"),
        (lambda: exact_string_motion(gaussian(1.2, 0.5, 4.0), until=9.0), "above the ground"),
        (lambda: exact_string_motion(gaussian(0.1, 0.5, 0.3), until=9.0), "ramp the drive"),
        (lambda: exact_string_motion(at_rest(), until=3.0).contact(4.0), "longer"),
        (lambda: exact_string_motion(at_rest(), until=3.0).contact(np.nan), "finite"),
        (lambda: exact_string_motion(at_rest(), until=3.0).shape(-0.1, 1.0), "driven end"),
        (lambda: sonic_times([2.0, 2.1], [0.1, 0.2, 0.3]), "broadcast"),
        (lambda: sonic_times(-2.0, 0.1), "Omega"),
        (lambda: sonic_times(2.0, 1.5), "epsilon"),
        (lambda: sonic_times(2.0, 0.1, labels=3), "labels"),
        (lambda: sonic_times(2.0, 0.1, ramp_periods=0), "ramp"),
        (lambda: sonic_threshold(2.0, rtol=2.0), "rtol"),
        (lambda: sonic_threshold(2.0, ramp_periods=0.1, hold_periods=0.0), "longer"),
    ],
)
def test_bad_input_gets_one_clear_error(call, words):
    with pytest.raises(InputError, match=words):
        call()
