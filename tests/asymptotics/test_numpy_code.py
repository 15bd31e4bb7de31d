"""The emitted module: right to a few ulp, honest where it is not, and what it promises to be."""

from __future__ import annotations

import math
import random
import re
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from asymptotics import ClosedForms, Expansion, expand, float_string
from asymptotics.errors import ResonanceError
from asymptotics.printing.numpy_code import _term, numpy_module
from asymptotics.values.evaluate import evaluate

UNIT = 2.0**-53


def module_from(source: str) -> ModuleType:
    module = ModuleType("emitted")
    exec(compile(source, "emitted", "exec"), module.__dict__)
    return module


@pytest.fixture(scope="module")
def modules(sixth: Expansion) -> dict[int, ModuleType]:
    return {
        order: module_from(
            numpy_module(ClosedForms(Expansion(sixth.problem, sixth.orders[:order])))
        )
        for order in (1, 2, 4, 6)
    }


def reference(order: int, s: float, tau: float, omega: float, epsilon: float) -> tuple[mpf, mpf]:
    """ξ_c and w/Z₀ at 50 digits from the engine over mpmath numbers: no closed form involved."""
    from asymptotics import moving_frame, string_problem
    from asymptotics.rings.ring import FloatRing

    class DigitRing(FloatRing):
        zero, one = mpf(0), mpf(1)

        def rational(self, numerator: int, denominator: int = 1) -> mpf:
            return mpf(numerator) / denominator

        def sum(self, terms: object) -> mpf:
            return mpmath.fsum(terms)

        def is_zero(self, element: object) -> bool:
            return element == 0

    s, tau, omega, epsilon = (mpf(float(x)) for x in (s, tau, omega, epsilon))
    problem = string_problem(DigitRing(), omega, lambda j: mpmath.cot(j * omega))
    expansion = expand(problem, order)
    small = epsilon / mpmath.sin(omega)

    def fourier(harmonics: dict[int, mpf]) -> mpf:
        return mpmath.fsum(
            (1 if j == 0 else 2) * c * mpmath.cos(j * omega * tau) for j, c in harmonics.items()
        )

    contact = 1 + mpmath.fsum(small**n * fourier(expansion.contact(n)) for n in range(1, order + 1))
    frame = moving_frame(expansion)
    profile = s * s
    for k, (value, slope) in frame.modes.items():
        if k:
            x = k * omega * s
            for n in range(1, order + 1):
                profile -= small**n * fourier(value[n]) * (1 - mpmath.cos(x))
                profile -= small**n * fourier(slope[n]) / (k * omega) * (x - mpmath.sin(x))
    return contact, profile


def cases(order: int, count: int, near: bool) -> list[tuple[float, float, float, float]]:
    """(s, τ, Ω, ε) with a well-ordered series, ``near`` resonances or away from them."""
    rng = random.Random(20 * order + near)
    found = []
    while len(found) < count:
        q = rng.randint(1, order)
        p = rng.randint(1, 3 * q)
        away = rng.choice([-1, 1]) * 10 ** rng.uniform(-6, -2)
        omega = p * np.pi / q + away if near else rng.uniform(0.3, 9.0)
        distance = min(abs(np.sin(k * omega)) for k in range(1, order + 1))
        if not near and distance < 0.1:
            continue
        epsilon = 0.02 * abs(np.sin(omega)) * distance**2 / omega**2
        found.append((-(10 ** rng.uniform(-8, 0)), rng.uniform(0, 7), omega, epsilon))
    return found


@pytest.mark.parametrize("order", [1, 2, 4, 6])
def test_a_few_ulp_away_from_resonances(modules: dict[int, ModuleType], order: int) -> None:
    module = modules[order]
    with mp.workdps(50):
        for s, tau, omega, epsilon in cases(order, 40, near=False):
            contact, profile = reference(order, s, tau, omega, epsilon)
            assert abs(module.contact(tau, omega, epsilon) - contact) <= 4 * UNIT * contact
            found = module.profile(s, tau, omega, epsilon)
            assert abs(found - profile) <= 16 * UNIT * profile


