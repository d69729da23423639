"""The drawn curve of a branch: a line through its curve points and bifurcations, at which stability changes."""

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
    """The drawn curve of a branch: a polygon with corners."""

    x: FloatArray
    """The parameter at each corner, in its SI unit, shape ``(n,)``."""
    y: FloatArray
    """The ordinate of each stop at each corner, shape ``(n, stops)``."""
    stable: npt.NDArray[np.bool_]
    """Whether motions from one corner to the next are stable, shape ``(n - 1,)``."""


def curve_of(dataset: xr.Dataset, branch: int, values: FloatArray, heights: FloatArray) -> Curve:
    """The drawn curve of a branch, with a corner at each curve point and at each bifurcation.

    The ordinates are `values` at curve points, shape (points, stops), and `heights` at bifurcations.  Between two
    bifurcations without a curve point between them, motions are drawn as unstable.
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
        else:  # stability changes at the first of the two points if that is a graze, else at the second point
            grazes = any(at[j] == i - 1 and kinds[j] == _GRAZING for j in own.tolist())
            parts.append(bool(stable[i] if grazes else stable[i - 1]))
    return Curve(
        np.array([one for one, _ in corners]),
        np.array([one for _, one in corners]).reshape(-1, values.shape[1]),
        np.array(parts, dtype=bool),
    )


def heights_of(dataset: xr.Dataset, values: FloatArray, *, impulses: bool) -> FloatArray:
    """The ordinate of each stop at each bifurcation, (bifurcations, stops), from `values` at curve points.

    Most bifurcations have their own impulses.  Other ordinates are, for a graze, the values at its curve point, else
    interpolated between the curve points on either side.
    """
    heights = np.array([_beside(dataset, j, values) for j in range(dataset.sizes["bifurcation"])])
    heights = heights.reshape(-1, values.shape[1])
    if not impulses:
        return heights
    known = dataset.bifurcation_impulse.values
    return np.where(np.isfinite(known), known, heights)


def _beside(dataset: xr.Dataset, j: int, values: FloatArray) -> FloatArray:
    """Values at a bifurcation from the neighbouring curve points; at a fold the parameter is quadratic in the
    values."""
    x, branch = dataset[parameter_of(dataset)].values, dataset.branch.values
    i = min(int(dataset.bifurcation_point.values[j]), x.size - 1)
    kind = int(dataset.bifurcation_kind.values[j])
    if kind == _GRAZING or i == 0 or branch[i - 1] != branch[i]:
        return np.asarray(values[i])
    ways = np.abs(x[i - 1 : i + 1] - dataset.bifurcation_value.values[j])
    ways = np.sqrt(ways) if kind == _FOLD else ways
    share = ways[0] / (ways.sum() or 1.0)
    return np.asarray((1 - share) * values[i - 1] + share * values[i])
