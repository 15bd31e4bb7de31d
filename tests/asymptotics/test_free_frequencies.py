"""Free frequencies of any rope: against closed forms, the beam's own spectrum, and the poles."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand
from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.free_frequencies import check_resonance, free_frequencies
from asymptotics.problems.moving_contact import moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi


@pytest.mark.parametrize("end", ["pinned", "clamped"])
@pytest.mark.parametrize("beta", [1e-5, 1e-3, 0.1, 0.9])
def test_the_beam_has_its_own_spectrum(beta: float, end: str) -> None:
    """Layers of √β and poles of the impedance next to its zeros included."""
    found = free_frequencies(beam(driven_end=end), {"beta": beta}, 12)
    exact = linear_frequencies(beta, 12, end)
    assert np.max(np.abs(found.values / exact - 1)) < 1e-11
    assert np.all(found.errors < 1e-10 * exact)


def test_damped_strings_ring_and_decay() -> None:
    """ω² − 2iζω = p²π² + κ + iηω p²π²."""
    zeta, eta, kappa = 0.2, 0.02, 0.7
    rope = string(damping=zeta, viscosity=eta, foundation=kappa)
    found = free_frequencies(rope, {}, 6)
    k2 = (np.pi * np.arange(1, 7) / found.static_contact) ** 2
    left = found.values**2 - 2j * zeta * found.values - kappa - k2 - 1j * eta * found.values * k2
    assert np.max(np.abs(left)) < 1e-7
    assert np.all(found.values.imag > 0)
    assert np.all(found.errors < 1e-8)
    assert np.all(found.errors > 0)


def test_a_travelling_string() -> None:
    """e^{iωτ} between two fixed ends at speed v: ω_p = pπ(1 − v²)/ξ₀; gyroscopic, no decay."""
    v = 0.4
    rope = moving_contact(
        equation=sp.Eq(W.diff(tau, 2) + 2 * v * W.diff(xi, tau) - (1 - v**2) * W.diff(xi, 2), -2),
        driven_end=[sp.Eq(W, 1 + epsilon * sp.cos(Omega * tau))],
        contact=[W, W.diff(xi)],
    )
    found = free_frequencies(rope, {}, 3)
    exact = np.pi * np.arange(1, 4) * (1 - v**2) / found.static_contact
    assert np.max(np.abs(found.values - exact)) < 1e-9


def test_there_the_expansion_grows_without_bound() -> None:
    rope = string(foundation=1.7)
    pole = float(free_frequencies(rope, {}, 1).values[0]) / 2
    sizes = [abs(expand(rope, 2, at={"Omega": pole * (1 + d)}).contact(2)[2]) for d in (1e-4, 1e-6)]
    assert 90 < sizes[1] / sizes[0] < 110
    with pytest.raises(ResonanceError, match="omega_1/2") as caught:
        check_resonance(rope, {"Omega": pole}, [1, 2])
    assert (caught.value.p, caught.value.q) == (1, 2)
    check_resonance(rope, {"Omega": pole}, [1, 3])


def test_bad_requests() -> None:
    for count in (0, 1000, 1.5):
        with pytest.raises(InputError, match="whole number"):
            free_frequencies(string(), {}, count)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="does not give way"):
        free_frequencies(string(springs=4), {}, 1)
    with pytest.raises(InputError, match="no value"):
        free_frequencies(beam(), {}, 1)
    with pytest.raises(InputError, match="is lost"):
        free_frequencies(string(damping=5.0), {}, 1)
