"""The dataset of branches, and the parts of the range that no branch covers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from lapjoint.campaigns import branch_dataset as without_gaps
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.campaigns.branches.search import Diagram

if TYPE_CHECKING:
    import xarray as xr

_AT = 1e-9
"""Distance of two values of the parameter, over the range, up to which they are one: motions are solved to 1e-9."""


def branch_dataset(spec: BranchPlan, diagrams: Sequence[Diagram]) -> xr.Dataset:
    """The dataset of branches.

    Parameters
    ----------
    spec : BranchPlan
        What was looked for.
    diagrams : sequence of Diagram
        What was found at each value of the second parameter; one where there is none.

    Returns
    -------
    xarray.Dataset
        The dataset.
    """
    dataset = without_gaps.branch_dataset(spec, cast("Any", diagrams))
    rows = [(i, *gap) for i, diagram in enumerate(diagrams) for gap in uncovered(spec, diagram.branches)]
    if not rows:
        return dataset
    values, first, last, why = zip(*rows, strict=True)
    path, units = spec.axis.path, spec.axis.units
    variables: dict[str, Any] = {
        "uncovered_from": (
            ("uncovered",),
            np.array(first),
            {"units": units, "long_name": f"{path} where a part of the range begins that no branch covers"},
        ),
        "uncovered_to": (("uncovered",), np.array(last), {"units": units, "long_name": f"{path} where it ends"}),
        "uncovered_why": (
            ("uncovered",),
            np.array(why, dtype=object),
            {"long_name": "why branches end at its ends"},
        ),
    }
    if spec.also_over is not None:
        also = spec.also_over
        at = np.array(also.values)[list(values)]
        variables["uncovered_also_over"] = ("uncovered",), at, {"units": also.units, "long_name": also.path}
    return dataset.assign(variables)


def uncovered(spec: BranchPlan, branches: Sequence[Mapping[str, Any]]) -> list[tuple[float, float, str]]:
    """The parts of the range that no branch covers.

    Parameters
    ----------
    spec : BranchPlan
        What was looked for.
    branches : sequence of mapping
        The branches, as `lapjoint.campaigns.branches.solve.solve_branch` gives them.

    Returns
    -------
    list of tuple of float, float and str
        Where each begins and ends, in the SI unit of the parameter, ascending, and why branches end there.
    """
    low, high = spec.axis.values
    near = _AT * (high - low)
    covered = sorted((*_extent(branch), i) for i, branch in enumerate(branches))
    gaps, reached, last = list[tuple[float, float, str]](), low, list[str]()
    for first, to, i in covered:
        if first > reached + near:
            gaps.append((reached, first, "; ".join([*last, _end_of(branches[i], i, first)])))
        if to > reached - near:
            ends = [_end_of(branches[i], i, to)]
            last = ends if to > reached + near else [*last, *ends]
            reached = max(reached, to)
    if high > reached + near:
        gaps.append((reached, high, "; ".join(last)))
    return gaps


def _extent(branch: Mapping[str, Any]) -> tuple[float, float]:
    """The least and the largest value of the parameter on a branch, its bifurcations included."""
    values = [*branch["values"], *(one["motion"][0] for one in branch["bifurcations"])]
    return min(values), max(values)


def _end_of(branch: Mapping[str, Any], number: int, value: float) -> str:
    """Why a branch does not go on beyond the least or the largest value of the parameter on it."""
    ends = {float(branch["values"][i]): branch["ends"][i] for i in (0, -1)}
    grazes = {float(one["motion"][0]): one for one in branch["bifurcations"] if one["kind"] == "grazing"}
    if value in grazes and grazes[value]["after"] == "folds":
        return f"branch {number} folds at a graze"
    if value in ends:
        return f"branch {number}: {ends[value]}"
    return f"branch {number}: {grazes[value]['after'] if value in grazes else 'fold'}"
