"""``ropewave simulate`` and ``threshold``, as a person or a program uses them."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asymptotics.problems.static_shape import contact_point
from derivations import progress as progress_module
from derivations.app import main
from derivations.reports.watched_run import default_dx, wave_heights
from numerics.files.runs import load

DX = 0.025
SHORT = ("--ramp", "3", "--periods", "6", "--keep", "2", "--dx", str(DX))
FOLLOWS = ("simulate", "--omega", "2.5", "--epsilon", "0.05", *SHORT)
SHEDS = ("simulate", "--omega", "2.9", "--epsilon", "0.1", *SHORT)


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(list(arguments))
    return int(caught.value.code or 0)


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    """The JSON object of a command, which must be all that it prints; no NaN, no Infinity."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    assert run(*arguments, "--json") == 0
    captured = capsys.readouterr()
    found: dict[str, Any] = json.loads(captured.out, parse_constant=refuse)
    return found


def check_ledger(found: dict[str, Any]) -> None:
    """Work = stored + damped + lost, to a rounding of forces 8β/dx³ a step; work was done."""
    energy = found["energy"]
    assert abs(energy["work"]) > 0.1
    stored = energy["end"] - energy["rest"]
    left = stored - energy["work"] + energy["damped"] + energy["lost"]
    steps = found["tau"] / found["dt"]
    scale = 8 * found["beta"] / found["dx"] ** 3
    assert abs(left) < 64 * np.finfo(float).eps * scale * np.sqrt(steps)
    assert energy["unexplained"] == pytest.approx(left, abs=1e-15)
    assert found["complementarity"]["least_height"] == 0
    assert found["complementarity"]["least_reaction"] > 0


def test_below_the_threshold_the_rope_follows(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, *FOLLOWS)
    assert (found["verdict"], found["highest_wave"]) == ("follows", None)
    assert [first["wave"] for first in found["first_waves"]] == [None, None]
    check_ledger(found)
    # The exact contact point at rest; the error at dx = √β/4 is 0.9 dx².
    assert found["contact"]["rest"] == pytest.approx(float(contact_point(0.01)), abs=2 * DX**2)
    assert found["contact"]["min"] < found["contact"]["rest"] < found["contact"]["max"]
    assert 0 < abs(found["fastest_contact"]["value"]) < 1
    assert found["events"]["new_contact"] == {"count": 0, "event": None}
    inputs = {"omega": 2.5, "epsilon": 0.05, "beta": 0.01, "ramp": 3.0, "periods": 6.0, "dx": DX,
              "dt": DX, "length": 8.0, "sponge": 3.0, "scheme": "trapezoidal", "damping": 0.0,
              "driven_end": "pinned", "restitution": 0.0}  # fmt: skip
    assert {name: found[name] for name in inputs} == inputs


def test_above_it_sheds_waves(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, *SHEDS)
    assert found["verdict"] == "sheds waves"
    low, high = (first["wave"] for first in found["first_waves"])
    assert 0 < low["tau"] <= high["tau"] <= found["highest_wave"]["tau"] <= found["tau"]
    assert low["tau"] < 4 * 2 * np.pi / 2.9  # before the periods that are kept
    assert found["highest_wave"]["height"] >= high["height"] >= wave_heights(0.01, DX)[1]
    assert found["events"]["separated_wave"]["event"]["tau"] == low["tau"]
    assert found["events"]["new_contact"]["count"] > 0
    assert found["energy"]["lost"] > 0.1
    check_ledger(found)


def test_damping_has_its_place_in_the_ledger(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, *FOLLOWS, "--damping", "0.2")
    assert found["damping"] == 0.2
    assert found["energy"]["damped"] > 0.001
    check_ledger(found)


def test_both_schemes_agree_on_what_follows(capsys: pytest.CaptureFixture[str]) -> None:
    """Each has an error of order dx² in ξ_c, and the explicit one another in time."""
    implicit = answer(capsys, *FOLLOWS)["contact"]
    explicit = answer(capsys, *FOLLOWS, "--scheme", "verlet")["contact"]
    assert implicit != explicit
    for name in ("min", "max"):
        assert implicit[name] == pytest.approx(explicit[name], abs=DX)


