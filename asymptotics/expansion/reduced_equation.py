r"""The reduced equation of a resonant harmonic of the rope that bends, in proved balls.

Harmonic q of the drive is nearly resonant where qΩ is close to a frequency Ω_p(β) of the linear
spectrum: its impedance has a pole there. Lyapunov's and Schmidt's way around it is to give
b = w_q″(ξ₀) instead, a second small parameter, and not to impose the contact condition w = 0 of
that harmonic. All of the order loop is then regular at the resonance, and what is left of the
condition is one equation between ε, b and Ω,

.. math:: G(ε, b; Ω) = D(qΩ)\, b + \sum_{n ≤ N} \sum_k g_{n-k,k}(Ω)\, ε^{n-k} b^k = 0,
          \qquad D(Ω_p) = 0,

exact through order N. A periodic state is a root b; since the third contact condition is
w″ + a₃ξ + … = 0, the amplitude of cos qθ in ξ_c is a = −2b/a₃ + …. To leading order this is the
amplitude equation of :mod:`asymptotics.resonances.folds`, with

.. math:: F = \frac{2}{a_3 D'} g_{q,0}, \qquad α = −\frac{a_3^2}{4 D'} g_{0,3}, \qquad
          γ = −\frac{1}{D'} g_{2,1}\ (q ≥ 2), \qquad D' = \frac{dD}{d(qΩ)} \text{ at } Ω_p.

Order n is a homogeneous polynomial in (ε, b); with ε = 1 a polynomial in b, so that the ring is
FLINT's polynomials with real balls as coefficients, and the engine stays as it is. Weak bending
costs digits, about half a power of 1/β an order, and very stiff ropes some in the static shape: the
working precision is doubled until the balls are narrow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import acb, acb_poly, arb, arb_poly, arb_series, fmpq

from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.beam import beam_problem, static_beam
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.beam_waves import StaticBeam, Waves, waves
from asymptotics.problems.problem import Mode, Problem
from asymptotics.rings.harmonics import Terms, multiply_into
from asymptotics.rings.numbers import Numbers, balls
from asymptotics.rings.precision import MOST_BITS, PrecisionError, at_precision
from asymptotics.rings.ring import FloatRing

Array = npt.NDArray[Any]

Column = tuple[Any, Any, Any, Any]
"""The first four derivatives of one solution at ξ₀."""

Reduced = list[list[arb]]
"""Orders 1 … N of G, order n as the list of g_{n−k,k}, k = 0 … n."""

_FEWEST_BITS = 128


class PolynomialRing(FloatRing):
    """Polynomials in b with real balls as coefficients, at the precision of FLINT's context.

    >>> ring = PolynomialRing()
    >>> ring.sum([ring.rational(1, 4), arb_poly([0, 1]) * ring.one]).coeffs()
    [0.250000000000000, 1.00000000000000]
    """

    zero: Any = arb_poly([])
    one: Any = arb_poly([1])

    def rational(self, numerator: int, denominator: int = 1) -> Any:
        """A constant."""
        return self.constant(acb(fmpq(numerator, denominator)))

    def sum(self, terms: Iterable[Any]) -> Any:
        """Σ terms."""
        return sum(terms, self.zero)

    def is_zero(self, element: Any) -> bool:
        """Exactly zero; a ball around zero may hold another number."""
        return len(element) == 0

    def constant(self, number: acb) -> Any:
        """The real part of a number."""
        return arb_poly([number.real])


class ComplexPolynomialRing(PolynomialRing):
    """Polynomials in a real r with complex balls as coefficients, for b = r e^{iφ}.

    >>> ring = ComplexPolynomialRing()
    >>> ring.conjugate(acb_poly([0, acb(0, 1)])).coeffs()
    [0, -1.00000000000000j]
    """

    even = False
    zero: Any = acb_poly([])
    one: Any = acb_poly([1])

    def conjugate(self, element: Any) -> Any:
        """Each coefficient's conjugate: r is real."""
        return acb_poly([c.conjugate() for c in element.coeffs()])

    def constant(self, number: acb) -> Any:
        """A number."""
        return acb_poly([number])


