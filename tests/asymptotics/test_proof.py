"""Every statement of a proof can fail, alone; and right results pass in every arithmetic."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb

from asymptotics import (
    Expansion,
    exact_string,
    expand,
    float_string,
    moving_frame,
    prove,
    string_problem,
)
from asymptotics.errors import InputError
from asymptotics.expansion.enclosures import WIDEST, enclosures
from asymptotics.expansion.images import MajorantRing, image_of_problem
from asymptotics.expansion.proof import OrderProof, RefutedError, residuals
from asymptotics.formulas.beam import expand_symbolic
from asymptotics.problems.beam import beam_problem, float_beam, static_beam
from asymptotics.problems.damped import damped_string
from asymptotics.problems.enclosed import ball_damped_string, ball_string
from asymptotics.problems.forcing import forced_string, fourier_drive
from asymptotics.problems.forcing_generators import generator_string
from asymptotics.resonances.singular_part import laurent_expansion
from asymptotics.rings.cotangent import CotangentRing
from asymptotics.rings.numbers import balls, digits
from asymptotics.rings.precision import at_precision
from asymptotics.rings.ring import FloatRing

RING = CotangentRing()
TWO = fourier_drive([0.83, 1.31], {(1, 0): 0.7, (0, 1): 0.4}, {(0, 1): 0.5, (1, -1): 0.3})


def changed(expansion: Expansion, n: int, **fields: object) -> Expansion:
    orders = list(expansion.orders)
    orders[n - 1] = replace(orders[n - 1], **fields)  # type: ignore[arg-type]
    return Expansion(expansion.problem, tuple(orders))


def refuted(expansion: Expansion, message: str = "order") -> list[OrderProof]:
    with pytest.raises(RefutedError, match=message) as caught:
        prove(expansion)
    return list(caught.value.proofs)


def proofs_hold(expansion: Expansion) -> bool:
    with pytest.raises(RefutedError) as caught:
        prove(expansion)
    return caught.value.proofs.holds


def faults(proof: OrderProof) -> set[str]:
    """The names of the statements that fail."""
    names = ("equation", "driven_end", "contact", "tails")
    failed = {name for name in names if not getattr(proof, name)}
    return failed | {name for name in ("missing", "foreign") if getattr(proof, name)}


# -- each statement --------------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "j"), [(1, -1), (3, -1), (3, 2), (3, 5), (4, 1), (4, -2)])
@pytest.mark.parametrize("part", ["contact", "shape"])
def test_harmonics_that_no_product_excites(sixth: Expansion, part: str, n: int, j: int) -> None:
    """Negative, of the wrong parity, or higher than the order."""
    own = n % 2 or 2
    series = dict(getattr(sixth, part)(n))
    series[j] = series[own]
    proofs = refuted(changed(sixth, n, **{part: series}), rf"order {n}: REFUTED .*{j} CANNOT BE")
    assert proofs[n].foreign == (j,)
    assert [proof.n for proof in proofs if not proof.holds] == [n]
    assert faults(proofs[n]) <= {"foreign", "tails"}


def test_a_harmonic_that_cannot_be_has_no_frame(sixth: Expansion) -> None:
    shape = dict(sixth.shape(3)) | {-1: sixth.shape(3)[1]}
    with pytest.raises(InputError, match=r"cot\(-1\*Omega\) is not in the ring"):
        moving_frame(changed(sixth, 3, shape=shape))


def test_a_missing_harmonic(sixth: Expansion) -> None:
    contact = {j: c for j, c in sixth.contact(6).items() if j != 4}
    assert faults(refuted(changed(sixth, 6, contact=contact), "4 MISSING")[6]) == {
        "missing",
        "contact",
    }
    contact = dict(sixth.contact(6)) | {4: RING.zero}
    assert refuted(changed(sixth, 6, contact=contact))[6].missing == (4,)


def test_only_the_contact_fails(sixth: Expansion) -> None:
    """The last order's contact point enters nothing but its own contact condition."""
    contact = dict(sixth.contact(6))
    contact[2] = contact[2] + RING.omega
    proofs = refuted(changed(sixth, 6, contact=contact), "contact NOT 0")
    assert [faults(proof) for proof in proofs] == [set()] * 6 + [{"contact"}]


