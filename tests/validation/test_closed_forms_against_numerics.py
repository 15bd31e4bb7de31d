"""The emitted closed forms against the exact string and the simulator: error ∝ ε^{N+1}.

What is judged where, by one rule, is in :mod:`derivations.cross_check.data`: at amplitudes that the
series itself allows (q = 0.3), where the error exceeds 10 floors (exact string) or 3 (simulator),
the floors measured without the series.

The slope may be off by 2q² = 0.18 where the window ends and less over all of it, the following
order being orthogonal, plus what floors add: 0.1 for the exact string and 0.15 for the simulator.
A wrong order changes it by 1. The size of the error must be that of the next term: this is what
sees a slip of one per cent in a coefficient of order N (see the last test).
"""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest

from derivations.cross_check.data import (
    PLACES,
    SETTLE,
    Comparison,
    Errors,
    against_exact_string,
    ramped,
)
from derivations.cross_check.forms import (
    beam_form,
    phases,
    string_form,
    string_source,
)
from derivations.cross_check.ladder import (
    BEAM_LARGEST,
    BEAM_OMEGA,
    BETA,
    GOLDEN,
    STRING_LARGEST,
    STRING_OMEGA,
)
from derivations.cross_check.runs import against_simulator, layer_residual
from derivations.generated import beam_order3_pinned, string_order4
from numerics.exact_string.characteristics import exact_string_motion
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.simulation.contact import Scheme

ORDERS = (1, 2, 3, 4)
# At the smallest amplitude judged: a tenth is the floor's, and next terms are below a hundredth.
PREFACTOR = 0.12


@functools.cache
def exact_string() -> Comparison:
    forms = [string_form(GOLDEN, n) for n in ORDERS]
    return against_exact_string(GOLDEN, forms, points=3)


@functools.cache
def simulated_string(dx: float) -> Comparison:
    forms = [string_form(STRING_OMEGA, n) for n in ORDERS[:2]]
    ladder = STRING_LARGEST * 2.0 ** (-np.arange(5) / 2)
    return against_simulator(STRING_OMEGA, 0.0, ladder, forms, dx, Scheme.VERLET, 200.0)


@functools.cache
def simulated_beam() -> Comparison:
    forms = [beam_form(BEAM_OMEGA, n, BETA) for n in ORDERS[:3]]
    ladder = BEAM_LARGEST * 2.0 ** (-np.arange(4) / 2)
    return against_simulator(BEAM_OMEGA, BETA, ladder, forms, 0.0025, Scheme.TRAPEZOIDAL)


def quantity(found: Comparison, name: str) -> Errors:
    return {"contact": found.contact, "shape": found.shape}[name]


def test_the_committed_modules_are_those_compared():
    tau, xi = np.linspace(0, 3, 7), np.linspace(0.1, 0.9, 5)[:, None]
    form = string_form(1.2, string_order4.ORDER)
    assert (string_order4.contact(tau, 1.2, 0.1) == form.contact(tau, 0.1)).all()
    s = np.minimum(xi - form.contact(tau, 0.1), 0)
    assert (string_order4.profile(s, tau, 1.2, 0.1) == form.shape(xi, tau, 0.1)).all()
    bent = beam_form(1.3, beam_order3_pinned.ORDER, BETA)
    assert (beam_order3_pinned.contact(tau, 1.3, 0.1, BETA) == bent.contact(tau, 0.1)).all()
    assert (beam_order3_pinned.shape(xi, tau, 1.3, 0.1, BETA) == bent.shape(xi, tau, 0.1)).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["contact", "shape"])
@pytest.mark.parametrize("order", ORDERS)
def test_exact_string(order: int, name: str):
    found = exact_string()
    errors = quantity(found, name)
    assert found.slope(errors, order) == pytest.approx(order + 1, abs=0.1)
    # Double precision holds barely more than the ten decades of error that two decades of ε take
    # at N = 4; of W, four terms that cancel, a little less.
    of_epsilon, of_error = found.decades(errors, order)
    least = 1.99 if name == "contact" else 1.6
    assert of_epsilon > least
    assert of_error > 1.9 * (order + 1) * least / 2
    assert found.prefactor(order) == pytest.approx(1, abs=PREFACTOR)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["contact", "shape"])
