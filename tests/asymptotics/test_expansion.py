"""The order loop: known coefficients, a second method, extension, and proofs that can fail."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from asymptotics import Expansion, exact_string, expand, float_string, prove, string_problem
from asymptotics.errors import InputError, ResonanceError
from asymptotics.expansion.order_loop import Order
from asymptotics.expansion.proof import RefutedError
from asymptotics.problems.string import pole_at
from asymptotics.rings.cotangent import CotangentRing
from asymptotics.rings.harmonics import pack, reachable, unpack
from asymptotics.rings.ring import FloatRing

RING = CotangentRing()


def rational_power(numerator: int, denominator: int, power: int):  # type: ignore[no-untyped-def]
    element = RING.rational(numerator, denominator)
    for _ in range(power):
        element = element * RING.omega
    return element


def test_first_coefficients(sixth: Expansion) -> None:
    """ξ₁ = ½Ω cos θ; ξ₂ = −Ω²/16 − (Ω³/8) κ₂ cos 2θ (a cosine's amplitude is twice its c_j)."""
    assert sixth.contact(1) == {1: rational_power(1, 4, 1)}
    assert sixth.contact(2) == {
        0: rational_power(-1, 16, 2),
        2: rational_power(-1, 16, 3) * RING.cot(2),
    }
    assert sixth.shape(2)[0] == (rational_power(1, 8, 2),) * 2


def direct_taylor(omega: float, order: int) -> tuple[list[dict[int, complex]], list[float]]:
    """A second method over plain numbers: explicit powers δ^d, two-sided Fourier sums by FFT.

    Order by order in ε̂, with time on a grid; nothing of the engine is used. Also returns the
    largest term that enters each order: what its roundings are relative to.
    """
    sizes = [0.0]
    points = 4 * order + 4
    theta = 2 * np.pi * np.arange(points) / points
    delta = [np.zeros(points)]  # δ's orders as functions of time
    towers: list[dict[int, np.ndarray]] = [{2: np.full(points, 2.0)}]
    modes = np.fft.rfftfreq(points, 1 / points)

    def power(d: int, n: int) -> np.ndarray:
        """δ^d at order n."""
        if d == 0:
            return np.ones(points) if n == 0 else np.zeros(points)
        return sum(
            (delta[k] * power(d - 1, n - k) for k in range(1, min(n, len(delta) - 1) + 1)),
            np.zeros(points),
        )

    for n in range(1, order + 1):
        delta.append(np.zeros(points))
        products = [
            [
                power(d, n - k) / math.factorial(d) * towers[k][d + e]
                for k in range(n)
                for d in range(1, n - k + 1)
                if d + e in towers[k]
            ]
            for e in (0, 1)
        ]
        known = [sum(terms, np.zeros(points)) for terms in products]
        value = np.fft.rfft(-known[0])
        cot = np.zeros(modes.size)
        cot[1:] = 1 / np.tan(modes[1:] * omega)
        slope = np.where(modes > 0, modes * omega * cot, 1.0) * value
        if n == 1:
            slope = slope + np.fft.rfft(-omega * np.cos(theta))
        sizes.append(
            max([abs(t).max() for terms in products for t in terms] + [omega])
            * max(1.0, float((modes * omega * abs(cot)).max()))
        )
        tower = {}
        for d in range(order + 2):
            start = (value, slope)[d % 2]
            tower[d] = np.fft.irfft((-((modes * omega) ** 2)) ** (d // 2) * start, points)
        towers.append(tower)
        delta[n] = -(tower[1] + known[1]) / 2
    spectra = [np.fft.rfft(d) / points for d in delta]
    return [{j: s[j] for j in range(order + 1)} for s in spectra], sizes


@pytest.mark.parametrize("omega", [0.83, 2.2, 5.1])
def test_a_second_method_agrees(omega: float) -> None:
    order = 7
    expected, sizes = direct_taylor(omega, order)
    found = expand(float_string(omega, order), order)
    for n in range(1, order + 1):
        for j in range(order + 1):
            difference = abs(found.contact(n).get(j, 0.0) - expected[n][j])
            # Some N³ products enter, each with the errors of the orders before it.
            assert difference <= order**3 * np.finfo(float).eps * max(sizes[: n + 1])
            assert n != j or abs(expected[n][j]) > 1e-6 * sizes[n]


def test_floats_and_closed_forms_agree(sixth: Expansion) -> None:
    omega = 0.83
    numbers = expand(float_string(omega, 6), 6)
    c = 1 / math.tan(omega)
    for n in range(1, 7):
        assert numbers.contact(n).keys() == sixth.contact(n).keys()
        for j, element in sixth.contact(n).items():
            below = float(element.denominator)
            for q, m in enumerate(element.poles, start=2):
                from asymptotics.rings.cotangent import resonance_polynomial

                poly = resonance_polynomial(q)
                below *= sum(int(poly[i]) * c**i for i in range(poly.degree() + 1)) ** m
            above = sum(
                int(v) * omega ** int(a) * c ** int(i) for (a, i), v in element.numerator.terms()
            )
            assert numbers.contact(n)[j] == pytest.approx(above / below, rel=1e-9)


def test_one_frequency_or_an_array_of_them() -> None:
    omegas = np.array([0.83, 2.2, 4.0])
    problem = string_problem(FloatRing(), omegas, lambda j: 1 / np.tan(j * omegas))
    together = expand(problem, 4)
    for i, omega in enumerate(omegas):
        alone = expand(float_string(omega, 4), 4)
        for n in range(1, 5):
            for j, c in alone.contact(n).items():
                row = np.broadcast_to(together.contact(n)[j], omegas.shape)
                assert row[i] == pytest.approx(c, rel=1e-12)


def test_extension_keeps_what_is_there_and_equals_the_direct_way(sixth: Expansion) -> None:
    short = expand(exact_string(), 3)
    seen: list[int] = []
    longer = expand(exact_string(), 6, start=short, progress=seen.append)
    assert seen == [4, 5, 6]
    assert all(a is b for a, b in zip(longer.orders, short.orders, strict=False))
    assert [o.contact for o in longer.orders] == [o.contact for o in sixth.orders]
    assert expand(exact_string(), 2, start=short).order == 2


def test_extension_of_another_problem_is_refused() -> None:
    with pytest.raises(InputError, match="belongs to 'string'"):
        expand(float_string(0.83, 3), 3, start=expand(exact_string(), 2))


@pytest.mark.parametrize("order", [0, -1, 2.5, "4", None, True])
def test_bad_orders(order: object) -> None:
    with pytest.raises(InputError, match="order = "):
        expand(exact_string(), order)  # type: ignore[arg-type]


def test_orders_that_are_not_there(sixth: Expansion) -> None:
    for n in (0, 7):
        with pytest.raises(InputError, match="holds orders 1 … 6"):
            sixth.contact(n)


@pytest.mark.parametrize(
    ("omega", "order", "p", "q"),
    [
        (math.pi, 1, 1, 1),
        (2 * math.pi, 4, 2, 1),
        (math.pi / 3, 3, 1, 3),
        (3.14159265, 4, 1, 1),
        (5 * math.pi / 7 * (1 + 1e-12), 7, 5, 7),
        (1.5 * math.pi, 8, 3, 2),
    ],
)
def test_resonances_are_named(omega: float, order: int, p: int, q: int) -> None:
    with pytest.raises(ResonanceError, match=f"p/q = {p}/{q} ") as caught:
        float_string(omega, order)
    assert (caught.value.p, caught.value.q) == (p, q)


def test_a_resonance_of_a_higher_order_is_no_hindrance() -> None:
    assert expand(float_string(math.pi / 3, 2), 2).order == 2


@pytest.mark.parametrize("omega", [0.0, -1.0, math.nan, math.inf, "x", None, 1e9])
def test_bad_frequencies(omega: object) -> None:
    with pytest.raises(InputError, match="Omega = "):
        float_string(omega, 2)  # type: ignore[arg-type]


def test_every_order_is_proved(sixth: Expansion) -> None:
    proofs = prove(sixth)
    assert [p.n for p in proofs] == list(range(7))
    assert all(p.holds for p in proofs)
    assert [len(p.harmonics) for p in proofs] == [1, 1, 2, 2, 3, 3, 4]


def changed(expansion: Expansion, n: int, **fields: object) -> Expansion:
    orders = list(expansion.orders)
    orders[n - 1] = replace(orders[n - 1], **fields)  # type: ignore[arg-type]
    return Expansion(expansion.problem, tuple(orders))


def test_a_wrong_contact_point_is_refuted(sixth: Expansion) -> None:
    contact = dict(sixth.contact(4))
    contact[2] = contact[2] * RING.rational(2)
    with pytest.raises(RefutedError, match="order 4: REFUTED") as caught:
        prove(changed(sixth, 4, contact=contact))
    # The error is even, so order 5 does not see it.
    assert [p.contact for p in caught.value.proofs] == [True] * 4 + [False, True, False]


def test_a_wrong_shape_is_refuted_at_the_driven_end(sixth: Expansion) -> None:
    shape = dict(sixth.shape(3))
    value, slope = shape[1]
    shape[1] = (value, slope + RING.omega)
    with pytest.raises(RefutedError) as caught:
        prove(changed(sixth, 3, shape=shape))
    assert not caught.value.proofs[3].driven_end
    assert not caught.value.proofs[3].contact


def test_a_wrong_equation_is_refuted(sixth: Expansion) -> None:
    problem = sixth.problem
    wrong = replace(
        problem,
        mode=lambda j: replace(problem.mode(j), reduction=(RING.omega, RING.zero)),
    )
    proofs: tuple = ()
    with pytest.raises(RefutedError) as caught:
        prove(Expansion(wrong, sixth.orders))
    proofs = caught.value.proofs
    assert not proofs[1].equation


def test_zero_equals_zero_is_no_proof(sixth: Expansion) -> None:
    """An expansion that collapsed satisfies every homogeneous statement; substance does not."""
    nothing: Order = Order(contact={}, shape={}, tails=((), ()))
    problem = replace(sixth.problem, drive={1: RING.zero})
    with pytest.raises(RefutedError, match="harmonics 1 MISSING"):
        prove(Expansion(problem, (nothing,)))


def test_packed_indices_add_like_tuples() -> None:
    for left in [(1, 0), (3, -4), (-2, 7), (0, -1)]:
        for right in [(0, 0), (5, 5), (-3, 4)]:
            total = pack(left) + pack(right)
            assert unpack(total, 2) == (left[0] + right[0], left[1] + right[1])
    assert reachable([pack((1, 0)), pack((0, 1))], 2) == {
        0,
        pack((2, 0)),
        pack((0, 2)),
        pack((1, 1)),
        pack((1, -1)),
    }


def test_numerically_at_a_resonance_is_relative_to_the_argument() -> None:
    """|qΩ − pπ| ≤ √u qΩ: at qΩ = 1000π that is 4.7e-5."""
    x = 1000 * math.pi
    assert pole_at(x + 4e-5) == pole_at(x - 4e-5) == 1000
    assert pole_at(x + 6e-5) == pole_at(x - 6e-5) == 0
    assert pole_at(math.pi + 4e-8) == 1
    assert pole_at(math.pi + 6e-8) == 0
    with pytest.raises(ResonanceError, match="p/q = 1000/1"):
        float_string(x + 4e-5, 1)
