"""The invariant circle is the string's periodic state: map, mean height, wave equation, errors."""

import itertools
import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from numerics.errors import CircleNotFoundError, InputError, NumericsError
from numerics.exact_string.invariant_circle import (
    EPS,
    CircleStatus,
    InvariantCircle,
    invariant_circle,
)

CASES = [(0.83, 0.02), (0.83, 0.3), (2.2, 0.05), (2.7, 0.02), (4.0, 0.02), (0.83, -0.1)]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"Omega={case[0]},eps={case[1]}")
def state(request: pytest.FixtureRequest) -> InvariantCircle:
    return invariant_circle(*request.param)


def times(state: InvariantCircle, count: int = 97) -> np.ndarray:
    """Times over several periods, none of them a node of anything."""
    return np.linspace(-1.0, 3.0, count) * 2 * math.pi / state.omega


def phase(state: InvariantCircle, psi: np.ndarray) -> np.ndarray:
    """φ = ψ + U(ψ), summed term by term."""
    return psi + sum(b * np.sin(k * psi) for k, b in enumerate(state.sines, start=1))


def test_converged(state):
    assert state.status is CircleStatus.CONVERGED
    assert min(state.residuals) <= 64 * EPS
    assert state.graph_margin > 0


def test_newton_is_quadratic():
    """Each residual is at most a constant times the square of the one before, until rounding."""
    residuals = invariant_circle(0.83, 0.02).residuals
    falls = [(a, b) for a, b in itertools.pairwise(residuals) if b > 1e-13]
    assert falls
    assert all(b <= a**2 for a, b in falls)


def test_orbit_of_the_standard_map(state):
    """Iterating the map from a point of the circle stays on it, at ψ + kϱ."""
    K = 2 * state.epsilon * state.omega**2
    psi = 0.4
    before, now = phase(state, np.array([psi - state.rotation_number, psi]))
    for k in range(1, 31):
        before, now = now, 2 * now - before - K * math.sin(now)
        # One unit of rounding a step, sheared by the map: it grows like k² on a circle.
        tolerance = 64 * EPS * k**2 * (1 + abs(now))
        assert now == pytest.approx(
            float(phase(state, np.array([psi + k * state.rotation_number]))[0]), abs=tolerance
        )


def test_mean_height_by_quadrature(state):
    """∫_u^{h(u)} (h(y) − y)/2 dy = ((h(u) − u)/2)² + Z(h(u)), with no Fourier algebra."""
    rho, omega = state.rotation_number, state.omega
    nodes, weights = leggauss(600)  # half a node a radian of the highest harmonic of U (1 + U′)
    for psi in (0.0, 1.1, 4.0):
        points = psi + rho * (nodes + 1) / 2
        stretch = 1 + sum(k * b * np.cos(k * points) for k, b in enumerate(state.sines, start=1))
        jump = (phase(state, points + rho) - phase(state, points)) / (2 * omega)
        integral = float(weights @ (jump * stretch)) * rho / 2 / omega
        u, h = phase(state, np.array([psi, psi + rho])) / omega
        expected = ((h - u) / 2) ** 2 + 1 + state.epsilon * math.cos(omega * h)
        assert integral == pytest.approx(expected, abs=200 * EPS * (1 + expected))


def test_driven_end(state):
    tau = times(state)
    drive = 1 + state.epsilon * np.cos(state.omega * tau)
    np.testing.assert_allclose(state.shape(0.0, tau), drive, rtol=0, atol=32 * EPS)


def test_contact_conditions(state):
    """W and W_ξ at ξ_c are sums of terms of size ξ_c² and 2ξ_c, to 64 roundings (4e-14)."""
    tau = times(state)
    xi = state.contact(tau)
    scale = 64 * EPS * float(1 + xi.max() ** 2)
    np.testing.assert_allclose(state.shape(xi, tau), 0, rtol=0, atol=scale)
    np.testing.assert_allclose(state.slope(xi, tau), 0, rtol=0, atol=scale)


