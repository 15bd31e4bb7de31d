"""Tongues: the paper's numbers, the closed forms, the pendulum and the engine agree."""

from __future__ import annotations

import math
from fractions import Fraction

import flint
import mpmath
import pytest
import sympy
from flint import arb, fmpq

from asymptotics import Expansion
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import expand
from asymptotics.formulas.normal_form import cotangent_terms
from asymptotics.problems.string import string_problem
from asymptotics.resonances.pendulum import coefficient
from asymptotics.resonances.singular_part import (
    amplitudes,
    centre_shift,
    expanded_part,
    laurent_expansion,
    pole_orders,
    singular_part,
)
from asymptotics.resonances.tongues import limit_law, parse_fraction, tongue
from asymptotics.rings.cotangent import resonance_polynomial
from asymptotics.rings.precision import at_precision
from asymptotics.rings.resonance_field import constant

EPS = 2.0**-52
PI, OMEGA = sympy.pi, sympy.Symbol("Omega")


def exact(p: int, q: int, order: int) -> dict[int, sympy.Expr]:
    return {j: sympy.sympify(a) for j, a in singular_part(p, q, order).text().items()}


# -- the paper -----------------------------------------------------------------------------------


@pytest.mark.parametrize("p", [1, 2, 3, 4])
def test_expandw2_term_by_term(p: int) -> None:
    """2a_j (s − sin(jpπs)/(jpπ)) cos jθ = (−)^p (pπ)⁴/32 · (jpπs − sin jpπs)/j cos jθ, j = 1, 3."""
    s = sympy.Symbol("s")
    part = singular_part(p, 1, 3)
    assert (part.pole, part.order, part.exponent) == (5, 3, Fraction(5, 3))
    ours = exact(p, 1, 3)
    assert sorted(ours) == [1, 3]
    for j, a in ours.items():
        rate = j * p * PI
        printed = sympy.Integer((-1) ** p) * (p * PI) ** 4 / 32 * (rate * s - sympy.sin(rate * s))
        assert sympy.expand(2 * a * (s - sympy.sin(rate * s) / rate) - printed / j) == 0


def test_printed_numbers() -> None:
    """0.309, 1.13, 0.077, 1.815, 0.085: every printed digit, by rounding."""
    first, second, half = tongue(1, 1, 3), tongue(2, 1, 3), tongue(1, 2, 4)
    assert f"{first.sides['+'].coefficient:.3f}" == "0.309"
    assert f"{first.sides['+'].s * math.pi:.2f}" == "-1.13"
    assert f"{first.sides['+'].height * math.pi**2:.3f}" == "0.085"
    assert f"{second.sides['+'].coefficient:.3f}" == "0.077"
    assert f"{second.sides['+'].s * 2 * math.pi:.2f}" == "-1.13"
    assert f"{half.sides['+'].coefficient:.3f}" == "1.815"
    assert (str(first.exponent), str(half.exponent)) == ("5/3", "3/4")
    # ωt = (2n + p)π on the paper's side μ > 0; half a period apart on the other.
    assert [t.sides["+"].theta for t in (first, second)] == [math.pi, 0.0]
    assert [t.sides["-"].theta for t in (first, second)] == [0.0, math.pi]
    # Eq. (grazing): 1/p².
    ratio = first.sides["+"].coefficient / second.sides["+"].coefficient
    assert ratio == pytest.approx(4, rel=16 * EPS)


@pytest.mark.parametrize(("q", "order"), [(1, 3), (2, 4), (3, 6), (4, 4)])
def test_the_touch_solves_the_grazing_conditions(q: int, order: int) -> None:
    """W = W_s = W_θ = 0 for the profile built anew from the exact a_j, in 30 digits."""
    result = tongue(1, q, order)
    a = exact(1, q, order)
    for sign, factor in (("+", 1), ("-", -1)):
        side = result.sides[sign]
        with mpmath.workdps(30):
            omega0 = mpmath.pi / q
            strength = mpmath.mpf(side.coefficient) ** order * factor**result.singular.pole

            def profile(s, theta, strength=strength, omega0=omega0):
                total = s * s
                for j, value in a.items():
                    c = mpmath.mpf(sympy.N(value, 30))
                    rate = j * omega0
                    defect = s - mpmath.sin(rate * s) / rate
                    total += 2 * strength * c * mpmath.cos(j * theta) * defect
                return total

            place = (mpmath.mpf(side.s), mpmath.mpf(side.theta))
            # s and θ are good to the Newton tolerance 16 EPS, C to EPS: W ~ s², its slopes ~ s.
            assert abs(profile(*place)) < 64 * order * EPS * side.s**2
            for n in ((1, 0), (0, 1)):
                assert abs(mpmath.diff(profile, place, n)) < 1024 * EPS * abs(side.s)


