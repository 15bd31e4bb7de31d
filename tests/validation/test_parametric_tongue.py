"""The parametric tongue at 2ω_p, against Mathieu's equation, multipliers and other drives."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand
from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.resonances.fold_range import ACCURACY
from asymptotics.resonances.parametric_tongue import parametric_tongue
from asymptotics.resonances.rope_fold import rope_fold
from derivations.app import main

KAPPA = sp.Symbol("kappa")


@pytest.mark.parametrize("p", [1, 2])
@pytest.mark.parametrize("kappa", [0.8, 6.0, 20.0])
def test_a_string_on_a_foundation_is_mathieus_equation(kappa: float, p: int) -> None:
    """ω² = κ + (pπ/ξ_c)² moves with ξ_c = ξ₀ + ε c cos θ: |Ω − 2ω| = ε |c| (pπ)²/(ξ₀³ω)."""
    rope = string(foundation=KAPPA)
    found = parametric_tongue(rope, {"kappa": kappa}, p)
    place = np.arccosh(1 + kappa / 2) / np.sqrt(kappa)
    frequency = np.sqrt(kappa + (p * np.pi / place) ** 2)
    assert found.frequency == pytest.approx(frequency, rel=1e-14)
    first = expand(rope, 1, at={"kappa": kappa, "Omega": 2 * frequency})
    swing = 2 * abs(complex(first.contact(1)[1]))
    law = swing * (p * np.pi) ** 2 / (place**3 * frequency)
    assert found.coefficient == pytest.approx(law, rel=1e-12)


def test_the_papers_beam() -> None:
    """ε = 0.046737 |Ω − 2Ω₁| at β = .01; Floquet multipliers −1.05175 at ε = .005 and −1.0873
    at .0085 on the centre line are e^{σ2π/Ω} with σ = Cε/2 − O(ε²)."""
    found = parametric_tongue(beam(), {"beta": 0.01}, 1)
    assert 1 / found.coefficient == pytest.approx(0.046737, abs=1e-6)
    assert found.resonance == pytest.approx(6.5000, abs=5e-5)
    rates = [np.log(x) * found.resonance / (2 * np.pi) for x in (1.05175, 1.0873)]
    ratios = [s / (found.coefficient * e / 2) for s, e in zip(rates, (0.005, 0.0085), strict=True)]
    assert ratios[0] == pytest.approx(0.976, abs=0.002)
    assert 0.94 < ratios[1] < ratios[0] < 1


def test_the_law_approaches_the_edges_as_its_error_says() -> None:
    """Inside the range the edges of order N are off the law by no more than slope·ε."""
    found = parametric_tongue(beam(driven_end="clamped"), {"beta": 0.05}, 1)
    assert found.edges is not None
    assert 0 < found.slope * found.reach <= ACCURACY
    width = found.coefficient * found.reach
    for edge, side in zip(found.edges, (-1, 1), strict=True):
        off = abs(edge - found.resonance - side * width)
        assert 0 < off <= found.slope * found.reach * width
    assert found.epsilon(found.resonance + width / 2) == pytest.approx(found.reach / 2, rel=1e-12)
    with pytest.raises(InputError, match="outside the range"):
        found.epsilon(found.resonance + 1.01 * width)


def test_harmonics_that_do_not_couple_leave_the_law_and_move_the_edges() -> None:
    """Harmonic 1 alone couples at order ε; half its size is half the tongue."""
    one = parametric_tongue(beam(), {"beta": 0.3}, 1)
    half = parametric_tongue(beam(drive={1: (sp.Rational(1, 2), 0)}), {"beta": 0.3}, 1)
    more = parametric_tongue(beam(drive={1: (1, 0), 3: (1, 0)}), {"beta": 0.3}, 1)
    assert half.coefficient == pytest.approx(one.coefficient / 2, rel=1e-13)
    assert more.coefficient == pytest.approx(one.coefficient, rel=1e-13)
    assert more.slope != pytest.approx(one.slope, rel=1e-3)


def test_time_may_start_at_half_a_period() -> None:
    """cos j(θ + π) = (−1)^j cos jθ: the two edges change places, the tongue stays."""
    one = parametric_tongue(beam(drive={1: (1, 0), 2: (1, 0)}), {"beta": 0.05}, 1)
    turned = parametric_tongue(beam(drive={1: (-1, 0), 2: (1, 0)}), {"beta": 0.05}, 1)
    other = parametric_tongue(beam(drive={1: (1, 0), 2: (-1, 0)}), {"beta": 0.05}, 1)
    assert one.edges is not None
    assert turned.edges == pytest.approx(one.edges, rel=1e-12)
    assert other.slope != pytest.approx(one.slope, rel=1e-3)


def test_the_range_is_short_next_to_another_resonance() -> None:
    """β = .3: ω₃ = 2.0187ω₂, so that harmonic 1 of the drive resonates nearly, too."""
    found = parametric_tongue(beam(), {"beta": 0.3}, 2)
    assert 0 < found.reach < 1e-4
    assert found.slope * found.reach <= ACCURACY


def test_refusals(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Damping, phases, no harmonic 1, the string, frequencies in coefficients; by command too."""
    phase = beam(drive={1: (1, sp.Rational(1, 2))})
    for refused in (parametric_tongue, lambda rope, at, p: rope_fold(rope, at, p, 1)):
        with pytest.raises(InputError, match="cosines only"):
            refused(phase, {"beta": 0.01}, 1)
        with pytest.raises(InputError, match="without damping"):
            refused(beam(damping=0.1), {"beta": 0.01}, 1)
        with pytest.raises(InputError, match="without damping"):  # not: overdamped
            refused(beam(damping=50), {"beta": 0.01}, 1)
        with pytest.raises(InputError, match="from 1 to 200"):
            refused(beam(), {"beta": 0.01}, 0)
    with pytest.raises(InputError, match="has none"):
        parametric_tongue(beam(drive={2: (1, 0)}), {"beta": 0.01}, 1)
    with pytest.raises(InputError, match="another resonance"):
        parametric_tongue(string(), {}, 1)
    for line, said in (
        (["tongue", "1/1", "--subharmonic", "2"], "all multiples"),
        (["tongue", "1/1", "--beta", "0.01"], "--subharmonic 2"),
        (["tongue", "1/2", "--beta", "0.01", "--subharmonic", "2"], "give p/1"),
        (["tongue", "1/1", "--beta", "0.01", "--drive", "1:1@1", "--subharmonic", "2"], "cosines"),
        (["fold", "1/1", "--beta", "0.01", "--drive", "1: 1@0.5"], "cosines"),
        (
            [
                "tongue",
                "1/1",
                "--beta",
                "0.1",
                "--subharmonic",
                "2",
                "--plot",
                str(tmp_path / "a.png"),
            ],
            "--json",
        ),
    ):
        with pytest.raises(SystemExit) as left:
            main(line)
        assert left.value.code not in (0, None)
        assert said in capsys.readouterr().err.replace("\n", " ")


def test_frequency_in_the_size_of_the_drive_is_refused() -> None:
    """A shaken acceleration Ω²cos Ωτ has another size at another Ω."""
    rope = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - KAPPA * W),
        driven_end=[sp.Eq(W, 1 + epsilon * Omega**2 * sp.cos(Omega * tau))],
        contact=[W, W.diff(xi)],
    )
    with pytest.raises(InputError, match="hold Omega"):
        parametric_tongue(rope, {"kappa": 2.0}, 1)


def test_command(capsys: pytest.CaptureFixture[str]) -> None:
    """The fields of --json are those of the function."""
    line = ["tongue", "1/1", "--beta", "0.3", "--subharmonic", "2", "--json"]
    with pytest.raises(SystemExit) as left:
        main(line)
    assert left.value.code in (0, None)
    fields = json.loads(capsys.readouterr().out)
    found = parametric_tongue(beam(), {"beta": 0.3}, 1)
    assert fields["coefficient"] == found.coefficient
    assert fields["range"]["edges"] == pytest.approx(found.edges, rel=1e-12)
    assert fields["subharmonic"] == 2
