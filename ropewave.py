"""The face of ropewave: ``import ropewave as rw``.

>>> import ropewave as rw
>>> series = rw.expand(rw.string(foundation=1.7), 2, at={rw.Omega: 2.2})
>>> round(2 * series.contact(1)[1], 12)
0.890012519029
>>> [proof.holds for proof in rw.prove(series)]
[True, True, True]

Each name is imported from its home when it is first asked for, so that this module costs nothing.
:data:`HOMES` says where a name lives, and with it where its source is to be read.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_ALGEBRA = {
    "derivation": "Derivation derive",
    "expansion.order_loop": "Expansion expand",
    "expansion.moving_frame": "MovingFrame moving_frame",
    "expansion.proof": "prove",
    "expansion.storage": "saved_expansion",
    "formulas.closed_form": "ClosedForm ClosedForms",
    "formulas.rope": "RopeForms rope_forms",
    "paper.check": "compare",
    "paper.printed": "printed",
    "printing.javascript": "javascript_module",
    "printing.latex": "contact_equation formula_sets profile_equation shape_equation",
    "printing.numpy_code": "numpy_module",
    "printing.rope_latex": "rope_latex",
    "printing.rope_modules": "rope_javascript rope_numpy",
    "problems.beam": "float_beam",
    "problems.beam_spectrum": "linear_frequencies linear_spectrum",
    "problems.damped": "damped_string",
    "problems.forcing": "forced_string fourier_drive",
    "problems.free_frequencies": "FreeFrequencies free_frequencies",
    "problems.moving_contact": "MovingContact moving_contact",
    "problems.presets": "beam string",
    "problems.problem": "Problem",
    "problems.string": "exact_string float_string",
    "problems.rope": "Rope",
    "problems.static_shape": "static_shape",
    "problems.symbols": "Omega W epsilon tau xi",
    "problems.written": "read_problem",
    "resonances.folds": "Fold fold",
    "resonances.normal_form": "NormalForm normal_form",
    "resonances.parametric_tongue": "ParametricTongue parametric_tongue",
    "resonances.rope_fold": "RopeFold rope_fold",
    "resonances.rationals": "nonlinear_resonances stiff_limit weak_bending",
    "resonances.tongues": "Tongue tongue",
    "rings.precision": "at_precision",
    "values.certified": "contact_certified evaluate_certified",
    "values.evaluate": "evaluate",
    "values.lindstedt": "lindstedt",
    "values.linear_response": "contact_response",
    "values.response": "response",
    "values.rope": "evaluate_rope",
    "values.series_analysis": "analyse_series",
}

_NUMERICS = {
    "events.study": "study",
    "events.waves": "track_waves",
    "exact_string.characteristics": "exact_string_motion",
    "exact_string.break_up": "break_up",
    "exact_string.envelope": "nobles_between",
    "exact_string.greene": "periodic_orbit",
    "exact_string.invariant_circle": "circle_at_rotation invariant_circle",
    "exact_string.rotation": "Noble noble",
    "files.checkpoint": "resume save_checkpoint",
    "periodic.branches": "doubled_state follow switched",
    "periodic.linear_rope": "LinearRope",
    "periodic.loci": "locus",
    "periodic.loss": "loss",
    "periodic.stability": "multipliers stability",
    "periodic.states": "PeriodicState periodic_state",
    "problems.drive": "cosine ramped_cosine",
    "problems.along": "table",
    "problems.problem": "RopeProblem",
    "problems.sampled": "read_samples sampled",
    "simulation.contact": "Simulator",
    "simulation.run": "Run simulate",
    "sweeps.sweep": "sweep",
    "thresholds.from_state": "departure",
    "thresholds.threshold": "threshold",
}

HOMES: dict[str, str] = {
    name: f"{package}.{module}"
    for package, rooms in (("asymptotics", _ALGEBRA), ("numerics", _NUMERICS))
    for module, names in rooms.items()
    for name in names.split()
}
"""Name ↦ the module that it comes from."""

__all__ = sorted([*HOMES, "HOMES", "__version__"])


def __getattr__(name: str) -> Any:
    """The public name, from its home."""
    if name == "__version__":
        from importlib.metadata import version

        return version("ropewave")
    if name not in HOMES:
        raise AttributeError(f"ropewave has no {name!r}; there are {', '.join(__all__)}")
    value = getattr(import_module(HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
