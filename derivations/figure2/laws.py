r"""Every law of Fig. 2: what it says, where its centre is, and over which window it can hold.

Three families are derived, none of them fitted: the touch of the truncated expansion (β = 0,
:mod:`asymptotics.resonances.tongues`), the separatrix of the pendulum, to which the truncations
lead (β = 0, :func:`asymptotics.resonances.tongues.limit_law`), and the fold of the rope that
resists bending (β > 0, :mod:`asymptotics.resonances.folds`). The fourth are the paper's three fits,
with the paper's centres.

**Windows.** The fold of the mode p comes from an amplitude equation, which needs two things.
*From above:* the second harmonic must not resonate, |qμ| ≪ D = Ω_{2p} − 2Ω_p; D ∝ β, so that this
window closes as β → 0. *From below:* what ends at a fold is a state, not at once the motion without
waves. The slow motion runs around a loop that starts at the double root a_f = |qμ/3α|^{1/2} and
reaches 3a_f. Only if that is large enough is a wave shed; otherwise the rope goes on, wave-less,
around the large root. The largest amplitude of the contact point that goes without a wave is a
measured number, :data:`LARGEST_AMPLITUDE`. It serves the window alone, never the law. Within the
window the premises are met at all; how good the law is there says its own error estimate,
:meth:`asymptotics.resonances.folds.Fold.error`, which reaches 10 % early in it.

The truncated tongue lies beyond the radius of convergence of the series it truncates, which is the
pendulum's law, wherever C |μ|^r exceeds it: for all |μ| up to :func:`first_convergent`, a number
larger than any μ there is. It has no window.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.resonances.folds import Fold, Kind, amplitude_equation
from asymptotics.resonances.tongues import limit_law, tongue
from derivations.figure2.data import BETAS, centres

Array = NDArray[np.float64]

PAPER_CENTRE = 3.2
"""Ω₀ of the paper's Fig. 2."""

PAPER_FITS = {
    "1/2": (0.5, 1.815, Fraction(3, 4)),
    "1/1": (1.0, 0.309, Fraction(5, 3)),
    "2/1": (2.0, 0.077, Fraction(5, 3)),
}
"""Resonance ↦ centre in units of Ω₀, coefficient and exponent, as printed in Fig. 2's caption."""

ORDERS = {"1/2": 4, "1/1": 3, "2/1": 3}
"""The order of the expansion that the paper truncates at."""

LARGEST_AMPLITUDE = 0.2
"""Half the swing of ξ_c beyond which waves were seen to leave next to Ω₁ at β = 0.01; a beat of
0.17 stayed wave-less for 140 periods, one of 0.23 did not (docs/figure2.md)."""

HARMONIC_SHARE = 0.5
"""Share of D up to which |qμ| counts as small against it."""


class Family(Enum):
    """Where a law comes from."""

    TRUNCATED = "truncated tongue"
    PENDULUM = "pendulum"
    FOLD = "bending fold"
    PAPER = "the paper's fit"


@dataclass(frozen=True)
class Law:
    """ε = coefficient · |Ω − centre|^exponent; a fold's with the shift of its centre.

    Attributes
    ----------
    family, resonance
        Which; ``resonance`` is p/q.
    beta
        Of the rope that it describes.
    centre, coefficient, exponent
        The law.
    sides
        Signs of μ = Ω − centre on which it stands.
    window
        |μ| between which its derivation holds; (inf, 0) if nowhere, (0, inf) if unlimited or, for
        a fit, not stated.
    bent
        The amplitude equation behind a fold. For q = 2 its shift is part of the law.
    """

    family: Family
    resonance: str
    beta: float
    centre: float
    coefficient: float
    exponent: Fraction
    sides: tuple[int, ...]
    window: tuple[float, float]
    bent: Fold | None = None

    def epsilon(self, omega: ArrayLike) -> Array:
        """ε at Ω; nan on a side where the law does not stand.

        >>> law = laws(Family.PENDULUM)[1]
        >>> law.resonance, float(law.epsilon(math.pi + 0.2).round(6))
        ('1/1', 0.005)
        """
        mu = np.asarray(omega, dtype=float) - self.centre
        if self.bent is not None:
            return self.bent.epsilon(mu)
        size = self.coefficient * np.abs(mu) ** float(self.exponent)
        return np.where(np.isin(np.sign(mu), (0, *self.sides)), size, math.nan)

    @property
    def text(self) -> str:
        """The law for a figure's label, in TeX's mathematics.

        >>> laws(Family.PAPER)[1].text
        '$0.309\\\\,|\\\\mu|^{5/3}$'
        """
        power = str(self.exponent)
        size = r"|\mu|" if not self.shifted else r"|\mu-\gamma\epsilon^2/2|"
        size += "" if power == "1" else rf"^{{{power}}}"
        return rf"${self.coefficient:.3g}\,{size}$"

    @property
    def shifted(self) -> bool:
        """Whether the law is one in the distance from a shifted centre."""
        return self.bent is not None and self.bent.gamma is not None


