"""The bifurcation diagram: its dots are the samples of the file, each kind of motion with its own look."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from made_sweeps import joint
from matplotlib.axes import Axes

from lapjoint import FREQUENCY, Axis, InputError
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.figures import in_hertz, plot_bifurcation

N = 5
KINDS = (("PERIODIC", 1), ("PERIODIC", 2), ("APERIODIC", 0), ("UNDECIDED", 0), ("QUASIPERIODIC", 0), ("FAILED", 0))
X = tuple(range(10, 10 + len(KINDS)))


def sampled(*more: Axis, shift: float = 0.0, **plan: Any) -> xr.Dataset:
    """A sweep with one motion of each kind, whose k-th displacement is cell + k / 10 mm."""
    this = Plan(Grid(joint("pad"), (Axis(FREQUENCY, X), *more)), strobe=N, **plan)
    points = {}
    for cell in range(this.size):
        outcome, multiple = KINDS[cell * len(KINDS) // this.size]
        z = [1e-3 * (cell + k / 10 + shift) for k in range(multiple or N)]
        samples = {} if outcome == "FAILED" else {"displacement": z, "velocity": [-2.0 * value for value in z]}
        points[cell] = Point(outcome=outcome, period_multiple=multiple, impulses=(0.1,), strobe=samples)
    return sweep_dataset(this, points)


def dots(axes: Axes) -> list[tuple[list[float], list[float], Any]]:
    """The drawn dots: their places, and whether they are filled, pale or hollow."""
    return [
        (
            np.asarray(line.get_xdata()).tolist(),
            np.round(np.asarray(line.get_ydata(), dtype=float), 6).tolist(),
            "hollow" if line.get_markerfacecolor() == "none" else "pale" if line.get_alpha() else "filled",
        )
        for line in axes.lines
        if np.size(line.get_xdata())
    ]


def named(axes: Axes) -> list[str]:
    legend = axes.get_legend()
    assert legend is not None
    return [text.get_text() for text in legend.get_texts()]


def test_filled_dots_repeat_pale_dots_do_not_hollow_ones_are_undecided() -> None:
    axes = plot_bifurcation(sampled())
    tenths = [0.0, 0.1, 0.2, 0.3, 0.4]
    assert sorted(dots(axes), key=lambda one: one[2]) == [
        ([10, 11, 11], [0.0, 1.0, 1.1], "filled"),
        ([13] * 5, [3 + t for t in tenths], "hollow"),
        ([12] * 5 + [14] * 5, [2 + t for t in tenths] + [4 + t for t in tenths], "pale"),
    ]
    assert named(axes) == ["repeats", "does not repeat", "undecided"]
    assert axes.get_ylabel() == "displacement once a period [mm]"
    assert axes.get_xlabel() == "angular frequency ω [rad/s]"


def test_the_legend_names_only_what_is_there() -> None:
    assert named(plot_bifurcation(sampled().isel(angular_frequency=[0, 1]))) == ["repeats"]


def test_velocities_and_hertz() -> None:
    axes = plot_bifurcation(in_hertz(sampled().isel(angular_frequency=[0, 1])), variable="strobe_velocity")
    ((x, y, _),) = dots(axes)
    np.testing.assert_allclose(x, np.array([10, 11, 11]) / (2 * np.pi))
    np.testing.assert_allclose(y, [0.0, -2.0, -2.2])
    assert axes.get_ylabel() == "velocity once a period [mm/s]"


def test_starts_and_a_second_field() -> None:
    axes = plot_bifurcation(sampled(starts=2))
    assert sorted(dots(axes), key=lambda one: one[2])[0] == ([10, 10, 11, 11, 11, 11], [0, 1, 2, 2.1, 3, 3.1], "filled")
    axes = plot_bifurcation(sampled(Axis("stops.*.gap", (1e-3, 2e-3))))
    assert named(axes)[:2] == ["gap (all stops) = 0.001 m", "gap (all stops) = 0.002 m"]
    filled = [one for one in dots(axes) if one[2] == "filled"]
    assert filled == [([10, 11, 11], [0, 2, 2.1], "filled"), ([10, 11, 11], [1, 3, 3.1], "filled")]


def test_several_sweeps_have_their_names_and_colours() -> None:
    axes = plot_bifurcation({"up": sampled(), "down": sampled(shift=0.5)}, wide=True)
    assert named(axes) == ["up", "down", "repeats", "does not repeat", "undecided"]
    assert [one[1] for one in dots(axes) if one[2] == "filled"] == [[0.0, 1.0, 1.1], [0.5, 1.5, 1.6]]


def test_what_cannot_be_drawn_is_refused() -> None:
    without = sampled().drop_vars("strobe_displacement")
    with pytest.raises(InputError, match="has no strobe_displacement; --strobe 64 of a sweep stores samples"):
        plot_bifurcation(without)
    with pytest.raises(InputError, match="has no impulse; "):
        plot_bifurcation(sampled(), variable="impulse")
    other = sampled().rename(angular_frequency="gap")
    with pytest.raises(InputError, match=r"down: is over gap .*, and up over angular frequency ω"):
        plot_bifurcation({"up": sampled(), "down": other})
