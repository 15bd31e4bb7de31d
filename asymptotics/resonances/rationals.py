r"""Where the expansion has its poles: linear resonances in closed form, and all p/q.

* String: f_p = p √(g/8Z₀), whatever the tension (eq. resonance1): :func:`tension_free_frequency`.
* Weak bending: how Ω_n leaves nπ, :func:`weak_bending`.
* Strong bending: the finite limit β → ∞ behind the paper's 42 %, :func:`stiff_limit`.
* Harmonic q of the drive meets linear resonance p at qΩ = Ω_p(β): :func:`nonlinear_resonances`.

The spectrum itself, at any β, is in :mod:`asymptotics.problems.beam_spectrum`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.formulas.closed_form import ClosedForm
from asymptotics.problems.beam_spectrum import (
    check_count,
    linear_frequencies,
    wavenumbers,
)
from asymptotics.problems.rope import Rope
from asymptotics.problems.static_shape import DrivenEnd, check_driven_end, single_stiffness

if TYPE_CHECKING:
    import sympy

# A window with more candidates p/q than this is a mistake, not a question.
_MOST = 100_000


# -- closed forms --------------------------------------------------------------------------------


def tension_free_frequency() -> ClosedForm:
    """f_p = Ω_p c/(2πx₀) with Ω_p = pπ, eq. (resonance1): the tension cancels.

    Examples
    --------
    >>> form = tension_free_frequency()
    >>> form.expression
    sqrt(2)*sqrt(g)*p/(4*sqrt(Z_0))
    >>> sorted(symbol.name for symbol in form.expression.free_symbols)
    ['Z_0', 'g', 'p']
    """
    import sympy

    p, tension, rho, g, height = sympy.symbols("p T rho g Z_0", positive=True)
    speed = sympy.sqrt(tension / rho)
    place = sympy.sqrt(2 * tension * height / (rho * g))
    frequency = p * sympy.pi * speed / (2 * sympy.pi * place)
    return ClosedForm("f_p", frequency, "resonance1", 1, "nowhere")


def weak_bending(driven_end: str = "pinned") -> ClosedForm:
    r"""Ω_n(β) through O(β): the √β of the longer rope and of its stiff ends cancel.

    Pinned, ξ₀ = √β + √(1+β) and kξ₀ = nπ + arctan(k/p); clamped, ξ₀ = 1 + 2√β and
    kξ₀ = nπ + 2 arctan(k/p), both up to e^{−1/√β}. With k²(1 + βk²) = Ω²

    .. math:: Ω_n = nπ [1 + ½(n^2π^2 − 1) β] \text{ (pinned)}, \quad
              nπ [1 + ½ n^2π^2 β] \text{ (clamped)}, \quad + O(β^{3/2}) .

    Raises
    ------
    InputError
        An unknown driven end.

    Examples
    --------
    >>> weak_bending().expression
    pi*n*(beta*(pi**2*n**2 - 1)/2 + 1)
    """
    import sympy

    n, beta = sympy.symbols("n beta", positive=True)
    shift = n**2 * sympy.pi**2 - (1 if check_driven_end(driven_end) == "pinned" else 0)
    return ClosedForm("Omega_n", n * sympy.pi * (1 + shift * beta / 2), "resonance1", 1, "nowhere")


@dataclass(frozen=True)
class StiffLimit:
    r"""The limit β → ∞ of one linear resonance, a beam without tension.

    Attributes
    ----------
    driven_end, n
        Which resonance.
    length
        L, the lifted part in metres, as a SymPy expression in B, Z_0, rho, g.
    equation
        Which x = kL solve, as a SymPy equation in x.
    expression
        f_n/√(g/8Z₀) as a SymPy expression in x.
    root
        x, the n-th positive root of ``equation``'s family.
    ratio
        ``expression`` at ``root``: f_n in units of √(g/8Z₀), Ω_n = π · ratio.
    """

    driven_end: DrivenEnd
    n: int
    length: sympy.Expr
    equation: sympy.Eq
    expression: sympy.Expr
    root: float
    ratio: float

    @property
    def increase(self) -> float:
        """By how much bending can raise f_n above n √(g/8Z₀): 0.42 is the paper's 42 %."""
        return self.ratio / self.n - 1


