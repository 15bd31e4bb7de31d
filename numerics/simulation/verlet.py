r"""The explicit Störmer–Verlet rule with projection, compiled: a second, independent integrator.

With V = (Wⁿ − Wⁿ⁻¹)/dt and G = KW + bZ + f at the time n, the unprojected velocity V* solves

.. math:: m\frac{V^* − V}{dt} + c\,\frac{V^* + V}{2} = −G ,

and :math:`W^{n+1} = \max(W^n + dt\,V^*, −r W^{n−1})` is the scheme of Paoli and Schatzman for the
coefficient of restitution r. It keeps W ≥ 0 for r = 0; for r > 0 a node may dip below ground for
one step, by less than it moves in a step. With the energy of the staggered scheme,

.. math:: E = ½ \sum m V^2 + ½ W^n·KW^{n+1} + ½\,b·(W^n Z^{n+1} + W^{n+1} Z^n) + ½ k Z^n Z^{n+1}
          + ½ f·(W^n + W^{n+1}) + ½ φ (Z^n + Z^{n+1}),

positive for dt < 2/ω_max, a step changes E by the work ½(b·W + kZ + φ)(Zⁿ⁺¹ − Zⁿ⁻¹), less
Σ c dt ((V + V′)/2)², less ½ Σ λ_i (W_iⁿ⁻¹ − W_iⁿ⁺¹) on the nodes that the ground pushes with the
force λ. For r = 0 the last is never negative. For r > 0 it can be: the string gains a little for r
close to 1 (at r = 0.6 a step has put back 10⁻⁴ of the energy at most), a stiff rope gains without
bound, which is why the simulator refuses it.

Source: L. Paoli & M. Schatzman, SIAM J. Numer. Anal. 40 (2002) 702.
"""

from __future__ import annotations

import math

import numpy as np

from numerics.compiled import njit
from numerics.problems.drive import Array
from numerics.simulation.observables import elastic_force, moving_size, observe, settle
from numerics.simulation.semi_discrete import SemiDiscrete, State


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
    """As :func:`numerics.simulation.trapezoidal.advance`; the velocities are those half a step
    earlier.

    ``heights`` begins with Z one step before the state: Zⁿ⁻¹, Zⁿ, Zⁿ⁺¹, …
    """
    height, velocity, active = state.height, state.velocity, state.active
    mass, load, obstacle = system.mass, system.load, system.obstacle
    half_drag = 0.5 * dt * system.damping / mass
    kick, keep = dt / (mass * (1.0 + half_drag)), (1.0 - half_drag) / (1.0 + half_drag)
    (b0, b1), stiff, weight = system.drive, system.end_stiffness, system.end_load
    n = len(height)
    force = np.zeros(n)
    floating = not obstacle.all()
    last = moving_size(height, velocity, floating)
    elastic_force(system.stiffness, height, n, force)
    for step in range(len(heights) - 2):
        z0, z1, z2 = heights[step], heights[step + 1], heights[step + 2]
        size = min(n, last + 4)
        pull = b0 * height[0] + b1 * height[1] + stiff * z1
        work = 0.5 * (z2 - z0) * (pull + weight)
        energy = 0.5 * (z2 * pull + weight * (z1 + z2))
        force[0] += b0 * z1
        force[1] += b1 * z1
        kinetic, elastic, damped, lost, lowest, least = 0.0, 0.0, 0.0, 0.0, math.inf, math.inf
        for i in range(size):
            before, old = velocity[i], height[i]
            speed = keep[i] * before - kick[i] * (force[i] + load[i])
            new = old + dt * speed
            ground = -restitution * (old - dt * before)
            active[i] = obstacle[i] and new < ground
            if active[i]:
                new, free = ground, speed
                speed = (new - old) / dt
                push = (speed - free) / kick[i]
                lost -= 0.5 * dt * push * (speed + before)
                least = min(least, push)
            mean = 0.5 * (speed + before)
            damped += system.damping[i] * dt * mean * mean
            kinetic += mass[i] * speed * speed
            elastic += new * force[i] + load[i] * (old + new)
            lowest = min(lowest, new)
            velocity[i], height[i] = speed, new
        energy += 0.5 * (kinetic + elastic)
        settle(ledger, rows[step], energy, work, damped, lost, 1, lowest, least / system.dx)
        # Nothing spreads farther than two nodes a step: beyond ``size`` the force is still zero.
        elastic_force(system.stiffness, height, size, force)
        last = moving_size(height[:size], velocity[:size], floating)
        observe(system, height, force, active, size, rows[step])
    return len(heights) - 2
