"""Damping: residuals, the undamped limit, resonance, closed forms, and a second method."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
import sympy

from asymptotics import Expansion, expand, moving_frame, prove
from asymptotics.errors import InputError
from asymptotics.expansion.proof import RefutedError, residuals
from asymptotics.formulas.rope import rope_forms
from asymptotics.problems.damped import damped_string, impedance, source, wavenumber
from asymptotics.problems.forcing import forced_string, fourier_drive
from asymptotics.problems.generators import Generators, generator_rope, values_of
from asymptotics.problems.moving_contact import moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.rings.ring import ComplexRing
from asymptotics.values.linear_response import damped_response as linear_response
from asymptotics.values.response import response

EPS = 2.0**-52
ORDER = 5
CASES = [(0.83, 0.1, 0.0), (math.pi, 0.05, 0.0), (2.2, 0.3, 0.04), (7.5, 4.0, 0.0)]


def size(expansion: Expansion, n: int) -> float:
    """The largest coefficient up to order n: what the N³ roundings of order n are relative to."""
    sizes = [1.0]
    for k in range(1, n + 1):
        sizes += [abs(c) for c in expansion.contact(k).values()]
        sizes += [abs(x) for row in expansion.shape(k).values() for x in row]
    return max(sizes)


@pytest.mark.parametrize(("omega", "damping", "viscosity"), CASES)
def test_residuals_are_roundings(omega: float, damping: float, viscosity: float) -> None:
    """At a resonance of the undamped string too; with certified bounds in test_balls."""
    solution = expand(damped_string(omega, damping, viscosity), ORDER)
    frame = moving_frame(solution)
    rate = max(1.0, abs(wavenumber(ORDER, omega, damping, viscosity)))
    for n in range(1, ORDER + 1):
        left = residuals(solution, frame, n)
        # Up to N + 3 − n derivatives of the equation are checked, each a power of k_N.
        bound = ORDER**3 * EPS * size(solution, n) * rate ** (ORDER + 3 - n)
        assert max(map(abs, left)) <= bound
        assert abs(solution.contact(n)[n]) > 1e3 * ORDER**3 * EPS
        assert abs(solution.contact(n)[n].imag) > 0


def test_impedances_as_generators_equal_the_numbers() -> None:
    """The preset's formulas, evaluated where this problem has its numbers; resonances included."""
    forms = rope_forms(string(damping=sympy.Symbol("zeta")), ORDER)
    proofs = forms.prove()
    assert [len(proof.harmonics) for proof in proofs] == [1, 1, 2, 2, 3, 3]
    for omega, damping in ((0.83, 0.1), (math.pi, 0.05), (7.5, 4.0)):
        problem = damped_string(omega, damping)
        values, numbers = values_of(problem, forms.generators), expand(problem, ORDER)
        for n, j in forms.places():
            element = forms.expansion.contact(n)[j]
            found = forms.expansion.problem.ring.evaluate(element, values, ComplexRing())
            difference = abs(found * problem.inverse_leading**n - numbers.contact(n)[j])
            assert difference <= ORDER**3 * EPS * size(numbers, n)


def complex_generators() -> Expansion:
    return expand(generator_rope(Generators(2, (1,), 3, False)), 3)


def test_a_wrong_shape_is_refuted() -> None:
    exact = complex_generators()
    value, slope, *rest = exact.orders[2].shape[1]
    exact.orders[2].shape[1] = (value, slope + exact.problem.ring["S1_1"], *rest)
    with pytest.raises(RefutedError) as caught:
        prove(exact)
    assert not caught.value.proofs[3].driven_end
    assert not caught.value.proofs[3].contact


def test_a_wrong_conjugate_is_refuted() -> None:
    """The moving frame sees complex harmonics on both sides; one side alone is no solution."""
    exact = complex_generators()
    contact = exact.orders[2].contact
    contact[1] = exact.problem.ring.conjugate(contact[1])
    with pytest.raises(RefutedError) as caught:
        prove(exact)
    assert [p.contact for p in caught.value.proofs] == [True, True, True, False]


@pytest.mark.parametrize("omega", [0.83, 2.2, 5.1])
def test_no_damping_is_approached_linearly(omega: float) -> None:
    """Away from resonance every coefficient is analytic in ζ: halving it halves the difference."""
    limit = expand(forced_string(fourier_drive([omega], {1: 1.0}), 4), 4)
    differences = []
    for damping in (2.0**-14, 2.0**-15, 2.0**-16):
        found = expand(damped_string(omega, damping), 4)
        row = []
        for n in range(1, 5):
            assert found.contact(n).keys() == limit.contact(n).keys()
            for j, c in limit.contact(n).items():
                if j:
                    row.append(abs(found.contact(n)[j] - c) / abs(c))
        differences.append(row)
    table = np.array(differences)
    assert table.min() > 1e3 * ORDER**3 * EPS
    # The next term is O(ζ) relative, with coefficients up to (order × distance to resonance)⁻¹.
    assert abs(np.log2(table[:-1] / table[1:]) - 1).max() < 0.02


