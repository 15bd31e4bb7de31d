"""The free frequencies of a reader's rope, written out."""

from __future__ import annotations

from typing import Any

import numpy as np

from asymptotics.problems.free_frequencies import FreeFrequencies
from asymptotics.problems.moving_contact import MovingContact


def as_json(rope: MovingContact, found: FreeFrequencies, order: int) -> dict[str, Any]:
    """Plain numbers and words."""
    return {
        "command": "resonances",
        "problem": str(rope),
        "parameters": dict(found.at),
        "static_contact": found.static_contact,
        "linear": [
            {"p": p, "omega": float(np.real(x)), "decay": float(np.imag(x)), "error": float(error)}
            for p, (x, error) in enumerate(zip(found.values, found.errors, strict=True), start=1)
        ],
        "nonlinear": [
            {"p": p, "q": q, "omega": omega} for p, q, omega in found.nonlinear(order) if q > 1
        ],
    }


def as_text(rope: MovingContact, found: FreeFrequencies, order: int) -> str:
    """A table of ω_p, and the Ω = ω_p/q where orders up to N have poles.

    >>> from asymptotics.problems.free_frequencies import free_frequencies
    >>> from asymptotics.problems.presets import string
    >>> rope = string(foundation=1.7)
    >>> print(as_text(rope, free_frequencies(rope, {}, 1), 2))
    rope 1.7*W + W_tautau - W_xixi = -2, W = epsilon*cos(Omega*tau) + 1
    xi_0 = 0.940043862207
       p         omega_p           decay
       1      3.58730020               0
    Omega = omega_p/q, where an expansion of order q has a pole:
      p/q           Omega
      1/2      1.79365010
    """
    given = ", ".join(f"{name} = {x:g}" for name, x in found.at.items())
    lines = [
        str(rope) + (f" at {given}" if given else ""),
        f"xi_0 = {found.static_contact:.12g}",
        f"{'p':>4}{'omega_p':>16}{'decay':>16}",
    ]
    for p, x in enumerate(found.values, start=1):
        lines.append(f"{p:>4}{float(np.real(x)):>16.8f}{float(np.imag(x)):>16.8g}")
    rows = [(p, q, omega) for p, q, omega in found.nonlinear(order) if q > 1]
    if rows:
        lines.append("Omega = omega_p/q, where an expansion of order q has a pole:")
        lines.append(f"{'p/q':>5}{'Omega':>16}")
        lines += [f"{f'{p}/{q}':>5}{omega:>16.8f}" for p, q, omega in rows]
    return "\n".join(lines)
