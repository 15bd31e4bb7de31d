"""Fig. 2 at working resolution: laws, fits, figure, resumption and the command."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asymptotics.errors import InputError, ResultError
from derivations.app import app, main
from derivations.commands.figure2 import figure2 as command
from derivations.figure2 import data as figure2
from derivations.figure2.fits import Curve, approach, curves, deviations, exponents, power
from derivations.figure2.laws import (
    LARGEST_AMPLITUDE,
    Family,
    all_laws,
    first_convergent,
    fold_window,
    laws,
)
from derivations.figure2.plot import plot_figure2
from derivations.figure2.points import MECHANISMS
from derivations.figure2.tables import tables
from numerics.errors import FileError
from numerics.thresholds.threshold import Mechanism

DOCS = Path(__file__).parents[2] / "docs"
RESONANCES = ("1/2", "1/1", "2/1")
# Whether or not the command is registered already, it must work.
if command not in [entry.callback for entry in app.registered_commands]:
    app.command()(command)


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(["figure2", *arguments])
    return int(caught.value.code or 0)


def row(beta: float, omega: float, middle: float, spread: float = 0.1) -> dict[str, Any]:
    """A point as the computation would return it."""
    lower, upper = middle * math.exp(-spread), middle * math.exp(spread)
    bracket = {"change": "base", "lower": lower, "upper": upper, "growth": None}
    return {
        "beta": beta,
        "omega": omega,
        "lower": lower,
        "upper": upper,
        "mechanism": "sonic contact",
        "circle": [lower, middle] if beta == 0 else None,
        "brackets": [bracket],
    }


def synthetic(exponent: float = 1.5, spread: float = 0.1) -> list[dict[str, Any]]:
    """0.1 |μ|^exponent around each Ω₁(β) and Ω₂(β), and the exact string's pendulum."""
    rows = []
    for beta in (0.01, 0.001, 0.0):
        for centre in list(figure2.centres(beta).values())[1:]:
            for size in figure2.detunings(7):
                power_of = 2.0 if beta == 0 else exponent
                middle = 0.1 * size**power_of
                rows += [row(beta, centre + s * size, middle, spread) for s in (-1, 1)]
        rows.append(row(beta, 2.9, 0.007 + math.sqrt(beta)))
    return rows


def test_laws_are_those_derived_and_printed() -> None:
    """Sheet §3, §4, §7; eq. (grazing); the caption of Fig. 2."""
    truncated, pendulum = laws(Family.TRUNCATED), laws(Family.PENDULUM)
    assert [law.coefficient for law in truncated] == pytest.approx(
        [1.8148896, 0.3092163, 0.0773041], abs=6e-8
    )
    assert [str(law.exponent) for law in truncated] == ["3/4", "5/3", "5/3"]
    assert [law.coefficient for law in pendulum] == pytest.approx([4 / math.pi, 1 / 8, 1 / 32])
    assert [law.centre for law in pendulum] == pytest.approx([math.pi / 2, math.pi, 2 * math.pi])
    folds = laws(Family.FOLD, 0.01)
    assert [law.coefficient for law in folds[:2]] == pytest.approx([0.995778, 0.112680], abs=6e-7)
    assert [law.centre for law in folds] == pytest.approx([1.6250, 3.2500, 7.1777], abs=6e-5)
    assert [law.sides for law in folds] == [(-1,), (-1,), (1,)]
    paper = laws(Family.PAPER)
    assert [(law.centre, law.coefficient) for law in paper] == [
        (1.6, 1.815),
        (3.2, 0.309),
        (6.4, 0.077),
    ]
    assert len(all_laws()) == 15


def test_a_law_is_nothing_on_the_other_side() -> None:
    fold = laws(Family.FOLD, 0.01)[1]
    below, above = fold.epsilon(fold.centre + np.array([-0.1, 0.1]))
    assert below == pytest.approx(0.112680 * 0.1**1.5, rel=1e-5)
    assert math.isnan(above)


def test_the_fold_of_a_half_has_its_shift() -> None:
    """2μ = γε² + κε^{4/3}, with the coefficients at β = 0.01; C |μ|^{3/4} alone is lower."""
    fold = laws(Family.FOLD, 0.01)[0]
    epsilon = float(fold.epsilon(fold.centre - 0.1))
    kappa = -((27 * 3.89146 * 0.556560**2 / 4) ** (1 / 3))
    assert 0.891259 * epsilon**2 + kappa * epsilon ** (4 / 3) == pytest.approx(-0.2, rel=1e-5)
    assert epsilon > 1.05 * fold.coefficient * 0.1**0.75
    assert r"\gamma\epsilon^2/2" in fold.text
    assert r"\gamma" not in laws(Family.FOLD, 0.01)[1].text


