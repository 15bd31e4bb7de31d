"""Folds: coefficients by several routes, the cubic solved, the limit of no bending."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from asymptotics import expand
from asymptotics.beam import beam, static_beam
from asymptotics.beam_spectrum import linear_frequencies
from asymptotics.errors import InputError
from asymptotics.folds import amplitude_equation, fold, fold_coefficient
from asymptotics.resonant_laurent import beam_laurent, string_forcing
from asymptotics.static_shape import DRIVEN_ENDS

EPS = float(np.finfo(float).eps)


def test_known_coefficients() -> None:
    """The values found at β = 0.01 by an independent prototype, to its printed digits."""
    result = fold(1, 1, 0.01)
    assert result.resonance == pytest.approx(3.2500013, abs=5e-8)
    assert result.F.value == pytest.approx(-1.73159, abs=5e-6)
    assert result.alpha.value == pytest.approx(-3.89146, abs=5e-6)
    assert result.coefficient.value == pytest.approx(0.112680, abs=5e-7)
    assert (result.exponent, result.side, result.sign) == (Fraction(3, 2), "below", -1)
    half = fold(1, 2, 0.01)
    assert half.coefficient.value == pytest.approx(0.995778, abs=5e-7)
    assert (half.exponent, half.side) == (Fraction(3, 4), "below")


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("q", [2, 3])
def test_alpha_is_the_mode_s_own(q: int, driven_end: str) -> None:
    """From order 3q at Ω₁/q as from order 3 at Ω₁: ξ_{3q,q} = (αF³ + γ^qF [q = 3])/(qμ)⁴ + …

    At q = 3 the shift contributes γ³F ε⁹/(3μ)⁴ to the same pole.
    """
    equation = fold(1, q, 0.01, driven_end)
    F, gamma = equation.F.value, equation.gamma
    assert gamma is not None
    near = beam_laurent(static_beam(np.array([0.01]), driven_end), 1, q, 3 * q)
    value, error = (float(x[0]) for x in near(3 * q, 4))
    shift = gamma.value**3 * F if q == 3 else 0.0
    found = (q**4 * value - shift) / F**3
    # The error estimate of the circle, and the roundings of a few thousand products.
    assert abs(found - equation.alpha.value) <= q**4 * error / abs(F) ** 3 + 1e4 * EPS
    assert abs(equation.alpha.value) > 1


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (1, 2), (3, 2), (1, 3), (2, 3)])
def test_error_estimates_hold_against_small_detunings(p: int, q: int, driven_end: str) -> None:
    """qμ ξ_{q,q} → F at a rate μ: Richardson's extrapolation from real detunings, no circle."""
    result = fold(p, q, 0.02, driven_end)
    sizes = [1e-3 * result.resonance / 2**k for k in range(4)]
    table = []
    for mu in sizes:
        values = [
            q * m * 2 * expand(beam(0.02, result.resonance + m, driven_end), q).contact(q)[q]
            for m in (mu, -mu)
        ]
        table.append(sum(values) / 2)  # even in μ: errors μ², μ⁴, …
    for k in range(1, 4):
        table = [(4**k * b - a) / (4**k - 1) for a, b in pairwise(table)]
    # The pole's place is known to 2 ulp, which μ = 1e-4 Ω amplifies.
    assert table[0] == pytest.approx(result.F.value, rel=1e5 * EPS)
    assert result.F.error < 1e3 * EPS * abs(result.F.value)
    assert result.alpha.error < 1e5 * EPS * abs(result.alpha.value)


def test_order_and_place_of_the_poles() -> None:
    """ξ_{n,q} has the pole the amplitude equation says, and none of the next order."""
    for q, n, pole in ((1, 1, 1), (1, 3, 4), (2, 2, 1), (2, 4, 2), (3, 3, 1), (3, 5, 2)):
        near = beam_laurent(static_beam(np.array([0.01])), 1, q, n)
        assert abs(near(n, pole)[0][0]) > 1e-3
        for beyond in (1, 2):
            value, error = near(n, pole + beyond)
            assert abs(value[0]) <= 10 * error[0]


