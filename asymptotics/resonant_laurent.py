r"""Laurent coefficients of the contact point's resonant harmonic, in double precision.

ξ_{n,q}, the coefficient of εⁿ cos qθ in ξ_c, has a pole at Ω = Ω_p/q. The engine runs over complex
Ω on a circle around it, and the discrete Fourier transform over the circle is the Laurent expansion
in μ = Ω − Ω_p/q: with M points and radius ρ the coefficient is off by (ρ/R)^M, R the distance to
the next pole, which is below rounding for R = 2.5ρ and M = 64. A second circle of half the radius,
and the rounding of the largest value on the circle, make the error estimate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.beam import beam
from asymptotics.beam_numbers import doubles
from asymptotics.beam_spectrum import linear_frequencies
from asymptotics.beam_waves import StaticBeam
from asymptotics.errors import InputError
from asymptotics.expansion import expand
from asymptotics.problem import string
from asymptotics.rings import FloatRing

Array = npt.NDArray[Any]
Pair = tuple[Array, Array]
"""Values and error estimates, one entry a β."""

_POINTS = 64  # on each circle
_ROOM = 0.4  # radius of the larger circle, in distances to the next pole
_LEAST = 1e-9  # a nearer pole leaves fewer than seven digits of the detuning on the circle


def beam_laurent(shape: StaticBeam, p: int, q: int, order: int) -> Callable[[int, int], Pair]:
    """(n, k) ↦ the coefficient of μ^{−k} in ξ_{n,q} at Ω_p/q, and its error, for each β.

    Raises
    ------
    InputError
        Another pole of the expansion of the given order is too close.

    Examples
    --------
    >>> from asymptotics.beam import static_beam
    >>> residue, _ = beam_laurent(static_beam(np.array([0.01])), 1, 1, 1)(1, 1)
    >>> residue.round(5)
    array([-1.73159])
    """
    # Ω_n grows at least like n, so that these reach beyond jΩ_p/q for all j ≤ order. All poles are
    # real, the linear problem being self-adjoint.
    spectrum = linear_frequencies(shape.beta, order * p // q + 2, shape.driven_end)
    centre = spectrum[:, p - 1] / q
    poles = spectrum[:, :, None] / np.arange(1, order + 1)
    gaps = abs(poles - centre[:, None, None])
    gaps[:, p - 1, q - 1] = centre
    gap = gaps.min(axis=(1, 2))
    if np.any(gap < _LEAST * centre):
        worst = float(np.asarray(shape.beta)[np.argmin(gap / centre)])
        raise InputError(
            f"at beta = {worst!r} another resonance lies within {_LEAST:g} of Omega_{p}/{q}, "
            "relatively: one amplitude equation does not describe both; change beta"
        )
    circle = np.exp(2j * math.pi * np.arange(_POINTS) / _POINTS)
    radius = _ROOM * gap[:, None, None] * np.array([1.0, 0.5])[:, None]
    column = StaticBeam(
        shape.beta[:, None, None],
        shape.driven_end,
        shape.contact_point[:, None, None],
        shape.a3[:, None, None],
    )
    omega = centre[:, None, None] + radius * circle
    solution = expand(beam(column.beta, omega, shape.driven_end, doubles(), column), order)

    def coefficient(n: int, k: int) -> Pair:
        values = 2 * solution.contact(n)[q]
        both = (values * circle**k).mean(axis=-1).real * radius[..., 0] ** k
        rounding = np.finfo(float).eps * abs(values).max(axis=-1) * radius[..., 0] ** k
        return both[:, 0], abs(both[:, 0] - both[:, 1]) + 8 * rounding.max(axis=-1)

    return coefficient


def string_forcing(p: int, q: int) -> float:
    """F⁰, the coefficient F of the rope without bending at Ω = pπ/q: eq. (linresponse1) and beyond.

    The sum over a circle as for the beam, around the pole of cot qΩ.

    >>> string_forcing(1, 1) / -(math.pi / 2), round(string_forcing(1, 2) / -(math.pi**3 / 64), 14)
    (1.0, 1.0)
    """
    centre = p * math.pi / q
    # The nearest other pole with denominator j ≤ q is at least π/(q(q − 1)) away; π for q = 1.
    radius = _ROOM * math.pi / max(1, q * (q - 1))
    circle = np.exp(2j * math.pi * np.arange(_POINTS) / _POINTS)
    omega = centre + radius * circle
    problem = string(FloatRing(), omega, lambda j: 1 / np.tan(j * omega))
    harmonic = 2 * expand(problem, q).contact(q)[q] / np.sin(omega) ** q
    return float(q * (harmonic * circle).mean().real * radius)