def test_height_and_slope_at_the_contact_point_are_two_conditions(sixth: Expansion) -> None:
    """A wave that the driven end allows, its slope undone by ξ₆: the height alone is not zero."""
    for j in (2, 4, 6):
        slope = RING.rational(j) * RING.omega * RING.cot(j)
        v, rate = sixth.shape(6)[j]
        shape = dict(sixth.shape(6)) | {j: (v + RING.one, rate + slope)}
        c = sixth.contact(6)[j] - slope * RING.rational(1, 2)
        spoilt = changed(sixth, 6, shape=shape, contact=dict(sixth.contact(6)) | {j: c})
        assert faults(refuted(spoilt)[6]) == {"contact"}
        left = residuals(spoilt, moving_frame(spoilt), 6).contact
        assert {key for key, x in left.items() if not x.is_zero()} == {(0, j)}
        assert [point.orders for point in enclosures(spoilt)] == [(True,) * 5 + (False,)] * 3


def test_only_the_driven_end_fails(sixth: Expansion) -> None:
    """Another weight of the drive in the problem's own words."""
    problem = replace(sixth.problem, end_unit=lambda j: (RING.rational(2) * RING.omega,))
    proofs = refuted(Expansion(problem, sixth.orders), "order 1: REFUTED .* driven end NOT 0")
    assert [faults(proof) for proof in proofs] == [set(), {"driven_end"}] + [set()] * 5
    problem = replace(sixth.problem, end_residual=lambda j, w: (w[0],))
    proofs = refuted(Expansion(problem, sixth.orders))
    assert faults(proofs[1]) == faults(proofs[2]) == {"driven_end"}


def test_only_the_equation_fails(sixth: Expansion) -> None:
    """W_ττ = 2 W_ξξ − 2 is not what was solved; the load's equation, j = 0, is left as it is."""
    old = sixth.problem.equation_residual

    def residual(j: int, w: Any) -> Any:
        return old(j, w) + w[2] if j else old(j, w)

    proofs = refuted(Expansion(replace(sixth.problem, equation_residual=residual), sixth.orders))
    assert faults(proofs[0]) == set()
    assert all(faults(proof) == {"equation"} for proof in proofs[1:])


def static_string(**fields: Any) -> Expansion:
    return expand(replace(exact_string(), **fields), 3)


def parabola(*derivatives: int) -> Callable[[int], Any]:
    return lambda d: RING.rational(derivatives[d] if d < len(derivatives) else 0)


def test_the_static_shape_has_to_reach_the_driven_end() -> None:
    """W₀ = 2(ξ − 1)² with twice the load is flat at the contact point, and 2 high."""
    twice = {"inverse_leading": RING.rational(1, 4), "load": (RING.rational(4),)}
    proofs = refuted(static_string(static=parabola(0, 0, 4), **twice), "order 0: REFUTED")
    assert faults(proofs[0]) == {"driven_end"}


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({"load": (RING.rational(3),)}, {"equation"}),
        ({"static": parabola(0, 0, 2, 1)}, {"equation"}),
        ({"static_reduction": (RING.zero, RING.zero, RING.one)}, {"equation"}),
        ({"static": parabola(0, -1, 2)}, {"driven_end", "contact"}),
        ({"static": parabola(1, 1, 2)}, {"contact"}),
        ({"static": parabola(1, 2, 4), "load": (RING.rational(4),)}, {"contact"}),
    ],
)
def test_the_static_shape(fields: dict[str, Any], fault: set[str]) -> None:
    assert faults(refuted(static_string(**fields), "order 0")[0]) == fault


