"""Resonances of one rope, written out: text, JSON, LaTeX; and the spectrum against β, drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.problems.beam_spectrum import linear_frequencies, linear_spectrum
from asymptotics.problems.rope import STANDARD_GRAVITY, Rope
from asymptotics.problems.static_shape import DrivenEnd
from asymptotics.resonances.rationals import (
    Resonance,
    nonlinear_resonances,
    weak_bending,
)
from derivations.figure2.centres import COMPARED, CentreComparison, figure2_centres

# The paper's experiment; only Z₀ matters for Ω ↔ hertz.
PAPER_HEIGHT = 0.81

# Okabe and Ito's colours, with a line style each for print without colour.
_LOOK: dict[int, tuple[str, Any]] = {
    1: ("#0072B2", "-"),
    2: ("#D55E00", (0, (5, 1.5))),
    3: ("#009E73", (0, (2, 1.2))),
}


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

    @property
    def centres(self) -> tuple[CentreComparison, ...]:
        """Fig. 2's tongue centres, for a rope that they are, or are said to be, those of."""
        applies = self.driven_end == "pinned" and self.beta in COMPARED
        return figure2_centres() if applies else ()


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
            for row in table.centres
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
    ]
    if table.centres:
        lines += [
            "",
            "tongue centres of the paper's Fig. 2 (beta = 0.01) and the linear spectrum, pinned",
            f"{'n':>4}{'printed':>10}{'beta':>10}{'Omega_n':>14}{'difference':>14}",
            *(
                f"{r.n:4d}{r.printed:10g}{r.beta:10g}{r.computed:14.8g}{r.difference:+14.7f}"
                for r in table.centres
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


def plot_spectrum(path: Path, table: ResonanceTable) -> dict[str, Any]:
    """Draw the rope's Ω_p(β)/q, q ≤ N, for 10⁻⁶ ≤ β ≤ 10⁴, and how bending shifts Ω₁ … Ω₃.

    Parameters
    ----------
    path
        .png, .pdf or .svg.
    table
        Whose driven end, count, order and β are drawn; β as a line where it is within the axes. Of
        nonlinear resonances only those with q ≤ 6, more lines cannot be told apart.

    Returns
    -------
    dict
        What was drawn: ``beta``, shape (401,), and for each (p, q) Ω_p/q, shape (401,).

    Raises
    ------
    InputError
        A bad suffix.
    StorageError
        The file cannot be written.
    """
    from derivations.figures.plots import check_plot_path, save_figure

    check_plot_path(path)
    values = np.geomspace(1e-6, 1e4, 401)
    count = len(table.linear)
    pairs = {(n, 1) for n in range(1, count + 1)}
    pairs |= {(r.p, r.q) for r in table.nonlinear if r.q <= _DRAWN}
    spectrum = linear_frequencies(values, max(p for p, _ in pairs), table.driven_end)
    drawn: dict[Any, Any] = {"beta": values}
    drawn |= {(p, q): spectrum[:, p - 1] / q for p, q in sorted(pairs)}
    save_figure(_figure(drawn, table), path)
    return drawn


_DRAWN = 6  # the largest q drawn


def _figure(drawn: dict[Any, Any], table: ResonanceTable) -> Any:
    from matplotlib.figure import Figure

    from derivations.figures.plots import drawing

    with drawing():
        figure = Figure(figsize=(7.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        _draw_resonances(left, drawn, table)
        limits = linear_frequencies(math.inf, 3, table.driven_end) / (np.pi * np.arange(1, 4))
        shifts = linear_frequencies(drawn["beta"], 3, table.driven_end)
        for n, (colour, style) in _LOOK.items():
            shift = shifts[:, n - 1] / (n * np.pi) - 1
            right.plot(drawn["beta"], shift, color=colour, ls=style, label=f"$n={n}$")
            right.plot([1e4, 2.2e4], [limits[n - 1] - 1] * 2, color=colour, lw=3.0)
            _draw_weak_law(right, n, table.driven_end)
        right.legend(frameon=False, fontsize=8, loc="upper left")
        right.set(
            yscale="log",
            ylim=(1e-6, 10),
            ylabel=r"$\Omega_n(\beta)/n\pi-1$",
            title=r"shift by bending; dotted: $O(\beta)$ law, bars: $\beta\to\infty$",
        )
        for axes in (left, right):
            axes.set(xscale="log", xlabel=r"bending stiffness $\beta=B/Tx_0^2$", xlim=(1e-6, 2.2e4))
            axes.title.set_fontsize(9)
            if 1e-6 <= table.beta <= 1e4:
                label = rf"$\beta={table.beta:g}$"
                _mark(axes, table.beta, label if axes is right else "")
    return figure


def _draw_resonances(axes: Any, drawn: dict[Any, Any], table: ResonanceTable) -> None:
    """Ω_p(β)/q: linear ones thick, the others by q."""
    from matplotlib import colormaps

    denominators = sorted({pair[1] for pair in drawn if pair != "beta"})
    shades = colormaps["cividis"](np.linspace(0.25, 0.9, max(denominators)))
    for pair, omega in drawn.items():
        if pair == "beta":
            continue
        q = pair[1]
        style = {"color": "black", "lw": 1.8} if q == 1 else {"color": shades[q - 1], "lw": 0.9}
        first = pair == min(other for other in drawn if other != "beta" and other[1] == q)
        axes.plot(drawn["beta"], omega, **style, label=f"$q={q}$" if first else None)
    dropped = f", of {table.order}" if table.order > _DRAWN else ""
    axes.set(
        yscale="log",
        ylabel=r"resonances $\Omega_p(\beta)/q$",
        title=rf"{table.driven_end} end, $q\leq{max(denominators)}$" + dropped,
    )
    axes.legend(framealpha=1, edgecolor="none", fontsize=8, loc="upper left")


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
