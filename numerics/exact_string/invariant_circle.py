r"""The exact periodic, wave-less state of the string (β = 0): an invariant circle.

With :math:`W = ξ² + f(τ−ξ) + g(τ+ξ)` the contact conditions W = W_ξ = 0 at ξ_c say
:math:`f'(τ−ξ_c) = −g'(τ+ξ_c) = ξ_c`. A characteristic that leaves ξ = 0 at the time t comes back at
h(t), reflected at the contact point halfway in time and space, so f′(t) = (h(t) − t)/2, and the
drive W(0, τ) = Z(τ) = 1 + ε cos Ωτ becomes :math:`h(t) − 2t + h^{-1}(t) = 2Z'(t)`: in φ = Ωt the
Chirikov standard map with K = 2εΩ². A periodic state is an invariant circle of it,

.. math:: φ = ψ + U(ψ), \quad h: ψ ↦ ψ + ϱ, \qquad
          U(ψ+ϱ) − 2U(ψ) + U(ψ−ϱ) = −K \sin(ψ + U(ψ)).

The map knows Z′ only. The mean height enters by the integral of the contact condition,
:math:`f(h(u)) − f(u) = ξ_c² + Z(h(u))`; its mean over the circle fixes ϱ = 2Ω + O(ε²):

.. math:: \frac{ϱ}{Ω} ⟨D (1 + U')⟩ = ⟨D²⟩ + 1 + ε ⟨\cos(ψ + U)⟩, \qquad
          D(ψ) = \frac{ϱ + U(ψ+ϱ) − U(ψ)}{2Ω}.

The drive is even in time, so U is odd: :math:`U = \sum_{k≥1} b_k \sin kψ`.

:mod:`numerics.exact_string.circle_newton` finds ϱ and the b_k;
:mod:`numerics.exact_string.circle_state` makes of them the contact point and the shape at any place
and time. Both are reached from here.

By Birkhoff's theorem an invariant circle is a graph over φ, hence 1 + U′ > 0, which is |ξ_c′| < 1.
The circle breaks up well before its contact point reaches the wave speed (the last ones found next
to Ω = π have max |ξ_c′| between 0.1 and 0.25); the motion that follows, no longer periodic, is what
folds.

**What a failure means.** Less than a proof that there is none. Newton's iteration needs all modes
of the circle, whose number grows without bound towards the break-up. The golden circle, ϱ = 2π ·
0.618034, lasts to K = 0.9716354; at its Ω and ε it is found at K = 0.85 on 512 nodes, at 0.95 on
2048, at 0.971 on 65536, and at 0.9716 not on 131072.
"""

from __future__ import annotations

import math

from numerics.errors import CircleNotFoundError, InputError
from numerics.exact_string.circle_newton import Sought, search
from numerics.exact_string.circle_state import EPS, CircleStatus, InvariantCircle
from numerics.problems.drive import positive

__all__ = ["EPS", "CircleStatus", "InvariantCircle", "circle_at_rotation", "invariant_circle"]

# No circle winds around the cylinder beyond this K, proved with interval arithmetic by
# R. S. MacKay & I. C. Percival, Commun. Math. Phys. 98 (1985) 469.
NO_CIRCLE = 63 / 64

# A second's work for the last of Newton's steps.
MOST_NODES = 2**17


def invariant_circle(
    omega: float,
    epsilon: float,
    nodes: int = 32,
    max_nodes: int = MOST_NODES,
    start: InvariantCircle | None = None,
) -> InvariantCircle:
    r"""The exact periodic wave-less state of the string driven by Z(τ) = 1 + ε cos Ωτ.

    Parameters
    ----------
    omega
        Ω > 0; with ε ≠ 0 not a linear resonance pπ.
    epsilon
        ε, of either sign (ε → −ε shifts the time by half a period).
    nodes, max_nodes
        Powers of two, M to begin with and M to give up at.
    start
        A circle at nearby parameters to begin from, instead of the linear response.

    Returns
    -------
    InvariantCircle
        With status ``CONVERGED``. The map and the mean height hold to rounding; b_k is then good to
        about 2⁻⁵² K/(4 sin²(kϱ/2)), the small divisors of a nearby resonance.

    Raises
    ------
    InputError
        Ω or ε is not what is allowed.
    CircleNotFoundError
        None was found with up to M nodes, which does not prove that there is none: see the
        module's docstring. Carries the last iterate; None for |K| ≥ 63/64, where it is proved.

    Examples
    --------
    >>> state = invariant_circle(omega=0.83, epsilon=0.02)
    >>> f"{state.rotation_number - 2 * 0.83:.3e}"
    '-1.322e-04'
    >>> state.status.name, round(state.contact_speed, 6)
    ('CONVERGED', 0.009335)

    Source: the string with β = 0 reduces to the standard map; see the module's docstring.
    """
    omega, epsilon = _check_input(omega, epsilon)
    _check_nodes(nodes, max_nodes)
    strength = 2 * epsilon * omega**2
    if abs(strength) >= NO_CIRCLE:
        raise CircleNotFoundError(
            f"Omega = {omega!r}, epsilon = {epsilon!r} make K = 2εΩ² = {strength:.6g}; for "
            "|K| ≥ 63/64 no invariant circle exists at any Omega, and the string makes waves: take "
            f"|epsilon| < {NO_CIRCLE / (2 * omega**2):.6g}",
            None,
        )
    sought = Sought(strength, omega, 2 * omega)
    state = search(sought, nodes, max_nodes, start)
    if state.status is not CircleStatus.CONVERGED:
        raise CircleNotFoundError(
            f"no invariant circle found at Omega = {omega!r}, epsilon = {epsilon!r} with up to "
            f"{max_nodes} nodes (K = {strength:.6g}; residual {state.residuals[-1]:.1e}): "
            f"{state.status.value}. This is no proof that there is none. Take a smaller |epsilon|, "
            "move Omega away from the nearest resonance pπ/q with small q, or raise max_nodes",
            state,
        )
    return state