def test_no_static_shape_is_no_proof() -> None:
    fields = {"static": parabola(), "load": (RING.zero,), "inverse_leading": RING.one}
    proofs = refuted(static_string(**fields), "harmonics 0 MISSING")
    assert faults(proofs[0]) == {"missing", "driven_end"}


def test_the_beams_static_shape_can_fail_at_the_driven_end() -> None:
    """a₃ is what the driven end determines."""
    for driven_end in ("pinned", "clamped"):
        problem = float_beam(0.01, 2.2, 2, driven_end)
        spoilt = replace(problem, static=lambda d, a=problem.static: a(d) * (1.01 if d % 2 else 1))
        assert faults(refuted(expand(spoilt, 2), "order 0: inconsistent")[0]) == {"driven_end"}


def test_tails_that_would_be_continued_wrongly(sixth: Expansion) -> None:
    """Each of them: they are no part of the result, but of every later order."""
    for n in range(2, 7):
        tails = sixth.orders[n - 1].tails
        for e, chain in enumerate(tails):
            for d, tail in enumerate(chain):
                for j in list(tail)[:1]:
                    spoilt = dict(tail) | {j: tail[j] + tail[j]}
                    parts = [list(other) for other in tails]
                    parts[e][d] = spoilt
                    wrong = tuple(tuple(part) for part in parts)
                    proofs = refuted(changed(sixth, n, tails=wrong), "tails WRONG")
                    assert [faults(p) for p in proofs if not p.holds] == [{"tails"}]
                    assert not proofs[n].tails
    assert not refuted(changed(sixth, 3, tails=()))[3].tails


def test_a_frame_of_another_expansion_is_refused(sixth: Expansion) -> None:
    spoilt = changed(sixth, 6, contact={})
    with pytest.raises(InputError, match="belongs to another expansion"):
        prove(spoilt, moving_frame(sixth))


# -- what the letters mean -------------------------------------------------------------------------


def minus_cot(j: int) -> Any:
    return RING.rational(-1) * RING.cot(j)


TWICE = RING.rational(2) * RING.omega
LETTERS = {
    "minus cot": string_problem(RING, RING.omega, minus_cot, name="string"),
    "twice the frequency, the same cot": string_problem(RING, TWICE, RING.cot, name="string"),
    "the same frequency, cot of the double": string_problem(
        RING, RING.omega, lambda j: RING.cot(2 * j), name="string"
    ),
    "tangent": string_problem(RING, RING.omega, lambda j: RING.cot(j) + RING.one, name="string"),
}


@pytest.mark.parametrize("name", [name for name in LETTERS if name != "tangent"])
def test_letters_that_do_not_mean_the_frequency_and_its_cotangent(name: str) -> None:
    """Every identity between them holds all the same: only Ω and cot Ω themselves tell."""
    expansion = expand(LETTERS[name], 3)
    # No cotangent enters ξ₁.
    first = 1 if name.startswith("twice") else 2
    proofs = refuted(expansion, rf"order {first}: REFUTED at Omega = \d+/\d+, tau = ")
    assert all(proof.holds for proof in proofs)
    assert not proofs_hold(expansion)
    points = enclosures(expansion)
    assert [point.orders.index(False) + 1 for point in points] == [first] * len(points)
    assert all(point.static for point in points)


def test_cotangents_without_their_relations_are_refuted_already_by_substitution() -> None:
    assert faults(refuted(expand(LETTERS["tangent"], 2))[2]) == {"driven_end"}