def test_the_series_in_epsilon_ends_at_the_fold() -> None:
    """ξ_{n,1} at fixed μ is a series in ε² whose branch point is the fold, up to O(μ).

    At a square root coefficients grow as ε_f^{−2m} m^{−3/2}: the ratio, extrapolated twice in 1/m,
    is 1/ε_f². Nothing of the Laurent expansion enters.
    """
    law = fold(1, 1, 0.01)
    deviations = []
    for mu in (-0.02, -0.01, -0.005):
        series = expand(beam(0.01, law.resonance + mu), 25)
        c = np.array([series.contact(n)[1] for n in range(1, 26, 2)])
        ratio, m = c[1:] / c[:-1], np.arange(1.0, 13.0)
        for k in (1, 2):
            ratio = (m[k:] * ratio[1:] - (m[k:] - k) * ratio[:-1]) / k
        deviations.append(ratio[-1] ** -0.5 / float(law.epsilon(mu)) - 1)
    # The remainder of the extrapolation, O(m⁻³) = 6e-4, is below the last deviation, 1e-2.
    assert deviations[1] / deviations[0] == pytest.approx(0.5, abs=0.05)
    assert deviations[2] / deviations[1] == pytest.approx(0.5, abs=0.05)
    assert 0.005 < deviations[2] < 0.02


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (3, 2), (1, 3), (2, 3), (1, 4)])
def test_the_fold_is_a_double_root(p: int, q: int) -> None:
    equation = fold(p, q, 0.01)
    F, alpha = equation.F.value, equation.alpha.value
    gamma = 0.0 if equation.gamma is None else equation.gamma.value
    for epsilon in (1e-3, 1e-2, 0.05):
        M = q * float(equation.detuning(epsilon)) - gamma * epsilon**2
        # 3αa² = M makes the derivative vanish; the cubic then has a = −3Fε^q/(2M)·(−1).
        a = 3 * F * epsilon**q / (2 * M)
        scale = abs(M * a)
        # M is a difference: its rounding is that of γε².
        lost = 16 * EPS * (1 + abs(gamma) * epsilon**2 / abs(M))
        assert abs(M * a - F * epsilon**q - alpha * a**3) <= lost * scale
        assert abs(M - 3 * alpha * a * a) <= lost * abs(M)
        assert math.copysign(1, M) == equation.sign
        # The law of the docstring, in the detuning from the shifted centre.
        law = equation.coefficient.value * abs(M / q) ** float(equation.exponent)
        assert law == pytest.approx(epsilon, rel=2 * lost)


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (1, 3), (2, 3), (1, 4)])
def test_epsilon_inverts_detuning(p: int, q: int) -> None:
    equation = fold(p, q, 0.01)
    epsilon = np.array([1e-4, 1e-3, 1e-2])
    mu = equation.detuning(epsilon)
    found = equation.epsilon(mu)
    # The first branch only: where μ(ε) has turned round, a smaller ε has the same μ.
    assert np.all(found <= epsilon * (1 + 1e-9))
    assert equation.detuning(found) == pytest.approx(mu, rel=1e-9)
    assert found[0] == pytest.approx(epsilon[0], rel=1e-9)
    assert np.isnan(equation.epsilon(-mu[:1])).all()


def test_powers_of_the_detuning() -> None:
    """Local exponents dln ε/dln|μ| as μ → 0: 3/2, 3/4, ½ in μ; for q = 4 only M has a power."""
    for q, exponent in ((1, 1.5), (2, 0.75), (3, 0.5)):
        equation = fold(1, q, 0.01)
        sign = math.copysign(1, equation.coefficient_in_detuning or 0.0)
        mu = sign * np.array([1e-9, 1e-10])
        epsilon = equation.epsilon(mu)
        local = math.log(epsilon[0] / epsilon[1]) / math.log(10)
        # q = 2: the shift's share is γε²/(2μ) ∝ |μ|^{1/2}, 2e-5 here.
        assert local == pytest.approx(exponent, abs=1e-4)
        assert epsilon[0] == pytest.approx(
            abs(equation.coefficient_in_detuning or 0.0) * 1e-9**exponent, rel=1e-4
        )
    fourth = fold(1, 4, 0.01)
    assert fourth.coefficient_in_detuning is None
    # The shift decides the side in μ, against the side in M.
    assert fourth.sign < 0 < float(fourth.detuning(1e-3))


def test_the_third_resonance_folds_on_the_other_side() -> None:
    """At β = 0.01, q = 3: γ and (27αF²/4)^{1/3} nearly cancel, and the sum is positive."""
    equation = fold(1, 3, 0.01)
    assert equation.side == "below"
    assert float(equation.detuning(0.01)) > 0
    assert equation.coefficient_in_detuning == pytest.approx(9.30826, abs=1e-5)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("p", [1, 2])
