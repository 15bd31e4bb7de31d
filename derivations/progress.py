"""Progress of long work on standard error, silent for work that is over in a second."""

from __future__ import annotations

import logging
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
    title: str, total: float, quiet: bool = False, fine: bool = False
) -> Iterator[Callable[..., None]]:
    """A function to call with the number of steps done, out of ``total``, and perhaps a word on it.

    On a terminal it moves a bar; elsewhere it writes a line a step, so that logs stay readable.
    ``quiet`` (for machine-read output) has more patience there. ``fine`` is for steps that are many
    and alike: it tells the time left, as the steps since the first call let expect it, and writes a
    line every few seconds only; so does a word.
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

            def advance(done: float, word: str = "") -> None:
                late = time.monotonic() - started > PATIENCE
                described = f"{title}, {word}" if word else title
                bar.update(task, completed=done, visible=late, description=described)

            yield advance
        return

    shown = started + PATIENCE - LINE_EVERY
    first: tuple[float, float] | None = None
    reached = 0.0

    def report(done: float, word: str = "") -> None:
        nonlocal shown, first, reached
        # Work that is done anew with more digits takes nothing back.
        reached = done = max(done, reached)
        now = time.monotonic()
        elapsed = now - started
        # Before the first call there was compiling, and what was done already was not done now.
        first = (now, done) if first is None else first
        if elapsed <= (QUIET_PATIENCE if quiet else PATIENCE):
            return
        if (fine or word) and now < shown + LINE_EVERY:
            return
        shown = now
        text = f"{done}/{total} ({elapsed:.1f} s)"
        if fine:
            left = remaining(now - first[0], done - first[1], total - done)
            text = f"{percentage(done / total)} % ({elapsed:.1f} s{left})"
        if word:
            text = f"{text}, {word}"
        note(f"{title}: {text}")

    yield report


def share_of_orders(report: Callable[[float], None], order: int) -> Callable[[int], None]:
    """n ↦ the share done: work grows like n⁵, and the moving frame is as much again."""
    return lambda n: report(0.5 * ((n - 1) // order + (((n - 1) % order + 1) / order) ** 5))


def percentage(part: float) -> str:
    """In whole percent, rounded down; below one, to a digit.

    >>> [percentage(part) for part in (0.0, 3.14e-9, 0.5, 0.9999)]
    ['0', '3e-07', '50', '99']
    """
    return f"{100 * part:.1g}" if 100 * part < 1 else f"{int(100 * part)}"


def remaining(seconds: float, done: float, left: float) -> str:
    """How long it will take to do what is left, in the unit that suits; nothing if none tells.

    >>> remaining(10.0, 0.5, 2.0), remaining(10.0, 1e-6, 1.0), remaining(3.0, 0.0, 1.0)
    (', 40 s left', ', 120 days left', '')
    """
    return f", {duration(seconds / done * left)} left" if done > 0 else ""


def duration(seconds: float) -> str:
    """To two digits, in the unit that suits.

    >>> duration(41.6), duration(4000.0), duration(1e10)
    ('42 s', '67 minutes', '310 years')
    """
    unit, length = [each for each in _UNITS if seconds >= 2 * each[1] or each is _UNITS[0]][-1]
    return f"{float(f'{seconds / length:.2g}'):g} {unit}"


_UNITS = (("s", 1.0), ("minutes", 60.0), ("hours", 3600.0), ("days", 86400.0), ("years", 3.2e7))


def announce(what: str, seconds: float) -> None:
    """Say how long work will take, roughly, where that is long: even before its first step."""
    if seconds > ANNOUNCED:
        note(f"{what}: roughly {duration(seconds)}; Ctrl-C ends it")


class _Announcer(logging.Handler):
    """Says the first message of a logger on standard error, as a command does."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print it."""
        logging.getLogger(record.name).removeHandler(self)
        note(record.getMessage())


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
