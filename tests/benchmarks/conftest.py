"""Processor time beside wall time: under load the two differ, and wall medians even invert."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from typing import Any

import pytest

_LINES: list[str] = []


def processor_time() -> float:
    """User and system seconds of this process and of the children that have ended."""
    return time.process_time() + sum(os.times()[2:4])


@pytest.fixture(autouse=True)
def beside_wall_time(request: pytest.FixtureRequest) -> Iterator[None]:
    """Read the processor's clock wherever the benchmark reads that on the wall."""
    if "benchmark" not in request.fixturenames:
        yield
        return
    benchmark: Any = request.getfixturevalue("benchmark")
    readings: list[tuple[float, float]] = []
    wall = benchmark._timer

    def timer() -> float:
        now = float(wall())
        readings.append((now, processor_time()))
        return now

    benchmark._timer = timer
    yield
    if benchmark.stats is None or len(readings) < 2:
        return
    # Readings come in pairs, before and after a round; the last rounds are those that count.
    rounds = list(zip(readings[::2], readings[1::2], strict=False))[-benchmark.stats.stats.rounds :]
    spent = sum(after[1] - before[1] for before, after in rounds)
    passed = sum(after[0] - before[0] for before, after in rounds)
    mean = benchmark.stats.stats.mean
    benchmark.extra_info["processor seconds"] = mean * spent / passed
    _LINES.append(f"{request.node.name:60s} {1e3 * mean:12.3f} {1e3 * mean * spent / passed:12.3f}")
    for name, value in benchmark.extra_info.items():
        if name != "processor seconds":
            _LINES.append(
                f"    {name}: {value:.4g}" if isinstance(value, float) else f"    {name}: {value}"
            )


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print what was gathered."""
    if _LINES:
        terminalreporter.section("benchmarks: milliseconds a round, mean")
        terminalreporter.write_line(f"{'':60s} {'wall':>12s} {'processor':>12s}")
        for line in _LINES:
            terminalreporter.write_line(line)
