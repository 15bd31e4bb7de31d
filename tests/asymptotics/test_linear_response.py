"""The linear response: proof by elimination, the wave equation itself, contours and resonance."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy
from sympy import I, exp

from asymptotics import ClosedForms, exact_string, expand
from asymptotics.errors import InputError, ResonanceError
from asymptotics.formulas.closed_form import symbols
from asymptotics.formulas.linear_response import (
    difference_equation,
    eliminate,
    harmonic_response,
    transfer_function,
)
from asymptotics.formulas.zero_test import are_equal
from asymptotics.values.linear_response import contact_response, contact_response_spectrum, transfer

NAMES = symbols()
OMEGA, TAU = NAMES["Omega"], NAMES["tau"]
UNIT = 2.0**-52


# -- exact ---------------------------------------------------------------------------------------


def test_elimination_is_proved_over_the_ring_of_shifts():
    solution = eliminate()
    ring = solution.determinant.context()
    shift, d, g, c = ring.gens()
    assert solution.holds
    assert all(r.is_zero() for r in solution.residuals)
    assert solution.difference == (g - g * shift**2, 2 * c * shift * d)
    # F = ΔZ/(1 − E²) and G = −E² F
    assert solution.forward * (1 - shift**2) == solution.determinant
    assert solution.backward == -(shift**2) * solution.forward
    # The three conditions once more, each as the paper writes it, times what clears 1/E and 1/c.
    f, b, x, one = solution.forward, solution.backward, solution.contact, solution.determinant
    assert (f + b - one).is_zero()
    assert (shift**2 * f + b).is_zero()
    assert (c * d * (-(shift**2) * f + b) + g * shift * x).is_zero()
    assert not (c * d * (shift**2 * f + b) + g * shift * x).is_zero()


def test_a_residual_refutes():
    solution = eliminate()
    wrong = replace(solution, residuals=(*solution.residuals[:2], solution.contact))
    assert not wrong.holds
    assert "REFUTED" in str(wrong)
    empty = replace(solution, determinant=solution.residuals[0])
    assert not empty.holds


def test_difference_equation_gives_the_transfer_function_on_exponentials():
    """x₁ = x₀ H e^{iωt} solves eq. (linear) for ΔZ = Z₀ e^{iωt} by eq. (leading), and only so."""
    g, c, x_0, omega = sympy.symbols("g c x_0 omega")
    height = g * x_0**2 / (2 * c**2)
    amplitude = x_0 * transfer_function().expression.subs(OMEGA, omega * x_0 / c)
    left, right = difference_equation().args
    drive = right.replace(sympy.Function("DeltaZ"), lambda u: height * exp(I * omega * u)).doit()
    for factor, solves in ((1, True), (-1, False), (2, False)):
        x_1 = left.replace(
            sympy.Function("x_1"), lambda u, f=factor: f * amplitude * exp(I * omega * u)
        )
        assert are_equal(x_1, drive) is solves


def test_dimensionless_factor_is_one():
    g, c, x_0 = sympy.symbols("g c x_0")
    height = g * x_0**2 / (2 * c**2)  # Z₀, eq. (leading)
    assert are_equal((2 * c / g) * height * (c / x_0) / x_0, 1)


def test_engine_agrees_at_first_order():
    forms = ClosedForms(expand(exact_string(), order=1))
    assert are_equal(forms.contact(1).expression, harmonic_response().expression)
    assert not are_equal(forms.contact(1).expression, 2 * harmonic_response().expression)
    assert harmonic_response().label == "linresponse1"
    assert transfer_function().label == "linresponse2"


# -- transfer ------------------------------------------------------------------------------------


def test_transfer_is_the_closed_form_at_any_frequency():
    omega = np.array([[-2.2, 1e-9, 0.3], [2.9, 4.0, 100.0]])
    closed = sympy.lambdify(OMEGA, transfer_function().expression, "mpmath")
    expected = [[float(closed(sympy.Float(float(v), 30))) for v in row] for row in omega]
    # one sine, one quotient: a few units of rounding
    assert transfer(omega) == pytest.approx(np.array(expected), rel=4 * UNIT)
    assert transfer(omega).shape == (2, 3)


def test_transfer_at_zero_is_the_static_change():
    assert transfer(0.0) == 0.5
    assert transfer(0) == 0.5
    assert transfer([0.0, -0.0, 5e-324, 1e-200]).tolist() == [0.5] * 4
    assert transfer(np.array([])).shape == (0,)
    assert transfer(0j) == 0.5


@pytest.mark.parametrize(
    ("omega", "p"),
    [
        (math.pi, 1),
        (-math.pi, 1),
        ([0.0, 1.0, 2 * math.pi], 2),
        (7 * math.pi * (1 + 1e-10), 7),
        (complex(math.pi, 1e-12), 1),
    ],
)
def test_transfer_names_the_resonance(omega, p):
    with pytest.raises(ResonanceError, match=f"p/q = {p}/1") as caught:
        transfer(omega)
    assert (caught.value.p, caught.value.q) == (p, 1)


@pytest.mark.parametrize("bad", [math.nan, [1.0, math.inf], "2.2", None, [[1.0], [1.0, 2.0]], 1e7])
def test_transfer_refuses(bad):
    with pytest.raises(InputError, match="omega") as caught:
        transfer(bad)
    assert not isinstance(caught.value, ResonanceError)


# -- any drive -----------------------------------------------------------------------------------


def ramped_sine(omega: float, ramp: float):
    """ΔZ and ΔZ′ of sin Ωτ under a ramp of length R, three times continuously differentiable."""

    def envelope(tau):
        x = np.minimum(tau / ramp, 1.0)
        return x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)

    def slope(tau):
        x = np.minimum(tau / ramp, 1.0)
        return 140 * (x * (1 - x)) ** 3 / ramp

    def drive(tau):
        return envelope(tau) * np.sin(omega * tau)

    def rate(tau):
        return slope(tau) * np.sin(omega * tau) + omega * envelope(tau) * np.cos(omega * tau)

    return drive, rate


def simulated_contact(drive, end: float, cells: int):
    """(τ, ξ₁) from w_ττ = w_ξξ, w(0) = ΔZ, w(1) = 0 by leapfrog, with 2ξ₁ = −w_ξ(1).

    At time step = cell the scheme is exact at the nodes. The slope is a central difference across
    ξ = 1, where w is odd: second order.
    """
    h = 1.0 / cells
    old, new = np.zeros(cells + 1), np.zeros(cells + 1)
    times, contact = [], []
    for step in range(1, round(end * cells) + 1):
        following = np.zeros(cells + 1)
        following[1:-1] = new[2:] + new[:-2] - old[1:-1]
        following[0] = drive(step * h)
        old, new = new, following
        times.append(step * h)
        contact.append(new[-2] / (2 * h))
    return np.array(times), np.array(contact)


@pytest.mark.parametrize("omega", [1.3, 2.9, 5.0])
def test_ramped_drive_against_the_wave_equation(omega):
    drive, rate = ramped_sine(omega, ramp=4.0)
    errors = []
    for cells in (50, 100):
        tau, simulated = simulated_contact(drive, end=12.0, cells=cells)
        errors.append(np.max(np.abs(simulated - contact_response(rate, tau))))
    assert errors[1] < 0.003
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.02)


def test_pulse_against_its_fourier_integral():
    """Eq. (linresponse2) along Im Ω = −1, below all poles: the causal contour."""
    length, power = 3.0, 12

    def drive(tau):
        return np.where((tau > 0) & (tau < length), np.sin(np.pi * tau / length) ** power, 0.0)

    def rate(tau):
        x = np.pi * tau / length
        inside = power * np.pi / length * np.sin(x) ** (power - 1) * np.cos(x)
        return np.where(tau < length, inside, 0.0)

    step, cut, depth = 0.1, 80.0, 1.0
    omega = np.arange(-cut, cut + step / 2, step) - 1j * depth
    nodes = np.linspace(0.0, length, 601)
    # A(Ω) = ∫ ΔZ e^{−iΩτ} dτ/2π; the trapezoidal rule is spectral for this smooth bump.
    transform = np.exp(-1j * np.outer(omega, nodes)) @ drive(nodes) * (nodes[1] / (2 * np.pi))
    tau = np.linspace(-2.0, 9.0, 45)
    integral = contact_response_spectrum(omega, transform * step, tau)
    exact = contact_response(rate, tau)
    assert np.max(np.abs(exact)) > 1.0
    # At the cut-off |A| is 3e-17; what remains is rounding, times e^τ ≤ 1e4.
    assert integral == pytest.approx(exact, abs=1e-10)
    # Above the poles the same integral is the anticausal solution: it must not agree.
    above = contact_response_spectrum(
        omega.conj(),
        np.exp(-1j * np.outer(omega.conj(), nodes)) @ drive(nodes) * step * nodes[1] / (2 * np.pi),
        tau,
    )
    assert np.max(np.abs(above - exact)) > 1.0


def test_transfer_far_from_the_real_axis():
    """Ω/(2 sin Ω) where sin Ω overflows, and on both sides of |Im Ω| = 1."""
    omega = np.array([1 + 1000j, 1 - 800j, 2 + 300j, -3 + 1.0001j, 3 - 0.9999j, -40j])
    with mpmath.workdps(30):
        for found, x in zip(transfer(omega), omega, strict=True):
            exact = mpmath.mpc(x) / (2 * mpmath.sin(mpmath.mpc(x)))
            assert abs(found - exact) <= 8 * UNIT * abs(exact) + 5e-324
    with pytest.raises(InputError, match="overflow"):
        contact_response_spectrum([1 - 500j], [1.0], [10.0])


def test_spectrum_of_a_real_drive():
    tau = np.linspace(0.0, 5.0, 12).reshape(3, 4)
    response = contact_response_spectrum([1.0, -1.0, 0.0, 2.5], [0.5, 0.5, 0.2, -1j], tau)
    expected = transfer(1.0) * np.cos(tau) + 0.1 - 1j * transfer(2.5) * np.exp(2.5j * tau)
    assert response.shape == (3, 4)
    assert response == pytest.approx(expected, rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("p", [1, 2, 3])
def test_growth_at_resonance(p):
    """ΔZ = sin pπτ from τ = 0: the amplitude grows by pπ per echo, pπ/2 per unit of τ."""
    omega = p * np.pi
    tau = np.linspace(1.0, 41.0, 4001)
    response = contact_response(lambda u: omega * np.cos(omega * u), tau)
    echoes = np.floor((tau - 1) / 2) + 1
    expected = omega * echoes * np.cos(omega * (tau - 1))
    away = np.abs((tau - 1) / 2 - np.rint((tau - 1) / 2)) > 1e-6  # the drive's start is a jump
    assert response[away] == pytest.approx(expected[away], abs=1e-9)
    peaks = [
        np.max(np.abs(response[(tau >= k + 0.01) & (tau < k + 1.99)])) for k in range(1, 41, 2)
    ]
    growth = np.polyfit(np.arange(1, 41, 2), peaks, 1)[0]
    assert growth == pytest.approx(omega / 2, rel=1e-9)
    # the residue of the transfer function predicts the same
    near = 1e-6
    assert abs(near * transfer(omega + near)) == pytest.approx(omega / 2, rel=1e-5)


def test_response_solves_its_difference_equation_and_is_causal():
    _, rate = ramped_sine(2.2, ramp=3.0)
    tau = np.linspace(2.0, 30.0, 141)
    left = contact_response(rate, tau) - contact_response(rate, tau - 2.0)
    assert left == pytest.approx(rate(tau - 1.0) * (tau >= 1.0), abs=1e-12)
    assert not np.any(contact_response(rate, np.linspace(-5.0, 0.99, 20)))


def test_after_a_ramp_the_steady_response_remains():
    """Ω/(2 sin Ω) sin Ωτ, up to what the ramp's ends excite: R⁻⁴ for three derivatives."""
    omega, errors = 2.2, []
    for ramp in (80.0, 160.0):
        _, rate = ramped_sine(omega, ramp)
        tau = np.linspace(ramp + 5.0, ramp + 15.0, 101)
        steady = transfer(omega) * np.sin(omega * tau)
        errors.append(np.max(np.abs(contact_response(rate, tau) - steady)))
    assert errors[1] < 1e-5
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def test_shapes_order_and_complex_rates():
    def rate(tau):
        return (1 + 2j) * tau

    tau = np.array([[5.5, 0.5], [3.0, 1.5]])
    expected = (1 + 2j) * np.array([[4.5 + 2.5 + 0.5, 0.0], [2.0, 0.5]])
    assert contact_response(rate, tau) == pytest.approx(expected)
    assert contact_response(rate, 3.0) == pytest.approx(2.0 + 4j)
    assert contact_response(rate, []).shape == (0,)


