"""Pickles in a fresh process, and deep copies: drives, problems, runs, exact motions, errors."""

from __future__ import annotations

import copy
import inspect
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from numerics import errors as all_errors
from numerics.errors import CircleNotFoundError, NumericsError, SonicContactError
from numerics.exact_string.characteristics import exact_string_motion
from numerics.exact_string.invariant_circle import invariant_circle
from numerics.problems.drive import Drive, at_rest, cosine, ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Simulator
from numerics.simulation.run import simulate
from numerics.simulation.semi_discrete import Grid

TIMES = np.linspace(0.0, 30.0, 301)
# In a process that has imported nothing yet.
CHILD = "import pickle, sys; pickle.dump(pickle.load(sys.stdin.buffer), sys.stdout.buffer)"


def in_a_fresh_process(item: Any) -> Any:
    done = subprocess.run(
        [sys.executable, "-c", CHILD], input=pickle.dumps(item), capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    return pickle.loads(done.stdout)


@pytest.mark.parametrize("copied", [in_a_fresh_process, copy.deepcopy])
def test_drives_problems_runs_and_motions(copied: Callable[[Any], Any]) -> None:
    drives = [at_rest(0.9), cosine(2.0, 0.01), ramped_cosine(omega=2.2, epsilon=0.02, periods=3)]
    problem = RopeProblem(0.01, drives[2], "clamped", 0.1)  # type: ignore[arg-type]
    grid = Grid(dx=0.02)
    run = simulate(problem, 2.0, grid)
    simulator = Simulator(problem, grid)
    blocks = simulator.blocks(until=2.0)
    next(blocks)
    motion = exact_string_motion(drives[2], until=20.0)
    circle = invariant_circle(2.2, 0.02)
    same_drives, same_problem, same_run, same_simulator, same_motion, same_circle = copied(
        (drives, problem, run, simulator, motion, circle)
    )
    for before, after in zip(drives, same_drives, strict=True):
        assert (before.label, before.omega) == (after.label, after.omega)
        for name in ("height", "slope", "curvature"):
            np.testing.assert_array_equal(getattr(before, name)(TIMES), getattr(after, name)(TIMES))
    assert (same_problem.beta, same_problem.driven_end) == (problem.beta, problem.driven_end)
    np.testing.assert_array_equal(simulate(same_problem, 2.0, grid).rows, run.rows)
    np.testing.assert_array_equal(same_run.rows, run.rows)
    np.testing.assert_array_equal(same_run.end.height, run.end.height)
    for one in (simulator, same_simulator):
        for _ in one.blocks(until=3.0):
            pass
    np.testing.assert_array_equal(simulator.state.height, same_simulator.state.height)
    np.testing.assert_array_equal(motion.contact(TIMES[:200]), same_motion.contact(TIMES[:200]))
    assert same_circle.status is circle.status


def test_the_exact_motion_of_a_drive_without_second_derivative() -> None:
    cosine_like = ramped_cosine(2.2, 0.02, 3)
    motion = exact_string_motion(Drive(cosine_like.height, cosine_like.slope, "mine"), until=20.0)
    again = pickle.loads(pickle.dumps(motion))
    np.testing.assert_array_equal(motion.contact(TIMES[:200]), again.contact(TIMES[:200]))


def test_a_drive_of_one_s_own_pickles_where_its_functions_do() -> None:
    own = Drive(np.cosh, np.sinh, "cosh")
    assert pickle.loads(pickle.dumps(own)) == own
    with pytest.raises((AttributeError, pickle.PicklingError), match="pickle"):
        pickle.dumps(Drive(lambda t: 1 + 0 * t, lambda t: 0 * t, "rest"))


def test_errors_cross_processes() -> None:
    motion = exact_string_motion(ramped_cosine(2.7, 0.3, periods=2), until=60.0)
    assert motion.sonic is not None
    errors: list[NumericsError] = [
        SonicContactError("too fast", motion.sonic),
        CircleNotFoundError("none", None),
    ]
    for _, kind in inspect.getmembers(all_errors, inspect.isclass):
        if issubclass(kind, NumericsError) and kind not in map(type, errors):
            errors.append(kind("words"))
    for error in errors:
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert again.__dict__ == error.__dict__
