"""What both solvers answer at the chosen frequency, as tables of HTML with the verdict above them."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from explore.answers import Cycle, Natural
from lapjoint.figures.text import hertz
from validation.case import CaseResult, Table
from validation.verdict import Verdict

STYLE = """
:host { font-size: 0.9rem; --line: color-mix(in srgb, currentColor 20%, transparent) }
table { border-collapse: collapse; margin: 0.2rem 0 1rem; width: 100%; font-variant-numeric: tabular-nums }
caption { text-align: left; font-weight: 600; padding: 0.3rem 0 }
th, td { text-align: left; vertical-align: top; padding: 0.15rem 0.8rem 0.15rem 0 }
th, td { border-bottom: 1px solid var(--line) }
.table { overflow-x: auto }
.verdict { font-size: 1.05rem; font-weight: 600; border-left: 6px solid; padding: 0.3rem 0.7rem; margin: 0 0 0.6rem }
.agree { border-color: #009e73 }
.explained { border-color: #e69f00 }
.disagree { border-color: #d55e00 }
.wait { border-color: gray; font-weight: 400 }
"""
NATURAL = 3
"""Number of natural frequencies that are shown: those that most joints are shaken near."""
_SAID = {
    Verdict.AGREE: "The solvers agree",
    Verdict.EXPLAINED: "The solvers differ, and the reason is known",
    Verdict.DISAGREE: "The solvers disagree",
}
OWN = "A solver fails a check of its own"
"""The verdict where the numbers of both solvers agree, and an invariant of one of them does not hold."""


def natural_line(natural: Natural) -> str:
    """Natural frequencies as a line of HTML."""
    numbers = ", ".join(f"{omega:.4g} rad/s ({hertz(omega)} Hz)" for omega in natural.angular_frequencies[:NATURAL])
    return f"<p>Natural frequencies with all stops open: {numbers}</p>"


def verdict_line(result: CaseResult | None, cycles: Mapping[str, Cycle], failed: str) -> str:
    """The verdict as a line of HTML, or what is still missing for one."""
    if failed:
        return _line("disagree" if cycles else "wait", failed)
    if result is None:
        waiting = "Computing the cycle ..." if not cycles else "The other solver is still computing ..."
        slow = any(not cycle.multipliers for cycle in cycles.values())
        return _line("wait", waiting + " It takes minutes for a motion that does not repeat." * slow)
    left = [item for item in result.items if item.verdict is not Verdict.AGREE]
    numbers = (
        f"{len(result.items) - len(left)} of {len(result.items)} comparisons and invariants hold within stated errors"
    )
    own = result.verdict is Verdict.DISAGREE and all(check.verdict is not Verdict.DISAGREE for check in result.checks)
    lines = "".join(f"<li>{escape(item.line)}</li>" for item in left)
    said = _line(result.verdict.value, f"{OWN if own else _SAID[result.verdict]}: {numbers}.")
    return said + (f"<ul>{lines}</ul>" if lines else "")


def _line(kind: str, text: str) -> str:
    return f'<p class="verdict {kind}">{escape(text)}</p>'


STALE = _line("wait", "The problem is not valid; this is the cycle of the last one that was.")
BEFORE = "<p>What is below is of the question before.</p>"


def tables(result: CaseResult | None, cycles: Mapping[str, Cycle]) -> str:
    """All tables as HTML: of both solvers side by side, or of the one that is done."""
    if result is not None:
        notes = "".join(f"<p>{escape(note)}</p>" for note in result.notes)
        return notes + "".join(map(_table, (*result.answer, *result.certificate)))
    return "".join(_table(table) for cycle in cycles.values() for table in cycle.tables)


def _table(table: Table) -> str:
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in table.columns)
    rows, before = [], None
    for row in table.rows:
        first = "" if table.grouped and row[0] == before else row[0]
        before = row[0]
        rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in (first, *row[1:])) + "</tr>")
    title, body = escape(table.title), "".join(rows)
    content = f"<caption>{title}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f'<div class="table" tabindex="0" role="group" aria-label="{title}"><table>{content}</table></div>'
