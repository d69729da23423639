"""What a report of an own problem says on its first pages: what was asked, and what the answer assumes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lapjoint.problem import Problem
from validation.case import CaseResult
from validation.report.asked import problem_sheets
from validation.report.assumed import assumptions
from validation.report.table_files import Sheet


@dataclass(frozen=True)
class OwnProblem:
    """The problem of a report, in words and tables."""

    title: str
    source: str
    """Where the problem comes from, as the command line names it; may be empty."""
    asked: tuple[Sheet, ...]
    """The problem, as tables."""
    assumed: tuple[str, ...]
    """What the answer assumes, in sentences."""
    commands: tuple[str, ...]
    """Commands that print the answer again."""


def own_problem(problem: Problem, source: str, results: Sequence[CaseResult]) -> OwnProblem:
    """What the first pages say of a problem, and of the cases that were run."""
    assumed = [*assumptions(problem), *(sentence for result in results for sentence in result.assumed)]
    commands = tuple(_commands(source, results)) if source else ()
    return OwnProblem(problem.title, source, tuple(problem_sheets(problem)), tuple(assumed), commands)


def _commands(source: str, results: Sequence[CaseResult]) -> Iterator[str]:
    """The commands that print the same numbers, one for each solver."""
    for result in results:
        for arguments in result.commands:
            yield f"lapjoint {arguments.format(problem=source)}"
