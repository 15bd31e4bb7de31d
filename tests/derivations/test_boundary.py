"""The boundary's command: two ways to a point, sweeps that resume, what differs by name."""

import json
from pathlib import Path

import pytest

from derivations.cross_check.boundary import _agrees, between, disagreements, point, tasks
from tests.command import said


@pytest.mark.parametrize(("omega", "kind"), [(3.2, "fold"), (3.59, "fold"), (1.62, "fold")])
def test_two_ways_agree(omega: float, kind: str) -> None:
    [task] = tasks(0.01, "pinned", [omega])
    row = point(task)
    assert row["mechanism"] == row["normal_form"]["kind"] == kind
    assert row["agrees"]
    assert row["normal_form"]["epsilon"] == pytest.approx(row["lower"], rel=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("omega", [6.48, 6.52])
def test_two_ways_agree_at_the_tongue(omega: float) -> None:
    row = point(tasks(0.01, "pinned", [omega])[0])
    assert row["mechanism"] == row["normal_form"]["kind"] == "period doubling"
    assert row["agrees"]


def test_the_string_has_a_lower_bound() -> None:
    row = point(tasks(0.0, "pinned", [2.9])[0])
    assert row["upper"] is None
    assert row["lower"] == pytest.approx(8.687e-3, rel=1e-3)
    assert row["mechanism"] == "loss of regularity"
    assert row["normal_form"] is None


def test_differences_are_named() -> None:
    known = {"kind": "fold", "epsilon": 2e-4, "error": 1e-6}
    row = {"omega": 3.24, "lower": 1e-4, "upper": 1.1e-4, "mechanism": "fold", "agrees": True}
    assert disagreements([{**row, "normal_form": known}]) == []
    [line] = disagreements([{**row, "normal_form": known, "agrees": False}])
    assert line.startswith("Omega = 3.24: fold at 0.0001 ... 0.00011 by states")
    assert "0.0002 +- 1e-06" in line
    for upper, lower, agrees in ((None, 1e-4, True), (None, 3e-4, False), (1.1e-4, 1e-4, False)):
        assert _agrees({**row, "lower": lower, "upper": upper}, known) is agrees
    other = {**row, "upper": 3e-4, "mechanism": "period doubling"}
    assert not _agrees(other, known)


def test_what_the_simulator_contradicts_is_named() -> None:
    row = {"omega": 6.0, "lower": 4e-3, "upper": 4.1e-3, "mechanism": "fold", "agrees": None}
    told = {"below": "stays", "below_at": 3.6e-3, "above": "leaves", "above_at": 4.51e-3}
    row = {**row, "harmonic": 6, "started": {**told, "periods": 60}}
    assert disagreements([row]) == []
    for side, wrong in (("below", "leaves"), ("above", "stays")):
        [line] = disagreements([{**row, "started": {**row["started"], side: wrong}}])
        assert line.startswith("Omega = 6: fold of harmonic 6 at 0.004")
        assert f"started {side}, at {told[side + '_at']:.6g}, the simulator {wrong}" in line


@pytest.mark.slow
def test_from_both_sides(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(["boundary", "--omega", "3.2", "--started", "--json"], capsys)
    assert code == 0
    told = json.loads(out)["points"][0]["started"]
    assert (told["below"], told["above"]) == ("stays", "leaves")
    assert told["above_at"] == pytest.approx(1.1 * 1.38788e-3, rel=1e-4)
    code, out, _ = said(["boundary", "--omega", "3.2", "--started"], capsys)
    assert "fold of harmonic 1" in out
    assert "stays, leaves" in out


def test_where_points_are_put_between() -> None:
    row = {"omega": 3.0, "lower": 1e-3, "mechanism": "fold"}
    rows = [row, {**row, "omega": 3.1, "mechanism": "none"}, {**row, "omega": 3.102}]
    assert between(rows) == [3.05]
    assert between(rows[::-1]) == [3.05]
    assert between([row, {**row, "omega": 3.1, "lower": 1.9e-3}]) == []
    assert between([row, {**row, "omega": 3.1, "lower": 0.0}]) == [3.05]


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plot, data = tmp_path / "a.svg", tmp_path / "points"
    arguments = ["boundary", "--omega", "3.22,3.24", "--data", str(data), "--plot", str(plot)]
    arguments += ["--simulated", "docs/figure2.json", "--json"]
    code, out, _ = said(arguments, capsys)
    assert code == 0
    first, drawn = json.loads(out), plot.read_bytes()
    assert [row["mechanism"] for row in first["points"]] == ["fold", "fold"]
    assert first["disagreements"] == []
    assert first["points"][0]["lower"] == pytest.approx(6.2009e-4, rel=1e-4)
    # Kept points come back as they were; a damaged one is refused and left alone.
    code, out, _ = said(arguments, capsys)
    assert json.loads(out) == first
    assert plot.read_bytes() == drawn
    kept = sorted(data.rglob("*.json"))
    assert len(kept) == 2
    text = kept[0].read_text()
    kept[0].write_text(text.replace("fold", "gold"))
    code, out, err = said(arguments, capsys)
    assert code != 0
    assert out == ""
    assert kept[0].name in err
    assert "gold" in kept[0].read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--omega", "-1"], "positive"),
        (["--omega", "x"], "--omega"),
        (["--omega", "3.2", "--simulated", "docs/figure2.json"], "give --plot"),
        (["--omega", "3.2", "--plot", "a.txt"], "cannot draw"),
        (["--omega", "3.2", "--beta", "0", "--started"], "ropes that bend"),
        (["--omega", "3.2", "--refine", "9"], "less than or equal to 8"),
        (["--omega", "3.2", "--plot", "a.png", "--simulated", "README.md"], "README"),
    ],
)
def test_command_refuses(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = said(["boundary", *arguments], capsys)
    assert code != 0
    assert out == ""
    assert message in err
