"""How fast periodic states, multipliers and losses are; nothing here fails on time.

β = 0.01. The ratio is to the ramped simulations that give an interval for the same loss, the fold
at Ω = 3.2; how wide both intervals are, part of ε, stands beside it.
"""

from __future__ import annotations

import time

import pytest

from numerics.periodic.loss import loss
from numerics.periodic.stability import stability
from numerics.periodic.states import periodic_state
from numerics.thresholds.threshold import threshold
from tests.numerics.test_states import rope


@pytest.mark.benchmark(group="periodic states, β = 0.01")
@pytest.mark.parametrize(("omega", "epsilon"), [(2.5, 0.05), (6.5, 0.005)])
def test_state(benchmark, omega, epsilon):
    benchmark.extra_info["goal in seconds"] = 0.02
    state = benchmark(periodic_state, rope(omega), epsilon)
    benchmark.extra_info["times"] = state.modes.times


@pytest.mark.benchmark(group="periodic states, β = 0.01")
def test_multipliers(benchmark):
    benchmark.extra_info["goal in seconds"] = 0.2
    benchmark(stability, periodic_state(rope(6.5), 0.005))


@pytest.mark.benchmark(group="periodic states, β = 0.01")
def test_loss_against_the_ramp(benchmark):
    benchmark.extra_info["goal in seconds"] = 5.0
    begin = time.perf_counter()
    found = benchmark.pedantic(loss, args=(rope, 3.2), rounds=1)
    middle = time.perf_counter()
    ramped = threshold(3.2, 0.01)
    benchmark.extra_info["seconds of the ramp per second"] = (time.perf_counter() - middle) / (
        middle - begin
    )
    assert found.upper is not None
    for name, one in (("the state", found), ("the ramp", ramped)):
        benchmark.extra_info[f"width of {name}"] = one.upper / one.lower - 1
