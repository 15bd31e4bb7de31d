"""Is ``asymptotics`` our package? PyPI holds another distribution of that name.

Installed beside ropewave it shadows our package, or its files merge into ours, without a word from
pip. This module imports nothing of ours, so that it can still speak when that has happened.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
from pathlib import Path

REMEDY = (
    "Run: pip uninstall -y asymptotics && pip install --force-reinstall --no-deps ropewave "
    "(in a clone: -e . instead of ropewave), or use a fresh virtual environment"
)


def find_clash() -> str | None:
    """What stands in the way of importing our ``asymptotics``; None when nothing does."""
    home = Path(__file__).resolve().parent.parent
    spec = importlib.util.find_spec("asymptotics")
    if spec is None or spec.origin is None:
        return f"the package asymptotics is missing beside {home / 'derivations'}. {REMEDY}"
    found = Path(spec.origin).resolve().parent
    if found.parent != home:
        return (
            f"'asymptotics' is imported from {found}, another package of the same name, "
            f"instead of {home / 'asymptotics'}. {REMEDY}; or take its folder off PYTHONPATH"
        )
    if 'DISTRIBUTION = "ropewave"' not in Path(spec.origin).read_text(
        encoding="utf-8", errors="replace"
    ):
        return f"another package has overwritten {spec.origin}. {REMEDY}"
    try:
        other = importlib.metadata.distribution("asymptotics")
    except importlib.metadata.PackageNotFoundError:
        return None
    if Path(str(other.locate_file("asymptotics"))).resolve() == found:
        return (
            f"the PyPI package asymptotics {other.version} has merged its files into {found}. "
            f"{REMEDY}"
        )
    return None
