"""``ropewave resonances``, ``tongue`` and ``fold``, as a person or a program uses them."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
import sympy

from derivations.app import main


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(list(arguments))
    return int(caught.value.code or 0)


def test_resonances(capsys: pytest.CaptureFixture[str]) -> None:
    """The table of the beam's spectrum, and the string's multiples of π."""
    assert run("resonances", "--beta", "0.01", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["omega"][:3] == pytest.approx([3.2500, 7.1777, 12.2343], abs=5e-5)
    assert found["xi0"] == pytest.approx(1.10498407, abs=5e-9)
    assert run("resonances", "--beta", "0", "--driven-end", "clamped", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["omega"] == pytest.approx([n * 3.141592653589793 for n in range(1, 6)])
    assert {"p", "q", "omega"} <= found["nonlinear"][0].keys()


def test_tongue(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("tongue", "1/1", "--order", "3", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["exponent"] == "5/3"
    for sign in "+-":
        assert found["coefficient"][sign] == pytest.approx(0.309, abs=5e-4)
        assert found["contact"][sign]["s"] * 3.141592653589793 == pytest.approx(-1.13, abs=5e-3)
    assert sympy.sympify(found["singular"]["3"]) == -(sympy.pi**5) / 64


def test_fold(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("fold", "1/2", "--beta", "0.01", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["exponent"], found["side"]) == ("3/4", "below")
    assert found["coefficient"] == pytest.approx(0.995778, abs=5e-7)
    assert found["resonance"] == pytest.approx(1.62500065, abs=5e-9)
    assert found["kind"] == "end"
    assert 0.01 < found["range"]["mu"] < 0.05


@pytest.mark.slow
def test_fold_at_the_edge_of_doubles(capsys: pytest.CaptureFixture[str]) -> None:
    """JSON has no NaN, whatever β; the law has a limit as β → ∞."""

    def refuse(constant: str) -> float:
        raise AssertionError(constant)

    assert run("fold", "1/1", "--beta", "1e308", "--json") == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    found = json.loads(captured.out, parse_constant=refuse)
    assert found["coefficient"] == pytest.approx(0.115844, abs=1e-6)
    assert run("fold", "1/3", "--beta", "1e-12", "--json") == 0
    json.loads(capsys.readouterr().out, parse_constant=refuse)


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ("resonances", "--beta", "0.01", "--count", "2", "--order", "2"),
        ("tongue", "2/1", "--order", "3"),
        ("fold", "1/1", "--beta", "0.001"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_text_table_and_figure(
    arguments: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        extras = ("--plot", str(tmp_path / f"{name}.svg"), "--latex", str(tmp_path / f"{name}.tex"))
        assert run(*arguments, *extras) == 0
        captured = capsys.readouterr()
        assert captured.out.count("\n") > 3
        assert captured.out.endswith("\n")
        assert captured.err.count("wrote ") == 2
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    table = (tmp_path / "a.tex").read_text(encoding="utf-8")
    assert table == (tmp_path / "b.tex").read_text(encoding="utf-8")
    assert table.count("\\begin{tabular}") == table.count("\\end{tabular}") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["resonances", "--beta", "-1"],
            "'--beta': Input should be greater than or equal to 0, not '-1'",
        ),
        (
            ["resonances", "--beta", "nan"],
            "'--beta': Input should be greater than or equal to 0, not 'nan'",
        ),
        (["resonances", "--beta", "0.1", "--driven-end", "free"], "free"),
        (
            ["resonances", "--count", "0"],
            "'--count': Input should be greater than or equal to 1, not '0'",
        ),
        (["tongue", "2/4"], "not in lowest terms"),
        (["tongue", "half"], "half"),
        (["tongue", "1/5", "--order", "4"], "give an order ≥ 5"),
        (["tongue", "1/1", "--plot", "x.bmp"], "ends in .pdf, .png, .svg"),
        (["fold", "1/1", "--beta", "0"], "beta = 0"),
        (["fold", "1/0"], "q = 0"),
        (["fold", "1/50"], "q = 50: the fold needs the expansion of order q + 4"),
        (["fold", "1/1", "--beta", "5e-324"], "leave the range of double precision"),
        (["fold", "1/1", "--driven-end", "loose"], "loose"),
    ],
)
def test_bad_input_is_one_clear_error(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*arguments) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_free_frequencies_of_a_rope_by_options_and_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "rope.toml"
    file.write_text(
        'equation = "W_tautau = W_xixi - 2 - kappa*W"\n'
        'driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]\ncontact = ["W", "W_xi"]\n'
        "[parameters]\nkappa = 1.7\n"
    )
    given = ["--problem", str(file), "--set", "kappa=2", "--count", "2"]
    assert run("resonances", *given, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    place = found["static_contact"]
    for row in found["linear"]:
        assert abs(row["omega"] ** 2 - 2 - (row["p"] * math.pi / place) ** 2) < 1e-9
        assert row["decay"] == 0
    first = found["nonlinear"][0]
    assert (first["p"], first["q"]) == (1, 3)
    assert run("resonances", "--beta", "0.01", "--damping", "0.1") == 0
    assert "omega_p" in capsys.readouterr().out
    assert run("resonances", "--damping", "0.1", "--plot", "a.png") == 2
