r"""Folds: how the wave-less state is lost next to a resonance when the rope resists bending.

Near Ω = Ω_p(β)/q + μ, Ω_p a frequency of the true linear spectrum, the amplitude a of cos qθ in the
contact point is resonant and obeys

.. math:: (qμ − γε^2)\, a = F ε^q + α a^3, \qquad θ = Ωτ.

Its two small solutions meet, and end, on the *fold*. With M = qμ − γε² the cubic has a double root
where 27 α F² ε^{2q} = 4M³, on the side Mα > 0:

.. math:: ε = C_{p,q} |μ − γε^2/q|^{3/(2q)}, \qquad
          C_{p,q} = \Bigl(\frac{2 q^{3/2}}{3\sqrt3\,|F|\sqrt{|α|}}\Bigr)^{1/q}.

For q ≤ 2 the shift is small against μ and the same law holds in μ itself. For q = 3 both terms are
∝ ε², so that the exponent ½ survives in μ with another coefficient, possibly on the other side. For
q ≥ 4 the shift dominates: a power law holds in the distance from the shifted centre only.

**Where the coefficients come from.** Expanding the amplitude equation in ε and comparing with the
engine's ξ_{n,q}, the coefficient of εⁿ cos qθ in ξ_c (:mod:`asymptotics.resonant_laurent`),

.. math:: ξ_{q,q} = \frac{F}{qμ} + …, \qquad ξ_{q+2,q} = \frac{γF}{(qμ)^2} + …\ (q ≥ 2), \qquad
          ξ_{3,1} = \frac{αF^3}{μ^4} + …\ (q = 1).

α belongs to the mode p alone, so that q = 1 gives it for every q.

**β → 0.** The second harmonic is then nearly resonant too, Ω_{2p} − 2Ω_p ≈ 3β(pπ)³, and

.. math:: α ≈ −\frac{(pπ)^2}{4(Ω_{2p} − 2Ω_p)} ≈ −\frac{1}{12pπβ}, \qquad
          C_{p,q} ≈ \Bigl(\frac{4 q^{3/2}\sqrt{pπβ}}{3|F^0|}\Bigr)^{1/q} ∝ β^{1/(2q)},
          \qquad C_{p,1} ≈ \frac83\sqrt{\frac{β}{pπ}},

F⁰ being the string's F: the law's coefficient vanishes, and with it the window |μ| ≪ Ω_{2p} − 2Ω_p
in which it holds. Beyond, the string's pendulum law takes over, of exponent 2/q:

.. math:: ε = \Bigl(\frac{π^2μ^2}{4v}\Bigr)^{1/q}, \qquad v = \frac{4pπ|F^0|}{q^2}
          \qquad (ε = μ^2/8p^2 \text{ for } q = 1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.beam import check_beam, static_beam
from asymptotics.beam_spectrum import linear_frequencies
from asymptotics.errors import InputError
from asymptotics.resonant_laurent import Array, Pair, beam_laurent, string_forcing


@dataclass(frozen=True)
class Coefficient:
    """A real number with an estimate of its absolute error."""

    value: float
    error: float


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
    """

    p: int
    q: int
    beta: float
    driven_end: str
    resonance: float
    F: Coefficient
    alpha: Coefficient
    gamma: Coefficient | None
    string_F: float

    @property
    def exponent(self) -> Fraction:
        """3/(2q)."""
        return Fraction(3, 2 * self.q)

    @property
    def coefficient(self) -> Coefficient:
        """C_{p,q}, in the detuning from the shifted centre; to first order in the errors."""
        q, F, alpha = self.q, self.F, self.alpha
        value = float(fold_coefficient(q, F.value, alpha.value))
        relative = F.error / abs(F.value) + alpha.error / abs(2 * alpha.value)
        return Coefficient(value, value * relative / q)

    @property
    def sign(self) -> int:
        """The sign of α: that of the detuning from the shifted centre on the fold."""
        return 1 if self.alpha.value > 0 else -1

    @property
    def side(self) -> str:
        """``below`` or ``above`` the (shifted) resonance."""
        return "above" if self.sign > 0 else "below"

    @property
    def coefficient_in_detuning(self) -> float | None:
        """The coefficient of |μ|^{3/(2q)} in μ itself, times the sign of μ; None for q ≥ 4."""
        if self.q <= 2:
            return self.sign * self.coefficient.value
        if self.q > 3:
            return None
        rate = float(self.detuning(1.0))
        return math.copysign(abs(rate) ** -0.5, rate)

    def detuning(self, epsilon: npt.ArrayLike) -> Array:
        """μ on the fold at amplitude ε ≥ 0: [γε² + (27αF²/4)^{1/3} ε^{2q/3}]/q, exactly.

        >>> fold(1, 1, 0.01).detuning([1e-4, 1e-3]).round(6)
        array([-0.009235, -0.042865])
        """
        size = np.asarray(epsilon, dtype=float)
        shift = 0.0 if self.gamma is None else self.gamma.value
        return (shift * size**2 + self._cubic * size ** (2 * self.q / 3)) / self.q

    @property
    def _cubic(self) -> float:
        return float(np.cbrt(27 * self.alpha.value * self.F.value**2 / 4))

    def epsilon(self, mu: npt.ArrayLike) -> Array:
        """The smallest ε on the fold at detuning μ; nan when none is between 0 and 1.

        x = ε^{2/3} solves γx³ + (27αF²/4)^{1/3} x^q = qμ. At ε = 1 the driven end touches down.

        >>> fold(1, 2, 0.01).epsilon([-1e-4, 1e-4]).round(6)
        array([0.000999,      nan])
        """
        values = np.asarray(mu, dtype=float)
        polynomial = np.zeros(max(3, self.q) + 1)
        polynomial[self.q] = self._cubic
        polynomial[3] += 0.0 if self.gamma is None else self.gamma.value
        result = np.full(values.shape, math.nan)
        for place, value in np.ndenumerate(values):
            polynomial[0] = -self.q * value
            roots = np.polynomial.Polynomial(polynomial).roots()
            # A simple root is real to rounding; 1e-9 allows for roots close to a double one.
            real = roots.real[(abs(roots.imag) <= 1e-9 * abs(roots)) & (roots.real > 0)]
            real = real[real < 1]
            if real.size:
                result[place] = real.min() ** 1.5
        return result

    def string_epsilon(self, mu: npt.ArrayLike) -> Array:
        """The pendulum law of the rope without bending, (π²μ²/(4v))^{1/q}."""
        v = 4 * self.p * math.pi * abs(self.string_F) / self.q**2
        return np.asarray((math.pi**2 * np.asarray(mu, dtype=float) ** 2 / (4 * v)) ** (1 / self.q))

    @property
    def crossover(self) -> float:
        """|μ| at which C |μ|^{3/(2q)} and the string's law meet.

        A scale, not a place where either holds: as β → 0 and q = 1 it is 4096/(27π⁴) ≈ 1.56 times
        the window Ω_{2p} − 2Ω_p of the fold's law.
        """
        return float((self.coefficient.value / self.string_epsilon(1.0)) ** (2 * self.q))

    def as_json(self) -> dict[str, Any]:
        """What ``ropewave fold P/Q --beta B --json`` prints."""
        found = {name: getattr(self, name) for name in ("F", "alpha", "gamma", "coefficient")}
        return {
            "command": "fold",
            "p": self.p,
            "q": self.q,
            "beta": self.beta,
            "driven_end": self.driven_end,
            "resonance": self.resonance,
            "exponent": str(self.exponent),
            "coefficient": self.coefficient.value,
            "variable": "mu" if self.q <= 2 else f"mu - gamma*epsilon**2/{self.q}",
            "coefficient_in_mu": self.coefficient_in_detuning,
            "side": self.side,
            "sign": self.sign,
            "F": self.F.value,
            "alpha": self.alpha.value,
            "gamma": None if self.gamma is None else self.gamma.value,
            "errors": {name: x.error for name, x in found.items() if x is not None},
            "string_F": self.string_F,
            "crossover": self.crossover,
        }


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
        Positive and without a common factor.
    beta
        β = B/(T x₀²) > 0.
    driven_end
        ``pinned`` or ``clamped``.

    Raises
    ------
    InputError
        p/q is not a reduced fraction of positive integers, β is not positive and finite, the driven
        end is unknown, or another resonance is too close for the coefficients to be told apart.

    Examples
    --------
    >>> result = fold(1, 1, 0.01)
    >>> round(result.resonance, 7), round(result.F.value, 5), round(result.alpha.value, 5)
    (3.2500013, -1.73159, -3.89146)
    >>> str(result.exponent), round(result.coefficient.value, 6), result.side
    ('3/2', 0.11268, 'below')
    """
    p, q = check_fraction(p, q)
    check_beam(beta, driven_end)
    resonance, F, alpha, gamma = amplitude_equation(p, q, np.array([float(beta)]), driven_end)
    return Fold(
        p=p,
        q=q,
        beta=float(beta),
        driven_end=driven_end,
        resonance=float(resonance[0]),
        F=_coefficient(F),
        alpha=_coefficient(alpha),
        gamma=None if gamma is None else _coefficient(gamma),
        string_F=string_forcing(p, q),
    )


def _coefficient(pair: tuple[Array, Array]) -> Coefficient:
    return Coefficient(float(pair[0][0]), float(pair[1][0]))


def check_fraction(p: Any, q: Any) -> tuple[int, int]:
    """p and q as positive coprime integers.

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
    return p, q


