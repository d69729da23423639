"""The Tab key: scripts for three shells, and what they are told to offer."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

import lapjoint.cli.completing
from lapjoint.cli.main import main
from lapjoint.solver import solver_names
from validation.suite import case_names

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "commands.md").read_text(encoding="utf-8")
SHELLS = ("bash", "zsh", "fish")


def offered(*words: str, begun: str = "") -> list[tuple[str, str]]:
    """What is offered after some words, for one that is begun: kinds and values."""
    completing = ShellComplete(main, {}, "lapjoint", "_LAPJOINT_COMPLETE")
    return [(item.type, item.value) for item in completing.get_completions(list(words), begun)]


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_for_each_shell_is_made_as_the_page_says(shell: str) -> None:
    assert f"_LAPJOINT_COMPLETE={shell}_source lapjoint" in PAGE
    code = "import sys; sys.argv = ['lapjoint']; from lapjoint.cli.start import main; main()"
    environment = os.environ | {"_LAPJOINT_COMPLETE": f"{shell}_source"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr
    assert f"_LAPJOINT_COMPLETE={shell}_complete" in done.stdout
    if shutil.which(shell):
        subprocess.run([shell, "-n"], input=done.stdout, text=True, check=True, timeout=60)


def test_commands_options_and_choices_are_offered() -> None:
    assert {("plain", "steady"), ("plain", "sweep"), ("plain", "statistics")} <= set(offered(begun="s"))
    assert offered("steady", begun="--sol") == [("plain", "--solver")]
    assert offered("steady", "--draw", begun="p") == [("plain", "phase"), ("plain", "poincare"), ("plain", "psd")]


def test_problems_files_solvers_and_cases_are_offered() -> None:
    assert offered("steady", begun="pre") == [
        ("plain", "preset:paper"),
        ("plain", "preset:sdnl104"),
        ("plain", "preset:lap"),
        ("file", "pre"),
    ]
    assert [name for _, name in offered("modes", "--solver")] == list(solver_names())
    assert [name for _, name in offered("validate", "--case")] == list(case_names())
    assert offered("export", "preset:paper", "--out", begun="o") == [("dir", "o")]
    for words in (
        ("steady", "x", "--figure"),
        ("plot",),
        ("sweep", "x", "--out"),
        ("init",),
        ("steady", "x", "--json"),
    ):
        assert offered(*words) == [("file", "")], words


def test_every_option_that_takes_a_file_offers_files() -> None:
    context = main.make_context("lapjoint", ["--help"], resilient_parsing=True)
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        assert command is not None
        for parameter in command.params:
            if getattr(parameter, "metavar", None) in ("FILE", "DIR"):
                assert isinstance(parameter.type, lapjoint.cli.completing.Offering), (name, parameter.name)
