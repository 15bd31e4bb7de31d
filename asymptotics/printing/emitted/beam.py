"""Rope with bending stiffness, pinned driven end, through order 1 in epsilon.

Order 1 is written by hand; asymptotics.printing.beam_numpy puts in the amplitudes of the others.

    contact(tau, omega, epsilon, beta)      x_c/x0
    shape(xi, tau, omega, epsilon, beta)    w/Z0 at xi = x/x0, from the driven end to the contact
    harmonics(omega, beta)                  {(n, j): coefficient of epsilon**n cos(j omega tau)}
    static_contact_point(beta)              x_c/x0 at rest

All arguments are dimensionless and broadcast against one another: omega is the angular frequency
times x0/c, epsilon the forcing amplitude in units of Z0, tau = c t/x0 and beta = B/(T x0**2) > 0.
The series is singular at the resonances omega = Omega_p(beta)/q, q <= ORDER, and loses its ordering
next to them. For beta >> 1 shape() cancels terms of size 2 beta and is right to a few times
beta * 2.0**-53 only; for beta << 1 a harmonic of order n is right to some 8 * 2.0**-53
* beta**((1 - n)/2) of itself.

nan is no result. It says that there is none:

    at a resonance, or so near that less than half the digits of the impedances are right
    where xi < 0, behind the driven end
    where beta is not positive, or so small that less than half the digits of x_c/x0 are right
    where an argument is not finite, or so large that the series overflows

On the ground, xi > x_c/x0, the shape is 0.
"""

from typing import Any

import numpy as np

ORDER = 1

# Half the digits of a double: what is nearer to a resonance, or to the driven end, is there.
RESOLUTION = 2.0**-26


def contact(tau: Any, omega: Any, epsilon: Any, beta: Any) -> Any:
    """x_c/x0 at the times tau, through epsilon**ORDER."""
    tau, omega, epsilon, beta = (np.asarray(a, dtype=float) for a in (tau, omega, epsilon, beta))
    return _place(_amplitudes(omega, beta)[0], tau, omega, epsilon, beta)


def _place(amplitudes: Any, tau: Any, omega: Any, epsilon: Any, beta: Any) -> Any:
    """x_c/x0 from its harmonics, where half of its digits are right."""
    total = static_contact_point(beta)
    lost = 0.0 * total
    for (n, j), amplitude in amplitudes.items():
        term = epsilon**n * amplitude
        total = total + term * np.cos(j * omega * tau)
        lost = lost + 8.0 * 2.0**-53 * np.abs(term) / np.sqrt(beta) ** (n - 1)
    return np.where(lost <= RESOLUTION * np.abs(total), total, np.nan)[()]


def static_contact_point(beta: Any) -> Any:
    """x_c/x0 at rest."""
    beta = np.asarray(beta, dtype=float)
    return 2.0 * np.sqrt(beta) * _stretch(beta)


def shape(xi: Any, tau: Any, omega: Any, epsilon: Any, beta: Any) -> Any:
    """w/Z0 at the position xi and the times tau, through epsilon**ORDER."""
    arguments = (xi, tau, omega, epsilon, beta)
    xi, tau, omega, epsilon, beta = (np.asarray(a, dtype=float) for a in arguments)
    y = _stretch(beta)
    length = 2.0 * np.sqrt(beta) * y
    amplitudes, data = _amplitudes(omega, beta)
    place = _place(amplitudes, tau, omega, epsilon, beta)
    s = np.where(xi > -RESOLUTION, np.minimum(xi, place), np.nan) - length
    total = _static_shape(s, y, length, beta)
    for (n, j), (value, slope) in data.items():
        drive = 1.0 if (n, j) == (1, 1) else 0.0
        solution = _solution(_waves(j * omega, beta, length), value, slope, drive, s, length)
        total = total + epsilon**n * solution * np.cos(j * omega * tau)
    return np.where(xi > place, 0.0, total)[()]


def harmonics(omega: Any, beta: Any) -> Any:
    """{(n, j): coefficient of epsilon**n cos(j omega tau) in x_c/x0}."""
    return _amplitudes(*(np.asarray(a, dtype=float) for a in (omega, beta)))[0]


def _amplitudes(omega: Any, beta: Any) -> Any:
    """The harmonics of x_c/x0, and value and slope of w's at the static contact point."""
    y = _stretch(beta)
    length, a3, excess = 2.0 * np.sqrt(beta) * y, _third(y, beta), _excess(y, beta)
    a3 = np.where(_regular(omega, beta, length) & np.isfinite(a3**ORDER), a3, np.nan)
    sigma = -2.0 / (beta * a3)
    S2, s3 = _derivatives(_waves(omega, beta, length), 0.0, 0.0, 1.0, sigma, excess)
    h1_1 = S2 * (-1.0)
    u1_1 = 0.0
    v1_1 = 0.0
    contact = {
        (1, 1): h1_1 / a3**1,
    }
    data = {
        (1, 1): (u1_1 / a3**0, v1_1 / a3**0),
    }
    return contact, data


def _stretch(beta: Any) -> Any:
    """xi_0/(2 sqrt(beta)) by Newton's iteration from the right, monotone for a convex function."""
    y = _start(beta)
    for _ in range(200):
        value, slope = _height(y, beta)
        step = value / slope
        moving = step > 4.0 * np.finfo(float).eps * y
        if not np.any(moving):
            break
        y = np.where(moving, y - step, y)
    return y


