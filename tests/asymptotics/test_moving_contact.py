"""Any linear equation through one door: the known ropes come out, what is no rope is refused."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Any

import pytest
import sympy as sp
from flint import acb
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from asymptotics import Expansion, expand, float_string, prove
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Order
from asymptotics.expansion.proof import RefutedError
from asymptotics.problems import presets
from asymptotics.problems.beam import float_beam
from asymptotics.problems.damped import damped_string
from asymptotics.problems.forcing import forced_string, fourier_drive
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.rings.precision import at_precision

EPS = 2.0**-52
kappa, beta = sp.symbols("kappa beta")
COSINE = epsilon * sp.cos(Omega * tau)
WAVE = sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2)
HELD = sp.Eq(W, 1 + COSINE)
STRING = [W, W.diff(xi)]
BEAM = [W, W.diff(xi), W.diff(xi, 2)]
BENDING = sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - beta * W.diff(xi, 4))


def foundation() -> MovingContact:
    return moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
        driven_end=[HELD],
        contact=STRING,
    )


def equal(found: Expansion[Any], wanted: Expansion[Any], units: float = 4) -> None:
    """To a few units in the last place of each order's largest coefficient."""
    assert found.order == wanted.order
    for n in range(1, wanted.order + 1):
        largest = max(map(abs, wanted.contact(n).values()))
        assert found.contact(n).keys() == wanted.contact(n).keys()
        for j, c in wanted.contact(n).items():
            assert abs(found.contact(n)[j] - c) <= units * EPS * largest


def test_the_foundation_string() -> None:
    series = expand(foundation(), 4, at={kappa: 1.7, Omega: 2.2})
    rest = math.acosh(1 + 1.7 / 2) / math.sqrt(1.7)
    assert series.problem.rest == pytest.approx(rest, rel=4 * EPS)
    assert 2 * series.contact(1)[1] == pytest.approx(0.890012519029, rel=1e-12)
    assert series.contact(2)[0] == pytest.approx(-0.306899750922, rel=1e-12)
    assert 2 * series.contact(2)[2] == pytest.approx(-0.794087307576, rel=1e-12)
    proofs = prove(series)
    assert [proof.holds for proof in proofs] == [True] * 5
    assert max(size for proof in proofs for size in proof.sizes) < 1e-14


@pytest.mark.parametrize("omega", [0.83, 2.2, 5.1])
def test_the_string_comes_out(omega: float) -> None:
    small = expand(float_string(omega, 6), 6)
    found = expand(presets.string(), 6, at={Omega: omega})
    for n in range(1, 7):
        for j, c in small.contact(n).items():
            # The string's small parameter is ε/sin Ω.
            assert found.contact(n)[j] == pytest.approx(c / math.sin(omega) ** n, rel=64 * EPS)


@pytest.mark.parametrize("driven_end", ["pinned", "clamped"])
@pytest.mark.parametrize(
    ("beta_", "omega"),
    [
        (10.0, 0.5),
        (0.01, 2.2),
        (1e-4, 5.1),
        pytest.param(1e-6, 2.2, marks=pytest.mark.slow),
    ],
)
def test_the_beam_comes_out(driven_end: str, beta_: float, omega: float) -> None:
    found = expand(presets.beam(driven_end=driven_end), 4, at={"beta": beta_, "Omega": omega})
    equal(found, expand(float_beam(beta_, omega, 4, driven_end), 4))


def test_damping_and_several_frequencies_come_out() -> None:
    damped = presets.string(damping=sp.Symbol("zeta"), viscosity=sp.Symbol("eta"))
    found = expand(damped, 5, at={"zeta": 0.1, "eta": 0.02, "Omega": 3.1})
    equal(found, expand(damped_string(3.1, 0.1, 0.02), 5))
    two = presets.string(drive={1: (1, 0), 3: (sp.Rational(1, 5), sp.Rational(1, 2))})
    drive = fourier_drive([0.83], {1: 1.0, 3: 0.2 * math.cos(0.5)}, {3: -0.2 * math.sin(0.5)})
    equal(expand(two, 4, at={"Omega": 0.83}), expand(forced_string(drive, 4), 4), units=16)


