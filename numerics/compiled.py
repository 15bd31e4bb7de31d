"""numba's compiler, content with any place for what it compiled, or with none.

Compiling takes seconds, and is told to the logger ``ropewave.numerics``.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache, NullCache

_LOGGER = logging.getLogger("ropewave.numerics")


class _Cache(FunctionCache):
    """numba's cache of a function, for places that may be full.

    numba compiles anew when the function's own file changes. What it calls in other files is
    compiled into it, so that their contents belong to the key, too.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._called = _sources(function)

    def _index_key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        return (*super()._index_key(sig, codegen), self._called)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept, or None."""
        found = super().load_overload(sig, target_context)
        if found is None:
            _LOGGER.info("compiling, once")
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, if possible: this process has it anyhow."""
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)


def _sources(function: Callable[..., Any]) -> str:
    """A digest of the files that hold the compiled functions that a function's module knows."""
    known = function.__globals__.values()
    called = [x.py_func for x in known if hasattr(x, "py_func")]
    files = sorted({inspect.getfile(other) for other in called} - {inspect.getfile(function)})
    digest = hashlib.sha256()
    for name in files:
        digest.update(Path(name).read_bytes())
    return digest.hexdigest()


class _NoCache(NullCache):
    """Nothing is kept."""

    def load_overload(self, sig: Any, target_context: Any) -> None:
        """Nothing was."""
        _LOGGER.info(
            "compiling, as every time: set NUMBA_CACHE_DIR to a folder that can be written"
        )


def njit(cache: bool = True, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit``; the cache is in NUMBA_CACHE_DIR, beside the source, or at the user's.

    Where none of them can be written (a read-only installation, no home) every process compiles
    anew.

    >>> @njit(cache=True)
    ... def double(x):
    ...     return 2 * x
    >>> double(1.5)
    3.0
    """

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(**options)(function)
        if not cache:
            return dispatcher
        try:
            dispatcher._cache = _Cache(function)
        except RuntimeError:  # numba has found no place
            dispatcher._cache = _NoCache()
        return dispatcher

    return decorate
