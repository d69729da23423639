"""Commands of other packages join those of lapjoint by their entry points."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run

from lapjoint.cli.main import main


@pytest.fixture
def other_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package with one command that works, and one whose module is missing."""
    (tmp_path / "joining_command.py").write_text(
        "import click\n\n@click.command()\ndef greet():\n    'Say hello.'\n    click.echo('hello')\n"
    )
    about = tmp_path / "joining_command-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: joining-command\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[lapjoint.commands]\ngreet = joining_command:greet\nbroken = no_such_module:command\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("other_package")
def test_a_command_joins_by_its_entry_point() -> None:
    assert "Say hello." in run("--help").output
    assert run("greet").output == "hello\n"


@pytest.mark.usefixtures("other_package")
def test_a_command_that_cannot_be_loaded_says_so_and_leaves_the_others_usable() -> None:
    done = run("broken", "--option", "value")
    assert done.exit_code == 1
    assert "command 'broken' is installed but cannot be loaded: No module named 'no_such_module'" in done.output
    assert run("--help").exit_code == 0


def test_validate_is_such_a_command() -> None:
    assert "report.html" in run("validate", "--help").output
    assert "validate" not in main.commands
    assert "table4" in run("validate", "--list").output


def test_the_package_runs_as_the_command() -> None:
    for option, begins in (("--version", "lapjoint, version"), ("-h", "Usage: python -m lapjoint")):
        done = subprocess.run([sys.executable, "-m", "lapjoint", option], capture_output=True, text=True, check=True)
        assert done.stdout.startswith(begins)
