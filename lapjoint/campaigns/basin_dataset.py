"""The dataset of basins, in memory and as NetCDF; `docs/basins.md` lists its variables."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.steady_state import Outcome
from lapjoint.campaigns.basin_chunk import UNBOUND
from lapjoint.campaigns.basin_plan import BasinPlan
from lapjoint.campaigns.basin_table import MotionTable, wilson
from lapjoint.campaigns.dataset import read_result
from lapjoint.campaigns.format_version import attributes_of
from lapjoint.campaigns.point import FAILED, OUTCOME_CODES, plain_section
from lapjoint.orbits.certified import CertifiedMotion
from lapjoint.orbits.compiled_intervals import IndexArray

if TYPE_CHECKING:
    import xarray as xr

UNBOUND_CLASSES = (*(it.name for it in (Outcome.QUASIPERIODIC, Outcome.APERIODIC, Outcome.UNDECIDED)), FAILED)
"""Names of the outcomes of starts that are bound to no motion."""
_NOTHING = -1
"""Fills up where a problem has fewer motions than another."""
Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
# Each entry has the name, type, unit and meaning of a variable with one number for each motion.
_MOTIONS: tuple[tuple[str, str, str, str], ...] = (
    ("period_multiple", "i4", "1", "excitation periods after which the motion repeats"),
    ("symmetric", "i1", "1", "1 if half of the motion mirrors the other half"),
    ("residual", "f8", "1", "distance between start and end of the motion, relative to its size"),
    ("multiplier_real", "f8", "1", "real part of the Floquet multiplier of largest modulus"),
    ("multiplier_imag", "f8", "1", "imaginary part of the same; of a conjugate pair, the positive one"),
)


def dataset_of_basins(
    plan: BasinPlan, tables: Sequence[MotionTable], branches: Sequence[IndexArray] | None
) -> xr.Dataset:
    """The dataset of a plan that is done.

    Parameters
    ----------
    plan : BasinPlan
        The plan.
    tables : sequence of MotionTable
        The table of each problem.
    branches : sequence of ndarray, shape (M,), or None
        The branch of each motion, along the values of `over`; None without these.

    Returns
    -------
    xarray.Dataset
        The dataset.
    """
    import xarray as xr

    variables = {**_starts(plan, tables), **_motions(plan, tables), **_fractions(plan, tables)}
    if branches is not None:
        text = "number of the branch that the motion belongs to: Newton's method leads along it from value to value"
        variables["branch"] = _of_motions(plan, list(branches), "i4", {"units": "1", "long_name": text})
    variables |= _failures(tables)
    return xr.Dataset(variables, coords=_coordinates(plan), attrs=_attributes(plan))


def _over(plan: BasinPlan) -> tuple[str, ...]:
    return () if plan.over is None else (plan.over.name,)


def _coordinates(plan: BasinPlan) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    if plan.over is not None:
        attributes = {"units": plan.over.units, "long_name": plan.over.path, "path": plan.over.path}
        found[plan.over.name] = (plan.over.name,), np.array(plan.over.values), attributes
    if plan.plane is None:
        text = {"units": "1", "long_name": "number of the random start"}
        found["start"] = ("start",), np.arange(plan.starts, dtype="i4"), text
    else:
        for name, one, values in zip(("first", "second"), plan.plane.coordinates, plan.axes, strict=True):
            what = "displacement" if one.kind == "z" else "velocity"
            text = {"units": one.units, "long_name": f"{what} by which the start is moved at x = {one.place:g} m"}
            found[name] = (name,), values, {**text, "coordinate": str(one)}
    names = np.array([name.lower() for name in UNBOUND_CLASSES], dtype=object)
    found["unbound"] = ("unbound",), names, {"long_name": "what starts do that are bound to no certified motion"}
    stops = np.array(plan.problem.stop_names, dtype=object)
    found["stop_name"] = ("stop",), stops, {"long_name": "name of the stop"}
    return found


def _starts(plan: BasinPlan, tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """One number for each start."""
    own = ("start",) if plan.plane is None else ("first", "second")
    shape = ((plan.values,) if plan.over is not None else ()) + ((plan.starts,) if plan.plane is None else plan.shape)

    def shaped(name: str, kind: str, attributes: dict[str, Any]) -> Variable:
        values = np.concatenate([getattr(table, name) for table in tables]).astype(kind).reshape(shape)
        return (*_over(plan), *own), values, attributes

    flags = {
        "flag_values": np.array(list(OUTCOME_CODES.values()), dtype="i1"),
        "flag_meanings": " ".join(OUTCOME_CODES).lower(),
    }
    to = "index of the certified motion that the start is bound to, along the dimension motion; -1: to none"
    pushed = "1 if the march was pushed off an unstable motion that it could not leave by itself"
    return {
        "motion": shaped("motion", "i4", {"units": "1", "long_name": to}),
        "outcome": shaped("outcome", "i1", {"long_name": "what was established of the start", **flags}),
        "periods": shaped("periods", "i4", {"units": "1", "long_name": "excitation periods marched from the start"}),
        "pushed": shaped("pushed", "i1", {"units": "1", "long_name": pushed}),
    }


def _of_motions(plan: BasinPlan, rows: list[Any], kind: str, attributes: dict[str, Any]) -> Variable:
    """One value, or one for each stop, for each motion of each problem, filled up to the largest number of motions."""
    most = max((len(row) for row in rows), default=0)
    arrays = [np.asarray(row) for row in rows]
    tail = next((array.shape[1:] for array in arrays if array.ndim > 1), ())
    fill: Any = np.nan if kind == "f8" else "" if kind == "O" else _NOTHING
    values = np.full((len(rows), most, *tail), fill, dtype=object if kind == "O" else kind)
    for i, array in enumerate(arrays):
        values[i, : len(array)] = array.reshape(len(array), *tail)
    dimensions = (*_over(plan), "motion", *(("stop",) if tail else ()))
    return dimensions, values if plan.over is not None else values[0], attributes


def _motions(plan: BasinPlan, tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """The table of motions."""

    def column(values: list[Any], kind: str, units: str, text: str, **more: Any) -> Variable:
        return _of_motions(plan, values, kind, ({"units": units} if units else {}) | {"long_name": text, **more})

    def each(name: str) -> list[Any]:
        return [[_number(motion, name) for motion in table.motions] for table in tables]

    found = {name: column(each(name), kind, units, text) for name, kind, units, text in _MOTIONS}
    stops = len(plan.problem.stops)
    impulses = [np.array([m.impulses for m in table.motions]).reshape(len(table.motions), stops) for table in tables]
    text = "impulse of the stop over one excitation period; positive at the top, negative at the bottom"
    found["impulse"] = column(impulses, "f8", "N s", text)
    text = "estimate of the numerical error of the impulse; infinite where none can be stated"
    found["impulse_error"] = column([table.errors for table in tables], "f8", "N s", text)
    codes = [[OUTCOME_CODES[motion.outcome.name] for motion in table.motions] for table in tables]
    meanings = " ".join(OUTCOME_CODES).lower()
    flags = {"flag_values": np.array(list(OUTCOME_CODES.values()), dtype="i1"), "flag_meanings": meanings}
    found["motion_outcome"] = column(codes, "i1", "", "what kind of periodic motion it is", **flags)
    found["twin"] = column(
        [table.twin for table in tables], "i4", "1", "index of its mirror image; -1: none, or itself"
    )
    text = "number of orbits, hardly apart, into which truncated modes have parted the motion; 1 where they have not"
    found["orbits"] = column([table.orbits for table in tables], "i4", "1", text)
    sections = [[json.dumps(plain_section(motion.points[0])) for motion in table.motions] for table in tables]
    text = "a section point of the motion as JSON: closed stops, the solver's own coordinates, nodes"
    found["section_point"] = column(sections, "O", "", text)
    return found


def _number(motion: CertifiedMotion, name: str) -> float:
    """A number of a motion by the name of its variable."""
    if name.startswith("multiplier_"):
        return float(motion.multiplier.real if name.endswith("real") else motion.multiplier.imag)
    return float(getattr(motion, name))


def _fractions(plan: BasinPlan, tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """How many starts end in each motion, and how many are bound to none, with their shares."""
    total, over = plan.count, plan.over is not None
    found: dict[str, Variable] = {}
    bound = [table.counts for table in tables]
    codes = [OUTCOME_CODES[name] for name in UNBOUND_CLASSES]
    free = [np.array([np.count_nonzero((t.motion == UNBOUND) & (t.outcome == code)) for code in codes]) for t in tables]
    for prefix, counts, what in (("", bound, "are bound to the motion"), ("unbound_", free, "end so")):
        parts: dict[str, list[Any]] = {"fraction": [], "fraction_low": [], "fraction_high": []}
        for row in counts:
            both = np.array([wilson(int(count), total) for count in row]).reshape(-1, 2)
            for name, values in zip(parts, (row / total, both[:, 0], both[:, 1]), strict=True):
                parts[name].append(values)
        ends = {"fraction_low": "lower end", "fraction_high": "upper end"}
        columns = {"count": (counts, "i4", f"number of starts that {what}")} | {
            name: (rows, "f8", f"{ends[name]} of its Wilson interval at 95 %" if name in ends else f"share that {what}")
            for name, rows in parts.items()
        }
        for name, (rows, kind, text) in columns.items():
            attributes = {"units": "1", "long_name": text}
            if prefix:
                values = np.array(rows).astype(kind)
                dimensions = (*_over(plan), "unbound")
                found[prefix + name] = dimensions, values if over else values[0], attributes
            else:
                found[name] = _of_motions(plan, list(rows), kind, attributes)
    return found


def _failures(tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """Why marches could not go on, if any could not."""
    rows = [(value, start, text) for value, table in enumerate(tables) for start, text in table.messages.items()]
    if not rows:
        return {}
    values, starts, texts = zip(*rows, strict=True)
    return {
        "failure_value": (("failure",), np.array(values, dtype="i4"), {"long_name": "number of the problem"}),
        "failure_start": (("failure",), np.array(starts, dtype="i4"), {"long_name": "number of the start, in C order"}),
        "failure_message": (("failure",), np.array(texts, dtype=object), {"long_name": "why the march ended"}),
    }


def _attributes(plan: BasinPlan) -> dict[str, Any]:
    identity = plan.identity
    chosen = {"plane": identity["plane"]} if plan.plane is not None else {"energy": plan.energy, "seed": plan.seed}
    title = f"Basins of: {plan.problem.title or 'a joint'}"
    return attributes_of(plan, title, result_of=plan.noun, problem=identity["problem"], **chosen, effort=plan.effort)


def read_basins(path: str | Path) -> xr.Dataset:
    """Read the dataset of basins from a NetCDF file into memory.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    InputError
        If there is no such file, it holds something else, it is damaged, or of another format version.
    """
    return read_result(path, BasinPlan.noun)
