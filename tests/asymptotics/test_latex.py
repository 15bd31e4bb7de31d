"""Emitted LaTeX says what the closed forms say, and fits the column."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from math import gcd
from pathlib import Path
from typing import Any

import pytest
import sympy
import sympy as sp
from mpmath import mp, mpf

from asymptotics import ClosedForms, exact_string, expand
from asymptotics.errors import InputError
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.formulas.closed_form import symbols
from asymptotics.formulas.normal_form import resonance_cosines
from asymptotics.formulas.rope import rope_forms
from asymptotics.printing.beam_latex import beam_latex
from asymptotics.printing.equations import COLUMNS, aligned
from asymptotics.printing.latex import (
    contact_equation,
    formula_sets,
    profile_equation,
    shape_equation,
)
from asymptotics.printing.latex_trees import cosine_sum
from asymptotics.printing.rope_latex import rope_document, rope_latex
from asymptotics.printing.text import _resonance
from asymptotics.printing.widths import Limits, Piece, break_lines, width
from asymptotics.problems import presets
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi

STYLES = ("cotangent", "circular")
POINT = {"Omega": "0.8317", "epsilon": "0.0371", "s": "-0.6173", "xi": "0.4139", "tau": "1.2791"}
DIGITS = 40


@cache
def closed_forms(order: int, style: str) -> ClosedForms:
    return ClosedForms(expand(exact_string(), order), style=style)


@cache
def files(order: int, style: str, column: str) -> dict[str, str]:
    return formula_sets(closed_forms(order, style), column)


# -- reading the emitted LaTeX back ---------------------------------------------------------------


def equations(text: str) -> dict[str, tuple[str, str]]:
    """Label -> (left, right) of every numbered formula in the align environments of a file."""
    found = {}
    for block in re.findall(r"\\begin\{align\}(.*?)\\end\{align\}", text, re.S):
        start = 0
        for label in re.finditer(r"\\label\{eq:rope:([^}]*)\}", block):
            flat = block[start : label.start()]
            start = label.end()
            flat = re.sub(r"\\\\(\[1ex\])?|\\nonumber|\\quad|\\qquad|&|\n", " ", flat)
            left, right = re.split(r"=\{\}|\\sim\{\}", flat, maxsplit=1)
            found[label.group(1)] = (left.strip(), right.replace("{-}", "-"))
    return found


class Reader:
    """Recursive descent over the emitted subset; ``f`` of a sine is the factors that follow it."""

    def __init__(self, text: str, values: dict[str, Any]) -> None:
        text = re.sub(r"\\[bB]ig[lr]", "", text)
        self.tokens = re.findall(r"\\[A-Za-z]+|\d+|\S", text)
        self.i, self.values = 0, values

    def value(self) -> Any:
        total = self.sum()
        assert self.i == len(self.tokens), self.tokens[self.i :]
        return total

    def peek(self) -> str:
        return self.tokens[self.i] if self.i < len(self.tokens) else ""

    def take(self, expected: str | None = None) -> str:
        token = self.peek()
        assert token
        assert expected is None or token == expected, (token, expected)
        self.i += 1
        return token

    def sum(self) -> Any:
        total, sign = mpf(0), 1
        if self.peek() in ("+", "-"):
            sign = -1 if self.take() == "-" else 1
        while True:
            total += sign * self.product()
            if self.peek() not in ("+", "-"):
                return total
            sign = -1 if self.take() == "-" else 1

    def product(self) -> Any:
        result, count = mpf(1), 0
        while self.peek() not in ("", "+", "-", ")", "]", "}"):
            if self.peek() == r"\times":
                self.take()
            result *= self.factor()
            count += 1
        assert count, "an empty product: something was dropped"
        return result

    def group(self) -> str:
        self.take("{")
        start = self.i
        while self.peek() != "}":
            self.take()
        self.take()
        return "".join(self.tokens[start : self.i - 1])

    def power(self) -> int:
        if self.peek() != "^":
            return 1
        self.take()
        return int(self.group())

    def angle(self) -> Any:
        """[k] Ω [s] or [k] θ, or a bracket: what stands under a sine."""
        if self.peek() == "[":
            return self.bracket("]")
        k = int(self.take()) if self.peek().isdigit() else 1
        result = k * self.values[self.take()]
        return result * self.values[self.take()] if self.peek() == "s" else result

    def bracket(self, closing: str) -> Any:
        self.take()
        result = self.sum()
        self.take(closing)
        return result

    def factor(self) -> Any:
        token = self.peek()
        if token in ("(", "["):
            inside = self.bracket(")" if token == "(" else "]")
            return inside ** self.power()
        token = self.take()
        if token.isdigit():
            return mpf(token)
        if token == r"\frac":
            above, below = self.bracket("}"), self.bracket("}")
            return above / below
        if token in (r"\sin", r"\cos"):
            n = self.power()
            return (mp.sin if token == r"\sin" else mp.cos)(self.angle()) ** n
        if token == r"\hat":
            return self.values[rf"\hat{self.take()}"] ** self.power()
        if token == "O":
            self.bracket(")")
            return mpf(0)
        if self.peek() == "_":
            self.take()
            token = f"{token}_{self.group()}"
        if self.peek() == "^" and token.startswith("F"):
            self.take()
            return self.values[f"{token}^{self.group()}"]
        return self.values[token] ** self.power()


def point(order: int = 7) -> dict[str, Any]:
    """Values of everything the formulas mention."""
    names = {name: mpf(text) for name, text in POINT.items()}
    omega, xi = names["Omega"], names["xi"]
    values = {r"\Omega": omega, "s": names["s"], r"\xi": xi, r"\theta": omega * names["tau"]}
    values[r"\epsilon"] = names["epsilon"]
    values[r"\hat\epsilon"] = names["epsilon"] / mp.sin(omega)
    for j in range(1, order + 1):
        values[rf"\kappa_{j}"] = mp.cot(j * omega)
        values[rf"\sigma_{j}"] = mp.sin(j * omega * xi) / mp.sin(j * omega)
        if j > 1:
            values[f"T_{j}"] = sum(a * mp.cos(k * omega) for k, a in resonance_cosines(j))
    return values


def exact(expression: Any) -> Any:
    names = symbols()
    function = sympy.lambdify([names[n] for n in POINT], expression, modules="mpmath")
    return mpf(function(*(mpf(v) for v in POINT.values())))


def close(found: Any, wanted: Any) -> bool:
    return abs(found - wanted) <= mpf(10) ** -DIGITS * max(abs(wanted), mpf(10) ** -6)


@pytest.mark.slow
@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("order", [4, 5])
def test_every_equation_reads_back(order: int, style: str, column: str) -> None:
    forms, texts = closed_forms(order, style), files(order, style, column)
    with mp.workdps(DIGITS + 20):
        values, sine = point(), mp.sin(mpf(POINT["Omega"]))
        contact, shape = equations(texts["contact.tex"]), equations(texts["shape.tex"])
        for n in range(1, order + 1):
            found = Reader(contact[f"xi{n}"][1], values).value() / sine**n
            assert close(found, exact(forms.contact(n).expression)), n
        for n in range(order + 1):
            found = Reader(shape[f"w{n}"][1], values).value() / sine**n
            assert close(found, exact(forms.shape(n).expression)), n
        profile = equations(texts["profile.tex"])
        for j in range(order + 1):
            for n in range(j + 2, order + 1, 2):
                left, right = profile[f"F{j}:{n - j}"]
                assert left == f"F_{{{j}}}^{{({n - j})}}"
                part = Reader(right, values).value()
                assert close(part, exact(forms.profile_part(j, n))), (j, n)
                values[f"F_{j}^({n - j})"] = part
            found = Reader(profile[f"F{j}"][1], values).value()
            assert close(found, exact(forms.profile(j).expression)), j


# -- form ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("style", STYLES)
def test_every_formula_has_one_label(style: str) -> None:
    order = 6
    texts = files(order, style, "two")
    labels = [x for t in texts.values() for x in re.findall(r"\\label\{eq:rope:([^}]*)\}", t)]
    wanted = {"contact", "shape", "profile"}
    wanted |= {f"xi{n}" for n in range(1, order + 1)} | {f"w{n}" for n in range(order + 1)}
    wanted |= {f"F{j}" for j in range(order + 1)}
    wanted |= {f"F{j}:{n - j}" for j in range(order + 1) for n in range(j + 2, order + 1, 2)}
    assert len(labels) == len(set(labels))
    assert set(labels) == wanted


def test_symbols_are_defined_where_they_are_used() -> None:
    texts = files(6, "circular", "two")
    used = set(re.findall(r"T_\{\d+\}", texts["profile.tex"]))
    assert used
    assert all(rf"${symbol}\equiv" in texts["profile.tex"] for symbol in used)
    assert r"\kappa_{j}\equiv\cot j\Omega" in files(6, "cotangent", "two")["profile.tex"]


def exact_resonance(q: int) -> mpf:
    """ζ^{−φ/2} Φ_q(ζ), ζ = e^{2iΩ}, over the 2 that all its cosines share where q = 2^n."""
    zeta, roots = (
        mp.expjpi(2 * mpf(POINT["Omega"]) / mp.pi),
        [p for p in range(q) if gcd(p, q) == 1],
    )
    product = mp.fprod(zeta - mp.expjpi(mpf(2 * p) / q) for p in roots)
    value = mp.re(product * zeta ** (-mpf(len(roots)) / 2))
    return value / 2 if q in (2, 4, 8, 16) else value


@pytest.mark.parametrize("q", range(2, 17))
def test_the_factor_of_a_resonance_is_the_cyclotomic_polynomial_s(q: int) -> None:
    """In LaTeX and as text, also beyond the orders of the other tests: T_6 = 2 cos 2Ω − 1."""
    with mp.workdps(DIGITS + 20):
        wanted = exact_resonance(q)
        text = _resonance(q, 1).replace(" cos", "*cos")
        assert close(Reader(cosine_sum(q), point()).value(), wanted)
        assert close(eval(text, {"cos": mp.cos, "Omega": mpf(POINT["Omega"])}), wanted)


def test_second_harmonic_is_the_papers_and_fits_one_line() -> None:
    forms = closed_forms(3, "cotangent")
    assert profile_equation(forms, 2, "one") == (
        "\\begin{align}\n"
        r"F_{2}\sim{}&\frac{\Omega^{2}}{8}\Bigl[2(1-\cos\Omega s)-(1-\cos 2\Omega s)"
        r"-\kappa_{2}(2\Omega s-\sin 2\Omega s)\Bigr]+O(\epsilon^{2}) \label{eq:rope:F2}"
        "\n\\end{align}\n"
    )


def test_same_bytes_under_any_hash_seed() -> None:
    program = (
        "import hashlib\n"
        "from asymptotics import ClosedForms, exact_string, expand\n"
        "from asymptotics.printing.latex import formula_sets\n"
        "e = expand(exact_string(), 4)\n"
        "for style in ('cotangent', 'circular'):\n"
        "    files = formula_sets(ClosedForms(e, style=style), 'two')\n"
        "    print(hashlib.sha256(repr(sorted(files.items())).encode()).hexdigest())\n"
    )
    here = "".join(
        hashlib.sha256(repr(sorted(files(4, style, "two").items())).encode()).hexdigest() + "\n"
        for style in STYLES
    )
    for seed in ("1", "2"):
        run = subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        assert run.stdout == here


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
def test_source_lines_are_short_even_at_order_ten(style: str) -> None:
    for column in COLUMNS:
        for text in files(10, style, column).values():
            assert max(map(len, text.splitlines())) < 1000
            assert text.count("{") == text.count("}")


@pytest.mark.slow
def test_cut_denominators_say_the_same() -> None:
    """Order 9 in a narrow column, where denominators of sines and cosines stand in two parts."""
    order = 9
    cotangents, circular = (equations(files(order, s, "two")["profile.tex"]) for s in STYLES)
    cut = [x for x, (_, right) in circular.items() if ":" in x and r"\times \frac{1}{" in right]
    assert len(cut) > 3
    with mp.workdps(DIGITS + 20):
        values = point(order)
        for label in cut:
            found, wanted = (
                Reader(text[label][1], values).value() for text in (circular, cotangents)
            )
            assert close(found, wanted), label


# -- layout, by the widths -------------------------------------------------------------------------

ORDERS = [4, 6, 8, 9, 10]
Row = tuple[str, str, bool]


def displays(text: str) -> list[list[Row]]:
    """The aligns of a file, row by row: left of the alignment, right of it, numbered or not."""
    found = []
    for block in re.findall(r"\\begin\{align\}\n(.*?)\n\\end\{align\}", text, re.S):
        rows = []
        for row in re.split(r"\\\\(?:\[1ex\])?\n", block):
            left, right = row.split("&", 1)
            right = re.sub(r"\\nonumber|\\label\{[^}]*\}", "", right).strip()
            rows.append((left.replace("{}", " "), right.replace("{-}", "-"), "\\label" in row))
        found.append(rows)
    return found


def column_widths(rows: list[Row]) -> tuple[float, list[float]]:
    """The widest left part, and every right part."""
    left = max(width(f"{left} s") - width("s") for left, *_ in rows)
    return left, [width(right) for _, right, _ in rows]


def overhang(rows: list[Row], line: float, number: float, separation: float) -> float:
    r"""How far the widest row of an align stands out, by the rules of amsmath.

    The align is centred; then, from the last row on, a numbered row that comes close to its number
    moves it. ``separation`` is ``\minalignsep``: with less left than that beside row and number,
    the two are centred instead, whatever that does to the other rows.
    """
    left, rights = column_widths(rows)
    total = left + max(rights)
    shift = max((line - total) / 2, 0.0)
    for (*_, numbered), right in reversed(list(zip(rows, rights, strict=True))):
        inner = left + right + number
        if not numbered or inner + 10.0 > line or shift + inner + number <= line:
            continue
        rest = (line - inner) / 2
        shift = rest if rest < separation else min(shift, rest)
    return shift + total - line


@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("order", ORDERS)
def test_every_row_stays_in_the_column(order: int, style: str, column: str) -> None:
    line = COLUMNS[column].points
    for name, text in files(order, style, column).items():
        separation = 0.0 if r"\renewcommand{\minalignsep}{0pt}" in text else 10.0
        for rows in displays(text):
            left, rights = column_widths(rows)
            for (*_, row, _), right in zip(rows, rights, strict=True):
                assert left + right <= line, (name, row)
            for number in (12.8, 17.8, 22.8):
                assert overhang(rows, line, number, separation) <= 0.0, (name, rows)


def test_amsmath_pushes_rows_out_when_it_may() -> None:
    """The case that made the file set the separation: 4 pt, and no warning of TeX's."""
    rows = [row for block in displays(files(4, "cotangent", "two")["profile.tex"]) for row in block]
    assert 2.0 < overhang(rows, 246.0, 17.8, separation=10.0) < 6.0
    assert overhang(rows, 246.0, 17.8, separation=0.0) <= 0.0


