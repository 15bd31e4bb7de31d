"""The tongue centres that the paper's Fig. 2 uses, beside the linear spectrum.

Fig. 2 is a simulation at β = 0.01, with tongues centred at Ω₀/2, Ω₀ and 2Ω₀, Ω₀ ≈ 3.2. The linear
resonances of a rope with that β are Ω₁ = 3.2500 and Ω₂ = 7.1777; it is β ≈ 0.001 whose Ω₁ and Ω₂
are 3.2 and 6.4 to the digits printed. This module computes the difference and leaves it standing.
"""

from __future__ import annotations

from dataclasses import dataclass

from asymptotics.problems.beam_spectrum import linear_frequencies, stiffness_of
from asymptotics.problems.static_shape import DrivenEnd, check_driven_end, single_stiffness

FIGURE2_BETA = 0.01
COMPARED = (FIGURE2_BETA, 0.001)
"""β of Fig. 2, and the one whose spectrum has the centres printed."""

FIGURE2_CENTRES = {1: 3.2, 2: 6.4}
"""n ↦ where Fig. 2 centres the tongue of the n-th linear resonance: Ω₀ and 2Ω₀."""

# Half a unit in the last of the two digits that 3.2 is printed with.
_HALF_DIGIT = 0.05


@dataclass(frozen=True)
class CentreComparison:
    """One tongue centre of the paper's Fig. 2 beside the linear resonance.

    Attributes
    ----------
    n, printed
        The n-th resonance, and the Ω at which Fig. 2 centres its tongue.
    beta, driven_end, computed
        Ω_n(β) of this rope.
    beta_of_printed
        The β whose Ω_n is the printed centre.
    """

    n: int
    printed: float
    beta: float
    driven_end: DrivenEnd
    computed: float
    beta_of_printed: float

    @property
    def difference(self) -> float:
        """Computed minus printed."""
        return self.computed - self.printed

    @property
    def agrees(self) -> bool:
        """Whether the computed value is within half a unit of the last printed digit."""
        return abs(self.difference) <= _HALF_DIGIT


def figure2_centres(
    betas: tuple[float, ...] = COMPARED, driven_end: str = "pinned"
) -> tuple[CentreComparison, ...]:
    """The paper's centres 3.2 and 6.4 against Ω₁(β) and Ω₂(β), for each β.

    At the β = 0.01 of Fig. 2 both miss, the second by 0.78; at β = 0.001 both agree to the digits
    printed. No β > 0 has Ω₂ = 2Ω₁: bending spreads the spectrum.

    Raises
    ------
    InputError
        A bad β or an unknown driven end.

    Examples
    --------
    >>> for row in figure2_centres():
    ...     print(f"beta = {row.beta}: Omega_{row.n} = {row.computed:.7f}, {row.difference:+.7f}")
    beta = 0.01: Omega_1 = 3.2500013, +0.0500013
    beta = 0.01: Omega_2 = 7.1776557, +0.7776557
    beta = 0.001: Omega_1 = 3.1546485, -0.0453515
    beta = 0.001: Omega_2 = 6.3961356, -0.0038644
    """
    end = check_driven_end(driven_end)
    rows = []
    for beta in betas:
        value = single_stiffness(beta)
        computed = linear_frequencies(value, max(FIGURE2_CENTRES), end)
        for n, printed in FIGURE2_CENTRES.items():
            place = stiffness_of(printed, n, end)
            rows.append(CentreComparison(n, printed, value, end, float(computed[n - 1]), place))
    return tuple(rows)


def stiffness_of_centres(driven_end: str = "pinned") -> tuple[float, float]:
    """The interval of β in which both centres agree with Ω₁(β), Ω₂(β) to the printed digit.

    Ω_n increases with β, so that each centre ± 0.05 bounds β from both sides; the two intervals are
    intersected.

    Raises
    ------
    InputError
        An unknown driven end.

    Examples
    --------
    >>> low, high = stiffness_of_centres()
    >>> f"{low:.5f} <= beta <= {high:.5f}"
    '0.00063 <= beta <= 0.00151'
    """
    end = check_driven_end(driven_end)
    low = [stiffness_of(c - _HALF_DIGIT, n, end) for n, c in FIGURE2_CENTRES.items()]
    high = [stiffness_of(c + _HALF_DIGIT, n, end) for n, c in FIGURE2_CENTRES.items()]
    return max(low), min(high)
