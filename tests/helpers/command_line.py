"""The command line, run within the process, and the problem that most of its tests are about."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner, Result

from lapjoint import paper_joint
from lapjoint.cli.main import main
from lapjoint.problem.files import to_toml

PAPER = "preset:paper"
FEW = ("--n-modes", "8")  # the least that is quick; no accuracy is asked of these tests
SIMULATE = ("simulate", PAPER, "--duration", "0.01")


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def run_well(*arguments: str | Path) -> str:
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


def assert_refused(result: Result, message: str, lines: int | None = None) -> None:
    """Bad input has a message, perhaps of some lines besides hints, its exit status, and no traceback."""
    assert result.exit_code == (3 if "cannot be written" in result.stderr else 2), result.output
    assert isinstance(result.exception, SystemExit)
    assert message in result.stderr
    assert result.stderr.startswith(("lapjoint: ", "Usage: "))
    assert "Traceback" not in result.output
    said = [line for line in result.stderr.splitlines() if not line.startswith("lapjoint: hint: ")]
    assert lines is None or len(said) == lines, said


def problem_file(tmp_path: Path, change: str = "", to: str = "") -> Path:
    text = to_toml(paper_joint())
    assert change in text
    path = tmp_path / "problem.toml"
    path.write_text(text.replace(change, to, 1))
    return path
