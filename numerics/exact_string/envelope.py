r"""The boundary of the exact string's periodic states: break-ups of many rotation numbers.

Every irrational ν has its own end (Ω(ν), ε_c(ν)). Between two neighbours of a Farey sequence, p/q
and p′/q′ with p′q − pq′ = 1, the two noble numbers

.. math:: \frac{p + γ p'}{q + γ q'}, \quad \frac{γ p + p'}{γ q + q'}, \qquad γ = (1+\sqrt 5)/2,

have the most robust circles (R. S. MacKay & J. Stark, Nonlinearity 5 (1992) 867). All of them with
q + q′ up to a limit are taken: the larger it is, the more of the dips at Ω ≈ πp/q are resolved.
"""

from __future__ import annotations

import math
from typing import Any

from numerics.errors import InputError, NumericsError
from numerics.exact_string.break_up import BreakUp, break_up
from numerics.exact_string.rotation import GOLDEN, Noble, noble

LARGEST = 60
"""Sum of denominators: some two thousand numbers between two integers."""

_UNCERTAIN = 1e-13


def nobles_between(low: float, high: float, denominators: int) -> list[Noble]:
    """The noble numbers of the text between low and high, increasing.

    Parameters
    ----------
    low, high
        0 ≤ low < high ≤ 20: rotation numbers.
    denominators
        The largest q + q′, 2 … 60.

    Raises
    ------
    InputError
        Other numbers.

    Examples
    --------
    >>> [round(one.value, 4) for one in nobles_between(0, 1, 3)]
    [0.2764, 0.382, 0.618, 0.7236]
    """
    if not (math.isfinite(low) and math.isfinite(high) and 0 <= low < high <= 20):
        raise InputError(f"rotation numbers from {low!r} to {high!r}; give 0 ≤ low < high ≤ 20")
    if not isinstance(denominators, int) or not 2 <= denominators <= LARGEST:
        raise InputError(f"denominators = {denominators!r}; give a whole number, 2 to {LARGEST}")
    found: set[float] = set()
    waiting = [((n, 1), (n + 1, 1)) for n in range(math.floor(low), math.ceil(high))]
    while waiting:
        (p, q), (r, s) = waiting.pop()
        if q + s > denominators:
            continue
        for one, other in ((1.0, GOLDEN), (GOLDEN, 1.0)):
            value = (one * p + other * r) / (one * q + other * s)
            if low <= value <= high:
                found.add(value)
        middle = (p + r, q + s)
        waiting += [((p, q), middle), (middle, (r, s))]
    return [noble(value, _UNCERTAIN * value) for value in _apart(sorted(found))]


def _apart(values: list[float]) -> list[float]:
    """Without those that rounding alone makes others: a noble number has several Farey pairs."""
    kept: list[float] = []
    for value in values:
        if not kept or value > kept[-1] * (1 + 10 * _UNCERTAIN):
            kept.append(value)
    return kept


def end_of(task: dict[str, Any]) -> dict[str, Any]:
    """One point of the boundary, as a sweep asks for it: the quotients ``head`` of ν.

    ``reason`` says why there is none.

    >>> found = end_of({"head": [0]})
    >>> round(found["K"], 6), round(found["omega"], 5), found["reason"]
    (0.971635, 1.93879, None)
    """
    rotation = Noble(tuple(task["head"]))
    row: dict[str, Any] = {"rotation": rotation.value, "head": list(rotation.head), "reason": None}
    try:
        found = break_up(rotation)
    except NumericsError as error:
        return {**row, "reason": str(error)}
    return {**row, **numbers_of(found)}


def numbers_of(found: BreakUp) -> dict[str, Any]:
    """K, Ω and ε with their errors, by the names that files and commands give them."""
    return {
        "K": found.strength,
        "omega": found.omega,
        "epsilon": found.epsilon,
        "error": found.strength_error,
        "omega_error": found.omega_error,
        "epsilon_error": found.epsilon_error,
        "K_by_norms": found.by_norms,
    }