def circle_at_rotation(
    rotation: float, strength: float, nodes: int = 32, max_nodes: int = MOST_NODES
) -> InvariantCircle:
    r"""The state with the rotation number ν = ϱ/2π at K = 2εΩ²; Ω and ε are read off.

    On a circle that lasts, ν is irrational; a rational one with a small denominator has none.

    Parameters
    ----------
    rotation
        ν > 0, the return time of the characteristics in periods of the drive, on average.
    strength
        K, of either sign.
    nodes, max_nodes
        As for :func:`invariant_circle`.

    Raises
    ------
    InputError
        ν is not positive, K or the node counts not what is allowed.
    CircleNotFoundError
        As :func:`invariant_circle`.

    Examples
    --------
    >>> state = circle_at_rotation((5**0.5 - 1) / 2, 0.95)
    >>> round(state.omega, 10), round(state.epsilon, 10)
    (1.9388697106, 0.1263561421)

    Source: the exact string reduces to the standard map; see the module's docstring.
    """
    rotation = positive("rotation", rotation)
    _check_nodes(nodes, max_nodes)
    if not isinstance(strength, int | float) or not math.isfinite(strength):
        raise InputError(f"strength = {strength!r}; K = 2εΩ² must be a finite number")
    if abs(strength) >= NO_CIRCLE:
        raise CircleNotFoundError(
            f"strength = {strength!r}: for |K| ≥ 63/64 no invariant circle exists; take a smaller "
            "K",
            None,
        )
    if strength and abs(math.sin(math.pi * rotation)) <= math.sqrt(EPS) * max(1.0, rotation):
        raise InputError(
            f"rotation = {rotation!r} is numerically a whole number, a resonance Ω = pπ, where any "
            "drive makes waves; take an irrational number, e.g. the golden one (5**0.5 - 1)/2"
        )
    state = search(Sought(float(strength), None, 2 * math.pi * rotation), nodes, max_nodes)
    if state.status is not CircleStatus.CONVERGED:
        raise CircleNotFoundError(
            f"no invariant circle found with the rotation number {rotation!r} at K = {strength!r} "
            f"with up to {max_nodes} nodes (residual {state.residuals[-1]:.1e}): "
            f"{state.status.value}. This is no proof that there is none. Take a smaller |K|, a "
            "number farther from p/q with small q, or raise max_nodes",
            state,
        )
    return state


def _check_input(omega: float, epsilon: float) -> tuple[float, float]:
    try:
        values = float(omega), float(epsilon)
    except (TypeError, ValueError):
        raise InputError(
            f"Omega = {omega!r}, epsilon = {epsilon!r}: give two numbers, e.g. 2.2 and 0.02"
        ) from None
    if not math.isfinite(values[0]) or values[0] <= 0:
        raise InputError(
            f"Omega = {values[0]!r}; the dimensionless frequency ωx₀/c must be positive and finite"
        )
    if not math.isfinite(values[1]):
        raise InputError(f"epsilon = {values[1]!r}; the relative drive amplitude must be finite")
    # Closer than √eps half the digits of sin Ω are rounding, and no ε > 1e-16 has a circle.
    if values[1] and abs(math.sin(values[0])) <= math.sqrt(EPS) * max(1.0, values[0]):
        p = round(values[0] / math.pi)
        raise InputError(
            f"Omega = {values[0]!r} is numerically at the resonance p/q = {p}/1 (sin Omega = 0), "
            f"where any drive makes waves; move Omega away from {p}π, or take epsilon = 0"
        )
    return values


def _check_nodes(nodes: int, max_nodes: int) -> None:
    for name, value in (("nodes", nodes), ("max_nodes", max_nodes)):
        if not isinstance(value, int) or value < 8 or value & (value - 1):
            raise InputError(f"{name} = {value!r}; give a power of two ≥ 8, e.g. 32")
    if nodes > max_nodes:
        raise InputError(f"nodes = {nodes} exceeds max_nodes = {max_nodes}; swap them")
