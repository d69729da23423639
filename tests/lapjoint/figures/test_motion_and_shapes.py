"""Figures of motions and mode shapes show the numbers of the answers they are given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from beams import UNIT
from written_history import at_rest

import analytic
from lapjoint import FREE, ContactState, History, Problem, Stop, contact_states, paper_joint
from lapjoint.answers import Modes
from lapjoint.figures import new_panels, plot_mode_shapes, plot_motion, plot_state_shapes
from lapjoint.figures.mode_shapes import state_groups

JOINT = paper_joint(k_star=5000.0)


@pytest.fixture(scope="module")
def modes_of_all_states() -> list[Modes]:
    return [analytic.Solver().modes(JOINT, state, 4) for state in contact_states(JOINT)]


def test_motion_is_drawn_in_millimetres_where_the_stops_are(history: History) -> None:
    axes = plot_motion(history, samples=101)
    times, drawn = axes.lines[0].get_data()
    exact = 1e3 * history.displacement(1.0, np.asarray(times))[0]
    np.testing.assert_array_equal(drawn, exact)
    assert set(history.switch_times) <= set(np.asarray(times))
    assert {line.get_ydata()[0] for line in axes.lines[1:]} == {1.0, -1.0}  # the gaps, mm
    assert axes.get_ylabel() == "displacement z [mm]"


def test_motion_is_drawn_where_it_is_asked_for(history: History) -> None:
    axes = plot_motion(history, x=[0.25, 1.0], samples=50)
    for line, x in zip(axes.lines, (0.25, 1.0), strict=False):
        assert line.get_label() == f"x = {x:g} m"
        np.testing.assert_array_equal(line.get_ydata(), 1e3 * history.displacement(x, np.asarray(line.get_xdata()))[0])
    assert plot_motion(history, x=0.5).lines[0].get_label() == "x = 0.5 m"


def test_without_stops_the_tip_is_drawn(history: History) -> None:
    axes = plot_motion(replace(at_rest(history), field=history.field), samples=10)
    assert [line.get_label() for line in axes.lines] == ["x = 1 m"]
    assert not axes.collections


def test_each_stop_has_a_strip_with_its_contacts(history: History) -> None:
    axes = plot_motion(history)
    strips = [bars for bars in axes.collections if str(bars.get_label()).startswith("_contacts")]
    extents = [np.ptp(path.vertices[:, 0]) for strip in strips for path in strip.get_paths()]
    # Matplotlib adds start and duration in double precision: an ulp of a second.
    np.testing.assert_allclose(extents, [contact.duration for contact in history.contacts], rtol=1e-14)


def test_the_curve_is_shaded_down_to_the_gap_while_in_contact(history: History) -> None:
    shades = [shade for shade in plot_motion(history).collections if str(shade.get_label()).startswith("_shade")]
    assert [shade.get_label() for shade in shades] == ["_shade of above", "_shade of below"]
    for shade, contact, sign in zip(shades, history.contacts, (1, -1), strict=True):
        corners = np.concatenate([path.vertices for path in shade.get_paths()])
        assert (corners[:, 0].min(), corners[:, 0].max()) == (contact.start, contact.end)
        assert (sign * corners[:, 1]).min() == pytest.approx(1.0, abs=1e-12)


def test_mode_shapes_are_drawn_upwards(history: History) -> None:
    modes = Modes(FREE, np.array([5.0, 9.0]), lambda x, derivative=0: np.array([-(x**2), x**2 * (1 - 2 * x)]))
    axes = plot_mode_shapes(history.problem, modes)
    for line in axes.lines[1:3]:
        y = np.asarray(line.get_ydata())
        assert y[np.argmax(np.abs(y))] > 0


def test_the_nine_states_are_laid_out_as_in_table_4(modes_of_all_states: list[Modes]) -> None:
    panels = plot_state_shapes(JOINT, modes_of_all_states[::-1])
    titles = [panel.get_legend().get_title().get_text().split(":")[0] for panel in panels]
    assert titles == ["State 1", "States 2, 4", "States 3, 5", "States 6, 7, 8, 9"]
    closed = [{float(x) for line in panel.lines[4:] for x in line.get_xdata()} for panel in panels]
    assert closed == [set(), {2.5}, {1.25}, {1.25, 2.5}]


def test_each_panel_has_the_shapes_and_frequencies_of_its_states(modes_of_all_states: list[Modes]) -> None:
    panels = plot_state_shapes(JOINT, modes_of_all_states, count=2)
    for panel, group in zip(panels, state_groups(JOINT, modes_of_all_states), strict=True):
        for modes in group:
            for i, line in enumerate(panel.lines[1:3]):
                x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
                shape = modes.shapes(x)[i]
                # States that share their springs share their shapes, up to sign and the rounding of the roots.
                assert min(np.max(np.abs(y - shape)), np.max(np.abs(y + shape))) < 1e-9 * np.max(np.abs(shape))
                assert line.get_label() == f"{i + 1}: {modes.angular_frequencies[i]:.4g}"


def test_mirrored_states_share_frequencies_but_no_panel() -> None:
    stops = tuple(Stop(x=x, side="top", gap=1e-3, stiffness=1e3) for x in (0.0, 1.0))
    beam = Problem(beam=UNIT, stops=stops)
    left, right = (analytic.Solver().modes(beam, ContactState((i,)), 4) for i in (0, 1))
    np.testing.assert_allclose(left.angular_frequencies, right.angular_frequencies, rtol=1e-9, atol=1e-9)
    assert len(state_groups(beam, [left, right])) == 2


def test_states_are_drawn_on_the_panels_given(modes_of_all_states: list[Modes]) -> None:
    given = new_panels(2, 3, 7.0, 4.0)
    for panels in (given, np.reshape(given, (2, 3))):  # type: ignore[arg-type]
        assert plot_state_shapes(JOINT, modes_of_all_states, panels) == given[:4]
