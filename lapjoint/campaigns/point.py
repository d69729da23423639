"""What is kept of one point of a sweep, as plain values that a journal can hold."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState

FAILED = "FAILED"
OUTCOME_CODES = {FAILED: -1} | {outcome.name: code for code, outcome in enumerate(Outcome)}
"""Numbers that stand for the outcomes in a file, by name; -1 where the solver gave up."""
CUT_AT_START, CUT_AT_END = 1, 2


@dataclass(frozen=True)
class Point:
    """The motion found at one point, in numbers; NaN where there is none."""

    outcome: str = FAILED
    """Name of the `lapjoint.answers.steady_state.Outcome`, or `FAILED`."""
    order: int = 0
    symmetric: bool = False
    residual: float = math.nan
    multiplier: float = math.nan
    """Modulus of the largest Floquet multiplier."""
    exponent: float = math.nan
    """Largest Lyapunov exponent, 1/s."""
    spread: float = math.nan
    """Its standard error, 1/s."""
    impulses: tuple[float, ...] = ()
    """Impulse of each stop over one excitation period, N s; empty if the solver gave up."""
    span: float = math.nan
    """Duration of the motion whose contacts are kept, s."""
    contacts: tuple[tuple[int, float, float, float, float, int], ...] = ()
    """Stop, start after the motion's, s, duration, s, impulse, N s, peak force, N, and where it is cut."""
    message: str = ""
    """Why the solver gave up."""


def point_of(found: SteadyState) -> Point:
    """What is kept of a steady state."""
    history, exponent = found.history, found.exponent
    multipliers = np.asarray(found.multipliers)
    return Point(
        outcome=found.outcome.name,
        order=int(found.order),
        symmetric=bool(found.symmetric),
        residual=float(found.residual),
        multiplier=float(np.max(np.abs(multipliers))) if multipliers.size else math.nan,
        exponent=math.nan if exponent is None else float(exponent.value),
        spread=math.nan if exponent is None else float(exponent.spread),
        impulses=tuple(np.asarray(found.impulses, dtype=float).tolist()),
        span=float(history.end - history.start),
        contacts=tuple(
            (
                int(c.stop),
                float(c.start - history.start),
                float(c.duration),
                float(c.impulse),
                float(c.peak_force),
                CUT_AT_START * bool(c.open_start) + CUT_AT_END * bool(c.open_end),
            )
            for c in history.contacts
        ),
    )


def plain_section(section: SectionPoint) -> dict[str, Any]:
    """A section as JSON can hold it; Python writes each float with the digits that give it back exactly."""
    return {"closed": list(section.state.closed), "coordinates": np.asarray(section.coordinates, dtype=float).tolist()}


def section_from(plain: dict[str, Any]) -> SectionPoint:
    """The section that `plain_section` made plain."""
    return SectionPoint(ContactState(tuple(plain["closed"])), np.array(plain["coordinates"], dtype=float))
