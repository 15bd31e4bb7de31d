"""The solutions of a linear equation against their closed forms at 40 digits."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

from asymptotics.expansion.solutions import solutions

PLACES = np.array([0.0, -1e-9, -1e-3, -0.04, -0.3, -1.0, -1.7])


def fundamental(reduction: Sequence[complex], degree: int, s: float) -> list[mpc]:
    """φ_0 … φ_{r−1} at s: the power series of the recurrence, summed at 60 digits."""
    r = len(reduction)
    with mp.workdps(60):
        chi, values = [mpc(complex(x)) for x in reduction], []
        for l in range(r):  # noqa: E741
            derivatives = [mpc(i == l) for i in range(r)]
            for d in range(r, degree):
                derivatives.append(sum(x * derivatives[d - r + i] for i, x in enumerate(chi)))
            values.append(sum(w * mpf(s) ** d / mp.factorial(d) for d, w in enumerate(derivatives)))
    return values


@pytest.mark.parametrize(
    ("reduction", "m"),
    [
        ([-9.0, 0.0], 2),
        ([1.7, 0.0], 2),
        ([-9.0 + 2.0j, 0.0], 2),
        ([-9.0, 0.3], 2),
        ([0.0, 0.0, 0.0], 2),
        ([0.0, 0.0, 100.0, 0.0], 3),
        ([0.0, 0.0, 0.0, 100.0, 0.0], 3),
        ([484.0, 0.0, 100.0, 0.0], 3),
        ([0.0, 0.0, 0.0, 0.0], 3),
        ([4.0 + 1.0j, 0.0, 2.0, 0.0], 3),
        ([-4.0, 0.0], 1),
    ],
)
def test_each_is_right_relative_to_the_waves_it_is_made_of(
    reduction: Sequence[complex], m: int
) -> None:
    found = solutions(reduction, m, PLACES)
    r = len(reduction)
    rate = 2 * max(abs(x) ** (1 / (r - i)) for i, x in enumerate(reduction))
    for i, s in enumerate(PLACES):
        exact = fundamental(reduction, 200, float(s))
        for l in range(r):  # noqa: E741
            with mp.workdps(60):
                wanted = exact[l] - (mpf(float(s)) ** l / mp.factorial(l) if l < m else 0)
            scale = abs(wanted)
            if rate * abs(s) > 1:  # a squared exponential is right relative to its largest entry
                scale += max(abs(x) * rate ** (k - l) for k, x in enumerate(exact))
            assert abs(complex(found[l, i]) - complex(wanted)) <= 64 * 2.0**-53 * float(scale)


def test_any_shape() -> None:
    s = -np.linspace(0, 2, 12)
    flat = solutions([484.0, 0.0, 100.0, 0.0], 3, s)
    table = solutions([484.0, 0.0, 100.0, 0.0], 3, s.reshape(3, 4))
    assert table.shape == (4, 3, 4)
    np.testing.assert_array_equal(table.reshape(4, 12), flat)
    assert solutions([0.0, 0.0], 2, s).tolist() == np.zeros((2, 12)).tolist()
    assert solutions([0.0, 0.0, 0.0], 2, s)[2] == pytest.approx(s**2 / math.factorial(2))
