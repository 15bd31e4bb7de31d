"""What the commands share: their options, and how they read lists of numbers.

Types and closed ranges are the command line's own, so that ``--help`` states them. What they
cannot say (Ω > 0, finite, resonances) is checked where it is checked in Python.
Imports of :mod:`asymptotics` stay inside functions, see :mod:`derivations.clash`.
"""

from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Literal

import typer

OrderOption = Annotated[
    int, typer.Option("--order", "-N", metavar="N", min=1, help="Highest power of ε.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw: .png, .pdf or .svg.")
]
LatexOption = Annotated[
    Path | None, typer.Option("--latex", metavar="FILE", help="Write a LaTeX table.")
]
OmegaOption = Annotated[float, typer.Option("--omega", metavar="Ω", help="Ω = ωx₀/c > 0.")]
EpsilonOption = Annotated[
    float, typer.Option("--epsilon", metavar="ε", help="Forcing amplitude, units of Z₀.")
]
BetaOption = Annotated[float, typer.Option("--beta", metavar="β", min=0, help="B/(T x₀²).")]
RopeBetaOption = Annotated[
    float, typer.Option("--beta", metavar="β", min=0, max=1, help="B/(T x₀²).")
]
EndOption = Annotated[
    Literal["pinned", "clamped"], typer.Option("--driven-end", help="How the shaken end is held.")
]

HertzOption = Annotated[
    float | None, typer.Option("--hz", metavar="F", help="Frequency in hertz, in the place of Ω.")
]
HeightOption = Annotated[
    float | None,
    typer.Option("--height", metavar="Z₀", help="With --hz: height of the driven end in metres."),
]
FrequencyOption = Annotated[
    float | None, typer.Option("--omega", metavar="Ω", help="Ω = ωx₀/c > 0; or --hz and --height.")
]
DataOption = Annotated[
    Path | None,
    typer.Option(
        "--data", metavar="FOLDER", help="Where points are kept, and taken up again from."
    ),
]
WorkersOption = Annotated[
    int, typer.Option("--workers", metavar="COUNT", min=1, help="Processes that compute.")
]

LIST = "X,X,…|START:STOP:STEP"
"""How :func:`numbers_of` wants them."""

MOST_NUMBERS = 100_000
"""Of one option; more are for programs."""

# Of a step: a stop that is missed by no more, as decimals of an irrational number do, is met.
_MET = Decimal("1e-9")


def omega_of(omega: float | None, hertz: float | None, height: float | None) -> float:
    """Ω, or from a frequency and the height of the driven end: Ω = 2πf √(2Z₀/g).

    >>> round(omega_of(None, 1.2, 0.81), 4)
    3.0645
    """
    from asymptotics.checks import finite_number
    from asymptotics.errors import InputError

    if omega is not None:
        if hertz is not None or height is not None:
            raise InputError("--omega and --hz with --height both say how fast; give one")
        return omega
    if hertz is None or height is None:
        raise InputError("give --omega, or --hz in hertz with --height in metres")
    from asymptotics.problems.rope import STANDARD_GRAVITY

    f, z = finite_number("--hz", hertz), finite_number("--height", height)
    if not (f > 0 and z > 0):
        raise InputError(f"--hz {f!r}, --height {z!r}: both have to be positive")
    return 2 * math.pi * f * math.sqrt(2 * z / STANDARD_GRAVITY)


def numbers_of(option: str, text: str) -> list[float]:
    """Numbers separated by commas, and grids start:stop:step with both ends.

    >>> numbers_of("--tau", "0:0.3:0.1,2")
    [0.0, 0.1, 0.2, 0.3, 2.0]
    """
    from asymptotics.errors import InputError

    values: list[float] = []
    for part in text.replace(",", " ").split():
        values += _grid(option, part) if ":" in part else [_number(option, part)]
        if len(values) > MOST_NUMBERS:
            raise InputError(f"{option}: more than {MOST_NUMBERS} numbers; give fewer")
    if not values:
        raise InputError(f"{option} is empty: give at least one number")
    return values


def _grid(option: str, text: str) -> list[float]:
    """start, start + step, … with the stop when it is met up to rounding; exact in decimals."""
    from asymptotics.errors import InputError

    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(f"{option} {text!r}: a grid is start:stop:step, for instance 0:6:0.1")
    rounded = [_number(option, part) for part in parts]
    if not all(map(math.isfinite, rounded)):
        raise InputError(f"{option} {text!r}: give finite numbers")
    start, stop, step = map(Decimal, parts)
    count = (stop - start) / step if rounded[2] else Decimal(-1)
    if count < 0:
        raise InputError(
            f"{option} {text!r}: steps of {step} do not lead from {start} to {stop}; give a step "
            "≠ 0 towards the stop"
        )
    if count >= MOST_NUMBERS:
        raise InputError(
            f"{option} {text!r}: {count:.3g} numbers; give at most {MOST_NUMBERS}, with a longer "
            "step"
        )
    steps = int(count + _MET)
    values = [float(start + i * step) for i in range(steps + 1)]
    if abs(count - steps) <= _MET:
        values[-1] = float(stop)
    return values


def _number(option: str, text: str) -> float:
    from asymptotics.errors import InputError

    try:
        return float(text)
    except ValueError:
        raise InputError(
            f"{option} {text!r}: not a number; give numbers separated by commas, 0.1,0.2, or a "
            "grid start:stop:step, 0:6:0.1"
        ) from None
