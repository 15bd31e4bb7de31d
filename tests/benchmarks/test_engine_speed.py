"""How fast the engine is; nothing here fails on time.

``pytest tests/benchmarks --benchmark-only`` prints the groups with their ratios.
The goals, kept beside the results as ``goal in seconds``: F₀ … F₄ and the contact point in
10 ms, order 12 in 2 s, order 16 in 60 s.
"""

from __future__ import annotations

import pytest

from asymptotics import ClosedForms, exact_string, expand, float_string, moving_frame, prove
from asymptotics.expansion.enclosures import enclosures
from asymptotics.expansion.modular import wrong_tails
from asymptotics.formulas.normal_form import _cotangent_form
from derivations.reports.formats import FORMATS, render
from tests.benchmarks.rivals import OURS, RIVALS, largest_error

HIGHEST_RIVAL_ORDER = 5


def closed_forms_to_order_4():
    return moving_frame(expand(exact_string(), order=4))


@pytest.mark.benchmark(group="F_0 ... F_4 and the contact point")
def test_paper_orders(benchmark):
    benchmark.extra_info["goal in seconds"] = 0.010
    frame = benchmark(closed_forms_to_order_4)
    assert set(frame.modes) == {0, 1, 2, 3, 4}
    prove(frame.expansion, frame)


@pytest.mark.benchmark(group="high order")
@pytest.mark.parametrize(("order", "claim"), [(8, None), (12, 2.0), (16, 60.0)])
def test_high_order(benchmark, order, claim):
    benchmark.extra_info["goal in seconds"] = claim
    solution = benchmark.pedantic(
        expand, (exact_string(), order), rounds=1 if order > 12 else 3, warmup_rounds=0
    )
    assert max(solution.contact(order)) == order


def derive_to_order_10():
    solution = expand(exact_string(), 10)
    return solution, moving_frame(solution)


@pytest.mark.benchmark(group="writing against deriving, order 10")
@pytest.mark.parametrize("what", ["expanding and proving", *FORMATS, "all formats"])
def test_writing(benchmark, what):
    """Every format from closed forms of its own; all formats together share their elements."""
    if what == "expanding and proving":
        benchmark.pedantic(lambda: prove(*derive_to_order_10()), rounds=3)
        return
    solution, frame = derive_to_order_10()
    proofs = prove(solution, frame)

    def fresh():
        _cotangent_form.cache_clear()
        return (ClosedForms(solution, frame),), {}

    def write(forms):
        return [render(forms, proofs, name) for name in FORMATS if what in (name, "all formats")]

    assert all(benchmark.pedantic(write, setup=fresh, rounds=3))


PROOF_STEPS = {
    "expand": lambda solution, frame: expand(exact_string(), solution.order),
    "moving_frame": lambda solution, frame: moving_frame(solution),
    "prove, the frame known": prove,
    "of which enclosures": lambda solution, frame: enclosures(solution),
    "of which tails": lambda solution, frame: wrong_tails(solution),
}


@pytest.mark.parametrize("step", PROOF_STEPS)
@pytest.mark.benchmark(group="a proof and what it proves, order 12")
def test_proof(benchmark, step):
    solution = expand(exact_string(), 12)
    benchmark.pedantic(
        PROOF_STEPS[step], (solution, moving_frame(solution)), rounds=3, warmup_rounds=0
    )


@pytest.mark.benchmark(group="numbers, order 20")
def test_floats(benchmark):
    solution = benchmark(lambda: expand(float_string(0.83, 20), 20))
    assert solution.order == 20


@pytest.mark.parametrize("name", [name for name in RIVALS if not name.startswith("textbook")])
@pytest.mark.benchmark(group=f"rings, order {HIGHEST_RIVAL_ORDER}")
def test_rings(benchmark, name):
    benchmark.extra_info["baseline"] = OURS
    result = benchmark.pedantic(RIVALS[name], (HIGHEST_RIVAL_ORDER,), rounds=1, warmup_rounds=0)
    assert largest_error(result, HIGHEST_RIVAL_ORDER) < 1e-9


def test_rivals_agree_with_ours():
    """The comparison is fair: every rival derives the same contact point."""
    for name, run in RIVALS.items():
        order = 1 if name.startswith("textbook") else 3
        assert largest_error(run(order), order) < 1e-12, name
