"""Exact asymptotics of a moving contact: SymPy outside, python-flint inside.

>>> from asymptotics import exact_string, expand, prove
>>> solution = expand(exact_string(), order=3)
>>> [proof.holds for proof in prove(solution)]
[True, True, True, True]
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asymptotics.closed_form import ClosedForm, ClosedForms
    from asymptotics.expansion import Expansion, expand
    from asymptotics.problem import exact_string, float_string, string
    from asymptotics.profile import MovingFrame, moving_frame
    from asymptotics.proof import prove

DISTRIBUTION = "ropewave"
"""Tells this package from another distribution's package of the same name."""

__all__ = [
    "ClosedForm",
    "ClosedForms",
    "Expansion",
    "MovingFrame",
    "exact_string",
    "expand",
    "float_string",
    "moving_frame",
    "prove",
    "string",
]

_HOMES = {
    "ClosedForm": "closed_form",
    "ClosedForms": "closed_form",
    "Expansion": "expansion",
    "MovingFrame": "profile",
    "exact_string": "problem",
    "expand": "expansion",
    "float_string": "problem",
    "moving_frame": "profile",
    "prove": "proof",
    "string": "problem",
}


def __getattr__(name: str) -> Any:
    """Import when asked for: the errors, which every program imports, must not cost the algebra."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
