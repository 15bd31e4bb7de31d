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

import pytest

from numerics.errors import FileError, InputError
from numerics.sweep import square, sweep

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


@pytest.mark.parametrize("value", [(1, 2), math.nan])
def test_what_json_reads_back_otherwise_is_still_the_same_task(tmp_path: Path, value: Any) -> None:
    calls: list[Any] = []

    def work(task: dict[str, Any]) -> dict[str, Any]:
        calls.append(task)
        return {"y": 1}

    for _ in range(2):
        assert sweep(work, [{"x": value}], str(tmp_path)) == [{"y": 1}]
    assert len(calls) == 1


def test_bad_arguments() -> None:
    with pytest.raises(InputError, match="not JSON"):
        sweep(square, [{"x": {1}}])
    with pytest.raises(InputError, match=r"workers = 1\.5"):
        sweep(square, TASKS, workers=1.5)
    with pytest.raises(InputError, match="equal"):
        sweep(square, [{"x": 1}, {"x": 1}])
    with pytest.raises(InputError, match="workers = 0"):
        sweep(square, TASKS, workers=0)


def test_an_unwritable_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(FileError, match="another folder"):
        sweep(square, TASKS[:1], tmp_path / "file" / "folder")


SLOW = """
import sys, time
from pathlib import Path
from numerics.sweep import sweep

def slowly(task):
    time.sleep(0.2)
    return {"y": task["x"] ** 2}

if __name__ == "__main__":
    sweep(slowly, [{"x": x} for x in range(40)], Path(sys.argv[1]), workers=2)
"""


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
