"""The simulator's smoothed contact point against the expansion, from the exact periodic state."""

from __future__ import annotations

import numpy as np
import pytest

from numerics.problems.drive import cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import follow
from numerics.simulation.semi_discrete import Grid
from tests.benchmarks.forced_rope import (
    BETA,
    EPSILON,
    OMEGA,
    PERIOD,
    contact_series,
    profile,
    rms,
)
from tests.numerics.by_hand import order


@pytest.mark.slow
def test_smoothing_brings_the_noise_down_to_the_error_of_the_grid():
    """Ω = 2.5, ε = .05, β = .01; the series is good to 3e-8 there. The rms errors are those that
    the docstring of ``smooth_contact`` gives; a window of √dx leaves 2.8e-4 at dx = .01."""
    sizes, raw, smooth = [0.02, 0.01, 0.005], [], []
    for dx in sizes:
        simulator = Simulator(RopeProblem(BETA, cosine(OMEGA, EPSILON)), Grid(dx, 3.0, 0.0))
        places = simulator.system.positions
        simulator.state.height[:] = profile(places, 0.0)
        simulator.state.active[:] = places >= contact_series(0.0)
        run = follow(simulator, 4 * PERIOD, record_from=1.5 * PERIOD)
        times, contact = run.smooth_contact()
        exact = contact_series(times)
        raw.append(rms(run.column(Column.CONTACT) - exact))
        smooth.append(rms(contact - exact))
    np.testing.assert_allclose(raw, [2.1e-3, 1.1e-3, 4.9e-4], rtol=0.05)
    np.testing.assert_allclose(smooth, [4.8e-4, 1.6e-4, 8.0e-5], rtol=0.05)
    assert 1.2 < order(sizes, smooth) < 1.4