def test_truncated_tongues_lie_beyond_the_radius_of_convergence() -> None:
    for name, truncated, pendulum in zip(
        RESONANCES, laws(Family.TRUNCATED), laws(Family.PENDULUM), strict=True
    ):
        edge = first_convergent(name)
        assert edge > 4  # far beyond the distance to the next resonance
        both = [float(law.epsilon(law.centre + edge)) for law in (truncated, pendulum)]
        assert both[0] == pytest.approx(both[1], rel=1e-12)
        assert truncated.epsilon(truncated.centre + 0.1) > pendulum.epsilon(pendulum.centre + 0.1)


def test_the_folds_window_closes_as_bending_goes() -> None:
    low, high = fold_window("1/1", 0.01)
    # 3 √(μ/3α) = the largest amplitude at the lower edge, α of sheet §7.
    assert 3 * math.sqrt(low / (3 * 3.89146)) == pytest.approx(LARGEST_AMPLITUDE, rel=1e-5)
    assert high == pytest.approx(0.5 * (7.1777 - 2 * 3.2500), abs=1e-4)
    assert fold_window("1/2", 0.01) == pytest.approx((low / 2, high / 2))
    assert fold_window("1/1", 0.001) == (math.inf, 0.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 5 / 3, 2.0])
def test_error_bars_cover_the_exponent(exponent: float) -> None:
    """Of many noisy samples about 95 % lie within two standard errors."""
    random = np.random.default_rng(4)
    mu, error = np.geomspace(0.01, 0.5, 8), np.linspace(0.02, 0.1, 8)
    inside, errors = 0, []
    for _ in range(400):
        noisy = 0.2 * mu**exponent * np.exp(error * random.standard_normal(8))
        value, deviation, *_ = power(mu, noisy, error)
        inside += abs(value - exponent) <= 2 * deviation
        errors.append(deviation)
    # Scatter above 1 enlarges the error, so that the coverage is 0.954 or a little more.
    assert 0.93 <= inside / 400 <= 0.995
    assert max(errors) < 0.1


def test_what_is_no_power_law_gets_a_larger_error() -> None:
    mu, error = np.geomspace(0.01, 0.5, 8), np.full(8, 0.01)
    straight = power(mu, mu**1.5, error)
    bent = power(mu, mu**1.5 * np.exp(0.3 * np.log(mu) ** 2), error)
    assert straight[4] < 1e-20
    assert bent[1] > 10 * straight[1]
    with pytest.raises(InputError, match="2 points"):
        power(mu[:2], mu[:2], error[:2])


def test_exponents_are_fitted_from_the_linear_spectrums_centre() -> None:
    fits = exponents(synthetic())
    seen = {(fit.curve, fit.resonance, fit.side, fit.window) for fit in fits}
    assert {("beta = 0.01", "1/1", -1, "near"), ("last circle", "2/1", 1, "far")} <= seen
    for fit in fits:
        truth = 2.0 if fit.curve in ("beta = 0", "last circle") else 1.5
        if 2.9 in _omegas(fit):
            continue
        assert fit.value == pytest.approx(truth, abs=1e-9)
        assert fit.coefficient == pytest.approx(
            0.1 * (math.exp(-0.05) if fit.curve == "last circle" else 1), rel=1e-9
        )
        assert 0 < fit.error < 0.2


def _omegas(fit: Any) -> list[float]:
    """2.9 if the synthetic point there, which is no part of the law, is in the fit's window."""
    beta = {"beta = 0.01": 0.01, "beta = 0.001": 0.001}.get(fit.curve, 0.0)
    mu = 2.9 - figure2.centres(beta)[fit.resonance]
    return [2.9] if mu * fit.side > 0 and 0.07 <= abs(mu) <= 0.6 and fit.window == "far" else []


def test_deviations_tell_where_a_law_is_met() -> None:
    fold = laws(Family.FOLD, 0.01)[1]
    sizes = np.geomspace(0.02, 0.4, 6)
    factors = np.array([2.0, 1.2, 1.05, 0.95, 0.92, 0.5])
    rows = [
        row(0.01, fold.centre - mu, factor * float(fold.epsilon(fold.centre - mu)))
        for mu, factor in zip(sizes, factors, strict=True)
    ]
    [found] = deviations(rows, [fold])
    assert found.ratio == pytest.approx(factors)
    assert found.matched == pytest.approx((sizes[2], sizes[4]))
    assert found.inside.tolist() == [False, False, True, True, True, False]
    [crossing] = found.crossings
    assert sizes[2] < crossing < sizes[3]


