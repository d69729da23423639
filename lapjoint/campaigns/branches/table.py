"""The dataset of branches, in memory and as NetCDF.

Points lie along the dimension ``point``, branch after branch, each in the sequence of its curve; bifurcations along the
dimension ``bifurcation`` in the same way.  docs/branches.md lists the variables.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from lapjoint.answers.branches import BifurcationKind
from lapjoint.answers.series import stop_coordinates
from lapjoint.answers.steady_state import Outcome
from lapjoint.campaigns.branches.loci import loci_of
from lapjoint.campaigns.branches.search import Diagram
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.dataset import (
    IMPULSE,
    OUTCOME_FLAGS,
    RESIDUAL,
    YES_NO,
    Column,
    Variable,
    attributes_of,
    axis_coordinate,
    read_result,
    stop_sides,
    tabulated,
)
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.point import OUTCOME_CODES, Point, point_from
from lapjoint.files.flags import flags

if TYPE_CHECKING:
    import xarray as xr

KINDS = get_args(BifurcationKind)
"""Names of bifurcations, in the sequence of their codes from 0."""
KIND_FLAGS = flags(name.replace(" ", "_") for name in KINDS)
"""Attributes of a variable of kinds of bifurcations."""
_BESIDE = 2
"""Number of points on either side of a graze that are tested for contacts: one lies just before the graze, and one just
beyond."""
_AT = 1e-9
"""Largest distance of two values of the parameter, divided by the range, that count as one: motions are solved to
1e-9."""
_NO_IMPULSE = 1e-3
"""Largest impulse at a first graze, divided by the largest impulse of the branch: just beyond the graze, contacts have
begun."""
_LEADING = "the Floquet multiplier of largest modulus; of a conjugate pair, the one with positive imaginary part"
_OUTCOMES = {**OUTCOME_FLAGS, "comment": " ".join(outcome.value for outcome in Outcome)}
_LIKELY = (
    "probability that another random start, if it leads to a stable motion, leads to an unknown branch; NaN where no "
    "start led to a stable motion"
)


def _peak_forces(point: Point) -> list[float]:
    """The largest force of each stop, N."""
    stops, contacts = range(len(point.impulses)), point.contacts
    return [max((one.peak_force for one in contacts if one.stop == stop), default=0.0) for stop in stops]


def _is_stable(point: Point) -> bool:
    return abs(complex(point.multiplier_real, point.multiplier_imag)) < 1


_OF_POINTS = (
    IMPULSE,
    Column("peak_force", "f8", "N", "largest force of the stop", value=_peak_forces, of_stops=True),
    Column("outcome", "i1", "", "what the motion is", _OUTCOMES, value=lambda point: OUTCOME_CODES[point.outcome]),
    Column(
        "stable",
        "i1",
        "",
        "whether all Floquet multipliers lie within the unit circle",
        YES_NO,
        value=_is_stable,
    ),
    Column("symmetric", "i1", "", "whether half the motion's period mirrors it", YES_NO),
    Column("period_multiple", "i4", "1", "excitation periods after which the motion repeats"),
    RESIDUAL,
    Column("multiplier_real", "f8", "1", f"real part of {_LEADING}"),
    Column("multiplier_imag", "f8", "1", f"imaginary part of {_LEADING}"),
    Column(
        "contact_count",
        "i4",
        "1",
        "number of contacts in a period of the motion",
        value=lambda point: len(point.contacts),
    ),
)
"""Variables of each point, from a `Point`."""


@dataclass(frozen=True)
class _Bifurcation:
    """A bifurcation of one of the branches, and where it lies."""

    branch: int
    """Number of its branch."""
    point: int
    """Index of the point that follows it, or lies at it."""
    first: bool
    """Whether it is a graze on one side of which no stop is touched."""
    row: Mapping[str, Any]
    """The bifurcation, as `lapjoint.campaigns.branches.solve.solve_branch` gives it."""


def _column(name: str, kind: str, units: str, text: str, more: Mapping[str, Any] | None = None) -> Column:
    """A variable whose value is that of the row of a `_Bifurcation`."""
    return Column(name, kind, units, text, more or {}, value=lambda one: one.row[name], text_first=True)


_OF_BIFURCATIONS = (
    Column("branch", "i4", "1", "number of its branch"),
    Column("point", "i4", "1", "index of the point that follows it, or lies at it"),
    _column("stop", "i4", "1", "stop that is grazed, from 0; -1 where none is"),
    _column("after", "O", "", "what the branch does at a graze: persists, folds, ends or is lost"),
    Column("first", "i1", "", "whether it is a graze on one side of which no stop is touched", YES_NO),
    Column(
        "impulse",
        "f8",
        "N s",
        "impulse of the stop over one excitation period",
        value=lambda one: one.row["impulses"],
        of_stops=True,
    ),
    Column(
        "motion",
        "O",
        "",
        "the motion there as JSON: the number, the section point, and half periods",
        value=lambda one: _text_of(one.row["motion"]),
    ),
    Column(
        "arcs",
        "O",
        "",
        "the same by the finest resolution that was asked, for lapjoint confirm; or empty",
        value=lambda one: _text_of(one.row["arcs"]),
    ),
)
"""Variables of each bifurcation besides its kind, value and error."""
_OF_STARTS = (
    Column(
        "starts_stable", "i4", "1", "number of random starts that led to a stable motion", value=lambda it: it.starts
    ),
    Column("starts_branches", "i4", "1", "number of branches that these motions lie on", value=lambda it: it.branches),
    Column(
        "starts_alone",
        "i4",
        "1",
        "number of those branches to which nothing leads but one start",
        value=lambda it: it.alone,
    ),
    Column(
        "unknown_probability",
        "f8",
        "1",
        _LIKELY,
        value=lambda it: np.nan if it.probability is None else it.probability,
    ),
    Column(
        "unknown_probability_bound",
        "f8",
        "1",
        "what that probability exceeds in about one search of twenty",
        value=lambda it: it.bound,
    ),
)
"""Variables of the random starts, from a `Reached`."""


def branch_dataset(spec: BranchSpec, diagrams: Sequence[Diagram]) -> xr.Dataset:
    """The dataset of branches, from the results at each value of the second parameter, or from one result without
    it."""
    import xarray as xr

    branches = [branch for diagram in diagrams for branch in diagram.branches]
    coordinates = stop_coordinates(spec.problem)
    variables = {
        "stop_side": stop_sides(spec.problem),
        **_points(spec, branches),
        **_bifurcations(spec, branches),
        **_ends(branches),
        **_not_followed(spec, diagrams),
        **_not_covered(spec, diagrams),
    }
    if spec.starts:
        reached = [diagram.reached for diagram in diagrams]
        variables |= {column.name: _each(spec, column, column.values(reached)) for column in _OF_STARTS}
    if spec.also_over is not None:
        coordinates[spec.also_over.name] = axis_coordinate(spec.also_over)
        variables |= _second(spec.also_over, diagrams, variables)
    return xr.Dataset(variables, coords=coordinates, attrs=_attributes(spec))


def read_branches(path: str | Path) -> xr.Dataset:
    """Read a dataset of branches from a NetCDF file into memory; InputError is raised as `read_result` says."""
    return read_result(path, BranchSpec.noun)


def _points(spec: BranchSpec, branches: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    axis, rows = spec.axis, [point_from(one) for branch in branches for one in branch["points"]]
    value = Column(axis.name, "f8", axis.units, axis.path, {"path": axis.path})
    owner = Column("branch", "i4", "1", "number of the branch, from 0; the points of each lie in sequence along it")
    return {
        axis.name: value.of(("point",), [value for branch in branches for value in branch["values"]]),
        "branch": owner.of(("point",), [i for i, branch in enumerate(branches) for _ in branch["points"]]),
        **tabulated("point", _OF_POINTS, rows, len(spec.problem.stops)),
    }


def _bifurcations(spec: BranchSpec, branches: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    units, stops = spec.axis.units, len(spec.problem.stops)
    error = "estimate of the numerical error of bifurcation_value; infinite where none can be stated"
    columns = (
        Column("kind", "i1", "", "what the bifurcation is", KIND_FLAGS, value=lambda one: KINDS.index(one.row["kind"])),
        _column("value", "f8", units, f"{spec.axis.path} at the bifurcation"),
        _column("error", "f8", units, error),
        *_OF_BIFURCATIONS,
    )
    return tabulated("bifurcation", columns, list(_located(branches, stops)), stops, "bifurcation_")


def _located(branches: Sequence[Mapping[str, Any]], stops: int) -> Iterator[_Bifurcation]:
    """The bifurcations of all branches."""
    first = 0
    for i, branch in enumerate(branches):
        for row in branch["bifurcations"]:
            known = {**row, "impulses": row["impulses"] or (np.nan,) * stops}
            yield _Bifurcation(i, first + row["index"], _is_first(branch, row), known)
        first += len(branch["points"])


def _text_of(plain: Any) -> str:
    """Plain values as text that gives them back exactly."""
    return "" if plain is None else json.dumps(plain, separators=(",", ":"))


def _is_first(branch: Mapping[str, Any], row: Mapping[str, Any]) -> bool:
    """Whether a bifurcation is a graze on one side of which no stop is touched."""
    points, at = branch["points"], row["index"]
    beside = points[max(at - _BESIDE, 0) : at + _BESIDE]
    if row["kind"] != "grazing" or not any(not point["contacts"] for point in beside):
        return False
    largest = max((abs(impulse) for point in points for impulse in point["impulses"]), default=0.0)
    return max(map(abs, row["impulses"]), default=0.0) <= _NO_IMPULSE * largest


def _ends(branches: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    """Why each branch ends where it ends."""
    texts = {f"branch_{end}_end": f"why the branch ends at its {end} point" for end in ("first", "last")}
    return {
        name: Column(name, "O", "", text).of(("branch_number",), [branch["ends"][i] for branch in branches])
        for i, (name, text) in enumerate(texts.items())
    }


def _each(spec: BranchSpec, column: Column, values: Sequence[Any]) -> Variable:
    """A variable with a value at each value of the second parameter, or with one value without it."""
    return column.of((), values[0]) if spec.also_over is None else column.of((spec.also_over.name,), values)


def _listed(
    spec: BranchSpec, dimension: str, columns: Sequence[Column], rows: Sequence[tuple[Any, ...]]
) -> dict[str, Variable]:
    """The variables of some rows, if there are any.

    Each row has the number of its value of the second parameter, and then the values of the columns.
    """
    if not rows:
        return {}
    numbers, *values = zip(*rows, strict=True)
    found = {column.name: column.of((dimension,), own) for column, own in zip(columns, values, strict=True)}
    if spec.also_over is None:
        return found
    return found | _also_over(dimension, dimension, spec.also_over, np.array(spec.also_over.values)[list(numbers)])


def _also_over(prefix: str, dimension: str, axis: Axis, values: Any) -> dict[str, Variable]:
    """The variable of values of the second parameter along a dimension."""
    column = Column(f"{prefix}_also_over", "f8", axis.units, axis.path)
    return {column.name: column.of((dimension,), values)}


def _not_followed(spec: BranchSpec, diagrams: Sequence[Diagram]) -> dict[str, Variable]:
    """The motions and starts that the search found and did not follow."""
    left = Column("left_out", "i4", "1", "number of motions whose branches were not followed, as the effort was spent")
    why = Column("failure_message", "O", "", "why a start, or a motion that was found, could not be followed")
    rows = [(i, reason) for i, diagram in enumerate(diagrams) for reason in diagram.failures]
    return {
        "left_out": _each(spec, left, [diagram.left_out for diagram in diagrams]),
        **_listed(spec, "failure", [why], rows),
    }


def _not_covered(spec: BranchSpec, diagrams: Sequence[Diagram]) -> dict[str, Variable]:
    """The parts of the range that no branch covers."""
    path, units = spec.axis.path, spec.axis.units
    columns = [
        Column("uncovered_from", "f8", units, f"{path} where a part of the range begins that no branch covers"),
        Column("uncovered_to", "f8", units, f"{path} where it ends"),
        Column("uncovered_why", "O", "", "why branches end at its ends"),
    ]
    rows = [(i, *gap) for i, diagram in enumerate(diagrams) for gap in uncovered(spec, diagram.branches)]
    return _listed(spec, "uncovered", columns, rows)


def _second(axis: Axis, diagrams: Sequence[Diagram], known: Mapping[str, Variable]) -> dict[str, Variable]:
    """The value of the second parameter at each branch and each bifurcation, and the locus of each bifurcation."""
    at = np.repeat(np.array(axis.values), [len(diagram.branches) for diagram in diagrams])
    owner, point = known["bifurcation_branch"][1], known["bifurcation_point"][1]
    multiple = known["period_multiple"][1]
    at_point = np.minimum(point, multiple.size - 1)
    impulses = known["bifurcation_impulse"][1]
    named = (known[f"bifurcation_{name}"][1] for name in ("kind", "stop", "first"))
    columns = (*named, multiple[at_point], known["bifurcation_after"][1] == "ends")
    labels = list(zip(*(column.tolist() for column in columns), strict=True))
    largest = float(np.abs(np.nan_to_num(known["impulse"][1])).max(initial=0.0))
    loci = loci_of(axis.values, labels, at[owner], known["bifurcation_value"][1], impulses, largest)
    text = "number of the locus: bifurcations at neighbouring values of the second number that are one have the same"
    return {
        **_also_over("branch", "branch_number", axis, at),
        **_also_over("bifurcation", "bifurcation", axis, at[owner]),
        "bifurcation_locus": Column("", "i4", "1", text).of(("bifurcation",), loci),
    }


def _attributes(spec: BranchSpec) -> dict[str, Any]:
    identity = spec.identity
    return attributes_of(
        spec,
        f"Branches of: {spec.problem.title or 'a joint'}",
        result_of=spec.noun,
        problem=identity["problem"],
        path=identity["path"],
        range=identity["range"],
        max_period_multiple=spec.max_period_multiple,
        starts=spec.starts,
        seed=spec.seed,
        errors=int(spec.errors),
        max_points=spec.max_points,
        effort=spec.effort,
        **({} if spec.also_over is None else {"also_over": spec.also_over.path}),
        **({"from_grazes": 1} if spec.from_grazes else {}),
    )


def uncovered(spec: BranchSpec, branches: Sequence[Mapping[str, Any]]) -> list[tuple[float, float, str]]:
    """The parts of the range that no branch covers: where each begins and ends, in the SI unit of the parameter,
    ascending, and why branches end there."""
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
