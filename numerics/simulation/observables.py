r"""What is read off the nodes at every step: contact point, lifted waves, minima; compiled.

**Contact point.** Let I be the first node on the ground and KW the elastic force. It is −q per
length left of the contact point ξ_c = ξ_I + d, where the rope carries the load q (2, plus its
acceleration), and zero beyond, where the ground does; where the rope is stiff the ground adds the
point force P at ξ_c. The sum of KW over the nodes I and I + 1, S₀, and its moment about ξ_I, S₁,
must agree with that:

.. math:: S_0 = P − q\left(d + \frac{dx}{2}\right), \qquad
          S_1 = P d − \frac{q}{2}\left(d^2 − \frac{dx^2}{4}\right)
          \quad⇒\quad \frac{q}{2} d^2 + \left(S_0 + \frac{q\,dx}{2}\right) d
          + \frac{q\,dx^2}{8} − S_1 = 0.

With β = 0 there is no point force and S₀ alone gives d. Both are of second order in dx at rest. In
motion W is, but ξ_c carries noise: every node that is laid down or picked up is a small impact, and
where W grows like s³ the last node is soon all noise. Measured: 0.1 dx at β = 0.01, 0.07 dx at
β = 0, and 0.2 dx for dx below √β/20; :meth:`numerics.simulation.run.Run.smooth_contact` averages
it. Where the rope touches with a single node, at the instant of an impact, or so close to the
driven end that Z enters those forces, ξ_c is the node itself, and P its KW if the ground must push.

Where nothing is on the ground the entries are NaN; where nothing beyond ξ_c is lifted BUMP is 0 and
BUMP_AT NaN; where there is no minimum before ξ_c both GAPs are NaN.
"""

from __future__ import annotations

import math
from enum import IntEnum

from numerics.compiled import njit
from numerics.problems.drive import Array
from numerics.simulation.semi_discrete import Flags, SemiDiscrete


class Column(IntEnum):
    """What a row of a record holds, in this order."""

    CONTACT = 0
    """ξ_c, the first contact point seen from the driven end."""
    FORCE = 1
    """P, the point force at ξ_c, in units of TZ₀/x₀."""
    BUMP = 2
    """Largest height beyond the contact point: a wave that has left."""
    BUMP_AT = 3
    """Where."""
    GAP = 4
    """Smallest local minimum of the height before the contact point."""
    GAP_AT = 5
    """Where."""
    ENERGY = 6
    """E."""
    WORK = 7
    """What the driven end has done, since the start."""
    DAMPED = 8
    """What damping has taken, since the start."""
    LOST = 9
    """What contact has taken, since the start. Of a rope that follows: an error of the grid, see
    :mod:`numerics.simulation.trapezoidal`."""
    UNEXPLAINED = 10
    """Change of energy in this step that none of these explains."""
    ROUNDS = 11
    """Rounds of the active-set iteration in this step; 1 for explicit steps."""
    LOWEST = 12
    """Smallest W of all nodes: W ≥ 0, the first half of the complementarity."""
    REACTION = 13
    """Smallest λ of all nodes on the ground, per unit length: λ ≥ 0, the other half."""


COLUMNS = len(Column)


@njit(cache=True)
def elastic_force(stiffness: Array, height: Array, size: int, force: Array) -> None:
    """KW on the first ``size`` nodes, those beyond being at W = 0."""
    k0, k1, k2 = stiffness[0], stiffness[1], stiffness[2]
    # Views that start where they are read, and no branches: an index such as i − 2 might be
    # negative, and the check of that keeps the compiler from vectorising.
    middle, sides, far = k0[2:], k1[1:], k2[2:]
    own, before, after, last, inner = height[2:], height[1:], height[3:], height[4:], force[2:]
    for i in range(size - 4):
        left = k2[i] * height[i] + sides[i] * before[i]
        inner[i] = middle[i] * own[i] + left + (sides[i + 1] * after[i] + far[i] * last[i])
    for i in (0, 1, size - 2, size - 1):
        total = k0[i] * height[i]
        if i > 0:
            total += k1[i - 1] * height[i - 1]
        if i > 1:
            total += k2[i - 2] * height[i - 2]
        if i + 1 < size:
            total += k1[i] * height[i + 1]
        if i + 2 < size:
            total += k2[i] * height[i + 2]
        force[i] = total


@njit(cache=True)
def moving_size(height: Array, velocity: Array, floating: bool) -> int:
    """How many leading nodes there are up to the last that is not at rest on the ground."""
    n = len(height)
    while n > 0 and not floating and height[n - 1] == 0.0 and velocity[n - 1] == 0.0:
        n -= 1
    return n


@njit(cache=True)
def settle(
    ledger: Array,
    row: Array,
    energy: float,
    work: float,
    damped: float,
    lost: float,
    rounds: int,
    lowest: float,
    reaction: float,
) -> None:
    """Enter one step's energies into the ledger (E, work, damped, lost), and all into the row."""
    row[10] = energy - ledger[0] - work + damped + lost
    ledger[0] = energy
    ledger[1] += work
    ledger[2] += damped
    ledger[3] += lost
    row[6:10] = ledger
    row[11], row[12], row[13] = rounds, lowest, reaction


@njit(cache=True)
def contact_point(system: SemiDiscrete, force: Array, active: Flags) -> tuple[float, float, int]:
    """ξ_c, P and I, from the elastic force ``force`` = KW; NaN and −1 without contact."""
    n, dx = len(active), system.dx
    first = 0
    while first < n and not active[first]:
        first += 1
    if first == n:
        return math.nan, math.nan, -1
    place = system.positions[first]
    if first < 3 or first + 1 >= n or not active[first + 1]:
        return place, max(force[first], 0.0), first
    # The load next to the contact carries its inertia; half the weight keeps q from vanishing.
    q = max(-force[first - 1], 0.5 * system.load[first]) / dx
    if q == 0.0:
        return place, 0.0, first
    s0 = force[first]
    if system.beta == 0.0:
        push, d = 0.0, -s0 / q - 0.5 * dx
    else:
        s0 += force[first + 1]
        b = s0 + 0.5 * q * dx
        push = math.sqrt(max(b * b - 2.0 * q * dx * (0.125 * q * dx - force[first + 1]), 0.0))
        d = (push - b) / q
    return place + min(max(d, -2.0 * dx), 2.0 * dx), push, first


@njit(cache=True)
def observe(
    system: SemiDiscrete, height: Array, force: Array, active: Flags, size: int, row: Array
) -> None:
    """Fill the geometrical entries of a row: contact point, wave beyond it, minimum before it."""
    row[:6] = math.nan
    row[0], row[1], first = contact_point(system, force, active)
    if first < 0:
        return
    top, low = first, -1
    for i in range(first + 1, size):
        if height[i] > height[top]:
            top = i
    for i in range(1, first - 1):
        minimum = height[i] < height[i - 1] and height[i] <= height[i + 1]
        if minimum and (low < 0 or height[i] < height[low]):
            low = i
    row[2] = height[top]
    if top > first:
        row[3] = system.positions[top]
    if low >= 0:
        row[4], row[5] = height[low], system.positions[low]
