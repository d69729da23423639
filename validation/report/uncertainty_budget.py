"""The uncertainty budget: what contributes to the uncertainty against which a difference is judged.

Within one number the contributions add up, ``u = sum u_i``; two numbers combine as ``U^2 = u_a^2 + u_b^2``.  A source's
share of U^2 is therefore ``sum u_i u / U^2`` over both numbers; the shares of all sources add up to one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.case import CaseResult
from validation.report.table_files import Cell, Sheet
from validation.verdict import Check, source_name


def shares(check: Check) -> dict[str, float]:
    """Share of each source in the combined uncertainty squared, largest first; empty where there is none."""
    whole = check.allowed**2
    if not (math.isfinite(whole) and whole > 0):
        return {}
    found: dict[str, float] = {}
    for estimate in (check.a, check.b):
        for source, amount in estimate.contributions:
            name = source_name(source)
            found[name] = found.get(name, 0.0) + amount * estimate.uncertainty / whole
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def sources(checks: Sequence[Check]) -> tuple[str, ...]:
    """All sources of some checks, in the order in which they first appear."""
    return tuple(dict.fromkeys(source for check in checks for source in shares(check)))


def budget_sheet(result: CaseResult, name: str) -> Sheet:
    """Shares of each source, check by check, in percent."""
    columns = sources(result.checks)
    rows: list[tuple[Cell, ...]] = []
    for check in result.checks:
        found = shares(check)
        size = max(abs(check.a.value), abs(check.b.value))
        relative = check.allowed / size if size else math.nan
        parts = (round(100 * found.get(source, 0.0), 2) for source in columns)
        rows.append((check.name, check.unit, check.allowed, relative, next(iter(found), ""), *parts))
    heads = ("quantity", "unit", "allowed", "relative to the value", "leading source")
    title = f"Uncertainty budget: {result.title}"
    return Sheet(name, title, (*heads, *(f"{source}, %" for source in columns)), tuple(rows))


def overall_sheet(results: Sequence[CaseResult]) -> Sheet:
    """For each case and source: in how many quantities it has a part, in how many it leads, and its largest share."""
    rows: list[tuple[Cell, ...]] = []
    for result in results:
        found = [shares(check) for check in result.checks]
        for source in sources(result.checks):
            has = [s[source] for s in found if s.get(source, 0.0) > 0]
            leads = sum(next(iter(s)) == source for s in found if s)
            if has:
                rows.append((result.title, source, len(has), leads, round(100 * max(has), 2)))
    columns = ("case", "source", "quantities with a part of it", "quantities it leads", "largest share, %")
    return Sheet("budget", "Uncertainty budget of all cases", columns, tuple(rows))
