"""Sweeps: order, parallel work, resuming after kill −9, refusal of damaged and foreign files."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from numerics.errors import FileError, InputError
from numerics.files.atomic import UNFINISHED
from numerics.sweeps.sweep import square, sweep

TASKS = [{"x": x} for x in range(5)]


class Counter:
    """square, counting its calls."""

    def __init__(self) -> None:
        self.calls: list[int] = []

    def __call__(self, task: dict[str, Any]) -> dict[str, Any]:
        self.calls.append(task["x"])
        return square(task)


def test_parallel_equals_serial_in_order() -> None:
    expected = [{"y": x * x} for x in range(5)]
    seen: list[tuple[int, int]] = []
    assert sweep(square, TASKS) == expected
    assert sweep(square, TASKS, workers=2, progress=lambda *at: seen.append(at)) == expected
    assert seen == [(done, 5) for done in range(6)]


def test_nothing_is_computed_twice(tmp_path: Path) -> None:
    first, second = Counter(), Counter()
    sweep(first, TASKS[:3], tmp_path, "squares")
    assert sweep(second, TASKS, tmp_path, "squares") == [{"y": x * x} for x in range(5)]
    assert first.calls == [0, 1, 2]
    assert second.calls == [3, 4]


def test_a_failure_keeps_what_was_there(tmp_path: Path) -> None:
    def fail(task: dict[str, Any]) -> dict[str, Any]:
        if task["x"] == 3:
            raise ZeroDivisionError
        return square(task)

    with pytest.raises(ZeroDivisionError):
        sweep(fail, TASKS, tmp_path)
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize("harm", ["truncate", "change", "empty"])
def test_damaged_files_are_refused_and_left_alone(tmp_path: Path, harm: str) -> None:
    sweep(square, TASKS[:1], tmp_path)
    (path,) = tmp_path.iterdir()
    text = path.read_text()
    content = json.loads(text)
    content["result"]["y"] = 17
    path.write_text({"truncate": text[:-9], "change": json.dumps(content), "empty": ""}[harm])
    before = path.read_bytes()
    with pytest.raises(FileError, match="Delete it"):
        sweep(square, TASKS, tmp_path)
    assert path.read_bytes() == before


def test_another_specification_is_refused(tmp_path: Path) -> None:
    sweep(square, TASKS[:1], tmp_path, "dx = 0.01")
    with pytest.raises(FileError, match=r"dx = 0\.01.*another folder"):
        sweep(square, TASKS[:1], tmp_path, "dx = 0.02")


def test_what_json_reads_back_otherwise_is_still_the_same_task(tmp_path: Path) -> None:
    calls: list[Any] = []

    def work(task: dict[str, Any]) -> dict[str, Any]:
        calls.append(task)
        return {"y": 1}

    for _ in range(2):
        assert sweep(work, [{"x": (1, 2)}], str(tmp_path)) == [{"y": 1}]
    assert len(calls) == 1


def test_bad_arguments() -> None:
    with pytest.raises(InputError, match="not JSON"):
        sweep(square, [{"x": {1}}])
    with pytest.raises(InputError, match=r"nan.* is not JSON"):
        sweep(square, [{"x": math.nan}])
    with pytest.raises(InputError, match=r"workers = 1\.5"):
        sweep(square, TASKS, workers=1.5)
    with pytest.raises(InputError, match="equal"):
        sweep(square, [{"x": 1}, {"x": 1}])
    with pytest.raises(InputError, match="workers = 0"):
        sweep(square, TASKS, workers=0)


def of_numpy(task: dict[str, Any]) -> dict[str, Any]:
    return {
        "f8": np.float64(task["x"]), "f4": np.float32(0.5), "i": np.int64(task["x"]),
        "b": np.bool_(True), "many": (np.int8(1), 2.0),
    }  # fmt: skip


def test_numpy_scalars_are_numbers(tmp_path: Path) -> None:
    """In tasks and results; a resumed sweep returns what the first one did."""
    task = {"x": np.int64(3)}
    first = sweep(of_numpy, [task], tmp_path)
    assert repr(first) == repr(sweep(of_numpy, [{"x": 3}], tmp_path))
    assert repr(first[0]) == "{'f8': 3.0, 'f4': 0.5, 'i': 3, 'b': True, 'many': [1, 2.0]}"
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    "value",
    [np.zeros(2), np.complex128(1j), {1}, object(), math.nan, [-math.inf], np.float32("nan")],
)
def test_other_results_are_one_clear_error(value: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is not JSON .*give plain finite numbers and words"):
        sweep(lambda _: {"y": value}, TASKS[:1], tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_result_that_could_not_be_read_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("numerics.sweeps.sweep.LARGEST_JSON", 300)
    with pytest.raises(InputError, match=r"takes \d+ bytes of JSON, more than 300"):
        sweep(lambda _: {"y": "x" * 300}, TASKS[:1], tmp_path)


def test_deeply_nested_results(tmp_path: Path) -> None:
    deep: list[Any] = []
    for _ in range(5000):
        deep = [deep]
    with pytest.raises(InputError, match="is not JSON"):
        sweep(lambda _: {"y": deep}, TASKS[:1], tmp_path)


MAIN = """
from numerics.sweeps.sweep import square, sweep
from numerics.errors import NumericsError

