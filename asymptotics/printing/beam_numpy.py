r"""The beam's closed forms as a NumPy module.

Written from the polynomials of :mod:`asymptotics.formulas.beam`, so that they hold for every β and
Ω. The driven end enters through the impedances alone, which the module computes with scaled
exponentials.

**Rounding.** In the boundary layer at the contact point every derivative is p ≈ σ ≈ 1/√β times the
one before, so that with the impedances themselves terms of size β^{−n/2} cancel at order n. The
module uses what is left of them,

    y₂₁ = Y₂₁ − σ,  y₂₀ = Y₂₀ + σ y₂₁,  y₃ᵢ = Y₃ᵢ − σ Y₂ᵢ,  s₃ = S₃ − σ S₂,  excess = b − σ²,

substituted exactly before the code is written, and computed from p − σ = (k² + excess)/(p + σ): the
leading terms have cancelled before anything is rounded. What is left of the cancellation costs
p^{n−1} of a harmonic's digits at order n: its relative error was at most 5 p^{n−1} 2⁻⁵³ against 200
digits, orders 1 to 5, 10⁻³⁰ ≤ β ≤ 10⁻², and 8 are allowed for. ``contact`` and ``shape`` have no
result where that takes half the digits of ξ_c.
"""

from __future__ import annotations

from typing import Any

from flint import fmpq_mpoly

from asymptotics.expansion.order_loop import Expansion
from asymptotics.formulas.beam import ENTRIES, SOURCES, contact_amplitude
from asymptotics.formulas.polynomials import brackets
from asymptotics.printing.numpy_code import emitted_source, functions_of, titled, with_definitions
from asymptotics.printing.polynomials import assignment, indented
from asymptotics.problems.beam import check_beam


def beam_numpy(expansion: Expansion[Any], driven_end: str = "pinned") -> str:
    """The source of a module with ``contact`` and ``shape`` of the beam; it needs NumPy only.

    Parameters
    ----------
    expansion
        From :func:`asymptotics.formulas.beam.expand_symbolic`.
    driven_end
        ``pinned`` or ``clamped``.

    Raises
    ------
    InputError
        Another kind of expansion, or an unknown driven end.

    Examples
    --------
    >>> from asymptotics.formulas.beam import expand_symbolic
    >>> namespace = {}
    >>> exec(beam_numpy(expand_symbolic(3)), namespace)
    >>> round(float(namespace["contact"](0.0, 2.2, 0.02, 0.01)), 8)
    1.13039172
    >>> round(float(namespace["shape"](0.0, 0.0, 2.2, 0.02, 0.01)), 12)
    1.02
    """
    check_beam(1.0, driven_end)
    N = expansion.order
    places = [(n, j) for n in range(1, N + 1) for j in sorted(expansion.contact(n))]
    polynomials = {place: contact_amplitude(expansion, *place) for place in places}
    shifts = _shifts(expansion.problem.ring)
    amplitudes = {place: c.compose(*shifts) for place, c in polynomials.items()}
    data = _contact_data(expansion, shifts)
    written = [*amplitudes.values(), *(c for pair in data.values() for c in pair)]
    used = {name for c in written for _, b in brackets(c, SOURCES) for _, f in b for name, _ in f}
    lines = []
    for j in range(N + 1):
        names = [f"Y{j}_{entry}" for entry in ENTRIES]
        if not used & set(names):
            continue
        y20, y21, y30, y31 = map(_python_name, names)
        rate = "0.0 * omega" if j == 0 else "omega" if j == 1 else f"{j} * omega"
        lines += [
            f"w{j} = _waves({rate}, beta, length)",
            f"Y20, {y30} = _derivatives(w{j}, 1.0, 0.0, 0.0, sigma, excess)",
            f"Y21, {y31} = _derivatives(w{j}, 0.0, 1.0, 0.0, sigma, excess)",
            f"{y21} = Y21 - sigma",
            f"{y20} = Y20 + sigma * {y21}",
        ]
    body = [
        "y = _stretch(beta)",
        "length, a3, excess = 2.0 * np.sqrt(beta) * y, _third(y, beta), _excess(y, beta)",
        "a3 = np.where(_regular(omega, beta, length) & np.isfinite(a3**ORDER), a3, np.nan)",
        "sigma = -2.0 / (beta * a3)",
        *(["B = omega * omega / beta"] if "B" in used else []),
        "S2, s3 = _derivatives(_waves(omega, beta, length), 0.0, 0.0, 1.0, sigma, excess)",
        *lines,
    ]
    for (n, j), c in amplitudes.items():
        body += assignment(f"h{n}_{j}", c, SOURCES, symbol=_python_name)
    for (n, j), pair in data.items():
        for name, c in zip("uv", pair, strict=True):
            body += assignment(f"{name}{n}_{j}", c, SOURCES, symbol=_python_name)
    body += ["contact = {", *(f"    ({n}, {j}): h{n}_{j} / a3**{n}," for n, j in places), "}"]
    body += ["data = {"]
    body += [f"    ({n}, {j}): (u{n}_{j} / a3**{n - 1}, v{n}_{j} / a3**{n - 1})," for n, j in data]
    body += ["}", "return contact, data"]
    source = emitted_source("beam")
    clamped = functions_of(emitted_source("beam_clamped")) if driven_end == "clamped" else {}
    source = with_definitions(source, {"_amplitudes": indented(body)}, {"ORDER": N}, clamped)
    return titled(
        source.replace("pinned driven end", f"{driven_end} driven end", 1), N, "beam_numpy"
    )


def _contact_data(
    expansion: Expansion[Any], shifts: list[fmpq_mpoly]
) -> dict[tuple[int, int], tuple[fmpq_mpoly, fmpq_mpoly]]:
    """Value and slope of each harmonic of w at ξ₀, as amplitudes of cos jθ."""
    data = {}
    for n in range(1, expansion.order + 1):
        for j, (value, slope, *_) in sorted(expansion.shape(n).items()):
            pair = (value, slope) if j == 0 else (value + value, slope + slope)
            data[n, j] = (pair[0].compose(*shifts), pair[1].compose(*shifts))
    return data


def _shifts(ring: Any) -> list[fmpq_mpoly]:
    """The image of each generator: the substitution of the module's docstring."""
    sigma, images = ring["sigma"], {name: ring[name] for name in ring.names}
    images["b"] = ring["b"] + sigma * sigma
    images["S3"] = ring["S3"] + sigma * ring["S2"]
    for j in range(sum(name.endswith("_20") for name in ring.names)):
        y20, y21, y30, y31 = (ring[f"Y{j}_{entry}"] for entry in ENTRIES)
        value, slope = y20 - sigma * y21, y21 + sigma
        images |= {f"Y{j}_20": value, f"Y{j}_21": slope}
        images |= {f"Y{j}_30": y30 + sigma * value, f"Y{j}_31": y31 + sigma * slope}
    return list(images.values())


def _python_name(name: str) -> str:
    """The variable that holds what the substitution leaves of a generator."""
    return {"b": "excess", "S3": "s3"}.get(name, name.replace("Y", "y"))
