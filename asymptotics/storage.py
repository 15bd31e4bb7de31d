r"""Saved derivations: one file an order, each sealed, so that nothing computed is lost or mixed up.

A folder holds one problem's expansion as ``order-0001.json.gz``, ``order-0002.json.gz``, … A file
is written under another name, flushed, and only then given its own, so a killed process leaves
whole files or none. Each carries

* the problem and the format it belongs to: another problem's file is *foreign* and refused;
* the SHA-256 of its content and that of the file before it: anything else is *damaged* and refused.

Refused files are never overwritten. A seal says that a file is what was written, not that it is
true; whoever loads an expansion proves it anew (:func:`asymptotics.proof.prove`).
"""

from __future__ import annotations

import gzip
import hashlib
import json
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asymptotics.atomic import replace_file, sweep_unfinished
from asymptotics.cotangent import CotangentElement, CotangentRing
from asymptotics.errors import (
    DamagedFileError,
    ForeignFileError,
    InputError,
    StorageError,
    UnwritableError,
)
from asymptotics.expansion import Expansion, Order, Progress, check_order, expansions
from asymptotics.harmonics import Harmonics
from asymptotics.problem import Problem

FORMAT = "ropewave expansion, version 1"
_RING = CotangentRing()


@dataclass(frozen=True)
class Store:
    """A folder that holds the exact expansion of one problem."""

    folder: Path
    problem: Problem[Any]

    def __post_init__(self) -> None:
        if not isinstance(self.problem.ring, CotangentRing):
            raise InputError(
                f"only expansions over the exact ring are saved, not {self.problem.name}; "
                "numbers at one frequency are quicker computed again"
            )

    def path(self, n: int) -> Path:
        """Where order n is kept."""
        return self.folder / f"order-{n:04d}.json.gz"

    def load(self, order: int) -> tuple[Expansion[Any], str]:
        """Saved orders 1, 2, …, at most ``order`` of them, and the seal of the last one.

        Raises
        ------
        DamagedFileError, ForeignFileError
            A file is not what was written, or belongs elsewhere; its name and the remedy are given.
        """
        orders: list[Order[CotangentElement]] = []
        seal = ""
        for n in range(1, order + 1):
            if not self.path(n).exists():
                break
            content = self._read(n, seal)
            seal = content["seal"]
            try:
                orders.append(_order_from(content["order"]))
            except (KeyError, TypeError, ValueError) as error:
                raise DamagedFileError(
                    f"{self.path(n)} is damaged: {error!r} while reading it. Move it (and later "
                    "orders) away and derive again"
                ) from error
        return Expansion(self.problem, tuple(orders)), seal

    def append(self, expansion: Expansion[Any], seal: str) -> str:
        """Write the last order of ``expansion``, ``seal`` being that of the one before it.

        Returns the new seal. A file that is there already (another process was faster) is checked
        and left alone.
        """
        n = expansion.order
        if self.path(n).exists():
            return str(self._read(n, seal)["seal"])
        content = {
            "format": FORMAT,
            "problem": self.problem.name,
            "n": n,
            "after": seal,
            "order": _order_to(expansion.orders[-1]),
        }
        content["seal"] = _seal(content)
        data = gzip.compress(json.dumps(content, separators=(",", ":")).encode(), 6, mtime=0)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            replace_file(self.path(n), data)
        except OSError as error:
            raise UnwritableError(
                f"cannot write in {self.folder}: {error.strerror or error}. Choose another folder "
                "(for the command's cache: set ROPEWAVE_CACHE to one you may write)"
            ) from error
        return str(content["seal"])

    def _read(self, n: int, after: str) -> dict[str, Any]:
        path = self.path(n)
        remedy = f"It is left as it is: move {path} (and later orders) away and derive again"
        try:
            content = json.loads(gzip.decompress(path.read_bytes()))
        except OSError as error:
            if not isinstance(error, gzip.BadGzipFile):
                raise StorageError(f"cannot read {path}: {error.strerror}. {remedy}") from error
            raise DamagedFileError(f"{path} is damaged: {error}. {remedy}") from error
        except (ValueError, EOFError, zlib.error) as error:
            raise DamagedFileError(f"{path} is damaged: {error}. {remedy}") from error
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            found = content.get("format") if isinstance(content, dict) else type(content).__name__
            raise ForeignFileError(f"{path} is not a {FORMAT} (it says {found!r}). {remedy}")
        if content.get("problem") != self.problem.name or content.get("n") != n:
            raise ForeignFileError(
                f"{path} holds order {content.get('n')} of {content.get('problem')!r}, not order "
                f"{n} of {self.problem.name!r}. {remedy}"
            )
        if content.get("seal") != _seal(content):
            raise DamagedFileError(f"{path} is damaged: its content has changed. {remedy}")
        if content.get("after") != after:
            raise DamagedFileError(f"{path} does not continue the order before it. {remedy}")
        return content


def derive(
    problem: Problem[Any], order: int, folder: Path, progress: Progress | None = None
) -> Expansion[Any]:
    """Continue the saved expansion of a problem to ``order``, saving every order as it is done.

    Killed at any moment, the next call goes on with the order that was under way.

    Raises
    ------
    DamagedFileError, ForeignFileError, UnwritableError
        What is saved cannot be trusted, or nothing can be written.

    Examples
    --------
    >>> import tempfile
    >>> from asymptotics.problem import exact_string
    >>> with tempfile.TemporaryDirectory() as name:
    ...     first = derive(exact_string(), 2, Path(name))
    ...     again = derive(exact_string(), 3, Path(name))
    >>> again.contact(2) == first.contact(2), again.order
    (True, 3)
    """
    order = check_order(order)
    store = Store(folder, problem)
    sweep_unfinished(folder)
    expansion, seal = store.load(order)
    if progress is not None and expansion.order:
        progress(expansion.order)
    for longer in expansions(problem, order, expansion):
        expansion = longer
        seal = store.append(expansion, seal)
        if progress is not None:
            progress(expansion.order)
    return expansion


def _seal(content: dict[str, Any]) -> str:
    """SHA-256 of everything but the seal itself, in one fixed spelling."""
    rest = {key: value for key, value in content.items() if key != "seal"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def _element_to(element: CotangentElement) -> list[Any]:
    form = element.canonical()
    terms = [[int(a), int(i), int(v)] for (a, i), v in form.numerator.terms()]
    return [form.denominator, list(form.poles), terms]


def _element_from(data: list[Any]) -> CotangentElement:
    denominator, poles, terms = data
    return _RING.element({(a, i): v for a, i, v in terms}, denominator, tuple(poles))


def _harmonics_to(harmonics: Harmonics[CotangentElement]) -> dict[str, Any]:
    return {str(j): _element_to(c) for j, c in sorted(harmonics.items())}


def _harmonics_from(data: dict[str, Any]) -> Harmonics[CotangentElement]:
    return {int(j): _element_from(c) for j, c in data.items()}


def _order_to(order: Order[CotangentElement]) -> dict[str, Any]:
    return {
        "contact": _harmonics_to(order.contact),
        "shape": {str(j): [_element_to(d) for d in start] for j, start in order.shape.items()},
        "tails": [[_harmonics_to(tail) for tail in chain] for chain in order.tails],
    }


def _order_from(data: dict[str, Any]) -> Order[CotangentElement]:
    return Order(
        contact=_harmonics_from(data["contact"]),
        shape={
            int(j): tuple(_element_from(d) for d in start) for j, start in data["shape"].items()
        },
        tails=tuple(tuple(_harmonics_from(tail) for tail in chain) for chain in data["tails"]),
    )