@pytest.mark.parametrize("style", STYLES)
def test_long_formulas_have_an_align_of_their_own(style: str) -> None:
    blocks = displays(files(9, style, "two")["profile.tex"])
    assert max(len(rows) for rows in blocks) > 100
    for rows in blocks:
        assert len(rows) <= 60 or sum(numbered for *_, numbered in rows) == 1
    # And short ones share theirs, so that they stand aligned.
    assert len(displays(files(4, style, "two")["profile.tex"])) == 1


def test_an_align_takes_equations_as_long_as_their_rows_fit() -> None:
    sizes = [20, 20, 20, 1, 59, 1, 90, 30, 30]
    text = aligned("\\\\\n".join(["&a"] * size) for size in sizes)
    blocks = text.split("\\begin{align}\n")[1:]
    assert [block.count("&a") for block in blocks] == [60, 60, 1, 90, 60]


@pytest.mark.parametrize("order", [3, 4, 5])
def test_every_row_of_the_beam_stays_in_the_column(order: int) -> None:
    text = beam_latex(expand_symbolic(order))
    text = text[text.index("The amplitudes") :]
    for rows in displays(text):
        left, rights = column_widths(rows)
        assert max(left + right for right in rights) <= COLUMNS["two"].points


@pytest.mark.parametrize("style", STYLES)
def test_brackets_close_in_the_size_they_opened_in(style: str) -> None:
    for text in files(9, style, "two").values():
        for rows in displays(text):
            open_brackets: list[str] = []
            for _, right, numbered in rows:
                for size, bracket in re.findall(r"(\\[bB]ig[lr]|)([()\[\]])", right):
                    if bracket in "([":
                        open_brackets.append(size + bracket)
                    else:
                        opened = open_brackets.pop()
                        pair = opened[-1] + bracket
                        assert pair in ("()", "[]"), right
                        assert opened[:-1].replace("l", "r") == size, right
                assert not (numbered and open_brackets), right