def test_exponents_of_the_issue() -> None:
    found = {q: [str(singular_part(1, q, q * n).exponent) for n in range(1, 5)] for q in (1, 2, 3)}
    assert found == {
        1: ["1", "3/2", "5/3", "7/4"],
        2: ["1/2", "3/4", "5/6", "7/8"],
        3: ["1/3", "1/2", "5/9", "7/12"],
    }
    assert [str(singular_part(3, 4, 4 * n).exponent) for n in (1, 2)] == ["1/4", "3/8"]


# -- independent routes to the coefficients ------------------------------------------------------


@pytest.mark.parametrize("p", [1, 2])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6])
def test_cotangent_forms_have_these_poles_at_q_1(sixth: Expansion, p: int, n: int) -> None:
    """κ_q → 1/(qμ) in the closed forms of the exact ring, all κ at once; ε̂ = (−)^p ε/μ."""
    ours = exact(p, 1, n)
    assert ours
    for j, element in sixth.contact(n).items():
        total = Fraction(0)
        for (a, q, m, i), r in cotangent_terms(element).items():
            assert m + i <= n - 1
            if m + i == n - 1:
                assert a == 2 * n - 1  # one power of π
                total += r * p**a / Fraction(q) ** m
        expected = (2 if j else 1) * total * (-1) ** (p * n)
        rest = ours.get(j, sympy.Integer(0)) / PI ** (2 * n - 1)
        assert rest == sympy.Rational(expected.numerator, expected.denominator)


@pytest.mark.parametrize(("p", "n"), [(1, 1), (1, 2), (1, 3), (3, 2), (5, 3)])
def test_cotangent_forms_have_these_poles_at_q_2(sixth: Expansion, p: int, n: int) -> None:
    """At Ω₀ = pπ/2 odd cotangents vanish, even ones are 1/(qμ), and sin² Ω₀ = 1."""
    ours = exact(p, 2, 2 * n)
    for j, element in sixth.contact(2 * n).items():
        total = sympy.Integer(0)
        for (a, q, m, i), r in cotangent_terms(element).items():
            if q % 2 == 0 and i == 0:
                assert m <= 2 * n - 1
                if m == 2 * n - 1:
                    rational = sympy.Rational(r.numerator, r.denominator)
                    total += rational * (p * PI / 2) ** a / sympy.Integer(q) ** m
        assert sympy.expand(ours.get(j, sympy.Integer(0)) - (2 if j else 1) * total) == 0
    assert ours


@pytest.mark.parametrize(("p", "q", "n"), [(1, 3, 1), (1, 3, 2), (2, 3, 2), (2, 5, 1), (5, 6, 1)])
def test_poles_of_the_canonical_fractions(sixth: Expansion, p: int, q: int, n: int) -> None:
    """A(Ω, c)/(d Π Ψ^m) with Ψ_q ≈ −Ψ_q′(c₀)(1 + c₀²) μ, evaluated in balls."""
    part = singular_part(p, q, q * n)
    with at_precision(300):
        omega, c = arb.pi() * p / q, (arb(p) / q).cot_pi()
        for j, element in sixth.contact(q * n).items():
            element = element.canonical()
            powers = dict(enumerate(element.poles, start=2))
            assert powers.get(q, 0) <= part.pole
            ball = arb(0)
            if powers.get(q, 0) == part.pole:
                for (a, i), r in element.numerator.terms():
                    ball += arb(int(r)) * omega ** int(a) * c ** int(i)
                for k, m in powers.items():
                    poly = resonance_polynomial(k)
                    if k == q:
                        ball /= (-at(poly.derivative(), c) * (1 + c * c)) ** m
                    else:
                        ball /= at(poly, c) ** m
                ball *= (2 if j else 1) / omega.sin() ** (q * n) / element.denominator
            ours = part.field.value(part.harmonics.get(j, constant(0)), 300)
            assert ours.overlaps(ball)
            assert abs(ours).rad() < arb(10) ** -60
    assert part.harmonics


def at(poly: flint.fmpz_poly, x: arb) -> arb:
    return sum((arb(a) * x**i for i, a in enumerate(poly.coeffs())), arb(0))


