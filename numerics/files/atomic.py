"""Files written whole or not at all.

A new file is filled beside the old one, under a name that begins with a dot, and then takes its
place in one step. Whoever writes holds a lock on the unfinished file. A killed process holds none,
so that what it left is told from what another one is writing.

The two packages share no code, and each has this module; a test holds them equal.
"""

from __future__ import annotations

import os
import secrets
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

UNFINISHED = ".ropewave-part"
"""How the names of unfinished files end."""

# Of the file's name, so that what is added fits into 255 bytes even with letters of four.
_LETTERS = 50


def replace_file(path: Path, content: bytes) -> None:
    """Make ``content`` the file at ``path``: killed at any moment, it is the old one or the new.

    A symbolic link is followed. An existing file keeps its mode, a new one gets the umask's.

    Raises
    ------
    OSError
        The folder is missing, full or protected, or ``path`` is no ordinary file.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     replace_file(Path(folder) / "note", b"all of it")
    ...     [path.read_bytes() for path in Path(folder).iterdir()]
    [b'all of it']
    """
    target = ordinary(path)
    with _unfinished(target) as (part, stream):
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
        if target.exists():
            part.chmod(stat.S_IMODE(target.stat().st_mode))
        if sys.platform == "win32":  # does not rename what is open
            stream.close()
        part.replace(target)


def ordinary(path: Path) -> Path:
    """Where ``path`` leads, which is an ordinary file or nothing yet; OSError otherwise.

    >>> ordinary(Path("/"))
    Traceback (most recent call last):
    OSError: [Errno 22] it is not an ordinary file
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        raise OSError(22, "it is not an ordinary file")
    return target


def sweep_unfinished(folder: Path) -> None:
    """Remove the unfinished files in a folder that no living process is writing.

    Those of other users, and those on a file system without locks, are left.
    """
    for part in folder.glob(f".*{UNFINISHED}"):
        try:
            handle = os.open(part, os.O_RDWR)
        except OSError:
            continue
        try:
            if _locked(handle):
                part.unlink(missing_ok=True)
        except OSError:
            continue
        finally:
            os.close(handle)


@contextmanager
def _unfinished(target: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """A new locked file beside ``target``, removed at the end unless it has got another name."""
    while True:
        part = target.parent / f".{target.name[:_LETTERS]}.{secrets.token_hex(8)}{UNFINISHED}"
        handle = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
        with open(handle, "wb") as stream:
            try:
                # Swept by another process before it was locked, it is lost.
                if not _locked(handle) or os.fstat(handle).st_nlink == 0:
                    continue
            except OSError:
                pass  # a file system without locks: nobody sweeps there
            try:
                yield part, stream
            finally:
                part.unlink(missing_ok=True)
        return


def _locked(handle: int) -> bool:
    """Lock an open file until it is closed; False if another process has.

    Raises
    ------
    OSError
        There are no such locks.
    """
    if sys.platform == "win32":
        raise OSError("no locks that end with a process")
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
