"""Singularities of the ε-series: known functions, predicted poles, rounding, the golden circle."""

from __future__ import annotations

import math
from functools import partial
from random import Random

import numpy as np
import pytest
from flint import acb, arb, arb_poly

from asymptotics import expand, float_string
from asymptotics.errors import InputError
from asymptotics.problems.enclosed import ball_string
from asymptotics.rings.balls import frequency
from asymptotics.rings.precision import at_precision
from asymptotics.values import series_analysis
from asymptotics.values.approximants import BITS, pade, scaled_series
from asymptotics.values.lindstedt import break_up, lindstedt
from asymptotics.values.series_analysis import (
    SeriesAnalysis,
    analyse_series,
    harmonic_series,
    island_width,
    resonance_pole,
    rotation_shift,
)
from asymptotics.values.singularities import pade_estimates, ratio_estimate

EPS = 2.0**-52
GOLDEN = math.pi * (math.sqrt(5) - 1) / 2  # Ω with 2Ω/2π the golden mean
FIBONACCI = [21, 34, 55, 89, 144, 233]
BREAK_UP = 0.971635  # J. M. Greene, J. Math. Phys. 20 (1979) 1183


@pytest.fixture(scope="module")
def golden() -> SeriesAnalysis:
    return analyse_series(GOLDEN, 60)


def power_series(place: float, exponent: float, count: int) -> np.ndarray:
    """Coefficients of (1 − x/place)^{−exponent}."""
    c = [1.0]
    for i in range(1, count):
        c.append(c[-1] * (exponent + i - 1) / i / place)
    return np.array(c)


@pytest.mark.parametrize(("place", "exponent"), [(2.0, 1.0), (-0.3, 0.5), (5.0, -1.5), (1.0, 3.0)])
def test_ratios_find_a_pure_power_exactly(place: float, exponent: float) -> None:
    found = ratio_estimate(power_series(place, exponent, 20))
    # i r_i − (i − 1) r_{i−1} multiplies roundings by 2i = 40, i (r/… − 1) once more by i.
    assert abs(found.position - place) <= 64 * 40 * EPS * abs(place)
    assert abs(found.exponent - exponent) <= 20 * 64 * 40 * EPS
    assert found.error <= 64 * 40 * EPS * abs(place)


def test_ratios_converge_and_their_spread_is_honest() -> None:
    """A second power behind the first: the error falls faster than 1/i, like the spread."""
    errors = []
    for count in (12, 24, 48):
        series = power_series(2.0, 0.5, count) + power_series(2.0, -0.7, count)
        found = ratio_estimate(series)
        errors.append(abs(found.position - 2))
        assert errors[-1] <= 20 * found.error
    assert errors[0] > 2 * errors[1] > 4 * errors[2] > 0


def test_competing_singularities_show_as_a_large_error() -> None:
    found = ratio_estimate(power_series(1.0, 1.0, 20) + power_series(-1.05, 1.0, 20))
    assert found.error > abs(found.position)


def test_pade_finds_all_poles_of_a_rational_function() -> None:
    places = [0.8, -1.1, 1.7]
    with at_precision(BITS):
        exact, scale = scaled_series(sum(power_series(p, 1.0, 24) for p in places))
        found = [z * scale for z, _ in pade(exact, 2, 3)]
        assert found == pytest.approx(places, rel=1e4 * EPS)
        assert [r for _, r in pade([arb(1), arb(1) / 2], 0, 1)] == [-2]
        assert pade([arb(0), arb(0), arb(1)], 0, 1) == []
    entire = np.array([1 / math.factorial(i) for i in range(24)])
    estimates = pade_estimates(sum(power_series(p, 1.0, 24) for p in places) + entire)
    assert [f.position.real for f in estimates[:2]] == pytest.approx(places[:2], rel=1e-6)
    assert all(f.error >= 0 for f in estimates)


def test_pade_ignores_noise() -> None:
    rng = np.random.default_rng(3)
    series = power_series(0.8, 1.0, 24) * (1 + 1e-12 * rng.standard_normal(24))
    near = [f for f in pade_estimates(series) if abs(f.position) < 2]
    assert len(near) == 1
    assert near[0].position == pytest.approx(0.8, rel=1e-9)


def powers(place: complex, exponent: float, count: int) -> list[arb]:
    """Coefficients of (1 − x/x_c)^{−g}, and of its conjugate where x_c is complex, to 200 bits."""
    with at_precision(300):
        x, c = acb(place.real, place.imag), [acb(1)]
        for i in range(1, count):
            c.append(c[-1] * (arb(exponent) + i - 1) / i / x)
        return [(2 if place.imag else 1) * z.real for z in c]