@pytest.mark.parametrize(("p", "q", "n"), [(1, 1, 3), (1, 2, 2), (2, 3, 1), (1, 4, 2)])
def test_small_finite_mu(p: int, q: int, n: int) -> None:
    """The engine over 60-digit numbers at μ = 10⁻¹² and half of it: the error halves."""
    values = singular_part(p, q, q * n).text()
    with mpmath.workdps(80):
        errors = []
        for mu in (mpmath.mpf(10) ** -12, mpmath.mpf(10) ** -12 / 2):
            omega = p * mpmath.pi / q + mu
            ring = BigRing()
            solution = expand(
                string_problem(ring, omega, lambda j, x=omega: mpmath.cot(j * x)), q * n
            )
            worst = mpmath.mpf(0)
            for j, c in solution.contact(q * n).items():
                found = (2 if j else 1) * c / mpmath.sin(omega) ** (q * n) * mu ** (2 * n - 1)
                limit = mpmath.mpf(sympy.N(sympy.sympify(values.get(j, "0")), 60))
                worst = max(worst, abs(found - limit))
            errors.append(worst)
        assert errors[1] / errors[0] == pytest.approx(0.5, abs=1e-6)
        assert errors[0] > 0


class BigRing:
    """mpmath numbers at the working precision."""

    even = True
    zero, one = mpmath.mpf(0), mpmath.mpf(1)

    def rational(self, numerator, denominator=1):
        return mpmath.mpf(numerator) / denominator

    def sum(self, terms):
        return mpmath.fsum(terms)

    def conjugate(self, element):
        return element

    def is_zero(self, element):
        return element == 0


