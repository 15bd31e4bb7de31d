"""What files of runs have in common: a seal, a specification, and writing whole or not at all.

The seal is one line at the end of a file: its kind and the SHA-256 of all before it. Readers of
the formats used (netCDF through HDF5, npz) pass over it; here it is checked before anything is
parsed. It says that a file is what was written, not that it is true.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numerics.errors import FileError

if TYPE_CHECKING:
    from numerics.contact import Simulator
    from numerics.simulation import Run

Specification = dict[str, Any]

_DIGEST = 64


def specification(run: Run | Simulator) -> Specification:
    """All parameters of a run, as plain numbers and words; the drive by its label.

    >>> from numerics.contact import Simulator
    >>> from numerics.drive import at_rest
    >>> from numerics.problem import RopeProblem
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


def replace_file(path: Path, fill: Callable[[Path], object]) -> None:
    """Let ``fill`` write a new file beside ``path``, then put it in place in one step.

    Killed at any moment, ``path`` is the old file or the new one. (The unfinished file, whose
    name begins with a dot, may be left behind.)

    Raises
    ------
    FileError
        The folder is missing, full or protected.
    """
    path = Path(os.path.realpath(path))
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        os.close(handle)
        unfinished = Path(name)
        try:
            fill(unfinished)
            with unfinished.open("rb+") as stream:
                os.fsync(stream.fileno())
            unfinished.chmod(0o644)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
    except OSError as error:
        raise FileError(
            f"cannot write {path}: {error.strerror or error}. Choose a place you may write to"
        ) from error


def write_sealed(path: Path, kind: str, fill: Callable[[Path], object]) -> None:
    """:func:`replace_file`, with a seal at the end of what ``fill`` writes."""

    def fill_and_seal(unfinished: Path) -> None:
        fill(unfinished)
        with unfinished.open("rb+") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
            stream.write(_first(kind) + digest.encode() + b"\n")

    replace_file(path, fill_and_seal)


def read_sealed(path: Path, kind: str) -> bytes:
    """The content of a sealed file, the seal taken off.

    Raises
    ------
    FileError
        It cannot be read, is not of this kind, or is not what was written.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    first = _first(kind)
    content, seal = raw[: -len(first) - _DIGEST - 1], raw[-len(first) - _DIGEST - 1 :]
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


def _first(kind: str) -> bytes:
    return f"\n{kind}, sha256 ".encode()
