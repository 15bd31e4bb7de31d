"""The linear spectrum: a Galerkin method, fifty digits, interlacing, both limits, mode shapes."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from numpy.polynomial import legendre

from asymptotics.errors import InputError
from asymptotics.problems.beam import static_beam
from asymptotics.problems.beam_spectrum import (
    linear_frequencies,
    linear_spectrum,
    stiffness_of,
    wavenumbers,
)
from asymptotics.problems.beam_waves import waves
from asymptotics.problems.static_shape import DRIVEN_ENDS, contact_point
from asymptotics.rings.numbers import doubles

UNIT = 2.0**-52


def galerkin(stretch: float, size: int, end: str) -> np.ndarray:
    """Ω_n ξ₀ of ∫(φ″² /z² + φ′²) = (Ωξ₀)² ∫φ² over 0 ≤ x ≤ 1, by Ritz: bounds from above.

    Polynomials of degree < size times x(1 − x)² or x²(1 − x)²; φ″(0) = 0 is a natural condition.
    """
    nodes, weights = legendre.leggauss(2 * size + 8)
    x, w = (nodes + 1) / 2, weights / 2
    bubble = np.polynomial.Polynomial([0, 1] if end == "pinned" else [0, 0, 1])
    bubble = bubble * np.polynomial.Polynomial([1, -2, 1])
    tables = []
    for d in range(3):
        column = np.zeros((x.size, size))
        for j in range(size):
            base = legendre.Legendre.basis(j)
            for i in range(d + 1):
                inner = base.deriv(d - i) if d > i else base
                outer = bubble.deriv(i) if i else bubble
                factor = math.comb(d, i) * 2.0 ** (d - i)
                column[:, j] += factor * outer(x) * inner(nodes)
        tables.append(np.sqrt(w)[:, None] * column)
    values, slopes, curvatures = tables
    q, r = np.linalg.qr(values)
    assert q.shape == values.shape
    inverse = np.linalg.inv(r)
    slopes, curvatures = slopes @ inverse, curvatures @ inverse
    stiffness = slopes.T @ slopes + curvatures.T @ curvatures / stretch**2
    return np.sqrt(np.linalg.eigvalsh(stiffness))


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize(
    ("beta", "size", "count"), [(1e-4, 60, 20), (1e-2, 34, 10), (1.0, 26, 8), (1e3, 24, 8)]
)
def test_no_root_is_missed(end: str, beta: float, size: int, count: int) -> None:
    """All eigenvalues of an independent discretisation, one for one, with the same count."""
    place = float(contact_point(beta, end))
    ritz = galerkin(place / math.sqrt(beta), size, end) / place
    omega = linear_frequencies(beta, count, end)
    # These degrees resolve the half waves and the layer √β; what is left is the backward error of
    # a dense symmetric eigenvalue problem, a few roundings of the largest eigenvalue.
    tolerance = 8 * UNIT * (ritz[-1] / omega) ** 2
    assert tolerance.max() < 2e-7
    assert np.all(np.abs(ritz[:count] / omega - 1) <= tolerance)
    assert np.sum(ritz < 0.5 * (omega[-1] + omega[-2])) == count - 1
    assert np.all(np.diff(omega) > math.pi)


def exact(beta: mpmath.mpf, end: str, near: float) -> mpmath.mpf:
    """Ω next to ``near`` from the textbook determinants in cosh and sinh, not from branches."""
    root = mpmath.sqrt(beta)
    if end == "pinned":
        static = lambda x: x * x - 2 * root * x * mpmath.tanh(x / (2 * root)) - 1  # noqa: E731
    else:
        static = lambda x: x * mpmath.coth(x / (2 * root)) - 2 * root - 1  # noqa: E731
    start = mpmath.mpf(float(contact_point(float(beta), end)))
    length = mpmath.findroot(static, (start, start * (1 + mpmath.mpf(10) ** -12)), verify=False)

    def determinant(omega: mpmath.mpf) -> mpmath.mpf:
        s = mpmath.sqrt(1 + 4 * beta * omega**2)
        p, k = mpmath.sqrt((1 + s) / (2 * beta)), mpmath.sqrt(2 * omega**2 / (1 + s))
        ck, sk, cp, sp = (
            mpmath.cos(k * length),
            mpmath.sin(k * length),
            mpmath.cosh(p * length),
            mpmath.sinh(p * length),
        )
        if end == "pinned":
            return (p * sk * cp - k * ck * sp) / (cp * p)
        return (2 * k * p * (1 - ck * cp) + (p * p - k * k) * sk * sp) / (cp * p * p)

    first = mpmath.mpf(near)
    return mpmath.findroot(determinant, (first, first * (1 + mpmath.mpf(10) ** -12)), verify=False)


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-8, 1e-4, 1e-2, 1.0, 1e4, 1e8])
def test_against_fifty_digits(end: str, beta: float) -> None:
    found = linear_frequencies(beta, 7, end)
    with mpmath.workdps(50):
        for n in (1, 2, 7):
            reference = exact(mpmath.mpf(beta), end, found[n - 1])
            # roundings of ξ₀, of the root x and of the three factors of Ω
            assert abs(float(found[n - 1] / reference - 1)) < 8 * UNIT


def test_sheet_table() -> None:
    printed = {
        1e-4: (3.1430, 6.2951, 9.4654),
        1e-3: (3.1546, 6.3961, 9.8070),
        5e-3: (3.2007, 6.7834, 11.0506),
        1e-2: (3.2500, 7.1777, 12.2343),
        1e-1: (3.6432, 9.8835, 19.3592),
    }
    for beta, row in printed.items():
        # four decimals are printed; half a unit of the last and a little for ties
        assert linear_frequencies(beta, 3) == pytest.approx(row, abs=0.51e-4)


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_no_overflow_and_both_limits(end: str) -> None:
    beta = np.concatenate([[0.0, 5e-324, 1e-300], np.geomspace(1e-8, 1e8, 33), [1e300, math.inf]])
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        omega = linear_frequencies(beta, 40, end)
    assert omega.shape == (beta.size, 40)
    assert np.all(np.isfinite(omega))
    n = np.arange(1, 41)
    assert omega[0].tolist() == (n * np.pi).tolist()
    # e^{−1/√β} and β itself are far below rounding
    assert omega[2] == pytest.approx(n * np.pi, rel=4 * UNIT)
    assert omega[-2] == pytest.approx(omega[-1], rel=8 * UNIT)
    # bending only raises them, and more the more there is of it, and spreads them
    assert np.all(np.diff(omega[3:-2], axis=0) > 0)
    assert np.all(omega[3:-2] < omega[-1])
    assert np.all(omega[3:, 1] > 2 * omega[3:, 0])


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_approach_to_the_limits(end: str) -> None:
    """Ω_n − Ω_n(0) ∝ β and Ω_n(∞) − Ω_n ∝ 1/√β, both positive."""
    low = linear_frequencies([1e-6, 1e-8], 4, end) - np.pi * np.arange(1, 5)
    assert np.log10(low[0] / low[1]) == pytest.approx(np.full(4, 2.0), abs=0.01)
    high = linear_frequencies(math.inf, 4, end) - linear_frequencies([1e6, 1e8], 4, end)
    assert np.log10(high[0] / high[1]) == pytest.approx(np.full(4, 1.0), abs=0.01)


@pytest.mark.parametrize("stretch", [0.0, 1e-3, 0.5, 3.0, 40.0, 1e4])
def test_interlacing_at_equal_length(stretch: float) -> None:
    """One more constraint moves each eigenvalue up, but not beyond the next (Courant, Weyl)."""
    pinned, clamped = (wavenumbers(stretch, 30, end) for end in DRIVEN_ENDS)
    assert np.all(pinned < clamped)
    assert np.all(clamped[:-1] < pinned[1:])
    n = np.arange(1, 31)
    assert np.all((pinned > n * np.pi) & (pinned < (n + 0.5) * np.pi))
    assert np.all((clamped > n * np.pi) & (clamped < (n + 1) * np.pi))


def test_many_roots_and_shapes() -> None:
    x = wavenumbers(30.0, 5000, "clamped")
    assert np.all((np.floor(x / np.pi)) == np.arange(1, 5001))
    assert wavenumbers(np.ones((2, 3)), 4).shape == (2, 3, 4)
    assert linear_frequencies(np.full((2, 3), 0.1), 4).shape == (2, 3, 4)
    assert linear_frequencies([], 4).shape == (0, 4)
    single = linear_frequencies(0.01, 3)
    assert linear_frequencies([0.0, 0.01, 1e3], 3)[1].tolist() == single.tolist()


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-3, 1e-2, 1.0])
def test_poles_of_the_expansion(end: str, beta: float) -> None:
    """The determinant of the expansion's impedances changes sign at each Ω_n, nowhere else."""
    shape = static_beam(beta, end)
    omega = linear_frequencies(beta, 4, end)
    grid = np.unique(
        np.concatenate(
            [np.linspace(0.3, omega[-1] * 1.02, 400), omega * (1 - 1e-9), omega * (1 + 1e-9)]
        )
    )
    values = [waves(shape, float(r), doubles()).solve(0, 0, 1)[1] for r in grid]
    flips = np.flatnonzero(np.diff(np.sign(values)))
    assert flips.size == omega.size
    assert np.all((grid[flips] < omega) & (omega < grid[flips + 1]))
    assert grid[flips + 1] == pytest.approx(omega, rel=2e-9)


