r"""Closed forms on trial: does the error of each order fall like the next power of ε?

At β = 0 the judge is the exact string, with bending the contact simulator, of a reader's own rope
its periodic state by collocation; none knows of the series. An order's slope is fitted where the
judge's own floor and the terms after the next leave it alone (:mod:`derivations.cross_check.data`),
and its uncertainty says what they may still do to it.

=================  ==============================================================================
agrees             the slope is N + 1 within its uncertainty
differs            it is not
floor reached      fewer than two amplitudes are clear of the floor, or the uncertainty exceeds ½
=================  ==============================================================================
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from asymptotics.errors import InputError
from asymptotics.problems.beam import float_beam
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.string import check_frequency
from derivations.cross_check.data import Comparison, against_exact_string
from derivations.cross_check.forms import (
    Array,
    closed_form,
    largest_amplitudes,
    term_sizes,
)
from derivations.cross_check.ropes import against_states, judge_of
from derivations.cross_check.runs import against_simulator
from numerics.simulation.contact import Scheme

Verdict = Literal["agrees", "differs", "floor reached"]
Progress = Callable[[int, int], None]

HIGHEST = {0.0: 8, 1.0: 4}
"""Orders worth judging: without, and with bending, where three more have to be derived."""


LOWEST, FASTEST = 0.05, 50.0
"""Ω between which a period is neither longer than any ramp nor as short as a step."""


@dataclass(frozen=True)
class Judged:
    """What became of one order.

    Attributes
    ----------
    order
        N; the error has to fall like ε^(N+1).
    slope, uncertainty
        The exponent found, and by how much it may be off; None at the floor.
    decades
        Of ε, over which it was fitted.
    verdict
        See the module's docstring.
    """

    order: int
    slope: float | None
    uncertainty: float | None
    decades: float
    verdict: Verdict


@dataclass(frozen=True)
class Validation:
    """A comparison and the verdicts on its orders, of ξ_c."""

    comparison: Comparison
    judge: str
    orders: tuple[Judged, ...]

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers; a row of ``errors`` an order."""
        one = self.comparison
        return {
            "omega": one.omega,
            "beta": None if math.isnan(one.beta) else one.beta,
            "judge": self.judge,
            "epsilons": one.epsilon.tolist(),
            "errors": one.contact.error.tolist(),
            "floor": one.contact.floor.tolist(),
            "slopes": [judged.slope for judged in self.orders],
            "uncertainties": [judged.uncertainty for judged in self.orders],
            "decades": [judged.decades for judged in self.orders],
            "verdicts": [judged.verdict for judged in self.orders],
        }


def validate(
    omega: float,
    beta: float,
    order: int,
    quick: bool = False,
    form: Callable[..., Any] | None = None,
    progress: Progress | None = None,
) -> Validation:
    """Judge the emitted closed forms of orders 1 … N at one Ω and β; or somebody's own.

    Parameters
    ----------
    omega, beta
        Ω, and β ≥ 0 (pinned).
    order
        N ≥ 1, at most 8 without and 4 with bending.
    quick
        A coarser ladder and grid.
    form
        (τ, Ω, ε) ↦ ξ_c, judged in the place of order N as if it were right through ε^N.

    Raises
    ------
    InputError
        A value out of range; a form that does not return numbers.
    ResonanceError
        Ω at a resonance of an order up to N + 3.

    Examples
    --------
    >>> found = validate(2.2, 0.0, 1, quick=True)
    >>> [(judged.order, round(judged.slope, 1), judged.verdict) for judged in found.orders]
    [(1, 2.0, 'agrees')]
    """
    if not LOWEST <= omega <= FASTEST:
        raise InputError(
            f"omega = {omega!r}; the judges follow the rope through a ramp and a period, which "
            f"takes {LOWEST} <= omega <= {FASTEST}"
        )
    most = HIGHEST[float(beta > 0)]
    if not 1 <= order <= most:
        raise InputError(
            f"order = {order}: closed forms {'with' if beta else 'without'} bending are judged "
            f"from order 1 to {most}"
        )
    # The ladder needs the sizes of three more terms: none of them may be at a pole.
    if beta > 0:
        float_beam(beta, omega, order + 3)
    else:
        omega = check_frequency(omega, order + 3)
    forms = [closed_form(omega, n, beta) for n in range(1, order + 1)]
    if form is not None:
        forms[-1] = replace(forms[-1], contact=_called(form, omega))
    if beta == 0:
        points, decades, ramp = (3, 1.0, 200.0) if quick else (4, 2.0, 400.0)
        comparison = against_exact_string(omega, forms, ramp, points, decades, progress)
        return _judged(comparison, "the exact string, from rest")
    sizes = term_sizes(omega, beta, order + 3)
    rungs, dx, ramp = (6, 0.005, 80.0) if quick else (8, 0.00125, 150.0)
    ladder = largest_amplitudes(sizes, order).max() * 2.0 ** (-np.arange(rungs) / 2)
    found = against_simulator(omega, beta, ladder, forms, dx, Scheme.TRAPEZOIDAL, ramp, progress)
    return _judged(found, f"the contact simulator, dx = {dx:g}")


