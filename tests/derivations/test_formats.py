"""One derivation in every format: what they share is computed once."""

from __future__ import annotations

from asymptotics import ClosedForms, Expansion, prove
from asymptotics.formulas.normal_form import _cotangent_form
from derivations.reports.formats import FORMATS, render


def test_cotangent_forms_are_computed_once_for_all_formats(sixth: Expansion) -> None:
    forms, proofs = ClosedForms(sixth), prove(sixth)
    _cotangent_form.cache_clear()
    first = {name: render(forms, proofs, name) for name in FORMATS}
    known = _cotangent_form.cache_info()
    assert known.misses == known.currsize > 50
    assert known.hits > 2 * known.misses
    again = {name: render(ClosedForms(sixth), proofs, name) for name in FORMATS}
    assert again == first
    assert _cotangent_form.cache_info().misses == known.misses
