"""A small made-up set of results that has everything a report must show, and texts that try to break it."""

from __future__ import annotations

import math

from validation.case import CaseResult, Drawing, table
from validation.report.drawing import draw
from validation.verdict import Check, Criterion, ErrorSource, Estimate, Kind

HOSTILE = '<script>alert("&")</script> "=1+1" \'é'


def estimate(value: float, u: float, kind: Kind = Kind.COMPUTED, source: ErrorSource = ErrorSource.MESH) -> Estimate:
    parts = ((source, 0.75 * u), (ErrorSource.ROUNDING, 0.25 * u)) if kind is Kind.COMPUTED else ()
    return Estimate(value, u, f"{HOSTILE}, 64 elements", kind, parts)


def checks() -> tuple[Check, ...]:
    a = estimate(1.0, 1e-3, source=ErrorSource.MODES)
    return (
        Check("agrees", "N s", a, estimate(1.0005, 1e-3), cap=1e-2),
        Check(f"differs {HOSTILE}", "N s", a, estimate(2.0, 1e-3)),
        Check("beyond the cap", "N s", estimate(1.0, 1.0), estimate(1.5, 1.0), cap=1e-3),
        Check("misprint", "rad/s", a, estimate(1.1, 5e-2, Kind.PUBLISHED), explanation=f"Known. {HOSTILE}"),
        Check("misprint again", "rad/s", a, estimate(1.2, 5e-2, Kind.PUBLISHED), explanation=f"Known. {HOSTILE}"),
        Check("without uncertainty", "1", estimate(1.0, 0.0), estimate(1.0, 0.0, Kind.ANALYTICAL)),
        Check("not a number", "1", estimate(math.nan, 1.0), estimate(1.0, math.inf, Kind.REGRESSION)),
        *(Check(f"one of many {i}", "s", a, estimate(1.0, 1e-3, Kind.OTHER_CODE)) for i in range(30)),
    )


def criteria() -> tuple[Criterion, ...]:
    return (
        Criterion("observed order", "1", 4.0, 3.9, 4.1, HOSTILE),
        Criterion("energy created", "1", 1.0, -math.inf, 1e-5, "a limit without an end"),
    )


def drawings() -> tuple[Drawing, ...]:
    one = draw(HOSTILE, lambda axes: axes.plot([0, 1], [0, 1]) and None, width=3.0, height=2.0)
    return one, one


def everything() -> list[CaseResult]:
    """A case with all there is, one that agrees, one with criteria alone, one with nothing, and a name twice."""
    rows = [(HOSTILE, i, 1.5 * i, "1.5 +- 0.1") for i in range(40)]
    tables = (
        table(HOSTILE, ("a", "b", "c", HOSTILE), rows),
        table(HOSTILE, ("a",), [(1,)]),
        table("empty", ("a",), []),
    )
    return [
        CaseResult(
            f"all {HOSTILE}",
            HOSTILE,
            f"Why? {HOSTILE}",
            checks(),
            criteria(),
            tables,
            drawings(),
            (HOSTILE,),
            HOSTILE,
            1.0,
        ),
        CaseResult("twice", "It agrees", "Does it?", checks()[:1], seconds=2.0),
        CaseResult("twice", "Criteria only", "Are they met?", criteria=criteria()[:1]),
        CaseResult("nothing", "Nothing", "What?"),
    ]
