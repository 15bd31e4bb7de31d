"""What :func:`asymptotics.expansion.proof.prove` hands out: the proofs of the orders, in words and
data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from asymptotics.errors import RopewaveError
from asymptotics.expansion.enclosures import WIDEST, Enclosure
from asymptotics.expansion.verdicts import Kind, in_words, residual_in_words


@dataclass(frozen=True)
class OrderProof:
    """What substitution found at order n; ``holds`` when all five statements do.

    Attributes
    ----------
    equation, driven_end, contact
        Whether the statement holds, by the measure of :mod:`asymptotics.expansion.verdicts`.
    missing, foreign, harmonics
        Harmonics of ξ_n that have to be there and are not, that cannot be there and are, and those
        that are as they should.
    tails
        Whether :func:`~asymptotics.expansion.order_loop.expand` may continue from this order.
    kind, sizes
        The arithmetic, and for each of the first three statements what was measured; zeros over an
        exact ring.
    """

    n: int
    equation: bool
    driven_end: bool
    contact: bool
    missing: tuple[int, ...]
    harmonics: tuple[int, ...]
    foreign: tuple[int, ...] = ()
    tails: bool = True
    kind: Kind = "exact"
    sizes: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def holds(self) -> bool:
        """All five statements."""
        substitution = self.equation and self.driven_end and self.contact
        return substitution and self.tails and not self.missing and not self.foreign

    def __str__(self) -> str:
        found = zip(
            ("PDE residual", "driven end", "contact"),
            (self.equation, self.driven_end, self.contact),
            self.sizes,
            strict=True,
        )
        left = ", ".join(
            f"{name} {residual_in_words(self.kind, holds, size)}" for name, holds, size in found
        )
        substance = [f"harmonics {', '.join(map(str, self.harmonics))} non-zero"]
        if self.missing:
            substance = [f"harmonics {', '.join(map(str, self.missing))} MISSING"]
        if self.foreign:
            substance.append(f"harmonics {', '.join(map(str, self.foreign))} CANNOT BE")
        if not self.tails:
            substance.append("tails WRONG")
        worst = min(self.sizes) if self.kind == "truncated" else max(self.sizes)
        word = in_words(self.kind, self.holds, worst)
        return f"order {self.n}: {word} ({left}; {'; '.join(substance)})"


@dataclass(frozen=True)
class Proof(Sequence[OrderProof]):
    """The proofs of orders 0 … N, a sequence, and what they are relative to.

    Attributes
    ----------
    enclosures
        The string's own problem at random frequencies; empty for other rings.
    """

    orders: tuple[OrderProof, ...]
    enclosures: tuple[Enclosure, ...] = ()

    @property
    def holds(self) -> bool:
        """Every order and every enclosure."""
        orders = all(proof.holds for proof in self.orders)
        return orders and all(point.holds for point in self.enclosures)

    @property
    def relative_to(self) -> str:
        """What the proof takes for granted, in a sentence."""
        kind = self.orders[0].kind
        if self.enclosures:
            return (
                "identically in Omega and c = cot(Omega); and at "
                f"{len(self.enclosures)} random Omega the coefficients satisfy W_tautau = W_xixi - "
                "2, the driven end and W = W_xi = 0 at x_c in certified enclosures, of relative "
                f"radius below {WIDEST:.0e}"
            )
        if kind == "numbers":
            return "numbers: residuals over the sum of their terms' magnitudes, not errors"
        if kind == "balls":
            return "balls: each residual contains 0, with the radius stated"
        if kind == "truncated":
            return "series in mu: the coefficients that are known, identically"
        return "identically in the ring's generators, whatever values these are given"

    @overload
    def __getitem__(self, index: int) -> OrderProof: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[OrderProof, ...]: ...

    def __getitem__(self, index: int | slice) -> OrderProof | tuple[OrderProof, ...]:
        return self.orders[index]

    def __len__(self) -> int:
        return len(self.orders)

    def __str__(self) -> str:
        return "\n".join((*map(str, self.orders), f"relative to: {self.relative_to}"))


class RefutedError(RopewaveError):
    """Substitution left a residual; ``proofs`` holds what was found at each order."""

    def __init__(self, proofs: Proof) -> None:
        self.proofs = proofs
        super().__init__(_refutation(proofs))


def _refutation(proofs: Proof) -> str:
    bad = next((p for p in proofs if not p.holds), None)
    if bad is None:
        point = next(point for point in proofs.enclosures if not point.holds)
        where = [n for n, holds in enumerate((point.static, *point.orders)) if not holds]
        return (
            f"order {where[0]}: REFUTED at Omega = {point.omega}, tau = {point.tau}: there the "
            "coefficients do not satisfy W_tautau = W_xixi - 2, the driven end and the contact "
            "conditions. The problem is not the string's, with c = cot(Omega): mend its ring, its "
            "cotangents or its frequency"
        )
    if bad.kind == "numbers":
        return (
            f"{bad}. That is more than rounding leaves: the numbers do not solve the problem from "
            "this order on; expand it again"
        )
    return (
        f"{bad}. The expansion is wrong from this order on: discard it, and any saved copy, "
        "and derive it again"
    )
