"""Figures show the numbers of the answers they are given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lapjoint import FREE, History, InputError, Modes
from lapjoint.figures import plot_mode_shapes, plot_motion, save


def test_motion_is_drawn_in_millimetres_where_the_stops_are(history: History) -> None:
    ax = plot_motion(history, samples=101)
    times, drawn = ax.lines[0].get_data()
    exact = 1e3 * history.displacement(1.0, np.asarray(times))[0]
    np.testing.assert_array_equal(drawn, exact)
    assert {line.get_ydata()[0] for line in ax.lines[1:]} == {1.0, -1.0}  # the gaps, mm


def test_each_stop_has_a_strip_with_its_contacts(history: History) -> None:
    ax = plot_motion(history)
    strips = [bars for bars in ax.collections if str(bars.get_label()).startswith("_contacts")]
    extents = [np.ptp(path.vertices[:, 0]) for strip in strips for path in strip.get_paths()]
    # Matplotlib adds start and duration in double precision: an ulp of a second.
    np.testing.assert_allclose(extents, [contact.duration for contact in history.contacts], rtol=1e-14)


def test_mode_shapes_are_drawn_upwards(history: History) -> None:
    modes = Modes(FREE, np.array([5.0, 9.0]), lambda x, derivative=0: np.array([-(x**2), x**2 * (1 - 2 * x)]))
    ax = plot_mode_shapes(history.problem, modes)
    for line in ax.lines[1:3]:
        y = np.asarray(line.get_ydata())
        assert y[np.argmax(np.abs(y))] > 0


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_is_saved_by_the_ending_of_its_name(history: History, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"motion.{ending}"
    save(plot_motion(history, samples=20), path)
    assert path.stat().st_size > 1000


@pytest.mark.parametrize("name", ["motion.bmp", "motion", "no/such/directory/motion.png"])
def test_a_figure_that_cannot_be_saved_says_so(history: History, tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="motion"):
        save(plot_motion(history, samples=20), tmp_path / name)
