r"""Folds: where two states merge next to a resonance when the rope resists bending.

Near Ω = Ω_p(β)/q + μ, Ω_p a frequency of the true linear spectrum, the amplitude a of cos qθ in the
contact point is resonant and obeys

.. math:: (qμ − γε^2)\, a = F ε^q + α a^3, \qquad θ = Ωτ.

With M = qμ − γε² the cubic has a double root where 27 α F² ε^{2q} = 4M³, on the side Mα > 0:

.. math:: qμ = γε^2 + κ ε^{2q/3}, \quad κ = (27αF^2/4)^{1/3}, \qquad \text{or} \qquad
          ε = C_{p,q} |μ − γε^2/q|^{3/(2q)}, \quad
          C_{p,q} = \Bigl(\frac{2 q^{3/2}}{3\sqrt3\,|F|\sqrt{|α|}}\Bigr)^{1/q}.

For q = 1 the shift γ is of higher order. For q = 2 it is small against μ as μ → 0, but no smaller
than other terms that are kept. For q = 3 both terms are ∝ ε², so that the exponent ½ survives in μ
with another coefficient, possibly on the other side. For q ≥ 4 the shift dominates: a power law
holds in the distance from the shifted centre only.

**What a fold ends.** There are three states where σqμ > S(ε) = σγε² + |κ|ε^{2q/3}, σ = sign α, and
one elsewhere. Raised from rest at a fixed μ with σμ > 0, the state is the middle root of the three,
and it ends where S reaches σqμ: the fold *ends the branch from rest*. But where S starts downwards,
the fold is on the side σμ < 0: there the state from rest is the only one, entering S < σqμ a
*disconnected pair is born* beside it, and it passes through. S starts upwards, S > 0, if

.. math:: q ≤ 2; \qquad |κ| + σγ > 0 \;(q = 3); \qquad σγ > 0 \;(q ≥ 4).

Either kind is met *by sweeping Ω at fixed ε*: the middle root, small far away on the side σ, is
lost where the sweep leaves σqμ > S. From the other side the single state goes over into the
largest of the three, without a loss.

**How far.** The law is made of leading terms; :mod:`asymptotics.resonances.fold_range` compares it
with the reduced equation of higher order (:mod:`asymptotics.expansion.reduced_equation`, which also
says how F, α and γ are found).

**β → 0.** The second harmonic is then nearly resonant too, Ω_{2p} − 2Ω_p ≈ 3β(pπ)³, and

.. math:: α ≈ −\frac{(pπ)^2}{4(Ω_{2p} − 2Ω_p)} ≈ −\frac{1}{12pπβ}, \qquad
          C_{p,q} ≈ \Bigl(\frac{4 q^{3/2}\sqrt{pπβ}}{3|F^0|}\Bigr)^{1/q} ∝ β^{1/(2q)},
          \qquad C_{p,1} ≈ \frac83\sqrt{\frac{β}{pπ}},

F⁰ being the string's F: the law's coefficient vanishes, and with it its range ∝ Ω_{2p} − 2Ω_p. The
rope without bending has another law, the pendulum's, of exponent 2/q:

.. math:: ε = \Bigl(\frac{π^2μ^2}{4v}\Bigr)^{1/q}, \qquad v = \frac{4pπ|F^0|}{q^2}
          \qquad (ε = μ^2/8p^2 \text{ for } q = 1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import arb

from asymptotics.checks import finite_number
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import expand
from asymptotics.expansion.reduced_equation import Array, Resonance
from asymptotics.problems.beam import check_beam
from asymptotics.problems.string import string_problem
from asymptotics.resonances.fold_range import LEAST, Range, fold_range
from asymptotics.resonances.leading_law import Terms, cubic, detuning_at, epsilon_at, law_terms
from asymptotics.rings.balls import outward
from asymptotics.rings.ring import FloatRing

_EPS = float(np.finfo(float).eps)
_SIDES = {-1: "below", 1: "above"}

LARGEST_P, LARGEST_Q = 1000, 8
"""The reduced equation of order q + 4 takes time ∝ q⁶, and F falls faster than 10^{−q/2}."""


class Kind(Enum):
    """What happens at a fold to the states at fixed Ω when ε is raised."""

    END = "ends the branch from rest"
    BIRTH = "birth of a disconnected pair"


@dataclass(frozen=True)
class FoldCoefficient:
    """A real number with a bound on its absolute error."""

    value: float
    error: float

    @classmethod
    def of(cls, ball: arb) -> FoldCoefficient:
        """The double next to a ball's centre, and how far from it the ball reaches."""
        value = float(ball.mid())
        return cls(value, outward(abs(ball - arb(value)))[1])


