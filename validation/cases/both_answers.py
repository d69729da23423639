"""What the command line prints of a steady state or of statistics, by both solvers side by side, and compared."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from lapjoint import Problem
from lapjoint.summaries.blocks import Block, Number, Row
from validation.case import Table, table
from validation.statistics_estimates import joint_factor
from validation.verdict import Check, ErrorSource, Estimate

SIDE_BY_SIDE = 2
"""Most numbers of a row for which both solvers stand side by side; with more they stand one below the other."""
SURE = 0.95
"""Probability with which all intervals of statistics that are compared are to hold together."""
STANDARD_ERRORS = 2.0
"""Standard errors in the expanded uncertainty of a mean over a motion that does not repeat."""
NONE = "–"
LARGEST = "largest"


@dataclass(frozen=True)
class Pair:
    """A row of each solver; None where a solver has no such row."""

    label: str
    """The quantity, of a block of several."""
    where: str
    rows: tuple[Row | None, ...]
    """One for each solver."""


def pairs(blocks: Sequence[Block | None]) -> list[Pair]:
    """The rows of one block by each solver, matched by quantity and by place or stop; None for a solver without it.

    Where all solvers have the largest value at one place that was asked for, that row says so, and there is no other.
    """
    found = [{} if block is None else {(row.of, _key(row)): row for row in block.rows} for block in blocks]
    result: dict[tuple[str, str | int], Pair] = {}
    for label, key in dict.fromkeys(itertools.chain(*found)):
        rows = tuple(of.get((label, key)) for of in found)
        places = list(dict.fromkeys(row.where for row in rows if row is not None))
        if key == LARGEST and len(places) == 1 and all(row is not None and row.asked for row in rows):
            asked = (label, places[0])
            result[asked] = replace(result[asked], where=f"{places[0]}, {LARGEST}")
        else:
            where = f"{LARGEST}, at {' and '.join(places)}" if key == LARGEST else places[0]
            result[label, key] = Pair(label, where, rows)
    return list(result.values())


def _key(row: Row) -> str | int:
    return LARGEST if row.largest else row.where if row.stop is None else row.stop


def matched(blocks: Mapping[str, Sequence[Block]]) -> list[tuple[str, tuple[str, ...], list[Pair]]]:
    """Title, heads and rows of all blocks, those with equal titles together."""
    first = {block.title: block for each in blocks.values() for block in each}
    found = []
    for title, block in first.items():
        each = [next((b for b in several if b.title == title), None) for several in blocks.values()]
        found.append((title, block.heads, pairs(each)))
    return found


def tables_of(problem: Problem, blocks: Mapping[str, Sequence[Block]]) -> tuple[Table, ...]:
    """The blocks of each solver, by its name, as tables of both."""
    place, solvers = "place x [m]" if not problem.line.several else "place, beam:x [m]", tuple(blocks)
    tables: list[Table] = []
    for single, group in itertools.groupby(matched(blocks), key=lambda block: block[1] == ("",)):
        several = list(group)
        if single and len(several) > 1:  # one number of each stop or of the whole: all such blocks make one table
            labelled = [replace(pair, label=title) for title, _, rows in several for pair in rows]
            tables.append(_side_by_side("Of each stop, and of the whole", ("",), labelled, solvers, "of"))
            continue
        for title, heads, rows in several:
            if len(heads) > SIDE_BY_SIDE:
                tables.append(_below_each_other(title, heads, rows, solvers))
            else:
                where = place if any(pair.label for pair in rows) else "stop"
                tables.append(_side_by_side(title, heads, rows, solvers, where))
    return tuple(tables)


def _side_by_side(
    title: str, heads: tuple[str, ...], rows: Sequence[Pair], solvers: tuple[str, ...], where: str
) -> Table:
    grouped = any(pair.label for pair in rows)
    columns = [f"{head}, {solver}" if head else solver for head in heads for solver in solvers]
    written = [
        [
            *([pair.label] if grouped else []),
            pair.where,
            *(_text(row, i) for i in range(len(heads)) for row in pair.rows),
        ]
        for pair in rows
    ]
    first = ["quantity", where] if grouped else [where]
    return table(title, [*first, *columns], written, grouped=grouped)


def _below_each_other(title: str, heads: tuple[str, ...], rows: Sequence[Pair], solvers: tuple[str, ...]) -> Table:
    written = [
        [pair.where, solver, *(_text(row, i) for i in range(len(heads)))]
        for pair in rows
        for solver, row in zip(solvers, pair.rows, strict=True)
    ]
    return table(title, ["stop", "solver", *heads], written, grouped=True)


def _text(row: Row | None, i: int) -> str:
    number = row.numbers[i] if row is not None and i < len(row.numbers) else None
    return NONE if number is None else number.with_error


@dataclass(frozen=True)
class How:
    """How the numbers of a solver were obtained."""

    text: str
    source: ErrorSource
    sampled: bool = False
    """Whether errors are standard errors of means over a finite time."""


def checks_of(
    blocks: Mapping[str, Sequence[Block]], how: Sequence[How], explanation: str = ""
) -> tuple[list[Check], int]:
    """Comparisons of all numbers of which both solvers state a finite error, and how many have no such error."""
    both = list(_numbers(blocks))
    known = [(name, unit, numbers) for name, unit, numbers in both if _uncertain(numbers, how)]
    joint = joint_factor(max(len(known), 1), SURE)
    checks = []
    for name, unit, numbers in known:
        a, b = (_estimate(number, of, joint) for number, of in zip(numbers, how, strict=True))
        checks.append(Check(name, unit, a, b, explanation=explanation))
    return checks, sum(not all(math.isfinite(_half_width(number)) for number in numbers) for *_, numbers in both)


def _numbers(blocks: Mapping[str, Sequence[Block]]) -> Iterator[tuple[str, str, list[Number]]]:
    """Name, unit, and the number of each solver, of all that both solvers have with an error or an interval."""
    for title, heads, rows in matched(blocks):
        for pair in rows:
            unit = re.search(r"\[(.*)\]", pair.label or title)
            what = re.sub(r" \[.*", "", pair.label) or re.sub(r" \[.*\]", "", title)
            at = f"at {pair.where}" if pair.label and not pair.where.startswith(LARGEST) else pair.where
            apart = len({row.where for row in pair.rows if row is not None}) > 1
            for i, head in enumerate(heads[:1] if apart else heads):  # of two places only the largest value is one
                numbers = [row.numbers[i] for row in pair.rows if row is not None and i < len(row.numbers)]
                found = [n for n in numbers if n is not None and not (n.error is None and n.interval is None)]
                if len(found) == len(pair.rows):
                    kind = title if pair.label and not head else head
                    yield ", ".join(filter(None, (what, at, kind))), unit[1] if unit else "1", found


def _half_width(number: Number) -> float:
    if number.interval is not None:
        return max(abs(end - number.value) for end in number.interval)
    return math.inf if number.error is None else number.error


def _uncertain(numbers: Sequence[Number], how: Sequence[How]) -> bool:
    """Whether all errors are finite, and no mean over a finite time is 0 by a condition at an end.

    Such a mean is that of the moment at a free end.  Finite elements fulfil the condition the better the finer they
    are, and an error of sampling does not hold that difference.
    """
    zero = [number.value == 0 and _half_width(number) == 0 for number in numbers]
    sampled = any(of.sampled or number.interval is not None for of, number in zip(how, numbers, strict=True))
    if all(zero) or (any(zero) and sampled):
        return False
    return all(math.isfinite(_half_width(number)) and math.isfinite(number.value) for number in numbers)


def _estimate(number: Number, how: How, joint: float) -> Estimate:
    """A number with its expanded uncertainty; that of means over a finite time is to hold for all of them together."""
    if number.interval is None and not how.sampled:
        return Estimate(number.value, _half_width(number), how.text, parts=((how.source, _half_width(number)),))
    u = joint * _half_width(number) * (1.0 if number.interval is not None else STANDARD_ERRORS)
    return Estimate(number.value, u, f"{how.text}, widened by {joint:.2f}", parts=((how.source, u),))