def test_limit_of_weak_bending(p: int, driven_end: str) -> None:
    """α → −1/(12pπβ), C_{p,1} → (8/3)√(β/(pπ)): both corrections are of order √β."""
    beta = np.array([1e-5, 1e-7, 1e-9])
    _, (F, _), (alpha, _), _ = amplitude_equation(p, 1, beta, driven_end)
    low, high = linear_frequencies(beta, 2 * p, driven_end)[:, [p - 1, 2 * p - 1]].T
    corrections = {
        "detuning of the second harmonic": (high - 2 * low) / (3 * beta * (p * math.pi) ** 3) - 1,
        "alpha": -alpha * 12 * p * math.pi * beta - 1,
        "coefficient": fold_coefficient(1, F, alpha) / (8 / 3 * np.sqrt(beta / (p * math.pi))) - 1,
    }
    for name, values in corrections.items():
        # The next correction is β(2pπ)² to a factor, against √β of order one: 5e-2 at β = 1e-7.
        assert values[1] / values[2] == pytest.approx(10, rel=0.1), name
        assert abs(values[2]) < 1e-3, name
    assert F[-1] / string_forcing(p, 1) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(("p", "q"), [(1, 2), (3, 2), (1, 3), (2, 3)])
def test_coefficients_vanish_like_a_root_of_beta(p: int, q: int) -> None:
    """C_{p,q} ∝ β^{1/(2q)} with the string's F⁰ in front."""
    first, second = fold(p, q, 1e-5), fold(p, q, 1e-7)
    exponent = math.log(first.coefficient.value / second.coefficient.value) / math.log(100)
    assert exponent == pytest.approx(1 / (2 * q), abs=0.005)
    scale = (4 * q**1.5 * math.sqrt(p * math.pi * 1e-7) / (3 * abs(second.string_F))) ** (1 / q)
    assert second.coefficient.value == pytest.approx(scale, rel=0.01)


def test_the_string_s_law() -> None:
    """ε = μ²/(8p²) for q = 1 and ε = 4|μ|/π for p/q = 1/2; met at the crossover."""
    for p in (1, 2, 3):
        assert fold(p, 1, 0.01).string_epsilon(0.1) == pytest.approx(0.01 / (8 * p * p), rel=1e-12)
    half = fold(1, 2, 1e-3)
    assert half.string_epsilon(-0.1) == pytest.approx(0.4 / math.pi, rel=1e-12)
    x = half.crossover
    assert half.string_epsilon(x) == pytest.approx(half.coefficient.value * x**0.75, rel=1e-12)
    # β → 0: |μ| = (64/3)² p³ β/π for q = 1.
    assert fold(1, 1, 1e-7).crossover == pytest.approx((64 / 3) ** 2 * 1e-7 / math.pi, rel=2e-3)


def test_many_beta_at_once_are_the_single_ones() -> None:
    beta = np.logspace(-4, 0, 9)
    resonance, (F, _), (alpha, _), gamma = amplitude_equation(1, 2, beta)
    assert gamma is not None
    for i in (0, 4, 8):
        single = fold(1, 2, float(beta[i]))
        assert resonance[i] == single.resonance
        assert F[i] == pytest.approx(single.F.value, rel=1e-12)
        assert alpha[i] == pytest.approx(single.alpha.value, rel=1e-9)
        assert single.gamma is not None
        assert gamma[0][i] == pytest.approx(single.gamma.value, rel=1e-9)


def test_json() -> None:
    fields = json.loads(json.dumps(fold(1, 2, 0.01).as_json(), allow_nan=False))
    assert fields["command"] == "fold"
    assert (fields["p"], fields["q"], fields["exponent"], fields["side"]) == (1, 2, "3/4", "below")
    assert fields["variable"] == "mu"
    assert 0 < fields["errors"]["coefficient"] < 1e-10
    assert json.loads(json.dumps(fold(1, 1, 0.01).as_json(), allow_nan=False))["gamma"] is None
    assert fold(1, 4, 0.01).as_json()["variable"] == "mu - gamma*epsilon**2/4"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2, 2, 0.01), "ask for 1/1"),
        ((0, 1, 0.01), "p = 0"),
        ((1, 1.5, 0.01), "q = 1.5"),
        ((True, 1, 0.01), "p = True"),
        ((1, 1, 0.0), "for β = 0 use the string"),
        ((1, 1, -1.0), "beta = -1.0"),
        ((1, 1, 0.01, "free"), "choose one of pinned, clamped"),
        ((1, 1, 1e-12), "another resonance lies within"),
    ],
)
def test_bad_input(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        fold(*arguments)  # type: ignore[arg-type]
