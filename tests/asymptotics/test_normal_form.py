"""Normal forms: known folds, the beam's own code, the leading laws, ranges that end."""

import json
from pathlib import Path

import numpy as np
import pytest
import sympy
from flint import arb

from asymptotics.errors import InputError
from asymptotics.expansion.reduced_equation import reduced_equation
from asymptotics.problems.beam import static_beam
from asymptotics.problems.free_frequencies import free_frequencies
from asymptotics.problems.moving_contact import moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.resonances.bifurcation_equation import Polynomial
from asymptotics.resonances.folds import fold
from asymptotics.resonances.normal_form import NormalForm, normal_form
from asymptotics.resonances.rope_fold import rope_fold
from asymptotics.rings.numbers import balls
from asymptotics.rings.precision import at_precision
from tests.command import said

AT = {"beta": "0.01"}
# Periodic states by a spectral method: the fold at Ω = 3.2.
SPECTRAL = 1.38788e-3


@pytest.mark.parametrize("order", range(5, 12))
def test_the_fold_at_3_2(order: int) -> None:
    (found,) = normal_form(beam(), AT, 1, 1, 3.2, order).folds()
    assert found.epsilon == pytest.approx(1.3874e-3, abs=2e-6)
    assert abs(found.epsilon - SPECTRAL) <= found.error


@pytest.mark.parametrize("order", range(5, 12))
def test_outside_the_range_there_is_no_number(order: int) -> None:
    with pytest.raises(InputError, match="outside the range"):
        normal_form(beam(), AT, 1, 1, 3.1, order).folds()


@pytest.mark.parametrize(("q", "omega"), [(1, "3.2"), (2, "1.62")])
def test_rows_are_those_of_the_beam_s_own_code(q: int, omega: str) -> None:
    with at_precision(256):
        shape = static_beam("0.01", numbers=balls())
        known = reduced_equation(shape, arb(omega), q, 7)
    rows = normal_form(beam(), AT, 1, q, float(omega), 7).rows
    for row, other in zip(rows, known, strict=True):
        expected = np.array([float(g) for g in other])
        # Ω is the double next to the decimal: a relative 1e-16 over the distance from resonance.
        np.testing.assert_allclose(row, expected, rtol=1e-12, atol=1e-12 * abs(expected).max())


@pytest.mark.parametrize("q", [1, 2])
def test_folds_have_the_leading_law_as_their_limit(q: int) -> None:
    law = fold(1, q, 0.01)
    errors = []
    for mu in (0.008, 0.004, 0.002):
        form = normal_form(beam(), AT, 1, q, law.resonant.value + law.mu_sign * mu, 8)
        errors.append(form.folds()[0].epsilon / float(law.epsilon(law.mu_sign * mu)) - 1)
    assert abs(errors[-1]) < 0.02
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.1)
    assert errors[2] / errors[1] == pytest.approx(0.5, abs=0.1)


def test_no_fold_on_the_other_side() -> None:
    assert normal_form(beam(), AT, 1, 1, 3.27, 9).folds() == ()
    assert normal_form(beam(), AT, 1, 1, 3.27, 9).edge() is None


@pytest.mark.parametrize("side", [-1, 1])
def test_the_tongue_at_twice_a_frequency(side: int) -> None:
    """ε = 0.0467365 |Ω − 2Ω₁| in the limit, by both edges."""
    ratios = []
    for mu in (2e-2, 1e-2):
        form = normal_form(beam(), AT, 1, 1, 6.5000025991 + side * mu, 7, subharmonic=2)
        edge = form.edge()
        assert edge is not None
        assert edge.amplitude == 0
        ratios.append(edge.epsilon / abs(form.omega - form.resonance))
        assert form.folds() == ()
    # The next term is linear in μ.
    assert 2 * ratios[1] - ratios[0] == pytest.approx(0.0467365, rel=1e-3)


def test_two_over_two() -> None:
    """With bending Ω₂/2 is not Ω₁; spectral states end between 5.2625e-4 and 5.2719e-4 there."""
    (found,) = normal_form(beam(), AT, 2, 2, 3.59, 10).folds()
    assert 5.2625e-4 < found.epsilon < 5.2719e-4
    with pytest.raises(InputError, match="outside the range"):
        normal_form(beam(), AT, 2, 2, 3.6, 10).folds()


def test_the_error_holds_at_the_end_of_a_range() -> None:
    """2/4, next to Ω₂/4 = 1.7944: spectral states end at 0.0596760; two changes alone are less."""
    (found,) = normal_form(beam(), AT, 2, 4, 1.8, 10).folds()
    assert 5e-5 < abs(found.epsilon - 0.0596760) <= found.error


