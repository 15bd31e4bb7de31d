"""The tongue command's backend: JSON, text, table, figures."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path

import pytest
import sympy

from asymptotics.errors import InputError
from asymptotics.resonances.tongues import tongue
from derivations.reports.tongues import as_json, as_text, latex_table, plot_orders, plot_tongues


def test_json_holds_the_paper() -> None:
    fields = json.loads(json.dumps(as_json(tongue(1, 1, 3))))
    assert fields["command"] == "tongue"
    assert (fields["p"], fields["q"], fields["order"], fields["order_used"]) == (1, 1, 3, 3)
    assert (fields["exponent"], fields["limit_exponent"]) == ("5/3", "2")
    assert fields["coefficient"].keys() == fields["contact"].keys() == {"+", "-"}
    assert round(fields["coefficient"]["+"], 3) == 0.309
    assert round(fields["contact"]["+"]["s"] * math.pi, 2) == -1.13
    assert fields["contact"]["+"]["theta"] == math.pi
    assert round(fields["height"]["+"] * math.pi**2, 3) == 0.085
    assert fields["limit_coefficient"] == 0.125


@pytest.mark.parametrize(
    ("p", "q", "order"), [(1, 1, 4), (1, 2, 5), (2, 3, 6), (1, 4, 8), (1, 5, 10)]
)
def test_json_is_enough_to_rebuild_the_law(p: int, q: int, order: int) -> None:
    """At the stated ε, s, θ the profile from the stated formulas is zero to rounding."""
    fields = as_json(tongue(p, q, order))
    N, E = fields["order_used"], fields["pole"]
    assert Fraction(fields["exponent"]) == Fraction(E, N)
    assert N % q == 0
    assert N <= order < N + q
    singular = {int(j): float(sympy.sympify(a)) for j, a in fields["singular"].items()}
    for sign, factor in (("+", 1), ("-", (-1) ** E)):
        s, theta = fields["contact"][sign]["s"], fields["contact"][sign]["theta"]
        strength = factor * fields["coefficient"][sign] ** N
        profile = s * s
        for j, a in singular.items():
            rate = j * p * math.pi / q
            profile += 2 * strength * a * math.cos(j * theta) * (s - math.sin(rate * s) / rate)
        # C^N magnifies the rounding of C by N; the sum is one of terms of size s².
        assert abs(profile) <= 64 * N * 2.0**-52 * s * s
    v = float(sympy.sympify(fields["pendulum"]))
    expected = (math.pi**2 / (4 * v)) ** (1 / q)
    assert fields["limit_coefficient"] == pytest.approx(expected, rel=8 * 2.0**-52)
    assert fields["limit_exponent"] == str(Fraction(2, q))
    assert (fields["centre_shift"] == "0") == (q <= 2)
    assert fields["variable"] == ("mu_eff" if q == 5 else "mu")


def test_text_says_which_order_and_variable() -> None:
    text = as_text(tongue(1, 2, 5))
    assert "order 5: set by order 4, the largest multiple of 2 up to it" in text
    assert "epsilon = 1.81489 |mu|^(3/4)" in text
    assert "cos(4*theta): -pi**7/131072" in text
    assert "limit of all orders: epsilon = 1.27324 |mu|^(1)" in text
    shifted = as_text(tongue(1, 5, 10))
    assert "|mu_eff|^(3/10)" in shifted
    assert "mu_eff = mu - epsilon^2*(" in shifted
    assert "set by" not in as_text(tongue(1, 1, 3))


def test_every_law_comes_with_its_range() -> None:
    fields, text = as_json(tongue(1, 1, 3)), as_text(tongue(1, 1, 3))
    assert fields["range"] == {"+": None, "-": None}
    assert "series in epsilon diverges" in fields["range_reason"]
    assert fields["limit_range"] == pytest.approx(math.pi / 40, rel=1e-9)
    for key in ("range_reason", "limit_range_reason"):
        assert fields[key] in text
    assert "none for the rope" in text
    assert "|mu| < 0.0785" in text
    assert as_json(tongue(1, 5, 5))["limit_range"] is None
    assert "not estimated for q > 4" in as_text(tongue(1, 5, 5))


def test_table() -> None:
    results = [tongue(1, 1, 3), tongue(1, 2, 4), tongue(1, 5, 10), tongue(1, 1, 4)]
    lines = latex_table(results).splitlines()
    rows = [line for line in lines if line.startswith("$") and not line.startswith("$p")]
    assert lines[1].endswith("{@{}cccccccc@{}}")
    assert [row.count("&") for row in rows] == [7] * 5
    assert rows[1].startswith(r"$1/2$ & $4$ & $\pm$ & $3/4$ & $1.8149$")
    assert r"3/10\,^{*}" in rows[2]
    assert [row.split(" & ")[2] for row in rows[3:]] == ["$+$", "$-$"]
    assert lines[-1].startswith("%")
    with pytest.raises(InputError, match="at least one"):
        latex_table([])


@pytest.mark.slow
def test_figures_are_the_same_bytes_every_time(tmp_path: Path) -> None:
    first, second = tmp_path / "a.svg", tmp_path / "b.svg"
    results = plot_tongues([(1, 1), (1, 2), (1, 5)], 5, first)
    assert [r.singular.order for r in results] == [5, 4, 5]
    plot_tongues([(1, 1), (1, 2), (1, 5)], 5, second)
    assert first.read_bytes() == second.read_bytes()
    orders = plot_orders(1, 2, 8, tmp_path / "c.png")
    assert [r.singular.order for r in orders] == [2, 4, 6, 8]
    assert (tmp_path / "c.png").stat().st_size > 1000


def test_bad_figures(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="file name that ends in"):
        plot_tongues([(1, 1)], 3, tmp_path / "a.txt")
    with pytest.raises(InputError, match="at least one p/q"):
        plot_tongues([], 3, tmp_path / "a.png")
    with pytest.raises(InputError, match="lowest terms"):
        plot_tongues([(2, 2)], 3, tmp_path / "a.png")
    with pytest.raises(InputError, match="at least 4 at q = 2"):
        plot_orders(1, 2, 3, tmp_path / "a.png")
    assert not list(tmp_path.iterdir())
