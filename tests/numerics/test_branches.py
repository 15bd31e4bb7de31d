"""Branches of periodic states: folds, period doublings, the doubled branch, two ways to a state."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from numerics.errors import InputError
from numerics.periodic import branches
from numerics.periodic.branches import BranchPoint, doubled_state, embedded, follow, switched
from numerics.periodic.linear_rope import LinearRope, NoPeriodicStateError
from numerics.periodic.modes import Modes
from numerics.periodic.stability import multipliers
from numerics.periodic.states import PeriodicState, periodic_state
from tests.command import said
from tests.numerics.test_states import rope


def at(omega: float) -> LinearRope:
    """The paper's rope at β = 0.01."""
    return rope(omega)


@pytest.fixture(scope="module")
def folded() -> list[BranchPoint]:
    """Past the fold at Ω = 3.2."""
    start = periodic_state(at(3.2), 8e-4)
    return list(follow(at, start, "epsilon", 1e-4, (0.0, 2e-3), points=8))


def test_the_fold(folded: list[BranchPoint]) -> None:
    (fold,) = [point for point in folded if point.kind is not None]
    assert fold.kind == "fold"
    assert fold.epsilon == pytest.approx(1.38788e-3, abs=1e-8)
    assert fold.width < 1e-4
    epsilons = [point.epsilon for point in folded]
    assert max(epsilons) <= fold.epsilon + 1e-12
    assert epsilons[-1] < fold.epsilon
    # A pair of multipliers meets at +1 and becomes real.
    before, after = (abs(multipliers(point.state, 10)).max() for point in (folded[0], folded[-1]))
    assert before == pytest.approx(1, abs=1e-8)
    assert after > 1.01


def test_points_are_states_and_steps_are_along_the_arc(folded: list[BranchPoint]) -> None:
    for point in folded[:2]:
        known = periodic_state(at(3.2), point.epsilon)
        tau = np.linspace(0, 2, 9)
        assert np.allclose(point.state.contact(tau), known.contact(tau), atol=1e-10)
    assert all(point.state.residual < 1e-11 for point in folded)
    arcs = [point.arclength for point in folded]
    assert arcs == sorted(arcs)


def test_two_ways_to_one_state() -> None:
    """Along Ω at fixed ε, and from rest at that Ω."""
    start = periodic_state(at(2.2), 0.01)
    points = list(follow(at, start, "omega", 0.05, (2.0, 2.4), points=9))
    assert [point.kind for point in points] == [None] * len(points)
    assert points[-1].omega == 2.4
    assert all(point.epsilon == 0.01 for point in points)
    known = periodic_state(at(points[-1].omega), 0.01)
    tau = np.linspace(0, 3, 11)
    assert np.allclose(points[-1].state.contact(tau), known.contact(tau), atol=1e-11)


def test_a_state_over_two_periods_solves_its_equations() -> None:
    state = periodic_state(at(6.45), 1e-3)
    modes = state.modes
    big = Modes(modes.rope, 2 * modes.times - 1, 2)
    left, _, _ = big.equations(embedded(state.unknown, modes, big), 1e-3)
    assert abs(left).max() < 1e-12


def test_period_doubling_and_the_branch_that_it_opens() -> None:
    start = periodic_state(at(6.48), 8e-4)
    walk = follow(at, start, "epsilon", 1e-4, (0.0, 3e-3), points=4)
    doubling = next(point for point in walk if point.kind is not None)
    assert doubling.kind == "period doubling"
    assert doubling.harmonic == 1
    # The normal form's edge, order 8.
    assert doubling.epsilon == pytest.approx(9.65194e-4, abs=1e-9)
    values = multipliers(doubling.state, 12)
    assert abs(values + 1).min() < 1e-2
    first, way = switched(doubling)
    points = list(follow(at, first, "epsilon", 1e-4, (0.0, 3e-3), points=9, tangent=way))
    assert all(point.kind is None for point in points)
    halves = np.array([2 * abs(point.state.waves[1]) / 2 for point in points])
    epsilons = np.array([point.epsilon for point in points])
    assert halves[0] < 1e-8
    assert (np.diff(halves) > 0).all()
    # It opens like a parabola in the amplitude of the half harmonic, towards smaller ε.
    curvature = (epsilons[3:] - doubling.epsilon) / halves[3:] ** 2
    assert (curvature < 0).all()
    assert curvature[-1] / curvature[0] == pytest.approx(1, abs=0.05)
    assert points[-1].state.residual < 1e-11


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"free": "beta"}, "epsilon, omega"),
        ({"step": 0.0}, "other than zero"),
        ({"step": float("nan")}, "finite"),
        ({"limits": (0.1, 0.2)}, "outside its limits"),
    ],
)
def test_arguments(change: dict, message: str) -> None:
    given = {"free": "epsilon", "step": 1e-3, "limits": (0.0, 0.02), **change}
    with pytest.raises(InputError, match=message):
        next(follow(at, periodic_state(at(2.2), 0.01), **given))


