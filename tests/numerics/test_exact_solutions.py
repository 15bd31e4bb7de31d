"""The exact solutions meet their own equations, checked by means they do not use themselves."""

import math

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from numerics.errors import InputError
from numerics.exact_solutions import (
    StringImpact,
    bouncing_bar,
    plucked_string,
    point_plateau,
    static_contact_point,
    static_shape,
    travelling_pulse,
)
from numerics.problem import DrivenEnd

EPS = float(np.finfo(float).eps)
ENDS = list(DrivenEnd)
BETAS = [1e-8, 1e-3, 0.01, 0.1, 1.0, 1e4]


# --- the rope at rest ---------------------------------------------------------------------------


class StaticByLinearAlgebra:
    """W = ξ² + A + Bξ + C e^{−ξ/b} + D e^{(ξ−ξ₀)/b} from four of the five conditions, 60 digits."""

    def __init__(self, beta: float, end: DrivenEnd, height: float) -> None:
        self.b, self.end, self.z = mp.sqrt(mp.mpf(beta)), end, mp.mpf(height)
        guess = mp.mpf(static_contact_point(beta, end, height))
        self.start = mp.findroot(self.curvature, (guess * (1 - mp.mpf("1e-9")), guess), tol=1e-40)
        self.coefficients = self.solve(self.start)

    def row(self, x: mp.mpf, start: mp.mpf, order: int) -> list[mp.mpf]:
        first, second = mp.mpf(order == 0), (x, mp.mpf(1))[order] if order < 2 else mp.mpf(0)
        return [
            first,
            second,
            mp.exp(-x / self.b) * (-1 / self.b) ** order,
            mp.exp((x - start) / self.b) / self.b**order,
        ]

    def solve(self, start: mp.mpf) -> mp.matrix:
        bending = 2 if self.end is DrivenEnd.PINNED else 1
        rows = [(mp.mpf(0), 0), (mp.mpf(0), bending), (start, 0), (start, 1)]
        right = [self.z, -2 if bending == 2 else 0, -(start**2), -2 * start]
        return mp.lu_solve(mp.matrix([self.row(x, start, d) for x, d in rows]), mp.matrix(right))

    def curvature(self, start: mp.mpf) -> mp.mpf:
        """W_ξξ(ξ₀): the fifth condition."""
        row = self.row(start, start, 2)
        return 2 + mp.fdot(row, self.solve(start))

    def value(self, x: float, order: int) -> mp.mpf:
        x = mp.mpf(x)
        square = (x**2, 2 * x, mp.mpf(2))[order] if order < 3 else mp.mpf(0)
        return square + mp.fdot(self.row(x, self.start, order), self.coefficients)


@pytest.mark.parametrize(("height", "end"), [(1.0, ENDS[0]), (1.0, ENDS[1]), (0.3, ENDS[0])])
@pytest.mark.parametrize("beta", BETAS)
def test_rope_at_rest_meets_its_five_conditions(beta: float, end: DrivenEnd, height: float) -> None:
    # Cancellation among the four functions costs 1/ξ₀⁴ of the length: 60 digits leave enough.
    with mp.workdps(60):
        exact = StaticByLinearAlgebra(beta, end, height)
        start = static_contact_point(beta, end, height)
        assert abs(start / exact.start - 1) < 8 * EPS
        xi = start * np.array([0.0, 0.1, 0.5, 0.9, 0.99, 0.9999])
        for order in range(5):
            ours = static_shape(xi, beta, end, height, order)
            theirs = [exact.value(x, order) for x in xi]
            # Rounding of ξ₀ moves the shape by W_ξ δξ₀, and ξ₀ counts in layers of the width √β.
            scale = max(abs(v) for v in theirs)
            layers = 1 + start / math.sqrt(beta) if order else 8
            for a, b in zip(ours, theirs, strict=True):
                assert abs(a - b) < 16 * EPS * layers * scale


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("beta", BETAS)
def test_rope_at_rest_meets_the_ground_from_above(beta: float, end: DrivenEnd) -> None:
    start = static_contact_point(beta, end)
    xi = start * (1 - np.geomspace(1e-6, 1.0, 400))
    assert np.all(static_shape(xi, beta, end) > 0)
    # Cubic contact, W ~ d³, and nothing beyond.
    near = static_shape(start - 1e-4 * math.sqrt(beta) * np.array([1.0, 2.0]), beta, end)
    assert near[1] / near[0] == pytest.approx(8, rel=1e-3)
    assert not np.any(static_shape(start * np.array([1.0, 1.5, 9.0]), beta, end))
    residual = static_shape(xi, beta, end, order=2) - beta * static_shape(xi, beta, end, order=4)
    scale = 1 + np.abs(static_shape(xi, beta, end, order=2)).max()
    np.testing.assert_allclose(residual, 2.0, atol=64 * EPS * scale, rtol=0)


