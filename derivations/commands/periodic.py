"""``ropewave state``: the periodic wave-less state of a rope, and whether it is stable."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derivations.commands.options import (
    EpsilonOption,
    FrequencyOption,
    HeightOption,
    HertzOption,
    JsonOption,
    PlotOption,
    omega_of,
)
from derivations.commands.ropes import (
    Asked,
    BendingOption,
    DampingOption,
    DriveOption,
    EndOption,
    ProblemOption,
    SetOption,
    asked,
)
from derivations.output import show, wrote

if TYPE_CHECKING:
    from numerics.periodic.stability import Stability
    from numerics.periodic.states import PeriodicState


def state(
    epsilon: EpsilonOption,
    omega: FrequencyOption = None,
    hz: HertzOption = None,
    height: HeightOption = None,
    beta: BendingOption = None,
    driven_end: EndOption = None,
    damping: DampingOption = None,
    drive: DriveOption = None,
    problem: ProblemOption = None,
    values: SetOption = None,
    as_json: JsonOption = False,
    plot: PlotOption = None,
) -> None:
    """The periodic wave-less state at Ω and ε, not expanded in ε, and its Floquet multipliers.

    It is the one that begins at rest: beyond a fold there is none. The rope has constant
    coefficients.
    """
    from asymptotics.checks import finite_number
    from asymptotics.errors import InputError
    from asymptotics.problems.presets import string
    from derivations.cross_check.ropes import in_numbers
    from derivations.progress import progress
    from numerics.periodic.states import periodic_state

    if plot is not None:
        from derivations.figures.plots import check_plot_path

        check_plot_path(plot)
    omega = finite_number("--omega", omega_of(omega, hz, height))
    epsilon = finite_number("--epsilon", epsilon)
    if not omega > 0:
        raise InputError(f"--omega {omega!r}: the frequency has to be positive")
    rope = asked(problem, values, beta, driven_end, damping, drive) or Asked(string(), {})
    at = {**rope.at, "Omega": omega}
    rest = complex(rope.rope.at(at).rest or 0).real
    stated = in_numbers(rope.rope, rope.rope.values(at), rest)
    with progress("finding the state", 1.0, as_json):
        found = periodic_state(stated, epsilon)
    height_left = found.clearance()
    if not height_left > 0:
        raise InputError(
            f"at epsilon = {epsilon:g}, Omega = {omega:g} the periodic solution is below the "
            f"ground (clearance {height_left:.3g} of that at rest): the rope touches the ground "
            "elsewhere, and the wave-less state has ended; give a smaller epsilon"
        )
    judged, reason = _judged(found)
    if plot is not None:
        from derivations.figures.state import plot_state

        plot_state(found, judged, plot)
    fields = {
        "command": "state",
        "omega": omega,
        "epsilon": epsilon,
        "problem": str(rope.rope),
        "static_contact": rest,
        "contact": [float(c) for c in found.waves.real],
        **({} if found.even else {"contact_sine": [float(c) for c in found.waves.imag]}),
        "subharmonic": found.modes.subharmonic,
        "residual": found.residual,
        "error": found.error,
        "clearance": height_left,
        "stable": "undecided" if judged is None else judged.verdict,
        "reason": reason,
        "modes": None if judged is None else judged.modes,
        "multipliers": None
        if judged is None
        else [[float(x.real), float(x.imag)] for x in judged.multipliers],
    }
    show(fields, _in_words(str(rope.rope), found, judged, reason, height_left), as_json)
    wrote(plot)


def _judged(found: PeriodicState) -> tuple[Stability | None, str | None]:
    """The verdict, or why there is none."""
    from numerics.errors import InputError
    from numerics.periodic.stability import stability

    try:
        return stability(found), None
    except InputError as error:
        return None, str(error)


def _in_words(
    name: str,
    found: PeriodicState,
    judged: Stability | None,
    reason: str | None,
    height_left: float,
) -> str:
    from numerics.periodic.states import resolved

    lines = [
        f"{name}, epsilon = {found.epsilon:g}",
        f"xi_c: error {found.error:.1e}, {resolved(found)} harmonics; least height "
        f"{height_left:.3g} of that at rest",
    ]
    for j, c in enumerate(found.waves[:9].tolist()):
        sine = "" if found.even else f"  {c.imag:+.14g} sin {j} theta"
        lines.append(f"  {c.real:+.14g} cos {j} theta{sine}")
    if judged is None:
        return "\n".join([*lines, f"stability: undecided; {reason}"])
    largest = judged.multipliers[0]
    return "\n".join(
        [
            *lines,
            f"stability: {judged.verdict}, by {judged.modes} modes; largest multiplier "
            f"{largest:.8g}, |.| = {abs(largest):.10g}",
        ]
    )