def _waves(rate: Any, beta: Any, length: Any) -> Any:
    """Wavenumbers and end values of the solutions at the angular frequency ``rate``."""
    root = np.sqrt(1.0 + 4.0 * beta * rate * rate)
    k2, p2 = 2.0 * rate * rate / (1.0 + root), (1.0 + root) / (2.0 * beta)
    k, p = np.sqrt(k2), np.sqrt(p2)
    safe = np.where(k > 0.0, k, 1.0)
    sine = np.where(k > 0.0, np.sin(k * length) / safe, length)
    decay, cosine = np.exp(-p * length), np.cos(k * length)
    return {"k2": k2, "p2": p2, "p": p, "decay": decay, "cosine": cosine, "sine": sine}


def _regular(omega: Any, beta: Any, length: Any) -> Any:
    """Where no harmonic is at its resonance: by the determinant over the size of its terms."""
    regular = np.isfinite(omega)
    for q in range(1, ORDER + 1):
        w = _waves(q * omega, beta, length)
        c1, c2, d1, d2 = _boundary(w)
        size = _size(w, 1.0 / np.sqrt(w["k2"] + 1.0 / (length * length)))
        from_pole = np.abs(c1 * d2 - d1 * c2) / (size * np.maximum(1.0, np.abs(q * omega)))
        regular = regular & (from_pole > RESOLUTION)
    return regular


def _boundary(w: Any) -> Any:
    """What exp(ps) and exp(-p(length + s)), with zero contact data, leave of both conditions."""
    e, p = w["decay"], w["p"]
    return *_end(-1.0, -p, 1.0, 0.0, w), *_end(-e, p * e, 0.0, 1.0, w)


def _solve(w: Any, value: Any, slope: Any, drive: Any) -> Any:
    """Coefficients of cos ks, sin(ks)/k, exp(ps), exp(-p(length + s)): contact data and drive."""
    e, p = w["decay"], w["p"]
    c1, c2, d1, d2 = _boundary(w)
    r1, r2 = _end(value, slope, 0.0, 0.0, w)
    determinant = c1 * d2 - d1 * c2
    c = ((drive - r1) * d2 + d1 * r2) / determinant
    d = (-c1 * r2 - c2 * (drive - r1)) / determinant
    return value - c - d * e, slope - p * (c - d * e), c, d


def _solution(w: Any, value: Any, slope: Any, drive: Any, s: Any, length: Any) -> Any:
    """The solution with these contact data and drive, at the distance s from the contact point."""
    a, b, c, d = _solve(w, value, slope, drive)
    k, p = np.sqrt(w["k2"]), w["p"]
    safe = np.where(k > 0.0, k, 1.0)
    sine = np.where(k > 0.0, np.sin(k * s) / safe, s)
    return a * np.cos(k * s) + b * sine + c * np.exp(p * s) + d * np.exp(-p * (length + s))


def _static_shape(s: Any, y: Any, length: Any, beta: Any) -> Any:
    """W0, with the boundary layers at the contact point and at the driven end."""
    p, layer = 1.0 / np.sqrt(beta), _layer(y)
    near = -beta * (2.0 - layer * np.exp(-2.0 * y)) * np.exp(p * s)
    far = -beta * layer * np.exp(-p * (length + s))
    return s * s + 2.0 * beta - _third(y, beta) * beta * s + near + far


def _derivatives(w: Any, value: Any, slope: Any, drive: Any, sigma: Any, excess: Any) -> Any:
    """w2 and w3 - sigma w2 at the contact point from value and slope there and the driven end."""
    e, p, total = w["decay"], w["p"], w["p2"] + w["k2"]
    _, _, c, d = _solve(w, value, slope, drive)
    gap = (w["k2"] + excess) / (p + sigma)  # p - sigma
    third = total * (c * gap - d * e * (p + sigma)) - w["k2"] * (slope - sigma * value)
    return total * (c + d * e) - w["k2"] * value, third


def _excess(y: Any, beta: Any) -> Any:
    """1/beta - sigma**2, exponentially small for small beta."""
    e = np.exp(-2.0 * y)
    return -4.0 * e / ((1.0 - e) * (1.0 - e)) / beta


def _height(y: Any, beta: Any) -> Any:
    """4 beta y (y - tanh y) = 1: value and derivative."""
    e = np.exp(-2.0 * y)
    t = (1.0 - e) / (1.0 + e)
    return y * (y - t) - 0.25 / beta, 2.0 * y - t - y * (1.0 - t * t)


def _start(beta: Any) -> Any:
    return 0.5 + 0.5 * np.sqrt(1.0 + 1.0 / beta)


def _third(y: Any, beta: Any) -> Any:
    e = np.exp(-2.0 * y)
    return -2.0 / np.sqrt(beta) * (1.0 - e) / (1.0 + e)


def _layer(y: Any) -> Any:
    """(1 - g) exp(2y) with a3 = -2 g/sqrt(beta)."""
    return 2.0 / (1.0 + np.exp(-2.0 * y))


def _end(a: Any, b: Any, c: Any, d: Any, w: Any) -> Any:
    """(w, w_xixi) at the driven end for coefficients of the four solutions."""
    harmonic = a * w["cosine"] - b * w["sine"]
    boundary = c * w["decay"] + d
    return harmonic + boundary, w["p2"] * boundary - w["k2"] * harmonic


def _size(w: Any, sine: Any) -> Any:
    """The size of the terms of the determinant, with the largest sin(kL)/k."""
    return w["p"] * ((w["p2"] + w["k2"]) * sine + w["p"])
