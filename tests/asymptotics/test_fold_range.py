"""The range of a fold's law: the reduced equation behind it, and the search itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from asymptotics import expand
from asymptotics.expansion.reduced_equation import Resonance, reduced_equation
from asymptotics.problems.beam import beam_problem, static_beam
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.resonances import fold_range
from asymptotics.resonances.fold_range import ACCURACY, Range, double_root, law_error, next_pole
from asymptotics.resonances.folds import Kind, amplitude_equation, fold
from asymptotics.rings.numbers import balls
from asymptotics.rings.precision import at_precision


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("q", [1, 2, 3])
def test_the_reduced_equation_is_solved_by_the_plain_expansion(q: int, driven_end: str) -> None:
    """b(ε) = w_q″ of the plain series makes G vanish, order by order; Ω away from resonances."""
    order, omega, beta = 6, 2.2 / q, 0.01
    plain = expand(beam_problem(beta, omega, driven_end), order)
    series = np.zeros(order + 1)
    for n in range(1, order + 1):
        if q in plain.shape(n):
            series[n] = plain.shape(n)[q][2]
    with at_precision(128):
        shape = static_beam(beta, driven_end, balls())
        rows = reduced_equation(shape, balls().convert(omega), q, order)
    total, size = np.zeros(order + 1), np.zeros(order + 1)
    for n, row in enumerate(rows, start=1):
        for k, g in enumerate(row):
            power = np.eye(order + 1)[0]
            for _ in range(k):
                power = np.convolve(power, series)[: order + 1]
            term = float(g) * np.roll(power, n - k)
            term[: n - k] = 0.0
            total, size = total + term, size + abs(term)
    assert size.max() > 1e-2
    # Doubles of the plain expansion lose about half a power of 1/β an order, here a decade.
    assert np.all(abs(total) <= 1e-9 * size + 1e-300)


def test_scaled_terms_are_those_of_the_cubic() -> None:
    """At the law's own fold, small: qμ b, αb³ and the drive stand as −3 : 1 : 2, γ beside."""
    law = amplitude_equation(1, 2, 0.01)
    mu = -1e-8
    epsilon = float(law.epsilon(mu))
    rows = law.resonant.scaled(mu, epsilon, law.amplitude(epsilon), 4)
    assert max(abs(row).max() for row in rows) == 1.0
    assert [len(row) for row in rows] == [2, 3, 4, 5]
    M = rows[0][1] + rows[2][1]
    assert rows[2][3] / M == pytest.approx(-1 / 3, rel=1e-5)
    assert rows[1][0] / M == pytest.approx(-2 / 3, rel=1e-5)
    shift = law.gamma.value * epsilon**2 if law.gamma is not None else 0.0
    assert rows[2][1] / rows[0][1] == pytest.approx(-shift / (2 * mu), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "q"), [(1, 1), (2, 1), (1, 2), (3, 2), (1, 3), (2, 3), (1, 4), (9, 4), (1, 5), (2, 5)]
)
def test_kinds_by_the_roots_of_the_reduced_equation(p: int, q: int) -> None:
    """All terms through order N + 2, well inside the range: states near the fold are counted."""
    found = fold(p, q, 0.01)
    assert found.range is not None
    mu = found.mu_sign * found.range.mu / 8
    epsilon = float(found.epsilon(mu))
    rows = found.resonant.scaled(mu, epsilon, found.amplitude(epsilon), found.range.order)
    # Half way from the fold to where M would vanish, or to twice M.
    middle = double_root(rows)
    near = min(0.1, 0.25 * abs(found.cubic) * epsilon ** (2 * q / 3) / (q * abs(mu)))
    count = []
    for x in (middle * (1 - near), middle * (1 + near)):
        polynomial = np.zeros(found.range.order + 1)
        for n, row in enumerate(rows, start=1):
            for k, g in enumerate(row):
                polynomial[k] += g * x ** (n - k)
        roots = np.roots(np.trim_zeros(polynomial[::-1], "f"))
        real = roots.real[abs(roots.imag) <= 1e-9 * abs(roots)]
        # The double root is 1, the third −2; others of the polynomial are far away.
        count.append(int(np.sum(abs(real) < 3.5)))
    assert count == ([3, 1] if found.kind is Kind.END else [1, 3])


def test_the_reduced_fold_converges_to_the_spectral_one() -> None:
    """β = 0.01, Ω = 3.2: 1.38374e-3, 1.38733e-3, 1.38615e-3, 1.38741e-3 at orders 3, 5, 7, 9."""
    law = amplitude_equation(1, 1, 0.01)
    mu = 3.2 - law.resonance
    epsilon = float(law.epsilon(mu))
    rows = law.resonant.scaled(mu, epsilon, law.amplitude(epsilon), 9)
    folds = [double_root(rows[:order]) * epsilon for order in (3, 5, 7, 9)]
    assert folds == pytest.approx([1.38374e-3, 1.38733e-3, 1.38615e-3, 1.38741e-3], abs=6e-9)


def test_a_double_root_that_is_not_there() -> None:
    """μa = Fε + αa³ with the wrong sign of μ has none; nor has a linear equation."""
    assert math.isnan(double_root([np.array([-1.0, -1.5]), np.array([0.0, 0, 0, -0.5])]))
    assert math.isnan(double_root([np.array([-1.0, 1.5])]))
    # One term alone: no equation is left for y.
    assert math.isnan(double_root([np.array([1.0, 0.0])]))


