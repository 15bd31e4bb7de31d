"""FLINT's precision belongs to the process: threads, forks, nesting, and one place that sets it."""

from __future__ import annotations

import multiprocessing
import pickle
import re
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from flint import ctx

import asymptotics
from asymptotics.formulas.beam import generator_names, impedances
from asymptotics.rings.precision import MOST_BITS, PrecisionError, at_precision, doubled, until
from asymptotics.rings.ring import GeneratorRing
from asymptotics.values.certified import evaluate_certified


def test_the_precision_is_one_number_for_all_threads() -> None:
    """What makes the lock necessary."""
    seen = []
    with at_precision(77):
        thread = threading.Thread(target=lambda: seen.append(ctx.prec))
        thread.start()
        thread.join()
    assert seen == [77]


def test_threads_leave_it_as_it_was() -> None:
    """Four threads of different needs: 77 bits before and after, and the results of one thread."""
    jobs = [(f"pi/2 + 1e-{k}", "1e-60", 2, "-0.5", "0.25") for k in (3, 12, 30, 50)] * 6
    with at_precision(77):
        alone = [evaluate_certified(*job) for job in jobs[:4]]
    before, interval = ctx.prec, sys.getswitchinterval()
    ctx.prec = 77
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(lambda job: evaluate_certified(*job), jobs))
        assert ctx.prec == 77
    finally:
        ctx.prec = before
        sys.setswitchinterval(interval)
    for i, point in enumerate(together):
        assert point == alone[i % 4]
        assert point.contact.ball.str(40) == alone[i % 4].contact.ball.str(40)


def test_contexts_of_one_thread_nest_and_end_with_errors() -> None:
    before = ctx.prec
    with at_precision(200):
        with at_precision(300):
            assert ctx.prec == 300
        assert ctx.prec == 200
    with pytest.raises(ZeroDivisionError), at_precision(200):
        _ = 1 / 0
    assert ctx.prec == before


def _inside() -> None:
    with at_precision(90):
        pass


@pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(), reason="this system has no fork"
)
def test_a_child_forked_while_another_thread_is_inside_is_not_locked_out() -> None:
    inside, leave = threading.Event(), threading.Event()

    def hold() -> None:
        with at_precision(100):
            inside.set()
            leave.wait()

    holder = threading.Thread(target=hold)
    holder.start()
    try:
        inside.wait()
        child = multiprocessing.get_context("fork").Process(target=_inside)
        child.start()
        child.join(30)
        assert child.exitcode == 0
    finally:
        leave.set()
        holder.join()


def test_one_place_sets_it() -> None:
    folder = Path(asymptotics.__file__).parent
    setting = re.compile(
        r"(?<!mpmath\.)workprec|flint.*workdps|ctx\.(prec|dps) *=[^=]|ctx, *\"prec\""
    )
    setters = {
        path.name for path in folder.glob("**/*.py") if setting.search(path.read_text("utf-8"))
    }
    assert setters == {"precision.py"}


def test_the_doubling_ends() -> None:
    tried: list[int] = []

    def compute() -> int:
        tried.append(ctx.prec)
        return ctx.prec

    assert until(lambda bits: bits >= 500, compute, "a test", 100) == (800, 800)
    assert tried == [100, 200, 400, 800]
    with pytest.raises(PrecisionError, match=r"^a test needs more than 8192 bits") as caught:
        until(lambda bits: False, compute, "a test", 4096)
    assert caught.value.partial == MOST_BITS
    assert doubled(MOST_BITS - 1, "a test", None) == 2 * MOST_BITS - 2
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.partial) == (str(caught.value), MOST_BITS)


def test_what_cannot_be_enclosed_in_few_bits_is_tried_in_more() -> None:
    beta = 1e30
    point = impedances(beta, 2.2, 1)
    ring = GeneratorRing(generator_names(1))
    assert point.evaluate(ring["b"]) == pytest.approx(1 / beta, rel=2.0**-52)
