"""Resonances of one rope, written out: text, JSON, LaTeX; and the spectrum against β, drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.beam_spectrum import linear_frequencies, linear_spectrum
from asymptotics.resonances import (
    Resonance,
    nonlinear_resonances,
    weak_bending,
)
from asymptotics.rope import STANDARD_GRAVITY, Rope
from asymptotics.static_shape import DRIVEN_ENDS, DrivenEnd, single_stiffness
from derivations.figure2_centres import FIGURE2_BETA, figure2_centres

# The paper's experiment; only Z₀ matters for Ω ↔ hertz.
PAPER_HEIGHT = 0.81

# Okabe and Ito's colours, with a line style each for print without colour.
_LOOK = {1: "#0072B2", 2: "#D55E00", 3: "#009E73"}
_DASH = {"pinned": "-", "clamped": (0, (4, 1.8))}


@dataclass(frozen=True)
class LinearRow:
    """One linear resonance: Ω_n, Ω_n/nπ, and hertz at the paper's Z₀ = 81 cm."""

    n: int
    omega: float
    ratio: float
    hertz: float


@dataclass(frozen=True)
class ResonanceTable:
    """All resonances of one rope that the command shows.

    Attributes
    ----------
    beta, driven_end
        Which rope.
    xi0
        ξ₀(β), its static contact point in units of x₀.
    order
        N: nonlinear resonances up to q = N.
    linear
        Ω_1 … Ω_count.
    nonlinear
        All p/q with q ≤ N, 0 < Ω ≤ Ω_count, ascending.
    increase
        By how much β → ∞ can raise f₁, as a fraction.
    """

    beta: float
    driven_end: DrivenEnd
    xi0: float
    order: int
    linear: tuple[LinearRow, ...]
    nonlinear: tuple[Resonance, ...]
    increase: float


def resonance_table(
    beta: float, driven_end: str = "pinned", count: int = 5, order: int = 3
) -> ResonanceTable:
    """The first ``count`` linear resonances and all nonlinear ones below the last, up to q = N.

    Raises
    ------
    InputError
        β negative, infinite or not a number; an unknown driven end; a bad count or order; more than
        10⁵ candidates p/q.

    Examples
    --------
    >>> table = resonance_table(0.01, count=2, order=2)
    >>> [round(row.omega, 4) for row in table.linear], round(table.xi0, 8)
    ([3.25, 7.1777], 1.10498407)
    >>> [f"{r.p}/{r.q}" for r in table.nonlinear]
    ['1/2', '1/1', '2/2', '3/2', '2/1']
    """
    spectrum = linear_spectrum(beta, count, driven_end)
    rope = _paper_rope()
    rows = tuple(
        LinearRow(n, omega, omega / (n * math.pi), float(rope.hertz_from_omega(omega)))
        for n, omega in enumerate(spectrum.omega, start=1)
    )
    nonlinear = nonlinear_resonances(
        order, 0.0, spectrum.omega[-1], spectrum.beta, spectrum.driven_end, rope
    )
    return ResonanceTable(
        beta=spectrum.beta,
        driven_end=spectrum.driven_end,
        xi0=spectrum.contact_point,
        order=order,
        linear=rows,
        nonlinear=nonlinear,
        increase=float(linear_frequencies(math.inf, 1, spectrum.driven_end)[0]) / math.pi - 1,
    )


def _paper_rope() -> Rope:
    return Rope.from_contact_point(1.47, 0.015, 0.0005, PAPER_HEIGHT, STANDARD_GRAVITY)


