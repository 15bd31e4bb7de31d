"""A reader's rope at many points at once, in doubles.

Impedances come from :mod:`asymptotics.problems.marching`; nothing bounds their rounding, which is
some 1e-13 of them, and 1e-10 where layers of 1e-3 are crossed. Where a point has no result in
doubles, an error says which and why.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import sympy

from asymptotics.errors import InputError
from asymptotics.problems.marching import impedances, rest, towers
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.problems.problem import Mode, Problem
from asymptotics.rings.ring import ComplexRing, FloatRing

Array = npt.NDArray[Any]

MOST_POINTS = 10**7


def broadcast(rope: MovingContact, at: Mapping[Any, Any]) -> dict[str, Array]:
    """The parameters' values as arrays of one shape.

    Raises
    ------
    InputError
        Names as in :meth:`MovingContact.values`, shapes that do not fit, what is not finite.
    """
    given = {str(getattr(key, "name", key)): value for key, value in at.items()}
    rope.values(dict.fromkeys(given, 1.0))  # the names
    try:
        arrays = {name: np.asarray(value, dtype=float) for name, value in given.items()}
        full = np.broadcast_arrays(*arrays.values())
    except (TypeError, ValueError) as error:
        raise InputError(f"at: arrays of numbers whose shapes fit; {error}") from None
    for name, values in arrays.items():
        if not np.isfinite(values).all() or (name == "Omega" and not (values > 0).all()):
            raise InputError(f"{name}: give finite numbers" + ", > 0" * (name == "Omega"))
    if not 0 < full[0].size <= MOST_POINTS:
        raise InputError(f"at: {full[0].size} points; give 1 … {MOST_POINTS}")
    return dict(zip(arrays, full, strict=True))


class Points:
    """The rope's numbers, the points along the leading axis; ``still``: with its rest state."""

    def __init__(self, rope: MovingContact, at: Mapping[str, Array], still: bool = True) -> None:
        self.rope, self.m, self.r = rope, rope.contact_order, rope.order
        self.shape = at["Omega"].shape
        self.at = {name: values.ravel() for name, values in at.items()}
        self.count = self.at["Omega"].size
        if not still:
            return
        xi = rope.letters.xi
        load = sympy.Poly(rope.equation.right, xi).all_coeffs()[::-1]
        self.load = self.columns(load).real
        self.constants = self.columns([c.constant for c in rope.driven_end]).real
        self.still = self.equation(0).real
        found = rest(self.still, self.ends(0).real, self.constants, self.load, self.m)
        self.place, self.first, self.pull = found

    def number(self, expression: sympy.Expr) -> Any:
        """An expression at all points."""
        symbols = sorted(expression.free_symbols, key=str)
        function = sympy.lambdify(symbols, expression, "numpy")
        return function(*(self.at[symbol.name] for symbol in symbols))

    def columns(self, expressions: Sequence[sympy.Expr]) -> Array:
        """Expressions side by side, (points, count)."""
        full = [np.broadcast_to(self.number(e), (self.count,)) for e in expressions]
        return np.stack(full, axis=-1).astype(complex)

    def rates(
        self,
        terms: Mapping[tuple[int, int], sympy.Expr],
        j: int,
        length: int,
        omega: Array | None = None,
    ) -> Array:
        """Σ_t c_{kt} (ijΩ)^t; Ω may be another, and complex."""
        found = np.zeros((self.count, length), dtype=complex)
        rate = 1j * j * (self.at["Omega"] if omega is None else omega)
        for (k, t), value in terms.items():
            found[:, k] += self.number(value) * rate**t
        return found

    def equation(self, j: int) -> Array:
        """c_0 … c_r at harmonic j, (points, r + 1)."""
        return self.rates(self.rope.equation.terms, j, self.r + 1)

    def ends(self, j: int) -> Array:
        """E at harmonic j, (points, n, r)."""
        rows = [self.rates(c.terms, j, self.r) for c in self.rope.driven_end]
        return np.stack(rows, axis=1)

    def amplitudes(self, j: int) -> Array:
        """What drives harmonic j, (points, n)."""
        return self.columns([c.drive.get(j, sympy.Integer(0)) for c in self.rope.driven_end])


