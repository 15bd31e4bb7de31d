"""The emitted beam's shape: the driven end, the contact, the PDE, the broadcast."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from asymptotics.beam_numpy import beam_numpy
from asymptotics.beam_symbolic import expand_symbolic
from asymptotics.static_shape import DRIVEN_ENDS

OMEGA = 2.2
TAU = np.linspace(0, 2.8, 7)


@cache
def module_of(order: int, driven_end: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(beam_numpy(expand_symbolic(order), driven_end), namespace)
    return namespace


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-6, 1e-3, 1e-2, 1.0, 1e3])
def test_the_driven_end(beta: float, driven_end: str) -> None:
    """w = 1 + ε cos Ωτ, and no moment (pinned) or no slope (clamped), at every order."""
    shape = module_of(4, driven_end)["shape"]
    drive = 1 + 0.01 * np.cos(OMEGA * TAU)
    # The static shape is a sum of terms up to 2β.
    scale = np.finfo(float).eps * (1 + 2 * beta)
    assert np.abs(shape(0.0, TAU, OMEGA, 0.01, beta) - drive).max() <= 8 * scale
    h = 1e-3 * np.sqrt(beta / (1 + beta))
    left, middle, right = (shape(x, TAU, OMEGA, 0.01, beta) for x in (-h, 0.0, h))
    if driven_end == "pinned":
        # Second difference: rounding over h², and w⁗ h²/12 with w⁗ = O(1/β).
        bound = 8 * scale / h**2 + 10 * h**2 / beta
        assert np.abs(left - 2 * middle + right).max() / h**2 <= bound
    else:
        bound = 8 * scale / h + 10 * h**2 / beta
        assert np.abs(right - left).max() / (2 * h) <= bound
        assert np.abs(left - 2 * middle + right).max() / h**2 > 0.01


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("order", "rate"), [(1, 3), (2, 3), (3, 4), (4, 5)])
def test_contact_falls_like_the_next_order(order: int, rate: int, driven_end: str) -> None:
    """w at the series' own contact point; at N = 1 one order better, because w₂(ξ₀) = 0."""
    module = module_of(order, driven_end)
    sizes = []
    for epsilon in (2e-3, 1e-3):
        place = module["contact"](TAU, OMEGA, epsilon, 0.01)
        sizes.append(np.abs(module["shape"](place, TAU, OMEGA, epsilon, 0.01)).max())
    assert np.log2(sizes[0] / sizes[1]) == pytest.approx(rate, abs=0.1)
    assert sizes[1] > 1e-15


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_equation_by_differences(driven_end: str) -> None:
    """W_ττ = W_ξξ − 2 − βW_ξξξξ: central differences leave what halving h quarters."""
    shape, beta, xi, tau, epsilon = module_of(3, driven_end)["shape"], 0.05, 0.4, 0.3, 0.05

    def left_over(h: float) -> float:
        w = shape(xi + h * np.arange(-2, 3), tau, OMEGA, epsilon, beta)
        t = shape(xi, tau + h * np.arange(-1, 2), OMEGA, epsilon, beta)
        second = (w[1] - 2 * w[2] + w[3]) / h**2
        fourth = (w[0] - 4 * w[1] + 6 * w[2] - 4 * w[3] + w[4]) / h**4
        return float((t[0] - 2 * t[1] + t[2]) / h**2 - second + 2 + beta * fourth)

    coarse, fine = left_over(0.04), left_over(0.02)
    assert coarse / fine == pytest.approx(4.0, abs=0.2)
    assert abs(fine) < 1e-2


def test_little_bending_is_the_string() -> None:
    shape = module_of(2, "pinned")["shape"]
    for beta in (1e-4, 1e-6):
        found = shape(0.3, TAU, OMEGA, 0.01, beta)
        string = 0.49 - 0.01 * np.sin(OMEGA * -0.7) / np.sin(OMEGA) * np.cos(OMEGA * TAU)
        # The contact point is √β further out; ε² and √β terms remain.
        assert np.abs(found - string).max() <= 5 * np.sqrt(beta) + 1e-3


def test_all_arguments_broadcast() -> None:
    shape = module_of(2, "pinned")["shape"]
    xi = np.linspace(0, 1, 5)
    found = shape(xi, TAU[:, None], OMEGA, 0.01, np.array([1e-3, 1e-2])[:, None, None])
    assert found.shape == (2, 7, 5)
    assert found[1, 3, 2] == shape(xi[2], TAU[3], OMEGA, 0.01, 1e-2)
