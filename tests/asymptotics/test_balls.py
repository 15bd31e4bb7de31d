"""Certified numbers: proved bounds, and the emitted module and evaluate() judged by them."""

from __future__ import annotations

import math
import random
from types import ModuleType

import numpy as np
import pytest
from flint import arb, fmpq

from asymptotics import ClosedForms, Expansion, expand, moving_frame
from asymptotics.errors import InputError, ResonanceError
from asymptotics.expansion.proof import residuals
from asymptotics.printing.numpy_code import numpy_module
from asymptotics.problems.damped import damped_string
from asymptotics.problems.enclosed import ball_damped_string, ball_string
from asymptotics.rings.balls import AcbRing, frequency, outward
from asymptotics.rings.cotangent import CotangentElement, resonance_polynomial
from asymptotics.rings.precision import PrecisionError, at_precision
from asymptotics.values.certified import (
    Enclosure,
    contact_harmonics,
    evaluate_certified,
)
from asymptotics.values.evaluate import evaluate

FREQUENCIES = ["0.83", 2.2, "pi/2 + 1e-9", "pi/3 - 1e-12", "2*pi/5 + 1e-30", "3 pi", 7.0]
UNIT = 2.0**-53


def exact_value(element: CotangentElement, omega: arb) -> arb:
    """An element of the exact ring in balls: the closed form, not the engine's loop."""
    c = omega.cot()
    below = arb(element.denominator)
    for q, m in enumerate(element.poles, start=2):
        poly = resonance_polynomial(q)
        below *= sum((int(a) * c**i for i, a in enumerate(poly.coeffs())), arb(0)) ** m
    above = sum(
        (int(v) * omega ** int(a) * c ** int(i) for (a, i), v in element.numerator.terms()),
        arb(0),
    )
    return above / below


@pytest.mark.parametrize("omega", FREQUENCIES)
def test_balls_meet_the_exact_ring(sixth: Expansion, omega: object) -> None:
    """Two enclosures of one number overlap; both are narrow, so that a wrong one would not."""
    order = 6
    if omega == "3 pi":
        omega = "3 pi + 1e-20"
    with at_precision(1400):
        solution = expand(ball_string(omega), order)
        value = frequency(omega).ball()
        for n in range(1, order + 1):
            assert solution.contact(n).keys() == sixth.contact(n).keys()
            for j, element in sixth.contact(n).items():
                ball, known = solution.contact(n)[j], exact_value(element, value)
                assert ball.overlaps(known)
                for x in (ball, known):
                    assert x.rad() < 1e-40 * abs(x)
                assert not (ball * (1 + arb("1e-30"))).overlaps(known)


def test_more_bits_only_narrow() -> None:
    found = []
    for bits in (64, 256):
        with at_precision(bits):
            found.append(expand(ball_string("pi/2 + 1e-6"), 5))
    for n in range(1, 6):
        for j, wide in found[0].contact(n).items():
            narrow = found[1].contact(n)[j]
            assert wide.contains(narrow)
            assert narrow.rad() < 1e-50 * wide.rad() + arb("1e-60")


@pytest.mark.parametrize("omega", ["0.83", "pi/2 + 1e-9"])
def test_residuals_are_balls_around_zero(omega: str) -> None:
    with at_precision(400):
        solution = expand(ball_string(omega), 5)
        frame = moving_frame(solution)
        for n in range(1, 6):
            for residual in residuals(solution, frame, n):
                assert residual.contains(0)
                assert residual.abs_upper() < 1e-40
            assert all(not c.contains(0) for c in solution.contact(n).values())


@pytest.mark.parametrize(
    ("omega", "damping", "viscosity"),
    [("0.83", "0.1", 0), ("pi", "1e-3", 0), ("pi/2", "0.05", "0.02"), (7.5, 3.0, 0)],
)
def test_damped_residuals_are_balls_around_zero(
    omega: object, damping: object, viscosity: object
) -> None:
    """At a resonance of the undamped string too."""
    with at_precision(400):
        solution = expand(ball_damped_string(omega, damping, viscosity), 4)
        frame = moving_frame(solution)
        for n in range(1, 5):
            left = list(residuals(solution, frame, n))
            assert len(left) > 4
            for residual in left:
                assert residual.contains(0)
                assert residual.abs_upper() < 1e-60
            assert all(not c.contains(0) for c in solution.contact(n).values())


def test_damped_balls_hold_the_damped_numbers() -> None:
    """The residuals do not know what ζ and η are called; the problem over doubles does."""
    numbers = expand(damped_string(0.83, 0.125, 0.0625), 3)
    with at_precision(128):
        balls = expand(ball_damped_string(0.83, 0.125, 0.0625), 3)
    for n in range(1, 4):
        for j, c in numbers.contact(n).items():
            ball = balls.contact(n)[j]
            # Amplitudes of order one, from N³ products.
            assert abs(complex(ball.mid()) - c) <= 27 * 2 * UNIT * max(1.0, abs(c))


