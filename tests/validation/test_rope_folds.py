"""The amplitude equation of any rope: the beam's own, and states that are not expanded."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import MovingContact, moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.resonances.folds import amplitude_equation
from asymptotics.resonances.rope_fold import RopeFold, rope_fold
from derivations.cross_check.ropes import in_numbers
from numerics.periodic.linear_rope import LinearRope
from numerics.periodic.modes import Modes
from numerics.periodic.states import solve
from tests.command import said

KAPPA = sp.Symbol("kappa")


@pytest.mark.parametrize("end", ["pinned", "clamped"])
@pytest.mark.parametrize(
    ("p", "q", "beta"), [(1, 1, 0.01), (1, 2, 0.05), (2, 3, 0.3), (1, 1, 1e-4)]
)
def test_the_beam_has_its_own_amplitude_equation(p: int, q: int, beta: float, end: str) -> None:
    """Two derivations that share the order loop only: scaled exponentials, and determinants."""
    found = rope_fold(beam(driven_end=end), {"beta": beta}, p, q)
    known = amplitude_equation(p, q, beta, end)
    assert pytest.approx(known.F.value, rel=1e-14) == found.F
    assert found.alpha == pytest.approx(known.alpha.value, rel=1e-14)
    if known.gamma is not None:
        assert found.gamma == pytest.approx(known.gamma.value, rel=1e-13)
    assert found.excited == q
    # The double root of the cubic lies where the law says.
    small = 1e-5
    mu = float(found.detuning(small))
    sides = [len(found.amplitudes(mu * (1 + d), small)) for d in (1e-3, -1e-3)]
    assert sorted(sides) == [1, 3]


ROPES: dict[str, tuple[MovingContact, dict[str, float], int]] = {
    "beam on a foundation": (beam(beta=sp.Rational(1, 20), foundation=KAPPA), {"kappa": 3.0}, 1),
    "string on a foundation": (string(foundation=KAPPA), {"kappa": 6.0}, 1),
    "guided beam": (
        moving_contact(
            equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - W.diff(xi, 4) / 20),
            driven_end=[
                sp.Eq(W.diff(xi), 0),
                sp.Eq(W.diff(xi, 3), 18 + 18 * epsilon * sp.cos(Omega * tau)),
            ],
            contact=[W, W.diff(xi), W.diff(xi, 2)],
        ),
        {},
        1,
    ),
    "beam at half its second frequency": (beam(beta=sp.Rational(1, 20)), {}, 2),
}


def amplitude_of_state(
    stated: LinearRope, size: float, q: int, start: float, times: int = 17
) -> float:
    """The amplitude of cos qθ in ξ_c of the periodic state that Newton finds from a given one."""
    modes = Modes(stated, times)
    wave = np.cos(q * modes.phase)
    state = solve(modes, modes.start(stated.rest + start * wave, size), size)
    assert state is not None
    return float(2 * np.mean(state.values * wave))


@pytest.mark.parametrize("name", ROPES)
def test_periodic_states_obey_it(name: str) -> None:
    """At the resonance itself F ε^{n₀} + α a³ = −γε² a; states by modes approach its root."""
    rope, at, q = ROPES[name]
    found: RopeFold = rope_fold(rope, at, 1 if q == 1 else 2, q)
    values = rope.values({**at, "Omega": found.frequency / q})
    rest = complex(rope.at({**at, "Omega": 2.0}).rest or 0).real
    stated = in_numbers(rope, values, rest)
    errors = []
    for size in (2e-4, 5e-5) if q == 1 else (4e-3, 1e-3):
        (root,) = found.amplitudes(0.0, size)
        state = amplitude_of_state(stated, size, q, float(root))
        errors.append((abs(state / root - 1), abs(root)))
    # What is left is of relative order a²: the next odd power.
    (coarse, large), (fine, little) = errors
    assert coarse < 0.3
    order = np.log(coarse / fine) / np.log(large / little)
    assert order > 1.6 or fine < 1e-6, errors


def test_what_has_no_such_fold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="without damping"):
        rope_fold(beam(damping=0.1), {"beta": 0.01}, 1, 1)
    with pytest.raises(InputError, match="another resonance"):
        rope_fold(string(), {}, 1, 1)
    with pytest.raises(InputError, match="not excited"):
        rope_fold(beam(drive={2: (1, 0)}), {"beta": 0.01}, 1, 3)
    for p, q in ((0, 1), (1, 9), (1.5, 1)):
        with pytest.raises(InputError, match="whole number"):
            rope_fold(beam(), {"beta": 0.01}, p, q)  # type: ignore[arg-type]


def test_a_second_drive_changes_the_forcing_not_the_amplitude_s_own_law() -> None:
    """Driven with 2θ too, harmonic 2 is excited at once: F is of first order, α stays."""
    plain = rope_fold(beam(), {"beta": 0.05}, 1, 2)
    driven = rope_fold(beam(drive={1: (1, 0), 2: (0.1, 0)}), {"beta": 0.05}, 1, 2)
    direct = rope_fold(beam(), {"beta": 0.05}, 1, 1)
    assert (plain.excited, driven.excited) == (2, 1)
    assert driven.alpha == pytest.approx(direct.alpha, rel=1e-13)
    assert pytest.approx(0.1 * direct.F, rel=1e-13) == driven.F


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rope.toml"
    file.write_text(
        'equation = "W_tautau = W_xixi - 2 - kappa*W"\n'
        'driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]\ncontact = ["W", "W_xi"]\n'
        "[parameters]\nkappa = 6\n"
    )
    code, out, _ = said(["fold", "1/1", "--problem", str(file), "--json"], capsys)
    assert code == 0
    found = json.loads(out)
    expected = rope_fold(string(foundation=6), {}, 1, 1)
    assert found["alpha"] == pytest.approx(expected.alpha, rel=1e-13)
    code, out, _ = said(["fold", "1/2", "--drive", "1: 1, 2: 0.1"], capsys)
    assert code == 0
    assert "fold: 2 (Omega - " in out
    for arguments in (["x"], ["1/2", "--plot", "a.png"], ["0/1"]):
        assert said(["fold", *arguments, "--problem", str(file)], capsys)[0] == 2
