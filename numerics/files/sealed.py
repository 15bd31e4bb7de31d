"""What files of runs have in common: a seal, a specification, and writing whole or not at all.

The seal is one line at the end of a file: its kind and the SHA-256 of all before it. Readers of
the formats used (netCDF through HDF5, npz) pass over it; here it is checked before anything is
parsed. It says that a file is what was written, not that it is true.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import stat
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from numerics.errors import FileError
from numerics.files import atomic

if TYPE_CHECKING:
    from numerics.simulation.contact import Simulator
    from numerics.simulation.run import Run

Specification = dict[str, Any]

LARGEST_JSON = 2**26
"""Bytes of a JSON file, 64 MiB: to parse more takes gigabytes."""

_DIGEST = 64


def specification(run: Run | Simulator) -> Specification:
    """All parameters of a run, as plain numbers and words; the drive by its label.

    >>> from numerics.simulation.contact import Simulator
    >>> from numerics.problems.drive import at_rest
    >>> from numerics.problems.problem import RopeProblem
    >>> specification(Simulator(RopeProblem(0.01, at_rest())))["driven_end"]
    'pinned'
    """
    problem = run.problem
    omega = problem.drive.omega
    return {
        "beta": problem.beta,
        "driven_end": problem.driven_end.value,
        "damping": problem.damping,
        "restitution": problem.restitution,
        "drive": problem.drive.label,
        "omega": None if omega is None else float(omega),
        **{name: float(value) for name, value in asdict(run.grid).items()},
        "dt": float(run.dt),
        "scheme": run.scheme.value,
        **problem.varying,
    }


def differences(found: Specification, wanted: Specification) -> str:
    """What differs, in words; nothing if nothing does.

    >>> differences({"beta": 0.1, "dt": 1.0}, {"beta": 0.2, "dt": 1.0})
    'beta = 0.1 there, 0.2 here'
    """
    names = [*wanted, *(name for name in found if name not in wanted)]
    return "; ".join(
        f"{name} = {found.get(name)!r} there, {wanted.get(name)!r} here"
        for name in names
        if found.get(name) != wanted.get(name)
    )


def release() -> str:
    """The version of ropewave, for the record."""
    try:
        return version("ropewave")
    except PackageNotFoundError:
        return "unknown"


def replace_file(path: Path, content: bytes) -> None:
    """Write a file whole or not at all: :func:`numerics.files.atomic.replace_file`.

    Raises
    ------
    FileError
        The folder is missing, full or protected.
    """
    try:
        atomic.replace_file(path, content)
    except OSError as error:
        raise FileError(
            f"cannot write {path}: {error.strerror or error}. Choose a place you may write to"
        ) from error


def is_there(path: Path) -> bool:
    """Whether there is something at ``path`` to be read, or to complain of.

    >>> is_there(Path("/nothing of this name"))
    False
    """
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError:  # whoever reads it will say which
        return True
    return True


def write_sealed(path: Path, kind: str, content: bytes) -> None:
    """Write the content with a seal at its end; what a killed process left beside it is removed.

    Raises
    ------
    FileError
        As :func:`replace_file`.
    """
    atomic.sweep_unfinished(path.parent)
    digest = hashlib.sha256(content).hexdigest()
    replace_file(path, b"".join([content, _first(kind), digest.encode(), b"\n"]))


def read_sealed(path: Path, kind: str) -> bytes:
    """The content of a sealed file, the seal taken off.

    Raises
    ------
    FileError
        It cannot be read, is not of this kind, or is not what was written.
    """
    first = _first(kind)
    try:
        with _open(path) as stream:
            length = max(os.fstat(stream.fileno()).st_size - len(first) - _DIGEST - 1, 0)
            stream.seek(length)
            seal = stream.read(len(first) + _DIGEST + 1)
            stream.seek(0)
            content = stream.read(length) if seal.startswith(first) else b""
    except (OSError, MemoryError) as error:
        raise FileError(f"cannot read {path}: {_reason(error)}") from error
    if not seal.startswith(first):
        raise FileError(
            f"{path} is not a {kind}, or it is truncated: its last line is not the seal. It is "
            "left as it is; move it away, or choose another name"
        )
    if seal != first + hashlib.sha256(content).hexdigest().encode() + b"\n":
        raise FileError(
            f"{path} is damaged: it is not what was written (SHA-256 differs). It is left as it "
            "is; move it away and run again"
        )
    return content


def not_written_here(path: Path, kind: str, what: str | Exception) -> FileError:
    """The error of a file whose seal is right and whose content is not, in one line."""
    if isinstance(what, MemoryError):
        return FileError(f"cannot read {path}: {_reason(what)}")
    line = " ".join(str(what or type(what).__name__).split())
    return FileError(
        f"{path} is sealed and yet no {kind} that ropewave has written: {line:.300}. It is left "
        "as it is; move it away and run again"
    )


def read_json(path: Path, remedy: str) -> Any:
    """What a JSON file holds; NaN and infinities are refused: JSON has none.

    ``remedy`` is what to do about a file that cannot be read.

    Raises
    ------
    FileError
        It cannot be read, is no JSON, or too large or too deeply nested for any file of ours.
    """
    try:
        with _open(path) as stream:
            raw = stream.read(LARGEST_JSON + 1)
        if len(raw) > LARGEST_JSON:
            raise ValueError(f"it has more than {LARGEST_JSON} bytes")
        return json.loads(raw, parse_constant=_finite, parse_float=_finite)
    except OSError as error:
        raise FileError(f"cannot read {path}: {_reason(error)}. {remedy}") from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise FileError(
            f"{path} is damaged, or no JSON file of ropewave: {_reason(error)}. {remedy}"
        ) from error


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text:.50} is no finite number")
    return number


def _open(path: Path) -> BinaryIO:
    """An ordinary file, for reading; devices and pipes have no end."""
    if not stat.S_ISREG(path.stat().st_mode):
        raise OSError(22, "it is not an ordinary file")
    return path.open("rb")


def _reason(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "it needs more memory than there is"
    return (isinstance(error, OSError) and error.strerror) or str(error)


def _first(kind: str) -> bytes:
    return f"\n{kind}, sha256 ".encode()
