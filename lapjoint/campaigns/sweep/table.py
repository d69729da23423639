"""The dataset of a sweep, in memory and as NetCDF.

The contacts are a contiguous ragged array (CF 1.11, section 9.3.3): those of one motion lie together along the
dimension ``contact``, motion after motion in C order of the grid, and ``contact_count`` says how many each has.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import stop_coordinates
from lapjoint.answers.steady_state import Outcome
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
    sample_attributes,
    sample_coordinates,
    stop_sides,
)
from lapjoint.campaigns.point import CUT_AT_END, CUT_AT_START, FAILED, OUTCOME_CODES, Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.strobe import strobe_variables
from lapjoint.summaries.of_orbit import ALONG, OF_ALL, OF_STOPS

if TYPE_CHECKING:
    import xarray as xr

SAME_MOTION = 1e-3
"""Largest difference of impulses of one motion, divided by the largest impulse at the point: more than the numerical
error of an impulse, and less than the difference between motions."""
_LEADING = "the Floquet multiplier of largest modulus; of a conjugate pair, the one with the positive imaginary part"
_OUTCOMES = ["The solver gave up; see the variable message.", *(outcome.value for outcome in Outcome)]
_COMMENT = " ".join(f"{name.lower()}: {sentence}" for name, sentence in zip(OUTCOME_CODES, _OUTCOMES, strict=True))
_OUTCOME = Column(
    "outcome", "i1", "", "what the search for a steady state established", {**OUTCOME_FLAGS, "comment": _COMMENT}
)
_IMPULSE_ERROR = Column(
    "impulse_error",
    "f8",
    "N s",
    "estimate of the numerical error of the impulse; infinite where none can be stated, the standard error of the mean "
    "where the motion does not repeat",
)
_OF_POINTS = (
    Column(
        "period_multiple", "i4", "1", "excitation periods after which the motion repeats; 0: it was not found to repeat"
    ),
    RESIDUAL,
    Column("multiplier_real", "f8", "1", f"real part of {_LEADING}"),
    Column("multiplier_imag", "f8", "1", f"imaginary part of {_LEADING}"),
    Column("exponent", "f8", "s-1", "largest Lyapunov exponent, measured where the motion does not repeat"),
    Column("standard_error", "f8", "s-1", "standard error of the largest Lyapunov exponent"),
    Column("duration", "f8", "s", "duration of the motion whose contacts are kept"),
)
"""Variables of each point; the names are those of the fields of `Point`."""
_GROWTH = Column("growth", "f8", "1", "largest factor by which a deviation grew on the way to the motion")
_LAST = (
    Column("symmetric", "i1", "", "whether half the motion's period mirrors it, z(x, t + T/2) = -z(x, t)", YES_NO),
    Column("message", "O", "", "why the solver gave up; empty where it did not"),
)
_CUT = {"flag_masks": np.array([CUT_AT_START, CUT_AT_END], dtype="i1"), "flag_meanings": "cut_at_start cut_at_end"}
_SIGNED = "time integral of the stop's force; positive at the top, negative at the bottom"
_CONTACTS = (
    Column("contact_stop", "i4", "", "index of the stop, from 0", {"comment": "index along the dimension stop"}),
    Column("contact_start", "f8", "s", "time of impact, since the start of the motion that is kept", text_first=True),
    Column("contact_duration", "f8", "s", "time in contact", text_first=True),
    Column("contact_impulse", "f8", "N s", _SIGNED, text_first=True),
    Column("contact_peak_force", "f8", "N", "largest force of the stop", text_first=True),
    Column(
        "contact_cut", "i1", "", "whether the contact is cut by the start or the end of the motion that is kept", _CUT
    ),
    Column("contact_dissipated", "f8", "J", "energy that the stop takes and keeps", text_first=True),
)
"""Variables of each contact, in the sequence of the fields of `PlainContact`."""


@dataclass(frozen=True)
class _Answers:
    """The answers of all cells, and the dimensions along which they lie."""

    points: list[Point]
    dimensions: tuple[str, ...]
    shape: tuple[int, ...]

    def tabulated(self, column: Column, values: Any, stops: int | None = None) -> Variable:
        """A variable with a value for each point, or for each stop at each point."""
        if stops is None:
            return column.of(self.dimensions, values, self.shape)
        return column.of((*self.dimensions, "stop"), values, (*self.shape, stops))


def sweep_dataset(plan: Plan, points: Mapping[int, Point]) -> xr.Dataset:
    """The dataset of a sweep from the answers of all its cells."""
    import xarray as xr

    dimensions = (*plan.grid.dimensions, *(("start",) if plan.has_starts else ()))
    answers = _Answers([points[cell] for cell in range(plan.size)], dimensions, plan.shape)
    variables = {
        "stop_side": stop_sides(plan.grid.problem),
        **_impulses(plan, answers),
        **_certificates(plan, answers),
        **_contacts(answers),
        **_summary(plan, answers),
        **strobe_variables(plan, answers.points, dimensions),
    }
    if plan.has_starts:
        variables["distinct"] = _distinct(plan, answers)
    return xr.Dataset(variables, coords=_coordinates(plan), attrs=_attributes(plan))


def _coordinates(plan: Plan) -> dict[str, Variable]:
    found = sample_coordinates(plan.grid.problem, plan.grid.samples)
    for axis in plan.grid.axes:
        text = "excitation angular frequency" if axis.name == "angular_frequency" else None
        found[axis.name] = axis_coordinate(axis, text)
    if plan.has_starts:
        text = "number of the start; 0 is the problem's own initial state, the others are random"
        text = "number of the random start" if plan.start == "random" else text
        found["start"] = Column("start", "i4", "1", text).of(("start",), range(plan.starts))
    return found | stop_coordinates(plan.grid.problem)


def _impulses(plan: Plan, answers: _Answers) -> dict[str, Variable]:
    stops = len(plan.grid.problem.stops)
    none = (np.nan,) * stops
    impulses = [point.impulses if point.outcome != FAILED else none for point in answers.points]
    found = {"impulse": answers.tabulated(IMPULSE, impulses, stops)}
    if plan.errors:
        errors = [point.impulse_errors or none for point in answers.points]
        found["impulse_error"] = answers.tabulated(_IMPULSE_ERROR, errors, stops)
    return found


def _certificates(plan: Plan, answers: _Answers) -> dict[str, Variable]:
    codes = [OUTCOME_CODES[point.outcome] for point in answers.points]
    found = {"outcome": answers.tabulated(_OUTCOME, codes)}
    for column in (*_OF_POINTS, *((_GROWTH,) if plan.sensitivity else ()), *_LAST):
        found[column.name] = answers.tabulated(column, column.values(answers.points))
    return found


def _contacts(answers: _Answers) -> dict[str, Variable]:
    more = {
        "sample_dimension": "contact",
        "comment": "Contiguous ragged array: the contacts of each motion lie together along the dimension contact, "
        f"motion after motion in C order of ({', '.join(answers.dimensions)}), the last fastest. Those of the motion "
        "with the flat index i are contact_*[sum(contact_count.flat[:i]) : sum(contact_count.flat[:i + 1])].",
    }
    count = Column("contact_count", "i4", "1", "number of contacts in the motion that is kept", more)
    found = {"contact_count": answers.tabulated(count, [len(point.contacts) for point in answers.points])}
    rows = [contact for point in answers.points for contact in point.contacts]
    for i, column in enumerate(_CONTACTS):
        found[column.name] = column.of(("contact",), [row[i] for row in rows])
    return found


def _summary(plan: Plan, answers: _Answers) -> dict[str, Variable]:
    """The further numbers that were asked for: of quantities, the largest along the beam and where it is."""
    found: dict[str, Variable] = {}
    for name in plan.summary:
        columns, stops = _columns_of(name), len(plan.grid.problem.stops) if name in OF_STOPS else None
        width = 1 if stops is None else stops
        nothing = [math.nan] * (len(columns) * width)
        numbers = np.array([point.summary.get(name, nothing) for point in answers.points], dtype=float)
        for i, column in enumerate(columns):
            if plan.errors or not column.name.endswith("_error"):
                found[column.name] = answers.tabulated(column, numbers[:, i * width : (i + 1) * width], stops)
    return found


def _columns_of(name: str) -> list[Column]:
    """The variables of a further number, in the sequence in which `Point.summary` holds their values."""
    units, text = (ALONG | OF_STOPS | OF_ALL)[name]
    if name in ALONG:
        text = f"{text}, where it is largest along the beam"
    error = Column(f"{name}_error", "f8", units, f"estimate of the numerical error of: {text}")
    where = [Column(f"{name}_x", "f8", "m", f"position of {name} from the root")] if name in ALONG else []
    return [Column(name, "f8", units, text), error, *where]


def _distinct(plan: Plan, answers: _Answers) -> Variable:
    text = (
        "number of different motions among the starts: by period multiple and impulses (mirror images count twice); "
        "all that do not repeat count as one"
    )
    column = Column("distinct", "i4", "1", text, {"relative_tolerance": SAME_MOTION})
    points = answers.points
    counts = [_motions(points[i : i + plan.starts]) for i in range(0, len(points), plan.starts)]
    return column.of(answers.dimensions[:-1], counts, plan.grid.shape)


def _motions(points: Sequence[Point]) -> int:
    """Number of different motions among points; points without an answer do not count."""
    found: list[Point] = []
    answers = [point for point in points if point.outcome != FAILED]
    size = max((abs(impulse) for point in answers for impulse in point.impulses), default=0.0)
    for point in answers:
        if not any(_same(point, other, SAME_MOTION * size) for other in found):
            found.append(point)
    return len(found)


def _same(one: Point, other: Point, tolerance: float) -> bool:
    """Whether two motions are one: neither repeats, or both repeat with nearly the same impulses, in N s."""
    if one.period_multiple != other.period_multiple:
        return False
    return one.period_multiple == 0 or bool(np.allclose(one.impulses, other.impulses, rtol=0.0, atol=tolerance))


def _attributes(plan: Plan) -> dict[str, Any]:
    return attributes_of(
        plan,
        f"Steady states of: {plan.grid.problem.title or 'a joint'}",
        problem=plan.identity["problem"],
        start=plan.start,
        starts=plan.starts,
        seed=plan.seed,
        sensitivity=int(plan.sensitivity),
        errors=int(plan.errors),
        **sample_attributes(plan.grid.samples),
    )


def read_curve(path: str | Path) -> xr.Dataset:
    """Read the dataset of a sweep from a NetCDF file into memory; InputError is raised as `read_result` says."""
    return read_result(path, Plan.noun)