def test_the_text_says_what_the_rope_did(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(*FOLLOWS) == 0
    text = capsys.readouterr().out
    assert "the rope follows: nothing higher than 0.00049 Z0" in text
    assert "at rest" in text
    assert "unexplained" in text
    assert run(*SHEDS) == 0
    text = capsys.readouterr().out
    assert "the rope sheds waves, the highest 0.02" in text
    assert text.count("Z0 first at tau = ") == 2
    assert "new contact: " in text


def test_a_checkpoint_is_continued_bit_for_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = answer(capsys, *SHEDS)
    state = ("--checkpoint", str(tmp_path / "state.npz"))
    assert answer(capsys, *SHEDS, *state, "--periods", "5")["continued_from"] is None
    found = answer(capsys, *SHEDS, *state)
    period = 2 * np.pi / 2.9
    assert found["continued_from"] == pytest.approx(3 * period, abs=DX)
    for name in ("energy", "contact", "tau"):
        assert found[name] == whole[name]
    answer(capsys, *SHEDS, *state, "--periods", "9")
    assert run(*SHEDS, *state, "--periods", "4") == 2
    assert "already stands at tau = " in capsys.readouterr().err


def test_an_interrupted_run_goes_on_from_its_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = answer(capsys, *SHEDS)

    @contextmanager
    def interrupting(*_: Any, **__: Any) -> Iterator[Callable[[int], None]]:
        yield lambda done: signal.raise_signal(signal.SIGINT) if done > 0.3 else None

    state = ("--checkpoint", str(tmp_path / "state.npz"))
    with monkeypatch.context() as patch:
        patch.setattr(progress_module, "progress", interrupting)
        assert run(*SHEDS, *state) == 130
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.endswith("state.npz\n")
        assert run(*SHEDS) == 130
        assert capsys.readouterr().err == ""
    found = answer(capsys, *SHEDS, *state)
    assert 0.3 * whole["tau"] < found["continued_from"] < 0.7 * whole["tau"]
    for name in ("energy", "contact", "tau"):
        assert found[name] == whole[name]


@pytest.mark.slow
def test_out_holds_the_periods_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "new" / "run.nc"
    found = answer(capsys, *SHEDS, "--out", str(path))
    data = load(path)
    assert float(data.time[-1]) == found["tau"]
    assert float(data.snapshot_time[0]) == pytest.approx(4 * 2 * np.pi / 2.9, abs=4 * DX)
    assert float(data.bump.max()) <= found["highest_wave"]["height"]
    assert float(data.attrs["smallest_height"]) == 0.0
    before = path.read_bytes()
    assert run(*SHEDS, "--out", str(path)) == 0
    assert path.read_bytes() == before
    capsys.readouterr()
    assert run(*FOLLOWS, "--out", str(path)) == 2
    captured = capsys.readouterr()
    assert "holds another run" in captured.err
    assert "choose another name, or delete it" in captured.err
    assert captured.out == ""  # said before the run
    assert run(*SHEDS, "--periods", "5", "--out", str(path)) == 2
    assert "longer than to" in capsys.readouterr().err
    assert path.read_bytes() == before


@pytest.mark.slow
def test_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plot, animation = tmp_path / "new" / "rope.png", tmp_path / "rope.gif"
    files = ("--plot", str(plot), "--animate", str(animation))
    assert run(*FOLLOWS, "--keep", "1", *files) == 0
    captured = capsys.readouterr()
    assert f"wrote {plot}\nwrote {animation}\n" in captured.err
    assert captured.out.endswith("T Z0/x0^2\n")
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert animation.read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--epsilon", "1.2"], "epsilon = 1.2 takes the driven end down to Z = -0.2"),
        (["--epsilon", "much"], "'--epsilon': Input should be a valid number"),
        (["--dx", "0.03"], "needs dx ≤ √β/4 = 0.025"),
        (["--length", "3.5"], "domain of length 3.5 whose last 3.0 absorb is too short"),
        (["--beta", "-0.01"], "'--beta': Input should be greater than or equal to 0, not '-0.01'"),
        (["--beta", "2"], "'--beta': Input should be less than or equal to 1, not '2'"),
        (["--scheme", "euler"], "'euler' is not one of 'trapezoidal', 'verlet'"),
        (["--driven-end", "free"], "'free' is not one of 'pinned', 'clamped'"),
        (
            ["--restitution", "1.5"],
            "'--restitution': Input should be less than or equal to 1, not '1.5'",
        ),
        (["--damping", "-1"], "'--damping': Input should be greater than or equal to 0, not '-1'"),
        (["--dt", "0"], "dt = 0"),
        (["--scheme", "verlet", "--dt", "0.02"], "beyond the stability limit"),
        (["--ramp", "-1"], "'--ramp': Input should be greater than or equal to 0, not '-1'"),
        (["--periods", "0"], "periods = 0"),
        (["--periods", "3"], "periods = 3 end before the ramp of 3 periods is over"),
        (["--dt", "0.2"], "at least 20 steps a period"),
        (["--out", "same.nc", "--checkpoint", "same.nc"], "same.nc is named twice"),
        (["--dx", "1e-9"], "nodes"),
        (["--keep", "nan"], "keep = nan"),
        (["--omega", "5e-324"], "Omega = 5e-324: its powers and its period leave double precision"),
        (["--omega", "1e101"], "take 1e-100 ≤ Omega ≤ 1e+100"),
        (["--damping", "1e308"], "take damping ≤ 1.13e+14"),
        (["--damping", "2e14"], "damping = 200000000000000.0 lets the rope creep by less than"),
        (["--periods", "1e308"], "give a finite number"),
        (["--beta", "0", "--sponge", "0", "--length", "1e308", "--dx", "1e307"], "needs dx ≤ √Z/4"),
        (["--beta", "0", "--dx", "0.26"], "the lifted rope at rest is √Z = 1 long"),
        (["--out", "run.txt"], "--out 'run.txt': netCDF files end in .nc"),
        (["--plot", "run.bmp"], "ends in .pdf, .png, .svg"),
        (["--animate", "run.mp4"], "ends in .gif"),
        (["--out", "/dev/null/run.nc"], "cannot write /dev/null/run.nc"),
        (["--animate", "/dev/null/run.gif"], "cannot write /dev/null/run.gif"),
        (["--checkpoint", "/dev/null/state"], "/dev/null/state"),
    ],
)
def test_bad_input_is_one_clear_error(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*SHEDS, *arguments) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.startswith("ropewave: error: ")
    assert captured.err.count("\n") == 1
    assert captured.out == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--beta", "1e308"], "'--beta': Input should be less than or equal to 1, not '1e308'"),
        (["--beta", "5e-324"], "make more than 10000000 nodes"),
        (["--omega", "5e-324"], "Omega = 5e-324: its powers and its period leave"),
        (["--omega", "1e-90"], "is more than 2^53 steps of"),
        (["--omega", "1e5"], "too long for a forcing period of 6.283e-05: take at least 20 steps"),
        (["--dx", "1e308"], "dx = 1e+308 is too coarse for beta = 0.01"),
        (["--dx", "1e-308"], "make more than 10000000 nodes"),
        (["--relative", "1e-10"], "'--relative': Input should be greater than or equal to 0.0000"),
    ],
)
def test_bad_input_to_threshold_is_one_clear_error(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("threshold", "--omega", "2.9", "--quick", *arguments) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.startswith("ropewave: error: ")
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_all_that_is_kept_may_be_more_than_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, *FOLLOWS)
    assert answer(capsys, *FOLLOWS, "--keep", "1e308") == found
    assert answer(capsys, *FOLLOWS, "--keep", "6") == found


