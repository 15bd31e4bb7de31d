"""Tongues written out: one JSON object, text, a LaTeX table, a figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.errors import InputError
from asymptotics.tongues import Tongue, tongue

# Okabe and Ito's colours: told apart with any colour vision.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_SIDES = ("+", "-")


def as_json(result: Tongue) -> dict[str, Any]:
    """The tongue as a dictionary that ``json.dumps`` takes; formulas are text that SymPy parses.

    ``order`` is what was asked for, ``order_used`` the largest multiple of q in it. "+" is μ > 0.

    >>> fields = as_json(tongue(1, 1, 3))
    >>> fields["exponent"], fields["singular"]
    ('5/3', {'1': '-pi**5/64', '3': '-pi**5/64'})
    """
    part, limit, sides = result.singular, result.limit, result.sides
    return {
        "command": "tongue",
        "p": part.p,
        "q": part.q,
        "order": result.order,
        "order_used": part.order,
        "variable": part.variable,
        "exponent": str(result.exponent),
        "coefficient": {sign: sides[sign].coefficient for sign in _SIDES},
        "contact": {sign: {"s": sides[sign].s, "theta": sides[sign].theta} for sign in _SIDES},
        "height": {sign: sides[sign].height for sign in _SIDES},
        "singular": {str(j): text for j, text in part.text().items()},
        "pole": part.pole,
        "certified_gap": {sign: sides[sign].gap for sign in _SIDES},
        "limit_exponent": str(limit.exponent),
        "limit_coefficient": limit.coefficient,
        "pendulum": limit.strength,
        "centre_shift": limit.shift,
        "conventions": {
            "law": "epsilon = coefficient*abs(mu)**exponent, mu = Omega - p*pi/q",
            "mu_eff": "mu - centre_shift*epsilon**2; the limit law is in mu_eff",
            "singular": "x_c/x0 ~ 1 + epsilon**order_used*mu**(-pole)"
            "*sum_j singular[j]*cos(j*theta), theta = Omega*tau",
            "contact": "s = (x - x_c)/x0; theta in [0, pi/q]",
            "height": "units of Z0",
            "pendulum": "V = pendulum*epsilon**q",
        },
    }


def as_text(result: Tongue) -> str:
    """The tongue in words and numbers.

    >>> print(as_text(tongue(1, 2, 5)))  # doctest: +ELLIPSIS
    Resonance p/q = 1/2 at Omega = 1*pi/2 = 1.5708, order 5: set by order 4, the largest multiple...
    """
    part, limit = result.singular, result.limit
    p, q = part.p, part.q
    head = f"Resonance p/q = {p}/{q} at Omega = {p}*pi/{q} = {p * math.pi / q:.6g}"
    head += f", order {result.order}"
    if result.order != part.order:
        head += f": set by order {part.order}, the largest multiple of {q} up to it"
    lines = [head]
    for sign in _SIDES:
        side = result.sides[sign]
        lines.append(
            f"  {part.variable} {'>' if sign == '+' else '<'} 0: epsilon = "
            f"{side.coefficient:.7g} |{part.variable}|^({result.exponent}); touches at "
            f"s = {side.s:.6g}, theta = {side.theta:.6g}; bump {side.height:.4g} Z0"
        )
    lines.append(f"  leading part: epsilon^{part.order}/{part.variable}^{part.pole} times")
    lines += [f"    cos({j}*theta): {text}" for j, text in part.text().items()]
    variable = "mu" if limit.shift == "0" else "mu_eff"
    lines.append(
        f"  limit of all orders: epsilon = {limit.coefficient:.7g} |{variable}|^({limit.exponent})"
    )
    if limit.shift != "0":
        lines.append(
            f"  mu_eff = mu - epsilon^2*({limit.shift}) = mu {-limit.shift_value:+.6g} epsilon^2"
        )
    return "\n".join(lines)


def latex_table(results: Sequence[Tongue]) -> str:
    r"""A ``tabular``: p/q, N, exponent, C and −s Ω₀ for both signs of μ, the limit law.

    Raises
    ------
    InputError
        No tongue given.

    >>> print(latex_table([tongue(1, 1, 3)]).splitlines()[3])
    $1/1$ & $3$ & $5/3$ & $0.30922$ & $0.30922$ & $1.1292$ & $1.1292$ & $2$ & $0.12500$ \\
    """
    if not results:
        raise InputError("no tongue to tabulate; give at least one")
    lines = [
        r"\begin{tabular}{ccccccccc}",
        r"\hline",
        r"$p/q$ & $N$ & exponent & $C_+$ & $C_-$ & $-s_+\Omega_0$ & $-s_-\Omega_0$ & "
        r"$2/q$ & limit \\ \hline",
    ]
    shifted = False
    for result in results:
        part, limit = result.singular, result.limit
        mark = r"\,^{*}" if part.variable == "mu_eff" else ""
        shifted = shifted or bool(mark)
        centre = part.p * math.pi / part.q
        cells = [
            f"{part.p}/{part.q}",
            f"{part.order}",
            f"{result.exponent}{mark}",
            *(_digits(result.sides[sign].coefficient) for sign in _SIDES),
            *(_digits(-result.sides[sign].s * centre) for sign in _SIDES),
            str(limit.exponent),
            _digits(limit.coefficient),
        ]
        lines.append(" & ".join(f"${cell}$" for cell in cells) + r" \\")
    lines += [r"\hline", r"\end{tabular}"]
    if shifted:
        lines.append(r"% $^{*}$: in $\mu_\mathrm{eff}=\mu-\gamma\epsilon^2$")
    return "\n".join(lines) + "\n"


def _digits(value: float) -> str:
    """Five significant digits, trailing zeros kept."""
    return f"{value:#.5g}"


def plot_tongues(resonances: Sequence[tuple[int, int]], order: int, path: Path) -> list[Tongue]:
    """Draw ε(Ω) of several resonances at one order, and the limit law; returns the tongues.

    The limit law of q ≥ 3 is drawn in Ω, that is with the shift of its centre.

    Raises
    ------
    InputError
        No resonance, one that is reducible or needs a higher order, or a path of another kind.
    """
    from derivations.plots import check_plot_path, save_figure

    check_plot_path(path)
    if not resonances:
        raise InputError("no resonance to draw; give at least one p/q")
    results = [tongue(p, q, order) for p, q in resonances]
    save_figure(_figure(results, order), path)
    return results


def plot_orders(p: int, q: int, highest: int, path: Path) -> list[Tongue]:
    """Draw the tongue of p/q at the orders q, 2q, …, ``highest`` next to the pendulum's law.

    Raises
    ------
    InputError
        p/q is reducible, ``highest`` < 2q, or a path of another kind.
    """
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    from derivations.plots import check_plot_path, drawing, save_figure

    check_plot_path(path)
    if highest < 2 * q:
        raise InputError(f"highest = {highest}; several orders need at least {2 * q} at q = {q}")
    results = [tongue(p, q, order) for order in range(q, highest + 1, q)]
    limit = results[0].limit
    with drawing():
        figure = Figure(figsize=(7.0, 3.2), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        distance = np.geomspace(1e-3, _REACH, 61)
        colours = colormaps["cividis"](np.linspace(0.0, 0.9, len(results)))
        for colour, result in zip(colours, results, strict=True):
            height = result.sides["-"].coefficient * distance ** float(result.exponent)
            left.plot(distance, height, color=colour, label=f"{result.singular.order}")
        law = limit.coefficient * distance ** float(limit.exponent)
        left.plot(distance, law, color="black", ls="--", label=r"$\infty$")
        left.legend(title="order $N$", frameon=False, title_fontsize=9, ncols=2)
        left.set(
            xscale="log",
            yscale="log",
            xlabel=r"distance below resonance $|\mu|$",
            ylabel=r"amplitude $\epsilon$",
        )
        orders = [result.singular.order for result in results]
        exponents = [float(r.exponent) for r in results]
        right.plot(orders, exponents, "o-", color=_COLOURS[0], ms=4, label="exponent")
        right.axhline(float(limit.exponent), color=_COLOURS[0], ls="--", lw=1)
        for sign, marker in zip(_SIDES, "^v", strict=True):
            ratio = [r.sides[sign].coefficient / limit.coefficient for r in results]
            label = rf"$C/C_\infty$, $\mu{'>' if sign == '+' else '<'}0$"
            right.plot(orders, ratio, marker + "-", color=_COLOURS[1], ms=4, label=label)
        right.axhline(1.0, color=_COLOURS[1], ls="--", lw=1)
        right.legend(frameon=False, loc="lower right")
        figure.suptitle(f"$p/q={p}/{q}$", fontsize=9)
        right.set(xlabel="order $N$", ylim=(0, None), ylabel="exponent; coefficient over its limit")
    save_figure(figure, path)
    return results


def _figure(results: Sequence[Tongue], order: int) -> Any:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from derivations.plots import drawing

    with drawing():
        figure = Figure(figsize=(7.0, 3.2), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        for i, result in enumerate(results):
            colour = _COLOURS[i % len(_COLOURS)]
            _draw_linear(left, result, colour)
            _draw_logarithmic(right, result, colour)
        left.set(
            xlabel=r"frequency $\Omega=\omega x_0/c$",
            ylabel=r"amplitude $\epsilon$",
            ylim=(0, _ceiling(results)),
        )
        right.set(
            xlabel=r"distance above resonance $\mu$ ($\mu_\mathrm{eff}$)",
            ylabel=r"amplitude $\epsilon$",
            xscale="log",
            yscale="log",
        )
        handles = [
            Line2D([], [], color="0.3", label=rf"expansion through $\epsilon^{{{order}}}$"),
            Line2D([], [], color="0.3", ls="--", label="pendulum, all orders"),
        ]
        figure.legend(handles=handles, frameon=False, loc="outside lower center", ncols=2)
        right.legend(frameon=False, loc="lower right", title="$p/q$", title_fontsize=9)
    return figure


def _ceiling(results: Sequence[Tongue]) -> float:
    """Room for the highest curve, but not so much that the flattest disappears."""
    heights = [r.sides["+"].coefficient * _REACH ** float(r.exponent) for r in results]
    return 1.05 * min(max(heights), 4 * min(heights))


def _draw_linear(axes: Any, result: Tongue, colour: str) -> None:
    """Both sides of a tongue over Ω, and the pendulum's law."""
    part, limit = result.singular, result.limit
    centre = part.p * math.pi / part.q
    distance = np.linspace(0.0, _REACH, 301)
    for sign, factor in (("+", 1), ("-", -1)):
        height = result.sides[sign].coefficient * distance ** float(result.exponent)
        shift = limit.shift_value * height**2 if part.variable == "mu_eff" else 0.0
        axes.plot(centre + factor * distance + shift, height, color=colour)
        height = limit.coefficient * distance ** float(limit.exponent)
        shifted = centre + factor * distance + limit.shift_value * height**2
        axes.plot(shifted, height, color=colour, ls="--", lw=1.0)
    axes.annotate(
        f"{part.p}/{part.q}",
        (centre, 1.0),
        (0, 2),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        color=colour,
        ha="center",
        fontsize=8,
    )


def _draw_logarithmic(axes: Any, result: Tongue, colour: str) -> None:
    """The side μ > 0 over the distance in its own variable."""
    part, limit = result.singular, result.limit
    distance = np.geomspace(1e-3, _REACH, 61)
    height = result.sides["+"].coefficient * distance ** float(result.exponent)
    axes.plot(distance, height, color=colour, label=f"{part.p}/{part.q}")
    axes.plot(
        distance, limit.coefficient * distance ** float(limit.exponent), color=colour, ls="--", lw=1
    )


_REACH = 0.7  # of |μ|: up to about halfway between the neighbours pπ/2