# -- printed ---------------------------------------------------------------------------------------


def has_latex() -> bool:
    if not (shutil.which("pdflatex") and shutil.which("kpsewhich")):
        return False
    found = subprocess.run(["kpsewhich", "revtex4-2.cls"], capture_output=True, check=False)
    return bool(found.stdout.strip())


needs_latex = pytest.mark.skipif(not has_latex(), reason="pdflatex or REVTeX is not installed")


def compile_tex(folder: Path, name: str) -> str:
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", name]
    for _ in range(2):  # the second run resolves the labels
        subprocess.run(command, cwd=folder, capture_output=True, check=True)
    return (folder / name).with_suffix(".log").read_text(errors="replace")


# What amsmath makes of an align: how far its rows stand out. TeX itself does not warn of that.
EDGES = r"""\makeatletter\let\calculated\calc@shift@align
\def\calc@shift@align{\calculated
\typeout{EDGE \the\dimexpr\eqnshift@+\totwidth@-\displaywidth\relax}}\makeatother
\begin{document}"""


def check_log(log: str) -> None:
    assert "Overfull" not in log
    assert "undefined" not in log
    assert "multiply defined" not in log
    assert not re.search(r"^!", log, re.M)
    edges = [float(x) for x in re.findall(r"EDGE (-?[\d.]+)pt", log)]
    assert edges
    assert max(edges) <= 0.0


