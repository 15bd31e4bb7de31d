"""One derivation serves all ropes: the polynomials in impedances against every other path."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import quickjs
import sympy as sp
from flint import acb

from asymptotics import expand, prove
from asymptotics.errors import InputError
from asymptotics.expansion.certificates import RefutedError
from asymptotics.expansion.order_loop import Expansion
from asymptotics.formulas.beam import symbolic_beam
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.formulas.rope import RopeForms, is_even, rope_forms
from asymptotics.printing.javascript import javascript_module
from asymptotics.printing.numpy_code import numpy_module
from asymptotics.printing.polynomials import JAVASCRIPT, assignment
from asymptotics.printing.rope_modules import rope_javascript, rope_numpy
from asymptotics.problems.generators import Generators, generator_rope, values_of
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import exact_string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.rings.balls import AcbRing
from asymptotics.rings.precision import at_precision
from asymptotics.rings.ring import GeneratorRing
from asymptotics.values.certified import contact_certified, evaluate_certified
from asymptotics.values.rope import evaluate_rope

KAPPA, ZETA, PHI = sp.symbols("kappa zeta phi")


def guided() -> MovingContact:
    """A beam whose end is guided: its shear is driven, its height free."""
    beta, shear = sp.symbols("beta s")
    return moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - beta * W.diff(xi, 4)),
        driven_end=[
            sp.Eq(W.diff(xi), 0),
            sp.Eq(W.diff(xi, 3), shear * (1 + epsilon * sp.cos(Omega * tau))),
        ],
        contact=[W, W.diff(xi), W.diff(xi, 2)],
    )


ROPES: dict[str, tuple[MovingContact, dict[str, float]]] = {
    "foundation": (string(foundation=KAPPA), {"Omega": 2.2, "kappa": 1.7}),
    "damped, three harmonics": (
        string(foundation=KAPPA, damping=ZETA, drive={0: (0.1, 0), 1: (1, 0), 2: (0.3, PHI)}),
        {"Omega": 2.2, "kappa": 1.7, "zeta": 0.1, "phi": 0.4},
    ),
    "damped clamped beam": (
        beam(driven_end="clamped", damping=ZETA, drive={1: (1, 0), 3: (0.2, 0.5)}),
        {"Omega": 2.2, "beta": 0.01, "zeta": 0.1},
    ),
    "functions of parameters": (
        string(
            foundation=sp.exp(1) * KAPPA + sp.pi / 100 + sp.sqrt(KAPPA) * sp.tanh(KAPPA),
            drive={1: (sp.exp(-PHI), 0), 2: (sp.cosh(PHI) / 5, PHI)},
        ),
        {"Omega": 1.2, "kappa": 0.3, "phi": 0.4},
    ),
    "guided beam": (guided(), {"Omega": 1.3, "beta": 0.05, "s": 18.0}),
    "beam on a slope with a foundation": (
        beam(foundation=KAPPA, ground=xi / 10),
        {"Omega": 2.2, "beta": 0.01, "kappa": 0.5},
    ),
}


@pytest.fixture(scope="module")
def forms() -> dict[str, RopeForms]:
    return {name: rope_forms(rope, 4) for name, (rope, _) in ROPES.items()}


@pytest.mark.parametrize("name", ROPES)
def test_the_polynomials_hold_the_expansion_in_balls(name: str, forms: dict[str, Any]) -> None:
    """Evaluated over balls they meet the order loop's own numbers, to forty digits."""
    rope, at = ROPES[name]
    found = forms[name]
    with at_precision(220):
        problem = rope.at(at, "balls")
        values = values_of(problem, found.generators)
        values = {key: acb(value) for key, value in values.items()}
        series = expand(problem, 4)
        ring = found.expansion.problem.ring
        worst = 0.0
        for n, j in found.places():
            direct = acb(series.contact(n)[j]) * (2 if j else 1)
            value = ring.evaluate(found.contact(n, j), values, AcbRing())
            value = value * acb(problem.inverse_leading) ** n
            assert (value - direct).contains(0)
            worst = max(worst, float(abs((value - direct) / direct).upper()))
        assert worst < 1e-40


