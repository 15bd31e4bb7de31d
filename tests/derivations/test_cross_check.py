"""The figure of the cross-check: what is printed, what is drawn, the same bytes twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asymptotics.errors import InputError
from derivations.cross_check.data import Comparison, Errors
from derivations.cross_check.ladder import draw, main, table
from derivations.figures.plots import save_figure


def made_up(beta: float, orders: int) -> Comparison:
    """Errors that are ε^{N+1} exactly, above a floor of 1e-15."""
    epsilon = 10.0 ** (-np.arange(2, 13) / 2)
    error = np.array([epsilon ** (n + 1) for n in range(1, orders + 1)])
    errors = Errors(np.maximum(error, 1e-15), np.full(epsilon.size, 1e-15))
    top = np.full(orders, 0.05)
    return Comparison(1.0, beta, epsilon, top, 10.0, np.ones(orders + 1), errors, errors)


def test_slopes_windows_and_prefactors_of_exact_powers():
    found = made_up(0.0, 4)
    for n in found.orders:
        assert found.slope(found.contact, n) == pytest.approx(n + 1, abs=1e-12)
        assert found.prefactor(n) == pytest.approx(1, abs=1e-12)
        inside = found.epsilon[found.judged(found.contact, n)]
        assert inside.max() <= 0.05
        assert inside.min() ** (n + 1) > 1e-14
    # From 10^{-3/2} down to the end of the ladder, 10^{-6}.
    assert found.decades(found.contact, 1) == pytest.approx((4.5, 9.0))


def test_an_order_at_the_floor_is_said_so():
    found = made_up(0.0, 4)
    buried = Errors(found.contact.error, np.ones(found.epsilon.size))
    assert found.decades(buried, 1) == (0.0, 0.0)
    with pytest.raises(InputError, match="judged by 0 amplitudes"):
        found.slope(buried, 1)


def test_the_table_has_a_line_for_each_order_and_quantity():
    lines = table([made_up(0.0, 4), made_up(0.01, 3)]).splitlines()
    assert len(lines) == 1 + 2 * (4 + 3)
    assert "2.000" in lines[1]


@pytest.mark.slow
def test_the_figure_is_the_same_twice(tmp_path: Path):
    found = [made_up(0.0, 4), made_up(0.0, 4), made_up(0.01, 3)]
    for name in ("one.svg", "two.svg"):
        save_figure(draw(found, 0.01), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


def test_a_bad_file_name_is_refused_before_anything_is_computed():
    with pytest.raises(InputError, match=r"cannot draw 'figure\.gif'"):
        main(["--out", "figure.gif"])