def mine(task):
    return square(task)

{call}
"""
CALL = """
try:
    print(sweep({work}, [{{"x": 1}}, {{"x": 2}}], workers=2))
except NumericsError as error:
    print(type(error).__name__, error)
"""
GUARDED = "if __name__ == '__main__':\n" + CALL.replace("\n", "\n    ")


@pytest.mark.parametrize(
    ("how", "call", "message"),
    [
        ("-", CALL.format(work="mine"), "InputError workers are processes of their own, and the "
         "main program, '<stdin>', is no file that they can import"),
        ("-", CALL.format(work="square"), "InputError workers are processes of their own, and the "
         "main program, '<stdin>', is no file"),
        ("-c", CALL.format(work="mine"), "InputError workers are processes of their own, and the "
         "work is defined in a session"),
        ("-c", CALL.format(work="square"), "[{'y': 1}, {'y': 4}]"),
        ("file", CALL.format(work="mine"), "WorkerError a process of the sweep ended before"),
        ("file", GUARDED.format(work="mine"), "[{'y': 1}, {'y': 4}]"),
        ("file", GUARDED.format(work="lambda task: task"), "InputError workers are processes of "
         "their own, and the work cannot be sent to them"),
    ],
)  # fmt: skip
def test_work_that_other_processes_cannot_import(
    how: str, call: str, message: str, tmp_path: Path
) -> None:
    code, script = MAIN.format(call=call), tmp_path / "script.py"
    script.write_text(code, encoding="utf-8")
    arguments = {"-": ["-"], "-c": ["-c", code], "file": [str(script)]}[how]
    done = subprocess.run(
        [sys.executable, *arguments],
        input=code if how == "-" else "",
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.stdout.startswith(message), done.stderr
    if not message.startswith("WorkerError"):
        assert done.stderr == ""


def test_a_start_sweeps_what_a_killed_one_left(tmp_path: Path) -> None:
    sweep(square, TASKS, tmp_path)
    left = tmp_path / f".more.12{UNFINISHED}"
    left.write_bytes(b"half")
    sweep(square, TASKS, tmp_path)
    assert len(list(tmp_path.iterdir())) == 5


def test_an_unwritable_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(FileError, match="another folder"):
        sweep(square, TASKS[:1], tmp_path / "file" / "folder")


SLOW = """
import sys, time
from pathlib import Path
from numerics.sweeps.sweep import sweep

def slowly(task):
    time.sleep(0.2)
    return {"y": task["x"] ** 2}

if __name__ == "__main__":
    sweep(slowly, [{"x": x} for x in range(40)], Path(sys.argv[1]), workers=2)
"""


@pytest.mark.slow
def test_killed_sweeps_resume_and_leave_no_workers(tmp_path: Path) -> None:
    script, folder = tmp_path / "slow.py", tmp_path / "results"
    script.write_text(SLOW)
    process = subprocess.Popen([sys.executable, str(script), str(folder)])
    while len(list(folder.glob("*.json"))) < 2:
        assert process.poll() is None
        time.sleep(0.02)
    workers = _children(process.pid)
    assert workers
    process.send_signal(signal.SIGKILL)
    process.wait()
    found = len(list(folder.glob("*.json")))
    assert 2 <= found < 40
    second = Counter()
    assert sweep(second, [{"x": x} for x in range(40)], folder)[7] == {"y": 49}
    assert len(second.calls) == 40 - found
    for _ in range(100):
        if not any(_alive(worker) for worker in workers):
            break
        time.sleep(0.1)
    assert not any(_alive(worker) for worker in workers)


def _children(parent: int) -> list[int]:
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == parent:
            found.append(int(path.parent.name))
    return found


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
        state = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"
