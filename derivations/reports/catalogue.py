"""The catalogue: which formulas there are, where the paper has them, which files hold them.

``python -m derivations`` regenerates every committed artefact of this table and
``python -m derivations --check`` compares them, byte for byte, with what the engine yields now.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from asymptotics.expansion.moving_frame import moving_frame
from asymptotics.expansion.order_loop import expand
from asymptotics.expansion.proof import prove
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.formulas.closed_form import STYLES, ClosedForms
from asymptotics.printing.beam_latex import beam_latex
from asymptotics.printing.beam_numpy import beam_numpy
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.problems.string import exact_string
from derivations.reports.formats import FORMATS, render

GENERATED = Path(__file__).parents[1] / "generated"
ORDER = 4
BEAM_ORDER = 3
COLUMNS = ("two", "one")


@dataclass(frozen=True)
class FormulaSet:
    """A set of formulas and where it is found."""

    name: str
    labels: tuple[str, ...]
    source: str
    files: tuple[str, ...]


CATALOGUE = (
    FormulaSet(
        "contact point ξ_c",
        ("expand", "linresponse1"),
        "asymptotics.formulas.closed_form.ClosedForms.contact",
        ("contact.tex", "string_order4.py", "string-order4.json"),
    ),
    FormulaSet(
        "shape w_n(ξ, τ)",
        ("leading",),
        "asymptotics.formulas.closed_form.ClosedForms.shape",
        ("shape.tex", "string-order4.json"),
    ),
    FormulaSet(
        "profile F_j(s, ε)",
        ("expandw", "F3"),
        "asymptotics.formulas.closed_form.ClosedForms.profile",
        ("profile.tex", "string-order4.txt", "string_order4.py", "string-order4.json"),
    ),
    FormulaSet(
        "bending: ξ_c and w with impedances",
        ("beam2", "BC3"),
        "asymptotics.formulas.beam.expand_symbolic",
        ("beam-order3-pinned.tex", "beam_order3_pinned.py"),
    ),
)


def artefacts() -> dict[str, str]:
    """Relative path → content of every committed artefact, derived and proved now."""
    expansion = expand(exact_string(), ORDER)
    frame = moving_frame(expansion)
    proofs = prove(expansion, frame)
    files: dict[str, str] = {}
    for style in STYLES:
        forms = ClosedForms(expansion, frame, style)
        for format in FORMATS:
            if format == "latex":
                for column in COLUMNS:
                    folder = f"latex-{column}-column-{style}"
                    for name, text in render(forms, proofs, format, column).items():
                        files[f"{folder}/{name}"] = text
            elif style == "cotangent":
                files.update(render(forms, proofs, format))
    files.update(_beam_artefacts())
    return files


def _beam_artefacts() -> dict[str, str]:
    expansion = expand_symbolic(BEAM_ORDER)
    prove(expansion)
    files = {}
    for end in DRIVEN_ENDS:
        files[f"beam-order{BEAM_ORDER}-{end}.tex"] = beam_latex(expansion, end)
        files[f"beam_order{BEAM_ORDER}_{end}.py"] = beam_numpy(expansion, end)
    return files


def differences(folder: Path = GENERATED) -> list[str]:
    """What is missing, different or left over in ``folder``, a line each."""
    wanted = artefacts()
    found = {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.name != "__init__.py"
    }
    lines = [f"missing: {name}" for name in sorted(wanted.keys() - found)]
    lines += [f"left over: {name}" for name in sorted(found - wanted.keys())]
    for name in sorted(wanted.keys() & found):
        if (folder / name).read_bytes() != wanted[name].encode():
            lines.append(f"different: {name}")
    return lines