def exchanged(wave: Waves) -> tuple[Column, Column, Column]:
    """The solutions with unit w′, unit w″ or unit drive, the other two zero.

    Their first values are w; that of the second is D. With A = (p²(C + De^{−pL}) − w″)/k² and
    B = w′ − p(C − De^{−pL}) in the notation of :mod:`asymptotics.problems.beam_waves` two equations
    are left. Their determinant vanishes where a free rope has w′ = w″ = 0 at ξ₀, not at its
    resonances.
    """
    e, p, k2 = wave.decay, wave.p, wave.k2
    ratio = wave.p2 / k2
    (c1, c2), (d1, d2) = wave.end(ratio, -p, 1, 0), wave.end(ratio * e, p * e, 0, 1)
    determinant = c1 * d2 - d1 * c2

    def column(slope: int, second: int, drive: int) -> Column:
        r1, r2 = wave.end(-second / k2, slope, 0, 0)
        c = ((drive - r1) * d2 + d1 * r2) / determinant
        d = (-c1 * r2 - c2 * (drive - r1)) / determinant
        even, odd = c + d * e, c - d * e
        third = p * (wave.p2 + k2) * odd - k2 * slope
        return ((ratio + 1) * even - second / k2, slope, second, third)

    return column(1, 0, 0), column(0, 1, 0), column(0, 0, 1)


def detuning(shape: StaticBeam, rate: arb) -> tuple[arb, arb]:
    """D and its derivative D′ at the angular frequency ``rate`` = qΩ."""
    functions = (arb_series.sqrt, arb_series.exp, arb_series.sin, arb_series.cos)
    numbers = Numbers(FloatRing(), arb_series, *functions, None)
    value = exchanged(waves(shape, arb_series([rate, 1], 2), numbers))[1][0]
    return value[0], value[1]


def enclosed_frequency(shape: StaticBeam, start: float) -> arb:
    """A ball that holds the zero Ω_p(β) of D near ``start``, its value in doubles; or nan."""
    rate = arb(start)
    for _ in range(MOST_BITS.bit_length()):  # Newton doubles the digits each time
        value, slope = detuning(shape, rate)
        rate = (rate - value / slope).mid()
    value, slope = detuning(shape, rate)
    # 16: so that D's own ball does not reach zero at the ends, where its sign has to change.
    reach = 16 * abs(value / slope).upper()
    below, above = (detuning(shape, rate + side * reach)[0] for side in (-1, 1))
    return arb(rate, reach) if below * above < 0 else arb.nan()


def _reduced_problem(shape: StaticBeam, omega: arb, q: int) -> Problem[Any]:
    """The beam over polynomials in b, harmonic q with w″ = b given and w left free."""
    numbers, ring = balls(), PolynomialRing()
    base = beam_problem(shape.beta, omega, shape.driven_end, numbers, shape)
    b, half = arb_poly([0, 1]), ring.rational(1, 2)

    def lift(values: Iterable[Any]) -> tuple[Any, ...]:
        return tuple(arb_poly([value]) for value in values)

    @cache
    def mode(j: int) -> Mode[Any]:
        known = base.mode(j)
        if j != q:
            rows = tuple(lift(row) for row in known.impedance)
            return Mode(lift(known.reduction), rows, lift(known.source))
        slope, second, drive = (lift(x) for x in exchanged(waves(shape, j * omega, numbers)))
        both = tuple(b * x + half * y for x, y in zip(second, drive, strict=True))
        return Mode(lift(known.reduction), (lift([0] * 4), slope), both if q == 1 else second)

    return replace(
        base,
        name=f"reduced {base.name}",
        ring=ring,
        static=cache(lambda d: arb_poly([base.static(d)])),
        static_reduction=lift(base.static_reduction),
        mode=mode,
        drive={1: ring.one} if q == 1 else {1: half, q: b},
        inverse_leading=arb_poly([base.inverse_leading]),
    )


def reduced_equation(shape: StaticBeam, omega: arb, q: int, order: int) -> Reduced:
    """G through order N at one Ω, all of it balls; b is the coefficient of e^{iqθ}.

    Examples
    --------
    >>> with at_precision(128):
    ...     shape = static_beam("0.01", numbers=balls())
    ...     G = reduced_equation(shape, arb("3.2"), 1, 3)
    >>> [round(float(g), 5) + 0 for g in (G[0][0], G[0][1], G[2][2], G[2][3])]
    [-0.48037, 0.00141, 0.01427, -0.00097]
    """
    solution = expand(_reduced_problem(shape, omega, q), order)
    return [left_over(solution, q, n) for n in range(1, order + 1)]


