"""How long a command takes to start, against ``import numpy`` alone.

Each row's ``processor seconds`` stand in its extra info: under load wall times mean little.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys

import pytest

APP = ("-m", "derivations.app")
POINT = ("--omega", "1.1", "--epsilon", "0.01")
ROUNDS = 7


def processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@pytest.mark.benchmark(group="start-up")
@pytest.mark.parametrize(
    "arguments",
    [
        ("-c", "import numpy"),
        ("-c", "from matplotlib.figure import Figure"),
        (*APP, "--help"),
        (*APP, "simulate", "--help"),
        (*APP, "evaluate", *POINT),
        (*APP, "derive"),
        (*APP, "derive", "--plot", "rope.png"),
    ],
    ids=lambda arguments: " ".join(arguments[1:]).replace("derivations.app", "ropewave"),
)
def test_start_up(benchmark, arguments, tmp_path):  # type: ignore[no-untyped-def]
    environment = {**os.environ, "ROPEWAVE_CACHE": str(tmp_path)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def run() -> None:
        subprocess.run(
            [sys.executable, *arguments],
            check=True,
            capture_output=True,
            env=environment,
            cwd=tmp_path,
        )

    run()  # compiles modules, fills caches
    before = processor_time()
    benchmark.pedantic(run, rounds=ROUNDS, warmup_rounds=0)
    benchmark.extra_info["processor seconds"] = round((processor_time() - before) / ROUNDS, 3)
