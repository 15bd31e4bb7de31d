"""One derivation, written out: text, LaTeX, NumPy, JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from asymptotics.errors import InputError
from asymptotics.expansion.certificates import Proof
from asymptotics.formulas.closed_form import ClosedForms
from derivations.files import write_file
from derivations.output import json_text

FORMATS = ("text", "latex", "numpy", "json")
LAST_PAGE = 12
"""The highest order whose formulas are pages to look at: 150 of them in two columns, and 2.6 times
as many with every second order. Beyond, text and LaTeX are written only when asked for by name."""


def render(forms: ClosedForms, proofs: Proof, format: str, column: str = "two") -> dict[str, str]:
    """File name → content of one format; LaTeX has several files, the others one.

    Examples
    --------
    >>> from asymptotics import exact_string, expand, prove
    >>> solution = expand(exact_string(), 2)
    >>> list(render(ClosedForms(solution), prove(solution), "text"))
    ['string-order2.txt']
    """
    stem = f"{forms.expansion.problem.name}-order{forms.order}"
    if format == "text":
        return {f"{stem}.txt": as_text(forms, proofs)}
    if format == "json":
        return {f"{stem}.json": json_text(as_json(forms, proofs), indent=1) + "\n"}
    if format == "numpy":
        from asymptotics.printing.numpy_code import numpy_module

        return {f"{stem.replace('-', '_')}.py": numpy_module(forms)}
    if format == "latex":
        from asymptotics.printing.latex import formula_sets

        return formula_sets(forms, column)
    raise InputError(f"format = {format!r}; choose one of {', '.join(FORMATS)}")


def as_text(forms: ClosedForms, proofs: Proof) -> str:
    """F_0 … F_N and ξ_c, each order with its proof, in text that SymPy parses."""
    from asymptotics.printing.text import contact_text, profile_text

    N = forms.order
    lines = [
        f"Rope with a moving contact, string limit (beta = 0), through order {N} in epsilon.",
        "",
        "  w/Z0  = sum over j of (epsilon/sin(Omega))**j * F_j(s, epsilon) * cos(j*Omega*tau)",
        "  x_c/x0 = 1 + sum over n, j of epsilon**n * xi_n_j(Omega) * cos(j*Omega*tau)",
        "  s = (x - x_c)/x0,  Omega = omega*x0/c,  tau = c*t/x0",
        "",
        f"Proved {proofs.relative_to}.",
        "",
    ]
    for j in range(N + 1):
        lines += [f"F_{j} = {profile_text(forms, j)}", f"  {proofs[j]}", ""]
    for n in range(1, N + 1):
        for j in sorted(forms.expansion.contact(n)):
            lines.append(f"xi_{n}_{j} = {contact_text(forms, n, j)}")
    return "\n".join(lines) + "\n"


def as_json(forms: ClosedForms, proofs: Proof) -> dict[str, Any]:
    """The derivation as one JSON object; every formula is a string that SymPy parses."""
    from asymptotics.printing.text import contact_text, profile_text, shape_text

    expansion = forms.expansion
    return {
        "command": "derive",
        "problem": expansion.problem.name,
        "order": forms.order,
        "style": forms.style,
        "conventions": {
            "contact": "x_c/x0 = 1 + sum_n epsilon**n sum_j contact[j]*cos(j*Omega*tau)",
            "shape": "w/Z0 = (xi - 1)**2 + sum_n epsilon**n sum_j shape[j]*cos(j*Omega*tau)",
            "profile": "w/Z0 = sum_j (epsilon/sin(Omega))**j*profile[j]*cos(j*Omega*tau)",
            "symbols": "Omega, epsilon, tau, xi = x/x0, s = (x - x_c)/x0",
        },
        "orders": [
            {
                "order": n,
                "contact": {
                    str(j): contact_text(forms, n, j) for j in sorted(expansion.contact(n))
                },
                "shape": {str(j): shape_text(forms, n, j) for j in sorted(expansion.shape(n))},
                "proved": proofs[n].holds,
            }
            for n in range(1, forms.order + 1)
        ],
        "profile": {str(j): profile_text(forms, j) for j in range(forms.order + 1)},
        "proofs": [str(proof) for proof in proofs],
        "proved_relative_to": proofs.relative_to,
    }


def write_files(files: dict[str, str], folder: Path) -> list[Path]:
    """Write each file whole or not at all; the folder is made when missing."""
    paths = []
    for name, content in files.items():
        path = folder / name
        write_file(path, content.encode())
        paths.append(path)
    return paths
