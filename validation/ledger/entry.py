"""One line of the ledger: what the paper says, what is computed, and what follows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from validation.case import Table, table
from validation.verdict import Estimate


class Ruling(Enum):
    """What becomes of a claim."""

    CONFIRMED = "confirmed"
    MISPRINT = "misprint"
    OVERTURNED = "overturned"
    UNDECIDABLE = "not decidable from the text"


@dataclass(frozen=True)
class Entry:
    """A claim, and what was found."""

    place: str
    """Where in the paper."""
    claim: str
    printed: str
    analytic: str
    """Recomputed by the analytic solver, with its uncertainty; empty where the claim is not about a motion."""
    fe: str
    """The same by finite elements."""
    published: str
    """By the paper's own scheme with its own numbers of modes, where that bears on the claim."""
    ruling: Ruling
    why: str
    evidence: str
    """The validation case, test or document that shows it."""


COLUMNS = ("place", "claim", "printed", "analytic", "FE", "scheme as published", "ruling", "why", "evidence")


def ledger_table(title: str, entries: Sequence[Entry]) -> Table:
    """Entries as a table of the report."""
    return table(
        title,
        COLUMNS,
        [
            (e.place, e.claim, e.printed, e.analytic, e.fe, e.published, e.ruling.value, e.why, e.evidence)
            for e in entries
        ],
    )


def counted(entries: Sequence[Entry]) -> str:
    """How many claims came to what."""
    counts = Counter(entry.ruling for entry in entries)
    return ", ".join(f"{counts[ruling]} {ruling.value}" for ruling in Ruling if counts[ruling])


def written(estimate: Estimate, digits: int = 7) -> str:
    """A number with its uncertainty."""
    return f"{estimate.value:.{digits}g} ± {estimate.uncertainty:.1g}"


def last_digit(text: str) -> float:
    """Half a unit of the last digit of a printed number."""
    mantissa, _, power = text.lower().replace(" %", "").partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))


def matches(value: float, text: str) -> bool:
    """Whether a computed value rounds to a printed one."""
    return abs(value - float(text.replace(" %", ""))) <= last_digit(text) * (1 + 1e-9)
