r"""Periodic states of ropes with constant coefficients, from the solutions of each harmonic.

W is a sum of :math:`e^{ijΩτ}` times solutions :math:`e^{λξ}` (powers of ξ where λ = 0 is a root),
combined so that they meet the driven end. Given ξ_c(τ) at equal times, all conditions there but one
are linear in the weights; the last one is then met by moving ξ_c (Newton). Nothing is expanded
in ε.

On a ground that gives way, springs κ under the rope beyond ξ_c, the solutions there decay or carry
energy away; W and its first r − 1 derivatives are continuous at ξ_c, and W = 0.

A few milliseconds where collocation takes seconds, and no grid; but only constant coefficients.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.periodic.collocation import (
    Array,
    LinearRope,
    NoPeriodicStateError,
    Terms,
    settled,
)

Complex = NDArray[np.complex128]

_OUTGOING = 1e-7
"""Growth in time, part of Ω, that tells which way a wave goes."""
_ZERO = 1e-9
"""Part of the largest exponent that counts as none."""


def periodic_contact(rope: LinearRope, epsilon: float, times: int) -> Array:
    """ξ_c of the periodic state at ``times`` equal times of a period, from τ = 0.

    Parameters
    ----------
    epsilon
        ε.
    times
        Odd; harmonics up to (times − 1)/2 are resolved.

    Raises
    ------
    InputError
        A coefficient that varies, a wrong number of conditions, or an even number of times.
    NoPeriodicStateError
        The iteration does not settle: ε beyond the state's end.

    Examples
    --------
    The string at rest, W = (1 − ξ)², and moved by ξ₁ = Ω/(2 sin Ω) cos Ωτ:

    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> moved = periodic_contact(string, 1e-3, 9)
    >>> round(float(moved[0] - 1) / 1e-3, 2), round(1.1 / np.sin(2.2), 2)
    (1.36, np.float64(1.36))
    """
    _check(rope, times)
    state = State(rope, epsilon, times)
    found = settled(state.left, float(rope.rest), times)
    if found is None:
        raise NoPeriodicStateError(
            f"no periodic state found at epsilon = {epsilon!r} on {times} times; give a smaller "
            "epsilon"
        )
    return found


def _check(rope: LinearRope, times: int) -> None:
    statements = [rope.terms, *(terms for terms, _, _ in rope.ends)]
    numbers = [c for terms in statements for c in terms.values()]
    if any(np.ndim(c) for c in numbers):
        raise InputError("modes: a coefficient varies along the rope; use collocation")
    r = rope.order
    wanted = r - rope.contacts + 1 if not rope.springs else r // 2
    if len(rope.ends) != wanted or (rope.springs and (r % 2 or rope.contacts != 1)):
        raise InputError(
            f"{len(rope.ends)} conditions at the driven end and {rope.contacts} at the contact "
            f"point; an equation of order {r} needs {wanted} of the former"
        )
    if times < 3 or times % 2 == 0:
        raise InputError(f"times = {times}; give an odd number of times ≥ 3")


def _rates(terms: Terms, rate: complex, length: int) -> Complex:
    found = np.zeros(length, dtype=complex)
    for (k, t), c in terms.items():
        found[k] += float(np.ravel(c)[0]) * (rate**t if t else 1.0)
    return found


class _Solutions:
    """Solutions of Σ c_k ∂^k w = 0, as columns of functions, none of them large on the rope."""

    def __init__(self, coefficients: Complex, rest: float) -> None:
        roots = np.roots(coefficients[::-1])
        small = abs(roots) <= _ZERO * max(abs(roots).max(initial=0.0), 1.0)
        self.powers = int(small.sum())
        self.exponents = roots[~small]
        self.anchors = np.where(self.exponents.real > 0, rest, 0.0)

    def __call__(self, x: Array, d: int) -> Complex:
        """∂^d of each at the places x, a column a solution."""
        columns: list[Any] = []
        for k in range(self.powers):
            power = np.prod(np.arange(k - d + 1, k + 1)) if d else 1.0
            columns.append(power * x ** (k - d) if k >= d else 0 * x)
        for value, anchor in zip(self.exponents, self.anchors, strict=True):
            columns.append(value**d * np.exp(value * (x - anchor)))
        return np.stack(columns, axis=-1).astype(complex)


def _forced(coefficients: Complex, load: Array) -> Array:
    """The polynomial solution of Σ c_k ∂^k W = ℓ, coefficients the highest power first."""
    lowest = int(np.flatnonzero(abs(coefficients) > 0)[0])
    # V = ∂^lowest W solves c V = ℓ − Σ c_k ∂^k V; each round is right to one more degree.
    c, total = coefficients[lowest:].real, np.poly1d([0.0])
    for _ in range(len(load)):
        value = np.poly1d(load)
        for k in range(1, len(c)):
            value = value - c[k] * np.polyder(total, k)
        total = value / c[0]
    for _ in range(lowest):
        total = np.polyint(total)
    return np.asarray(total.coeffs, float)


class State:
    """W as a function of weights that are linear, and of ξ_c."""

    def __init__(self, rope: LinearRope, epsilon: float, times: int) -> None:
        self.rope = rope
        half = (times - 1) // 2
        self.harmonics = list(range(-half, half + 1))
        self.phase = 2 * np.pi * np.arange(times) / times
        tau = self.phase / rope.omega
        self.ground = np.poly1d(list(rope.ground))
        amplitudes = [np.fft.fft(drive(tau)) / times for _, _, drive in rope.ends]
        self.left_side = [
            self._driven(j, [epsilon * a[j] for a in amplitudes]) for j in self.harmonics
        ]
        if rope.springs:
            self.right_side = [self._beyond(j) for j in self.harmonics]
            coefficients = self._on_springs(_rates(rope.terms, 0.0, rope.order + 1))
            self.sunk = np.poly1d(_forced(coefficients, self._load()))

    def _load(self) -> Array:
        """ℓ, of W − g where springs act on that."""
        load = np.poly1d(np.atleast_1d(np.asarray(self.rope.load, float)))
        if self.rope.springs:
            # (P + κ)(W − g) = ℓ − Pg.
            rates = _rates(self.rope.terms, 0.0, self.rope.order + 1).real
            for k, c in enumerate(rates):
                load = load - c * np.polyder(self.ground, k)
        return np.asarray(load.coeffs, float)

    def _on_springs(self, coefficients: Complex) -> Complex:
        sign = np.sign(float(np.ravel(self.rope.terms[0, 2])[0]))
        found = coefficients.copy()
        found[0] += sign * self.rope.springs
        return found

    def _driven(self, j: int, drive: list[complex]) -> Callable[[Array, int], tuple[Any, Any]]:
        """Harmonic j on the left: what the driven end leaves free, and what it forces."""
        rope, r = self.rope, self.rope.order
        rate = 1j * j * rope.omega
        solutions = _Solutions(_rates(rope.terms, rate, r + 1), rope.rest)
        at_end = np.concatenate([solutions(np.zeros(1), d) for d in range(r)])
        rows = np.stack([_rates(terms, rate, r) for terms, _, _ in rope.ends]) @ at_end
        right = np.array(drive, dtype=complex)
        load = np.poly1d([0.0])
        if j == 0:
            still = np.atleast_1d(np.asarray(rope.load, float))
            load = np.poly1d(_forced(_rates(rope.terms, 0.0, r + 1), still))
            for i, (terms, constant, _) in enumerate(rope.ends):
                rates = _rates(terms, 0.0, r).real
                right[i] += constant - sum(
                    c * np.polyder(load, k)(0.0) for k, c in enumerate(rates)
                )
        size = np.abs(rows).max(axis=1, initial=1e-300)
        rows, right = rows / size[:, None], right / size
        _, _, dual = np.linalg.svd(rows)
        free = np.conj(dual[len(rows) :]).T
        forced = np.linalg.lstsq(rows, right, rcond=None)[0]

        def at(x: Array, d: int) -> tuple[Any, Any]:
            table = solutions(x, d)
            return table @ free, table @ forced + np.polyder(load, d)(x)

        return at

    def _beyond(self, j: int) -> Callable[[Array, int], Any]:
        """Harmonic j on the springs: what decays or leaves."""
        rope = self.rope
        growing = 1j * j * rope.omega + _OUTGOING * rope.omega
        roots = np.roots(self._on_springs(_rates(rope.terms, growing, rope.order + 1))[::-1])
        exact = np.roots(
            self._on_springs(_rates(rope.terms, 1j * j * rope.omega, rope.order + 1))[::-1]
        )
        kept = [exact[np.argmin(abs(exact - root))] for root in roots if root.real < 0]
        if 2 * len(kept) != rope.order:
            raise InputError(
                f"harmonic {j}: {len(kept)} of {rope.order} solutions on the springs decay or leave"
            )
        exponents = np.array(kept)

        def at(x: Array, d: int) -> Any:
            return exponents**d * np.exp(np.outer(x - rope.rest, exponents))

        return at

    def _sums(self, contact: Array, d: int) -> tuple[Complex, Complex]:
        """∂^d of W − g at the contact point from the left: per weight, and without any."""
        columns, total = [], np.zeros(len(contact), dtype=complex)
        for j, side in zip(self.harmonics, self.left_side, strict=True):
            wave = np.exp(1j * j * self.phase)
            free, forced = side(contact, d)
            columns.append(free * wave[:, None])
            total += forced * wave
        return np.hstack(columns), total - np.polyder(self.ground, d)(contact)

    def left(self, contact: Array) -> Array:
        """What the last condition at the contact point leaves, when the others hold."""
        if self.rope.springs:
            return self._left_on_springs(contact)
        rows = [self._sums(contact, d) for d in range(self.rope.contacts)]
        matrix = np.vstack([table for table, _ in rows[:-1]])
        weights = np.linalg.solve(matrix, -np.concatenate([total for _, total in rows[:-1]]))
        table, total = rows[-1]
        return np.asarray((table @ weights + total).real)

    def _left_on_springs(self, contact: Array) -> Array:
        rows, sides = [], []
        for d in range(self.rope.order):
            table, total = self._sums(contact, d)
            beyond = np.hstack(
                [
                    side(contact, d) * np.exp(1j * j * self.phase)[:, None]
                    for j, side in zip(self.harmonics, self.right_side, strict=True)
                ]
            )
            rows.append(np.hstack([table, -beyond]))
            sides.append(np.polyder(self.sunk, d)(contact) - total)
        weights = np.linalg.solve(np.vstack(rows), np.concatenate(sides))
        table, total = self._sums(contact, 0)
        return np.asarray((table @ weights[: table.shape[1]] + total).real)
