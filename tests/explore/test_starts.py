"""What a page starts from: presets, and the problems of the gallery."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import pytest

from explore.question import opened
from explore.starts import GALLERY, starts, tables_of
from lapjoint import Problem
from lapjoint.problem.files import problem_from_tables

SCRIPTS = Path(__file__).resolve().parents[2] / "docs" / "gallery"


def problem_of(script: Path) -> Problem:
    """The first problem that a script of the gallery makes; what comes after it is not run."""
    names: dict[str, Any] = {}
    for node in ast.parse(script.read_text(encoding="utf-8")).body:
        exec(compile(ast.Module([node], []), str(script), "exec"), names)
        if isinstance(node, ast.Assign) and isinstance(value := names[ast.unparse(node.targets[0])], Problem):
            return value
    raise AssertionError(f"{script} makes no problem")


@pytest.mark.parametrize("name", GALLERY)
def test_a_start_of_the_gallery_is_the_problem_of_its_script(name: str) -> None:
    assert problem_from_tables(tables_of(name)) == problem_of(SCRIPTS / f"{name}.py")


@pytest.mark.parametrize("name", starts().values())
def test_each_start_is_a_question(name: str) -> None:
    assert opened(tables_of(name)).made().stops
