r"""The free frequencies of a reader's rope: where its expansion has poles.

Harmonic q of the expansion is singular where the lifted part, held at rest at the driven end and at
the static contact point, can oscillate by itself at qΩ: Ω = ω_p/q. There the impedance
:math:`Y_{m−1,m−2}` has a simple pole; its inverse has a simple zero, which is what is looked for:
on the real axis without damping, and from there into the complex plane as damping grows to what it
is. Free waves go like :math:`e^{iω_pτ}`; Im ω_p is their decay.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.checks import check_order, whole_number
from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems.marching import characteristic, impedances
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.swept_rope import Points

Array = npt.NDArray[Any]

_PER_SPACING = 40
"""Points where the impedance is looked at, per spacing π/ξ₀ of the string's frequencies."""

_FARTHEST = 400
"""How many such spacings are searched."""

_MOST = 200
_STEPS = 20
"""In which damping grows from nothing to what it is."""


@dataclass(frozen=True)
class FreeFrequencies:
    """What :func:`free_frequencies` found.

    Attributes
    ----------
    at
        The parameters' values.
    static_contact
        ξ₀.
    values
        ω_p, increasing as they do without damping; complex where the rope is damped.
    errors
        Of each: the last step of the search, and the rounding of the impedance.
    """

    at: Mapping[str, float]
    static_contact: float
    values: Array
    errors: Array

    def nonlinear(self, order: int) -> list[tuple[int, int, float]]:
        """(p, q, Re ω_p/q) for q ≤ N, increasing: the poles of an expansion of order N.

        p/q is not reduced: ω₂/2 is another pole than ω₁.

        >>> from asymptotics.problems.presets import string
        >>> found = free_frequencies(string(), {}, 2)
        >>> [(p, q, round(omega, 6)) for p, q, omega in found.nonlinear(2)]
        [(1, 2, 1.570796), (1, 1, 3.141593), (2, 2, 3.141593), (2, 1, 6.283185)]
        """
        order = check_order(order)
        rows = [
            (p, q, float(np.real(value)) / q)
            for p, value in enumerate(self.values, start=1)
            for q in range(1, order + 1)
        ]
        return sorted(rows, key=lambda row: (round(row[2], 9), row[1]))


def free_frequencies(rope: MovingContact, at: Mapping[Any, Any], count: int = 5) -> FreeFrequencies:
    """The first free frequencies of a rope at values of its parameters.

    Parameters
    ----------
    rope
        As it was written down, on a ground that does not give way, its coefficients constant.
    at
        Symbol or name ↦ number, without Ω.
    count
        How many.

    Raises
    ------
    InputError
        Bad values; a rope on springs or with coefficients that vary; fewer frequencies than asked
        for within 400 spacings π/ξ₀, or one that is overdamped.

    Examples
    --------
    On an elastic foundation ω_p² = κ + (pπ/ξ₀)²:

    >>> from asymptotics.problems.presets import string
    >>> found = free_frequencies(string(foundation=1.7), {}, 2)
    >>> (found.values**2 - (np.pi * np.arange(1, 3) / found.static_contact) ** 2).round(9).tolist()
    [1.7, 1.7]

    A damped one rings with ω² − 2iζω = π²:

    >>> ring = free_frequencies(string(damping=0.1), {}, 1).values[0]
    >>> bool(abs(ring**2 - 0.2j * ring - np.pi**2) < 1e-9)
    True
    """
    whole_number("count", count, _MOST)
    if rope.springs != 0 or rope.varying:
        raise InputError(
            f"{rope}: free frequencies are found for constant coefficients and a ground that does "
            "not give way"
        )
    given = {str(getattr(key, "name", key)): value for key, value in at.items()}
    given.pop("Omega", None)
    values = {name: float(x) for name, x in rope.values({**given, "Omega": 1}).items()}
    single = Points(rope, {name: np.array([x]) for name, x in values.items()})
    place = float(single.place[0])
    if not np.isfinite(place):
        rope.at({**given, "Omega": 1.0})  # says why
        raise InputError(f"{rope}: no static contact point is found in doubles")
    inverse = _Inverse(rope, values, place)
    spacing = np.pi / place
    grid = spacing * (np.arange(_FARTHEST * _PER_SPACING + 1) + 0.5) / _PER_SPACING
    found: list[tuple[complex, float]] = []
    step = 20 * _PER_SPACING
    for start in range(0, len(grid) - 1, step):
        part = grid[start : start + step + 1]
        heights, _ = inverse(part, 0.0)
        for i in np.flatnonzero(heights[:-1] * heights[1:] <= 0).tolist()[: count - len(found)]:
            root = inverse.crossing(part[i], part[i + 1])
            found.append(inverse.damped(*root) if inverse.is_damped else root)
        if len(found) >= count:
            table = np.array([value for value, _ in found])
            return FreeFrequencies(
                {name: x for name, x in values.items() if name != "Omega"},
                place,
                table if inverse.is_damped else table.real,
                np.array([error for _, error in found]),
            )
    raise InputError(
        f"{rope}: {len(found)} free frequencies below {grid[-1]:.4g}, {count} are asked for; ask "
        "for fewer"
    )


