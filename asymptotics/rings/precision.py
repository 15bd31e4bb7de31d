"""FLINT's working precision: set in one place, and doubled until a result is accurate enough."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from flint import ctx

from asymptotics.errors import RopewaveError

T = TypeVar("T")

# More are needed only for frequencies some 10⁻²⁴⁰⁰ from a resonance: certainly not what was meant.
MOST_BITS = 1 << 13


class PrecisionError(RopewaveError):
    """The accuracy asked for needs more bits than allowed; ``partial`` has what was reached."""

    def __init__(self, message: str, partial: Any) -> None:
        super().__init__(message)
        self.partial = partial


class _Lock:
    """One thread at a time; a forked process starts with it open."""

    def __init__(self) -> None:
        self.reset()
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self.reset)

    def reset(self) -> None:
        self.lock = threading.RLock()


# FLINT's precision is one number for the whole process: a thread that set it under another one's
# computation would change that one's accuracy, and two that restore it in turn leave a wrong value.
_LOCK = _Lock()


@contextmanager
def at_precision(bits: int) -> Iterator[None]:
    """A context in which balls are computed with that many bits.

    FLINT's precision belongs to the process, so one thread at a time is inside and others wait;
    contexts of one thread may be nested.

    >>> from flint import arb
    >>> with at_precision(200):
    ...     arb.pi().rad() < 1e-59
    True
    """
    with _LOCK.lock:
        before = ctx.prec
        ctx.prec = bits
        try:
            yield
        finally:
            ctx.prec = before


def until(
    accurate: Callable[[T], bool], compute: Callable[[], T], what: str, start: int = 64
) -> tuple[T, int]:
    """``compute`` with doubled precision until its result is accurate; the result and the bits.

    Raises
    ------
    PrecisionError
        More than 8192 bits would be needed.
    """
    bits: int = start
    reached: Any = None
    while True:
        with at_precision(bits):
            try:
                result = compute()
            except PrecisionError as error:  # balls too wide to go on with
                reached = error.partial
            else:
                if accurate(result):
                    return result, bits
                reached = result
        bits = doubled(bits, what, reached)


def doubled(bits: int, what: str, reached: Any) -> int:
    """Twice the bits, or a :class:`PrecisionError` when that is more than allowed."""
    if bits >= MOST_BITS:
        raise PrecisionError(
            f"{what} needs more than {MOST_BITS} bits; ask for less accuracy, or move Omega "
            "away from the resonance",
            reached,
        )
    return 2 * bits
