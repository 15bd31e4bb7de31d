"""What the numerics say when they cannot do what was asked.

Every error names what was given, what is allowed and what to do about it. (The algebra has errors
of its own: the two packages share no code.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numerics.exact_string.characteristics import SonicContact
    from numerics.exact_string.invariant_circle import InvariantCircle


class NumericsError(Exception):
    """Base of every error that the numerics raise on purpose."""

    def __reduce__(self) -> tuple[Any, ...]:
        # An exception is pickled as its class called with its message; some take more.
        return _again, (type(self), self.args, self.__dict__)


def _again(kind: type[NumericsError], args: tuple[Any, ...], state: dict[str, Any]) -> Any:
    error = kind.__new__(kind, *args)
    error.__dict__.update(state)
    return error


class InputError(NumericsError, ValueError):
    """An argument outside what the function accepts."""


class CircleNotFoundError(NumericsError):
    """No invariant circle, hence no periodic wave-less state of the exact string, was found.

    Attributes
    ----------
    partial : InvariantCircle or None
        What the iteration had when it gave up; its ``status`` says why, its ``residuals`` how it
        went. None where it was not started, because no circle can exist.
    """

    def __init__(self, message: str, partial: InvariantCircle | None) -> None:
        super().__init__(message)
        self.partial = partial


class OrbitNotFoundError(NumericsError):
    """A periodic orbit of the string's map was not found."""


class SonicContactError(NumericsError):
    """A time was asked for at which the exact string's solution by characteristics has ended.

    Attributes
    ----------
    sonic : SonicContact
        Where and when the contact point reached the wave speed.
    """

    def __init__(self, message: str, sonic: SonicContact) -> None:
        super().__init__(message)
        self.sonic = sonic


class ActiveSetError(NumericsError):
    """The contact set of a time step could not be determined."""


class FileError(NumericsError):
    """A file is damaged, foreign or of another run; it has been left as it is."""


class WorkerError(NumericsError):
    """A process of a sweep ended before its work was done."""


class MissingPackageError(NumericsError, ImportError):
    """A package that only this task needs is not installed."""


class ThresholdNotFoundError(NumericsError):
    """No loss of the wave-less state was found in the range of amplitudes that is searched."""
