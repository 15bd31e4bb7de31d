"""The certified minimisation behind a first touch: its bounds are bounds, its maximum is global."""

from __future__ import annotations

import math

import numpy as np
import pytest

from asymptotics.errors import InputError
from asymptotics.resonances.first_touch import _Profile, graze

EPS = 2.0**-52

CASES = [
    {1: 1.0},
    {2: -1.0},
    {3: 0.7},
    {1: 1.0, 3: 1.0},
    {1: 0.3, 2: -1.0},
    {1: -0.2, 2: 0.5, 5: 1.0},
    {1: 1.0, 2: 0.8, 3: -0.6, 4: 0.4},
]


@pytest.mark.parametrize("harmonics", CASES, ids=str)
@pytest.mark.parametrize(("dx", "dy"), [(0.3, 1e-4), (1e-4, 0.5), (0.2, 0.2), (0.05, 0.02)])
def test_no_value_in_a_cell_exceeds_its_bound(harmonics, dx, dy):
    """Corners and inside; cells about extrema too, where the second order counts alone."""
    profile = _Profile(harmonics)
    dx, dy = dx / profile.k[-1], dy / profile.k[-1]
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, math.pi, 41), np.linspace(dy, 9, 120)))
    value, bound = profile.bound(x, y, dx, dy)
    np.testing.assert_array_equal(value, profile.value(x, y))
    rounding = 64 * EPS * np.abs(profile.weight).sum()
    for across in np.linspace(-1, 1, 5):
        for along in np.linspace(-1, 1, 5):
            inside = profile.value(x + across * dx, y + along * dy)
            assert (inside <= bound + rounding).all()


@pytest.mark.parametrize(
    ("cell", "centre"), [((1e-2, 1e-7), (math.pi, math.pi)), ((1e-7, 1e-2), (math.pi, 2.46))]
)
def test_the_second_order_is_no_more_than_twice_what_it_must_be(cell, centre):
    """R = 2 cos x ψ(y) where R_xx and R_yy are largest: bounds halved would be false."""
    profile = _Profile({1: 1.0})
    place = np.array([centre[0]]), np.array([centre[1]])
    value, bound = profile.bound(*place, *cell)
    along_x, along_y = (abs(float(g[0])) for g in profile.gradient(*place))
    first = along_x * cell[0] + along_y * cell[1]
    corners = [
        float(profile.value(place[0] + a * cell[0], place[1] + b * cell[1])[0])
        for a in (-1, 1)
        for b in (-1, 1)
    ]
    allowed, needed = float((bound - value)[0]) - first, max(corners) - float(value[0]) - first
    assert 0.5 * allowed < needed < allowed


@pytest.mark.parametrize("harmonics", CASES, ids=str)
def test_each_second_derivative_has_its_bound(harmonics):
    """Each by itself: their sum in a cell leaves room that hides a bound that is false."""
    profile, step = _Profile(harmonics), 1e-5
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, math.pi, 61), np.linspace(0, 12, 241)))
    along_x = [profile.gradient(x + sign * step, y) for sign in (1, -1)]
    along_y = [profile.gradient(x, y + sign * step) for sign in (1, -1)]
    xx, xy = ((above - below) / (2 * step) for above, below in zip(*along_x, strict=True))
    yy = (along_y[0][1] - along_y[1][1]) / (2 * step)
    slack = 1 + 1e-6
    assert np.abs(xx).max() <= profile.xx * slack
    assert np.abs(xy).max() <= profile.xy * slack
    assert np.abs(yy).max() <= profile.yy * slack
    if len(harmonics) == 1:  # R_xy = −2ak² sin kx ψ′(ky), and ψ′(0) = 1/6
        assert np.abs(xy).max() == pytest.approx(profile.xy, rel=1e-2)


@pytest.mark.parametrize("harmonics", CASES, ids=str)
@pytest.mark.parametrize("part", [0.9, 0.3, 0.05])
def test_beyond_the_reach_there_is_no_value_as_large(harmonics, part):
    profile = _Profile(harmonics)
    value = part / graze(harmonics).amplitude
    reach = profile.reach(value)
    x, y = np.meshgrid(np.linspace(0, math.pi, 33), np.linspace(reach, 4 * reach, 1500))
    assert profile.value(x.ravel(), y.ravel()).max() < value


def test_the_reach_is_that_of_the_slowest_decay():
    """R = 2ψ(y) → 2/y at x = 0: the reach must exceed 2/value, and by no more than a quarter."""
    for value in (0.4, 0.1, 0.01):
        assert 2 / value < _Profile({1: 1.0}).reach(value) <= 2.5 / value


@pytest.mark.parametrize("harmonics", CASES, ids=str)
def test_no_smaller_amplitude_touches(harmonics):
    touch, profile = graze(harmonics), _Profile(harmonics)
    assert 0 < touch.gap <= 2e-7
    x, y = np.meshgrid(np.linspace(0, math.pi, 201), np.linspace(1e-2, 30, 1501))
    largest = profile.value(x.ravel(), y.ravel()).max()
    assert touch.amplitude * (1 - touch.gap) * largest <= 1 + 64 * EPS
    assert touch.amplitude * largest > 1 - 1e-3
    # It is a touch: R = 1/g with no slope, at the place it names, and nowhere earlier.
    at = np.array([touch.x]), np.array([touch.y])
    assert float(profile.value(*at)[0]) * touch.amplitude == pytest.approx(1, abs=64 * EPS)
    for slope in profile.gradient(*at):
        assert abs(float(slope[0])) < 1e-9 * np.abs(profile.weight).sum()
    before = np.linspace(0, touch.x, 50, endpoint=False)
    heights = np.linspace(1e-2, 15, 800)
    grid = profile.value(np.repeat(before, 800), np.tile(heights, len(before)))
    assert len(before) == 0 or touch.x == 0 or grid.max() * touch.amplitude < 1 + 1e-9
    bump = np.linspace(0, touch.y, 20001)[1:]
    lifted = bump**2 * (1 - touch.amplitude * profile.value(np.full_like(bump, touch.x), bump))
    assert touch.height == pytest.approx(lifted.max(), rel=1e-6)
    assert touch.height >= lifted.max() * (1 - 1e-12)


def test_of_equal_maxima_the_earliest():
    """cos 2x has the same maximum at 0 and π, −cos 2x one at π/2, −cos x one at π."""
    assert graze({2: 1.0}).x == 0.0
    assert graze({2: -1.0}).x == pytest.approx(math.pi / 2, abs=1e-9)
    assert graze({1: -1.0}).x == pytest.approx(math.pi, abs=1e-15)


@pytest.mark.parametrize(
    ("harmonics", "said"),
    [
        ({}, "no harmonic"),
        ({1: 0.0}, "no harmonic"),
        ({0: 1.0}, "k ≥ 1"),
        ({1: math.nan}, "finite"),
    ],
)
def test_bad_harmonics(harmonics, said):
    with pytest.raises(InputError, match=said):
        graze(harmonics)
