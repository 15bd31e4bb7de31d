"""Which rope a command is about: the paper's string, one of its kin by options, or a file's."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from asymptotics.expansion.certificates import Proof
    from asymptotics.expansion.order_loop import Expansion
    from asymptotics.formulas.rope import RopeForms
    from asymptotics.problems.moving_contact import MovingContact

ProblemOption = Annotated[
    Path | None,
    typer.Option("--problem", metavar="FILE", help="A rope of your own, a TOML file (README)."),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=X", help="A parameter of --problem; may be repeated."),
]
BendingOption = Annotated[
    float | None, typer.Option("--beta", metavar="β", min=0, help="Bending, B/(T x₀²).")
]
EndOption = Annotated[
    Literal["pinned", "clamped"] | None,
    typer.Option("--driven-end", help="How the shaken end of a beam is held."),
]
DampingOption = Annotated[
    float | None, typer.Option("--damping", metavar="ζ", min=0, help="Viscous: free waves e^(−ζτ).")
]
DriveOption = Annotated[
    str | None,
    typer.Option("--drive", metavar="N: A@PHI,…", help="Harmonics, e.g. '1: 1, 3: 0.2@0.5'."),
]

_PART = re.compile(r"\s*(\d{1,4})\s*:\s*([^@\s]+)\s*(?:@\s*(\S+)\s*)?")


@dataclass(frozen=True)
class Asked:
    """A rope, and the values of its parameters but for Ω."""

    rope: MovingContact
    at: dict[str, Any]


def asked(
    problem: Path | None,
    values: list[str] | None,
    beta: float | None,
    driven_end: str | None,
    damping: float | None,
    drive: str | None,
) -> Asked | None:
    """The rope that the options describe; None when none was given, for the paper's string."""
    from asymptotics.errors import InputError

    options = {"--beta": beta, "--driven-end": driven_end, "--damping": damping, "--drive": drive}
    given = [name for name, value in options.items() if value is not None]
    if problem is not None:
        from asymptotics.problems.written import read_problem

        if given:
            raise InputError(
                f"--problem and {', '.join(given)}: the file says what the rope is; put it there"
            )
        written = read_problem(problem)
        return Asked(written.rope, {**written.parameters, **_assignments(values or [])})
    if values:
        raise InputError("--set changes a parameter of --problem FILE; there is no file")
    if not given:
        return None
    import sympy

    from asymptotics.problems import presets

    at: dict[str, Any] = {}
    shared: dict[str, Any] = {"drive": None if drive is None else drive_of(drive)}
    if damping:
        shared["damping"], at["zeta"] = sympy.Symbol("zeta"), _exact(damping)
    if beta:
        at["beta"] = _exact(beta)
        return Asked(presets.beam(driven_end=driven_end or "pinned", **shared), at)
    if driven_end is not None:
        raise InputError("--driven-end holds a rope with bending; give --beta > 0 as well")
    return Asked(presets.string(**shared), at)


def _exact(value: float) -> Any:
    import sympy

    from asymptotics.checks import finite_number

    number = finite_number("an option", value)
    return sympy.Rational(*number.as_integer_ratio())


def drive_of(text: str) -> dict[int, tuple[Any, Any]]:
    """'1: 1, 3: 0.2@0.5' as {harmonic: (amplitude, phase)}, ΔZ = Σ amplitude cos(nθ + phase).

    Raises
    ------
    InputError
        The text is of another form.

    >>> drive_of("1: 1, 3: 0.2@0.5")
    {1: (1, 0), 3: (1/5, 1/2)}
    """
    import sympy

    from asymptotics.errors import InputError
    from asymptotics.rings.balls import rational

    found: dict[int, tuple[Any, Any]] = {}
    for part in text.split(","):
        match = _PART.fullmatch(part)
        size, phase = (rational(x) for x in (match[2], match[3] or "0")) if match else (None, None)
        if match is None or size is None or phase is None or int(match[1]) in found:
            raise InputError(
                f"--drive {text!r}: {part.strip()!r} is not harmonic: amplitude, or harmonic: "
                "amplitude@phase, each harmonic once; for instance '1: 1, 3: 0.2@0.5'"
            )
        exact = (sympy.Rational(x.numerator, x.denominator) for x in (size, phase))
        found[int(match[1])] = (next(exact), next(exact))
    return found


