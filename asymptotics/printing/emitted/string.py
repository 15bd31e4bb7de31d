"""Rope with a moving contact, string limit (beta = 0), through order 1 in epsilon.

Order 1 is written by hand; asymptotics.printing.numpy_code puts in the amplitudes of the others.

    contact(tau, omega, epsilon)      x_c/x0, eq. (expand)
    profile(s, tau, omega, epsilon)   w/Z0, eq. (expandw)
    contact_error, profile_error      bounds on the rounding error of the two

All arguments are dimensionless and broadcast against one another:

    omega    angular frequency times x0/c, with x0**2 = 2 T Z0/(rho g) and c**2 = T/rho
    epsilon  forcing amplitude in units of Z0: w/Z0 = 1 + epsilon cos(omega tau) at the driven end
    tau      c t/x0
    s        (x - x_c)/x0: negative on the lifted rope, down to -x_c/x0 at the driven end

Both are plain series in epsilon: powers beyond ORDER are dropped, and nothing says that those kept
still decrease. They are singular at the resonances omega = p pi/q, q <= ORDER, and lose their
ordering next to them long before the digits run out.

nan is no result. It says that there is none:

    at a resonance, or so near that less than half the digits of cot(q omega) are right
    where omega is not positive, so small that its powers underflow, or beyond 2**20 (for doubles)
    where s is beyond the driven end
    where an argument is not finite, or so large that the series overflows

On the ground, s > 0, the profile is 0.

Every function takes the array namespace as ``xp``: NumPy by default, any Array-API one otherwise,
also inside of what transforms or compiles functions (jit, grad, vmap). Numbers are double
precision, or what the namespace grants when it is asked for double; arguments are what they are in
that format, and the bounds are in its own unit roundoff.
"""

from math import frexp
from typing import Any

import numpy as np

ORDER = 1

# The highest power of omega in an amplitude.
POWER = 1

# No term passes through more roundings than this on its way into contact() or profile().
ROUNDINGS = 32

# NumPy works through arguments with more elements than this in pieces.
BLOCK = 8192


def contact(tau: Any, omega: Any, epsilon: Any, xp: Any = np) -> Any:
    """x_c/x0 at the times tau, through epsilon**ORDER."""
    return _in_blocks(_contact, _floats((tau, omega, epsilon), xp), xp)


def _contact(tau: Any, omega: Any, epsilon: Any, xp: Any) -> Any:
    cotangents, regular = _cotangents(omega, xp)
    harmonics = _contact_harmonics(omega, epsilon / xp.sin(omega), cotangents)
    place = _place(harmonics, _cosines(omega * tau, xp))
    return xp.where(regular & xp.isfinite(place), place, _constant("nan", omega, xp))


def profile(s: Any, tau: Any, omega: Any, epsilon: Any, xp: Any = np) -> Any:
    """w/Z0 at the distance s from the contact point and the times tau, through epsilon**ORDER."""
    return _in_blocks(_profile, _floats((s, tau, omega, epsilon), xp), xp)


def _profile(s: Any, tau: Any, omega: Any, epsilon: Any, xp: Any) -> Any:
    cotangents, regular = _cotangents(omega, xp)
    small, cosines = epsilon / xp.sin(omega), _cosines(omega * tau, xp)
    lifted = xp.where(s < 0.0, s, 0.0 * s)
    amplitudes = _profile_amplitudes(omega, small, cotangents)
    functions = _shape_functions(omega * lifted, xp)
    shapes = [
        sum(a * functions[k - 1][kind] for (k, kind), a in amplitudes[j].items())
        for j in range(ORDER + 1)
    ]
    shapes[0] = lifted * lifted + shapes[0]
    w = _combine(shapes, cosines, xp)
    harmonics = _contact_harmonics(omega, small, cotangents)
    if xp is np and np.all(regular):
        shortest = 1.0 + harmonics[0] - sum(abs(h) for j, h in harmonics.items() if j)
        if np.all(s >= -shortest):
            return w
    # What misses the driven end by less than half the digits of x_c/x0 is the driven end.
    reach, nan = (
        _place(harmonics, cosines) + _epsilon(omega, xp) ** 0.5,
        _constant("nan", omega, xp),
    )
    return xp.where(s >= xp.where(regular & xp.isfinite(reach), -reach, nan), w, nan)


