"""The bouncing bar and the striking string meet their own equations, by means they do not use."""

import math

import mpmath as mp
import numpy as np
import pytest

from numerics.exact_solutions.index import (
    StringImpact,
    bouncing_bar,
    point_plateau,
)

EPS = float(np.finfo(float).eps)


# --- the bouncing bar ---------------------------------------------------------------------------

BARS = [
    {},
    {"drop": 2.0},
    {"gravity": 3.7, "drop": 0.9, "length": 4.0, "young": 210.0, "density": 7.8},
    {"drop": 1.5},  # once it comes down within the piece in which it rose
    {"drop": 0.3},  # falls for less than one echo
    {"drop": 60.0},
]


def test_bar_has_the_contacts_and_the_period_of_the_sheet() -> None:
    bar = bouncing_bar(16.0)
    spans = [(1, 5 / 3), (11 / 3, 13 / 3)]
    expected = [(a + n * 16 / 3, b + n * 16 / 3) for n in range(3) for a, b in spans]
    np.testing.assert_allclose(bar.contacts, expected, rtol=1e-12)
    first, second = np.linspace(1.01, 1.66, 9), np.linspace(3.68, 4.32, 9)
    np.testing.assert_allclose(bar.pressure(first), 300 * first, rtol=1e-12)
    np.testing.assert_allclose(bar.pressure(second), 300 * (16 / 3 - second), rtol=1e-12)
    t = np.linspace(0.0, 16 / 3, 200)
    np.testing.assert_allclose(bar.bottom(t + 16 / 3), bar.bottom(t), atol=1e-11)


@pytest.mark.parametrize("data", BARS)
def test_bar_meets_ground_law_and_free_end(data: dict[str, float]) -> None:
    bar = bouncing_bar(12.0, **data)
    t = np.linspace(0, 12, 5001)
    b, p = bar.bottom(t), bar.pressure(t)
    assert np.all(b >= 0)
    assert np.all(p >= -1e-10)
    assert not np.any(b * p)
    assert np.any(p > 0)
    assert np.any(b > 0.01 * bar.drop)
    np.testing.assert_allclose(bar.displacement(0.0, t), b, atol=1e-10)
    stress = bar.young * bar.strain(0.0, t)
    np.testing.assert_allclose(-stress, p, atol=1e-9 * (1 + p.max()))
    assert not np.any(bar.strain(bar.length, t))
    # d'Alembert's identity with weight: exact over every diamond inside the bar.
    x, h = 0.4 * bar.length, 0.3 * bar.length
    dt, mid = h / bar.wave_speed, t[(t > 1) & (t < 11)]
    along = bar.displacement(x, mid + dt) + bar.displacement(x, mid - dt)
    across = bar.displacement(x + h, mid) + bar.displacement(x - h, mid)
    np.testing.assert_allclose(along, across - bar.gravity * dt * dt, atol=1e-10)


@pytest.mark.parametrize("data", BARS)
def test_bar_keeps_energy_and_momentum(data: dict[str, float]) -> None:
    bar = bouncing_bar(12.0, **data)
    cells = 20_000
    x = (np.arange(cells) + 0.5) * bar.length / cells
    start = bar.gravity * bar.drop
    times = np.linspace(0.1, 11.9, 11)
    fine = (np.arange(100_000) + 0.5) * 12.0 / 100_000
    impulse = np.cumsum(bar.pressure(fine)) * 12.0 / 100_000
    for t in times:
        v, strain = bar.velocity(x, t), bar.strain(x, t)
        density = 0.5 * v**2 + 0.5 * bar.wave_speed**2 * strain**2
        energy = np.mean(density + bar.gravity * bar.displacement(x, t))
        # Each jump in x, one for each piece of a′ within an echo, costs half a cell of its height.
        assert energy == pytest.approx(start, rel=4e-3)
        pressed = np.interp(t, fine + 6e-5, impulse) / (bar.density * bar.length)
        assert np.mean(v) == pytest.approx(pressed - bar.gravity * t, abs=4e-3 * math.sqrt(start))


def bar_by_leapfrog(cells: int, until: float, data: dict[str, float]) -> float:
    """Largest difference in height; nodes on the characteristics, penetration projected away."""
    bar = bouncing_bar(until, **data)
    dt = bar.length / cells / bar.wave_speed
    old = np.full(cells + 1, bar.drop)
    now = old - 0.5 * bar.gravity * dt**2
    heights = [old[0], now[0]]
    while len(heights) * dt <= until:
        padded = np.concatenate([now[1:2], now, now[-2:-1]])
        new = padded[2:] + padded[:-2] - old - bar.gravity * dt**2
        new[0] = max(new[0], 0.0)
        old, now = now, new
        heights.append(new[0])
    exact = bar.bottom(np.arange(len(heights)) * dt)
    assert exact.max() > 0 == exact.min()
    return float(np.abs(np.array(heights) - exact).max())


