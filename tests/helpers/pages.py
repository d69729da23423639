"""What pages of documentation show: fenced blocks, and sessions of the command line."""

from __future__ import annotations

import re
import shlex

from command_line import run_well


def blocks(language: str, text: str) -> list[str]:
    """The fenced blocks of a language on a page."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]\d+)?|\?")
SCATTER = 0.25
"""Relative difference of a statistic of a chaotic motion from processor to processor; the pages use means of many
contacts, whose intervals are a tenth."""


def assert_session(console: str) -> list[str]:
    """Run the commands of a block: each prints the lines below it, as `assert_shown` compares them."""
    lines = []
    for line, shown in sessions(console):
        assert_shown(line, shown, run_well(*shlex.split(line)))
        lines.append(line)
    return lines


def sessions(console: str) -> list[tuple[str, str]]:
    """The commands of a block, without the name of the program, each with what stands below it."""
    parts = (part.partition("\n") for part in console.replace("\\\n", "").split("$ lapjoint ")[1:])
    return [(line, shown) for line, _, shown in parts]


def assert_shown(line: str, shown: str, printed: str) -> None:
    """A command prints the lines below it, in their order; "..." stands for any line.

    Of statistics each row has its words and its first number, to `SCATTER`: rounding leads to another chaotic motion.
    """
    same = alike if line.startswith("statistics") else str.__eq__
    rows = iter(printed.splitlines())
    for expected in shown.splitlines():
        assert expected == "..." or any(same(expected.rstrip(), one.rstrip()) for one in rows), (line, expected)


def alike(expected: str, printed: str) -> bool:
    """Whether a row has the words of another, and nearly its first number in a column."""
    (words, numbers), (others, found) = (_parts(row) for row in (expected, printed))
    if words != others or len(numbers) != len(found):
        return False
    return not numbers or abs(found[0] - numbers[0]) <= SCATTER * abs(numbers[0])


def _parts(row: str) -> tuple[list[str], list[float]]:
    """The words of a row, and the numbers of its columns, which stand behind two spaces."""
    cells = re.split(r"\s{2,}", row.strip())
    numbers = [float(cell.replace("?", "inf")) for cell in cells if NUMBER.fullmatch(cell)]
    return [cell for cell in cells if not NUMBER.fullmatch(cell)], numbers
