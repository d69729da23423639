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
    period_multiple: int = 0
    """Excitation periods after which the motion repeats; 0 if it was not found to."""
    symmetric: bool = False
    residual: float = math.nan
    multiplier_real: float = math.nan
    multiplier_imag: float = math.nan
    """Floquet multiplier of largest modulus; of a conjugate pair, the one with the positive imaginary part."""
    exponent: float = math.nan
    """Largest Lyapunov exponent, 1/s."""
    standard_error: float = math.nan
    """Its standard error, 1/s."""
    impulses: tuple[float, ...] = ()
    """Impulse of each stop over one excitation period, N s; empty if the solver gave up."""
    duration: float = math.nan
    """Duration of the motion whose contacts are kept, s."""
    contacts: tuple[tuple[int, float, float, float, float, int], ...] = ()
    """Stop, start after the motion's, s, duration, s, impulse, N s, peak force, N, and where it is cut."""
    growth: float = math.nan
    """Largest factor by which a deviation grew on the way to the motion; NaN if it was not measured."""
    message: str = ""
    """Why the solver gave up."""


def point_of(found: SteadyState) -> Point:
    """What is kept of a steady state."""
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
        growth=math.nan if growth is None else float(growth),
    )


def plain_section(point: SectionPoint) -> dict[str, Any]:
    """A section point as JSON can hold it; Python writes each float with the digits that give it back exactly."""
    plain = {"closed": list(point.state.closed), "coordinates": np.asarray(point.coordinates, dtype=float).tolist()}
    if point.nodes is not None:
        plain["nodes"] = np.asarray(point.nodes, dtype=float).tolist()
    return plain


def section_from(plain: dict[str, Any]) -> SectionPoint:
    """The section point that `plain_section` made plain."""
    nodes = np.array(plain["nodes"], dtype=float) if "nodes" in plain else None
    return SectionPoint(ContactState(tuple(plain["closed"])), np.array(plain["coordinates"], dtype=float), nodes)
