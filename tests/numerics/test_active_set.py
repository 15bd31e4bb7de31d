"""The complementarity solver against every active set there is, and where Newton's would cycle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from numerics.simulation.trapezoidal import (
    ROUNDS,
    complementarity,
    factor,
    multiplier,
    revise,
    substituted,
)
from tests.numerics.by_hand import EPS


def bands_of(matrix: np.ndarray) -> np.ndarray:
    return np.array([np.append(np.diag(matrix, k), np.zeros(k)) for k in range(3)])


def random_matrix(generator: np.random.Generator, n: int) -> np.ndarray:
    """Pentadiagonal, positive definite, condition some 10⁴ at n = 8, signs at random.

    LLᵀ with L lower triangular of bandwidth 2: no M-matrix, so that only Murty's rule is sure.
    """
    lower = np.diag(generator.uniform(0.3, 1.0, n))
    lower += np.diag(generator.normal(size=n - 1), -1) + np.diag(generator.normal(size=n - 2), -2)
    return lower @ lower.T


def solve(matrix, right, active, obstacle=None):
    n = len(right)
    held, x = active.copy(), np.zeros(n)
    ground = np.ones(n, bool) if obstacle is None else obstacle
    _, rounds, _ = complementarity(
        bands_of(matrix), right, ground, n, 0, held, np.zeros((3, n)), np.zeros(n), x
    )
    return x, held, rounds


def by_enumeration(matrix, right, obstacle):
    """The one active set with x ≥ 0 and Ax − right ≥ 0, of all 2ⁿ; and the margin of its signs."""
    n = len(right)
    found = []
    for pattern in range(2**n):
        active = (pattern >> np.arange(n) & 1).astype(bool)
        if (active & ~obstacle).any():
            continue
        x, free = np.zeros(n), ~active
        if free.any():
            x[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free])
        push = matrix @ x - right
        margin = np.min(np.append(x[free & obstacle], push[active]), initial=np.inf)
        if margin > 0:
            found.append((x, active, margin))
    return found


@pytest.mark.parametrize("seed", range(6))
def test_against_every_active_set(seed):
    """n = 8, any start. The sets agree; x to what the condition number leaves."""
    generator = np.random.default_rng([seed, 5])
    seen = np.zeros(9, bool)
    for _ in range(5):
        matrix, right = random_matrix(generator, 8), generator.normal(size=8)
        obstacle = generator.random(8) < 0.8
        ((exact, active, margin),) = by_enumeration(matrix, right, obstacle)
        if margin < 1e-9:
            continue  # two sets are as good as each other
        start = (generator.random(8) < 0.5) & obstacle
        x, held, rounds = solve(matrix, right, start, obstacle)
        assert rounds > 0
        np.testing.assert_array_equal(held, active)
        size = np.linalg.cond(matrix) * np.abs(exact).max()
        np.testing.assert_allclose(x, exact, rtol=0, atol=64 * EPS * size)
        seen[held.sum()] = True
    assert seen[1:].any()


def test_against_bounded_least_squares():
    """min ½xᵀAx − xᵀr over x ≥ 0 is min |Lᵀx − L⁻¹r|: an independent solver, n = 40."""
    generator = np.random.default_rng(11)
    for _ in range(20):
        matrix, right = random_matrix(generator, 40), generator.normal(size=40)
        matrix += 0.1 * np.eye(40)  # else the condition number grows exponentially with n
        lower = np.linalg.cholesky(matrix)
        problem = lower.T, np.linalg.solve(lower, right)
        other = lsq_linear(*problem, bounds=(0, np.inf), method="bvls", tol=1e-14).x
        x, held, _ = solve(matrix, right, np.zeros(40, bool))
        assert 0 < held.sum() < 40
        assert (x >= 0).all()
        push = matrix @ x - right
        assert push[held].min() >= -1e-9 * np.abs(push).max()
        assert np.abs(push[~held]).max() <= 1e-9 * np.abs(push).max()
        np.testing.assert_allclose(x, other, rtol=0, atol=1e-7 * np.abs(x).max())


def primal_dual(matrix, right, rounds: int) -> list[bytes]:
    """The active sets of the unguarded iteration, one a round."""
    n, active, sets = len(right), np.zeros(len(right), bool), []
    for _ in range(rounds):
        x, free = np.zeros(n), ~active
        x[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free])
        push = matrix @ x - right
        active = np.where(active, push >= 0, x < 0)
        sets.append(active.tobytes())
    return sets


def test_a_cycle_is_left():
    """Where the primal–dual iteration runs in a circle for ever, Murty's rule ends."""
    generator, cycles = np.random.default_rng(3), 0
    for _ in range(400):
        matrix, right = random_matrix(generator, 8), generator.normal(size=8)
        sets = primal_dual(matrix, right, 40)
        if sets[-1] != sets[-2]:
            cycles += 1
            x, held, rounds = solve(matrix, right, np.zeros(8, bool))
            assert rounds > ROUNDS
            ((exact, active, _),) = by_enumeration(matrix, right, np.ones(8, bool))
            np.testing.assert_array_equal(held, active)
            size = np.linalg.cond(matrix) * np.abs(exact).max()
            np.testing.assert_allclose(x, exact, rtol=0, atol=64 * EPS * size)
    assert cycles >= 3


