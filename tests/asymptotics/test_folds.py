"""Folds: coefficients by several routes, the cubic solved, the limit of no bending."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest

from asymptotics import expand
from asymptotics.errors import InputError
from asymptotics.problems.beam import beam_problem, static_beam
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.beam_waves import waves
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.resonances.folds import (
    LARGEST_Q,
    Fold,
    FoldCoefficient,
    Kind,
    amplitude_equation,
    fold,
    fold_coefficient,
    string_forcing,
)
from asymptotics.rings.numbers import digits

EPS = float(np.finfo(float).eps)


def laurent(
    p: int, q: int, order: int, beta: float, driven_end: str = "pinned", points: int = 64
) -> Callable[[int, int], Any]:
    """(n, k) ↦ the coefficient of μ^{−k} in ξ_{n,q} at Ω_p/q: the engine on a circle in Ω.

    Another way to the amplitude equation than the reduced one, the poles of the plain expansion: at
    the working precision of mpmath, M points and a radius R/4, R the distance to the next pole
    of the expansion: the discrete Fourier transform is off by 4^{−M}, 3e-39 for M = 64.
    """
    numbers = digits()
    shape = static_beam(beta, driven_end, numbers)
    start = linear_frequencies(beta, order * p // q + 2, driven_end)

    def determinant(rate: Any) -> Any:
        wave = waves(shape, rate, numbers)
        (c1, c2), (d1, d2) = (
            wave.end(-1, -wave.p, 1, 0),
            wave.end(-wave.decay, wave.p * wave.decay, 0, 1),
        )
        return c1 * d2 - d1 * c2

    old, new = (start[p - 1] * mpmath.mpf(1 + side * 1e-12) for side in (-1, 1))
    for _ in range(12):  # the secant's, until rounding leaves no difference
        rise = determinant(new) - determinant(old)
        if rise:
            old, new = new, new - determinant(new) * (new - old) / rise
    centre = new / q
    gaps = abs(start[:, None] / np.arange(1, order + 1) - float(centre))
    gaps[p - 1, q - 1] = float(centre)
    radius = mpmath.mpf(gaps.min()) / 4
    values = []
    for i in range(points // 2 + 1):  # the other half is the conjugate
        turn = mpmath.expjpi(mpmath.mpf(2 * i) / points)
        solution = expand(
            beam_problem(beta, centre + radius * turn, driven_end, numbers, shape), order
        )
        values.append((turn, solution))

    def coefficient(n: int, k: int) -> Any:
        total = mpmath.mpf(0)
        for i, (turn, solution) in enumerate(values):
            term = (2 * solution.contact(n)[q] * turn**k).real
            total += term * (1 if i in (0, points // 2) else 2)
        return total / points * radius**k

    return coefficient


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


@pytest.mark.slow
@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("q", [2, 3])
def test_alpha_is_the_mode_s_own(q: int, driven_end: str) -> None:
    """From order 3q at Ω₁/q as from order 3 at Ω₁: ξ_{3q,q} = (αF³ + γ^qF [q = 3])/(qμ)⁴ + …

    At q = 3 the shift contributes γ³F ε⁹/(3μ)⁴ to the same pole.
    """
    equation = amplitude_equation(1, q, 0.01, driven_end)
    F, gamma = equation.F.value, equation.gamma
    assert gamma is not None
    with mpmath.workdps(30):
        value = laurent(1, q, 3 * q, 0.01, driven_end, 32)(3 * q, 4)
    shift = gamma.value**3 * F if q == 3 else 0.0
    found = float((q**4 * value - shift) / F**3)
    assert found == pytest.approx(equation.alpha.value, rel=1e3 * EPS)
    assert abs(equation.alpha.value) > 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "q", "beta", "driven_end"),
    [
        (1, 1, 0.01, "clamped"),
        (2, 3, 0.01, "clamped"),
        (1, 2, 1.0, "pinned"),
        (2, 3, 1e-8, "pinned"),
        (1, 3, 1e-10, "pinned"),
        (1, 3, 1e-10, "clamped"),
        (1, 2, 1e-14, "pinned"),
        (1, 2, 1e8, "pinned"),
    ],
)
def test_errors_hold_at_the_edges(p: int, q: int, beta: float, driven_end: str) -> None:
    """Against 60 to 90 digits on a circle, where close poles and weak bending cost doubles all."""
    found = amplitude_equation(p, q, beta, driven_end)
    with mpmath.workdps(90):
        first = laurent(p, 1, 3, beta, driven_end)
        wanted = {"alpha": first(3, 4) / first(1, 1) ** 3}
        near = first if q == 1 else laurent(p, q, q + 2, beta, driven_end)
        wanted["F"] = q * near(q, 1)
        if q > 1:
            wanted["gamma"] = q * near(q + 2, 2) / near(q, 1)
        for name, value in wanted.items():
            got = getattr(found, name)
            # 1e-30: the circle itself.
            assert abs(got.value - value) <= got.error + abs(value) * mpmath.mpf(10) ** -30, name
            assert 0 < got.error <= EPS * abs(got.value)


def test_the_bound_on_the_coefficient_counts_both_errors() -> None:
    """C ∝ (|F| √|α|)^{−1/q}: a tenth of a per cent in F, or two in α, is 0.05 % at q = 2."""
    plain = amplitude_equation(1, 2, 0.01)
    for name, share in (("F", 1e-3), ("alpha", 2e-3)):
        value = getattr(plain, name).value
        wide = dataclasses.replace(plain, **{name: FoldCoefficient(value, share * abs(value))})
        bound = wide.coefficient.error / wide.coefficient.value
        assert bound == pytest.approx(5e-4, rel=1e-9)
        moved = dataclasses.replace(plain, **{name: FoldCoefficient(value * (1 - share), 0.0)})
        change = moved.coefficient.value / plain.coefficient.value - 1
        assert change == pytest.approx(bound, rel=2e-3)
    assert 0 < plain.coefficient.error < 8 * EPS * plain.coefficient.value


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (1, 2), (3, 2), (1, 3), (2, 3)])
def test_F_holds_against_small_detunings(p: int, q: int, driven_end: str) -> None:
    """qμ ξ_{q,q} → F at a rate μ: Richardson's extrapolation from real detunings, no circle."""
    result = amplitude_equation(p, q, 0.02, driven_end)
    sizes = [1e-3 * result.resonance / 2**k for k in range(4)]
    table = []
    for mu in sizes:
        values = [
            q
            * m
            * 2
            * expand(beam_problem(0.02, result.resonance + m, driven_end), q).contact(q)[q]
            for m in (mu, -mu)
        ]
        table.append(sum(values) / 2)  # even in μ: errors μ², μ⁴, …
    for k in range(1, 4):
        table = [(4**k * b - a) / (4**k - 1) for a, b in pairwise(table)]
    # The pole's place is known to 2 ulp, which μ = 1e-4 Ω amplifies.
    assert table[0] == pytest.approx(result.F.value, rel=1e5 * EPS)


