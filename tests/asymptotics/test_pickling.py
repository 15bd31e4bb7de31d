"""Pickles in a fresh process, and deep copies: expansions of every ring, frames, forms, errors."""

from __future__ import annotations

import copy
import inspect
import pickle
import random
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import Ordering, acb, arb, fmpq_mpoly_ctx, fmpq_poly, fmpz_mpoly_ctx, fmpz_poly

from asymptotics import (
    ClosedForms,
    Expansion,
    exact_string,
    expand,
    moving_frame,
    prove,
    string_problem,
)
from asymptotics import errors as all_errors
from asymptotics.errors import InputError, ResonanceError, RopewaveError
from asymptotics.expansion.proof import RefutedError
from asymptotics.formulas.beam import contact_amplitude, expand_symbolic, impedances
from asymptotics.formulas.linear_response import eliminate
from asymptotics.problems.beam import beam_problem, float_beam
from asymptotics.problems.damped import damped_string
from asymptotics.problems.enclosed import ball_damped_string, ball_string
from asymptotics.problems.forcing import forced_string, fourier_drive
from asymptotics.problems.forcing_generators import generator_string
from asymptotics.problems.generators import Generators, generator_rope
from asymptotics.problems.problem import Problem
from asymptotics.problems.string import float_string
from asymptotics.resonances.folds import fold
from asymptotics.resonances.singular_part import singular_part
from asymptotics.rings.bounded import Bounded
from asymptotics.rings.laurent import LaurentRing
from asymptotics.rings.numbers import balls, digits
from asymptotics.rings.precision import PrecisionError, at_precision
from asymptotics.rings.resonance_field import ResonanceField
from asymptotics.rings.ring import ComplexRing, FloatRing
from asymptotics.values.certified import contact_harmonics, evaluate_certified

ORDER = 3
DRIVE = fourier_drive([0.8, 1.3], {(1, 0): 1.0, (0, 1): 0.5}, {(1, 1): 0.3})
LAURENT = LaurentRing(1, 3, 4)


def ball_problems() -> list[Problem[Any]]:
    with at_precision(200):
        return [
            ball_string("pi/2 + 1e-9"),
            ball_damped_string("pi", "1e-9"),
            ball_damped_string("pi", "1e-9", drive={1: acb(1, 2) / 3}),
            beam_problem("0.01", "2.2", "clamped", balls()),
        ]


PROBLEMS: list[Problem[Any]] = [
    exact_string(),
    float_string(0.83, ORDER),
    forced_string(DRIVE, ORDER),
    damped_string(0.83, 0.1, drive={1: 0.5, 2: 0.25j}),
    float_beam(1e-8, 2.2, ORDER),
    beam_problem(np.array([0.01, 0.02]), 2.2),
    beam_problem("0.01", "2.2", "pinned", digits()),
    generator_string([1, 2], ORDER + 1),
    generator_rope(Generators(2, (1,), ORDER + 1, False)),
    expand_symbolic(ORDER + 1).problem,
    string_problem(LAURENT, LAURENT.omega, LAURENT.cot),
    *ball_problems(),
]


def same(a: Any, b: Any) -> bool:
    """Equality to the last bit, of balls too, through containers and objects."""
    if type(a) is not type(b):
        return False
    if isinstance(a, arb):
        return bool(
            a.mid().man_exp() == b.mid().man_exp() and a.rad().man_exp() == b.rad().man_exp()
        )
    if isinstance(a, acb):
        return same(a.real, b.real) and same(a.imag, b.imag)
    if isinstance(a, Bounded):
        return same(a.value, b.value) and same(a.error, b.error)
    if isinstance(a, np.ndarray):
        return bool(np.array_equal(a, b))
    if isinstance(a, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, Problem):
        return a.name == b.name
    if isinstance(a, ResonanceField):
        return (a.p, a.q) == (b.p, b.q)
    if is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return bool(a == b)


# In a process that has imported nothing yet: load, continue each expansion by an order, send back.
CHILD = """
import pickle, sys
loaded = pickle.load(sys.stdin.buffer)
from asymptotics import Expansion, expand
from asymptotics.rings.precision import at_precision
import mpmath
mpmath.mp.dps = 30
longer = []
for item in loaded:
    if isinstance(item, Expansion):
        with at_precision(200):
            longer.append(expand(item.problem, item.order + 1, start=item))
pickle.dump((loaded, longer), sys.stdout.buffer)
"""


