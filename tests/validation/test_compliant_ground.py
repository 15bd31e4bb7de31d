"""A rope on springs against periodic states that are not expanded, and against the rigid ground."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand, prove
from asymptotics.errors import InputError
from asymptotics.problems.moving_contact import moving_contact
from asymptotics.problems.presets import beam, string
from asymptotics.problems.symbols import Omega, W, epsilon, tau, xi
from asymptotics.rings.precision import at_precision
from asymptotics.values.rope import evaluate_rope
from numerics.problems.drive import ramped_cosine
from numerics.problems.problem import RopeProblem
from numerics.simulation.penalty import penalty_ground, solve
from numerics.simulation.semi_discrete import Grid
from tests.validation.two_sided_states import contact_of

KAPPA = sp.Symbol("kappa")


def test_the_string_on_stiff_springs() -> None:
    """κ = 400, Ω = 2.2: all harmonics in use are evanescent on the ground."""
    series = expand(string(springs=KAPPA), 2, at={KAPPA: 400, Omega: 2.2})
    place = complex(series.problem.rest or 0).real
    assert abs(place - 0.951249219725) < 1e-12
    assert abs(place**2 + 2 * place / 20 - 1) < 1e-15
    assert abs(2 * series.contact(1)[1] - 1.363505302) < 1e-9
    assert abs(series.contact(2)[0] + 0.351386084) < 1e-9
    assert abs(2 * series.contact(2)[2] + 0.758933989) < 1e-9


CASES = [
    pytest.param(0.0, 400.0, 2.2, (1e-2, 5e-3), id="string, evanescent"),
    pytest.param(0.0, 30.0, 2.2, (2e-2, 1e-2), id="string, radiating from the third harmonic on"),
    pytest.param(0.0, 2.0, 2.2, (4e-2, 2e-2), id="string, radiating"),
    pytest.param(0.05, 100.0, 1.9, (2e-2, 1e-2), id="beam, evanescent"),
    pytest.param(0.05, 2.0, 1.9, (4e-2, 2e-2), id="beam, radiating"),
]


@pytest.mark.parametrize(("beta", "kappa", "omega", "small"), CASES)
def test_each_order_removes_one_power_of_the_error(
    beta: float, kappa: float, omega: float, small: tuple[float, float]
) -> None:
    rope = beam(beta=sp.Float(beta), springs=KAPPA) if beta else string(springs=KAPPA)
    at = {KAPPA: kappa, Omega: omega}
    series = expand(rope, 4, at=at)
    assert prove(series).holds
    rest = complex(series.problem.rest or 0).real
    harmonics = 7
    times = 2 * np.pi * np.arange(2 * harmonics + 1) / (2 * harmonics + 1)
    errors = {n: [] for n in range(1, 5)}  # type: dict[int, list[float]]
    for size in small:
        state = contact_of(beta, kappa, omega, size, rest, harmonics)
        total = np.full(len(times), rest)
        for n in range(1, 5):
            for j, c in series.contact(n).items():
                total += size**n * ((2 if j else 1) * c * np.exp(1j * j * times)).real
            errors[n].append(float(np.max(np.abs(total - state))))
    for n, (coarse, fine) in errors.items():
        slope = np.log2(coarse / fine)
        assert fine < 2e-12 or abs(slope - (n + 1)) < 0.25, (n, errors[n])


def test_proof_over_balls_and_its_failure() -> None:
    rope = string(springs=KAPPA)
    with at_precision(160):
        series = expand(rope.at({KAPPA: 30, Omega: 2.2}, "balls"), 3)
        assert prove(series).holds
        order = series.orders[1]
        moved = {j: (x[0] + 1, *x[1:]) for j, x in order.shape.items()}
        wrong = type(series)(
            series.problem,
            (series.orders[0], type(order)(order.contact, moved, order.tails), series.orders[2]),
        )
        with pytest.raises(Exception, match="REFUTED"):
            prove(wrong)


def test_stiff_springs_are_the_rigid_ground() -> None:
    """The difference falls like the thickness 1/√κ of the layer in which springs give way."""
    rigid = expand(string(), 3, at={Omega: 2.2})
    left = []
    for kappa in (1e4, 1e6):
        soft = expand(string(springs=KAPPA), 3, at={KAPPA: kappa, Omega: 2.2})
        left.append(
            [
                abs(complex(soft.problem.rest or 0) - 1),
                abs(2 * soft.contact(3)[3] - 2 * rigid.contact(3)[3]),
            ]
        )
    for coarse, fine in zip(*left, strict=True):
        assert 5 < coarse / fine < 12


def test_the_profile_meets_the_springs_and_goes_on_beyond() -> None:
    at = {KAPPA: 400, Omega: 2.2}
    s = np.array([-0.4, -1e-3, 0.0, 1e-3, 0.2])
    result = evaluate_rope(string(springs=KAPPA), at, 0.005, 3, s, [0.0, 0.7])
    assert np.all(np.abs(result.profile[:, 2]) < 1e-15)
    assert np.all(result.profile[:, 0] > 0.1)
    # No kink: the second difference is the jump of nothing, W″ = 2 on both sides.
    assert np.all(np.abs(result.profile[:, 1] + result.profile[:, 3] - 2e-6) < 1e-6)
    still = evaluate_rope(string(springs=KAPPA), at, 0.0, 1, [0.05, 0.3], [0.0])
    assert np.allclose(still.profile, -(1 - np.exp(-20 * np.array([0.05, 0.3]))) / 200, atol=1e-14)
    with pytest.raises(InputError, match="beyond the contact point"):
        evaluate_rope(string(), {Omega: 2.2}, 0.005, 3, [0.1], [0.0])


@pytest.mark.parametrize("kappa", [2.0, 60.0])
def test_waves_beyond_obey_the_equation_there(kappa: float) -> None:
    """W_ττ = W_ξξ − 2 − κW at s > 0, by differences in a fixed frame; order 4, small ε."""
    rope, at, size = string(springs=KAPPA), {KAPPA: kappa, Omega: 2.2}, 2e-3
    tau, place, h = 0.9, 1.1, 1e-3
    times = np.array([tau - h, tau, tau + h])
    contact = evaluate_rope(rope, at, size, 4, [], times).contact
    around = place + h * np.array([-1.0, 0.0, 1.0])
    W = evaluate_rope(rope, at, size, 4, around[None, :] - contact[:, None], times).profile
    moved = (W[2, 1] - 2 * W[1, 1] + W[0, 1]) / h**2
    bent = (W[1, 2] - 2 * W[1, 1] + W[1, 0]) / h**2
    left = moved - bent + 2 + kappa * W[1, 1]
    assert abs(moved) > 1e-4
    assert abs(left) < 2e-2 * abs(moved) + 1e-7


def test_bad_springs_are_refused() -> None:
    with pytest.raises(InputError, match="positive"):
        expand(string(springs=KAPPA), 1, at={KAPPA: -3, Omega: 2.2})
    drive = sp.Eq(W, 1 + epsilon * sp.cos(Omega * tau))
    wave = sp.Eq(W.diff(tau, 2), W.diff(xi, 2) - 2)
    with pytest.raises(InputError, match=r"give \[W\]"):
        moving_contact(equation=wave, driven_end=[drive], contact=[W, W.diff(xi)], springs=4)
    with pytest.raises(InputError, match="needs r/2 = 1"):
        moving_contact(
            equation=wave, driven_end=[drive, sp.Eq(W.diff(xi), 0)], contact=[W], springs=4
        )
    with pytest.raises(InputError, match="constant"):
        moving_contact(equation=wave, driven_end=[drive], contact=[W], springs=4 * xi)
    lifted = moving_contact(
        equation=sp.Eq(W.diff(tau, 2), W.diff(xi, 2) + 2),
        driven_end=[drive],
        contact=[W],
        springs=4,
    )
    with pytest.raises(InputError, match="no static shape"):
        expand(lifted, 1, at={Omega: 2.2})


def crossing(positions: np.ndarray, heights: np.ndarray) -> float:
    """Where W = 0 first, by the cubic through the four nodes next to it."""
    i = int(np.flatnonzero(heights < 0)[0])
    near = slice(i - 2, i + 2)
    cubic = np.polyfit(heights[near], positions[near], 3)
    return float(np.polyval(cubic, 0.0))


@pytest.mark.parametrize(
    ("beta", "kappa", "spacings"),
    [(0.0, 2.0, (0.05, 0.025)), pytest.param(0.05, 3.0, (0.05,), marks=pytest.mark.slow)],
)
def test_the_simulated_rope_on_springs(
    beta: float, kappa: float, spacings: tuple[float, ...]
) -> None:
    """The penalty ground is this ground. Waves leave, the absorbing end is ten x₀ long."""
    omega, small = 2.2, 0.02
    rope = beam(beta=sp.Float(beta), springs=KAPPA) if beta else string(springs=KAPPA)
    series = expand(rope, 3, at={KAPPA: kappa, Omega: omega})
    rest = complex(series.problem.rest or 0).real
    drive = ramped_cosine(omega, small, 5)
    times = drive.period * np.linspace(14, 15, 9)
    errors = []
    for dx in spacings:
        ground = penalty_ground(RopeProblem(beta, drive), Grid(dx, 20.0, 10.0), kappa, 0.0)
        run = solve(ground, times, rtol=1e-8, atol=1e-10)
        found = np.array([crossing(ground.system.positions, h) for h in run.heights])
        total = np.full(len(times), rest)
        for n in range(1, 4):
            for j, c in series.contact(n).items():
                wave = (2 if j else 1) * c * np.exp(1j * j * omega * times)
                total += small**n * wave.real
        errors.append(float(np.max(np.abs(found - total))))
    amplitude = small * 2 * abs(series.contact(1)[1])
    assert errors[-1] < 0.015 * amplitude
    assert len(errors) == 1 or errors[1] < 0.5 * errors[0]
