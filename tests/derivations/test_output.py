"""What is printed: in any encoding, to any reader, and never a number that is none."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from asymptotics.errors import ResultError
from derivations.commands.options import MOST_NUMBERS, numbers_of
from derivations.output import json_text, show

EVALUATE = ("evaluate", "--omega", "1.1", "--epsilon", "0.01")
SIMULATE = ("simulate", "--omega", "2.5", "--epsilon", "0.05", "--ramp", "3", "--periods", "5",
            "--dx", "0.025")  # fmt: skip
COMMANDS = ("derive", "evaluate", "resonances", "tongue", "fold", "simulate", "threshold",
            "figure2", "regenerate")  # fmt: skip


def command(
    *arguments: str, shell: str | None = None, **environment: str
) -> subprocess.CompletedProcess[bytes]:
    """The command in a process of its own; ``shell`` is what its output is sent to."""
    line = [sys.executable, "-m", "derivations.app", *arguments]
    if shell is not None:
        line = ["bash", "-c", f'"$@" {shell}', "bash", *line]
    return subprocess.run(line, capture_output=True, env={**os.environ, **environment})


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_help_and_results_in_a_poor_encoding(encoding: str) -> None:
    script = (
        "from derivations.app import main\n"
        f"for name in {COMMANDS!r}:\n"
        "    try:\n"
        "        main([name, '--help'])\n"
        "    except SystemExit as end:\n"
        "        assert end.code == 0, name\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": encoding},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    # The command line's own help falls back to UTF-8 where it meets ASCII.
    text = done.stdout.decode("utf-8" if encoding == "ascii" else encoding)
    assert text.count("Usage: ropewave ") == len(COMMANDS)
    assert ("Ω = ωx₀/c" if encoding == "ascii" else "Omega = omegax_0/c") in text
    done = command(*SIMULATE, PYTHONIOENCODING=encoding)
    assert (done.returncode, done.stderr) == (0, b"")
    text = done.stdout.decode(encoding)
    assert "x0 in the last period" in text
    assert ("..." if encoding == "ascii" else "…") in text


@pytest.mark.slow
def test_the_cross_check_in_a_poor_encoding() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "derivations.cross_check.ladder", "--help"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"epsilon" in done.stdout


@pytest.mark.slow
def test_a_file_name_that_is_no_text_is_printed_as_it_is(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/\xff.png"
    done = command(*EVALUATE, "--plot", os.fsdecode(name))
    assert done.returncode == 0
    assert done.stderr == b"wrote " + name + b"\n"


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize(
    "arguments", [EVALUATE, (*EVALUATE, "--json"), ("simulate", "--help"), ("--version",)]
)
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_disk_is_one_error(arguments: tuple[str, ...], unbuffered: str) -> None:
    done = command(*arguments, shell=">/dev/full", PYTHONUNBUFFERED=unbuffered)
    assert done.returncode == 2
    assert done.stderr.decode() == (
        "ropewave: error: cannot write the results: No space left on device; send them elsewhere\n"
    )
    done = command(*arguments, shell="2>/dev/full")
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments", [(*EVALUATE, "--tau", "0:4000:0.1"), ("derive", "--order", "7"), ("--help",)]
)
def test_a_reader_that_leaves_is_no_error(arguments: tuple[str, ...]) -> None:
    done = command(*arguments, shell="| true; exit ${PIPESTATUS[0]}")
    assert done.returncode in (0, 1)  # 0 when all was written before
    assert done.stderr == b""
    done = command(*arguments, shell="| head -1; exit ${PIPESTATUS[0]}")
    assert done.stdout.count(b"\n") == 1
    assert done.stderr == b""


@pytest.mark.slow
def test_closed_streams() -> None:
    done = command(*EVALUATE, shell=">&-")
    assert done.returncode == 2
    assert done.stderr.startswith(b"ropewave: error: standard output is closed; ")
    whole = command(*EVALUATE, "--plot", "x.bmp", shell="2>&-")
    assert (whole.returncode, whole.stdout) == (2, b"")
    assert command(*EVALUATE, shell="2>&-").stdout == command(*EVALUATE).stdout


@pytest.mark.slow
def test_version_and_completion() -> None:
    done = command("--version")
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.startswith(b"ropewave ")
    asked = {"COMP_WORDS": "ropewave thr", "COMP_CWORD": "1"}
    done = command(_ROPEWAVE_COMPLETE="complete_bash", **asked)
    assert done.stdout.split() == [b"threshold"]
    asked = {"COMP_WORDS": "ropewave derive --style ci", "COMP_CWORD": "3"}
    done = command(_ROPEWAVE_COMPLETE="complete_bash", **asked)
    assert done.stdout.split() == [b"circular"]
    assert b"ropewave" in command("--show-completion", "bash").stdout


def test_without_arguments_there_is_help() -> None:
    assert command().stdout == command("--help").stdout != b""


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("as_json", [True, False])
def test_a_result_that_is_no_number_is_an_error(
    value: float, as_json: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ResultError, match=rf"the result a.b\[1\] = {value!r} is no number"):
        show({"a": {"b": [1.0, value]}, "c": None}, "text", as_json)
    assert capsys.readouterr().out == ""
    assert json_text({"a": [1, 2.5, None, "ε"]}) == '{"a": [1, 2.5, null, "\\u03b5"]}'


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0:0.3:0.1", [0.0, 0.1, 0.2, 0.3]),
        ("0:0.35:0.1", [0.0, 0.1, 0.2, 0.3]),
        ("-1:0:0.25", [-1.0, -0.75, -0.5, -0.25, 0.0]),
        ("0:-2:-1,5", [0.0, -1.0, -2.0, 5.0]),
        ("3:3:1", [3.0]),
        ("0:1:0.3333333333", [0.0, 0.3333333333, 0.6666666666, 1.0]),
        ("0:1:0.33333333", [0.0, 0.33333333, 0.66666666, 0.99999999]),
        ("0:0.6666666665:0.3333333333", [0.0, 0.3333333333, 0.6666666665]),
        ("0:2e5:2.00002", None),
    ],
)
def test_grids(text: str, values: list[float] | None) -> None:
    found = numbers_of("--tau", text)
    if values is None:
        assert (len(found), found[-1]) == (MOST_NUMBERS, 199999.99998)
    else:
        assert found == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0:1", "a grid is start:stop:step"),
        ("0:1:0.1:2", "a grid is start:stop:step"),
        ("0:1:0", "give a step"),
        ("0:1:-0.1", "give a step"),
        ("1:0:0.1", "give a step"),
        ("0:x:1", "'x': not a number"),
        ("0:inf:1", "give finite numbers"),
        ("nan:1:1", "give finite numbers"),
        ("0:1:1e-400", "give a step"),
        ("0:1:1e-9999999", "give a step"),
        ("0:1e400:1", "give finite numbers"),
        ("0:1:1e-5", "at most 100000"),
        ("0:1e308:1e-300", "at most 100000"),
        ("0:9999:0.1,0:9:1", "more than 100000 numbers"),
        ("", "is empty"),
        ("1,two", "'two': not a number"),
    ],
)
def test_a_bad_list_is_one_clear_error(text: str, message: str) -> None:
    from asymptotics.errors import InputError

    with pytest.raises(InputError, match=message):
        numbers_of("--tau", text)


@pytest.mark.parametrize("arguments", [["--help"], ["simulate", "--help"], ["--version"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    script = (
        "import sys\n"
        "from derivations.app import main\n"
        "try:\n"
        f"    main({arguments!r})\n"
        "except SystemExit:\n"
        "    print(*sys.modules, file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    heavy = {"numpy", "flint", "sympy", "rich", "matplotlib", "numba", "scipy"}
    if len(arguments) == 1:  # the options for completion need it before a command is reached
        heavy.add("pydantic")
    assert heavy & set(done.stderr.split()) == set()
    assert "derivations.app" in done.stderr.split()


def test_the_face_of_asymptotics_is_imported_when_asked_for() -> None:
    import asymptotics

    assert set(asymptotics.__all__) <= set(dir(asymptotics))
    for name in asymptotics.__all__:
        assert callable(getattr(asymptotics, name))
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = asymptotics.nothing
