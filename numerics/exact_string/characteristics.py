r"""The exact string (β = 0): the motion from rest, by the return map of its characteristics.

With :math:`W = ξ² + f(τ−ξ) + g(τ+ξ)` the contact conditions W = W_ξ = 0 say
:math:`f'(u) = −g'(v) = ξ_c` at u = τ − ξ_c, v = τ + ξ_c. A characteristic that leaves ξ = 0 at the
time t_k comes back at t_{k+1}, reflected at the contact point halfway, and W(0, τ) = Z(τ) becomes

.. math:: t_{k+1} − 2t_k + t_{k−1} = 2Z'(t_k), \qquad
          τ = \tfrac12 (t_{k+1} + t_k), \quad ξ_c = \tfrac12 (t_{k+1} − t_k).

A string at rest until τ = 0 at the height Z(0) = a² has t_1 = t_0 + 2a for t_0 ≤ 0: the labels
t_0 ∈ (−2a, 0] number all orbits, and s = t_0 + 2ak all departures, t = T(s). Eliminating g from
contact and drive gives f along an orbit without any quadrature; with f(t) = a t + F(t),

.. math:: F(t_{k+1}) = F(t_k) + (ξ_c − a)² + Z(t_{k+1}) − a², \qquad
          W = (ξ − a)² + Z(v) − a² + F(u) − F(v),

a form in which nothing large cancels. Every value asked for is an orbit followed from rest; the
label is found by Newton's iteration inside a bracket, with the tangent map D_k = dt_k/dt_0. No
interpolation enters.

**How far.** ξ_c′ = (D_{k+1} − D_k)/(D_{k+1} + D_k). The contact point reaches the wave speed where
D_{k+1} = 0, moving towards the driven end. It never does so away from it first: that is D_k = 0,
and the same characteristic met ξ_c′ = −1 one return before. While D > 0 on all characteristics on
the string, W_ξ = (v − h(u))/2 + (h⁻¹(v) − u)/2 < 0 and the string lies on the ground only where it
should; here h is the return map t_k ↦ t_{k+1}. A violent drive (h′ < −1; from rest Z″ < −1) can
bring the string down in front of the contact point before the news arrives there; times after that
are refused too, see :attr:`SonicContact.monotone_until`.

**How exact.** With errors η_j in the kicks 2Z′(t_j), the Wronskian of the tangent map gives the
error of the contact point at fixed τ as Σ_j D_j η_j/(D_k + D_{k+1}): no growth beyond the ratios of
D. :meth:`ExactString.error_estimate` sums it; the kicks' own errors are those of rounding t.
Against the same map in 40 digits, ξ_c at Ω = 2.2, ε = .02 (ramp of 20 periods) is off by 4e-16,
3e-15, 3e-14 after 20, 50, 100 periods, where the estimate says 9e-15, 7e-14, 3e-13.

The compiled map for many harmonic drives is in :mod:`numerics.exact_string.thresholds`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from numerics.errors import InputError, SonicContactError
from numerics.exact_string.orbits import EPS, Array, Orbit, ReturnMap, return_map
from numerics.exact_string.search import Nodes, SonicContact, search
from numerics.problems.drive import Drive, positive

__all__ = ["ExactString", "SonicContact", "exact_string_motion"]

FIRST_LABELS = 64


@dataclass(frozen=True, eq=False)
class ExactString:
    """The motion of the string from rest, at β = 0; ``exact_string_motion`` makes it.

    Attributes
    ----------
    drive, until
        Z(τ), and the last time that may be asked for.
    sonic
        The first sonic contact up to ``until``; None if there is none.
    labels
        How many orbits the search for it took in 2a.
    least_stretch
        The least D up to ``until``, or up to D = 0: how far the contact is from being sonic.
    label_change
        By how much its instant, or ``least_stretch`` if there is none, changed when the labels were
        doubled last. Values do not depend on the labels; whether a contact was overlooked does.
    """

    drive: Drive
    until: float
    sonic: SonicContact | None
    labels: int
    least_stretch: float
    label_change: float
    _map: ReturnMap = field(repr=False)
    _departures: Nodes = field(repr=False)
    _contacts: Nodes = field(repr=False)

    @property
    def valid_until(self) -> float:
        """The last time at which the solution holds."""
        return self.until if self.sonic is None else min(self.until, self.sonic.monotone_until)

    def contact(self, tau: ArrayLike) -> Array:
        """ξ_c(τ) = (t_{k+1} − t_k)/2 where τ = (t_{k+1} + t_k)/2, for times of any shape.

        Raises
        ------
        SonicContactError
            Some τ lies beyond the sonic contact.
        InputError
            Some τ is not finite or lies beyond ``until``.

        Examples
        --------
        >>> from numerics.problems.drive import ramped_cosine
        >>> motion = exact_string_motion(ramped_cosine(2.2, 0.02, periods=3), until=20.0)
        >>> motion.contact([-1.0, 0.0]).tolist()
        [1.0, 1.0]
        """
        return self._map.contact(self._at_contact(tau))

    def contact_velocity(self, tau: ArrayLike) -> Array:
        """ξ_c′(τ) = (D_{k+1} − D_k)/(D_{k+1} + D_k); raises as :meth:`contact`."""
        orbit = self._at_contact(tau)
        return orbit.jump_rate / (orbit.stretch + orbit.next_stretch)

    def error_estimate(self, tau: ArrayLike) -> Array:
        """The rounding error to expect in ξ_c(τ), from above: Σ D_j η_j/(D_k + D_{k+1}) + ….

        η_j is ε_mach (2|Z″(t_j)| (t_j + 1) + 2|Z′(t_j)| + |d_j|); rounding of τ itself adds
        ε_mach |ξ_c′| τ and of the result ε_mach ξ_c. Raises as :meth:`contact`.
        """
        orbit = self._at_contact(tau)
        total = orbit.stretch + orbit.next_stretch
        speed = np.abs(orbit.jump_rate / total)
        position = self._map.contact(orbit)
        return orbit.error / total + EPS * (4 * speed * (np.abs(tau) + 2) + position)

    def shape(self, xi: ArrayLike, tau: ArrayLike) -> Array:
        """W(ξ, τ) = (ξ − a)² + Z(v) − a² + F(u) − F(v), and 0 on the ground. Arguments broadcast.

        u = τ − ξ and v = τ + ξ are both turned into labels. Raises as :meth:`contact`, and
        InputError for a negative ξ.
        """
        xi, tau, contact = self._places(xi, tau)
        inside = np.minimum(xi, contact)
        left, right = self._departing(tau - inside), self._departing(tau + inside)
        rest = self._map.rest
        drive = self._drive_change(tau + inside)
        lifted = (inside - rest) ** 2 + drive + (left.primitive - right.primitive)
        return np.where(xi <= contact, lifted, 0.0)

    def slope(self, xi: ArrayLike, tau: ArrayLike) -> Array:
        """W_ξ(ξ, τ) = 2ξ − f′(u) + Z′(v) − f′(v), f′(t_k) = (t_{k+1} − t_k)/2, as :meth:`shape`.

        On reaching a sonic contact f′ has a square-root singularity at v, and half the digits go.
        """
        xi, tau, contact = self._places(xi, tau)
        inside = np.minimum(xi, contact)
        left, right = self._departing(tau - inside), self._departing(tau + inside)
        kick = np.where(tau + inside > 0, self.drive.slope(np.maximum(tau + inside, 0.0)), 0.0)
        lifted = 2 * (inside - self._map.rest) + (kick - (left.jump + right.jump) / 2)
        return np.where(xi <= contact, lifted, 0.0)

    def _drive_change(self, times: Array) -> Array:
        """Z − a², which is 0 at rest."""
        change = self.drive.height(np.maximum(times, 0.0)) - self._map.rest**2
        return np.where(times > 0, change, 0.0)

    def _places(self, xi: ArrayLike, tau: ArrayLike) -> tuple[Array, Array, Array]:
        places, times = np.broadcast_arrays(np.asarray(xi, float), np.asarray(tau, float))
        if not (np.isfinite(places).all() and (places >= 0).all()):
            raise InputError(
                f"xi = {xi!r}: give finite positions ξ ≥ 0, the driven end being ξ = 0"
            )
        return places, times, self.contact(times)

    def _at_contact(self, tau: ArrayLike) -> Orbit:
        times = np.asarray(tau, float)
        if not np.isfinite(times).all():
            raise InputError(f"tau = {tau!r}: give finite times")
        latest = float(times.max(initial=-math.inf))
        if latest > self.valid_until:
            if self.sonic is not None:
                raise SonicContactError(
                    f"tau = {latest!r} lies beyond τ = {self.valid_until!r}: the contact point "
                    f"reaches the wave speed at τ = {self.sonic.time:.9g}, ξ = "
                    f"{self.sonic.place:.9g}, and this solution ends. Ask for earlier times, take "
                    "a gentler drive, or simulate the contact",
                    self.sonic,
                )
            raise InputError(
                f"tau = {latest!r} lies beyond until = {self.until!r}; make the motion longer"
            )
        return self._follow(self._contacts, times, half=True)

    def _departing(self, times: Array) -> Orbit:
        return self._follow(self._departures, times, half=False)

    def _follow(self, nodes: Nodes, target: Array, half: bool) -> Orbit:
        shape = np.shape(target)
        target = np.minimum(target, nodes.values[-1]).ravel()
        right = np.searchsorted(nodes.values, target)
        returns, high = nodes.returns[right], nodes.labels[right]
        left = np.maximum(right - 1, 0)
        low = np.where(nodes.returns[left] == returns, nodes.labels[left], -self._map.reach)
        # Before the first node the string rests and the label is the departure itself.
        resting = target - (self._map.rest if half else 0.0)
        low, high = np.where(right == 0, resting, low), np.where(right == 0, resting, high)
        labels = self._map.invert(target, returns, low, high, half)
        orbit = self._map.orbit(returns.reshape(shape), labels.reshape(shape))
        reached = self._map.midpoint(orbit) if half else orbit.time
        return self._map.shifted(orbit, target.reshape(shape) - reached, half)


def exact_string_motion(
    drive: Drive,
    until: float,
    max_labels: int = 4096,
) -> ExactString:
    r"""The exact motion of the string (β = 0) that rests as W = (ξ − a)² until τ = 0.

    Parameters
    ----------
    drive
        Z(τ) > 0 for τ ≥ 0, with Z′(0) = 0. Its values at τ < 0 do not matter: the string rests.
        Z″, if the drive has none, comes from differences of Z′ (which must then be smooth across
        τ = 0), good to about 10⁻¹⁴; ξ_c′ and the sonic contact are then as good, and slower.
    until
        The last time of interest, > 0.
    max_labels
        The labels a return are doubled from 64 until the search for a sonic contact gives the
        same twice, at most to this number.

    Returns
    -------
    ExactString
        The motion up to ``until`` or up to the first sonic contact, with either.

    Raises
    ------
    InputError
        The drive does not start from rest, goes down to the ground, or is not finite.

    Examples
    --------
    >>> from numerics.problems.drive import ramped_cosine
    >>> motion = exact_string_motion(ramped_cosine(2.2, 0.02, periods=5), until=100.0)
    >>> motion.sonic is None
    True
    >>> xi_c = motion.contact(77.0)
    >>> bool(abs(motion.shape(xi_c, 77.0)) < 1e-14), bool(abs(motion.slope(xi_c, 77.0)) < 1e-14)
    (True, True)

    Too strong a drive:

    >>> motion = exact_string_motion(ramped_cosine(2.2, 0.2, periods=5), until=100.0)
    >>> motion.sonic.time < 100, motion.sonic.returns
    (True, 4)

    Source: theory of the return map, see the module's docstring; eq. (beam2) with β = 0.
    """
    until = positive("until", until)
    start = np.zeros(1)
    height, slope = float(drive.height(start)[0]), float(drive.slope(start)[0])
    if not height > 0:
        raise InputError(f"Z(0) = {height!r}: the driven end must rest above the ground, Z(0) > 0")
    if not abs(slope) <= 64 * EPS:
        raise InputError(
            f"Z′(0) = {slope!r}: a string at rest until τ = 0 needs Z′(0) = 0; ramp the drive up"
        )
    the_map = return_map(drive, until, math.sqrt(height))
    found = search(the_map, until, FIRST_LABELS)
    change, labels = math.inf, FIRST_LABELS
    while labels < max_labels and not change <= 1e-6:
        labels *= 2
        finer = search(the_map, until, labels)
        change = finer.change(found)
        found = finer
    return ExactString(
        drive=drive,
        until=until,
        sonic=found.sonic,
        labels=labels,
        least_stretch=found.least_stretch,
        label_change=change,
        _map=the_map,
        _departures=found.departures,
        _contacts=found.contacts,
    )