@pytest.mark.parametrize(
    ("place", "exponent", "kind"),
    [
        (0.7 + 0j, 1.0, "pole"),
        (-0.7 + 0j, 0.5, "branch point"),
        (-0.5 + 0.4j, 1.0, "pole"),
        (-0.5 + 0.4j, 0.5, "branch point"),
        (-0.5 + 0.4j, -0.5, "branch point"),
        (0.2 + 0.6j, 1.5, "branch point"),
    ],
)
def test_complex_pairs_and_branch_points(place: complex, exponent: float, kind: str) -> None:
    """Beside another one, farther away, and an entire part: errors hold, kinds are right."""
    kinds = set()
    for count in (10, 14, 20, 30):
        far, near = powers(-1.3 + 0j, 0.5, count), powers(place, exponent, count)
        series = [
            a + b + arb(1) / math.factorial(i)
            for i, (a, b) in enumerate(zip(near, far, strict=True))
        ]
        found = pade_estimates(series)
        if not found:
            continue
        first = found[0]
        assert abs(first.position - place) <= first.error
        assert first.position.imag >= 0
        kinds.add(first.kind)
    assert kinds <= {kind, "undecided"}
    assert found
    assert first.error < 0.1 * abs(place)


def test_a_zero_is_no_singularity() -> None:
    """(1 − x/0.3) eˣ/(1 − x): f′/f has a pole at 0.3, f has none."""
    count = 24
    exponential = [1 / math.factorial(i) for i in range(count)]
    series = np.convolve(np.convolve(exponential, [1, -1 / 0.3])[:count], np.ones(count))[:count]
    assert [round(f.position.real, 6) for f in pade_estimates(series) if abs(f.position) < 3] == [1]


# -- at fixed Ω ------------------------------------------------------------------------------------


def test_doubles_against_balls() -> None:
    """The doubles are the balls rounded: each coefficient to half a unit in its last place."""
    order = 30
    numbers = expand(float_string(GOLDEN, order), order)
    with at_precision(256):
        balls = expand(ball_string(GOLDEN), order)
        sine = frequency(GOLDEN).ball().sin()
    worst = []
    for n in range(1, order + 1):
        for j, ball in balls.contact(n).items():
            assert ball.rad() < 1e-30 * abs(ball)
            worst.append(float((abs(ball - numbers.contact(n)[j]) / abs(ball)).mid()))
    assert max(worst) <= EPS / 2
    series = harmonic_series(numbers, GOLDEN, 14)
    known = float((2 * balls.contact(14)[14] / sine**14).mid())
    assert series[0] == pytest.approx(known, rel=order**3 * EPS)


@pytest.mark.parametrize(("p", "q"), [(2, 9), (4, 9), (3, 11)])
def test_poles_are_where_the_shifted_resonance_is(p: int, q: int) -> None:
    """ε_q² of the leading order is met up to a relative O(μ) as μ = Ω − pπ/q → 0.

    Below order 3q the resonant harmonic does not act on itself yet, and the pole is simple.
    """
    defects = []
    for mu in (1e-3, 5e-4, 2.5e-4):
        omega = p * math.pi / q + mu
        order = q + 2 * (q - 1)
        series = harmonic_series(expand(float_string(omega, order), order), omega, q)
        found = ratio_estimate(series, q)
        defects.append(abs(found.position / resonance_pole(omega, q) - 1))
    assert defects[-1] < 0.05
    assert defects[0] > 1.5 * defects[1] > 2.25 * defects[2] > 0


@pytest.mark.slow
def test_the_golden_series_diverges_by_its_resonances(golden: SeriesAnalysis) -> None:
    """Harmonic 34 (34Ω = 21π + 0.041) has a simple pole at ε² < 0, half as far as the break-up."""
    ratios = {f.harmonic: f for f in golden.singularities if f.method == "ratio"}
    ratio = ratios[34]
    assert ratio.position.real < 0
    assert ratio.error < 1e-3 * abs(ratio.position)
    assert abs(ratio.exponent - 1) < 0.01
    assert ratio.position.real == pytest.approx(resonance_pole(GOLDEN, 34), rel=0.2)
    nearest = golden.nearest
    assert nearest is not None
    assert abs(nearest.position - ratio.position) < 0.02 * abs(ratio.position)
    circle = BREAK_UP / (2 * GOLDEN**2)
    assert math.sqrt(abs(nearest.position)) < 0.5 * circle
    # The root test passes the break-up of the circle and goes on falling.
    assert golden.growth[59] < circle < golden.growth[39]
    assert list(golden.growth[35::4]) == sorted(golden.growth[35::4], reverse=True)
    shown = golden.as_json()
    assert shown["nearest"]["epsilon"] == math.sqrt(abs(nearest.position))
    assert shown["resonances"][1][0] == 34


