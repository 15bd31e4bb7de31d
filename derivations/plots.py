"""Figures: labelled, readable in print and without colour, the same bytes every time."""

from __future__ import annotations

import logging
import math
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.checks import finite_number
from asymptotics.errors import InputError, StorageError
from asymptotics.evaluate import string_expansion
from asymptotics.response import Response, response
from asymptotics.storage import replace_file

SUFFIXES = {".png", ".pdf", ".svg"}
# The state is even in time: the second half of a period retraces the first.
_PHASES = ("0", r"\frac{1}{8}", r"\frac{1}{4}", r"\frac{3}{8}", r"\frac{1}{2}")


def check_plot_path(path: Path) -> Path:
    """A path whose suffix is one we draw, in a folder that exists or can be made."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"cannot draw {path.name!r}: give a file name that ends in "
            f"{', '.join(sorted(SUFFIXES))}"
        )
    return path


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure whole or not at all, without dates."""
    suffix = check_plot_path(path).suffix.lower()
    metadata: dict[str, Any] = {
        ".png": {"Software": None},
        ".pdf": {"CreationDate": None},
        ".svg": {"Date": None},
    }[suffix]
    from matplotlib import rc_context

    # Embedding fonts, fontTools warns of the time stamps inside them.
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with rc_context(figure_style()):
            replace_file(
                path,
                lambda part: figure.savefig(part, format=suffix[1:], dpi=200, metadata=metadata),
            )
    except OSError as error:
        raise StorageError(
            f"cannot write {path}: {error.strerror or error}. Choose another file"
        ) from error


def plot_period(omega: float, epsilon: float, order: int, path: Path) -> Response:
    """Draw the profile over one period and ξ_c(τ), from the series of the given order.

    Returns what was drawn: the whole rope, 401 positions at each of 97 times.
    """
    check_plot_path(path)
    epsilon = finite_number("epsilon", epsilon)
    expansion, drive = string_expansion(omega, epsilon, order)
    period = 2 * math.pi / drive.frequencies[0]
    if math.isinf(period):
        raise InputError(f"Omega = {omega!r} has no period to draw; give a larger one")
    tau = np.linspace(0.0, period, 97)
    contact = response(expansion, drive.phase, epsilon, [], tau).contact
    s = contact[:, None] * np.linspace(-1.0, 0.0, 401)
    result = response(expansion, drive.phase, epsilon, s, tau)
    save_figure(_period_figure(result, drive.frequencies[0]), path)
    return result


def figure_style() -> Any:
    """What all figures share: sizes for print, light axes, deterministic SVG."""
    return {
        "font.size": 9,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.linewidth": 0.8,
        "lines.linewidth": 1.4,
        "mathtext.fontset": "cm",
        "svg.hashsalt": "ropewave",
        "pdf.fonttype": 42,
    }


def _period_figure(result: Response, omega: float) -> Any:
    from matplotlib import colormaps, rc_context
    from matplotlib.figure import Figure

    with rc_context(figure_style()):
        figure = Figure(figsize=(7.0, 2.9), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        colours = colormaps["cividis"](np.linspace(0.0, 0.9, len(_PHASES)))
        step, period = (result.tau.size - 1) // 8, result.tau[-1]
        for i, (colour, phase) in enumerate(zip(colours, _PHASES, strict=True)):
            contact, profile = result.contact[i * step], result.profile[i * step]
            left.plot(contact + result.s[i * step], profile, color=colour, label=f"${phase}$")
            left.plot(contact, 0, "o", color=colour, ms=3.2)
            right.plot(result.tau[i * step] / period, contact, "o", color=colour, ms=4.5, zorder=3)
        left.set(
            xlabel=r"position $x/x_0$",
            ylabel=r"height $w/Z_0$",
            xlim=(0, 1.15 * result.contact.max()),
            title="rope in the first half of a period",
        )
        left.axhline(0, color="0.6", lw=0.6, zorder=0)
        left.legend(title=r"time $\omega t/2\pi$", frameon=False, title_fontsize=9)
        right.plot(result.tau / period, result.contact, color="black", lw=1.0)
        right.set(
            xlabel=r"time $\omega t/2\pi$",
            ylabel=r"contact point $x_c/x_0$",
            xlim=(0, 1),
            title="contact point",
        )
        for axes in (left, right):
            axes.title.set_fontsize(9)
        figure.suptitle(
            rf"$\Omega={omega:.5g}$,  $\epsilon={result.epsilon:.4g}$,  "
            rf"series through $\epsilon^{{{result.order}}}$",
            fontsize=9,
        )
    return figure
