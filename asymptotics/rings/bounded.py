r"""Doubles that carry a bound of their error, as scalars or as whole arrays.

An element is a pair (value, error), |true − value| ≤ error, and every operation bounds what its
operands' errors and its own rounding add (running error analysis; a ball with a double for its
centre and one for its radius):

.. math:: |δ(ab)| ≤ |a| δ_b + |b| δ_a + δ_a δ_b + u |ab|, \qquad u = 2^{−53},

with 4u for complex numbers; what the bound itself rounds is covered by a factor 1 + 2⁻⁴⁰. Where a
divisor may be zero, a quotient's error is ∞: nothing is known. Balls of python-flint do this to any
precision, but one at a time; here arrays of thousands of frequencies cost a few NumPy operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from asymptotics.rings.numbers import Numbers
from asymptotics.rings.pickling import remembering
from asymptotics.rings.ring import FloatRing

Array = npt.NDArray[Any]

_UNIT = 2.0**-53
_COMPLEX = 4  # a complex product or quotient rounds that much more than a real one
_OWN = 1 + 2.0**-40  # what the bound's own few roundings may take from it
_TINY = 2.0**-1000  # results that underflow
# NumPy's real exp, sin, cos and sqrt are right to 2 ulp.
_FUNCTION = 4


class Bounded:
    """Numbers with error bounds; of one shape, or shapes that broadcast.

    Attributes
    ----------
    value, error
        Doubles or complex doubles; and doubles ≥ 0, ∞ where nothing is known.

    Numbers without a bound that take part in an operation are exact.

    Examples
    --------
    >>> third = Bounded(1.0) / 3
    >>> (third - 1 / 3).value, 0 < (third - 1 / 3).error < 1e-15
    (np.float64(0.0), np.True_)
    >>> (Bounded(1.0) / Bounded(1e-3, 1e-2)).error
    np.float64(inf)
    """

    __slots__ = ("error", "value")
    __array_ufunc__ = None  # an array on the left leaves the operation to this class

    def __init__(self, value: Any, error: Any = 0.0) -> None:
        self.value = np.asarray(value)[()]
        self.error = np.asarray(error, dtype=float)[()]

    def __repr__(self) -> str:
        return f"Bounded({self.value!r}, {self.error!r})"

    def _is_nothing(self) -> bool:
        return np.ndim(self.value) == 0 and self.value == 0 == self.error

    def __mul__(self, other: Any) -> Bounded:
        other = lifted(other)
        if self._is_nothing() or other._is_nothing():
            return Bounded(0.0)
        with np.errstate(all="ignore"):
            value = self.value * other.value
            mine, its = _times(self.error, other.value), _times(other.error, self.value)
            return _made(value, mine + its + _times(self.error, other.error))

    def __add__(self, other: Any) -> Bounded:
        other = lifted(other)
        if self._is_nothing() or other._is_nothing():
            return self if other._is_nothing() else other
        with np.errstate(all="ignore"):
            return _made(self.value + other.value, self.error + other.error)

    def __truediv__(self, other: Any) -> Bounded:
        other = lifted(other)
        with np.errstate(all="ignore"):
            value = self.value / other.value
            least = np.abs(other.value) * (1 - 2.0**-40) - other.error
            error = (self.error + _times(other.error, value)) / np.where(least > 0, least, np.nan)
            if self._is_nothing() and np.all(least > 0):
                return Bounded(0.0)
            return _made(value, error)

    def __pow__(self, power: int) -> Bounded:
        return prod([self] * power, start=lifted(1.0))

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self.error)

    def __sub__(self, other: Any) -> Bounded:
        return self + -lifted(other)

    def __rsub__(self, other: Any) -> Bounded:
        return -self + other

    def __rtruediv__(self, other: Any) -> Bounded:
        return lifted(other) / self

    __rmul__ = __mul__
    __radd__ = __add__


def lifted(number: Any) -> Bounded:
    """The number as :class:`Bounded`, exact when it has no bound yet."""
    return number if isinstance(number, Bounded) else Bounded(number)


def _times(error: Any, value: Any) -> Any:
    """error · |value|, 0 where the error is 0 whatever the value."""
    return np.where(error == 0, 0.0, error * np.abs(value))


def _made(value: Any, error: Any, roundings: float = 1) -> Bounded:
    """What one operation gives: its rounding joins the bound; no number becomes 'nothing known'."""
    unit = roundings * (_COMPLEX if np.iscomplexobj(value) else 1) * _UNIT
    total = (error + unit * np.abs(value)) * _OWN + _TINY
    return Bounded(value, np.where(np.isfinite(value) & ~np.isnan(total), total, np.inf))


def _function(
    function: Callable[[Any], Any], spread: Callable[[Any, Any, Any], Any]
) -> Callable[[Any], Bounded]:
    """An elementary function; ``spread`` bounds what an error of the argument does to the value."""

    def bounded(argument: Any) -> Bounded:
        argument = lifted(argument)
        with np.errstate(all="ignore"):
            value = function(argument.value)
            error = spread(argument.value, value, argument.error)
            return _made(value, np.where(argument.error == 0, 0.0, error), _FUNCTION)

    return bounded


def _spread_of_sqrt(z: Any, root: Any, error: Any) -> Any:
    # |√(z + δ) − √z| ≤ |δ|/|√z| for |δ| ≤ |z|/2, by the mean value |z|/2 ≤ |z + tδ|.
    return np.where(2 * error <= np.abs(z), error / np.abs(root), np.inf)


def _spread_of_exp(z: Any, power: Any, error: Any) -> Any:
    return np.abs(power) * np.expm1(error)


def _spread_of_circular(z: Any, value: Any, error: Any) -> Any:
    # |sin′|, |cos′| ≤ cosh Im z; the rounding, too, is relative to that.
    return np.cosh(np.abs(np.imag(z)) + error) * error


class BoundedRing(FloatRing):
    """The ring of :class:`Bounded` numbers: what an expansion loses to rounding is in its result.

    >>> from asymptotics import expand
    >>> from asymptotics.problems.string import string_problem
    >>> omegas = Bounded(np.array([2.2, 3.1415926]))
    >>> cot = lambda j: bounded().cos(j * omegas) / bounded().sin(j * omegas)
    >>> xi = expand(string_problem(BoundedRing(), omegas, cot), 4).contact(4)[4]
    >>> [float(f"{lost:.0e}") for lost in xi.error / abs(xi.value)]    # near π half the digits
    [6e-14, 4e-08]
    """

    zero: Any = Bounded(0.0)
    one: Any = Bounded(1.0)

    def rational(self, numerator: int, denominator: int = 1) -> Bounded:
        """numerator/denominator, rounded once."""
        return lifted(float(numerator)) / denominator

    def sum(self, terms: Iterable[Any]) -> Bounded:
        """Σ terms, left to right."""
        total = self.zero
        for term in terms:
            total = total + term
        return total

    def is_zero(self, element: Any) -> bool:
        """Whether it is known to be zero, without error, everywhere."""
        element = lifted(element)
        return not (np.any(element.value) or np.any(element.error))


@remembering
def bounded() -> Numbers:
    """The arithmetic of :class:`Bounded` numbers, for problems that take one."""
    sqrt = _function(np.sqrt, _spread_of_sqrt)
    exp = _function(np.exp, _spread_of_exp)
    sin, cos = (_function(f, _spread_of_circular) for f in (np.sin, np.cos))
    return Numbers(BoundedRing(), lifted, sqrt, exp, sin, cos, None)