@pytest.mark.parametrize("data", BARS)
def test_bar_against_a_second_method(data: dict[str, float]) -> None:
    coarse, fine = (bar_by_leapfrog(cells, 5.0, data) for cells in (50, 800))
    # First order, 16 times less, but for where the impacts fall between the steps.
    assert fine < coarse / 6
    assert fine < 0.01 * bouncing_bar(1.0, **data).drop


# --- the string that strikes the ground ---------------------------------------------------------


def impact_by_leapfrog(impact: StringImpact, tau: float, nodes: int) -> float:
    """Largest difference to the closed form; Schatzman's rule W ≥ −r W_old, steps dτ = dξ."""
    h = impact.scale / nodes
    reach = int(4 * tau / h + 3 * nodes)
    zeta = np.arange(-reach, reach + 1) * h
    time = -0.1037 * impact.scale
    old, now = impact.free_fall(zeta, time), impact.free_fall(zeta, time + h)
    time += h
    while time + h <= tau:
        new = impact.free_fall(zeta, time + h)
        new[1:-1] = now[2:] + now[:-2] - old[1:-1] - 2 * h * h
        old, now, time = now, np.maximum(new, -impact.restitution * old), time + h
    inner = np.abs(zeta) < 2 * tau
    return float(np.abs(now - impact.height(zeta, time))[inner].max())


@pytest.mark.parametrize(
    ("curvature", "restitution", "until"),
    [(2, 0, 1.2), (1.5, 0, 1.0), (4, 0, 2.5), (20, 0, 1.5), (2, 1, 1.2), (20, 0.7, 1.5), (4, 1, 2)],
)
def test_impact_against_a_second_method(curvature: float, restitution: float, until: float) -> None:
    impact = StringImpact(0.3, curvature, restitution)
    height = impact.velocity * impact.scale
    coarse, fine = (impact_by_leapfrog(impact, until * impact.scale, n) for n in (60, 480))
    # First order: the instant of an impact is known to one step. (With r = 0 and a = 2 the string
    # comes to rest on the parabola that the scheme has exactly.)
    assert fine < max(coarse / 5, 1e-9 * height)
    assert fine < 6e-3 * height


@pytest.mark.parametrize("curvature", [1.2, 1.999999, 2.0, 2.000001, 5.0, 1e9])
def test_impulse_is_the_integral_over_the_front(curvature: float) -> None:
    impact = StringImpact(0.3, curvature, 0.25)
    with mp.workdps(30):
        a, v = mp.mpf(curvature), mp.mpf(impact.velocity)

        def struck(z: mp.mpf) -> mp.mpf:
            """When the free fall reaches the ground."""
            return 2 * (a * z * z / 2) / (v + mp.sqrt(v * v - (a - 2) * a * z * z))

        def density(z: mp.mpf) -> mp.mpf:
            speed = v - (a - 2) * struck(z)
            return (1 + mp.mpf(0.25)) * speed * (1 - (a * z / speed) ** 2)

        bracket = (0.9 * impact.sonic_half_width, 1.1 * impact.sonic_half_width)
        sonic = lambda z: v - (a - 2) * struck(z) - a * z  # noqa: E731
        end = mp.findroot(sonic, bracket, solver="anderson")
        assert abs(end / impact.sonic_half_width - 1) < 1e-13
        assert abs(struck(end) / impact.sonic_time - 1) < 1e-13
        total = 2 * mp.quad(density, [0, end])
    assert float(total) == pytest.approx(impact.impulse, rel=1e-13)
    if curvature == 2:
        assert impact.rebound_length == pytest.approx(4 / 3 * impact.scale, rel=8 * EPS)
    if curvature == 1e9:
        assert impact.rebound_length == pytest.approx(impact.scale, rel=1e-8)


