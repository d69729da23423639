"""What the README promises is run."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from lapjoint.cli.main import main
from lapjoint.problem.files import from_toml

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


@pytest.mark.parametrize("code", blocks("python"), ids=lambda code: code.split("\n")[0])
def test_its_code_runs_and_prints(
    code: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert len(code.split("\n\n")) == 2
    exec(compile(code, "README.md", "exec"), {})
    assert re.search(r"\d\.\d", capsys.readouterr().out)


def test_its_session_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (session,) = blocks("pycon")
    lines = re.findall(r"^>>> (.*)$", session, re.MULTILINE)
    names: dict[str, object] = {}
    for line in lines[:-1]:
        exec(line, names)
    assert "impulse" in str(eval(lines[-1], names))


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


def test_from_problem_to_impulse_takes_five_lines() -> None:
    for code in blocks("python")[:2]:
        assert len([line for line in code.splitlines() if line.strip()]) <= 5


def test_its_problem_file_is_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = (f"{i / 1000},{i % 3}" for i in range(9))
    Path("shaker.csv").write_text("\n".join(["t,a_z", *rows]), encoding="utf-8")
    whole, *other_bases = blocks("toml")
    problem = from_toml(whole)
    assert len(other_bases) == 3
    for other_base in other_bases:
        other = from_toml(whole.split("[base_motion]")[0] + other_base)
        assert other.replace(base_motion=problem.base_motion) == problem
    assert problem.stop_names == ("tip",)


def test_every_dependency_is_explained() -> None:
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    table = README.split("## What it stands on")[1].split("\n## ")[0]
    for requirement in project["dependencies"]:
        name = re.split(r"[<>=]", requirement)[0]
        assert name in table, f"{name} is not explained in the README"


def test_its_map_names_every_folder_two_levels_deep() -> None:
    table = README.split("## How it is laid out")[1].split("\n## ")[0]
    named = {path.rstrip("/") for path in re.findall(r"`([\w/]+/)`", table)}
    tops = {path.split("/")[0] for path in named}
    assert {"lapjoint", "analytic", "fe_lapjoint", "validation", "tests", "benchmarks", "docs"} == tops
    inner = {path for top in tops for path in (ROOT / top).iterdir() if any(path.rglob("*.py"))}
    assert named == tops | {path.relative_to(ROOT).as_posix() for path in inner}
