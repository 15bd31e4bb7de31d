"""Compiled code is never older than its source."""

from __future__ import annotations

import hashlib
import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

import numerics
from derivations.progress import announce_compiling
from numerics.simulation import trapezoidal, verlet

FOLDER = Path(numerics.__file__).parent


@pytest.mark.parametrize("caller", [trapezoidal, verlet])
def test_a_change_of_the_observables_recompiles_who_calls_them(caller):
    digest = hashlib.sha256((FOLDER / "simulation" / "observables.py").read_bytes()).hexdigest()
    assert digest[:12] == caller._COMPILED_WITH, (
        f'in {caller.__name__} write _COMPILED_WITH = "{digest[:12]}"'
    )


def test_no_other_file_calls_compiled_code_of_another():
    compiled = [path for path in FOLDER.rglob("*.py") if "@njit" in path.read_text()]
    compiled.remove(FOLDER / "compiled.py")
    names = {path.stem for path in compiled}
    assert names == {"trapezoidal", "verlet", "observables", "kernels"}
    for path in compiled:
        imported = {name for name in names if f".{name} import" in path.read_text()}
        assert imported == ({"observables"} if path.stem in ("trapezoidal", "verlet") else set())


ONCE = """
import logging, sys, numba.core.caching
if sys.argv[1] == "nowhere":
    numba.core.caching.FunctionCache._impl_class._locator_classes = []
logging.basicConfig(format="%(message)s", level=logging.INFO)
import numpy as np
from numerics.simulation.observables import moving_size
print(moving_size(np.array([1.0, 0.0]), np.zeros(2), False))
"""


def said(where, tmp_path):
    """What a process says that needs a compiled function."""
    done = subprocess.run(
        [sys.executable, "-c", ONCE, where],
        cwd=FOLDER.parent,
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.stdout == "1\n", done.stderr
    return done.stderr


@pytest.mark.slow
def test_without_a_place_for_a_cache_it_is_compiled_all_the_same(tmp_path):
    """numba's own decorator ends with "cannot cache function"."""
    assert said("nowhere", tmp_path).startswith("compiling, as every time: set NUMBA_CACHE_DIR to")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_with_a_place_it_is_compiled_once(tmp_path):
    assert [said("there", tmp_path) for _ in range(2)] == ["compiling, once\n", ""]


def test_a_place_that_is_full_is_no_fault(monkeypatch, tmp_path):
    from numba.core.caching import IndexDataCacheFile

    from numerics.compiled import njit

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(IndexDataCacheFile, "save", full)
    assert njit(cache=True)(lambda x: 2 * x)(1.5) == 3.0
    assert njit(cache=False)(lambda x: 2 * x)(1.5) == 3.0


def test_a_command_says_once_that_it_compiles(capsys):
    logger = logging.getLogger("ropewave.numerics")
    announce_compiling(quiet=True)
    logger.info("compiling")
    assert capsys.readouterr().err == ""
    announce_compiling(quiet=False)
    logger.info("compiling")
    logger.info("compiling")
    assert capsys.readouterr().err == "compiling\n"