@pytest.mark.slow
def test_order_and_place_of_the_poles() -> None:
    """ξ_{n,q} has the pole the amplitude equation says, and none of the next order."""
    with mpmath.workdps(30):
        for q, n, pole in ((1, 1, 1), (1, 3, 4), (2, 2, 1), (2, 4, 2), (3, 3, 1), (3, 5, 2)):
            near = laurent(1, q, n, 0.01, points=32)
            assert abs(near(n, pole)) > 1e-3
            for beyond in (1, 2):
                assert abs(near(n, pole + beyond)) < 1e-12


@pytest.mark.slow
def test_the_series_in_epsilon_ends_at_the_fold() -> None:
    """ξ_{n,1} at fixed μ is a series in ε² whose branch point is the fold, up to O(μ).

    At a square root coefficients grow as ε_f^{−2m} m^{−3/2}: the ratio, extrapolated twice in 1/m,
    is 1/ε_f². Nothing of the Laurent expansion enters.
    """
    law = amplitude_equation(1, 1, 0.01)
    deviations = []
    for mu in (-0.02, -0.01, -0.005):
        series = expand(beam_problem(0.01, law.resonance + mu), 25)
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
    equation = amplitude_equation(p, q, 0.01)
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


def equation(q: int, kappa: float, gamma: float | None, alpha: float = -4.0, p: int = 1) -> Fold:
    """A made amplitude equation with the given κ (of α's sign) and γ."""
    F = math.sqrt(4 * kappa**3 / (27 * alpha))
    exact = [FoldCoefficient(x, 0.0) for x in (F, alpha)]
    shift = None if gamma is None else FoldCoefficient(gamma, 0.0)
    return Fold(p, q, 0.01, "pinned", 1.0, *exact, shift, -1.0)


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (1, 3), (2, 3), (1, 4), (3, 5)])
def test_epsilon_inverts_detuning(p: int, q: int) -> None:
    found = amplitude_equation(p, q, 0.01)
    epsilon = np.array([1e-12, 1e-4, 1e-3, 1e-2, 0.05])
    mu = found.detuning(epsilon)
    assert found.epsilon(mu) == pytest.approx(epsilon, rel=1e-13)
    assert found.epsilon(float(mu[2])).shape == ()
    assert np.isnan(found.epsilon(-mu)).all()
    assert np.isnan(found.epsilon(0.0))


