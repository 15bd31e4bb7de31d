r"""The beam's closed forms as a NumPy module.

Written from the polynomials of :mod:`asymptotics.beam_symbolic`, so that they hold for every β and
Ω. The driven end enters through the impedances alone, which the module computes with scaled
exponentials.

**Rounding.** In the boundary layer at the contact point every derivative is p ≈ σ ≈ 1/√β times the
one before, so that with the impedances themselves terms of size β^{−n/2} cancel at order n. The
module uses what is left of them,

    y₂₁ = Y₂₁ − σ,  y₂₀ = Y₂₀ + σ y₂₁,  y₃ᵢ = Y₃ᵢ − σ Y₂ᵢ,  s₃ = S₃ − σ S₂,  excess = b − σ²,

substituted exactly before the code is written, and computed from p − σ = (k² + excess)/(p + σ): the
leading terms have cancelled before anything is rounded, and an error of p ulp remains.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.resources import files
from math import lcm
from typing import Any

from flint import fmpq_mpoly

from asymptotics.beam import check_beam
from asymptotics.beam_symbolic import ENTRIES, brackets, contact_amplitude
from asymptotics.expansion import Expansion

_WIDTH = 96


def beam_numpy(expansion: Expansion[Any], driven_end: str = "pinned") -> str:
    """The source of a module with ``contact`` and ``shape`` of the beam; it needs NumPy only.

    Parameters
    ----------
    expansion
        From :func:`asymptotics.beam_symbolic.expand_symbolic`.
    driven_end
        ``pinned`` or ``clamped``.

    Raises
    ------
    InputError
        Another kind of expansion, or an unknown driven end.

    Examples
    --------
    >>> from asymptotics.beam_symbolic import expand_symbolic
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
    used = {name for c in written for _, _, b in brackets(c) for _, f in b for name in f}
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
    parts = {
        "END": driven_end,
        "ORDER": str(N),
        "CONSTANTS": _indented(["B = omega * omega / beta"] if "B" in used else []),
        "IMPEDANCES": _indented(lines),
        "AMPLITUDES": _indented(
            [
                *(x for (n, j), c in amplitudes.items() for x in _assignment(f"h{n}_{j}", c)),
                *(
                    line
                    for (n, j), pair in data.items()
                    for name, c in zip("uv", pair, strict=True)
                    for line in _assignment(f"{name}{n}_{j}", c)
                ),
            ]
        ),
        "DATA": "\n".join(
            f"        ({n}, {j}): (u{n}_{j} / a3**{n - 1}, v{n}_{j} / a3**{n - 1}),"
            for n, j in data
        ),
        "RESULT": "\n".join(f"        ({n}, {j}): h{n}_{j} / a3**{n}," for n, j in places),
        "STATIC": _source(driven_end).rstrip(),
    }
    text = _source("template")
    for key, value in parts.items():
        text = text.replace(f"@{key}@\n" if not value else f"@{key}@", value)
    return text


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


def _source(name: str) -> str:
    """Fixed source text: the module's template, or what one driven end puts into it."""
    return (files("asymptotics") / f"beam_numpy_{name}.txt").read_text(encoding="utf-8")


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


def _indented(lines: Iterable[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)


def _assignment(name: str, element: fmpq_mpoly) -> list[str]:
    """``name = …`` as a sum of S2**k * S3**l * (bracket) / denominator, a statement a bracket."""
    lines: list[str] = [] if not element.is_zero() else [f"{name} = 0.0"]
    for k, m, bracket in brackets(element):
        below = lcm(*(value.denominator for value, _ in bracket))
        terms = []
        for value, names in bracket:
            factors = [_python_name(name) for name in names]
            size = abs(int(value * below))
            if size != 1 or not factors:
                factors.insert(0, f"{size}.0")
            terms.append(("- " if value < 0 else "+ ") + " * ".join(factors))
        terms[0] = terms[0].removeprefix("+ ").replace("- ", "-", 1)
        outside = [f"{s}**{a}" if a > 1 else s for s, a in (("S2", k), ("s3", m)) if a]
        factor = " * ".join(outside) + (f" / {below}" if below > 1 else "")
        head = f"{name} = {name} + " if lines else f"{name} = "
        lines += _wrapped(f"{head}{factor} * (", terms)
    return lines


def _wrapped(head: str, terms: list[str]) -> list[str]:
    """``head`` terms ``)``, over as many lines as the width asks for."""
    line = head + " ".join(terms) + ")"
    if len(line) + 4 <= _WIDTH:
        return [line]
    lines, current = [head], ""
    for term in terms:
        if current and len(current) + len(term) + 9 > _WIDTH:
            lines.append(f"    {current}")
            current = ""
        current += f"{' ' if current else ''}{term}"
    return [*lines, f"    {current}", ")"]
