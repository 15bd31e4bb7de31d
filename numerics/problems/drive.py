"""The motion Z(τ) of the driven end, in units of Z₀, and its derivative.

Both are vectorised functions of τ. A rope that starts from rest needs Z′(0) = 0; the height Z(0) it
rests at may be any positive number.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import wraps
from typing import Any, ParamSpec

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numerics.errors import InputError

Array = NDArray[np.float64]
P = ParamSpec("P")

LOWEST, HIGHEST = 1e-100, 1e100
"""The frequencies between which Ω² and 2π/Ω, and some thousand of either, are finite."""


@dataclass(frozen=True)
class Drive:
    """Z(τ) and Z′(τ).

    Attributes
    ----------
    height, slope
        Z and Z′: functions of an array of times, in units of x₀/c.
    label
        What identifies the motion, in files and checkpoints: two drives with one label are taken
        to be the same.
    omega
        Ω of a (nearly) periodic drive; None otherwise. Runs are measured in its periods.
    curvature
        Z″, if at hand; only the exact string asks for it, and does without.

    A drive of this module pickles and deep-copies; one of your own does where its functions do.

    Examples
    --------
    A tap: the end rises by ε for a moment.

    >>> tap = Drive(lambda t: 1 + 0.1 * t**2 * np.exp(-t * t),
    ...             lambda t: 0.2 * t * (1 - t * t) * np.exp(-t * t), "tap 0.1")
    >>> float(tap.height(np.array(0.0)))
    1.0
    """

    height: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    label: str
    omega: float | None = None
    curvature: Callable[[Array], Array] | None = None

    def __post_init__(self) -> None:
        if not (callable(self.height) and callable(self.slope)):
            raise InputError("a drive needs functions of an array of times: Z and its derivative")
        if not self.label:
            raise InputError("a drive needs a label: files and checkpoints are told apart by it")
        if self.omega is not None:
            object.__setattr__(self, "omega", frequency(self.omega))

    @property
    def period(self) -> float:
        """2π/Ω.

        Raises
        ------
        InputError
            The drive has no frequency.
        """
        if self.omega is None:
            raise InputError(
                f"the drive {self.label!r} has no period: give Omega, or times instead of periods"
            )
        return 2 * math.pi / self.omega


class _Part:
    """One function of a drive, pickled as the call that made the drive."""

    def __init__(self, function: Callable[[Array], Array], name: str, origin: Any) -> None:
        self.function, self.name, self.origin = function, name, origin

    def __call__(self, t: Array) -> Array:
        return self.function(t)

    def __reduce__(self) -> tuple[Any, ...]:
        return _part, (self.name, *self.origin)


def _part(name: str, make: Callable[..., Drive], args: Any, kwargs: Any) -> Any:
    return getattr(make(*args, **kwargs), name)


def picklable(make: Callable[P, Drive]) -> Callable[P, Drive]:
    """Let the drives that a module's function makes be pickled, with all that holds them."""

    @wraps(make)
    def made(*args: P.args, **kwargs: P.kwargs) -> Drive:
        drive = make(*args, **kwargs)
        parts: dict[str, Any] = {
            name: _Part(getattr(drive, name), name, (made, args, kwargs))
            for name in ("height", "slope", "curvature")
            if getattr(drive, name) is not None
        }
        return replace(drive, **parts)

    return made


@picklable
def at_rest(height: float = 1.0) -> Drive:
    """Z = ``height`` for ever.

    >>> at_rest().height(np.array([0.0, 3.0]))
    array([1., 1.])
    """
    z = positive("height", height)

    def nothing(t: Array) -> Array:
        return np.zeros(np.shape(t))

    return Drive(lambda t: np.full(np.shape(t), z), nothing, f"rest {z!r}", curvature=nothing)


@picklable
def cosine(omega: float, epsilon: float) -> Drive:
    """Z = 1 + ε cos Ωτ for all τ ≥ 0, the paper's eq. (forcing); the start is sudden.

    >>> round(float(cosine(2.0, 0.1).height(np.array(np.pi / 2))), 12)
    0.9
    """
    omega, epsilon = check_amplitude(omega, epsilon)
    return Drive(
        lambda t: 1 + epsilon * np.cos(omega * t),
        lambda t: -epsilon * omega * np.sin(omega * t),
        f"cosine {omega!r} {epsilon!r}",
        omega,
        lambda t: -epsilon * omega**2 * np.cos(omega * t),
    )


@picklable
def fourier(
    omega: float,
    waves: Mapping[int, complex],
    level: float = 1.0,
    begin: float = 1.0,
    periods: float = 5.0,
) -> Drive:
    """Z = level + f(τ) Re Σ a_j e^{ijΩτ} for all τ ≥ 0, f going from ``begin`` to 1.

    In so many periods, like :func:`ramped_cosine`'s r. At ``begin`` = 1 the start is sudden.

    >>> drive = fourier(2.0, {1: 0.1, 3: -0.02j})
    >>> wanted = 1 + 0.1 * np.cos(1.4) + 0.02 * np.sin(4.2)
    >>> bool(abs(drive.height(np.array(0.7)) - wanted) < 1e-12)
    True
    """
    omega, level, begin = frequency(omega), positive("level", level), finite("begin", begin)
    length = positive("periods", periods) * 2 * math.pi / omega
    rates = 1j * omega * np.array(sorted(waves), dtype=float)
    sizes = np.array([complex(waves[j]) for j in sorted(waves)])
    if not np.isfinite(sizes).all():
        raise InputError(f"the amplitudes {dict(waves)!r} have to be finite")

    def moved(t: Array) -> list[Array]:
        turning = np.exp(np.asarray(t, dtype=float)[..., None] * rates)
        return [np.asarray((turning @ (rates**d * sizes)).real) for d in range(3)]

    def risen(t: Array) -> list[Array]:
        step, rate, bend = smooth_step(np.asarray(t, dtype=float) / length)
        part = 1 - begin
        return [begin + part * step, part * rate / length, part * bend / length**2]

    def height(t: Array) -> Array:
        return level + risen(t)[0] * moved(t)[0]

    def slope(t: Array) -> Array:
        (z, v, _), (f, df, _) = moved(t), risen(t)
        return df * z + f * v

    def curvature(t: Array) -> Array:
        (z, v, a), (f, df, ddf) = moved(t), risen(t)
        return ddf * z + 2 * df * v + f * a

    label = f"fourier {omega!r} {level!r} {sorted(waves.items())!r}"
    label += "" if begin == 1 else f" from {begin!r} in {periods!r}"
    return Drive(height, slope, label, omega, curvature)