@pytest.mark.slow
@needs_latex
@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("order", [4, 6, 9])
def test_prints_within_the_column(order: int, style: str, column: str, tmp_path: Path) -> None:
    for name, text in files(order, style, column).items():
        text = text.replace(r"\begin{document}", EDGES)
        (tmp_path / name).write_text(text, encoding="utf-8")
    log = compile_tex(tmp_path, "supplement.tex")
    check_log(log)
    assert re.search(r"Output written on supplement\.pdf \([1-9]\d* pages", log)


@needs_latex
@pytest.mark.parametrize("column", COLUMNS)
def test_the_beam_prints_within_the_column(column: str, tmp_path: Path) -> None:
    expansion = expand_symbolic(4)
    ends = {end: beam_latex(expansion, end) for end in ("pinned", "clamped")}
    source = f"{COLUMNS[column].preamble}{EDGES}\n{''.join(ends.values())}\\end{{document}}\n"
    (tmp_path / "beam.tex").write_text(source, encoding="utf-8")
    check_log(compile_tex(tmp_path, "beam.tex"))


LONG = moving_contact(
    equation=sp.Eq(
        W.diff(tau, 2)
        + 2 * sp.Symbol("zeta") * W.diff(tau)
        + sp.Symbol("rho") * W.diff(xi, 2, tau, 2),
        W.diff(xi, 2)
        - sp.sqrt(2 * sp.Symbol("kappa_1") / 3) * W
        - 2
        - xi / 5
        - sp.Symbol("beta") * W.diff(xi, 4),
    ),
    driven_end=[
        sp.Eq(
            W, 1 + epsilon * (sp.cos(Omega * tau) + sp.cos(3 * Omega * tau + sp.Symbol("phi")) / 7)
        ),
        sp.Eq(W.diff(xi, 2), sp.Symbol("nu") * W.diff(xi, 1, tau, 1)),
    ],
    contact=[W, W.diff(xi), W.diff(xi, 2)],
    ground=xi / 9,
)


