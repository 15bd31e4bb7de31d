"""The folds' laws, kinds and ranges against periodic states found by harmonic balance."""

from __future__ import annotations

import numpy as np
import pytest

from asymptotics.resonances.folds import Fold, Kind, fold
from tests.validation.beam_states import BeamStates, extremum


def turning_point(law: Fold, mu: float, harmonics: int = 16) -> float:
    """ε at the fold of the branch from rest, the amplitude of harmonic q raised through it."""
    states = BeamStates(law.beta, law.resonance + mu, law.q, harmonics)
    epsilon = float(law.epsilon(mu))
    start = states.state(states.rest, -1, epsilon / 4)
    first = start[states.amplitude_entry()]
    return extremum(states.family(start, np.linspace(first, 2.5 * law.amplitude(epsilon), 81)))


@pytest.mark.parametrize(
    ("p", "q", "beta", "deviations"),
    [
        (1, 1, 0.01, {-0.01: -0.0188, -0.03: -0.0557, -0.065: -0.1206}),
        (1, 1, 0.001, {-0.01: -0.0691, -0.02: -0.1247, -0.07: -0.3042}),
        (1, 1, 1.0, {-0.05: -0.0187}),
        (2, 1, 0.01, {0.01: 0.0021}),
        (1, 2, 1.0, {-0.02: -0.0104, -0.05: -0.0593}),
        (1, 2, 0.01, {-0.005: -0.0120, -0.02: -0.0522}),
        (3, 2, 0.01, {-0.01: 0.0216}),
        (2, 3, 0.01, {0.002: -0.0042, 0.004: -0.0092}),
        (1, 3, 0.001, {-1.8e-4: -0.0062}),
        (2, 3, 0.001, {-0.001: -0.0038}),
    ],
)
def test_the_estimate_covers_what_the_law_is_off(
    p: int, q: int, beta: float, deviations: dict[float, float]
) -> None:
    law = fold(p, q, beta)
    assert law.kind is Kind.END
    assert law.range is not None
    for mu, wanted in deviations.items():
        found = float(law.epsilon(mu)) / turning_point(law, mu) - 1
        # The parabola through three of 81 amplitudes: 1e-4 of ε.
        assert found == pytest.approx(wanted, abs=2e-4)
        assert abs(found) <= law.range.slope * abs(mu)
        assert (law.error(mu) < 1) == (abs(mu) <= law.range.mu)


def test_the_state_from_rest_passes_through_a_birth() -> None:
    """β = 0.01, above Ω₁/3: no fold up to ε = 0.15, five times the law; a pair from there on."""
    law, mu = fold(1, 3, 0.01), 1e-5
    assert law.kind is Kind.BIRTH
    epsilon, amplitude = float(law.epsilon(mu)), law.amplitude(float(law.epsilon(mu)))
    assert epsilon == pytest.approx(0.0294, abs=5e-5)
    states = BeamStates(0.01, law.resonance + mu, 3, 18)
    raised = states.raised(np.linspace(0, 0.15, 151)[1:])
    assert raised[-1, 1] == pytest.approx(0.15)
    # The single state has the other sign, and twice the pair's amplitude.
    here = np.interp(epsilon, raised[:, 1], raised[:, 0])
    assert here == pytest.approx(-2 * amplitude, rel=0.05)
    start = states.state(states.rest, -1, epsilon)
    pair = states.state(start, states.amplitude_entry(), amplitude)
    # The smaller of the two soon runs along in ε; its amplitude hardly falls.
    small = states.family(pair, amplitude * np.linspace(1, 0.95, 21))
    large = states.family(pair, amplitude * np.linspace(1, 2, 51))
    both = np.vstack([small[::-1], large[1:]])
    birth = extremum(both)
    assert birth == pytest.approx(both[:, 1].min(), rel=1e-5)
    assert abs(epsilon / birth - 1) <= float(law.error(mu))
    assert small[-1, 1] > 1.01 * birth
    assert large[-1, 1] > 1.2 * birth


@pytest.mark.parametrize(("p", "q", "mu"), [(1, 1, -0.01), (1, 2, -0.01), (2, 3, 0.002)])
def test_the_state_from_rest_ends(p: int, q: int, mu: float) -> None:
    """Raised in ε, Newton follows it up to the fold, and lands elsewhere or nowhere beyond."""
    law = fold(p, q, 0.01)
    # With 16 the highest harmonic resonates beyond the fold, and Newton lands there.
    states = BeamStates(0.01, law.resonance + mu, q, 24)
    epsilon = turning_point(law, mu, 24)
    raised = states.raised(epsilon * np.linspace(0.02, 1.1, 55))
    amplitude = law.amplitude(epsilon)
    along = raised[(raised[:, 0] / amplitude > 0) & (abs(raised[:, 0] / amplitude) < 1.2)]
    assert 0.96 * epsilon < along[-1, 1] <= epsilon * (1 + 1e-6)


@pytest.mark.parametrize(("p", "q", "epsilon"), [(1, 3, 0.0294), (1, 1, 1.2e-4)])
def test_a_sweep_meets_either_kind(p: int, q: int, epsilon: float) -> None:
    """At fixed ε, α < 0: Ω raised from below, the small state is lost at the law's detuning."""
    law = fold(p, q, 0.01)
    fold_mu = float(law.detuning(epsilon))
    width = abs(fold_mu) + law.q * abs(law.amplitude(epsilon)) ** 2
    last = None
    state = None
    for mu in fold_mu + width * np.linspace(-2, 0.5, 26):
        states = BeamStates(0.01, law.resonance + mu, q)
        try:
            state = states.state(states.rest if state is None else state, -1, epsilon)
        except ArithmeticError:
            break
        share = state[states.amplitude_entry()] / law.amplitude(epsilon)
        if not 0 < share < 1.5:
            break
        last = mu
    assert last is not None
    assert last == pytest.approx(fold_mu, abs=0.12 * width)
