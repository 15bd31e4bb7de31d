"""Checkpoints: resumed runs are the straight ones to the last bit, and no file is ever half."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from numerics.errors import FileError, InputError
from numerics.files.checkpoint import KIND, resume, save_checkpoint, saving, start_or_resume
from numerics.problems.drive import Drive, at_rest, cosine, ramped_cosine
from numerics.problems.problem import DrivenEnd, RopeProblem
from numerics.simulation.contact import BLOCK, Scheme, Simulator
from numerics.simulation.observables import Column
from numerics.simulation.run import follow
from numerics.simulation.semi_discrete import Grid

STEPS = 2000
CASES = {
    "trapezoidal": (RopeProblem(0.01, cosine(3.5, 0.5)), Grid(0.02), None, Scheme.TRAPEZOIDAL),
    "trapezoidal, rebound": (
        RopeProblem(0.01, cosine(3.5, 0.5), DrivenEnd.CLAMPED, 0.01, 0.5),
        Grid(0.02),
        0.03,
        Scheme.TRAPEZOIDAL,
    ),
    "verlet": (RopeProblem(0.04, cosine(3.5, 0.5)), Grid(0.05), None, Scheme.VERLET),
    "verlet, rebound": (
        RopeProblem(0.0, cosine(3.5, 0.5), damping=0.01, restitution=0.5),
        Grid(0.02),
        None,
        Scheme.VERLET,
    ),
}
SMALL = RopeProblem(0.04, ramped_cosine(2.5, 0.05, 2), damping=0.01)
COARSE = Grid(0.05)


def advance(simulator: Simulator, step: int) -> np.ndarray:
    return np.concatenate([b.rows for b in simulator.blocks((step - 0.5) * simulator.dt)])


def bits(simulator: Simulator) -> list[Any]:
    arrays = *simulator.state, simulator.ledger
    worst = simulator.unexplained, simulator.lowest, simulator.reaction
    return [
        simulator.step,
        *(value.hex() for value in worst),
        *(part.tobytes() for part in arrays),
    ]


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    path = tmp_path / "rope.npz"
    simulator = Simulator(SMALL, COARSE)
    advance(simulator, 30)
    save_checkpoint(simulator, path)
    return path


@pytest.fixture
def kept(saved: Path) -> Iterator[Path]:
    """The file of ``saved``, which must be the same afterwards, and alone."""
    before = saved.read_bytes()
    yield saved
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_resumed_run_is_the_straight_run_bit_for_bit(name: str, tmp_path: Path) -> None:
    straight = Simulator(*CASES[name])
    rows = advance(straight, STEPS)
    # Waves lie on the ground at every cut, or the test would show little.
    assert (rows[[776, BLOCK - 2, BLOCK - 1, BLOCK], Column.BUMP] > 0.05).all()
    assert np.ptp(rows[:, Column.LOST]) > 1
    for cut in 777, BLOCK - 1, BLOCK, BLOCK + 1:
        first = Simulator(*CASES[name])
        parts = [advance(first, cut)]
        path = tmp_path / f"{cut}.npz"
        save_checkpoint(first, path)
        second = resume(path, *CASES[name])
        assert bits(second) == bits(first)
        parts.append(advance(second, STEPS))
        assert np.concatenate(parts).tobytes() == rows.tobytes()
        assert bits(second) == bits(straight)


def test_a_checkpoint_before_the_first_step(tmp_path: Path) -> None:
    straight, path = Simulator(SMALL, COARSE), tmp_path / "rope.npz"
    save_checkpoint(straight, path)
    resumed = resume(path, SMALL, COARSE)
    assert advance(resumed, 40).tobytes() == advance(straight, 40).tobytes()


def test_equal_runs_give_equal_bytes_that_numpy_reads(saved: Path) -> None:
    before = saved.read_bytes()
    save_checkpoint(resume(saved, SMALL, COARSE), saved)
    assert saved.read_bytes() == before
    with np.load(saved, allow_pickle=False) as arrays:
        assert int(arrays["step"]) == 30


def test_any_changed_byte_is_noticed(kept: Path) -> None:
    raw = kept.read_bytes()
    places = [*range(0, len(raw), 199), *range(len(raw) - 120, len(raw))]
    assert len(places) > 200
    for place in places:
        kept.write_bytes(raw[:place] + bytes([raw[place] ^ 4]) + raw[place + 1 :])
        with pytest.raises(FileError, match=r"damaged|is not a .* or it is truncated"):
            resume(kept, SMALL, COARSE)
    kept.write_bytes(raw)


@pytest.mark.parametrize("length", [0, 1, 50, 150, 5000, -1])
def test_truncated_files_are_refused(length: int, saved: Path) -> None:
    saved.write_bytes(saved.read_bytes()[:length])
    before = saved.read_bytes()
    for attempt in (
        lambda: start_or_resume(saved, SMALL, COARSE),
        lambda: save_checkpoint(Simulator(SMALL, COARSE), saved),
        lambda: saving(Simulator(SMALL, COARSE), saved).__enter__(),
    ):
        with pytest.raises(FileError, match=r"truncated.*left as it is; move it away"):
            attempt()
    assert saved.read_bytes() == before


def test_foreign_and_missing_files_are_refused(tmp_path: Path) -> None:
    for content in b"notes", b"\nropewave run, version 1, sha256 " + b"0" * 64 + b"\n":
        path = tmp_path / "notes.txt"
        path.write_bytes(content)
        with pytest.raises(FileError, match=f"is not a {KIND}"):
            save_checkpoint(Simulator(SMALL, COARSE), path)
        assert path.read_bytes() == content
    with pytest.raises(FileError, match=r"cannot read .*No such file"):
        resume(tmp_path / "none.npz", SMALL, COARSE)
    with pytest.raises(FileError, match=r"cannot write .*No such file"):
        save_checkpoint(Simulator(SMALL, COARSE), tmp_path / "none" / "rope.npz")


OTHERS = {
    "beta = 0.04 there, 0.05 here": (replace(SMALL, beta=0.05), COARSE),
    "driven_end = 'pinned' there, 'clamped'": (replace(SMALL, driven_end="clamped"), COARSE),
    "damping = 0.01 there, 0.0 here": (replace(SMALL, damping=0.0), COARSE),
    "restitution = 0.0 there, 0.1": (replace(SMALL, restitution=0.1), COARSE),
    "drive = 'ramped cosine 2.5 0.05 2.0' there, 'rest 1.0' here; omega = 2.5 there, None": (
        replace(SMALL, drive=at_rest()),
        COARSE,
    ),
    "dx = 0.05 there, 0.04 here; dt = 0.05 there, 0.04": (SMALL, Grid(0.04)),
    "length = 8.0 there, 9.0": (SMALL, Grid(0.05, length=9)),
    "sponge = 3.0 there, 2.0": (SMALL, Grid(0.05, sponge=2)),
    "strength = 10.0 there, 4.0": (SMALL, Grid(0.05, strength=4)),
    "dt = 0.05 there, 0.04": (SMALL, COARSE, 0.04),
    "scheme = 'trapezoidal' there, 'verlet'": (SMALL, COARSE, None, "verlet"),
}


@pytest.mark.parametrize("difference", OTHERS)
def test_another_run_is_refused_and_the_difference_named(difference: str, kept: Path) -> None:
    other = OTHERS[difference]
    with pytest.raises(FileError, match="the checkpoint of another run") as caught:
        resume(kept, *other)
    assert difference in str(caught.value)
    with pytest.raises(FileError, match="the checkpoint of another run"):
        save_checkpoint(Simulator(*other), kept)


@pytest.mark.parametrize("change", [1e-12, np.nan])
def test_another_motion_of_the_same_name_is_refused(change: float, kept: Path) -> None:
    drive = SMALL.drive

    def height(t: np.ndarray) -> np.ndarray:
        return drive.height(t) + np.where(np.abs(t - 1.4) < 0.3, change, 0.0)

    other = replace(SMALL, drive=Drive(height, drive.slope, drive.label, drive.omega))
    for attempt in (
        lambda: resume(kept, other, COARSE),
        lambda: save_checkpoint(Simulator(other, COARSE), kept),
    ):
        with pytest.raises(FileError, match=r"another motion of the same name: Z\(1\.[1-7]"):
            attempt()


def test_a_drive_that_rounds_elsewhere_is_the_same(kept: Path) -> None:
    drive = SMALL.drive
    other = Drive(lambda t: drive.height(t) * (1 + 2.0**-52), drive.slope, drive.label, drive.omega)
    assert resume(kept, replace(SMALL, drive=other), COARSE).step == 30


KILLER = """
import os, random, signal, sys, time
from pathlib import Path
import numpy as np
from tests.numerics.test_checkpoint import COARSE, SMALL, advance, bits
from numerics.files.checkpoint import resume, save_checkpoint
from numerics.simulation.contact import Simulator

