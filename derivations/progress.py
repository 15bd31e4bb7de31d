"""Progress of long work on standard error, silent for work that is over in a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from derivations.output import note

PATIENCE = 1.0
"""Seconds before anything is shown."""

QUIET_PATIENCE = 15.0
"""The same where only a program reads on: standard error is for people all the same."""

LINE_EVERY = 5.0
"""Seconds between two lines of work with many small steps."""

ANNOUNCED = 30.0
"""Seconds of work that are announced before they begin."""


@contextmanager
def progress(
    title: str, total: int, quiet: bool = False, fine: bool = False
) -> Iterator[Callable[..., None]]:
    """A function to call with the number of steps done, out of ``total``, and perhaps a word on it.

    On a terminal it moves a bar; elsewhere it writes a line a step, so that logs stay readable.
    ``quiet`` (for machine-read output) has more patience there. ``fine`` is for steps that are many
    and alike: it tells the time left, and writes a line every few seconds only; so does a word.
    """
    started = time.monotonic()
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, Progress

        with Progress(
            "{task.description}",
            BarColumn(),
            *_columns(fine),
            console=Console(stderr=True),
            transient=True,
        ) as bar:
            task = bar.add_task(title, total=total, visible=False)

            def advance(done: int, word: str = "") -> None:
                late = time.monotonic() - started > PATIENCE
                described = f"{title}, {word}" if word else title
                bar.update(task, completed=done, visible=late, description=described)

            yield advance
        return

    shown = started + PATIENCE - LINE_EVERY

    def report(done: int, word: str = "") -> None:
        nonlocal shown
        now = time.monotonic()
        elapsed = now - started
        if elapsed <= (QUIET_PATIENCE if quiet else PATIENCE):
            return
        if (fine or word) and now < shown + LINE_EVERY:
            return
        shown = now
        text = f"{done}/{total} ({elapsed:.1f} s)"
        if fine:
            left = elapsed * (total - done) / max(done, 1)
            text = f"{100 * done // total} % ({elapsed:.1f} s, {left:.0f} s left)"
        if word:
            text = f"{text}, {word}"
        note(f"{title}: {text}")

    yield report


def announce(what: str, seconds: float) -> None:
    """Say how long work will take, roughly, where that is long: even before its first step."""
    if seconds <= ANNOUNCED:
        return
    unit, length = next((unit for unit in _UNITS if seconds < 100 * unit[1]), _UNITS[-1])
    note(f"{what}: roughly {seconds / length:.2g} {unit}; Ctrl-C ends it")


_UNITS = (("s", 1.0), ("minutes", 60.0), ("hours", 3600.0), ("days", 86400.0), ("years", 3.2e7))


def _columns(fine: bool) -> list:
    from rich.progress import (
        MofNCompleteColumn,
        TaskProgressColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    if fine:
        return [TaskProgressColumn(), TimeElapsedColumn(), "left", TimeRemainingColumn()]
    return [MofNCompleteColumn(), TimeElapsedColumn()]