def stiff_limit(driven_end: str = "pinned", n: int = 1) -> StiffLimit:
    r"""The closed form behind the paper's 'up to 42 % as β → ∞', for either driven end.

    For z = ξ₀/√β → 0 the static condition, βs(z) = 1 with s(z) = z² − 2z tanh(z/2) pinned or
    (z coth(z/2) − 2)² clamped, begins with s ~ σz⁴. With βx₀⁴ = 2BZ₀/(ρg),

    .. math:: L^4 = \frac{2BZ_0}{σρg}, \qquad Ω_n = \sqrt{σ}\, x^2, \qquad
              \frac{f_n}{\sqrt{g/8Z_0}} = \frac{\sqrt{σ}\, x^2}{π} .

    Pinned: σ = 1/12, tan x = tanh x, x²/(2√3 π) = 1.4168. Clamped: σ = 1/36,
    tan(x/2) = −tanh(x/2), x²/(6π) = 1.1869. Only a pinned driven end gives 42 %.

    Raises
    ------
    InputError
        An unknown driven end; n not a whole number ≥ 1.

    Examples
    --------
    >>> limit = stiff_limit()
    >>> limit.equation, limit.expression, limit.length
    (Eq(tan(x), tanh(x)), sqrt(3)*x**2/(6*pi), 24**(1/4)*B**(1/4)*Z_0**(1/4)/(g**(1/4)*rho**(1/4)))
    >>> for end in ("pinned", "clamped"):
    ...     limit = stiff_limit(end)
    ...     print(f"{end}: kL = {limit.root:.4f}, f_1 rises by {100 * limit.increase:.2f} %")
    pinned: kL = 3.9266, f_1 rises by 41.68 %
    clamped: kL = 4.7300, f_1 rises by 18.69 %
    """
    import sympy

    end, n = check_driven_end(driven_end), check_count(n)
    x = sympy.Symbol("x", positive=True)
    stiffness, height, rho, g = sympy.symbols("B Z_0 rho g", positive=True)
    sigma = _quartic(end)
    half, odd = (x, True) if end == "pinned" else (x / 2, n % 2 == 0)
    root = float(wavenumbers(0.0, n, end)[-1])
    expression = sympy.sqrt(sigma) * x**2 / sympy.pi
    return StiffLimit(
        driven_end=end,
        n=n,
        length=(2 * stiffness * height / (sigma * rho * g)) ** sympy.Rational(1, 4),
        equation=sympy.Eq(sympy.tan(half), sympy.tanh(half) if odd else -sympy.tanh(half)),
        expression=expression,
        root=root,
        ratio=float(expression.subs(x, sympy.Float(root, 17))),
    )


@cache
def _quartic(driven_end: DrivenEnd) -> sympy.Rational:
    """σ: the static condition βs(z) = 1 begins with s ~ σz⁴."""
    import sympy

    z = sympy.Symbol("z", positive=True)
    static = {
        "pinned": z**2 - 2 * z * sympy.tanh(z / 2),
        "clamped": (z * sympy.coth(z / 2) - 2) ** 2,
    }[driven_end]
    return sympy.series(static, z, 0, 6).removeO().coeff(z, 4)


# -- nonlinear resonances ------------------------------------------------------------------------


@dataclass(frozen=True)
class Resonance:
    """qΩ = Ω_p(β): harmonic q of the drive meets linear resonance p.

    Attributes
    ----------
    p, q
        For the string (β = 0) in lowest terms: harmonic kq then meets resonance kp at the same Ω.
        With bending those are resonances of their own, and p/q need not be reduced.
    omega
        Ω = Ω_p(β)/q.
    hertz
        The frequency in hertz, when a rope was given.
    """

    p: int
    q: int
    omega: float
    hertz: float | None = None

    @property
    def first_order(self) -> int:
        """n = q: harmonic q first appears at ε^q, and with it this pole."""
        return self.q


