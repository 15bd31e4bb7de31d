"""Curves of folds and period doublings: against points located at fixed Ω, and a cusp."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from derivations.figures.branch import plot_curve
from numerics.errors import InputError
from numerics.periodic.branches import BranchPoint, follow
from numerics.periodic.linear_rope import LinearRope
from numerics.periodic.loci import _Locus, locus
from numerics.periodic.states import periodic_state
from tests.command import said
from tests.numerics.test_states import rope


def at(omega: float) -> LinearRope:
    return rope(omega)


def damped(omega: float) -> LinearRope:
    return rope(omega, 0.01, 0.01)


def located(omega: float, kind: str, highest: float) -> BranchPoint:
    walk = follow(at, periodic_state(at(omega), highest / 4), "epsilon", highest / 20, (0, highest))
    return next(point for point in walk if point.kind == kind)


@pytest.fixture(scope="module")
def doubling() -> BranchPoint:
    return located(6.45, "period doubling", 4e-3)


@pytest.mark.parametrize("kind", ["fold", "period doubling"])
def test_derivatives(kind: str) -> None:
    omega, epsilon = (3.2, 1.3e-3) if kind == "fold" else (6.45, 2.5e-3)
    state = periodic_state(at(omega), epsilon)
    curve = _Locus(at, kind, state.modes, np.ones(3))
    z = np.concatenate([state.unknown, [epsilon, omega]])
    curve.take_border(z)
    _, rows = curve.equations(z)
    generator = np.random.default_rng(2)
    way = generator.standard_normal(z.size) * 1e-2
    for part, h in ((slice(0, -2), 1e-6), (slice(-2, -1), 1e-3), (slice(-1, None), 1e-3)):
        some = np.zeros_like(z)
        some[part] = way[part]
        up, down = (curve.equations(z + d * h * some)[0] for d in (1, -1))
        change = (up - down) / (2 * h)
        assert np.allclose(change, rows @ some, rtol=1e-3, atol=1e-6 * abs(rows @ some).max())


def test_folds_at_other_frequencies() -> None:
    points = list(locus(at, located(3.2, "fold", 2e-3), 0.008, (3.2, 3.24)))
    assert points[0].epsilon == pytest.approx(1.38788e-3, abs=1e-8)
    assert (points[-1].omega, points[-1].kind) == (3.24, None)
    assert points[-1].epsilon == pytest.approx(1.1486248e-4, rel=1e-7)
    for point in points:
        assert point.residual < 1e-12
        assert point.state.residual < 1e-10


@pytest.mark.slow
def test_the_tongue(doubling: BranchPoint) -> None:
    """As far as a state at twice the frequency, and through its tip, where ε changes its sign."""
    points = list(locus(at, doubling, 0.02, (6.4, 6.48)))
    assert points[-1].epsilon == pytest.approx(9.65194e-4, abs=1e-8)
    points = list(locus(at, doubling, 0.02, (6.4, 6.52)))
    assert points[-1].epsilon == pytest.approx(-9.06562e-4, abs=1e-8)
    tips = [
        a.omega + a.epsilon * (b.omega - a.omega) / (a.epsilon - b.epsilon)
        for a, b in pairwise(points)
        if a.epsilon > 0 > b.epsilon
    ]
    assert tips == [pytest.approx(6.5000026, abs=2e-3)]


def test_the_figure(doubling: BranchPoint, tmp_path: Path) -> None:
    points = list(locus(at, doubling, 0.02, (6.4, 6.46)))
    plots = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for plot in plots:
        plot_curve("period doubling", [replace(points[0], kind="cusp"), *points[1:]], plot)
    assert plots[0].read_bytes() == plots[1].read_bytes()
    assert b"cusp" in plots[0].read_bytes()


@pytest.mark.slow
def test_a_cusp() -> None:
    """With damping the hysteresis at Ω₁ begins at a cusp: folds are there above it, none below."""
    start = periodic_state(damped(3.19), 5e-4)
    walk = follow(damped, start, "omega", 0.004, (3.1, 3.26), longest=20.0, accuracy=1e-8)
    first, second = (point for point in walk if point.kind == "fold")
    limits = (second.omega, 3.3)
    points = list(locus(damped, first, 0.002, limits, accuracy=1e-8))
    (cusp,) = (point for point in points if point.kind == "cusp")
    lowest = min(point.epsilon for point in points)
    assert abs(cusp.epsilon - lowest) < 0.05 * lowest
    assert points[-1].epsilon == pytest.approx(5e-4, rel=1e-6)
    below = follow(
        damped,
        periodic_state(damped(3.19), 0.95 * lowest),
        "omega",
        0.004,
        (3.1, 3.26),
        longest=20.0,
        accuracy=1e-8,
    )
    assert not [point for point in below if point.kind == "fold"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"step": 0.0}, "other than zero"),
        ({"step": float("inf")}, "finite"),
        ({"limits": (6.5, 7.0)}, "outside its limits"),
    ],
)
def test_arguments(change: dict, message: str, doubling: BranchPoint) -> None:
    given = {"step": 0.01, "limits": (6.0, 7.0), **change}
    with pytest.raises(InputError, match=message):
        next(locus(at, doubling, **given))


def test_only_folds_and_doublings_have_a_curve() -> None:
    start = periodic_state(at(2.2), 0.01)
    point = next(follow(at, start, "epsilon", 0.001, (0, 0.02)))
    with pytest.raises(InputError, match="regular point has no curve"):
        next(locus(at, point, 0.01, (2.0, 2.4)))


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plot = tmp_path / "a.svg"
    wanted = ["branch", "--beta", "0.01", "--omega", "3.2", "--epsilon", "1e-3", "--to", "2e-3"]
    wanted += ["--points", "8", "--step", "1e-4", "--no-stability"]
    code, out, _ = said([*wanted, "--curve", "3.22", "--plot", str(plot), "--json"], capsys)
    assert code == 0
    found = json.loads(out)["curve"]
    assert (found["kind"], found["ended"]) == ("fold", None)
    assert found["points"][-1]["omega"] == 3.22
    assert found["points"][-1]["epsilon"] == pytest.approx(6.2009e-4, rel=1e-4)
    assert b"svg" in plot.read_bytes()
    for given, message in (("3.2", "other than"), ("-1", "positive"), ("nan", "finite")):
        code, out, err = said([*wanted, "--curve", given], capsys)
        assert (code != 0, out) == (True, "")
        assert message in err
    plain = ["branch", "--omega", "2.2", "--epsilon", "0.01", "--to", "0.02", "--no-stability"]
    code, _, err = said([*plain, "--curve", "2.3"], capsys)
    assert code != 0
    assert "no fold and no period doubling" in err