def contact_error(tau: Any, omega: Any, epsilon: Any, xp: Any = np) -> Any:
    """A bound on the rounding error of contact(), to first order in the unit roundoff.

    Infinite where omega is such that there is no result.
    """
    tau, omega, epsilon = _floats((tau, omega, epsilon), xp)
    magnitudes, regular = _magnitudes(omega, epsilon, xp)
    harmonics = _contact_harmonics(*magnitudes)
    phase = xp.abs(omega * tau)
    total = 1.0 + _value(harmonics[0]) + 0.0 * phase
    for j in range(1, ORDER + 1):
        total = total + _value(harmonics[j]) * (1.0 + j * phase)
    bound = 0.5 * _epsilon(omega, xp) * ROUNDINGS * total
    return xp.where(regular, bound, _constant("inf", omega, xp))


def profile_error(s: Any, tau: Any, omega: Any, epsilon: Any, xp: Any = np) -> Any:
    """A bound on the rounding error of profile(), to first order in the unit roundoff.

    Infinite where omega is such that there is no result.
    """
    s, tau, omega, epsilon = _floats((s, tau, omega, epsilon), xp)
    magnitudes, regular = _magnitudes(omega, epsilon, xp)
    s = xp.where(s < 0.0, s, 0.0 * s)
    amplitudes = _profile_amplitudes(*magnitudes)
    x, phase = xp.abs(omega * s), xp.abs(omega * tau)
    total = s * s + 0.0 * phase
    for j, parts in amplitudes.items():
        for (k, kind), a in parts.items():
            kx = k * x
            # |1 - cos kx| or |kx - sin kx|, with the error of its recurrence relative to k**2.
            size = xp.where(kx < 1.0, kx ** (2 + kind), kind * kx + 2.0)
            total = total + k * k * (1.0 + x) * size * _value(a) * (1.0 + j * phase)
    bound = 0.5 * _epsilon(omega, xp) * ROUNDINGS * total
    return xp.where(regular, bound, _constant("inf", omega, xp))


def _contact_harmonics(o: Any, e: Any, k: Any) -> dict[int, Any]:
    """{j: amplitude of cos(j omega tau) in x_c/x0}, with o = omega, e = epsilon/sin(omega)."""
    (k1,) = k
    h1 = e * o / 2
    return {0: 0.0, 1: h1}


def _profile_amplitudes(o: Any, e: Any, k: Any) -> dict[int, dict[tuple[int, int], Any]]:
    """{j: {(k, kind): amplitude}} of cos(j omega tau) times a function of the position:

    kind 0, 1 - cos(k omega s), named v; kind 1, k omega s - sin(k omega s), named d.
    """
    (k1,) = k
    d1_1 = e
    return {
        0: {},
        1: {(1, 1): d1_1},
    }


def _floats(arguments: tuple[Any, ...], xp: Any) -> list[Any]:
    """The arguments as arrays that broadcast against one another."""
    arrays = [xp.asarray(a, dtype=xp.float64) for a in arguments]
    shapes = [tuple(a.shape) for a in arrays]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        raise ValueError(
            f"arguments of shapes {', '.join(map(str, shapes))} do not broadcast against one "
            "another; put times in rows, tau[:, None], and positions in columns"
        ) from None
    return arrays


def _in_blocks(function: Any, arguments: list[Any], xp: Any) -> Any:
    """function(*arguments, xp); of NumPy in blocks that stay in the processor's cache."""
    if xp is not np or max(a.size for a in arguments) <= BLOCK:
        return function(*arguments, xp)
    shape = np.broadcast_shapes(*(a.shape for a in arguments))
    out = np.empty(shape)
    rows = BLOCK * shape[0] // out.size
    for i in range(0, shape[0], max(rows, 1)):
        cut = slice(i, i + rows) if rows else i
        whole = slice(None) if rows else 0
        part = [
            a if a.ndim < len(shape) else a[(cut if a.shape[0] > 1 else whole), ...]
            for a in arguments
        ]
        out[cut, ...] = function(*part, xp) if rows else _in_blocks(function, part, xp)
    return out


def _place(harmonics: dict[int, Any], cosines: list[Any]) -> Any:
    """x_c/x0 from its harmonics."""
    total = 1.0 + harmonics[0]
    for j, cosine in enumerate(cosines, start=1):
        total = total + harmonics[j] * cosine
    return total


def _combine(shapes: list[Any], cosines: list[Any], xp: Any) -> Any:
    """shapes[0] + sum of shapes[j] cos(j phase)."""
    times = cosines[0]
    if xp is np and times.ndim == 2 and times.shape[1] == 1 and all(f.ndim == 1 for f in shapes):
        # An open grid, rows over tau and columns over s, is one matrix product. (Elsewhere a matrix
        # product may be done in a narrower format.)
        rows = np.stack([np.ones_like(times[:, 0]), *(c[:, 0] for c in cosines)], axis=1)
        return rows @ np.stack(shapes)
    total = shapes[0]
    for shape, cosine in zip(shapes[1:], cosines, strict=True):
        total = total + shape * cosine
    return total


