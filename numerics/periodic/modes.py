r"""A rope with constant coefficients as equations for its periodic states.

In units of Ω/s, W is a sum over the harmonics j of :math:`e^{ijΩτ/s}` times solutions
:math:`e^{λξ}` (powers of ξ where λ = 0 is a root) of the equation of that harmonic,

.. math:: \sum_k c_k(ijΩ/s) λ^k = 0,

combined so that they meet the driven end. What the end leaves free are weights, in which W is
linear. Unknown are the weights and ξ_c at an odd number of equal times, and what they have to meet
is W − g = … = ∂^{m−1}(W − g) = 0 at ξ_c at these times. The matrix of derivatives is analytic: a
moved contact point changes ∂^d(W − g) there by ∂^{d+1}(W − g). Nothing is expanded in ε.

On a ground that gives way, springs κ under the rope beyond ξ_c, the solutions there decay or carry
energy away; W and its first r − 1 derivatives are continuous at ξ_c, and W = 0.

The weights are coordinates in the space of what is free, spanned by orthonormal columns of the
derivatives at ξ₀. Along a branch that space turns with Ω; :class:`Modes` takes the columns of an
earlier one, so that the unknowns stay the same ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope, Terms

Complex = NDArray[np.complex128]

_OUTGOING = 1e-7
"""Growth in time, part of Ω, that tells which way a wave goes."""
_ZERO = 1e-9
"""Part of the largest exponent that counts as none."""


def check_constant(rope: LinearRope, times: int) -> None:
    """That modes are for this rope.

    Raises
    ------
    InputError
        A coefficient that varies, a wrong number of conditions, or an even number of times.
    """
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


def rates(terms: Terms, rate: complex, length: int) -> Complex:
    """The coefficients of ∂_ξ^0 … ∂_ξ^{length−1} at e^{rate τ}."""
    found = np.zeros(length, dtype=complex)
    for (k, t), c in terms.items():
        found[k] += float(np.ravel(c)[0]) * (rate**t if t else 1.0)
    return found


@dataclass(frozen=True)
class _Exponentials:
    """For each harmonic as many solutions, none of them large on the rope.

    Attributes
    ----------
    exponents, anchors
        e^{λ(ξ − anchor)}, a row a harmonic.
    powers
        (harmonic, column) ↦ p of the columns that are ξ^p.
    """

    exponents: Complex
    anchors: Array
    powers: dict[tuple[int, int], int]

    @classmethod
    def of(cls, polynomials: Sequence[Complex], rest: float) -> _Exponentials:
        """Of Σ c_k λ^k = 0, a list of c_k a harmonic."""
        rows, powers = [], {}
        for j, coefficients in enumerate(polynomials):
            roots = np.roots(coefficients[::-1])
            small = abs(roots) <= _ZERO * max(abs(roots).max(initial=0.0), 1.0)
            for p, column in enumerate(np.flatnonzero(small)):
                powers[j, int(column)] = p
            rows.append(np.where(small, 0.0, roots))
        exponents = np.array(rows)
        return cls(exponents, np.where(exponents.real > 0, rest, 0.0), powers)

    def derivatives(self, x: Array, count: int) -> list[Complex]:
        """∂^0 … ∂^{count−1} at the places x: (place, harmonic, column)."""
        found = [np.exp(self.exponents * (x[:, None, None] - self.anchors))]
        for _ in range(count - 1):
            found.append(found[-1] * self.exponents)
        for (j, column), p in self.powers.items():
            for d in range(count):
                factor = np.prod(np.arange(p - d + 1, p + 1)) if d else 1.0
                found[d][:, j, column] = factor * x ** (p - d) if p >= d else 0.0
        return found


def _forced(coefficients: Complex, load: Array) -> np.poly1d:
    """The polynomial solution of Σ c_k ∂^k W = ℓ."""
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
    return total


class _Side:
    """The rope on one side of the contact point: W = free · weights + forced."""

    def __init__(
        self,
        solutions: _Exponentials,
        free: Sequence[Complex],
        forced: tuple[Complex, Complex],
        load: np.poly1d,
        rest: float,
        columns: Sequence[Complex] | None,
    ) -> None:
        self.solutions, self.forced, self.load = solutions, forced, load
        r = solutions.exponents.shape[1]
        data = solutions.derivatives(np.array([rest]), r)
        self.columns, combined = [], []
        for j, combinations in enumerate(free):
            size = max(1.0, float(abs(solutions.exponents[j]).max()))
            here = np.array([row[0, j] / size**d for d, row in enumerate(data)]) @ combinations
            q, triangle = np.linalg.qr(here)
            known = columns[j] if columns is not None else _own(q, j == 0)
            turned, _, back = np.linalg.svd(np.conj(q).T @ known)
            # The nearest orthonormal columns in the space to the known ones.
            unitary = turned @ back
            self.columns.append(q @ unitary)
            combined.append(combinations @ np.linalg.solve(triangle, unitary))
        self.free = np.array(combined)

    @property
    def unknowns(self) -> int:
        """How many real weights."""
        harmonics, _, f = self.free.shape
        return f * (2 * harmonics - 1)

    def tables(self, x: Array, wave: Complex, count: int) -> tuple[list[Array], list[Complex]]:
        """∂^d at each place: per real weight, and of each single solution."""
        found, every = [], []
        for table in self.solutions.derivatives(x, count):
            table *= wave[:, :, None]
            every.append(table)
            per_weight = np.einsum("thr,hrf->thf", table, self.free, optimize=True)
            flat = per_weight[:, 1:].reshape(len(x), -1)
            found.append(np.hstack([per_weight[:, 0].real, flat.real, -flat.imag]))
        return found, every

    def weights(self, flat: Array) -> Complex:
        """Real unknowns as complex weights: (harmonic, f)."""
        harmonics, _, f = self.free.shape
        real, imaginary = np.split(flat[f:], 2)
        rest = (real + 1j * imaginary).reshape(harmonics - 1, f)
        return np.concatenate([flat[None, :f].astype(complex), rest])


def _own(q: Complex, real: bool) -> Complex:
    """Columns of a space; real ones where it is that of a real equation."""
    if not real:
        return q
    _, vectors = np.linalg.eigh((q @ np.conj(q).T).real)
    return vectors[:, vectors.shape[1] - q.shape[1] :].astype(complex)


class Modes:
    """The equations for a periodic state at one Ω.

    Parameters
    ----------
    rope
        With constant coefficients.
    times
        T, odd: harmonics of Ω/s up to (T − 1)/2.
    subharmonic
        s: the period is s that of the drive.
    like
        Another one, whose unknowns these are to be.

    Attributes
    ----------
    phase, tau
        Ωτ/s and τ at the T times.
    """

    def __init__(
        self, rope: LinearRope, times: int, subharmonic: int = 1, like: Modes | None = None
    ) -> None:
        check_constant(rope, times)
        self.rope, self.times, self.subharmonic = rope, times, subharmonic
        base, r = rope.omega / subharmonic, rope.order
        self.phase = 2 * np.pi * np.arange(times) / times
        self.tau = self.phase / base
        harmonics = np.arange((times + 1) // 2)
        self.wave = np.exp(1j * np.outer(self.phase, harmonics))
        self.ground = np.poly1d(list(rope.ground))
        steady = [rates(rope.terms, 1j * j * base, r + 1) for j in harmonics]
        solutions = _Exponentials.of(steady, rope.rest)
        free, still, driven = [], [], []
        load = _forced(steady[0], np.atleast_1d(np.asarray(rope.load, float)))
        waves = [np.fft.fft(drive(self.tau)) / times for _, _, drive in rope.ends]
        at_end = [row[0] for row in solutions.derivatives(np.zeros(1), r)]
        for j in harmonics:
            rows = [rates(terms, 1j * j * base, r) for terms, _, _ in rope.ends]
            constant = np.zeros(len(rope.ends))
            if j == 0:
                constant = np.array([c for _, c, _ in rope.ends])
                constant -= [
                    sum(c * np.polyder(load, k)(0.0) for k, c in enumerate(row.real))
                    for row in rows
                ]
            drive = np.array([(2 if j else 1) * a[j] for a in waves])
            conditions = np.array(rows) @ np.array([row[j] for row in at_end])
            size = np.maximum(np.abs(conditions).max(axis=1), 1e-300)
            conditions = conditions / size[:, None]
            _, _, dual = np.linalg.svd(conditions)
            free.append(np.conj(dual[len(rows) :]).T)
            inverse = np.linalg.pinv(conditions)
            still.append(inverse @ (constant / size))
            driven.append(inverse @ (drive / size))
        self.left: _Side = _Side(
            solutions,
            free,
            (np.array(still), np.array(driven)),
            load,
            rope.rest,
            like.left.columns if like is not None else None,
        )
        self.right: _Side | None = self._beyond(base * harmonics, like) if rope.springs else None

    def _beyond(self, frequencies: NDArray[Any], like: Modes | None) -> _Side:
        """The rope on the springs: what decays or leaves."""
        rope, r = self.rope, self.rope.order
        kept = []
        for frequency in frequencies:
            growing = 1j * frequency + _OUTGOING * rope.omega
            told = np.roots(self._on_springs(rates(rope.terms, growing, r + 1))[::-1])
            exact = np.roots(self._on_springs(rates(rope.terms, 1j * frequency, r + 1))[::-1])
            those = [exact[np.argmin(abs(exact - root))] for root in told if root.real < 0]
            if 2 * len(those) != r:
                raise InputError(
                    f"at frequency {frequency:.4g}, {len(those)} of {r} solutions on the springs "
                    "decay or leave"
                )
            kept.append(those)
        exponents = np.array(kept)
        solutions = _Exponentials(exponents, np.full(exponents.shape, rope.rest), {})
        # (P + κ)(W − g) = ℓ − Pg.
        load = np.poly1d(np.atleast_1d(np.asarray(rope.load, float)))
        for k, c in enumerate(rates(rope.terms, 0.0, r + 1).real):
            load = load - c * np.polyder(self.ground, k)
        sunk = _forced(self._on_springs(rates(rope.terms, 0.0, r + 1)), load.coeffs)
        none = np.zeros(exponents.shape, dtype=complex)
        known = like.right.columns if like is not None and like.right is not None else None
        free = [np.eye(r // 2, dtype=complex)] * len(kept)
        return _Side(solutions, free, (none, none), sunk, rope.rest, known)

    def _on_springs(self, coefficients: Complex) -> Complex:
        sign = np.sign(float(np.ravel(self.rope.terms[0, 2])[0]))
        found = coefficients.copy()
        found[0] += sign * self.rope.springs
        return found

    @property
    def unknowns(self) -> int:
        """How many: weights, then ξ_c at the T times."""
        beyond = self.right.unknowns if self.right is not None else 0
        return self.left.unknowns + beyond + self.times

    def _values(
        self, side: _Side, x: Array, count: int, flat: Array, epsilon: float
    ) -> tuple[list[Array], list[Array], list[Array]]:
        """∂^d: per weight, in all, and per ε."""
        tables, every = side.tables(x, self.wave, count)
        still, driven = side.forced
        totals, per_epsilon = [], []
        for d, (table, each) in enumerate(zip(tables, every, strict=True)):
            moved = np.einsum("thr,hr->t", each, driven).real
            rest = np.einsum("thr,hr->t", each, still).real + np.polyder(side.load, d)(x)
            totals.append(table @ flat + rest + epsilon * moved)
            per_epsilon.append(moved)
        return tables, totals, per_epsilon

    def equations(self, unknown: Array, epsilon: float) -> tuple[Array, Array, Array]:
        """What the conditions at ξ_c leave, its derivatives by the unknowns, and by ε."""
        rope, contact = self.rope, unknown[-self.times :]
        count = rope.order + 1 if rope.springs else rope.contacts + 1
        flat = unknown[: self.left.unknowns]
        tables, totals, by_epsilon = self._values(self.left, contact, count, flat, epsilon)
        totals = [total - np.polyder(self.ground, d)(contact) for d, total in enumerate(totals)]
        rows: list[tuple[list[Array], Array, Array, Array]] = []
        if self.right is None:
            for d in range(rope.contacts):
                rows.append(([tables[d]], totals[d], totals[d + 1], by_epsilon[d]))
        else:
            beyond = unknown[self.left.unknowns : -self.times]
            others, sums, _ = self._values(self.right, contact, count, beyond, 0.0)
            for d in range(rope.order):
                step = totals[d + 1] - sums[d + 1]
                parts = [tables[d], -others[d]]
                rows.append((parts, totals[d] - sums[d], step, by_epsilon[d]))
            none = np.zeros_like(others[0])
            rows.append(([tables[0], none], totals[0], totals[1], by_epsilon[0]))
        left = np.concatenate([total for _, total, _, _ in rows])
        matrix = np.vstack([np.hstack([*parts, np.diag(step)]) for parts, _, step, _ in rows])
        return left, matrix, np.concatenate([row for _, _, _, row in rows])

    def start(self, contact: Array, epsilon: float) -> Array:
        """The unknowns at a given ξ_c, with weights that meet all conditions but the last."""
        unknown = np.concatenate([np.zeros(self.unknowns - self.times), contact])
        left, matrix, _ = self.equations(unknown, epsilon)
        rows = slice(0, self.unknowns - self.times)
        unknown[rows] = -np.linalg.solve(matrix[rows, rows], left[rows])
        return unknown

    def shape(
        self, unknown: Array, epsilon: float, x: Array, tau: Array, d: int = 0, rate: int = 0
    ) -> Array:
        """∂_ξ^d ∂_τ^rate (W − g) of the lifted part at places and times of one length."""
        turning = self.rope.omega / self.subharmonic * np.arange(self.wave.shape[1])
        wave = np.exp(1j * np.outer(tau, turning)) * (1j * turning) ** rate
        tables, every = self.left.tables(x, wave, d + 1)
        still, driven = self.left.forced
        forced = np.einsum("thr,hr->t", every[d], still + epsilon * driven).real
        total = tables[d] @ unknown[: self.left.unknowns] + forced
        if rate == 0:
            total += np.polyder(self.left.load, d)(x) - np.polyder(self.ground, d)(x)
        return np.asarray(total)