def test_the_response_at_resonance_is_finite() -> None:
    """ζ |ξ₁| → pπ/2 at Ω = pπ, with an error O(ζ²): k = pπ − iζ + ζ²/(2pπ) + …"""
    for p in (1, 2):
        errors = []
        for damping in (0.04, 0.02, 0.01):
            amplitude = abs(linear_response(p * math.pi, damping))
            errors.append(abs(damping * amplitude - p * math.pi / 2))
        slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
        assert errors[-1] > 0
        assert abs(slopes - 2).max() < 0.02
    # Half the power at a detuning of ζ: the width of the resonance.
    damping = 1e-4
    centre = abs(linear_response(math.pi, damping))
    aside = abs(linear_response(math.pi + damping, damping))
    assert aside / centre == pytest.approx(1 / math.sqrt(2), rel=10 * damping)


def test_closed_forms_through_the_second_order() -> None:
    """ξ₁: k₁/(4 sin k₁); ξ₂: −|k₁/ sin k₁|²/16 and −k₂ cot k₂ (k₁/sin k₁)²/32, by hand.

    (At order 2, w₂(1) = ξ₁² and w₂′(1) = −2ξ₂, for w₁ vanishes at ξ = 1 with all even derivatives.)
    """
    omega, zeta, place = sympy.symbols("Omega zeta xi_0")
    k = [sympy.sqrt(j**2 * omega**2 - 2 * sympy.I * j * zeta * omega) for j in (1, 2)]
    g, conjugate = k[0] / sympy.sin(k[0]), k[0].subs(sympy.I, -sympy.I)
    forms = rope_forms(string(damping=zeta), 3)
    expected = {
        (1, 1): g / 2,
        (2, 0): -g * conjugate / sympy.sin(conjugate) / 16,
        (2, 2): -k[1] * sympy.cot(k[1]) * g**2 / 16,
    }
    point = {omega: sympy.Rational(83, 100), zeta: sympy.Rational(1, 10), place: sympy.Integer(1)}
    numbers = expand(damped_string(0.83, 0.1), 3)
    for (n, j), formula in expected.items():
        found = forms.closed_contact(n, j)
        direct = numbers.contact(n)[j] * (2 if j else 1)
        assert abs((found - formula).evalf(30, subs=point)) < 1e-25
        assert abs(complex(found.evalf(20, subs=point)) - direct) < 64 * EPS
        assert abs(direct) > 1e-3
    third = complex(forms.closed_contact(3, 3).evalf(20, subs=point))
    assert abs(third - 2 * numbers.contact(3)[3]) < 64 * EPS
    assert forms.closed_contact(2, 1) == 0


def test_closed_forms_of_every_second_order_rope() -> None:
    """A travelling damped rope on a foundation, its load growing along it, two harmonics."""
    v, zeta, kappa = sympy.symbols("v zeta kappa")
    rope = moving_contact(
        equation=sympy.Eq(
            W.diff(tau, 2) + 2 * v * W.diff(xi, tau) + 2 * zeta * W.diff(tau),
            (1 - v**2) * W.diff(xi, 2) - zeta * W.diff(xi) - 2 - xi / 5 - kappa * W,
        ),
        driven_end=[
            sympy.Eq(
                2 * W, 2 + epsilon * sympy.cos(Omega * tau) + epsilon * sympy.sin(2 * Omega * tau)
            )
        ],
        contact=[W, W.diff(xi)],
    )
    at = {"v": 0.3, "zeta": 0.1, "kappa": 0.7, "Omega": 1.3}
    series, forms = expand(rope, 2, at=at), rope_forms(rope, 2)
    point = {sympy.Symbol(name): sympy.Rational(str(x)) for name, x in at.items()}
    point[sympy.Symbol("xi_0")] = sympy.Float(complex(series.problem.rest or 0).real, 17)
    for n, j in forms.places():
        direct = series.contact(n)[j] * (2 if j else 1)
        found = complex(forms.closed_contact(n, j).evalf(20, subs=point))
        assert abs(found - direct) < 1e-11 * max(1.0, abs(direct))
    with pytest.raises(InputError, match="second order"):
        rope_forms(beam(), 1).closed_contact(1, 1)


# -- a second method: the full nonlinear problem by collocation ------------------------------------


def growth(expansion: Expansion) -> float:
    """max |ξ_n|^{1/n}: ε times this is the ratio of successive orders."""
    return max(
        max(map(abs, expansion.contact(n).values())) ** (1 / n)
        for n in range(1, expansion.order + 1)
    )


