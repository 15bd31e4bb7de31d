"""Evaluation at one frequency, and every way to ask for nonsense."""

from __future__ import annotations

import math

import numpy as np
import pytest

from asymptotics.errors import InputError, OrderingError, ResonanceError
from asymptotics.expansion.solutions import sine_defect, versine
from asymptotics.values.evaluate import evaluate


def test_quasi_static_limit() -> None:
    """Ω → 0: the rope follows its static shape, ξ_c = √(1 + ε cos Ωτ) and w = (x/x₀ − ξ_c)²."""
    errors = []
    for order in (2, 4, 6):
        result = evaluate(1e-3, 0.1, order, [-0.5], [0.0])
        errors.append(abs(result.contact[0] - math.sqrt(1.1)))
        assert result.profile[0, 0] == pytest.approx(0.25, abs=1e-6)
    assert errors[0] > 10 * errors[1]
    assert errors[2] < 1e-6


def test_the_driven_end_moves_as_told() -> None:
    tau = np.linspace(0, 4, 9)
    contact = evaluate(0.83, 0.01, 8, [0.0], tau).contact
    for time, place in zip(tau, contact, strict=True):
        w = evaluate(0.83, 0.01, 8, [-place], [time]).profile[0, 0]
        assert w == pytest.approx(1 + 0.01 * math.cos(0.83 * time), abs=1e-13)


def test_no_forcing_no_motion() -> None:
    result = evaluate(0.83, 0.0, 4, [-0.5, 0.0], [0.0, 1.0])
    assert result.contact.tolist() == [1.0, 1.0]
    assert result.profile.tolist() == [[0.25, 0.0], [0.25, 0.0]]


