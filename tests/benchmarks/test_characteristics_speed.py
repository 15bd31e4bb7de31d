"""How fast the exact string's map is; nothing here fails on time.

``pytest tests/benchmarks --benchmark-only`` prints the groups: the compiled map against the same
map in NumPy over the labels and in a plain Python loop, in map steps (with the tangent map) a
second, kept as ``map steps a second``. The goal is 10⁷ on one core.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from numerics.exact_string import kernels
from numerics.exact_string.orbits import return_map
from numerics.problems.drive import ramped_cosine

OMEGA, EPSILON, LABELS = 2.2, 0.002, 256


def compiled(ramp, hold, points):
    period = 2 * math.pi / OMEGA
    full = np.full(points, 1.0)
    return kernels.many_sonic(
        OMEGA * full, EPSILON * full, ramp * period * full, (ramp + hold) * period * full, LABELS
    )


def in_numpy(ramp, hold):
    drive = ramped_cosine(OMEGA, EPSILON, ramp)
    the_map = return_map(drive, 10.0, 1.0)
    labels = 2 * (np.arange(1, LABELS + 1) / LABELS - 1)
    times, _ = the_map.table(labels, (ramp + hold) * drive.period)
    return times.size


def in_python(ramp, hold, orbits):
    length = ramp * 2 * math.pi / OMEGA
    steps, until = 0, (ramp + hold) * 2 * math.pi / OMEGA
    for label in np.linspace(-2, 0, orbits).tolist():
        t, d, stretch, change = label, 2.0, 1.0, 0.0
        while t + d / 2 <= until:
            t += d
            stretch += change
            first, second = kernels.kick.py_func(t, OMEGA, EPSILON, length)
            d += first
            change += second * stretch
            steps += 1
    return steps


def record(benchmark, steps):
    benchmark.extra_info["goal in map steps a second"] = 1e7
    if benchmark.stats is not None:
        benchmark.extra_info["map steps a second"] = steps / benchmark.stats.stats.min


@pytest.mark.parametrize(("ramp", "hold"), [(5, 95), (20, 80), (100, 0), (100, 100)])
@pytest.mark.benchmark(group="exact string: compiled map by length of ramp and hold")
def test_compiled_map(benchmark, ramp, hold):
    times, steps = benchmark.pedantic(compiled, (ramp, hold, 20), rounds=5, warmup_rounds=1)
    assert np.isnan(times).all()  # all steps were taken
    record(benchmark, steps)


@pytest.mark.parametrize(
    ("route", "arguments"),
    [(compiled, (20, 80, 1)), (in_numpy, (20, 80)), (in_python, (20, 80, 16))],
    ids=["compiled", "NumPy over labels", "Python loop, 1/16 of the labels"],
)
@pytest.mark.benchmark(group="exact string: one run of 20 + 80 periods, 256 labels")
def test_routes(benchmark, route, arguments):
    result = benchmark.pedantic(route, arguments, rounds=3, warmup_rounds=1)
    steps = result[1] if isinstance(result, tuple) else result
    assert steps > 1000
    record(benchmark, steps)