def check_resonance(rope: MovingContact, at: Mapping[Any, Any], harmonics: Sequence[int]) -> None:
    """That no harmonic is numerically at a free frequency: half its impedances' digits are there.

    Nothing is checked where there is nothing to check it with: on springs, where coefficients vary,
    and of layers too thin for doubles.

    Raises
    ------
    ResonanceError
        One is; the error names p and q.
    """
    if rope.springs != 0 or rope.varying:
        return
    values = {name: np.array([float(x)]) for name, x in rope.values(at).items()}
    points = Points(rope, values)
    if not np.isfinite(points.place[0]):
        return
    for q in harmonics:
        equation, ends = points.equation(q), points.ends(q)
        nothing = np.zeros(ends.shape[:2])
        try:
            table, _ = impedances(equation, ends, nothing, points.place, rope.contact_order - 1)
        except ValueError:  # thinner layers than doubles cross
            return
        if q and not np.isfinite(table).all():
            _refuse(rope, at, float(values["Omega"][0]), q)


def _refuse(rope: MovingContact, at: Mapping[Any, Any], omega: float, q: int) -> None:
    p = 0
    for count in (8, 32, _MOST):
        found = np.real(free_frequencies(rope, at, count).values)
        p = int(np.argmin(np.abs(found - q * omega))) + 1
        if p < count:
            break
    lower = f", or ask for an order below {q}" if q > 1 else ""
    raise ResonanceError(
        f"Omega = {omega!r} is numerically at the resonance omega_{p}/{q} of {rope}, where an "
        f"expansion has a pole as soon as it holds harmonic {q}; move Omega away{lower}",
        p,
        q,
    )


class _Inverse:
    """ω ↦ what vanishes at a free frequency, the odd ∂_τ times a factor."""

    def __init__(self, rope: MovingContact, values: Mapping[str, float], place: float) -> None:
        self.rope, self.values, self.place = rope, values, place
        self.is_damped = rope.irreversible

    def __call__(self, omega: Array, factor: float) -> tuple[Array, Array]:
        m, r = self.rope.contact_order, self.rope.order
        at = {name: np.full(omega.shape, x) for name, x in self.values.items()}
        points = Points(self.rope, at, still=False)

        def rates(terms: Mapping[tuple[int, int], Any], length: int) -> Array:
            scaled = {(k, t): c * factor if t % 2 else c for (k, t), c in terms.items()}
            return points.rates(scaled, 1, length, omega)

        equation = rates(self.rope.equation.terms, r + 1)
        ends = np.stack([rates(c.terms, r) for c in self.rope.driven_end], axis=1)
        length = np.full(omega.shape, self.place)
        # Without damping all is real, if the rates are.
        if not factor and np.isrealobj(omega):
            equation, ends = equation.real, ends.real
        return characteristic(equation, ends, length, m - 1)

    def one(self, omega: complex, factor: float) -> complex:
        """1/Y at one frequency; nan where its layers are thinner than doubles cross."""
        try:
            zero, pole = self(np.array([omega]), factor)
        except ValueError:
            return complex("nan")
        return complex(zero[0] / pole[0])

    def crossing(self, left: float, right: float) -> tuple[complex, float]:
        """The zero of the undamped one between two places of unlike sign."""
        from scipy.optimize import brentq

        def height(x: float) -> float:
            return float(self(np.array([x]), 0.0)[0][0])

        root = float(brentq(height, left, right, xtol=1e-14, rtol=1e-14))
        return complex(root), 4e-14 * root + 1e-13 * (right - left)

    def damped(self, start: complex, error: float) -> tuple[complex, float]:
        """The zero that this becomes as damping grows to its full size.

        Raises
        ------
        InputError
            It is lost on the way, as where a mode is overdamped.
        """
        root = start
        for factor in np.linspace(0, 1, _STEPS + 1)[1:].tolist():
            root, error = self._secant(root, factor)
            # Overdamped, it goes on as two decays without oscillation, neither of them this one.
            if not np.isfinite(error) or root.real < 1e-6 * abs(root):
                raise InputError(
                    f"{self.rope}: the free frequency that is {start.real:.6g} without damping is "
                    f"lost when {factor:.0%} of it are there; give less, or ask for fewer"
                )
        return root, error

    def _secant(self, start: complex, factor: float) -> tuple[complex, float]:
        a, b = start, start * (1 + 1e-4) + 1e-4j
        fa, fb = self.one(a, factor), self.one(b, factor)
        for _ in range(40):
            if fb == fa:
                break
            a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
            fb = self.one(b, factor)
            if not abs(fb) < np.inf:
                return b, float("nan")
            if abs(b - a) <= 1e-10 * abs(b):
                return b, abs(b - a) + 1e-13 * abs(b)
        return b, abs(b - a) if abs(b - a) < 1e-9 * abs(b) else float("nan")
