"""Problem files: what they say is read, and hostile text is refused in bounded time."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from asymptotics import expand
from asymptotics.errors import InputError
from asymptotics.problems import presets
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.problems.written import (
    DEEPEST,
    LONGEST,
    MOST_BYTES,
    expression,
    problem_of,
    read_problem,
    statement,
)

FILE = """
equation = "W_tautau = W_xixi - 2 - kappa*W"
driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]
contact = ["W", "W_xi"]

[parameters]
kappa = 1.7
"""


def test_a_file_is_the_rope_it_says(tmp_path: Path) -> None:
    path = tmp_path / "rope.toml"
    path.write_text(FILE, encoding="utf-8")
    written = read_problem(path)
    found = expand(written.rope, 3, at={**written.parameters, "Omega": 2.2})
    wanted = expand(presets.string(foundation=sp.Float(1.7)), 3, at={"Omega": 2.2})
    for n in (1, 2, 3):
        assert found.contact(n) == wanted.contact(n)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("1/3 + 0.1", sp.Rational(13, 30)),
        ("-2**2", sp.Integer(-4)),
        ("2**-2", sp.Rational(1, 4)),
        ("2 - 3 - 4", sp.Integer(-5)),
        ("8/2/2", sp.Integer(2)),
        ("-(1 - +2)*3e-1", sp.Rational(3, 10)),
        ("a*W_xixitau", sp.Symbol("a") * W.diff(xi, 2, tau)),
        ("W_tauxixi", W.diff(xi, 2, tau)),
        ("W", W),
        ("sqrt(2)*sin(Omega*tau + pi/2)*epsilon", sp.sqrt(2) * sp.cos(Omega * tau) * epsilon),
        (0.5, sp.Rational(1, 2)),
    ],
)
def test_expressions(text: Any, wanted: sp.Expr) -> None:
    assert sp.simplify(expression(text, "here") - wanted) == 0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "nothing stands there"),
        ("   ", "nothing stands there"),
        ("1 +", "missing at the end"),
        ("(1", "a ) is missing"),
        ("1)", "not expected"),
        ("2 3", "not expected"),
        ("W_xx", "derivatives are"),
        ("W_", "derivatives are"),
        ("__import__", "not understood"),
        ("__import__('os')", "not understood"),
        ("().__class__", "not understood"),
        ("W.diff(xi)", "not understood"),
        ("lambda: 0", "not understood"),
        ("exec(1)", "no function here"),
        ("W(xi, tau)", "not understood"),
        ("9**9**9", "needs parentheses"),
        ("9**99999999999999999999", "exponents are whole numbers"),
        ("((9**9)**9)**9**2", "needs parentheses"),
        ("kappa**kappa", "exponents are whole numbers"),
        ("1e999999999", "too long or too large"),
        ("9" * 100, "too long or too large"),
        ("1/0", "divides by zero"),
        ("0**-1", "divides by zero"),
        ("(" * 1000 + "1" + ")" * 900, "parentheses inside one another"),
        ("-" * 1500, "missing at the end"),
        ("x" * 40, "no name here"),
        ("W_" + "xi" * 100, "too many derivatives"),
        ("1" * (LONGEST + 1), "characters"),
        ("kappa * ☃", "not understood"),
        (None, "no text"),
        (True, "no text"),
        ([], "no text"),
    ],
)
def test_hostile_text_is_refused(text: Any, reason: str) -> None:
    with pytest.raises(InputError, match=re.escape(reason)) as caught:
        expression(text, "here")
    assert len(str(caught.value)) < 400


def test_towers_of_powers_end_at_once() -> None:
    """(((9**12)**12)**12)…: each level is small, together they are 10^(12^n) digits."""
    text = "9"
    for _ in range(DEEPEST - 2):
        text = f"({text})**12"
    with pytest.raises(InputError, match="is too large"):
        expression(text, "here")


@pytest.mark.parametrize(
    "text",
    [
        "*".join(f"(a{i} + b)" for i in range(60)),
        "*".join(f"cos({i}*Omega*tau)" for i in range(1, 60)),
        "(a + b + c + d + e + f + g + h)**12",
        "(" * 20 + "a + b" + ")**12" * 20,
        "(" * 20 + "a*W" + ")**12" * 20,
    ],
)
def test_what_would_grow_when_multiplied_out(text: str) -> None:
    with pytest.raises(InputError, match=r"too large|more than 500 terms"):
        expression(text, "here")


@settings(max_examples=300, deadline=2000)
@given(st.text(alphabet="W_xitau epsilonOmega0123456789.+-*/()=^,'\"[]{}cosqrt", max_size=60))
def test_any_text_is_read_or_refused(text: str) -> None:
    with suppress(InputError):
        assert isinstance(statement(text, "here"), sp.Expr)


def table(**changes: Any) -> dict[str, Any]:
    whole = {
        "equation": "W_tautau = W_xixi - 2",
        "driven_end": ["W = 1 + epsilon*cos(Omega*tau)"],
        "contact": ["W", "W_xi"],
        **changes,
    }
    return {key: value for key, value in whole.items() if value is not ...}


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (table(equation=...), "equation is missing"),
        (table(load=2), "'load' is unknown"),
        (table(parameters=3), "parameters is no table"),
        (table(parameters={"kappa": []}), "is no number"),
        (table(parameters={"kappa": True}), "is no number"),
        (table(contact=[]), "has to be a list"),
        (table(contact={}), "has to be a list"),
        (table(contact=["W"] * 1000), "has to be a list"),
        (table(contact=[1, 2]), "no text"),
        (table(equation="W_tautau = W_xixi = 2"), "more than one ="),
        (table(equation="W*W_xixi = 2"), "is not linear"),
    ],
)
def test_tables_that_are_no_problem(data: dict[str, Any], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        problem_of(data, "here")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"\xff\xfe", "is no TOML file"),
        (b"equation = ", "is no TOML file"),
        (b"a = " + b"[" * 60_000, "is no TOML file"),
        (b"x = 1\n" * 100_000, f"larger than {MOST_BYTES}"),
        (b"", "is missing"),
    ],
)
def test_files_that_are_no_problem(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "rope.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=reason):
        read_problem(path)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none.toml", Path("/dev/zero"), Path("a\0b")):
        with pytest.raises(InputError):
            read_problem(path)
