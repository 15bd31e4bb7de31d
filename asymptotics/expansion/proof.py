"""Each order proves itself by substitution.

Five statements are checked for every order:

* the equation: every harmonic and every derivative that the expansion used satisfies the PDE;
* the driven end: every harmonic meets each of its conditions, the drive's own with its amplitude;
* the contact: W and its first m − 1 slopes vanish at the *moving* contact point. The shift is made
  by the series of :mod:`asymptotics.expansion.moving_frame`, which share nothing with the engine's
  Taylor sums;
* substance: every harmonic that n-fold products of the drive can excite is there (of numbers and
  balls, where one may vanish, some), and no other. An expansion that collapsed to 0 = 0 would
  satisfy the first three, and a negative index is seen by none;
* the tails, from which :func:`~asymptotics.expansion.order_loop.expand` continues (exact ring only,
  where they are saved), see :mod:`asymptotics.expansion.modular`.

**What a proof is relative to.** Substitution is into the equation and the driven end that the
:class:`~asymptotics.problems.problem.Problem` states, over its ring; what the ring's letters mean
it does not know. For the exact string that is closed: :mod:`asymptotics.expansion.enclosures` puts
the expansion into W_ττ = W_ξξ − 2, W(0, τ) = 1 + εΔZ, W = W_ξ = 0 at ξ_c in balls at random Ω, with
c = cot Ω. For polynomials in generators a proof holds for whatever values the generators are given.
Over numbers and balls it is about those numbers, and the verdict is another:
:mod:`asymptotics.expansion.verdicts`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic

from asymptotics.errors import InputError
from asymptotics.expansion.certificates import OrderProof, Proof, RefutedError
from asymptotics.expansion.enclosures import enclosures
from asymptotics.expansion.images import MajorantRing, image_of_expansion
from asymptotics.expansion.modular import wrong_tails
from asymptotics.expansion.moving_frame import MovingFrame, moving_frame
from asymptotics.expansion.order_loop import Expansion, Progress, derivative_towers
from asymptotics.expansion.verdicts import Kind, allowed_by_rounding, kind_of, verdict
from asymptotics.problems.problem import Ground, Problem
from asymptotics.rings.cotangent import CotangentRing
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.ring import E, Ring


def prove(
    expansion: Expansion[E],
    frame: MovingFrame[E] | None = None,
    progress: Progress | None = None,
) -> Proof:
    """Substitute an expansion back, order by order; order 0 is the static shape.

    Parameters
    ----------
    frame
        :func:`~asymptotics.expansion.moving_frame.moving_frame` of the expansion, when already
        computed.
    progress
        Called with n while the frame is computed.

    Raises
    ------
    RefutedError
        Some order leaves a residual, lacks a harmonic it must have, has one it cannot have, or
        cannot be continued.
    InputError
        ``frame`` is another expansion's.

    Examples
    --------
    >>> from asymptotics import exact_string, expand, float_string
    >>> print(*prove(expand(exact_string(), order=2)), sep="\\n")
    order 0: proved (PDE residual 0, driven end 0, contact 0; harmonics 0 non-zero)
    order 1: proved (PDE residual 0, driven end 0, contact 0; harmonics 1 non-zero)
    order 2: proved (PDE residual 0, driven end 0, contact 0; harmonics 0, 2 non-zero)
    >>> print(prove(expand(float_string(2.2, 1), 1))[0])
    order 0: consistent to 0 (PDE residual 0, driven end 0, contact 0; harmonics 0 non-zero)
    """
    if frame is not None and frame.expansion is not expansion:
        raise InputError("the moving frame belongs to another expansion; leave it out")
    foreign = _foreign(expansion)
    if any(foreign):
        expansion, frame = _without(expansion, foreign), None
    frame = moving_frame(expansion, progress) if frame is None else frame
    kind = kind_of(expansion.problem.ring)
    scales: MovingFrame[Any] | None = None
    if kind == "numbers":
        ring = MajorantRing(expansion.problem.ring.even)
        scales = moving_frame(image_of_expansion(expansion, ring, _magnitude))
    string: Any = expansion if isinstance(expansion.problem.ring, CotangentRing) else None
    wrong = wrong_tails(string) if string else ()
    proofs = Proof(
        tuple(
            _prove_order(frame, scales, n, kind, foreign[n], n not in wrong)
            for n in range(expansion.order + 1)
        )
    )
    if string and proofs.holds:
        proofs = Proof(proofs.orders, enclosures(string))
    if not proofs.holds:
        raise RefutedError(proofs)
    return proofs


def _magnitude(number: Any) -> Any:
    return abs(number)


def _foreign(expansion: Expansion[E]) -> list[tuple[int, ...]]:
    """For each order 0 … N the harmonics that no product of the drive's can excite."""
    drive = list(expansion.problem.drive)
    found: list[tuple[int, ...]] = [()]
    for n, order in enumerate(expansion.orders, start=1):
        here = order.contact.keys() | order.shape.keys()
        found.append(tuple(sorted(here - reachable(drive, n))))
    return found