@pytest.mark.parametrize(
    ("rate", "tau", "message"),
    [
        (3.0, 1.0, "rate = 3.0 is not callable"),
        (np.cos, math.nan, "tau holds NaN"),
        (np.cos, [1.0, math.inf], "tau holds NaN or an infinity"),
        (np.cos, 1j, "tau is complex"),
        (np.cos, "now", "tau = 'now' is not an array of numbers"),
        (np.cos, 1e12, "more than 1e"),
        (lambda u: 1.0, [2.0, 3.0], r"shape \(\) for times of shape \(2,\)"),
        (lambda u: u * math.nan, 2.0, r"rate\(tau\) holds NaN"),
        (lambda u: None, 2.0, "not an array of numbers"),
        (lambda u: np.full(u.shape, 1e308), 5.0, "overflows double precision"),
    ],
)
def test_contact_response_refuses(rate, tau, message):
    with pytest.raises(InputError, match=message):
        contact_response(rate, tau)


@pytest.mark.parametrize(
    ("frequencies", "amplitudes", "tau", "message"),
    [
        ([1.0, 2.0], [1.0], 0.0, "shape"),
        ([[1.0]], [[1.0]], 0.0, "one-dimensional"),
        (1.0, 1.0, 0.0, "one-dimensional"),
        ([1.0], [math.nan], 0.0, "amplitudes holds NaN"),
        ([1.0], [1.0], [math.nan], "tau holds NaN"),
        ([math.pi], [1.0], 0.0, "p/q = 1/1"),
        ([1.0], [1.0], 1e308, r"the phase 1e\+308, beyond 1.34e\+08"),
        ([0.5, 2.0], [1.0, 1.0], 1e8, r"the phase 2e\+08, beyond"),
        ([1.0 - 100j], [1.0], 100.0, "overflows double precision"),
        ([2.0, 2.0], [1e308, 1e308], 0.0, "overflows double precision"),
    ],
)
def test_spectrum_refuses(frequencies, amplitudes, tau, message):
    with pytest.raises(InputError, match=message):
        contact_response_spectrum(frequencies, amplitudes, tau)


def test_transfer_of_fast_growing_and_decaying_drives():
    """e^{−iΩ} overflows on the way: H = −iΩe^{iΩ}/(1 − e^{2iΩ}) does not, and is even in Ω."""
    from mpmath import mp, mpc, sin

    omega = np.array([1 + 0.99j, 1 + 1.01j, 3 - 20j, -2 + 300j, 1 - 700j, 0.5 + 1e5j, 4 - 9e5j])
    found = transfer(omega)
    with mp.workdps(40):
        for value, h in zip(omega, found, strict=True):
            exact = mpc(complex(value)) / (2 * sin(mpc(complex(value))))
            # The phase of e^{iΩ} is Re Ω, its size e^{−|Im Ω|}: an ulp of either is what remains.
            assert abs(complex(h) - complex(exact)) <= 8 * 2.0**-53 * abs(value) * abs(
                complex(exact)
            )
    assert (transfer(-omega) == found).all()
    assert transfer([1e-320 + 1e-320j, 1e-9]).tolist() == [0.5, 0.5]
