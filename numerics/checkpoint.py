"""Stop a simulation and go on later, bit for bit.

A checkpoint is a sealed npz file (:mod:`numerics.files`): the state, the ledger, the
specification of the run as JSON, and samples of Z(τ), for two drives may share a label. On the
same machine with the same packages a resumed simulator takes the very steps it would have taken.
"""

from __future__ import annotations

import io
import json
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from numerics.contact import BLOCK, Scheme, Simulator
from numerics.drive import Array, non_negative
from numerics.errors import FileError, NumericsError
from numerics.files import differences, read_sealed, release, specification, write_sealed
from numerics.problem import RopeProblem
from numerics.semi_discrete import Grid, State

KIND = "ropewave checkpoint, version 2"
"""To be changed with the format, or with what the integrators do to the last bit."""

# Samples of Z over the time gone by, besides those of the present block.
_PAST = 256
# Another machine's cosine may differ in the last bits of Z; another motion differs in others.
_ROUNDINGS = 64.0

Progress = Callable[[int, int], None]
_Content = dict[str, Any]


def save_checkpoint(simulator: Simulator, path: Path | str) -> None:
    """Write where the simulator stands; a process killed while writing leaves the old file.

    Raises
    ------
    FileError
        The file exists and is not a checkpoint of this run, or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from numerics.drive import ramped_cosine
    >>> problem = RopeProblem(0.01, ramped_cosine(2.5, 0.05, 5))
    >>> simulator = Simulator(problem, Grid(dx=0.02))
    >>> _ = list(simulator.blocks(until=3.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_checkpoint(simulator, Path(folder) / "rope.npz")
    ...     again = resume(Path(folder) / "rope.npz", problem, Grid(dx=0.02))
    >>> again.time, bool((again.state.height == simulator.state.height).all())
    (3.0, True)
    """
    path = Path(path)
    if path.exists():
        _check(path, _read(path), simulator)
    content = _content(simulator)

    def fill(unfinished: Path) -> None:
        with unfinished.open("wb") as stream:
            np.savez(stream, **content)

    write_sealed(path, KIND, fill)


def resume(
    path: Path | str,
    problem: RopeProblem,
    grid: Grid | None = None,
    dt: float | None = None,
    scheme: Scheme | str = Scheme.TRAPEZOIDAL,
) -> Simulator:
    """The simulator that was saved, of the run that the arguments describe.

    Raises
    ------
    FileError
        The file is missing, damaged, truncated, no checkpoint, or one of another run: what
        differs is named. It is left as it is.
    InputError
        As the :class:`~numerics.contact.Simulator`.
    """
    path = Path(path)
    content = _read(path)
    simulator = Simulator(problem, grid, dt, scheme)
    _check(path, content, simulator)
    simulator.state = State(content["height"], content["velocity"], content["active"])
    simulator.ledger = content["ledger"]
    simulator.step = int(content["step"])
    simulator.unexplained, simulator.lowest, simulator.reaction = map(float, content["worst"])
    return simulator


def start_or_resume(
    path: Path | str,
    problem: RopeProblem,
    grid: Grid | None = None,
    dt: float | None = None,
    scheme: Scheme | str = Scheme.TRAPEZOIDAL,
) -> Simulator:
    """:func:`resume` where there is a file, else a new :class:`~numerics.contact.Simulator`."""
    if Path(path).exists():
        return resume(path, problem, grid, dt, scheme)
    return Simulator(problem, grid, dt, scheme)


@contextmanager
def saving(
    simulator: Simulator,
    path: Path | str,
    seconds: float = 10.0,
    latest: float = math.inf,
    progress: Progress | None = None,
) -> Iterator[Progress]:
    """Checkpoints at once, every so many seconds, and at the end, also one by a NumericsError.

    Not after an interrupt, which may fall between a step and its number: the last one stands.

    Parameters
    ----------
    simulator, path
        See :func:`save_checkpoint`.
    seconds
        Of the clock on the wall, between two checkpoints.
    latest
        There is no checkpoint after this time τ. A checkpoint does not hold the rows and snapshots
        that a run has kept; give the time they begin at, and a resumed run keeps them all.
    progress
        Called on, after every block.

    Yields
    ------
    Progress
        To be given to :func:`~numerics.simulation.follow`.

    Raises
    ------
    FileError
        As :func:`save_checkpoint`, before any work is done.
    InputError
        ``seconds`` negative.

    Examples
    --------
    >>> import tempfile
    >>> from numerics.simulation import follow
    >>> from numerics.drive import ramped_cosine
    >>> problem = RopeProblem(0.01, ramped_cosine(2.5, 0.05, 5))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rope.npz"
    ...     for until in 10.0, 20.0:
    ...         simulator = start_or_resume(path, problem, Grid(dx=0.02))
    ...         with saving(simulator, path) as progress:
    ...             run = follow(simulator, until, progress=progress)
    >>> simulator.time
    20.0
    """
    seconds, saved = non_negative("seconds", seconds), -math.inf

    def save() -> None:
        nonlocal saved
        if simulator.time <= latest:
            save_checkpoint(simulator, path)
        saved = time.monotonic()

    def block_done(done: int, total: int) -> None:
        if time.monotonic() - saved >= seconds:
            save()
        if progress is not None:
            progress(done, total)

    save()
    try:
        yield block_done
    except NumericsError:
        save()
        raise
    save()


def _content(simulator: Simulator) -> _Content:
    times = _sample_times(simulator)
    return {
        "specification": np.array(json.dumps(specification(simulator))),
        "version": np.array(release()),
        "step": np.array(simulator.step),
        "height": simulator.state.height,
        "velocity": simulator.state.velocity,
        "active": simulator.state.active,
        "ledger": simulator.ledger,
        "worst": np.array([simulator.unexplained, simulator.lowest, simulator.reaction]),
        "drive_times": times,
        "drive_heights": np.asarray(simulator.problem.drive.height(times), float),
    }


def _sample_times(simulator: Simulator) -> Array:
    """Of the present block, where Z matters to the next bit, and of the time gone by."""
    start = simulator.step - simulator.step % BLOCK
    block = simulator.dt * np.arange(start - 1, start + BLOCK + 1)
    return np.concatenate([np.maximum(block, 0.0), np.linspace(0.0, simulator.time, _PAST)])


def _read(path: Path) -> _Content:
    with np.load(io.BytesIO(read_sealed(path, KIND)), allow_pickle=False) as arrays:
        return dict(arrays)


def _check(path: Path, content: _Content, simulator: Simulator) -> None:
    """That the checkpoint is of the simulator's run."""
    found = json.loads(str(content["specification"]))
    what = differences(found, specification(simulator))
    if not what:
        times, there = content["drive_times"], content["drive_heights"]
        here = np.asarray(simulator.problem.drive.height(times), float)
        if here.shape != times.shape:
            what = "the drive does not give a height for each time of an array"
        else:
            apart = np.abs(here - there)
            same = apart <= _ROUNDINGS * np.finfo(float).eps * np.abs(there)
            if not same.all():
                worst = int(np.argmax(np.where(same, -1.0, np.nan_to_num(apart, nan=math.inf))))
                what = (
                    f"the drive {simulator.problem.drive.label!r} is another motion of the same "
                    f"name: Z({times[worst]:.6g}) = {there[worst]:.17g} there, "
                    f"{here[worst]:.17g} here"
                )
    if what:
        raise FileError(
            f"{path} is the checkpoint of another run: {what}. It is left as it is; ask for that "
            "run, choose another name, or move the file away"
        )
