r"""Saved derivations: one file an order, each sealed, so that nothing computed is lost or mixed up.

A folder holds one problem's expansion as ``order-0001.json.gz``, ``order-0002.json.gz``, … A file
is written under another name, flushed, and only then given its own, so a killed process leaves
whole files or none. Each carries

* the problem and the format it belongs to: another problem's file is *foreign* and refused;
* the SHA-256 of its content and that of the file before it: anything else is *damaged* and refused.

Refused files are never overwritten. A seal is no key, it says that a file is what was written, not
by whom: what is read is bounded and checked for its form
(:mod:`asymptotics.expansion.saved_orders`), and every number of it, those that later orders are
computed from included, is compared with the engine's at a random point modulo a random prime
(:mod:`asymptotics.expansion.modular`). Whoever goes on to use an expansion proves it
(:func:`asymptotics.expansion.proof.prove`).
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asymptotics.atomic import replace_file, sweep_unfinished
from asymptotics.checks import check_order
from asymptotics.errors import (
    DamagedFileError,
    ForeignFileError,
    InputError,
    StorageError,
    UnwritableError,
)
from asymptotics.expansion.modular import ModularPoint, engine_image
from asymptotics.expansion.order_loop import Expansion, Order, Progress, expansions
from asymptotics.expansion.saved_orders import (
    Terms,
    fields,
    largest_size,
    order_from,
    order_to,
    packed,
    unpacked,
)
from asymptotics.problems.problem import Problem
from asymptotics.rings.cotangent import CotangentElement, CotangentRing, Poles, check_element

FORMAT = "ropewave expansion, version 1"
_FIELDS = ("format", "problem", "n", "after", "order", "seal")
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
        saved: list[Any] = []
        seal = ""
        for n in range(1, order + 1):
            content = self._read(n, seal)
            if content is None:
                break
            seal = content["seal"]
            saved.append(content["order"])
        return Expansion(self.problem, self._checked(saved)), seal

    def _checked(self, saved: list[Any]) -> tuple[Order[CotangentElement], ...]:
        """Saved orders, none of whose numbers is another than the engine's."""
        if not saved:
            return ()
        point = ModularPoint()
        wanted = engine_image(self.problem, point, len(saved))
        orders = []
        for n, (data, known) in enumerate(zip(saved, wanted, strict=True), start=1):

            def image(terms: Terms, d: int, poles: Poles, highest: int = self._highest(n)) -> int:
                check_element(terms, d, poles)
                # A product of n cotangents has Ψ_q once for each that q divides.
                if len(poles) >= highest or any(power > 2 * highest for power in poles):
                    raise ValueError(f"no coefficient has the poles {list(poles)[:9]}")
                return point.value_of(terms, d, poles)

            try:
                if order_from(data, image) != known:
                    raise ValueError(f"its numbers are not what {self.problem.name!r} yields")
                orders.append(order_from(data, _element))
            except (ValueError, ZeroDivisionError) as error:
                raise self._damaged(n, error) from error
        return tuple(orders)

    def _highest(self, n: int) -> int:
        """The highest harmonic of order n."""
        return n * max(self.problem.drive, default=1)

    def _damaged(self, n: int, why: Exception | str) -> DamagedFileError:
        return DamagedFileError(f"{self.path(n)} is damaged: {why}. {self._remedy(n)}")

    def _remedy(self, n: int) -> str:
        return f"It is left as it is: move {self.path(n)} (and later orders) away and derive again"

    def append(self, expansion: Expansion[Any], seal: str) -> str:
        """Write the last order of ``expansion``, ``seal`` being that of the one before it.

        Returns the new seal. A file that is there already (another process was faster) is checked
        and left alone.
        """
        n = expansion.order
        content = {
            "format": FORMAT,
            "problem": self.problem.name,
            "n": n,
            "after": seal,
            "order": order_to(expansion.orders[-1]),
        }
        content["seal"] = _seal(content)
        there = self._read(n, seal)
        if there is not None:
            if there["seal"] != content["seal"]:
                raise self._damaged(n, f"its numbers are not what {self.problem.name!r} yields")
            return str(content["seal"])
        data = packed(content)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            replace_file(self.path(n), data)
        except OSError as error:
            raise UnwritableError(
                f"cannot write in {self.folder}: {error.strerror or error}. Choose another folder "
                "(for the command's cache: set ROPEWAVE_CACHE to one you may write)"
            ) from error
        return str(content["seal"])

    def _read(self, n: int, after: str) -> dict[str, Any] | None:
        """What the file of order n says, when there is one."""
        path, limit = self.path(n), largest_size(self._highest(n))
        try:
            if not path.exists():
                return None
            if not path.is_file():
                raise StorageError(f"{path} is not a file. {self._remedy(n)}")
            with path.open("rb") as stream:
                data = stream.read(limit + 1)
        except OSError as error:
            reason = error.strerror or error
            raise StorageError(f"cannot read {path}: {reason}. {self._remedy(n)}") from error
        try:
            content = unpacked(data, limit)
        except ValueError as error:
            raise self._damaged(n, error) from error
        found = content.get("format") if isinstance(content, dict) else type(content).__name__
        if found != FORMAT:
            raise ForeignFileError(
                f"{path} is not a {FORMAT} (it says {str(found)[:40]!r}). {self._remedy(n)}"
            )
        try:
            fields(content, _FIELDS, "a saved order")
        except ValueError as error:
            raise self._damaged(n, error) from error
        if (content["problem"], content["n"]) != (self.problem.name, n):
            raise ForeignFileError(
                f"{path} holds order {str(content['n'])[:40]} of {str(content['problem'])[:40]!r}, "
                f"not order {n} of {self.problem.name!r}. {self._remedy(n)}"
            )
        if content["seal"] != _seal(content):
            raise self._damaged(n, "its content has changed")
        if content["after"] != after:
            raise DamagedFileError(
                f"{path} does not continue the order before it. {self._remedy(n)}"
            )
        return content


def saved_expansion(
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
    >>> from asymptotics.problems.string import exact_string
    >>> with tempfile.TemporaryDirectory() as name:
    ...     first = saved_expansion(exact_string(), 2, Path(name))
    ...     again = saved_expansion(exact_string(), 3, Path(name))
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


def _element(terms: Terms, denominator: int, poles: Poles) -> CotangentElement:
    return _RING.element({(a, i): v for a, i, v in terms}, denominator, poles)
