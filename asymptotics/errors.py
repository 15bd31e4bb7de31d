"""What ropewave says when it cannot do what was asked.

Every error names what was given, what is allowed and what to do about it.
"""

from __future__ import annotations

from typing import Any


class RopewaveError(Exception):
    """Base of every error that ropewave raises on purpose."""

    def __reduce__(self) -> tuple[Any, ...]:
        # An exception is pickled as its class called with its message; some take more.
        return _again, (type(self), self.args, self.__dict__)


def _again(kind: type[RopewaveError], args: tuple[Any, ...], state: dict[str, Any]) -> Any:
    error = kind.__new__(kind, *args)
    error.__dict__.update(state)
    return error


class InputError(RopewaveError, ValueError):
    """An argument outside what the function accepts."""


class ResonanceError(InputError):
    """A frequency at, or numerically at, a resonance Ω = pπ/q (with bending, Ω_p(β)/q).

    Attributes
    ----------
    p, q : int
        The resonance; in lowest terms for the string, where p/q and 2p/2q are the same pole.
    """

    def __init__(self, message: str, p: int, q: int) -> None:
        super().__init__(message)
        self.p = p
        self.q = q


class OrderingError(InputError):
    """The ε-series has lost its ordering: later terms are not smaller than the first."""


class StorageError(RopewaveError):
    """A saved derivation that cannot be read, trusted or written."""


class UnwritableError(StorageError):
    """A place where nothing can be written: protected, full, or no folder."""


class DamagedFileError(StorageError):
    """A saved derivation whose content does not match its own checksum."""


class ForeignFileError(StorageError):
    """A saved file that belongs to another problem, another format or another program."""


class OutputError(RopewaveError):
    """Results that cannot be printed where they are sent."""


class ResultError(RopewaveError, ArithmeticError):
    """A result that is infinite or not a number: the input is beyond double precision."""


class NameClashError(RopewaveError, ImportError):
    """Another distribution provides a package named ``asymptotics``."""