def validate_rope(
    rope: MovingContact,
    at: Mapping[Any, Any],
    order: int,
    quick: bool = False,
    form: Callable[..., Any] | None = None,
    progress: Progress | None = None,
) -> Validation:
    """The same for a reader's own rope, against its periodic states.

    Parameters
    ----------
    rope, at
        As for :func:`asymptotics.expand`.

    Examples
    --------
    >>> from asymptotics.problems.presets import string
    >>> found = validate_rope(string(foundation=1.7), {"Omega": 2.2}, 1, quick=True)
    >>> [judged.verdict for judged in found.orders]
    ['agrees']
    """
    omega = float(rope.values(at)["Omega"])
    own = None if form is None else _called(form, omega)
    found = against_states(rope, at, order, quick, own, progress)
    return _judged(found, judge_of(rope))


def _judged(comparison: Comparison, judge: str) -> Validation:
    return Validation(comparison, judge, tuple(_verdict(comparison, n) for n in comparison.orders))


def _verdict(one: Comparison, n: int) -> Judged:
    decades = one.decades(one.contact, n)[0]
    if one.judged(one.contact, n).sum() < 2:
        return Judged(n, None, None, decades, "floor reached")
    slope, uncertainty = one.slope(one.contact, n), one.uncertainty(one.contact, n)
    if uncertainty > 0.5:
        return Judged(n, None, None, decades, "floor reached")
    verdict: Verdict = "agrees" if abs(slope - n - 1) <= uncertainty else "differs"
    return Judged(n, slope, uncertainty, decades, verdict)


def _called(form: Callable[..., Any], omega: float) -> Callable[[Any, Any], Array]:
    """The reader's function, its answers looked at."""

    def contact(tau: Any, epsilon: Any) -> Array:
        try:
            found = np.asarray(form(tau, omega, epsilon), dtype=float)
        except Exception as error:
            raise InputError(
                f"the closed form cannot be called with (tau, omega, epsilon): {error!r}"
            ) from error
        if found.shape != np.shape(tau) or not np.isfinite(found).all():
            raise InputError(
                f"the closed form returns an array of shape {found.shape}, or numbers that are "
                f"not finite, for tau of shape {np.shape(tau)}; return xi_c at each tau"
            )
        return found

    return contact


def read_form(path: Path) -> Callable[..., Any]:
    """The function ``contact(tau, omega, epsilon)`` of a Python file, which is run.

    Raises
    ------
    InputError
        No such file, one that does not run, or has no such function.
    """
    import runpy

    try:
        found = runpy.run_path(str(path)).get("contact")
    except Exception as error:
        raise InputError(f"{path} does not run: {error!r}") from None
    if not callable(found):
        raise InputError(f"{path} defines no function contact(tau, omega, epsilon)")
    return found
