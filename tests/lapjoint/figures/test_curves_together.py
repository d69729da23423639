"""Several sweeps in one figure: all of them named, on a common axis and in a common unit; limits on both sides."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from made_sweeps import made_sweep
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from lapjoint.errors import InputError
from lapjoint.figures import plot_curve, plot_curve_wide, plot_curves, plot_curves_wide
from lapjoint.figures.style import each_axes, figure_of

X = np.linspace(10.0, 20.0, 21)
UP = made_sweep(X, [-X, np.where(X < 17, X, 3.0)], [1] * 21)
DOWN = made_sweep(X[::2][::-1], [-X[::2][::-1], X[::2][::-1]], [1] * 8 + [0] * 3)
BOTH = {"up": UP, "down": DOWN}
ONE_STOP = {"up": made_sweep(X, [X]), "down": made_sweep(X, [2 * X])}


def legend(axes: Axes) -> dict[str, tuple[str, str]]:
    """Colours and line patterns by the names in the legend."""
    found = axes.get_legend()
    assert found is not None
    handles = [handle for handle in found.legend_handles if handle is not None]
    return {
        text.get_text(): (handle.get_color(), handle.get_linestyle())  # type: ignore[attr-defined]
        for text, handle in zip(found.get_texts(), handles, strict=True)
    }


def test_colours_are_of_stops_and_patterns_of_sweeps() -> None:
    names = legend(plot_curves(BOTH))
    assert list(names) == ["pad", "wall", "up", "down", "does not repeat"]
    assert names["pad"][0] != names["wall"][0]
    assert names["up"][1] != names["down"][1]
    assert names["up"][0] == names["down"][0]


def test_with_one_curve_each_the_sweeps_have_colours_too() -> None:
    names = legend(plot_curves(ONE_STOP))
    assert list(names) == ["up", "down"]
    assert names["up"][0] != names["down"][0]
    assert names["up"][1] != names["down"][1]


def test_every_point_of_every_sweep_is_drawn() -> None:
    axes = plot_curves(BOTH)
    drawn = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines if line.get_linestyle() != "None"]
    points = np.concatenate([y for y in drawn if y.size])
    for dataset in BOTH.values():
        assert np.isin(dataset.impulse.values.ravel(), points).all()


@pytest.mark.parametrize(
    ("together", "reason"),
    [
        ({"up": UP, "gaps": made_sweep(X * 1e-3, [X], path="stops.*.gap")}, "gaps: is over gap"),
        ({"up": UP, "stress": UP, "none": made_sweep(X, [X])}, None),
    ],
)
def test_what_does_not_fit_is_refused_by_name(together: dict[str, xr.Dataset], reason: str | None) -> None:
    if reason is None:
        assert plot_curves(together) is not None
        return
    for draw in (plot_curves, plot_curves_wide):
        with pytest.raises(InputError, match=reason):
            draw(together)


def test_a_sweep_without_the_variable_is_named() -> None:
    more = ONE_STOP["up"].assign(force_peak=ONE_STOP["up"].impulse.assign_attrs(units="N"))
    with pytest.raises(InputError, match=r"^down: variable 'force_peak': is not in this file"):
        plot_curves({"up": more, "down": ONE_STOP["down"]}, variable="force_peak")


def test_a_limit_is_drawn_on_the_sides_that_have_values_in_the_unit_of_the_axis() -> None:
    def heights(axes: Axes) -> list[float]:
        lines = [line for line in axes.lines if "limit" in str(line.get_label())]
        named = [float(np.asarray(line.get_ydata())[0]) for line in lines]
        pattern = lines[0].get_linestyle(), lines[0].get_color(), lines[0].get_linewidth()
        return named + [
            float(np.asarray(line.get_ydata())[0])
            for line in axes.lines
            if line not in lines and (line.get_linestyle(), line.get_color(), line.get_linewidth()) == pattern
        ]

    assert sorted(heights(plot_curves(BOTH, limits=[15.0]))) == [-15.0, 15.0]
    assert heights(plot_curves(ONE_STOP, limits=[15.0])) == [15.0]
    assert "limit 15 N s" in legend(plot_curve(UP, limits=[15.0]))
    forces = {
        name: one.assign(force_peak=(one.impulse * 1e6).assign_attrs(units="N")) for name, one in ONE_STOP.items()
    }
    axes = plot_curves(forces, variable="force_peak", limits=[15e6])
    assert "[MN]" in axes.get_ylabel()
    assert heights(axes) == [15.0]
    assert plot_curve_wide(UP, limits=[15.0])[0].get_title(loc="left") == "pad; limit 15 N s"


def drawn(panels: Axes | tuple[Axes, ...]) -> list[Text]:
    """The titles, legends and labels of a figure, and the names of sweeps beside the strips of outcomes."""
    found: list[Text] = []
    for axes in each_axes(panels):
        found += [axes.xaxis.label, axes.yaxis.label, *axes.texts]
        of = axes.get_legend()
        found += [] if of is None else [of.get_title(), *of.get_texts()]
    if isinstance(panels, tuple):
        found += panels[-1].get_yticklabels()
    return found


@pytest.mark.parametrize("long", [False, True])
def test_no_text_of_the_page_wide_figures_overlaps_another_or_is_cut(long: bool) -> None:
    name = "a sweep upwards from a state of rest with a name that is far too long for a legend"
    sweeps = {f"{name} {key}": one for key, one in BOTH.items()} if long else BOTH
    for axes in (plot_curves(sweeps, limits=[15.0]), plot_curves_wide(sweeps, limits=[15.0])):
        figure = figure_of(axes)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        renderer = canvas.get_renderer()  # type: ignore[no-untyped-call]
        boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in drawn(axes) if text.get_text()]
        for said, box in boxes:
            assert box.x0 >= figure.bbox.x0 - 1, said
            assert box.x1 <= figure.bbox.x1 + 1, said
        for (one, a), (other, b) in combinations(boxes, 2):
            assert not a.padded(-2).overlaps(b.padded(-2)), (one, other)