@dataclass(frozen=True)
class Fold:
    """The amplitude equation at Ω_p(β)/q and its fold, see the module's docstring.

    Attributes
    ----------
    resonance
        Ω_p(β)/q.
    F, alpha, gamma
        Coefficients of the amplitude equation; γ is None for q = 1, where it is of higher order.
    string_F
        F⁰, the coefficient F at β = 0.
    range
        Where the law holds; None if no detuning was found at which it does.
    """

    p: int
    q: int
    beta: float
    driven_end: str
    resonance: float
    F: FoldCoefficient
    alpha: FoldCoefficient
    gamma: FoldCoefficient | None
    string_F: float
    range: Range | None = None

    @property
    def resonant(self) -> Resonance:
        """Which resonance this is."""
        return Resonance(self.p, self.q, self.beta, self.driven_end)

    @property
    def exponent(self) -> Fraction:
        """3/(2q)."""
        return Fraction(3, 2 * self.q)

    @property
    def coefficient(self) -> FoldCoefficient:
        """C_{p,q}, in the detuning from the shifted centre; to first order in the errors."""
        q, F, alpha = self.q, self.F, self.alpha
        value = float(fold_coefficient(q, F.value, alpha.value))
        relative = F.error / abs(F.value) + alpha.error / abs(2 * alpha.value)
        # The formula itself rounds a few times.
        return FoldCoefficient(value, value * (relative / q + 4 * _EPS))

    @property
    def sign(self) -> int:
        """σ, the sign of α: that of the detuning from the shifted centre on the fold."""
        return 1 if self.alpha.value > 0 else -1

    @property
    def mu_sign(self) -> int:
        """The sign of μ on the fold as ε → 0."""
        return 1 if self._terms[0][0] > 0 else -1

    @property
    def side(self) -> str:
        """``below`` or ``above`` the shifted resonance."""
        return _SIDES[self.sign]

    @property
    def mu_side(self) -> str:
        """``below`` or ``above`` Ω_p/q itself, where the fold starts at ε = 0."""
        return _SIDES[self.mu_sign]

    @property
    def kind(self) -> Kind:
        """What the fold is to the state that is reached from rest.

        >>> fold(1, 1, 0.01).kind.value, fold(1, 3, 0.01).kind.value
        ('ends the branch from rest', 'birth of a disconnected pair')
        """
        return Kind.END if self.mu_sign == self.sign else Kind.BIRTH

    @property
    def coefficient_in_detuning(self) -> float | None:
        """The coefficient of |μ|^{3/(2q)} in μ itself, times the sign of μ; None if no such law."""
        if self.q == 1:
            return self.sign * self.coefficient.value
        if self.q != 3:
            return None
        return self.mu_sign * float(abs(self.detuning(1.0))) ** -0.5

    @property
    def cubic(self) -> float:
        """κ = (27αF²/4)^{1/3}."""
        return cubic(self.F.value, self.alpha.value)

    @property
    def _terms(self) -> Terms:
        """qμ on the fold as Σ c x^m, x = ε^{2/3}, lowest power first."""
        return law_terms(self.q, self.cubic, None if self.gamma is None else self.gamma.value)

    @property
    def powers(self) -> list[tuple[float, Fraction]]:
        """μ on the fold as Σ c ε^m: the pairs (c, m), lowest power first."""
        return [(c / self.q, Fraction(2 * m, 3)) for c, m in self._terms]

    def detuning(self, epsilon: npt.ArrayLike) -> Array:
        """μ on the fold at amplitude ε ≥ 0: (γε² + κε^{2q/3})/q.

        >>> fold(1, 1, 0.01).detuning([1e-4, 1e-3]).round(6)
        array([-0.009235, -0.042865])
        """
        return detuning_at(self._terms, epsilon) / self.q

    def epsilon(self, mu: npt.ArrayLike) -> Array:
        """ε on the fold at detuning μ, from ε = 0 up to where μ turns round, or ε = 1; else nan.

        What happens there says :attr:`kind`, how good it is :meth:`error`: at the birth of a pair
        the state reached from rest passes through. At ε = 1 the driven end touches down.

        >>> fold(1, 2, 0.01).epsilon([-1e-4, 1e-4]).round(6)
        array([0.000999,      nan])
        """
        return epsilon_at(self._terms, self.q * np.asarray(mu, dtype=float))

    def error(self, mu: npt.ArrayLike) -> Array:
        """The estimated relative error of :meth:`epsilon`, c|μ|; inf beyond :attr:`range`.

        >>> fold(1, 1, 0.01).error([-0.01, -0.03, -0.3]).round(3)
        array([0.019, 0.057,   inf])
        """
        size = abs(np.asarray(mu, dtype=float))
        if self.range is None:
            return np.full(size.shape, math.inf)
        return np.where(size <= self.range.mu, self.range.slope * size, math.inf)

    def amplitude(self, epsilon: float) -> float:
        """a at the double root, where 3αa² = M = κε^{2q/3}: 3Fε^q/(2M)."""
        return 1.5 * self.F.value / self.cubic * epsilon ** (self.q / 3)

    def string_epsilon(self, mu: npt.ArrayLike) -> Array:
        """The pendulum law of the rope without bending, (π²μ²/(4v))^{1/q}: of another rope."""
        v = 4 * self.p * math.pi * abs(self.string_F) / self.q**2
        return np.asarray((math.pi**2 * np.asarray(mu, dtype=float) ** 2 / (4 * v)) ** (1 / self.q))

    def as_json(self) -> dict[str, Any]:
        """What ``ropewave fold P/Q --beta B --json`` prints."""
        found = {name: getattr(self, name) for name in ("F", "alpha", "gamma", "coefficient")}
        reach = self.range
        return {
            "command": "fold",
            "p": self.p,
            "q": self.q,
            "beta": self.beta,
            "driven_end": self.driven_end,
            "resonance": self.resonance,
            "kind": self.kind.name.lower(),
            "meaning": self.meaning,
            "exponent": str(self.exponent),
            "coefficient": self.coefficient.value,
            "variable": "mu" if self.q == 1 else f"mu - gamma*epsilon**2/{self.q}",
            "side": self.side,
            "sign": self.sign,
            "mu_of_epsilon": [{"coefficient": c, "exponent": str(m)} for c, m in self.powers],
            "coefficient_in_mu": self.coefficient_in_detuning,
            "side_in_mu": self.mu_side,
            "range": None
            if reach is None
            else {
                "mu": reach.mu,
                "epsilon": reach.epsilon,
                "error": reach.error,
                "error_per_mu": reach.slope,
                "reduced_order": reach.order,
            },
            "reason": self.reason,
            "F": self.F.value,
            "alpha": self.alpha.value,
            "gamma": None if self.gamma is None else self.gamma.value,
            "errors": {name: x.error for name, x in found.items() if x is not None},
            "string_F": self.string_F,
        }

    @property
    def meaning(self) -> list[str]:
        """What follows for a state at fixed Ω when ε is raised, and at fixed ε when Ω is swept."""
        name, direction = f"Omega_{self.p}/{self.q}", "up" if self.sign < 0 else "down"
        rise = {
            Kind.END: "raising epsilon from rest, the wave-less state ends here",
            Kind.BIRTH: "raising epsilon from rest, the wave-less state passes through: "
            "a pair of other states is born beside it",
        }[self.kind]
        return [
            f"at fixed Omega {self.mu_side} {name}: {rise}",
            f"at fixed epsilon: sweeping Omega {direction} from far {self.side}, "
            "the small state ends here",
        ]

    @property
    def reason(self) -> str:
        """Why the range is what it is."""
        if self.range is None:
            return f"the law was found to hold at no detuning down to {LEAST:g} of the resonance"
        return self.range.reason


