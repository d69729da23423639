"""The motion at one point of a sweep or of a branch, and a section point, as plain values that a journal can hold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, NotRequired, TypedDict

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState
from lapjoint.summaries import summarise

FAILED = "FAILED"
"""Name of the outcome where the solver gave up."""
OUTCOME_CODES = {FAILED: -1} | {outcome.name: code for code, outcome in enumerate(Outcome)}
"""Numbers that stand for the outcomes in a file, by name; -1 where the solver gave up."""
CUT_AT_START, CUT_AT_END = 1, 2
"""Bits that say at which end of the motion a contact is cut: at its start, and at its end."""


class PlainSection(TypedDict):
    """A section point as values that JSON can hold; Python writes each float with the digits that give it back."""

    closed: list[int]
    """The closed stops."""
    released: NotRequired[list[int]]
    """The closed stops that exert no force, where there are some."""
    coordinates: list[list[float]]
    """The solver's own coordinates."""
    nodes: NotRequired[list[float]]
    """Positions of the nodes along the beam, where the coordinates have some."""


class PlainContact(NamedTuple):
    """A contact of the motion at a point; a journal holds it as a list, in this sequence."""

    stop: int
    """The stop, from 0."""
    start: float
    """Time of impact, since the start of the motion, s."""
    duration: float
    """Time in contact, s."""
    impulse: float
    """Time integral of the stop's force, N s."""
    peak_force: float
    """Largest force of the stop, N."""
    cut: int
    """The ends at which the motion cuts the contact, `CUT_AT_START` plus `CUT_AT_END`."""
    dissipated: float = 0.0
    """Energy that the stop takes and keeps, J."""


@dataclass(frozen=True)
class Point:
    """The motion found at one point, in numbers; NaN where there is none."""

    outcome: str = FAILED
    """Name of the `lapjoint.answers.steady_state.Outcome`, or `FAILED`."""
    period_multiple: int = 0
    """Number of excitation periods after which the motion repeats; 0 if it was not found to repeat."""
    symmetric: bool = False
    """Whether half the motion's period mirrors it."""
    residual: float = math.nan
    """Distance between the start and the end of the motion, relative to its size."""
    multiplier_real: float = math.nan
    """Real part of the Floquet multiplier of largest modulus."""
    multiplier_imag: float = math.nan
    """Imaginary part of the Floquet multiplier of largest modulus; of a conjugate pair, the positive one."""
    exponent: float = math.nan
    """Largest Lyapunov exponent, 1/s."""
    standard_error: float = math.nan
    """Standard error of the exponent, 1/s."""
    impulses: tuple[float, ...] = ()
    """Impulse of each stop over one excitation period, N s; empty if the solver gave up."""
    duration: float = math.nan
    """Duration of the motion whose contacts are kept, s."""
    contacts: tuple[PlainContact, ...] = ()
    """The contacts, in the sequence of their impacts."""
    growth: float = math.nan
    """Largest factor by which a deviation grew on the way to the motion; NaN if it was not measured."""
    impulse_errors: tuple[float, ...] = ()
    """Estimate of each impulse's numerical error, N s; infinite where none can be stated, empty if none was made."""
    summary: dict[str, list[float]] = field(default_factory=dict)
    """Further numbers of the motion that were asked for, by name.  Of a quantity: the largest value along the beam, its
    error, and its position, m.  Of the stops: one value for each stop, or for all together, then their errors.  Errors
    are NaN where none were estimated."""
    strobe: dict[str, list[float]] = field(default_factory=dict)
    """Stroboscopic samples that were asked for, as `lapjoint.campaigns.sweep.strobe.strobed` gives them."""
    message: str = ""
    """Reason for which the solver gave up; empty where it did not."""


def point_of(found: SteadyState, summary: Sequence[str] = ()) -> Point:
    """The numbers of a steady state that are kept, with those of `SUMMARIES` that `summary` names."""
    history, exponent = found.history, found.exponent
    leading = complex(found.multipliers[0]) if found.multipliers.size else complex(math.nan, math.nan)
    growth = None if found.acceptance is None else found.acceptance.growth
    return Point(
        outcome=found.outcome.name,
        period_multiple=int(found.period_multiple),
        symmetric=bool(found.symmetric),
        residual=float(found.residual),
        multiplier_real=leading.real,
        multiplier_imag=abs(leading.imag),
        exponent=math.nan if exponent is None else float(exponent.value),
        standard_error=math.nan if exponent is None else float(exponent.standard_error),
        impulses=tuple(np.asarray(found.impulses, dtype=float).tolist()),
        duration=float(history.end - history.start),
        contacts=tuple(
            PlainContact(
                stop=int(c.stop),
                start=float(c.start - history.start),
                duration=float(c.duration),
                impulse=float(c.impulse),
                peak_force=float(c.peak_force),
                cut=CUT_AT_START * bool(c.open_start) + CUT_AT_END * bool(c.open_end),
                dissipated=float(c.dissipated),
            )
            for c in history.contacts
        ),
        growth=math.nan if growth is None else float(growth),
        summary=_summary_of(found, summary) if summary else {},
        impulse_errors=() if found.impulse_errors is None else tuple(map(float, found.impulse_errors)),
    )


def point_from(fields: Mapping[str, Any]) -> Point:
    """A point from its attributes, as a journal holds them."""
    return Point(**{**fields, "contacts": tuple(PlainContact(*one) for one in fields.get("contacts", ()))})


def _summary_of(found: SteadyState, names: Sequence[str]) -> dict[str, list[float]]:
    """Numbers of a steady state as `Point.summary` holds them."""
    from lapjoint.summaries.of_orbit import ALONG, quantities_of

    summary = summarise(found, quantities=quantities_of(names) or ["displacement"], names=names)
    result = {}
    for name in names:
        values, errors = summary.value(name)
        if name in ALONG:
            i = int(np.argmax(values))
            result[name] = [float(values[i]), float(errors[i]), float(summary.selection.x[i])]
        else:
            result[name] = [*values.tolist(), *errors.tolist()]
    return result


def plain_section(point: SectionPoint) -> PlainSection:
    """A section point as values that JSON can hold."""
    coordinates = np.asarray(point.coordinates, dtype=float).tolist()
    plain = PlainSection(closed=list(point.state.closed), coordinates=coordinates)
    if point.state.released:
        plain["released"] = list(point.state.released)
    if point.nodes is not None:
        plain["nodes"] = np.asarray(point.nodes, dtype=float).tolist()
    return plain


def section_from(plain: PlainSection) -> SectionPoint:
    """The section point of which `plain_section` made the values, with the same bits."""
    nodes = np.array(plain["nodes"], dtype=float) if "nodes" in plain else None
    state = ContactState(tuple(plain["closed"]), tuple(plain.get("released", ())))
    return SectionPoint(state, np.array(plain["coordinates"], dtype=float), nodes)
