"""Writing files whole: modes, links, faults, what killed processes leave, in both packages."""

from __future__ import annotations

import os
import random
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import asymptotics.atomic
import numerics.files.atomic

ROOT = Path(__file__).parents[1]


MODULES = [asymptotics.atomic, numerics.files.atomic]


@pytest.fixture(params=MODULES, ids=lambda module: module.__name__)
def atomic(request: pytest.FixtureRequest) -> ModuleType:
    module: ModuleType = request.param
    return module


@pytest.fixture
def umask() -> Iterator[None]:
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_both_packages_have_the_same() -> None:
    one, other = (Path(str(module.__file__)) for module in MODULES)
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize(("mask", "wanted"), [(0o077, 0o600), (0o002, 0o664), (0o022, 0o644)])
def test_new_files_have_the_mode_of_the_umask(
    atomic: ModuleType, mask: int, wanted: int, tmp_path: Path, umask: None
) -> None:
    os.umask(mask)
    atomic.replace_file(tmp_path / "new", b"1")
    assert mode(tmp_path / "new") == wanted


@pytest.mark.parametrize("kept", [0o600, 0o640, 0o664, 0o755])
def test_existing_files_keep_theirs(
    atomic: ModuleType, kept: int, tmp_path: Path, umask: None
) -> None:
    path = tmp_path / "old"
    path.write_bytes(b"1")
    path.chmod(kept)
    atomic.replace_file(path, b"22")
    assert (mode(path), path.read_bytes()) == (kept, b"22")


def test_links_are_followed_and_stay(atomic: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    target = tmp_path / "far" / "file"
    for name, to in (("relative", "far/file"), ("second", "relative"), ("absolute", str(target))):
        link = tmp_path / name
        link.symlink_to(to)
        atomic.replace_file(link, name.encode())
        assert os.readlink(link) == to
        assert target.read_bytes() == name.encode()
        target.unlink()  # the next link hangs, and is followed all the same
    assert list((tmp_path / "far").iterdir()) == []


def test_what_is_no_file_is_left(atomic: ModuleType, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    for name in ("pipe", "folder"):
        with pytest.raises(OSError, match="it is not an ordinary file"):
            atomic.replace_file(tmp_path / name, b"1")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    with pytest.raises(FileNotFoundError):
        atomic.replace_file(tmp_path / "none" / "file", b"1")
    assert {path.name for path in tmp_path.iterdir()} == {"pipe", "folder"}


@pytest.mark.parametrize("name", ["x" * 255, "Ω" * 127])
def test_names_as_long_as_they_may_be(atomic: ModuleType, name: str, tmp_path: Path) -> None:
    atomic.replace_file(tmp_path / name, b"1")
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("fault", ["fsync", "replace", "write"])
def test_a_fault_leaves_the_old_file_and_nothing_else(
    atomic: ModuleType, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    if fault == "write":
        resource = pytest.importorskip("resource")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
        try:
            with pytest.raises(OSError, match="File too large"):
                atomic.replace_file(path, bytes(5000))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            signal.signal(signal.SIGXFSZ, before)
    else:
        monkeypatch.setattr(os, fault, full)
        with pytest.raises(OSError, match="No space left"):
            atomic.replace_file(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_only_what_nobody_writes_is_swept(atomic: ModuleType, tmp_path: Path) -> None:
    dead = tmp_path / f".file.1234{atomic.UNFINISHED}"
    others = [tmp_path / name for name in (f"file{atomic.UNFINISHED}", ".file.part", ".file")]
    for path in (dead, *others):
        path.write_bytes(b"1")
    with atomic._unfinished(tmp_path / "file") as (part, _):
        atomic.sweep_unfinished(tmp_path)
        assert part.exists()
        assert not dead.exists()
    assert not part.exists()
    assert set(tmp_path.iterdir()) == set(others)
    atomic.sweep_unfinished(tmp_path / "none")


def test_swept_before_it_is_locked_it_is_made_again(
    atomic: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lock, calls = atomic._locked, []

    def late(handle: int) -> bool:
        calls.append(handle)
        if len(calls) == 1:  # another process sweeps just now
            [part] = tmp_path.iterdir()
            part.unlink()
        if len(calls) == 2:  # another is about to
            return False
        return bool(lock(handle))

    monkeypatch.setattr(atomic, "_locked", late)
    atomic.replace_file(tmp_path / "file", b"1")
    assert len(calls) == 3
    assert (tmp_path / "file").read_bytes() == b"1"


def test_without_locks_files_are_written_and_none_is_swept(
    atomic: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(_: int) -> bool:
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr(atomic, "_locked", none)
    left = tmp_path / f".other.1234{atomic.UNFINISHED}"
    left.write_bytes(b"1")
    atomic.replace_file(tmp_path / "file", b"1")
    atomic.sweep_unfinished(tmp_path)
    assert set(tmp_path.iterdir()) == {left, tmp_path / "file"}


WRITER = """
import sys
from pathlib import Path
from {module} import replace_file, sweep_unfinished

path = Path(sys.argv[1])
sweep_unfinished(path.parent)
print("begun", flush=True)
for number in range(10**9):
    replace_file(path, bytes([number % 256]) * 1_000_000)
"""


@pytest.mark.slow
def test_two_writers_are_killed_again_and_again(atomic: ModuleType, tmp_path: Path) -> None:
    """The file is always whole, and the next start removes what the last one left."""
    path, chance, left = tmp_path / "file", random.Random(5), 0
    code = WRITER.format(module=atomic.__name__)
    for kills in range(1, 200):
        writers = [
            subprocess.Popen(
                [sys.executable, "-c", code, str(path)],
                cwd=ROOT,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
            )
            for _ in range(2)
        ]
        for writer in writers:
            assert writer.stdout is not None
            assert writer.stdout.readline() == b"begun\n"
        time.sleep(chance.uniform(0.0, 0.05))
        for writer in writers:
            writer.kill()
            _, errors = writer.communicate()
            assert errors == b""
        if path.exists():
            content = path.read_bytes()
            assert content == content[:1] * 1_000_000
        parts = [found for found in tmp_path.iterdir() if found != path]
        assert len(parts) <= 2
        left += len(parts)
        if kills >= 6 and left:  # some of them did fall into a write
            break
    assert left > 0
    atomic.sweep_unfinished(tmp_path)
    assert list(tmp_path.iterdir()) == [path]
