r"""The string under any finite Fourier drive, with one frequency or several.

.. math:: W(0, τ) = 1 + ε\, ΔZ(τ), \qquad
          ΔZ = \sum_n \bigl(a_n \cos θ_n + b_n \sin θ_n\bigr), \quad
          θ_n = n·Ω\, τ = (n_1 Ω_1 + n_2 Ω_2 + …)\, τ

The paper's eq. (forcing) is ΔZ = cos Ωτ. Every combination n of the frequencies behaves as one
harmonic does there: its wavenumber is n·Ω, its impedance n·Ω cot n·Ω. No 1/sin can be taken out of
several harmonics at once, so the small parameter is ε itself. A combination with n·Ω = 0 is like
the mean (x cot x → 1), so that commensurate frequencies may be given as if they were not; one with
n·Ω = pπ, p ≠ 0, resonates.

Sine terms make the state uneven in time: the coefficients are complex then.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import acb, arb, fmpq

from asymptotics.checks import check_order
from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import check_frequency, driven_string, pole_at
from asymptotics.rings.balls import AcbRing, ArbRing
from asymptotics.rings.harmonics import pack, reachable, unpack
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import ComplexRing, FloatRing, Ring

Index = int | tuple[int, ...]
Array = npt.NDArray[Any]


@dataclass(frozen=True)
class FourierDrive:
    """ΔZ(τ) = Σ_n (c_n e^{iθ_n} + c.c.), the mean counted once; made by :func:`fourier_drive`.

    Attributes
    ----------
    frequencies
        (Ω_1, Ω_2, …).
    amplitudes
        c_n by the packed index n ≥ 0 (:func:`~asymptotics.rings.harmonics.pack`).
    """

    frequencies: tuple[float, ...]
    amplitudes: Mapping[int, complex]

    @property
    def even(self) -> bool:
        """Whether there are cosines only."""
        return all(c.imag == 0 for c in self.amplitudes.values())

    def rate(self, packed: int) -> tuple[float, float]:
        """n·Ω of the doubles Ω as they stand, as a double and what its rounding lost.

        >>> high, low = fourier_drive([0.1, 0.3], {(1, 0): 1.0}).rate(pack((3, -1)))
        >>> high, low                # 3 · 0.1 − 0.3 of the doubles, not of the decimals
        (2.7755575615628914e-17, 0.0)
        """
        exact = self.exact_rate(packed)
        high = float(exact)
        return high, float(exact - Fraction(high))

    def exact_rate(self, packed: int) -> Fraction:
        """n·Ω of the doubles Ω as they stand."""
        indices = unpack(packed, len(self.frequencies))
        return sum(
            (n * Fraction(omega) for n, omega in zip(indices, self.frequencies, strict=True)),
            Fraction(0),
        )

    def circular(self, packed: int) -> tuple[float, float, float]:
        """x = n·Ω, cos x and sin x, to a few ulp of their own even next to a pole of cot x."""
        x, lost = self.rate(packed)
        c, s = math.cos(x), math.sin(x)
        return x, c - lost * s, s + lost * c

    def enclosed_circular(self, packed: int) -> tuple[arb, arb, arb]:
        """The same as balls in the precision of the moment."""
        exact = self.exact_rate(packed)
        x = arb(fmpq(exact.numerator, exact.denominator))
        return x, x.cos(), x.sin()

    def phase(self, packed: int, tau: npt.ArrayLike) -> Array:
        """θ_n at the times τ, any shape."""
        return self.rate(packed)[0] * np.asarray(tau, dtype=float)

    def __call__(self, tau: npt.ArrayLike) -> Array:
        """ΔZ at the times τ, any shape."""
        total = np.zeros(np.shape(tau))
        for n, c in self.amplitudes.items():
            wave = c * np.exp(1j * self.phase(n, tau))
            total += (2.0 if n else 1.0) * wave.real
        return total

    def delayed(self, time: float) -> FourierDrive:
        """The drive ΔZ(τ − time)."""
        shifted = {
            n: c * cmath.exp(-1j * self.rate(n)[0] * time) for n, c in self.amplitudes.items()
        }
        return FourierDrive(self.frequencies, shifted)


def fourier_drive(
    frequencies: Sequence[float],
    cosines: Mapping[Index, float],
    sines: Mapping[Index, float] | None = None,
) -> FourierDrive:
    """ΔZ(τ) = Σ a_n cos θ_n + b_n sin θ_n, in units of Z₀.

    Parameters
    ----------
    frequencies
        Ω_1, Ω_2, …, positive.
    cosines, sines
        a_n and b_n by the harmonic index n: a whole number where there is one frequency, else a
        tuple with one whole number for each. Index 0 is a shift of the mean height.

    Raises
    ------
    InputError
        No or bad frequencies, indices that do not fit them, amplitudes that are not finite, or
        nothing but zeros.

    Examples
    --------
    >>> drive = fourier_drive([0.8], {1: 1.0, 3: 0.25}, {2: 0.5})
    >>> drive.amplitudes
    {1: (0.5+0j), 3: (0.125+0j), 2: -0.25j}
    >>> fourier_drive([0.8, 1.3], {(1, 0): 1.0, (0, 1): 1.0}).even
    True
    """
    if not frequencies:
        raise InputError("frequencies is empty: give at least one frequency Ω = ωx₀/c")
    omegas = tuple(check_frequency(omega, 0) for omega in frequencies)
    amplitudes: dict[int, complex] = {}
    for values, unit in ((cosines, 1.0 + 0j), (sines or {}, -1j)):
        for index, value in values.items():
            packed, size = packed_index(index, len(omegas)), _amplitude(index, value)
            c = unit * (size if packed == 0 else 0.5 * size)
            if packed == 0 and unit != 1:
                continue  # sin 0
            total = amplitudes.get(abs(packed), 0) + (c if packed >= 0 else c.conjugate())
            amplitudes[abs(packed)] = complex(total.real + 0.0, total.imag + 0.0)
    amplitudes = {n: c for n, c in amplitudes.items() if c}
    if not amplitudes:
        raise InputError("the drive is zero: give at least one amplitude that is not")
    return FourierDrive(omegas, amplitudes)


def packed_index(index: Any, count: int) -> int:
    """The packed form of a harmonic index as :func:`fourier_drive` takes it.

    >>> packed_index((1, -2), 2) == pack((1, -2))
    True
    """
    indices = index if isinstance(index, tuple) else (index,)
    if len(indices) != count or any(
        isinstance(n, bool) or not isinstance(n, int) or abs(n) > 1000 for n in indices
    ):
        raise InputError(
            f"harmonic index {index!r}: give {count} whole number(s) up to 1000 in size, one for "
            "each frequency"
        )
    return pack(indices)


def _amplitude(index: Any, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"amplitude {value!r} of harmonic {index!r} is not a finite number")
    return number


def excited(drive: Sequence[int], order: int) -> list[int]:
    """Packed harmonics ≥ 0 that some order up to ``order`` can excite.

    >>> excited([2], 3)
    [0, 2, 4, 6]
    """
    return sorted({j for n in range(1, order + 1) for j in reachable(drive, n)})


@remembering
def forced_string(drive: FourierDrive, order: int) -> Problem[Any]:
    """The string under a drive, in double precision; for
    :func:`asymptotics.expansion.order_loop.expand`.

    The ring is real where the drive has cosines only, else complex. The small parameter is ε.

    Raises
    ------
    InputError
        ``order`` is no whole number ≥ 1.
    ResonanceError
        A combination frequency that ``order`` excites is at, or numerically at, pπ, p ≠ 0.

    Examples
    --------
    >>> from asymptotics import expand
    >>> solution = expand(forced_string(fourier_drive([0.83], {1: 1.0}), 2), 2)
    >>> round(2 * solution.contact(1)[1], 6)       # Ω/(2 sin Ω), eq. (linresponse1)
    0.562383
    """
    order = check_order(order)
    _check_resonances(drive, order)
    ring: Ring[Any] = FloatRing() if drive.even else ComplexRing()

    amplitudes = {j: c.real if drive.even else c for j, c in drive.amplitudes.items()}
    problem = _forced(drive, ring, drive.circular, amplitudes)
    return replace(problem, balls=lambda: ball_forced_string(drive))


@remembering
def ball_forced_string(drive: FourierDrive) -> Problem[Any]:
    """:func:`forced_string` over balls, of the doubles in the drive as they stand; no resonance is
    refused. Make it, and expand it, within :func:`~asymptotics.rings.precision.at_precision`.
    """
    amplitudes = {j: acb(c) for j, c in drive.amplitudes.items()}
    if drive.even:
        real = {j: c.real for j, c in amplitudes.items()}
        return _forced(drive, ArbRing(), drive.enclosed_circular, real)
    return _forced(drive, AcbRing(), drive.enclosed_circular, amplitudes)


def _forced(
    drive: FourierDrive,
    ring: Ring[Any],
    circle: Callable[[int], tuple[Any, Any, Any]],
    amplitudes: Mapping[int, Any],
) -> Problem[Any]:
    """The string with x, cos x, sin x of each combination, x = n·Ω, from ``circle``."""
    circular = cache(circle)

    def impedance(j: int) -> Any:
        x, c, s = circular(j)
        return 1 if x == 0 else x * c / s

    def source(j: int) -> Any:
        x, _, s = circular(j)
        return 1 if x == 0 else x / s

    def end_residual(j: int, w: Sequence[Any]) -> Any:
        x, c, s = circular(j)
        return w[0] * c - w[1] * (1 if x == 0 else s / x)

    return driven_string(
        f"string at {drive.frequencies!r} under {dict(drive.amplitudes)!r}",
        ring,
        stiffness=lambda j: ring.one * circular(j)[0] ** 2,
        impedance=lambda j: ring.one * impedance(j),
        source=lambda j: ring.one * source(j),
        drive=amplitudes,
        equation_residual=lambda j, w: w[2] + circular(j)[0] ** 2 * w[0],
        end_residual=end_residual,
        end_unit=lambda j: ring.one,
    )


def _check_resonances(drive: FourierDrive, order: int) -> None:
    """As :func:`~asymptotics.problems.string.check_frequency`, for every combination the order
    excites.
    """
    for j in excited(list(drive.amplitudes), order):
        x = drive.rate(j)[0]
        p = pole_at(abs(x))
        if p == 0:
            continue
        n = unpack(j, len(drive.frequencies))
        q = n[0] if len(n) == 1 else 1
        p, q = p // math.gcd(p, q), q // math.gcd(p, q)
        what = "n = " + ", ".join(map(str, n))
        raise ResonanceError(
            f"frequencies {drive.frequencies!r}: the combination {what} has n·Omega = {x!r}, "
            f"numerically at the resonance p/q = {p}/{q}, where order {order} has a pole; move a "
            "frequency away, or ask for a lower order",
            p,
            q,
        )