def fold_coefficient(q: int, F: npt.ArrayLike, alpha: npt.ArrayLike) -> Array:
    """C_{p,q} from the coefficients of the amplitude equation.

    >>> round(float(fold_coefficient(1, -1.73159, -3.89146)), 6)     # β = 0.01, p = 1
    0.11268
    """
    size = np.abs(F) * np.sqrt(np.abs(alpha))
    return np.asarray((2 * q**1.5 / (3 * math.sqrt(3) * size)) ** (1 / q))


def fold(p: int, q: int, beta: float, driven_end: str = "pinned") -> Fold:
    """The amplitude equation and the fold at Ω_p(β)/q.

    Parameters
    ----------
    p, q
        Positive and without a common factor; p ≤ 1000, q ≤ 8.
    beta
        β = B/(T x₀²) > 0.
    driven_end
        ``pinned`` or ``clamped``.

    Raises
    ------
    InputError
        p/q is not a reduced fraction of positive integers or one is too large, β is not positive
        and finite or so small or large that the law leaves double precision, the driven end is
        unknown, or another resonance is too close for the coefficients to be told apart.

    Examples
    --------
    >>> result = fold(1, 1, 0.01)
    >>> round(result.resonance, 7), round(result.F.value, 5), round(result.alpha.value, 5)
    (3.2500013, -1.73159, -3.89146)
    >>> str(result.exponent), round(result.coefficient.value, 6), result.side
    ('3/2', 0.11268, 'below')
    """
    found = amplitude_equation(p, q, beta, driven_end)
    return replace(found, range=fold_range(found))