def swept_problem(rope: MovingContact, at: Mapping[Any, Any]) -> Problem[Any]:
    """The problem at arrays of parameters, for :func:`asymptotics.expand`.

    Raises
    ------
    InputError, PrecisionError
        What the rope at the first point without a result raises.

    Examples
    --------
    >>> import numpy as np
    >>> from asymptotics import expand
    >>> from asymptotics.problems.presets import string
    >>> rope = string(foundation=sympy.Symbol("kappa"))
    >>> series = expand(rope, 2, at={"kappa": np.array([1.7, 2.0]), "Omega": 2.2})
    >>> (2 * series.contact(1)[1]).round(12)
    array([0.89001252, 0.84261588])
    """
    if rope.springs != 0 or rope.varying:
        raise InputError(
            f"{rope}: arrays of points are for constant coefficients and a ground that does not "
            "give way; expand one by one"
        )
    values = broadcast(rope, at)
    points = Points(rope, values)
    drives = [points.amplitudes(j) for j in _harmonics(rope)]
    even = not rope.irreversible and not any(drive.imag.any() for drive in drives)
    ring: Any = FloatRing() if even else ComplexRing()
    m, r = rope.contact_order, rope.order
    _check(rope, points, points.place, "")

    def element(column: Array) -> Array:
        return (column.real if even else column).reshape(points.shape)

    def kind(array: Array) -> Array:
        return array.real if even else array

    @cache
    def static(d: int) -> Array:
        tower = towers(points.still, points.first, max(d + 1, r), points.pull)
        return element(tower[:, d])

    @cache
    def mode(j: int) -> Mode[Any]:
        equation = kind(points.equation(j))
        ends, amplitudes = kind(points.ends(j)), kind(points.amplitudes(j))
        try:
            table, source = impedances(equation, ends, amplitudes, points.place, m - 1)
        except ValueError as error:
            raise InputError(f"harmonic {j}: {error}, or expand the points one by one") from None
        _check(rope, points, table.sum(axis=(1, 2)) + source.sum(axis=1), f" at harmonic {j}")
        return Mode(
            tuple(element(-equation[:, k] / equation[:, r]) for k in range(r)),
            tuple(tuple(element(table[:, d, i]) for d in range(r)) for i in range(m - 1)),
            tuple(element(source[:, d]) for d in range(r)),
        )

    def equation_residual(j: int, w: Sequence[Any]) -> Any:
        found = points.equation(j)
        return ring.sum([element(found[:, k]) * x for k, x in enumerate(w[: r + 1])])

    def end_residual(j: int, w: Sequence[Any]) -> tuple[Any, ...]:
        rows = mode(j).impedance
        return tuple(
            ring.sum([w[d], *(ring.rational(-1) * row[d] * w[i] for i, row in enumerate(rows))])
            for d in range(m - 1, r)
        )

    pulls = [element(points.pull[:, q]) for q in range(points.pull.shape[1])]
    coefficients = points.still
    reduction = [ring.zero] * len(pulls)
    reduction += [element(-coefficients[:, k] / coefficients[:, r]) for k in range(r)]
    return Problem(
        name=f"rope {rope} at {points.count} points, {sorted(values)}",
        ring=ring,
        contact_order=m,
        static=static,
        static_reduction=tuple(reduction),
        mode=mode,
        drive=dict.fromkeys(_harmonics(rope), ring.one),
        inverse_leading=1 / static(m),
        equation_residual=equation_residual,
        end_residual=end_residual,
        end_unit=lambda j: mode(j).source[m - 1 :],
        load=tuple(pulls),
        static_end_residual=lambda a: (),
        rest=points.place.reshape(points.shape),
    )


def _harmonics(rope: MovingContact) -> list[int]:
    return sorted({abs(j) for c in rope.driven_end for j in c.drive})


def _check(rope: MovingContact, points: Points, numbers: Array, where: str) -> None:
    """Raise what the first point without a result has to say."""
    missing = np.flatnonzero(~np.isfinite(numbers))
    if not missing.size:
        return
    first: Callable[[str], float] = lambda name: float(points.at[name][missing[0]])  # noqa: E731
    at = {name: first(name) for name in points.at}
    rope.at(at).mode(1)  # where that too has no result, it says why
    spelled = ", ".join(f"{name} = {value!r}" for name, value in at.items())
    raise InputError(
        f"{missing.size} of {points.count} points have no result in doubles{where}, the first at "
        f"{spelled}: too close to a resonance; leave them out, or expand them one by one"
    )
