"""Exact asymptotics of a moving contact: SymPy outside, python-flint inside.

>>> from asymptotics import exact_string, expand, prove
>>> solution = expand(exact_string(), order=3)
>>> [proof.holds for proof in prove(solution)]
[True, True, True, True]
"""

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
