"""One derivation, written out: text, LaTeX, NumPy, JavaScript, JSON."""

from __future__ import annotations

from pathlib import Path

from asymptotics.errors import InputError
from asymptotics.expansion.certificates import Proof
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.formulas.rope import RopeForms
from asymptotics.printing.written_out import as_json, as_text
from derivations.files import write_file
from derivations.output import json_text

FORMATS = ("text", "latex", "numpy", "javascript", "json")
LAST_PAGE = 12
"""The highest order whose formulas are pages to look at: 150 of them in two columns, and 2.6 times
as many with every second order. Beyond, text and LaTeX are written only when asked for by name."""


def render(
    forms: ClosedForms | RopeForms, proofs: Proof, format: str, column: str = "two"
) -> dict[str, str]:
    """File name → content of one format; the string's LaTeX has several files, the others one.

    Examples
    --------
    >>> from asymptotics import exact_string, expand, prove
    >>> solution = expand(exact_string(), 2)
    >>> list(render(ClosedForms(solution), prove(solution), "text"))
    ['string-order2.txt']
    """
    name = "rope" if isinstance(forms, RopeForms) else forms.expansion.problem.name
    stem = f"{name}-order{forms.order}"
    if format == "text":
        return {f"{stem}.txt": as_text(forms, proofs)}
    if format == "json":
        return {f"{stem}.json": json_text(as_json(forms, proofs), indent=1) + "\n"}
    if format == "numpy":
        return {f"{stem.replace('-', '_')}.py": _numpy(forms)}
    if format == "javascript":
        return {f"{stem.replace('-', '_')}.mjs": _javascript(forms)}
    if format == "latex":
        return _latex(forms, stem, column)
    raise InputError(f"format = {format!r}; choose one of {', '.join(FORMATS)}")


def _numpy(forms: ClosedForms | RopeForms) -> str:
    if isinstance(forms, RopeForms):
        from asymptotics.printing.rope_modules import rope_numpy

        return rope_numpy(forms)
    from asymptotics.printing.numpy_code import numpy_module

    return numpy_module(forms)


def _javascript(forms: ClosedForms | RopeForms) -> str:
    if isinstance(forms, RopeForms):
        from asymptotics.printing.rope_modules import rope_javascript

        return rope_javascript(forms)
    from asymptotics.printing.javascript import javascript_module

    return javascript_module(forms)


def _latex(forms: ClosedForms | RopeForms, stem: str, column: str) -> dict[str, str]:
    if isinstance(forms, RopeForms):
        from asymptotics.printing.rope_latex import rope_document, rope_latex

        fragment = f"{stem}.tex"
        return {
            fragment: rope_latex(forms, column=column),
            f"{stem}-page.tex": rope_document(forms, fragment, column),
        }
    from asymptotics.printing.latex import formula_sets

    return formula_sets(forms, column)


def write_files(files: dict[str, str], folder: Path) -> list[Path]:
    """Write each file whole or not at all; the folder is made when missing."""
    paths = []
    for name, content in files.items():
        path = folder / name
        write_file(path, content.encode())
        paths.append(path)
    return paths
