"""Curves of impulses: lines end where the motion becomes another one, and what does not repeat is marked."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes

from lapjoint import FREQUENCY, Axis, paper_joint, sweep
from lapjoint.figures import plot_curve
from lapjoint.figures.impulse_curve import ERRATIC, draw_line, in_pieces
from lapjoint.figures.style import new_axes

X = np.linspace(0.0, 1.0, 41)
SMOOTH = np.sin(3 * X) + X**2


def drawn(axes: Axes) -> list[np.ndarray]:
    """Abscissas of every line or mark with points."""
    return [np.asarray(line.get_xdata()) for line in axes.lines if np.size(line.get_xdata())]


def lengths(y: np.ndarray, kinds: np.ndarray) -> list[int]:
    return [piece.stop - piece.start for piece in in_pieces(y, kinds)]


def test_a_smooth_curve_of_one_kind_is_one_line() -> None:
    assert lengths(SMOOTH, np.ones(41)) == [41]
    peak = 1 / (1 + ((X - 0.5) / 0.03) ** 2)  # a resonance of which few points lie on the slopes
    assert lengths(peak, np.ones(41)) == [41]


@pytest.mark.parametrize("at", [1, 17, 40])
def test_a_jump_parts_the_line(at: int) -> None:
    jumping = np.where(np.arange(41) < at, SMOOTH, SMOOTH + 1.0)
    assert lengths(jumping, np.ones(41)) == [at, 41 - at]


def test_another_kind_of_motion_parts_the_line() -> None:
    kinds = np.where(np.arange(41) < 20, 1.0, 2.0)
    assert lengths(SMOOTH, kinds) == [20, 21]


def test_missing_values_do_no_harm() -> None:
    y = SMOOTH.copy()
    y[[3, 4]] = np.nan
    assert sum(lengths(y, np.ones(41))) == 41


def test_what_does_not_repeat_is_marked_and_a_point_alone_is_seen() -> None:
    kinds = np.ones(41)
    kinds[10:20], kinds[30] = ERRATIC, 3.0
    axes = new_axes()
    draw_line(axes, X, SMOOTH, "C0", "-", "name", kinds)
    assert sorted(points.size for points in drawn(axes)) == [1, 10, 10, 10, 10, 10]
    alone = next(line for line in axes.lines if np.size(line.get_xdata()) == 1)
    assert alone.get_marker() == "."
    marks = [line for line in axes.lines if line.get_marker() == "o"]
    np.testing.assert_array_equal(marks[0].get_xdata(), X[10:20])


def test_the_curves_of_a_second_field_are_told_apart() -> None:
    axes_swept = [Axis(FREQUENCY, (400.0, 420.0)), Axis("stops.*.gap", (1e-3, 5e-3, 2e-2))]
    axes = plot_curve(sweep(paper_joint(), axes_swept, solver="analytic", options={"n_modes": 4}))
    assert axes.figure.legends or axes.get_legend() is not None
    labels = [str(line.get_label()) for line in axes.lines]
    assert {"0.001", "0.005", "0.02", "P2", "P5"} <= set(labels)
    shades = {line.get_alpha() for line in axes.lines if np.size(line.get_xdata()) == 2 and line.get_alpha()}
    assert len(shades) == 3
