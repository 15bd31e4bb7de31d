"""The beam over its generators: exact proofs, closed forms, their numbers and their emission."""

from __future__ import annotations

import ast
import dataclasses
import os
import re
import subprocess
import sys
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mpf

from asymptotics import Expansion, exact_string, expand, prove
from asymptotics.errors import InputError
from asymptotics.expansion.order_loop import Order
from asymptotics.expansion.proof import RefutedError
from asymptotics.formulas.beam import (
    contact_amplitude,
    expand_symbolic,
    generator_names,
    impedances,
    symbolic_beam,
)
from asymptotics.printing.beam_latex import beam_latex
from asymptotics.printing.beam_numpy import beam_numpy
from asymptotics.problems.beam import beam_problem, static_beam
from asymptotics.problems.static_shape import DRIVEN_ENDS
from asymptotics.rings.harmonics import reachable
from asymptotics.rings.numbers import digits
from asymptotics.rings.ring import GeneratorRing

ORDER = 5


@cache
def series() -> Expansion[Any]:
    return expand_symbolic(ORDER)


def test_every_order_is_proved_and_there() -> None:
    proofs = prove(series())
    assert all(proof.holds for proof in proofs)
    assert [set(proof.harmonics) for proof in proofs[1:]] == [
        reachable([1], n) for n in range(1, ORDER + 1)
    ]


def test_first_orders_in_closed_form() -> None:
    """ξ₁ = −S₂ cos θ; both harmonics of ξ₂; w₁ = w₁′ = w₂ = 0, w₂′ = ½ξ₁², w₃ = −ξ₁³/6."""
    ring = series().problem.ring
    assert isinstance(ring, GeneratorRing)
    s2, s3, sigma = ring["S2"], ring["S3"], ring["sigma"]
    half, quarter, eighth = (ring.rational(1, k) for k in (2, 4, 8))
    assert contact_amplitude(series(), 1, 1) == -s2
    for j in (0, 2):
        expected = half * s2 * s3 - quarter * s2 * s2 * (sigma + ring[f"Y{j}_21"])
        assert contact_amplitude(series(), 2, j) == expected
    assert series().shape(1)[1][:2] == (ring.zero, ring.zero)
    for j, share in ((0, quarter), (2, eighth)):
        assert series().shape(2)[j][:2] == (ring.zero, share * s2 * s2)
    # cos³θ = (3 cos θ + cos 3θ)/4, as c_j of e^{ijθ}.
    for j, share in ((1, ring.rational(3, 8)), (3, eighth)):
        assert series().shape(3)[j][0] == ring.rational(1, 6) * share * s2 * s2 * s2
    assert len(list(contact_amplitude(series(), 3, 1).terms())) == 15
    assert len(list(contact_amplitude(series(), 3, 3).terms())) == 11


def test_impedances_of_the_value_enter_at_order_three_only() -> None:
    """Up to order 2 the contact data are slopes: w₂ = 0."""
    ring = series().problem.ring
    for n, wanted in ((1, False), (2, False), (3, True)):
        powers = [monomial for c in series().contact(n).values() for monomial, _ in c.terms()]
        used = {name for m in powers for name, a in zip(ring.names, m, strict=True) if a}
        assert any(name.endswith("_20") for name in used) == wanted


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("beta", "omega"), [("0.01", "2.2"), ("1e-4", "5.1"), ("2", "0.83")])
def test_values_are_the_numeric_beam_s(beta: str, omega: str, driven_end: str) -> None:
    with mpmath.workdps(50):
        numbers = digits()
        point = impedances(beta, omega, ORDER, driven_end, numbers)
        direct = expand(beam_problem(beta, omega, driven_end, numbers), ORDER)
        for n in range(1, ORDER + 1):
            assert series().contact(n).keys() == direct.contact(n).keys()
            for j, c in series().contact(n).items():
                found = point.evaluate(c, mpf) / point.a3**n
                # Terms as large as (p ξ)^n cancel: a dozen of the fifty digits at β = 1e-4.
                assert abs(found - direct.contact(n)[j]) < mpf(10) ** -30 * abs(found)
            for j, w in series().shape(n).items():
                for x, y in zip(w, direct.shape(n)[j], strict=True):
                    found = point.evaluate(x, mpf) / point.a3 ** (n - 1)
                    assert abs(found - y) <= mpf(10) ** -30 * max(map(abs, direct.shape(n)[j]))


