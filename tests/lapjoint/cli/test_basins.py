"""The command ``lapjoint basins``: what it prints, what it writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from toy import bar

from lapjoint import write_problem
from lapjoint.campaigns.basin_dataset import read_basins
from lapjoint.cli.main import main

PLANE = ("--plane", "z(0.5),v(1.0)", "--grid", "4x5", "--range", "-3:3,-2:2")
RANDOM = ("--energy", "20", "--starts", "12")
OVER = ("--over", "base_motion.angular_frequency", "--from", "0.53", "--to", "0.55", "--values", "2")


@pytest.fixture
def problem(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A bar between two equal stops, with motions of one period and of three."""
    monkeypatch.chdir(tmp_path)
    write_problem(bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05), "bar.toml")
    return "bar.toml"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["basins", *arguments])


def test_a_plane_is_written_printed_and_drawn(problem: str) -> None:
    command = (problem, *PLANE, "--modes", "2", "--out", "plane.nc")
    result = run(*command, "--figure", "plane.png")
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[:2] == ["Wrote plane.nc", "20 starts; share of each motion, with its 95 % interval:"]
    assert any("3 periods, " in line for line in lines)
    assert lines[-1] == "Wrote plane.png"
    assert Path("plane.png").stat().st_size > 5000
    found = read_basins("plane.nc")
    assert found.motion.shape == (4, 5)
    assert found["first"].values[[0, -1]].tolist() == [-3.0, 3.0]
    assert found["second"].attrs["units"] == "m s-1"
    again = run(*command)
    assert again.stdout.startswith("plane.nc: holds these basins already, finished")
    drawn = CliRunner().invoke(main, ["plot", "plane.nc", "-o", "again.pdf"])
    assert drawn.stdout == "Wrote again.pdf\n"


def test_random_starts_along_a_number_are_drawn_as_shares(problem: str) -> None:
    result = run(problem, *RANDOM, *OVER, "--modes", "2", "--out", "over.nc", "--figure", "over.svg")
    assert result.exit_code == 0, result.output
    assert "base_motion.angular_frequency = 0.53 rad s-1" in result.stdout
    assert read_basins("over.nc").branch.shape[0] == 2
    assert "share of the starts" in Path("over.svg").read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "no starts are chosen"),
        ((*PLANE, "--starts", "5"), "--starts: is of random starts, and --plane gives a grid"),
        ((*PLANE, "--energy", "5"), "--energy: is of random starts"),
        ((*RANDOM, "--grid", "4x4"), "--grid: is of a grid"),
        (("--plane", "z(0.5)"), "must be two coordinates"),
        (("--plane", "z(0.5),v(7)"), "v(7) is not on the beam, which is 1 m long"),
        (("--plane", "z(0.5),v(0.5)", "--grid", "4"), "--grid 4: must be two numbers of values, as in 40x40"),
        (("--plane", "z(0.5),v(0.5)", "--grid", "4x0"), "--grid 4x0: must be two numbers of values"),
        (("--plane", "z(0.5),v(0.5)", "--range", "1:2"), "--range 1:2: must be FROM:TO,FROM:TO"),
        (("--plane", "z(0.5),v(0.5)", "--range", "2:1,0:1"), "range = 2:1: must have finite ends"),
        (("--energy", "nan"), "energy = nan: must be positive and finite"),
        ((*RANDOM, "--values", "3"), "--values: is of the values of --over PATH"),
        ((*RANDOM, "--over", "damping.coefficient", "--from", "1"), "--to: is missing; --over damping.coefficient"),
        ((*RANDOM, "--over", "no.thing", "--from", "1", "--to", "2", "--values", "2"), "no.thing"),
        ((*RANDOM, "--solver", "nobody"), "is not installed"),
    ],
)
def test_what_means_nothing_is_refused_in_one_line(problem: str, arguments: tuple[str, ...], said: str) -> None:
    result = run(problem, *arguments, "--out", "basins.nc")
    assert result.exit_code == 2, result.output
    assert said in result.stderr
    said_of_it = [line for line in result.stderr.splitlines() if not line.startswith("lapjoint: hint:")]
    assert len(said_of_it) == 1  # hints are of the bar, whose units are no metres
    assert not list(Path().glob("*.nc*"))


def test_a_file_of_another_kind_is_refused_before_any_work(problem: str) -> None:
    assert run(problem, *RANDOM, "--out", "basins.txt").exit_code == 2
    assert run(problem, *RANDOM, "--out", "basins.nc", "--figure", "basins.gif").exit_code == 2
