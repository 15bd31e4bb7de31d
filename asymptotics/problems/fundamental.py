r"""Harmonics and static shapes of a linear equation with constant coefficients, over balls.

With y = (w, w′, …, w^{(r−1)}) the equation Σ c_k ∂^k w = 0 is y′ = Ay, A the companion matrix of
c_k/c_r, so that :math:`y(0) = e^{−Aξ_0} y(ξ_0)`. The n = r − m + 1 conditions at the driven end are
rows E: with :math:`M = E e^{−Aξ_0}` and S its last n columns,

.. math:: S x = −M_{\cdot i} \text{ (unit datum i)}, \qquad S x = v \text{ (the drive)}, \qquad
          x = (w^{(m−1)}, …, w^{(r−1)}) \text{ at } ξ_0 .

Where layers are thin e^{−Aξ₀} is huge and its columns nearly parallel. Balls neither overflow nor
hide what that costs; whoever asks doubles their bits until enough is left.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flint import acb, acb_mat, arb, ctx

from asymptotics.rings.precision import PrecisionError

Row = Sequence[acb]


@dataclass(frozen=True)
class Propagator:
    """The equation Σ c_k ∂^k w = load, k ≤ r, in the form y′ = Ay + b.

    Attributes
    ----------
    coefficients
        c_0 … c_r, balls.
    load
        The right-hand side's Taylor coefficients' derivatives ℓ, ℓ′, …, ℓ^{(p)} at ξ₀; none for
        a harmonic.
    """

    coefficients: tuple[acb, ...]
    load: tuple[acb, ...] = ()

    @property
    def order(self) -> int:
        """r."""
        return len(self.coefficients) - 1

    def matrix(self) -> acb_mat:
        """A, with the states ℓ, ℓ′, … of the load below those of w."""
        r, p = self.order, len(self.load)
        leading = self.coefficients[r]
        entries = [[acb(0)] * (r + p) for _ in range(r + p)]
        for i in range(r - 1):
            entries[i][i + 1] = acb(1)
        for k in range(r):
            entries[r - 1][k] = -self.coefficients[k] / leading
        if p:
            entries[r - 1][r] = 1 / leading
        for i in range(p - 1):
            entries[r + i][r + i + 1] = acb(1)
        return acb_mat(entries)

    def backwards(self, length: arb) -> acb_mat:
        """e^{−A·length}: the states at ξ = 0 from those at ξ₀ = ``length``."""
        return (self.matrix() * acb(-length)).exp()

    def steps(self, length: arb, count: int) -> Iterator[acb_mat]:
        """From ξ₀ = ``length`` to 0 in equal steps."""
        step = self.backwards(length / count)
        for _ in range(count):
            yield step

    def stepwise(self, length: arb) -> acb_mat:
        """The same by Taylor's series in steps, without FLINT's exponential: for the proof.

        A step h has |A|h ≤ ½, so that after the term T_n all others are less than |T_n| together.
        """
        step = self.matrix() * acb(-length)
        size = max(
            sum(float(abs(step[i, k]).upper()) for k in range(step.ncols()))
            for i in range(step.nrows())
        )
        halvings = 0
        while size > 0.5:
            size, halvings = size / 2, halvings + 1
        step = step * acb(arb(2) ** -halvings)
        unit = acb_mat([[acb(i == k) for k in range(step.ncols())] for i in range(step.nrows())])
        total, term, n = unit, unit, 0
        while n == 0 or _largest(term) > arb(2) ** (-ctx.prec - 2 * halvings):
            n += 1
            term = term * step * acb(arb(1) / n)
            total = total + term
        rest = acb(arb(0, 1), arb(0, 1)) * acb(_largest(term) * term.nrows())
        total = total + acb_mat([[rest] * term.ncols() for _ in range(term.nrows())])
        for _ in range(halvings):
            total = total * total
        return total


def _largest(matrix: acb_mat) -> arb:
    sizes = [abs(x).upper() for x in matrix.entries()]
    return max(sizes, key=float)


def product(rows: Sequence[Row], matrix: acb_mat) -> list[list[acb]]:
    """The rows times the matrix; rows shorter than it are filled with zeros."""
    width = matrix.nrows()
    filled = [[*row, *[acb(0)] * (width - len(row))] for row in rows]
    result = acb_mat(filled) * matrix
    return [[result[i, k] for k in range(result.ncols())] for i in range(result.nrows())]


def solve(rows: Sequence[Row], right: Sequence[acb], what: str) -> list[acb]:
    """x with rows·x = right.

    Raises
    ------
    PrecisionError
        The determinant's ball holds zero: a resonance, or too few bits to tell.
    """
    if not rows:
        return []
    # A row's size says nothing: thin layers make one 10^400 times another.
    scaled, sides = [], []
    for row, side in zip(rows, right, strict=True):
        size = max((abs(x).upper() for x in row), key=magnitude)
        if not size > 0:
            raise PrecisionError(f"{what}: a row of zeros", rows)
        scaled.append([x / acb(size.mid()) for x in row])
        sides.append([side / acb(size.mid())])
    try:
        found = acb_mat(scaled).solve(acb_mat(sides))
    except ZeroDivisionError:
        raise PrecisionError(f"{what}: singular to {ctx.prec} bits", rows) from None
    return [found[i, 0] for i in range(found.nrows())]


def magnitude(ball: arb) -> tuple[int, float]:
    """Comparable also beyond the doubles: the binary exponent first.

    Raises
    ------
    PrecisionError
        A ball that holds everything.
    """
    if not ball.is_finite():
        raise PrecisionError("a solution beyond any bound", ball)
    if ball == 0:
        return (-(10**9), 0.0)
    mantissa, exponent = ball.mid().man_exp()
    bits = int(abs(mantissa)).bit_length()
    return (int(exponent) + bits, float(arb((abs(mantissa), -bits))))
