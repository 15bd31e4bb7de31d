"""Evaluation at one frequency, and every way to ask for nonsense."""

from __future__ import annotations

import math

import numpy as np
import pytest

from asymptotics.errors import InputError, OrderingError, ResonanceError
from asymptotics.evaluate import evaluate, sine_defect, versine


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
        ((3.0, 0.2, 4, [-0.5], [0.0]), OrderingError, "too large for order 4 at Omega = 3.0"),
        ((3.14, 0.1, 1, [-0.5], [0.0]), OrderingError, "linear response"),
        ((0.83, math.nan, 4, [-0.5], [0.0]), InputError, "epsilon = nan"),
        ((0.83, "x", 4, [-0.5], [0.0]), InputError, "epsilon = 'x' is not a number"),
        ((math.nan, 0.01, 4, [-0.5], [0.0]), InputError, "Omega = nan"),
        ((0.83, 0.01, 0, [-0.5], [0.0]), InputError, "order = 0"),
        ((0.83, 0.01, 4, [-0.5, 0.1], [0.0]), InputError, "s = 0.1 is beyond the contact"),
        ((0.83, 0.01, 4, [-0.5, math.inf], [0.0]), InputError, "s contains inf"),
        ((0.83, 0.01, 4, [-0.5], [math.nan]), InputError, "tau contains nan"),
        ((0.83, 0.01, 4, [[-0.5]], [0.0]), InputError, r"s has shape \(1, 1\)"),
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