def test_symbols_of_the_reader_s_own() -> None:
    x, t, Omega_, small = sp.symbols("x t Omega epsilon")
    U = sp.Function("U")(x, t)
    rope = moving_contact(
        equation=U.diff(t, 2) - U.diff(x, 2) + 2 + sp.Symbol("kappa") * U,
        driven_end=[sp.Eq(U, 1 + small * sp.cos(Omega_ * t))],
        contact=[U.diff(x), U],
    )
    wanted = expand(foundation(), 3, at={kappa: 1.7, Omega: 2.2})
    equal(expand(rope, 3, at={"kappa": 1.7, "Omega": 2.2}), wanted)


def test_the_equation_may_be_multiplied_through() -> None:
    rope = moving_contact(
        equation=sp.Eq(-3 * W.diff(tau, 2), -3 * W.diff(xi, 2) + 6 + 3 * kappa * W),
        driven_end=[sp.Eq(5 * W, 5 + 5 * COSINE)],
        contact=STRING,
    )
    equal(
        expand(rope, 3, at={kappa: 1.7, Omega: 2.2}),
        expand(foundation(), 3, at={kappa: 1.7, Omega: 2.2}),
    )


def test_a_curved_ground_under_a_foundation() -> None:
    """Taken off by hand: V = W − g lies flat, with the load and the height that this leaves."""
    g = sp.Rational(1, 10) * xi + sp.Rational(1, 20) * xi**2
    over = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
        driven_end=[HELD],
        contact=STRING,
        ground=g,
    )
    flat = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) + g.diff(xi, 2) - 2 - kappa * (W + g)),
        driven_end=[HELD],
        contact=STRING,
    )
    at = {kappa: 1.7, Omega: 2.2}
    found = expand(over, 4, at=at)
    equal(found, expand(flat, 4, at=at))
    assert prove(found).holds
    assert found.problem.rest != pytest.approx(math.acosh(1.85) / math.sqrt(1.7), rel=1e-3)


