"""The emitted beam's shape: the driven end, the contact, the PDE, the broadcast."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from asymptotics import expand
from asymptotics.errors import ResonanceError
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.printing.beam_numpy import beam_numpy
from asymptotics.problems.beam import beam_problem, float_beam
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.rings.numbers import digits

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
    w = [shape(x, TAU, OMEGA, 0.01, beta) for x in (0.0, h, 2 * h, 3 * h)]
    # One-sided differences, for there is no rope on the other side: rounding over h or h², and
    # 11 w⁗ h²/12 or w‴ h²/3 with w⁗ = O(1/β).
    second = np.abs(2 * w[0] - 5 * w[1] + 4 * w[2] - w[3]).max() / h**2
    if driven_end == "pinned":
        assert second <= 24 * scale / h**2 + 10 * h**2 / beta
    else:
        slope = np.abs(-3 * w[0] + 4 * w[1] - w[2]).max() / (2 * h)
        assert slope <= 8 * scale / h + 10 * h**2 / beta
        assert second > 0.01


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


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_rope_ends_at_the_ground_and_at_the_driven_end(driven_end: str) -> None:
    module = module_of(3, driven_end)
    place = module["contact"](TAU, OMEGA, 0.01, 0.01)
    for beyond in (1e-12, 0.1, 50.0):
        assert (module["shape"](place + beyond, TAU, OMEGA, 0.01, 0.01) == 0).all()
    assert (module["shape"](place - 0.1, TAU, OMEGA, 0.01, 0.01) > 1e-4).all()
    assert module["shape"](3.0, 0.0, OMEGA, 0.01, 0.01) == 0
    assert np.isnan(module["shape"](-1e-7, TAU, OMEGA, 0.01, 0.01)).all()
    # What misses the driven end by rounding is the driven end.
    end = module["shape"](-1e-12, TAU, OMEGA, 0.01, 0.01)
    np.testing.assert_allclose(end, 1 + 0.01 * np.cos(OMEGA * TAU), atol=1e-10)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize("beta", [1e-3, 0.01, 1.0])
def test_a_resonance_has_no_result(beta: float, driven_end: str) -> None:
    """Ω_p(β)/q with q ≤ N, and what is so near that half the digits are rounding."""
    module = module_of(3, driven_end)
    first, second = linear_frequencies(beta, 2, driven_end)
    for omega in (
        first,
        second,
        first / 2,
        second / 3,
        first * (1 + 1e-9),
        second / 2 * (1 - 1e-9),
    ):
        with pytest.raises(ResonanceError):
            float_beam(beta, omega, 3, driven_end)
        assert np.isnan(module["contact"](0.3, omega, 1e-6, beta))
        assert np.isnan(module["shape"](0.3, 0.3, omega, 1e-6, beta))
        assert all(np.isnan(a) for a in module["harmonics"](omega, beta).values())
        pair = module["contact"](0.3, np.array([OMEGA, omega]), 1e-6, beta)
        assert np.isnan(pair).tolist() == [False, True]
    assert np.isfinite(module["contact"](0.3, first / 5, 1e-9, beta))  # beyond the order
    assert np.isfinite(module["contact"](0.3, first * (1 + 1e-5), 1e-9, beta))


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_where_there_is_no_beam_or_no_number(driven_end: str) -> None:
    module = module_of(3, driven_end)
    with np.errstate(all="ignore"):
        for beta in (0.0, -0.01, np.nan, np.inf, 1e-300):
            assert np.isnan(module["contact"](0.3, OMEGA, 0.01, beta)), beta
            assert np.isnan(module["shape"](0.3, 0.3, OMEGA, 0.01, beta)), beta
        for arguments in ((0.3, np.nan, 0.01), (0.3, np.inf, 0.01), (0.3, OMEGA, 1e200)):
            assert np.isnan(module["contact"](*arguments, 0.01))
            assert np.isnan(module["shape"](0.3, *arguments, 0.01))


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_thin_layers_cost_what_is_stated_and_then_there_is_no_result(driven_end: str) -> None:
    """A harmonic of order n is right to 8 u β^{(1−n)/2}; ξ_c is given while half its digits are."""
    module = module_of(4, driven_end)
    for beta in (1e-2, 1e-4, 1e-6, 1e-10, 1e-13):
        with mp.workdps(120):
            exact = expand(beam_problem(mpf(beta), mpf(OMEGA), driven_end, digits()), 4)
            wanted = {
                (n, j): (2 if j else 1) * c
                for n in range(1, 5)
                for j, c in exact.contact(n).items()
            }
            found = module["harmonics"](OMEGA, beta)
            for (n, j), value in wanted.items():
                bound = 8 * 2.0**-53 * beta ** ((1 - n) / 2)
                assert abs(mpf(float(found[n, j])) / value - 1) <= bound
            for epsilon in (1e-2, 1e-3, 1e-5):
                total = exact.problem.rest + sum(
                    mpf(epsilon) ** n * c * mpmath.cos(j * mpf(OMEGA) * mpf(0.3))
                    for (n, j), c in wanted.items()
                )
                place = module["contact"](0.3, OMEGA, epsilon, beta)
                assert np.isnan(place) or abs(mpf(float(place)) / total - 1) < 2.0**-26
        # Where rounding has order 4 but ε⁴ hides it, there is a result; where it does not, none.
        assert np.isfinite(module["contact"](0.3, OMEGA, 1e-9, beta))
    assert np.isnan(module["contact"](0.3, OMEGA, 1e-2, 1e-13))
    assert np.isnan(module["shape"](0.3, 0.3, OMEGA, 1e-2, 1e-13))
    assert np.isfinite(module["contact"](0.3, OMEGA, 1e-2, 1e-6))


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_a_slow_drive_moves_the_static_shape(driven_end: str) -> None:
    """ω → 0 is no resonance: ξ_c is that of a rope held at 1 + ε, whose β is β/(1 + ε)."""
    module = module_of(3, driven_end)
    epsilon, beta = 1e-3, 0.01
    expected = np.sqrt(1 + epsilon) * module["static_contact_point"](beta / (1 + epsilon))
    for omega in (0.0, 1e-300, 1e-9, 1e-6):
        assert module["contact"](0.0, omega, epsilon, beta) == pytest.approx(expected, abs=1e-11)


def test_order_one_is_the_hand_written_module() -> None:
    """What other orders are put into runs as it stands, and is the emitted module of order 1."""
    from asymptotics.printing.emitted import beam

    emitted = beam_numpy(expand_symbolic(1)).splitlines()
    written = Path(beam.__file__).read_text(encoding="utf-8").splitlines()
    differing = [a for a, b in zip(emitted, written, strict=True) if a != b]
    assert [a[:9] for a in differing] == ["Generated"]
