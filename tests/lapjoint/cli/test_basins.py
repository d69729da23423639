"""The command ``lapjoint basins``: what it prints and writes."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from command_line import assert_refused, run, run_well
from toy import bar

from lapjoint import write_problem
from lapjoint.campaigns.basins.table import read_basins

PLANE = ("--plane", "z(0.5),v(1.0)", "--grid", "4x5", "--range", "-3:3,-2:2")
RANDOM = ("--energy", "20", "--starts", "12")
OVER = ("--over", "base_motion.angular_frequency", "--from", "0.53", "--to", "0.55", "--values", "2")


@pytest.fixture
def problem() -> str:
    """A bar between two equal stops, with motions of one period and of three."""
    write_problem(bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05), "bar.toml")
    return "bar.toml"


def test_a_plane_is_written_printed_and_drawn(problem: str) -> None:
    command = ("basins", problem, *PLANE, "--n-modes", "2", "--out", "plane.nc")
    lines = run_well(*command, "--figure", "plane.png").splitlines()
    assert lines[:2] == ["Wrote plane.nc", "20 starts; share of each motion, with its 95 % interval:"]
    assert any("3 periods, " in line for line in lines)
    assert lines[-1] == "Wrote plane.png"
    assert Path("plane.png").stat().st_size > 5000
    found = read_basins("plane.nc")
    assert found.motion.shape == (4, 5)
    assert found["first"].values[[0, -1]].tolist() == [-3.0, 3.0]
    assert found["second"].attrs["units"] == "m s-1"
    assert run_well(*command).startswith("plane.nc: holds these basins already, finished")
    assert run_well("plot", "plane.nc", "-o", "again.pdf") == "Wrote again.pdf\n"


def test_a_parameter_in_hz_is_printed_and_drawn_in_hz(problem: str) -> None:
    over = ("--over", "frequency", "--from", "0.08", "--to", "0.1", "--values", "2")
    said = run_well("basins", problem, *RANDOM, *over, "--n-modes", "2", "--out", "over.nc", "--figure", "over.svg")
    assert "base_motion.frequency = 0.08 Hz" in said
    assert "frequency [Hz]" in Path("over.svg").read_text()
    assert read_basins("over.nc").angular_frequency.values.tolist() == [2 * math.pi * 0.08, 2 * math.pi * 0.1]
    same = ("--hz", *over[:1], "angular_frequency", *over[2:])
    assert "holds these basins already" in run_well(
        "basins", problem, *RANDOM, *same, "--n-modes", "2", "--out", "over.nc"
    )
    assert_refused(
        run("basins", problem, *RANDOM, "--hz", "--out", "other.nc"), "--hz: is of --over base_motion.", lines=1
    )


def test_random_starts_along_a_number_are_drawn_as_shares(problem: str) -> None:
    said = run_well("basins", problem, *RANDOM, *OVER, "--n-modes", "2", "--out", "over.nc", "--figure", "over.svg")
    assert "base_motion.angular_frequency = 0.53 rad s-1" in said
    assert read_basins("over.nc").branch.shape[0] == 2
    assert "share of the starts" in Path("over.svg").read_text()
