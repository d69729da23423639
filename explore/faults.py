"""What is wrong with a problem, and what looks like a slip, at the fields of its form."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable
from dataclasses import dataclass

from explore.question import Question
from lapjoint.errors import InputError
from lapjoint.problem import Problem


@dataclass(frozen=True)
class Checked:
    """A problem that was checked."""

    problem: Problem | None
    """The problem; None if it is not valid."""
    faults: tuple[tuple[str, str], ...]
    """Path of a field, or empty, and what is wrong there."""
    hints: tuple[tuple[str, str], ...] = ()
    """Path of a field, or empty, and what looks like a slip there."""


def checked(question: Question) -> Checked:
    """The problem of a question, with the messages about it that its file would get."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            problem = question.made()
    except InputError as error:
        return Checked(None, tuple(map(located, _lines(str(error)))))
    said = [*problem.hints, *(str(one.message) for one in caught)]
    return Checked(problem, (), tuple(map(located, said)))


def located(line: str) -> tuple[str, str]:
    """The path of the field that a message begins with, as forms have it, and the message; no path if it names none.

    A message says ``stops[1].gap = "wide": must be a number``; the form has this field at ``stops.1.gap``.
    """
    found = re.match(r"([a-z_]+(?:\[\d+\]|\.[a-z_]+)*)(?= = |: )", line)
    return (re.sub(r"\[(\d+)\]", r".\1", found[1]), line) if found else ("", line)


def at_fields(messages: Iterable[tuple[str, str]], paths: Iterable[str]) -> dict[str, list[str]]:
    """Messages by the longest of the paths of a form that leads to where they belong; under "" where there is none."""
    known = set(paths)
    found: dict[str, list[str]] = {}
    for path, message in messages:
        while path and path not in known:
            path = path.rpartition(".")[0]
        found.setdefault(path, []).append(message)
    return found


def _lines(message: str) -> list[str]:
    """The faults of a message about a problem, without the lines that introduce them."""
    lines = [line.strip() for line in message.removeprefix("problem: ").split("\n")]
    return [line for line in lines if not re.fullmatch(r"\d+ faults", line)]
