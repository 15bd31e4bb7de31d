"""What exactness costs elsewhere: other rings through our engine, and the textbook route.

The other rings do less: polynomials in dependent cotangents have no unique form, hence no zero
test, and no proof. What the canonical form costs at low orders and saves at high ones is the point.

``python -m tests.benchmarks.rivals`` prints, for each order, the time of every rival over the time
of ropewave's ring on the same machine in the same run. Every rival's contact point is compared with
double precision at one frequency before its time counts.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

import flint
from sympy.core.cache import clear_cache
from sympy.external.gmpy import GROUND_TYPES

from asymptotics import Expansion, exact_string, expand, float_string, string_problem
from asymptotics.rings import cotangent

OMEGA = 0.83
OURS = "ropewave: one cotangent, python-flint"


def ropewave(order: int) -> Expansion[Any]:
    return expand(exact_string(), order)


def sympy_expressions(order: int) -> Expansion[Any]:
    from tests.benchmarks.rings import SympyRing

    ring = SympyRing(order)
    return expand(string_problem(ring, ring.omega, ring.cot), order)


def symengine_expressions(order: int) -> Expansion[Any]:
    from tests.benchmarks.rings import SymengineRing

    ring = SymengineRing(order)
    return expand(string_problem(ring, ring.omega, ring.cot), order)


def sympy_polynomials(order: int) -> Expansion[Any]:
    from tests.benchmarks.rings import PolynomialRing

    ring = PolynomialRing(order)
    return expand(string_problem(ring, ring.omega, ring.cot), order)


def textbook_route(order: int) -> tuple[Any, dict[tuple[int, int], Any]]:
    from tests.benchmarks.textbook import textbook

    return textbook(order)


RIVALS: dict[str, Callable[[int], Any]] = {
    OURS: ropewave,
    "same engine, sympy.polys.rings": sympy_polynomials,
    "same engine, SymEngine": symengine_expressions,
    "same engine, SymPy expressions": sympy_expressions,
    "textbook route, plain SymPy": textbook_route,
}


def evaluate_cotangent(element: cotangent.CotangentElement, omega: float) -> float:
    """An element of ropewave's ring at Ω, in 200-bit arithmetic because its powers cancel."""
    with flint.ctx.workprec(200):
        c, x = flint.arb(omega).cot(), flint.arb(omega)
        total = flint.arb(0)
        for (a, i), coefficient in element.numerator.terms():
            total += int(coefficient) * x ** int(a) * c ** int(i)
        for q, power in enumerate(element.poles, start=2):
            total /= cotangent.resonance_polynomial(q)(c) ** power
        return float(total / element.denominator)


def largest_error(result: Any, order: int) -> float:
    """max |ξ's coefficients − those in double precision|, relative to the largest of each order."""
    reference = expand(float_string(OMEGA, order), order)
    values = [OMEGA, *(1 / math.tan(j * OMEGA) for j in range(1, order + 1))]
    worst = 0.0
    for n in range(1, order + 1):
        wanted = reference.contact(n)
        scale = max(abs(value) for value in wanted.values())
        for j, value in wanted.items():
            if isinstance(result, tuple):
                omega, contact = result
                found = float(contact[n, j].subs(omega, OMEGA)) * math.sin(OMEGA) ** n
                found /= 1 if j == 0 else 2
            elif isinstance(result.problem.ring, cotangent.CotangentRing):
                found = evaluate_cotangent(result.contact(n)[j], OMEGA)
            else:
                found = result.problem.ring.evaluate(result.contact(n)[j], values)
            worst = max(worst, abs(found - value) / scale)
    return worst


def _forget() -> None:
    """Empty SymPy's cache and ours: a repeated run must not look anything up."""
    clear_cache()
    for function in vars(cotangent).values():
        if hasattr(function, "cache_clear"):
            function.cache_clear()


def _work(name: str, order: int, channel: Connection) -> None:
    run = RIVALS[name]
    run(1)  # imports do not count
    seconds = math.inf
    for _ in range(7):
        _forget()
        begin = time.process_time()
        result = run(order)
        seconds = min(seconds, time.process_time() - begin)
        if seconds > 0.5:
            break
    channel.send((seconds, largest_error(result, order)))


def measure(name: str, order: int, limit: float) -> tuple[float, float] | None:
    """(seconds, error) of one rival at one order in a process of its own; None at the limit.

    Seconds of processor time, the best of up to seven runs, each with empty caches, so that what
    else the machine does is left out.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(name, order, sender), daemon=True)
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(limit) else None
    except EOFError:
        raise RuntimeError(f"{name}: order {order} failed; its traceback is above") from None
    finally:
        process.kill()
        process.join()


def table(orders: range, limit: float, report: Callable[[str], None] = print) -> None:
    """Print times and ratios; a rival that reaches the limit is not asked for higher orders."""
    alive = list(RIVALS)
    report(f"exact ground types of SymPy: {GROUND_TYPES}")
    report(f"time limit {limit:g} s a run; ratio = time over {OURS!r} at the same order")
    for order in orders:
        ours = math.nan
        for name in list(alive):
            outcome = measure(name, order, limit)
            if outcome is None:
                alive.remove(name)
                text = f"more than {limit:g} s: ratio above {limit / ours:,.0f}"
            else:
                seconds, error = outcome
                if error > 1e-9:  # far above the rounding of raw cotangents at these orders
                    raise AssertionError(f"{name}, order {order}: off by {error:.1e}")
                ours = seconds if name == OURS else ours
                text = f"{seconds * 1e3:12.2f} ms   ratio {seconds / ours:10.1f}   off {error:.0e}"
            report(f"order {order:2d}  {name:40s} {text}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--min-order", type=int, default=2)
    parser.add_argument("--max-order", type=int, default=6)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds a run")
    arguments = parser.parse_args()
    table(range(arguments.min_order, arguments.max_order + 1), arguments.limit)
