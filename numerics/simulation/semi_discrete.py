r"""A rope, string or bar on finitely many nodes, one of them perhaps driven, above an obstacle.

.. math:: m_i \ddot W_i + c_i \dot W_i + (KW)_i + b_i Z(τ) + f_i = λ_i, \qquad
          W_i ≥ 0 ⟂ λ_i ≥ 0,

with K symmetric and pentadiagonal. The energy is that of the differences:

.. math:: E = ½ \sum m_i \dot W_i^2 + ½ W·KW + Z\,b·W + ½ k Z² + f·W + φZ,

so that dE/dτ = Ż(b·W + kZ + φ) − Σ c_i Ẇ_i² and nothing else: the ground does no work, except in
an impact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.problems.along import Along
from numerics.problems.drive import Array, finite, non_negative, positive, whole
from numerics.problems.problem import DrivenEnd, RopeProblem

Flags = NDArray[np.bool_]

FEWEST, MOST = 8, 10**7
"""Nodes that a domain must have at least, and at most."""


class SemiDiscrete(NamedTuple):
    """The equations of the module's docstring, as data for any of the time integrators.

    A named tuple, so that compiled code reads it by the same names.

    Attributes
    ----------
    positions, mass, damping, load
        ξ_i, m_i, c_i, f_i, shape (n,).
    stiffness
        K_{i,i}, K_{i,i+1}, K_{i,i+2}, shape (3, n), padded with zeros.
    drive
        b_0, b_1: the driven end pulls on the first two nodes at most.
    end_stiffness, end_load
        k and φ.
    obstacle
        Which nodes have ground below them, shape (n,).
    dx, beta
        Spacing and β, for the contact point between the nodes.
    """

    positions: Array
    mass: Array
    damping: Array
    load: Array
    stiffness: Array
    drive: tuple[float, float]
    end_stiffness: float
    end_load: float
    obstacle: Flags
    dx: float
    beta: float

    @property
    def size(self) -> int:
        """The number n of free nodes."""
        return len(self.positions)

    def force(self, height: Array, end: float | Array = 0.0) -> Array:
        """KW + bZ + f, for W of shape (n,)."""
        k0, k1, k2 = self.stiffness
        total = k0 * height + self.load
        total[1:] += k1[:-1] * height[:-1]
        total[:-1] += k1[:-1] * height[1:]
        total[2:] += k2[:-2] * height[:-2]
        total[:-2] += k2[:-2] * height[2:]
        total[0] += self.drive[0] * end
        total[1] += self.drive[1] * end
        return total

    def energy(self, height: Array, velocity: Array, end: float = 0.0) -> float:
        """E of the module's docstring."""
        elastic = 0.5 * height @ (self.force(height, end) + self.load)
        pull = 0.5 * end * (self.drive[0] * height[0] + self.drive[1] * height[1])
        kinetic = 0.5 * velocity @ (self.mass * velocity)
        own = end * (0.5 * self.end_stiffness * end + self.end_load)
        return float(kinetic + elastic + pull + own)

    @property
    def explicit_limit(self) -> float:
        """2/ω_max, with ω_max bounded by Gershgorin's circles: explicit steps must be shorter."""
        k0, k1, k2 = np.abs(self.stiffness)
        rows = k0 + k1 + k2
        rows[1:] += k1[:-1]
        rows[2:] += k2[:-2]
        return float(2 / math.sqrt((rows / self.mass).max()))


class State(NamedTuple):
    """W, V and the nodes that the ground holds, shape (n,) each.

    For Verlet V is the velocity half a step before the time of W.
    """

    height: Array
    velocity: Array
    active: Flags


@dataclass(frozen=True)
class Grid:
    """Spacing, length and absorbing end of the domain.

    Attributes
    ----------
    dx
        Spacing, at most √β/4 where β > 0: the boundary layer √β at the contact point needs nodes.
    length
        Where the domain ends, in units of x₀.
    sponge
        Over this last part of the domain extra damping 2σ(ξ)W_τ swallows waves, with σ rising from
        0 to ``strength`` like a cubic. 0 for a hard end.
    strength
        σ at the end. From 6 on nothing measurable of a pulse on the ground reaches it.

    Raises
    ------
    InputError
        ``dx`` or ``length`` not positive, the others negative, or too many nodes.
    """

    dx: float = 0.01
    length: float = 8.0
    sponge: float = 3.0
    strength: float = 10.0

    def __post_init__(self) -> None:
        checks = {"dx": positive, "length": positive, "sponge": non_negative}
        for name, check in (checks | {"strength": non_negative}).items():
            object.__setattr__(self, name, check(name, getattr(self, name)))
        if self.length > MOST * self.dx:
            raise InputError(
                f"length = {self.length!r} and dx = {self.dx!r} make more than {MOST} nodes; take "
                "a larger dx or a shorter domain"
            )


