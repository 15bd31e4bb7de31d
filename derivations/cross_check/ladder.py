"""The cross-check, drawn: the emitted closed forms' errors against ε.

``python -m derivations.cross_check --out cross_check.png`` compares them with the exact string and
with the simulated rope, without and with bending, prints the slopes and draws all three. With the
default grid that takes some minutes, ten times less with ``--dx 0.005``.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from derivations.cross_check.data import Comparison, against_exact_string
from derivations.cross_check.forms import beam_form, string_form
from derivations.cross_check.runs import against_simulator
from derivations.cross_check.validation import Validation
from derivations.figures.plots import check_plot_path, drawing, save_figure
from derivations.output import open_streams
from numerics.simulation.contact import Scheme

GOLDEN = math.pi * (math.sqrt(5) - 1) / 2
"""Ω/π as far from fractions as can be: no resonance pπ/q is near."""
STRING_OMEGA = 2.0
STRING_LARGEST = 0.08
STRING_RAMP = 300.0
BEAM_OMEGA = 1.3
BEAM_LARGEST = 0.2
BETA = 0.01
DX = 0.00125

# Okabe & Ito's colours, with a marker each so that grey prints stay readable.
_STYLES = (("#0072B2", "o"), ("#D55E00", "s"), ("#009E73", "^"), ("#CC79A7", "D"))


def comparisons(dx: float = DX, rungs: int = 8) -> tuple[Comparison, Comparison, Comparison]:
    """Exact string, simulated string (Verlet) and simulated rope with bending (trapezoidal).

    The simulations start from an ε near the largest at which an order is judged, and halve it every
    second rung; at their Ω the terms of all orders are of a size that a grid resolves.
    """
    ladder = 2.0 ** (-np.arange(rungs) / 2)
    return (
        against_exact_string(GOLDEN, [string_form(GOLDEN, n) for n in range(1, 5)]),
        against_simulator(
            STRING_OMEGA,
            0.0,
            STRING_LARGEST * ladder,
            [string_form(STRING_OMEGA, n) for n in range(1, 5)],
            dx,
            Scheme.VERLET,
            STRING_RAMP,
        ),
        against_simulator(
            BEAM_OMEGA,
            BETA,
            BEAM_LARGEST * ladder,
            [beam_form(BEAM_OMEGA, n, BETA) for n in range(1, 4)],
            dx,
            Scheme.TRAPEZOIDAL,
        ),
    )


def table(found: Sequence[Comparison]) -> str:
    """One line an order and quantity: the slope, and over how much it was fitted."""
    lines = ["Omega      beta   of    N  slope   decades of epsilon, of the error"]
    for one in found:
        for name, errors in (("xi_c", one.contact), ("W", one.shape)):
            if errors is None:
                continue
            for n in one.orders:
                head = f"{one.omega:<9.6g}  {one.beta:<5g}  {name:<4}  {n}"
                if one.judged(errors, n).sum() < 2:
                    lines.append(f"{head}  at the floor")
                    continue
                of_epsilon, of_error = one.decades(errors, n)
                lines.append(
                    f"{head}  {one.slope(errors, n):.3f}   {of_epsilon:.2f}  {of_error:.2f}"
                )
    return "\n".join(lines)


def draw(found: Sequence[Comparison], dx: float) -> Any:
    """A panel each: errors of ξ_c filled, of W hollow, those beside the judgement pale."""
    from matplotlib.figure import Figure

    titles = (
        "exact string, from rest",
        rf"simulator, $\beta=0$, $\Delta\xi={dx:g}$",
        rf"simulator, $\beta={BETA:g}$, $\Delta\xi={dx:g}$",
    )
    with drawing():
        figure = Figure(figsize=(10.2, 4.0), layout="constrained")
        panels = figure.subplots(1, len(found))
        for axes, one, title in zip(panels, found, titles, strict=True):
            _panel(axes, one)
            axes.set(
                title=rf"{title}, $\Omega={one.omega:.5g}$",
                xlabel=r"forcing amplitude $\epsilon$",
            )
            axes.title.set_fontsize(9)
        panels[0].set_ylabel("error of order $N$ (root mean square)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    return figure


def draw_validation(found: Validation) -> Any:
    """One comparison, with its verdicts in the title."""
    from matplotlib.figure import Figure

    one = found.comparison
    with drawing():
        figure = Figure(figsize=(5.4, 4.4), layout="constrained")
        axes = figure.subplots()
        _panel(axes, one)
        beta = "" if math.isnan(one.beta) else rf", $\beta={one.beta:g}$"
        verdicts = ", ".join(f"{judged.order}: {judged.verdict}" for judged in found.orders)
        axes.set(
            title=rf"$\Omega={one.omega:.5g}${beta}; judge: {found.judge}"
            f"\n{verdicts}",
            xlabel=r"forcing amplitude $\epsilon$",
            ylabel="error of order $N$ (root mean square)",
        )
        axes.title.set_fontsize(9)
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _panel(axes: Any, one: Comparison) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set(xscale="log", yscale="log")
    for n in one.orders:
        colour, marker = _STYLES[(n - 1) % len(_STYLES)]
        for errors, face in ((one.contact, colour), (one.shape, "white")):
            if errors is None:
                continue
            judged = one.judged(errors, n)
            look = {"marker": marker, "ls": "none", "color": colour, "mfc": face, "ms": 4.5}
            label = rf"$N={n}$" if errors is one.contact else None
            values = errors.error[n - 1]
            axes.plot(one.epsilon[judged], values[judged], label=label, **look)
            axes.plot(one.epsilon[~judged], values[~judged], alpha=0.25, **look)
        # Not fitted: the next term of the series itself.
        guide = one.sizes[n] * one.epsilon ** (n + 1)
        axes.plot(one.epsilon, guide, color=colour, lw=0.9)
    axes.plot([], [], color="0.4", lw=0.9, label=r"$\|\xi_{N+1}\|\,\epsilon^{N+1}$")
    floors = ((one.contact, "--", r"floor, $x_c$"), (one.shape, ":", r"floor, $w$"))
    for errors, style, label in floors:
        if errors is None:
            continue
        axes.plot(one.epsilon, errors.floor, style, color="0.3", lw=1.0, label=label)
    if one.beta == 0 and len(one.orders) == len(_STYLES):
        axes.plot([], [], "o", color="0.4", ms=4.5, label="$x_c/x_0$")
        axes.plot([], [], "o", color="0.4", mfc="white", ms=4.5, label="$w/Z_0$")
    # On a short axis the powers of ten alone would leave it without numbers.
    parts = (1.0,) if one.epsilon[0] > 100 * one.epsilon[-1] else (1.0, 2.0, 5.0)
    axes.xaxis.set_major_locator(LogLocator(subs=parts))
    axes.xaxis.set_minor_formatter(NullFormatter())
    if len(parts) > 1:
        axes.xaxis.set_major_formatter("{x:g}")
    lowest = min(e.floor.min() for e in (one.contact, one.shape) if e is not None)
    axes.set_ylim(lowest / 4, 4 * one.contact.error.max())


def main(arguments: Sequence[str] | None = None) -> None:
    """Compare, print and draw."""
    open_streams()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="the figure: .png, .pdf or .svg")
    parser.add_argument("--dx", type=float, default=DX, help="the simulator's grid")
    given = parser.parse_args(arguments)
    if given.out is not None:
        check_plot_path(given.out)
    found = comparisons(given.dx)
    print(table(found))
    if given.out is not None:
        save_figure(draw(found, given.dx), given.out)


if __name__ == "__main__":
    main()
