"""The command, as a person or a program uses it."""

from __future__ import annotations

import gzip
import importlib.util
import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import sympy

from asymptotics.expansion.storage import _seal
from derivations.app import GOLDEN, main
from derivations.reports import formats


@pytest.fixture(autouse=True)
def _cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROPEWAVE_CACHE", str(tmp_path / "cache"))


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(list(arguments))
    return int(caught.value.code or 0)


def test_derive_prints_every_formula_with_its_proof(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("derive", "--order", "4") == 0
    out = capsys.readouterr().out
    for j in range(5):
        assert f"\nF_{j} = " in out
        assert f"  order {j}: proved (PDE residual 0, driven end 0, contact 0;" in out


def test_derive_json_is_one_object_that_sympy_parses(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("derive", "--order", "5", "--json") == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    result = json.loads(captured.out)
    assert [o["order"] for o in result["orders"]] == [1, 2, 3, 4, 5]
    assert all(o["proved"] for o in result["orders"])
    omega = sympy.Symbol("Omega")
    second = sympy.sympify(result["orders"][1]["contact"]["2"])
    expected = -(omega**3) * sympy.cot(2 * omega) / 8 / sympy.sin(omega) ** 2
    assert sympy.simplify(second - expected) == 0
    names = {"Omega", "epsilon", "s", "xi"}
    for order in result["orders"]:
        for text in (*order["contact"].values(), *order["shape"].values()):
            assert {x.name for x in sympy.sympify(text).free_symbols} <= names
    assert sorted(result["profile"]) == ["0", "1", "2", "3", "4", "5"]


@pytest.mark.slow
def test_derive_writes_every_format(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "new" / "folder"
    assert run("derive", "--order", "3", "--out", str(out), "--plot", str(out / "p.pdf")) == 0
    assert {path.name for path in out.iterdir()} == {
        "string-order3.txt", "string-order3.json", "string_order3.py", "string_order3.mjs", "p.pdf",
        "contact.tex", "shape.tex", "profile.tex", "supplement.tex",
    }  # fmt: skip
    spec = importlib.util.spec_from_file_location("emitted", out / "string_order3.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    capsys.readouterr()
    assert run("evaluate", "--omega", "0.83", "--epsilon", "0.02", "--order", "3", "--s",
               "-0.5,0", "--tau", "0,1", "--json") == 0  # fmt: skip
    result = json.loads(capsys.readouterr().out)
    for time, contact, row in zip([0.0, 1.0], result["contact"], result["profile"], strict=True):
        assert module.contact(time, 0.83, 0.02) == pytest.approx(contact, rel=1e-14)
        assert module.profile(-0.5, time, 0.83, 0.02) == pytest.approx(row[0], rel=1e-14)
        assert row[1] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("format", ["text", "latex", "numpy", "javascript", "json"])
def test_one_format_goes_to_the_screen(format: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("derive", "--order", "2", "--format", format) == 0
    out = capsys.readouterr().out
    marks = {"text": "F_2 =", "latex": "\\label{eq:rope:F2", "numpy": "def profile(", "json": "{"}
    marks["javascript"] = "export function profile("
    assert marks[format] in out


def test_beyond_the_last_page_the_useful_formats_are_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a high order nobody gets pages unasked: one line says so, and how to get them."""
    monkeypatch.setattr(formats, "LAST_PAGE", 2)
    useful = {"string-order3.json", "string_order3.mjs", "string_order3.py"}
    assert run("derive", "--order", "3", "--out", str(tmp_path / "a")) == 0
    assert {path.name for path in (tmp_path / "a").iterdir()} == useful
    captured = capsys.readouterr()
    line = "order 3 would fill hundreds of pages: text and LaTeX are left out; --format text or"
    assert captured.err.count(line) == 1
    assert "F_2 = " not in captured.out
    assert captured.out.count("proved") == 4

    assert run("derive", "--order", "3") == 0
    captured = capsys.readouterr()
    assert "the formulas are left out; --out writes them as NumPy and JSON" in captured.err
    assert "F_2 = " not in captured.out
    assert captured.out.count("proved") == 4

    # Asked for by name they are written, and shown; an order below the limit has them all.
    assert run("derive", "--order", "3", "--format", "text", "--out", str(tmp_path / "b")) == 0
    assert {path.name for path in (tmp_path / "b").iterdir()} == {"string-order3.txt"}
    assert run("derive", "--order", "3", "--format", "latex") == 0
    captured = capsys.readouterr()
    assert "left out" not in captured.err
    assert r"\label{eq:rope:F2}" in captured.out
    assert run("derive", "--order", "2") == 0
    captured = capsys.readouterr()
    assert "left out" not in captured.err
    assert "F_2 = " in captured.out

    assert run("derive", "--order", "3", "--json", "--out", str(tmp_path / "c")) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    assert {Path(name).name for name in json.loads(captured.out)["files"]} == useful


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_figures_are_the_same_bytes_every_time(tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        assert run("evaluate", "--omega", str(GOLDEN), "--epsilon", "0.1", "--order", "5",
                   "--plot", str(tmp_path / f"{name}.{suffix}")) == 0  # fmt: skip
    first, second = (tmp_path / f"{name}.{suffix}" for name in ("a", "b"))
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 5_000


def test_a_second_run_reads_the_cache(tmp_path: Path) -> None:
    assert run("derive", "--order", "3", "--json") == 0
    folder = tmp_path / "cache" / "string"
    assert len(list(folder.iterdir())) == 3
    victim = folder / "order-0002.json.gz"
    victim.write_bytes(b"garbage")
    assert run("derive", "--order", "4", "--json") == 2
    assert victim.read_bytes() == b"garbage"
    assert run("derive", "--order", "4", "--json", "--no-cache") == 0


def negative(order: dict) -> None:
    order["contact"]["-1"] = order["contact"]["1"]


def doubled_tail(order: dict) -> None:
    tail = order["tails"][1][0]
    for element in tail.values():
        element[0] *= 2


@pytest.mark.parametrize("change", [negative, doubled_tail])
def test_a_resealed_lie_in_the_cache_is_neither_proved_nor_continued(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: Callable[[dict], None]
) -> None:
    assert run("derive", "--order", "3", "--json") == 0
    path = tmp_path / "cache" / "string" / "order-0003.json.gz"
    content = json.loads(gzip.decompress(path.read_bytes()))
    change(content["order"])
    content["seal"] = _seal(content)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))
    capsys.readouterr()
    for order in ("3", "4"):
        assert run("derive", "--order", order) == 2
        shown = capsys.readouterr()
        assert "order-0003.json.gz is damaged" in shown.err
        assert "proved" not in shown.out + shown.err
    assert len(list(path.parent.iterdir())) == 3


def test_the_certificate_says_what_it_is_relative_to(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("derive", "--order", "2") == 0
    assert "Proved identically in Omega and c = cot(Omega); and at 3" in capsys.readouterr().out
    assert run("derive", "--order", "2", "--json") == 0
    said = json.loads(capsys.readouterr().out)["proved_relative_to"]
    assert said.startswith("identically in Omega and c = cot(Omega)")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["derive", "--order", "0"],
            "'--order' / '-N': Input should be greater than or equal to 1, not '0'",
        ),
        (["derive", "--order", "-3"], "greater than or equal to 1, not '-3'"),
        (
            ["derive", "--order", "two"],
            "valid integer, unable to parse string as an integer, not 'two'",
        ),
        (
            ["derive", "--format", "pdf"],
            "'pdf' is not one of 'text', 'latex', 'numpy', 'javascript', 'json'",
        ),
        (["derive", "--style", "sine"], "'sine' is not one of 'cotangent', 'circular'"),
        (["derive", "--column", "three"], "'three' is not one of 'one', 'two'"),
        (["derive", "--plot", "x.bmp"], "ends in .pdf, .png, .svg"),
        (["evaluate", "--omega", "0.83"], "Missing option"),
        (["evaluate", "--omega", str(math.pi / 3), "--epsilon", "0.01"], "p/q = 1/3 "),
        (["derive", "--order", "2.5"], "unable to parse string as an integer, not '2.5'"),
        (
            ["evaluate", "--omega", "x", "--epsilon", "0.1"],
            "'--omega': Input should be a valid number, unable to parse string as a number, "
            "not 'x'",
        ),
        (["evaluate", "--omega", "1,2", "--epsilon", "0.1"], "as a number, not '1,2'"),
        (["evaluate", "--omega", "nan", "--epsilon", "0.01"], "Omega = nan"),
        (["evaluate", "--omega", "0.83", "--epsilon", "nan"], "epsilon = nan"),
        (["evaluate", "--omega", "3.1", "--epsilon", "0.1"], "too large for order 1"),
        (["evaluate", "--omega", "0.83", "--epsilon", "0.1", "--s", "0.5"], "beyond the contact"),
        (
            ["evaluate", "--omega", "0.83", "--epsilon", "0.1", "--s", "a,b"],
            "--s 'a': not a number; give numbers separated by commas",
        ),
        (["evaluate", "--omega", "0.83", "--epsilon", "0.1", "--tau", ","], "--tau is empty"),
        (
            ["derive", "--order", "2", "--out", "/dev/null/x"],
            "cannot write /dev/null/x",
        ),
        (
            ["evaluate", "--omega", "0.83", "--epsilon", "0.02", "--s", "-3"],
            "s = -3.0 is beyond the driven end, which is at s = -1.011221519 when tau = 0",
        ),
        (["evaluate", "--omega", "0.83", "--epsilon", "0.1", "--tau", "1e308"], "tau = 1e+308:"),
        (["evaluate", "--omega", "0.83", "--epsilon=1e308"], "epsilon = 1e+308 is too large"),
        (
            [
                "evaluate",
                "--omega=1e-308",
                "--epsilon=0.1",
                "--s",
                "0," * 2000,
                "--tau",
                "0," * 501,
            ],
            "a table of 501 × 2000 numbers, more than 1000000",
        ),
        (
            ["evaluate", "--omega=5e-324", "--epsilon=0.1", "--plot", "x.png"],
            "Omega = 5e-324 has no period to draw",
        ),
        (["nonsense"], "No such command"),
    ],
)
def test_bad_input_is_one_clear_error(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*arguments) != 0
    captured = capsys.readouterr()
    assert message in " ".join(captured.err.replace("│", " ").split())
    assert captured.out == ""
    assert "Traceback" not in captured.err


def test_out_of_memory_is_one_clear_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from asymptotics.values import evaluate as module

    def fill(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(module, "evaluate", fill)
    assert run("evaluate", "--omega", "1.1", "--epsilon", "0.01") == 2
    captured = capsys.readouterr()
    assert captured.err == (
        "ropewave: error: out of memory: ask for fewer points, a lower order or a coarser grid\n"
    )
    assert captured.out == ""


def test_a_fault_of_the_program_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    from asymptotics.values import evaluate as module

    def fail(*_: object) -> None:
        raise OSError(5, "Input/output error", "some/file")

    monkeypatch.setattr(module, "evaluate", fail)
    with pytest.raises(OSError, match="some/file"):
        main(["evaluate", "--omega", "1.1", "--epsilon", "0.01"])


def test_an_unwritable_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("ROPEWAVE_CACHE", str(tmp_path / "file" / "cache"))
    assert run("derive", "--order", "2") == 2
    assert "set ROPEWAVE_CACHE" in capsys.readouterr().err


def command(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "derivations.app", *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
    )


@pytest.mark.slow
def test_another_package_of_our_name_is_told(tmp_path: Path) -> None:
    (tmp_path / "asymptotics").mkdir()
    (tmp_path / "asymptotics" / "__init__.py").write_text("", encoding="utf-8")
    home = str(Path(__file__).resolve().parents[2])
    result = command("derive", PYTHONPATH=f"{tmp_path}{os.pathsep}{home}")
    # ``-m`` puts the working directory first; run from elsewhere to let the other package win.
    if result.returncode == 0:
        result = subprocess.run(
            [sys.executable, "-m", "derivations.app", "derive"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": home},
        )
    assert result.returncode == 2
    assert "another package of the same name" in result.stderr
    assert "pip uninstall -y asymptotics" in result.stderr
    assert "Traceback" not in result.stderr


def test_progress_is_shown_for_long_work_only(capsys: pytest.CaptureFixture[str]) -> None:
    from derivations import progress as module

    with module.progress("deriving", 2) as report:
        report(1)
    assert capsys.readouterr().err == ""
    patience, module.PATIENCE = module.PATIENCE, -1.0
    try:
        with module.progress("deriving", 2) as report:
            report(1)
            report(0)  # done anew with more digits
        assert all(
            line.startswith("deriving: 1/2 (") for line in capsys.readouterr().err.splitlines()
        )
        with module.progress("deriving", 2, quiet=True) as report:
            report(1)
        assert capsys.readouterr().err == ""
    finally:
        module.PATIENCE = patience


def test_evaluate_answers_the_slowest_drive(capsys: pytest.CaptureFixture[str]) -> None:
    """√(1 + ε) through ε⁴, and every number of the JSON object is one."""
    assert run("evaluate", "--omega", "1e-300", "--epsilon", "0.1", "--json") == 0

    def no_constant(name: str) -> None:
        raise AssertionError(name)

    result = json.loads(capsys.readouterr().out, parse_constant=no_constant)
    assert result["contact"] == [pytest.approx(1 + 0.05 - 0.00125 + 0.0000625 - 0.1**4 * 5 / 128)]
    assert result["s"] == [-1.0, -0.75, -0.5, -0.25, 0.0]
    assert result["profile"][0] == pytest.approx([1.0, 0.5625, 0.25, 0.0625, 0.0])


@pytest.mark.parametrize("command", ["evaluate", "simulate", "validate", "threshold"])
def test_frequency_and_height_in_the_place_of_omega(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    amplitude = ["--epsilon", "0.01"] if command in ("evaluate", "simulate") else []
    for given, says in (
        ([], "--hz"),
        (["--hz", "1"], "--height"),
        (["--omega", "2", "--hz", "1", "--height", "1"], "give one"),
        (["--hz", "-1", "--height", "1"], "positive"),
        (["--hz", "nan", "--height", "1"], "--hz"),
    ):
        assert run(command, *amplitude, *given) == 2
        assert says in capsys.readouterr().err
    if command == "evaluate":
        assert run(command, *amplitude, "--hz", "0.8", "--height", "0.81", "--json") == 0
        omega = json.loads(capsys.readouterr().out)["omega"]
        assert abs(omega - 2 * math.pi * 0.8 * math.sqrt(2 * 0.81 / 9.80665)) < 1e-14