def _epsilon(like: Any, xp: Any) -> float:
    """The distance of 1 to the next number in the format of an array."""
    return float(xp.finfo(like.dtype).eps)


def _constant(value: str, like: Any, xp: Any) -> Any:
    """nan or inf in the format of an array."""
    return xp.asarray(float(value), dtype=like.dtype)


def _cotangents(omega: Any, xp: Any) -> tuple[list[Any], Any]:
    """[cot(omega), cot(2 omega), ...] for the number omega as it stands; and where they are right.

    Near a pole the rounding of q*omega would cost the digits. Split in two halves (Veltkamp), omega
    times q is exact, so what that rounding lost is known and goes back in to first order. What
    remains is an error of a few ulp, relative to which q*omega itself stands 1 ulp off: closer to a
    pole than the root of that, a power of the cotangent keeps no digit.
    """
    epsilon = _epsilon(omega, xp)
    resolution = epsilon**0.5
    digits = 2 - frexp(epsilon)[1]
    scaled = (2.0 ** ((digits + 1) // 2) + 1.0) * omega
    high = scaled - (scaled - omega)
    low = omega - high
    least = float(xp.finfo(omega.dtype).smallest_normal) ** (1.0 / (POWER + 1))
    regular = (omega > least) & (omega < 2.0**-6 / resolution)
    cotangents = []
    for q in range(1, ORDER + 1):
        product = q * omega
        lost = (q * high - product) + q * low
        tangent = xp.tan(product)
        distance = xp.abs(tangent + lost)
        clear = (distance > resolution) & (distance > resolution * product)
        regular = regular & (clear | (product < 1.0))  # omega = 0 is no pole of x cot x
        cotangents.append((1.0 - lost * tangent) / (tangent + lost))
    return cotangents, regular


def _cosines(phase: Any, xp: Any) -> list[Any]:
    """[cos(phase), cos(2 phase), ...] by Chebyshev's recurrence."""
    cosine = xp.cos(phase)
    cosines = [cosine]
    before: Any = 1.0
    for _ in range(ORDER - 1):
        cosines.append(2.0 * cosine * cosines[-1] - before)
        before = cosines[-2]
    return cosines


def _shape_functions(x: Any, xp: Any) -> list[tuple[Any, Any]]:
    """(1 - cos kx, kx - sin kx) for k = 1, 2, ...: both small at small x, neither cancels."""
    half = xp.sin(0.5 * x)
    versine = 2.0 * half * half
    square = x * x
    series = 0.0 * x
    for k in range(8, 0, -1):
        series = (1.0 - series) * square * (1.0 / ((2 * k + 1) * (2 * k)))
    defect = xp.where(xp.abs(x) < 1.0, x * series, x - xp.sin(x))
    functions = [(versine, defect)]
    before: tuple[Any, Any] = (0.0, 0.0)
    double = 2.0 * versine
    for k in range(1, ORDER):
        v, g = functions[-1]
        functions.append(
            (2.0 * v - before[0] + double * (1.0 - v), 2.0 * g - before[1] + double * (k * x - g))
        )
        before = (v, g)
    return functions


class _Magnitude:
    """A number that cannot cancel: sums and differences add, signs are dropped."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def __add__(self, other: Any) -> Any:
        return _Magnitude(self.value + _value(other))

    __radd__ = __sub__ = __rsub__ = __add__

    def __mul__(self, other: Any) -> Any:
        return _Magnitude(self.value * _value(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return _Magnitude(self.value / _value(other))

    def __neg__(self) -> Any:
        return self


def _value(number: Any) -> Any:
    """The size of a number or of a _Magnitude."""
    return number.value if isinstance(number, _Magnitude) else abs(number)


def _magnitudes(omega: Any, epsilon: Any, xp: Any) -> tuple[tuple[Any, Any, list[Any]], Any]:
    """The arguments of the amplitude functions as magnitudes; and where omega is regular."""
    cotangents, regular = _cotangents(omega, xp)
    small = xp.abs(epsilon / xp.sin(omega))
    return (
        _Magnitude(xp.abs(omega)),
        _Magnitude(small),
        [_Magnitude(xp.abs(k)) for k in cotangents],
    ), regular
