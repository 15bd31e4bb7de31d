"""Where circles break up: values of the literature, orbits of the map itself, a second method."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from derivations.commands.critical import number_of
from numerics.errors import CircleNotFoundError, InputError
from numerics.exact_string import break_up as module
from numerics.exact_string.break_up import break_up
from numerics.exact_string.greene import periodic_orbit
from numerics.exact_string.invariant_circle import circle_at_rotation, invariant_circle
from numerics.exact_string.rotation import Noble, noble
from tests.command import said

GOLDEN = (math.sqrt(5) - 1) / 2
# J. M. Greene (1979) has 0.971635; R. S. MacKay's renormalisation (1993) gives 0.971635406.
GOLDEN_K = 0.971635406


def test_golden() -> None:
    found = break_up(Noble((0,)))
    assert found.strength == pytest.approx(GOLDEN_K, abs=1e-9)
    assert found.strength_error < 1e-9
    assert found.omega == pytest.approx(1.9387855, abs=5e-8)
    assert found.epsilon == pytest.approx(0.129245, abs=5e-7)
    assert found.by_norms == pytest.approx(GOLDEN_K, abs=1e-4)
    assert found.last_circle is not None
    assert found.last_circle.graph_margin > 0


def test_silver() -> None:
    """ν = √2 − 1, whose critical residue is not that of noble numbers."""
    found = break_up(noble(math.sqrt(2) - 1))
    assert found.strength == pytest.approx(0.957445, abs=1e-6)
    assert found.omega == pytest.approx(1.31762, abs=5e-6)
    assert found.epsilon == pytest.approx(0.27574, abs=5e-6)
    assert found.crossings[-1].residue == pytest.approx(0.2275, abs=2e-4)


@pytest.mark.parametrize(
    ("head", "longest"),
    [
        *(((0,), q) for q in (150, 400, 1000)),
        *(((0, 3, 5, 2), q) for q in (250, 400, 1000)),
        *(((0, *(2,) * 18), q) for q in (200, 450, 1000)),
        ((0, *(1, 2) * 9), 1000),
        ((0, 2, 4), 600),
    ],
)
def test_the_error_holds_for_shorter_orbits(
    head: tuple[int, ...], longest: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = break_up(Noble(head))
    monkeypatch.setattr(module, "_LONGEST", longest)
    short = break_up(Noble(head))
    assert abs(short.strength - exact.strength) <= short.strength_error
    assert abs(short.omega - exact.omega) <= short.omega_error


@pytest.mark.parametrize(("p", "q"), [(55, 89), (89, 144), (13, 34), (144, 89), (1, 3), (3, 4)])
def test_orbits_are_orbits(p: int, q: int) -> None:
    """Iterating the map itself closes after q steps; R from a product of matrices."""
    strength = 0.9
    orbit = periodic_orbit(p, q, strength)
    phi = 2 * math.pi * p * np.arange(q) / q + orbit.deviations
    jump = phi[1] - phi[0]
    x, r, tangent = 0.0, jump, np.eye(2)
    for j in range(q):
        assert x == pytest.approx(float(phi[j]), abs=1e-8)
        bend = strength * math.cos(x + r)
        x, r = x + r, r - strength * math.sin(x + r)
        tangent = np.array([[1, 1], [-bend, 1 - bend]]) @ tangent
    assert x == pytest.approx(2 * math.pi * p, abs=1e-8)
    assert r == pytest.approx(jump, abs=1e-8)
    assert orbit.residue == pytest.approx((2 - np.trace(tangent)) / 4, abs=1e-7)
    assert orbit.residue > 0  # elliptic, or inverse hyperbolic: the one through the island's middle


def test_quarter_residue_of_55_89() -> None:
    assert periodic_orbit(55, 89, 0.971653413793).residue == pytest.approx(0.25, abs=1e-9)


@pytest.mark.parametrize(("p", "q"), [(1597, 2584), (610, 987)])
def test_frequency_of_an_orbit_is_the_circles(p: int, q: int) -> None:
    """K = 0.9: the circle lasts, and a long orbit samples it; q odd and even."""
    circle = circle_at_rotation(GOLDEN, 0.9)
    difference = periodic_orbit(p, q, 0.9).omega - circle.omega
    assert abs(difference) <= 10 / q**2


@pytest.mark.parametrize("strength", [0.85, 0.95, 0.971])
def test_golden_circle_to_the_break_up(strength: float) -> None:
    """The map itself keeps to the circle, and fixed Ω and ε give the same ϱ."""
    circle = circle_at_rotation(GOLDEN, strength)
    again = invariant_circle(circle.omega, circle.epsilon)
    assert again.rotation_number == pytest.approx(2 * math.pi * GOLDEN, abs=1e-11)
    k = np.arange(1, len(circle.sines) + 1)

    def phase(psi: float) -> float:
        return psi + float(circle.sines @ np.sin(k * psi))

    before, now = phase(0.4 - 2 * math.pi * GOLDEN), phase(0.4)
    for step in range(1, 101):
        before, now = now, 2 * now - before - strength * math.sin(now)
        assert now == pytest.approx(phase(0.4 + 2 * math.pi * GOLDEN * step), abs=1e-10)


def test_the_contact_curve_and_speed_of_many_harmonics() -> None:
    """20000 harmonics: the curve against the inversion, the speed against its differences."""
    circle = circle_at_rotation(GOLDEN, 0.971)
    assert len(circle.sines) > 10_000
    tau, xi = circle.contact_curve(64)
    some = slice(None, None, len(tau) // 7)
    np.testing.assert_allclose(circle.contact(tau[some]), xi[some], rtol=0, atol=1e-12)
    speed = np.abs(np.diff(xi) / np.diff(tau)).max()
    assert circle.contact_speed == pytest.approx(speed, rel=1e-3)
    assert circle.contact_speed >= speed


def test_no_circle_is_found_above() -> None:
    with pytest.raises(CircleNotFoundError, match="no proof that there is none"):
        circle_at_rotation(GOLDEN, 0.973)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: circle_at_rotation(1.0, 0.1), "whole number"),
        (lambda: circle_at_rotation(-0.1, 0.1), "> 0"),
        (lambda: circle_at_rotation(GOLDEN, math.nan), "finite"),
        (lambda: periodic_orbit(2, 4, 0.5), "coprime"),
        (lambda: periodic_orbit(1, 2, 0.5), "3 ≤ q"),
        (lambda: periodic_orbit(1, 3, 0.0), "positive"),
        (lambda: noble(0.0), "between 0"),
        (lambda: noble(0.6, -1.0), "uncertainty"),
        (lambda: break_up(noble(1 / 3)), "farther from p/q"),
    ],
)
def test_arguments(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()


def test_nothing_beyond_the_proved_bound() -> None:
    with pytest.raises(CircleNotFoundError, match="63/64"):
        circle_at_rotation(GOLDEN, 0.99)


@pytest.mark.parametrize("value", [GOLDEN, 0.7548776662, math.e - 2, 17.123456, 0.0123456])
@pytest.mark.parametrize("digits", [5, 8, 12])
def test_noble_numbers_keep_the_digits(value: float, digits: int) -> None:
    meant = noble(value, 10.0**-digits)
    assert abs(meant.value - value) <= 1.0001 * 10.0**-digits
    errors = [abs(p / q - meant.value) for p, q, _ in meant.convergents(10_000)]
    assert errors == sorted(errors, reverse=True)


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    texts = []
    for name in ("a.svg", "b.svg"):
        plot = tmp_path / name
        code, out, _ = said(
            ["critical", "--rotation", "0.618034", "--json", "--plot", str(plot)], capsys
        )
        assert code == 0
        texts.append(plot.read_bytes())
    assert texts[0] == texts[1]
    fields = json.loads(out)
    assert fields["K"] == pytest.approx(GOLDEN_K, abs=1e-9)
    assert 0 < fields["error"] < 1e-9
    assert fields["epsilon"] == pytest.approx(fields["K"] / (2 * fields["omega"] ** 2))
    code, out, _ = said(["critical", "--rotation", "golden"], capsys)
    assert code == 0
    assert "0.971635406" in out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0.6", "1 digits"),
        ("1/2", "rational"),
        ("x", "no real number"),
        ("-0.618034", "between 0 and 1000"),
        ("nan", "no real number"),
        ("1e400", "give"),
        ("0.33333333", "farther from"),
        ("", "nothing stands there"),
    ],
)
def test_command_refuses(text: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(["critical", f"--rotation={text}"], capsys)
    assert code != 0
    assert out == ""
    assert message in err


def test_digits() -> None:
    assert number_of("1.2345e-2") == (0.012345, pytest.approx(5e-7))
    assert number_of("0.41421356237309505") == (0.41421356237309505, None)
    assert number_of("(sqrt(5)-1)/2")[0] == GOLDEN
