"""Compiled code is never older than its source."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

import numerics
from derivations.progress import announce_compiling

FOLDER = Path(numerics.__file__).parent


CALLER = """
from numerics.compiled import njit
from callee import inner

@njit()
def outer(x):
    return inner(x) + 1.0

print(outer(1.0), len(outer.stats.cache_hits))
"""
CALLEE = """
from numerics.compiled import njit

@njit()
def inner(x):
    return {factor} * x
"""


def test_a_change_of_what_is_called_recompiles_the_caller(tmp_path: Path) -> None:
    """numba alone would use the old callee, which is compiled into the caller's code."""
    (tmp_path / "caller.py").write_text(CALLER)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    environment["PYTHONPATH"] = os.pathsep.join([str(FOLDER.parent), str(tmp_path)])
    said = []
    for factor in (2.0, 2.0, 5.0, 2.0):
        (tmp_path / "callee.py").write_text(CALLEE.format(factor=factor))
        done = subprocess.run(
            [sys.executable, "-B", "-c", "import caller"],
            capture_output=True,
            text=True,
            env=environment,
            cwd=tmp_path,
            check=True,
        )
        said.append(done.stdout.split())
    assert [x for x, _ in said] == ["3.0", "3.0", "6.0", "3.0"]
    assert [hits for _, hits in said][:3] == ["0", "1", "0"]


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
