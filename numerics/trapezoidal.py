r"""The trapezoidal rule with full projection, compiled.

A step of length dt from (W⁰, V⁰) to (W¹, V¹) solves the linear complementarity problem

.. math:: A W^1 = r + 2λ, \quad W^1 ≥ 0 ⟂ λ ≥ 0, \qquad A = \frac{4m}{dt^2} + \frac{2c}{dt} + K,

r = (4m/dt² + 2c/dt)W⁰ − KW⁰ + 4mV⁰/dt − 2f − b(Z⁰ + Z¹), and sets V¹ = 2(W¹ − W⁰)/dt − V⁰. A is
positive definite, hence W¹ unique. Then every node in contact gives up its velocity V¹ (*full
projection*), or takes :math:`r\sqrt{2ℓ/m}` upwards instead, where

.. math:: ℓ = λW^0 + ½ m (V^1)^2 ≥ 0

is the energy that the node has lost in the step, ≈ ½m(V⁰)² in an impact. With the elastic force and
boundary work taken at the mean of both times the energy balance of a step is exact,

.. math:: ΔE = ΔZ\,(b·\bar W + k\bar Z + φ) − \frac{1}{dt} \sum c_i ΔW_i^2 − (1 − r^2) \sum ℓ_i ,

so that with the end at rest the energy can only fall, at any dt; what is left over is rounding,
and reported. (With r = 1 the
string needs dt < dx: at dt = dx a strike gives back 3.6 % too little however fine the grid, at
dt = dx/4 0.45 %.)

The complementarity problem is solved by the primal–dual active set iteration (a semismooth Newton
method): nodes below ground become active, active ones that the ground would have to hold are
released. It is not sure to end: after 12 rounds only the lowest such index changes (Murty's rule),
which ends for every positive definite A.

Source: K. G. Murty, Opsearch 11 (1974) 1; M. Hintermüller, K. Ito & K. Kunisch, SIAM J. Optim. 13
(2002) 865.
"""

from __future__ import annotations

import math

import numpy as np

from numerics.compiled import njit
from numerics.drive import Array
from numerics.observables import elastic_force, moving_size, observe, settle
from numerics.semi_discrete import Flags, SemiDiscrete, State

# What numba compiled is reused until this file changes. It calls numerics/observables.py, so it
# must change with it: these are the first digits of that file's SHA-256, held to it by a test.
_COMPILED_WITH = "1a19b36fcf85"

ROUNDS = 12
"""Rounds of the primal–dual iteration before Murty's rule takes over."""

# Changes of the active set per node, all rounds together, after which a bug must be assumed.
_MOST = 50
# λ of a node at rest on the ground is the difference of terms of this many roundings.
_ROUNDINGS = 64.0
_EPS = 2.0**-52


@njit(cache=True)
def factor(bands: Array, active: Flags, start: int, size: int, factors: Array) -> None:
    """LDLᵀ of A with unit rows on active nodes, from row ``start`` to ``size`` − 1.

    ``factors`` holds L_{i,i−1}, L_{i,i−2} and 1/D_i; its earlier rows are used as they are.
    """
    k0, k1, k2 = bands[0], bands[1], bands[2]
    l1, l2, inverse = factors[0], factors[1], factors[2]
    for i in range(start, size):
        l1[i] = l2[i] = 0.0
        if active[i]:
            inverse[i] = 1.0
            continue
        d = k0[i]
        coupling = k1[i - 1] if i > 0 and not active[i - 1] else 0.0
        if i > 1 and not active[i - 2]:
            l2[i] = k2[i - 2] * inverse[i - 2]
            d -= l2[i] * k2[i - 2]
            if not active[i - 1]:
                coupling -= k2[i - 2] * l1[i - 1]
        if i > 0 and not active[i - 1]:
            l1[i] = coupling * inverse[i - 1]
            d -= l1[i] * coupling
        inverse[i] = 1.0 / d


@njit(cache=True)
def sweep(
    factors: Array, right: Array, active: Flags, start: int, size: int, y: Array, x: Array
) -> None:
    """Solve LDLᵀ x = right, x = 0 on active nodes; y holds the forward sweep before ``start``."""
    l1, l2, inverse = factors[0], factors[1], factors[2]
    for i in range(start, size):
        value = 0.0
        if not active[i]:
            value = right[i]
            if i > 0:
                value -= l1[i] * y[i - 1]
            if i > 1:
                value -= l2[i] * y[i - 2]
        y[i] = value
    for i in range(size - 1, -1, -1):
        value = 0.0
        if not active[i]:
            value = y[i] * inverse[i]
            if i + 1 < size:
                value -= l1[i + 1] * x[i + 1]
            if i + 2 < size:
                value -= l2[i + 2] * x[i + 2]
        x[i] = value


@njit(cache=True)
def multiplier(bands: Array, right: Array, x: Array, i: int) -> float:
    """(Ax − right)_i = 2λ_i on a node where x is zero."""
    value = -right[i]
    if i > 0:
        value += bands[1, i - 1] * x[i - 1]
    if i > 1:
        value += bands[2, i - 2] * x[i - 2]
    if i + 1 < len(x):
        value += bands[1, i] * x[i + 1]
    if i + 2 < len(x):
        value += bands[2, i] * x[i + 2]
    return value