@pytest.mark.parametrize("order", ORDERS[:2])
def test_simulated_string(order: int, name: str):
    found = simulated_string(0.0025)
    errors = quantity(found, name)
    assert found.judged(errors, order).sum() >= 2
    assert found.slope(errors, order) == pytest.approx(order + 1, abs=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["contact", "shape"])
@pytest.mark.parametrize("order", ORDERS[:3])
def test_simulated_rope_with_bending(order: int, name: str):
    found = simulated_beam()
    errors = quantity(found, name)
    assert found.judged(errors, order).sum() >= 3
    assert found.slope(errors, order) == pytest.approx(order + 1, abs=0.15)


def test_the_simulators_floor_is_of_second_order():
    """Of W; nodes that land make it scatter by a factor, so its mean over amplitudes is taken."""
    omega, ladder = 0.83, [0.12, 0.08, 0.05, 0.03]
    coarse, fine = (
        against_simulator(omega, 0.0, ladder, [string_form(omega, 1)], dx, Scheme.VERLET, 120.0)
        for dx in (0.02, 0.005)
    )
    rate = np.log(coarse.shape.floor / fine.shape.floor).mean() / np.log(4)
    assert rate == pytest.approx(2, abs=0.35)


@pytest.mark.slow
def test_bending_vanishes_with_beta():
    """ξ_c − ξ_c⁰ − √(β/(1−ξ_c′²)) − β/2, on average, is of higher order than the layer √β."""
    form = string_form(1.2, 4)
    betas = np.array([1e-2, 1e-3, 1e-4])
    found = [
        layer_residual(form, 1.2, 0.05, beta, dx)
        for beta, dx in zip(betas.tolist(), (0.01, 0.005, 0.0025), strict=True)
    ]
    assert (np.abs(found) < 0.5 * betas).all()


@pytest.mark.slow
def test_the_ramp_ends_in_the_periodic_state():
    """Its transient falls faster than any power of the ramp's length: the local exponent grows."""
    epsilon, xi = 0.001, PLACES[:, None]
    circle = invariant_circle(GOLDEN, epsilon)
    transients = []
    for length in (25.0, 50.0, 100.0, 200.0):
        drive = ramped(GOLDEN, epsilon, length)
        tau = phases(GOLDEN, length + SETTLE)
        motion = exact_string_motion(drive, float(tau[-1]) + 1, max_labels=64)
        transients.append(np.abs(motion.contact(tau) - circle.contact(tau)).max())
        assert np.abs(motion.shape(xi, tau) - circle.shape(xi, tau)).max() < 2 * transients[-1]
    exponents = -np.diff(np.log2(transients))
    assert (np.diff(exponents) > 1).all()
    assert transients[-1] < 1e-7 * epsilon


def spoil(source: str, name: str) -> str:
    """The source with one per cent added to an assignment ``name = …`` of one line."""
    changed, count = re.subn(rf"(?m)^(    {name} = )(.+)$", r"\g<1>1.01 * (\g<2>)", source, count=1)
    assert count == 1
    return changed


@pytest.mark.slow
@pytest.mark.parametrize("order", ORDERS)
def test_one_per_cent_in_the_emitted_source_shows(order: int):
    """The size of the error would no longer be that of the next term, as required above."""
    found = exact_string()
    last = int(np.flatnonzero(found.judged(found.contact, order))[-1])
    epsilon = float(found.epsilon[last])
    tau = phases(GOLDEN, 0.0)
    truth = invariant_circle(GOLDEN, epsilon).contact(tau)
    ratios = []
    for source in (string_source(order), spoil(string_source(order), f"h{order}")):
        error = string_form(GOLDEN, order, source).contact(tau, epsilon) - truth
        ratios.append(np.sqrt(np.mean(error**2)) / (found.sizes[order] * epsilon ** (order + 1)))
    assert ratios[0] == pytest.approx(1, abs=PREFACTOR)
    assert ratios[1] > 1 + 1.5 * PREFACTOR
