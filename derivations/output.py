"""What the commands print: results to standard output, all else to standard error.

Results survive a terminal that lacks a letter; where they cannot be written at all that is one
error; and nothing that is not a number is called a result. Imports of :mod:`asymptotics` stay
inside functions, see :mod:`derivations.clash`.
"""

from __future__ import annotations

import codecs
import contextlib
import io
import json
import math
import os
import sys
from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Any

_SPELT = {
    "Ω": "Omega", "ω": "omega", "β": "beta", "ε": "epsilon", "ζ": "zeta", "τ": "tau", "ξ": "xi",
    "μ": "mu", "π": "pi", "σ": "sigma", "λ": "lambda", "Δ": "Delta", "√": "sqrt ", "…": "...",
    "−": "-", "–": "-", "—": "-", "→": "->", "≤": "<=", "≥": ">=", "≠": "!=", "±": "+-", "·": "*",
    "×": "x", "′": "'", "∞": "inf", "½": "1/2", "⅓": "1/3", "⅔": "2/3", "ξ₀": "xi_0",
    **{chr(0x2080 + digit): f"_{digit}" for digit in range(10)},
    **dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", ("^0", "^1", "^2", "^3", "^4", "^5", "^6", "^7", "^8", "^9", "^-"),
               strict=True)),
}  # fmt: skip


def spell(error: UnicodeError) -> tuple[str | bytes, int]:
    """An error handler of codecs that spells out the letters an encoding lacks.

    >>> codecs.register_error("ropewave", spell)
    >>> "ε ≤ 10⁻³, Ω₁ … é".encode("ascii", "ropewave")
    b'epsilon <= 10^-^3, Omega_1 ... \\\\xe9'
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letter = error.object[error.start]
    if "\udc80" <= letter <= "\udcff":  # a byte of a file's name: as it came
        return bytes([ord(letter) - 0xDC00]), error.start + 1
    spelt = _SPELT.get(letter)
    if spelt is None:
        spelt = letter.encode("ascii", "backslashreplace").decode()
    return spelt, error.start + 1


def open_streams() -> None:
    """Let both streams take every letter, and make up for a closed standard error.

    Raises
    ------
    OutputError
        Standard output is closed.
    """
    codecs.register_error("ropewave", spell)
    if sys.stderr is None:  # ``print`` would go to standard output instead
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stdout is None:
        from asymptotics.errors import OutputError

        raise OutputError("standard output is closed; send the results to a file, or to /dev/null")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="ropewave")


def guarded(run: Callable[[], int]) -> int:
    """The exit code of ``run`` once all it printed is written; 1 where nobody reads on.

    Raises
    ------
    OutputError
        What was printed cannot be written.
    """
    stdout = sys.stdout
    try:
        try:
            code = run()
        finally:
            sys.stdout = stdout  # the command line wraps it when a pipe breaks
            stdout.flush()
    except BrokenPipeError:
        _give_up(stdout)
        return 1
    except OSError as error:
        if error.filename is not None:  # no stream's
            raise
        _give_up(stdout)
        from asymptotics.errors import OutputError

        raise OutputError(
            f"cannot write the results: {error.strerror or error}; send them elsewhere"
        ) from error
    return code


def _give_up(stream: Any) -> None:
    """Let what is left in a broken stream go nowhere, without a word at the end of the process."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def note(text: str) -> None:
    """A line on standard error; when that is full or closed, results go on without it."""
    with contextlib.suppress(OSError):
        print(text, file=sys.stderr, flush=True)


def wrote(*paths: Path | None) -> None:
    """Say which files were written."""
    for path in paths:
        if path is not None:
            note(f"wrote {path}")


def show(fields: dict[str, Any], text: str, as_json: bool) -> None:
    """One JSON object, or text; either only when all its numbers are numbers.

    Raises
    ------
    ResultError
        A result that is infinite or not a number.
    """
    line = json_text(fields)
    print(line if as_json else text.rstrip("\n"))


def json_text(fields: Any, indent: int | None = None, ensure_ascii: bool = True) -> str:
    """JSON, as all commands and files have it: never NaN, never Infinity.

    Raises
    ------
    ResultError
        As :func:`show`.

    >>> json_text({"a": [1, 2.5, None]})
    '{"a": [1, 2.5, null]}'
    """
    try:
        return json.dumps(fields, allow_nan=False, indent=indent, ensure_ascii=ensure_ascii)
    except ValueError:
        from asymptotics.errors import ResultError

        found = _not_finite(fields)
        if found is None:
            raise
        where, value = found
        raise ResultError(
            f"the result {where} = {value!r} is no number: these parameters are beyond what double "
            "precision can compute; give less extreme ones"
        ) from None


def _not_finite(value: Any, where: str = "") -> tuple[str, Any] | None:
    """Where the first number that is none stands, and which it is.

    >>> _not_finite({"a": 1.0, "b": [2.0, math.inf]})
    ('b[1]', inf)
    """
    if isinstance(value, float):
        return None if math.isfinite(value) else (where, value)
    parts: list[tuple[str, Any]] = []
    if isinstance(value, dict):
        parts = [(f"{where}.{name}" if where else str(name), part) for name, part in value.items()]
    elif isinstance(value, list | tuple):
        parts = [(f"{where}[{i}]", part) for i, part in enumerate(value)]
    return next(filter(None, (_not_finite(part, name) for name, part in parts)), None)


def finite(value: Any) -> Any:
    """Plain numbers, words, lists and objects, with null for numbers that JSON does not have.

    For results that may rightly be absent; :func:`json_text` refuses the others.

    >>> finite({"a": math.nan, "b": [1, 2.5, "c", None]})
    {'a': None, 'b': [1, 2.5, 'c', None]}
    """
    if isinstance(value, dict):
        return {name: finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [finite(part) for part in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, str | int | None):
        return value
    return float(value) if math.isfinite(value) else None