# -- the pendulum --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("p", "q", "last"), [(1, 1, 8), (2, 1, 5), (1, 2, 4), (3, 2, 3), (1, 3, 3), (2, 3, 2)]
)
def test_the_engine_follows_the_pendulum_to_all_orders(p: int, q: int, last: int) -> None:
    """a_{kq} = Ω₀^{n−1} a₁^n A_{n,k}, exactly, for q ≤ 3: nothing but the pendulum is singular."""
    first = singular_part(p, q, q)
    field, a1 = first.field, first.harmonics[q]
    for n in range(1, last + 1):
        part = expanded_part(p, q, q * n)
        assert part.variable == "mu"
        assert sorted(part.harmonics) == [k * q for k in range(n % 2 or 2, n + 1, 2)]
        for j, a in part.harmonics.items():
            A = coefficient(n, j // q)
            expected = field.centre ** (n - 1) * a1**n * fmpq(A.numerator, A.denominator)
            assert field.reduce(a - expected).is_zero()


@pytest.mark.parametrize(("p", "q"), [(1, 2), (1, 3), (2, 3), (1, 4), (3, 4), (1, 5), (3, 5)])
def test_the_shift_makes_the_next_pole(p: int, q: int) -> None:
    """a₁/(μ − γε²) = a₁/μ + a₁γε²/μ² + …: γ from the rotation number, the pole from the engine."""
    expansion = laurent_expansion(p, q, q + 2)
    field = singular_part(p, q, q).field
    first = expansion.contact(q)[q].coefficient(-1)
    # sin^{−2} Ω₀ = 1 + c² takes ε̂^{q+2}/ε̂^q to ε².
    c = field.cot(1)
    double = expansion.contact(q + 2)[q].coefficient(-2) * (1 + c * c)
    assert field.reduce(first * centre_shift(p, q) - double).is_zero()
    assert not field.reduce(double).is_zero()


def test_q_4_has_the_shift_in_its_leading_part_and_5_is_led_by_it() -> None:
    """(ε²/μ)² next to ε⁴/μ² at q = 4; beyond, worse poles at orders that are no multiple of q."""
    part = expanded_part(1, 4, 8)
    field, first = part.field, singular_part(1, 4, 4).harmonics[4]
    shift = centre_shift(1, 4)
    assert sorted(part.harmonics) == [4, 8]
    # a₁/(μ − γε² − γ₂ε⁴ …): beside γ² the regular part of order ε⁴ cannot reach μ⁻³.
    assert field.reduce(part.harmonics[4] - first * shift**2).is_zero()
    assert pole_orders(1, 4, 8) == (0, 0, 0, 1, 1, 2, 2, 3)
    poles = pole_orders(1, 5, 10)
    assert poles[9] / 10 < poles[8] / 9
    assert singular_part(1, 5, 10).variable == "mu_eff"
    assert singular_part(1, 5, 5).variable == "mu"
    for q, last in ((1, 6), (2, 8), (3, 9)):
        poles = pole_orders(1, q, last)
        ratios = [Fraction(e, m) for m, e in enumerate(poles, start=1)]
        for n in range(1, last // q + 1):
            assert poles[q * n - 1] == 2 * n - 1
            if n > 1:
                assert max(ratios[: q * n]) == Fraction(2 * n - 1, q * n)


def test_pole_orders_do_not_overlook_a_pole() -> None:
    """Against full amplitudes with a longer mantissa."""
    expansion = laurent_expansion(1, 2, 8, terms=6)
    for n in (1, 2, 3, 4):
        lowest = min(a.leading()[0] for a in amplitudes(expansion, n).values())
        assert pole_orders(1, 2, 8)[2 * n - 1] == -lowest == 2 * n - 1


@pytest.mark.parametrize(
    ("p", "q", "order"),
    [
        (1, 1, 9),
        (2, 1, 6),
        (3, 2, 8),
        (2, 3, 9),
        (1, 4, 4),
        (1, 4, 12),
        (3, 4, 8),
        (2, 5, 5),
        (5, 7, 7),
    ],
)
def test_the_short_way_is_the_whole_expansion(p: int, q: int, order: int) -> None:
    """One-sided harmonics and the pendulum's coefficients against everything the engine has."""
    short, whole = singular_part(p, q, order), expanded_part(p, q, order)
    assert short.harmonics == whole.harmonics
    assert short.harmonics
    assert (short.pole, short.variable) == (whole.pole, whole.variable)


def test_the_radius_of_the_series_in_mu_at_q_4() -> None:
    """Root test: |a_n|^{1/n} → R^{−4}, where γε² ∼ μ adds to what the pendulum alone would give."""
    for p in (1, 3):
        law = limit_law(p, 4)
        sizes = {
            n: max(abs(a) for a in singular_part(p, 4, 4 * n).values().values()) for n in (16, 32)
        }
        # From n to 2n a power of n drops out of the root: Richardson's step.
        found = (sizes[32] / sizes[16]) ** (1 / 16)
        assert found == pytest.approx(law.radius**-4, rel=0.1)
        assert abs(found / law.coefficient**-4 - 1) > 0.5


@pytest.mark.slow
def test_strengths_without_digits_to_spare() -> None:
    """Coefficients that cancel to a part in 10³⁰ and less keep their sign and their digits."""
    for p, q in ((7, 50), (1, 40)):
        law = limit_law(p, q)
        assert law.coefficient > 0
        field = singular_part(p, q, q).field
        rough, fine = (field.value(singular_part(p, q, q).harmonics[q], bits) for bits in (64, 400))
        assert rough.rel_accuracy_bits() >= 64
        assert rough.overlaps(fine)


def test_ranges() -> None:
    """Where the touch is beyond convergence, and how far the limit law holds."""
    for p, crossing in ((1, 15.1), (2, 15.1)):
        found = tongue(p, 1, 3)
        assert [found.window(sign) for sign in "+-"] == [None, None]
        assert found.sides["+"].divergent == pytest.approx(crossing, abs=0.05)
    assert tongue(1, 2, 4).sides["-"].divergent == pytest.approx(4.13, abs=0.005)
    assert tongue(1, 2, 4).window("-") is None
    # ξ_1 = ½Ω cot-like pole: Ω/(2 sin Ω) ≈ −(π/2 + μ/2)/μ, so b = 1/π.
    law = limit_law(1, 1)
    assert law.next_terms == pytest.approx((1 / math.pi, 0.0), rel=4 * EPS)
    assert law.range == pytest.approx(0.1 * math.pi / 4, rel=1e-9)
    assert law.error(law.range) == pytest.approx(0.1, rel=1e-9)
    assert limit_law(1, 5).range is None
    assert limit_law(1, 5).error(0.01) is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((1, 61, 61), "give q ≤ 60"), ((1, 1, 81), "give an order ≤ 80"), ((1, 5, 10), None)],
)
def test_limits_say_why(arguments: tuple[int, int, int], message: str | None) -> None:
    if message is None:
        with pytest.raises(InputError, match="use singular_part"):
            expanded_part(*arguments)
        return
    with pytest.raises(InputError, match=message):
        singular_part(*arguments)