def _without(expansion: Expansion[E], foreign: Sequence[tuple[int, ...]]) -> Expansion[E]:
    orders = tuple(
        replace(
            order,
            contact={j: c for j, c in order.contact.items() if j not in foreign[n]},
            shape={j: start for j, start in order.shape.items() if j not in foreign[n]},
        )
        for n, order in enumerate(expansion.orders, start=1)
    )
    return Expansion(expansion.problem, orders)


@dataclass(frozen=True)
class Residuals(Generic[E]):
    """What order n leaves of each statement, as ring elements; see :func:`residuals`.

    The keys tell them apart: harmonic and derivative, then twice condition and harmonic.
    """

    equation: Mapping[tuple[int, int], E]
    driven_end: Mapping[tuple[int, int], E]
    contact: Mapping[tuple[int, int], E]

    def __iter__(self) -> Iterator[E]:
        for statement in (self.equation, self.driven_end, self.contact):
            yield from statement.values()


def residuals(expansion: Expansion[E], frame: MovingFrame[E], n: int) -> Residuals[E]:
    """Order n substituted into the equation, the driven end and the contact conditions.

    Zero over an exact ring; over balls each contains zero, and its radius is the bound; over
    floating-point numbers they are roundings.

    >>> from asymptotics import exact_string, expand, moving_frame
    >>> solution = expand(exact_string(), order=2)
    >>> set(residuals(solution, moving_frame(solution), 2))
    {(0)}
    """
    if n == 0:
        return _static_residuals(expansion, frame)
    problem, shape = expansion.problem, expansion.shape(n)
    derivative = derivative_towers(expansion)
    r = len(problem.mode(0).reduction)
    depth = expansion.order - n + (problem.contact_order if problem.ground is None else r)
    equation = {
        (j, d): _differentiated(problem, j, d, lambda i, j=j: derivative(n, j, i))  # type: ignore[misc]
        for j in shape
        for d in range(depth)
    }
    ends: dict[tuple[int, int], E] = {}
    for j, start in shape.items():
        left = problem.end_residual(j, start[:r])
        if n == 1 and j in problem.drive:
            minus = problem.ring.rational(-1) * problem.drive[j]
            pairs = zip(left, problem.end_unit(j), strict=True)
            left = tuple(problem.ring.sum([x, minus * unit]) for x, unit in pairs)
        ends |= {(i, j): x for i, x in enumerate(left)}
    ground = problem.ground
    if ground is not None:
        beyond = derivative_towers(expansion, right=True)
        for j, start in shape.items():
            far = ground.end_residual(j, start[r:])
            ends |= {(len(ends) + i, -1 - j): x for i, x in enumerate(far)}
            for d in range(depth):
                w = [beyond(n, j, d + i) for i in range(r + 1)]
                equation[-1 - j, d] = ground.equation_residual(j, w)
    return Residuals(equation, ends, _contact_residuals(frame, n))


def _differentiated(problem: Problem[E], j: int, d: int, derivative: Callable[[int], E]) -> E:
    """What is left of the equation's d-th derivative."""
    r = len(problem.mode(j).reduction)
    if problem.varying is not None:
        return problem.varying.residual(j, d, [derivative(i) for i in range(r + d + 1)])
    return problem.equation_residual(j, [derivative(d + i) for i in range(r + 1)])


