r"""Certified evaluation: numbers with proved error bounds, right up to a resonance.

The expansion is run over balls (:mod:`asymptotics.rings.balls`), with the working precision doubled
until what was asked for is enclosed tightly enough. The result is the truncated series itself,

.. math:: ξ_c ∼ 1 + \sum_{n≤N} ε^n \sum_j a_{n,j} \cos jΩτ, \qquad \frac{w}{Z_0} ∼ s^2 + \dots,

(eqs. expand, expandw); what the powers beyond N would add is not part of the bound.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.expansion.moving_frame import MovingFrame, moving_frame
from asymptotics.expansion.order_loop import Expansion, expand
from asymptotics.problems.enclosed import ball_string
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.rings.balls import Frequency, frequency, outward, rational
from asymptotics.rings.precision import at_precision, until


@dataclass(frozen=True)
class Enclosure:
    """A real number that is known to lie between two doubles.

    Attributes
    ----------
    lower, upper
        The doubles, rounded outward.
    ball
        The ball of python-flint, with all its digits.
    """

    lower: float
    upper: float
    ball: arb = field(repr=False, compare=False)

    @classmethod
    def of(cls, ball: arb) -> Enclosure:
        """The enclosure of a ball."""
        return cls(*outward(ball), ball)

    def __contains__(self, value: float) -> bool:
        return bool(self.lower <= value <= self.upper)

    def distance(self, value: float) -> float:
        """An upper bound on |true − value|."""
        with at_precision(max(64, self.ball.bits() + 64)):
            return outward(abs(self.ball - arb(value)))[1]

    def as_json(self) -> dict[str, Any]:
        """Bounds, and the digits that are certain."""
        return {"lower": self.lower, "upper": self.upper, "value": self.ball.str(40)}


@dataclass(frozen=True)
class CertifiedHarmonics:
    """ξ_c's harmonics at one Ω: :func:`contact_harmonics`.

    Attributes
    ----------
    omega
        Ω, exactly.
    order
        N.
    bits
        The working precision that was enough.
    amplitudes
        ``amplitudes[n − 1][j]`` encloses a_{n,j}, the coefficient of ε^n cos jΩτ.
    """

    omega: Frequency
    order: int
    bits: int
    amplitudes: tuple[dict[int, Enclosure], ...]

    def as_json(self) -> dict[str, Any]:
        """Plain data: orders by n, harmonics by j."""
        return {
            "omega": str(self.omega),
            "order": self.order,
            "bits": self.bits,
            "amplitudes": {
                str(n): {str(j): e.as_json() for j, e in sorted(row.items())}
                for n, row in enumerate(self.amplitudes, start=1)
            },
        }


def _accuracy(relative: Any) -> float:
    value = rational(relative)
    if value is None or not 0 < value < 1:
        raise InputError(f"relative = {relative!r}; give an accuracy between 0 and 1, e.g. 1e-16")
    return float(value)


def _tight(ball: arb, scale: arb, relative: float) -> bool:
    """Whether the radius is certainly below relative · scale."""
    return bool(ball.is_finite() and ball.rad() <= relative * scale.abs_lower())


def contact_harmonics(omega: Any, order: int, relative: float = 1e-16) -> CertifiedHarmonics:
    """Enclosures of the amplitudes a_{n,j} of ε^n cos jΩτ in ξ_c, n ≤ N.

    Parameters
    ----------
    omega
        Ω as :func:`~asymptotics.rings.balls.frequency` takes it: 0.83, '0.83', 'pi/2 + 1e-12'.
    order
        N ≥ 1.
    relative
        Radius of each ball over the largest |a_{n,j}| of its order n. (An amplitude may vanish, at
        cot jΩ = 0, and has no relative accuracy then.)

    Raises
    ------
    InputError
        Ω, N or the accuracy is not what is allowed.
    ResonanceError
        Ω = pπ/q with q ≤ N.
    PrecisionError
        More than 8192 bits would be needed.

    Examples
    --------
    >>> result = contact_harmonics("pi/2 + 1e-12", 2)
    >>> result.amplitudes[1][2].ball.str(12, radius=False)       # −Ω³/(8 sin²Ω) cot 2Ω
    '-2.42236536565e+11'
    >>> result.bits
    128
    """
    order = check_order(order)
    exact, relative = frequency(omega), _accuracy(relative)
    exact.check(order)

    def compute() -> list[dict[int, arb]]:
        solution = expand(ball_string(exact), order)
        sine = exact.ball().sin()
        return [
            {j: (2 if j else 1) * c / sine**n for j, c in solution.contact(n).items()}
            for n in range(1, order + 1)
        ]

    def accurate(rows: list[dict[int, arb]]) -> bool:
        return all(
            _tight(
                ball, max((abs(x) for x in row.values()), key=lambda x: float(x.mid())), relative
            )
            for row in rows
            for ball in row.values()
        )

    rows, bits = until(accurate, compute, f"Omega = {exact} at order {order}")
    amplitudes = tuple({j: Enclosure.of(ball) for j, ball in row.items()} for row in rows)
    return CertifiedHarmonics(exact, order, bits, amplitudes)


@dataclass(frozen=True)
class CertifiedPoint:
    """ξ_c and w/Z₀ of the truncated series at one (Ω, ε, s, τ): :func:`evaluate_certified`."""

    omega: Frequency
    order: int
    bits: int
    contact: Enclosure
    profile: Enclosure

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "omega": str(self.omega),
            "order": self.order,
            "bits": self.bits,
            "contact": self.contact.as_json(),
            "profile": self.profile.as_json(),
        }


def evaluate_certified(
    omega: Any, epsilon: Any, order: int, s: Any, tau: Any, relative: float = 1e-16
) -> CertifiedPoint:
    """Enclosures of ξ_c(τ) and w/Z₀(s, τ) through ε^N.

    Parameters
    ----------
    omega, epsilon, s, tau
        As in :func:`asymptotics.values.evaluate.evaluate`, one number each; a double is what it
        stands for, a decimal in a string is exact, and Ω may be 'p*pi/q + mu'.
    order
        N ≥ 1.
    relative
        Radius of the two balls over the magnitude of ξ_c and of w/Z₀ (or over 10⁻³⁰ s², should the
        profile vanish).

    Raises
    ------
    InputError, ResonanceError, PrecisionError
        As :func:`contact_harmonics`; also for s > 0 or s < −ξ_c.

    Examples
    --------
    >>> point = evaluate_certified("0.83", "0.02", 4, "-0.5", 0)
    >>> print(point.contact.ball.str(25, radius=False), point.profile.ball.str(20, radius=False))
    1.011221519318453103 0.249680197792495058
    """
    order = check_order(order)
    exact, relative = frequency(omega), _accuracy(relative)
    exact.check(order)
    numbers = {"epsilon": rational(epsilon), "s": rational(s), "tau": rational(tau)}
    for name, number in numbers.items():
        if number is None:
            raise InputError(f"{name} is not a finite number or a decimal")
    if numbers["s"] > 0:  # type: ignore[operator]
        raise InputError(f"s = {s!r} is beyond the contact point; give s ≤ 0")

    def compute() -> tuple[arb, arb]:
        values = [arb(fmpq(x.numerator, x.denominator)) for x in numbers.values()]  # type: ignore[union-attr]
        return _point(expand(ball_string(exact), order), exact.ball(), *values)

    def accurate(pair: tuple[arb, arb]) -> bool:
        contact, profile = pair
        floor = 1e-30 * arb(float(numbers["s"] or 0)) ** 2
        size = profile if profile.abs_lower() > floor else floor
        return _tight(contact, contact, relative) and (
            bool(profile.is_zero()) or _tight(profile, size, relative)
        )

    what = f"Omega = {exact}, epsilon = {epsilon!r} at order {order}"
    (contact, profile), bits = until(accurate, compute, what)
    reach = outward(contact)[1]
    if numbers["s"] < -reach:  # type: ignore[operator]
        raise InputError(f"s = {s!r} is beyond the driven end, which is at s = {-reach!r}")
    return CertifiedPoint(exact, order, bits, Enclosure.of(contact), Enclosure.of(profile))


@dataclass(frozen=True)
class CertifiedContact:
    """ξ_c of a rope's truncated series at one (parameters, ε, τ): :func:`contact_certified`."""

    at: dict[str, str]
    order: int
    bits: int
    contact: Enclosure

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "parameters": self.at,
            "order": self.order,
            "bits": self.bits,
            "contact": self.contact.as_json(),
        }


