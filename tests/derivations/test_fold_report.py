"""What ``ropewave fold`` shows: text, table and figure say what the fold is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asymptotics.errors import InputError
from asymptotics.folds import fold
from derivations.fold_report import coefficient_curve, fold_table, fold_text, plot_fold


def test_text_names_law_side_and_shift() -> None:
    first = fold_text(fold(1, 1, 0.01))
    assert "Omega_1/1 = 3.25000130 (pinned driven end, beta = 0.01)" in first
    assert "mu a = F eps + alpha a^3" in first
    assert "gamma" not in first
    assert "|mu|^(3/2), below the resonance" in first
    assert "string  eps = 0.125 |mu|^(2)" in first
    third = fold_text(fold(1, 3, 0.01))
    assert "(3mu - gamma eps^2) a = F eps^3 + alpha a^3" in third
    assert "below the shifted resonance" in third
    assert "in mu itself eps = 9.30826 |mu|^(1/2), above" in third
    assert "no power law in mu itself" in fold_text(fold(1, 4, 0.01))


def test_table_has_a_row_of_ten_columns_a_fold() -> None:
    table = fold_table([fold(1, 1, 0.01), fold(1, 2, 0.01, "clamped")])
    rows = [line for line in table.splitlines() if line.endswith(r"\\") and line[0].isdigit()]
    assert len(rows) == 2
    assert all(row.count("&") == 9 for row in rows)
    assert "1/2 & 0.01 & clamped" in rows[1]
    assert "3/4" in rows[1]
    assert table.count("{tabular}") == 2
    with pytest.raises(InputError, match="no folds"):
        fold_table([])


def test_figures_have_the_same_bytes_every_time(tmp_path: Path) -> None:
    result = fold(2, 1, 0.01)
    first, second = (tmp_path / f"{name}.svg" for name in "ab")
    plot_fold(result, first)
    plot_fold(result, second)
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 5_000


def test_a_file_name_that_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ends in .pdf, .png, .svg"):
        plot_fold(fold(1, 1, 0.01), tmp_path / "fold.bmp")


def test_the_curve_changes_side_where_alpha_does() -> None:
    """p = 2: α passes zero near β = 0.005 and a pole, Ω₃ = 2Ω₂, near β = 0.2."""
    beta = [1e-3, 1e-2, 1.0]
    values, sides = coefficient_curve(2, 1, beta)
    assert sides.tolist() == [-1, 1, -1]
    singles = [fold(2, 1, b).coefficient.value for b in beta]
    assert values == pytest.approx(singles, rel=1e-12)
    many, _ = coefficient_curve(1, 1, np.logspace(-6, 0, 200))
    assert many.shape == (200,)
    assert (many > 0).all()


def test_the_curve_refuses_bad_input() -> None:
    with pytest.raises(InputError, match="ask for 1/2"):
        coefficient_curve(2, 4, [0.01])
    with pytest.raises(InputError, match=r"beta = -1.0"):
        coefficient_curve(1, 1, [0.01, -1.0])