def collocation(
    omega: float, damping: float, viscosity: float, epsilon: float, modes: int = 10
) -> np.ndarray:
    """ξ_c's Fourier coefficients c_0 … c_M of the periodic state itself, by Newton's iteration.

    W = ξ² + (1 + b_0 ξ) + 2 Re Σ e^{ijθ} (drive_j cos k_jξ + b_j sin k_jξ / k_j) satisfies the
    equation and the driven end for any b; W = W_ξ = 0 at ξ_c(θ) in the mean-square sense.
    """
    theta = np.arange(6 * modes) * (2 * np.pi / (6 * modes))
    j = np.arange(1, modes + 1)
    rate = j * omega
    k = np.sqrt((rate**2 - 2j * damping * rate) / (1 + 1j * viscosity * rate))
    waves = np.exp(1j * np.multiply.outer(theta, j))
    drive = np.zeros(modes)
    drive[0] = epsilon / 2

    def series(c: np.ndarray) -> np.ndarray:
        return c[0] + 2 * (waves @ (c[1 : modes + 1] + 1j * c[modes + 1 :])).real

    def residual(x: np.ndarray) -> np.ndarray:
        place, b = series(x[: 2 * modes + 1]), x[2 * modes + 1 :]
        amplitude = b[1 : modes + 1] + 1j * b[modes + 1 :]
        phase = np.multiply.outer(place, k)
        value = place**2 + 1 + b[0] * place
        slope = 2 * place + b[0]
        shape = drive * np.cos(phase) + amplitude * np.sin(phase) / k
        tilt = -k * drive * np.sin(phase) + amplitude * np.cos(phase)
        value = value + 2 * (waves * shape).sum(axis=1).real
        slope = slope + 2 * (waves * tilt).sum(axis=1).real
        return np.concatenate([value, slope])

    x = np.zeros(4 * modes + 2)
    x[0], x[2 * modes + 1] = 1.0, -2.0
    for _ in range(12):
        base = residual(x)
        h = 1e-6  # of a Jacobian that need not be exact: the iteration ends on the residual
        jacobian = np.array(
            [(residual(x + h * e) - residual(x - h * e)) / (2 * h) for e in np.eye(x.size)]
        ).T
        x = x - np.linalg.lstsq(jacobian, base, rcond=None)[0]
    assert abs(residual(x)).max() < 1e-12
    return np.concatenate([x[:1], x[1 : modes + 1] + 1j * x[modes + 1 : 2 * modes + 1]])


@pytest.mark.parametrize(("omega", "damping", "viscosity"), CASES[:3])
def test_the_full_problem_is_met_to_the_order_kept(
    omega: float, damping: float, viscosity: float
) -> None:
    """The error of order N falls like ε^{N+1}; N itself would be off by one."""
    top = 3
    solution = expand(damped_string(omega, damping, viscosity), top + 1)
    scale = growth(solution)
    errors = []
    for small in (0.02 / scale, 0.01 / scale):
        exact = collocation(omega, damping, viscosity, small)
        row = []
        for order in range(1, top + 1):
            total = np.zeros_like(exact)
            total[0] = 1
            for n in range(1, order + 1):
                for j, c in solution.contact(n).items():
                    total[j] += small**n * c
            row.append(np.sqrt(np.sum(np.abs(exact - total) ** 2)))
        errors.append(row)
    found = np.log2(np.array(errors[0]) / np.array(errors[1]))
    assert min(errors[1]) > 1e-12
    assert abs(found - np.arange(2, top + 2)).max() < 0.2


def test_profile_and_driven_end() -> None:
    """Truncated separately, profile and position leave ε^{N+1} at the driven end."""
    tau = np.linspace(0, 5, 7)
    for omega, damping, viscosity in CASES[:3]:
        solution = expand(damped_string(omega, damping, viscosity), 4)
        scale = growth(solution)

        def phase(j: int, times: np.ndarray, omega: float = omega) -> np.ndarray:
            return j * omega * times

        leftover = []
        for small in (0.02 / scale, 0.01 / scale):
            contact = response(solution, phase, small, [], tau).contact
            profile = response(solution, phase, small, -contact[:, None], tau).profile
            ends = profile[:, 0] - 1 - small * np.cos(omega * tau)
            leftover.append(np.sqrt(np.mean(ends**2)))
        assert abs(np.log2(leftover[0] / leftover[1]) - 5) < 0.3


def test_functions_of_the_wavenumber() -> None:
    for k in (0.3 + 0.2j, 2.0 + 0.999999j, 2.0 + 1.000001j, 1.0 + 30j):
        assert abs(impedance(k) - k * cmath.cos(k) / cmath.sin(k)) <= 16 * EPS * abs(k)
        assert abs(source(k) - k / cmath.sin(k)) <= 16 * EPS * abs(k / cmath.sin(k))
    assert impedance(5 + 1e4j) == pytest.approx(-1j * (5 + 1e4j), rel=4 * EPS)
    # ζ ≫ 1: a diffusive string, nothing overflows.
    assert all(abs(c) < 1e-300 for c in expand(damped_string(50.0, 1e7), 3).contact(1).values())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.83, -1.0), "damping = -1.0"),
        ((0.83, math.nan), "damping = nan"),
        ((0.83, "x"), "damping = 'x'"),
        ((0.83, 0.1, -1), "viscosity = -1"),
        ((0.83, 0.0), "use forced_string"),
        ((-1.0, 0.1), "Omega = -1.0"),
    ],
)
def test_bad_input(arguments: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        damped_string(*arguments)