def amplitude_equation(
    p: int, q: int, beta: Array, driven_end: str = "pinned"
) -> tuple[Array, Pair, Pair, Pair | None]:
    """Ω_p/q, F, α and γ for many β at once, shape (n,); the last three with error estimates.

    Raises what :func:`fold` raises.

    Examples
    --------
    >>> F = amplitude_equation(1, 2, np.array([1e-2, 1e-6]))[1][0]
    >>> F.round(4)                                  # → −π³/64 = −0.4845 as β → 0
    array([-0.5566, -0.4845])
    """
    shape = static_beam(beta, driven_end)
    first = beam_laurent(shape, p, 1, 3)
    residue, residue_error = first(1, 1)
    quartic, quartic_error = first(3, 4)
    alpha = quartic / residue**3
    error = abs(alpha) * (abs(quartic_error / quartic) + 3 * abs(residue_error / residue))
    resonance = linear_frequencies(beta, p, driven_end)[:, -1] / q
    if q == 1:
        return resonance, (residue, residue_error), (alpha, error), None
    near = beam_laurent(shape, p, q, q + 2)
    residue, residue_error = near(q, 1)
    double, double_error = near(q + 2, 2)
    # The ratio of ξ_{q+2,q} ∼ γF/(qμ)² and ξ_{q,q} ∼ F/(qμ).
    gamma = q * double / residue
    gamma_error = abs(gamma) * abs(residue_error / residue) + abs(q * double_error / residue)
    return resonance, (q * residue, q * residue_error), (alpha, error), (gamma, gamma_error)