def _assignments(texts: list[str]) -> dict[str, str]:
    from asymptotics.errors import InputError

    found = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise InputError(f"--set {text!r}: write name=value, for instance --set kappa=2")
        found[name.strip()] = value.strip()
    return found


def evaluated(
    asked: Asked,
    omega: float,
    epsilon: float,
    order: int,
    s: list[float] | None,
    tau: list[float],
    plot: Path | None,
) -> tuple[dict[str, Any], str]:
    """The fields of ``evaluate`` for a rope, and its table."""
    from asymptotics.values.rope import evaluate_rope
    from derivations.progress import progress, share_of_orders

    at = {**asked.at, "Omega": omega}
    with progress("expanding", 1.0, fine=True) as report:
        told = share_of_orders(report, order)
        result = evaluate_rope(asked.rope, at, epsilon, order, s, tau, told)
    if plot is not None:
        from derivations.figures.plots import plot_rope_period

        with progress("drawing", 1.0, fine=True) as report:
            told = share_of_orders(report, order)
            plot_rope_period(asked.rope, at, epsilon, order, plot, told)
    fields = {
        "command": "evaluate",
        "omega": result.at["Omega"],
        "parameters": dict(result.at),
        "static_contact": result.static_contact,
        **result.as_json(),
    }
    values = ", ".join(f"{name} = {value:g}" for name, value in result.at.items())
    return fields, f"{values}, epsilon = {result.epsilon:g}, order {result.order}\n" + table(result)


def table(result: Any) -> str:
    """ξ_c and w/Z₀, a line a time."""
    lines = []
    heads = ["tau", "x_c/x0", *(f"w/Z0(s={value:g})" for value in result.s)]
    lines.append("  ".join(f"{head:>16}" for head in heads))
    for time, contact, row in zip(result.tau, result.contact, result.profile, strict=True):
        lines.append("  ".join(f"{value:16.10g}" for value in (time, contact, *row)))
    return "\n".join(lines)


def derived(asked: Asked, omega: float, order: int, quiet: bool) -> tuple[dict[str, Any], str]:
    """The expansion of a rope in numbers, and its proof: as fields and as text."""
    from asymptotics import expand, prove
    from derivations.progress import progress

    at = {**asked.at, "Omega": omega}
    with progress("deriving", order, quiet) as report:
        solution: Expansion[Any] = expand(asked.rope, order, progress=report, at=at)
    with progress("proving", order, quiet) as report:
        proofs = prove(solution, progress=report)
    rest = complex(solution.problem.rest or 0).real
    fields = {
        "command": "derive",
        "problem": str(asked.rope),
        "parameters": {name: float(x) for name, x in asked.rope.values(at).items()},
        "order": order,
        "static_contact": rest,
        "contact": [_harmonics(solution, n) for n in range(1, order + 1)],
        "proof": [str(proof) for proof in proofs],
    }
    return fields, _in_words(asked, solution, rest, proofs)


def formulas(asked: Asked, order: int, quiet: bool) -> tuple[RopeForms, Proof]:
    """The closed forms of a rope in its impedances, and their proof."""
    from asymptotics.formulas.rope import rope_forms
    from derivations.progress import progress

    with progress("deriving", order, quiet) as report:
        forms = rope_forms(asked.rope, order, report)
    with progress("proving", order, quiet) as report:
        return forms, forms.prove(report)


def _harmonics(solution: Expansion[Any], n: int) -> dict[str, list[float]]:
    """j ↦ [a, b] with ξ_n = Σ_j a_j cos jθ + b_j sin jθ."""
    found = {}
    for j, c in sorted(solution.contact(n).items()):
        value = complex(c) * (2 if j else 1)
        found[str(j)] = [value.real, -value.imag]
    return found


def _in_words(asked: Asked, solution: Expansion[Any], rest: float, proofs: Proof) -> str:
    lines = [str(asked.rope), f"xi_0 = {rest:.15g}"]
    for n in range(1, solution.order + 1):
        terms = []
        for j, (a, b) in _harmonics(solution, n).items():
            angle = "theta" if j == "1" else f"{j} theta"
            if j == "0":
                terms.append(f"{a:+.15g}")
                continue
            terms += [f"{x:+.15g} {f}({angle})" for x, f in ((a, "cos"), (b, "sin")) if x]
        lines.append(f"xi_{n} = " + (" ".join(terms) or "0"))
    return "\n".join([*lines, "", *map(str, proofs)])