def test_over_balls_the_proof_encloses_zero() -> None:
    with at_precision(128):
        series = expand(foundation().at({kappa: "1.7", Omega: "2.2"}, "balls"), 3)
        proofs = prove(series)
        assert all(proof.kind == "balls" and proof.holds for proof in proofs)
        assert max(size for proof in proofs for size in proof.sizes) < 1e-25


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "nonlinear": ({"equation": WAVE.lhs - WAVE.rhs + W**2}, "W(xi, tau)**2 is not linear"),
    "slope squared": (
        {"equation": W.diff(tau, 2) - W.diff(xi, 2) * (1 + W.diff(xi) ** 2) + 2},
        "is not linear",
    ),
    "too few conditions": ({"equation": BENDING, "contact": BEAM}, "needs r - m + 1 = 2"),
    "too many conditions": ({"driven_end": [HELD, sp.Eq(W.diff(xi), 0)]}, "needs r - m + 1 = 1"),
    "a gap at the contact": ({"contact": [W, W.diff(xi, 2)]}, "without a gap"),
    "no contact": ({"contact": []}, "at least two"),
    "contact with a value": ({"contact": [sp.Eq(W, 1), W.diff(xi)]}, "which vanish"),
    "nothing driven": ({"driven_end": [sp.Eq(W, 1)]}, "no condition is driven"),
    "not periodic": (
        {"driven_end": [sp.Eq(W, 1 + epsilon * tau * sp.cos(Omega * tau))]},
        "not a finite sum of cos",
    ),
    "decays": ({"driven_end": [sp.Eq(W, 1 + epsilon * sp.exp(-tau))]}, "not a finite sum of cos"),
    "no multiple": (
        {"driven_end": [sp.Eq(W, 1 + epsilon * sp.cos(sp.sqrt(2) * Omega * tau))]},
        "n whole",
    ),
    "a pole in time": (
        {"driven_end": [sp.Eq(W, 1 + epsilon / sp.cos(Omega * tau))]},
        "not a finite sum of cos",
    ),
    "ε squared": (
        {"driven_end": [sp.Eq(W, 1 + epsilon**2 * sp.cos(Omega * tau))]},
        "epsilon times a periodic",
    ),
    "ε in the equation": ({"equation": sp.Eq(WAVE.lhs, WAVE.rhs + epsilon * W)}, "ε stands in it"),
    "varying tension": (
        {"equation": sp.Eq(WAVE.lhs, sp.exp(xi) * W.diff(xi, 2) - 2)},
        "has to be a constant, or a polynomial in xi",
    ),
    "load in time": ({"equation": sp.Eq(WAVE.lhs, WAVE.rhs + sp.cos(tau))}, "depends on tau"),
    "order nine": ({"equation": sp.Eq(WAVE.lhs, W.diff(xi, 9) - 2)}, "between 1 and 8"),
    "derivative too high": (
        {"driven_end": [sp.Eq(W.diff(xi, 2), COSINE)]},
        "conditions are on lower derivatives",
    ),
    "two unknowns": (
        {"equation": sp.Eq(WAVE.lhs, WAVE.rhs + sp.Function("V")(xi, tau))},
        "write them for one function",
    ),
    "imaginary drive": (
        {"driven_end": [sp.Eq(W, 1 + sp.I * COSINE)]},
        "the drive is not real",
    ),
    "ground no polynomial": ({"ground": sp.sin(xi)}, "not a polynomial"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_well_posed_is_refused_with_the_reason(name: str) -> None:
    given_, reason = REFUSED[name]
    whole = {"equation": WAVE, "driven_end": [HELD], "contact": STRING, **given_}
    with pytest.raises(InputError) as caught:
        expand(moving_contact(**whole), 1, at={Omega: 2.2})
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("at", "reason"),
    [
        ({kappa: 1.7}, "Omega has no value"),
        ({Omega: 2.2}, "kappa has no value"),
        ({kappa: 1.7, Omega: 2.2, beta: 1}, "beta is no parameter"),
        ({kappa: math.nan, Omega: 2.2}, "not a finite number"),
        ({kappa: "x", Omega: 2.2}, "not a finite number"),
        ({kappa: 1.7, Omega: 0}, "must be positive"),
        (None, "has no value"),
    ],
)
def test_values_are_asked_for(at: Any, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        expand(foundation(), 2, at=at)


def test_values_for_a_problem_that_has_them_are_refused() -> None:
    with pytest.raises(InputError, match="has its numbers already"):
        expand(float_string(2.2, 2), 2, at={Omega: 2.2})


def test_expansions_pickle_and_go_on() -> None:
    series = expand(foundation(), 2, at={kappa: 1.7, Omega: 2.2})
    loaded = pickle.loads(pickle.dumps(series))
    equal(
        expand(loaded.problem, 3, start=loaded),
        expand(foundation(), 3, at={kappa: 1.7, Omega: 2.2}),
    )


def test_no_static_shape() -> None:
    weightless = sp.Eq(W.diff(tau, 2), W.diff(xi, 2) + 2)
    rope = moving_contact(equation=weightless, driven_end=[HELD], contact=STRING)
    with pytest.raises(InputError, match="no static shape"):
        expand(rope, 1, at={Omega: 2.2})


def test_a_shape_below_the_ground() -> None:
    """Turned over twice: held below the ground, the parabola through it is negative."""
    rope = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) + 2),
        driven_end=[sp.Eq(W, -1 + COSINE)],
        contact=STRING,
    )
    with pytest.raises(InputError, match="is below it"):
        expand(rope, 1, at={Omega: 2.2})


