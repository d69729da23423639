"""The curve of a branch through its curve points and bifurcations; stability changes at bifurcations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lapjoint.figures.branch_names import KIND_NAMES, parameter_of
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr

_FOLD, _GRAZING = KIND_NAMES.index("fold"), KIND_NAMES.index("grazing")


@dataclass(frozen=True)
class Curve:
    """A branch as it is drawn."""

    x: FloatArray
    """The parameter at each corner, in its SI unit, shape ``(n,)``."""
    y: FloatArray
    """The value drawn of each stop at each corner, shape ``(n, stops)``."""
    stable: npt.NDArray[np.bool_]
    """Whether motions from one corner to the next are stable, shape ``(n - 1,)``."""


def curve_of(dataset: xr.Dataset, branch: int, values: FloatArray, heights: FloatArray) -> Curve:
    """A branch with a corner at each curve point, `values` (points, stops), and at each bifurcation, `heights`.

    Between two bifurcations that lie between neighbouring curve points, motions are drawn as not stable.
    """
    x, stable = dataset[parameter_of(dataset)].values, dataset.stable.values == 1
    at, kinds = dataset.bifurcation_point.values, dataset.bifurcation_kind.values
    own = np.flatnonzero(dataset.bifurcation_branch.values == branch)
    points = np.flatnonzero(dataset.branch.values == branch)
    corners: list[tuple[float, FloatArray]] = [(x[i], values[i]) for i in points[:1]]
    parts: list[bool] = []
    for i in points[1:].tolist():
        between = [j for j in own.tolist() if at[j] == i and kinds[j] != _GRAZING]
        corners += [(dataset.bifurcation_value.values[j], heights[j]) for j in between]
        corners.append((x[i], values[i]))
        if between:
            parts += [bool(stable[i - 1]), *[False] * (len(between) - 1), bool(stable[i])]
        else:  # stability changes at a graze at the first of the two points, or else at the second point
            grazes = any(at[j] == i - 1 and kinds[j] == _GRAZING for j in own.tolist())
            parts.append(bool(stable[i] if grazes else stable[i - 1]))
    return Curve(
        np.array([one for one, _ in corners]),
        np.array([one for _, one in corners]).reshape(-1, values.shape[1]),
        np.array(parts, dtype=bool),
    )


def heights_of(dataset: xr.Dataset, values: FloatArray, *, impulses: bool) -> FloatArray:
    """The value to draw of each stop at each bifurcation, (bifurcations, stops), from `values` at curve points.

    Impulses are known at most bifurcations.  An unknown value is taken from the graze's curve point, or
    interpolated between the curve points on either side.
    """
    heights = np.array([_beside(dataset, j, values) for j in range(dataset.sizes["bifurcation"])])
    heights = heights.reshape(-1, values.shape[1])
    if not impulses:
        return heights
    known = dataset.bifurcation_impulse.values
    return np.where(np.isfinite(known), known, heights)


def _beside(dataset: xr.Dataset, j: int, values: FloatArray) -> FloatArray:
    """Values at a bifurcation from the curve points beside it; at a fold the parameter is quadratic in them."""
    x, branch = dataset[parameter_of(dataset)].values, dataset.branch.values
    i = min(int(dataset.bifurcation_point.values[j]), x.size - 1)
    kind = int(dataset.bifurcation_kind.values[j])
    if kind == _GRAZING or i == 0 or branch[i - 1] != branch[i]:
        return np.asarray(values[i])
    ways = np.abs(x[i - 1 : i + 1] - dataset.bifurcation_value.values[j])
    ways = np.sqrt(ways) if kind == _FOLD else ways
    share = ways[0] / (ways.sum() or 1.0)
    return np.asarray((1 - share) * values[i - 1] + share * values[i])
