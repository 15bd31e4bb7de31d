"""Stop a simulation and go on later, bit for bit.

A checkpoint is a sealed npz file (:mod:`numerics.files.sealed`): the state, the ledger, the
specification of the run as JSON, and samples of Z(τ), for two drives may share a label. On the
same machine with the same packages a resumed simulator takes the very steps it would have taken.
"""

from __future__ import annotations

import io
import json
import math
import time
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from numerics.errors import FileError, NumericsError
from numerics.files.checkpoint_checks import impossible, misshapen, other_motion, sample_times
from numerics.files.sealed import (
    differences,
    is_there,
    not_written_here,
    read_sealed,
    release,
    specification,
    write_sealed,
)
from numerics.problems.drive import non_negative
from numerics.problems.problem import RopeProblem
from numerics.simulation.contact import Scheme, Simulator
from numerics.simulation.semi_discrete import Grid, State

KIND = "ropewave checkpoint, version 2"
"""To be changed with the format, or with what the integrators do to the last bit."""

_FIELDS = (
    "specification",
    "version",
    "step",
    "height",
    "velocity",
    "active",
    "ledger",
    "worst",
    "drive_times",
    "drive_heights",
)

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
    >>> from numerics.problems.drive import ramped_cosine
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
    if is_there(path):
        _check(path, _read(path), simulator)
    packed = io.BytesIO()
    np.savez(packed, **_content(simulator))
    write_sealed(path, KIND, packed.getvalue())


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
        The file is missing, damaged, truncated, no checkpoint, one of another run, or of no run
        at all: what differs is named. It is left as it is.
    InputError
        As the :class:`~numerics.simulation.contact.Simulator`.
    """
    path = Path(path)
    content = _read(path)
    simulator = Simulator(problem, grid, dt, scheme)
    _check(path, content, simulator)
    what = impossible(simulator, content)
    if what:
        raise not_written_here(path, KIND, what)
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
    """:func:`resume` where there is a file, else a new
    :class:`~numerics.simulation.contact.Simulator`.
    """
    if is_there(Path(path)):
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
        To be given to :func:`~numerics.simulation.run.follow`.

    Raises
    ------
    FileError
        As :func:`save_checkpoint`, before any work is done.
    InputError
        ``seconds`` negative.

    Examples
    --------
    >>> import tempfile
    >>> from numerics.simulation.run import follow
    >>> from numerics.problems.drive import ramped_cosine
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
    times = sample_times(simulator.step, simulator.dt)
    return {
        "specification": np.array(json.dumps(specification(simulator))),
        "version": np.array(release()),
        "step": np.array(simulator.step, np.int64),
        "height": simulator.state.height,
        "velocity": simulator.state.velocity,
        "active": simulator.state.active,
        "ledger": simulator.ledger,
        "worst": np.array([simulator.unexplained, simulator.lowest, simulator.reaction]),
        "drive_times": times,
        "drive_heights": np.asarray(simulator.problem.drive.height(times), float),
    }


def _read(path: Path) -> _Content:
    """The arrays of a checkpoint; only that they are there is checked."""
    raw = io.BytesIO(read_sealed(path, KIND))
    try:
        with zipfile.ZipFile(raw) as archive:
            members = {member.filename: member for member in archive.infolist()}
            if set(members) != {f"{name}.npy" for name in _FIELDS}:
                raise ValueError(f"it holds {sorted(members)}")
            if any(member.compress_type != zipfile.ZIP_STORED for member in members.values()):
                raise ValueError("its arrays are compressed")
        with np.load(raw, allow_pickle=False) as arrays:
            content = {name: arrays[name] for name in _FIELDS}
        content["specification"] = json.loads(str(content["specification"]))
        if not isinstance(content["specification"], dict):
            raise ValueError("its specification is no object")
    except Exception as error:  # of zipfile and NumPy, in bytes that are not theirs: any
        raise not_written_here(path, KIND, error) from error
    return content


def _check(path: Path, content: _Content, simulator: Simulator) -> None:
    """That the checkpoint is of the simulator's run."""
    what = differences(content["specification"], specification(simulator))
    if not what:
        broken = misshapen(simulator, content)
        if broken:
            raise not_written_here(path, KIND, broken)
        what = other_motion(simulator, content)
    if what:
        raise FileError(
            f"{path} is the checkpoint of another run: {what}. It is left as it is; ask for that "
            "run, choose another name, or move the file away"
        )