def test_a_ground_that_would_have_to_pull() -> None:
    """2 − g″ < 0: the rope spans a ground so curved instead of lying on it."""
    rope = moving_contact(
        equation=WAVE, driven_end=[sp.Eq(W, 5 + COSINE)], contact=STRING, ground=xi**2 * 3 / 2
    )
    with pytest.raises(InputError, match="no static shape"):
        expand(rope, 1, at={Omega: 2.2})
    far = moving_contact(
        equation=WAVE, driven_end=[HELD], contact=STRING, ground=(xi - 3) ** 3 / 1000
    )
    with pytest.raises(InputError, match="have to pull"):
        expand(far, 1, at={Omega: 2.2})


def test_a_leading_coefficient_that_vanishes() -> None:
    """W_ξξ + W_ξξττ/4: nothing is left of it at harmonic 2 of Ω = 1."""
    rope = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) + W.diff(xi, 2, tau, 2) / 4 - 2),
        driven_end=[HELD],
        contact=STRING,
    )
    assert expand(rope, 1, at={Omega: 1}).order == 1
    with pytest.raises(InputError, match="vanishes at harmonic 2"):
        expand(rope, 2, at={Omega: 1})


def test_next_to_a_resonance_all_digits_are_there() -> None:
    """The double nearest to π: sin Ω is 1e-16, and ξ₁ = Ω/(2 sin Ω) as exact as ever."""
    series = expand(presets.string(), 1, at={Omega: math.pi})
    assert 2 * series.contact(1)[1] == pytest.approx(math.pi / (2 * math.sin(math.pi)), rel=4 * EPS)


coefficient = st.integers(-8, 8).map(lambda n: sp.Rational(n, 8))
positive = st.integers(1, 16).map(lambda n: sp.Rational(n, 8))


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    st.fixed_dictionaries(
        {
            "foundation": st.integers(0, 16).map(lambda n: sp.Rational(n, 8)),
            "damping": coefficient,
            "mixed": coefficient,
            "rotary": st.integers(0, 4).map(lambda n: sp.Rational(n, 32)),
            "bending": st.sampled_from([0, sp.Rational(1, 20), 1]),
            "omega": positive,
            "phase": coefficient,
            "second": coefficient,
            "end": st.integers(1, 3),
        }
    ),
    st.integers(0, 10**6),
)
def test_random_ropes_are_proved_and_a_moved_coefficient_is_not(
    drawn: dict[str, Any], which: int
) -> None:
    left = W.diff(tau, 2) + drawn["damping"] * W.diff(tau) + drawn["mixed"] * W.diff(xi, tau)
    right = W.diff(xi, 2) - 2 - drawn["foundation"] * W + drawn["rotary"] * W.diff(xi, 2, tau, 2)
    drive = sp.cos(Omega * tau + drawn["phase"]) + drawn["second"] * sp.sin(2 * Omega * tau)
    ends = [sp.Eq(W, 1 + epsilon * drive)]
    if drawn["bending"]:
        ends.append(sp.Eq(W.diff(xi, drawn["end"]), 0))
    rope = moving_contact(
        equation=sp.Eq(left, right - drawn["bending"] * W.diff(xi, 4)),
        driven_end=ends,
        contact=BEAM if drawn["bending"] else STRING,
    )
    at = {Omega: drawn["omega"]}
    try:
        with at_precision(256):
            series = expand(rope.at(at, "balls"), 2)
    except InputError:
        assume(False)  # at a rest that does not exist, or where the leading coefficient vanishes
    with at_precision(256):
        assert prove(series).holds
        order = series.orders[1]
        j = sorted(order.contact)[which % len(order.contact)]
        moved = {**order.contact, j: order.contact[j] + acb(1e-6).real}
        wrong = Order(moved, order.shape, order.tails)
        with pytest.raises(RefutedError):
            prove(replace(series, orders=(series.orders[0], wrong)))


@pytest.mark.parametrize("value", ["1.7", [1], None])
def test_presets_take_numbers_and_symbols(value: object) -> None:
    with pytest.raises(InputError, match="give a number"):
        presets.string(foundation=value)
    with pytest.raises(InputError, match="give a number"):
        presets.beam(damping=value)