def test_string_at_rest_and_the_known_contact_points() -> None:
    xi = np.linspace(0, 2, 9)
    np.testing.assert_array_equal(static_shape(xi, 0.0), np.maximum(1 - xi, 0) ** 2)
    np.testing.assert_allclose(static_shape(xi, 0.0, height=0.49), np.maximum(0.7 - xi, 0) ** 2)
    assert static_shape(0.25, 0.0, order=1) == -1.5
    limits = [static_contact_point(1e12, end) / 1e3 for end in ENDS]
    np.testing.assert_allclose(limits, [12**0.25, 36**0.25], rtol=1e-6)
    assert static_contact_point(0.01, "clamped") > static_contact_point(0.01, "pinned") > 1


# --- the pulse ----------------------------------------------------------------------------------

PULSES = [(0.01, 1.5, 1), (1e-4, 1.05, 1), (0.3, 3.0, 1), (0.01, 1.5, 2), (0.01, 1.2, 3)]


@pytest.mark.parametrize(("beta", "speed", "humps"), PULSES)
def test_pulse_is_the_formula_of_the_sheet(beta: float, speed: float, humps: int) -> None:
    pulse = travelling_pulse(beta, speed, humps)
    with mp.workdps(40):
        guess = (humps + mp.mpf(1) / 2) * mp.pi
        root = mp.findroot(lambda w: mp.sin(w) - w * mp.cos(w), guess - 1 / guess)
        k = mp.mpf(speed) ** 2 - 1
        m = mp.sqrt(k / mp.mpf(beta))
        ell, amplitude = root / m, 2 / (k * mp.cos(root))
        assert abs(pulse.root - root) < 4 * EPS * root
        assert abs(pulse.half_length / ell - 1) < 16 * EPS

        def formula(z: mp.mpf) -> mp.mpf:
            return (ell**2 - z**2) / k + amplitude / m**2 * (mp.cos(root) - mp.cos(m * z))

        for share in (-0.98, -0.6, -0.2, 0.0, 0.3, 0.7, 0.97):
            for order in range(5):
                exact = mp.diff(formula, share * ell, order)
                ours = pulse.shape(share * float(ell), order)
                scale = 2 * (1 + root**2) * beta / k**2 * m**order
                assert abs(ours - exact) < 64 * EPS * root * scale


@pytest.mark.parametrize(("beta", "speed", "humps"), PULSES)
def test_pulse_meets_wave_equation_and_contact(beta: float, speed: float, humps: int) -> None:
    pulse = travelling_pulse(beta, speed, humps)
    ell, k = pulse.half_length, speed**2 - 1
    zeta = ell * np.linspace(-1, 1, 2001)[1:-1]
    w = [pulse.shape(zeta, d) for d in range(5)]
    scale = np.abs(w[2]).max() * (1 + speed**2)
    np.testing.assert_allclose(
        speed**2 * w[2] - w[2] + 2 + beta * w[4], 0, atol=256 * EPS * scale * pulse.root
    )
    assert np.all(w[0] > 0)
    # n humps: n maxima, seen as n changes of the slope from + to −.
    falls = (pulse.shape(zeta[:-1], 1) > 0) & (pulse.shape(zeta[1:], 1) <= 0)
    assert falls.sum() == humps
    assert pulse.height == pytest.approx(w[0].max(), rel=1e-4)
    assert pulse.height >= w[0].max() * (1 - 8 * EPS)
    # Next to both ends: W ~ d³, W′ ~ d², W″ ~ d, W‴ finite.
    for side in (-1, 1):
        d = 1e-6 * ell
        third = pulse.shape(side * (ell - d), 3)
        assert third == pytest.approx(-side * 2 * pulse.root / math.sqrt(beta * k), rel=1e-4)
        for order in range(3):
            expected = third * (-side * d) ** (3 - order) / math.factorial(3 - order)
            assert pulse.shape(side * (ell - d), order) == pytest.approx(expected, rel=1e-4)
        assert not pulse.shape(side * ell * np.array([1.0, 1.1])).any()