def generic(problem: Problem[Any], order: int) -> tuple[Expansion[Any], Any]:
    """The polynomials of its kind, and how to put a problem's own numbers into them."""
    generators = Generators(problem.contact_order, tuple(problem.drive), order, True)
    series = expand(generator_rope(generators), order)
    values, ring = values_of(problem, generators), series.problem.ring
    return series, lambda element: ring.evaluate(element, values, problem.ring)


@pytest.mark.parametrize(("problem", "order"), [(exact_string(), 6), (symbolic_beam(4), 4)])
def test_string_and_beam_are_instances_identically(problem: Problem[Any], order: int) -> None:
    """Exact rings: not a digit, an identity, for ξ_n and the contact data alike."""
    series, at = generic(problem, order)
    own, ring = expand(problem, order), problem.ring
    scale = ring.one
    for n in range(1, order + 1):
        scale = scale * problem.inverse_leading
        assert own.contact(n).keys() == series.contact(n).keys()
        for j, c in own.contact(n).items():
            left = ring.sum([c, ring.rational(-1) * at(series.contact(n)[j]) * scale])
            assert ring.is_zero(left)
        for j, w in own.shape(n).items():
            for i in range(problem.contact_order - 1):
                value = at(series.shape(n)[j][i]) * scale
                # W is in units of a_m there: one power of 1/a_m less.
                left = ring.sum([w[i] * problem.inverse_leading, ring.rational(-1) * value])
                assert ring.is_zero(left)


@pytest.mark.parametrize("contacts", [2, 3, 4, 5])
@pytest.mark.parametrize("even", [True, False])
def test_every_kind_of_contact_is_proved(contacts: int, even: bool) -> None:
    series = expand(generator_rope(Generators(contacts, (1, 2), 3, even)), 3)
    assert prove(series).holds
    order = series.orders[2]
    moved = {j: c + series.problem.ring.one for j, c in order.contact.items()}
    wrong = Expansion(
        series.problem,
        (*series.orders[:2], type(order)(moved, order.shape, order.tails)),
    )
    with pytest.raises(RefutedError):
        prove(wrong)


@pytest.mark.parametrize(
    "generators",
    [Generators(2, (), 2, True), Generators(2, (2, 1), 2, True), Generators(2, (-1,), 2, True)],
)
def test_what_is_no_drive_is_refused(generators: Generators) -> None:
    with pytest.raises(InputError, match="harmonics"):
        generator_rope(generators)


