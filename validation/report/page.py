"""The page for people: the contents of each case, their order, and their anchors."""

from __future__ import annotations

import base64
import hashlib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from lapjoint.figures.text import hertz
from validation.case import CaseResult, Drawing, Table
from validation.report.own import OwnProblem
from validation.report.records import VERDICTS, checks_sheet, counts, criteria_sheet, tightest
from validation.report.table_files import FOLDER, Sheet, distinct
from validation.report.uncertainty_budget import budget_sheet
from validation.verdict import Check, Criterion, Verdict

PRINT_SCRIPT = (
    'addEventListener("beforeprint",()=>{for(const d of document.querySelectorAll("details.case:not([open])"))'
    '{d.open=true;d.dataset.shut=""}});'
    'addEventListener("afterprint",()=>{for(const d of document.querySelectorAll("details[data-shut]"))'
    "{d.open=false;delete d.dataset.shut}});"
    "const show=()=>{let e=location.hash&&document.getElementById(decodeURIComponent(location.hash.slice(1)));"
    "if(!e)return;for(let d=e;d;d=d.parentElement)if(d.tagName==='DETAILS')d.open=true;e.scrollIntoView()};"
    'addEventListener("hashchange",show);addEventListener("DOMContentLoaded",show);'
)
"""Opens the folded cases for printing, and the case that holds the target of a link, in browsers that do not do so
themselves."""
_ON_PAPER = 36
"""Most rows of the answer that are printed: with more, a place of the beam is left out unless a quantity is largest
there, so that two pages are enough."""
PICTURED = ("ledger", "steady", "transient")
"""Cases whose first figure may stand on the first screen, the best first."""


_DOES = {Verdict.AGREE: "agree", Verdict.EXPLAINED: "differ for a named reason", Verdict.DISAGREE: "disagree"}


@dataclass(frozen=True)
class Finding:
    """Items that do not agree, and share an explanation."""

    verdict: Verdict
    explanation: str
    items: tuple[tuple[str, Check | Criterion], ...]
    """Items, each with the anchor of its row."""


@dataclass(frozen=True)
class View:
    """A case as the page shows it."""

    result: CaseResult
    anchor: str

    @cached_property
    def checks(self) -> list[tuple[str, Check]]:
        """Checks with their anchors, disagreements first."""
        return [(f"{self.anchor}-check-{i + 1}", c) for i, c in _worst_first(self.result.checks)]

    @cached_property
    def criteria(self) -> list[tuple[str, Criterion]]:
        """Criteria with their anchors, disagreements first."""
        return [(f"{self.anchor}-criterion-{i + 1}", c) for i, c in _worst_first(self.result.criteria)]

    @cached_property
    def findings(self) -> list[Finding]:
        """Disagreements, then explained differences, grouped by explanation."""
        groups: dict[tuple[Verdict, str], list[tuple[str, Check | Criterion]]] = {}
        items: list[tuple[str, Check | Criterion]] = [*self.checks, *self.criteria]
        for anchor, item in items:
            if item.verdict is not Verdict.AGREE:
                groups.setdefault((item.verdict, getattr(item, "explanation", "")), []).append((anchor, item))
        ordered = sorted(groups.items(), key=lambda group: VERDICTS.index(group[0][0]))
        return [Finding(verdict, why, tuple(items)) for (verdict, why), items in ordered]

    @property
    def headline(self) -> str:
        """The result of the case in a line: its own words, or how many comparisons agree."""
        if self.result.headline:
            return self.result.headline
        found = [f"{self.counts[v]} {_DOES[v]}" for v in reversed(VERDICTS) if self.counts[v]]
        return ", ".join(found) or "nothing was compared"

    @property
    def counts(self) -> dict[Verdict, int]:
        """Number of comparisons of each verdict."""
        return counts(self.result)

    def evidence(self, verdict: Verdict) -> str:
        """Anchor of the comparisons behind a count of verdicts."""
        if verdict is not Verdict.AGREE:
            return f"{self.anchor}-findings"
        return f"{self.anchor}-{'checks' if self.result.checks else 'criteria'}"

    @cached_property
    def tightest(self) -> tuple[str, Check] | None:
        """The check with the largest difference over the allowed one."""
        found = tightest(self.result)
        return next(((anchor, check) for anchor, check in self.checks if check is found), None)

    @cached_property
    def checks_sheet(self) -> Sheet:
        """Files of the checks."""
        return checks_sheet(self.result, f"{self.anchor}-checks")

    @cached_property
    def criteria_sheet(self) -> Sheet:
        """Files of the criteria."""
        return criteria_sheet(self.result, f"{self.anchor}-criteria")

    @cached_property
    def budget_sheet(self) -> Sheet:
        """Files of the uncertainty budget."""
        return budget_sheet(self.result, f"{self.anchor}-budget")

    @cached_property
    def tables(self) -> list[Sheet]:
        """The case's own tables."""
        return self._sheets("table", self.result.tables)

    @cached_property
    def answer(self) -> list[Sheet]:
        """Tables of the answer to the user's question."""
        return self._sheets("answer", self.result.answer)

    @cached_property
    def certificate(self) -> list[Sheet]:
        """Tables that say how the answer was established."""
        return self._sheets("certificate", self.result.certificate)

    def _sheets(self, kind: str, tables: Sequence[Table]) -> list[Sheet]:
        names = distinct([f"{kind} {table.title}" for table in tables])
        return [
            Sheet(f"{self.anchor}-{name}", table.title, table.columns, table.rows, table.grouped)
            for name, table in zip(names, tables, strict=True)
        ]

    @property
    def sheets(self) -> list[Sheet]:
        """Everything of the case that becomes files."""
        found = [self.checks_sheet, self.budget_sheet] if self.result.checks else []
        found += [self.criteria_sheet] if self.result.criteria else []
        return [*found, *self.tables, *self.answer, *self.certificate]

    @property
    def drawings(self) -> list[tuple[str, Drawing]]:
        """Anchor and figure of each, its ids its own within the page."""
        anchors = [f"{self.anchor}-figure-{i + 1}" for i in range(len(self.result.drawings))]
        return [(a, with_own_ids(d, a)) for a, d in zip(anchors, self.result.drawings, strict=True)]


