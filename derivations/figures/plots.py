"""Figures: labelled, readable in print and without colour, the same bytes every time."""

from __future__ import annotations

import io
import logging
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.checks import finite_number
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Progress
from asymptotics.problems.moving_contact import MovingContact
from asymptotics.values.evaluate import string_expansion
from asymptotics.values.response import Response, response
from asymptotics.values.rope import evaluate_rope, ground_height
from derivations.files import check_writable, write_file

SUFFIXES = {".png", ".pdf", ".svg"}
# The state is even in time: the second half of a period retraces the first.
_PHASES = ("0", r"\frac{1}{8}", r"\frac{1}{4}", r"\frac{3}{8}", r"\frac{1}{2}")


_STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "lines.linewidth": 1.4,
    "mathtext.fontset": "cm",
    "svg.hashsalt": "ropewave",
    "pdf.fonttype": 42,
}


@contextmanager
def drawing(**changes: Any) -> Iterator[None]:
    """Draw and write within this: matplotlib's defaults, our sizes, and no word of the user's.

    A matplotlibrc may ask for TeX, other fonts or margins; here figures are the same bytes for all.
    ``changes`` have underscores for dots: ``font_size=8``.
    """
    from matplotlib import rc_context, rcParamsDefault

    settings: dict[Any, Any] = {
        name: value for name, value in rcParamsDefault.items() if not name.startswith("backend")
    }
    settings.update(_STYLE)
    settings.update((name.replace("_", ".", 1), value) for name, value in changes.items())
    with rc_context(settings):
        yield


def check_plot_path(path: Path) -> Path:
    """A path whose suffix is one we draw, where a file can be written."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"cannot draw {path.name!r}: give a file name that ends in "
            f"{', '.join(sorted(SUFFIXES))}"
        )
    check_writable(path)
    return path


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure whole or not at all, without dates."""
    suffix = check_plot_path(path).suffix.lower()
    metadata: dict[str, Any] = {
        ".png": {"Software": None},
        ".pdf": {"CreationDate": None},
        ".svg": {"Date": None},
    }[suffix]
    # Embedding fonts, fontTools warns of the time stamps inside them.
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    drawn = io.BytesIO()
    with drawing():
        figure.savefig(drawn, format=suffix[1:], dpi=200, metadata=metadata)
    write_file(path, drawn.getvalue())


def plot_period(
    omega: float, epsilon: float, order: int, path: Path, progress: Progress | None = None
) -> Response:
    """Draw the profile over one period and ξ_c(τ), from the series of the given order.

    Returns what was drawn: the whole rope, 401 positions at each of 97 times. ``progress`` is
    called as by :func:`asymptotics.values.evaluate.evaluate`.
    """
    check_plot_path(path)
    epsilon = finite_number("epsilon", epsilon)
    expansion, drive = string_expansion(omega, epsilon, order, progress)
    frame_done = None if progress is None else lambda n: progress(order + n)
    period = 2 * math.pi / drive.frequencies[0]
    if math.isinf(period):
        raise InputError(f"Omega = {omega!r} has no period to draw; give a larger one")
    tau = np.linspace(0.0, period, 97)
    contact = response(expansion, drive.phase, epsilon, [], tau).contact
    s = contact[:, None] * np.linspace(-1.0, 0.0, 401)
    result = response(expansion, drive.phase, epsilon, s, tau, frame_done)
    save_figure(_period_figure(result, drive.frequencies[0]), path)
    return result


def plot_rope_period(
    rope: MovingContact,
    at: Mapping[str, Any],
    epsilon: float,
    order: int,
    path: Path,
    progress: Progress | None = None,
) -> Response:
    """The same of a reader's own rope at values of its parameters."""
    check_plot_path(path)
    omega = float(rope.values(at)["Omega"])
    tau = np.linspace(0.0, 2 * math.pi / omega, 97)
    contact = evaluate_rope(rope, at, epsilon, order, [], tau).contact
    s = contact[:, None] * np.linspace(-1.0, 0.0, 401)
    if rope.springs != 0:
        # Beyond the contact point it moves, too: a layer 1/√κ sinks, and waves leave.
        ahead = np.linspace(0.0, 0.6, 241)[1:] * contact.max()
        s = np.hstack([s, np.broadcast_to(ahead, (tau.size, ahead.size))])
    result = evaluate_rope(rope, at, epsilon, order, s, tau, progress)

    def ground(x: Any) -> Any:
        return ground_height(rope, rope.values(at), x)

    save_figure(_period_figure(result, omega, ground), path)
    return result


def _period_figure(result: Response, omega: float, ground: Any = None) -> Any:
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    with drawing():
        figure = Figure(figsize=(7.0, 2.9), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        colours = colormaps["cividis"](np.linspace(0.0, 0.9, len(_PHASES)))
        step, period = (result.tau.size - 1) // 8, result.tau[-1]
        for i, (colour, phase) in enumerate(zip(colours, _PHASES, strict=True)):
            contact, profile = result.contact[i * step], result.profile[i * step]
            left.plot(contact + result.s[i * step], profile, color=colour, label=f"${phase}$")
            there = np.interp(0.0, result.s[i * step], profile)
            left.plot(contact, there, "o", color=colour, ms=3.2)
            right.plot(result.tau[i * step] / period, contact, "o", color=colour, ms=4.5, zorder=3)
        left.set(
            xlabel=r"position $x/x_0$",
            ylabel=r"height $w/Z_0$",
            xlim=(0, 1.15 * max(result.contact.max(), (result.contact[:, None] + result.s).max())),
            title="rope in the first half of a period",
        )
        x = np.linspace(0.0, left.get_xlim()[1], 200)
        height = np.zeros_like(x) if ground is None else ground(x)
        left.plot(x, height, color="0.6", lw=0.6, zorder=0)
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
