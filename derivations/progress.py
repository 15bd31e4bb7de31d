"""Progress of long work on standard error, silent for work that is over in a second."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PATIENCE = 1.0
"""Seconds before anything is shown."""

LINE_EVERY = 5.0
"""Seconds between two lines of work with many small steps."""


@contextmanager
def progress(
    title: str, total: float, quiet: bool = False, fine: bool = False
) -> Iterator[Callable[[float], None]]:
    """A function to call with the number of steps done, out of ``total``.

    On a terminal it moves a bar; elsewhere it writes a line a step, so that logs stay readable.
    ``quiet`` (for machine-read output) keeps it to terminals. ``fine`` is for steps that are many
    and alike: it tells the time left, as the steps since the first call let expect it, and writes a
    line every few seconds only.
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

            def advance(done: float) -> None:
                late = time.monotonic() - started > PATIENCE
                bar.update(task, completed=done, visible=late)

            yield advance
        return

    shown = started + PATIENCE - LINE_EVERY
    first: tuple[float, float] | None = None

    def report(done: float) -> None:
        nonlocal shown, first
        now = time.monotonic()
        elapsed = now - started
        # Before the first call there was compiling, and what was done already was not done now.
        first = (now, done) if first is None else first
        if quiet or elapsed <= PATIENCE or (fine and now < shown + LINE_EVERY):
            return
        shown = now
        text = f"{done}/{total} ({elapsed:.1f} s)"
        if fine:
            left = remaining(now - first[0], done - first[1], total - done)
            text = f"{percentage(done / total)} % ({elapsed:.1f} s{left})"
        print(f"{title}: {text}", file=sys.stderr, flush=True)

    yield report


def percentage(part: float) -> str:
    """In whole percent, rounded down; below one, to a digit.

    >>> [percentage(part) for part in (0.0, 3.14e-9, 0.5, 0.9999)]
    ['0', '3e-07', '50', '99']
    """
    return f"{100 * part:.1g}" if 100 * part < 1 else f"{int(100 * part)}"


def remaining(seconds: float, done: float, left: float) -> str:
    """How long it will take to do what is left, in the unit that suits; nothing if none tells.

    >>> remaining(10.0, 0.5, 2.0), remaining(10.0, 1e-6, 1.0), remaining(3.0, 0.0, 1.0)
    (', 40 s left', ', 116 d left', '')
    """
    if done <= 0:
        return ""
    time_left = seconds / done * left
    for unit, length in (("s", 1), ("min", 60), ("h", 3600), ("d", 86400)):
        if time_left < 120 * length or unit == "d":
            return f", {time_left / length:.0f} {unit} left"
    return ""


class _Announcer(logging.Handler):
    """Says the first message of a logger on standard error, as a command does."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print it."""
        logging.getLogger(record.name).removeHandler(self)
        print(record.getMessage(), file=sys.stderr, flush=True)


def announce_compiling(quiet: bool) -> None:
    """Have it said when compiling begins; ``quiet`` keeps it to terminals."""
    logger = logging.getLogger("ropewave.numerics")
    for handler in [known for known in logger.handlers if isinstance(known, _Announcer)]:
        logger.removeHandler(handler)
    if sys.stderr.isatty() or not quiet:
        logger.setLevel(logging.INFO)
        logger.addHandler(_Announcer())


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
