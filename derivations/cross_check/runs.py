r"""The emitted closed forms beside the contact simulator, for
:mod:`derivations.cross_check.ladder`.

At β = 0 the floor is the distance of the simulated state from the invariant circle, the exact
periodic one: grid, time step and ramp together. With bending it is a third of the distance from a
grid twice as coarse, the schemes being of second order.

At β = 0 the simulated ξ_c jumps, by O(dx ε), as single nodes land; W does not. So of the simulated
ξ_c the harmonics 0 … HARMONICS are compared, more than the series of order 4 has.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derivations.cross_check.data import (
    PLACES,
    SETTLE,
    Comparison,
    Row,
    comparison,
    ramped,
)
from derivations.cross_check.forms import PHASES, Array, JudgedForm, rms
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.problems.drive import Drive
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.semi_discrete import Grid

HARMONICS = 5
# Floor and truncation error add as squares: three floors are 5 % of an error.
SIMULATED_KEEP = 3.0


@dataclass(frozen=True, eq=False)
class SimulatedPeriod:
    """The first whole period after a time, in steps of equal length.

    Attributes
    ----------
    times, contact
        ξ_c at the end of each step, shape (n,).
    shape_times, shape
        PHASES instants, and W at PLACES then, shape (places, PHASES).
    """

    times: Array
    contact: Array
    shape_times: Array
    shape: Array

    def distance(
        self, contact: Callable[[Array], Array], shape: Callable[[Array, Array], Array]
    ) -> tuple[float, float]:
        """Of ξ_c, by its harmonics, and of W, from ξ_c(τ) and W(ξ, τ)."""
        excess = harmonics(contact(self.times) - self.contact)
        return _size(excess), rms(shape(PLACES[:, None], self.shape_times) - self.shape)


def harmonics(values: Array) -> NDArray[np.complex128]:
    """c_0 … c_HARMONICS of Σ c_j e^{ijθ}, from values at the ends of equal steps of one period.

    >>> theta = np.arange(1, 17) * np.pi / 8
    >>> bool(np.allclose(harmonics(1 + np.cos(theta)), [1, 0.5, 0, 0, 0, 0]))
    True
    """
    turns = 2 * np.pi * np.arange(1, len(values) + 1) / len(values)
    waves = np.exp(-1j * np.multiply.outer(np.arange(HARMONICS + 1), turns))
    return np.asarray(waves @ values / len(values))


def simulated_period(
    drive: Drive, after: float, beta: float, dx: float, scheme: Scheme
) -> SimulatedPeriod:
    """The first whole period after a time, with steps of about dx (Verlet: as long as stable)."""
    problem, grid = RopeProblem(beta, drive), Grid(dx=dx, length=2.0, sponge=0.5)
    longest = Simulator(problem, grid, scheme=scheme).dt
    dt = drive.period / (PHASES * math.ceil(drive.period / (PHASES * longest)))
    simulator = Simulator(problem, grid, dt, scheme)
    start = math.ceil(after / drive.period) * drive.period
    for _ in simulator.blocks(start - dt / 2):
        pass
    nodes = np.round(PLACES / dx).astype(int) - 1
    blocks, frames, instants = [], [], []
    for i in range(1, PHASES + 1):
        blocks += list(simulator.blocks(start + i * drive.period / PHASES - dt / 2))
        frames.append(simulator.state.height[nodes])
        instants.append(simulator.time)
    return SimulatedPeriod(
        np.concatenate([block.times for block in blocks]),
        np.concatenate([block.rows[:, Column.CONTACT] for block in blocks]),
        np.array(instants),
        np.array(frames).T,
    )


def against_simulator(
    omega: float,
    beta: float,
    epsilon: Sequence[float] | Array,
    forms: Sequence[JudgedForm],
    dx: float,
    scheme: Scheme,
    length: float = 150.0,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Closed forms of orders 1 … N against the simulator, at the amplitudes ε, decreasing.

    ``progress`` is called with how many are done, and of how many.

    Raises
    ------
    CircleNotFoundError
        β = 0, and the string has no periodic state at an amplitude.
    """
    rows = []
    for e in epsilon:
        rows.append(_simulated_row(omega, beta, e, forms, dx, scheme, length))
        if progress is not None:
            progress(len(rows), len(epsilon))
    return comparison(omega, beta, epsilon, len(forms), SIMULATED_KEEP, rows)


def _simulated_row(
    omega: float,
    beta: float,
    epsilon: float,
    forms: Sequence[JudgedForm],
    dx: float,
    scheme: Scheme,
    length: float,
) -> Row:
    drive = ramped(omega, epsilon, length)
    run = simulated_period(drive, length + SETTLE, beta, dx, scheme)
    errors = [run.distance(*form.at(epsilon)) for form in forms]
    if beta > 0:
        coarse = simulated_period(drive, length + SETTLE, beta, 2 * dx, scheme)
        floor = _grid_error(run, coarse)
    else:
        circle = invariant_circle(omega, epsilon)
        floor = run.distance(circle.contact, circle.shape)
    return errors, floor


def _grid_error(fine: SimulatedPeriod, coarse: SimulatedPeriod) -> tuple[float, float]:
    """A third of the distance: what is left on the finer grid of a scheme of second order."""
    excess = harmonics(fine.contact) - harmonics(coarse.contact)
    return _size(excess) / 3, rms(fine.shape - coarse.shape) / 3


def _size(parts: NDArray[np.complex128]) -> float:
    """Root mean square of the function with these harmonics."""
    return math.sqrt(abs(parts[0]) ** 2 + 2 * float((np.abs(parts[1:]) ** 2).sum()))


def layer_residual(
    form: JudgedForm,
    omega: float,
    epsilon: float,
    beta: float,
    dx: float,
    length: float = 150.0,
) -> float:
    r"""What bending adds to the string's mean contact point beyond its boundary layer.

    The mean over a period of :math:`ξ_c − ξ_c^0 − \sqrt{β/(1 − ξ_c'^2)} − β/2`, ξ_c simulated with
    β > 0 and ξ_c⁰ the string's closed form ``form``.
    """
    drive = ramped(omega, epsilon, length)
    run = simulated_period(drive, length + SETTLE, beta, dx, Scheme.TRAPEZOIDAL)
    step = run.times[1] - run.times[0]
    string = form.contact(run.times, epsilon)
    speed = (form.contact(run.times + step, epsilon) - form.contact(run.times - step, epsilon)) / (
        2 * step
    )
    layer = np.sqrt(beta / (1 - speed**2)) + beta / 2
    return float(np.mean(run.contact - string - layer))
