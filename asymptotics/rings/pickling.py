"""Copies and pickles: python-flint's numbers by their exact data, problems by how they were made.

python-flint's polynomials and balls do not pickle. Here :mod:`copyreg` learns how, so that whatever
holds them (expansions, frames, closed forms) pickles and deep-copies without code of its own.
"""

from __future__ import annotations

import copyreg
import sys
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from flint import (
    Ordering,
    acb,
    arb,
    ctx,
    fmpq,
    fmpq_mpoly,
    fmpq_mpoly_ctx,
    fmpq_poly,
    fmpz,
    fmpz_mpoly,
    fmpz_mpoly_ctx,
    fmpz_poly,
)

from asymptotics.rings.precision import at_precision

P = ParamSpec("P")
T = TypeVar("T")

_RADIUS_BITS = 30
"""FLINT's radii are m 2^e with 2²⁹ ≤ m < 2³⁰."""


class Remembered:
    """What pickles as the call that made it, where ``origin`` holds one."""

    origin: tuple[Any, ...] | None = None

    def __reduce_ex__(self, protocol: Any) -> Any:
        if self.origin is None:
            return super().__reduce_ex__(protocol)
        return remade, self.origin


def remembering(constructor: Callable[P, T]) -> Callable[P, T]:
    """Let what a module's function returns be pickled as the call that made it.

    The object is a :class:`Remembered`. A changed copy (:func:`dataclasses.replace`) has no origin:
    it is no longer what the call makes.
    """

    @wraps(constructor)
    def made(*args: P.args, **kwargs: P.kwargs) -> T:
        result = constructor(*args, **kwargs)
        object.__setattr__(result, "origin", (made, args, kwargs, _precisions()))
        return result

    return made


def remade(
    constructor: Callable[..., T], args: Any, kwargs: Any, precisions: tuple[int, int | None]
) -> T:
    """The call again, at the precisions it was made in: problems hold balls or mpmath's numbers."""
    bits, digits = precisions
    with at_precision(bits):
        if digits is None:
            return constructor(*args, **kwargs)
        import mpmath

        with mpmath.workprec(digits):
            return constructor(*args, **kwargs)


def _precisions() -> tuple[int, int | None]:
    """FLINT's and, where anybody has imported it, mpmath's."""
    mpmath = sys.modules.get("mpmath")
    return ctx.prec, None if mpmath is None else mpmath.mp.prec


def register() -> None:
    """Teach :mod:`copyreg` the types of python-flint that cannot pickle themselves."""
    copyreg.pickle(arb, _reduce_arb)
    copyreg.pickle(acb, lambda ball: (acb, (ball.real, ball.imag)))
    copyreg.pickle(fmpz_poly, lambda poly: (fmpz_poly, (list(poly.coeffs()),)))
    copyreg.pickle(fmpq_poly, lambda poly: (fmpq_poly, (list(poly.coeffs()),)))
    for polynomial, context in ((fmpz_mpoly, fmpz_mpoly_ctx), (fmpq_mpoly, fmpq_mpoly_ctx)):
        copyreg.pickle(polynomial, _reduce_polynomial)
        copyreg.pickle(context, _reduce_context)


def _reduce_context(context: Any) -> tuple[Any, ...]:
    return _context, (type(context), tuple(context.names()), context.ordering().name)


def _context(kind: Any, names: tuple[str, ...], ordering: str) -> Any:
    return kind.get(list(names), Ordering[ordering])


def _reduce_polynomial(polynomial: Any) -> tuple[Any, ...]:
    terms = {tuple(map(int, powers)): c for powers, c in polynomial.terms()}
    return _polynomial, (polynomial.context(), terms)


def _polynomial(context: Any, terms: dict[tuple[int, ...], fmpz | fmpq]) -> Any:
    return context.from_dict(terms)


def _reduce_arb(ball: arb) -> tuple[Any, ...]:
    if not ball.is_finite():
        return arb, (str(ball),)
    return _ball, (*ball.mid().man_exp(), *ball.rad().man_exp())


def _ball(mantissa: fmpz, exponent: fmpz, radius: fmpz, scale: fmpz) -> arb:
    centre = arb((mantissa, exponent))
    if radius == 0:
        return centre
    # FLINT reads a radius by cutting it to 30 bits and adding one unit to the last: so one half a
    # unit below comes back exactly.
    shift = _RADIUS_BITS - int(radius).bit_length()
    unit = fmpz(int(radius) << shift)
    return arb(centre, arb((2 * unit - 1, scale - shift - 1)))