@pytest.mark.parametrize("order", [2, 4, 6])
@pytest.mark.parametrize("near", [False, True])
def test_errors_stay_below_the_stated_bound(
    modules: dict[int, ModuleType], order: int, near: bool
) -> None:
    """On the response alone, a thousandfold magnified: ε is set so that nothing hides behind 1."""
    module = modules[order]
    ratios = []
    with mp.workdps(50):
        for s, tau, omega, epsilon in cases(order, 40, near):
            strong = 1e3 * epsilon
            contact, profile = reference(order, s, tau, omega, strong)
            if -s > contact:
                continue
            for error, bound in (
                (
                    module.contact(tau, omega, strong) - contact,
                    module.contact_error(tau, omega, strong),
                ),
                (
                    module.profile(s, tau, omega, strong) - profile,
                    module.profile_error(s, tau, omega, strong),
                ),
            ):
                ratios.append(float(abs(error)) / float(bound))
    assert max(ratios) <= 1.0
    # A bound that could never be reached says nothing: it is within a few orders of magnitude.
    assert max(ratios) >= 1e-4


def test_the_bound_grows_towards_a_resonance(modules: dict[int, ModuleType]) -> None:
    bounds = [float(modules[4].contact_error(0.3, np.pi / 2 + mu, 0.1)) for mu in (1e-1, 1e-5)]
    assert bounds[1] > 1e3 * bounds[0]


def test_relative_accuracy_at_the_contact_point(modules: dict[int, ModuleType]) -> None:
    """w ∼ s² there; the naive 1 − cos and x − sin would leave 1e−16/s² of it."""
    with mp.workdps(50):
        for s in (-1e-2, -1e-5, -1e-9):
            _, profile = reference(4, s, 0.4, 0.83, 0.05)
            assert abs(modules[4].profile(s, 0.4, 0.83, 0.05) - profile) <= 16 * UNIT * profile


