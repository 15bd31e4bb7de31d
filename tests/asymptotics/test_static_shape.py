"""The static shape: its equation, its ends, every size of β, and a second derivation."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import sympy

from asymptotics.errors import InputError
from asymptotics.problems.beam import static_beam
from asymptotics.problems.static_shape import (
    DRIVEN_ENDS,
    bracketed_newton,
    contact_point,
    static_shape,
)
from asymptotics.rings.numbers import digits

UNIT = 2.0**-52
BETAS = [1e-12, 1e-8, 1e-4, 1e-2, 0.3, 1.0, 30.0, 1e4, 1e8, 1e30]


def condition(end: str, beta: mpmath.mpf, x: mpmath.mpf) -> mpmath.mpf:
    """W₀(0) − 1 from the solution in cosh and sinh, without the simplifications of the module."""
    root = mpmath.sqrt(beta)
    z = x / root
    if end == "pinned":
        d = 2 * beta * (1 - mpmath.cosh(z)) / mpmath.sinh(z)
    else:
        d = 2 * beta * (z - mpmath.sinh(z)) / (mpmath.cosh(z) - 1)
    return x * x + 2 * beta * (1 - mpmath.cosh(z)) + d * (z - mpmath.sinh(z)) - 1


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-3, 1e-2, 0.3, 1.0, 30.0, 1e4, 1e8, 1e30])
def test_contact_point_against_fifty_digits(end: str, beta: float) -> None:
    found = float(contact_point(beta, end))
    with mpmath.workdps(120):
        b, x = mpmath.mpf(beta), mpmath.mpf(found)
        value = condition(end, b, x)
        h = x * mpmath.mpf(10) ** -40
        slope = (condition(end, b, x + h) - condition(end, b, x - h)) / (2 * h)
        error = float(value / slope / x)
    # a handful of roundings in one logarithm, whose slope in log ξ is at least 1
    assert abs(error) < 4 * UNIT
    assert slope > 0


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_static_beam_in_doubles_against_sixty_digits(end: str) -> None:
    """ξ₀ and a₃ where y − tanh y, y coth y − 1 and coth y − y/sinh² y cancel, β ≫ 1, too."""
    together = static_beam(np.array(BETAS), end)
    for i, beta in enumerate(BETAS):
        with mpmath.workdps(60):
            exact = static_beam(mpmath.mpf(beta), end, digits())
        alone = static_beam(beta, end)
        for place in (together.contact_point[i], alone.contact_point):
            assert abs(place / float(exact.contact_point) - 1) <= 2 * UNIT
        a3 = float(exact.a3)
        for value in (together.a3[i], alone.a3, static_shape(beta, end).derivative(3)):
            assert abs(value / a3 - 1) <= 4 * UNIT


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_contact_point_for_thin_and_thick_ropes(end: str) -> None:
    """tanh and coth are 1 for β ≤ 10⁻⁶, to far below rounding; β → ∞ gives (12β)^¼, (36β)^¼."""
    beta = np.array([0.0, 5e-324, 1e-300, 1e-16, 1e-8, 1e-6])
    root = np.sqrt(beta)
    thin = root + np.sqrt(1 + beta) if end == "pinned" else 1 + 2 * root
    assert contact_point(beta, end) == pytest.approx(thin, rel=4 * UNIT)
    power = 12 if end == "pinned" else 36
    stiff = np.array([1e34, 1e300, 1.7e308])
    thick = contact_point(stiff, end) / (power**0.25 * stiff**0.25)
    # the next term is O(1/√β) of the first
    assert thick == pytest.approx(1.0, rel=1e-15)
    assert contact_point(math.inf, end) == math.inf


def test_sheet_values() -> None:
    printed = [1.01005000, 1.03212265, 1.10498407, 1.35384357]
    # printed to 8 decimals
    assert contact_point([1e-4, 1e-3, 1e-2, 1e-1]) == pytest.approx(printed, abs=0.51e-8)


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", BETAS)
def test_profile_solves_its_boundary_value_problem(end: str, beta: float) -> None:
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        shape = static_shape(beta, end)
        place = shape.contact_point
        xi = place * np.concatenate([np.linspace(0.0, 1.0, 23), 1 - np.geomspace(1e-6, 0.5, 9)])
        second, fourth = shape.profile(xi, 2), shape.profile(xi, 4)
        at_end = [float(shape.profile(0.0, d)) for d in range(4)]
        at_contact = [float(shape.profile(place, d)) for d in range(3)]
    # each term is a sum of a few of size max(1, |W''|, β|W''''|)
    size = 1 + np.abs(second) + beta * np.abs(fourth)
    assert np.all(np.abs(second - 2 - beta * fourth) <= 16 * UNIT * size)
    # ξ₀ is known to a few roundings: relative to W₀' ξ₀ and, for derivatives, to the end layer √β
    assert at_end[0] == pytest.approx(1.0, abs=16 * UNIT * (1 + abs(at_end[1]) * place))
    free = at_end[2] if end == "pinned" else at_end[1]
    scale = 2.0 if end == "pinned" else 2 * place
    layer = place / math.sqrt(beta)
    assert abs(free) <= 16 * UNIT * scale * max(1.0, 1 / layer**2, layer)
    other = at_end[1] if end == "pinned" else at_end[2]
    assert abs(other) > 1e-3 / max(1.0, layer**-4, beta)
    assert at_contact == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", BETAS)
def test_derivatives_at_the_contact_point(end: str, beta: float) -> None:
    shape = static_shape(beta, end)
    assert shape.contact_order == 3
    for d in range(9):
        assert shape.derivative(d) == pytest.approx(
            float(shape.profile(shape.contact_point, d)), rel=16 * UNIT, abs=0.0
        )
    assert shape.derivative(3) < 0
    # a_{d+2} = a_d/β from a₃ and a₄ = −2/β: the weight
    for d in range(3, 7):
        assert shape.derivative(d + 2) == pytest.approx(shape.derivative(d) / beta, rel=8 * UNIT)
    assert beta * shape.derivative(4) == pytest.approx(-2.0, rel=4 * UNIT)


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_derivatives_by_finite_differences(end: str) -> None:
    shape = static_shape(0.02, end)
    xi, errors = np.linspace(0.2, 0.9 * shape.contact_point, 15), []
    for d in range(4):
        steps = []
        for h in (2e-3, 1e-3):
            numeric = (shape.profile(xi + h, d) - shape.profile(xi - h, d)) / (2 * h)
            steps.append(np.max(np.abs(numeric - shape.profile(xi, d + 1))))
        errors.append(math.log2(steps[0] / steps[1]))
    assert errors == pytest.approx([2.0] * 4, abs=0.02)


@pytest.mark.slow
def test_closed_form_conditions_follow_from_the_boundary_values() -> None:
    """SymPy: both conditions of the module from the general solution and its five conditions."""
    y, z, s = sympy.symbols("y z s", positive=True)
    # W₀/β with y = (ξ₀ − ξ)/√β, z = ξ₀/√β, for a free σ; W₀″ = 2 + βW₀⁗ and W₀ ~ y³ hold.
    shape = 2 * (s * (sympy.sinh(y) - y) - (sympy.cosh(y) - 1 - y**2 / 2))
    assert sympy.simplify(shape.diff(y, 2) - 2 - shape.diff(y, 4)) == 0
    assert [shape.diff(y, d).subs(y, 0) for d in range(3)] == [0, 0, 0]
    conditions = {
        "pinned": (shape.diff(y, 2), sympy.tanh(z / 2), z**2 - 2 * z * sympy.tanh(z / 2)),
        "clamped": (
            shape.diff(y),
            sympy.coth(z / 2) - z / 2 / sympy.sinh(z / 2) ** 2,
            (z * sympy.coth(z / 2) - 2) ** 2,
        ),
    }
    for free, sigma, height in conditions.values():
        for left in (free.subs(y, z).subs(s, sigma), shape.subs(y, z).subs(s, sigma) - height):
            rational = sympy.simplify(left.rewrite(sympy.exp))
            assert rational == 0
        assert sympy.simplify((free.subs(y, z).subs(s, 2 * sigma)).rewrite(sympy.exp)) != 0


def test_string() -> None:
    shape = static_shape(0.0)
    assert (shape.contact_point, shape.contact_order) == (1.0, 2)
    assert [shape.derivative(d) for d in range(5)] == [0.0, 0.0, 2.0, 0.0, 0.0]
    assert shape.profile([0.0, 0.5, 1.0]).tolist() == [1.0, 0.25, 0.0]
    assert shape.profile([0.0, 1.0], 1).tolist() == [-2.0, 0.0]
    assert shape.profile([0.0, 1.0], 2).tolist() == [2.0, 2.0]
    assert shape.profile(0.5, 3) == 0.0


@pytest.mark.parametrize("end", DRIVEN_ENDS)
def test_thin_ropes_tend_to_the_string(end: str) -> None:
    """ξ₀ − 1 is O(√β), and so is W₀ − (1 − ξ)² clamped; pinned it is O(β) outside the layers."""
    xi, errors = np.linspace(0.0, 0.9, 10), []
    for beta in (1e-6, 1e-8):
        shape = static_shape(beta, end)
        errors.append(np.max(np.abs(shape.profile(xi) - (1 - xi) ** 2)))
    assert math.log10(errors[0] / errors[1]) == pytest.approx(
        2.0 if end == "pinned" else 1.0, abs=0.01
    )


def test_bracketed_newton_falls_back_on_bisection() -> None:
    """arctan far from its root: Newton alone diverges from |x| > 1.39."""
    roots = bracketed_newton(
        lambda x: (np.arctan(x - 1), 1 / (1 + (x - 1) ** 2)),
        np.array([-1e6, -3.0]),
        np.array([1e5, 1e9]),
        np.array([5e4, 1e9]),
    )
    assert roots == pytest.approx([1.0, 1.0], abs=32 * UNIT)
    with pytest.raises(ArithmeticError, match="not increasing"):
        bracketed_newton(
            lambda x: (x * math.nan, x), np.array([0.0]), np.array([1.0]), np.array([0.5])
        )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: contact_point(-1e-9), "beta = -1e-09; .* not negative"),
        (lambda: contact_point([0.1, math.nan]), "beta = nan"),
        (lambda: contact_point("stiff"), "beta = 'stiff' is not a number"),
        (lambda: contact_point(None), "finite and not negative"),
        (lambda: contact_point(0.1, "free"), "driven_end = 'free'; choose one of pinned, clamped"),
        (lambda: static_shape(math.inf), "beta = inf.*stiff_limit"),
        (lambda: static_shape([0.1, 0.2]), "give one number"),
        (lambda: static_shape(0.1).profile(-0.1), "0 <= xi <= xi_0"),
        (lambda: static_shape(0.1).profile(2.0), "lifted part"),
        (lambda: static_shape(0.1).profile(math.nan), "lifted part"),
        (lambda: static_shape(0.1).profile("here"), "xi = 'here'"),
        (lambda: static_shape(0.1).profile(0.5, -1), "d = -1"),
        (lambda: static_shape(0.1).derivative(True), "d = True"),
        (lambda: static_shape(0.1).derivative(1.5), "d = 1.5"),
    ],
)
def test_refuses(call, message) -> None:
    with pytest.raises(InputError, match=message):
        call()