def _static_residuals(expansion: Expansion[E], frame: MovingFrame[E]) -> Residuals[E]:
    """The same of the static shape; its reduction to lower derivatives counts as equation."""
    problem = expansion.problem
    ring, static, reduction = problem.ring, problem.static, problem.static_reduction
    minus, R = ring.rational(-1), len(reduction)
    equation = {}
    for d in range(expansion.order + 1):
        terms = [_differentiated(problem, 0, d, static)]
        if d < len(problem.load):
            terms.append(minus * problem.load[d])
        equation[0, d] = ring.sum(terms)
        if problem.varying is not None:
            continue
        lower = [chi * static(d + i) for i, chi in enumerate(reduction)]
        equation[1, d] = ring.sum([minus * static(d + R), *lower])
    ends = {(i, 0): x for i, x in enumerate(problem.static_end_residual(static))}
    if problem.ground is not None:
        equation |= _static_beyond(problem, problem.ground, expansion.order)
    return Residuals(equation, ends, _contact_residuals(frame, 0))


def _static_beyond(problem: Problem[E], ground: Ground[E], order: int) -> dict[tuple[int, int], E]:
    """What the rope at rest leaves of its equation where it lies on a ground that gives way."""
    ring, static, reduction = problem.ring, ground.static, ground.static_reduction
    minus, r, R = ring.rational(-1), len(problem.mode(0).reduction), len(reduction)
    found = {}
    for d in range(order + 1):
        terms = [ground.equation_residual(0, [static(d + i) for i in range(r + 1)])]
        if d < len(ground.load):
            terms.append(minus * ground.load[d])
        found[2, d] = ring.sum(terms)
        lower = [chi * static(d + i) for i, chi in enumerate(reduction)]
        found[3, d] = ring.sum([minus * static(d + R), *lower])
    return found


def _contact_residuals(frame: MovingFrame[E], n: int) -> dict[tuple[int, int], E]:
    return {
        (index, j): c
        for index, condition in enumerate(frame.expansion.problem.conditions)
        for j, c in frame.left_at_contact(condition, n).items()
    }


def _prove_order(
    frame: MovingFrame[E],
    scales: MovingFrame[Any] | None,
    n: int,
    kind: Kind,
    foreign: tuple[int, ...],
    tails: bool,
) -> OrderProof:
    expansion = frame.expansion
    left = residuals(expansion, frame, n)
    size = left if scales is None else residuals(scales.expansion, scales, n)
    ring = expansion.problem.ring
    rounding, impedances = (
        allowed_by_rounding(ring, expansion.order, flag) if scales else 0.0
        for flag in (False, True)
    )
    statements: tuple[tuple[Mapping[Any, E], Mapping[Any, Any], float], ...] = (
        (left.equation, size.equation, rounding),
        (left.driven_end, size.driven_end, impedances),
        (left.contact, size.contact, rounding),
    )
    equation, driven_end, contact = (
        verdict(kind, ((x, other[key]) for key, x in here.items()), ring, allowed)
        for here, other, allowed in statements
    )
    wanted, present = _substance(expansion, n)
    if kind in ("numbers", "balls") and present:
        wanted = present  # at one frequency and phase a harmonic may vanish
    return OrderProof(
        n=n,
        equation=equation.holds,
        driven_end=driven_end.holds,
        contact=contact.holds,
        missing=tuple(sorted(wanted - present)),
        harmonics=tuple(sorted(present)),
        foreign=foreign,
        tails=tails,
        kind=kind,
        sizes=(equation.size, driven_end.size, contact.size),
    )


def _substance(expansion: Expansion[E], n: int) -> tuple[set[int], set[int]]:
    """Which harmonics order n has to have and has; of order 0 the static shape."""
    problem = expansion.problem
    ring: Ring[E] = problem.ring
    if n == 0:
        return {0}, set() if ring.is_zero(problem.static(problem.contact_order)) else {0}
    present = {j for j, c in expansion.contact(n).items() if not ring.is_zero(c)}
    return reachable(list(problem.drive), n), present