def test_amplitudes_and_branch_solve_the_equation() -> None:
    form = normal_form(beam(), AT, 1, 1, 3.2, 7)
    (found,) = form.folds()
    few, many = form.amplitudes(1.001 * found.epsilon), form.amplitudes(0.999 * found.epsilon)
    near = [sum(abs(x - found.amplitude) < 0.01 for x in roots) for roots in (few, many)]
    assert near == [0, 2]
    polynomial = form.polynomial()
    assert isinstance(polynomial, Polynomial)
    epsilon, amplitude = form.branch()
    assert epsilon.max() == pytest.approx(found.epsilon, rel=1e-3)
    for e, a in zip(epsilon[1::20], amplitude[1::20], strict=True):
        (g,), ((by_epsilon, _),) = polynomial(np.array([e, -a * form.leading / 2]))
        assert abs(g) < 1e-10 * abs(e * by_epsilon)


def test_an_own_rope() -> None:
    """A string on an elastic foundation: its free frequencies are no multiples of one."""
    kappa = sympy.Symbol("kappa")
    rope = moving_contact(
        equation=sympy.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2 - kappa * W),
        driven_end=[sympy.Eq(W, 1 + epsilon * sympy.cos(Omega * tau))],
        contact=[W, W.diff(xi)],
    )
    at = {"kappa": "3"}
    known = rope_fold(rope, at, 1, 1)
    errors = []
    for size in (4e-3, 2e-3):
        mu = float(np.sign(known.kappa)) * size
        (found,) = normal_form(rope, at, 1, 1, known.frequency + mu, 7).folds()
        errors.append(float(known.detuning(found.epsilon)) / mu - 1)
    assert abs(errors[1]) < 0.1
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1, 1, 3.2, 4), "order = 4"),
        ((1, 1, 3.2, 26), "order = 26"),
        ((1, 1, 9.0, 7), "not near the resonance"),
        ((1, 1, float("nan"), 7), "finite"),
        ((0, 1, 3.2, 7), "p"),
        ((1, 9, 0.36, 7), "q"),
        ((2, 2, 7.2, 7, 2), "common divisor"),
    ],
)
def test_arguments(arguments: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        normal_form(beam(), AT, *arguments)


def test_the_string_is_refused() -> None:
    for omega in (3.1, 3.14, 3.1416):
        with pytest.raises(InputError, match="one amplitude does not suffice"):
            normal_form(string(), {}, 1, 1, omega, 7).folds()


def _damped(zeta: str, omega: float, order: int = 7, subharmonic: int = 1) -> NormalForm:
    rope = beam(damping=sympy.Symbol("zeta"))
    return normal_form(rope, {**AT, "zeta": zeta}, 1, 1, omega, order, subharmonic)


def test_a_complex_b_is_the_real_one_without_damping() -> None:
    real, both = normal_form(beam(), AT, 1, 1, 3.2, 5), _damped("0", 3.2, 5)
    assert both.is_complex
    assert not real.is_complex
    for row, matrix in zip(real.rows, both.rows, strict=True):
        # On the real axis b and its conjugate are one.
        np.testing.assert_allclose(matrix.sum(axis=1), row, rtol=1e-12, atol=1e-12 * abs(row).max())
    assert both.folds()[0].epsilon == pytest.approx(real.folds()[0].epsilon, rel=1e-10)


def test_a_phase_of_the_drive_moves_nothing_but_time() -> None:
    turned = normal_form(beam(drive={1: (1, 0.7)}), AT, 1, 1, 3.2, 5)
    assert turned.is_complex
    known = normal_form(beam(), AT, 1, 1, 3.2, 5)
    assert turned.folds()[0].epsilon == pytest.approx(known.folds()[0].epsilon, rel=1e-10)
    epsilon, amplitude = turned.branch()
    at = turned.amplitudes(5e-4)
    assert len(at) == 2
    below = epsilon < 5e-4
    assert amplitude[below].min() < at[0] < at[1]
    np.testing.assert_allclose(at[0], np.abs(known.amplitudes(5e-4)).min(), rtol=1e-9)


def test_damping_closes_the_fold_in_a_cusp() -> None:
    """Two folds below, where states turn back and turn again; none where damping is strong."""
    folds = _damped("0.005", 3.2).folds()
    assert len(folds) == 2
    assert folds[0].epsilon > folds[1].epsilon
    assert folds[0].amplitude < folds[1].amplitude
    assert _damped("0.05", 3.2).folds() == ()


def test_the_damped_tongue_has_a_least_drive() -> None:
    """Free waves decay as e^{−ζτ}, so that the detuning Ω − 2Ω₁ becomes Ω − 2Ω₁ − 2iζ."""
    zeta, resonance = 2e-4, 2 * free_frequencies(beam(), AT, 1).values[0]
    undamped = normal_form(beam(), AT, 1, 1, resonance + 2 * zeta, 5, 2).edge()
    assert undamped is not None
    for omega in (resonance, resonance + 2 * zeta, resonance - 2 * zeta):
        damped = _damped("0.0002", omega, 5, 2).edge()
        assert damped is not None
        expected = np.hypot(1, abs(omega - resonance) / (2 * zeta)) * undamped.epsilon
        # The centre shifts by ε², one side of the tongue against the other.
        assert damped.epsilon == pytest.approx(expected, rel=2e-3)


def test_one_amplitude_suffices_nearer_and_nearer_as_beta_falls() -> None:
    """Ω₂/2 − Ω₁ falls with β; half way there harmonic 2 is as near."""
    for beta in ("1e-3", "1e-4"):
        first, second = free_frequencies(beam(), {"beta": beta}, 2).values
        gap = second / 2 - first
        for share, rival in ((0.45, None), (0.55, (2, 2))):
            assert normal_form(beam(), {"beta": beta}, 1, 1, first + share * gap, 5).rival == rival


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plot = tmp_path / "a.svg"
    common = ["normal-form", "1/1", "--beta", "0.01", "--json"]
    code, out, _ = said([*common, "--omega", "3.2", "--plot", str(plot)], capsys)
    assert code == 0
    fields = json.loads(out)
    assert fields["fold"][0]["epsilon"] == pytest.approx(1.3874e-3, abs=2e-6)
    assert fields["fold"][0]["omega"] == 3.2
    assert fields["outside"] is None
    first = plot.read_bytes()
    said([*common, "--omega", "3.2", "--plot", str(plot)], capsys)
    assert plot.read_bytes() == first
    code, out, _ = said([*common, "--omega", "3.1"], capsys)
    fields = json.loads(out)
    assert (code, fields["fold"]) == (0, [])
    assert "outside the range" in fields["outside"]
    code, out, _ = said(
        ["normal-form", "1/1", "--beta", "0.01", "--subharmonic", "2", "--omega", "6.48"], capsys
    )
    assert code == 0
    assert "edge of the tongue: epsilon = 0.00096519" in out
    code, out, _ = said(common, capsys)
    assert (code, json.loads(out)["resonance"]) == (0, pytest.approx(3.2500013, abs=1e-7))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["1/1", "--omega", "3.2"], "no simple resonance"),
        (["one", "--beta", "0.01"], "N/J"),
        (["0/1", "--beta", "0.01"], "N/J"),
        (["1/1", "--beta", "0.01", "--plot", "a.png"], "give --omega"),
        (["1/1", "--beta", "0.01", "--omega", "-3"], "not near"),
    ],
)
def test_command_refuses(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = said(["normal-form", *arguments], capsys)
    assert code != 0
    assert out == ""
    assert message in err


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (2, 1)])
def test_the_range_of_any_rope_s_law_is_the_beam_s(p: int, q: int) -> None:
    """Two reductions and two spectra."""
    own, beams = rope_fold(beam(), AT, p, q), fold(p, q, 0.01)
    assert own.range is not None
    assert beams.range is not None
    assert own.range.mu == pytest.approx(beams.range.mu, rel=1e-9)
    assert own.range.slope == pytest.approx(beams.range.slope, rel=1e-9)
    assert own.range.pole == beams.range.pole
    assert own.mu_sign == beams.mu_sign
    mu = own.mu_sign * own.range.mu
    assert float(own.epsilon(mu)) == pytest.approx(float(beams.epsilon(mu)), rel=1e-12)


def test_the_range_of_two_over_two_holds_against_higher_orders() -> None:
    law = rope_fold(beam(), AT, 2, 2)
    assert law.range is not None
    for share in (0.25, 0.5, 1):
        mu = law.mu_sign * share * law.range.mu
        (found,) = normal_form(beam(), AT, 2, 2, law.frequency / 2 + mu, 8).folds()
        off = abs(float(law.epsilon(mu)) / found.epsilon - 1)
        assert off <= law.range.slope * abs(mu) + found.error / found.epsilon
        assert off > 0.2 * law.range.slope * abs(mu)