def as_json(table: ResonanceTable) -> dict[str, Any]:
    """The table as plain lists, numbers and text.

    ``first_order`` is the power of ε at which the pole first appears; ``hertz`` is for Z₀ = 81 cm.

    Examples
    --------
    >>> as_json(resonance_table(0.0, count=1, order=2))["nonlinear"][0]["p"]
    1
    """
    return {
        "command": "resonances",
        "beta": table.beta,
        "driven_end": table.driven_end,
        "order": table.order,
        "xi0": table.xi0,
        "omega": [row.omega for row in table.linear],
        "ratio": [row.ratio for row in table.linear],
        "hertz": [row.hertz for row in table.linear],
        "height": PAPER_HEIGHT,
        "stiff_limit_increase": table.increase,
        "nonlinear": [
            {
                "p": r.p,
                "q": r.q,
                "omega": r.omega,
                "hertz": r.hertz,
                "first_order": r.first_order,
            }
            for r in table.nonlinear
        ],
        "figure2": [
            {
                "n": row.n,
                "printed": row.printed,
                "beta": row.beta,
                "driven_end": row.driven_end,
                "omega": row.computed,
                "difference": row.difference,
                "agrees": row.agrees,
                "beta_of_printed": row.beta_of_printed,
            }
            for row in figure2_centres()
        ],
    }


def as_text(table: ResonanceTable) -> str:
    """The table for a terminal.

    Examples
    --------
    >>> print(as_text(resonance_table(0.01, count=2, order=2)))     # doctest: +ELLIPSIS
    pinned driven end, beta = 0.01: static contact point xi_0 = 1.10498407
    bending can raise f_1 by at most 41.68 % (beta -> infinity)
    <BLANKLINE>
       n           Omega    Omega/(n pi)   Hz (Z_0 = 0.81 m)
       1    3.2500012996      1.03450754              1.2726
       2    7.1776556599      1.14235938              2.8106
    ...
    """
    lines = [
        f"{table.driven_end} driven end, beta = {table.beta:g}: "
        f"static contact point xi_0 = {table.xi0:.9g}",
        f"bending can raise f_1 by at most {100 * table.increase:.2f} % (beta -> infinity)",
        "",
        f"{'n':>4}{'Omega':>16}{'Omega/(n pi)':>16}{f'Hz (Z_0 = {PAPER_HEIGHT} m)':>20}",
        *(f"{r.n:4d}{r.omega:16.11g}{r.ratio:16.9g}{r.hertz:20.5g}" for r in table.linear),
        "",
        f"poles of the expansion of order {table.order}: q Omega = Omega_p",
        f"{'p/q':>8}{'Omega':>16}{'Hz':>12}{'from order':>12}",
        *(
            f"{f'{r.p}/{r.q}':>8}{r.omega:16.11g}{r.hertz:12.5g}{r.first_order:12d}"
            for r in table.nonlinear
        ),
        "",
        "tongue centres of the paper's Fig. 2 (beta = 0.01) and the linear spectrum, pinned",
        f"{'n':>4}{'printed':>10}{'beta':>10}{'Omega_n':>14}{'difference':>14}",
        *(
            f"{r.n:4d}{r.printed:10g}{r.beta:10g}{r.computed:14.8g}{r.difference:+14.7f}"
            for r in figure2_centres()
        ),
    ]
    return "\n".join(lines)


def latex_table(table: ResonanceTable) -> str:
    """The linear resonances as a plain ``tabular``, for a page without extra packages.

    Examples
    --------
    >>> print(latex_table(resonance_table(0.01, count=1)))
    \\begin{tabular}{rrrr}
    \\hline
    $n$ & $\\Omega_n$ & $\\Omega_n/n\\pi$ & $f_n$ (Hz) \\\\
    \\hline
    1 & 3.2500013 & 1.034508 & 1.2726 \\\\
    \\hline
    \\end{tabular}
    """
    return "\n".join(
        [
            r"\begin{tabular}{rrrr}",
            r"\hline",
            r"$n$ & $\Omega_n$ & $\Omega_n/n\pi$ & $f_n$ (Hz) \\",
            r"\hline",
            *(
                rf"{row.n} & {row.omega:.7f} & {row.ratio:.6f} & {row.hertz:.4f} \\"
                for row in table.linear
            ),
            r"\hline",
            r"\end{tabular}",
        ]
    )


# -- the spectrum against β ----------------------------------------------------------------------


