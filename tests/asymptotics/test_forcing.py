"""Any Fourier drive: the paper's cosine, the linear theory, time shifts, and the exact string."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

from asymptotics import (
    Expansion,
    exact_string,
    expand,
    float_string,
    moving_frame,
    prove,
    string_problem,
)
from asymptotics.errors import InputError, OrderingError, ResonanceError
from asymptotics.expansion.proof import RefutedError, residuals
from asymptotics.problems.forcing import (
    FourierDrive,
    excited,
    forced_string,
    fourier_drive,
)
from asymptotics.problems.forcing_generators import generator_string, generator_values
from asymptotics.rings.cotangent import CotangentRing
from asymptotics.rings.harmonics import pack, unpack
from asymptotics.rings.ring import ComplexRing, GeneratorRing
from asymptotics.values.evaluate import evaluate
from asymptotics.values.linear_response import contact_response_spectrum
from asymptotics.values.response import response

EPS = 2.0**-52
ORDER = 5
PHASED = fourier_drive([0.83], {1: 0.8, 3: 0.3, 0: 0.2}, {1: 0.6, 2: -0.4})
TWO = fourier_drive([0.83, 1.31], {(1, 0): 0.7, (0, 1): 0.4}, {(0, 1): 0.5, (1, -1): 0.3})
DRIVES = [PHASED, TWO]


def rounding(expansion: Expansion, n: int) -> float:
    """A scale for order n's rounding: N³ products of the orders below enter it, each relative to
    the largest contact or shape coefficient of some order up to n."""
    sizes = [1.0]
    for k in range(1, n + 1):
        sizes += [abs(c) for c in expansion.contact(k).values()]
        sizes += [abs(x) for row in expansion.shape(k).values() for x in row]
    return expansion.order**3 * EPS * max(sizes)


def test_one_cosine_is_the_papers_drive() -> None:
    omega, order = 2.2, 8
    old = expand(float_string(omega, order), order)
    new = expand(forced_string(fourier_drive([omega], {1: 1.0}), order), order)
    for n in range(1, order + 1):
        assert new.contact(n).keys() == old.contact(n).keys()
        for j, c in old.contact(n).items():
            scaled = c / math.sin(omega) ** n
            assert abs(new.contact(n)[j] - scaled) <= rounding(new, n)
            assert n != j or abs(scaled) > 1e3 * rounding(new, n)


@pytest.mark.parametrize("drive", DRIVES)
def test_the_linear_order_is_the_linear_response(drive: FourierDrive) -> None:
    tau = np.linspace(0, 9, 23)
    rates, amplitudes = [], []
    for j, c in drive.amplitudes.items():
        rates += [drive.rate(j)[0], -drive.rate(j)[0]] if j else [0.0]
        amplitudes += [c, np.conj(c)] if j else [c]
    expected = contact_response_spectrum(rates, amplitudes, tau)
    assert abs(expected.imag).max() <= 8 * EPS
    small = 1e-6
    found = response(expand(forced_string(drive, 1), 1), drive.phase, small, [], tau)
    # ξ_c − 1 is known to a rounding of 1.
    assert abs((found.contact - 1) / small - expected.real).max() <= 8 * EPS / small
    assert abs(expected.real).max() > 0.5


@pytest.mark.parametrize("drive", DRIVES)
def test_a_delayed_drive_gives_the_delayed_state(drive: FourierDrive) -> None:
    """Every order, every harmonic: ξ_{n,j} e^{−ijΩt}."""
    time = 0.7
    here = expand(forced_string(drive, ORDER), ORDER)
    later = expand(forced_string(drive.delayed(time), ORDER), ORDER)
    for n in range(1, ORDER + 1):
        assert later.contact(n).keys() == here.contact(n).keys()
        for j, c in here.contact(n).items():
            turned = c * np.exp(-1j * drive.rate(j)[0] * time)
            assert abs(later.contact(n)[j] - turned) <= rounding(here, n)
    odd = [abs(c.imag) for c in here.contact(ORDER).values()]
    assert max(odd) > 1e-3


def test_the_drive_itself() -> None:
    tau = np.linspace(0, 5, 11)
    x, y = 0.83 * tau, 1.31 * tau
    expected = 0.7 * np.cos(x) + 0.4 * np.cos(y) + 0.5 * np.sin(y) + 0.3 * np.sin(x - y)
    np.testing.assert_allclose(TWO(tau), expected, atol=8 * EPS)
    np.testing.assert_allclose(TWO.delayed(0.4)(tau), TWO(tau - 0.4), atol=8 * EPS)
    np.testing.assert_allclose(PHASED(0.0), 0.8 + 0.3 + 0.2, atol=8 * EPS)


def test_a_negative_index_is_the_reflected_one() -> None:
    """cos(−θ) = cos θ, sin(−θ) = −sin θ."""
    forward = fourier_drive([0.8, 1.3], {(1, -1): 0.5}, {(1, -1): 0.25})
    backward = fourier_drive([0.8, 1.3], {(-1, 1): 0.5}, {(-1, 1): -0.25})
    assert forward == backward
    assert forward.amplitudes[pack((1, -1))] == 0.25 - 0.125j


def merged(expansion: Expansion, ratio: int) -> list[dict[int, complex]]:
    """Order by order, the harmonics (n₁, n₂) of Ω and ratio·Ω summed to n₁ + ratio n₂."""
    orders = []
    for n in range(1, expansion.order + 1):
        total: dict[int, complex] = {}
        for j, c in expansion.contact(n).items():
            first, second = unpack(j, 2)
            index = first + ratio * second
            sides = [(index, c)] if j == 0 else [(index, c), (-index, np.conj(c))]
            for i, value in sides:
                if i >= 0:
                    total[i] = total.get(i, 0) + value
        orders.append(total)
    return orders


@pytest.mark.parametrize("ratio", [2, 3])
def test_commensurate_frequencies_as_two_or_as_one(ratio: int) -> None:
    """Combinations that are no motion at all, as (2, −1) for Ω₂ = 2Ω₁, behave as the mean."""
    omega = 0.75  # its multiples are doubles
    pair = fourier_drive([omega, ratio * omega], {(1, 0): 0.6, (0, 1): 0.3}, {(0, 1): 0.5})
    single = fourier_drive([omega], {1: 0.6, ratio: 0.3}, {ratio: 0.5})
    both = expand(forced_string(pair, ORDER), ORDER)
    one = expand(forced_string(single, ORDER), ORDER)
    assert any(pair.rate(j)[0] == 0 and j for j in excited(list(pair.amplitudes), ORDER))
    for n, harmonics in enumerate(merged(both, ratio), start=1):
        known = one.contact(n)
        for j in known.keys() | harmonics.keys():
            assert abs(harmonics.get(j, 0) - known.get(j, 0)) <= rounding(both, n)
        assert max(abs(c) for c in known.values()) > 1e3 * rounding(both, n)


@pytest.mark.parametrize("drive", DRIVES)
def test_residuals_are_roundings(drive: FourierDrive) -> None:
    solution = expand(forced_string(drive, ORDER), ORDER)
    frame = moving_frame(solution)
    top = max(drive.rate(j)[0] for j in excited(list(drive.amplitudes), ORDER))
    for n in range(1, ORDER + 1):
        # The PDE is checked on up to N + 2 derivatives, each a power of the fastest rate.
        bound = rounding(solution, n) * max(1.0, top) ** (ORDER + 3 - n)
        left = list(residuals(solution, frame, n))
        assert max(map(abs, left)) <= bound
        assert len(left) > 4


def test_a_shift_of_the_mean_height_is_the_static_shape_of_another_height() -> None:
    """ΔZ = 1: W₀ scaled to the height 1 + ε, ξ_c = √(1 + ε)."""
    drive = fourier_drive([0.83], {0: 1.0})
    solution = expand(forced_string(drive, 6), 6)
    binomial = 1.0
    for n in range(1, 7):
        binomial *= (1.5 - n) / n
        assert solution.contact(n) == {0: pytest.approx(binomial, rel=64 * EPS)}


# -- the exact string ------------------------------------------------------------------------------


def inverse(function: Callable, target: np.ndarray, guess: np.ndarray) -> np.ndarray:
    """τ with τ + function(τ) = target; |function′| < 0.05 here, so each step gains a digit."""
    tau = guess
    for _ in range(16):
        tau = target - function(tau)
    return tau


def characteristics_residuals(
    drive: FourierDrive, order: int, epsilon: float
) -> tuple[float, float]:
    """What the truncated ξ_c leaves of the exact string's two conditions (means, at 25 times).

    With W = ξ² + f(τ − ξ) + g(τ + ξ): f′ = ξ_c at τ − ξ_c, so h(τ − ξ_c) = τ + ξ_c returns the
    characteristic, and h(t) − 2t + h⁻¹(t) = 2Z′(t); and f(h(u)) − f(u) = ξ_c² + Z(h(u)).
    """
    solution = expand(forced_string(drive, order), order)

    def place(tau: np.ndarray) -> np.ndarray:
        total = np.ones_like(tau)
        for n in range(1, order + 1):
            for j, c in solution.contact(n).items():
                wave = np.real(c * np.exp(1j * drive.phase(j, tau)))
                total += epsilon**n * (2 if j else 1) * wave
        return total

    def speed(tau: np.ndarray) -> np.ndarray:
        total = np.zeros_like(tau)
        for n in range(1, order + 1):
            for j, c in solution.contact(n).items():
                wave = np.real(1j * drive.rate(j)[0] * c * np.exp(1j * drive.phase(j, tau)))
                total += epsilon**n * (2 if j else 1) * wave
        return total

    t = np.linspace(0, 11, 25)
    leaves = inverse(lambda x: -place(x), t, t + 1)  # t = τ − ξ_c(τ)
    arrives = inverse(place, t, t - 1)
    rate = sum(
        -2 * epsilon * drive.rate(j)[0] * np.imag(c * np.exp(1j * drive.phase(j, t)))
        for j, c in drive.amplitudes.items()
    )
    map_residual = place(leaves) - place(arrives) - rate
    back = t + 2 * place(leaves)
    next_leaves = inverse(lambda x: -place(x), back, back + 1)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half = (next_leaves - leaves) / 2
    grid = leaves[:, None] + half[:, None] * (1 + nodes)
    integral = half * ((place(grid) * (1 - speed(grid))) @ weights)
    height_residual = integral - place(leaves) ** 2 - 1 - epsilon * drive(back)
    return float(np.sqrt(np.mean(map_residual**2))), float(np.sqrt(np.mean(height_residual**2)))


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("drive", DRIVES)
def test_the_exact_strings_map_is_satisfied_to_the_order_kept(
    drive: FourierDrive, order: int
) -> None:
    """Quasi-periodic or not: both residuals fall like ε^{N+1}; a wrong order would leave ε^N.

    Successive halvings of ε change the measured slope by O(ε); 0.25 tells N + 1 from N.
    """
    amplitudes = [2.0**-k / 64 for k in range(3)]
    found = np.array([characteristics_residuals(drive, order, e) for e in amplitudes])
    assert found.min() > 64 * EPS  # above the rounding of quantities of size one
    slopes = np.log2(found[:-1] / found[1:])
    assert abs(slopes[-1] - (order + 1)).max() < 0.25


# -- exact rings -----------------------------------------------------------------------------------


def test_generators_prove_themselves_and_equal_the_numbers() -> None:
    for drive, harmonics in ((PHASED, [0, 1, 2, 3]), (TWO, [(1, 0), (0, 1), (1, -1)])):
        exact = expand(generator_string(harmonics, 3), 3)
        assert all(proof.holds for proof in prove(exact))
        ring = exact.problem.ring
        assert isinstance(ring, GeneratorRing)
        values = generator_values(drive, 3)
        numbers = expand(forced_string(drive, 3), 3)
        for n in range(1, 4):
            assert exact.contact(n).keys() == numbers.contact(n).keys()
            for j, element in exact.contact(n).items():
                found = ring.evaluate(element, values, ComplexRing())
                assert abs(found - numbers.contact(n)[j]) <= rounding(numbers, n)


def test_generators_carry_the_harmonic_index() -> None:
    """A time shift turns A_n by a phase: each monomial of harmonic j has Σ n (a_n − ā_n) = j."""
    exact = expand(generator_string([1, 2], 4), 4)
    weights = [
        (-1 if name.endswith("_") else 1) * int(name.strip("A_")) if name[0] == "A" else 0
        for name in exact.problem.ring.names
    ]
    for n in range(1, 5):
        for j, element in exact.contact(n).items():
            for powers, _ in element.terms():
                assert sum(w * int(p) for w, p in zip(weights, powers, strict=True)) == j


def test_generators_specialise_to_the_cotangent_ring() -> None:
    """κ_j ↦ cot jΩ, A₁ ↦ ½ gives the exact string, identically in Ω."""
    exact, ring = expand(exact_string(), 5), CotangentRing()
    general = expand(generator_string([1], 5, sines=False), 5)
    values = {f"k{j}": ring.cot(j) for j in range(1, 6)}
    values |= {"Omega": ring.omega, "A1": ring.rational(1, 2)}
    for n in range(1, 6):
        assert general.contact(n).keys() == exact.contact(n).keys()
        for j, element in general.contact(n).items():
            assert general.problem.ring.evaluate(element, values, ring) == exact.contact(n)[j]


def test_several_scaled_harmonics_are_exact_in_the_cotangent_ring() -> None:
    """ΔZ = sin Ω cos θ + ½ sin 2Ω cos 2θ: proved identically in Ω, the resonances resolved."""
    ring = CotangentRing()
    drive = {1: ring.rational(1, 2), 2: ring.rational(1, 4)}
    solution = expand(
        string_problem(ring, ring.omega, ring.cot, name="two harmonics", drive=drive), 4
    )
    proofs = prove(solution)
    assert all(proof.holds for proof in proofs)
    assert [len(proof.harmonics) for proof in proofs] == [1, 2, 5, 7, 9]
    assert solution.problem.mode(2).source[1] == ring.rational(-2) * ring.omega


def test_a_wrong_amplitude_is_refuted() -> None:
    exact = expand(generator_string([1, 2], 2), 2)
    ring = exact.problem.ring
    exact.problem.drive[2] = ring["A1"]  # type: ignore[index]
    with pytest.raises(RefutedError) as caught:
        prove(exact)
    assert not caught.value.proofs[1].driven_end


# -- fields and errors -----------------------------------------------------------------------------


def test_the_response_is_that_of_evaluate_and_meets_the_driven_end() -> None:
    s, tau = np.linspace(-0.98, 0, 9), np.linspace(0, 5, 7)
    drive = fourier_drive([0.83], {1: 1.0})
    solution = expand(forced_string(drive, 6), 6)
    found = response(solution, drive.phase, 0.03, s, tau)
    known = evaluate(0.83, 0.03, 6, s, tau)
    np.testing.assert_allclose(found.contact, known.contact, rtol=64 * EPS)
    np.testing.assert_allclose(found.profile, known.profile, rtol=1e3 * EPS, atol=64 * EPS)
    assert found.as_json()["order"] == 6
    for drive in DRIVES:
        leftover = []
        for epsilon in (0.02, 0.01):
            solution = expand(forced_string(drive, ORDER), ORDER)
            state = response(solution, drive.phase, epsilon, [], tau)
            ends = response(solution, drive.phase, epsilon, -state.contact[:, None], tau).profile[
                :, 0
            ]
            leftover.append(np.sqrt(np.mean((ends - 1 - epsilon * drive(tau)) ** 2)))
        # Profile and position are truncated separately: what is left is of order N + 1.
        assert abs(np.log2(leftover[0] / leftover[1]) - (ORDER + 1)) < 0.3


@pytest.mark.parametrize(
    ("frequencies", "cosines", "message"),
    [
        ([], {1: 1.0}, "frequencies is empty"),
        ([-1.0], {1: 1.0}, "must be positive"),
        ([0.8], {(1, 2): 1.0}, "harmonic index"),
        ([0.8, 0.9], {1: 1.0}, "harmonic index 1: give 2 whole"),
        ([0.8], {1.5: 1.0}, "harmonic index"),
        ([0.8], {1: math.nan}, "amplitude nan"),
        ([0.8], {1: "x"}, "amplitude 'x'"),
        ([0.8], {1: 0.0}, "the drive is zero"),
    ],
)
def test_bad_drives(frequencies: list, cosines: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        fourier_drive(frequencies, cosines)


def test_resonances_are_those_the_drive_excites() -> None:
    with pytest.raises(ResonanceError, match="p/q = 1/2") as caught:
        forced_string(fourier_drive([math.pi / 2], {1: 1.0}), 2)
    assert (caught.value.p, caught.value.q) == (1, 2)
    forced_string(fourier_drive([math.pi / 2], {1: 1.0}), 1)
    # Even harmonics alone never excite odd ones.
    forced_string(fourier_drive([math.pi / 3], {2: 1.0}), 2)
    with pytest.raises(ResonanceError, match="n = 1, 1 has"):
        forced_string(fourier_drive([1.0, math.pi - 1.0], {(1, 0): 1.0, (0, 1): 1.0}), 2)


def test_a_lost_ordering_is_refused() -> None:
    drive = fourier_drive([3.0], {1: 1.0})
    with pytest.raises(OrderingError, match="too large for order 4"):
        response(expand(forced_string(drive, 4), 4), drive.phase, 0.2, [], [0.0])


def test_bad_generators() -> None:
    with pytest.raises(InputError, match="repeat"):
        GeneratorRing(["a", "a"])
    with pytest.raises(InputError, match="no involution"):
        GeneratorRing(["a", "b"], {"a": (1, "b")})
    with pytest.raises(InputError, match="give each once"):
        generator_string([(0, -1)], 2)
    assert pack((1, -1)) > 0


@pytest.mark.parametrize("turns", [7.0, 7.5])
@pytest.mark.parametrize("near", [1e-7, -3e-6, 1e-3])
def test_cosine_and_sine_next_to_a_pole_and_a_zero(near: float, turns: float) -> None:
    """The rounding of n·Ω is put back; without it sin n·Ω loses digits."""
    drive = fourier_drive([(turns * math.pi + near) / 30, 0.1], {(1, 0): 1.0, (0, 1): 1.0})
    for index in ((30, 0), (30, 1), (60, 0)):
        packed = pack(index)
        x, c, s = drive.circular(packed)
        with mpmath.workdps(60):
            exact = sum(n * mpmath.mpf(f) for n, f in zip(index, drive.frequencies, strict=True))
            assert x == float(exact)
            assert abs(c - mpmath.cos(exact)) <= 4 * EPS * abs(mpmath.cos(exact))
            assert abs(s - mpmath.sin(exact)) <= 4 * EPS * abs(mpmath.sin(exact))