@needs_latex
@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize(
    ("rope", "order"),
    [(presets.string(foundation=sp.Symbol("kappa")), 4), (presets.beam(damping=0.1), 3), (LONG, 2)],
)
def test_any_rope_prints_within_the_column(
    column: str, rope: MovingContact, order: int, tmp_path: Path
) -> None:
    forms = rope_forms(rope, order)
    page = rope_document(forms, "rope.tex", column).replace(r"\begin{document}", EDGES)
    (tmp_path / "rope.tex").write_text(rope_latex(forms, column=column), encoding="utf-8")
    (tmp_path / "page.tex").write_text(page, encoding="utf-8")
    check_log(compile_tex(tmp_path, "page.tex"))


@needs_latex
def test_widths_are_those_of_tex(tmp_path: Path) -> None:
    texts = [files(5, style, "one")["profile.tex"] for style in STYLES]
    texts.append(files(9, "circular", "two")["profile.tex"])
    beam = beam_latex(expand_symbolic(4))
    rope = rope_latex(rope_forms(presets.string(damping=0.1), 4))
    texts += [text[text.index("The amplitudes") :] for text in (beam, rope)]
    lines = [right for text in texts for rows in displays(text) for _, right, _ in rows]
    boxes = "".join(f"\\sbox0{{$\\displaystyle{{}}{x}$}}\\typeout{{W \\the\\wd0}}\n" for x in lines)
    source = f"\\documentclass{{article}}\\begin{{document}}\n{boxes}\\end{{document}}\n"
    (tmp_path / "w.tex").write_text(source, encoding="utf-8")
    printed = [float(w) for w in re.findall(r"W ([\d.]+)pt", compile_tex(tmp_path, "w.tex"))]
    assert len(printed) == len(lines) > 200
    for line, wanted in zip(lines, printed, strict=True):
        assert -0.5 <= width(line) - wanted <= 0.03 * wanted + 3, line


