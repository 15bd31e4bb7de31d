"""The commands on a rope that is not the paper's string."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asymptotics import expand
from asymptotics.problems import presets
from asymptotics.problems.symbols import Omega
from asymptotics.values.rope import evaluate_rope
from derivations.app import main
from derivations.commands.ropes import drive_of
from tests.command import said

FILE = """
equation = "W_tautau = W_xixi - 2 - kappa*W"
driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]
contact = ["W", "W_xi"]

[parameters]
kappa = 1.7
"""


@pytest.fixture
def problem(tmp_path: Path) -> str:
    path = tmp_path / "rope.toml"
    path.write_text(FILE, encoding="utf-8")
    return str(path)


def test_evaluate_a_problem_file(problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["evaluate", "--problem", problem, "--omega", "2.2", "--epsilon", "0.01", "--json"]
    code, out, _ = said([*line, "--order", "3", "--tau", "0,1", "--s=-0.5,0"], capsys)
    found = json.loads(out)
    assert code == 0
    assert found["static_contact"] == pytest.approx(math.acosh(1.85) / math.sqrt(1.7), rel=1e-15)
    assert found["parameters"] == {"kappa": 1.7, "Omega": 2.2}
    series = expand(presets.string(foundation=1.7), 3, at={Omega: 2.2})
    wanted = found["static_contact"] + sum(
        0.01**n * (2 if j else 1) * c * math.cos(j * 2.2)
        for n in (1, 2, 3)
        for j, c in series.contact(n).items()
    )
    assert found["contact"][1] == pytest.approx(wanted, rel=1e-14)
    assert found["profile"][1][1] == 0
    _, out, _ = said([*line, "--set", "kappa=0"], capsys)
    string = ["evaluate", "--omega", "2.2", "--epsilon", "0.01", "--json"]
    _, plain, _ = said(string, capsys)
    assert json.loads(out)["contact"] == pytest.approx(json.loads(plain)["contact"], rel=1e-13)


def test_derive_a_problem_file(problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["derive", "--problem", problem, "--omega", "2.2", "--order", "2"]
    code, out, _ = said(line, capsys)
    assert code == 0
    assert "xi_1 = +0.890012519029" in out
    assert "order 2: consistent to" in out
    _, out, _ = said([*line, "--json"], capsys)
    found = json.loads(out)
    assert found["contact"][1]["2"][0] == pytest.approx(-0.794087307576, rel=1e-12)


def test_options_make_the_same_rope(capsys: pytest.CaptureFixture[str]) -> None:
    """A damped clamped beam under two frequencies is one line."""
    line = [
        "evaluate",
        "--omega",
        "2.2",
        "--epsilon",
        "0.01",
        "--json",
        "--beta",
        "0.01",
        "--driven-end",
        "clamped",
    ]
    code, out, _ = said([*line, "--damping", "0.1", "--drive", "1: 1, 3: 0.2@0.5"], capsys)
    assert code == 0
    rope = presets.beam(
        beta=0.01, driven_end="clamped", damping=0.1, drive={1: (1, 0), 3: (0.2, 0.5)}
    )
    wanted = evaluate_rope(rope, {"Omega": 2.2}, 0.01, 4, None, [0.0])
    assert json.loads(out)["contact"] == pytest.approx(wanted.contact.tolist(), rel=1e-14)
    assert np.ravel(json.loads(out)["profile"]) == pytest.approx(wanted.profile.ravel(), abs=1e-12)


def test_a_period_of_it_is_drawn(problem: str, tmp_path: Path) -> None:
    picture = tmp_path / "rope.png"
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "--problem", problem, "--omega", "2.2", "--epsilon", "0.02",
              "--plot", str(picture)])  # fmt: skip
    assert not ended.value.code
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--set", "kappa=2"], "there is no file"),
        (["--driven-end", "clamped"], "give --beta > 0"),
        (["--drive", "1"], "is not harmonic"),
        (["--drive", "1: x"], "is not harmonic"),
        (["--drive", "1: 1, 1: 2"], "each harmonic once"),
        (["--drive", "1: 1@nan"], "is not harmonic"),
        (["--problem", "none.toml"], "cannot be read"),
        (["--beta", "nan"], "greater than or equal to 0"),
    ],
)
def test_bad_options(arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(["evaluate", "--omega", "2.2", "--epsilon", "0.01", *arguments], capsys)
    assert (code, out) == (2, "")
    assert reason in err
    assert err.count("ropewave: error: ") == 1


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--beta", "0.1"], "the file says what the rope is"),
        (["--set", "kappa"], "write name=value"),
        (["--set", "kappa=two"], "is not a finite number"),
        (["--set", "mu=2"], "mu is no parameter"),
    ],
)
def test_bad_options_beside_a_file(
    problem: str, arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["evaluate", "--omega", "2.2", "--epsilon", "0.01", "--problem", problem]
    code, _, err = said([*line, *arguments], capsys)
    assert code == 2
    assert reason in err


def test_derive_writes_the_formulas_of_it(
    problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "x"
    order = ["--order", "2", "--out", str(folder)]
    code, out, _ = said(["derive", "--problem", problem, *order], capsys)
    assert code == 0
    assert "xi_2_2 = -1/4*S1_1**2*alpha3" in out
    assert {path.name for path in folder.iterdir()} == {
        "rope-order2-page.tex",
        "rope-order2.json",
        "rope-order2.tex",
        "rope-order2.txt",
        "rope_order2.mjs",
        "rope_order2.py",
    }
    written = json.loads((folder / "rope-order2.json").read_text())
    assert written["contact"]["xi_1_1"] == "-S1_1"
    assert written["parameters"] == ["kappa", "Omega"]
    namespace: dict[str, Any] = {}
    exec((folder / "rope_order2.py").read_text(), namespace)
    assert abs(namespace["harmonics"](2.2, kappa=1.7)[2, 2] + 0.794087307576) < 1e-12


@pytest.mark.parametrize("format", ["text", "latex", "numpy", "javascript", "json"])
def test_each_format_names_the_parameters_of_the_options(
    format: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """β and ζ are parameters of the formulas, not seventeen digits in them."""
    options = ["--beta", "0.01", "--damping", "0.1", "--order", "2", "--format", format]
    code, out, _ = said(["derive", *options], capsys)
    assert code == 0
    assert "beta" in out
    assert "zeta" in out
    assert "0.01" not in out.replace("epsilon, 0.01", "")


def test_a_rope_whose_tension_varies_has_formulas_but_no_modules(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "rope.toml"
    file.write_text(
        'equation = "W_tautau = (1 + xi/4)*W_xixi + W_xi/4 - 2"\n'
        'driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]\ncontact = ["W", "W_xi"]\n'
    )
    folder = tmp_path / "x"
    order = ["--order", "2", "--out", str(folder)]
    code, _, err = said(["derive", "--problem", str(file), *order], capsys)
    assert code == 0
    assert "no modules" in err
    assert {path.suffix for path in folder.iterdir()} == {".tex", ".json", ".txt"}
    code, _, err = said(["derive", "--problem", str(file), "--format", "numpy"], capsys)
    assert code == 2
    assert "constant coefficients" in err


def test_what_derive_draws_is_the_string(problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = said(["derive", "--problem", problem, "--plot", "a.png"], capsys)
    assert code == 2
    assert "evaluate --plot draws" in err


def test_drives() -> None:
    found = drive_of(" 0: 0.1 ,2:1e-1 @ -0.5,3: 1/3")
    assert {n: (float(a), float(b)) for n, (a, b) in found.items()} == {
        0: (0.1, 0.0),
        2: (0.1, -0.5),
        3: (1 / 3, 0.0),
    }
