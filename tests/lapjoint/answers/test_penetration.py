"""All that reads a stop's penetration from a motion takes the base into account where the stop is fixed in space."""

from __future__ import annotations

import numpy as np
import pytest
from beams import unit_cantilever

import analytic
from lapjoint import History, Stop
from lapjoint.figures import plot_motion, plot_phase_portrait
from lapjoint.scene.layout import Layout
from lapjoint.scene.sampled_motion import Motion
from lapjoint.summaries.collector import Collector
from lapjoint.summaries.quantities import selection

GAP, STIFFNESS = 8e-4, 60.0
STOPS = (
    Stop(x=1.0, side="top", gap=GAP, stiffness=STIFFNESS, fixed_to="space", name="wall"),
    Stop(x=1.0, side="bottom", gap=-GAP / 4, stiffness=STIFFNESS, name="jaw"),
)


@pytest.fixture(scope="module")
def moved() -> History:
    """A motion that hits a wall in space and a jaw that presses the straight beam."""
    return analytic.Solver(n_modes=10).simulate(unit_cantilever(*STOPS), 3.0, errors=False)


@pytest.fixture(scope="module")
def times(moved: History) -> np.ndarray:
    return np.linspace(moved.start, moved.end, 400)


def test_a_wall_in_space_is_met_by_the_displacement_and_that_of_the_base(moved: History, times: np.ndarray) -> None:
    z, y = moved.displacement(1.0, times)[0], moved.base(times)
    np.testing.assert_allclose(moved.penetration(times), [z + y - GAP, -z + GAP / 4], atol=1e-18)
    forces = [-STIFFNESS * np.maximum(z + y - GAP, 0.0), STIFFNESS * np.maximum(GAP / 4 - z, 0.0)]
    np.testing.assert_allclose(moved.contact_force(times), forces, atol=1e-18)
    for k in (0, 1):
        closed = np.array([k in moved.state_at(float(t)) for t in times])
        assert np.all(moved.penetration(times)[k][closed] > -1e-9)
        assert np.all(moved.penetration(times)[k][~closed] < 1e-9)


def test_summaries_take_the_same_forces_and_the_speed_of_approach(moved: History, times: np.ndarray) -> None:
    what = selection(moved.problem)
    np.testing.assert_allclose(what.values(moved, times)[1], moved.contact_force(times), atol=1e-18)
    sums = Collector(what, 0.0, moved.end, 1, 100.0)
    sums.take(moved)
    largest = sums.finish().largest[0, :, 3]
    for k, sign in enumerate((1, -1)):
        starts = np.array([c.start for c in moved.contacts if c.stop == k and not c.open_end and not c.open_start])
        speed = sign * (moved.velocity(1.0, starts)[0] + (moved.base(starts, 1) if k == 0 else 0.0))
        assert largest[k] == pytest.approx(speed.max(), rel=1e-9)


def test_the_face_of_a_wall_in_space_is_drawn_where_it_is_seen_from_the_base(moved: History, times: np.ndarray) -> None:
    sample = Motion(moved).sample(Layout(moved.problem), times)
    faces = np.stack([GAP - moved.base(times), np.full(times.size, GAP / 4)], axis=1)
    opened = sample.closed == 0
    np.testing.assert_allclose(sample.faces[opened], faces[opened], atol=1e-18)
    axes = plot_motion(moved, samples=200)
    (face,) = (line for line in axes.lines if line.get_label() == "_face")
    t = np.asarray(face.get_xdata())
    np.testing.assert_allclose(face.get_ydata(), 1e3 * (GAP - moved.base(t)), atol=1e-15)
    still = [line for line in plot_phase_portrait(moved).lines if len(np.asarray(line.get_xdata())) == 2]
    assert [float(line.get_xdata()[0]) for line in still] == [1e3 * GAP / 4]