def rope(problem: RopeProblem, grid: Grid | None = None) -> SemiDiscrete:
    r"""The rope's second-order differences: energies ½ΣT(D₁W)² dx, ½βΣ(D₂W)² dx and ½ΣκW² dx.

    The tension is taken half way between nodes. Over uneven ground the nodes hold W − g: Kg is part
    of the load.

    Nodes are ξ_i = i dx, i = 1 … n; node 0 is the driven end, whose ghost neighbour makes D₂W = 0
    (pinned) or W_{−1} = W_1 (clamped); the rope ends at W = D₂W = 0.

    Raises
    ------
    InputError
        The grid does not suit the problem: dx > √β/4, or a domain that ends before the rope is
        down.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> system = rope(RopeProblem(0.01, ramped_cosine(2.5, 0.05)), Grid(dx=0.02))
    >>> system.size, round(system.explicit_limit * 1e3, 3)
    (399, 1.99)
    """
    grid = Grid() if grid is None else grid
    beta, dx = problem.beta, grid.dx
    _check_grid(problem, grid)
    n = round(grid.length / dx) - 1
    positions = dx * np.arange(1.0, n + 1)
    links = _checked("tension", problem.tension, dx * np.arange(0.5, n + 1), least=0.0) / dx
    springs = dx * _checked("foundation", problem.foundation, dx * np.arange(0.0, n + 1))
    k0 = links[:-1] + links[1:] + springs[1:] + 6 * beta / dx**3
    k1 = -links[1:] - 4 * beta / dx**3
    k2 = np.full(n, beta / dx**3)
    clamped = problem.driven_end is DrivenEnd.CLAMPED
    turn = 2 * beta / dx**3 if clamped else 0.0
    k0[0] += -beta / dx**3 + turn
    k0[-1] -= beta / dx**3
    k1[-1:] = k2[-2:] = 0.0
    weight = dx * problem.weight(dx * np.arange(0.0, n + 1))
    system = SemiDiscrete(
        positions=positions,
        mass=dx * _checked("mass", problem.mass, positions, least=0.0),
        damping=2 * dx * (problem.damping + _sponge(positions, grid)),
        load=weight[1:],
        stiffness=np.array([k0, k1, k2]),
        drive=(-float(links[0]) - 2 * beta / dx**3 - turn, beta / dx**3),
        end_stiffness=float(links[0] + 0.5 * springs[0]) + beta / dx**3 + turn,
        end_load=0.5 * float(weight[0]),
        obstacle=np.ones(n, bool),
        dx=dx,
        beta=beta,
    )
    if not any(problem.ground.coefficients) and not problem.ground.places:
        return system
    ground = problem.ground(positions)
    load = system.force(ground)
    # K knows that W − g ends with the domain; g goes on, straight.
    beyond, next_but_one = ground[-1] + np.array([1.0, 2.0]) * (ground[-1] - ground[-2])
    load[-2] += beta / dx**3 * beyond
    load[-1] += (-links[-1] - 4 * beta / dx**3) * beyond
    load[-1] += beta / dx**3 * (next_but_one + ground[-1])
    return system._replace(
        load=load,
        end_load=system.end_load + system.drive[0] * ground[0] + system.drive[1] * ground[1],
    )


def _checked(name: str, values: Along, places: Array, least: float | None = None) -> Array:
    """Values along the rope that must not be negative, or must exceed ``least``."""
    found = values(places)
    bad = ~(found >= 0) if least is None else ~(found > least)
    if bad.any():
        where = int(np.flatnonzero(bad)[0])
        raise InputError(
            f"{name} = {found[where]:.6g} at ξ = {places[where]:.6g}; it has to be "
            f"{'at least 0' if least is None else f'> {least:g}'} along the whole domain"
        )
    return found


