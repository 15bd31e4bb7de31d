r"""The forced string, exact in everything: frequencies, cotangents and amplitudes as generators.

No relation between the generators is used, so a formula holds for any number of incommensurate
frequencies; with one frequency, :class:`~asymptotics.rings.cotangent.CotangentRing` also knows how
its cotangents are related (:func:`asymptotics.problems.string.string_problem` with a ``drive``).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from flint import acb

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.problems.forcing import FourierDrive, Index, excited, packed_index
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import driven_string
from asymptotics.rings.harmonics import unpack
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import GeneratorRing


@remembering
def generator_string(harmonics: Sequence[Index], order: int, sines: bool = True) -> Problem[Any]:
    r"""The string under a drive with the given harmonics, exact in everything.

    Over ℚ[Ω_i, κ_n, A_n]: the frequencies, κ_n = cot n·Ω of every combination up to ``order``, and
    the scaled amplitudes :math:`A_n = c_n/\sin n·Ω` (A₀ = c₀). The small parameter is ε.

    Parameters
    ----------
    harmonics
        Indices of the drive, as in :func:`fourier_drive`. The generators of n are named k1, A1 or,
        with several frequencies, k1_m2, A1_m2 for n = (1, −2).
    order
        The highest order it will be expanded to.
    sines
        Whether A_n is complex, with the generator ``…_`` for its conjugate.

    Examples
    --------
    >>> from asymptotics import expand
    >>> solution = expand(generator_string([1, 2], 2, sines=False), 2)
    >>> solution.contact(2)[2]             # A₁ = 1/2: the paper's drive
    -1/4*Omega^3*k2*A1^2
    >>> solution.contact(2)[3]
    -3/2*Omega^3*k3*A1*A2
    """
    order = check_order(order)
    count = len(harmonics[0]) if isinstance(harmonics[0], tuple) else 1
    packed = [packed_index(index, count) for index in harmonics]
    if any(j < 0 for j in packed) or len(set(packed)) < len(packed):
        raise InputError(
            f"harmonics {list(harmonics)!r}: give each once, with a first non-zero index > 0"
        )
    indices = [j for j in excited(packed, order) if j]
    rates = ["Omega"] if count == 1 else [f"Omega{i}" for i in range(1, count + 1)]
    amplitudes = {j: "A" + _label(j, count) for j in packed}
    names = rates + ["k" + _label(j, count) for j in indices] + list(amplitudes.values())
    conjugates: dict[str, tuple[int, str]] = {}
    if sines:
        for j, name in amplitudes.items():
            if j:
                names.append(name + "_")
                conjugates |= {name: (1, name + "_"), name + "_": (1, name)}
    ring = GeneratorRing(names, conjugates)

    @cache
    def rate(j: int) -> Any:
        return ring.sum(
            ring.rational(n) * ring[name] for n, name in zip(unpack(j, count), rates, strict=True)
        )

    def cot(j: int) -> Any:
        return ring["k" + _label(j, count)]

    return driven_string(
        f"string with harmonics {list(harmonics)!r}",
        ring,
        stiffness=lambda j: rate(j) * rate(j),
        impedance=lambda j: rate(j) * cot(j),
        source=rate,
        drive={j: ring[name] for j, name in amplitudes.items()},
        equation_residual=lambda j, w: w[2] + rate(j) * rate(j) * w[0],
        # W(0) over sin(n·Ω), whose amplitude there is A.
        end_residual=lambda j, w: rate(j) * cot(j) * w[0] - w[1],
        end_unit=rate,
    )


def _label(packed: int, count: int) -> str:
    """The end of a generator's name: 3, or 2_m1 for (2, −1)."""
    return "_".join(str(n).replace("-", "m") for n in unpack(packed, count))


def generator_values(drive: FourierDrive, order: int, enclosed: bool = False) -> dict[str, Any]:
    """Numbers for the generators of :func:`generator_string`, for the harmonics of one drive.

    In doubles; or, ``enclosed``, balls in the precision of the moment, over which
    :meth:`~asymptotics.rings.ring.GeneratorRing.evaluate` bounds its own error.

    >>> import math
    >>> from asymptotics.problems.forcing import fourier_drive
    >>> drive = fourier_drive([0.83], {1: 1.0})
    >>> values = generator_values(drive, 2)
    >>> sorted(values), round(values["A1"].real * math.sin(0.83), 12)
    (['A1', 'A1_', 'Omega', 'k1', 'k2'], 0.5)
    """
    count = len(drive.frequencies)
    heads = ["Omega"] if count == 1 else [f"Omega{i}" for i in range(1, count + 1)]
    number: Any = acb if enclosed else complex
    circular: Any = drive.enclosed_circular if enclosed else drive.circular
    values = {name: number(x) for name, x in zip(heads, drive.frequencies, strict=True)}
    for j in excited(list(drive.amplitudes), order):
        if j:
            _, c, s = circular(j)
            values["k" + _label(j, count)] = number(c / s)
    for j, c_j in drive.amplitudes.items():
        name = "A" + _label(j, count)
        values[name] = number(c_j) / (circular(j)[2] if j else 1)
        if j:
            values[name + "_"] = values[name].conjugate()
    return values