def spoiled(change: Any) -> Expansion[Any]:
    order = series().orders[2]
    contact, shape = dict(order.contact), dict(order.shape)
    change(contact, shape)
    orders = list(series().orders)
    orders[2] = Order(contact, shape, order.tails)
    return dataclasses.replace(series(), orders=tuple(orders[:3]))


def test_a_wrong_contact_point_is_refuted() -> None:
    def change(contact: dict[int, Any], shape: dict[int, Any]) -> None:
        contact[3] = contact[3] + contact[3]

    with pytest.raises(RefutedError, match=r"order 3: REFUTED .* contact NOT 0"):
        prove(spoiled(change))


@pytest.mark.parametrize("place", [2, 3])
def test_a_wrong_impedance_is_refuted(place: int) -> None:
    """Either of the two definitions, thanks to the free weight λ between them."""

    def change(contact: dict[int, Any], shape: dict[int, Any]) -> None:
        w = list(shape[1])
        w[place] = w[place] + w[place]
        shape[1] = tuple(w)

    with pytest.raises(RefutedError, match=r"driven end NOT 0"):
        prove(spoiled(change))


def test_a_wrong_equation_is_refuted() -> None:
    problem = symbolic_beam(2)
    ring = problem.ring

    def mode(j: int) -> Any:
        good = problem.mode(j)
        return dataclasses.replace(good, reduction=(ring.zero, *good.reduction[1:]))

    with pytest.raises(RefutedError, match=r"PDE residual NOT 0"):
        prove(expand(dataclasses.replace(problem, mode=mode), 2))


def test_bad_input() -> None:
    with pytest.raises(InputError, match="order = 0"):
        expand_symbolic(0)
    with pytest.raises(InputError, match="closed forms of the beam need its generators"):
        contact_amplitude(expand(exact_string(), 1), 1, 1)
    with pytest.raises(InputError, match="beta = 0"):
        impedances(0.0, 2.2, 2)
    assert len(generator_names(3)) == 5 + 4 * 4


# -- emission ------------------------------------------------------------------------------------


