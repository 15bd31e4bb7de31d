"""What ``ropewave fold`` shows: text, table and figure say what it is and how far it holds."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from asymptotics.errors import InputError
from asymptotics.resonances.folds import Kind, fold
from derivations.reports.folds import coefficient_curve, fold_table, fold_text, plot_fold
from tests.asymptotics.test_latex import compile_tex, needs_latex


def test_text_names_law_side_and_shift() -> None:
    first = fold_text(fold(1, 1, 0.01))
    assert "Omega_1/1 = 3.25000130 (pinned driven end, beta = 0.01)" in first
    assert "mu a = F eps + alpha a^3" in first
    assert "gamma" not in first
    assert "|mu|^(3/2), below Omega_1/1" in first
    assert "at beta = 0: eps = 0.125 |mu|^(2), the law of another rope" in first
    third = fold_text(fold(1, 3, 0.01))
    assert "(3mu - gamma eps^2) a = F eps^3 + alpha a^3" in third
    assert "below the shifted resonance" in third
    assert "in mu itself eps = 9.30826 |mu|^(1/2), above" in third


def test_text_prints_the_shift_at_q_2() -> None:
    """β = 1, Ω₁/2: C |μ|^{3/4} alone is 24 % off at μ = −0.05, with γ 6 %."""
    result = fold(1, 2, 1.0)
    text = fold_text(result)
    assert "|mu - gamma eps^2/2|^(3/4), below the shifted resonance" in text
    line = next(line for line in text.splitlines() if "that is mu = " in line)
    found = re.findall(r"([+-]?) ?(-?[\d.]+) eps\^\(([\d/]+)\)", line)
    assert [power for _, _, power in found] == ["4/3", "2"]
    epsilon = float(result.epsilon(-0.05))
    powers = (4 / 3, 2)
    mu = sum(float(s + c) * epsilon**m for (s, c, _), m in zip(found, powers, strict=True))
    assert mu == pytest.approx(-0.05, rel=1e-4)
    alone = result.coefficient.value * 0.05**0.75
    assert alone / 0.154098 - 1 == pytest.approx(-0.242, abs=1e-3)


def test_text_says_what_follows_and_how_far() -> None:
    first = fold_text(fold(1, 1, 0.01))
    assert "fold  ends the branch from rest" in first
    assert "at fixed Omega below Omega_1/1: raising epsilon from rest, the wave-less state" in first
    assert "sweeping Omega up from far below, the small state ends here" in first
    [line] = [line for line in first.splitlines() if line.startswith("range")]
    reach, epsilon, slope, end = map(float, re.findall(r"\d+\.\d+|\d+(?=%)", line)[:4])
    assert (0.03 < reach < 0.053, epsilon, slope) == (True, 0.00125, 1.9)
    assert end == pytest.approx(100 * 1.9 * reach, abs=0.5)
    assert "terms through order 7 move the fold by more than 10%" in first
    assert "meet" not in first
    birth = fold_text(fold(1, 4, 0.01))
    assert "fold  birth of a disconnected pair" in birth
    assert "above Omega_1/4: raising epsilon from rest, the wave-less state passes through" in birth
    assert "that is mu = 0.186499 eps^(2) - 0.0650286 eps^(8/3)" in birth
    nowhere = fold_text(dataclasses.replace(fold(1, 1, 0.01), range=None))
    assert "range  none\n  the law was found to hold at no detuning down to 1e-40" in nowhere


def test_table_has_a_column_a_fold() -> None:
    results = [fold(1, 1, 0.01, "clamped"), fold(1, 3, 0.01), fold(2, 1, 1e-6)]
    table = fold_table(results)
    assert table.count("\\begin{tabular}") == table.count("\\end{tabular}") == 2
    rows = dict(
        line.removesuffix(r" \\").split(" & ", 1)
        for line in table.split("\\end{tabular}")[0].splitlines()
        if line.endswith(r"\\")
    )
    assert rows["$p/q$"] == "1/1 & 1/3"
    assert rows["driven end"] == "clamped & pinned"
    assert rows["from rest"] == "ends & passes"
    assert rows[r"$\gamma$"].startswith("-- & $")
    assert re.fullmatch(r"\$0\.0\d+\$ & \$5\.\d+\\times10\^\{-5\}\$", rows[r"$|\mu|\le$"])
    assert r"$10^{-6}$" in table or r"$1\times10^{-6}$" in table
    assert not re.search(r"\de[-+]?\d", table)
    empty = fold_table([dataclasses.replace(results[0], range=None)])
    assert empty.count("& --") == 4
    with pytest.raises(InputError, match="no folds"):
        fold_table([])


@pytest.mark.slow
@needs_latex
def test_tables_fit_the_column_of_a_letter(tmp_path: Path) -> None:
    results = [fold(1, 3, 0.01, "clamped"), fold(3, 4, 1e-6, "clamped"), fold(1, 1, 1e-7)]
    source = (
        "\\documentclass[reprint,prl,amsmath,amssymb,twocolumn]{revtex4-2}\n"
        f"\\begin{{document}}\n\\noindent\n{fold_table(results)}\\end{{document}}\n"
    )
    (tmp_path / "t.tex").write_text(source, encoding="utf-8")
    assert "Overfull" not in compile_tex(tmp_path, "t.tex")


@pytest.mark.slow
def test_figures_have_the_same_bytes_every_time(tmp_path: Path) -> None:
    result = fold(2, 1, 0.01)
    first, second = (tmp_path / f"{name}.svg" for name in "ab")
    plot_fold(result, first)
    plot_fold(result, second)
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 5_000


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 3)])
def test_the_figure_stops_where_the_law_does(
    p: int, q: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from matplotlib.figure import Figure

    drawn: list[Figure] = []
    monkeypatch.setattr(
        "derivations.figures.plots.save_figure", lambda figure, path: drawn.append(figure)
    )
    result = fold(p, q, 0.01)
    assert result.range is not None
    plot_fold(result, tmp_path / "a.svg")
    plot_fold(dataclasses.replace(result, range=None), tmp_path / "b.svg")
    left, right = drawn[0].axes
    law = left.lines[0]
    assert law.get_label().startswith("fold")
    assert law.get_xdata().max() == pytest.approx(result.range.mu)
    assert law.get_ydata().max() == pytest.approx(result.range.epsilon)
    assert max(line.get_xdata().max() for line in left.lines) <= result.range.mu * (1 + 1e-12)
    assert [text.get_text() for text in left.texts] == [f"law ends: {result.range.error:.0%} off"]
    assert result.kind.value in left.get_title()
    assert result.mu_side in left.get_xlabel()
    labels = [line.get_label() for line in right.lines]
    assert ("birth of a pair, above" in labels) == (q == 3)
    bare = drawn[1].axes[0]
    assert bare.lines[0].get_label() == "fold: its law has no range"
    assert len(bare.lines[0].get_xdata()) == 0


def test_a_file_name_that_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ends in .pdf, .png, .svg"):
        plot_fold(fold(1, 1, 0.01), tmp_path / "fold.bmp")


def test_the_curve_changes_side_where_alpha_does() -> None:
    """p = 2: α passes zero near β = 0.005 and a pole, Ω₃ = 2Ω₂, near β = 0.2."""
    beta = [1e-3, 1e-2, 1.0]
    folds = coefficient_curve(2, 1, beta)
    assert [f.sign for f in folds] == [-1, 1, -1]
    assert [f.kind for f in folds] == [Kind.END] * 3
    singles = [fold(2, 1, b).coefficient.value for b in beta]
    assert [f.coefficient.value for f in folds] == singles


def test_the_curve_refuses_bad_input() -> None:
    with pytest.raises(InputError, match="ask for 1/2"):
        coefficient_curve(2, 4, [0.01])
    with pytest.raises(InputError, match=r"beta = -1.0"):
        coefficient_curve(1, 1, [0.01, -1.0])