def test_a_wrong_shape_leaves_a_ball_without_zero() -> None:
    with at_precision(128):
        solution = expand(ball_damped_string("0.83", "0.1"), 2)
        value, slope = solution.orders[1].shape[2]
        solution.orders[1].shape[2] = (value, slope + arb("1e-20"))
        left = list(residuals(solution, moving_frame(solution), 2))
        assert any(not residual.contains(0) for residual in left)


@pytest.mark.parametrize("omega", [0.83, math.pi / 2, math.pi, "pi/3 - 1e-25", "2*pi/5 + 1e-9"])
def test_harmonics_have_the_accuracy_asked_for(omega: object) -> None:
    """The double nearest π/2 is 6e-17 from the resonance: a true answer all the same."""
    loose, tight = (contact_harmonics(omega, 5, relative=r) for r in (1e-10, 1e-40))
    assert tight.bits > loose.bits
    for n in range(1, 6):
        largest = max(abs(float(e.ball.mid())) for e in tight.amplitudes[n - 1].values())
        for j, enclosure in tight.amplitudes[n - 1].items():
            assert float(enclosure.ball.rad()) <= 1.01e-40 * largest
            assert loose.amplitudes[n - 1][j].ball.overlaps(enclosure.ball)
            assert enclosure.lower < enclosure.upper
    shown = tight.as_json()
    assert shown["order"] == 5
    assert set(shown["amplitudes"]["2"]) == {"0", "2"}


def test_first_amplitudes() -> None:
    """Ω/(2 sin Ω) and −Ω²/(16 sin²Ω), −Ω³ cot 2Ω/(8 sin²Ω)."""
    rows = contact_harmonics("0.83", 2).amplitudes
    x = 0.83
    assert x / (2 * math.sin(x)) == pytest.approx(rows[0][1].lower, rel=8 * UNIT)
    scale = math.sin(x) ** 2
    assert rows[1][0].upper == pytest.approx(-(x**2) / 16 / scale, rel=16 * UNIT)
    assert rows[1][2].upper == pytest.approx(-(x**3) / 8 / math.tan(2 * x) / scale, rel=64 * UNIT)


# -- what the certified numbers judge --------------------------------------------------------------


@pytest.fixture(scope="module")
def modules(sixth: Expansion) -> dict[int, ModuleType]:
    found = {}
    for order in (2, 4, 6):
        module = ModuleType(f"emitted{order}")
        source = numpy_module(ClosedForms(Expansion(sixth.problem, sixth.orders[:order])))
        exec(compile(source, module.__name__, "exec"), module.__dict__)
        found[order] = module
    return found


def cases(order: int, count: int) -> list[tuple[float, float, float, float]]:
    """(s, τ, Ω, ε): half of them 1e-2 … 1e-10 from a resonance, ε such that all orders show."""
    rng = random.Random(order)
    found = []
    while len(found) < count:
        q = rng.randint(1, order)
        omega = rng.randint(1, 3 * q) * math.pi / q
        if len(found) % 2:
            omega += rng.choice([-1, 1]) * 10 ** rng.uniform(-10, -2)
        else:
            omega = rng.uniform(0.3, 9.0)
        distance = min(abs(math.sin(k * omega)) for k in range(1, order + 1))
        epsilon = rng.choice([0.02, 20.0]) * abs(math.sin(omega)) * distance**2 / omega**2
        found.append((-(10 ** rng.uniform(-8, 0)), rng.uniform(0, 7), omega, epsilon))
    return found


@pytest.mark.parametrize("order", [2, 4, 6])
def test_the_emitted_module_keeps_its_bounds(modules: dict[int, ModuleType], order: int) -> None:
    """contact_error and profile_error, to first order in the unit roundoff, hence the 1.01."""
    module, ratios = modules[order], []
    for s, tau, omega, epsilon in cases(order, 80):
        if math.isinf(module.contact_error(tau, omega, epsilon)):
            assert math.isnan(module.contact(tau, omega, epsilon))  # at a resonance, for doubles
            continue
        try:
            true = evaluate_certified(omega, epsilon, order, s, tau)
        except InputError:
            assert math.isnan(module.profile(s, tau, omega, epsilon))  # no rope there
            continue
        for enclosure, value, bound in (
            (
                true.contact,
                module.contact(tau, omega, epsilon),
                module.contact_error(tau, omega, epsilon),
            ),
            (
                true.profile,
                module.profile(s, tau, omega, epsilon),
                module.profile_error(s, tau, omega, epsilon),
            ),
        ):
            ratios.append(enclosure.distance(float(value)) / float(bound))
    assert len(ratios) > 60
    assert max(ratios) <= 1.01
    # A bound that could never be reached says nothing.
    assert max(ratios) >= 1e-4