@pytest.mark.parametrize(
    ("q", "kappa", "gamma"),
    [
        (2, -2.0, 0.9),
        (2, -1.0, 2.0),
        (4, -1.0, 0.9),
        (4, -3.0, 0.5),
        (5, -8.0, 0.5),
        (3, -1.0, 2.0),
    ],
)
def test_epsilon_ends_where_the_law_turns_round(q: int, kappa: float, gamma: float) -> None:
    """γ against κ: μ(ε) has a turning point, and ε is the first branch up to it, or to ε = 1."""
    made = equation(q, kappa, gamma)
    fine = np.linspace(0, 1, 200_001)[1:]
    mu = made.detuning(fine)
    top = int(np.argmax(mu * made.mu_sign))
    found = made.epsilon(mu[:top:500])
    assert found == pytest.approx(fine[:top:500], rel=1e-6)
    beyond = mu[top] * np.array([1 + 1e-9, 1.5])
    assert np.isnan(made.epsilon(beyond)).all()


@pytest.mark.parametrize("q", [1, 2, 3, 4])
def test_the_driven_end_touches_down_at_one(q: int) -> None:
    """q qμ = S(1) is the last fold there is."""
    made = equation(q, -0.5, None if q == 1 else -0.25)
    last = float(made.detuning(1.0))
    assert made.epsilon(last * (1 - 1e-12)) == pytest.approx(1.0, rel=1e-11)
    assert np.isnan(made.epsilon(last * (1 + 1e-12)))