def module(source: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(compile(source, "emitted", "exec"), namespace)
    return namespace


@pytest.fixture(scope="module")
def numpy_modules(forms: dict[str, RopeForms]) -> dict[str, dict[str, Any]]:
    return {name: module(rope_numpy(found)) for name, found in forms.items()}


def parameters(at: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in at.items() if name != "Omega"}


@pytest.mark.parametrize("name", ROPES)
def test_the_numpy_module_computes_its_own_impedances(
    name: str, forms: dict[str, Any], numpy_modules: dict[str, Any]
) -> None:
    rope, at = ROPES[name]
    emitted, series = numpy_modules[name], expand(rope, 4, at=at)
    found = emitted["harmonics"](at["Omega"], **parameters(at))
    place = emitted["static_contact_point"](**parameters(at))
    assert abs(place / complex(series.problem.rest or 0).real - 1) < 1e-13
    for n in range(1, 5):
        size = max(abs(c) for c in series.contact(n).values())
        for j, c in series.contact(n).items():
            assert abs(found[n, j] - c * (2 if j else 1)) < 4e-12 * size


@pytest.mark.parametrize("name", ROPES)
def test_the_emitted_shape_meets_the_moving_frame_to_the_next_order(
    name: str, numpy_modules: dict[str, Any]
) -> None:
    """Both are the same function through ε⁴: what is left falls like ε⁵, and W = drive at ξ = 0."""
    rope, at = ROPES[name]
    emitted = numpy_modules[name]
    left = []
    for small in (4e-3, 2e-3):
        here = evaluate_rope(rope, at, small, 4, [-0.4, -0.1], [0.7])
        places = here.contact[0] + here.s
        shape = emitted["shape"](places, 0.7, at["Omega"], small, **parameters(at))
        left.append(float(np.max(np.abs(shape - here.profile[0]))))
    assert left[0] < 1e-4
    assert left[1] < left[0] / 2**4.4 or left[0] < 1e-12
    if name == "damped, three harmonics":
        drive = 0.1 + np.cos(2.2 * 0.7) + 0.3 * np.cos(4.4 * 0.7 + at["phi"])
        end = emitted["shape"](0.0, 0.7, 2.2, 2e-3, **parameters(at))
        assert abs(end - 1 - 2e-3 * drive) < 1e-13
    assert emitted["shape"](5.0, 0.7, at["Omega"], 1e-3, **parameters(at)) == pytest.approx(
        0.5 if "slope" in name else 0.0
    )
    assert np.isnan(emitted["shape"](-0.1, 0.7, at["Omega"], 1e-3, **parameters(at)))


@pytest.mark.parametrize("name", ROPES)
def test_the_emitted_profile_is_the_moving_frame_s(
    name: str, numpy_modules: dict[str, Any]
) -> None:
    """The same truncated series at fixed s, by Taylor's series about ξ₀ instead of reductions."""
    rope, at = ROPES[name]
    emitted, times = numpy_modules[name], np.array([0.0, 0.7, 2.1])
    here = evaluate_rope(rope, at, 4e-3, 4, [-0.55, -0.4, -0.05, 0.0], times)
    found = emitted["profile"](here.s, times[:, None], at["Omega"], 4e-3, **parameters(at))
    assert np.max(np.abs(found - here.profile)) < 2e-10
    slope = "slope" in name
    ground = emitted["contact"](0.7, at["Omega"], 4e-3, **parameters(at)) / 10 if slope else 0.0
    assert abs(found[1, 3] - ground) < 1e-11
    end = emitted["profile"](-9.0, 0.0, at["Omega"], 4e-3, **parameters(at))
    assert np.isnan(end)
    # It meets the ground smoothly: s to the power of the contact's order.
    near = emitted["profile"](np.array([-2e-2, -1e-2]), 0.7, at["Omega"], 4e-3, **parameters(at))
    if not slope:
        assert abs(np.log2(near[0] / near[1]) - rope.contact_order) < 0.3


def javascript(source: str) -> quickjs.Context:
    context = quickjs.Context()
    context.eval(re.sub(r"^export ", "", source, flags=re.MULTILINE))
    return context


@pytest.mark.parametrize("name", ROPES)
def test_the_javascript_module_says_the_same(
    name: str, forms: dict[str, Any], numpy_modules: dict[str, Any]
) -> None:
    _, at = ROPES[name]
    emitted, context = numpy_modules[name], javascript(rope_javascript(forms[name]))
    given = ", ".join(f"{key}: {value!r}" for key, value in parameters(at).items())
    found = emitted["harmonics"](at["Omega"], **parameters(at))
    listed = f"harmonics({at['Omega']}, {{{given}}})"
    assert context.eval(f"{listed}.length") == len(found)
    for index, ((n, j), value) in enumerate(found.items()):
        entry = [context.eval(f"{listed}[{index}].{part}") for part in ("n", "j", "re", "im")]
        assert entry[:2] == [n, j]
        size = max(abs(x) for (order, _), x in found.items() if order == n)
        assert abs(complex(entry[2], entry[3]) - value) < 4e-12 * size
    for time in (0.0, 0.3, 17.2):
        there = context.eval(f"contact({time}, {at['Omega']}, 0.01, {{{given}}})")
        here = emitted["contact"](time, at["Omega"], 0.01, **parameters(at))
        assert abs(there - here) < 1e-11


def test_the_strings_javascript_is_its_numpy_module() -> None:
    found = ClosedForms(expand(exact_string(), 5))
    emitted, context = module(numpy_module(found)), javascript(javascript_module(found))
    compared = 0
    for omega in (0.83, 2.2, 5.9):
        for time in (0.0, 0.4, 12.0):
            arguments = (time, omega, 0.02)
            bound = float(emitted["contact_error"](*arguments))
            here, there = emitted["contact"](*arguments), context.eval(f"contact{arguments}")
            assert abs(here - there) <= 2 * bound
            for s in (-0.9, -0.3, -1e-6, 0.0, 0.5):
                arguments_s = (s, *arguments)
                bound = float(emitted["profile_error"](*arguments_s))
                here = emitted["profile"](*arguments_s)
                there = context.eval(f"profile{arguments_s}")
                assert np.isnan(here) == (there is None or np.isnan(there))
                if np.isfinite(here):
                    compared += 1
                    assert abs(here - there) <= 2 * bound
    assert compared > 30
    for call in ("contact(0, Math.PI / 2, 0.1)", "contact(0, -1, 0.1)", "profile(-9, 0, 1, 0.1)"):
        assert context.eval(f"Number.isNaN({call})")


def test_arrays_of_points_are_those_points(numpy_modules: dict[str, Any]) -> None:
    emitted = numpy_modules["damped clamped beam"]
    betas, omegas = np.array([1e-3, 0.01, 0.3])[:, None], np.array([1.9, 2.2])
    table = emitted["harmonics"](omegas, beta=betas, zeta=0.1)[3, 1]
    assert table.shape == (3, 2)
    for i in range(3):
        for k in range(2):
            one = emitted["harmonics"](omegas[k], beta=betas[i, 0], zeta=0.1)[3, 1]
            assert abs(table[i, k] - one) < 1e-9 * abs(one)


def test_what_has_no_result_is_nan_and_takes_nobody_with_it(numpy_modules: dict[str, Any]) -> None:
    emitted = numpy_modules["foundation"]
    place = emitted["static_contact_point"](kappa=1.7)
    resonance = np.sqrt((np.pi / place) ** 2 + 1.7)
    found = emitted["contact"](0.0, np.array([2.2, resonance, np.nan]), 0.01, kappa=1.7)
    assert np.isfinite(found).tolist() == [True, False, False]
    with pytest.raises(TypeError, match="kappa"):
        emitted["contact"](0.0, 2.2, 0.01)


def test_thin_layers_do_not_overflow() -> None:
    """β = 1e-6, harmonic 20, in doubles: the right digits, against balls."""
    rope = beam(drive={20: (1, 0)})
    emitted = module(rope_numpy(rope_forms(rope, 2)))
    at = {"beta": 1e-6, "Omega": 2.2}
    found = emitted["harmonics"](2.2, beta=1e-6)
    series = expand(rope, 2, at=at)
    for n in (1, 2):
        for j, c in series.contact(n).items():
            assert abs(found[n, j] / (c * (2 if j else 1)) - 1) < 1e-6


def test_closed_impedances_of_a_second_order_equation() -> None:
    """What the LaTeX prints: Y = k cot kξ₀ − μ, S = −d k e^{−μξ₀}/sin kξ₀."""
    speed = sp.Symbol("v")
    rope = moving_contact(
        equation=sp.Eq(
            W.diff(tau, 2) + 2 * speed * W.diff(xi, tau) - (1 - speed**2) * W.diff(xi, 2), -2
        ),
        driven_end=[sp.Eq(W, 1 + epsilon * sp.cos(Omega * tau))],
        contact=[W, W.diff(xi)],
    )
    found = rope_forms(rope, 2)
    assert not is_even(rope)
    values = found.values({"Omega": 2.2, "v": 0.3})
    place = complex(rope.at({"Omega": 2.2, "v": 0.3}).rest or 0).real
    for j, name in ((1, None), (2, "Y2_1_0")):
        c0, c1, c2 = -((2.2 * j) ** 2), 2 * 0.3 * 2.2j * j, -(1 - 0.09)
        mu = c1 / (2 * c2)
        k = np.sqrt(c0 / c2 - mu**2 + 0j)
        if name:
            assert abs(values[name] - (k / np.tan(k * place) - mu)) < 1e-12
        else:
            expected = -k * np.exp(-mu * place) / np.sin(k * place)
            assert abs(values["S1_1"] - expected) < 1e-12


def test_assignments_add_up_their_terms_sizes() -> None:
    """With magnitudes for the values and 1 for minus, nothing cancels."""
    ring = GeneratorRing(["x", "y", "S"])
    x, y, S = (ring[name] for name in ring.names)
    value = S * S * (x - ring.rational(3) * y) - S * ring.rational(1, 2) * x
    lines = "\n".join(assignment("z", value, ["S"], minus="minus"))
    for minus, expected in ((-1.0, 4 * (2 - 15) - 2), (1.0, 4 * (2 + 15) + 2)):
        scope: dict[str, Any] = {"x": 2.0, "y": 5.0, "S": 2.0, "minus": minus}
        exec(lines, scope)
        assert scope["z"] == expected
    script = "\n".join(assignment("z", value, ["S"], JAVASCRIPT))
    context = quickjs.Context()
    assert context.eval(f"const x = 2, y = 5, S = 2; {script} z") == -54


def test_one_expand_takes_arrays() -> None:
    """10³ points at once, each what it is alone; the proof holds over them."""
    rope = beam(driven_end="clamped", damping=ZETA, foundation=KAPPA)
    betas = np.linspace(0.01, 0.5, 1000)
    at = {"beta": betas, "Omega": 2.2, "zeta": 0.1, "kappa": 0.3}
    series = expand(rope, 4, at=at)
    for i in (0, 499, 999):
        one = expand(rope, 4, at={**at, "beta": float(betas[i])})
        for n in range(1, 5):
            for j, c in one.contact(n).items():
                assert abs(series.contact(n)[j][i] / c - 1) < 1e-9
    assert prove(series).holds


@pytest.mark.parametrize(
    ("at", "says"),
    [
        ({"Omega": np.array([2.2, np.pi])}, "1 of 2 points .* Omega = 3.14159"),
        ({"Omega": np.array([2.2, -1.0])}, "> 0"),
        ({"Omega": np.array([2.2, np.nan])}, "finite"),
        ({"Omega": []}, "0 points"),
        ({"omega": np.array([2.2])}, "no parameter"),
        ({"Omega": ["a"]}, "numbers"),
    ],
)
def test_bad_arrays_are_refused_by_name(at: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        expand(string(), 2, at=at)


@pytest.mark.parametrize("name", ROPES)
def test_certified_contact_points_hold_the_doubles(name: str) -> None:
    """To thirty digits; the string's own certified evaluation is met where it applies."""
    rope, at = ROPES[name]
    doubles = evaluate_rope(rope, at, 0.01, 4, [], [0.3])
    point = contact_certified(rope, at, 0.01, 4, 0.3, 1e-30)
    assert point.contact.distance(float(doubles.contact[0])) < 1e-14
    finer = contact_certified(rope, at, 0.01, 4, 0.3, 1e-60)
    assert point.contact.ball.overlaps(finer.contact.ball)
    assert finer.bits >= point.bits
    assert float(finer.contact.ball.rad()) < 1e-59
    plain = contact_certified(string(), {"Omega": "0.83"}, "0.02", 4, "0.3", 1e-25)
    same = evaluate_certified("0.83", "0.02", 4, "-0.5", "0.3", 1e-25)
    assert plain.contact.ball.overlaps(same.contact.ball)
    with pytest.raises(InputError, match="finite numbers"):
        contact_certified(rope, at, "x", 2, 0)
