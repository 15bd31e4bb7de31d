"""How time, length and memory grow with the order.

``python -m tests.benchmarks.growth --max-order 16 --out growth.png`` derives the exact string one
order at a time in one process, then its moving frame and proof, then its JSON and NumPy files,
prints a table and draws it. Times are processor seconds; lengths are sums over the harmonics of
ξ_n; memory is the process's peak. The raw cotangent polynomials come from the same engine over
``sympy.polys.rings``.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from asymptotics import (
    ClosedForms,
    Expansion,
    exact_string,
    expand,
    moving_frame,
    prove,
    string_problem,
)
from asymptotics.formulas.normal_form import _cotangent_form, cotangent_form
from derivations.reports.formats import render

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HIGHEST_RAW = 9

# Okabe & Ito's colours, with a marker each so that grey prints stay readable.
STYLES = {
    "blue": {"color": "#0072B2", "marker": "o"},
    "vermilion": {"color": "#D55E00", "marker": "s"},
    "green": {"color": "#009E73", "marker": "^"},
    "purple": {"color": "#CC79A7", "marker": "D"},
}


@dataclass
class Growth:
    """What was measured; entry n − 1 belongs to order n, times and memory are cumulative."""

    expand_seconds: list[float] = field(default_factory=list)
    proof_seconds: list[float] = field(default_factory=list)
    writing_seconds: list[float] = field(default_factory=list)
    canonical_terms: list[int] = field(default_factory=list)
    cotangent_terms: list[int] = field(default_factory=list)
    raw_terms: list[int] = field(default_factory=list)
    expand_memory: list[float] = field(default_factory=list)
    proof_memory: list[float] = field(default_factory=list)


def peak_megabytes() -> float:
    """The process's peak resident memory; the unit of ru_maxrss is the system's own."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 2**20 if sys.platform == "darwin" else peak / 2**10


def measure(max_order: int) -> Growth:
    """Derive first, prove after, so that the proof's memory is not the derivation's.

    The peak while proving order n is therefore at least that of deriving them all. For the same
    reason SymPy, SymEngine and matplotlib are imported when they are needed.
    """
    growth, problem = Growth(), exact_string()
    solution: Expansion | None = None
    spent = 0.0
    for n in range(1, max_order + 1):
        begin = time.process_time()
        solution = expand(problem, n, start=solution)
        spent += time.process_time() - begin
        growth.expand_seconds.append(spent)
        growth.expand_memory.append(peak_megabytes())
    for n in range(1, max_order + 1):
        truncated = Expansion(problem, solution.orders[:n])
        begin = time.process_time()
        prove(truncated, moving_frame(truncated))
        growth.proof_seconds.append(time.process_time() - begin)
        growth.proof_memory.append(peak_megabytes())
        elements = solution.contact(n).values()
        growth.canonical_terms.append(sum(len(element.numerator) for element in elements))
        growth.cotangent_terms.append(
            sum(sum(map(len, cotangent_form(x).rows.values())) for x in elements)
        )
    growth.writing_seconds = [
        writing_seconds(Expansion(problem, solution.orders[:n])) for n in range(1, max_order + 1)
    ]
    growth.raw_terms = raw_lengths(min(max_order, HIGHEST_RAW))
    return growth


def writing_seconds(expansion: Expansion) -> float:
    """JSON and NumPy of an expansion already proved, from closed forms of its own."""
    frame = moving_frame(expansion)
    proofs = prove(expansion, frame)
    _cotangent_form.cache_clear()
    begin = time.process_time()
    forms = ClosedForms(expansion, frame)
    for format in ("json", "numpy"):
        render(forms, proofs, format)
    return time.process_time() - begin


def raw_lengths(highest: int) -> list[int]:
    """Monomials in Ω, κ₁, κ₂, … of ξ_1, ξ_2, …"""
    from tests.benchmarks.rings import PolynomialRing

    ring = PolynomialRing(highest)
    raw = expand(string_problem(ring, ring.omega, ring.cot), highest)
    return [
        sum(ring.length(element) for element in raw.contact(n).values())
        for n in range(1, highest + 1)
    ]


def table(growth: Growth) -> str:
    """One line an order."""
    lines = [
        "order  expand [s]  frame + proof [s]  JSON + NumPy [s]  canonical  cotangent  raw cot.  "
        "expand [MB]    all [MB]"
    ]
    for i in range(len(growth.expand_seconds)):
        raw = growth.raw_terms[i] if i < len(growth.raw_terms) else "-"
        lines.append(
            f"{i + 1:5d} {growth.expand_seconds[i]:11.4f} {growth.proof_seconds[i]:18.4f} "
            f"{growth.writing_seconds[i]:17.4f} "
            f"{growth.canonical_terms[i]:10d} {growth.cotangent_terms[i]:10d} {raw:>9} "
            f"{growth.expand_memory[i]:12.1f} {growth.proof_memory[i]:11.1f}"
        )
    return "\n".join(lines)


def draw(growth: Growth) -> Figure:
    """Three panels over the order N, memory from zero, the rest logarithmic."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 3.6), layout="constrained")
    times, lengths, memory = figure.subplots(1, 3)

    def curve(axes: Axes, values: Sequence[float], style: str, label: str) -> None:
        axes.plot(
            range(1, len(values) + 1),
            values,
            label=label,
            linewidth=1.5,
            markersize=5,
            **STYLES[style],
        )

    curve(times, growth.expand_seconds, "blue", "expansion")
    curve(times, growth.proof_seconds, "vermilion", "moving frame and proof")
    curve(times, growth.writing_seconds, "green", "JSON and NumPy")
    times.set(title="Time, orders 1 … N", ylabel="processor time (s)")
    curve(lengths, growth.raw_terms, "purple", "raw cotangents")
    curve(lengths, growth.canonical_terms, "blue", "one cotangent (canonical)")
    curve(lengths, growth.cotangent_terms, "green", "cotangent partial fractions")
    lengths.set(title="Length of the contact point", ylabel=r"terms in $\xi_N$")
    curve(memory, growth.expand_memory, "blue", "expansion")
    memory.plot(
        [len(growth.proof_memory)],
        growth.proof_memory[-1:],
        label="with moving frame and proof",
        linestyle="none",
        **STYLES["vermilion"],
    )
    memory.set(title="Peak memory", ylabel="resident memory (MB)")
    memory.set_ylim(bottom=0)
    for axes in (times, lengths, memory):
        axes.set_xlabel("order N")
        if axes is not memory:
            axes.set_yscale("log")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.grid(True, which="major", color="0.85", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize="small")
    return figure


def main() -> None:
    """Measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--max-order", type=int, default=12)
    parser.add_argument("--out", type=Path, required=True, help="the figure, .png, .pdf or .svg")
    arguments = parser.parse_args()
    growth = measure(arguments.max_order)
    print(table(growth))
    import matplotlib as mpl

    with mpl.rc_context({"svg.hashsalt": "ropewave"}):
        # No date and no version: the same numbers give the same bytes.
        date = {".png": {"Software": None}, ".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
        metadata = date.get(arguments.out.suffix)
        draw(growth).savefig(arguments.out, dpi=160, metadata=metadata)


if __name__ == "__main__":
    main()