def test_long_work_is_announced(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Roughly: nodes × steps × 20 ns; said with --json as well, and before the first step."""
    monkeypatch.setattr(progress_module, "ANNOUNCED", 0.0)
    assert run(*FOLLOWS, "--json") == 0
    assert capsys.readouterr().err.splitlines()[0] == (
        "604 steps of 319 nodes: roughly 0.0039 s; Ctrl-C ends it"
    )
    short = ("threshold", "--omega", "2.9", "--dx", str(DX), "--relative", "0.5", "--json")
    assert run(*short, "--quick") == 0
    assert capsys.readouterr().err.splitlines()[0] == (
        "about 10 runs, the first of 3467 steps of 319 nodes: roughly 0.22 s; Ctrl-C ends it"
    )
    monkeypatch.setattr(progress_module, "ANNOUNCED", 30.0)
    progress_module.announce("work", 30.0)
    assert capsys.readouterr().err == ""
    for seconds, said in ((31, "31 s"), (3e2, "5 minutes"), (2e4, "5.6 hours"), (1e6, "12 days"),
                          (1e10, "310 years")):  # fmt: skip
        progress_module.announce("work", seconds)
        assert capsys.readouterr().err == f"work: roughly {said}; Ctrl-C ends it\n"


def test_a_threshold_tells_its_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress_module, "PATIENCE", -1.0)
    monkeypatch.setattr(progress_module, "LINE_EVERY", 0.0)
    line = ("threshold", "--omega", "2.9", "--dx", str(DX), "--relative", "0.5", "--quick")
    assert run(*line) == 0
    lines = capsys.readouterr().err.splitlines()
    assert "a run at epsilon = 0.9, " in lines[0]  # the sweep that finds where to begin
    assert lines[-1].startswith("bracketing: 1/1 (")
    parts = [int(text.split()[-4]) for text in lines[:-1]]
    assert all(text.endswith(" % of it") for text in lines[:-1])
    assert 0 < min(parts) < max(parts) <= 100
    monkeypatch.setattr(progress_module, "QUIET_PATIENCE", -1.0)
    assert run(*line, "--json") == 0
    assert "a run at epsilon" in capsys.readouterr().err


def test_a_damaged_or_foreign_checkpoint(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "state.npz"
    assert run(*SHEDS, "--checkpoint", str(path)) == 0
    capsys.readouterr()
    assert run(*FOLLOWS, "--checkpoint", str(path)) == 2
    assert "is the checkpoint of another run" in capsys.readouterr().err
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert run(*SHEDS, "--checkpoint", str(path)) == 2
    captured = capsys.readouterr()
    assert "is damaged" in captured.err
    assert captured.err.count("\n") == 1
    assert path.read_bytes() == content


@pytest.mark.parametrize(
    ("package", "arguments"),
    [("numba", FOLLOWS), ("numba", ("threshold", "--omega", "2.9")),
     ("xarray", (*FOLLOWS, "--out", "run.nc"))],
)  # fmt: skip
def test_a_missing_extra_is_named(
    package: str,
    arguments: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    assert run(*arguments) == 2
    captured = capsys.readouterr()
    assert f"{package} is needed" in captured.err
    assert "pip install 'ropewave[sim]'" in captured.err
    assert captured.err.count("\n") == 1


def test_default_spacing_resolves_the_boundary_layer() -> None:
    for beta in (1.0, 0.1, 0.0016, 1e-3, 3e-4, 1e-4, 1e-5):
        dx = default_dx(beta)
        limit = min(0.01, np.sqrt(beta) / 20)
        assert 0.4 * limit <= dx <= limit
        assert f"{dx:.2g}" == f"{dx:g}"


def test_the_threshold_is_where_simulate_finds_it(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(
        capsys, "threshold", "--omega", "2.9", "--dx", str(DX), "--quick", "--relative", "0.1"
    )
    assert (found["omega"], found["beta"]) == (2.9, 0.01)
    assert found["lower"] < found["upper"] <= 1.1 * found["lower"] * (1 + 1e-12)
    [only] = found["runs"]
    assert (only["lower"], only["upper"]) == (found["lower"], found["upper"])
    assert (only["change"], only["mechanism"]) == ("base", found["mechanism"])
    settings = only["settings"]
    assert settings["dx"] == DX
    same = ("--dx", str(DX), "--ramp", repr(settings["ramp"]), "--keep", "1",
            "--periods", repr(settings["ramp"] + settings["hold"]))  # fmt: skip
    for name, lost in (("lower", False), ("upper", True)):
        wave = answer(capsys, "simulate", "--omega", "2.9", "--epsilon", repr(found[name]), *same)
        highest = wave["highest_wave"]
        assert (highest is not None and highest["height"] >= settings["height"]) == lost


def test_the_threshold_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("threshold", "--omega", "2.9", "--dx", str(DX), "--quick", "--relative", "0.2") == 0
    text = capsys.readouterr().out
    assert "the wave-less state is lost at 0.0" in text
    assert "one setting only" in text
    assert "with ramps of 20 and holds of 20 forcing periods, not the quasi-static loss" in text
    assert run("threshold", "--omega", "-1") == 2
    assert "omega = -1" in capsys.readouterr().err.lower()
    assert run("threshold", "--omega", "2.9", "--beta", "-1") == 2
    assert (
        "'--beta': Input should be greater than or equal to 0, not '-1'" in capsys.readouterr().err
    )


@pytest.mark.slow
def test_the_threshold_of_a_string_is_exact(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "threshold", "--omega", "2.7", "--beta", "0")
    assert found["lower"] < 0.0292 < found["upper"] < 0.03
    assert found["mechanism"] == "sonic contact"
    assert [each["settings"]["ramp"] for each in found["runs"]] == [20, 40, 80, 20, 20]
    assert "ramps of 20 or 40 or 80 and holds of 20 or 80" in found["bounds"]
    assert run("threshold", "--omega", "2.7", "--beta", "0") == 0
    assert "base: the exact string, ramp 20 and hold 20" in capsys.readouterr().out
    assert run("threshold", "--omega", "2.7", "--beta", "0", "--dx", "0.01") == 2
    assert "leave --dx out" in capsys.readouterr().err


def test_progress_tells_the_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is left takes as long as the steps since the first call tell, which came late."""
    clock = iter([0.0, 777.0, 778.0, 783.0, 790.0])
    monkeypatch.setattr(progress_module.time, "monotonic", lambda: next(clock))
    with progress_module.progress("simulating", 1.0, fine=True) as report:
        for done in (0.25, 0.25 + 1e-9, 0.25 + 6e-6, 0.5):
            report(done)
    assert capsys.readouterr().err.splitlines() == [
        "simulating: 25 % (777.0 s)",
        "simulating: 25 % (783.0 s, 8.7 days left)",
        "simulating: 50 % (790.0 s, 26 s left)",
    ]
    monkeypatch.undo()
    monkeypatch.setattr(progress_module, "PATIENCE", -1.0)
    with progress_module.progress("simulating", 10, quiet=True, fine=True) as report:
        report(5)
    assert capsys.readouterr().err == ""
