r"""Floquet multipliers of a periodic state: waves in a rope with a moving end.

W, …, W^{(m−1)} vanish at ξ_c, hence a small disturbance v of the state obeys the homogeneous
equation with v = … = v^{(m−2)} = 0 at the moving point ξ_c(τ); that of ξ_c follows it,
χ = −v^{(m−1)}/W^{(m)}. For an equation

.. math:: ρ v_{ττ} + δ v_τ + 2V v_{ξτ} − η_2 v_{ξξτ} + η_4 v_{ξξξξτ}
          = T v_{ξξ} − κ v − B v_{ξξξξ} + ι v_{ξξττ}

v = Σ q_i(τ) φ_i(ξ/ξ_c) in the virtual work gives, with the rate v_τ = Σ (q̇_i − …) of a moving
frame, a linear Hamiltonian system for q and its momenta p = ∂L/∂q̇ when δ = η = 0: the map over a
period is symplectic and its multipliers come in pairs λ, 1/λ. Steps are exponentials of the fourth-
order Magnus series, which are symplectic to rounding.

The φ_i are free modes of the rope at rest. A verdict is given when two numbers of modes agree.
For the string (m = 2) the disturbance is f(τ − ξ) − f(τ + ξ) with f∘h = f for the state's own
characteristics h: it is neutral, always, and its multipliers are :math:`e^{2πik/ν}` with the
rotation number ν.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from numerics.errors import InputError
from numerics.periodic.linear_rope import Array, LinearRope
from numerics.periodic.modes import Complex
from numerics.periodic.states import PeriodicState

MODES = (10, 14)
"""The two numbers of modes of a verdict."""

TOLERANCE = 1e-6
"""A multiplier off the unit circle by less is on it."""

_MOST_STEPS = 4096
# Trial functions per mode, and steps per period of the fastest mode kept.
_TRIALS, _PER_PERIOD = 2, 10

_KNOWN = {(0, 2), (0, 1), (1, 1), (2, 1), (4, 1), (2, 0), (0, 0), (4, 0), (2, 2)}


@dataclass(frozen=True)
class Stability:
    """Multipliers of a state over its period, and what they say.

    Attributes
    ----------
    verdict
        ``stable``, ``neutral`` (the string, whose disturbances neither grow nor decay),
        ``unstable``, or ``undecided``: the two numbers of modes disagree.
    multipliers
        By the larger number of modes, the largest modulus first.
    modes
        That number.
    growth
        log|λ|/period of the largest.
    """

    verdict: str
    multipliers: Complex
    modes: int
    growth: float


def stability(state: PeriodicState) -> Stability:
    """The verdict on a state.

    Raises
    ------
    InputError
        What :func:`multipliers` is not for.

    Examples
    --------
    The string at rest hardly moved: λ = e^{2πik/ν}, ν = Ω/π + O(ε²).

    >>> from numerics.periodic.states import periodic_state
    >>> ends = [({(0, 0): 1.0}, 1.0, lambda tau: np.cos(2.2 * tau))]
    >>> string = LinearRope({(0, 2): 1.0, (2, 0): -1.0}, -2.0, ends, 2, 2.2, 1.0)
    >>> found = stability(periodic_state(string, 1e-3))
    >>> found.verdict, bool(abs(abs(found.multipliers) - 1).max() < 1e-9)
    ('neutral', True)
    """
    few, many = (multipliers(state, count) for count in MODES)
    rope = state.modes.rope
    period = 2 * math.pi * state.modes.subharmonic / rope.omega
    sizes = abs(few).max(), abs(many).max()
    growth = math.log(sizes[1]) / period
    damped = any(t == 1 and k != 1 and c for (k, t), c in rope.terms.items())
    above = [size > 1 + TOLERANCE for size in sizes]
    if rope.order == 2 and not damped and not rope.terms.get((0, 0)):
        verdict = "neutral"
    elif above[0] != above[1]:
        verdict = "undecided"
    elif above[0]:
        # Growth that belongs to the number of modes is none of the rope's.
        apart = abs(math.log(sizes[0]) - math.log(sizes[1]))
        verdict = "unstable" if apart < 0.3 * math.log(sizes[1]) else "undecided"
    elif damped and max(sizes) > 1 - TOLERANCE:
        verdict = "undecided"
    else:
        verdict = "stable"
    return Stability(verdict, many, MODES[1], growth)


def multipliers(state: PeriodicState, modes: int, steps: int | None = None) -> Complex:
    """The 2n multipliers of a state's period by n modes, the largest modulus first.

    Parameters
    ----------
    modes
        n, 2 to 40.
    steps
        Of the period; by default ten a period of the fastest mode.

    Raises
    ------
    InputError
        The equation has other terms than the module's; an end that does no work is not told from
        one that does; a ground that gives way.
    """
    if not 2 <= modes <= 40:
        raise InputError(f"modes = {modes!r}; give a whole number from 2 to 40")
    waves = _Waves(state.modes.rope, modes)
    period = 2 * math.pi * state.modes.subharmonic / state.modes.rope.omega
    if steps is None:
        slowest = 16 * state.waves.size
        steps = min(_MOST_STEPS, max(slowest, math.ceil(_PER_PERIOD * period * waves.fastest / 6)))
    # The Magnus series of fourth order, at the two Gauss points of each step.
    h = period / steps
    middle = h * (np.arange(steps) + 0.5)
    off = h * math.sqrt(3) / 6
    first, second = (
        waves.matrices(state.contact(middle + x), state.contact(middle + x, 1)) for x in (-off, off)
    )
    generator = h / 2 * (first + second)
    generator += math.sqrt(3) * h**2 / 12 * (second @ first - first @ second)
    total = np.eye(2 * modes)
    for step in _exponentials(generator):
        total = step @ total
    found = np.linalg.eigvals(total)
    return np.asarray(found[np.argsort(-abs(found), kind="stable")], dtype=complex)


def _exponentials(a: Array) -> Array:
    """exp of each matrix, by a Padé fraction of order 6 and squaring: it stays symplectic."""
    size = float(abs(a).sum(axis=1).max())
    halvings = max(0, math.ceil(math.log2(size / 0.5))) if size > 0 else 0
    x = a / 2**halvings
    square = x @ x
    fourth = square @ square
    one = np.eye(a.shape[-1])
    even = one + 5 / 44 * square + fourth / 792 + square @ fourth / 665280
    odd = x @ (one / 2 + square / 66 + fourth / 15840)
    result = np.linalg.solve(even - odd, even + odd)
    for _ in range(halvings):
        result = result @ result
    return np.asarray(result)


class _Waves:
    """The modes on the fixed strip y = ξ/ξ_c, and the matrices of their motion."""

    def __init__(self, rope: LinearRope, modes: int) -> None:
        self.c = c = _coefficients(rope)
        essential = _essential(rope)
        places, weights = np.polynomial.legendre.leggauss(_TRIALS * modes + 24)
        self.y, weights = (places + 1) / 2, weights / 2
        trials = _trials(essential, rope.contacts - 1, _TRIALS * modes + 4, self.y)
        # Modes of the rope at rest.
        x0 = rope.rest
        mass = c[0, 2] * _gram(trials[0], trials[0], weights)
        mass += c[2, 2] / x0**2 * _gram(trials[1], trials[1], weights)
        stiff = sum(
            size / x0 ** (2 * d) * _gram(trials[d], trials[d], weights)
            for d, size in enumerate((c[0, 0], c[2, 0], c[4, 0]))
        )
        lower = np.linalg.cholesky(mass)
        inner = np.linalg.solve(lower, np.linalg.solve(lower, stiff).T)
        values, vectors = np.linalg.eigh((inner + inner.T) / 2)
        chosen = np.linalg.solve(lower.T, vectors[:, :modes])
        self.fastest = math.sqrt(max(float(values[modes - 1]), 0.0))
        phi = [table @ chosen for table in trials]
        y = self.y[:, None]
        # Of the moving frame: v_τ = q̇φ − (ξ_c'/ξ_c) q yφ′, and its first two slopes.
        moved = [y * phi[1], phi[1] + y * phi[2], 2 * phi[2] + y * phi[3]]
        self.still = [_gram(a, a, weights) for a in phi[:3]]
        self.mixed = [_gram(a, b, weights) for a, b in zip(phi[:3], moved, strict=True)]
        self.both = [_gram(b, b, weights) for b in moved]
        self.turned = _gram(phi[0], phi[1], weights)  # ∫ φ_i φ_j′, skew
        self.turned_moved = _gram(phi[1], moved[0], weights)

    def matrices(self, contact: Array, rate: Array) -> Array:
        """A(τ) of z′ = Az, z = (q, p)."""
        c = self.c
        x, ratio = contact[:, None, None], (rate / contact)[:, None, None]

        def quadratic(sizes: tuple[float, float, float], tables: list[Array]) -> Any:
            return sum(
                size * x ** (1 - 2 * d) * table
                for d, (size, table) in enumerate(zip(sizes, tables, strict=True))
                if size
            )

        inertia = (c[0, 2], c[2, 2], 0.0)
        losses = (c[0, 1], c[2, 1], c[4, 1])
        zero = np.zeros((contact.size, *self.still[0].shape))
        # L = ½ q̇ᵀM q̇ − r q̇ᵀN q + ½ r² qᵀSq − ½ qᵀKq + L₁, r = ξ_c'/ξ_c.
        M = zero + quadratic(inertia, self.still)
        N = zero + ratio * quadratic(inertia, self.mixed)
        S = zero + ratio**2 * quadratic(inertia, self.both)
        K = zero + quadratic((c[0, 0], c[2, 0], c[4, 0]), self.still)
        if c[1, 1]:
            # 2V v_ξτ is the force of L₁ = V ∫ v_τ v_ξ dξ.
            V = c[1, 1] / 2
            N = N - V * self.turned
            S = S - V * ratio * (self.turned_moved + self.turned_moved.transpose(1, 0))
        inverse = np.linalg.inv(M)
        to_q = inverse @ N
        back = N.transpose(0, 2, 1)
        upper = np.concatenate([to_q, inverse], axis=2)
        lower = np.concatenate([S - K - back @ to_q, -back @ inverse], axis=2)
        if any(losses):
            # Virtual work −∫ δ v_τ φ_i − …, v_τ by q̇ = M⁻¹(p + Nq).
            D = zero + quadratic(losses, self.still)
            E = zero + ratio * quadratic(losses, self.mixed)
            lower = lower - np.concatenate([D @ to_q - E, D @ inverse], axis=2)
        return np.concatenate([upper, lower], axis=1)


def _gram(a: Array, b: Array, weights: Array) -> Array:
    return np.asarray(a.T @ (weights[:, None] * b))


def _coefficients(rope: LinearRope) -> dict[tuple[int, int], float]:
    """ρ, δ, 2V, η₂, η₄, T, κ, B, ι by (k, t), all positive where they keep or lose energy."""
    if rope.springs:
        raise InputError("stability is of a ground that does not give way")
    strange = [
        key for key, c in rope.terms.items() if key not in _KNOWN and np.any(np.asarray(c) != 0)
    ]
    if strange or any(np.ndim(c) for c in rope.terms.values()):
        raise InputError(
            "stability: the equation may have W, W_xixi, W_xixixixi and their first derivatives in "
            f"time, W_tautau, W_xitau and W_xixitautau, with constant coefficients; not {strange}"
        )
    whole = float(np.ravel(rope.terms.get((0, 2), 0.0))[0])
    if not whole:
        raise InputError("stability: the equation has no W_tautau")
    found = {}
    for key in _KNOWN:
        sign = -1.0 if key[0] == 2 else 1.0
        found[key] = sign * float(np.ravel(rope.terms.get(key, 0.0))[0]) / abs(whole)
    if whole < 0:
        found = {key: -c for key, c in found.items()}
    return found


def _essential(rope: LinearRope) -> tuple[int, ...]:
    """Which derivatives vanish at ξ = 0; the other conditions are natural ones.

    Held there is W or W_ξ, and nothing else does work: (W, W_ξ), (W, W_ξξ) and (W_ξ, W_ξξξ).
    """
    held = []
    for terms, _, _ in rope.ends:
        present = [key for key, c in terms.items() if c]
        if len(present) != 1 or present[0][1]:
            raise InputError("stability: each condition at the driven end holds one derivative")
        held.append(present[0][0])
    allowed: dict[int, list[tuple[int, ...]]] = {2: [(0,)], 4: [(0, 1), (0, 2), (1, 3)]}
    if tuple(sorted(held)) not in allowed.get(rope.order, []):
        raise InputError(
            "stability: at the driven end are held W; W and W_xi; W and W_xixi; or W_xi and "
            f"W_xixixi, the others do work. Given: derivatives {sorted(held)}"
        )
    return tuple(k for k in sorted(held) if k < rope.order // 2)


def _trials(essential: tuple[int, ...], vanishing: int, count: int, y: Array) -> list[Array]:
    """Polynomials that meet the essential conditions at y = 0 and 1, with three derivatives."""
    # (1 − y)^vanishing P_k(2y − 1) has them at 1; those at 0 leave a subspace.
    k = np.arange(count + len(essential))
    factor = np.polynomial.Legendre([0.5, -0.5]) ** vanishing
    basis = [factor * np.polynomial.Legendre.basis(int(i)) for i in k]
    rows = np.array([[b.deriv(d)(-1.0) if d else b(-1.0) for b in basis] for d in essential])
    if len(essential):
        rows = rows / abs(rows).max(axis=1, keepdims=True)
        _, _, dual = np.linalg.svd(rows)
        chosen = dual[len(essential) :].T
    else:
        chosen = np.eye(len(basis))
    places = 2 * y - 1
    tables = []
    for d in range(4):
        values = np.stack([(b.deriv(d) if d else b)(places) for b in basis], axis=1)
        tables.append(2.0**d * values @ chosen)
    return tables
