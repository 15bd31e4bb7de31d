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
and reported. (With r = 1 the string needs dt < dx: at dt = dx a strike gives back 3.6 % too little
however fine the grid, at dt = dx/4 0.45 %.)

**A rope that follows loses energy to contact, too**, on a grid. In the continuum W_τ vanishes at a
contact point that moves, and nothing is lost. A node is laid down once W has fallen to zero there,
with the speed |ξ_c′W_ξ| at a distance of up to dx from the contact point: a small impact, and full
projection takes ½mV² of it. Per forcing period at ε = 0.05, β = 0.01, dt = dx (energy 1.5) that is
2e-6, 6e-7, 2e-7 at Ω = 2.5 and 1e-7, 1.5e-8, 1.6e-9 at Ω = 1.3 for dx = 0.02, 0.01, 0.005; Verlet
loses half as much. It is an error of the grid, not of the physics, and falls with it.

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
from numpy.typing import NDArray

from numerics.compiled import njit
from numerics.problems.drive import Array
from numerics.simulation.observables import elastic_force, moving_size, observe, settle
from numerics.simulation.semi_discrete import Flags, SemiDiscrete, State

Indices = NDArray[np.int64]

ROUNDS = 12
"""Rounds of the primal–dual iteration before Murty's rule takes over."""

# Changes of the active set per node, all rounds together, after which a bug must be assumed.
_MOST = 50
# λ of a node at rest on the ground is the difference of terms of this many roundings.
_ROUNDINGS = 64.0
_EPS = 2.0**-52


@njit(cache=True)
def factor(bands: Array, active: Flags, start: int, stop: int, factors: Array) -> None:
    """LDLᵀ of A with unit rows on active nodes, from row ``start`` to ``stop`` − 1.

    ``factors`` holds L_{i,i−1}, L_{i,i−2} and 1/D_i; its earlier rows are used as they are.
    """
    k0, k1, k2 = bands[0], bands[1], bands[2]
    l1, l2, inverse = factors[0], factors[1], factors[2]
    for i in range(start, stop):
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
def substituted(
    factors: Array,
    right: Array,
    active: Flags,
    begin: int,
    start: int,
    stop: int,
    y: Array,
    x: Array,
) -> None:
    """Solve LDLᵀ x = right from row ``begin`` to ``stop`` − 1, with x = 0 on active nodes.

    y holds the forward sweep before ``start``. What lies beyond either end must not be coupled.
    """
    l1, l2, inverse = factors[0], factors[1], factors[2]
    for i in range(start, stop):
        value = 0.0
        if not active[i]:
            value = right[i]
            if i > 0:
                value -= l1[i] * y[i - 1]
            if i > 1:
                value -= l2[i] * y[i - 2]
        y[i] = value
    for i in range(stop - 1, begin - 1, -1):
        value = 0.0
        if not active[i]:
            value = y[i] * inverse[i]
            if i + 1 < stop:
                value -= l1[i + 1] * x[i + 1]
            if i + 2 < stop:
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
def largest(x: Array, size: int) -> float:
    """max |x_i| of the first ``size``."""
    found = 0.0
    for i in range(size):
        found = max(found, abs(x[i]))
    return found


@njit(cache=True)
def revise(
    bands: Array,
    right: Array,
    obstacle: Flags,
    start: int,
    stop: int,
    slack: float,
    murty: bool,
    x: Array,
    active: Flags,
    changed: Indices,
    count: int,
) -> tuple[int, float]:
    """Change the active set from ``start`` to ``stop`` − 1 where x or λ has the wrong sign.

    Appends the indices that changed to the ``count`` first ones of ``changed``. Returns how many
    there are now, and the smallest Ax − right on the active nodes that were looked at. Of λ only
    what exceeds ``slack``, rounding, counts.
    """
    k1, k2 = bands[1], bands[2]
    last, least = len(x) - 3, math.inf
    for i in range(start, stop):
        if not active[i]:
            wrong = obstacle[i] and x[i] < 0.0
        else:
            if 2 <= i <= last:  # ``multiplier`` without its branches, which cost more than it does
                push = -right[i] + k1[i - 1] * x[i - 1] + k2[i - 2] * x[i - 2]
                push = push + k1[i] * x[i + 1] + k2[i] * x[i + 2]
            else:
                push = multiplier(bands, right, x, i)
            least = min(least, push)
            wrong = push < -slack
        if wrong:
            active[i] = not active[i]
            changed[count] = i
            count += 1
            if murty:
                break
    return count, least


@njit(cache=True)
def span(
    active: Flags, changed: Indices, first: int, count: int, size: int
) -> tuple[int, int, int]:
    """The rows that a change of the active set at ``changed[first]`` can reach, and what follows.

    Two neighbours that stay on the ground part the rope: nothing on one side is felt on the other.
    Returns the first row and the one after the last, with such neighbours at both ends, and the
    next of the changes, which are in order.
    """
    begin, quiet = changed[first], 0
    while begin > 0 and quiet < 2:
        quiet = quiet + 1 if active[begin - 1] else 0
        begin -= 1
    stop, quiet = changed[first], 0
    while stop < size and quiet < 2:
        if first < count and changed[first] == stop:
            first, quiet = first + 1, 0
        else:
            quiet = quiet + 1 if active[stop] else 0
        stop += 1
    return begin, stop, first


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

    The first round is of all rows, the others of those that the changes can reach; when these ask
    for no more, all are looked at again.
    """
    n = len(right)
    factor(bands, active, fresh, size, factors)
    substituted(factors, right, active, 0, 0, size, y, x)
    changed, spans = np.empty(n, np.int64), np.empty((n, 2), np.int64)
    slack = _ROUNDINGS * _EPS * bands[0, 0]
    limit = slack * largest(x, size)
    count, least = revise(bands, right, obstacle, 0, size, limit, ROUNDS < 1, x, active, changed, 0)
    rounds = 1
    while count > 0:
        if rounds > _MOST * n:
            return size, -rounds, least
        rounds += 1
        if changed[count - 1] + 4 > size and size < n:
            old, size = size, min(n, changed[count - 1] + 8)
            factor(bands, active, old, size, factors)
            y[old:size] = 0.0
        following, parts = 0, 0
        while following < count:
            start = changed[following]
            begin, stop, following = span(active, changed, following, count, size)
            factor(bands, active, start, stop, factors)
            substituted(factors, right, active, begin, start, stop, y, x)
            spans[parts, 0], spans[parts, 1] = begin, stop
            parts += 1
        count = 0
        if rounds <= ROUNDS:
            for part in range(parts):
                start, stop = spans[part, 0], spans[part, 1]
                if part > 0:  # both may end in the same neighbours
                    start = max(start, spans[part - 1, 1])
                count, _ = revise(
                    bands, right, obstacle, start, stop, limit, False, x, active, changed, count
                )
        if count == 0:
            limit = slack * largest(x, size)
            count, least = revise(
                bands, right, obstacle, 0, size, limit, rounds > ROUNDS, x, active, changed, 0
            )
    return size, rounds, least


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
