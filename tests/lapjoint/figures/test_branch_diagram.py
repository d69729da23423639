"""The diagram of branches: what is stable is solid, what is not is dashed, and each bifurcation has its mark."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from beams import unit_cantilever

from lapjoint import Axis, InputError, Stop
from lapjoint.campaigns.branches.search import Diagram
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.branches.table import branch_dataset
from lapjoint.campaigns.point import Point
from lapjoint.figures import plot_branches, plot_loci

VALUES = (1.0, 2.0, 3.0, 2.5, 2.0, 3.0, 4.0)
IMPULSES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
STABLE = (True, True, True, False, False, True, True)
CANTILEVER = unit_cantilever(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0, name="tip"))
BARE: dict[str, Any] = {"error": 1e-9, "stop": 0, "after": "", "impulses": (), "arcs": None}
"""What a bifurcation has besides its kind, its value and its place."""


def bifurcation(kind: str, value: float, index: int, **more: Any) -> dict[str, Any]:
    """A bifurcation before a point."""
    return BARE | {"kind": kind, "value": value, "index": index, "motion": [value, None, 2]} | more


def diagram(*folds: tuple[float, int]) -> Diagram:
    """A branch with folds at some values, each before a point."""
    points = [
        vars(Point("PERIODIC", 1, False, 0.0, 0.5 if stable else 1.5, 0.0, impulses=(impulse,)))
        for impulse, stable in zip(IMPULSES, STABLE, strict=True)
    ]
    found = [bifurcation("fold", value, i, stop=-1, impulses=(0.2,)) for value, i in folds]
    branch = {"values": VALUES, "points": points, "bifurcations": found, "ends": ("boundary", "boundary")}
    return Diagram([branch])


def dataset_of(*diagrams: Diagram, other: Stop | None = None, also: Axis | None = None) -> xr.Dataset:
    """Diagrams, one for each value of `also`, as a dataset; the joint may have another stop."""
    joint = CANTILEVER if other is None else CANTILEVER.replace(stops=(*CANTILEVER.stops, other))
    return branch_dataset(BranchSpec(joint, "base_motion.angular_frequency", 1.0, 4.0, also_over=also), [*diagrams])


BELOW = CANTILEVER.stops[0].model_copy(update={"side": "bottom", "name": "below"})


@pytest.fixture
def dataset() -> xr.Dataset:
    """A branch with two folds, written by hand."""
    return dataset_of(diagram((3.1, 3), (1.9, 5)))


@pytest.fixture
def in_two_parameters() -> xr.Dataset:
    """Branches with two folds at three gaps; at the last gap one fold is far away, and there is a flip."""
    also = Axis("stops.*.gap", (2e-3, 1e-3, 3e-3))
    last = diagram((1.2, 3), (1.95, 5), (3.5, 6))
    last.branches[0]["bifurcations"][2]["kind"] = "flip"
    return dataset_of(diagram((3.2, 3), (1.9, 5)), diagram((3.1, 3), (1.8, 5)), last, also=also)


def test_stable_parts_are_solid_and_unstable_ones_dashed(dataset: xr.Dataset) -> None:
    lines = [line for line in plot_branches(dataset).lines if line.get_marker() == "None" and len(line.get_xdata()) > 1]
    drawn = [(list(line.get_xdata()), line.is_dashed()) for line in lines]
    assert drawn[:3] == [([1.0, 2.0, 3.0, 3.1], False), ([3.1, 2.5, 2.0, 1.9], True), ([1.9, 3.0, 4.0], False)]


def lines_of(*found: dict[str, Any], stable: tuple[bool, ...] = STABLE) -> list[Any]:
    """What is drawn of a branch with some bifurcations: corners, and whether they are joined by dashes."""
    one = diagram()
    one.branches[0]["bifurcations"] = list(found)
    for point, holds in zip(one.branches[0]["points"], stable, strict=True):
        point["multiplier_real"] = 0.5 if holds else 1.5
    axes = plot_branches(dataset_of(one))
    lines = [line for line in axes.lines if line.get_marker() == "None" and len(line.get_xdata()) > 1]
    return [
        ([*zip(line.get_xdata(), np.round(line.get_ydata(), 12), strict=True)], line.is_dashed()) for line in lines[:-1]
    ]


def test_a_part_ends_at_its_bifurcation_at_the_impulse_there() -> None:
    first, second, third = lines_of(
        bifurcation("fold", 3.1, 3, impulses=(0.22,)),
        bifurcation("fold", 1.9, 5, impulses=(0.44,)),
    )
    assert first[0][-1] == second[0][0] == (3.1, 0.22)
    assert second[0][-1] == third[0][0] == (1.9, 0.44)


def test_where_the_impulse_is_not_known_a_part_ends_between_the_points_on_either_side() -> None:
    # As the square of the way from a fold, 0.1 and 0.6 of the number are 0.29 and 0.71 of the way; else as the way.
    first, second, _ = lines_of(bifurcation("fold", 3.1, 3), bifurcation("flip", 2.25, 5))
    share = np.sqrt(0.1) / (np.sqrt(0.1) + np.sqrt(0.6))
    assert first[0][-1] == second[0][0] == (3.1, pytest.approx(0.2 + 0.1 * share))
    assert second[0][-1] == (2.25, pytest.approx(0.425))


def test_at_a_graze_stability_changes_at_its_point() -> None:
    first, second = lines_of(bifurcation("grazing", 3.0, 2), stable=(True,) * 3 + (False,) * 4)
    assert [corner[0] for corner in first[0]] == [1.0, 2.0, 3.0]
    assert [corner[0] for corner in second[0]] == [3.0, 2.5, 2.0, 3.0, 4.0]
    assert (first[1], second[1]) == (False, True)


def test_between_two_bifurcations_that_undo_each_other_a_part_is_dashed() -> None:
    first, second, third = lines_of(bifurcation("flip", 1.25, 1), bifurcation("flip", 1.5, 1), stable=(True,) * 7)
    assert [corner[0] for corner in second[0]] == [1.25, 1.5]
    assert (first[1], second[1], third[1]) == (False, True, False)


def test_bifurcations_are_marked_with_their_names(dataset: xr.Dataset) -> None:
    axes = plot_branches(dataset)
    (marked,) = [line for line in axes.lines if line.get_label() == "fold"]
    assert marked.get_xdata().tolist() == [3.1, 1.9]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["tip", "unstable", "fold"]


def test_the_legend_tells_stops_by_colour_and_unstable_motions_by_dashes() -> None:
    one = diagram()
    for point in one.branches[0]["points"]:
        point["impulses"] = (*point["impulses"], -1.0)
    legend = plot_branches(dataset_of(one, other=BELOW)).get_legend()
    names = [text.get_text() for text in legend.get_texts()]
    dashed = dict(zip(names, [line.is_dashed() for line in legend.get_lines()], strict=True))
    assert dashed == {"tip": False, "below": False, "unstable": True}
    colours = [line.get_color() for line in legend.get_lines()]
    assert len(set(colours)) == len(colours)


def test_of_twins_that_rounding_tells_apart_the_first_is_marked() -> None:
    one = diagram((3.1, 3))
    for some in (*one.branches[0]["points"], *one.branches[0]["bifurcations"]):
        some["impulses"] = (*some["impulses"], -some["impulses"][0] * (1 + 1e-12))
    axes = plot_branches(dataset_of(one, other=BELOW))
    (marked,) = [line for line in axes.lines if line.get_label() == "fold"]
    assert marked.get_ydata().tolist() == [0.2]


def test_an_unknown_ordinate_is_refused(dataset: xr.Dataset) -> None:
    with pytest.raises(InputError, match="ordinate = 'speed': allowed: impulse, peak_force"):
        plot_branches(dataset, ordinate="speed")


def test_lines_join_bifurcations_where_one_goes_on(in_two_parameters: xr.Dataset) -> None:
    axes = plot_loci(in_two_parameters)
    drawn = [list(zip(line.get_xdata(), line.get_ydata(), strict=True)) for line in axes.lines]
    assert sorted(line for line in drawn if line) == [
        [(1e-3, 1.8), (2e-3, 1.9), (3e-3, 1.95)],
        [(1e-3, 3.1), (2e-3, 3.2)],
        [(3e-3, 1.2)],
        [(3e-3, 3.5)],
    ]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["fold", "flip"]
    assert axes.get_xlabel() == "gap (all stops) [m]"


def test_branches_of_one_problem_have_no_loci(dataset: xr.Dataset) -> None:
    with pytest.raises(InputError, match="of one problem, not of several values of a second parameter"):
        plot_loci(dataset)


def test_a_figure_without_loci_says_so_and_no_other(in_two_parameters: xr.Dataset) -> None:
    empty = dataset_of(diagram(), diagram(), also=Axis("stops.*.gap", (2e-3, 1e-3)))
    said = [[text.get_text() for text in plot_loci(one).texts] for one in (empty, in_two_parameters)]
    assert said == [["no bifurcation in this range"], []]
