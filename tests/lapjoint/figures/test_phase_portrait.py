"""Phase portraits and Poincare sections show the states of the history."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from written_history import OMEGA, at_rest

from lapjoint import BaseMotion, History
from lapjoint.figures import new_axes, plot_phase_portrait, plot_poincare_section
from lapjoint.figures.sampling import SMOOTH, smooth_times
from lapjoint.figures.style import figure_of
from lapjoint.problem import FloatArray

TONES = ((3e-3, 35.0), (6e-4, 220.0), (2e-4, 617.0))
"""Amplitudes, m, and angular frequencies, rad/s, of a beam that was plucked."""


@pytest.fixture
def driven(history: History) -> History:
    """Four periods of a base motion with the frequency of the swing, and a little more."""
    problem = history.problem.replace(base_motion=BaseMotion(amplitude=1e-3, angular_frequency=OMEGA))
    return replace(history, problem=problem, end=4.2)


def test_a_portrait_is_the_history_at_one_position(history: History) -> None:
    orbit = plot_phase_portrait(history, x=0.5, samples=301).lines[0]
    t = np.linspace(0.0, 1.0, 301)
    z, v = (set(np.asarray(values)) for values in orbit.get_data())
    assert set(1e3 * history.displacement(0.5, t)[0]) <= z
    assert set(history.velocity(0.5, t)[0]) <= v


def test_a_portrait_shows_the_stop_farthest_from_the_root(history: History) -> None:
    axes = plot_phase_portrait(history)
    assert axes.lines[0].get_label() == "x = 1 m"
    assert {line.get_xdata()[0] for line in axes.lines[2:]} == {1.0, -1.0}  # the gaps, mm
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("displacement z [mm]", "velocity z$_t$ [m/s]")


def test_the_orbit_is_marked_where_a_stop_is_closed_and_nowhere_else(history: History) -> None:
    axes = plot_phase_portrait(history)
    z, v = (np.asarray(values) for values in axes.lines[1].get_data())
    marked = np.isfinite(v)
    assert np.all(np.abs(z[marked]) >= 1.0 - 1e-12)
    assert np.all(np.abs(z[~marked]) <= 1.0 + 1e-12)
    assert {float(z[marked].max()), float(z[marked].min())} == {float(z.max()), float(z.min())}


def test_a_short_flight_between_two_contacts_is_not_marked(history: History) -> None:
    first, second = history.contacts
    near = replace(second, start=first.end + 1e-9)
    switches = np.array([first.start, first.end, near.start, near.end])
    axes = plot_phase_portrait(replace(history, contacts=(first, near), switch_times=switches), samples=100)
    assert np.isnan(np.asarray(axes.lines[1].get_ydata())).sum() >= 1
    flight = np.flatnonzero(np.isnan(np.asarray(axes.lines[1].get_ydata())))
    z = np.asarray(axes.lines[0].get_xdata())
    assert np.any(z[flight] == 1e3 * history.displacement(1.0, (first.end + near.start) / 2)[0])


def test_portraits_on_the_same_axes_differ_in_colour_and_line(history: History) -> None:
    axes = new_axes()
    for name in ("one", "other"):
        plot_phase_portrait(history, axes, label=name)
    orbits = [line for line in axes.lines if line.get_label() in ("one", "other")]
    assert len({(line.get_color(), line.get_linestyle()) for line in orbits}) == 2
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["one", "in contact", "other"]


def test_an_orbit_without_excitation_has_no_corners(history: History) -> None:
    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return np.outer(np.ones_like(x), sum(a * w**dt * np.sin(w * t + dt * math.pi / 2) for a, w in TONES))

    free = replace(at_rest(history), end=3.0, field=field)
    orbit = plot_phase_portrait(free, samples=300).lines[0]
    t = smooth_times(free, 1.0, np.linspace(0.0, 3.0, 300))
    assert len(orbit.get_xdata()) == t.size < 10_000
    size = np.ptp([1e3 * free.displacement(1.0, t)[0], free.velocity(1.0, t)[0]], axis=1)

    def states(share: float) -> FloatArray:
        times = t[:-1] + share * np.diff(t)
        return (np.array([1e3 * free.displacement(1.0, times)[0], free.velocity(1.0, times)[0]]).T / size).T

    start, chord = states(0.0), states(1.0) - states(0.0)
    for share in (0.25, 0.5, 0.75):
        across = (chord[0] * (states(share) - start)[1] - chord[1] * (states(share) - start)[0]) / np.hypot(*chord)
        assert np.max(np.abs(across)) < 2 * SMOOTH


def test_a_beam_at_rest_is_a_dot(history: History) -> None:
    axes = plot_phase_portrait(at_rest(history))
    orbit = axes.lines[0]
    assert orbit.get_marker() == "o"
    assert set(np.asarray(orbit.get_xdata())) == set(np.asarray(orbit.get_ydata())) == {0.0}
    figure_of(axes).draw_without_rendering()


def test_sections_lie_at_the_multiples_of_the_period(driven: History) -> None:
    z, v = plot_poincare_section(driven).lines[0].get_data()
    np.testing.assert_array_equal(z, 1e3 * driven.displacement(1.0, np.arange(5.0))[0])
    np.testing.assert_array_equal(v, driven.velocity(1.0, np.arange(5.0))[0])


def test_a_section_is_taken_at_the_phase_asked_for(driven: History) -> None:
    for phase in (math.pi / 2, -3 * math.pi / 2):
        z, _ = plot_poincare_section(driven, phase=phase).lines[0].get_data()
        np.testing.assert_allclose(z, [3.0] * 4, rtol=1e-12)  # the largest deflection, mm


@pytest.mark.parametrize(
    ("start", "end", "count"),
    [(0.9, 2.0 - 1e-13, "2 sections"), (1.0 + 1e-13, 4.0 - 1e-13, "3 sections"), (1.0 + 1e-13, 2.0, "1 section")],
)
def test_the_rounding_of_an_end_neither_loses_nor_doubles_a_section(
    driven: History, start: float, end: float, count: str
) -> None:
    line = plot_poincare_section(replace(driven, start=start, end=end, switch_times=np.zeros(0))).lines[0]
    assert len(line.get_xdata()) == int(count.split()[0])
    assert str(line.get_label()).endswith(f" {count}")


def test_points_apart_by_rounding_are_not_blown_up(driven: History) -> None:
    axes = plot_poincare_section(driven)
    assert np.ptp(axes.get_xlim()) >= 0.1 * 6.0  # of the orbit, -3 to 3 mm