def _worst_first(items: Sequence[Any]) -> list[tuple[int, Any]]:
    return sorted(enumerate(items), key=lambda item: VERDICTS.index(item[1].verdict))


def views(results: Sequence[CaseResult]) -> list[View]:
    """Each case with an anchor of its own."""
    anchors = distinct([f"case {result.name}" for result in results])
    return [View(result, anchor) for result, anchor in zip(results, anchors, strict=True)]


def own_ids(svg: str, prefix: str) -> str:
    """An SVG whose ids, and references to them, carry a prefix."""
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', svg)
    return re.sub(r'(href="#|url\(#)([^")]+)', rf"\1{prefix}-\2", svg)


def with_own_ids(drawn: Drawing, prefix: str) -> Drawing:
    """A figure whose ids carry a prefix, in the page's own drawing and in that for narrow screens."""
    return Drawing(drawn.title, own_ids(drawn.svg, prefix), own_ids(drawn.narrow, f"{prefix}-narrow"))


def sentence(results: Sequence[CaseResult]) -> str:
    """The verdict on everything, in a sentence."""
    found = {v: sum(counts(result)[v] for result in results) for v in VERDICTS}
    total, differ, named = sum(found.values()), found[Verdict.DISAGREE], found[Verdict.EXPLAINED]
    if not total:
        return "Nothing was compared."
    if differ:
        titles = ", ".join(r.title for r in results if r.verdict is Verdict.DISAGREE)
        return f"{differ} of {total} comparisons {'disagrees' if differ == 1 else 'disagree'}: see {titles}."
    if named:
        verb = "differs for a reason that is" if named == 1 else "differ for reasons that are"
        return f"Nothing disagrees: {total - named} of {total} comparisons agree, and {named} {verb} named."
    return "The one comparison agrees." if total == 1 else f"All {total} comparisons agree."


def significant(value: float, uncertainty: float) -> str:
    """A number down to the first digit of its uncertainty; nine digits if the uncertainty is 0 or not finite."""
    digits = 9
    if value and math.isfinite(value) and uncertainty > 0 and math.isfinite(uncertainty):
        digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(uncertainty)) + 1
    text = f"{value:#.{min(max(digits, 2), 15)}g}"
    return text.rstrip(".")


def short(value: float, digits: int = 2) -> str:
    """A number to two digits; from 10 to 100000 it is rounded to a whole number."""
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    if math.isfinite(value) and 10 ** (digits - 1) <= abs(value) < 1e5:
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


def first_picture(shown: Sequence[View]) -> Drawing | None:
    """The figure for the first screen; None where no case of `PICTURED` has one."""
    found = {view.result.name: view.result.drawings[0] for view in shown if view.result.drawings}
    return next((with_own_ids(found[name], "first") for name in PICTURED if name in found), None)


def answering(shown: Sequence[View]) -> list[View]:
    """The cases whose answers stand on the first page: first contacts only where there is nothing that lasts."""
    found = [view for view in shown if view.answer]
    lasts = any(view.result.name in ("steady", "statistics") for view in found)
    return [view for view in found if view.result.name != "transient" or not lasts]


def page(
    shown: Sequence[View],
    overall: Mapping[str, Sheet],
    about: Mapping[str, Any],
    joint: Drawing,
    own: OwnProblem | None = None,
) -> str:
    """The page as HTML."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("validation.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters.update(short=short, hertz=hertz)
    digest = base64.b64encode(hashlib.sha256(PRINT_SCRIPT.encode()).digest()).decode()
    return environment.get_template("report.html.j2").render(
        views=shown,
        overall=overall,
        about=about,
        own=own,
        answering=answering(shown),
        crowded=sum(len(sheet.rows) for view in answering(shown) for sheet in view.answer) > _ON_PAPER,
        joint=with_own_ids(joint, "joint"),
        picture=first_picture(shown),
        sentence=sentence([view.result for view in shown]),
        worst=next((v for v in VERDICTS if any(view.counts[v] for view in shown)), None),
        significant=significant,
        verdicts=VERDICTS,
        folder=FOLDER,
        script=PRINT_SCRIPT,
        digest=digest,
    )