# -- modes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-8, 1e-4, 1e-2, 1.0, 1e4, 1e8])
def test_modes_solve_the_eigenvalue_problem(end: str, beta: float) -> None:
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        spectrum = linear_spectrum(beta, 4, end)
        place = spectrum.contact_point
        xi = place * np.linspace(0.0, 1.0, 41)
        for n, (omega, k) in enumerate(zip(spectrum.omega, spectrum.wavenumber, strict=True), 1):
            phi = [spectrum.mode(n, xi, d) for d in range(5)]
            terms = (beta * phi[4], -phi[2], -(omega**2) * phi[0])
            assert np.max(np.abs(phi[0])) > 0.9
            # one rounding of Ω², k² and of phases up to kξ₀, on terms of the size of the largest
            size = max(np.max(np.abs(t)) for t in terms)
            assert np.max(np.abs(sum(terms))) <= 32 * n * UNIT * size
            p = math.hypot(k, 1 / math.sqrt(beta))
            small = 32 * n * UNIT * np.array([1, k + p, k * k + p * k, (k + p) ** 3])
            assert abs(phi[0][0]) <= small[0]
            assert abs(phi[0][-1]) <= small[0]
            assert abs(phi[1][-1]) <= small[1]
            free, other = (2, 1) if end == "pinned" else (1, 2)
            assert abs(phi[free][0]) <= small[free]
            assert abs(phi[other][0]) > 0.1 * k**other
            # n − 1 nodes inside, and φ leaves ξ = 0 upwards
            inner = np.sign(phi[0][1:-1])
            assert np.count_nonzero(np.diff(inner[inner != 0])) == n - 1
            assert phi[0][1] > 0


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_modes_are_orthogonal(end: str) -> None:
    spectrum = linear_spectrum(0.01, 5, end)
    nodes, weights = legendre.leggauss(80)
    xi = spectrum.contact_point * (nodes + 1) / 2
    table = np.array([spectrum.mode(n, xi) for n in range(1, 6)])
    gram = (table * weights) @ table.T
    norms = np.sqrt(np.diag(gram))
    # Gauss's rule is exact to rounding for five half waves and a layer of a tenth
    assert gram / np.outer(norms, norms) == pytest.approx(np.eye(5), abs=1e-13)


