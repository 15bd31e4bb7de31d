r"""The exact string's map for harmonic drives, compiled: ``thresholds`` calls it.

The drive is :func:`numerics.problems.drive.ramped_cosine`, Z = 1 + ε r(τ) cos Ωτ, whose ramp, with
its first and second derivative, is evaluated only while it lasts. After it the map is the standard
map with K = 2εΩ². Orbits are followed as in :mod:`numerics.exact_string.orbits`, in the order of
their departures s = t_0 + 2k, so that D = dt_k/dt_0 is scanned for minima as it is produced, and no
more than one 2a of labels is stored. A minimum that could hide a zero between two labels is
followed by golden section; a zero is bisected to rounding.

All functions here take plain numbers and unchecked arrays.
"""

from __future__ import annotations

import math

import numpy as np

from numerics.compiled import njit

REACH = 2.0  # 2a, a = √Z(0) = 1
GOLDEN = (math.sqrt(5.0) - 1) / 2
# π/2 in two parts, the first of 33 bits.
HALF_PI = math.floor(math.pi / 2 * 2.0**32) / 2.0**32
HALF_PI_REST = (math.pi / 2 - HALF_PI) + 6.123233995736766e-17


@njit(cache=True)
def ramp(x):  # type: ignore[no-untyped-def]
    """r, r′, r″ of ``smooth_step``, 0 < x < 1."""
    y = 1 - x
    exponent = 1 / x - 1 / y
    if exponent > 700.0:
        return 0.0, 0.0, 0.0
    if exponent < -700.0:
        return 1.0, 0.0, 0.0
    rise = 1 / (1 + math.exp(exponent))
    pull = 1 / (x * x) + 1 / (y * y)
    rate = rise * (1 - rise) * pull
    bend = rate * (1 - 2 * rise) * pull + rise * (1 - rise) * (2 / y**3 - 2 / x**3)
    return rise, rate, bend


@njit(cache=True)
def kick(t, omega, epsilon, length):  # type: ignore[no-untyped-def]
    """2Z′(t) and 2Z″(t), 0 at rest."""
    if t <= 0:
        return 0.0, 0.0
    turns = omega * t
    cosine, sine = math.cos(turns), math.sin(turns)
    strength = 2 * epsilon * omega
    if t >= length:
        return -strength * sine, -strength * omega * cosine
    rise, rate, bend = ramp(t / length)
    rate, bend = rate / length, bend / length**2
    first = 2 * epsilon * rate * cosine - strength * rise * sine
    second = 2 * epsilon * bend * cosine - 2 * strength * rate * sine
    return first, second - strength * omega * rise * cosine


@njit(cache=True)
def stretch(returns, label, omega, epsilon, length):  # type: ignore[no-untyped-def]
    """D_k and the midpoint (t_{k−1} + t_k)/2 of one orbit; a label > 0 is the next return's."""
    if label > 0:
        returns, label = returns + 1, label - REACH
    x, d, dx, dd = 0.0, 0.0, 0.0, 0.0
    middle = label - REACH / 2
    for step in range(1, returns + 1):
        middle = label + REACH * (step - 0.5) + (x + 0.5 * d)
        x += d
        dx += dd
        first, second = kick(label + REACH * step + x, omega, epsilon, length)
        d += first
        dd += second * (1 + dx)
    return 1 + dx, middle


