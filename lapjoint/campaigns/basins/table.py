"""The dataset of basins, in memory and as NetCDF; `docs/basins.md` lists its variables."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import stop_coordinates
from lapjoint.answers.steady_state import Outcome
from lapjoint.campaigns.basins.motions import MotionTable, branches_of, table_of, wilson
from lapjoint.campaigns.basins.solve import UNBOUND, ChunkEnds
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.dataset import (
    IMPULSE,
    OUTCOME_FLAGS,
    RESIDUAL,
    Column,
    Variable,
    attributes_of,
    axis_coordinate,
    read_result,
)
from lapjoint.campaigns.point import FAILED, OUTCOME_CODES, plain_section

if TYPE_CHECKING:
    import xarray as xr

UNBOUND_CLASSES = (*(it.name for it in (Outcome.QUASIPERIODIC, Outcome.APERIODIC, Outcome.UNDECIDED)), FAILED)
"""Names of the outcomes of starts that are bound to no motion."""
_FILL: Mapping[str, Any] = {"f8": np.nan, "O": "", "i1": -1, "i4": -1}
"""Value, by type, that pads the rows of a problem with fewer motions than another."""
_OF_STARTS = (
    Column(
        "motion",
        "i4",
        "1",
        "index of the certified motion that the start is bound to, along the dimension motion; -1: to none",
    ),
    Column("outcome", "i1", "", "what was established of the start", OUTCOME_FLAGS),
    Column("periods", "i4", "1", "excitation periods marched from the start"),
    Column("pushed", "i1", "1", "1 if the march was pushed off an unstable motion that it could not leave by itself"),
)
"""Variables of each start; the names are those of the fields of `MotionTable`."""


_OF_MOTIONS = (
    Column(
        "period_multiple",
        "i4",
        "1",
        "excitation periods after which the motion repeats",
        value=lambda table: [motion.period_multiple for motion in table.motions],
    ),
    Column(
        "symmetric",
        "i1",
        "1",
        "1 if half of the motion mirrors the other half",
        value=lambda table: [motion.symmetric for motion in table.motions],
    ),
    replace(RESIDUAL, value=lambda table: [motion.residual for motion in table.motions]),
    Column(
        "multiplier_real",
        "f8",
        "1",
        "real part of the Floquet multiplier of largest modulus",
        value=lambda table: [motion.multiplier.real for motion in table.motions],
    ),
    Column(
        "multiplier_imag",
        "f8",
        "1",
        "imaginary part of the same; of a conjugate pair, the positive one",
        value=lambda table: [motion.multiplier.imag for motion in table.motions],
    ),
    replace(IMPULSE, value=lambda table: [motion.impulses for motion in table.motions]),
    Column(
        "impulse_error",
        "f8",
        "N s",
        "estimate of the numerical error of the impulse; infinite where none can be stated",
        value=lambda table: table.errors,
        of_stops=True,
    ),
    Column(
        "motion_outcome",
        "i1",
        "",
        "what kind of periodic motion it is",
        OUTCOME_FLAGS,
        value=lambda table: [OUTCOME_CODES[motion.outcome.name] for motion in table.motions],
    ),
    Column("twin", "i4", "1", "index of its mirror image; -1: none, or itself"),
    Column(
        "orbits",
        "i4",
        "1",
        "number of orbits, hardly apart, into which truncated modes have parted the motion; 1 where they have not",
    ),
    Column(
        "section_point",
        "O",
        "",
        "a section point of the motion as JSON: closed stops, the solver's own coordinates, nodes",
        value=lambda table: [json.dumps(plain_section(motion.points[0])) for motion in table.motions],
    ),
)
"""Variables of each motion, from a `MotionTable`."""
_BRANCH = Column(
    "branch",
    "i4",
    "1",
    "number of the branch that the motion belongs to: Newton's method leads along it from value to value",
)
_FAILURES = (
    Column("failure_value", "i4", "", "number of the problem"),
    Column("failure_start", "i4", "", "number of the start, in C order"),
    Column("failure_message", "O", "", "why the march ended"),
)


def basins_dataset(plan: BasinPlan, points: Mapping[int, ChunkEnds]) -> xr.Dataset:
    """The dataset of basins from the answers of all cells."""
    import xarray as xr

    tables = []
    for value in range(plan.values):
        first = plan.values + value * plan.chunks
        cells = range(first, first + plan.chunks)
        chunks = [points[cell].whole(len(plan.chunk(cell).starts)) for cell in cells]
        tables.append(table_of(plan, value, points[value], chunks))
    motions = {column.name: _of_motions(plan, column, column.values(tables)) for column in _OF_MOTIONS}
    variables = {**_starts(plan, tables), **motions, **_fractions(plan, tables)}
    if plan.over is not None:
        variables["branch"] = _of_motions(plan, _BRANCH, branches_of(plan, tables))
    variables |= _failures(tables)
    return xr.Dataset(variables, coords=_coordinates(plan), attrs=_attributes(plan))


def _over(plan: BasinPlan) -> tuple[str, ...]:
    return () if plan.over is None else (plan.over.name,)


def _coordinates(plan: BasinPlan) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    if plan.over is not None:
        found[plan.over.name] = axis_coordinate(plan.over)
    if plan.plane is None:
        found["start"] = Column("start", "i4", "1", "number of the random start").of(("start",), range(plan.starts))
    else:
        for name, one, values in zip(("first", "second"), plan.plane.coordinates, plan.axes, strict=True):
            what = "displacement" if one.kind == "z" else "velocity"
            place = one.place if isinstance(one.place, str) else f"x = {one.place:g} m"
            text = f"{what} by which the start is moved at {place}"
            found[name] = Column(name, "f8", one.units, text, {"coordinate": str(one)}).of((name,), values)
    unbound = Column("unbound", "O", "", "what starts do that are bound to no certified motion")
    found["unbound"] = unbound.of(("unbound",), [name.lower() for name in UNBOUND_CLASSES])
    return found | stop_coordinates(plan.problem)


def _starts(plan: BasinPlan, tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """One value for each start."""
    own = ("start",) if plan.plane is None else ("first", "second")
    each = (plan.starts,) if plan.plane is None else plan.shape
    shape = each if plan.over is None else (plan.values, *each)
    dimensions = (*_over(plan), *own)
    return {one.name: one.of(dimensions, np.concatenate(one.values(tables)), shape) for one in _OF_STARTS}


def _of_motions(plan: BasinPlan, column: Column, rows: Sequence[Any]) -> Variable:
    """One value, or one for each stop, for each motion of each problem, padded to the largest number of motions."""
    more, tail = (("stop",), (len(plan.problem.stops),)) if column.of_stops else ((), ())
    most = max((len(row) for row in rows), default=0)
    values = np.full((len(rows), most, *tail), _FILL[column.kind], dtype=column.kind)
    for i, row in enumerate(rows):
        values[i, : len(row)] = np.reshape(row, (len(row), *tail))
    return (*_over(plan), "motion", *more), values if plan.over is not None else values[0], column.attributes


def _fractions(plan: BasinPlan, tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """How many starts end in each motion, and how many are bound to none, with their shares and intervals."""
    codes = [OUTCOME_CODES[name] for name in UNBOUND_CLASSES]
    free = [np.array([np.count_nonzero((t.motion == UNBOUND) & (t.outcome == code)) for code in codes]) for t in tables]
    found = {}
    for column, rows in _shares("", "are bound to the motion", [table.counts for table in tables], plan.count):
        found[column.name] = _of_motions(plan, column, rows)
    for column, rows in _shares("unbound_", "end so", free, plan.count):
        values = rows if plan.over is not None else rows[0]
        found[column.name] = column.of((*_over(plan), "unbound"), values)
    return found


def _shares(prefix: str, what: str, counts: Sequence[Any], total: int) -> list[tuple[Column, list[Any]]]:
    """The variables for counts of starts, their fractions and intervals, with their values for each problem."""
    ends = [np.array([wilson(int(count), total) for count in row]).reshape(-1, 2) for row in counts]
    return [
        (Column(f"{prefix}count", "i4", "1", f"number of starts that {what}"), list(counts)),
        (Column(f"{prefix}fraction", "f8", "1", f"share that {what}"), [row / total for row in counts]),
        (
            Column(f"{prefix}fraction_low", "f8", "1", "lower end of its Wilson interval at 95 %"),
            [both[:, 0] for both in ends],
        ),
        (
            Column(f"{prefix}fraction_high", "f8", "1", "upper end of its Wilson interval at 95 %"),
            [both[:, 1] for both in ends],
        ),
    ]


def _failures(tables: Sequence[MotionTable]) -> dict[str, Variable]:
    """Why marches could not go on, if any could not."""
    rows = [(value, start, text) for value, table in enumerate(tables) for start, text in table.messages.items()]
    columns = zip(_FAILURES, zip(*rows, strict=True), strict=True) if rows else ()
    return {column.name: column.of(("failure",), values) for column, values in columns}


def _attributes(plan: BasinPlan) -> dict[str, Any]:
    identity = plan.identity
    chosen = {"plane": identity["plane"]} if plan.plane is not None else {"energy": plan.energy, "seed": plan.seed}
    title = f"Basins of: {plan.problem.title or 'a joint'}"
    return attributes_of(plan, title, result_of=plan.noun, problem=identity["problem"], **chosen, effort=plan.effort)


def read_basins(path: str | Path) -> xr.Dataset:
    """Read the dataset of basins from a NetCDF file into memory; InputError is raised as `read_result` says."""
    return read_result(path, BasinPlan.noun)