@pytest.mark.parametrize(("beta", "speed", "humps"), PULSES)
def test_pulse_force_and_energy(beta: float, speed: float, humps: int) -> None:
    pulse = travelling_pulse(beta, speed, humps)
    nodes, weights = leggauss(80)
    zeta, weights = nodes * pulse.half_length, weights * pulse.half_length
    w, slope, bend = (pulse.shape(zeta, d) for d in range(3))
    kinetic = 0.5 * weights @ pulse.velocity(zeta) ** 2
    potential = weights @ (0.5 * slope**2 + 0.5 * beta * bend**2 + 2 * w)
    assert kinetic == pytest.approx(pulse.kinetic_energy, rel=1e-12)
    assert potential == pytest.approx(pulse.potential_energy, rel=1e-12)
    assert pulse.energy == pytest.approx(kinetic + potential, rel=1e-12)
    # Two ends carry what flies; the force is β times the jump of W‴, from below.
    assert 2 * pulse.contact_force == pytest.approx(2 * 2 * pulse.half_length, rel=8 * EPS)
    jump = -pulse.shape(pulse.half_length * (1 - 1e-9), 3)
    assert beta * jump == pytest.approx(pulse.contact_force, rel=1e-6)
    # W_τ is what moving the shape gives.
    xi, h = 0.31 * pulse.half_length, 1e-4 * pulse.half_length / speed
    moved = (pulse.shape(xi - speed * h) - pulse.shape(xi + speed * h)) / (2 * h)
    assert moved == pytest.approx(pulse.velocity(xi), rel=1e-5)


def test_pulse_height_of_the_sheet() -> None:
    assert travelling_pulse(1.0, math.sqrt(2)).height == pytest.approx(31.3974062539, rel=1e-11)


# --- the plucked string -------------------------------------------------------------------------


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_plucked_string_vibrates_between_impacts(e: float) -> None:
    x, h = np.linspace(0.1, 0.9, 33), 0.05
    for t in (0.2, 0.7, 1.0, 1.3, 2.2):
        across = plucked_string(x + h, t, e) + plucked_string(x - h, t, e)
        along = plucked_string(x, t + h, e) + plucked_string(x, t - h, e)
        np.testing.assert_allclose(across, along, atol=16 * EPS)
        assert np.all(plucked_string(x, t, e) >= 0)


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("impact", [0, 1, 2])
def test_plucked_string_leaves_with_restitution(e: float, impact: int) -> None:
    x, h, t = np.linspace(0.1, 0.9, 9), 1e-5, impact + 0.5
    before = -plucked_string(x, t - h, e) / h
    after = plucked_string(x, t + h, e) / h
    np.testing.assert_allclose(after, -e * before, atol=1e-9)
    np.testing.assert_allclose(before, -(e**impact) * np.pi * np.sin(np.pi * x), atol=1e-8)
    assert plucked_string(0.5, 1.0, e) == pytest.approx(e)


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


# --- bad input ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "call",
    [
        lambda: static_contact_point(-0.1),
        lambda: static_contact_point(0.1, "free"),
        lambda: static_contact_point(0.1, "pinned", 0.0),
        lambda: static_shape(-1.0, 0.1),
        lambda: static_shape(math.nan, 0.1),
        lambda: static_shape(0.5, 0.1, order=-1),
        lambda: travelling_pulse(0.0, 1.5),
        lambda: travelling_pulse(0.1, 1.0),
        lambda: travelling_pulse(0.1, 1.5, 0),
        lambda: plucked_string(0.5, 1.0, 1.1),
        lambda: plucked_string(1.5, 1.0, 1.0),
        lambda: plucked_string(0.5, -1.0, 1.0),
        lambda: bouncing_bar(-1.0),
        lambda: bouncing_bar(1.0, drop=0.0),
        lambda: bouncing_bar(1.0).bottom(2.0),
        lambda: bouncing_bar(1.0).displacement(11.0, 0.5),
        lambda: StringImpact(0.3, 1.0),
        lambda: StringImpact(0.0, 3.0),
        lambda: StringImpact(0.3, 3.0, 2.0),
        lambda: point_plateau(0.3, 0.5, 0.0),
    ],
)
def test_bad_input_is_refused(call) -> None:
    with pytest.raises(InputError, match=r"give|choose|faster|lies at"):
        call()
