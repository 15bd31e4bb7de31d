"""Committed artefacts are what the engine yields now."""

from __future__ import annotations

from pathlib import Path

import pytest

from derivations.app import main
from derivations.reports import catalogue
from derivations.reports.formats import write_files


def test_no_committed_artefact_differs() -> None:
    assert catalogue.differences() == []


def test_differences_are_found(tmp_path: Path) -> None:
    files = catalogue.artefacts()
    write_files(files, tmp_path)
    assert catalogue.differences(tmp_path) == []
    first, second, *_ = sorted(files)
    (tmp_path / first).write_text("changed", encoding="utf-8")
    (tmp_path / second).unlink()
    (tmp_path / "more.tex").write_text("left over", encoding="utf-8")
    assert catalogue.differences(tmp_path) == [
        f"missing: {second}",
        "left over: more.tex",
        f"different: {first}",
    ]


def test_check_fails_when_something_differs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["regenerate", "--check"])
    assert not caught.value.code
    monkeypatch.setattr(catalogue, "differences", lambda: ["different: x"])
    with pytest.raises(SystemExit) as caught:
        main(["regenerate", "--check"])
    assert caught.value.code == 1
    assert "different: x" in capsys.readouterr().err


def test_every_file_of_the_catalogue_exists() -> None:
    names = {Path(name).name for name in catalogue.artefacts()}
    for entry in catalogue.CATALOGUE:
        assert set(entry.files) <= names
