"""A watched run, written out: text and JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from derivations.output import finite
from derivations.reports.watched_run import Bump, Verdict, Watched
from numerics.simulation.contact import Scheme

if TYPE_CHECKING:
    from numerics.events.finder import Event
    from numerics.simulation.run import Run


def as_json(watched: Watched) -> dict[str, Any]:
    """The inputs and results of a run as plain numbers and words; null for what there is not."""
    from numerics.files.sealed import specification

    energy, work, damped, lost = watched.run.ledger
    low, high = watched.contact_range
    parameters = specification(watched.run)
    del parameters["drive"]
    found = {
        "command": "simulate",
        **parameters,
        "epsilon": watched.epsilon,
        "ramp": watched.ramp,
        "periods": watched.periods,
        "tau": watched.run.times[-1],
        "continued_from": watched.begun if watched.begun > 0 else None,
        "verdict": watched.verdict.value,
        "highest_wave": _bump(watched.highest),
        "first_waves": [
            {"threshold": least, "wave": _bump(bump)}
            for least, bump in zip(watched.heights, watched.first, strict=True)
        ],
        "events": {
            kind.name.lower(): {"count": watched.counts[kind], "event": _event(event)}
            for kind, event in watched.events.items()
        },
        "fastest_contact": _event(watched.fastest),
        "contact": {"rest": watched.rest[0], "min": low, "max": high},
        "energy": {
            "rest": watched.rest[1],
            "end": energy,
            "work": work,
            "damped": damped,
            "lost": lost,
            "unexplained": unexplained(watched),
            "unexplained_step": watched.run.unexplained,
        },
        "complementarity": {
            "least_height": watched.run.lowest,
            "least_reaction": watched.run.reaction,
        },
    }
    plain: dict[str, Any] = finite(found)
    return plain


def of_any_drive(run: Run) -> tuple[dict[str, Any], str]:
    """A run under a drive that need not be periodic, as plain numbers and as text."""
    from numerics.files.sealed import specification
    from numerics.simulation.observables import Column

    contact = run.column(Column.CONTACT)
    energy, work, damped, lost = (float(x) for x in run.ledger)
    fields = {
        "command": "simulate",
        **specification(run),
        "tau": run.times.tolist(),
        "contact": contact.tolist(),
        "wave": run.column(Column.BUMP).tolist(),
        "energy": {
            "end": energy,
            "work": work,
            "damped": damped,
            "lost": lost,
            "unexplained_step": run.unexplained,
        },
        "complementarity": {"least_height": run.lowest, "least_reaction": run.reaction},
    }
    plain: dict[str, Any] = finite(fields)
    lines = [
        f"{run.problem.drive.label}, beta = {run.problem.beta:g}",
        *(f"{name}: {label}" for name, label in run.problem.varying.items()),
        f"to tau = {run.end_time:g}: contact point {contact.min():.6g} … {contact.max():.6g}",
        f"energy {energy:.6g}, work {work:.6g}, damped {damped:.6g}, lost {lost:.3g}; "
        f"unexplained in a step at most {run.unexplained:.1e}",
    ]
    return plain, "\n".join(lines)


def unexplained(watched: Watched) -> float:
    """The change of energy since the start that the ledger does not explain."""
    energy, work, damped, lost = watched.run.ledger
    return float(energy - watched.rest[1] - work + damped + lost)


def _bump(bump: Bump | None) -> dict[str, float] | None:
    return None if bump is None else {"height": bump.height, "x": bump.place, "tau": bump.time}


def _event(event: Event | None) -> dict[str, float] | None:
    if event is None:
        return None
    return {
        "tau": event.time,
        "before": event.before,
        "after": event.after,
        "x": event.place,
        "value": event.value,
        "error": event.error,
    }


def as_text(watched: Watched) -> str:
    """The run in words: which, what the rope did, its contact point, energy and residuals."""
    return "\n".join([*_heading(watched), *_waves(watched), *_events(watched), *_balance(watched)])


def _heading(watched: Watched) -> list[str]:
    run, problem = watched.run, watched.run.problem
    lines = [
        f"Omega = {problem.drive.omega:g}, epsilon = {watched.epsilon:g}, beta = {problem.beta:g}, "
        f"{problem.driven_end.value} end, damping {problem.damping:g}, "
        f"restitution {problem.restitution:g}",
        f"{watched.periods:g} forcing periods, {watched.ramp:g} of them ramp, to tau = "
        f"{run.times[-1]:.6g}; {run.scheme.value}, dx = {run.grid.dx:g}, dt = {run.dt:.4g}, "
        f"length {run.grid.length:g}, the last {run.grid.sponge:g} absorbing",
    ]
    if watched.begun > 0:
        lines.append(f"continued from tau = {watched.begun:.6g}: waves and events are those since")
    return lines


def _waves(watched: Watched) -> list[str]:
    low, high = watched.heights
    highest = watched.highest
    since = f"since tau = {watched.begun:.6g} " if watched.begun > 0 else ""
    if watched.verdict is Verdict.FOLLOWS or highest is None:
        return [
            f"{since}the rope follows: nothing higher than {low:.2g} Z0 beyond the contact point"
        ]
    where = f"{highest.height:.4g} Z0 at x = {highest.place:.4g} x0, {_when(watched, highest.time)}"
    lines = [
        f"{since}the rope sheds waves, the highest {where}"
        if watched.verdict is Verdict.SHEDS
        else f"{since}in doubt: the highest wave, {where}, is hardly more than the grid can hold; "
        "take a smaller dx"
    ]
    for least, bump in zip((low, high), watched.first, strict=True):
        if bump is not None:
            lines.append(f"  higher than {least:.2g} Z0 first at {_when(watched, bump.time)}")
    lines.append("  how waves go on, and what the ground takes from them, depends on dx: compare")
    return lines


def _when(watched: Watched, time: float) -> str:
    return f"tau = {time:.6g} (period {time / watched.run.problem.drive.period:.2f})"


def _events(watched: Watched) -> list[str]:
    from numerics.events.finder import EventKind

    low, high = watched.contact_range
    lines = [
        f"contact point {low:.6g} … {high:.6g} x0 in the last period, {watched.rest[0]:.6g} at rest"
    ]
    if watched.fastest is not None:
        fastest = watched.fastest
        lines.append(
            f"  fastest {fastest.value:+.3g} ± {fastest.error:.1g} c, "
            f"{_when(watched, fastest.time)}"
        )
    for kind, event in watched.events.items():
        if event is not None and kind is not EventKind.SEPARATED_WAVE:
            which = "lowest" if kind is EventKind.NEAR_MISS else "first"
            lines.append(
                f"  {kind.value}: {watched.counts[kind]}, the {which} at x = {event.place:.4g} x0, "
                f"{_when(watched, event.time)}"
            )
    return lines


def _balance(watched: Watched) -> list[str]:
    run = watched.run
    energy, work, damped, lost = run.ledger
    dips = run.scheme is Scheme.VERLET and run.problem.restitution > 0
    return [
        f"energy [T Z0^2/x0]: work {work:.6g} = stored {energy - watched.rest[1]:.6g} + damped "
        f"{damped:.6g} + lost on the ground {lost:.6g}, and {abs(unexplained(watched)):.1e} "
        f"unexplained ({run.unexplained:.1e} in a step)",
        f"least height {run.lowest:.2g} Z0, least force of the ground {run.reaction:.2g} T Z0/x0^2"
        + ("; with restitution the explicit scheme lets nodes dip for a step" if dips else ""),
    ]
