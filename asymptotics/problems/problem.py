r"""A moving-contact problem as data.

The lifted part obeys a linear equation; at the contact point ξ_c(τ) the shape and its first m − 1
slopes vanish, W = W_ξ = … = ∂^{m−1}W = 0. The expansion needs to know of the problem only

* the static derivatives a_d = ∂^d W₀ at the static contact point, a₀ = … = a_{m−1} = 0 ≠ a_m;
* for each harmonic e^{ijθ}, how derivatives at the static contact point follow from the first
  m − 1 of them: the *impedances*; and how the drive enters;
* the equation itself, as the reduction of ∂^r to lower derivatives;
* the conditions that hold at ξ_c, of which the last one determines it.

Where the ground gives way (:class:`Ground`) the rope beyond ξ_c moves too: the conditions are then
that nothing jumps there, and that W = 0.

Two more functions state the equation and the driven end a second time, in their own words. The
engine never calls them: they are what each order is substituted back into.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic

from asymptotics.rings.pickling import Remembered
from asymptotics.rings.ring import E, Ring


@dataclass(frozen=True)
class Mode(Generic[E]):
    """One harmonic e^{ijθ} of the lifted part, seen from the static contact point.

    Attributes
    ----------
    reduction
        (χ₀, …, χ_{r−1}) with ∂^r = Σ χ_i ∂^i on solutions of harmonic j.
    impedance
        One row per contact datum w, w′, …, w^{(m−2)}: the first r derivatives of the solution that
        has unit datum and satisfies the homogeneous driven end. On a ground that gives way the data
        are the jumps of w … w^{(r−1)}, and a row has the first r derivatives from the left, then
        from the right.
    source
        The first r (or 2r) derivatives of the solution with zero contact data and unit drive.
    """

    reduction: tuple[E, ...]
    impedance: tuple[tuple[E, ...], ...]
    source: tuple[E, ...]


@dataclass(frozen=True)
class ContactCondition:
    """∂_ξ^e W, or what it jumps by, vanishes at the contact point.

    Attributes
    ----------
    derivative
        e.
    jump
        Whether the difference between the right and the left of ξ_c is meant, or the left.
    """

    derivative: int
    jump: bool = False


@dataclass(frozen=True)
class Ground(Generic[E]):
    """A ground that gives way: the rope beyond the contact point, seen from ξ₀.

    Attributes
    ----------
    static, static_reduction
        As in :class:`Problem`, from the right.
    reduction
        j ↦ (χ_0, …), as in :class:`Mode`.
    equation_residual, load
        As in :class:`Problem`.
    end_residual
        (j, [w, w′, …]) ↦ what each condition far away leaves of one harmonic: that it decays, or
        carries energy away.
    """

    static: Callable[[int], E]
    static_reduction: tuple[E, ...]
    reduction: Callable[[int], tuple[E, ...]]
    equation_residual: Callable[[int, Sequence[E]], E] = field(repr=False)
    load: tuple[E, ...] = field(repr=False)
    end_residual: Callable[[int, Sequence[E]], tuple[E, ...]] = field(repr=False)


@dataclass(frozen=True)
class Varying(Generic[E]):
    """An equation whose coefficients vary with ξ: its derivatives at ξ₀ by Leibniz' rule.

    Attributes
    ----------
    weights
        (j, d) ↦ ∂^d, d ≥ r, in terms of w … w^{(d−1)}.
    residual
        (j, q, [w, …, w^{(r+q)}]) ↦ what the q-th derivative of the equation leaves of a harmonic.
    """

    weights: Callable[[int, int], tuple[E, ...]]
    residual: Callable[[int, int, Sequence[E]], E] = field(repr=False)


@dataclass(frozen=True)
class Problem(Remembered, Generic[E]):
    r"""Everything the order loop and the proof need to know.

    Attributes
    ----------
    name
        Identifies the problem in files and messages.
    ring
        Where the coefficients live.
    contact_order
        m: 2 for the string, 3 for the beam; how many derivatives W, W_ξ, … vanish at ξ_c. On a
        ground that gives way W alone does, m = 1.
    static
        d ↦ a_d.
    static_reduction
        ∂^R on the static shape in terms of lower derivatives, as in :class:`Mode`.
    mode
        j ↦ :class:`Mode`.
    drive
        Amplitude of each e^{ijθ}, j ≥ 0, in the driven end's motion, in units of the small
        parameter; the reflected harmonics are understood.
    inverse_leading
        1/a_m.
    equation_residual
        (j, [w, w′, …]) ↦ what the PDE leaves of one harmonic, zero on a solution.
    end_residual, end_unit
        (j, [w, w′, …, first r]) ↦ what each homogeneous condition at the driven end, of which there
        are r − m + 1, leaves of one harmonic; and j ↦ what a unit drive leaves of each.
    load, static_end_residual
        What the static shape leaves of the PDE at ξ₀ (its weight) and of its derivatives in ξ, as
        far as they do not vanish; and d ↦ a_d ↦ what a static shape with
        these derivatives leaves of each condition at the driven end (zero for W₀), linear in them
        but for a constant.
    rest
        ξ₀, the static contact point; None where it is no element of the ring. The expansion does
        not need it, its values do.
    ground
        What lies beyond ξ_c, where that moves; None where it lies still.
    varying
        Where coefficients depend on ξ; the reductions then hold at ξ₀ only.
    balls
        Makes the same problem over balls, in the precision of the moment. Where it is given,
        :func:`~asymptotics.expansion.order_loop.expand` computes there and rounds to doubles, all
        digits right: see :mod:`asymptotics.expansion.rounded`.
    sweep
        Where the parameters are arrays: how :mod:`asymptotics.expansion.swept` bounds the errors of
        theirs.
    """

    name: str
    ring: Ring[E]
    contact_order: int
    static: Callable[[int], E]
    static_reduction: tuple[E, ...]
    mode: Callable[[int], Mode[E]]
    drive: Mapping[int, E]
    inverse_leading: E
    equation_residual: Callable[[int, Sequence[E]], E] = field(repr=False)
    end_residual: Callable[[int, Sequence[E]], tuple[E, ...]] = field(repr=False)
    end_unit: Callable[[int], tuple[E, ...]] = field(repr=False)
    load: tuple[E, ...] = field(repr=False)
    static_end_residual: Callable[[Callable[[int], E]], tuple[E, ...]] = field(repr=False)
    rest: E | None = None
    balls: Callable[[], Problem[Any]] | None = field(default=None, repr=False)
    sweep: Sweep | None = field(default=None, repr=False)
    ground: Ground[E] | None = field(default=None, repr=False)
    varying: Varying[E] | None = field(default=None, repr=False)

    @property
    def conditions(self) -> tuple[ContactCondition, ...]:
        """What holds at the contact point; the last determines ξ_n, the others the contact data."""
        if self.ground is None:
            return tuple(ContactCondition(e) for e in range(self.contact_order))
        jumps = range(len(self.mode(0).reduction))
        return (*(ContactCondition(e, jump=True) for e in jumps), ContactCondition(0))

    def static_at(self, condition: ContactCondition, d: int) -> E:
        """∂^d of what a condition is about, of the static shape at ξ₀."""
        left = self.static(d)
        if not condition.jump:
            return left
        assert self.ground is not None
        minus = self.ring.rational(-1)
        return self.ring.sum([self.ground.static(d), minus * left])


@dataclass(frozen=True)
class Sweep:
    """A problem, or what belongs to one, at all points of arrays of parameters.

    Attributes
    ----------
    shape
        Of the arrays, broadcast.
    bounded
        Makes it over :class:`~asymptotics.rings.bounded.Bounded` arrays.
    at
        Flat index ↦ the same at that point, over numbers that have balls behind them.
    """

    shape: tuple[int, ...]
    bounded: Callable[[], Any]
    at: Callable[[int], Any]