path = Path(sys.argv[1])
random.seed(1)
straight = Simulator(SMALL, COARSE)
advance(Simulator(SMALL, COARSE), 1)  # compiled before the clock starts
save_checkpoint(straight, path)
steps, interrupted = [], 0
# At least 40 kills, and on a busy machine as many as it takes to interrupt some writing.
for kills in range(1, 2000):
    child = os.fork()
    if child == 0:
        simulator = resume(path, SMALL, COARSE)
        while True:
            advance(simulator, simulator.step + 1)
            save_checkpoint(simulator, path)
    time.sleep(random.uniform(0.0, 0.06))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    steps.append(resume(path, SMALL, COARSE).step)
    interrupted += len(list(path.parent.glob(".*")))
    if kills >= 40 and steps[-1] > 20 and interrupted:
        break
advance(straight, steps[-1])
assert bits(straight) == bits(resume(path, SMALL, COARSE))
save_checkpoint(straight, path)
assert list(path.parent.iterdir()) == [path]
print(steps[-1], steps == sorted(steps), interrupted)
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork and SIGKILL")
def test_killed_while_writing_the_file_is_whole(tmp_path: Path) -> None:
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", KILLER, str(tmp_path / "rope.npz")],
        cwd=root,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(root), *sys.path])},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    last, ordered, interrupted = done.stdout.split()
    assert ordered == "True"
    # Work was done between the kills, and some of them did fall into a write.
    assert int(last) > 20
    assert int(interrupted) > 0


