"""Where commands write: refused before the work, and results that no full disk takes away."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import platformdirs
import pytest

from asymptotics.atomic import UNFINISHED
from asymptotics.errors import UnwritableError
from asymptotics.expansion import storage
from derivations.app import main
from derivations.cache import cache_folder
from derivations.figure2 import data as figure2
from derivations.figures import plots
from derivations.files import check_folder, check_writable, write_file
from derivations.reports import folds as fold_report
from derivations.reports import resonances as resonance_report
from derivations.reports import tongues as tongue_report
from derivations.reports import watched_run as simulation_run

# Imported here, so that none of them meets the stand-ins below and keeps them.
LATER = (fold_report, plots, tongue_report)
MISSING = Path("/no folder of this name")
SIMULATE = ("simulate", "--omega", "2.5", "--epsilon", "0.05", "--ramp", "2", "--periods", "3")


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(list(arguments))
    return int(caught.value.code or 0)


def test_missing_folders_are_made_when_written_not_when_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "one" / "two" / "file"
    check_writable(path)
    check_folder(path)
    assert list(tmp_path.iterdir()) == []
    write_file(path, b"1")
    write_file(path, b"2")
    assert path.read_bytes() == b"2"
    left = path.parent / f".of a killed command{UNFINISHED}"
    left.write_bytes(b"")
    write_file(path, b"3")
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("check", [check_writable, check_folder, lambda p: write_file(p, b"1")])
def test_no_folder_is_made_in_the_root_but_by_its_owner(
    check: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(UnwritableError, match=f"cannot write .*: no folder {MISSING}"):
        check(MISSING / "deeper" / "file.png")
    assert not MISSING.exists()
    monkeypatch.chdir("/")
    check_folder(Path("relative"))  # where one stands, folders are one's own


def test_what_is_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    for check in (check_writable, check_folder):
        with pytest.raises(UnwritableError, match=r"cannot write .*file/file2: Not a directory"):
            check(tmp_path / "file" / "file2")
    with pytest.raises(UnwritableError, match="it is not an ordinary file"):
        check_writable(tmp_path)
    with pytest.raises(UnwritableError, match="File name too long"):
        check_writable(tmp_path / ("x" * 300))


COMMANDS = {
    "figure2 --out": ("figure2", "--coarse", "--out", "{}.png"),
    "figure2 --collect": ("figure2", "--coarse", "--out", "{0}/a.png", "--collect", "{1}/b.json"),
    "figure2 --tables": ("figure2", "--coarse", "--out", "{0}/a.png", "--tables", "{1}/b.md"),
    "simulate --out": (*SIMULATE, "--out", "{}.nc"),
    "simulate --plot": (*SIMULATE, "--plot", "{}.png"),
    "simulate --animate": (*SIMULATE, "--animate", "{}.gif"),
    "derive --out": ("derive", "--order", "2", "--out", "{}"),
    "derive --plot": ("derive", "--order", "2", "--plot", "{}.svg"),
    "evaluate --plot": ("evaluate", "--omega", "0.8", "--epsilon", "0.1", "--plot", "{}.png"),
    "resonances --plot": ("resonances", "--plot", "{}.png"),
    "resonances --latex": ("resonances", "--latex", "{}.tex"),
    "tongue --latex": ("tongue", "1/2", "--latex", "{}.tex"),
    "tongue --plot": ("tongue", "1/2", "--plot", "{}.png"),
    "fold --latex": ("fold", "1/2", "--latex", "{}.tex"),
    "fold --plot": ("fold", "1/2", "--plot", "{}.png"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_files_that_cannot_be_written_are_refused_before_the_work(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import asymptotics.expansion.order_loop
    import asymptotics.resonances.folds
    import asymptotics.resonances.tongues
    import asymptotics.values.evaluate

    def work(*_: object, **__: object) -> None:
        raise AssertionError("work was done")

    for module, function in (
        (figure2, "compute"),
        (simulation_run, "watch"),
        (storage, "saved_expansion"),
        (asymptotics.values.evaluate, "evaluate"),
        (asymptotics.resonances.tongues, "tongue"),
        (asymptotics.resonances.folds, "fold"),
        (resonance_report, "resonance_table"),
    ):
        monkeypatch.setattr(module, function, work)
    arguments = [part.format(tmp_path, MISSING) for part in COMMANDS[name]]
    if "{1}" not in "".join(COMMANDS[name]):
        arguments = [part.format(MISSING / "deeper") for part in COMMANDS[name]]
    assert run(*arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(f"ropewave: error: cannot write {MISSING}")
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
    assert not MISSING.exists()


@pytest.fixture
def no_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user whose cache folder cannot be made."""
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.delenv("ROPEWAVE_CACHE", raising=False)
    home = tmp_path / "file" / "cache"
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda _: home)
    return home


def test_without_the_users_cache_it_goes_on(
    no_place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("derive", "--order", "2", "--json") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["order"] == 2
    assert captured.err.startswith(f"ropewave: warning: cannot write {no_place}")
    assert "set ROPEWAVE_CACHE" in captured.err
    assert captured.err.count("\n") == 1
    assert cache_folder("figure2") is None
    # What was asked for by name is an error.
    monkeypatch.setenv("ROPEWAVE_CACHE", str(no_place))
    assert cache_folder("figure2") == no_place / "figure2"
    assert run("derive", "--order", "2", "--json") == 2
    assert "set ROPEWAVE_CACHE" in capsys.readouterr().err


def test_a_full_disk_takes_the_users_cache_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(path: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(storage, "replace_file", full)
    monkeypatch.delenv("ROPEWAVE_CACHE", raising=False)
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda _: tmp_path)
    assert run("derive", "--order", "3", "--json") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["order"] == 3
    assert "No space left on device" in captured.err
    monkeypatch.setenv("ROPEWAVE_CACHE", str(tmp_path))
    assert run("derive", "--order", "3", "--json") == 2


def test_a_full_disk_takes_no_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    out = tmp_path / "run.nc"
    assert run(*SIMULATE, "--dx", "0.025", "--json", "--out", str(out)) == 2
    captured = capsys.readouterr()
    assert json.loads(captured.out)["verdict"] == "follows"
    assert f"cannot write {out}: No space left on device" in captured.err
    assert list(tmp_path.iterdir()) == []


def test_a_start_sweeps_what_a_killed_one_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROPEWAVE_CACHE", str(tmp_path))
    assert run("derive", "--order", "2") == 0
    left = tmp_path / "string" / f".order-0009.json.gz.12{UNFINISHED}"
    left.write_bytes(b"half")
    assert run("derive", "--order", "2") == 0  # nothing is written
    assert not left.exists()


def test_links_that_go_in_circles_are_one_clear_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.nc").symlink_to("b.nc")
    (tmp_path / "b.nc").symlink_to("a.nc")
    for option in ("--out", "--checkpoint"):
        assert run(*SIMULATE, "--dx", "0.025", option, str(tmp_path / "a.nc")) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert "Too many levels of symbolic links" in captured.err


def test_links_that_hang_are_followed(tmp_path: Path) -> None:
    for option, name in (("--out", "run.nc"), ("--checkpoint", "state.npz")):
        (tmp_path / f"link {name}").symlink_to(name)
        assert run(*SIMULATE, "--dx", "0.025", option, str(tmp_path / f"link {name}")) == 0
        assert (tmp_path / name).is_file()
        assert (tmp_path / f"link {name}").is_symlink()
