"""A summary as blocks of rows: what the command line prints of one solver, and what a report shows of both."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.answers.series import written
from lapjoint.answers.steady_state import SteadyState
from lapjoint.figures.text import error_text
from lapjoint.problem import FloatArray, Problem
from lapjoint.summaries.fatigue_of_orbit import OF_FATIGUE, FatigueSummary
from lapjoint.summaries.of_orbit import OF_STOPS, WANDERING, OrbitSummary, summarise

POWERS = {"input_power": "of the excitation", "damping_power": "lost in beams and links"}
"""Mean powers that are no stop's, and what they are."""
LIFE = "Time until the damage is 1, where it is largest [h]"
"""Title of the block of the fatigue life."""
IMPULSE = "Impulse per excitation period [N s], top positive"
"""Title of the block of impulses of a steady state."""


@dataclass(frozen=True)
class Number:
    """A number with what is known of its error."""

    value: float
    error: float | None = None
    """Numerical error, in the unit of the number; infinite if no error can be stated, None if none was estimated."""
    interval: tuple[float, float] | None = None
    """Ends of the 95 % interval of a mean over a long motion."""
    digits: int = 5
    """Number of significant digits that are shown."""

    @property
    def text(self) -> str:
        """The number; a question mark if it is unknown."""
        return shown(self.value, self.digits)

    @property
    def ends(self) -> tuple[str, str]:
        """The ends of the interval, or two empty texts."""
        if self.interval is None:
            return "", ""
        low, high = (shown(end, self.digits) for end in self.interval)
        return low, high

    @property
    def with_error(self) -> str:
        """The number with its error or its interval."""
        if self.interval is not None:
            return f"{self.text} ({' to '.join(self.ends)})"
        return self.text if self.error is None else f"{self.text} ± {error_text(self.error)}"


@dataclass(frozen=True)
class Row:
    """Numbers at a place of the beam, or at a stop."""

    where: str
    """The place, m, or the name of the stop."""
    numbers: tuple[Number | None, ...]
    """One for each head of the block; None where there is none."""
    of: str = ""
    """Quantity and unit, where a block has several quantities."""
    stop: int | None = None
    """Index of the stop; None for a place, and for all stops together."""
    largest: bool = False
    """Whether the place is that at which the quantity is largest along the beam."""
    asked: bool = True
    """Whether the place was asked for."""


@dataclass(frozen=True)
class Block:
    """Rows of equal numbers, under a title."""

    title: str
    heads: tuple[str, ...]
    """A head for each number of a row."""
    rows: tuple[Row, ...]


def shown(value: float, digits: int) -> str:
    """A number to some significant digits; a question mark if it is not finite."""
    return f"{value:.{digits}g}" if math.isfinite(value) else "?"


def at_stops(
    problem: Problem,
    title: str,
    heads: tuple[str, ...],
    columns: Sequence[FloatArray],
    errors: Sequence[FloatArray | None],
    *,
    digits: int = 8,
    damped: bool = False,
    in_all: tuple[float, float | None] | None = None,
) -> Block:
    """A block of stops, or of `damped` stops alone, from a column of values, ``(S,)``, for each head, with errors.

    `in_all` is the value of all stops together, with its error: a row of its own where there are several.
    """

    def number(value: float, error: float | None) -> Number:
        return Number(value, error, digits=digits)

    which = [i for i, stop in enumerate(problem.structure.stops) if stop.damping > 0 or not damped]
    rows = [
        Row(
            problem.stop_names[i],
            tuple(
                number(float(c[i]), None if e is None else float(e[i])) for c, e in zip(columns, errors, strict=True)
            ),
            stop=i,
        )
        for i in which
    ]
    if in_all is not None and len(which) > 1:
        rows.append(Row("in all", (number(*in_all),)))
    return Block(title, heads, tuple(rows))


def steady_blocks(found: SteadyState, at: Sequence[float] | None = None) -> list[Block]:
    """What is shown of a steady state: impulses and losses, then peaks, forces, contacts, powers, fatigue.

    Blocks without rows are left out.
    """
    problem, errors = found.problem, found.impulse_errors
    blocks = [at_stops(problem, IMPULSE, ("",), [found.impulses], [errors])]
    if found.period_multiple:
        title = "Energy lost in damped stops per excitation period [J]"
        blocks.append(at_stops(problem, title, ("",), [found.dissipated], [found.dissipated_errors], damped=True))
    blocks += summary_blocks(summarise(found, at=at), "" if found.period_multiple else f" over {WANDERING} periods")
    return [block for block in blocks if block.rows]