@pytest.mark.slow
# What Padé approximants at order 84, in 640 bits, have: at Ω = 1.2 settled to 1e-8;
# at Ω = 1.9 branch points, whose estimates still move by as much as given. There, below order 44,
# no estimate is good enough to be given. At Ω = 2.52955, near 4π/5, order 60 has branch points, and
# low orders a pole beside them that looks as if it were settled to one per cent.
@pytest.mark.parametrize(
    ("omega", "order", "known", "within"),
    [
        (1.2, 32, [-0.0341286], 1e-7),
        (1.2, 40, [0.01334976], 1e-8),
        (1.9, 24, None, 0),
        (2.52955305, 20, None, 0),
        (2.52955305, 28, [-0.000757 + 0.000097j], 5e-5),
        pytest.param(1.9, 36, None, 0, marks=pytest.mark.slow),
        pytest.param(1.9, 40, None, 0, marks=pytest.mark.slow),
        pytest.param(1.2, 44, [0.01334976], 1e-8, marks=pytest.mark.slow),
        pytest.param(1.9, 44, [-0.0098 + 0.0055j, 0.0126], 5e-4, marks=pytest.mark.slow),
        pytest.param(1.9, 52, [-0.0098 + 0.0055j, 0.0126], 5e-4, marks=pytest.mark.slow),
    ],
)
def test_the_nearest_singularity_against_higher_orders(
    omega: float, order: int, known: list[complex] | None, within: float
) -> None:
    nearest = analyse_series(omega, order).nearest
    if known is None:
        assert nearest is None
        return
    assert nearest is not None
    assert min(abs(nearest.position - place) for place in known) <= nearest.error + within
    assert nearest.error < 0.25 * abs(nearest.position)
    assert nearest.kind in ("undecided", "pole" if omega == 1.2 else "branch point")


def claims_against(
    reference: int, orders: list[int], seed: int, monkeypatch: pytest.MonkeyPatch
) -> tuple[int, int]:
    """How many claims of ``nearest`` there are, and how many are confirmed by a better estimate.

    One Ω is drawn from each eighth of 0.4 … 3.6.
    """
    random = Random(seed)
    claims = confirmed = 0
    for omega in [0.4 * (1 + i + random.random()) for i in range(8)]:
        longest = expand(float_string(omega, reference), reference)
        monkeypatch.setattr(
            series_analysis, "expand", partial(lambda start, p, n: expand(p, n, start), longest)
        )
        found = analyse_series(omega, reference).singularities
        known = [f for f in found if f.method == "Padé"]
        for order in orders:
            claim = analyse_series(omega, order).nearest
            if claim is None:
                continue
            claims += 1
            gaps = [(abs(f.position - claim.position), f.error) for f in known]
            assert any(gap <= claim.error + error for gap, error in gaps), (omega, order, claim)
            confirmed += any(gap <= claim.error and error <= claim.error for gap, error in gaps)
    return claims, confirmed