@picklable
def ramped_cosine(omega: float, epsilon: float, periods: float = 20.0) -> Drive:
    """Z = 1 + ε r(τ) cos Ωτ with r rising from 0 at τ = 0 to 1 after ``periods`` forcing periods.

    r is :func:`smooth_step`: all its derivatives vanish at both ends, so that a long ramp leaves
    no free oscillation to any power of its rate. (The paper's experiment ramps over 20 periods.)

    Examples
    --------
    >>> drive = ramped_cosine(2.0, 0.1, periods=10)
    >>> drive.height(np.array([0.0, 10 * drive.period])).tolist()
    [1.0, 1.1]
    """
    omega, epsilon = check_amplitude(omega, epsilon)
    periods = positive("ramp periods", periods)
    length = periods * 2 * math.pi / omega

    def height(t: Array) -> Array:
        return 1 + epsilon * smooth_step(t / length)[0] * np.cos(omega * t)

    def slope(t: Array) -> Array:
        step, rate, _ = smooth_step(t / length)
        turns = omega * t
        return epsilon * (rate / length * np.cos(turns) - step * omega * np.sin(turns))

    def curvature(t: Array) -> Array:
        step, rate, bend = smooth_step(t / length)
        even = bend / length**2 - step * omega**2
        return epsilon * (even * np.cos(omega * t) - 2 * rate / length * omega * np.sin(omega * t))

    label = f"ramped cosine {omega!r} {epsilon!r} {periods!r}"
    return Drive(height, slope, label, omega, curvature)


def smooth_step(x: ArrayLike) -> tuple[Array, Array, Array]:
    r"""r, r′ and r″: :math:`r = 1/(1 + e^{1/x − 1/(1−x)})` between 0 and 1, constant outside.

    >>> [float(value) for value in smooth_step(0.5)]
    [0.5, 2.0, 0.0]
    """
    x = np.asarray(x, float)
    inside = (x > 0) & (x < 1)
    # Nearer to the ends the exponential overflows, and r is 0 or 1 to the last bit.
    y = np.clip(x, 1 / 700, 1 - 1 / 700)
    rise = 1 / (1 + np.exp(1 / y - 1 / (1 - y)))
    first, second = 1 / y**2 + 1 / (1 - y) ** 2, 2 / (1 - y) ** 3 - 2 / y**3
    rate = rise * (1 - rise) * first
    bend = (1 - 2 * rise) * rate * first + rise * (1 - rise) * second
    outside = np.where(x >= 1, 1.0, 0.0)
    return (
        np.where(inside, rise, outside),
        np.where(inside, rate, 0.0),
        np.where(inside, bend, 0.0),
    )


def check_amplitude(omega: float, epsilon: float) -> tuple[float, float]:
    """Ω > 0 and |ε| < 1, so that the end stays above the ground."""
    omega, epsilon = frequency(omega), finite("epsilon", epsilon)
    if abs(epsilon) >= 1:
        raise InputError(
            f"epsilon = {epsilon!r} takes the driven end down to Z = {1 - abs(epsilon):.3g} ≤ 0; "
            "the height 1 + ε cos Ωτ must stay above the ground: take |epsilon| < 1"
        )
    return omega, epsilon


def frequency(omega: Any) -> float:
    """Ω between LOWEST and HIGHEST."""
    number = positive("Omega", omega)
    if not LOWEST <= number <= HIGHEST:
        raise InputError(
            f"Omega = {omega!r}: its powers and its period leave double precision; take "
            f"{LOWEST:g} ≤ Omega ≤ {HIGHEST:g}"
        )
    return number


def finite(name: str, value: Any) -> float:
    """``value`` as a finite float.

    >>> finite("beta", "1e-2")
    0.01
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r}: give a number") from None
    if not math.isfinite(number):
        raise InputError(f"{name} = {value!r}: give a finite number")
    return number


def positive(name: str, value: Any) -> float:
    """``value`` as a finite float > 0."""
    number = finite(name, value)
    if number <= 0:
        raise InputError(f"{name} = {value!r}: give a number > 0")
    return number


def non_negative(name: str, value: Any) -> float:
    """``value`` as a finite float ≥ 0."""
    number = finite(name, value)
    if number < 0:
        raise InputError(f"{name} = {value!r}: give a number ≥ 0")
    return number


def whole(name: str, value: Any, least: int = 1) -> int:
    """``value`` as an integer that is not below ``least``.

    >>> whole("workers", 2.0)
    2
    """
    number = finite(name, value)
    if number != int(number) or number < least:
        raise InputError(f"{name} = {value!r}: give a whole number, at least {least}")
    return int(number)