def test_shapes() -> None:
    result = evaluate(0.83, 0.01, 3, np.linspace(-1, 0, 4), [0.0, 0.1, 0.2])
    assert result.contact.shape == (3,)
    assert result.profile.shape == (3, 4)
    assert len(result.terms) == 3
    assert evaluate(0.83, 0.01, 3, [], []).profile.shape == (0, 0)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((math.pi / 2, 0.01, 4, [-0.5], [0.0]), ResonanceError, "p/q = 1/2 "),
        (
            (3.0, 0.2, 4, [-0.5], [0.0]),
            OrderingError,
            "too large for order 1 of the string at Omega = 3.0",
        ),
        ((3.14, 0.1, 1, [-0.5], [0.0]), OrderingError, "linear response"),
        ((0.83, math.nan, 4, [-0.5], [0.0]), InputError, "epsilon = nan"),
        ((0.83, "x", 4, [-0.5], [0.0]), InputError, "epsilon = 'x' is not a number"),
        ((math.nan, 0.01, 4, [-0.5], [0.0]), InputError, "Omega = nan"),
        ((0.83, 0.01, 0, [-0.5], [0.0]), InputError, "order = 0"),
        ((0.83, 0.01, 4, [-0.5, 0.1], [0.0]), InputError, "s = 0.1 is beyond the contact"),
        ((0.83, 0.01, 4, [-0.5, math.inf], [0.0]), InputError, "s contains inf"),
        ((0.83, 0.01, 4, [-0.5], [math.nan]), InputError, "tau contains nan"),
        ((0.83, 0.01, 4, [[[-0.5]]], [0.0]), InputError, r"s has shape \(1, 1, 1\)"),
        ((0.83, 0.01, 4, [[-0.5], [-0.6]], [0.0]), InputError, "2 rows for 1 times"),
        ((0.83, 0.01, 4, [[-0.5], [0.1]], [0.0, 1.0]), InputError, "s = 0.1 is beyond the contact"),
        (
            (0.83, 0.01, 4, [-0.5, -3.0, -0.1], [0.0]),
            InputError,
            "s = -3.0 is beyond the driven end.*-1.0056",
        ),
        ((0.83, 0.01, 4, [-1.0], [0.0, 3.0]), InputError, r"when tau = 3;.*for all tau"),
        ((0.83, 0.01, 4, [[-1.0], [-1.0]], [0.0, 3.0]), InputError, "s = -1.0 .*when tau = 3"),
        ((0.83, 0.01, 4, [-0.5], [1e308]), InputError, r"tau = 1e\+308: the phase"),
        ((0.83, 0.01, 4, [-0.5], [1e8]), InputError, "phase of harmonic 2, 1.66e\\+08"),
        ((0.83, 1e308, 4, [-0.5], [0.0]), OrderingError, "order 1 .*linear response"),
        ((0.0, 0.01, 4, [-0.5], [0.0]), InputError, "Omega = 0.0"),
        ((0.83, 0.01, 1, [-0.5] * 20_000, [0.0] * 20_000), InputError, "400000000 values"),
        ((0.83, 0.01, 4, ["a"], [0.0]), InputError, "s = .* is not a list of numbers"),
    ],
)
def test_bad_input(arguments: tuple, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        evaluate(*arguments)


def test_small_arguments_do_not_cancel() -> None:
    x = np.array([1e-8, 1e-3, 0.5, 0.999999, 1.000001, 3.0])
    from mpmath import cos, mp, mpf, sin

    with mp.workdps(50):
        for value in x:
            exact = mpf(float(value))
            assert abs(versine(np.array([value]))[0] / (1 - cos(exact)) - 1) < 1e-15
            assert abs(sine_defect(np.array([value]))[0] / (exact - sin(exact)) - 1) < 4e-15


@pytest.mark.parametrize("omega", [1e-3, 1e-20, 1e-300, 1e-308, 5e-324])
def test_the_slowest_drive_is_the_quasi_static_rope(omega: float) -> None:
    """Nothing overflows on the way: ξ_c = √(1 + ε) through ε⁸, and w = s²."""
    result = evaluate(omega, 0.1, 8, [-0.5, -1.0], [0.0])
    series = sum(
        np.prod([0.5 - i for i in range(n)]) / math.factorial(n) * 0.1**n for n in range(9)
    )
    assert result.contact[0] == pytest.approx(series, rel=1e-6 if omega == 1e-3 else 4e-16)
    assert result.profile[0] == pytest.approx([0.25, 1.0], rel=1e-6 if omega == 1e-3 else 4e-16)


def test_a_row_of_positions_for_each_time() -> None:
    tau = np.array([0.0, 1.0, 2.0])
    s = np.array([[-1.0, -0.3], [-0.5, -0.2], [-0.9, 0.0]])
    table = evaluate(0.83, 0.05, 4, s, tau).profile
    for time, places, row in zip(tau, s, table, strict=True):
        alone = evaluate(0.83, 0.05, 4, places, time).profile[0]
        np.testing.assert_allclose(row, alone, rtol=1e-14)


def test_positions_that_are_not_given() -> None:
    """Quarters of x₀, as far as the rope reaches at all times."""
    assert evaluate(0.83, 0.02, 4, None, 0.0).s.tolist() == [-1, -0.75, -0.5, -0.25, 0]
    short = evaluate(0.83, 0.02, 4, None, [0.0, 3.0])
    assert short.contact.min() < 1
    assert short.s.tolist() == [-0.75, -0.5, -0.25, 0]
    assert evaluate(0.83, 0.02, 4, None, []).profile.shape == (0, 0)


def test_the_driven_end_itself_is_on_the_rope() -> None:
    """A position that misses it by the rounding of ξ_c is not beyond it."""
    contact = evaluate(0.83, 0.02, 4, [], [0.3]).contact[0]
    for s in (-contact, -contact * (1 + 1e-9)):
        end = evaluate(0.83, 0.02, 4, [s], [0.3]).profile[0, 0]
        assert end == pytest.approx(1 + 0.02 * math.cos(0.83 * 0.3), abs=1e-8)
    with pytest.raises(InputError, match="beyond the driven end"):
        evaluate(0.83, 0.02, 4, [-contact * (1 + 1e-7)], [0.3])


def test_a_series_that_loses_its_ordering_says_so_at_once() -> None:
    """At the first order that shows it, not after all orders asked for; and tells its progress."""
    done: list[int] = []
    with pytest.raises(OrderingError, match="too large for order 8 of"):
        evaluate(0.83, 0.9, 200, [], [], progress=done.append)
    assert done == [1, 2, 3, 4, 5, 6, 7]


def test_a_negative_epsilon_is_half_a_period_later() -> None:
    half, tau = math.pi / 0.83, np.array([0.0, 0.9, 2.5])
    minus = evaluate(0.83, -0.05, 4, [-0.5], tau)
    plus = evaluate(0.83, 0.05, 4, [-0.5], tau + half)
    np.testing.assert_allclose(minus.contact, plus.contact, rtol=1e-13)
    np.testing.assert_allclose(minus.profile, plus.profile, rtol=1e-12)


def test_progress_goes_through_the_orders_and_then_the_profile_s() -> None:
    """The profile's as often as its digits ask for, 4 telling that the expansion is done anew."""
    done: list[int] = []
    evaluate(0.83, 0.02, 4, [-0.5], [0.0], progress=done.append)
    assert done[:4] == [1, 2, 3, 4]
    profile = [n for n in done[4:] if n > 4]
    assert profile == [5, 6, 7, 8] * (len(profile) // 4) != []
    assert set(done[4:]) <= {4, 5, 6, 7, 8}


def test_too_little_memory_is_one_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("asymptotics.values.response._profile", exhausted)
    with pytest.raises(InputError, match=r"not enough memory .* 2 times × 3 positions"):
        evaluate(0.83, 0.01, 4, [-0.5, -0.4, -0.3], [0.0, 1.0])
