"""What the README promises is run, and so is what it promises of the pages that it leads to."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from pages import assert_session, blocks

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LONGEST = 150
"""Lines that a newcomer reads before anything else, at most: two or three screens."""


def test_it_is_short() -> None:
    assert len(README.splitlines()) <= LONGEST


def test_the_two_commands_are_one_line_each() -> None:
    validate, test = blocks("sh", README)
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
    assert re.findall(rf"{pattern[1]}.*\n", README, re.MULTILINE) == [blocks("sh", README)[1]]
    subprocess.run(["bash", "-n", str(ROOT / ".ci" / "run")], check=True)


def test_its_ten_lines_of_python_print_what_stands_below_them(capsys: pytest.CaptureFixture[str]) -> None:
    (code,), (shown,) = blocks("python", README), blocks("text", README)
    assert len([line for line in code.splitlines() if line]) <= 10
    exec(compile(code, "README.md", "exec"), {})
    assert capsys.readouterr().out.startswith(shown)


def test_its_five_commands_print_what_stands_below_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = blocks("console", README)
    commands = [line.split()[0] for line in assert_session(block)]
    assert commands == ["init", "modes", "steady", "sweep", "validate"]
    for written in ("my.toml", "motion.png", "curve.nc", "report/report.html"):
        assert Path(written).stat().st_size > 1000


def test_from_problem_to_impulse_takes_five_lines() -> None:
    for code in blocks("python", (ROOT / "docs" / "library.md").read_text(encoding="utf-8"))[:2]:
        assert len([line for line in code.splitlines() if line.strip()]) <= 5


def test_its_map_names_every_folder_of_the_house() -> None:
    named = set(re.findall(r"`(\w+)/`", README.split("## Folders")[1]))
    assert named == {"lapjoint", "analytic", "fe_lapjoint", "validation", "explore", "tests", "benchmarks", "docs"}
