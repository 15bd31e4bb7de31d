"""The pendulum: three routes to its series, its integral, its radius of convergence."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from asymptotics.errors import InputError
from asymptotics.resonances.first_touch import graze
from asymptotics.resonances.pendulum import (
    RADIUS,
    coefficient,
    elliptic,
    momentum,
    parameter,
    series,
    truncated,
)

EPS = 2.0**-52
X = np.linspace(0, 2 * math.pi, 96, endpoint=False)


def test_two_routes_to_the_series() -> None:
    """The recurrence for ϖ² against Lagrange's inversion, exactly, all k ≡ n."""
    for n, row in enumerate(series(14), start=1):
        assert sorted(row) == list(range(n % 2 or 2, n + 1, 2))
        assert row == {k: coefficient(n, k) for k in row}
        assert all(row.values())
        assert coefficient(n, n + 1) == 0


def test_top_harmonics() -> None:
    """A_{n,n} = 2 binom(1/2, n): the other branches of the square root do not reach k = n."""
    for n, row in enumerate(series(12), start=1):
        binomial = Fraction(1)
        for i in range(n):
            binomial *= (Fraction(1, 2) - i) / (i + 1)
        assert row[n] == 2 * binomial


@pytest.mark.parametrize("strength", [0.3, -0.3, 0.6, -0.616, 1e-9])
def test_momentum_solves_its_equations(strength: float) -> None:
    """ϖ² − 2Λ cos x is constant and ⟨ϖ⟩ = 1.

    The trapezoidal rule converges like exp(−nodes · width of analyticity): 4096 nodes leave
    rounding even 1e-3 away from the separatrix.
    """
    x = np.linspace(0, 2 * math.pi, 4096, endpoint=False)
    w = momentum(strength, x)
    energy = w**2 - 2 * strength * np.cos(x)
    # ϖ ≤ π/2 is good to the rounding of m, magnified by dE/dm ≤ a few units.
    assert np.ptp(energy) <= 64 * EPS
    assert float(w.mean()) == pytest.approx(1, abs=64 * EPS)
    assert np.ptp(w) > abs(strength)


@pytest.mark.parametrize("strength", [0.1, 0.25, -0.25])
def test_the_series_converges_to_it(strength: float) -> None:
    """Each order gains the factor |Λ|/RADIUS, up to the algebraic n⁻²."""
    exact = momentum(strength, X)
    errors = [np.abs(truncated(strength, X, n) - exact).max() for n in (6, 12, 18)]
    for before, after in itertools.pairwise(errors):
        gain = (abs(strength) / RADIUS) ** 6
        assert after < gain * before or after < 16 * EPS
        assert after > gain * before / 40 or after < 16 * EPS


def test_radius_of_convergence() -> None:
    """Ratios of Σ_k |A_{n,k}| at distance 2 approach RADIUS⁻² like 1 + 2·2/n, from below."""
    rows = series(80)
    size = [float(sum(map(abs, row.values()))) for row in rows]
    for n in (40, 60, 80):
        estimate = math.sqrt(size[n - 3] / size[n - 1])
        # Terms RADIUS⁻ⁿ n⁻² ln⁻² n: the estimate is RADIUS (1 + 2/n + O(1/(n ln n))).
        assert 1 < estimate / RADIUS < 1 + 2 / n * 1.5


def test_nothing_is_singular_inside_the_radius() -> None:
    """dΛ/dm = π²K/(16E³), and the image of the cut m ≥ 1 stays outside |Λ| = RADIUS."""
    for m in (0.1, 0.5, 0.9):
        rate = mpmath.diff(lambda t: mpmath.pi**2 * t / (16 * mpmath.ellipe(t) ** 2), m)
        expected = mpmath.pi**2 * mpmath.ellipk(m) / (16 * mpmath.ellipe(m) ** 3)
        assert abs(rate - expected) < 1e-12 * expected  # mpmath differentiates to 15 digits
    cut = [1 + 10 ** (i / 10) for i in range(-60, 61)]
    sizes = [abs(mpmath.pi**2 * m / (16 * mpmath.ellipe(m) ** 2)) for m in cut]
    assert min(sizes) > RADIUS
    assert sizes[0] == pytest.approx(RADIUS, rel=1e-4)
    assert sizes[-1] == pytest.approx(RADIUS, rel=1e-4)


def test_elliptic_integrals() -> None:
    for m in (0.0, 1e-12, 0.3, 0.99, 1 - 1e-10):
        first, second = elliptic(m)
        assert first == pytest.approx(float(mpmath.ellipk(m)), rel=8 * EPS)
        # E = K (1 − rest) cancels where E ≈ 1 and K is large: at most a factor of K ≈ 13 here.
        assert second == pytest.approx(float(mpmath.ellipe(m)), rel=64 * EPS)