def test_window_grows():
    """Nodes beyond the window join when one close to them is released."""
    n = 60
    matrix = 2.1 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    right = np.full(n, -0.5)
    right[0], right[30:45] = 40.0, -1e-3
    whole, held, _ = solve(matrix, right, np.ones(n, bool))
    x, active = np.zeros(n), np.ones(n, bool)
    bands, ground = bands_of(matrix), np.ones(n, bool)
    size, rounds, _ = complementarity(
        bands, right, ground, 5, 0, active, np.zeros((3, n)), np.zeros(n), x
    )
    assert rounds > 1
    assert 5 < size < n
    np.testing.assert_array_equal(active, held)
    np.testing.assert_allclose(x, whole, rtol=0, atol=64 * EPS * whole.max())
    assert (whole > 0).sum() > 5


def test_the_multiplier_of_a_held_node_is_its_row_of_the_matrix():
    n, rng = 8, np.random.default_rng(4)
    upper = np.tril(np.triu(rng.normal(size=(n, n))), 2)
    matrix = upper + np.triu(upper, 1).T
    right, x = rng.normal(size=n), rng.normal(size=n)
    for i in range(n):
        rest = np.where(np.arange(n) == i, 0.0, x)  # a node that is held lies on the ground
        expected = matrix[i] @ rest - right[i]
        assert abs(multiplier(bands_of(matrix), right, rest, i) - expected) < 64 * EPS


def whole_rounds(bands, right, obstacle, active) -> tuple[np.ndarray, np.ndarray, int, float]:
    """The same iteration with every round over all rows."""
    n = len(right)
    factors, y, x, changed = np.zeros((3, n)), np.zeros(n), np.zeros(n), np.empty(n, np.int64)
    held, rounds, count, least = active.copy(), 0, 1, np.inf
    while count:
        rounds += 1
        factor(bands, held, 0, n, factors)
        substituted(factors, right, held, 0, 0, n, y, x)
        slack = 64 * EPS * bands[0, 0] * np.abs(x).max()
        count, least = revise(
            bands, right, obstacle, 0, n, slack, rounds > ROUNDS, x, held, changed, 0
        )
    return x, held, rounds, least


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_rounds_over_what_changed_are_whole_rounds_to_the_bit(seed):
    """Lifted pieces of all lengths, apart by a node or more; any start, ground not everywhere."""
    generator, seen, longest = np.random.default_rng([seed, 7]), set(), 0
    for _ in range(40):
        n = int(generator.integers(8, 120))
        matrix = random_matrix(generator, n) + generator.choice([0.3, 3.0]) * np.eye(n)
        lift = np.repeat(generator.normal(size=n), generator.integers(1, 9, n))[:n]
        right = lift + generator.uniform(-1, 0.5) + 0.1 * generator.normal(size=n)
        obstacle = generator.random(n) < generator.choice([0.8, 1.0])
        start = (generator.random(n) < generator.uniform(0, 1)) & obstacle
        bands = bands_of(matrix)
        wanted, held, rounds, least = whole_rounds(bands, right, obstacle, start)
        x, active = np.zeros(n), start.copy()
        size, count, push = complementarity(
            bands, right, obstacle, n, 0, active, np.zeros((3, n)), np.zeros(n), x
        )
        assert (size, count, push) == (n, rounds, least)
        np.testing.assert_array_equal(active, held)
        np.testing.assert_array_equal(x, wanted)
        seen.add(int(np.count_nonzero(np.diff(active.astype(int)) > 0)))
        longest = max(longest, rounds)
    assert longest > 3
    assert max(seen) > 5