def module_of(order: int, driven_end: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(beam_numpy(Expansion(series().problem, series().orders[:order]), driven_end), namespace)
    return namespace


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
@pytest.mark.parametrize(("beta", "omega"), [(10.0, 0.5), (0.1, 0.83), (0.01, 2.2), (1e-3, 5.1)])
def test_the_numpy_module_gives_the_beam_s_numbers(
    beta: float, omega: float, driven_end: str
) -> None:
    found = module_of(4, driven_end)["harmonics"](omega, beta)
    with mpmath.workdps(50):
        exact = expand(beam_problem(beta, omega, driven_end, digits()), 4)
    assert set(found) == {(n, j) for n in range(1, 5) for j in exact.contact(n)}
    for (n, j), value in found.items():
        wanted = float(exact.contact(n)[j] * (1 if j == 0 else 2))
        # An error of p ≤ 32 ulp in each impedance, a hundred of them in a coefficient that may
        # itself be a hundredth of its terms.
        assert value == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("driven_end", DRIVEN_ENDS)
def test_the_numpy_module_in_the_boundary_layer(driven_end: str) -> None:
    """β = 1e-6: terms of size β^{−n/2} have cancelled before the code was written."""
    found = module_of(3, driven_end)["harmonics"](2.2, 1e-6)
    with mpmath.workdps(60):
        exact = expand(beam_problem(1e-6, 2.2, driven_end, digits()), 3)
    for (n, j), value in found.items():
        wanted = float(exact.contact(n)[j] * (1 if j == 0 else 2))
        # p² ulp, p = 1000, in what is left of Y₂₀ at order 3; p³ and more were it not for that.
        assert value == pytest.approx(wanted, rel=8e-16 * 1e3 ** (n - 1) * 10)


def test_the_numpy_module_adds_up_the_series_and_broadcasts() -> None:
    module = module_of(3, "pinned")
    tau, omega = np.linspace(0, 3, 4), np.array([[1.3], [2.2]])
    found = module["contact"](tau, omega, 0.02, 0.01)
    assert found.shape == (2, 4)
    direct = expand(beam_problem(0.01, 2.2), 3)
    wanted = static_beam(0.01).contact_point + sum(
        0.02**n * c * (1 if j == 0 else 2) * np.cos(j * 2.2 * tau)
        for n in range(1, 4)
        for j, c in direct.contact(n).items()
    )
    assert found[1] == pytest.approx(wanted, rel=1e-14)
    assert module["static_contact_point"](np.array([1e-4, 0.1])).shape == (2,)


def test_the_numpy_module_is_self_contained_and_the_same_every_time() -> None:
    source = beam_numpy(expand_symbolic(3))
    imported = [
        name
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (
            [a.name for a in node.names] if isinstance(node, ast.Import) else [node.module]
        )
    ]
    assert imported == ["typing", "numpy"]
    assert max(map(len, source.splitlines())) <= 100
    program = (
        "from asymptotics.printing.beam_latex import *;"
        "from asymptotics.printing.beam_numpy import *;"
        "from asymptotics.formulas.beam import *;"
        "e = expand_symbolic(3); print(beam_numpy(e) + beam_latex(e), end='')"
    )
    for seed in ("0", "1"):
        result = subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        assert result.stdout == source + beam_latex(expand_symbolic(3))


def read_back(tex: str, values: dict[str, Any]) -> Any:
    """The value of an emitted right-hand side."""
    code = tex.replace(r"\nonumber", "").replace("\\\\", "").replace("\n", "").replace("&", "")
    code = code.replace(r"\qquad", "").replace(r"\quad", "").replace(r"\sigma{}", "{sigma}")
    code = code.replace("{-}", "-").replace("(Y", "*(Y")
    code = code.replace(r"\Bigl[", "*(").replace(r"\Bigr]", ")")
    code = re.sub(r"\\frac\{(\d+)\}\{(\d+)\}", r"*mpf(\1)/\2", code)
    code = re.sub(r"Y\^\{\((\d)\)\}_\{(\d\d)\}", r"{Y\1_\2}", code)
    code = re.sub(r"S_\{(\d)\}", r"{S\1}", code)
    code = re.sub(r"(?<![{A-Za-z_])([bB])(?!\w)", r"{\1}", code)
    code = re.sub(r"\^\{(\d)\}", r"**\1", code)
    code = re.sub(r"\{(\w+)\}", r"*v['\1']", code)
    code = re.sub(r"(^|[-+(])\*\(", r"\1(", code)
    code = re.sub(r"(^|[-+(])\*", r"\1", code)
    return eval(code, {"v": values, "mpf": mpf})


def test_the_latex_formulas_read_back() -> None:
    expansion = expand_symbolic(4)
    text = beam_latex(expansion)
    with mpmath.workdps(40):
        point = impedances("0.01", "2.2", 4, "pinned", digits())
        values = dict(point.values)
        found = re.findall(
            r"^(\\xi|u|v)_\{(\d),(\d)\}=\{\}(.*?)[,.] \\label", text, re.MULTILINE | re.DOTALL
        )
        wanted = {}
        for n in range(1, 5):
            for j in expansion.contact(n):
                wanted[r"\xi", n, j] = contact_amplitude(expansion, n, j)
                if n > 1:
                    for name, x in zip("uv", expansion.shape(n)[j], strict=False):
                        if not x.is_zero():
                            wanted[name, n, j] = x if j == 0 else x + x
        assert {(name, int(n), int(j)) for name, n, j, _ in found} == set(wanted)
        for name, n, j, tex in found:
            expected = point.evaluate(wanted[name, int(n), int(j)], mpf)
            assert abs(read_back(tex, values) - expected) < mpf(10) ** -25 * (1 + abs(expected))


def test_the_latex_definitions_hold() -> None:
    """The printed Φ, Ψ, Λ and S: values, slopes and both conditions at the driven end."""
    with mpmath.workdps(40):
        numbers = digits()
        shape = static_beam("0.01", "pinned", numbers)
        length, beta = shape.contact_point, shape.beta
        root = mpmath.sqrt(1 + 4 * beta * mpf("2.2") ** 2)
        p, k = mpmath.sqrt((root + 1) / (2 * beta)), mpmath.sqrt((root - 1) / (2 * beta))
        C, D, T = mpmath.cos(k * length), mpmath.sin(k * length) / k, mpmath.tanh(p * length)
        delta, cosh = p * D - T * C, mpmath.cosh(p * length)

        def phi(x: mpf) -> mpf:
            return (p * mpmath.sin(k * x) / k - C * mpmath.sinh(p * x) / cosh) / delta

        def psi(x: mpf) -> mpf:
            return (D * mpmath.sinh(p * x) / cosh - T * mpmath.sin(k * x) / k) / delta

        def r(x: mpf) -> mpf:
            return (p * p * mpmath.cos(k * x) + k * k * mpmath.cosh(p * x)) / (p * p + k * k)

        slope = mpmath.diff(r, length)

        def drive(x: mpf) -> mpf:
            return r(x) - r(length) * phi(x) - slope * psi(x)

        values = impedances("0.01", "2.2", 1, "pinned", numbers).values
        for function, at_rest, expected in (
            (phi, 0, (1, 0, values["Y1_20"], values["Y1_30"])),
            (psi, 0, (0, 1, values["Y1_21"], values["Y1_31"])),
            (drive, 1, (0, 0, values["S2"], values["S3"])),
        ):
            assert abs(function(mpf(0)) - at_rest) < mpf(10) ** -30
            assert abs(mpmath.diff(function, 0, 2)) < mpf(10) ** -8
            for d, wanted in enumerate(expected):
                # Numerical differentiation at 40 digits is good to some fifteen.
                assert abs(mpmath.diff(function, length, d) - wanted) < mpf(10) ** -8 * (
                    1 + abs(wanted)
                )


def test_the_clamped_latex_differs_in_its_definitions_only() -> None:
    expansion = expand_symbolic(2)
    pinned, clamped = (beam_latex(expansion, end) for end in DRIVEN_ENDS)
    assert r"w=w_{\xi\xi}=0" in pinned
    assert r"w=w_{\xi}=0" in clamped
    amplitudes = [
        re.sub(r"\\label\{[^}]*\}", "", text[text.index(r"\xi_{1,1}") :])
        for text in (pinned, clamped)
    ]
    assert amplitudes[0] == amplitudes[1]
    for text in (pinned, clamped):
        assert text.count(r"\begin{align}") == text.count(r"\end{align}")


@pytest.mark.parametrize("order", [1, 3, 5])
def test_the_latex_is_a_text_with_labels_that_tex_accepts(order: int) -> None:
    expansion = expand_symbolic(order)
    labels: list[str] = []
    for end in DRIVEN_ENDS:
        text = beam_latex(expansion, end)
        body = [line for line in text.splitlines() if not line.startswith("%")]
        assert body[0].startswith(r"\begingroup")
        assert body[1].startswith("The contact point and the shape of the beam")
        assert body[-1] == r"\par\endgroup"
        for block in re.findall(r"\\begin\{align\}(.*?)\\end\{align\}", text, re.DOTALL):
            rows = re.split(r"\\\\(?:\[1ex\])?\n", block)
            assert all((r"\label" in row) != (r"\nonumber" in row) for row in rows)
        # Two superscripts on one symbol stop TeX.
        assert not re.search(r"\^\{[^}]*\}(_\{[^}]*\})?\^", text)
        labels += re.findall(r"\\label\{([^}]*)\}", text)
    assert len(labels) == len(set(labels))
    assert all(label.startswith("eq:rope:") for label in labels)


@pytest.mark.parametrize("emit", [beam_latex, beam_numpy])
def test_emission_of_bad_input(emit: Any) -> None:
    with pytest.raises(InputError, match="choose one of pinned, clamped"):
        emit(expand_symbolic(1), "free")
    with pytest.raises(InputError, match="need its generators"):
        emit(expand(exact_string(), 1))