def contact_certified(
    rope: MovingContact,
    at: Mapping[Any, Any],
    epsilon: Any,
    order: int,
    tau: Any,
    relative: float = 1e-16,
) -> CertifiedContact:
    """An enclosure of ξ_c(τ) through ε^N of any rope that was written down.

    Parameters
    ----------
    rope, at
        As for :func:`asymptotics.expand`; decimals in strings are exact.
    epsilon, tau
        One number each, read likewise.
    order, relative
        As in :func:`evaluate_certified`.

    Raises
    ------
    InputError, PrecisionError
        As :func:`asymptotics.expand`; values that are no numbers.

    Examples
    --------
    >>> from asymptotics.problems.presets import beam
    >>> at = {"beta": "0.01", "Omega": "2.2"}
    >>> point = contact_certified(beam(), at, "0.02", 3, 0, 1e-25)
    >>> print(point.contact.ball.str(25, radius=False))
    1.130391717647387328528099
    """
    order, relative = check_order(order), _accuracy(relative)
    small, time = rational(epsilon), rational(tau)
    if small is None or time is None:
        raise InputError(f"epsilon = {epsilon!r}, tau = {tau!r}: give finite numbers or decimals")
    values = rope.values(at)

    def ball(number: Fraction) -> arb:
        return arb(fmpq(number.numerator, number.denominator))

    def compute() -> arb:
        solution = expand(rope.at(at, "balls"), order)
        place: Any = solution.problem.rest
        rest = acb(place).real
        angle = ball(values["Omega"]) * ball(time)
        total = rest
        for n in range(1, order + 1):
            for j, c in solution.contact(n).items():
                wave = acb(0, j * angle).exp() * acb(c) * (2 if j else 1)
                total = total + ball(small) ** n * wave.real
        return total

    name = f"{rope} at order {order}"
    contact, bits = until(lambda x: _tight(x, x, relative), compute, name)
    spelled = {key: str(value) for key, value in values.items()}
    return CertifiedContact(spelled, order, bits, Enclosure.of(contact))


def _point(solution: Expansion[arb], omega: arb, epsilon: arb, s: arb, tau: arb) -> tuple[arb, arb]:
    """ξ_c and w/Z₀ in balls."""
    order, small = solution.order, epsilon / omega.sin()
    cosines = [(j * omega * tau).cos() for j in range(order + 1)]

    def series(orders: Callable[[int], dict[int, arb]]) -> arb:
        return sum(
            (
                small**n * (2 if j else 1) * c * cosines[j]
                for n in range(1, order + 1)
                for j, c in orders(n).items()
            ),
            arb(0),
        )

    frame: MovingFrame[arb] = moving_frame(solution)
    profile = s * s
    for k, (value, slope) in frame.modes.items():
        if k:
            x = k * omega * s
            # 1 − cos x = 2 sin²(x/2) is exact; the doubled precision takes care of x − sin x.
            profile -= series(value.__getitem__) * 2 * (x / 2).sin() ** 2
            profile -= series(slope.__getitem__) * (x - x.sin()) / (k * omega)
    return 1 + series(solution.contact), profile