def test_states_of_twice_the_period() -> None:
    """On the way to its branch's beginning at 2.54022e-3 the half harmonic goes like a root."""
    near, far = (doubled_state(at(6.45), epsilon) for epsilon in (2.52e-3, 2.46e-3))
    assert near.modes.subharmonic == 2
    ratio = (2.54022e-3 - 2.46e-3) / (2.54022e-3 - 2.52e-3)
    assert abs(far.waves[1]) / abs(near.waves[1]) == pytest.approx(math.sqrt(ratio), rel=0.02)
    assert max(near.error, far.error) < 1e-9
    for epsilon in (0.0, -1e-3, 0.6):
        with pytest.raises(InputError, match="above 0"):
            doubled_state(at(6.45), epsilon)


def test_only_period_doublings_are_switched(folded: list[BranchPoint]) -> None:
    with pytest.raises(InputError, match="no branch of twice the period"):
        switched(folded[0])


@pytest.mark.parametrize("most", [24, 8])
def test_a_lost_branch_says_where(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """The string needs the more harmonics the farther it is driven; 8 is less than it begins on."""
    monkeypatch.setattr(branches, "MOST", most)
    string = rope(2.2, 0.0)
    start = periodic_state(string, 0.02)
    with pytest.raises(NoPeriodicStateError, match=rf"epsilon = 0\.0.* not resolved by {most}"):
        list(follow(lambda omega: string, start, "epsilon", 0.01, (0.0, 0.12)))


def test_a_graze_of_few_harmonics_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if the lifted part came down at ε = .0123 on the harmonics of the start only."""
    bent = rope(2.2)
    start = periodic_state(bent, 0.01)
    few = start.modes.times

    def height(state: PeriodicState, *_: int) -> float:
        return -1.0 if state.epsilon > 0.0123 and state.modes.times == few else 1.0

    monkeypatch.setattr(PeriodicState, "clearance", height)
    with pytest.raises(NoPeriodicStateError, match=r"grazes the ground is not resolved by \d+"):
        list(follow(lambda omega: bent, start, "epsilon", 1e-3, (0.0, 0.015)))


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plot = tmp_path / "a.svg"
    arguments = ["branch", "--beta", "0.01", "--omega", "3.2", "--epsilon", "1e-3", "--to", "2e-3"]
    arguments += ["--points", "8", "--step", "1e-4", "--json", "--plot", str(plot)]
    code, out, _ = said(arguments, capsys)
    assert code == 0
    fields = json.loads(out)
    (fold,) = fields["bifurcations"]
    assert fold["kind"] == "fold"
    assert fold["epsilon"] == pytest.approx(1.38788e-3, abs=1e-8)
    verdicts = [point["stable"] for point in fields["points"]]
    assert (verdicts[0], verdicts[-1]) == ("stable", "unstable")
    assert {"epsilon", "omega", "amplitude", "stable"} <= fields["points"][0].keys()
    drawn = plot.read_bytes()
    said([*arguments, "--no-stability"], capsys)
    assert drawn != plot.read_bytes()  # without dashes


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--epsilon", "0.01", "--to", "0.01"], "where the branch begins"),
        (["--epsilon", "0.01", "--to", "nan"], "finite"),
        (["--epsilon", "0.01", "--to", "0.02", "--omega", "-1"], "positive"),
        (["--epsilon", "0.01", "--to", "0.011", "--subharmonic", "2"], "no period doubling"),
        (["--epsilon", "0.01", "--to", "0.02", "--step", "0"], "other than zero"),
    ],
)
def test_command_refuses(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ["branch", "--beta", "0.01", *arguments]
    if "--omega" not in arguments:
        given += ["--omega", "2.2"]
    code, out, err = said(given, capsys)
    assert code != 0
    assert out == ""
    assert message in err
