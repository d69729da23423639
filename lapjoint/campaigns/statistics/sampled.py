"""The dataset of statistics with samples of uncertain numbers: the statistics of each sample, one after the other.

Of values along the beam there are those at the chosen places, over ``x``.  If no places were chosen, there is the
largest along the beam, and where it is, ``*_x``.  What is counted in bins is left out: the bins of 256 samples would be
most of the file.  A sample of which a realisation did not come to its end has no values: they are NaN.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import place_coordinates, stop_coordinates
from lapjoint.campaigns.dataset import (
    Column,
    Variable,
    attributes_of,
    sample_attributes,
    sample_coordinates,
    stop_sides,
)
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.campaigns.statistics.table import Realised
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray
from lapjoint.sampling.design import SAMPLE, Samples
from lapjoint.solver import make_solver
from lapjoint.summaries.measure import Measure
from lapjoint.summaries.sums import Sums
from lapjoint.summaries.table import interval_ends, remarks, settings_of, variables_of

if TYPE_CHECKING:
    import xarray as xr

_FAILED = Column("failed", "i4", "1", "realisations that did not come to their end, in which case there are no values")
_SETTINGS = (
    Column("settle", "f8", "s", "start that is left out"),
    Column("units", "f8", "1", "units of time of all realisations, from which intervals follow"),
    Column("unit_duration", "f8", "s", "duration of a unit"),
    Column("decay_time", "f8", "s", "time in which the slowest mode falls by a factor e"),
    Column("rate", "f8", "s-1", "samples of the motion in a second"),
)
"""How each sample was summarised."""
_OF_FATIGUE = {
    "sampling_error": ("damage_rate", "1", "error of the damage by the sampling of the stress, relative"),
    "equivalent_rate": ("equivalent_range", "s-1", "cycles a second of the equivalent range"),
}
"""Attributes of variables that differ from sample to sample: the variable, and the unit and the meaning."""


@dataclass(frozen=True)
class _Row:
    """The statistics of a sample."""

    variables: dict[str, Variable]
    """By name: dimensions, values and attributes."""
    settings: dict[str, Any]
    """How its motions were summarised."""
    remarks: list[str]
    """Reasons to doubt the intervals."""


def sampled_dataset(spec: Realisations, samples: Samples, points: Mapping[int, Realised]) -> xr.Dataset:
    """The dataset of statistics from the answers of all realisations of all samples; SolverError if no sample has all
    its sums."""
    import xarray as xr

    solver = make_solver(spec.solver, **spec.options)
    answers = [[points[sample * spec.seeds + i] for i in range(spec.seeds)] for sample in range(samples.size)]
    rows = [_row(spec, spec.measure(solver, sample), own) for sample, own in enumerate(answers)]
    messages = [answer.message for own in answers for answer in own if answer.sums is None]
    some = next((row for row in rows if row is not None), None)
    if some is None:
        raise SolverError(f"no sample came to its end: {messages[0]}")
    failed = [sum(answer.sums is None for answer in own) for own in answers]
    variables = {"stop_side": stop_sides(spec.problem), "failed": _FAILED.of((SAMPLE,), failed)}
    variables |= {name: _stacked(rows, name, one) for name, one in some.variables.items()}
    attributes = attributes_of(
        spec,
        f"Statistics of: {spec.problem.title or 'a joint'}",
        result_of=spec.noun,
        problem=spec.identity["problem"],
        solver_name=solver.name,
        seeds=spec.seeds,
        duration=spec.duration,
        **{name: some.settings[name] for name in ("level", "intervals", "peaks")},
        failed=len(messages),
        messages="\n".join(messages),
        remarks=_remark(rows),
        **sample_attributes(samples),
    )
    return xr.Dataset(variables, coords=_coordinates(spec, rows, some), attrs=attributes)


def _row(spec: Realisations, what: Measure, answers: list[Realised]) -> _Row | None:
    """The statistics of a sample; None if a realisation did not come to its end."""
    parts = [answer.sums for answer in answers if answer.sums is not None]
    if len(parts) < len(answers):
        return None
    sums = Sums.joined(parts)
    every = variables_of(what, sums, binned=False)
    if spec.at is None:
        variables = dict(_largest_along(every, what.selection.x))
    else:
        places = what.selection.asked
        variables = {
            name: (dims, values[places] if "x" in dims else values, attributes)
            for name, (dims, values, attributes) in every.items()
        }
    return _Row(variables, settings_of(what, sums), remarks(what, sums, len(parts)))


def _largest_along(every: dict[str, Variable], x: FloatArray) -> Iterator[tuple[str, Variable]]:
    """Variables of which those along the beam, over `x`, m, are the largest magnitude along it, and where that is."""
    for name, (dims, values, attributes) in every.items():
        if "x" not in dims:
            yield name, (dims, values, attributes)
        elif not name.endswith("_interval"):
            at = int(np.argmax(np.abs(values)))
            yield name, ((), values[at], attributes)
            yield f"{name}_x", ((), x[at], {"units": "m", "long_name": f"position of {name} from the root"})
            if f"{name}_interval" in every:
                _, ends, of_ends = every[f"{name}_interval"]
                yield f"{name}_interval", (("bound",), ends[at], of_ends)


def _stacked(rows: list[_Row | None], name: str, some: Variable) -> Variable:
    """A variable over the samples and its own dimensions; NaN at samples without values."""
    dims, values, attributes = some
    nothing = np.full(np.shape(values), np.nan)
    every = np.stack([nothing if row is None else row.variables[name][1] for row in rows])
    return (SAMPLE, *dims), every, {key: value for key, value in attributes.items() if key not in _OF_FATIGUE}


def _remark(rows: list[_Row | None]) -> str:
    """A sentence on reasons to doubt the intervals of samples; empty if there are none."""
    doubts = {i: row.remarks[0] for i, row in enumerate(rows) if row is not None and row.remarks}
    if not doubts:
        return ""
    first, text = next(iter(doubts.items()))
    return (
        f"there are reasons to doubt the intervals of {len(doubts)} of {len(rows)} samples; of sample {first}: {text}"
    )


def _coordinates(spec: Realisations, rows: list[_Row | None], some: _Row) -> dict[str, Any]:
    """The samples, how each was summarised, the stops and the places."""
    found: dict[str, Any] = sample_coordinates(spec.problem, spec.samples)
    for column in _SETTINGS:
        found[column.name] = column.of(
            (SAMPLE,), [np.nan if row is None else row.settings[column.name] for row in rows]
        )
    for name, (of, units, text) in _OF_FATIGUE.items():
        if of in some.variables:
            values = [np.nan if row is None else row.variables[of][2][name] for row in rows]
            found[name] = Column(name, "f8", units, text).of((SAMPLE,), values)
    found |= {"bound": interval_ends()} | stop_coordinates(spec.problem)
    return found if spec.at is None else found | place_coordinates(spec.problem, np.array([*dict.fromkeys(spec.at)]))
