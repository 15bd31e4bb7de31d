"""A linear rope in numbers, and what its periodic states are asked for by."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from numerics.errors import NumericsError

Array = NDArray[np.float64]
NumberOrPolynomial = float | Sequence[float]
"""A number, or a polynomial in ξ: its coefficients, the highest power first."""
Terms = Mapping[tuple[int, int], NumberOrPolynomial]
"""(k, t) ↦ the coefficient of ∂_ξ^k ∂_τ^t W."""


class NoPeriodicStateError(NumericsError):
    """Newton's iteration found no state at this amplitude."""


@dataclass(frozen=True)
class LinearRope:
    """A rope in numbers, stated without the algebra.

    Attributes
    ----------
    terms, load
        c_{kt} and ℓ.
    ends
        The conditions at ξ = 0: (e_{kt}, d, τ ↦ ΔZ).
    contacts
        m: W − g and its first m − 1 slopes vanish at ξ_c.
    omega, rest
        Ω, and ξ₀ to start from.
    ground
        g's coefficients, the highest power of ξ first.
    springs
        κ of a ground that gives way, see :mod:`numerics.periodic.modes`; then m = 1.
    """

    terms: Terms
    load: NumberOrPolynomial
    ends: Sequence[tuple[Terms, float, Callable[[Array], Array]]]
    contacts: int
    omega: float
    rest: float
    ground: Sequence[float] = (0.0,)
    springs: float = 0.0

    @property
    def order(self) -> int:
        """r."""
        return max(k for k, _ in self.terms)