def summary_blocks(summary: OrbitSummary, over: str = "") -> list[Block]:
    """The values of a summary at places and at stops; `over` says over which time they are means."""
    problem, values, errors = summary.selection.problem, summary.values, summary.errors

    def error(name: str) -> FloatArray | None:
        return None if errors is None else errors[name]

    def block(title: str, heads: tuple[str, ...], *names: str) -> Block:
        columns = [values[name] for name in names]
        return at_stops(problem, title, heads, columns, [error(name) for name in names], digits=5)

    def alone(name: str) -> Number:
        unsure = error(name)
        return Number(float(values[name][0]), None if unsure is None else float(unsure[0]))

    lost = f"Mean power lost in damped stops{over} [W]"
    received = f"Mean power received by stops{over}, to keep or to give back [W]"
    total = alone("dissipated_power_total")
    powers = tuple(Row(text, (alone(name),)) for name, text in POWERS.items())
    blocks = [
        Block(f"Largest magnitude, and RMS{over}", ("peak", "RMS"), tuple(_at_places(summary))),
        block("Force [N]", ("peak", "RMS"), "force_peak", "force_rms"),
        block("Contacts a second, and share of time", ("contacts", "share"), "contact_rate", "contact_time"),
        block(received, ("",), "received_power"),
        at_stops(
            problem,
            lost,
            ("",),
            [values["dissipated_power"]],
            [error("dissipated_power")],
            damped=True,
            in_all=(total.value, total.error),
        ),
        Block(f"Mean power{over} [W]", ("",), powers),
    ]
    others = [name for name in OF_STOPS if name not in _OF_STOPS_SHOWN]
    if summary.fatigue is not None:
        blocks += _of_fatigue(summary, summary.fatigue)
    return blocks + [block(f"{OF_STOPS[name][1]} [{written(OF_STOPS[name][0])}]", ("",), name) for name in others]


_OF_STOPS_SHOWN = ("force_peak", "force_rms", "contact_rate", "contact_time", "received_power", "dissipated_power")


def _at_places(summary: OrbitSummary) -> list[Row]:
    """Peak and root mean square of each quantity."""
    rows: list[Row] = []
    for one in summary.selection.quantities:
        of = f"{one.name.replace('_', ' ')} [{written(one.units)}]"
        rows += _along(summary, of, summary.values, summary.errors, f"{one.name}_peak", f"{one.name}_rms")
    return rows


def _of_fatigue(summary: OrbitSummary, fatigue: FatigueSummary) -> list[Block]:
    """Damage and ranges at places, and the life, if there is damage."""
    values, errors, rows = fatigue.values, fatigue.errors, list[Row]()
    for name, (units, _) in OF_FATIGUE.items():
        rows += _along(summary, f"{name.replace('_', ' ')} [{written(units)}]", values, errors, name)
    blocks = [Block("Fatigue; equivalent range: once a period", ("value",), tuple(rows))]
    worst = int(np.argmax(values["damage_rate"]))
    rate = float(values["damage_rate"][worst])
    if rate > 0:
        unsure = None if errors is None else float(errors["damage_rate"][worst]) / rate**2 / 3600
        blocks.append(Block(LIFE, ("",), (Row("along the beam", (Number(1 / rate / 3600, unsure),)),)))
    return blocks


def _along(
    summary: OrbitSummary, of: str, values: dict[str, FloatArray], errors: dict[str, FloatArray] | None, *names: str
) -> list[Row]:
    """A row for each chosen place, and one for the place where the first number is largest along the beam."""
    what, rows = summary.selection, list[Row]()
    largest = int(np.argmax(values[names[0]]))
    for i in [*what.asked.tolist(), largest]:
        numbers = [Number(float(values[n][i]), None if errors is None else float(errors[n][i])) for n in names]
        rows.append(Row(what.problem.line.place(float(what.x[i]), 4), tuple(numbers), of, asked=i in what.asked))
    rows[-1] = replace(rows[-1], largest=True)
    return rows
