"""The exact solutions meet their own equations, checked by means they do not use themselves."""

import math

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from numerics.errors import InputError
from numerics.exact_solutions.index import (
    StringImpact,
    bouncing_bar,
    plucked_string,
    point_plateau,
    static_contact_point,
    static_shape,
    travelling_pulse,
)
from numerics.problems.problem import DrivenEnd

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