def test_wave_equation(state):
    """W_ττ = W_ξξ − 2 by the exact parallelogram rule of the wave operator, no small step."""
    tau = times(state, 31)[:, None]
    xi = np.linspace(0.2, 0.6, 5)[None, :]
    step = 0.1
    corners = state.shape(xi + step, tau) + state.shape(xi - step, tau)
    corners = corners - state.shape(xi, tau + step) - state.shape(xi, tau - step)
    np.testing.assert_allclose(corners, 2 * step**2, rtol=0, atol=64 * EPS)


def test_slope_is_the_derivative_and_negative(state):
    """The profile is strictly monotone up to the contact point: the exact string never grazes."""
    tau = times(state, 23)[:, None]
    xi = np.linspace(0.01, 0.97, 41) * state.contact(tau)
    step = EPS ** (1 / 3)  # balances the error step² of the difference and EPS/step of rounding
    slope = (state.shape(xi + step, tau) - state.shape(xi - step, tau)) / (2 * step)
    scale = 1 + max(k**2 * abs(b) for k, b in enumerate(state.sines, start=1))
    np.testing.assert_allclose(state.slope(xi, tau), slope, rtol=0, atol=100 * scale * step**2)
    assert (state.slope(xi, tau) < 0).all()


def test_on_the_ground(state):
    tau = times(state, 11)
    assert (state.profile(0.3, tau) == 0).all()
    assert (state.slope(state.contact(tau) + 0.3, tau) == 0).all()
    assert (state.profile(-0.3, tau) > 0).all()


def test_contact_speed_is_the_largest(state):
    tau = np.linspace(0, 2 * math.pi / state.omega, 4001)
    speed = np.abs(np.gradient(state.contact(tau), tau, edge_order=2)).max()
    # Second differences on this grid see the maximum to a relative 1e-4 of itself.
    assert speed == pytest.approx(state.contact_speed, rel=2e-3)
    assert state.contact_speed < 1


def test_theory_value():
    """ϱ − 2Ω at Ω = 0.83, ε = 0.02, to the four digits it is quoted with."""
    shift = invariant_circle(0.83, 0.02).rotation_number - 2 * 0.83
    assert shift == pytest.approx(-1.322e-4, abs=0.0005e-4)


def test_static_state():
    """Without drive the shape is (1 − ξ)², also at a resonance."""
    for omega in (0.83, math.pi):
        state = invariant_circle(omega, 0.0)
        assert state.rotation_number == pytest.approx(2 * omega, abs=4 * EPS * omega)
        assert state.contact(1.7) == pytest.approx(1, abs=8 * EPS)
        xi = np.linspace(0, 0.9, 10)
        np.testing.assert_allclose(state.shape(xi, 0.3), (1 - xi) ** 2, rtol=0, atol=32 * EPS)
        assert state.contact_speed == 0


def test_half_a_period():
    """ε → −ε is a shift by half a period."""
    plus, minus = invariant_circle(2.2, 0.04), invariant_circle(2.2, -0.04)
    tau = times(plus)
    shifted = minus.contact(tau + math.pi / 2.2)
    np.testing.assert_allclose(plus.contact(tau), shifted, rtol=0, atol=64 * EPS)


def test_late_times_keep_their_digits():
    state = invariant_circle(0.83, 0.1)
    period = 2 * math.pi / 0.83
    late = state.shape(0.5, 0.4 + 1000 * period)
    # The argument 0.4 + 1000 periods is itself rounded to EPS of its size.
    assert late == pytest.approx(float(state.shape(0.5, 0.4)), abs=2 * EPS * 1000 * period)


def test_start_from_a_neighbour():
    near = invariant_circle(2.2, 0.049)
    direct, led = invariant_circle(2.2, 0.05), invariant_circle(2.2, 0.05, start=near)
    assert led.rotation_number == pytest.approx(direct.rotation_number, abs=64 * EPS)
    np.testing.assert_allclose(led.contact(times(led)), direct.contact(times(led)), atol=1e-13)


