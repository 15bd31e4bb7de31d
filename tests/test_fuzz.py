"""The fuzzer of command lines in small; see :mod:`tests.fuzz` for the large one."""

from __future__ import annotations

import shlex
import sys

import pytest

from tests import fuzz
from tests.fuzz import EVERY, Outcome, fault, line, lines_at_random, lines_made, run

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="forks")

# Long runs are for the large fuzzer; here they only have to be stopped.
SECONDS = 1.0
SLOW = {"figure2", "threshold"}


@pytest.mark.slow
def test_no_line_crashes_or_calls_a_nan_a_result() -> None:
    fuzz.prepare()
    made = [words for words in lines_made(110) if words[0] not in SLOW]
    drawn = [words for words in lines_at_random(70, seed=8) if words[0] not in SLOW]
    assert len(made) + len(drawn) > 120
    faults = {}
    for words in (*made, *drawn):
        found = fault(words, run(words, SECONDS))
        if found not in (None, "silent"):
            faults[shlex.join(words)] = found
    assert faults == {}


def test_lines_are_those_of_their_seed_and_reach_every_option() -> None:
    assert list(lines_at_random(20, 3)) == list(lines_at_random(20, 3))
    assert list(lines_at_random(20, 3)) != list(lines_at_random(20, 4))
    every = lines_made()
    assert len(every) > 700
    assert len(lines_made(300)) == 300
    assert {words[0] for words in lines_made(300)} == set(EVERY)
    # An option that the command does not know would test nothing.
    for command, options in EVERY.items():
        known = run([command, "--help"]).out
        assert all(option in known for option in options), command


@pytest.mark.parametrize(
    ("outcome", "expected"),
    [
        (Outcome(0, "1.0\n", ""), None),
        (Outcome(0, "x = nan\n", ""), "no number"),
        (Outcome(0, "error -inf\n", ""), "no number"),
        (Outcome(0, "informed of nanometres, beta -> infinity\n", ""), None),
        (Outcome(2, "", "ropewave: error: no\n"), None),
        (Outcome(2, "", ""), "exit 2"),
        (Outcome(2, "", "ropewave: error: no\nropewave: error: no\n"), "exit 2"),
        (Outcome(1, "", "Traceback (most recent call last):\n"), "traceback"),
        (Outcome(-11, "", ""), "signal 11"),
        (Outcome(None, "", "simulating: 3 %\n"), None),
        (Outcome(None, " \n", ""), "silent"),
    ],
)
def test_what_counts_as_a_fault(outcome: Outcome, expected: str | None) -> None:
    assert fault(["evaluate"], outcome) == expected


def test_json_is_parsed() -> None:
    assert fault(["fold", "--json"], Outcome(0, '{"a": 1', "")) == "no JSON"
    assert fault(["fold", "--json"], Outcome(0, '{"a": NaN}', "")) == "no number"
    assert fault(["fold", "--json"], Outcome(0, '{"a": 1}', "")) is None


def test_a_line_that_hangs_or_crashes_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    from derivations import app

    def hang(_: list[str]) -> None:
        while True:
            pass

    monkeypatch.setattr(app, "main", hang)
    assert fault([], run([], 0.2)) == "silent"
    monkeypatch.setattr(app, "main", lambda _: 1 / 0)
    assert fault([], run([], 5)) == "traceback"
    monkeypatch.setattr(app, "main", lambda _: bytearray(2 * fuzz.MEMORY))
    assert "MemoryError" in run([], 5).err
    assert line("fold", {"--beta": "1"}) == ["fold", "1/1", "--beta", "1"]
