r"""The amplitude equation of a resonance of any undamped rope, and the fold that it has.

Where qΩ is close to a free frequency ω_p (:mod:`asymptotics.problems.free_frequencies`) harmonic q
is not expanded: b = ∂^{m−1}w_q at ξ₀ is given instead, a second small parameter, and the contact
condition w = 0 of that harmonic is not imposed (Lyapunov–Schmidt reduction). What is left of it is

.. math:: G(ε, b; Ω) = D(qΩ)\, b + \sum_{n ≤ N} \sum_k g_{n−k,k} ε^{n−k} b^k = 0, \qquad
          D(ω_p) = 0 .

The amplitude of cos qθ in ξ_c is a = −2b/a_m + …. With μ = Ω − ω_p/q and n₀ the first order that
excites harmonic q,

.. math:: (qμ − γε^2)\, a = F ε^{n_0} + α a^3, \qquad
          F = \frac{2}{a_m D'} g_{n_0,0}, \quad α = −\frac{a_m^2}{4D'} g_{0,3}, \quad
          γ = −\frac{1}{D'} g_{2,1},

and a double root where :math:`qμ = γε^2 + κ ε^{2n_0/3}`, κ = (27αF²/4)^{1/3}, for n₀ = 1 without
the γ (:mod:`asymptotics.resonances.leading_law`). How far that law holds says
:mod:`asymptotics.resonances.fold_range`. The paper's beam has a code of its own,
:mod:`asymptotics.resonances.folds`; the two agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import acb, acb_poly, arb, arb_poly, ctx

from asymptotics.checks import whole_number
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import expand
from asymptotics.expansion.reduced_equation import (
    ComplexPolynomialRing,
    PolynomialRing,
    left_over,
    until_narrow,
)
from asymptotics.problems.contact_problem import Enclosed, enclosed_problem
from asymptotics.problems.enclosed_expressions import enclose
from asymptotics.problems.free_frequencies import free_frequencies
from asymptotics.problems.fundamental import product, solve
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.problem import Mode, Problem
from asymptotics.resonances.fold_range import LEAST, Range, fold_range
from asymptotics.resonances.leading_law import Terms, cubic, detuning_at, epsilon_at, law_terms
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.precision import PrecisionError, at_precision

LARGEST_Q = 8
_MOST_P = 200
_BITS = (160, 320, 640, 1280, 2560, 5120)
_NARROW = 2.0**-52


@dataclass(frozen=True)
class RopeFold:
    """What :func:`rope_fold` found.

    Attributes
    ----------
    p, q
        Of ω_p/q.
    excited
        n₀.
    frequency
        ω_p.
    F, alpha, gamma
        Of the amplitude equation; γ of q = 1 too, where it is of higher order than the rest.
    errors
        Bounds on what rounding and the numerical D′ leave of the three.
    resonant
        The resonance, for the law's range.
    """

    p: int
    q: int
    excited: int
    frequency: float
    F: float
    alpha: float
    gamma: float
    errors: tuple[float, float, float]
    resonant: RopeResonance = field(repr=False)

    @property
    def kappa(self) -> float:
        """κ of the fold, with the sign of α."""
        return cubic(self.F, self.alpha)

    @property
    def terms(self) -> Terms:
        """qμ on the fold as Σ c x^m, x = ε^{2/3}, lowest power first."""
        return law_terms(self.excited, self.kappa, self.gamma)

    @property
    def mu_sign(self) -> int:
        """The sign of μ on the fold as ε → 0."""
        return 1 if self.terms[0][0] > 0 else -1

    def detuning(self, epsilon: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """μ of the fold at ε, by the law of leading terms."""
        return detuning_at(self.terms, np.abs(epsilon)) / self.q

    def epsilon(self, mu: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """ε ≥ 0 of the fold at μ, by the law; nan where it has none."""
        return epsilon_at(self.terms, self.q * np.asarray(mu, dtype=float))

    def amplitude(self, epsilon: float) -> float:
        """a at the double root, where 3αa² = κε^{2n₀/3}."""
        return 1.5 * self.F / self.kappa * epsilon ** (self.excited / 3)

    @cached_property
    def range(self) -> Range | None:
        """Where the law holds; None if it was found to hold nowhere. Takes seconds."""
        return fold_range(self)

    def amplitudes(self, mu: float, epsilon: float) -> npt.NDArray[np.float64]:
        """The real roots a of the amplitude equation, increasing: one state, or three."""
        linear = self.q * mu - self.gamma * epsilon**2
        roots = np.roots([self.alpha, 0.0, -linear, self.F * epsilon**self.excited])
        real = roots[np.abs(roots.imag) <= 1e-9 * (np.abs(roots) + 1e-300)].real
        return np.sort(real)

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "command": "fold",
            "p": self.p,
            "q": self.q,
            "excited": self.excited,
            "frequency": self.frequency,
            "resonance": self.frequency / self.q,
            "F": self.F,
            "alpha": self.alpha,
            "gamma": self.gamma,
            "kappa": self.kappa,
            "errors": list(self.errors),
            "range": None
            if self.range is None
            else {
                "mu": self.range.mu,
                "epsilon": self.range.epsilon,
                "error": self.range.error,
                "error_per_mu": self.range.slope,
                "reduced_order": self.range.order,
            },
            "reason": f"the law was found to hold at no detuning down to {LEAST:g} of the resonance"
            if self.range is None
            else self.range.reason,
        }


def rope_fold(rope: MovingContact, at: Mapping[Any, Any], p: int, q: int) -> RopeFold:
    """The amplitude equation at ω_p/q of a rope at values of its parameters.

    Parameters
    ----------
    rope
        As it was written down: even in time, so without damping and without sines in its drive;
        constant coefficients, a ground that does not give way, and a simple resonance, which the
        string's is not where all multiples of one frequency resonate.
    at
        Symbol or name ↦ number, without Ω.
    p, q
        Which free frequency, and over which harmonic, 1 ≤ q ≤ 8.

    Raises
    ------
    InputError
        Anything else; a harmonic that the drive does not excite; another resonance so close that
        the coefficients are lost.

    Examples
    --------
    >>> from asymptotics.problems.presets import beam
    >>> found = rope_fold(beam(), {"beta": 0.01}, 1, 1)
    >>> round(found.F, 5), round(found.alpha, 5)
    (-1.73159, -3.89146)
    """
    whole_number("q", q, LARGEST_Q)
    values, start = reducible(rope, at, p)
    drive = sorted({abs(j) for c in rope.driven_end for j in c.drive})
    orders = [n for n in range(1, 2 * LARGEST_Q) if q in reachable(drive, n)]
    if not orders:
        raise InputError(f"harmonic {q} is not excited by a drive of harmonics {drive}")
    excited = orders[0]
    for bits in _BITS:
        with at_precision(bits):
            try:
                found = _coefficients(rope, values, start, q, excited)
            except PrecisionError:
                continue
        if all(error <= _NARROW * (abs(x) + 1) for x, error in found[1:]):
            (frequency, _), (F, f), (alpha, a), (gamma, g) = found
            resonant = RopeResonance(rope, tuple(sorted(values.items())), p, q, start)
            return RopeFold(p, q, excited, frequency, F, alpha, gamma, (f, a, g), resonant)
    raise InputError(
        f"the amplitude equation at omega_{p}/{q} of {rope} is lost in {_BITS[-1]} bits: another "
        "resonance is too close"
    )


def placed(rope: MovingContact, at: Mapping[Any, Any], p: int) -> tuple[dict[str, Fraction], float]:
    """The values of a rope, and its ω_p in doubles; with damping the real part.

    Raises
    ------
    InputError
        p is not from 1 to 200; bad values.
    """
    whole_number("p", p, _MOST_P)
    given = {
        str(getattr(key, "name", key)): value for key, value in at.items() if str(key) != "Omega"
    }
    values = rope.values({**given, "Omega": 1})
    return values, float(np.real(free_frequencies(rope, given, p).values[p - 1]))


def reducible(
    rope: MovingContact, at: Mapping[Any, Any], p: int
) -> tuple[dict[str, Fraction], float]:
    """The same, of a rope whose resonances have one real amplitude.

    Raises
    ------
    InputError
        Also: the rope is damped or gyroscopic, or driven by sines.
    """
    values, start = placed(rope, at, p)
    drives = [enclose(a, values) for c in rope.driven_end for a in c.drive.values()]
    if rope.irreversible or not all(a.imag.contains(0) for a in drives):
        raise InputError(
            f"{rope}: the law of leading terms is for one real amplitude, without damping and "
            "gyroscopic terms, driven by cosines only; choose the time so that no phase is left, "
            "or ask for the normal form (ropewave normal-form), which takes them"
        )
    return values, start


def _exact(ball: arb) -> Fraction:
    """The centre of a ball.

    Raises
    ------
    PrecisionError
        It holds everything.
    """
    if not ball.is_finite():
        raise PrecisionError("the free frequency", ball)
    mantissa, exponent = ball.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


class Resonant:
    """One rope at rational frequencies next to a resonance."""

    def __init__(self, rope: MovingContact, values: Mapping[str, Fraction], q: int) -> None:
        self.rope, self.values, self.q = rope, values, q

    def at(self, rate: Fraction) -> Enclosed:
        """The rope driven at Ω = rate/q."""
        return Enclosed(self.rope, tuple(sorted({**self.values, "Omega": rate / self.q}.items())))

    def exchanged(self, made: Enclosed) -> tuple[list[list[acb]], list[acb], list[acb]]:
        """Harmonic q per contact datum (the first left out), per b, and driven: r derivatives."""
        m, r, q = self.rope.contact_order, self.rope.order, self.q
        table = product(made.rows(q), made.propagator(q).backwards(made.static.point))
        free = [0, *range(m, r)]
        block = [[row[c] for c in free] for row in table]

        def column(datum: int | None, right: Sequence[acb]) -> list[acb]:
            found = solve(block, right, f"harmonic {q} next to its resonance")
            full = [acb(0)] * r
            for c, x in zip(free, found, strict=True):
                full[c] = x
            if datum is not None:
                full[datum] = acb(1)
            return full

        data = [column(k, [-row[k] for row in table]) for k in range(1, m - 1)]
        return data, column(m - 1, [-row[m - 1] for row in table]), column(None, made.amplitudes(q))

    def detuning(self, rate: Fraction) -> arb:
        """D at the angular frequency ``rate`` = qΩ."""
        return self.exchanged(self.at(rate))[1][0].real

    def resonance(self, rate: Fraction) -> tuple[Fraction, arb]:
        """ω_p next to ``rate``, and D′ there, in the precision of the moment."""
        step = Fraction(1, 2 ** (ctx.prec // 3))
        for _ in range(ctx.prec.bit_length()):
            below, here, above = (self.detuning(rate + d * step) for d in (-1, 0, 1))
            slope = (above - below) / (2 * arb(step.numerator) / arb(step.denominator))
            rate = _exact(arb(rate.numerator) / arb(rate.denominator) - here / slope)
        # The next term of the difference quotient, D‴ step²/6, from D″ as it is seen.
        curved = abs(above - 2 * here + below) / (arb(step.numerator) / arb(step.denominator))
        widened = slope.rad() + curved.upper() * arb(2) ** (-ctx.prec // 4)
        return rate, arb(slope.mid(), widened)


@dataclass(frozen=True)
class RopeResonance:
    """ω_p/q of one rope, as :mod:`asymptotics.resonances.fold_range` asks for it.

    Attributes
    ----------
    rope, values
        The rope, and its parameters but for Ω.
    p, q
        Of ω_p/q.
    start
        ω_p in doubles.
    """

    rope: MovingContact
    values: tuple[tuple[str, Fraction], ...]
    p: int
    q: int
    start: float

    @property
    def value(self) -> float:
        """ω_p/q."""
        return self.start / self.q

    def spectrum(self, count: int) -> npt.NDArray[np.float64]:
        """ω_1 … ω_count."""
        given = {name: x for name, x in self.values if name != "Omega"}
        return np.array(free_frequencies(self.rope, given, min(count, _MOST_P)).values)

    def scaled(
        self, mu: float, epsilon: float, amplitude: float, order: int
    ) -> list[npt.NDArray[np.float64]]:
        """G's orders at ω_p/q + μ as g_{n−k,k} ε^{n−k} b^k, over the largest of them.

        b is −a_m/2 times the amplitude a.

        Raises
        ------
        InputError
            8192 bits do not suffice.
        """
        resonant = Resonant(self.rope, dict(self.values), self.q)

        def compute() -> list[arb]:
            centre, _ = resonant.resonance(Fraction(self.start))
            rate = centre + self.q * Fraction(mu)
            leading = resonant.at(rate).static.derivative(self.rope.contact_order).real
            b = -amplitude * leading / 2
            terms = [
                g * arb(epsilon) ** (n - k) * b**k
                for n, row in enumerate(reduced(resonant, rate, self.q, order), start=1)
                for k, g in enumerate(row)
            ]
            largest = max(x.mid().abs_lower() for x in terms)
            return [x / largest for x in terms]

        found = until_narrow(compute, f"the reduced equation at omega_{self.p}/{self.q}", True)
        flat = np.array([float(x.mid()) for x in found])
        # Order n has n + 1 coefficients.
        return np.split(flat, np.cumsum(np.arange(2, order + 1)))


def _coefficients(
    rope: MovingContact, values: Mapping[str, Fraction], start: float, q: int, excited: int
) -> list[tuple[float, float]]:
    """ω_p, F, α, γ with errors, in the precision of the moment."""
    resonant = Resonant(rope, values, q)
    rate, slope = resonant.resonance(Fraction(start))
    G = reduced(resonant, rate, q, max(3, excited))
    leading = resonant.at(rate).static.derivative(rope.contact_order).real
    amplitude = -2 / leading
    third = [*G[2], *[arb(0)] * 4]
    balls = [
        arb(rate.numerator) / arb(rate.denominator),
        -amplitude * G[excited - 1][0] / slope,
        -third[3] / (amplitude**2 * slope),
        -third[1] / slope,
    ]
    return [
        (float(x.mid()), float(x.rad().upper()) + 2.0**-53 * abs(float(x.mid()))) for x in balls
    ]


def reduced(
    resonant: Resonant, rate: Fraction, q: int, order: int, phase: acb | None = None
) -> list[list[Any]]:
    """G through an order, at Ω = rate/q: real balls, or complex ones where b = r e^{iφ}.

    ``phase`` is e^{iφ}, and the letter is r, for a rope whose states are not even in time.
    """
    values = tuple(sorted({**resonant.values, "Omega": rate / q}.items()))
    base: Problem[Any] = enclosed_problem(resonant.rope, values)
    made = resonant.at(rate)
    data, by_b, driven = resonant.exchanged(made)
    ring: PolynomialRing = PolynomialRing() if phase is None else ComplexPolynomialRing()
    b = arb_poly([0, 1]) if phase is None else acb_poly([0, phase])

    def lift(row: Sequence[Any]) -> tuple[Any, ...]:
        return tuple(ring.constant(acb(x)) for x in row)

    @cache
    def mode(j: int) -> Mode[Any]:
        if j != q:
            known = base.mode(j)
            rows = tuple(lift(row) for row in known.impedance)
            return Mode(lift(known.reduction), rows, lift(known.source))
        coefficients = made.propagator(q).coefficients
        r = len(coefficients) - 1
        reduction = [-c / coefficients[r] for c in coefficients[:r]]
        rows = (lift([0] * r), *(lift(row) for row in data))
        both = tuple(b * x + y for x, y in zip(lift(by_b), lift(driven), strict=True))
        return Mode(lift(reduction), rows, both)

    problem = replace(
        base,
        name=f"reduced {base.name}",
        ring=ring,
        static=cache(lambda d: ring.constant(acb(base.static(d)))),
        static_reduction=lift(base.static_reduction),
        mode=mode,
        drive=dict.fromkeys({*base.drive, q}, ring.one),
        inverse_leading=ring.constant(acb(base.inverse_leading)),
    )
    solution = expand(problem, order)
    return [left_over(solution, q, n) for n in range(1, order + 1)]


def law_in_words(found: RopeFold) -> list[str]:
    """The fold's law and its range as lines of text."""
    terms = " ".join(f"{c:+.6g} epsilon^({Fraction(2 * m, 3)})" for c, m in found.terms)
    law = f"fold: {found.q} (Omega - {found.frequency / found.q:.10g}) = {terms}"
    reach = found.range
    if reach is None:
        return [law, "range  none: the law was found to hold at no detuning"]
    return [
        law,
        f"range  |mu| <= {reach.mu:.3g}, epsilon <= {reach.epsilon:.3g}: epsilon is off by about "
        f"{reach.slope:.2g} |mu|, {reach.error:.1%} at the end",
        f"  {reach.reason}",
    ]