def test_it_is_the_evaluate_function(modules: dict[int, ModuleType]) -> None:
    s, tau = np.linspace(-0.95, 0, 7), np.linspace(0, 3, 5)
    result = evaluate(0.83, 0.05, 6, s, tau)
    found = modules[6].profile(s, tau[:, None], 0.83, 0.05)
    np.testing.assert_allclose(found, result.profile, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(modules[6].contact(tau, 0.83, 0.05), result.contact, rtol=1e-14)


def test_broadcasting_over_every_argument(modules: dict[int, ModuleType]) -> None:
    module = modules[4]
    s = np.linspace(-1, 0, 3)
    tau = np.linspace(0, 2, 4)[:, None]
    omega = np.array([0.7, 0.9])[:, None, None]
    epsilon = np.array([0.01, 0.02, 0.03, 0.04, 0.05])[:, None, None, None]
    table = module.profile(s, tau, omega, epsilon)
    assert table.shape == (5, 2, 4, 3)
    assert module.profile_error(s, tau, omega, epsilon).shape == (5, 2, 4, 3)
    one = module.profile(s[1], tau[2, 0], omega[1, 0, 0], epsilon[3, 0, 0, 0])
    assert table[3, 1, 2, 1] == pytest.approx(float(one), rel=1e-15)
    assert module.contact(tau, omega, epsilon).shape == (5, 2, 4, 1)
    grid = module.profile(s, tau, 0.7, 0.01)
    assert grid.shape == (4, 3)
    np.testing.assert_allclose(grid, table[0, 0], rtol=1e-14)


def test_shapes_that_do_not_broadcast(modules: dict[int, ModuleType]) -> None:
    with pytest.raises(ValueError, match=r"shapes \(3,\), \(4,\), \(\), \(\) do not broadcast"):
        modules[4].profile(np.zeros(3), np.zeros(4), 0.83, 0.01)


ARGUMENTS = {
    "contact": ("tau", "omega", "epsilon"),
    "profile": ("s", "tau", "omega", "epsilon"),
    "contact_error": ("tau", "omega", "epsilon"),
    "profile_error": ("s", "tau", "omega", "epsilon"),
}


def points(size: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(size)
    return {
        "s": -0.9 * rng.random(size),
        "tau": 7 * rng.random(size),
        "omega": rng.uniform(0.5, 0.9, size),
        "epsilon": 0.01 * rng.random(size),
    }


class Frozen:
    """An array as a tracer has it: arithmetic, shape and format; no truth, no writing, no size."""

    def __init__(self, value: Any) -> None:
        self._value = value
        self.shape, self.dtype, self.ndim = value.shape, value.dtype, value.ndim

    def __bool__(self) -> bool:
        raise TypeError("a value that is not known yet has no truth")

    def __abs__(self) -> Frozen:
        return Frozen(abs(self._value))

    def __neg__(self) -> Frozen:
        return Frozen(-self._value)


def _operator(name: str) -> Callable[[Frozen, Any], Frozen]:
    return lambda a, b: Frozen(getattr(a._value, name)(bare(b)))


for name in ["add", "sub", "mul", "truediv", "pow"]:
    setattr(Frozen, f"__{name}__", _operator(f"__{name}__"))
    setattr(Frozen, f"__r{name}__", _operator(f"__r{name}__"))
for name in ["lt", "le", "gt", "ge", "and", "or"]:
    setattr(Frozen, f"__{name}__", _operator(f"__{name}__"))


def bare(value: Any) -> Any:
    return value._value if isinstance(value, Frozen) else value


def frozen_namespace(double: type) -> SimpleNamespace:
    """A namespace of :class:`Frozen` arrays, which gives ``double`` when asked for float64."""

    def lifted(function: Callable[..., Any]) -> Callable[..., Frozen]:
        return lambda *a: Frozen(np.asarray(function(*map(bare, a))))

    return SimpleNamespace(
        float64=double,
        finfo=np.finfo,
        asarray=lambda a, dtype: Frozen(np.asarray(bare(a), dtype=dtype)),
        **{
            name: lifted(getattr(np, name))
            for name in ("sin", "cos", "tan", "abs", "where", "isfinite")
        },
    )


@pytest.mark.parametrize("size", [1, 8192, 8193, 20_000])
@pytest.mark.parametrize("function", list(ARGUMENTS))
def test_other_array_namespaces_at_any_size(
    modules: dict[int, ModuleType], function: str, size: int
) -> None:
    """Nothing is written into, counted or asked for its truth: it compiles and transforms."""
    import array_api_strict as strict

    arguments = [points(size)[name] for name in ARGUMENTS[function]]
    expected = getattr(modules[4], function)(*arguments)
    with strict.ArrayAPIStrictFlags(boolean_indexing=False, data_dependent_shapes=False):
        found = getattr(modules[4], function)(*map(strict.asarray, arguments), xp=strict)
    np.testing.assert_allclose(np.asarray(found), expected, rtol=1e-14)
    found = getattr(modules[4], function)(*arguments, xp=frozen_namespace(np.float64))
    np.testing.assert_allclose(bare(found), expected, rtol=1e-14)


def test_an_open_grid_in_another_namespace(modules: dict[int, ModuleType]) -> None:
    import array_api_strict as strict

    s, tau = np.linspace(-0.9, 0.1, 500), np.linspace(0, 2, 40)[:, None]
    found = modules[4].profile(strict.asarray(s), strict.asarray(tau), 0.83, 0.02, xp=strict)
    expected = modules[4].profile(s, tau, 0.83, 0.02)
    np.testing.assert_allclose(np.asarray(found), expected, rtol=1e-13)


@pytest.mark.parametrize("near", [False, True])
def test_single_precision_has_its_own_bound(modules: dict[int, ModuleType], near: bool) -> None:
    """Asked for double a namespace may give single: then error and bound are those of single.

    The reference takes the single precision arguments as they stand.
    """
    single, ratios = frozen_namespace(np.float32), []
    for s, tau, omega, epsilon in cases(4, 200, near):
        strong = 100 * epsilon
        for function, arguments in (
            ("contact", (tau, omega, strong)),
            ("profile", (s, tau, omega, strong)),
        ):
            narrow = [np.float32(a) for a in arguments]
            exact = getattr(modules[4], function)(*(float(a) for a in narrow))
            found = bare(getattr(modules[4], function)(*narrow, xp=single))
            bound = bare(getattr(modules[4], f"{function}_error")(*narrow, xp=single))
            assert found.dtype == bound.dtype == np.float32
            double = getattr(modules[4], f"{function}_error")(*(float(a) for a in narrow))
            if math.isinf(bound):
                assert near  # single precision does not tell it from the resonance
                assert np.isnan(found)
                continue
            assert bound == pytest.approx(2.0**29 * double, rel=1e-3)
            if not np.isnan(exact):
                ratios.append(abs(float(found) - exact) / float(bound))
    assert len(ratios) > 50
    assert 1e-4 < max(ratios) <= 1.0


NOWHERE = [0.0, -0.83, math.nan, math.inf, 1.2e6, 1e9, 1e-39, 1e-300, 5e-324]
RESONANT = [math.pi, math.pi / 2, 2 * math.pi / 3, 3 * math.pi / 4 + 3e-9, 100 * math.pi - 1e-6]


@pytest.mark.parametrize("omega", NOWHERE + RESONANT)
def test_no_result_is_nan(modules: dict[int, ModuleType], omega: float) -> None:
    """Where the engine over floats refuses, no number comes out that could be taken for one."""
    with np.errstate(all="ignore"):
        assert np.isnan(modules[4].contact(0.1, omega, 1e-9))
        assert np.isnan(modules[4].profile(-0.5, 0.1, omega, 1e-9))
        assert modules[4].contact_error(0.1, omega, 1e-9) == math.inf
        assert modules[4].profile_error(-0.5, 0.1, omega, 1e-9) == math.inf
        both = modules[4].contact(0.1, np.array([0.83, omega]), 1e-9)
        assert np.isnan(both).tolist() == [False, True]
        both = modules[4].profile(-0.5, 0.1, np.array([0.83, omega]), 1e-9)
        assert np.isnan(both).tolist() == [False, True]
    if omega in RESONANT:
        with pytest.raises(ResonanceError):
            evaluate(omega, 1e-9, 4, [-0.5], [0.1])


def test_a_series_that_overflows_has_no_result(modules: dict[int, ModuleType]) -> None:
    with np.errstate(all="ignore"):
        for arguments in ((0.1, 0.83, 1e200), (1e308, 8.3, 0.01), (math.inf, 0.83, 0.01)):
            assert np.isnan(modules[4].contact(*arguments))
            assert np.isnan(modules[4].profile(-0.5, *arguments))


def test_the_rule_for_resonances_is_that_of_the_engine(modules: dict[int, ModuleType]) -> None:
    """|sin qΩ| ≤ 2⁻²⁶ max(1, qΩ), q ≤ N, a little on either side."""
    for p, q in ((1, 1), (1, 2), (5, 3), (7, 4), (9, 2)):
        width = 2.0**-26 * max(1.0, p * math.pi) / q
        for offset, refused in ((0.99, True), (1.01, False), (-0.99, True), (-1.01, False)):
            omega = p * math.pi / q + offset * width
            assert np.isnan(modules[4].contact(0.1, omega, 1e-20)) == refused
            try:
                evaluate(omega, 1e-20, 4, [], [0.1])
            except ResonanceError:
                assert refused
            else:
                assert not refused
    # What the order does not excite is no resonance.
    assert modules[2].contact(0.1, math.pi / 3, 1e-3) == pytest.approx(1.0, abs=1e-2)
    assert np.isnan(modules[4].contact(0.1, math.pi / 3, 1e-3))


@pytest.mark.parametrize("order", [1, 2, 4, 6])
def test_slow_drives_down_to_where_powers_underflow(
    modules: dict[int, ModuleType], order: int
) -> None:
    """ξ_c = √(1 + ε) through ε^N; nothing is lost silently on the way down."""
    module = modules[order]
    series = sum(
        np.prod([0.5 - i for i in range(n)]) / math.factorial(n) * 0.1**n for n in range(order + 1)
    )
    least = 2.0 ** (-1022 / (module.POWER + 1))
    for omega in (1e-9, 1e-15, 1.01 * least):
        assert module.contact(0.0, omega, 0.1) == pytest.approx(series, rel=8 * UNIT)
        assert module.profile(-0.5, 0.0, omega, 0.1) == pytest.approx(0.25, rel=8 * UNIT)
    assert np.isnan(module.contact(0.0, 0.99 * least, 0.1))


def test_the_rope_ends_at_the_ground_and_at_the_driven_end(modules: dict[int, ModuleType]) -> None:
    module, tau = modules[4], np.linspace(0, 7, 15)
    ground = np.array([1e-300, 0.5, 30.0])
    assert (module.profile(ground, tau[:, None], 0.83, 0.02) == 0).all()
    assert module.profile(0.5, 0.3, np.array([0.83, 0.9]), 0.02).tolist() == [0.0, 0.0]
    contact = module.contact(tau, 0.83, 0.02)
    for s in (-contact, -contact * (1 + 1e-9)):
        end = module.profile(s, tau, 0.83, 0.02)
        np.testing.assert_allclose(end, 1 + 0.02 * np.cos(0.83 * tau), atol=1e-7)
    assert np.isnan(module.profile(-contact * (1 + 1e-7), tau, 0.83, 0.02)).all()
    assert np.isnan(module.profile(-3.0, 0.0, 0.83, 0.02))
    assert np.isnan(module.profile(math.nan, 0.0, 0.83, 0.02))
    # On a grid, in blocks and not: beyond at some times only.
    s = np.linspace(-1.01, 0.1, 3000)
    table = module.profile(s, tau[:, None], 0.83, 0.02)
    np.testing.assert_array_equal(np.isnan(table), s < -contact[:, None] - 2.0**-26)
    np.testing.assert_array_equal(table[:, s > 0], 0.0)


def test_order_one_is_the_hand_written_module(sixth: Expansion) -> None:
    """What other orders are put into runs as it stands, and is the emitted module of order 1."""
    from asymptotics.printing.emitted import string

    emitted = numpy_module(ClosedForms(Expansion(sixth.problem, sixth.orders[:1])))
    written = Path(string.__file__).read_text(encoding="utf-8")
    differing = [
        (a, b) for a, b in zip(emitted.splitlines(), written.splitlines(), strict=True) if a != b
    ]
    assert [a[:9] for a, _ in differing] == ["Generated"]


def test_needs_numpy_only_and_is_the_same_every_time(tmp_path: Path) -> None:
    program = (
        "from asymptotics import *\nfrom asymptotics.printing.numpy_code import numpy_module\n"
        "print(numpy_module(ClosedForms(expand(exact_string(), 4))), end='')"
    )
    texts = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={"PYTHONHASHSEED": seed, "PATH": ""},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(texts) == 1
    (tmp_path / "rope.py").write_text(texts.pop(), encoding="utf-8")
    check = (
        "import sys, rope; rope.contact(0.0, 0.8, 0.1);"
        "print([m for m in ('sympy', 'flint', 'asymptotics', 'scipy') if m in sys.modules])"
    )
    out = subprocess.run(
        [sys.executable, "-c", check], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert out.stdout.strip() == "[]"


def test_long_brackets_are_emitted_in_blocks(sixth: Expansion) -> None:
    """They are broken into statements; the numbers are those of the engine over floats."""
    ninth = expand(sixth.problem, 9, start=sixth)
    source = numpy_module(ClosedForms(ninth))
    assert max(map(len, source.splitlines())) <= 100
    module = module_from(source)
    result = evaluate(0.83, 0.05, 9, [-0.4], [0.3])
    assert module.contact(0.3, 0.83, 0.05) == pytest.approx(result.contact[0], rel=1e-14)
    assert module.profile(-0.4, 0.3, 0.83, 0.05) == pytest.approx(result.profile[0, 0], rel=1e-13)


def test_the_float_engine_keeps_its_digits() -> None:
    """The reference's own check: the engine over doubles is near the engine over 50 digits."""
    with mp.workdps(50):
        contact, _ = reference(6, -0.5, 0.3, 0.83, 0.05)
    numbers = expand(float_string(0.83, 6), 6)
    total = 1.0 + sum(
        (0.05 / np.sin(0.83)) ** n
        * sum((2 if j else 1) * c * np.cos(j * 0.83 * 0.3) for j, c in numbers.contact(n).items())
        for n in range(1, 7)
    )
    assert total == pytest.approx(float(contact), rel=1e-14)


@pytest.mark.parametrize("shape", [(20_000,), (3, 9_000), (9_000, 3), (2, 2, 9_000)])
def test_large_arrays_are_worked_through_in_blocks(
    modules: dict[int, ModuleType], shape: tuple[int, ...]
) -> None:
    """Block by block, whatever the shapes: the numbers are those of one piece."""
    module = modules[4]
    rng = np.random.default_rng(3)
    s, tau = -rng.random(shape), rng.random(shape[-1:])
    omega = rng.uniform(0.5, 0.9, (*shape[:-1], 1))
    found = module.profile(s, tau, omega, 0.01), module.contact(tau, omega, 0.01)
    module.BLOCK, block = 10**9, module.BLOCK
    try:
        expected = module.profile(s, tau, omega, 0.01), module.contact(tau, omega, 0.01)
    finally:
        module.BLOCK = block
    for a, b in zip(found, expected, strict=True):
        assert a.shape == shape
        np.testing.assert_array_equal(a, b)


def test_cotangents_are_right_next_to_their_poles(modules: dict[int, ModuleType]) -> None:
    """What the count of roundings assumes: 6 u for the double Ω as it stands, poles included."""
    rng = random.Random(11)
    with mp.workdps(50):
        for _ in range(200):
            q = rng.randint(1, 6)
            omega = rng.randint(1, 4 * q) * np.pi / q + rng.choice([-1, 1]) * 10 ** rng.uniform(
                -13, -1
            )
            found, _ = modules[6]._cotangents(np.float64(omega), np)
            for k, value in enumerate(found, start=1):
                exact = mpmath.cot(k * mpf(float(omega)))
                assert abs(value - exact) <= 6 * UNIT * abs(exact)


@pytest.mark.parametrize("above", [1, 3, 2**53 - 1, 2**53 + 1, 3**50])
@pytest.mark.parametrize("below", [1, 7, 2**53 - 1, 2**53 + 1, 7**40])
@pytest.mark.parametrize("names", [[], ["a"], ["a", "", "b"]])
def test_a_term_is_its_fraction_however_large(above: int, below: int, names: list[str]) -> None:
    """Integers that no double holds are divided exactly, and then rounded once."""
    for factor in (Fraction(above, below), -Fraction(above, below)):
        text = _term(factor, names)
        found = eval(f"0.0 {text}", {"a": 4.0, "b": 0.5})
        exact = factor * {0: 1, 1: 4, 3: 2}[len(names)]
        assert text[0] in "+-"
        assert abs(Fraction(found) - exact) <= Fraction(2) ** -51 * abs(exact)
        integers = [int(digits) for digits in re.findall(r"(?<![\d.e+-])\d+(?![\d.e])", text)]
        assert max(integers, default=0) < 2**53


def test_beyond_the_driven_end_at_some_time_there_is_no_result_then(
    modules: dict[int, ModuleType],
) -> None:
    """Also for positions that the rope reaches at its mean length, and at other times."""
    tau = np.linspace(0.0, 2 * math.pi / 0.83, 33)
    contact = modules[4].contact(tau, 0.83, 0.05)
    s = -(1 + 1e-3) * contact[contact < np.mean(contact) - 2e-3]
    short = tau[contact < np.mean(contact) - 2e-3]
    assert len(s) > 5
    assert np.isnan(modules[4].profile(s, short, 0.83, 0.05)).all()
    assert np.isfinite(modules[4].profile(0.998 * s, short, 0.83, 0.05)).all()
