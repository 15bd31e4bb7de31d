"""Where results are kept from one run to the next."""

from __future__ import annotations

import os
from pathlib import Path

from derivations.output import note


def cache_folder(name: str) -> Path | None:
    """Where results of that name are kept: in ROPEWAVE_CACHE, or in the user's cache folder.

    None, with a warning, if the latter cannot be written; the former was asked for.
    """
    from asymptotics.errors import UnwritableError
    from derivations.files import check_folder

    named = os.environ.get("ROPEWAVE_CACHE")
    if named:
        return Path(named) / name
    import platformdirs

    folder = platformdirs.user_cache_path("ropewave") / name
    try:
        check_folder(folder)
    except UnwritableError as error:
        without_cache(error)
        return None
    return folder


def without_cache(error: Exception) -> None:
    """Warn that nothing is kept; raise the error where ROPEWAVE_CACHE asked for it."""
    if os.environ.get("ROPEWAVE_CACHE"):
        raise error
    note(
        f"ropewave: warning: {error}: set ROPEWAVE_CACHE to a folder you may write to. "
        "Going on, and keeping nothing"
    )
