"""Closed forms on trial: right ones agree, wrong ones differ, the rest is not told."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from asymptotics.errors import InputError, ResonanceError
from asymptotics.problems import presets
from derivations.app import main
from derivations.cross_check.validation import validate, validate_rope

pytest.importorskip("numba")

RIGHT = """
import numpy as np

def contact(tau, omega, epsilon):
    theta, small = omega * tau, epsilon / np.sin(omega)
    mean, double = omega**2 / 16, omega**3 / 8 / np.tan(2 * omega)
    return 1 + small * omega / 2 * np.cos(theta) - small**2 * (mean + double * np.cos(2 * theta))
"""


@pytest.mark.slow
def test_the_string_s_orders_agree_with_the_exact_string() -> None:
    found = validate(2.2, 0.0, 3, quick=True)
    assert [judged.verdict for judged in found.orders] == ["agrees"] * 3
    for judged in found.orders:
        assert judged.slope is not None
        assert abs(judged.slope - judged.order - 1) < 0.1


@pytest.mark.slow
def test_the_beam_s_orders_against_the_simulator() -> None:
    found = validate(2.2, 0.01, 3, quick=True)
    assert [judged.verdict for judged in found.orders][:2] == ["agrees", "agrees"]
    assert found.orders[2].verdict == "floor reached"  # the coarse grid has no more
    assert "dx = 0.005" in found.judge


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "verdict"), [(("", ""), "agrees"), (("/ 16", "/ 15"), "differs")]
)
def test_a_reader_s_own_form(
    tmp_path: Path,
    change: tuple[str, str],
    verdict: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "form.py"
    path.write_text(RIGHT.replace(*change) if change[0] else RIGHT, encoding="utf-8")
    picture = tmp_path / "v.png"
    with pytest.raises(SystemExit) as ended:
        main(["validate", "--omega", "2.2", "--order", "2", "--quick", "--json", "--form",
              str(path), "--plot", str(picture)])  # fmt: skip
    assert not ended.value.code
    found = json.loads(capsys.readouterr().out)
    assert found["verdicts"] == ["agrees", verdict]
    assert len(found["errors"]) == 2
    assert len(found["errors"][0]) == len(found["epsilons"]) == len(found["floor"])
    assert picture.stat().st_size > 10_000


@pytest.mark.slow
def test_a_form_that_is_wrong_at_first_order_falls_too_slowly() -> None:
    found = validate(
        2.2, 0.0, 2, quick=True, form=lambda tau, omega, epsilon: 1 + epsilon * np.cos(omega * tau)
    )
    assert found.orders[1].verdict == "differs"
    assert found.orders[1].slope == pytest.approx(1, abs=0.1)


def test_what_cannot_be_judged() -> None:
    with pytest.raises(ResonanceError):
        validate(math.pi, 0.0, 1)
    with pytest.raises(ResonanceError):
        validate(math.pi / 4, 0.0, 1)  # the ladder needs three orders more
    for omega, beta, order in ((2.2, 0.0, 9), (2.2, 0.1, 5), (-1.0, 0.0, 1), (2.2, 0.0, 0)):
        with pytest.raises(InputError):
            validate(omega, beta, order)


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("x = 1", "defines no function contact"),
        ("import", "does not run"),
        ("def contact(tau): return tau", "cannot be called"),
        ("def contact(tau, omega, epsilon): return 1.0", "return xi_c at each tau"),
        ("def contact(tau, omega, epsilon): return tau / 0", "return xi_c at each tau"),
        ("contact = 3", "defines no function contact"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_files_that_are_no_form(
    tmp_path: Path, source: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "form.py"
    path.write_text(source, encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["validate", "--omega", "2.2", "--quick", "--order", "1", "--form", str(path)])
    assert ended.value.code == 2
    assert reason in capsys.readouterr().err


PROBLEM = """
equation = "W_tautau = W_xixi - 2 - kappa*W"
driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]
contact = ["W", "W_xi"]

[parameters]
kappa = 1.7
"""


@pytest.mark.slow
def test_a_reader_s_own_rope_against_its_periodic_states(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "rope.toml"
    path.write_text(PROBLEM, encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["validate", "--problem", str(path), "--omega", "2.2", "--order", "3", "--quick",
              "--json", "--plot", str(tmp_path / "v.png")])  # fmt: skip
    assert not ended.value.code
    found = json.loads(capsys.readouterr().out)
    assert found["beta"] is None
    assert found["verdicts"] == ["agrees"] * 3
    assert [round(slope) for slope in found["slopes"]] == [2, 3, 4]


@pytest.mark.slow
def test_the_string_s_formula_is_not_the_foundation_s() -> None:
    found = validate_rope(
        presets.string(foundation=1.7),
        {"Omega": 2.2},
        2,
        quick=True,
        form=lambda tau, omega, epsilon: 1 + epsilon * np.cos(omega * tau),
    )
    assert found.orders[1].verdict == "differs"


@pytest.mark.slow
def test_thin_layers_are_nothing_to_modes() -> None:
    """√β = 0.01: they have no grid that would have to resolve it."""
    found = validate_rope(presets.beam(), {"beta": 1e-4, "Omega": 2.2}, 1, quick=True)
    assert found.orders[0].verdict == "agrees"


@pytest.mark.parametrize(
    ("text", "judge"),
    [
        ('equation = "W_tautau = W_xixi - 2"\nsprings = "50"\ncontact = ["W"]\n', "modes"),
        pytest.param(
            'equation = "W_tautau = (1 + xi/4)*W_xixi + W_xi/4 - 2"\ncontact = ["W", "W_xi"]\n',
            "collocation",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_ropes_on_springs_and_of_varying_tension_are_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, judge: str
) -> None:
    file = tmp_path / "rope.toml"
    file.write_text(text + 'driven_end = ["W = 1 + epsilon*cos(Omega*tau)"]\n')
    order = ["--order", "2", "--quick", "--json"]
    with pytest.raises(SystemExit) as caught:
        main(["validate", "--problem", str(file), "--omega", "2.2", *order])
    assert not caught.value.code
    found = json.loads(capsys.readouterr().out)
    assert found["verdicts"] == ["agrees", "agrees"]
    assert judge in found["judge"]