@pytest.mark.slow
def test_errors_hold_against_a_higher_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that is claimed is refuted, and half of it is confirmed by what is no worse."""
    claims, confirmed = claims_against(34, [20, 24, 28], 20, monkeypatch)
    assert 2 * confirmed >= claims > 3


@pytest.mark.slow
def test_errors_hold_against_order_60(monkeypatch: pytest.MonkeyPatch) -> None:
    claims, confirmed = claims_against(60, [20, 28, 36, 44], 21, monkeypatch)
    assert 2 * confirmed >= claims > 10


def test_the_island_reaches_beyond_the_branch_points() -> None:
    """4Ω near π: below order 12 a simple pole of harmonic 4, from then on a branch point."""
    omega, q, order = math.pi / 4 + 0.01, 4, 28
    expansion = expand(float_string(omega, order), order)
    series = harmonic_series(expansion, omega, q)
    last = q - 1  # of the coefficients below order 3q
    pole = series[last - 1] / series[last]
    assert pole == pytest.approx(resonance_pole(omega, q), rel=0.05)
    width = island_width(omega, abs(pole) ** (q / 2) * abs(series[last] * pole ** (last + 1)))
    branch = pade_estimates(harmonic_series(expansion, omega, 10), 10)[0]
    assert branch.error < width / 4 < abs(branch.position - pole) < width


def test_rotation_shift_from_the_lindstedt_series() -> None:
    """ϱ = 2Ω + γε² from the mean height on the circle: ⟨D(1 + U′)⟩ϱ/Ω = ⟨D²⟩ + 1 + ε⟨cos φ⟩."""
    omega = 0.83
    defects = []
    for epsilon in (0.01, 0.005):
        rotation = 2 * omega + rotation_shift(omega) * epsilon**2
        strength = 2 * epsilon * omega**2
        orders = lindstedt(rotation, 8)
        u = (strength ** np.arange(9)[:, None] * orders).sum(axis=0)
        spectrum = np.fft.rfft(u)
        k = np.arange(spectrum.size)
        ahead = np.fft.irfft(spectrum * np.exp(1j * k * rotation), u.size)
        stretch = 1 + np.fft.irfft(1j * k * spectrum, u.size)
        d = (rotation + ahead - u) / (2 * omega)
        psi = 2 * np.pi * np.arange(u.size) / u.size
        height = rotation / omega * np.mean(d * stretch)
        defects.append(
            abs(height - np.mean(d**2) - 1 - epsilon * np.mean(np.cos(psi + u))) / epsilon**2
        )
    # What the next order leaves falls like ε² after division by ε².
    assert defects[0] > 1e-7
    assert math.log2(defects[0] / defects[1]) == pytest.approx(2, abs=0.05)


# -- at fixed rotation number ----------------------------------------------------------------------


def exact_lindstedt(rotation: arb, order: int) -> list[list[arb]]:
    """A second method in balls: Fourier coefficients instead of nodes. Row n: the sines of U_n."""
    divisors = [None] + [-4 * (k * rotation / 2).sin() ** 2 for k in range(1, order + 1)]
    wave, rates, rows = [arb_poly([0, 1])], [arb_poly([])], [[]]
    for n in range(1, order + 1):
        c = [wave[-1][i] for i in range(2 * n)] + [arb(0)] * 2
        middle = n - 1
        sines = [arb(0)]
        for k in range(1, n + 1):
            low = c[middle - k] if k <= middle else arb(0)
            sines.append(-(c[middle + k] - low) / divisors[k])
        rows.append(sines)
        half = [s / 2 for s in sines]
        rates.append(arb_poly([-h for h in half[:0:-1]] + [arb(0)] + half[1:]) * n)
        total = sum((rates[m] * wave[n - m] for m in range(1, n + 1)), arb_poly([]))
        wave.append(total * (arb(1) / n))
    return rows


def test_lindstedt_against_balls() -> None:
    order = 60
    with at_precision(256):
        exact = exact_lindstedt(arb(GOLDEN) * 2, order)
    found = lindstedt(2 * GOLDEN, order)
    sines = -2 * np.fft.rfft(found, axis=1).imag / found.shape[1]
    for n in range(1, order + 1):
        scale = max(float(abs(x).mid()) for x in exact[n])
        for k in range(1, n + 1):
            # n products an order, over up to n orders, each divided by small divisors ≥ 1/n².
            assert abs(sines[n, k] - float(exact[n][k].mid())) <= n**4 * EPS * scale
    assert scale > 0


def test_the_circle_is_met() -> None:
    """The truncated sum leaves K^{N+1} in the map."""
    rotation, order = 1.66, 6
    orders = lindstedt(rotation, order)
    shift = np.exp(1j * np.arange(orders.shape[1] // 2 + 1) * rotation)
    psi = 2 * np.pi * np.arange(orders.shape[1]) / orders.shape[1]
    left = []
    for strength in (0.2, 0.1):
        u = (strength ** np.arange(order + 1)[:, None] * orders).sum(axis=0)
        spectrum = np.fft.rfft(u)
        second = np.fft.irfft(spectrum * (shift - 2 + shift.conj()), u.size)
        left.append(abs(second + strength * np.sin(psi + u)).max())
    assert left[1] > 1e3 * EPS
    assert math.log2(left[0] / left[1]) == pytest.approx(order + 1, abs=0.3)


def test_the_golden_circle_breaks_up_where_it_is_known_to() -> None:
    found = break_up(FIBONACCI, 2 * GOLDEN)
    assert abs(found.radius - BREAK_UP) <= found.error < 0.02
    # The diagonal's own radius is another number: the estimate does not mistake one for the other.
    assert found.diagonal > found.radius + 0.005
    assert len(found.extrapolations) == 3


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ratio_estimate([1.0] * 7), "7 coefficients are too few"),
        (lambda: pade_estimates([1.0] * 7), "7 coefficients are too few"),
        (lambda: analyse_series(0.83, 10), "order = 10 gives too few"),
        (lambda: break_up([1, 2, 3], 1.0), "at least six"),
        (lambda: break_up([1, 2, 3, 5, 8, 7], 1.0), "increasing"),
        (lambda: lindstedt(-1.0, 3), "must be positive"),
    ],
)
def test_bad_input(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=message):
        call()