@cache
def laws(family: Family, beta: float = 0.0) -> tuple[Law, ...]:
    """The three laws of a family, around Ω₁/2, Ω₁ and Ω₂.

    >>> [round(law.coefficient, 4) for law in laws(Family.FOLD, 0.01)]
    [0.9958, 0.1127, 0.0401]
    >>> [round(law.coefficient, 4) for law in laws(Family.TRUNCATED)]
    [1.8149, 0.3092, 0.0773]
    """
    return tuple(_MAKERS[family](resonance, beta) for resonance in PAPER_FITS)


def all_laws() -> tuple[Law, ...]:
    """Every law that Fig. 2 is drawn against."""
    derived = [law for beta in BETAS for law in laws(Family.FOLD, beta)]
    strings = [law for family in (Family.TRUNCATED, Family.PENDULUM) for law in laws(family)]
    return (*derived, *strings, *laws(Family.PAPER))


def first_convergent(resonance: str) -> float:
    """|μ| from which on the truncated tongue lies below the pendulum's law, (C/C∞)^{1/(r∞ − r)}.

    >>> [round(first_convergent(name), 1) for name in PAPER_FITS]
    [4.1, 15.1, 15.1]
    """
    [truncated] = (law for law in laws(Family.TRUNCATED) if law.resonance == resonance)
    [pendulum] = (law for law in laws(Family.PENDULUM) if law.resonance == resonance)
    ratio = truncated.coefficient / pendulum.coefficient
    return float(ratio ** (1 / float(pendulum.exponent - truncated.exponent)))


def second_harmonic(p: int, beta: float) -> float:
    """D = Ω_{2p} − 2Ω_p, how far the second harmonic of the mode p is from resonance.

    >>> round(second_harmonic(1, 0.01), 4), round(second_harmonic(1, 0.001), 4)
    (0.6777, 0.0868)
    """
    frequencies = linear_frequencies(beta, 2 * p)
    return float(frequencies[2 * p - 1] - 2 * frequencies[p - 1])


def fold_window(resonance: str, beta: float) -> tuple[float, float]:
    """|μ| between which the fold is the loss of the wave-less state; see the module's docstring.

    The largest amplitude is that of a contact speed, so it goes as 1/Ω_p.

    >>> [round(edge, 3) for edge in fold_window("1/1", 0.01)]
    [0.052, 0.339]
    """
    p, q = (int(part) for part in resonance.split("/"))
    result = amplitude_equation(p, q, beta)
    if result.kind is not Kind.END:
        return (math.inf, 0.0)
    amplitude = LARGEST_AMPLITUDE * centres(0.01)["1/1"] / (q * result.resonance)
    # 3a_f = the largest amplitude, with a_f² = qμ/(3α).
    low = abs(result.alpha.value) * amplitude**2 / (3 * q)
    high = HARMONIC_SHARE * abs(second_harmonic(p, beta)) / q
    return (low, high) if low < high else (math.inf, 0.0)


def _fold(resonance: str, beta: float) -> Law:
    p, q = (int(part) for part in resonance.split("/"))
    found = amplitude_equation(p, q, beta)
    return Law(
        Family.FOLD,
        resonance,
        beta,
        found.resonance,
        found.coefficient.value,
        found.exponent,
        (found.mu_sign,),
        fold_window(resonance, beta),
        found,
    )


def _truncated(resonance: str, beta: float) -> Law:
    p, q = (int(part) for part in resonance.split("/"))
    found = tongue(p, q, ORDERS[resonance])
    coefficient = found.sides["+"].coefficient  # odd poles: the same on both sides
    window = (math.inf, 0.0)
    return Law(
        Family.TRUNCATED,
        resonance,
        0.0,
        p * math.pi / q,
        coefficient,
        found.exponent,
        (-1, 1),
        window,
    )


def _pendulum(resonance: str, beta: float) -> Law:
    p, q = (int(part) for part in resonance.split("/"))
    found = limit_law(p, q)
    return Law(
        Family.PENDULUM,
        resonance,
        0.0,
        p * math.pi / q,
        found.coefficient,
        found.exponent,
        (-1, 1),
        (0.0, math.inf),
    )


def _paper(resonance: str, beta: float) -> Law:
    ratio, coefficient, exponent = PAPER_FITS[resonance]
    return Law(
        Family.PAPER,
        resonance,
        0.01,
        ratio * PAPER_CENTRE,
        coefficient,
        exponent,
        (-1, 1),
        (0.0, math.inf),
    )


_MAKERS: dict[Family, Callable[[str, float], Law]] = {
    Family.TRUNCATED: _truncated,
    Family.PENDULUM: _pendulum,
    Family.FOLD: _fold,
    Family.PAPER: _paper,
}