@dataclass
class Made:
    """A law with a resonance of Ω_1/1, for the search."""

    q: int = 1
    mu_sign: int = -1

    @property
    def resonant(self) -> Resonance:
        return Resonance(1, self.q, 0.01, "pinned")

    def epsilon(self, mu: Any) -> Any:
        return abs(np.asarray(mu))

    def amplitude(self, epsilon: float) -> float:
        return epsilon


def searched(monkeypatch: pytest.MonkeyPatch, error: Any) -> Range | None:
    monkeypatch.setattr(fold_range, "law_error", lambda law, size: error(size))
    return fold_range.fold_range(Made())


def test_the_search_finds_where_the_error_is_a_tenth(monkeypatch: pytest.MonkeyPatch) -> None:
    for slope in (3.0, 1e4, 1e20):
        found = searched(monkeypatch, lambda size, slope=slope: slope * size)
        assert found is not None
        assert found.slope == pytest.approx(slope)
        assert ACCURACY / slope / math.sqrt(2) <= found.mu <= ACCURACY / slope
        assert found.epsilon == found.mu
        assert (found.pole, found.lost, found.order) == (None, False, 7)
        assert found.error == pytest.approx(found.slope * found.mu)
        assert "more than 10%" in found.reason


def test_the_slope_is_the_steepest_below_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """An error that flattens is steeper farther down; the line has to stay above it."""
    found = searched(monkeypatch, lambda size: 0.2 * size / (size + 0.02))
    assert found is not None
    for size in found.mu * np.array([1, 0.5, 0.125, 0.01]):
        assert 0.2 * size / (size + 0.02) <= found.slope * size * 1.01
    assert found.mu <= ACCURACY / found.slope


def test_a_law_that_is_good_by_chance_far_out_is_not_trusted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = searched(monkeypatch, lambda size: size if size > 0.02 or size < 1e-3 else math.inf)
    assert found is not None
    assert 2e-4 < found.mu < 1e-3
    assert found.lost
    assert "no such fold" in found.reason


def test_the_range_ends_half_way_to_a_pole(monkeypatch: pytest.MonkeyPatch) -> None:
    """Below Ω₁ the next of jΩ = Ω_n, j ≤ 7, is Ω₄/6."""
    spectrum = linear_frequencies(0.01, 4)
    found = searched(monkeypatch, lambda size: 1e-3 * size)
    assert found is not None
    assert found.pole == (4, 6)
    assert found.mu == pytest.approx((spectrum[0] - spectrum[3] / 6) / 2, rel=1e-12)
    assert "half way to Omega_4/6, where harmonic 6 resonates" in found.reason


@pytest.mark.parametrize(("q", "side"), [(1, 1), (1, -1), (2, 1), (2, -1), (3, 1)])
def test_the_next_pole_is_the_nearest_of_the_harmonics_through_order_seven(
    q: int, side: int
) -> None:
    """Harmonic 8 would resonate nearer for q = 1 above Ω₁ and for q = 2 below Ω₁/2."""
    spectrum, place = linear_frequencies(0.01, 40), Made(q).resonant.value
    found = [
        (side * (omega / j - place), (n, j))
        for j in range(1, 8)
        for n, omega in enumerate(spectrum, start=1)
        if side * (omega / j - place) > 1e-9
    ]
    distance, pole = min(found)
    bound = min(distance / 2, place / 4)
    expected = pole if bound < place / 4 else None
    assert next_pole(Made(q, side)) == (pytest.approx(bound, rel=1e-12), expected)


def test_no_range(monkeypatch: pytest.MonkeyPatch) -> None:
    assert searched(monkeypatch, lambda size: math.inf) is None
    assert searched(monkeypatch, lambda size: 1.0) is None
    assert searched(monkeypatch, lambda size: size if size > 1e-3 else math.inf) is None


def test_poles_that_merge_with_the_resonance_are_left_out() -> None:
    """β → 0: Ω₂/2 is at Ω₁ to rounding; the quarter of Ω₁ is what bounds the search below."""
    law = amplitude_equation(1, 1, 1e-17)
    bound, pole = next_pole(law)
    assert 0.01 < bound <= law.resonance / 4
    assert pole is None or pole[0] != pole[1]


def test_the_error_is_infinite_without_a_law() -> None:
    law = amplitude_equation(1, 1, 0.01)
    assert law_error(law, 1e6) == math.inf
    assert 0 < law_error(law, 1e-3) < 3e-3
    assert np.isinf(law.error([-1e-3])).all()
    assert fold(1, 1, 0.01).error([-0.001, -1.0]).tolist()[1] == math.inf


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [(1.0, 1.0, 0.0), (0.99, 1.0, 0.01), (1.25, 1.25, 0.2), (1.2, 1.25, 0.24)],
)
def test_the_estimate_counts_what_the_last_orders_moved(
    low: float, high: float, wanted: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """|ε_law/ε_{N+2} − 1| + |ε_N/ε_{N+2} − 1|, the reduced folds in units of the law."""
    law = amplitude_equation(1, 1, 0.01)
    monkeypatch.setattr(fold_range, "double_root", lambda rows: low if len(rows) == 5 else high)
    assert law_error(law, 1e-3) == pytest.approx(wanted, abs=1e-12)
