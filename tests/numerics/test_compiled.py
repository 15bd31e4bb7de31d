"""Compiled code is never older than its source."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

import numerics
from numerics import trapezoidal, verlet

FOLDER = Path(numerics.__file__).parent


@pytest.mark.parametrize("caller", [trapezoidal, verlet])
def test_a_change_of_the_observables_recompiles_who_calls_them(caller):
    digest = hashlib.sha256((FOLDER / "observables.py").read_bytes()).hexdigest()
    assert digest[:12] == caller._COMPILED_WITH, (
        f'in {caller.__name__} write _COMPILED_WITH = "{digest[:12]}"'
    )


def test_no_other_file_calls_compiled_code_of_another():
    compiled = [path for path in FOLDER.glob("*.py") if "import njit" in path.read_text()]
    names = {path.stem for path in compiled}
    assert names == {"trapezoidal", "verlet", "observables", "characteristics_kernels"}
    for path in compiled:
        imported = {name for name in names if f"from numerics.{name} import" in path.read_text()}
        assert imported == ({"observables"} if path.stem in ("trapezoidal", "verlet") else set())