def plot_spectrum(path: Path, beta: float | None = None) -> dict[str, Any]:
    """Draw Ω_n(β)/nπ and Ω_n/nπ − 1 for 10⁻⁶ ≤ β ≤ 10⁴, both driven ends, n = 1, 2, 3.

    Parameters
    ----------
    path
        .png, .pdf or .svg.
    beta
        Another β to mark beside the paper's 0.01; outside the axes it is not drawn.

    Returns
    -------
    dict
        What was drawn: ``beta``, shape (401,), and for each driven end Ω_n/nπ, shape (401, 3).

    Raises
    ------
    InputError
        A bad suffix or β.
    StorageError
        The file cannot be written.
    """
    from derivations.plots import check_plot_path, save_figure

    check_plot_path(path)
    marked = None if beta is None else single_stiffness(beta)
    values = np.geomspace(1e-6, 1e4, 401)
    n = np.arange(1, 4)
    drawn: dict[str, Any] = {"beta": values}
    for end in DRIVEN_ENDS:
        drawn[end] = linear_frequencies(values, 3, end) / (n * np.pi)
    save_figure(_figure(drawn, marked), path)
    return drawn


def _figure(drawn: dict[str, Any], marked: float | None) -> Any:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from derivations.plots import drawing

    with drawing():
        figure = Figure(figsize=(7.0, 3.1), layout="constrained")
        left, right = figure.subplots(1, 2)
        for end in DRIVEN_ENDS:
            limits = linear_frequencies(math.inf, 3, end) / (np.pi * np.arange(1, 4))
            for n, colour in _LOOK.items():
                ratio, style = drawn[end][:, n - 1], {"color": colour, "ls": _DASH[end]}
                left.plot(drawn["beta"], ratio, **style)
                right.plot(drawn["beta"], ratio - 1, **style)
                left.plot(
                    [1e4, 2.2e4], [limits[n - 1]] * 2, color=colour, lw=3.0, solid_capstyle="butt"
                )
                _draw_weak_law(right, n, end)
        left.set(
            ylabel=r"$\Omega_n(\beta)/n\pi$",
            ylim=(0.95, 3.35),
            title=r"linear resonances; bars: $\beta\to\infty$",
        )
        keys = [Line2D([], [], color=colour, label=f"$n={n}$") for n, colour in _LOOK.items()]
        keys += [Line2D([], [], color="black", ls=_DASH[end], label=end) for end in DRIVEN_ENDS]
        left.legend(handles=keys, framealpha=1, edgecolor="none", fontsize=8, loc="upper left")
        right.set(
            yscale="log",
            ylim=(1e-6, 10),
            ylabel=r"$\Omega_n(\beta)/n\pi-1$",
            title=r"their shift; dotted: $O(\beta)$ law",
        )
        for axes in (left, right):
            axes.set(xscale="log", xlabel=r"bending stiffness $\beta=B/Tx_0^2$", xlim=(1e-6, 2.2e4))
            axes.title.set_fontsize(9)
            _mark(axes, FIGURE2_BETA, "paper's Fig. 2" if axes is right else "")
            if marked and 1e-6 <= marked <= 1e4 and marked != FIGURE2_BETA:
                _mark(axes, marked, rf"$\beta={marked:g}$" if axes is right else "")
    return figure


def _draw_weak_law(axes: Any, n: int, end: str) -> None:
    import sympy

    form = weak_bending(end).expression
    number, beta = sorted(form.free_symbols, key=lambda symbol: symbol.name, reverse=True)
    slope = float(sympy.diff(form, beta).subs(number, n) / (n * sympy.pi))
    values = np.array([1e-6, 3e-2 / n**2])
    axes.plot(values, slope * values, color="black", lw=0.9, ls=":")


def _mark(axes: Any, beta: float, text: str) -> None:
    colour = "0.35"
    axes.axvline(beta, color=colour, lw=0.8, ls="-.", zorder=0)
    axes.annotate(
        text,
        (beta, 0.02),
        xycoords=("data", "axes fraction"),
        xytext=(3, 0),
        textcoords="offset points",
        rotation=90,
        fontsize=7,
        color=colour,
    )