def amplitude_equation(p: int, q: int, beta: float, driven_end: str = "pinned") -> Fold:
    """:func:`fold` without the range of the law, which takes most of the time.

    Raises what :func:`fold` raises.

    Examples
    --------
    >>> F = [amplitude_equation(1, 2, beta).F.value for beta in (1e-2, 1e-6)]
    >>> [round(value, 4) for value in F]                  # → −π³/64 = −0.4845 as β → 0
    [-0.5566, -0.4845]
    """
    p, q = check_fraction(p, q)
    check_beam(beta, driven_end)
    resonance = Resonance(p, q, finite_number("beta", beta), driven_end)
    F, alpha, *gamma = (FoldCoefficient.of(ball) for ball in resonance.coefficients())
    result = Fold(
        p=p,
        q=q,
        beta=resonance.beta,
        driven_end=driven_end,
        resonance=resonance.value,
        F=F,
        alpha=alpha,
        gamma=gamma[0] if gamma else None,
        string_F=string_forcing(p, q),
    )
    if not all(0 < abs(x) < math.inf for x in (F.value, alpha.value, result.coefficient.value)):
        raise InputError(
            f"beta = {resonance.beta!r}: the coefficients of the fold at Omega_{p}/{q} leave the "
            "range of double precision; give a beta closer to 1"
        )
    return result


def string_forcing(p: int, q: int) -> float:
    """F⁰, the coefficient F of the rope without bending at Ω = pπ/q: eq. (linresponse1) and beyond.

    Harmonic q first appears at order q, there times cot qΩ ≈ 1/(qμ): any two values of the
    cotangent give its factor.

    >>> string_forcing(1, 1) / -(math.pi / 2), round(string_forcing(1, 2) / -(math.pi**3 / 64), 14)
    (1.0, 1.0)
    """
    if q == 1:
        return (-1) ** p * p * math.pi / 2
    omega = p * math.pi / q

    def harmonic(at_pole: float) -> float:
        def cot(j: int) -> float:
            return at_pole if j == q else 1 / math.tan(j * omega)

        return float(2 * expand(string_problem(FloatRing(), omega, cot), q).contact(q).get(q, 0.0))

    return (harmonic(1.0) - harmonic(0.0)) / math.sin(omega) ** q


def check_fraction(p: Any, q: Any) -> tuple[int, int]:
    """p and q as positive coprime integers, at most :data:`LARGEST_P` and :data:`LARGEST_Q`.

    >>> check_fraction(2, 4)
    Traceback (most recent call last):
    ...
    asymptotics.errors.InputError: p/q = 2/4 is not in lowest terms: ask for 1/2
    """
    for name, value in (("p", p), ("q", q)):
        if isinstance(value, bool) or not hasattr(value, "__index__") or value < 1:
            raise InputError(f"{name} = {value!r}; give p/q with positive integers, e.g. 1/2")
    p, q = int(p), int(q)
    common = math.gcd(p, q)
    if common > 1:
        raise InputError(
            f"p/q = {p}/{q} is not in lowest terms: ask for {p // common}/{q // common}"
        )
    if p > LARGEST_P:
        raise InputError(f"p = {p}: no rope has the frequency Omega_{p}; give p <= {LARGEST_P}")
    if q > LARGEST_Q:
        raise InputError(
            f"q = {q}: the fold needs the expansion of order q + 4, whose cost grows like q⁶, and "
            f"is of no use there, F being below 10^(-q/2); give q <= {LARGEST_Q}"
        )
    return p, q
