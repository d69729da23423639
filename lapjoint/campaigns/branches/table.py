"""The dataset of branches, in memory and as NetCDF.

Points lie along the dimension ``point``, branch after branch, each in the sequence of its curve; bifurcations along the
dimension ``bifurcation`` in the same way.  docs/branches.md lists the variables.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from lapjoint.answers.branches import BifurcationKind
from lapjoint.answers.steady_state import Outcome
from lapjoint.campaigns.branches.loci import loci_of
from lapjoint.campaigns.branches.search import Diagram
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.dataset import attributes_of, read_result
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.point import OUTCOME_CODES, Point

if TYPE_CHECKING:
    import xarray as xr

KINDS = get_args(BifurcationKind)
"""Names of bifurcations, in the sequence of their codes from 0."""
_YES_NO = {"flag_values": np.array([0, 1], dtype="i1"), "flag_meanings": "no yes"}
_BESIDE = 2
"""Number of points on either side of a graze that are tested for contacts: one lies just before the graze, and one just
beyond."""
_AT = 1e-9
"""Largest distance of two values of the parameter, divided by the range, that count as one: motions are solved to
1e-9."""
_NO_IMPULSE = 1e-3
"""Largest impulse at a first graze, divided by the largest impulse of the branch: just beyond the graze, contacts have
begun."""
Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
"""Dimensions, values and attributes of a variable, as xarray takes them."""


def branch_dataset(spec: BranchSpec, diagrams: Sequence[Diagram]) -> xr.Dataset:
    """The dataset of branches, from the results at each value of the second parameter, or from one result without
    it."""
    import xarray as xr

    stops = spec.problem.stops
    branches = [branch for diagram in diagrams for branch in diagram.branches]
    names = np.array(spec.problem.stop_names, dtype=object)
    coordinates: dict[str, Variable] = {"stop_name": (("stop",), names, {"long_name": "name of the stop"})}
    signs = np.array([stop.sign for stop in stops], dtype="i1")
    meanings = {"flag_values": np.array([-1, 1], dtype="i1"), "flag_meanings": "bottom top"}
    variables: dict[str, Variable] = {
        "stop_side": (("stop",), signs, {"long_name": "side of the stop", **meanings}),
        **_points(spec, branches),
        **_bifurcations(spec, branches),
        **_branches(branches),
        **_not_followed(spec, diagrams),
        **_not_covered(spec, diagrams),
        **_unknown(spec, diagrams),
    }
    if spec.also_over is not None:
        coordinates |= _second_axis(spec.also_over)
        variables |= _second(spec.also_over, diagrams, variables)
    return xr.Dataset(variables, coords=coordinates, attrs=_attributes(spec))


def read_branches(path: str | Path) -> xr.Dataset:
    """A dataset of branches, read into memory from a NetCDF file.

    `InputError` is raised if there is no such file, it holds no branches, it is damaged, or has another format version.
    """
    return read_result(path, BranchSpec.noun)


def _points(spec: BranchSpec, branches: Sequence[dict[str, Any]]) -> dict[str, Variable]:
    rows = [Point(**one) for branch in branches for one in branch["points"]]
    axis, stops = spec.axis, len(spec.problem.stops)
    values = np.array([value for branch in branches for value in branch["values"]])
    sentences = [outcome.value for outcome in Outcome]
    outcome = {
        "flag_values": np.array(list(OUTCOME_CODES.values()), dtype="i1"),
        "flag_meanings": " ".join(OUTCOME_CODES).lower(),
        "comment": " ".join(sentences),
    }

    def peaks(row: Point) -> list[float]:
        return [max((c[4] for c in row.contacts if c[0] == k), default=0.0) for k in range(stops)]

    def scalar(name: str, kind: str, units: str, text: str) -> Variable:
        column = np.array([getattr(row, name) for row in rows], dtype=kind)
        return ("point",), column, {"units": units, "long_name": text}

    leading = "the Floquet multiplier of largest modulus; of a conjugate pair, the one with positive imaginary part"
    stable = [abs(complex(row.multiplier_real, row.multiplier_imag)) < 1 for row in rows]
    text = "impulse of the stop over one excitation period; positive at the top, negative at the bottom"
    return {
        axis.name: (("point",), values, {"units": axis.units, "long_name": axis.path, "path": axis.path}),
        "branch": (
            ("point",),
            np.repeat(np.arange(len(branches), dtype="i4"), [len(branch["points"]) for branch in branches]),
            {"units": "1", "long_name": "number of the branch, from 0; the points of each lie in sequence along it"},
        ),
        "impulse": (("point", "stop"), _table([row.impulses for row in rows], stops), _with_units("N s", text)),
        "peak_force": (
            ("point", "stop"),
            _table([peaks(row) for row in rows], stops),
            _with_units("N", "largest force of the stop"),
        ),
        "outcome": (
            ("point",),
            np.array([OUTCOME_CODES[row.outcome] for row in rows], dtype="i1"),
            {"long_name": "what the motion is", **outcome},
        ),
        "stable": (
            ("point",),
            np.array(stable, dtype="i1"),
            {"long_name": "whether all Floquet multipliers lie within the unit circle", **_YES_NO},
        ),
        "symmetric": (
            ("point",),
            np.array([row.symmetric for row in rows], dtype="i1"),
            {"long_name": "whether half the motion's period mirrors it", **_YES_NO},
        ),
        "period_multiple": scalar("period_multiple", "i4", "1", "excitation periods after which the motion repeats"),
        "residual": scalar("residual", "f8", "1", "distance between start and end of the motion, relative to its size"),
        "multiplier_real": scalar("multiplier_real", "f8", "1", f"real part of {leading}"),
        "multiplier_imag": scalar("multiplier_imag", "f8", "1", f"imaginary part of {leading}"),
        "contact_count": (
            ("point",),
            np.array([len(row.contacts) for row in rows], dtype="i4"),
            _with_units("1", "number of contacts in a period of the motion"),
        ),
    }


def _bifurcations(spec: BranchSpec, branches: Sequence[dict[str, Any]]) -> dict[str, Variable]:
    rows = [one for branch in branches for one in branch["bifurcations"]]
    owner = [i for i, branch in enumerate(branches) for _ in branch["bifurcations"]]
    starts = np.cumsum([0, *(len(branch["points"]) for branch in branches)])
    stops = len(spec.problem.stops)

    def column(name: str, kind: Any, text: str, **attributes: Any) -> Variable:
        return ("bifurcation",), np.array([row[name] for row in rows], dtype=kind), {"long_name": text, **attributes}

    error = "estimate of the numerical error of bifurcation_value; infinite where none can be stated"
    return {
        "bifurcation_kind": (
            ("bifurcation",),
            np.array([KINDS.index(row["kind"]) for row in rows], dtype="i1"),
            {"long_name": "what the bifurcation is", **meanings_of(KINDS)},
        ),
        "bifurcation_value": column("value", "f8", f"{spec.axis.path} at the bifurcation", units=spec.axis.units),
        "bifurcation_error": column("error", "f8", error, units=spec.axis.units),
        "bifurcation_branch": (
            ("bifurcation",),
            np.array(owner, dtype="i4"),
            {"units": "1", "long_name": "number of its branch"},
        ),
        "bifurcation_point": (
            ("bifurcation",),
            np.array([starts[i] + row["index"] for i, row in zip(owner, rows, strict=True)], dtype="i4"),
            {"units": "1", "long_name": "index of the point that follows it, or lies at it"},
        ),
        "bifurcation_stop": column("stop", "i4", "stop that is grazed, from 0; -1 where none is", units="1"),
        "bifurcation_after": column(
            "after", object, "what the branch does at a graze: persists, folds, ends or is lost"
        ),
        "bifurcation_first": (
            ("bifurcation",),
            np.array([_is_first(branches[i], row) for i, row in zip(owner, rows, strict=True)], dtype="i1"),
            {"long_name": "whether it is a graze on one side of which no stop is touched", **_YES_NO},
        ),
        "bifurcation_impulse": (
            ("bifurcation", "stop"),
            _table([row["impulses"] or (np.nan,) * stops for row in rows], stops),
            _with_units("N s", "impulse of the stop over one excitation period"),
        ),
        "bifurcation_motion": (
            ("bifurcation",),
            np.array([_text_of(row["motion"]) for row in rows], dtype=object),
            {"long_name": "the motion there as JSON: the number, the section point, and half periods"},
        ),
        "bifurcation_arcs": (
            ("bifurcation",),
            np.array([_text_of(row["arcs"]) for row in rows], dtype=object),
            {"long_name": "the same by the finest resolution that was asked, for lapjoint confirm; or empty"},
        ),
    }


def meanings_of(names: Sequence[str]) -> dict[str, Any]:
    """The attributes ``flag_values`` and ``flag_meanings`` for codes from 0."""
    values = np.arange(len(names), dtype="i1")
    return {"flag_values": values, "flag_meanings": " ".join(name.replace(" ", "_") for name in names)}


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


def _branches(branches: Sequence[dict[str, Any]]) -> dict[str, Variable]:
    return {
        f"branch_{which}_end": (
            ("branch_number",),
            np.array([branch["ends"][i] for branch in branches], dtype=object),
            {"long_name": f"why the branch ends at its {which} point"},
        )
        for i, which in enumerate(("first", "last"))
    }


def _not_followed(spec: BranchSpec, diagrams: Sequence[Diagram]) -> dict[str, Variable]:
    """The motions and starts that the search found and did not follow."""
    dimensions = () if spec.also_over is None else (spec.also_over.name,)
    left = np.array([diagram.left_out for diagram in diagrams], dtype="i4")
    text = "number of motions whose branches were not followed, as the effort was spent"
    found: dict[str, Variable] = {
        "left_out": (dimensions, left if dimensions else left[0], {"units": "1", "long_name": text})
    }
    rows = [(i, reason) for i, diagram in enumerate(diagrams) for reason in diagram.failures]
    if rows:
        values, reasons = zip(*rows, strict=True)
        text = "why a start, or a motion that was found, could not be followed"
        found["failure_message"] = ("failure",), np.array(reasons, dtype=object), {"long_name": text}
        if spec.also_over is not None:
            at = np.array(spec.also_over.values)[list(values)]
            found["failure_also_over"] = ("failure",), at, _at_value(spec.also_over)
    return found


def _not_covered(spec: BranchSpec, diagrams: Sequence[Diagram]) -> dict[str, Variable]:
    """The parts of the range that no branch covers."""
    rows = [(i, *gap) for i, diagram in enumerate(diagrams) for gap in uncovered(spec, diagram.branches)]
    if not rows:
        return {}
    values, first, last, why = zip(*rows, strict=True)
    path, units = spec.axis.path, spec.axis.units
    variables: dict[str, Variable] = {
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
    return variables


def _unknown(spec: BranchSpec, diagrams: Sequence[Diagram]) -> dict[str, Variable]:
    """The counts of the random starts, and the probability that another start leads to an unknown branch."""
    if not spec.starts:
        return {}
    dimensions, rows = () if spec.also_over is None else (spec.also_over.name,), [one.reached for one in diagrams]

    def column(kind: str, text: str, values: Sequence[float | None]) -> Variable:
        known = np.array([np.nan if one is None else one for one in values], dtype=kind)
        return dimensions, known if dimensions else known[0], {"units": "1", "long_name": text}

    columns: dict[str, tuple[str, str, list[float | None]]] = {
        "starts_stable": ("i4", "number of random starts that led to a stable motion", [one.starts for one in rows]),
        "starts_branches": ("i4", "number of branches that these motions lie on", [one.branches for one in rows]),
        "starts_alone": (
            "i4",
            "number of those branches to which nothing leads but one start",
            [one.alone for one in rows],
        ),
        "unknown_probability": (
            "f8",
            "probability that another random start, if it leads to a stable motion, leads to an unknown branch; "
            "NaN where no start led to a stable motion",
            [one.probability for one in rows],
        ),
        "unknown_probability_bound": (
            "f8",
            "what that probability exceeds in about one search of twenty",
            [one.bound for one in rows],
        ),
    }
    return {name: column(*one) for name, one in columns.items()}


def _second_axis(axis: Axis) -> dict[str, Variable]:
    """The values of the second parameter, as a coordinate."""
    return {axis.name: ((axis.name,), np.array(axis.values), {**_at_value(axis), "path": axis.path})}


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
        "branch_also_over": (("branch_number",), at, _at_value(axis)),
        "bifurcation_also_over": (("bifurcation",), at[owner], _at_value(axis)),
        "bifurcation_locus": (("bifurcation",), loci.astype("i4"), {"units": "1", "long_name": text}),
    }


def _at_value(axis: Axis) -> dict[str, Any]:
    return {"units": axis.units, "long_name": axis.path}


def _table(rows: Sequence[Sequence[float]], width: int) -> Any:
    return np.array([tuple(row) for row in rows], dtype=float).reshape(len(rows), width)


def _with_units(units: str, text: str) -> dict[str, Any]:
    return {"units": units, "long_name": text}


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
    """The parts of the range that no branch covers.

    Parameters
    ----------
    spec : BranchSpec
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
