"""Progress of long work on standard error, silent for work that is over in a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from derivations.output import note

PATIENCE = 1.0
"""Seconds before anything is shown."""

LINE_EVERY = 5.0
"""Seconds between two lines of work with many small steps."""


@contextmanager
def progress(
    title: str, total: int, quiet: bool = False, fine: bool = False
) -> Iterator[Callable[[int], None]]:
    """A function to call with the number of steps done, out of ``total``.

    On a terminal it moves a bar; elsewhere it writes a line a step, so that logs stay readable.
    ``quiet`` (for machine-read output) keeps it to terminals. ``fine`` is for steps that are many
    and alike: it tells the time left, and writes a line every few seconds only.
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

            def advance(done: int) -> None:
                late = time.monotonic() - started > PATIENCE
                bar.update(task, completed=done, visible=late)

            yield advance
        return

    shown = started + PATIENCE - LINE_EVERY

    def report(done: int) -> None:
        nonlocal shown
        now = time.monotonic()
        elapsed = now - started
        if quiet or elapsed <= PATIENCE or (fine and now < shown + LINE_EVERY):
            return
        shown = now
        text = f"{done}/{total} ({elapsed:.1f} s)"
        if fine:
            left = elapsed * (total - done) / max(done, 1)
            text = f"{100 * done // total} % ({elapsed:.1f} s, {left:.0f} s left)"
        note(f"{title}: {text}")

    yield report


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
