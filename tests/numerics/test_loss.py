"""Where the wave-less state is lost: known folds and doublings, an instability, lower bounds."""

import numpy as np
import pytest

from asymptotics.problems.beam_spectrum import linear_frequencies
from numerics.errors import InputError
from numerics.periodic.linear_rope import NoPeriodicStateError
from numerics.periodic.loss import Loss, Mechanism, loss
from numerics.periodic.stability import multipliers
from numerics.periodic.states import PeriodicState, decay, periodic_state, resolved
from tests.numerics.test_states import rope


def found(omega: float, highest: float = 0.5) -> Loss:
    return loss(rope, omega, highest)


def test_the_fold() -> None:
    lost = found(3.2)
    assert lost.mechanism is lost.end_mechanism is Mechanism.FOLD
    assert lost.upper is not None
    assert lost.lower <= 1.38788e-3 + 1e-8
    assert lost.upper >= 1.38788e-3 - 1e-8
    assert 0 < lost.upper - lost.lower < 1e-9
    assert lost.harmonic == 1
    assert lost.beyond is None
    assert lost.growth is None
    periodic_state(rope(3.2), 0.997 * lost.lower)
    with pytest.raises(NoPeriodicStateError):
        periodic_state(rope(3.2), 1.003 * lost.upper)


@pytest.mark.slow
def test_the_period_doubling() -> None:
    lost = found(6.48)
    assert lost.mechanism is Mechanism.DOUBLING
    assert lost.upper is not None
    assert lost.lower == pytest.approx(9.65194e-4, abs=1e-8)
    assert lost.end > lost.upper
    assert lost.growth is not None
    assert lost.growth > 0
    below, above = (
        abs(multipliers(periodic_state(rope(6.48), e), 12)).max()
        for e in (0.998 * lost.lower, 1.002 * lost.upper)
    )
    assert below < 1 + 1e-6 < above


@pytest.mark.slow
def test_a_window_of_instability_is_not_stepped_over() -> None:
    """At Ω = 6.4 from .00348 to below .0051, where steps along the branch are longer."""
    lost = found(6.4)
    assert lost.mechanism is Mechanism.INSTABILITY
    assert lost.lower == pytest.approx(3.4845e-3, rel=2e-3)
    beyond, again = (
        abs(multipliers(periodic_state(rope(6.4), e), 14)).max() for e in (3.6e-3, 5.1e-3)
    )
    assert beyond > 1 + 1e-4
    assert again < 1 + 1e-6


def test_a_graze(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if the lifted part came down at ε = .0123."""

    def height(state: PeriodicState, *_: int) -> float:
        return 0.0123 - state.epsilon

    monkeypatch.setattr(PeriodicState, "clearance", height)
    lost = found(2.2, 0.05)
    assert lost.mechanism is lost.end_mechanism is Mechanism.GRAZE
    assert lost.upper is not None
    assert lost.lower <= 0.0123 <= lost.upper <= 1.002 * lost.lower


@pytest.mark.slow
def test_a_gap_of_a_high_harmonic_is_told() -> None:
    """At Ω = 6 the branch folds where six times the frequency meets a free one."""
    lost = found(6.0, 0.01)
    assert lost.mechanism is Mechanism.FOLD
    assert lost.harmonic == 6
    assert lost.lower == pytest.approx(4.79270e-3, abs=1e-8)


def test_the_rate_of_decay() -> None:
    """Of the string: its circle is analytic, the less the farther it is driven."""
    rates = []
    for epsilon in (0.02, 0.04, 0.06):
        state = periodic_state(rope(2.2, 0.0), epsilon)
        rates.append(decay(state))
        last = resolved(state)
        size = abs(state.waves)
        fitted = np.polyfit(np.arange(last // 2, last + 1), np.log(size[last // 2 : last + 1]), 1)
        assert rates[-1] == pytest.approx(-fitted[0], rel=0.2)
    assert rates[0] > rates[1] > rates[2] > 0.2


@pytest.mark.slow
def test_another_instability() -> None:
    """Two free modes whose frequencies add up: at Ω = 5 a pair leaves the circle off the axis."""
    lost = found(5.0, 0.03)
    assert lost.mechanism is Mechanism.INSTABILITY
    assert lost.upper is not None
    assert lost.upper - lost.lower < 2e-3 * lost.upper
    values = multipliers(periodic_state(rope(5.0), 1.01 * lost.upper), 14)
    assert abs(values[0]) > 1 + 1e-5
    assert abs(values[0].imag) > 0.1
    assert abs(multipliers(periodic_state(rope(5.0), 0.99 * lost.lower), 14)).max() < 1 + 1e-6


def test_nothing_is_lost_below_the_largest_amplitude() -> None:
    lost = found(2.2, 0.01)
    assert lost.mechanism is Mechanism.NONE
    assert lost.upper is None
    assert lost.lower == 0.01


def test_a_resonance_has_no_state() -> None:
    """Ω₁ itself, to rounding."""
    centre = float(linear_frequencies(0.01, 1)[0])
    with pytest.raises(NoPeriodicStateError):
        found(centre)


@pytest.mark.parametrize("highest", [0.0, -1.0, np.nan, np.inf])
def test_arguments(highest: float) -> None:
    with pytest.raises(InputError, match="positive amplitude"):
        found(2.2, highest)