@pytest.mark.parametrize(
    ("q", "kappa", "gamma", "kind"),
    [
        (1, -1.0, None, Kind.END),
        (1, 1.0, None, Kind.END),
        (2, -1.0, 5.0, Kind.END),
        (2, 1.0, -5.0, Kind.END),
        (3, -1.0, 0.9, Kind.END),
        (3, -1.0, 1.1, Kind.BIRTH),
        (3, 1.0, -0.9, Kind.END),
        (3, 1.0, -1.1, Kind.BIRTH),
        (3, 1.0, 7.0, Kind.END),
        (4, -1.0, 0.1, Kind.BIRTH),
        (4, -1.0, -0.1, Kind.END),
        (4, 1.0, 0.1, Kind.END),
        (5, 1.0, -0.1, Kind.BIRTH),
    ],
)
def test_kinds_by_the_roots_of_the_cubic(
    q: int, kappa: float, gamma: float | None, kind: Kind
) -> None:
    """States counted on both sides of the fold in ε, and in μ; nothing of the condition is used."""
    made = equation(q, kappa, gamma, math.copysign(4.0, kappa))
    F, alpha = made.F.value, made.alpha.value

    def states(mu: float, epsilon: float) -> list[float]:
        M = q * mu - (gamma or 0.0) * epsilon**2
        roots = np.roots([alpha, 0.0, -M, F * epsilon**q])
        return sorted(roots.real[abs(roots.imag) < 1e-9 * abs(roots).max()])

    epsilon = 0.02
    mu = float(made.detuning(epsilon))
    before, after = (len(states(mu, epsilon * x)) for x in (0.99, 1.01))
    assert (before, after) == ((3, 1) if kind is Kind.END else (1, 3))
    assert made.kind is kind
    # The state of the lowest amplitude at rest is the one that ends, or is the only one before.
    assert states(mu, 1e-9)[1 if kind is Kind.END else 0] == pytest.approx(0, abs=1e-8)
    # On either kind the sweep in μ leaves three states on the side of α's sign.
    inner, outer = (len(states(mu + made.sign * d * abs(mu), epsilon)) for d in (-0.02, 0.02))
    assert (inner, outer) == (1, 3)
    # And there the middle one is what merges: it is small far away.
    assert made.amplitude(epsilon) == pytest.approx(
        states(mu + made.sign * 1e-8 * abs(mu), epsilon)[1], rel=1e-2
    )


def test_the_folds_that_end_nothing() -> None:
    """At β = 0.01, pinned, of q ≤ 5 and Ω_p/q up to 7/3."""
    births = {"1/3", "7/3", "1/4", "3/4", "5/4", "1/5", "3/5", "6/5", "7/5"}
    ends = {"1/1", "2/1", "1/2", "3/2", "2/3", "4/3", "5/3", "2/5", "4/5"}
    for name in births | ends:
        p, q = map(int, name.split("/"))
        kind = amplitude_equation(p, q, 0.01).kind
        assert kind is (Kind.BIRTH if name in births else Kind.END), name


def test_powers_of_the_detuning() -> None:
    """Local exponents dln ε/dln|μ| as μ → 0: 3/2, 3/4, ½ in μ; for q = 4 only M has a power."""
    for q, exponent in ((1, 1.5), (2, 0.75), (3, 0.5)):
        equation = amplitude_equation(1, q, 0.01)
        mu = equation.mu_sign * np.array([1e-9, 1e-10])
        epsilon = equation.epsilon(mu)
        local = math.log(epsilon[0] / epsilon[1]) / math.log(10)
        # q = 2: the shift's share is γε²/(2μ) ∝ |μ|^{1/2}, 2e-5 here.
        assert local == pytest.approx(exponent, abs=1e-4)
        if q != 2:
            assert epsilon[0] == pytest.approx(
                abs(equation.coefficient_in_detuning or 0.0) * 1e-9**exponent, rel=1e-9
            )
    fourth = amplitude_equation(1, 4, 0.01)
    assert fourth.coefficient_in_detuning is None
    # The shift decides the side in μ, against the side in M.
    assert fourth.sign < 0 < float(fourth.detuning(1e-3))


def test_the_third_resonance_folds_on_the_other_side() -> None:
    """At β = 0.01, q = 3: γ and (27αF²/4)^{1/3} nearly cancel, and the sum is positive."""
    equation = amplitude_equation(1, 3, 0.01)
    assert equation.side == "below"
    assert float(equation.detuning(0.01)) > 0
    assert equation.coefficient_in_detuning == pytest.approx(9.30826, abs=1e-5)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("p", [1, 2])
def test_limit_of_weak_bending(p: int, driven_end: str) -> None:
    """α → −1/(12pπβ), C_{p,1} → (8/3)√(β/(pπ)): both corrections are of order √β."""
    beta = np.array([1e-5, 1e-7, 1e-9])
    found = [amplitude_equation(p, 1, value, driven_end) for value in beta]
    F, alpha = (np.array([getattr(f, name).value for f in found]) for name in ("F", "alpha"))
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
    first, second = amplitude_equation(p, q, 1e-5), amplitude_equation(p, q, 1e-7)
    exponent = math.log(first.coefficient.value / second.coefficient.value) / math.log(100)
    assert exponent == pytest.approx(1 / (2 * q), abs=0.005)
    scale = (4 * q**1.5 * math.sqrt(p * math.pi * 1e-7) / (3 * abs(second.string_F))) ** (1 / q)
    assert second.coefficient.value == pytest.approx(scale, rel=0.01)


