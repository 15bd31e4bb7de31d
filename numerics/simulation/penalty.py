r"""The semi-discrete rope over springs instead of ground, for ``scipy.integrate.solve_ivp``.

A third check of the contact simulators: slow, familiar, and without any projection. Where a node is
below ground it is pushed up by a spring and a dashpot that never pull,

.. math:: λ_i = m_i \max\bigl(−κW_i − 2η\sqrt{κ}\, \dot W_i,\, 0\bigr) \text{ for } W_i < 0,

κ in units of c²/x₀². A rope at rest sinks by 2/κ, and a node that strikes such ground alone leaves
it after a time of order 1/√κ with the part

.. math:: r = e^{−2φ\cot φ}, \quad \cos φ = η \qquad (r = e^{−2} \text{ at } η = 1; \text{ for }
          η = \cosh ψ \text{ read } φ = iψ)

of its speed: η is the restitution of this model, r = 0 only as η → ∞. With dx fixed and κ → ∞ the
equations become those of :mod:`numerics.simulation.semi_discrete` with this r. Take κ ≫ ω_max² =
4/dx² + 16β/dx⁴ for that; below it the ground is felt soft, and the error is of order 1/√κ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from numerics.errors import InputError, NumericsError
from numerics.problems.drive import Array, non_negative, positive
from numerics.problems.problem import RopeProblem
from numerics.simulation.observables import contact_point
from numerics.simulation.semi_discrete import Grid, SemiDiscrete, rope

METHODS = ("RK45", "RK23", "DOP853", "Radau", "BDF", "LSODA")
"""Methods of ``solve_ivp``."""

IMPLICIT = ("Radau", "BDF")
"""Methods of ``solve_ivp`` that want to know where the Jacobian is not zero."""


@dataclass(frozen=True, eq=False)
class PenaltyRun:
    """What :func:`solve` found.

    Attributes
    ----------
    times, contact
        τ and ξ_c, shape (k,).
    heights, velocities
        W and W_τ at the nodes, shape (k, n).
    evaluations
        How often the right-hand side was asked for.
    """

    times: Array
    contact: Array
    heights: Array
    velocities: Array
    evaluations: int


@dataclass(frozen=True, eq=False)
class PenaltyGround:
    """A rope over springs; :func:`penalty_ground` makes it.

    The state y of ``solve_ivp`` is (W_1, W_τ1, W_2, W_τ2, …), shape (2n,): in this order the
    Jacobian is banded.

    Attributes
    ----------
    problem, system
        What moves, and its differences.
    stiffness, damping
        κ and η.
    start
        The state at rest, with the driven end at Z(0).
    """

    problem: RopeProblem
    system: SemiDiscrete
    stiffness: float
    damping: float
    start: Array = field(init=False)

    def __post_init__(self) -> None:
        end = float(self.problem.drive.height(np.zeros(1))[0])
        start = np.zeros(2 * self.system.size)
        start[0::2] = self._at_rest(end)
        object.__setattr__(self, "start", start)

    @property
    def restitution(self) -> float:
        """The r of the module's docstring.

        Examples
        --------
        >>> from numerics.problems.drive import at_rest
        >>> problem, grid = RopeProblem(0.01, at_rest()), Grid(dx=0.025)
        >>> [round(penalty_ground(problem, grid, 1e6, eta).restitution, 4) for eta in (0, 1, 10)]
        [1.0, 0.1353, 0.0024]
        """
        eta = self.damping
        if eta == 1:
            return math.exp(-2)
        if eta < 1:
            angle = math.acos(eta)
            return math.exp(-2 * angle * eta / math.sin(angle))
        angle = math.acosh(eta)
        return math.exp(-2 * angle * eta / math.sinh(angle))

    def reaction(self, height: Array, velocity: Array) -> Array:
        """λ, for W and W_τ of shape (n,)."""
        push = -self.stiffness * height - 2 * self.damping * math.sqrt(self.stiffness) * velocity
        return self.system.mass * np.where(height < 0, np.maximum(push, 0.0), 0.0)

    def rhs(self, t: float, y: Array) -> Array:
        """dy/dτ, as ``solve_ivp`` calls it."""
        height, velocity = y[0::2], y[1::2]
        end = float(self.problem.drive.height(np.array([t]))[0])
        total = self.reaction(height, velocity) - self.system.force(height, end)
        rate = np.empty_like(y)
        rate[0::2] = velocity
        rate[1::2] = (total - self.system.damping * velocity) / self.system.mass
        return rate

    def contact(self, height: Array) -> float:
        """ξ_c of one state, by the formula of :mod:`numerics.simulation.observables`.

        Its nodes on the ground are those below it, and lie at W = 0 there: the penetration, of
        order 1/κ, is taken off before forces are formed.
        """
        above = np.maximum(height, 0.0)
        held = height <= 0
        force = self.system.force(above) - self.system.load
        return float(contact_point(self.system, force, held)[0])

    def _at_rest(self, end: float) -> Array:
        """K W + bZ + f = κ m max(−W, 0): Newton's iteration over who is below ground."""
        from scipy.linalg import solveh_banded

        system, n = self.system, self.system.size
        k0, k1, k2 = system.stiffness
        right = -system.force(np.zeros(n), end)
        below = np.zeros(n, bool)
        below[n // 2 :] = True
        for _ in range(10 * n):
            bands = np.array([k0 + self.stiffness * system.mass * below, k1, k2])
            height: Array = solveh_banded(bands, right, lower=True)
            if np.array_equal(height < 0, below):
                return height
            below = height < 0
        raise NumericsError("no state at rest on springs was found; take a stiffer ground")


def penalty_ground(
    problem: RopeProblem, grid: Grid | None, stiffness: float, damping: float = 1.0
) -> PenaltyGround:
    """The rope of ``problem`` over springs of stiffness κ and damping η.

    ``problem.restitution`` plays no part: η stands for it, see
    :attr:`PenaltyGround.restitution`.

    Raises
    ------
    InputError
        κ ≤ 0, η < 0, or a grid that does not suit the problem.

    Examples
    --------
    A rope at rest sinks by 2/κ.

    >>> from numerics.problems.drive import at_rest
    >>> ground = penalty_ground(RopeProblem(0.01, at_rest()), Grid(dx=0.025), 1e6)
    >>> round(float(ground.start[2 * 200]) * 1e6, 2)
    -2.0
    """
    stiffness, damping = positive("stiffness", stiffness), non_negative("damping", damping)
    return PenaltyGround(problem, rope(problem, grid), stiffness, damping)


def solve(
    ground: PenaltyGround,
    times: ArrayLike,
    method: str = "LSODA",
    rtol: float = 1e-6,
    atol: float = 1e-9,
) -> PenaltyRun:
    """The motion from rest at τ = 0, at the ``times`` given.

    Parameters
    ----------
    ground
        See :func:`penalty_ground`.
    times
        Increasing, ≥ 0, shape (k,).
    method, rtol, atol
        Of ``scipy.integrate.solve_ivp``.

    Raises
    ------
    InputError
        Times that do not increase from τ ≥ 0 on, an unknown method, or a tolerance ≤ 0.
    NumericsError
        ``solve_ivp`` gave up.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> problem = RopeProblem(0.04, ramped_cosine(2.5, 0.05, 0.5))
    >>> ground = penalty_ground(problem, Grid(0.05, 3.0, 0.0), 1e6)
    >>> run = solve(ground, [0.0, 0.5, 1.0])
    >>> run.contact.shape, bool(run.contact[0] > 1.19), bool(run.heights.min() > -1e-4)
    ((3,), True, True)
    """
    from scipy.integrate import solve_ivp

    if method not in METHODS:
        raise InputError(f"method = {method!r}: choose one of {', '.join(METHODS)}")
    rtol, atol = positive("rtol", rtol), positive("atol", atol)
    try:
        moments = np.atleast_1d(np.asarray(times, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"times = {times!r}: give numbers") from None
    ordered = moments.ndim == 1 and moments.size > 0 and bool((np.diff(moments) > 0).all())
    if not (ordered and moments[0] >= 0 and 0 < moments[-1] < math.inf):
        raise InputError(f"times = {times!r}: give increasing times, the first at least 0")
    solution = solve_ivp(
        ground.rhs,
        (0.0, moments[-1]),
        ground.start,
        method=method,
        t_eval=moments,
        rtol=rtol,
        atol=atol,
        **_structure(method, ground.system.size),
    )
    if not (solution.success and np.isfinite(solution.y).all()):
        raise NumericsError(
            f"solve_ivp gave up at tau = {solution.t[-1]:.6g}: {solution.message} "
            "Take another method, or look whether the drive is finite"
        )
    heights, velocities = solution.y[0::2].T, solution.y[1::2].T
    return PenaltyRun(
        times=moments,
        contact=np.array([ground.contact(height) for height in heights]),
        heights=heights,
        velocities=velocities,
        evaluations=int(solution.nfev),
    )


def _structure(method: str, n: int) -> dict[str, Any]:
    """Where the Jacobian is not zero: node i's acceleration feels W_{i±2}, …, W_i and W_τi."""
    if method == "LSODA":
        return {"lband": 5, "uband": 3}
    if method not in IMPLICIT:
        return {}
    from scipy.sparse import diags_array, kron

    near = diags_array(np.ones((5, n)), offsets=[-2, -1, 0, 1, 2], shape=(n, n))
    own = diags_array(np.ones(n))
    return {"jac_sparsity": kron(near, [[0, 0], [1, 0]]) + kron(own, [[0, 1], [0, 1]])}