@pytest.mark.slow
def test_evaluate_is_right_to_its_rounding() -> None:
    """N³ products of size Σ terms, powers of the cotangents right to a few units: see the ratio."""
    order, ratios = 6, []
    for s, tau, omega, epsilon in cases(order, 60):
        try:
            found = evaluate(omega, epsilon, order, [s], [tau])
        except InputError:  # a resonance, a lost ordering, or no rope there
            continue
        true = evaluate_certified(omega, epsilon, order, s, tau)
        ratios.append(true.contact.distance(float(found.contact[0])) / (order**3 * UNIT))
    assert len(ratios) > 20
    assert max(ratios) <= 1.0


def test_a_wrong_digit_is_seen(modules: dict[int, ModuleType]) -> None:
    true = evaluate_certified(0.83, 0.05, 4, -0.5, 0.3)
    value = float(modules[4].contact(0.3, 0.83, 0.05))
    bound = float(modules[4].contact_error(0.3, 0.83, 0.05))
    assert true.contact.distance(value) <= bound
    assert true.contact.distance(value * (1 + 1e-12)) > bound
    assert float(np.float64(value)) != float(true.contact.ball.mid()) or true.contact.lower <= value


def test_the_profile_vanishes_at_the_contact_point() -> None:
    point = evaluate_certified("0.83", "0.05", 3, 0, "0.3")
    assert point.profile.ball == 0
    near = evaluate_certified("0.83", "0.05", 3, "-1e-20", "0.3")
    # w ∼ s² W_ξξ/2: relative accuracy survives.
    assert 0.5e-40 < near.profile.lower < near.profile.upper < 2e-40
    assert near.as_json()["bits"] >= 128


# -- input -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "turns", "offset"),
    [
        ("pi/2", (1, 2), (0, 1)),
        ("3*pi/4 + 0.125", (3, 4), (1, 8)),
        ("2 pi - 1/3", (2, 1), (-1, 3)),
        ("0.1", (0, 1), (1, 10)),
        (0.25, (0, 1), (1, 4)),
    ],
)
def test_frequencies_are_exact(text: object, turns: tuple, offset: tuple) -> None:
    found = frequency(text)
    assert (found.turns.numerator, found.turns.denominator) == turns
    assert (found.offset.numerator, found.offset.denominator) == offset
    assert frequency(found) is found


@pytest.mark.parametrize(
    "omega", ["", "x", "pi/0", "1e99999", None, math.nan, math.inf, -1.0, 0, "pi - 4"]
)
def test_bad_frequencies(omega: object) -> None:
    with pytest.raises(InputError, match="Omega = "):
        contact_harmonics(omega, 2)


def test_exact_resonances_are_named() -> None:
    with pytest.raises(ResonanceError, match="p/q = 2/3") as caught:
        contact_harmonics("4*pi/6", 3)
    assert (caught.value.p, caught.value.q) == (2, 3)
    assert contact_harmonics("2*pi/3", 2).order == 2


def test_what_cannot_be_enclosed_is_said() -> None:
    with pytest.raises(PrecisionError, match="more than 8192 bits") as caught:
        contact_harmonics("pi + 1e-2900", 1)
    assert caught.value.partial
    for relative in (0, 1.0, "x"):
        with pytest.raises(InputError, match="relative = "):
            contact_harmonics(0.83, 1, relative=relative)  # type: ignore[arg-type]
    with pytest.raises(
        InputError, match=r"s = '-3' is beyond the driven end, which is at s = -1\.0112"
    ):
        evaluate_certified("0.83", "0.02", 4, "-3", 0)
    with pytest.raises(InputError, match="beyond the contact"):
        evaluate_certified(0.83, 0.1, 2, 0.5, 0)
    with pytest.raises(InputError, match="epsilon is not"):
        evaluate_certified(0.83, math.nan, 2, -0.5, 0)
    with pytest.raises(InputError, match="damping = -1"):
        ball_damped_string(0.83, -1)


def test_outward_rounding() -> None:
    with at_precision(200):
        third = arb(fmpq(1, 3))
    enclosure = Enclosure.of(third)
    assert enclosure.lower < enclosure.upper
    assert 1 / 3 in enclosure
    assert outward(arb(0.5)) == (math.nextafter(0.5, 0), math.nextafter(0.5, 1))
    assert AcbRing().one == 1