def test_limit_laws() -> None:
    """ε = μ²/(8p²), ε = 4μ/(πp²) and v_q of the standard map's first resonances."""
    for p in (1, 2, 3):
        law = limit_law(p, 1)
        assert law.coefficient == pytest.approx(1 / (8 * p * p), rel=EPS)
        assert sympy.sympify(law.strength) == 2 * (p * PI) ** 2
        assert (law.exponent, law.shift) == (2, "0")
    for p in (1, 3, 5):
        law = limit_law(p, 2)
        # V₂ = K²/16 with K = 2εΩ₀².
        assert sympy.sympify(law.strength) == (p * PI / 2) ** 4 / 4
        assert law.coefficient == pytest.approx(4 / (math.pi * p * p), rel=2 * EPS)
    for p, q in ((1, 3), (2, 3), (1, 4), (2, 5)):
        law = limit_law(p, q)
        v = float(sympy.N(sympy.sympify(law.strength), 30))
        expected = (math.pi**2 / (4 * v)) ** (1 / q)
        assert law.coefficient == pytest.approx(expected, rel=4 * EPS)
        # K^q = (2εΩ₀²)^q times an algebraic number: one power of π.
        degree = {
            int(t.as_coeff_exponent(PI)[1])
            for t in sympy.Add.make_args(sympy.sympify(law.strength))
        }
        assert degree == {2 * q}


@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (1, 2), (3, 2), (1, 3)])
def test_coefficients_are_universal(p: int, q: int) -> None:
    """C^{qn} = (4/v)^n g_n/q, g_n the same for all p/q: a consequence for both sides."""
    law, n = limit_law(p, q), 4
    result, reference = tongue(p, q, q * n), tongue(1, 1, n)
    v = float(sympy.N(sympy.sympify(law.strength), 30))
    ours = sorted(side.coefficient ** (q * n) * q * (v / 4) ** n for side in result.sides.values())
    base = 2 * math.pi**2
    theirs = sorted(side.coefficient**n * (base / 4) ** n for side in reference.sides.values())
    assert ours == pytest.approx(theirs, rel=64 * EPS)
    assert ours[1] > 1.1 * ours[0]


def test_even_orders_have_two_sides_from_n_4_on() -> None:
    """n = 2 has one harmonic, and its sides differ by a quarter of its period only."""
    for q in (1, 2, 3):
        second, fourth = tongue(1, q, 2 * q).sides, tongue(1, q, 4 * q).sides
        assert second["+"].coefficient == pytest.approx(second["-"].coefficient, rel=8 * EPS)
        thetas = [second[sign].theta for sign in "+-"]
        assert abs(thetas[0] - thetas[1]) == pytest.approx(math.pi / (2 * q), rel=8 * EPS)
        ratio = fourth["+"].coefficient / fourth["-"].coefficient
        assert abs(ratio ** (4 * q) - 1) > 0.1


def test_the_march_to_the_limit() -> None:
    """Exponents 2 − 1/n; coefficients fall towards 1/8, slowly and from above.

    By the radius of convergence C/C∞ → 1. Seen: C/C∞ = n^{a/n} with a = 2.47, 2.07, 1.91, 1.82,
    1.74 falling, so that the bound by a = 2.5 goes to 1.
    """
    ratios = {n: tongue(1, 1, n).sides["-"].coefficient * 8 for n in (3, 5, 7, 9, 12)}
    powers = [n * math.log(ratio) / math.log(n) for n, ratio in ratios.items()]
    for falling in (list(ratios.values()), powers):
        assert falling == sorted(falling, reverse=True)
    assert powers[0] < 2.5
    for n, ratio in ratios.items():
        assert singular_part(1, 1, n).exponent == 2 - Fraction(1, n)
        assert ratio > 1


# -- input ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("2/4", r"not in lowest terms.*1/2"),
        ("3/3", r"1/1"),
        ("0/1", "p = 0"),
        ("1/0", "q = 0"),
        ("-1/2", "give p/q"),
        ("1.5", "give p/q"),
        ("a/b", "give p/q"),
        ("", "give p/q"),
        ("1/2/3", "give p/q"),
        ("¹/2", "give p/q"),
    ],
)
def test_bad_fractions(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        parse_fraction(text)


def test_bad_orders() -> None:
    with pytest.raises(InputError, match=r"order = 2 has no pole at p/q = 1/3.*order ≥ 3"):
        tongue(1, 3, 2)
    for order in (0, -3, 2.5, "4", True):
        with pytest.raises(InputError, match="order = "):
            tongue(1, 1, order)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="lowest terms"):
        tongue(2, 2, 4)
    with pytest.raises(InputError, match="give q ≥ 2"):
        centre_shift(3, 1)


def test_an_order_between_multiples_is_set_by_the_one_below() -> None:
    between, below = tongue(1, 2, 5), tongue(1, 2, 4)
    assert (between.order, between.singular.order) == (5, 4)
    assert between.sides == below.sides
