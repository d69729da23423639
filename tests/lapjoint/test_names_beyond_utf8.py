"""Text and names that UTF-8 does not hold end in one message, or do what was asked, and no command has a traceback.

Python gives each byte of an argument that is not UTF-8 as half of a surrogate pair, which nothing can encode.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner
from command_line import assert_refused, run

from lapjoint import InputError, Problem, paper_joint, read_problem, write_problem
from lapjoint.cli.main import Lapjoint
from lapjoint.errors import OutputError
from lapjoint.files.writing import write_file
from lapjoint.problem import RecordLoad, SineLoad, Stop
from lapjoint.problem.files import problem_from_tables, problem_tables

BYTE = os.fsdecode(b"\xff")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder whose name is not UTF-8, with a problem and a record in it."""
    there = tmp_path / f"nm{BYTE}"
    try:
        there.mkdir()
    except OSError:
        pytest.skip("this file system has no names but in UTF-8")
    rows = "".join(f"{i / 500},{i % 7}.5\n" for i in range(60))
    (there / "r.csv").write_text(rows, encoding="utf-8")
    load = {"kind": "record", "x": 1.0, "file": "r.csv", "time_column": 1}
    tables = problem_tables(paper_joint()) | {"point_loads": [load]}
    write_problem(problem_from_tables(tables, "joint", there), there / "joint.toml")
    return there


@pytest.mark.parametrize(
    "assignment",
    [f"title=a{BYTE}b", f"stops.0.name={BYTE}", f"point_loads.0.file={BYTE}.csv", f"point_loads.0.unit={BYTE}"],
)
def test_text_of_a_problem_is_refused(assignment: str, folder: Path) -> None:
    refused = run("modes", folder / "joint.toml", "--set", assignment)
    assert_refused(refused, "must be text that UTF-8 can hold", lines=1)
    assert "\\udcff" in refused.stderr


@pytest.mark.parametrize(
    ("part", "given"),
    [
        (Problem, {"title": BYTE, "beam": paper_joint().beam}),
        (Stop, {"name": BYTE, "x": 1.0, "side": "top", "gap": 0.0, "stiffness": 1.0}),
        (SineLoad, {"x": 1.0, "force": 1.0, "angular_frequency": 1.0, BYTE: 1.0}),
        (RecordLoad, {"x": 1.0, "file": BYTE, "rate": 1.0}),
    ],
)
def test_text_of_a_part_is_refused_in_python(part: Any, given: dict[str, Any]) -> None:
    with pytest.raises(InputError) as caught:
        part(**given)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_told_whatever_its_folder_is_called(folder: Path) -> None:
    for path in (folder / "none.toml", folder / f"{BYTE}.toml"):
        assert_refused(run("modes", path), "cannot be read: No such file")
    (folder / "r.csv").unlink()
    assert_refused(run("modes", folder / "joint.toml"), "cannot be read: No such file")


SHORT = ("--no-errors", "--n-modes", 2, "--duration", 0.02)


@pytest.mark.parametrize(
    ("command", "options", "out"),
    [
        ("simulate", SHORT, ("--contacts", f"c{BYTE}.csv")),
        pytest.param("simulate", SHORT, ("--series", f"c{BYTE}.csv"), marks=pytest.mark.thorough),
        pytest.param("simulate", SHORT, ("--series", f"c{BYTE}.nc"), marks=pytest.mark.thorough),
        pytest.param("simulate", SHORT, ("--figure", f"c{BYTE}.svg"), marks=pytest.mark.thorough),
        pytest.param("modes", ("--n-modes", 2), ("--json", f"c{BYTE}.json"), marks=pytest.mark.thorough),
        pytest.param("modes", ("--n-modes", 2), ("--figure", f"c{BYTE}.png"), marks=pytest.mark.thorough),
        pytest.param(
            "statistics", ("--n-modes", 2, "--settle", 0.01), ("--out", f"c{BYTE}.nc"), marks=pytest.mark.thorough
        ),
    ],
)
def test_files_in_such_a_folder_are_read_and_written(
    command: str, options: tuple[object, ...], out: tuple[str, str], folder: Path
) -> None:
    result = run(command, folder / "joint.toml", *options, out[0], folder / out[1])
    assert result.exit_code == 0, result.stderr
    assert (folder / out[1]).exists()
    assert not list(folder.glob("*.journal"))


@pytest.mark.thorough
def test_vtk_cannot_write_there_and_that_is_said(folder: Path) -> None:
    options = ("--n-modes", 2, "--duration", 0.02, "--frames", 3)
    result = run("export", folder / "joint.toml", *options, "--out", folder / "motion")
    assert (result.exit_code, type(result.exception)) == (3, SystemExit)
    assert "has characters that UTF-8 does not hold" in result.stderr.splitlines()[-1]


def test_a_problem_whose_record_has_no_name_in_utf8_is_not_written(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="has characters that UTF-8 does not hold"):
        write_problem(read_problem(folder / "joint.toml"), tmp_path / "copy.toml")
    with pytest.raises(OutputError, match="has characters that UTF-8 does not hold"):
        write_file(tmp_path / "text", BYTE)
    assert sorted(path.name for path in tmp_path.iterdir()) == [folder.name]


def test_what_another_command_cannot_write_is_told() -> None:
    def encode() -> None:
        f"a{BYTE}b".encode()

    group = Lapjoint("lapjoint", commands=[click.Command("encode", callback=encode)])
    result = CliRunner().invoke(group, ["encode"])
    assert (result.exit_code, result.stderr.count("\n")) == (3, 1)
    assert "a\\udcffb: cannot be written: has characters that UTF-8 does not hold" in result.stderr
