"""What the README promises is run."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from lapjoint.cli.main import main

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_the_two_commands_are_one_line_each() -> None:
    validate, test = blocks("sh")
    for command, ending in ((validate, ".venv/bin/lapjoint validate\n"), (test, ".venv/bin/pytest -n 2\n")):
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install -q -e ")
        assert command.endswith(ending)
        assert command.count("\n") == 1
    for check in ("ruff check .", "ruff format --check .", "mypy"):
        assert f".venv/bin/{check} &&" in test


def test_ci_runs_the_readmes_test_command() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    pattern = re.search(r"grep -E '(.*)' README\.md", script)
    assert pattern
    assert re.findall(rf"{pattern[1]}.*\n", README, re.MULTILINE) == [blocks("sh")[1]]
    subprocess.run(["bash", "-n", str(ROOT / ".ci" / "run")], check=True)


def test_its_code_takes_ten_lines_and_prints(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = blocks("python")
    assert len(code.strip().splitlines()) <= 10
    exec(compile(code, "README.md", "exec"), {})
    assert re.search(r"\d\.\d", capsys.readouterr().out)


def test_it_is_read_in_a_sitting() -> None:
    assert len(README.splitlines()) <= 150


def test_a_problem_of_ones_own_takes_the_commands_that_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = (block for block in blocks("console") if "lapjoint init" in block)
    commands = [shlex.split(line.removeprefix("$ "), comments=True) for line in block.splitlines()]
    assert commands[0] == ["source", ".venv/bin/activate"]
    assert [command[:2] for command in commands[1:]] == [
        ["lapjoint", name] for name in ("init", "modes", "steady", "validate")
    ]
    for _, *words in commands[1:]:
        result = CliRunner().invoke(main, words)
        assert result.exit_code == 0, result.output
    assert Path("report/report.html").is_file()