def test_approach_starts_at_the_exact_string() -> None:
    found = [item for item in approach(synthetic()) if item["omega"] == 2.9]
    assert [item["beta"] for item in found] == [0.01, 0.001, 0.0]
    assert found[-1]["ratio"] == 1.0
    assert found[0]["ratio"] == pytest.approx(0.107 / 0.007)


@pytest.mark.slow
def test_a_killed_run_goes_on(tmp_path: Path) -> None:
    wanted = [{"beta": 0.0, "omega": omega, "coarse": True} for omega in (2.9, 6.0)]
    calls: list[int] = []
    first = figure2.compute(True, tmp_path, wanted=wanted[:1])
    again = figure2.compute(
        True, tmp_path, wanted=wanted, progress=lambda done, _: calls.append(done)
    )
    assert calls == [1, 2]  # one was there already
    assert again[0] == first[0]
    with pytest.raises(FileError, match="belongs to another sweep"):
        figure2.sweep(figure2.point, wanted, tmp_path, figure2.specification(False))


def test_collected_data_come_back_and_others_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    path.write_text(figure2.collected(figure2._rounded(synthetic()), True))
    points, coarse = figure2.read_collected(path)
    assert coarse
    assert [point["omega"] for point in points] == pytest.approx(
        [point["omega"] for point in synthetic()], rel=1e-6
    )
    content = json.loads(path.read_text())
    content["specification"] = "something else"
    path.write_text(json.dumps(content))
    with pytest.raises(FileError, match="Compute it anew"):
        figure2.read_collected(path)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_nothing_but_numbers_is_collected(value: float) -> None:
    points = [synthetic()[0] | {"omega": value}]
    with pytest.raises(ResultError, match=r"points\[0\]\.omega = .* is no number"):
        figure2.collected(points, True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--workers", "0"], "--workers"),
        (["--out", "figure.bmp"], "ends in .pdf, .png, .svg"),
        (["--tables", "tables.html"], "ends in .md"),
        (["--data", "nowhere.json"], "cannot read nowhere.json"),
        (["--data", "pyproject.toml.json"], "cannot read"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--coarse", *arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err


@pytest.mark.slow
def test_two_frequencies_from_simulation_to_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The whole command, at two Ω and with short ramps."""
    monkeypatch.setattr(figure2, "COARSE_OMEGAS", (2.9, 2.91))
    monkeypatch.setattr(figure2, "BETAS", (0.01,))
    monkeypatch.setattr(figure2, "RAMP", 10.0)
    monkeypatch.setattr(figure2, "HOLD", 2.0)
    out, collect, text = (tmp_path / name for name in ("figure.png", "points.json", "tables.md"))
    arguments = ["--coarse", "--out", str(out), "--collect", str(collect), "--json"]
    arguments += ["--tables", str(text)]
    assert run(*arguments, "--data", str(tmp_path)) == 0
    report = json.loads(capsys.readouterr().out)
    assert [(point["beta"], point["omega"]) for point in report["points"]] == [
        (0.01, 2.9),
        (0.01, 2.91),
        (0.0, 2.9),
        (0.0, 2.91),
    ]
    simulated, string = report["points"][0], report["points"][2]
    assert 0.01 < simulated["lower"] < simulated["upper"] <= 1.05 * simulated["lower"] * (1 + 1e-12)
    assert string["upper"] < simulated["lower"]  # bending holds the state together
    assert len(report["laws"]) == 15
    assert out.stat().st_size > 40_000
    assert len(list((tmp_path / "coarse").iterdir())) == 4
    points, _ = figure2.read_collected(collect)
    assert points == report["points"]
    assert report["files"] == [str(out), str(collect), str(text)]
    assert text.read_text(encoding="utf-8") == tables(points, coarse=True)
    again = tmp_path / "again.png"
    plot_figure2(points[::-1], again)
    assert again.read_bytes() == out.read_bytes()


def test_committed_points_cover_the_figure() -> None:
    """docs/figure2.json is complete, and its intervals are intervals."""
    points, coarse = figure2.read_collected(DOCS / "figure2.json")
    assert not coarse
    content = json.loads((DOCS / "figure2.json").read_text(encoding="utf-8"))
    assert content["specification"] == figure2.specification()
    found = {(point["beta"], point["omega"]) for point in points}
    assert found == {(task["beta"], task["omega"]) for task in figure2.tasks()}
    for point in points:
        assert 0 < point["lower"] < point["upper"]
        names = [item["change"] for item in point["brackets"]]
        assert len(names) == (7 if point["beta"] > 0 else 4)


def test_committed_tables_are_those_of_the_committed_points() -> None:
    points, coarse = figure2.read_collected(DOCS / "figure2.json")
    assert (DOCS / "figure2-tables.md").read_bytes() == tables(points, coarse).encode()


def cells(text: str, section: str) -> list[list[str]]:
    """The rows of one table, its head first."""
    body = text.split(f"\n## {section}\n\n")[1].split("\n\n")[0]
    lines = [line[2:-2].replace("\\|", "¦").split(" | ") for line in body.splitlines()]
    return [lines[0], *lines[2:]]


def test_tables_tell_what_the_points_hold() -> None:
    """Points of 0.1 |μ|^1.5 with ends a factor e^0.1 off, and pendulums of 0.1 μ²."""
    text = tables(synthetic())
    assert cells(text, "Points")[1] == ["0.01", "29", "1.22", "1.2", "0", "0", "29", "0"]
    dips = {(line[0], line[1][:2]): line for line in cells(text, "Lowest points")[1:]}
    assert dips["0.01", "Ω₁"][3:] == ["-0.0125", "0.00014 [0.000126, 0.000154]"]
    fits = cells(text, "Local exponents")
    assert fits[0][2:] == ["β = 0.01", "β = 0.001", "β = 0, ramped", "last circle"]
    found = {(line[0], line[1]): line[2:] for line in fits[1:]}
    assert [cell.split()[0] for cell in found["above Ω₂", "near"]] == ["1.50"] * 2 + [
        "2.00",
        "2.000",
    ]
    assert found["below Ω₁/2", "near"] == ["–"] * 4
    # 0.8 e^-0.05 is the middle of the circle's bracket over the law.
    _, above = (line for line in cells(text, "Pendulum") if line[0] == "0.125 ¦μ¦^2")
    assert above[1].startswith("last circle, above 3.1416")
    assert above[2].split(", ")[0] == f"0.0125: {0.8 * math.exp(-0.05):.2f}"
    assert "*" not in above[2]


def test_tables_star_the_laws_that_intervals_contain() -> None:
    fold = laws(Family.FOLD, 0.01)[1]
    sizes = (0.02, 0.1)
    rows = [
        row(0.01, fold.centre - mu, factor * float(fold.epsilon(fold.centre - mu)))
        for mu, factor in zip(sizes, (1.05, 1.2), strict=True)
    ]
    head, line = cells(tables(rows), "Bending folds")
    assert head == ["law", "curve", "computed over law at ¦μ¦"]
    assert line == ["0.1127 ¦μ¦^3/2", "β = 0.01, below 3.2500", "0.02: 1.05*, 0.1: 1.20"]
    moved = [line for line in cells(tables(rows), "Truncated tongues") if "below 3.2500" in line[1]]
    truncated = laws(Family.TRUNCATED)[1]
    value = 1.2 * 0.112680 * 0.1**1.5 / (truncated.coefficient * 0.1 ** (5 / 3))
    assert moved[0][2].split(", ")[1] == f"0.1: {value:.2f}"


def test_tables_know_neither_order_nor_other_mechanisms() -> None:
    rows = [*synthetic(), row(1e-4, 2.9, 0.01)]
    assert tables(rows[::-1]) == tables(rows)
    assert cells(tables(rows), "β → 0")[2][1:] == [
        "0.10700 [0.09682, 0.11825], ×15.29",
        "0.03862 [0.03495, 0.04268], ×5.52",
        "0.01000 [0.00905, 0.01105], ×1.43",
        "0.00700 [0.00633, 0.00774], ×1.00",
    ]
    assert set(MECHANISMS) == {item.value for item in Mechanism}


def test_curves_are_ordered() -> None:
    found = curves(list(reversed(synthetic())))
    assert [curve.name for curve in found] == [
        "beta = 0.01",
        "beta = 0.001",
        "beta = 0",
        "last circle",
    ]
    assert all((np.diff(curve.omega) > 0).all() for curve in found)
    assert isinstance(found[0], Curve)


@pytest.mark.slow
def test_the_last_circle_found_is_a_lower_bound_and_not_a_close_one():
    """At Ω = 1.9387855 the golden circle lasts to ε = .129245 (K = .971635); docs/figure2.md."""
    low, high = figure2.largest_circle(1.9387855)
    assert high < 1.011 * low
    assert 0.97 * 0.129245 < low < high < 0.129245
