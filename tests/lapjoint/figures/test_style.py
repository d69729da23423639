"""Figures fit the page they are made for, in one style, without a window, and their files are reproducible."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from history_figures import assert_fits

from lapjoint import History, InputError
from lapjoint.errors import OutputError
from lapjoint.figures import new_axes, new_panels, plot_convergence, plot_motion, save
from lapjoint.figures.style import COLUMN_WIDTH


def test_a_long_key_is_wrapped() -> None:
    axes = new_axes(COLUMN_WIDTH, 3.0)
    for i in range(6):
        answers = {n: 1 + 10.0 ** (-i) / n**2 for n in (8, 16, 32)}
        plot_convergence(answers, axes, reference=1.0, label=f"states 6 to 9, mode {i + 1}")
    assert_fits(axes, COLUMN_WIDTH, 3.0)


@pytest.mark.parametrize("ending", ["png", "svg", pytest.param("pdf", marks=pytest.mark.thorough)])
def test_equal_figures_are_equal_files(history: History, tmp_path: Path, ending: str) -> None:
    one, other = tmp_path / f"one.{ending}", tmp_path / f"other.{ending}"
    for path in (one, other):
        save(plot_motion(history, samples=20), path)
    assert one.stat().st_size > 1000
    assert one.read_bytes() == other.read_bytes()


def test_a_figure_of_several_panels_is_saved_by_any_of_them(tmp_path: Path) -> None:
    panels = new_panels(1, 2, 3.4, 2.0)
    for name, axes in (("one.svg", panels[1]), ("all.svg", panels)):
        save(axes, tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "all.svg").read_bytes()


@pytest.mark.parametrize("name", ["motion.bmp", "motion", "no/such/directory/motion.png"])
def test_a_figure_that_cannot_be_saved_says_so(history: History, tmp_path: Path, name: str) -> None:
    with pytest.raises((InputError, OutputError), match="motion"):
        save(plot_motion(history, samples=20), tmp_path / name)


def test_the_style_leaves_other_figures_alone(history: History) -> None:
    before = dict(matplotlib.rcParams)
    plot_motion(history, new_axes(3.4, 2.5))
    assert dict(matplotlib.rcParams) == before


def test_drawing_opens_no_window() -> None:
    code = (
        "import sys; from lapjoint.figures import plot_convergence; plot_convergence({8: 1.1, 16: 1.02, 32: 1.0}); "
        "sys.exit('matplotlib.pyplot' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
