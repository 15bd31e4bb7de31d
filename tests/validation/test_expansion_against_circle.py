"""The engine's series against the exact circle: the error of order N falls like ε^{N+1}.

The two share nothing: a Taylor expansion of moving contact conditions, and an invariant circle of
the standard map. A wrong coefficient at order n leaves an error that falls like εⁿ only. It shows
when it is not small against order n + 1 at the amplitudes used: from 1e-5 of ξ_1 over 1e-2 of ξ_4
to 1e-1 of ξ_8. Finer slips are for the proof by substitution.

One rule chooses the amplitudes everywhere. They lie on a ladder of ratio 2^{1/4} that starts at
ε̂ = 0.2/r, r = ‖ξ_8‖^{1/8} estimating the inverse radius of convergence, and an order is judged by
those where its error lies in WINDOW: above 1e-13, a hundred times the rounding of both sides
(4 units of 2⁻⁵² ≈ 1e-15), and below 1e-9, where later orders have become small. The error is a root
mean square over a period: orders n and n + 1 hold harmonics of different parity and are orthogonal,
so that the slope is off by O(ε²) only.

Order N + 2 makes that share. Where it is next to its own resonance, |(N + 2)Ω − pπ| < CLEAR, it is
not small, and order N is left out: of the 48 pairs below only Ω = 2.2, N = 8 (22 = 7π + 0.009).
"""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
import pytest

from asymptotics import Expansion, MovingFrame, expand, float_string, moving_frame
from numerics.exact_string.invariant_circle import InvariantCircle, invariant_circle

ORDER = 8
OMEGAS = (0.83, 1.2, 2.2, 2.7, 4.0, 5.0)
CLEAR = 0.02
WINDOW = (1e-13, 1e-9)
# Order N + 2 changes the slope by 2 (ε̂ r)² ≤ 0.08 if the orders grow evenly, which they do to about
# a factor of two; a wrong order changes it by 1.
TOLERANCE = 0.15


def clear(omega: float, order: int) -> bool:
    return abs(math.remainder((order + 2) * omega, math.pi)) >= CLEAR


CASES = [(omega, n) for omega in OMEGAS for n in range(1, ORDER + 1) if clear(omega, n)]

# Midpoints of half a period are enough, the state being even in time.
THETA = (np.arange(24) + 0.5) * (math.pi / 24)
S = np.linspace(-0.8, 0, 21)


def fourier(harmonics: dict[int, float]) -> np.ndarray:
    """c₀ + Σ 2 c_j cos jθ on THETA."""
    total = np.zeros_like(THETA)
    for j, c in harmonics.items():
        total += (1 if j == 0 else 2) * c * np.cos(j * THETA)
    return total


def contact_orders(expansion: Expansion[float]) -> np.ndarray:
    """Order n of ξ_c in row n."""
    rows = [np.ones_like(THETA)]
    return np.array(rows + [fourier(expansion.contact(n)) for n in range(1, expansion.order + 1)])


def profile_orders(frame: MovingFrame[float], omega: float) -> np.ndarray:
    """Order n of W(ξ_c + s, τ) in entry n, an array over (s, θ)."""
    functions = [(frame.static, (np.ones_like(S), S, S**2 / 2))]
    for k, series in frame.modes.items():
        if k == 0:
            functions.append((series, (np.ones_like(S), S)))
        else:
            rate = k * omega
            functions.append((series, (np.cos(rate * S), np.sin(rate * S) / rate)))
    return np.array(
        [
            sum(
                np.multiply.outer(values, fourier(coefficients[n]))
                for series, basis in functions
                for coefficients, values in zip(series, basis, strict=True)
            )
            for n in range(frame.expansion.order + 1)
        ]
    )


@dataclasses.dataclass(frozen=True)
class Ladder:
    """The exact states at one Ω, ε̂ from large to small."""

    omega: float
    expansion: Expansion[float]
    small: np.ndarray
    contacts: np.ndarray
    profiles: np.ndarray


@functools.cache
def ladder_at(omega: float) -> Ladder:
    expansion = expand(float_string(omega, ORDER), ORDER)
    growth = np.abs(fourier(expansion.contact(ORDER))).max() ** (1 / ORDER)
    sine = math.sin(omega)
    small = math.copysign(0.2 / growth, sine) * 2.0 ** (-np.arange(72) / 4)
    states = [invariant_circle(omega, float(x * sine)) for x in small]
    tau = THETA / omega
    return Ladder(
        omega,
        expansion,
        small,
        np.array([state.contact(tau) for state in states]),
        np.array([profile(state, tau) for state in states]),
    )


def profile(state: InvariantCircle, tau: np.ndarray) -> np.ndarray:
    return state.profile(S[:, None], tau[None, :])


def slope(orders: np.ndarray, exact: np.ndarray, small: np.ndarray, order: int) -> float:
    """The exponent of ε in the root-mean-square error of the series cut off at ``order``."""
    powers = small[:, None] ** np.arange(order + 1)
    error = np.tensordot(powers, orders[: order + 1], axes=1) - exact
    size = np.sqrt((error.reshape(len(small), -1) ** 2).mean(axis=1))
    inside = (size > WINDOW[0]) & (size < WINDOW[1])
    # Four decades of error are at least 4/(N + 1) decades of ε, 5 steps of the ladder at N = 8.
    assert inside.sum() >= 5
    return float(np.polyfit(np.log(np.abs(small[inside])), np.log(size[inside]), 1)[0])


def test_few_cases_are_left_out():
    assert len(CASES) == len(OMEGAS) * ORDER - 1


@pytest.mark.parametrize(("omega", "order"), CASES)
def test_contact_point(omega: float, order: int):
    ladder = ladder_at(omega)
    found = slope(contact_orders(ladder.expansion), ladder.contacts, ladder.small, order)
    assert found == pytest.approx(order + 1, abs=TOLERANCE)


@pytest.mark.parametrize(("omega", "order"), CASES)
def test_profile(omega: float, order: int):
    ladder = ladder_at(omega)
    orders = profile_orders(moving_frame(ladder.expansion), omega)
    found = slope(orders, ladder.profiles, ladder.small, order)
    assert found == pytest.approx(order + 1, abs=TOLERANCE)


@pytest.mark.parametrize("order", range(2, ORDER + 1))
def test_a_missing_harmonic_shows(order: int):
    """Without the largest harmonic of ξ_n the slope falls to n: the tests above would fail."""
    ladder = ladder_at(0.83)
    orders = list(ladder.expansion.orders)
    wrong = dict(orders[order - 1].contact)
    del wrong[max(wrong, key=lambda j: abs(wrong[j]))]
    orders[order - 1] = dataclasses.replace(orders[order - 1], contact=wrong)
    spoilt = dataclasses.replace(ladder.expansion, orders=tuple(orders))
    of_contact = slope(contact_orders(spoilt), ladder.contacts, ladder.small, order)
    of_profile = slope(
        profile_orders(moving_frame(spoilt), ladder.omega), ladder.profiles, ladder.small, order
    )
    assert max(of_contact, of_profile) < order + 0.5
