"""Where the commands write: looked at before the work, and written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from asymptotics.atomic import ordinary, replace_file, sweep_unfinished
from asymptotics.errors import UnwritableError


def check_writable(path: Path) -> None:
    """That a file can be written there, missing folders made; nothing is made yet.

    Only a missing folder in the root of the file system is not made for an absolute path.

    Raises
    ------
    UnwritableError
        It cannot, with the reason.

    Examples
    --------
    >>> check_writable(Path("/no/a.png"))
    Traceback (most recent call last):
    asymptotics.errors.UnwritableError: cannot write /no/a.png: no folder /no. Choose another place
    """
    try:
        _check_folder(path, ordinary(path).parent)
    except OSError as error:
        raise _cannot(path, error) from error


def check_folder(folder: Path) -> None:
    """As :func:`check_writable`, for files in a folder that may be missing."""
    try:
        _check_folder(folder, Path(os.path.realpath(folder)))
    except OSError as error:
        raise _cannot(folder, error) from error


def write_file(path: Path, content: bytes) -> None:
    """Write a file whole or not at all; folders are made when missing.

    What a killed command has left in the folder is removed.

    Raises
    ------
    UnwritableError
        It cannot be written.
    """
    make_folder_of(path)
    try:
        sweep_unfinished(path.parent)
        replace_file(path, content)
    except OSError as error:
        raise _cannot(path, error) from error


def make_folder_of(path: Path) -> None:
    """Make the folder of a file to be written, after :func:`check_writable`."""
    check_writable(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _cannot(path, error) from error


def _check_folder(asked: Path, folder: Path) -> None:
    missing = None
    while not folder.exists():
        missing, folder = folder, folder.parent
    # Only root could make one there, and root mistypes paths as others do.
    if missing is not None and asked.is_absolute() and folder == Path(folder.anchor):
        raise OSError(2, f"no folder {missing}")
    with tempfile.TemporaryFile(dir=folder):
        pass


def _cannot(path: Path, error: OSError) -> UnwritableError:
    return UnwritableError(f"cannot write {path}: {error.strerror or error}. Choose another place")