@pytest.mark.parametrize(("count", "filled"), [(5, [3, 2]), (6, [3, 3]), (7, [3, 3, 1])])
def test_of_fillings_with_equally_many_lines_the_fullest_first(
    count: int, filled: list[int]
) -> None:
    """[2, 3] and [3, 1, 3] would fit as well."""
    items = [Piece("s", 0), *(Piece("+s", 0) for _ in range(count - 1))]
    lines = break_lines(items, Limits(width("+s+s+s") + 1))
    assert [line.count("s") for line in lines] == filled


# -- arguments -------------------------------------------------------------------------------------


def test_bad_arguments_name_the_remedy() -> None:
    forms = closed_forms(4, "cotangent")
    with pytest.raises(InputError, match="'three'; choose one of two, one"):
        formula_sets(forms, "three")
    with pytest.raises(InputError, match="not closed forms; give ClosedForms"):
        formula_sets("forms")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"j = 5 is not part of order 4; give 0 ≤ j ≤ 4"):
        profile_equation(forms, 5)
    with pytest.raises(InputError, match=r"n = 0 is not part of order 4; give 1 ≤ n ≤ 4"):
        contact_equation(forms, 0)
    with pytest.raises(InputError, match=r"n = 1\.5 is not an integer"):
        shape_equation(forms, 1.5)  # type: ignore[arg-type]
