"""A derivation and its proof as one text, and as one JSON object; of the string and of any rope."""

from __future__ import annotations

from typing import Any

from flint import fmpq_mpoly

from asymptotics.expansion.certificates import Proof
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.formulas.rope import RopeForms
from asymptotics.printing.text import contact_text, profile_text, shape_text


def as_text(forms: ClosedForms | RopeForms, proofs: Proof) -> str:
    """F_0 … F_N and ξ_c, or ξ_{n,j} and u_{n,j} of any rope, in text that SymPy parses.

    Examples
    --------
    >>> from asymptotics.formulas.rope import rope_forms
    >>> from asymptotics.problems.presets import string
    >>> forms = rope_forms(string(foundation=1.7), 2)
    >>> print(as_text(forms, forms.prove()).splitlines()[-1])
    u_2_2_0 = 1/4*S1_1**2
    """
    if isinstance(forms, RopeForms):
        return _rope_text(forms, proofs)
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


def as_json(forms: ClosedForms | RopeForms, proofs: Proof) -> dict[str, Any]:
    """The derivation as one JSON object; every formula is a string that SymPy parses."""
    if isinstance(forms, RopeForms):
        return _rope_json(forms, proofs)
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


def _polynomial(element: fmpq_mpoly) -> str:
    return str(element).replace("^", "**")


def _conventions(forms: RopeForms) -> dict[str, str]:
    m = forms.generators.contact_order
    wave = "cos(j*Omega*tau)" if forms.generators.even else "exp(I*j*Omega*tau), its real part"
    conventions = {
        "contact": f"x_c/x0 = xi_0 + sum over n, j of (epsilon/a_{m})**n * xi_n_j * {wave}",
        "shape": f"w/Z0 = W_0 + sum over j of epsilon * Lambda_j * {wave} + sum over n > 1, j, i "
        f"of a_{m} * (epsilon/a_{m})**n * u_n_j_i * Phi_j_i * {wave}",
        "alpha{d}": f"a_d/a_{m}, a_d the derivative d in xi of the static shape W_0 at xi_0",
        "S{j}_{d}": "derivative d at xi_0 of Lambda_j: driven with harmonic j of the drive, no "
        "contact data",
        "Y{j}_{d}_{i}": f"derivative d at xi_0 of Phi_j_i: driven end at rest, contact data "
        f"delta_ki, k <= {m - 2}",
    }
    return conventions | ({} if forms.generators.even else {"..._": "complex conjugate"})


def _formulas(forms: RopeForms) -> tuple[dict[str, str], dict[str, str]]:
    contact = {f"xi_{n}_{j}": _polynomial(forms.contact(n, j)) for n, j in forms.places()}
    shape = {
        f"u_{n}_{j}_{i}": _polynomial(u)
        for n, j in forms.shapes()
        for i, u in enumerate(forms.data(n, j))
    }
    return contact, shape


def _rope_text(forms: RopeForms, proofs: Proof) -> str:
    contact, shape = _formulas(forms)
    return "\n".join(
        [
            f"{forms.rope}",
            f"through order {forms.order} in epsilon.",
            "",
            *(f"  {name}: {text}" for name, text in _conventions(forms).items()),
            "",
            f"Proved {proofs.relative_to}.",
            "",
            *(f"  {proof}" for proof in proofs),
            "",
            *(f"{name} = {text}" for name, text in (contact | shape).items()),
            "",
        ]
    )


def _rope_json(forms: RopeForms, proofs: Proof) -> dict[str, Any]:
    contact, shape = _formulas(forms)
    return {
        "command": "derive",
        "problem": str(forms.rope),
        "parameters": list(forms.rope.parameters),
        "order": forms.order,
        "contact_order": forms.generators.contact_order,
        "even": forms.generators.even,
        "conventions": _conventions(forms),
        "generators": [generator.name for generator in forms.generators.listed()],
        "contact": contact,
        "shape": shape,
        "proofs": [str(proof) for proof in proofs],
        "proved_relative_to": proofs.relative_to,
    }