def test_the_string_s_law() -> None:
    """ε = μ²/(8p²) for q = 1 and ε = 4|μ|/π for p/q = 1/2; met at the crossover."""
    for p in (1, 2, 3):
        assert amplitude_equation(p, 1, 0.01).string_epsilon(0.1) == pytest.approx(
            0.01 / (8 * p * p), rel=1e-12
        )
    half = amplitude_equation(1, 2, 1e-3)
    assert half.string_epsilon(-0.1) == pytest.approx(0.4 / math.pi, rel=1e-12)


def test_json() -> None:
    fields = json.loads(json.dumps(fold(1, 2, 0.01).as_json(), allow_nan=False))
    assert fields["command"] == "fold"
    assert (fields["p"], fields["q"], fields["exponent"], fields["side"]) == (1, 2, "3/4", "below")
    assert fields["variable"] == "mu - gamma*epsilon**2/2"
    assert fields["coefficient_in_mu"] is None
    assert [term["exponent"] for term in fields["mu_of_epsilon"]] == ["4/3", "2"]
    epsilon = 0.01
    mu = sum(
        t["coefficient"] * epsilon ** float(Fraction(t["exponent"]))
        for t in fields["mu_of_epsilon"]
    )
    assert mu == pytest.approx(float(amplitude_equation(1, 2, 0.01).detuning(epsilon)), rel=1e-14)
    assert 0 < fields["errors"]["coefficient"] < 1e-14
    assert fields["kind"] == "end"
    assert 0.02 < fields["range"]["mu"] < 0.05
    assert 0.02 < fields["range"]["error"] <= 0.1
    assert "order 7" in fields["reason"]
    birth = amplitude_equation(1, 3, 0.01).as_json()
    assert birth["kind"] == "birth"
    assert (birth["side"], birth["side_in_mu"]) == ("below", "above")
    assert "passes through" in birth["meaning"][0]
    assert "sweeping Omega up from far below" in birth["meaning"][1]
    assert amplitude_equation(1, 1, 0.01).as_json()["gamma"] is None
    assert amplitude_equation(1, 4, 0.01).as_json()["variable"] == "mu - gamma*epsilon**2/4"


@pytest.mark.parametrize("beta", [1e-300, 1e-100, 1e-12, 1e5, 1e100, 1e308])
def test_absurd_stiffness_gives_numbers(beta: float) -> None:
    """No bound on β: as β → 0 C_{1,1} = (8/3)√(β/π), as β → ∞ it has a limit."""
    found = amplitude_equation(1, 1, beta)
    json.loads(json.dumps(found.as_json(), allow_nan=False))
    limit = 8 / 3 * math.sqrt(beta / math.pi) if beta < 1 else 0.115843743619
    assert found.coefficient.value == pytest.approx(limit, rel=1e-2 if beta < 1e6 else 1e-9)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2, 2, 0.01), "ask for 1/1"),
        ((0, 1, 0.01), "p = 0"),
        ((1, 1.5, 0.01), "q = 1.5"),
        ((True, 1, 0.01), "p = True"),
        ((1, 1, 0.0), "for β = 0 use the string"),
        ((1, 1, -1.0), "beta = -1.0"),
        ((1, 1, math.nan), "beta = nan"),
        ((1, 1, 0.01, "free"), "choose one of pinned, clamped"),
        ((1, 1, 5e-324), "leave the range of double precision"),
        ((1001, 1, 0.01), "give p <= 1000"),
        ((1, LARGEST_Q + 1, 0.01), f"give q <= {LARGEST_Q}"),
    ],
)
def test_bad_input(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        fold(*arguments)  # type: ignore[arg-type]
