r"""After the wave-less state is lost: how wave heights grow with ε − ε_c, and the ground's rebound.

The paper says that they grow linearly, not as a square root. A fit of H = H₀ + A(ε − ε_c)^p over a
finite range answers that only within its error, and ε_c is itself an interval: the exponent is
fitted at both of its ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numerics.errors import InputError
from numerics.exact_solutions.impact import StringImpact
from numerics.problems.drive import Array, Drive, positive, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.semi_discrete import Grid
from numerics.thresholds.ramped_run import Settings


@dataclass(frozen=True, eq=False)
class HeightCurve:
    """Heights of waves against ε, shape (k,) each; a height is the BUMP's largest in a period.

    Attributes
    ----------
    omega, beta, settings
        Of which runs; ``settings.height`` is where a wave begins.
    epsilon
        The amplitudes.
    first
        The first wave's, within a period; 0 where there was none.
    mean, scatter
        Mean and standard deviation over the second half of the hold: the regime that follows.
    """

    omega: float
    beta: float
    settings: Settings
    epsilon: Array
    first: Array
    mean: Array
    scatter: Array


def wave_heights(
    omega: float, beta: float, epsilons: Sequence[float] | Array, settings: Settings
) -> HeightCurve:
    """Ramp and hold at each ε to the end, waves or not.

    Raises
    ------
    InputError
        As the simulator, no amplitude, or a hold of less than four periods.

    Examples
    --------
    >>> coarse = Settings(dx=0.025, height=1e-3, ramp=5, hold=4)
    >>> curve = wave_heights(2.9, 0.01, [0.01, 0.1], coarse)
    >>> float(curve.mean[0]), bool(curve.mean[1] > 1e-3)
    (0.0, True)
    """
    if settings.hold < 4:
        raise InputError(f"hold = {settings.hold!r}: give at least 4 periods, to average over")
    if len(epsilons) == 0:
        raise InputError("epsilons is empty: give at least one amplitude")
    each = [_heights(omega, beta, epsilon, settings) for epsilon in epsilons]
    first, mean, scatter = np.array(each).T
    return HeightCurve(omega, beta, settings, np.array(epsilons, float), first, mean, scatter)


def _heights(omega: float, beta: float, epsilon: float, s: Settings) -> tuple[float, float, float]:
    drive = ramped_cosine(omega, epsilon, s.ramp)
    simulator = s.simulator(RopeProblem(beta, drive))
    periods = math.floor(s.ramp + s.hold)
    highest = np.zeros(periods + 1)
    for times, rows in simulator.blocks(periods * drive.period):
        which = np.minimum((times / drive.period).astype(int), periods)
        np.maximum.at(highest, which, rows[:, Column.BUMP])
    waves = np.flatnonzero(highest >= s.height)
    first = highest[waves[0] : waves[0] + 2].max() if len(waves) else 0.0
    regime = highest[math.ceil(s.ramp + s.hold / 2) : periods]
    return float(first), float(regime.mean()), float(regime.std())


@dataclass(frozen=True)
class PowerFit:
    """H = H₀ + A(ε − ε_c)^p.

    Attributes
    ----------
    exponent, error
        p and its standard error, for the middle of the interval of ε_c.
    low, high
        The exponents at the two ends of that interval, in rising order.
    offset, amplitude
        H₀ and A.
    residual
        Root mean square misfit of log H.
    """

    exponent: float
    error: float
    low: float
    high: float
    offset: float
    amplitude: float
    residual: float


def fit_power(
    epsilon: Array, height: Array, lower: float, upper: float, offset: bool = True
) -> PowerFit:
    """Least squares of log H; ``offset`` says whether H₀ ≥ 0 is free, or zero.

    Raises
    ------
    InputError
        Fewer than five points, points that are not above ``upper`` with a wave, or an interval that
        is none.

    Examples
    --------
    >>> x = np.linspace(0.11, 0.2, 9)
    >>> fit = fit_power(x, 0.001 + 0.3 * (x - 0.1), 0.1, 0.1)
    >>> round(fit.exponent, 6), round(fit.offset, 6)
    (1.0, 0.001)
    """
    epsilon, height = np.asarray(epsilon, float), np.asarray(height, float)
    if (
        epsilon.ndim != 1
        or epsilon.shape != height.shape
        or not np.isfinite(epsilon + height).all()
    ):
        raise InputError("give as many heights as amplitudes, all of them finite")
    if not lower <= upper < math.inf:
        raise InputError(f"lower = {lower!r}, upper = {upper!r}: give the ends of an interval")
    if len(epsilon) < 5 or not (epsilon > upper).all() or not (height > 0).all():
        raise InputError("give five or more amplitudes above the threshold, each with a wave")
    middle = 0.5 * (lower + upper)
    best, error, residual = _fit(epsilon - middle, height, offset)
    ends = sorted(_fit(epsilon - end, height, offset)[0][0] for end in (lower, upper))
    return PowerFit(
        best[0], error, ends[0], ends[1], best[2] if offset else 0.0, math.exp(best[1]), residual
    )


def _fit(excess: Array, height: Array, offset: bool) -> tuple[list[float], float, float]:
    """(p, ln A and, if free, H₀), the error of p and the residual."""
    from scipy.optimize import least_squares

    def misfit(v: Array) -> Array:
        model = np.exp(v[1]) * excess ** v[0] + (v[2] if offset else 0.0)
        return np.asarray(np.log(model / height))

    slope, level = np.polyfit(np.log(excess), np.log(height), 1)
    start = [max(slope, 0.1), level] + ([0.1 * float(height.min())] if offset else [])
    low = [0.0, -np.inf] + ([0.0] if offset else [])
    found = least_squares(misfit, start, bounds=(low, np.inf), x_scale=np.abs(start), xtol=1e-12)
    if offset and found.x[2] < 1e-6 * height.min():
        # H₀ sits on its bound, where it tells nothing about the error of p.
        (slope, level), error, residual = _fit(excess, height, offset=False)
        return [slope, level, 0.0], error, residual
    square = 2 * found.cost / max(len(excess) - len(start), 1)
    error = math.sqrt(square * np.linalg.pinv(found.jac.T @ found.jac)[0, 0])
    return [float(x) for x in found.x], error, math.sqrt(2 * found.cost / len(excess))


def strike(
    impact: StringImpact,
    until: float,
    dx: float,
    scheme: Scheme | str = Scheme.VERLET,
    courant: float = 0.9,
    width: float = 1.0,
) -> tuple[Array, Array, float]:
    """Let a string with a smooth minimum fall on the ground, in the simulator.

    The string starts in free fall just above the ground, its minimum between two nodes, and the
    driven end goes on falling as without ground: the impact is the only event until waves from it
    have run to the end and back.

    Parameters
    ----------
    impact
        Which, with its restitution.
    until
        τ after the first touch.
    dx, scheme, courant
        Spacing, integrator and dt/dx.
    width
        The result is for |ζ| ≤ width.

    Returns
    -------
    tuple
        ζ and W there, and the time since the first touch.

    Raises
    ------
    InputError
        ``until`` or ``width`` so large that the ends of the domain are felt.

    Examples
    --------
    >>> impact = StringImpact(velocity=0.3, curvature=4.0)
    >>> zeta, height, tau = strike(impact, 0.1, dx=0.01)
    >>> bool(np.abs(height - impact.height(zeta, tau)).max() < 1e-3)
    True
    """
    until, width = positive("until", until), positive("width", width)
    start = -0.02 / max(impact.velocity, 0.1)
    # Off the nodes by an irrational part of dx; the far end of the domain, cut off, is felt last.
    centre = 2 + dx / math.sqrt(7)
    if until - start + width > 2:
        raise InputError(f"until + width = {until + width:.3g}: only below 2 are the ends unfelt")
    scheme, dt = Scheme(scheme), courant * positive("dx", dx)
    a, v = impact.curvature, impact.velocity
    drive = Drive(
        lambda t: impact.free_fall(-centre, t + start),
        lambda t: (a - 2) * (t + start) - v + np.zeros_like(t),
        f"free fall {a!r} {v!r}",
    )
    problem = RopeProblem(0.0, drive, restitution=impact.restitution)
    simulator = Simulator(problem, Grid(dx, length=6.0, sponge=0.0), dt, scheme)
    zeta = simulator.system.positions - centre
    state = simulator.state
    state.height[:] = impact.free_fall(zeta, start)
    before = impact.free_fall(zeta, start - dt)
    falling = (a - 2) * start - v
    state.velocity[:] = (state.height - before) / dt if scheme is Scheme.VERLET else falling
    state.active[:] = False
    for _ in simulator.blocks(until - start):
        pass
    near = np.abs(zeta) <= width
    return zeta[near], state.height[near], simulator.time + start
