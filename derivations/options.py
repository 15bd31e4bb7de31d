"""What the commands share: their options, and how they read numbers.

Numbers arrive as text, so that all wrong input is answered by the same checks as in Python.
Imports of :mod:`asymptotics` stay inside functions, see :mod:`derivations.clash`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

OrderOption = Annotated[str, typer.Option("--order", "-N", metavar="N", help="Highest power of ε.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
PlotOption = Annotated[Path | None, typer.Option("--plot", help="Draw: .png, .pdf or .svg.")]
LatexOption = Annotated[Path | None, typer.Option("--latex", help="Write a LaTeX table.")]
OmegaOption = Annotated[str, typer.Option("--omega", metavar="Ω", help="Ω = ωx₀/c.")]
BetaOption = Annotated[str, typer.Option("--beta", metavar="β", help="B/(T x₀²).")]
EndOption = Annotated[str, typer.Option("--driven-end", help="pinned or clamped.")]


def order_of(text: str, option: str = "order") -> int:
    """A whole number ≥ 1."""
    from asymptotics.errors import InputError
    from asymptotics.expansion import check_order

    try:
        order: int | str = int(text)
    except ValueError:
        order = text
    if option == "order":
        return check_order(order)
    if not isinstance(order, int) or order < 1:
        raise InputError(f"{option} {text!r}: give a whole number ≥ 1")
    return order


def number_of(option: str, text: str) -> float:
    """One number."""
    from asymptotics.errors import InputError

    values = numbers_of(option, text)
    if len(values) > 1:
        raise InputError(f"{option} {text!r}: give one number")
    return values[0]


def numbers_of(option: str, text: str) -> list[float]:
    """Numbers separated by commas."""
    from asymptotics.errors import InputError

    parts = [part for part in text.replace(",", " ").split() if part]
    try:
        values = [float(part) for part in parts]
    except ValueError:
        raise InputError(
            f"{option} {text!r}: not a number; several are separated by commas: 0.1,0.2"
        ) from None
    if not values:
        raise InputError(f"{option} is empty: give at least one number")
    return values