def string_on_obstacle(nodes: int) -> SemiDiscrete:
    """A weightless string from W(0) = 0 to W(1) = 0 above a flat obstacle, unit wave speed.

    >>> string_on_obstacle(99).dx
    0.01
    """
    n = whole("nodes", nodes, FEWEST)
    dx = 1 / (n + 1)
    k1 = np.full(n, -1 / dx)
    k1[-1] = 0.0
    zeros = np.zeros(n)
    return SemiDiscrete(
        positions=dx * np.arange(1.0, n + 1),
        mass=np.full(n, dx),
        damping=zeros,
        load=zeros,
        stiffness=np.array([np.full(n, 2 / dx), k1, zeros]),
        drive=(0.0, 0.0),
        end_stiffness=0.0,
        end_load=0.0,
        obstacle=np.ones(n, bool),
        dx=dx,
        beta=0.0,
    )


def falling_bar(
    nodes: int, modulus: float = 900.0, density: float = 1.0, length: float = 10.0, g: float = 10.0
) -> SemiDiscrete:
    """A vertical elastic bar that falls on rigid ground, touching it with its lower end only.

    W_i is the height of the section that rests at ξ_i above the lower end, less ξ_i: the lower end,
    node 0, meets the ground at W_0 = 0. Linear finite elements, lumped mass.

    Source: D. Doyen, A. Ern & S. Piperno, SIAM J. Sci. Comput. 33 (2011) 223.

    >>> bar = falling_bar(101)
    >>> float(bar.mass.sum()), bar.obstacle.sum()
    (10.0, np.int64(1))
    """
    n, modulus, g = whole("nodes", nodes, FEWEST), positive("modulus", modulus), finite("g", g)
    dx = positive("length", length) / (n - 1)
    mass = np.full(n, positive("density", density) * dx)
    k0 = np.full(n, 2 * modulus / dx)
    k1 = np.full(n, -modulus / dx)
    mass[[0, -1]] /= 2
    k0[[0, -1]] /= 2
    k1[-1] = 0.0
    obstacle = np.zeros(n, bool)
    obstacle[0] = True
    return SemiDiscrete(
        positions=dx * np.arange(0.0, n),
        mass=mass,
        damping=np.zeros(n),
        load=mass * g,
        stiffness=np.array([k0, k1, np.zeros(n)]),
        drive=(0.0, 0.0),
        end_stiffness=0.0,
        end_load=0.0,
        obstacle=obstacle,
        dx=dx,
        beta=0.0,
    )


def _sponge(positions: Array, grid: Grid) -> Array:
    if grid.sponge == 0:
        return np.zeros_like(positions)
    depth = np.clip((positions - grid.length) / grid.sponge + 1, 0.0, 1.0)
    return grid.strength * depth**3


def check_spacing(beta: float, dx: float, height: float = 1.0) -> None:
    """What must be resolved: the boundary layer √β, or without bending the rope's length √Z."""
    width, what = math.sqrt(beta), "the boundary layer at the contact point is √β"
    if beta == 0:
        width, what = math.sqrt(height), "the lifted rope at rest is √Z"
    if dx > width / 4 * (1 + 1e-12):
        raise InputError(
            f"dx = {dx!r} is too coarse for beta = {beta!r}: {what} = {width:.4g} "
            f"{'wide' if beta > 0 else 'long'} and needs dx ≤ {'√β' if beta > 0 else '√Z'}/4 = "
            f"{width / 4:.4g}"
        )


def _check_grid(problem: RopeProblem, grid: Grid) -> None:
    height = float(problem.drive.height(np.array(0.0)))
    if not 0 < height < math.inf:
        raise InputError(
            f"the drive starts at Z(0) = {height!r}; it must start above the ground, Z > 0"
        )
    check_spacing(problem.beta, grid.dx, height)
    # The static rope is down by √Z + √β (and ξ₀ ≤ 1.36 √Z for β ≤ 0.1); waves need room beyond.
    down = math.sqrt(height) + math.sqrt(problem.beta)
    if grid.length - grid.sponge < 1.25 * down or grid.length < FEWEST * grid.dx:
        raise InputError(
            f"a domain of length {grid.length!r} whose last {grid.sponge!r} absorb is too short: "
            f"the rope at rest comes down near ξ = {down:.4g}; take length − sponge ≥ "
            f"{1.25 * down:.4g}"
        )