def nonlinear_resonances(
    order: int,
    low: float,
    high: float,
    beta: float = 0.0,
    driven_end: str = "pinned",
    rope: Rope | None = None,
) -> tuple[Resonance, ...]:
    """All poles of the expansion of the given order in low ≤ Ω ≤ high, ascending in Ω, then q.

    Parameters
    ----------
    order
        N: q = 1 … N.
    low, high
        The window of Ω, 0 ≤ low < high; :meth:`Rope.omega_from_hertz` converts from hertz.
    beta, driven_end
        β ≥ 0 and the driven end.
    rope
        Fills in ``hertz``; its own bending stiffness is not used.

    Raises
    ------
    InputError
        A bad order, window, β or driven end; a window with more than 10⁵ candidates.

    Examples
    --------
    >>> [f"{r.p}/{r.q}" for r in nonlinear_resonances(3, 0.5, 3.2)]
    ['1/3', '1/2', '2/3', '1/1']
    >>> for r in nonlinear_resonances(2, 3.0, 4.0, beta=0.01):       # 2/2 has left 1/1
    ...     print(f"{r.p}/{r.q}: Omega = {r.omega:.4f}, from order {r.first_order}")
    1/1: Omega = 3.2500, from order 1
    2/2: Omega = 3.5888, from order 2
    """
    N, value, end = check_order(order), single_stiffness(beta), check_driven_end(driven_end)
    low, high = _window(low, high)
    if N * N * high / math.pi > _MOST:
        raise InputError(
            f"order {N} has about {N * N * high / math.pi:.2g} candidates p/q up to Omega = "
            f"{high:g}; give a lower order or a narrower window"
        )
    # Ω_p ≥ pπ, so that no p beyond this one can matter.
    linear = linear_frequencies(value, max(1, math.floor(N * high / math.pi) + 1), end)
    found = [
        _resonance(p, q, omega / q, rope)
        for q in range(1, N + 1)
        for p, omega in enumerate(linear.tolist(), start=1)
        if low <= omega / q <= high and (value > 0 or math.gcd(p, q) == 1)
    ]
    return tuple(sorted(found, key=lambda r: (r.omega, r.q)))


def neighbouring_resonances(
    omega: float, order: int, beta: float = 0.0, driven_end: str = "pinned"
) -> tuple[Resonance | None, Resonance]:
    """The poles of the expansion of the given order next to Ω: at or below it, and above.

    For the string they are neighbours in the Farey sequence of the order. There is none below
    Ω₁(β)/N.

    Raises
    ------
    InputError
        Ω not positive and finite; a bad order, β or driven end.

    Examples
    --------
    >>> below, above = neighbouring_resonances(2.2, order=6)
    >>> f"{below.p}/{below.q} < 2.2/pi < {above.p}/{above.q}"
    '2/3 < 2.2/pi < 3/4'
    """
    N, value, end = check_order(order), single_stiffness(beta), check_driven_end(driven_end)
    _, omega = _window(0.0, omega)
    if N * omega / math.pi > _MOST:
        raise InputError(f"Omega = {omega!r} at order {N} needs too many linear resonances")
    linear = linear_frequencies(value, math.floor(N * omega / math.pi) + 2, end)
    found: set[Resonance] = set()
    for q in range(1, N + 1):
        # Reduced fractions round differently: look one further on both sides.
        first = int(np.searchsorted(linear, q * omega))
        for p in range(max(first - 1, 1), min(first + 2, linear.size) + 1):
            common = math.gcd(p, q) if value == 0 else 1
            reduced = p // common, q // common
            found.add(_resonance(*reduced, float(linear[reduced[0] - 1]) / reduced[1]))
    below = [r for r in found if r.omega <= omega]
    nearest = max(below, key=lambda r: (r.omega, -r.q)) if below else None
    return nearest, min((r for r in found if r.omega > omega), key=lambda r: (r.omega, r.q))


def _resonance(p: int, q: int, omega: float, rope: Rope | None = None) -> Resonance:
    return Resonance(p, q, omega, None if rope is None else float(rope.hertz_from_omega(omega)))


def _window(low: Any, high: Any) -> tuple[float, float]:
    try:
        bounds = float(low), float(high)
    except (TypeError, ValueError):
        raise InputError(f"Omega from {low!r} to {high!r}: give two numbers") from None
    if not 0 <= bounds[0] < bounds[1] < math.inf:
        raise InputError(
            f"Omega from {bounds[0]!r} to {bounds[1]!r}: give finite numbers 0 <= low < high"
        )
    return bounds
