"""A reader's rope: one point, ten thousand points, formulas, and what judges them.

``pytest tests/benchmarks --benchmark-only`` prints the groups with their ratios. Goals: order 6 at
one more point in 50 ms, order 4 at 10⁴ points in 2 s.
"""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand
from asymptotics.formulas.rope import rope_forms
from asymptotics.printing.rope_modules import rope_javascript, rope_numpy
from asymptotics.problems.presets import beam, string

ROPES = {
    "string on a foundation": (string(foundation=sp.Symbol("kappa")), {"kappa": 1.7}),
    "damped clamped beam": (beam(driven_end="clamped", damping=0.1), {"beta": 0.01}),
}


@pytest.mark.benchmark(group="order 6 at one more point")
@pytest.mark.parametrize("name", ROPES)
def test_one_more_point(benchmark, name):
    benchmark.extra_info["goal in seconds"] = 0.05
    rope, at = ROPES[name]
    expand(rope, 6, at={**at, "Omega": 2.2})
    fresh = iter(np.linspace(2.21, 2.4, 200).tolist())
    series = benchmark.pedantic(lambda: expand(rope, 6, at={**at, "Omega": next(fresh)}), rounds=10)
    assert series.order == 6


@pytest.mark.benchmark(group="order 4 at 10^4 points")
@pytest.mark.parametrize("name", ROPES)
def test_many_points(benchmark, name):
    benchmark.extra_info["goal in seconds"] = 2.0
    rope, at = ROPES[name]
    (parameter, value), *_ = at.items()
    points = {parameter: value * np.linspace(1, 2, 10**4), "Omega": 2.2}
    series = benchmark.pedantic(lambda: expand(rope, 4, at=points), rounds=2)
    assert series.contact(4)[4].shape == (10**4,)


@pytest.mark.benchmark(group="order 4: derived, and written")
@pytest.mark.parametrize("what", ["derived", "NumPy", "JavaScript"])
def test_formulas(benchmark, what):
    rope, _ = ROPES["damped clamped beam"]
    forms = rope_forms(rope, 4)
    work = {
        "derived": lambda: rope_forms(rope, 4),
        "NumPy": lambda: rope_numpy(forms),
        "JavaScript": lambda: rope_javascript(forms),
    }
    assert benchmark(work[what])
