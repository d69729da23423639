"""Figures of basins: every motion in a colour of its own, what is bound to none hatched, shares with intervals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from lapjoint.figures import plot_basins, save
from lapjoint.figures.basin_names import motion_names


def motions(multiples: list[int], impulses: list[list[float]], twins: list[int]) -> dict[str, object]:
    n = len(multiples)
    share = np.full(n, 1 / (n + 1))
    return {
        "period_multiple": ("motion", multiples),
        "impulse": (("motion", "stop"), impulses),
        "twin": ("motion", twins),
        "count": ("motion", np.full(n, 5)),
        "fraction": ("motion", share),
        "fraction_low": ("motion", share / 2),
        "fraction_high": ("motion", share * 1.2),
        "unbound_count": ("unbound", [0, 4]),
        "unbound_fraction": ("unbound", [0.0, 0.2]),
        "unbound_fraction_low": ("unbound", [0.0, 0.1]),
        "unbound_fraction_high": ("unbound", [0.1, 0.3]),
    }


THREE = motions([1, 3, 3], [[0.0, 0.0], [1.25, -0.5], [0.5, -1.25]], [-1, 2, 1])
NAMES = {"stop_name": ("stop", ["P2", "P3"]), "unbound": ["aperiodic", "undecided"]}


def plane(motion: np.ndarray, table: dict[str, object]) -> xr.Dataset:
    coords = {
        "first": ("first", np.linspace(-1, 1, motion.shape[0]), {"coordinate": "z(2.5)", "units": "m"}),
        "second": ("second", np.linspace(-2, 2, motion.shape[1]), {"coordinate": "v(1)", "units": "m s-1"}),
    }
    variables = {"motion": (("first", "second"), motion), **table}
    return xr.Dataset(variables, coords={**coords, **NAMES}, attrs={"title": "Basins of: a joint"})


def test_motions_are_named_by_period_multiple_and_impulse() -> None:
    found = motion_names(plane(np.zeros((2, 2), dtype=int), THREE))
    assert found == [
        "1: 1 period, no contact",
        "2: 3 periods, P2 1.25 N s",
        "3: 3 periods, P2 0.5 N s (mirror image of 2)",
    ]


def test_motions_whose_impulses_hardly_differ_are_named_by_more_digits() -> None:
    table = motions([1, 1], [[1900.123, 0.0], [1900.124, 0.0]], [-1, -1])
    found = motion_names(plane(np.zeros((2, 2), dtype=int), table))
    assert found == ["1: 1 period, P2 1900.123 N s", "2: 1 period, P2 1900.124 N s"]


@pytest.mark.parametrize("shape", [(7, 5), (1, 4), (3, 1)])
def test_a_plane_has_a_colour_for_each_motion_and_hatches_the_rest(shape: tuple[int, int], tmp_path: Path) -> None:
    motion = np.resize(np.array([0, 1, 2, -1]), shape)
    axes = plot_basins(plane(motion, THREE))
    legend = axes.get_legend()
    assert legend is not None
    shown = [text.get_text() for text in legend.get_texts()]
    assert shown[-1] == "undecided"
    assert len(shown) == 4
    patches = legend.get_patches()
    assert len({patch.get_facecolor() for patch in patches}) == 4
    assert patches[-1].get_hatch()
    assert axes.get_xlabel() == "start moved by z at x = 2.5 m [m]"
    assert axes.get_ylabel() == "start moved by v at x = 1 m [m/s]"
    save(axes, tmp_path / "plane.png")


def test_twenty_motions_have_twenty_colours() -> None:
    table = motions([1] * 20, [[float(i), 0.0] for i in range(20)], [-1] * 20)
    axes = plot_basins(plane(np.arange(20).reshape(4, 5), table))
    (mesh,) = (it for it in axes.collections if it.get_array() is not None and it.get_array().size == 20)
    assert len({tuple(colour) for colour in mesh.cmap(mesh.norm(mesh.get_array().ravel()))}) == 20


def test_random_starts_are_bars_with_intervals(tmp_path: Path) -> None:
    table = {"motion": ("start", [0, 1, 2, -1]), **THREE}
    axes = plot_basins(xr.Dataset(table, coords=NAMES, attrs={"title": "Basins of: a joint"}))
    assert [bar.get_width() for bar in axes.patches] == pytest.approx([0.25, 0.25, 0.25, 0.2])
    assert [text.get_text() for text in axes.get_yticklabels()][-1] == "undecided"
    save(axes, tmp_path / "bars.svg")