@pytest.mark.parametrize("curvature", [1.5, 2.0, 6.0])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_struck_points_turn_round(curvature: float, restitution: float) -> None:
    impact = StringImpact(0.3, curvature, restitution)
    tau = impact.sonic_time * np.array([0.1, 0.5, 0.9])
    zeta, h = impact.half_width(tau), 1e-5 * impact.scale
    assert np.all(np.diff(zeta) > 0)
    np.testing.assert_allclose(impact.height(zeta, tau), 0, atol=16 * EPS * 0.3 * impact.scale)
    before = (impact.height(zeta, tau) - impact.height(zeta, tau - h)) / h
    after = (impact.height(zeta, tau + h) - impact.height(zeta, tau)) / h
    assert np.all(before < -0.2 * impact.velocity)
    np.testing.assert_allclose(after, -restitution * before, atol=1e-3 * impact.velocity)
    # Where nothing has heard of it, it falls freely.
    far = 3 * impact.scale
    assert impact.height(far, tau[1]) == impact.free_fall(far, tau[1])


@pytest.mark.parametrize(("curvature", "restitution"), [(2.0, 1.0), (20.0, 0.7), (4.0, 0.0)])
def test_impact_obeys_the_wave_equation_off_the_ground(
    curvature: float, restitution: float
) -> None:
    impact = StringImpact(0.3, curvature, restitution)
    size, h = impact.scale, 0.05 * impact.scale
    x, t = np.meshgrid(np.linspace(-3, 3, 61) * size, np.linspace(0.0, 2.5, 51) * size)
    struck = [np.abs(x) < impact.half_width(t + dt) + 2 * h for dt in (-h, 0, h)]
    free = ~np.any(struck, axis=0) & ((t > impact.sonic_time + 2 * h) | (np.abs(x) > size))
    along = impact.height(x, t + h) + impact.height(x, t - h)
    across = impact.height(x + h, t) + impact.height(x - h, t)
    scale = 0.3 * size
    assert free.sum() > 1000
    assert np.abs((along - across + 2 * h * h)[free]).max() < 256 * EPS * scale
    # Inside the struck region the ground pushes, so that the identity must fail there.
    assert np.abs((along - across + 2 * h * h)[~free]).max() > 1e-3 * scale


def test_sticking_string_is_lifted_by_what_it_would_have_sunk() -> None:
    impact = StringImpact(0.3, 5.0, 0.0)
    lift_off = impact.velocity / (impact.curvature - 2)
    assert impact.half_width(0.999 * lift_off) > 0 == impact.half_width(1.001 * lift_off)
    tau = lift_off * np.array([1.0, 1.5, 2.0])
    lifted = impact.height(0.0, tau) - impact.free_fall(0.0, tau)
    np.testing.assert_allclose(lifted, impact.depth, rtol=1e-12)
    assert impact.depth > impact.plateau > 0
    x, t = np.meshgrid(np.linspace(-2, 2, 201) * 0.3, np.linspace(0, 1, 101) * 0.3)
    assert impact.height(x, t).min() >= -16 * EPS
    # A string that comes down as it lay at rest comes to rest: (|ζ| − V/a)² outside the contact.
    rest = StringImpact(0.3, 2.0, 0.0)
    zeta = np.linspace(-0.5, 0.5, 101)
    expected = np.maximum(np.abs(zeta) - 0.15, 0) ** 2
    np.testing.assert_allclose(rest.height(zeta, 2.0), expected, atol=64 * EPS)
    assert rest.depth == math.inf


def test_plateau_grows_as_the_square_of_the_speed() -> None:
    slow, fast = (StringImpact(v, 3.0, 0.5) for v in (0.1, 0.2))
    assert fast.plateau == pytest.approx(4 * slow.plateau)
    assert slow.plateau == pytest.approx(point_plateau(0.1, 0.5, slow.rebound_length))
    # And it is what the field ends with: far behind both fronts.
    lifted = slow.height(0.0, 1.0) - slow.free_fall(0.0, 1.0)
    assert lifted == pytest.approx(slow.plateau, rel=1e-12)


def test_a_node_leaves_its_own_plateau() -> None:
    # One node of the grid is given (1 + r)V; at dτ = dξ its plateau shows on every second node.
    h, kick = 0.01, 1.5 * 0.2
    old, now = np.zeros(201), np.zeros(201)
    now[100] = kick * h
    for _ in range(40):
        new = np.zeros(201)
        new[1:-1] = now[2:] + now[:-2] - old[1:-1]
        old, now = now, new
    mean = 0.5 * (now + old)[70:131]
    np.testing.assert_allclose(mean, point_plateau(0.2, 0.5, h), rtol=1e-12)


def test_where_the_first_impact_no_longer_holds_the_field_says_so() -> None:
    impact = StringImpact(0.3, 1.5, 0.6)
    x, t = np.meshgrid(np.linspace(-2, 2, 201), np.linspace(0, 1, 51))
    assert impact.height(x * impact.scale, t * impact.scale).min() < -0.05 * 0.3 * impact.scale