@njit(cache=True)
def revise(
    bands: Array, right: Array, obstacle: Flags, size: int, murty: bool, x: Array, active: Flags
) -> tuple[int, int, float]:
    """Change the active set where x or λ has the wrong sign.

    Returns the lowest and the highest index that changed (``size`` and −1 if none did) and the
    smallest Ax − right on the active nodes. Of λ only what exceeds rounding counts.
    """
    slack = _ROUNDINGS * _EPS * bands[0, 0] * max(x[:size].max(), -x[:size].min())
    lowest, highest, least = size, -1, math.inf
    for i in range(size):
        if active[i]:
            push = multiplier(bands, right, x, i)
            least = min(least, push)
            wrong = push < -slack
        else:
            wrong = obstacle[i] and x[i] < 0.0
        if wrong:
            active[i] = not active[i]
            lowest, highest = min(lowest, i), i
            if murty:
                break
    return lowest, highest, least


@njit(cache=True)
def complementarity(
    bands: Array,
    right: Array,
    obstacle: Flags,
    size: int,
    fresh: int,
    active: Flags,
    factors: Array,
    y: Array,
    x: Array,
) -> tuple[int, int, float]:
    """Solve Ax − right ⟂ x ≥ 0 from the active set given, which is updated in place.

    ``size`` nodes are looked at to begin with; the rest are at rest on the ground, and join when a
    node close to them is released: there x must be 0 and ``right`` what the ground bears. Rows of
    ``factors`` before ``fresh`` are those of this set. Returns the size, the rounds (negative if
    the iteration did not end) and the smallest Ax − right on the active nodes.
    """
    n = len(right)
    start, rounds = 0, 0
    while True:
        factor(bands, active, fresh, size, factors)
        sweep(factors, right, active, start, size, y, x)
        rounds += 1
        lowest, highest, least = revise(bands, right, obstacle, size, rounds > ROUNDS, x, active)
        if highest < 0:
            return size, rounds, least
        if rounds > _MOST * n:
            return size, -rounds, least
        if highest + 4 > size and size < n:
            size = min(n, highest + 8)
        start = fresh = lowest


@njit(cache=True)
def accept(
    system: SemiDiscrete,
    dt: float,
    restitution: float,
    bands: Array,
    right: Array,
    force: Array,
    x: Array,
    size: int,
    state: State,
) -> tuple[float, float, float]:
    """Make x the new W, with its V, in the state; ``force`` is Kx.

    Returns the energy without the driven end's part, and what damping and contact have taken.
    """
    height, velocity = state.height, state.velocity
    kinetic, elastic, damped, lost = 0.0, 0.0, 0.0, 0.0
    for i in range(size):
        mass, change = system.mass[i], x[i] - height[i]
        speed = 2.0 * change / dt - velocity[i]
        damped += system.damping[i] * change * change / dt
        if state.active[i]:
            loss = 0.0
            if height[i] != 0.0 or velocity[i] != 0.0:
                reaction = 0.5 * multiplier(bands, right, x, i)
                loss = max(reaction * height[i] + 0.5 * mass * speed * speed, 0.0)
            speed = restitution * math.sqrt(2.0 * loss / mass)
            lost += loss - 0.5 * mass * speed * speed
        kinetic += mass * speed * speed
        elastic += x[i] * (force[i] + 2.0 * system.load[i])
        velocity[i] = speed
        height[i] = x[i]
    return 0.5 * (kinetic + elastic), damped, lost


@njit(cache=True)
def advance(
    system: SemiDiscrete,
    dt: float,
    restitution: float,
    heights: Array,
    state: State,
    ledger: Array,
    rows: Array,
) -> int:
    """len(heights) − 1 steps; state and ledger change in place, a row of observables a step.

    Returns the number of steps taken: all, or those before an active-set iteration that did not
    end.
    """
    height, velocity, active, load = state.height, state.velocity, state.active, system.load
    (b0, b1), stiff, weight = system.drive, system.end_stiffness, system.end_load
    n = len(height)
    inertia = 4.0 * system.mass / dt
    memory = (inertia + 2.0 * system.damping) / dt
    shifted = system.stiffness.copy()
    shifted[0] += memory
    x, y, force, right, factors = (
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        -2.0 * load,
        np.zeros((3, n)),
    )
    floating = not system.obstacle.all()
    last = moving_size(height, velocity, floating)
    elastic_force(system.stiffness, height, n, force)
    before = active.copy()
    size = 0
    for step in range(len(heights) - 1):
        z0, z1 = heights[step], heights[step + 1]
        fresh, size = size, min(n, last + 4)
        for i in range(size):
            pushed = memory[i] * height[i] + inertia[i] * velocity[i]
            right[i] = pushed - force[i] - 2.0 * load[i]
        right[0] -= b0 * (z0 + z1)
        right[1] -= b1 * (z0 + z1)
        # Nodes that have left the window lie on the ground: x is zero there already.
        right[size:fresh] = -2.0 * load[size:fresh]
        size, rounds, least = complementarity(
            shifted, right, system.obstacle, size, fresh, active, factors, y, x
        )
        if rounds < 0:
            active[:] = before
            return step
        pull0, pull1 = b0 * height[0] + b1 * height[1], b0 * x[0] + b1 * x[1]
        elastic_force(system.stiffness, x, size, force)
        energy, damped, lost = accept(
            system, dt, restitution, shifted, right, force, x, size, state
        )
        energy += z1 * (pull1 + 0.5 * stiff * z1 + weight)
        work = (z1 - z0) * (0.5 * (pull0 + pull1 + stiff * (z0 + z1)) + weight)
        lowest, reaction = x[:size].min(), 0.5 * least / system.dx
        settle(ledger, rows[step], energy, work, damped, lost, rounds, lowest, reaction)
        observe(system, height, force, active, size, rows[step])
        last = moving_size(height[:size], velocity[:size], floating)
        before[:size] = active[:size]
    return len(heights) - 1