@njit(cache=True)
def lowest(returns, low, high, omega, epsilon, length):  # type: ignore[no-untyped-def]
    """The label in [low, high] where D is least, by golden section, and D there."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left = stretch(returns, left, omega, epsilon, length)[0]
    at_right = stretch(returns, right, omega, epsilon, length)[0]
    for _ in range(40):  # 0.618⁴⁰ = 4e-9 in place, its square in value
        if at_left < at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = stretch(returns, left, omega, epsilon, length)[0]
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = stretch(returns, right, omega, epsilon, length)[0]
        if min(at_left, at_right) <= 0:
            break
    return (left, at_left) if at_left < at_right else (right, at_right)


@njit(cache=True)
def zero(returns, low, high, omega, epsilon, length):  # type: ignore[no-untyped-def]
    """The midpoint where D falls to 0, between D(low) > 0 and D(high) ≤ 0, by bisection."""
    for _ in range(52):
        middle = 0.5 * (low + high)
        if stretch(returns, middle, omega, epsilon, length)[0] > 0:
            low = middle
        else:
            high = middle
    return stretch(returns, high, omega, epsilon, length)[1]


@njit(cache=True)
def advance_held(times, state, omega, strength):  # type: ignore[no-untyped-def]
    r"""One return at full amplitude: d += 2Z′(t), dd += 2Z″(t) D, at the given times.

    Sine and cosine are written out, so that the loop becomes vector instructions: the quadrant
    q = round(2Ωt/π), the remainder with π/2 in two parts (exact products for q < 2²⁰), and the
    Taylor polynomials on |r| ≤ π/4, whose first omitted terms are below 2⁻⁵⁶.
    """
    d, dx, dd = state[1], state[2], state[3]
    for j in range(len(times)):
        turns = omega * times[j]
        q = math.floor(turns * (2 / math.pi) + 0.5)
        r = (turns - q * HALF_PI) - q * HALF_PI_REST
        z = r * r
        sine, cosine = 0.0, 0.0
        for n in (17, 15, 13, 11, 9, 7, 5, 3):
            sine = (1 + sine) * (-z / (n * (n - 1)))
        for n in (16, 14, 12, 10, 8, 6, 4, 2):
            cosine = (1 + cosine) * (-z / (n * (n - 1)))
        sine, cosine = r + r * sine, 1 + cosine
        half, next_half = math.floor(0.5 * q), math.floor(0.5 * q + 0.5)
        odd = q - 2 * half
        first = (cosine if odd > 0.5 else sine) * (1 - 2 * (half - 2 * math.floor(0.5 * half)))
        second = sine if odd > 0.5 else cosine
        second *= 1 - 2 * (next_half - 2 * math.floor(0.5 * next_half))
        d[j] -= strength * first
        dd[j] -= strength * omega * second * (1 + dx[j])


@njit(cache=True)
def advance_ramping(times, state, omega, epsilon, length):  # type: ignore[no-untyped-def]
    """One return while the ramp lasts, as :func:`advance_held`."""
    d, dx, dd = state[1], state[2], state[3]
    for j in range(len(times)):
        first, second = kick(times[j], omega, epsilon, length)
        d[j] += first
        dd[j] += second * (1 + dx[j])


@njit(cache=True)
def first_sonic(omega, epsilon, length, until, count):  # type: ignore[no-untyped-def]
    """The first sonic instant up to ``until``, or nan, and the map steps taken on the labels."""
    width = REACH / count
    labels = width * np.arange(1, count + 1) - REACH
    state = np.zeros((4, count))  # x, d and their derivatives with respect to the label
    older, old = 1.0, 1.0
    returns = 0
    while labels[0] + REACH * (returns + 0.5) + state[0, 0] + 0.5 * state[1, 0] <= until:
        returns += 1
        state[0] += state[1]
        state[2] += state[3]
        times = labels + REACH * returns + state[0]
        for j in range(count):
            new = 1 + state[2, j]
            # A parabola dips below the middle label by at most 1/8 of the larger step.
            dip = old <= older and old <= new and old <= max(older, new) - old
            if dip or new <= 0:
                low, place, value = labels[j] - 2 * width, labels[j], new
                if dip:
                    place, value = lowest(returns, low, place, omega, epsilon, length)
                if value > 0 and new <= 0:
                    place, value = labels[j], new
                if value <= 0:
                    when = zero(returns, low, place, omega, epsilon, length)
                    return (when if when <= until else math.nan), returns * count
            older, old = old, new
        if times[0] >= length:
            advance_held(times, state, omega, 2 * epsilon * omega)
        else:
            advance_ramping(times, state, omega, epsilon, length)
    return math.nan, returns * count


@njit(cache=True)
def many_sonic(omegas, epsilons, lengths, ends, count):  # type: ignore[no-untyped-def]
    """``first_sonic`` for arrays of one dimension, and all map steps."""
    times, total = np.empty(len(omegas)), 0
    for i in range(len(omegas)):
        times[i], steps = first_sonic(omegas[i], epsilons[i], lengths[i], ends[i], count)
        total += steps
    return times, total