def test_the_enclosures_see_each_coefficient(sixth: Expansion) -> None:
    """ξ_n and w_n, one at a time, wrong by a factor 1 + 10⁻²⁰."""
    factor = RING.rational(10**20 + 1, 10**20)
    for n in range(1, 7):
        for j, c in sixth.contact(n).items():
            spoilt = changed(sixth, n, contact=dict(sixth.contact(n)) | {j: c * factor})
            for point in enclosures(spoilt):
                assert point.orders.index(False) == n - 1
        for j, start in sixth.shape(n).items():
            for i, x in enumerate(start):
                if x.is_zero():
                    continue
                row = list(start)
                row[i] = x * factor
                shape = dict(sixth.shape(n)) | {j: tuple(row)}
                for point in enclosures(changed(sixth, n, shape=shape)):
                    assert point.orders.index(False) == n - 1


def test_the_enclosures_know_the_static_shape(sixth: Expansion) -> None:
    last = (0, 0, 2, 0, 0, 0, 0, 1)  # a_{N+1}, the highest derivative that order N uses
    for derivatives in ((0, 0, 4), (1, 0, 2), (0, 1, 2), (0, 0, 2, 1), last):
        problem = replace(sixth.problem, static=parabola(*derivatives))
        points = enclosures(Expansion(problem, sixth.orders))
        assert not any(point.static or point.holds for point in points)


def test_the_enclosures_are_narrow_and_the_same_each_time(sixth: Expansion) -> None:
    points = enclosures(sixth)
    assert points == enclosures(sixth)
    assert all(0 < point.radius <= WIDEST and point.holds for point in points)
    assert len({point.omega for point in points}) == len(points) == 3
    drive = {0: RING.rational(1, 3), 1: RING.rational(1, 2), 2: RING.rational(1, 4)}
    two = expand(string_problem(RING, RING.omega, RING.cot, name="two", drive=drive), 3)
    assert prove(two).holds
    assert all(len(point.orders) == 3 for point in enclosures(two))


