"""Closed forms, p/q and their orders in the expansion, and the two limits of bending."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
import sympy

from asymptotics import Expansion
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import expand
from asymptotics.problems.beam import beam_problem
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.rope import Rope
from asymptotics.resonances.rationals import (
    neighbouring_resonances,
    nonlinear_resonances,
    stiff_limit,
    tension_free_frequency,
    weak_bending,
)

UNIT = 2.0**-52


# -- closed forms --------------------------------------------------------------------------------


def test_tension_cancels() -> None:
    form = tension_free_frequency()
    p, g, height, tension = sympy.symbols("p g Z_0 T", positive=True)
    assert form.label == "resonance1"
    assert sympy.simplify(form.expression - p * sympy.sqrt(g / (8 * height))) == 0
    assert tension not in form.expression.free_symbols
    numeric = form.expression.subs({p: 2, g: 9.80665, height: 0.81})
    rope = Rope(0.3, 0.015, 0.0, 0.81)
    assert rope.resonance_hertz(2) == pytest.approx(float(numeric), rel=4 * UNIT)


@pytest.mark.parametrize("end", ["pinned", "clamped"])
def test_weak_bending_has_the_right_remainder(end: str) -> None:
    """Ω_n − law = O(β^{3/2}): the observed order, and a wrong law has order 1."""
    n, beta = sympy.symbols("n beta", positive=True)
    law = sympy.lambdify([n, beta], weak_bending(end).expression)
    values, count = np.array([1e-6, 1e-7]), np.arange(1, 5)
    omega = linear_frequencies(values, 4, end)
    error = np.abs(omega - law(count[None, :], values[:, None]))
    # (10)^{3/2} a decade; the next term is √β of this one, times n
    assert np.log10(error[0] / error[1]) == pytest.approx(np.full(4, 1.5), abs=0.02)
    other = "clamped" if end == "pinned" else "pinned"
    wrong = sympy.lambdify([n, beta], weak_bending(other).expression)
    error = np.abs(omega - wrong(count[None, :], values[:, None]))
    assert np.log10(error[0] / error[1])[0] == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_forty_two_per_cent_is_pinned() -> None:
    pinned, clamped = stiff_limit("pinned"), stiff_limit("clamped")
    assert round(100 * pinned.increase) == 42
    assert round(100 * clamped.increase) == 19
    x, stiffness, height, rho, g = sympy.symbols("x B Z_0 rho g", positive=True)
    assert sympy.simplify(pinned.expression - x**2 / (2 * sympy.sqrt(3) * sympy.pi)) == 0
    assert sympy.simplify(clamped.expression - x**2 / (6 * sympy.pi)) == 0
    assert sympy.simplify(pinned.length**4 - 24 * stiffness * height / (rho * g)) == 0
    assert sympy.simplify(clamped.length**4 - 72 * stiffness * height / (rho * g)) == 0


@pytest.mark.parametrize("n", [1, 2, 3, 6])
@pytest.mark.parametrize("end", ["pinned", "clamped"])
def test_stiff_roots_to_thirty_digits(end: str, n: int) -> None:
    """mpmath on the given equation, and on the textbook form; then the spectrum itself at β = ∞."""
    limit = stiff_limit(end, n)
    x = sympy.Symbol("x", positive=True)
    difference = sympy.lambdify(x, limit.equation.lhs - limit.equation.rhs, "mpmath")
    textbook = {
        "pinned": lambda v: mpmath.tan(v) - mpmath.tanh(v),
        "clamped": lambda v: mpmath.cos(v) - mpmath.sech(v),
    }[end]
    with mpmath.workdps(30):
        for function in (difference, textbook):
            root = mpmath.findroot(function, limit.root)
            assert abs(limit.root / root - 1) < 4 * UNIT
        ratio = sympy.lambdify(x, limit.expression, "mpmath")(root)
        assert abs(limit.ratio / ratio - 1) < 8 * UNIT
    assert linear_frequencies(math.inf, n, end)[-1] / math.pi == pytest.approx(
        limit.ratio, rel=8 * UNIT
    )
    assert linear_frequencies(1e30, n, end)[-1] / math.pi == pytest.approx(
        limit.ratio,
        rel=1e-12,  # the correction is O(1/√β) = 1e-15 times x²
    )


def test_length_of_a_heavy_beam() -> None:
    """The lifted length in metres from L⁴ = 24BZ₀/ρg, against ξ₀x₀ of a nearly slack rope."""
    from asymptotics.problems.static_shape import contact_point

    names = sympy.symbols("B Z_0 rho g", positive=True)
    values = dict(zip(names, (0.3, 0.81, 0.05, 9.80665), strict=True))
    rope = Rope(1e-7, 0.05, 0.3, 0.81)
    for end in ("pinned", "clamped"):
        expected = float(stiff_limit(end).length.subs(values))
        measured = float(contact_point(rope.beta, end)) * rope.contact_point
        assert measured == pytest.approx(expected, rel=2 / math.sqrt(rope.beta))


# -- p/q -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [1, 2, 5, 8])
def test_all_fractions_and_no_other(order: int) -> None:
    found = nonlinear_resonances(order, 0.0, 7.0)
    expected = sorted(
        {Fraction(p, q) for q in range(1, order + 1) for p in range(1, 60) if p * math.pi <= 7 * q}
    )
    assert [Fraction(r.p, r.q) for r in found] == expected
    assert all(math.gcd(r.p, r.q) == 1 for r in found)
    for r in found:
        assert r.omega == pytest.approx(r.p * math.pi / r.q, rel=4 * UNIT)
        assert r.first_order == r.q
    # neighbours in a Farey sequence: p′q − pq′ = 1
    assert all(b.p * a.q - a.p * b.q == 1 for a, b in pairwise(found))


def test_window_and_hertz() -> None:
    rope = Rope(0.2, 0.015, 0.0, 0.81)
    low, high = rope.omega_from_hertz([0.5, 1.3])
    found = nonlinear_resonances(4, low, high, rope=rope)
    assert [(r.p, r.q) for r in found] == [(1, 2), (2, 3), (3, 4), (1, 1)]
    for r in found:
        assert r.hertz == pytest.approx(rope.resonance_hertz(r.p) / r.q, rel=8 * UNIT)
    assert nonlinear_resonances(2, 2.0, 3.0) == ()
    # the window is closed
    assert [(r.p, r.q) for r in nonlinear_resonances(1, math.pi, 2 * math.pi)] == [(1, 1), (2, 1)]


def test_bending_splits_what_the_string_has_in_one() -> None:
    omega = linear_frequencies(0.01, 40)
    found = nonlinear_resonances(3, 0.0, 8.0, beta=0.01)
    expected = {(p, q) for q in (1, 2, 3) for p in range(1, 41) if omega[p - 1] / q <= 8.0}
    assert {(r.p, r.q) for r in found} == expected
    assert {(1, 1), (2, 2), (3, 3)} <= expected
    assert [r.omega for r in found] == sorted(r.omega for r in found)
    for r in found:
        assert r.omega == omega[r.p - 1] / r.q


def test_pole_of_order_q_first_appears_at_order_q(sixth: Expansion) -> None:
    """In the exact ring Ψ_q, whose roots are cot(pπ/q), is in no denominator before order q."""
    for q in range(2, 7):
        for n in range(1, 7):
            powers = [c.canonical().poles for c in sixth.contact(n).values()]
            present = any(len(poles) >= q - 1 and poles[q - 2] > 0 for poles in powers)
            if n < q:
                assert not present
            if n == q:
                assert present


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (2, 2), (2, 3), (3, 3)])
def test_pole_of_the_beam_first_appears_at_order_q(p: int, q: int) -> None:
    """With bending too, 2/2 and 3/3 included: μ ξ_q,q tends to a constant, lower orders stay."""
    centre = float(linear_frequencies(0.01, p)[-1]) / q
    solutions = [expand(beam_problem(0.01, centre + mu), q) for mu in (1e-4, 1e-5)]
    first = [abs(s.contact(q)[q]) for s in solutions]
    assert math.log10(first[1] / first[0]) == pytest.approx(1.0, abs=0.01)
    for n in range(1, q):
        for j, c in solutions[0].contact(n).items():
            assert solutions[1].contact(n)[j] == pytest.approx(c, rel=0.02)


@pytest.mark.parametrize("order", [1, 3, 6])
@pytest.mark.parametrize("beta", [0.0, 0.01])
def test_neighbours_are_the_nearest(order: int, beta: float) -> None:
    everything = nonlinear_resonances(order, 0.0, 40.0, beta)
    for omega in (*np.linspace(0.2, 9.0, 57), math.pi, 2 * math.pi / 3, everything[3].omega):
        below, above = neighbouring_resonances(float(omega), order, beta)
        lower = [r for r in everything if r.omega <= omega]
        assert below == (max(lower, key=lambda r: (r.omega, -r.q)) if lower else None)
        assert above == min(
            (r for r in everything if r.omega > omega), key=lambda r: (r.omega, r.q)
        )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: nonlinear_resonances(0, 0.0, 1.0), "order = 0"),
        (lambda: nonlinear_resonances("2", 0.0, 1.0), "order = '2'"),
        (lambda: nonlinear_resonances(2, 1.0, 1.0), "0 <= low < high"),
        (lambda: nonlinear_resonances(2, -1.0, 1.0), "from -1.0 to 1.0"),
        (lambda: nonlinear_resonances(2, 0.0, math.nan), "to nan"),
        (lambda: nonlinear_resonances(2, 0.0, "high"), "give two numbers"),
        (lambda: nonlinear_resonances(200, 0.0, 100.0), "1.3e[+]06 candidates"),
        (lambda: nonlinear_resonances(2, 0.0, 1.0, beta=-1.0), "beta = -1.0"),
        (lambda: nonlinear_resonances(2, 0.0, 1.0, driven_end="free"), "choose one of"),
        (lambda: neighbouring_resonances(0.0, 3), "from 0.0 to 0.0"),
        (lambda: neighbouring_resonances(1e9, 3), "too many"),
        (lambda: neighbouring_resonances(2.0, 3, math.inf), "beta = inf"),
        (lambda: stiff_limit("free"), "driven_end = 'free'"),
        (lambda: stiff_limit("pinned", 0), "count = 0"),
        (lambda: weak_bending("free"), "driven_end = 'free'"),
    ],
)
def test_refuses(call, message) -> None:
    with pytest.raises(InputError, match=message):
        call()