def test_lost_next_to_a_resonance():
    """Ω = 2.7, ε = 0.03: beyond the resonance's separatrix; the partial result is carried."""
    with pytest.raises(CircleNotFoundError, match=r"smaller \|epsilon\|") as caught:
        invariant_circle(2.7, 0.03)
    partial = caught.value.partial
    assert partial is not None
    assert partial.status is not CircleStatus.CONVERGED
    assert len(partial.residuals) > 1
    assert isinstance(caught.value, NumericsError)


def test_too_few_nodes_is_said():
    with pytest.raises(CircleNotFoundError, match="max_nodes") as caught:
        invariant_circle(0.83, 0.3, nodes=8, max_nodes=16)
    assert caught.value.partial is not None
    assert caught.value.partial.nodes == 16


@pytest.mark.parametrize(
    ("omega", "epsilon", "too_few", "enough"),
    [
        (1.9392596793683539, 0.11301003110149455, 256, 512),
        (1.9387879431291504, 0.12916017170010255, 32768, 65536),
    ],
)
def test_a_failure_is_no_proof(omega, epsilon, too_few, enough):
    """The golden circle at K = .85 and .971, Ω and ε from the same equations at fixed ϱ: it is
    missed where its series does not fit, and the error does not say that there is none."""
    golden = math.pi * (math.sqrt(5) - 1)
    with pytest.raises(CircleNotFoundError, match="no proof that there is none") as caught:
        invariant_circle(omega, epsilon, max_nodes=too_few)
    assert caught.value.partial is not None
    assert caught.value.partial.status is not CircleStatus.CONVERGED
    state = invariant_circle(omega, epsilon, max_nodes=enough)
    assert state.nodes > too_few
    assert state.rotation_number == pytest.approx(golden, abs=1e-12)


def test_no_circle_beyond_the_proved_bound():
    """|K| ≥ 63/64; the error names the largest amplitude worth trying."""
    with pytest.raises(CircleNotFoundError, match="63/64") as caught:
        invariant_circle(1.2, 0.35)
    assert caught.value.partial is None
    assert "0.3417" in str(caught.value)


@pytest.mark.parametrize(
    ("omega", "epsilon", "said"),
    [
        (-1.0, 0.1, r"Omega = -1\.0.*positive and finite"),
        (0.0, 0.1, "positive and finite"),
        (math.inf, 0.1, "positive and finite"),
        (math.nan, 0.1, "positive and finite"),
        (0.83, math.nan, "epsilon = nan.*finite"),
        (2 * math.pi, 0.01, "resonance p/q = 2/1"),
        ("fast", 0.01, "'fast'.*two numbers"),
    ],
)
def test_input_is_checked(omega, epsilon, said):
    with pytest.raises(InputError, match=said):
        invariant_circle(omega, epsilon)


@pytest.mark.parametrize("nodes", [0, 12, 33, 32.0])
def test_nodes_are_checked(nodes):
    with pytest.raises(InputError, match="power of two"):
        invariant_circle(0.83, 0.02, nodes=nodes)
    with pytest.raises(InputError, match="exceeds"):
        invariant_circle(0.83, 0.02, nodes=64, max_nodes=32)


def test_places_and_times_are_checked():
    state = invariant_circle(0.83, 0.02)
    with pytest.raises(InputError, match="ξ ≥ 0"):
        state.shape(-0.1, 0.0)
    with pytest.raises(InputError, match="finite times"):
        state.contact(np.nan)


@pytest.mark.parametrize("distance", [6.25e-3, 1e-3, -1e-3, 2e-4])
@pytest.mark.parametrize("share", [0.1, 0.3])
def test_next_to_a_resonance_rounding_is_not_taken_for_failure(
    distance: float, share: float
) -> None:
    """Well inside the pendulum's separatrix ε = μ²/8 the circle exists, however small μ is."""
    omega, epsilon = np.pi + distance, share * distance**2 / 8
    circle = invariant_circle(omega, epsilon)
    tau = np.linspace(0, 2, 5)
    contact = circle.contact(tau)
    slope = circle.slope(contact, tau)
    # The response is amplified by 1/sin Ω, and so are the roundings of the drive.
    assert np.abs(slope).max() <= 100 * np.finfo(float).eps / abs(np.sin(omega))
