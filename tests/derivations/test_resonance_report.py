"""Tables and figure of the resonances; the paper's Fig. 2 centres."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from asymptotics.errors import InputError
from asymptotics.problems.beam_spectrum import linear_frequencies
from derivations.figure2.centres import figure2_centres, stiffness_of_centres
from derivations.reports.resonances import (
    as_json,
    as_text,
    latex_table,
    plot_spectrum,
    resonance_table,
)


@pytest.mark.parametrize("end", ["pinned", "clamped"])
@pytest.mark.parametrize("beta", [0.0, 0.01, 1e8])
def test_json(beta: float, end: str) -> None:
    table = resonance_table(beta, end, count=4, order=3)
    result = json.loads(json.dumps(as_json(table), allow_nan=False))
    assert {"command", "beta", "driven_end", "xi0", "omega", "nonlinear"} <= result.keys()
    assert (result["command"], result["beta"], result["driven_end"]) == ("resonances", beta, end)
    assert result["omega"] == linear_frequencies(beta, 4, end).tolist()
    assert result["ratio"][1] == pytest.approx(result["omega"][1] / (2 * math.pi), rel=1e-15)
    assert [r["omega"] for r in result["nonlinear"]] == sorted(
        r["omega"] for r in result["nonlinear"]
    )
    for r in result["nonlinear"]:
        assert r["first_order"] == r["q"] <= 3
        # hertz at Z₀ = 81 cm: Ω/2π √(g/2Z₀)
        expected = r["omega"] / (2 * math.pi) * math.sqrt(9.80665 / 1.62)
        assert r["hertz"] == pytest.approx(expected, rel=1e-14)
    pairs = {(r["p"], r["q"]) for r in result["nonlinear"]}
    assert {(p, 1) for p in range(1, 5)} <= pairs
    assert ((2, 2) in pairs) is (beta > 0)


@pytest.mark.parametrize(
    ("beta", "end", "shown"),
    [(0.01, "pinned", 4), (0.001, "pinned", 4), (0.01, "clamped", 0), (0.0, "pinned", 0),
     (0.02, "pinned", 0)],
)  # fmt: skip
def test_the_papers_centres_stand_beside_their_own_rope_only(
    beta: float, end: str, shown: int
) -> None:
    table = resonance_table(beta, end, count=1, order=1)
    assert len(as_json(table)["figure2"]) == shown
    assert ("Fig. 2" in as_text(table)) is (shown > 0)


def test_text_and_latex_hold_every_row() -> None:
    table = resonance_table(0.01, "clamped", count=3, order=2)
    text, latex = as_text(table), latex_table(table)
    for row in table.linear:
        assert f"{row.omega:.11g}" in text
        assert f"{row.n} & {row.omega:.7f} & {row.ratio:.6f} & {row.hertz:.4f} \\\\" in latex
    for r in table.nonlinear:
        assert re.search(rf"^ +{r.p}/{r.q} +{r.omega:.11g} ", text, re.MULTILINE)
    assert "18.69 %" in text
    assert "41.68 %" in as_text(resonance_table(0.01))
    assert latex.startswith(r"\begin{tabular}{rrrr}")
    assert latex.count("&") == 3 * 4
    assert "rule" not in latex


def test_figure2_centres_are_not_the_linear_resonances() -> None:
    first, second, third, fourth = figure2_centres()
    assert (first.n, first.printed, first.beta) == (1, 3.2, 0.01)
    assert (second.n, second.printed, second.beta) == (2, 6.4, 0.01)
    # Ω₁ misses by half a printed digit and a little, Ω₂ by 0.78; β = 0.001 would agree
    assert first.difference == pytest.approx(0.0500013, abs=1e-7)
    assert second.difference == pytest.approx(0.7777, abs=1e-4)
    assert (first.agrees, second.agrees, third.agrees, fourth.agrees) == (False, False, True, True)
    assert (third.computed, fourth.computed) == pytest.approx((3.155, 6.396), abs=0.5e-3)
    # a clamped end does not rescue the second one
    assert not figure2_centres(driven_end="clamped")[1].agrees
    for row in figure2_centres():
        at = linear_frequencies(row.beta_of_printed, row.n)[-1]
        assert at == pytest.approx(row.printed, rel=1e-14)


def test_no_single_stiffness_has_centres_in_the_ratio_two() -> None:
    rows = figure2_centres()
    assert rows[0].beta_of_printed > 4 * rows[1].beta_of_printed > 0
    low, high = stiffness_of_centres()
    assert low < 0.001 < high < 0.01
    for beta, inside in (
        (low * 0.99, False),
        (low * 1.01, True),
        (high * 0.99, True),
        (0.01, False),
    ):
        assert all(row.agrees for row in figure2_centres((beta,))) is inside


@pytest.mark.slow
def test_figure(tmp_path: Path) -> None:
    table = resonance_table(0.001, "clamped", count=3, order=2)
    drawn = plot_spectrum(tmp_path / "spectrum.svg", table)
    plot_spectrum(tmp_path / "again.svg", table)
    content = (tmp_path / "spectrum.svg").read_bytes()
    assert content == (tmp_path / "again.svg").read_bytes()
    assert len(content) > 10_000
    expected = linear_frequencies(drawn["beta"], 3, "clamped")
    assert drawn[3, 1] == pytest.approx(expected[:, 2], rel=1e-15)
    assert drawn[1, 2] == pytest.approx(expected[:, 0] / 2, rel=1e-15)
    assert set(drawn) - {"beta"} == {(1, 1), (2, 1), (3, 1)} | {(r.p, r.q) for r in table.nonlinear}
    # print without colour: each n has its own line style
    assert b"stroke-dasharray" in content
    plot_spectrum(tmp_path / "spectrum.png", table)
    assert (tmp_path / "spectrum.png").stat().st_size > 5_000


@pytest.mark.slow
def test_the_figure_is_of_the_rope_that_was_asked_for(tmp_path: Path) -> None:
    tables = [
        resonance_table(0.01),
        resonance_table(0.01, "clamped"),
        resonance_table(0.01, order=2),
        resonance_table(0.01, count=3),
        resonance_table(0.1),
    ]
    pictures = set()
    for i, table in enumerate(tables):
        path = tmp_path / f"{i}.svg"
        plot_spectrum(path, table)
        pictures.add(path.read_bytes())
    assert len(pictures) == len(tables)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda path: resonance_table(-0.1), "beta = -0.1"),
        (lambda path: resonance_table("x"), "beta = 'x' is not a number"),
        (lambda path: resonance_table(0.1, "free"), "choose one of pinned, clamped"),
        (lambda path: resonance_table(0.1, count=0), "count = 0"),
        (lambda path: resonance_table(0.1, order=0), "order = 0"),
        (lambda path: resonance_table(math.inf), "stiff_limit"),
        (lambda path: plot_spectrum(path / "a.bmp", resonance_table(0.0)), "cannot draw 'a.bmp'"),
        (lambda path: figure2_centres((math.nan,)), "beta = nan"),
        (lambda path: stiffness_of_centres("free"), "choose one of"),
    ],
)
def test_refuses(call, message, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        call(tmp_path)
    assert list(tmp_path.iterdir()) == []
