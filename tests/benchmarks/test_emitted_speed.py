"""The emitted module against the paper's printed F₁–F₃ typed by hand, on a million points.

``typed`` is what a careful reader types from the page. ``emitted`` is order 4: it also holds F₄ and
the terms the paper leaves out. The group's ratio column is the comparison.
"""

from __future__ import annotations

import os
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest

from asymptotics import ClosedForms, exact_string, expand
from asymptotics.printing.numpy_code import numpy_module


def typed(s, tau, omega, epsilon):  # type: ignore[no-untyped-def]
    """w/Z₀ from eqs. (expandw) ff. as printed."""
    sin, cos, tan = np.sin, np.cos, np.tan
    O, x, e = omega, omega * s, epsilon  # noqa: E741
    F1 = (x - sin(x)) * (
        1 + e**2 * O**4 * cos(O) ** 2 / (32 * sin(O) ** 4) * (1 + 2 * tan(O) / O)
    ) + e**2 * O**4 / cos(O) / (16 * sin(O) ** 3) * (sin(2 * O) - sin(2 * O + x)) * sin(x)
    F2 = (O**2 / 8) * (
        (1 - cos(x)) ** 2 - sin(x) ** 2 - cos(2 * O) / sin(2 * O) * (2 * x - sin(2 * x))
    )
    F3 = (O**4 / 32) * (
        sin(x)
        + sin(3 * x)
        - 2 * sin(2 * x)
        + (2 - cos(2 * O) + cos(4 * O))
        / (2 * (1 + 2 * cos(2 * O)) * sin(O) ** 2)
        * (3 * x - sin(3 * x))
        - 4 * cos(2 * O) / sin(2 * O) * (1 - 2 * cos(x)) * sin(x) ** 2
    )
    h, theta = e / sin(O), O * tau
    return s**2 + h * F1 * cos(theta) + h**2 * F2 * cos(2 * theta) + h**3 * F3 * cos(3 * theta)


def emitted():  # type: ignore[no-untyped-def]
    module = ModuleType("emitted")
    exec(numpy_module(ClosedForms(expand(exact_string(), 4))), module.__dict__)
    return module.profile


RNG = np.random.default_rng(7)
# On the rope at all times: its driven end is at s = −ξ_c, and ξ_c > 0.99 at these ε.
POINTS = {
    "points (s, tau)": (-0.99 * RNG.random(10**6), 7 * RNG.random(10**6), 0.83, 1e-3),
    "points (s, tau, Omega, epsilon)": (
        -0.99 * RNG.random(10**6),
        7 * RNG.random(10**6),
        RNG.uniform(0.5, 0.9, 10**6),
        1e-3 * RNG.random(10**6),
    ),
    "grid 1000 x 1000": (-0.99 * RNG.random(1000), 7 * RNG.random(1000)[:, None], 0.83, 1e-3),
}


@pytest.mark.parametrize("who", ["typed", "emitted"])
@pytest.mark.parametrize("where", list(POINTS))
def test_a_million_points(benchmark, where, who):  # type: ignore[no-untyped-def]
    benchmark.group = f"profile, {where}"
    function = typed if who == "typed" else emitted()
    result = benchmark.pedantic(function, POINTS[where], rounds=7, warmup_rounds=1)
    # What the printed formulas leave out is of order ε⁴ in F₀ and ε² in F₂.
    assert np.abs(result - typed(*POINTS[where])).max() < 1e-5


def run(*arguments: str) -> None:
    environment = {**os.environ, "ROPEWAVE_CACHE": os.devnull}
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, env=environment)


@pytest.mark.benchmark(group="whole process")
@pytest.mark.parametrize(
    "arguments",
    [
        ("-c", "import typer, flint, numpy"),
        ("-m", "derivations.app", "derive", "--order", "4", "--no-cache"),
    ],
    ids=["importing the libraries", "ropewave derive --order 4"],
)
def test_process(benchmark, arguments):  # type: ignore[no-untyped-def]
    benchmark.pedantic(run, arguments, rounds=5, warmup_rounds=1)
