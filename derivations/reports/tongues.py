"""Tongues written out: one JSON object, text, a LaTeX table, a figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asymptotics.errors import InputError
from asymptotics.resonances.tongues import (
    MOST_ESTIMATED,
    TOLERANCE,
    LimitLaw,
    Tongue,
    half_way,
    tongue,
)

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
        "range": {sign: result.window(sign) for sign in _SIDES},
        "range_reason": _reason(result),
        "limit_exponent": str(limit.exponent),
        "limit_coefficient": limit.coefficient,
        "pendulum": limit.strength,
        "centre_shift": limit.shift,
        "limit_range": limit.range,
        "limit_range_reason": _limit_reason(limit),
        "conventions": {
            "law": "epsilon = coefficient*abs(mu)**exponent, mu = Omega - p*pi/q",
            "mu_eff": "mu - centre_shift*epsilon**2; the limit law is in mu_eff",
            "singular": "x_c/x0 ~ 1 + epsilon**order_used*mu**(-pole)"
            "*sum_j singular[j]*cos(j*theta), theta = Omega*tau",
            "contact": "s = (x - x_c)/x0; theta in [0, pi/q]",
            "height": "units of Z0",
            "pendulum": "V = pendulum*epsilon**q",
            "range": "from which to which abs(mu) the law may hold for the rope; null: nowhere",
            "limit_range": "abs(mu_eff) up to which the limit law is within 10 %; null: not known",
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
    lines.append(f"  range of these laws: {_reason(result)}")
    variable = "mu" if limit.shift == "0" else "mu_eff"
    lines.append(
        f"  limit of all orders: epsilon = {limit.coefficient:.7g} |{variable}|^({limit.exponent})"
    )
    if limit.shift != "0":
        lines.append(
            f"  mu_eff = mu - epsilon^2*({limit.shift}) = mu {-limit.shift_value:+.6g} epsilon^2"
        )
    lines.append(f"  range of the limit law: {_limit_reason(limit)}")
    return "\n".join(lines)


def _reason(result: Tongue) -> str:
    """Where the law of the truncated expansion may hold for the rope, and why not elsewhere."""
    part = result.singular
    windows = [window for sign in _SIDES if (window := result.window(sign)) is not None]
    edge = min(result.sides[sign].divergent for sign in _SIDES)
    why = (
        f"for |{part.variable}| < {edge:.3g} the touch lies where the series in epsilon diverges "
        f"(it converges below the limit law), and half way to the next resonance is "
        f"{result.half_way:.3g}"
    )
    if not windows:
        return f"none for the rope, they are those of the truncated expansion: {why}"
    low, high = min(low for low, _ in windows), max(high for _, high in windows)
    return f"{low:.3g} < |{part.variable}| < {high:.3g} at most: {why}"


def _limit_reason(limit: LimitLaw) -> str:
    variable = "mu" if limit.shift == "0" else "mu_eff"
    if limit.range is None:
        return f"as {variable} -> 0; how far is not estimated for q > {MOST_ESTIMATED}"
    return (
        f"|{variable}| < {limit.range:.3g}, beyond which the terms next to it are estimated to "
        f"change epsilon by more than {100 * TOLERANCE:.0f} %"
    )


def latex_table(results: Sequence[Tongue]) -> str:
    r"""A ``tabular``: p/q, N, side of μ, exponent, C, −sΩ₀, and the limit law; one column wide.

    Raises
    ------
    InputError
        No tongue given.

    >>> print(latex_table([tongue(1, 1, 3)]).splitlines()[4])
    $1/1$ & $3$ & $\pm$ & $5/3$ & $0.30922$ & $1.1292$ & $2$ & $0.12500$ \\
    """
    if not results:
        raise InputError("no tongue to tabulate; give at least one")
    lines = [
        r"\begingroup\setlength{\tabcolsep}{3pt}",
        r"\begin{tabular}{@{}cccccccc@{}}",
        r"\hline",
        r"$p/q$ & $N$ & $\mu$ & power & $C$ & $-s\Omega_0$ & $2/q$ & $C_\infty$ \\ \hline",
    ]
    for result in results:
        part, limit = result.singular, result.limit
        centre = part.p * math.pi / part.q
        mark = r"\,^{*}" if part.variable == "mu_eff" else ""
        before = (f"{part.p}/{part.q}", f"{part.order}")
        after = (str(limit.exponent), _digits(limit.coefficient))
        sides: dict[tuple[str, str], str] = {}
        for sign in _SIDES:
            side = result.sides[sign]
            numbers = (_digits(side.coefficient), _digits(-side.s * centre))
            sides[numbers] = r"\pm" if numbers in sides else sign
        for numbers, sign in sides.items():
            cells = (*before, sign, f"{result.exponent}{mark}", *numbers, *after)
            lines.append(" & ".join(f"${cell}$" for cell in cells) + r" \\")
    lines += [r"\hline", r"\end{tabular}\endgroup"]
    if any(result.singular.variable == "mu_eff" for result in results):
        lines.append(r"% $^{*}$: in $\mu_\mathrm{eff}=\mu-\gamma\epsilon^2$")
    return "\n".join(lines) + "\n"


def _digits(value: float) -> str:
    """Five significant digits, trailing zeros kept."""
    return f"{value:#.5g}"


def plot_tongues(resonances: Sequence[tuple[int, int]], order: int, path: Path) -> list[Tongue]:
    """Draw ε(Ω) of several resonances at one order, and the limit law; returns the tongues.

    The limit law of q ≥ 3 is drawn in Ω, that is with the shift of its centre; every limit law as
    far as its range, or half way to the next resonance where that is not known.

    Raises
    ------
    InputError
        No resonance, one that is reducible or needs a higher order, or a path of another kind.
    """
    from derivations.figures.plots import check_plot_path, save_figure

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

    from derivations.figures.plots import check_plot_path, drawing, save_figure

    check_plot_path(path)
    if highest < 2 * q:
        raise InputError(f"highest = {highest}; several orders need at least {2 * q} at q = {q}")
    results = [tongue(p, q, order) for order in range(q, highest + 1, q)]
    limit = results[0].limit
    with drawing():
        figure = Figure(figsize=(7.0, 3.2), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        distance = np.geomspace(1e-3, 1.0, 61) * _reach(results[0])
        colours = colormaps["cividis"](np.linspace(0.0, 0.9, len(results)))
        for colour, result in zip(colours, results, strict=True):
            height = result.sides["-"].coefficient * distance ** float(result.exponent)
            left.plot(distance, height, color=colour, lw=1.0, label=f"{result.singular.order}")
        known = distance[distance <= _known(limit)]
        left.plot(known, limit.epsilon(known), color="black", lw=2.2, label=r"$\infty$")
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

    from derivations.figures.plots import drawing

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
            # Tongues of different width have heights of different orders of magnitude.
            **({"ylim": (0, None)} if len(results) == 1 else {"yscale": "log"}),
        )
        right.set(
            xlabel=r"distance above resonance $\mu$ ($\mu_\mathrm{eff}$)",
            ylabel=r"amplitude $\epsilon$",
            xscale="log",
            yscale="log",
        )
        bound = rf"pendulum, all orders, as far as within {100 * TOLERANCE:.0f}$\,$%"
        handles = [
            Line2D([], [], color="0.3", lw=1.0, ls="--", label=_truncated_label(results, order)),
            Line2D([], [], color="0.3", lw=2.2, label=bound),
        ]
        figure.legend(handles=handles, frameon=False, loc="outside lower center")
        right.legend(frameon=False, loc="lower right", title="$p/q$", title_fontsize=9)
    return figure


def _truncated_label(results: Sequence[Tongue], order: int) -> str:
    label = rf"touch of the expansion through $\epsilon^{{{order}}}$"
    beyond = all(r.window(sign) is None for r in results for sign in _SIDES)
    return f"{label}: beyond convergence" if beyond else label


def _known(limit: LimitLaw) -> float:
    """|μ_eff| up to which the limit law is drawn: its range, where that is known."""
    return half_way(limit.p, limit.q) if limit.range is None else limit.range


def _reach(result: Tongue) -> float:
    """|μ| up to which a tongue is drawn: twice as far as its limit law, not into the next one."""
    return min(2 * _known(result.limit), result.half_way)


def _draw_linear(axes: Any, result: Tongue, colour: str) -> None:
    """Both sides of a tongue over Ω, and the pendulum's law as far as it is known to hold."""
    part, limit = result.singular, result.limit
    centre = part.p * math.pi / part.q
    distance = np.linspace(0.0, 1.0, 301)
    for sign, factor in (("+", 1), ("-", -1)):
        far = _reach(result) * distance
        height = result.sides[sign].coefficient * far ** float(result.exponent)
        shift = limit.shift_value * height**2 if part.variable == "mu_eff" else 0.0
        axes.plot(centre + factor * far + shift, height, color=colour, lw=1.0, ls="--")
        far = _known(limit) * distance
        height = limit.epsilon(far)
        shifted = centre + factor * far + limit.shift_value * height**2
        axes.plot(shifted, height, color=colour, lw=2.2)
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
    distance = np.geomspace(1e-3, 1.0, 61)
    far = _reach(result) * distance
    height = result.sides["+"].coefficient * far ** float(result.exponent)
    axes.plot(far, height, color=colour, lw=1.0, ls="--")
    far = _known(limit) * distance
    axes.plot(far, limit.epsilon(far), color=colour, lw=2.2, label=f"{part.p}/{part.q}")