def in_a_fresh_process(items: list[Any]) -> tuple[list[Any], list[Any]]:
    done = subprocess.run(
        [sys.executable, "-c", CHILD], input=pickle.dumps(items), capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    result: tuple[list[Any], list[Any]] = pickle.loads(done.stdout)
    return result


@pytest.fixture(scope="module")
def expansions() -> Iterator[list[Expansion[Any]]]:
    with mpmath.workdps(30), at_precision(200):
        yield [expand(problem, ORDER) for problem in PROBLEMS]


def test_expansions_over_every_ring_in_a_fresh_process(expansions: list[Expansion[Any]]) -> None:
    loaded, longer = in_a_fresh_process(expansions)
    for before, after, continued in zip(expansions, loaded, longer, strict=True):
        assert same(before, after), before.problem.name
        here = expand(before.problem, ORDER + 1, start=before)
        assert same(here, continued), before.problem.name


def test_expansions_deep_copy(expansions: list[Expansion[Any]]) -> None:
    for before in expansions:
        after = copy.deepcopy(before)
        assert same(before, after), before.problem.name
        longer = expand(after.problem, ORDER + 1, start=after)
        assert same(expand(before.problem, ORDER + 1, start=before), longer)


def test_balls_are_made_again_in_their_own_precision() -> None:
    """Ω of a problem at 200 bits is a ball of 200 bits, whatever the reader's precision."""
    problem = ball_problems()[0]
    data = pickle.dumps(problem)
    with at_precision(53):
        again = pickle.loads(data)
    with at_precision(200):
        assert same(again.mode(1), problem.mode(1))


@pytest.mark.slow
def test_frames_forms_and_results_in_a_fresh_process(expansions: list[Expansion[Any]]) -> None:
    exact = expansions[0]
    forms = ClosedForms(exact)
    point = impedances(1e-8, 2.2, 3)
    items: list[Any] = [
        *[moving_frame(expansion) for expansion in expansions],
        forms.contact(2),
        forms.profile(2),
        contact_harmonics("pi/2 + 1e-9", 3),
        evaluate_certified(0.83, 0.02, 3, -0.5, 0),
        singular_part(1, 3, 5),
        eliminate(),
        fold(1, 3, 0.01),
        prove(exact),
        DRIVE,
        FloatRing().one,
        ComplexRing().one,
    ]
    loaded, _ = in_a_fresh_process(items)
    for before, after in zip(items, loaded, strict=True):
        assert same(before, after), before
    again, _ = in_a_fresh_process([forms, point, digits()])
    assert again[0].contact(3) == forms.contact(3)
    assert same(again[0].frame, forms.frame)
    element = contact_amplitude(expand_symbolic(3), 3, 3)
    assert again[1].evaluate(element) == point.evaluate(element)
    assert again[2].exp(mpmath.mpf(1)) == digits().exp(mpmath.mpf(1))


def test_a_changed_problem_is_not_pickled_as_the_one_it_was() -> None:
    changed = replace(exact_string(), name="another")
    with pytest.raises((AttributeError, pickle.PicklingError), match="pickle"):
        pickle.dumps(changed)


def test_balls_come_back_bit_for_bit() -> None:
    """Also at a reader's precision of 10 bits, and again and again."""
    random.seed(1)
    for _ in range(2000):
        with at_precision(random.choice([20, 53, 128, 700])):
            x = arb(random.uniform(-1, 1)) * arb(2) ** random.randint(-2000, 2000)
            radius = arb(2) ** random.randint(-300, 300)
            ball = random.choice([x / 3, x.cos(), arb.pi() * x, arb(x, radius), arb(0, radius), x])
        with at_precision(10):
            again = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(ball))))
        assert same(ball, again)
    for text in ("nan", "inf"):
        assert str(pickle.loads(pickle.dumps(arb(text)))) == str(arb(text))


def test_polynomials_and_their_rings() -> None:
    for kind in (fmpq_mpoly_ctx, fmpz_mpoly_ctx):
        ring = kind.get(["x", "y"], Ordering.deglex)
        x, y = ring.gens()
        assert pickle.loads(pickle.dumps(ring)) is ring
        again = pickle.loads(pickle.dumps(3 * x * y + x**2 - 1))
        assert again == 3 * x * y + x**2 - 1
        assert again.context() is ring
    for poly in (fmpz_poly([1, 0, 3]), fmpq_poly([1, 0, 3]) / 7, fmpz_poly([])):
        assert pickle.loads(pickle.dumps(poly)) == poly
        assert copy.deepcopy(poly) == poly


def test_errors_cross_processes() -> None:
    errors: list[RopewaveError] = [
        ResonanceError("at a resonance", 1, 2),
        PrecisionError("too few", {"order": 2}),
        InputError("no"),
    ]
    with pytest.raises(RefutedError) as caught:
        prove(expand(replace(exact_string(), load=(exact_string().ring.zero,)), 2))
    errors.append(caught.value)
    kinds = [k for _, k in inspect.getmembers(all_errors, inspect.isclass) if k.__doc__]
    errors += [
        kind("words")
        for kind in kinds
        if issubclass(kind, RopewaveError) and kind is not ResonanceError
    ]
    for error in errors:
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert again.__dict__ == error.__dict__
