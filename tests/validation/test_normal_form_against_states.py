"""Folds and edges of normal forms against spectral periodic states and their multipliers."""

import numpy as np
import pytest
import sympy

from asymptotics.problems.presets import beam
from asymptotics.resonances.normal_form import normal_form
from derivations.cross_check.ropes import by_frequency
from numerics.periodic.branches import doubled_state
from numerics.periodic.linear_rope import LinearRope, NoPeriodicStateError
from numerics.periodic.stability import multipliers
from numerics.periodic.states import periodic_state


def stated(omega: float) -> LinearRope:
    """The paper's rope at β = 0.01, stated for the numerics."""
    return by_frequency(beam(), {"beta": 0.01})(omega)


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.002, 0.01])
def test_damped_states_end_at_the_fold(damping: float) -> None:
    """b is complex there, and behind the fold there is another state, of twice the amplitude."""
    at = {"beta": 0.01, "zeta": damping}
    rope = beam(damping=sympy.Symbol("zeta"))
    fold, back = normal_form(rope, at, 1, 1, 3.2, 7).folds()
    numbers = by_frequency(rope, at)(3.2)
    assert back.epsilon < fold.epsilon
    state = periodic_state(numbers, fold.epsilon - fold.error)
    assert state.clearance() > 0
    with pytest.raises(NoPeriodicStateError):
        periodic_state(numbers, fold.epsilon + fold.error)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "q", "omega", "order"), [(1, 1, 3.2, 9), (2, 2, 3.59, 10), (1, 2, 1.62, 8)]
)
def test_states_end_at_the_fold(p: int, q: int, omega: float, order: int) -> None:
    form = normal_form(beam(), {"beta": "0.01"}, p, q, omega, order)
    fold = form.folds()[0]
    below, above = fold.epsilon * (1 - 4e-3), fold.epsilon * (1 + 4e-3)
    assert fold.error < 1e-2 * fold.epsilon
    state = periodic_state(stated(omega), below)
    assert state.clearance() > 0
    with pytest.raises(NoPeriodicStateError):
        periodic_state(stated(omega), above)
    # A pair e^{±iφ} closes in on +1: φ² ∝ ∂G/∂b, the square root of the distance, here a quarter.
    nearest = [
        np.sort(abs(np.angle(multipliers(periodic_state(stated(omega), e), 10))))[0]
        for e in (fold.epsilon * (1 - 16e-3), below)
    ]
    assert nearest[1] / nearest[0] == pytest.approx(4**-0.25, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("omega", "order"), [(6.48, 8), (6.52, 8), (6.55, 8)])
def test_a_multiplier_passes_minus_one_at_the_edge(omega: float, order: int) -> None:
    edge = normal_form(beam(), {"beta": "0.01"}, 1, 1, omega, order, subharmonic=2).edge()
    assert edge is not None
    margin = max(2 * edge.error, 2e-3 * edge.epsilon)
    below, above = (
        multipliers(periodic_state(stated(omega), edge.epsilon + d * margin), 12) for d in (-1, 1)
    )
    assert abs(abs(below) - 1).max() < 1e-6
    worst = above[abs(above).argmax()]
    assert abs(worst) > 1 + 1e-4
    assert worst.real < -1
    assert abs(worst.imag) < 1e-8


@pytest.mark.slow
def test_the_state_of_twice_the_period() -> None:
    """b = ∂^{m−1} w_J at ξ₀ of the state, w continued beyond ξ_c, is the only root but zero."""
    form = normal_form(beam(), {"beta": "0.01"}, 1, 1, 6.45, 10, subharmonic=2)
    for epsilon, error in ((2.4e-3, 5e-5), (2e-3, 1e-5)):
        state = doubled_state(stated(6.45), epsilon)
        modes = state.modes
        rest = np.full(modes.times, modes.rope.rest)
        slopes = modes.shape(state.unknown, epsilon, rest, modes.tau, modes.rope.contacts - 1)
        found = 2 * abs(np.fft.fft(slopes)[1]) / modes.times / abs(form.leading)
        (amplitude,) = (a for a in form.amplitudes(epsilon) if 0 < a < 0.1)
        assert found == pytest.approx(amplitude, rel=error)