def test_parameter_is_the_inverse() -> None:
    """Λ(m(Λ)) = Λ; at the separatrix ϖ(0) = π/2 and ϖ(π) = 0."""
    for strength in (1e-12, 0.01, 0.3, 0.6, 0.6168):
        m = parameter(strength)
        _, E = elliptic(m)
        assert m * RADIUS / E**2 == pytest.approx(strength, rel=16 * EPS)
    close = momentum(RADIUS * (1 - 1e-9), [0.0, math.pi])
    assert close[0] == pytest.approx(math.pi / 2, rel=1e-8)
    assert 0 < close[1] < 1e-3


@pytest.mark.parametrize("strength", [RADIUS, -0.7, math.inf, math.nan])
def test_beyond_the_separatrix(strength: float) -> None:
    with pytest.raises(InputError, match="separatrix"):
        momentum(strength, 0.0)


@pytest.mark.parametrize("order", [0, -1, 2.0, True])
def test_bad_orders(order: int) -> None:
    with pytest.raises(InputError, match="starts at n = 1"):
        series(order)


def test_first_two_touches_in_closed_form() -> None:
    """One harmonic: max ψ = 1/π at z = π, so g = π/2 at y = π, and π at y = π/2 for n = 2."""
    first, second = graze({1: 1.0}), graze({2: -0.25})
    assert first.amplitude == pytest.approx(math.pi / 2, rel=8 * EPS)
    assert first.y == pytest.approx(math.pi, rel=8 * EPS)
    assert second.amplitude == pytest.approx(math.pi, rel=8 * EPS)
    assert (first.x, second.x) == (0.0, pytest.approx(math.pi / 2, rel=8 * EPS))
    assert second.y == pytest.approx(math.pi / 2, rel=8 * EPS)
    # Height of the first: max t² − π (t − sin t) on (0, π).
    t = mpmath.findroot(lambda t: 2 * t - mpmath.pi * (1 - mpmath.cos(t)), 1.0)
    bump = float(t**2 - mpmath.pi * (t - mpmath.sin(t)))
    assert first.height == pytest.approx(bump, rel=64 * EPS)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("n", [3, 4, 6, 9])
def test_no_touch_anywhere_before_the_first(n: int, sign: int) -> None:
    """Dense sampling of the profile itself, with no formula of the search in it."""
    row = {k: sign * float(a) for k, a in series(n)[n - 1].items()}
    touch = graze(row)
    assert 0 <= touch.gap < 1e-6
    x = np.linspace(0, math.pi, 401)[:, None, None]
    y = np.linspace(0, 8, 801)[None, :, None]
    k = np.array(list(row))
    a = np.array(list(row.values()))

    def lowest(amplitude: float, x: np.ndarray, y: np.ndarray) -> float:
        defect = y - np.sin(k * y) / k
        profile = y[..., 0] ** 2 - 2 * amplitude * (np.cos(k * x) * defect) @ a
        return float(profile.min())

    assert lowest(touch.amplitude * (1 - 1e-6), x, y) >= -64 * EPS * 64
    place = np.full((1, 1, 1), touch.x), np.full((1, 1, 1), touch.y)
    # At the touch itself zero, to rounding of terms of size y²; a little beyond, below the ground.
    assert abs(lowest(touch.amplitude, *place)) <= 64 * EPS
    assert lowest(touch.amplitude * 1.001, *place) < -0.9e-3 * touch.y**2


def test_touch_is_smooth() -> None:
    """Zero slope and zero velocity where it touches, by central differences of step h."""
    row = {k: float(a) for k, a in series(4)[3].items()}
    touch = graze(row)

    def profile(x: float, y: float) -> float:
        total = sum(a * math.cos(k * x) * (y - math.sin(k * y) / k) for k, a in row.items())
        return y * y - 2 * touch.amplitude * total

    h = 1e-4
    across = (profile(touch.x + h, touch.y) - profile(touch.x - h, touch.y)) / (2 * h)
    along = (profile(touch.x, touch.y + h) - profile(touch.x, touch.y - h)) / (2 * h)
    # Third derivatives are below 60 here; the differences err by h²/6 of them.
    assert abs(across) < 10 * h * h
    assert abs(along) < 10 * h * h
    assert 0.1 < touch.x < math.pi - 0.1


@pytest.mark.parametrize("harmonics", [{}, {1: 0.0}, {0: 1.0}, {1: math.nan}])
def test_bad_harmonics(harmonics: dict[int, float]) -> None:
    with pytest.raises(InputError, match="harmonic"):
        graze(harmonics)
