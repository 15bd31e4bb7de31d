"""Figures do not depend on the settings of who draws them."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest

from asymptotics import expand, float_string, moving_frame
from derivations.app import main
from derivations.figures.plots import drawing, plot_period

# Each of these changed or broke a figure that took its settings from the user's matplotlibrc.
HOSTILE = {
    "text.usetex": True,
    "font.family": "cursive",
    "savefig.bbox": "tight",
    "savefig.transparent": True,
    "savefig.facecolor": "black",
    "figure.facecolor": "black",
    "axes.facecolor": "red",
    "axes.grid": True,
    "axes.unicode_minus": False,
    "axes.xmargin": 0.3,
    "axes.titleweight": "bold",
    "figure.constrained_layout.h_pad": 0.5,
    "legend.fontsize": 20,
    "lines.marker": "x",
    "path.simplify": False,
    "path.sketch": (2, 10, 2),
    "pdf.compression": 0,
    "svg.fonttype": "none",
    "svg.image_inline": False,
    "text.parse_math": False,
    "xtick.direction": "in",
    "ytick.labelsize": 20,
}
SIMULATE = ("simulate", "--omega", "2.5", "--epsilon", "0.05", "--ramp", "2", "--periods", "4",
            "--keep", "1", "--dx", "0.025")  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "option", "suffixes"),
    [
        (("evaluate", "--omega", "1.1", "--epsilon", "0.01"), "--plot", ("png", "pdf", "svg")),
        (("resonances",), "--plot", ("svg",)),
        (("tongue", "1/2"), "--plot", ("svg",)),
        (("fold", "1/1"), "--plot", ("svg",)),
        (SIMULATE, "--plot", ("svg",)),
        (SIMULATE, "--animate", ("gif",)),
    ],
)
def test_the_users_settings_do_not_matter(
    arguments: tuple[str, ...], option: str, suffixes: tuple[str, ...], tmp_path: Path
) -> None:
    for suffix in suffixes:
        drawn = []
        for name, settings in (("plain", {}), ("hostile", HOSTILE)):
            path = tmp_path / f"{name}.{suffix}"
            with matplotlib.rc_context(settings), pytest.raises(SystemExit) as end:  # type: ignore[arg-type]
                main([*arguments, option, str(path)])
            assert not end.value.code
            drawn.append(path.read_bytes())
        assert drawn[0] == drawn[1], suffix


def test_drawing_leaves_the_users_settings_as_they_were() -> None:
    with matplotlib.rc_context({"font.size": 23, "lines.linewidth": 7}):
        before = dict(matplotlib.rcParams)
        with drawing(font_size=8):
            assert matplotlib.rcParams["font.size"] == 8
            assert matplotlib.rcParams["lines.linewidth"] == 1.4
            assert matplotlib.rcParams["axes.spines.top"] is False
            assert matplotlib.rcParams["text.usetex"] is False
        assert dict(matplotlib.rcParams) == before


def test_drawing_tells_how_far_it_is(tmp_path: Path) -> None:
    told: list[int] = []
    plot_period(2.2, 0.01, 6, tmp_path / "rope.png", told.append)
    assert sorted(set(told) - {0}) == list(range(1, 13))


def test_more_digits_give_signs_of_life() -> None:
    """Far beyond its radius of convergence the frame needs the expansion anew, with more bits."""
    told: list[int] = []
    solution = expand(float_string(3.0, 20), 20)
    moving_frame(solution, told.append)
    assert told.count(0) % 20 == 0
    assert told.count(0) > 0