def test_balls_that_stay_wide_are_no_enclosure(
    sixth: Expansion, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A wide ball contains zero, and much else."""
    import asymptotics.expansion.enclosures as module

    monkeypatch.setattr(module, "WIDEST", 0.0)
    monkeypatch.setattr(module, "_MOST_BITS", 256)
    point = enclosures(sixth, points=1)[0]
    assert 0 < point.radius < 1e-60
    assert not any(point.orders)


def test_the_refutation_names_the_point_and_the_order(sixth: Expansion) -> None:
    """Not the first point, which holds; order 0 is the static shape."""
    proof = prove(sixth)
    first, second, third = proof.enclosures
    for wrong, order in (
        (replace(second, orders=(True, True, False, False, True, True)), 3),
        (replace(second, static=False), 0),
    ):
        message = str(RefutedError(replace(proof, enclosures=(first, wrong, third))))
        assert message.startswith(f"order {order}: REFUTED at Omega = {second.omega}, tau = ")
        assert second.omega != first.omega


def test_the_certificate_says_what_the_proof_is_relative_to(sixth: Expansion) -> None:
    words = str(prove(sixth)).splitlines()
    assert len(words) == 8
    assert words[-1].startswith("relative to: identically in Omega and c = cot(Omega); and at 3")
    assert "W_tautau = W_xixi - 2" in words[-1]
    assert "whatever values" in prove(expand(generator_string([1], 2), 2)).relative_to
    assert prove(expand(generator_string([1], 2), 2)).enclosures == ()


# -- numbers, balls, truncated series --------------------------------------------------------------


def in_numbers() -> dict[str, Expansion]:
    omegas = np.array([0.83, 2.2, 4.0])
    array = string_problem(FloatRing(), omegas, lambda j: 1 / np.tan(j * omegas))
    return {
        "string": expand(float_string(2.2, 8), 8),
        "near a pole": expand(float_string(np.pi / 3 + 1e-7, 6), 6),
        "array": expand(array, 4),
        "pinned": expand(float_beam(0.01, 2.2, 4), 4),
        "clamped": expand(float_beam(0.01, 2.2, 4, "clamped"), 4),
        "thin layer": expand(float_beam(1e-6, 2.2, 4), 4),
        "thin clamped layer": expand(float_beam(5e-5, 2.2, 3, "clamped"), 3),
        "stiff": expand(float_beam(10.0, 0.5, 4), 4),
        "complex": expand(beam_problem(0.01, 2.2 + 0.1j), 3),
        "digits": expand(beam_problem(0.01, 2.2, numbers=digits()), 3),
        "damped": expand(damped_string(3.14, 0.05), 5),
        "viscous": expand(damped_string(3.14, 0.05, 0.02), 5),
        "forced": expand(forced_string(fourier_drive([0.83], {1: 1.0, 0: 0.3}), 5), 5),
        "two frequencies": expand(forced_string(TWO, 4), 4),
    }


NUMBERS = in_numbers()


@pytest.mark.parametrize("name", NUMBERS)
def test_right_numbers_are_consistent(name: str) -> None:
    proofs = prove(NUMBERS[name])
    assert proofs.holds
    for proof in proofs:
        assert proof.kind == "numbers"
        assert max(proof.sizes) < 2.0**-26
        assert re.match(rf"order {proof.n}: consistent to (0|\d+e-\d+) \(PDE residual ", str(proof))
    assert max(max(proof.sizes) for proof in proofs) > 0
    assert "numbers" in proofs.relative_to


@pytest.mark.parametrize("name", NUMBERS)
def test_wrong_numbers_are_inconsistent(name: str) -> None:
    """One coefficient of the last or the first order wrong by a thousandth."""
    expansion = NUMBERS[name]
    for n in (1, expansion.order):
        j, c = max(expansion.contact(n).items())
        contact = dict(expansion.contact(n)) | {j: c * 1.001}
        proofs = refuted(changed(expansion, n, contact=contact), f"order {n}: inconsistent")
        assert faults(proofs[n]) == {"contact"}
        assert 0 < proofs[n].sizes[2] < 1.001e-3
        start = list(expansion.shape(n)[j])
        start[-1] = start[-1] * 1.001
        shape = dict(expansion.shape(n)) | {j: tuple(start)}
        assert "driven_end" in faults(refuted(changed(expansion, n, shape=shape))[n])
    problem = expansion.problem

    def residual(j: int, w: Any) -> Any:
        return problem.equation_residual(j, w) + w[2] / 1000

    wrong = Expansion(replace(problem, equation_residual=residual), expansion.orders)
    assert faults(refuted(wrong)[0]) == {"equation"}
    lost = {j: c for j, c in expansion.contact(1).items() if j != max(expansion.contact(1))}
    refuted(changed(expansion, 1, contact=lost), "order 1: inconsistent")


def along_the_kernel(expansion: Expansion, condition: int, change: Any) -> Expansion:
    """w″ and w‴ of the last harmonic moved so that one condition of the driven end sees nothing."""
    n, problem = expansion.order, expansion.problem
    ring = problem.ring
    units = ([ring.one if i == k else ring.zero for i in range(4)] for k in (2, 3))
    x, y = (problem.end_residual(n, unit)[condition] for unit in units)
    second, third = change * y, ring.rational(-1) * change * x
    w = expansion.shape(n)[n]
    shape = dict(expansion.shape(n)) | {n: (*w[:2], w[2] + second, w[3] + third)}
    c = expansion.contact(n)[n] - second * problem.inverse_leading  # w″ + a₃ξ = …
    return changed(expansion, n, shape=shape, contact=dict(expansion.contact(n)) | {n: c})


BEAMS = ("pinned", "clamped", "thin layer", "thin clamped layer", "stiff", "complex", "digits")


@pytest.mark.parametrize("condition", [0, 1])
def test_each_condition_of_a_beams_driven_end_is_checked(condition: int) -> None:
    def refute(expansion: Expansion, change: Any, word: str) -> None:
        n = expansion.order
        wrong = along_the_kernel(expansion, condition, change)
        proofs = refuted(wrong, f"order {n}: {word}")
        assert [faults(proof) for proof in proofs] == [set()] * n + [{"driven_end"}]

    for name in BEAMS:
        expansion = NUMBERS[name]
        n, problem = expansion.order, expansion.problem
        unit = problem.end_residual(n, [problem.ring.rational(int(i == 3)) for i in range(4)])
        change = expansion.shape(n)[n][2] / (1000 * unit[condition])
        refute(expansion, change, "inconsistent")
    with at_precision(128):
        for driven_end in ("pinned", "clamped"):
            refute(expand(beam_problem(0.01, 2.2, driven_end, balls()), 3), arb("1e-12"), "REFUTED")
    symbolic = expand_symbolic(3)
    refute(symbolic, symbolic.problem.ring.one, "REFUTED")


@pytest.mark.parametrize("condition", [0, 1])
@pytest.mark.parametrize("driven_end", ["pinned", "clamped"])
@pytest.mark.parametrize("beta", [1e-6, 0.01, 1.0])
def test_each_condition_of_a_beams_static_shape_is_checked(
    beta: float, driven_end: str, condition: int
) -> None:
    """Another contact point, and the a₃ for which one of the conditions holds there."""
    right = static_beam(beta, driven_end)
    moved = replace(right, contact_point=right.contact_point * 1.01)
    problem = beam_problem(beta, 2.2, driven_end, static=moved)
    none, one = (
        problem.static_end_residual(lambda d, a3=a3: a3 if d == 3 else problem.static(d))[condition]
        for a3 in (0.0, 1.0)
    )
    shape = replace(moved, a3=none / (none - one))
    wrong = replace(beam_problem(beta, 2.2, driven_end, static=shape), balls=None)
    proofs = refuted(expand(wrong, 2), "order 0: inconsistent")
    assert [faults(proof) for proof in proofs] == [{"driven_end"}, set(), set()]


@pytest.mark.parametrize("name", ["string", "pinned", "clamped", "viscous"])
def test_an_image_leaves_of_each_condition_what_the_problem_does(name: str) -> None:
    """For any derivatives: here none that solve anything."""
    problem = NUMBERS[name].problem
    image = image_of_problem(problem, problem.ring, lambda x: x)

    def static(d: int) -> float:
        return (0.3, -0.7, 1.9, -2.3, 5.1)[d]

    assert image.static_end_residual(static) == pytest.approx(problem.static_end_residual(static))
    for j in (0, 1, 3):
        w = [0.4, -1.7, 2.9, 0.8, 3.3][: len(problem.mode(j).reduction) + 1]
        assert image.end_residual(j, w[:-1]) == pytest.approx(problem.end_residual(j, w[:-1]))
        assert image.equation_residual(j, w) == pytest.approx(problem.equation_residual(j, w))
        if j:
            assert image.end_unit(j) == problem.end_unit(j)


def test_at_some_phases_a_harmonic_vanishes() -> None:
    """n = (1, 0) − (0, 1) − (1, −1) = 0: here the real part of an imaginary product."""
    drive = fourier_drive([0.7, 1.9], {(1, 0): 0.3, (0, 1): 0.4}, {(1, -1): 0.5})
    expansion = expand(forced_string(drive, 3), 3)
    assert not expansion.contact(3).get(0, 0)
    assert prove(expansion)[3].missing == ()
    nothing = replace(expansion.orders[0], contact={}, shape={})
    problem = replace(expansion.problem, drive={1: 0j})
    assert "missing" in faults(refuted(Expansion(problem, (nothing,)))[1])


@pytest.mark.parametrize(
    ("beta", "driven_end"),
    [(1e10, "pinned"), (1e16, "pinned"), (1e30, "pinned"), (1e10, "clamped")],
)
def test_a_very_stiff_beam_is_consistent(beta: float, driven_end: str) -> None:
    """The growing solution, as large as the rest at ξ₀, hides no digits of W₀ = 1."""
    assert prove(expand(float_beam(beta, 2.2, 2, driven_end), 2)).holds


def test_magnitudes_only_add_up() -> None:
    ring = MajorantRing(even=False)
    assert (ring.zero, ring.one, ring.rational(-3), ring.rational(-3, 2)) == (0.0, 1.0, 3.0, 1.5)
    assert (ring.sum([]), ring.sum([ring.rational(-1), 2.0])) == (0.0, 3.0)
    assert ring.is_zero(ring.zero)
    assert not ring.is_zero(np.array([0.0, 1e-300]))


def test_digits_are_held_to_the_digits_they_have_and_doubles_to_theirs() -> None:
    with mpmath.workdps(50):
        expansion = expand(beam_problem("0.01", "2.2", numbers=digits()), 2)
        assert max(max(proof.sizes) for proof in prove(expansion)) < 1e-48
        contact = {j: c * (1 + mpmath.mpf(10) ** -30) for j, c in expansion.contact(2).items()}
        assert faults(refuted(changed(expansion, 2, contact=contact))[2]) == {"contact"}
        assert prove(NUMBERS["string"]).holds
        assert prove(NUMBERS["damped"]).holds


def test_numbers_that_are_none_are_inconsistent() -> None:
    expansion = NUMBERS["string"]
    for value in (np.nan, np.inf):
        contact = dict(expansion.contact(8)) | {0: value}
        proofs = refuted(changed(expansion, 8, contact=contact), "order 8: inconsistent")
        assert faults(proofs[8]) == {"contact"}


def test_balls_contain_zero_and_say_how_wide_they_are() -> None:
    with at_precision(128):
        cases = [
            expand(ball_string("2.2"), 5),
            expand(ball_damped_string("2.2", "0.1"), 4),
            expand(beam_problem(0.01, 2.2, numbers=balls()), 3),
        ]
        for expansion in cases:
            proofs = prove(expansion)
            assert proofs.holds
            assert proofs.relative_to.startswith("balls")
            last = proofs[expansion.order]
            widest = [
                float(x.rad()) if isinstance(x, arb) else float(arb.max(x.real.rad(), x.imag.rad()))
                for x in residuals(expansion, moving_frame(expansion), expansion.order)
            ]
            assert 0 < max(last.sizes) == max(widest) < 1e-15
            assert f"enclosed within {max(widest):.0e} (PDE residual contains 0" in str(last)
            j, c = max(expansion.contact(2).items())
            contact = dict(expansion.contact(2)) | {j: c * arb("1.0000000001")}
            assert faults(refuted(changed(expansion, 2, contact=contact), "REFUTED")[2]) == {
                "contact"
            }
            contact = dict(expansion.contact(2)) | {j: c * arb(0, "inf")}
            assert "contact" in faults(refuted(changed(expansion, 2, contact=contact))[2])


def test_truncated_series_are_proved_as_far_as_they_are_known() -> None:
    expansion = laurent_expansion(1, 2, 4, terms=6)
    proofs = prove(expansion)
    assert "order 2: proved up to O(mu^5)" in str(proofs)
    assert "order 4: proved up to O(mu^3)" in str(proofs)
    assert proofs.relative_to.startswith("series in mu")
    contact = dict(expansion.contact(2))
    contact[2] = expansion.problem.ring.sum([contact[2], contact[2]])
    assert faults(refuted(changed(expansion, 2, contact=contact))[2]) == {"contact"}


def test_progress_is_told(sixth: Expansion) -> None:
    seen: list[int] = []
    prove(sixth, progress=seen.append)
    assert seen == [1, 2, 3, 4, 5, 6]


def test_generators_prove_as_before() -> None:
    for expansion in (expand_symbolic(3), expand(generator_string([1, 2], 2), 2)):
        proofs = prove(expansion)
        assert {proof.kind for proof in proofs} == {"exact"}
        assert len(proofs) == expansion.order + 1
        assert [proof.n for proof in proofs[1:]] == list(range(1, expansion.order + 1))
