"""The string's boundary over many rotation numbers: which, their symmetries, the command."""

import json
import math
from itertools import pairwise
from pathlib import Path

import pytest

from numerics.errors import InputError, NumericsError
from numerics.exact_string import envelope
from numerics.exact_string.envelope import end_of, nobles_between
from tests.command import said


def test_which_numbers() -> None:
    found = nobles_between(0, 2, 8)
    values = [one.value for one in found]
    assert len(found) == 44
    assert all(b > a for a, b in pairwise(values))
    # Between two Farey neighbours the sum of whose denominators is in reach there are two or more.
    for p, q, r, s in ((0, 1, 1, 1), (1, 2, 2, 3), (2, 3, 3, 4), (0, 1, 1, 7), (3, 5, 2, 3)):
        assert sum(p / q < value < r / s for value in values) >= 2
    # All quotients of what is beyond the first few are one.
    assert all(len(one.head) < 10 for one in found)
    assert min(abs(value - (math.sqrt(5) - 1) / 2) for value in values) < 1e-15


def test_symmetries() -> None:
    """The standard map has one K_c for ν, 1 − ν and ν + 1; Ω and ε_c of the string differ."""
    heads = [one.head for one in nobles_between(0.25, 0.75, 5)]
    rows = [end_of({"head": list(head)}) for head in heads]
    assert len(rows) == 6
    for one, other in zip(rows, reversed(rows), strict=True):
        assert one["rotation"] + other["rotation"] == pytest.approx(1, abs=1e-12)
        assert one["K"] == pytest.approx(other["K"], abs=3 * (one["error"] + other["error"]))
        further = end_of({"head": [one["head"][0] + 1, *one["head"][1:]]})
        assert one["K"] == pytest.approx(further["K"], abs=3 * (one["error"] + further["error"]))
        assert further["omega"] > one["omega"] + 2
        for row in (one, further):
            assert row["epsilon"] == pytest.approx(row["K"] / (2 * row["omega"] ** 2), rel=1e-12)


@pytest.mark.parametrize("head", [(0, 12), (0, 1, 12), (1, 1, 7)])
def test_numbers_next_to_a_resonance(head: tuple[int, ...]) -> None:
    """The first orbits' residues are below 1e-3 at their crossing, or lost in rounding."""
    row = end_of({"head": list(head)})
    assert row["reason"] is None
    assert row["K_by_norms"] == pytest.approx(row["K"], rel=5e-5)
    mirrored = end_of({"head": [head[0], 1, head[1] - 1] if len(head) == 2 else [0, head[2] + 1]})
    assert mirrored["K"] == pytest.approx(row["K"], abs=1e-7)


def test_why_there_is_no_end(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(rotation: object) -> None:
        raise NumericsError("the orbit 1/2 was not found")

    monkeypatch.setattr(envelope, "break_up", lost)
    row = end_of({"head": [0, 12]})
    assert row["reason"] == "the orbit 1/2 was not found"
    assert "epsilon" not in row


@pytest.mark.parametrize(
    "given",
    [(-0.1, 1, 5), (1, 1, 5), (0, math.nan, 5), (0, 21, 5), (0, 1, 1), (0, 1, 61), (0, 1, 2.5)],
)
def test_arguments(given: tuple) -> None:
    with pytest.raises(InputError):
        nobles_between(*given)


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plots, data = [tmp_path / "a.svg", tmp_path / "b.svg"], tmp_path / "kept"
    wanted = ["critical", "--between", "0.3:0.7", "--denominators", "3", "--data", str(data)]
    outs = []
    for plot in plots:
        code, out, _ = said([*wanted, "--plot", str(plot), "--json"], capsys)
        assert code == 0
        outs.append(json.loads(out))
    assert outs[0] == outs[1]
    assert [row["omega"] for row in outs[0]["points"]] == [
        pytest.approx(1.2259858, abs=1e-7),
        pytest.approx(1.9387855, abs=1e-7),
    ]
    assert plots[0].read_bytes() == plots[1].read_bytes()
    code, out, _ = said(wanted, capsys)
    assert code == 0
    assert "0.971635406" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give one of --rotation"),
        (["--rotation", "golden", "--between", "0:1"], "give one of --rotation"),
        (["--rotation", "golden", "--workers", "2"], "give --between"),
        (["--between", "golden"], "give two numbers"),
        (["--between", "1:0"], "low < high"),
        (["--between", "0:1", "--denominators", "99"], "2 to 60"),
        (["--between", "0:1:2"], "give two numbers"),
    ],
)
def test_command_refuses(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = said(["critical", *arguments], capsys)
    assert (code != 0, out) == (True, "")
    assert message in err