def test_saving_as_it_goes_and_at_the_end(tmp_path: Path) -> None:
    path, seen, times = tmp_path / "rope.npz", [], []

    def look(done: int, total: int) -> None:
        seen.append((done, total))
        times.append(resume(path, SMALL, COARSE).step)

    simulator = start_or_resume(path, SMALL, COARSE)
    with saving(simulator, path, seconds=0.0, progress=look) as progress:
        follow(simulator, 10.0, snapshots=2.0, progress=progress)
    assert seen == [(n, 200) for n in (40, 80, 120, 160, 200)]
    assert times == [40, 80, 120, 160, 200]
    simulator = start_or_resume(path, SMALL, COARSE)
    assert simulator.step == 200
    with saving(simulator, path, seconds=1e6, progress=look) as progress:
        follow(simulator, 14.0, snapshots=2.0, progress=progress)
    assert times[5:] == [200, 200]
    assert resume(path, SMALL, COARSE).step == 280


def test_what_is_kept_from_a_time_on_is_kept_whole_by_a_resumed_run(tmp_path: Path) -> None:
    path, runs = tmp_path / "rope.npz", []
    for _ in range(2):
        simulator = start_or_resume(path, SMALL, COARSE)
        with saving(simulator, path, seconds=0.0, latest=8.0) as progress:
            runs.append(follow(simulator, 10.0, 8.0, 0.5, progress))
        assert resume(path, SMALL, COARSE).time == 8.0
    assert runs[0].times[0] == 8.0
    assert runs[1].times.tobytes() == runs[0].times[1:].tobytes()
    assert runs[1].rows.tobytes() == runs[0].rows[1:].tobytes()
    assert runs[1].heights.tobytes() == runs[0].heights[-5:].tobytes()


@pytest.mark.parametrize(("error", "step"), [(InputError, 80), (KeyboardInterrupt, 40)])
def test_saving_when_a_run_breaks_off(error: type, step: int, tmp_path: Path) -> None:
    path = tmp_path / "rope.npz"
    simulator = Simulator(SMALL, COARSE)
    advance(simulator, 40)

    def run() -> None:
        with saving(simulator, path, seconds=1e6) as progress:
            follow(simulator, 4.0, progress=progress)
            raise error

    with pytest.raises(error):
        run()
    assert simulator.step == 80
    assert resume(path, SMALL, COARSE).step == step
