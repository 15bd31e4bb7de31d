"""The resummed pendulum against the exact circle: an error of the next order in μ.

At a fixed Λ the pendulum's harmonics of ξ_c, those of cos kqθ, are of size μ; what is left out is
of relative size μ. So against the exact state their error falls like μ². The two share nothing: an
elliptic function with one coefficient read off the engine's expansion, and Newton's iteration on
the standard map's invariant circle. A wrong v_q, sign, mean or shape leaves an error of order μ.

For q = 3 the amplitude is ε ~ μ^{2/3}, so the shift of the resonance's centre by γε² ~ μ^{4/3}
matters: with it the order is 2, without it the error is Λ-derivative times γε², of order 4/3.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from asymptotics.resonances.pendulum import momentum
from asymptotics.resonances.singular_part import centre_shift, singular_part
from asymptotics.resonances.tongues import limit_law
from numerics.errors import CircleNotFoundError
from numerics.exact_string.invariant_circle import invariant_circle

NODES = 64
THETA = np.arange(NODES) * (2 * math.pi / NODES)
EPS = 2.0**-52

# (p, q, |Λ|, largest |μ|): three halvings. The largest μ is where the next order is a tenth of the
# size: smaller for larger q, whose amplitude ε ~ μ^{2/q} must stay below break-up of the circle.
CASES = [
    (1, 1, 0.2, 0.1),
    (1, 1, 0.45, 0.1),
    (2, 1, 0.45, 0.1),
    (1, 2, 0.2, 0.05),
    (1, 2, 0.45, 0.02),
    (3, 2, 0.45, 0.05),
    (1, 3, 0.2, 0.02),
    (1, 3, 0.45, 0.005),
    (2, 3, 0.2, 0.01),
]
HALVINGS = 3


def errors(
    p: int, q: int, strength: float, largest: float, shifted: bool = True, factor: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Largest error and size of the resonant harmonics at μ = largest, largest/2, …"""
    part = singular_part(p, q, q)
    first, centre = part.values()[q], p * math.pi / q
    shift = float(part.field.value(centre_shift(p, q))) if q > 2 and shifted else 0.0
    resonant = np.arange(q, NODES // 2, q)
    error, size = [], []
    for i in range(HALVINGS + 1):
        mu = largest * 2.0**-i
        epsilon = (strength * mu * mu / (centre * abs(first))) ** (1 / q)
        omega = centre + mu + shift * epsilon**2
        contact = invariant_circle(omega, epsilon).contact(THETA / omega)
        Lambda = factor * math.copysign(strength, first)
        pendulum = mu / centre * (momentum(Lambda, q * THETA) - 1)
        found, expected = (np.fft.rfft(x)[resonant] / NODES for x in (contact, pendulum))
        error.append(np.abs(found - expected).max())
        size.append(np.abs(expected).max())
    return np.array(error), np.array(size)


def order(error: np.ndarray) -> float:
    """Observed exponent of μ over the last halving."""
    return math.log2(error[-2] / error[-1])


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("p", "q", "strength", "largest"), CASES)
def test_second_order(p: int, q: int, strength: float, largest: float, side: int) -> None:
    error, size = errors(p, q, strength, side * largest)
    # Orders beyond the next are a relative μ for q ≤ 2, at q = 3 a relative ε ~ μ^{1/3} with small
    # coefficients: a quarter of an order is what they leave here.
    assert order(error) == pytest.approx(2, abs=0.25)
    assert error[-1] < 0.1 * size[-1]
    assert error[-1] > 64 * EPS


@pytest.mark.parametrize("side", [1, -1])
def test_without_the_shift_of_the_centre(side: int) -> None:
    plain, _ = errors(1, 3, 0.2, side * 0.005, shifted=False)
    better, _ = errors(1, 3, 0.2, side * 0.005)
    assert order(plain) == pytest.approx(4 / 3, abs=0.1)
    assert plain[-1] > 5 * better[-1]


@pytest.mark.parametrize("factor", [1.01, -1.0])
def test_a_wrong_strength_shows(factor: float) -> None:
    """A per cent of v_q, or its sign, leaves an error of first order."""
    error, _ = errors(1, 2, 0.45, 0.003, factor=factor)
    assert order(error) < 1.5


@pytest.mark.parametrize("mu", [0.1, 0.05, 0.025, -0.1, -0.05, -0.025])
@pytest.mark.parametrize(("p", "q", "slope"), [(1, 1, 2), (2, 1, 2), (1, 2, 4)])
def test_the_limit_law_is_where_the_circle_is_lost(p: int, q: int, slope: int, mu: float) -> None:
    """ε_lost = (π²μ²/(4v_q))^{1/q} (1 + O(μ)), from both sides of the threshold and of Ω₀.

    Measured: 1 − 0.7 μ to 1 − 1.0 μ at q = 1, 1 − 1.5 μ to 1 − 2.2 μ at q = 2; ``slope`` is twice
    that, so a coefficient that is wrong by 10 % fails at |μ| = 0.025.
    """
    law = limit_law(p, q)
    epsilon = law.coefficient * abs(mu) ** float(law.exponent)
    omega = p * math.pi / q + mu
    margin = slope * abs(mu)
    assert invariant_circle(omega, epsilon * (1 - margin)).graph_margin > 0
    with pytest.raises(CircleNotFoundError):
        invariant_circle(omega, epsilon * (1 + margin), max_nodes=512)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("p", "q"), [(1, 1), (2, 1), (1, 2), (3, 2), (1, 3), (2, 3), (1, 4), (3, 4)]
)
def test_the_range_of_the_limit_law(p: int, q: int, side: int) -> None:
    """At the edge of the stated range the circle is lost within the stated error of the law."""
    law = limit_law(p, q)
    distance = law.range
    assert distance is not None
    error, epsilon = law.error(distance), law.epsilon(distance)
    assert error == pytest.approx(0.1, rel=1e-9)

    def omega(amplitude: float) -> float:
        return p * math.pi / q + side * distance + law.shift_value * amplitude**2

    below, above = epsilon * (1 - error), epsilon * (1 + error)
    assert invariant_circle(omega(below), below).graph_margin > 0
    with pytest.raises(CircleNotFoundError):
        invariant_circle(omega(above), above, max_nodes=512)
