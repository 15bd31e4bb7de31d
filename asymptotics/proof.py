"""Each order proves itself by substitution.

Four statements are checked for every order, over the exact ring identically in Ω:

* the equation: every harmonic and every derivative that the expansion used satisfies the PDE;
* the driven end: every harmonic meets it, the drive's own with its amplitude;
* the contact: W and its first m − 1 slopes vanish at the *moving* contact point. The shift is made
  by the series of :mod:`asymptotics.profile`, which share nothing with the engine's Taylor sums;
* substance: every harmonic that n-fold products of the drive can excite is there. An expansion that
  collapsed to 0 = 0 would satisfy the first three.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Generic

from asymptotics.errors import RopewaveError
from asymptotics.expansion import Expansion, Progress, derivative_towers
from asymptotics.harmonics import reachable
from asymptotics.profile import MovingFrame, moving_frame
from asymptotics.rings import E


@dataclass(frozen=True)
class OrderProof:
    """What substitution found at order n; ``holds`` when all four statements do."""

    n: int
    equation: bool
    driven_end: bool
    contact: bool
    missing: tuple[int, ...]
    harmonics: tuple[int, ...]

    @property
    def holds(self) -> bool:
        """All four statements."""
        return self.equation and self.driven_end and self.contact and not self.missing

    def __str__(self) -> str:
        def word(good: bool) -> str:
            return "0" if good else "NOT 0"

        substance = f"harmonics {', '.join(map(str, self.harmonics))} non-zero"
        if self.missing:
            substance = f"harmonics {', '.join(map(str, self.missing))} MISSING"
        return (
            f"order {self.n}: {'proved' if self.holds else 'REFUTED'} "
            f"(PDE residual {word(self.equation)}, driven end {word(self.driven_end)}, "
            f"contact {word(self.contact)}; {substance})"
        )


class RefutedError(RopewaveError):
    """Substitution left a residual; ``proofs`` holds what was found at each order."""

    def __init__(self, proofs: tuple[OrderProof, ...]) -> None:
        bad = next(p for p in proofs if not p.holds)
        super().__init__(
            f"{bad}. The expansion is wrong from this order on: discard it, and any saved copy, "
            "and derive it again"
        )
        self.proofs = proofs


def prove(
    expansion: Expansion[E],
    frame: MovingFrame[E] | None = None,
    progress: Progress | None = None,
) -> tuple[OrderProof, ...]:
    """Substitute an exact expansion back, order by order; order 0 is the static shape.

    Raises
    ------
    RefutedError
        Some order leaves a residual, or lacks a harmonic it must have.

    Examples
    --------
    >>> from asymptotics import exact_string, expand
    >>> print(*prove(expand(exact_string(), order=2)), sep="\\n")
    order 0: proved (PDE residual 0, driven end 0, contact 0; harmonics 0 non-zero)
    order 1: proved (PDE residual 0, driven end 0, contact 0; harmonics 1 non-zero)
    order 2: proved (PDE residual 0, driven end 0, contact 0; harmonics 0, 2 non-zero)
    """
    frame = moving_frame(expansion, progress) if frame is None else frame
    proofs = (
        _prove_static(expansion, frame),
        *(_prove_order(expansion, frame, n) for n in range(1, expansion.order + 1)),
    )
    if not all(proof.holds for proof in proofs):
        raise RefutedError(proofs)
    return proofs


def _prove_static(expansion: Expansion[E], frame: MovingFrame[E]) -> OrderProof:
    problem = expansion.problem
    ring, m = problem.ring, problem.contact_order
    r = len(problem.mode(0).reduction)
    residuals = []
    for d in range(expansion.order + 1):
        terms = [problem.equation_residual(0, [problem.static(d + i) for i in range(r + 1)])]
        if d == 0:
            terms.append(ring.rational(-1) * problem.load)
        residuals.append(ring.sum(terms))
    return OrderProof(
        n=0,
        equation=all(ring.is_zero(residual) for residual in residuals),
        driven_end=ring.is_zero(problem.static_end_residual()),
        contact=not any(frame.slope_at_contact(e, 0) for e in range(m)),
        missing=() if not ring.is_zero(problem.static(m)) else (0,),
        harmonics=() if ring.is_zero(problem.static(m)) else (0,),
    )


@dataclass(frozen=True)
class Residuals(Generic[E]):
    """What order n leaves of each statement, as ring elements; see :func:`residuals`."""

    equation: tuple[E, ...]
    driven_end: tuple[E, ...]
    contact: tuple[E, ...]

    def __iter__(self) -> Iterator[E]:
        return iter((*self.equation, *self.driven_end, *self.contact))


def residuals(expansion: Expansion[E], frame: MovingFrame[E], n: int) -> Residuals[E]:
    """Order n ≥ 1 substituted into the equation, the driven end and the contact conditions.

    Zero over an exact ring; over balls each contains zero, and its radius is the bound; over
    floating-point numbers they are roundings.

    >>> from asymptotics import exact_string, expand, moving_frame
    >>> solution = expand(exact_string(), order=2)
    >>> set(residuals(solution, moving_frame(solution), 2))
    {(0)}
    """
    problem, shape = expansion.problem, expansion.shape(n)
    derivative = derivative_towers(expansion)
    depth = expansion.order - n + problem.contact_order
    equation = tuple(
        problem.equation_residual(j, [derivative(n, j, d + i) for i in range(len(start) + 1)])
        for j, start in shape.items()
        for d in range(depth)
    )
    ends = []
    for j, start in shape.items():
        residual = [problem.end_residual(j, start)]
        if n == 1 and j in problem.drive:
            minus = problem.ring.rational(-1) * problem.drive[j]
            residual.append(minus * problem.end_unit(j))
        ends.append(problem.ring.sum(residual))
    contact = tuple(
        c for e in range(problem.contact_order) for c in frame.slope_at_contact(e, n).values()
    )
    return Residuals(equation, tuple(ends), contact)


def _prove_order(expansion: Expansion[E], frame: MovingFrame[E], n: int) -> OrderProof:
    problem = expansion.problem
    ring, contact = problem.ring, expansion.contact(n)
    left = residuals(expansion, frame, n)

    def vanish(elements: Iterable[E]) -> bool:
        return all(ring.is_zero(element) for element in elements)

    wanted = reachable(list(problem.drive), n)
    present = {j for j, c in contact.items() if not ring.is_zero(c)} & set(expansion.shape(n))
    return OrderProof(
        n=n,
        equation=vanish(left.equation),
        driven_end=vanish(left.driven_end),
        contact=vanish(left.contact),
        missing=tuple(sorted(wanted - present)),
        harmonics=tuple(sorted(present)),
    )
