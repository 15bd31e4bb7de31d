"""The run that the simulators are compared in: β = 0.01, Ω = 2.5, ε = 0.05, a rope that follows.

**The same start.** Every program starts at τ = 0 with the profile of the expansion and no velocity.
That is the periodic state, so no ramp is needed; the error is that of the third period.

**The same contact point.** W = W_ξ = W_ξξ = 0 at ξ_c, so that W^{1/3} has a simple zero there: a
polynomial for ξ in W^{1/3}, fitted to the free nodes with 10⁻³ < W < 10⁻¹ and taken at zero. It
does not look at the ground, where each program has its own idea of contact.

**The rivals' units** are x₀ = T = ρ = 1 and Z₀ = ``SLOPE``, hence g = 2 Z₀: they are geometrically
nonlinear, which makes O(SLOPE²) of difference to the paper's eq. (beam2): 2.6 SLOPE² in ξ_c by
MoorDyn with larger slopes.
"""

from __future__ import annotations

import importlib
import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asymptotics import Expansion, expand
from asymptotics.problems.beam import beam_problem, static_beam

Array = NDArray[np.float64]

BETA, OMEGA, EPSILON = 0.01, 2.5, 0.05
PERIOD = 2 * math.pi / OMEGA
PERIODS = 3
SAMPLES = 64
"""Contact points taken in a period; a rival's time is that of the fastest of these stretches."""
LENGTH = 1.8
"""Of the rivals' ropes; ξ_c stays below 1.21, and ground further out would only cost them time."""
SLOPE = 2e-3
GROUND = 16.0
"""The rivals' ground has the stiffness GROUND β/dx⁴ per length and half critical damping: its
frequency is that of the stiffest bending wave of the grid, its depth of contact dx/√2."""
ORDER, PROFILE_ORDER = 24, 12
"""Orders of the reference: beyond them rounding, or growing exponentials, win over truncation."""

TIMES: Array = np.linspace(0.0, PERIODS * PERIOD, PERIODS * SAMPLES + 1)[1:]
LAST = slice(-SAMPLES, None)


@dataclass(frozen=True)
class Outcome:
    """One run; ``contact`` is ξ_c at TIMES, ``seconds`` of processor time are for one period.

    ``reference`` is the exact ξ_c where the run is not of the periodic state, ``own`` the error of
    the program's own contact point where it has one.
    """

    name: str
    nodes: int
    dt: float
    seconds: float
    contact: Array
    reference: Array | None = None
    own: float | None = None

    @property
    def error(self) -> float:
        """Root mean square over the last period; NaN when a run has blown up."""
        exact = contact_series(TIMES) if self.reference is None else self.reference
        return rms((self.contact - exact)[LAST])


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@cache
def expansion() -> Expansion[Any]:
    return expand(beam_problem(BETA, OMEGA), ORDER)


def contact_series(tau: Any, order: int = ORDER) -> Array:
    """ξ_c(τ) of the periodic state, through ε^order."""
    total = np.full(np.shape(tau), float(static_beam(BETA).contact_point))
    for n in range(1, order + 1):
        for j, c in expansion().contact(n).items():
            factor = (2 if j else 1) * EPSILON**n * float(c)
            total = total + factor * np.cos(j * OMEGA * np.asarray(tau))
    return total


def profile(xi: Array, tau: float) -> Array:
    """W(ξ, τ) of the periodic state, zero on the ground."""
    static = static_beam(BETA)
    s, root = xi - float(static.contact_point), math.sqrt(BETA)
    odd = float(static.a3) * BETA * root
    total = s**2 + 2 * BETA * (1 - np.cosh(s / root)) + odd * (np.sinh(s / root) - s / root)
    for n in range(1, PROFILE_ORDER + 1):
        for j, start in expansion().shape(n).items():
            factor = (2 if j else 1) * EPSILON**n * math.cos(j * OMEGA * tau)
            total = total + factor * _harmonic(s, j * OMEGA, [float(w) for w in start])
    return np.where(xi < contact_series(tau), total, 0.0)


def _harmonic(s: Array, rate: float, start: list[float]) -> Array:
    """The solution of βw⁗ − w″ = rate² w with the derivatives ``start`` at s = 0."""
    root = math.sqrt(1 + 4 * BETA * rate**2)
    p, k = math.sqrt((1 + root) / (2 * BETA)), math.sqrt((root - 1) / (2 * BETA))
    c = (k * k * start[0] + start[2]) / (p * p + k * k)
    g = (k * k * start[1] + start[3]) / (p * p + k * k)
    sine = np.sin(k * s) / k if k else s
    boundary = c * np.cosh(p * s) + g / p * np.sinh(p * s)
    return boundary + (start[0] - c) * np.cos(k * s) + (start[1] - g) * sine


def contact_of(xi: Array, w: Array) -> float:
    """ξ_c from a profile; see the module's docstring. NaN where there is none."""
    free = (w > 1e-3) & (w < 1e-1)
    if np.count_nonzero(free) < 6 or not np.isfinite(w).all():
        return math.nan
    return float(np.polynomial.polynomial.polyfit(np.cbrt(w[free]), xi[free], 4)[0])


def driven(tau: float) -> tuple[float, float]:
    """Z/Z₀ and its rate."""
    return 1 + EPSILON * math.cos(OMEGA * tau), -EPSILON * OMEGA * math.sin(OMEGA * tau)


def steps_in_sample(longest: float) -> tuple[int, float]:
    """How many equal steps no longer than ``longest`` make a sample, and their length."""
    steps = math.ceil(PERIOD / SAMPLES / longest)
    return steps, PERIOD / SAMPLES / steps


def timed(advance: Callable[[], object], look: Callable[[], float]) -> tuple[float, Array]:
    """Seconds of processor time for a period, by the fastest sample, and ξ_c at TIMES."""
    best, contact = math.inf, []
    for _ in TIMES:
        begin = time.process_time()
        advance()
        best = min(best, time.process_time() - begin)
        contact.append(look())
    return SAMPLES * best, np.array(contact)


def need(module: str, package: str) -> Any:
    """Import a rival, or say how to get it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module:
            raise
        sys.exit(f"{module} is not installed: pip install {package}, or name other --rivals")
