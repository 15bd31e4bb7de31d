"""The face: every public name is there, lives where it says, and costs nothing until it is used."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import ropewave as rw

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("name", rw.HOMES)
def test_every_name_is_its_home_s(name: str) -> None:
    assert getattr(rw, name) is getattr(import_module(rw.HOMES[name]), name)
    assert name in dir(rw)


def test_the_version_is_the_distribution_s() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{rw.__version__}"' in text


def test_an_unknown_name_says_which_there_are() -> None:
    with pytest.raises(AttributeError, match=r"there are .*moving_contact"):
        _ = rw.resonnances


def test_importing_it_imports_nothing() -> None:
    program = "import sys; import ropewave; print(sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    loaded = done.stdout
    for heavy in ("numpy", "sympy", "flint", "asymptotics", "numerics", "numba"):
        assert f"'{heavy}'" not in loaded