def left_over(solution: Expansion[Any], q: int, n: int) -> list[Any]:
    """Order n of the contact condition w = 0 in harmonic q: w_n + Σ ξ_k H_{1, n−k}."""
    terms: Terms[Any] = {}
    for k in range(1, n):
        tail = solution.orders[n - k].tails[0][0]
        multiply_into(terms, solution.contact(k), tail, solution.problem.ring)
    shape = solution.shape(n)
    own = [shape[q][0]] if q in shape else []
    found = solution.problem.ring.sum([*terms.get(q, []), *own]).coeffs()
    return found + [arb(0)] * (n + 1 - len(found))


def until_narrow(compute: Callable[[], list[arb]], what: str, together: bool = False) -> list[arb]:
    """``compute`` with doubled precision until its balls are narrower than doubles round.

    Each against itself or, ``together``, against the largest.

    Raises
    ------
    InputError
        8192 bits do not suffice.
    """
    bits = _FEWEST_BITS
    while bits <= MOST_BITS:
        with at_precision(bits):
            try:
                found = compute()
            # A static shape or a denominator may still be too wide.
            except (PrecisionError, ValueError):
                found = [arb.nan()]
            sizes = [x.abs_lower() for x in found]
            if together:
                sizes = [max(sizes)] * len(found)
            if all(x.rad() <= size * 2.0**-54 for x, size in zip(found, sizes, strict=True)):
                return found
        bits *= 2
    raise InputError(f"{what} is lost in {MOST_BITS} bits: another resonance is too close")


@dataclass(frozen=True)
class Resonance:
    """Ω_p(β)/q of one rope: which amplitude equation is meant.

    >>> [x.str(8, radius=False) for x in Resonance(1, 2, 0.01, "pinned").coefficients()]
    ['-0.55655958', '-3.8914600', '0.89125923']
    """

    p: int
    q: int
    beta: float
    driven_end: str

    @cached_property
    def value(self) -> float:
        """Ω_p(β)/q in double precision."""
        return float(linear_frequencies(self.beta, self.p, self.driven_end)[-1]) / self.q

    def spectrum(self, count: int) -> Array:
        """Ω_1 … Ω_count."""
        return linear_frequencies(self.beta, count, self.driven_end)

    def _placed(self) -> tuple[StaticBeam, arb]:
        shape = static_beam(self.beta, self.driven_end, balls())
        return shape, enclosed_frequency(shape, self.q * self.value)

    def coefficients(self) -> list[arb]:
        """F, α and, for q ≥ 2, γ, as balls narrower than the rounding of doubles.

        Raises
        ------
        InputError
            They cannot be told apart from those of another resonance.
        """
        q = self.q

        def compute() -> list[arb]:
            shape, frequency = self._placed()
            slope = detuning(shape, frequency)[1]
            G = reduced_equation(shape, frequency / q, q, max(3, q + 2))
            amplitude = -2 / shape.a3
            found = [-amplitude * G[q - 1][0] / slope, -G[2][3] / (amplitude**2 * slope)]
            return found if q == 1 else [*found, -G[2][1] / slope]

        return until_narrow(compute, f"the amplitude equation at Omega_{self.p}/{q}")

    def scaled(self, mu: float, epsilon: float, amplitude: float, order: int) -> list[Array]:
        """G's orders at Ω_p/q + μ as doubles g_{n−k,k} ε^{n−k} b^k, over the largest of them.

        b is −a₃/2 times the given amplitude a.

        Raises
        ------
        InputError
            8192 bits do not suffice.
        """

        def compute() -> list[arb]:
            shape, frequency = self._placed()
            b = -amplitude * shape.a3 / 2
            G = reduced_equation(shape, frequency / self.q + mu, self.q, order)
            terms = [
                g * arb(epsilon) ** (n - k) * b**k
                for n, row in enumerate(G, start=1)
                for k, g in enumerate(row)
            ]
            largest = max(x.mid().abs_lower() for x in terms)
            return [x / largest for x in terms]

        found = until_narrow(compute, f"the reduced equation at Omega_{self.p}/{self.q}", True)
        flat = np.array([float(x.mid()) for x in found])
        # Order n has n + 1 coefficients.
        return np.split(flat, np.cumsum(np.arange(2, order + 1)))
