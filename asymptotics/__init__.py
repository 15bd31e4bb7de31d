"""Exact asymptotics of a moving contact: SymPy outside, python-flint inside.

===============  =================================================================================
``rings``        what a coefficient is: exact in Ω, doubles, digits, balls, Laurent series
``problems``     what is expanded: string, beam, damping, drives; static shapes and spectra
``expansion``    the order loop, the frame of the contact point, the proof, storage
``formulas``     ring elements as formulas: normal forms, the zero test
``printing``     formulas as text, LaTeX, NumPy, JavaScript and JSON
``values``       numbers from an expansion, certified or not; singularities of the series
``resonances``   p/q, tongues, folds, first touch
``paper``        the printed formulas, and the check that ours equal them
===============  =================================================================================

``derivation`` is the one verb over all of them. A room imports those above it, never those below
(import-linter holds it; of printing, values and resonances none imports another).

>>> from asymptotics import exact_string, expand, prove
>>> solution = expand(exact_string(), order=3)
>>> [proof.holds for proof in prove(solution)]
[True, True, True, True]
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asymptotics.expansion.moving_frame import MovingFrame, moving_frame
    from asymptotics.expansion.order_loop import Expansion, expand
    from asymptotics.expansion.proof import prove
    from asymptotics.formulas.closed_form import ClosedForm, ClosedForms
    from asymptotics.problems.string import exact_string, float_string, string_problem

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
    "string_problem",
]

_HOMES = {
    "ClosedForm": "formulas.closed_form",
    "ClosedForms": "formulas.closed_form",
    "Expansion": "expansion.order_loop",
    "MovingFrame": "expansion.moving_frame",
    "exact_string": "problems.string",
    "expand": "expansion.order_loop",
    "float_string": "problems.string",
    "moving_frame": "expansion.moving_frame",
    "prove": "expansion.proof",
    "string_problem": "problems.string",
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
