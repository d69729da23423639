"""One line of the ledger: what the paper says, what is computed, and what follows."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from validation.case import Table, table
from validation.ledger.rules import Numbers, Rule, Ruling, rule_of
from validation.references.reading import Printed, Source, printed, sources
from validation.verdict import Estimate

DATA = Path(__file__).with_name("claims.toml")
TIP = 2.5  # Position of the tip of the paper's beam, m from the root


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, and the ruling that is expected."""

    key: str
    place: str
    """Place in the paper."""
    claim: str
    printed: str
    expected: Ruling
    evidence: str
    """The validation case, test or document that shows it."""
    source: Source

    @property
    def number(self) -> Printed:
        """The printed value, where it is a number; a percent sign is left out."""
        return Printed(self.printed.replace(" %", ""), "", self.place, self.source)


@cache
def claims() -> dict[str, Claim]:
    """All claims, by key."""
    data = tomllib.loads(DATA.read_text(encoding="utf-8"))
    source, found = sources()[data["source"]], {}
    for key, given in data["claims"].items():
        text = given["printed"] if "printed" in given else printed(*given["printed_in"]).text
        ruling = Ruling(given["expected"])
        found[key] = Claim(key, given["place"], given["claim"], text, ruling, given["evidence"], source)
    return found


@dataclass(frozen=True)
class Entry:
    """A claim, its computed numbers, and the ruling."""

    key: str
    numbers: Numbers
    """Numbers from which the ruling follows."""
    why: str
    analytic: str = ""
    """Value by the analytic solver, with its uncertainty; empty where the claim is not about a motion."""
    fe: str = ""
    """Value by finite elements, with its uncertainty."""
    published: str = field(default="")
    """Value by the paper's own scheme with its own numbers of modes, where it bears on the claim."""

    @property
    def claim(self) -> Claim:
        """The claim of the paper."""
        return claims()[self.key]

    @property
    def rule(self) -> Rule:
        """The rule that turns the numbers into the ruling."""
        return rule_of(self.key)

    @property
    def ruling(self) -> Ruling:
        """The ruling on the claim."""
        return self.rule.judge(self.numbers)


COLUMNS = ("place", "claim", "printed", "analytic", "FE", "scheme as published", "ruling", "why", "rule", "evidence")


def ledger_table(title: str, entries: Sequence[Entry]) -> Table:
    """Entries as a table of the report."""
    rows = []
    for e in entries:
        said = (e.claim.place, e.claim.claim, e.claim.printed)
        rows.append((*said, e.analytic, e.fe, e.published, e.ruling.value, e.why, e.rule.words, e.claim.evidence))
    return table(title, COLUMNS, rows)


def counted(entries: Sequence[Entry]) -> str:
    """Number of claims by ruling."""
    counts = Counter(entry.ruling for entry in entries)
    return ", ".join(f"{counts[ruling]} {ruling.value}" for ruling in Ruling if counts[ruling])


def written(estimate: Estimate, digits: int = 7) -> str:
    """A number with its uncertainty."""
    return f"{estimate.value:.{digits}g} ± {estimate.uncertainty:.1g}"


def said(key: str) -> dict[str, float]:
    """The printed number of a claim, and half a unit of its last digit, for its rule."""
    number = claims()[key].number
    return {"printed": number.value, "half unit": number.half_unit}
