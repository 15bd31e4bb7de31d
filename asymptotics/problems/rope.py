r"""A rope in SI units, and what the dimensionless quantities of the paper are for it.

.. math:: c^2 = \frac{T}{ρ}, \qquad x_0^2 = \frac{2TZ_0}{ρg}, \qquad β = \frac{B}{Tx_0^2}
          = \frac{ρgB}{2T^2Z_0}, \qquad Ω = \frac{ωx_0}{c} = ω\sqrt{\frac{2Z_0}{g}}

(eqs. rope, leading, beam2). Ω needs neither tension nor density: both c and x₀ grow like √T.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asymptotics.errors import InputError
from asymptotics.problems.beam_spectrum import linear_frequencies
from asymptotics.problems.static_shape import contact_point

STANDARD_GRAVITY = 9.80665

# Of the tension that a rope without bending would have: less is a beam that hangs.
_SLACK = 1e-4

_WHAT = {
    "tension": "the tension T in newtons",
    "line_density": "the mass per length ρ in kg/m",
    "bending_stiffness": "the bending stiffness B in N m²",
    "height": "the height Z₀ of the driven end in metres",
    "gravity": "the acceleration due to gravity in m/s²",
    "contact_point": "the distance x₀ of the contact point from the driven end in metres",
    "static_contact": "the distance of the contact point at rest in metres",
    "stiffness": "the stiffness k of springs per length in N/m²",
    "drag": "the drag per length and speed in N s/m²",
}


@dataclass(frozen=True)
class Rope:
    """A rope whose end is held above the ground it lies on.

    Attributes
    ----------
    tension, line_density, bending_stiffness, height, gravity
        T (N), ρ (kg/m), B (N m²), Z₀ (m), g (m/s²). All positive; B may be zero.

    Raises
    ------
    InputError
        A parameter that is not a number, not finite or not positive; or so extreme that β or x₀
        leaves the range of double precision.

    Examples
    --------
    The paper's experiment, and its prediction for every tension:

    >>> rope = Rope.from_contact_point(
    ...     1.47, line_density=0.015, bending_stiffness=0.0005, height=0.81
    ... )
    >>> print(f"f_1 = {rope.resonance_hertz(1):.2f} Hz, T = {rope.tension:.3f} N")
    f_1 = 1.23 Hz, T = 0.196 N
    >>> print(f"Omega at 1.2 Hz = {rope.omega_from_hertz(1.2):.4f}, beta = {rope.beta:.5f}")
    Omega at 1.2 Hz = 3.0645, beta = 0.00118
    """

    tension: float
    line_density: float
    bending_stiffness: float
    height: float
    gravity: float = STANDARD_GRAVITY

    def __post_init__(self) -> None:
        for item in fields(self):
            value = _quantity(item.name, getattr(self, item.name))
            object.__setattr__(self, item.name, value)
        derived = (self.contact_point, self.wave_speed)
        if not all(0 < x < math.inf for x in derived) or not math.isfinite(self.beta):
            raise InputError(
                f"{self} has x0 = {derived[0]!r} m, c = {derived[1]!r} m/s, beyond double "
                "precision; check the units: they are SI"
            )

    @classmethod
    def from_contact_point(
        cls,
        contact_point: float,
        line_density: float,
        bending_stiffness: float,
        height: float,
        gravity: float = STANDARD_GRAVITY,
    ) -> Rope:
        """The rope whose contact point at rest is x₀: T = ρgx₀²/(2Z₀), eq. (leading).

        That is the relation of a rope without bending. With bending the contact point at rest is at
        ξ₀(β) x₀, farther by the fraction √β or so
        (:func:`~asymptotics.problems.static_shape.contact_point`).

        Raises
        ------
        InputError
            As for :class:`Rope`.
        """
        place, density, z, g = (
            _quantity(name, value)
            for name, value in (
                ("contact_point", contact_point),
                ("line_density", line_density),
                ("height", height),
                ("gravity", gravity),
            )
        )
        return cls(density * g * place * place / (2 * z), density, bending_stiffness, z, g)

    @classmethod
    def from_static_contact(
        cls,
        static_contact: float,
        line_density: float,
        bending_stiffness: float,
        height: float,
        driven_end: str = "pinned",
        gravity: float = STANDARD_GRAVITY,
    ) -> Rope:
        """The rope that is seen to meet the ground at rest at this distance, bending included.

        T with ξ₀(β) x₀ = the distance, x₀ and β depending on T: both sides rise with T.

        Raises
        ------
        InputError
            As for :class:`Rope`; an unknown driven end; a distance that bending alone exceeds.

        Examples
        --------
        >>> rope = Rope.from_static_contact(1.5, 0.015, 0.0005, 0.81)
        >>> round(rope.tension, 6), round(rope.static_contact(), 9)
        (0.190344, 1.5)
        """
        from scipy.optimize import brentq

        place = _quantity("static_contact", static_contact)
        string = cls.from_contact_point(place, line_density, bending_stiffness, height, gravity)
        if string.bending_stiffness == 0:
            return string

        def excess(scale: float) -> float:
            rope = replace(string, tension=scale * string.tension)
            return rope.static_contact(driven_end) / place - 1

        if excess(_SLACK) > 0:
            raise InputError(
                f"static_contact = {place!r} m: a rope of this bending stiffness reaches farther "
                "at any tension; check the units: they are SI"
            )
        scale = float(brentq(excess, _SLACK, 1.0, xtol=1e-15, rtol=1e-14))
        return replace(string, tension=scale * string.tension)

    def static_contact(self, driven_end: str = "pinned") -> float:
        """Where the rope at rest meets the ground, ξ₀(β) x₀ in metres.

        >>> round(Rope(0.196, 0.015, 0.0005, 0.81).static_contact(), 4)
        1.5206
        """
        if self.bending_stiffness == 0:
            return self.contact_point
        return float(contact_point(self.beta, driven_end)) * self.contact_point

    def at(self, hertz: float) -> dict[str, float]:
        """Ω and β as the parameters of :func:`asymptotics.problems.presets.beam`.

        >>> {name: round(x, 5) for name, x in Rope(0.2, 0.015, 5e-4, 0.81).at(1.2).items()}
        {'Omega': 3.06449, 'beta': 0.00114}
        """
        return {"Omega": float(self.omega_from_hertz(hertz)), "beta": self.beta}

    def foundation(self, stiffness: float) -> float:
        """κ = k x₀²/T of an elastic foundation, or of springs below the rope, of k in N/m²."""
        size = _quantity("stiffness", stiffness)
        return size * self.contact_point * self.contact_point / self.tension

    def damping(self, coefficient: float) -> float:
        """ζ = c_d x₀/(2ρc) of a drag c_d w_t per length, c_d in N s/m²."""
        size = _quantity("drag", coefficient)
        return size * self.contact_point / (2 * self.line_density * self.wave_speed)

    def tau_from_seconds(self, seconds: ArrayLike) -> NDArray[np.float64]:
        """τ = ct/x₀, the shape of ``seconds``."""
        return _frequencies("seconds", seconds) * (self.wave_speed / self.contact_point)

    def seconds_from_tau(self, tau: ArrayLike) -> NDArray[np.float64]:
        """t = x₀τ/c.

        >>> rope = Rope(0.2, 0.015, 0.0, 0.81)
        >>> float(rope.seconds_from_tau(rope.tau_from_seconds(2.5)))
        2.5
        """
        return _frequencies("tau", tau) * (self.contact_point / self.wave_speed)

    @property
    def wave_speed(self) -> float:
        """c = √(T/ρ) in m/s."""
        return math.sqrt(self.tension / self.line_density)

    @property
    def contact_point(self) -> float:
        """x₀ = √(2TZ₀/(ρg)) in metres, eq. (leading)."""
        return self.wave_speed * math.sqrt(2 * self.height / self.gravity)

    @property
    def beta(self) -> float:
        """β = B/(Tx₀²), eq. (beam2)."""
        return self.bending_stiffness / self.tension / self.contact_point / self.contact_point

    def omega_from_hertz(self, hertz: ArrayLike) -> NDArray[np.float64]:
        """Ω = 2πf √(2Z₀/g), the shape of ``hertz``.

        Raises
        ------
        InputError
            A frequency that is not a finite number.
        """
        return _frequencies("hertz", hertz) * (
            2 * math.pi * math.sqrt(2 * self.height / self.gravity)
        )

    def hertz_from_omega(self, omega: ArrayLike) -> NDArray[np.float64]:
        """f = Ω/(2π) √(g/2Z₀), the shape of ``omega``.

        Raises
        ------
        InputError
            A frequency that is not a finite number.

        Examples
        --------
        >>> rope = Rope(0.2, 0.015, 0.0, 0.81)
        >>> rope.hertz_from_omega([3.2, 6.4]).round(2)        # the paper's Fig. 2
        array([1.25, 2.51])
        """
        return _frequencies("omega", omega) * (
            math.sqrt(self.gravity / (2 * self.height)) / (2 * math.pi)
        )

    def resonance_hertz(self, p: int = 1) -> float:
        """f_p = p √(g/8Z₀) in hertz, eq. (resonance1): without bending, at any tension.

        Raises
        ------
        InputError
            p is not a whole number ≥ 1.
        """
        if isinstance(p, bool) or not isinstance(p, int) or p < 1:
            raise InputError(f"p = {p!r}; resonances are numbered by whole numbers p >= 1")
        return p * math.sqrt(self.gravity / (8 * self.height))

    def linear_hertz(self, count: int, driven_end: str = "pinned") -> NDArray[np.float64]:
        """The first linear resonances in hertz, with this rope's bending stiffness.

        Raises
        ------
        InputError
            A bad count or an unknown driven end.

        Examples
        --------
        >>> Rope(0.2, 0.015, 0.0005, 0.81).linear_hertz(2).round(4)
        array([1.236 , 2.5103])
        """
        return self.hertz_from_omega(linear_frequencies(self.beta, count, driven_end))


def _quantity(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r} is not a number; give {_WHAT[name]}") from None
    zero_allowed = name in ("bending_stiffness", "stiffness", "drag")
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero_allowed):
        allowed = "finite and not negative" if zero_allowed else "positive and finite"
        raise InputError(f"{name} = {number!r}; {_WHAT[name]} must be {allowed}")
    return number


def _frequencies(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {values!r} is not a number or an array of numbers") from None
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name} = {values!r}; give finite frequencies")
    return array
