"""What pages of documentation show: fenced blocks, and sessions of the command line."""

from __future__ import annotations

import re
import shlex

from command_line import run_well


def blocks(language: str, text: str) -> list[str]:
    """The fenced blocks of a language on a page."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def assert_session(console: str) -> list[str]:
    """Run the commands of a block: each prints the lines below it, in their order; "..." stands for any line."""
    lines = []
    for part in console.split("$ lapjoint ")[1:]:
        line, _, shown = part.partition("\n")
        printed = iter(run_well(*shlex.split(line)).splitlines())
        for expected in shown.splitlines():
            assert expected == "..." or any(expected.rstrip() == one.rstrip() for one in printed), (line, expected)
        lines.append(line)
    return lines
