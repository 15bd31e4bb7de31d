r"""The string with damping.

.. math:: W_{ττ} + 2ζ W_τ = W_{ξξ} + η W_{ξξτ} − 2, \quad W(0, τ) = 1 + ε ΔZ(τ), \quad
          W = W_ξ = 0 \text{ at } ξ_c(τ)

ζ is half the damping coefficient per unit length over ρ, in units of c/x₀: with a drag force
−ν ∂w/∂t per unit length, :math:`ζ = ν x_0/(2ρc)`, and free waves decay as :math:`e^{−ζτ}`. η is the
Kelvin–Voigt time T′/T in units of x₀/c, for a transverse force T w_x + T′ w_xt. The static shape
and the mean of each order are those without damping; a harmonic e^{ijΩτ} has the complex wavenumber

.. math:: k_j^2 = \frac{(jΩ)^2 − 2iζ jΩ}{1 + iη jΩ}

and the impedance k_j cot k_j, which is finite at every real Ω: no resonance is left. To first order
:math:`ξ_1 = \mathrm{Re}\, \frac{k_1}{2 \sin k_1} e^{iΩτ}`, so :math:`|ξ_1| → pπ/(2ζ)` at Ω = pπ as
ζ → 0 (η = 0).

With η > 0 the smooth contact W_ξ = 0 needs a point force at the edge, η W_ξξ |ξ_c′| in units of
T w_x, which pulls while the rope peels off (ξ_c′ > 0). The expansion is of that problem, as stated;
a ground that only pushes needs η = 0.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from flint import acb

from asymptotics.errors import InputError
from asymptotics.problems.enclosed import ball_damped_string
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import check_frequency, driven_string
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import ComplexRing

if TYPE_CHECKING:
    pass


def wavenumber(j: int, omega: float, damping: float, viscosity: float = 0.0) -> complex:
    """k_j of the module's docstring, with Im k_j ≥ 0.

    >>> abs(wavenumber(2, 1.5, 0.0) ** 2), wavenumber(1, 1.5, 0.1).imag > 0
    (9.0, True)
    """
    rate = j * omega
    square = complex(rate * rate, -2.0 * damping * rate) / complex(1.0, viscosity * rate)
    root = cmath.sqrt(square)
    return -root if root.imag < 0 else root


def impedance(k: complex) -> complex:
    """k cot k for Im k ≥ 0, without overflow.

    >>> abs(impedance(1000j))
    1000.0
    """
    if k.imag < 1.0:
        return k * cmath.cos(k) / cmath.sin(k)
    decay = cmath.exp(2j * k)
    return -1j * k * (1 + decay) / (1 - decay)


def source(k: complex) -> complex:
    """k/sin k for Im k ≥ 0, without overflow.

    >>> abs(source(1000j))
    0.0
    """
    if k.imag < 1.0:
        return k / cmath.sin(k)
    return -2j * k * cmath.exp(1j * k) / (1 - cmath.exp(2j * k))


@remembering
def damped_string(
    omega: float,
    damping: float,
    viscosity: float = 0.0,
    drive: Mapping[int, complex] | None = None,
) -> Problem[Any]:
    """The damped string over complex numbers, for :func:`asymptotics.expansion.order_loop.expand`.

    Parameters
    ----------
    omega
        Ω; any positive one, resonances included.
    damping, viscosity
        ζ ≥ 0 and η ≥ 0, not both zero.
    drive
        Amplitude of each e^{ijΩτ}, j ≥ 0; cos Ωτ by default. The small parameter is ε.

    Raises
    ------
    InputError
        A value that is not finite or out of range.

    Examples
    --------
    >>> from asymptotics import expand
    >>> at_resonance = expand(damped_string(math.pi, 0.05), 3)
    >>> round(2 * abs(at_resonance.contact(1)[1]), 4)       # π/(2 · 0.05) = 31.4159
    31.4138
    """
    omega = check_frequency(omega, 0)
    zeta, eta = _coefficient("damping", damping), _coefficient("viscosity", viscosity)
    if zeta == eta == 0:
        raise InputError(
            "damping = viscosity = 0: use forced_string, which knows the undamped resonances"
        )
    k = cache(lambda j: wavenumber(j, omega, zeta, eta))

    def equation_residual(j: int, w: Sequence[Any]) -> Any:
        rate = j * omega
        inertia = -rate * rate + 2j * zeta * rate
        return (1 + 1j * eta * rate) * w[2] - inertia * w[0]

    def end_residual(j: int, w: Sequence[Any]) -> Any:
        # W(0) = w cos k − w′ sin k/k, over cos k so that a strongly damped one does not overflow.
        return w[0] - w[1] / impedance(k(j))

    amplitudes = {1: 0.5 + 0j} if drive is None else dict(drive)
    name = f"string at {omega!r}, damping {zeta!r}, viscosity {eta!r}"
    problem = driven_string(
        name if drive is None else f"{name} under {amplitudes!r}",
        ComplexRing(),
        stiffness=lambda j: k(j) * k(j),
        impedance=lambda j: impedance(k(j)),
        source=lambda j: source(k(j)),
        drive=amplitudes,
        equation_residual=equation_residual,
        end_residual=end_residual,
        end_unit=lambda j: source(k(j)) / impedance(k(j)),
    )
    exact = {j: acb(c) for j, c in amplitudes.items()}
    return replace(problem, balls=lambda: ball_damped_string(omega, zeta, eta, exact))


def _coefficient(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not (math.isfinite(number) and number >= 0):
        raise InputError(f"{name} = {value!r}; give a finite number ≥ 0")
    return number
