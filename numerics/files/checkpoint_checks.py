r"""Whether the content of a checkpoint is the state of a run, and of which.

A seal says that a file is what somebody wrote. Compiled code trusts the shapes it is given, and a
number that is none, or a state that no run reaches, spreads into every result. So all that is read
is checked: shapes and types, finite values in their ranges, that the energy of the state is the
ledger's, and that the ledger closes,

.. math:: |E - E_0 - \text{work} + \text{damped} + \text{lost}| ≤ n\,u

after n steps of which none leaves more than u unexplained.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from numerics.problems.drive import Array
from numerics.simulation.contact import BLOCK, Scheme, Simulator

# Samples of Z over the time gone by, besides those of the present block.
_PAST = 256
# Another machine's cosine may differ in the last bits of Z; another motion differs in others.
_ROUNDINGS = 64.0
_EPS = float(np.finfo(float).eps)
_MOST_STEPS = 2**53

Content = dict[str, Any]


def sample_times(step: int, dt: float) -> Array:
    """Of the present block, where Z matters to the next bit, and of the time gone by."""
    start = step - step % BLOCK
    block = dt * np.arange(start - 1.0, start + BLOCK + 1)
    return np.concatenate([np.maximum(block, 0.0), np.linspace(0.0, step * dt, _PAST)])


def misshapen(simulator: Simulator, content: Content) -> str:
    """Which array has not the shape and type that it has in a simulator, in words, or nothing."""
    n, samples = simulator.system.size, BLOCK + 2 + _PAST
    wanted = {
        "step": ((), np.dtype(np.int64)),
        "height": ((n,), np.dtype(float)),
        "velocity": ((n,), np.dtype(float)),
        "active": ((n,), np.dtype(bool)),
        "ledger": ((4,), np.dtype(float)),
        "worst": ((3,), np.dtype(float)),
        "drive_times": ((samples,), np.dtype(float)),
        "drive_heights": ((samples,), np.dtype(float)),
    }
    for name, (shape, kind) in wanted.items():
        found = content[name]
        if found.shape != shape or found.dtype != kind:
            return f"{name} is {found.dtype} of shape {found.shape}, not {kind} of {shape}"
    if (content["active"].view(np.uint8) > 1).any():
        return "active holds what is neither true nor false"
    step = int(content["step"])
    if not 0 <= step <= _MOST_STEPS:
        return f"step = {step}"
    times = sample_times(step, simulator.dt)
    if not np.allclose(content["drive_times"], times, rtol=_ROUNDINGS * _EPS, atol=0):
        return f"drive_times are not those of step {step}"
    return ""


def other_motion(simulator: Simulator, content: Content) -> str:
    """Where the drive is another than that of the checkpoint, in words, or nothing."""
    times, there = content["drive_times"], content["drive_heights"]
    here = np.asarray(simulator.problem.drive.height(times), float)
    if here.shape != times.shape:
        return "the drive does not give a height for each time of an array"
    apart = np.abs(here - there)
    same = apart <= _ROUNDINGS * _EPS * np.abs(there)
    if same.all():
        return ""
    worst = int(np.argmax(np.where(same, -1.0, np.nan_to_num(apart, nan=math.inf))))
    return (
        f"the drive {simulator.problem.drive.label!r} is another motion of the same name: "
        f"Z({times[worst]:.6g}) = {there[worst]:.17g} there, {here[worst]:.17g} here"
    )


def impossible(fresh: Simulator, content: Content) -> str:
    """What no run of a simulator, given at rest, arrives at, in words, or nothing."""
    height, velocity, ledger = content["height"], content["velocity"], content["ledger"]
    for name in ("height", "velocity", "ledger"):
        if not np.isfinite(content[name]).all():
            return f"{name} holds {content[name][~np.isfinite(content[name])][0]}"
    unexplained, lowest, reaction = content["worst"]
    if not (0 <= unexplained < math.inf and lowest > -math.inf and reaction > -math.inf):
        return f"the worst of its steps are {unexplained}, {lowest}, {reaction}"
    # Only the rebounds of the explicit scheme take nodes below the ground, for a step.
    if not (fresh.scheme is Scheme.VERLET and fresh.problem.restitution > 0):
        if (height < 0).any():
            return f"a height is {height.min()}"
        if height[content["active"]].any():
            return "a node that the ground holds is above it"
    with np.errstate(over="ignore", invalid="ignore"):
        energy, scale = _energy(fresh, height, velocity, int(content["step"]))
    rounding = _ROUNDINGS * _EPS
    if not (math.isfinite(scale) and abs(energy - ledger[0]) <= rounding * scale):
        return f"the energy of its state is {energy:.10g}, that of its ledger {ledger[0]:.10g}"
    rest = fresh.ledger[0]
    left = ledger[0] - rest - ledger[1] + ledger[2] + ledger[3]
    most = unexplained + rounding * (abs(rest) + np.abs(ledger).sum())
    if not abs(left) <= int(content["step"]) * most:
        return f"its ledger {ledger.tolist()} does not close: {left:.3g} are left over"
    return ""


def _energy(fresh: Simulator, height: Array, velocity: Array, step: int) -> tuple[float, float]:
    """E as the scheme has it, and the sum of the absolute values that it is the difference of."""
    system = fresh.system
    times = fresh.dt * np.array([max(step - 1.0, 0.0), step])
    before, now = (float(z) for z in np.asarray(fresh.problem.drive.height(times), float))
    old = height
    if fresh.scheme is Scheme.VERLET:  # staggered: see numerics.simulation.verlet
        old = height - fresh.dt * velocity
    else:
        before = now
    kinetic = 0.5 * velocity @ (system.mass * velocity)
    pull = system.drive[0] * height[0] + system.drive[1] * height[1]
    ends = system.end_load * (before + now) + system.end_stiffness * before * now + pull * before
    mixed = old @ system.force(height, now) + system.load @ height
    k = 4 * np.abs(system.stiffness).sum(axis=0)
    scale = kinetic + k @ (height * height + old * old) + abs(ends) + now * k[0] * (now + height[0])
    return float(kinetic + 0.5 * (mixed + ends)), float(scale + system.load @ np.abs(height))
