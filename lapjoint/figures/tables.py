"""Answers as tables: one table of each answer, from which text, HTML and a pandas frame are made."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.equilibrium import Equilibrium
from lapjoint.answers.history import History
from lapjoint.answers.modes import Modes
from lapjoint.answers.quantities import QUANTITIES
from lapjoint.answers.series import written
from lapjoint.answers.steady_state import SteadyState
from lapjoint.figures.text import error_text, frequency_text, plain
from lapjoint.problem import Problem
from lapjoint.summaries.of_orbit import OF_ALL, OF_STOPS, OrbitSummary

if TYPE_CHECKING:
    import pandas as pd

ROWS = 12
"""Largest number of rows that are shown, so that an answer fits on a screen; a pandas frame has all."""


@dataclass(frozen=True)
class Column:
    """A column of a table: texts, or numbers with or without errors."""

    name: str
    values: Sequence[Any]
    unit: str = ""
    errors: Sequence[float | None] | None = None
    """Numerical errors; infinite where none can be stated, None where none was estimated."""

    @property
    def head(self) -> str:
        """The heading."""
        return self.name.replace("_", " ") + (f" [{self.unit}]" if self.unit else "")

    def cell(self, row: int, plus_minus: str) -> str:
        """A value as text, with its error."""
        value, error = self.values[row], None if self.errors is None else self.errors[row]
        shown = f"{value:.6g}" if isinstance(value, float) else plain(str(value))
        return shown if error is None else f"{shown} {plus_minus} {error_text(float(error))}"


@dataclass(frozen=True)
class Table:
    """An answer as a table."""

    title: str
    lines: Sequence[str] = ()
    """What is said above the rows."""
    columns: Sequence[Column] = field(default=())

    @property
    def heads(self) -> list[str]:
        """The headings."""
        return [column.head for column in self.columns]

    def rows(self, plus_minus: str) -> list[list[str]]:
        """The rows that are shown, as text."""
        return [[column.cell(i, plus_minus) for column in self.columns] for i in range(min(self.count, ROWS))]

    @property
    def count(self) -> int:
        """Number of all rows."""
        return len(self.columns[0].values) if self.columns else 0

    def text(self, kind: str) -> str:
        """The table as text, after the kind of the answer."""
        rows = [self.heads, *self.rows("+-")] if self.count else []
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        cells = (
            "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
        )
        more = [f"... and {self.count - ROWS} more"] if self.count > ROWS else []
        return "\n".join([f"{kind}: {plain(self.title)}", *map(plain, self.lines), *cells, *more])

    def frame(self) -> pd.DataFrame:
        """The table as a pandas frame; errors have columns of their own, and units are in its ``attrs``."""
        import pandas as pd

        found: dict[str, Any] = {}
        for column in self.columns:
            found[column.name] = list(column.values)
            if column.errors is not None:
                found[f"{column.name}_error"] = [math.nan if error is None else error for error in column.errors]
        frame = pd.DataFrame(found)
        frame.attrs["units"] = {column.name: column.unit for column in self.columns if column.unit}
        return frame


@singledispatch
def table_of(answer: object) -> Table:
    """The table of an answer; `TypeError` for an object that is no answer."""
    raise TypeError(f"{type(answer).__name__} is no answer")


@table_of.register
def _of_modes(modes: Modes) -> Table:
    """Natural frequencies."""
    closed = ", ".join(str(i + 1) for i in modes.state.closed)
    title = f"Modes with stop {closed} closed" if closed else "Modes with all stops open"
    omega = modes.angular_frequencies.tolist()
    columns = (
        Column("mode", range(1, len(omega) + 1)),
        Column("angular_frequency", omega, "rad/s"),
        Column("frequency", [w / (2 * math.pi) for w in omega], "Hz"),
    )
    return Table(title, (), columns)


@table_of.register
def _of_history(history: History) -> Table:
    """The contacts of a motion."""
    contacts = history.contacts
    said = f"{history.solver}, {history.start:g} to {history.end:g} s: {len(contacts)} contacts"

    def column(name: str, unit: str, with_errors: bool = True) -> Column:
        errors = [getattr(c, f"{name}_error") for c in contacts] if with_errors else None
        known = errors if errors and any(error is not None for error in errors) else None
        return Column(name, [float(getattr(c, name)) for c in contacts], unit, known)

    columns = [
        Column("stop", [history.problem.stop_names[c.stop] for c in contacts]),
        column("start", "s"),
        column("duration", "s", False),
        column("impulse", "N s"),
        column("peak_force", "N"),
        *([column("dissipated", "J")] if _damped(history.problem) else []),
    ]
    return Table(_title(history.problem), (said,), columns)


@table_of.register
def _of_steady_state(steady: SteadyState) -> Table:
    """The impulses of the stops in a period of a steady state."""
    lines = [f"{steady.solver}: {steady.outcome.value}"]
    omega, multiple = steady.problem.excitation_frequency, steady.period_multiple
    if omega is not None:
        lines.append(f"Excitation: {frequency_text(omega)}")
    if multiple:
        mirrored = ", mirrored half-way." if steady.symmetric else "."
        lines.append(f"It repeats after {multiple} excitation period{'s' * (multiple > 1)}{mirrored}")
    if steady.multipliers.size:
        lines.append(f"Largest modulus of a Floquet multiplier: {np.abs(steady.multipliers).max():.4g}")
    unsure, lost = steady.impulse_errors, steady.dissipated_errors
    columns = [
        *_stops(steady.problem),
        Column("impulse_per_period", steady.impulses.tolist(), "N s", None if unsure is None else unsure.tolist()),
    ]
    if _damped(steady.problem):
        errors = None if lost is None else lost.tolist()
        columns.append(Column("dissipated_per_period", steady.dissipated.tolist(), "J", errors))
    return Table(_title(steady.problem), lines, columns)


@table_of.register
def _of_equilibrium(found: Equilibrium) -> Table:
    """The forces of the stops in a static equilibrium."""
    lines = [found.solver, *([found.other_equilibria] if found.other_equilibria else [])]
    for name, tip in zip(found.problem.line.names, found.tips, strict=True):
        of = f" of {name}" if name else ""
        lines.append(f"Displacement of the tip{of}: {tip.value:.6g} +- {error_text(tip.error)} m")
    force = Column("force", found.contact_forces.tolist(), "N", found.errors.contact_forces.tolist())
    return Table(_title(found.problem), lines, (*_stops(found.problem), force))


@table_of.register
def _of_summary(summary: OrbitSummary) -> Table:
    """Peaks and root mean squares at the places that were asked for, and the values of stops."""
    what = summary.selection
    line, asked = what.problem.line, what.asked.tolist()
    places = [(f"{line.place(float(what.x[i]), 4)}{' m' * (not line.several)}", i) for i in asked]
    rows = list[tuple[str, str, str, float, float | None]]()
    for name, values in summary.values.items():
        errors = None if summary.errors is None else summary.errors[name]
        rows += [
            (name, where, unit, float(values[i]), None if errors is None else float(errors[i]))
            for where, unit, i in _places_of(name, what.problem.stop_names, places)
        ]
    name_of, at, unit_of, value_of, error_of = zip(*rows, strict=True)
    known = None if summary.errors is None else error_of
    columns = (
        Column("value_of", name_of),
        Column("at", at),
        Column("unit", unit_of),
        Column("value", value_of, "", known),
    )
    return Table(_title(what.problem), (), columns)


def _places_of(name: str, stops: Sequence[str], places: Iterable[tuple[str, int]]) -> Iterator[tuple[str, str, int]]:
    """Where a value of a summary is given, its unit, and its index there."""
    if name in OF_STOPS:
        yield from ((stop, written(OF_STOPS[name][0]), i) for i, stop in enumerate(stops))
    elif name in OF_ALL:
        yield "all stops", written(OF_ALL[name][0]), 0
    elif name.rpartition("_")[0] in QUANTITIES:
        yield from ((place, written(QUANTITIES[name.rpartition("_")[0]].units), i) for place, i in places)


def _stops(problem: Problem) -> list[Column]:
    """The names, places and sides of the stops."""
    stops = problem.structure.stops
    return [
        Column("stop", problem.stop_names),
        Column("x", [stop.where for stop in stops], "m"),
        Column("side", [stop.side for stop in stops]),
    ]


def _damped(problem: Problem) -> bool:
    return any(stop.damping > 0 for stop in problem.stops)


def _title(problem: Problem) -> str:
    return problem.title or "Untitled problem"
