"""Progress of long work on standard error, silent for work that is over in a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PATIENCE = 1.0
"""Seconds before anything is shown."""


@contextmanager
def progress(title: str, total: int, quiet: bool = False) -> Iterator[Callable[[int], None]]:
    """A function to call with the number of steps done, out of ``total``.

    On a terminal it moves a bar; elsewhere it writes a line a step, so that logs stay readable.
    ``quiet`` (for machine-read output) keeps it to terminals.
    """
    started = time.monotonic()
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

        with Progress(
            "{task.description}",
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=Console(stderr=True),
            transient=True,
        ) as bar:
            task = bar.add_task(title, total=total, visible=False)

            def advance(done: int) -> None:
                late = time.monotonic() - started > PATIENCE
                bar.update(task, completed=done, visible=late)

            yield advance
        return

    def report(done: int) -> None:
        elapsed = time.monotonic() - started
        if elapsed > PATIENCE and not quiet:
            print(f"{title}: {done}/{total} ({elapsed:.1f} s)", file=sys.stderr, flush=True)

    yield report