def test_modes_of_the_string() -> None:
    spectrum = linear_spectrum(0.0, 3)
    xi = np.linspace(0.0, 1.0, 9)
    assert spectrum.contact_point == 1.0
    assert spectrum.mode(2, xi) == pytest.approx(np.sin(2 * np.pi * xi), abs=8 * UNIT)
    assert spectrum.mode(3, xi, 1) == pytest.approx(
        3 * np.pi * np.cos(3 * np.pi * xi), abs=64 * UNIT
    )
    for end in DRIVEN_ENDS:
        errors = [
            np.max(np.abs(linear_spectrum(beta, 2, end).mode(2, xi) - spectrum.mode(2, xi)))
            for beta in (1e-6, 1e-8)
        ]
        assert math.log10(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.05)


# -- inverse -------------------------------------------------------------------------------------


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize(("n", "beta"), [(1, 1e-6), (1, 0.0049), (2, 1e-3), (3, 5.0), (1, 1e5)])
def test_stiffness_is_the_inverse(end: str, n: int, beta: float) -> None:
    omega = float(linear_frequencies(beta, n, end)[-1])
    step = linear_frequencies([beta, beta * 1.001], n, end)[:, -1]
    condition = omega * 1e-3 / (step[1] - step[0])
    # the rounding of Ω, times how much log β moves with log Ω
    assert stiffness_of(omega, n, end) == pytest.approx(beta, rel=16 * UNIT * condition)


def test_stiffness_of_the_string() -> None:
    assert stiffness_of(math.pi) == 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: linear_frequencies(-0.1, 3), "beta = -0.1"),
        (lambda: linear_frequencies(math.nan, 3), "beta = nan"),
        (lambda: linear_frequencies(0.1, 0), "count = 0"),
        (lambda: linear_frequencies(0.1, 10**6), "count = 1000000"),
        (lambda: linear_frequencies(0.1, 2.5), "count = 2.5 is not a whole number"),
        (lambda: linear_frequencies(0.1, True), "count = True"),
        (lambda: linear_frequencies(0.1, 2, "Pinned"), "driven_end = 'Pinned'"),
        (lambda: wavenumbers(-1.0, 2), "stretch = -1.0"),
        (lambda: wavenumbers(math.nan, 2), "stretch = nan"),
        (lambda: linear_spectrum(math.inf, 2), "beta = inf"),
        (lambda: linear_spectrum(0.1, 2).mode(3, 0.5), "holds n = 1 ... 2"),
        (lambda: linear_spectrum(0.1, 2).mode(1, 9.0), "lifted part"),
        (lambda: linear_spectrum(0.1, 2).mode(1, 0.5, -1), "d = -1"),
        (lambda: stiffness_of(3.0), "not a linear resonance number 1 of any pinned rope"),
        (lambda: stiffness_of(4.46), "3.14159 <= Omega < 4.45085"),
        (lambda: stiffness_of(3.9, 1, "clamped"), "Omega < 3.72888"),
        (lambda: stiffness_of(math.nan), "Omega = nan"),
        (lambda: stiffness_of("3.2"), "Omega = '3.2'"),
    ],
)
def test_refuses(call, message) -> None:
    with pytest.raises(InputError, match=message):
        call()
