"""`lapjoint statistics` prints a table of 80 columns, and writes files."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from beams import unit_cantilever
from command_line import run_well

from lapjoint import Beam, Stop, write_problem
from lapjoint.problem.random_motion import RandomBaseMotion
from lapjoint.problem.records import RecordBaseMotion
from lapjoint.summaries.statistics_blocks import quantiles

STATISTICS = ("statistics", "--n-modes", "2")
SHAKEN = unit_cantilever(
    Stop(name="a stop whose name is longer than its column", x=1.0, side="top", gap=1e-4, stiffness=1e4),
    Stop(name="far", x=0.5, side="bottom", gap=0.01, stiffness=1e4),
    ratio=0.1,
).replace(
    title="Shaken",
    beam=Beam(length=1.0, bending_stiffness=200.0, mass_per_length=1.0),
    base_motion=RandomBaseMotion(psd=[[5.0, 1.0], [40.0, 1.0]]),
)


@pytest.fixture
def problem() -> str:
    write_problem(SHAKEN, "shaken.toml")
    return "shaken.toml"


def test_it_prints_values_and_intervals_and_writes_them(problem: str) -> None:
    files = ("--out", "stats.nc", "--json", "stats.json")
    command = (*STATISTICS, problem, "--duration", "3", "--seeds", "2", *files, "--at", "x=1,0.5")
    lines = run_well(*command).splitlines()
    assert max(len(line) for line in lines) <= 80
    told = ("displacement [m]", "absolute acceleration [m/s2]", "Contacts a second", "far")
    for text in ("Statistics of: Shaken", *told):
        assert any(line.startswith(text) for line in lines), text
    assert "the first" in lines[2]
    assert any(line.startswith("Note: intervals are made of") for line in lines)
    impulses = lines[next(i for i, line in enumerate(lines) if line.startswith("Impulse a second")) :]
    assert impulses[2].split() == ["far", "0", "0", "?"]
    found = xr.load_dataset("stats.nc")
    content = json.loads(Path("stats.json").read_text())
    rms = content["variables"]["displacement_rms"]
    assert rms["values"] == found.displacement_rms.values.tolist()
    assert np.array(rms["interval"]).shape == (found.x.size, 2)
    assert [x for x, asked in zip(content["x_m"], content["asked"], strict=True) if asked] == [0.5, 1.0]
    assert run_well(*command).splitlines() == ["stats.nc: holds these statistics already, finished", *lines[1:]]


def test_quantiles_of_counts_in_bins() -> None:
    low, high = np.array([1.0, 2.0, 4.0]), np.array([2.0, 4.0, 8.0])
    assert quantiles(np.array([50, 0, 50]), low, high) == pytest.approx([2.0, 4 * 2**0.8, 4 * 2**0.98])
    assert all(math.isnan(value) for value in quantiles(np.array([0, 0, 0]), low, high))


def test_holes_that_are_bridged_are_said() -> None:
    times = np.delete(np.arange(0.0, 2.0, 0.01), range(100, 130))
    record = RecordBaseMotion(quantity="acceleration", values=np.sin(20 * times), times=times, holes="bridge")
    write_problem(SHAKEN.replace(base_motion=record), "holed.toml")
    printed = run_well(*STATISTICS, "holed.toml")
    assert max(map(len, printed.splitlines())) <= 80
    said = "1 hole bridged as from sample to sample, the longest from 0.99 s on for 0.31 s"
    assert said in " ".join(printed.split())


def test_the_offset_and_the_trend_of_a_record_are_said_as_simulate_says_them() -> None:
    values = 2.0 + 0.5 * np.arange(0.0, 2.0, 0.01) + np.sin(20 * np.arange(0.0, 2.0, 0.01))
    record = RecordBaseMotion(quantity="acceleration", values=values, rate=100.0, remove="offset")
    write_problem(SHAKEN.replace(base_motion=record), "offset.toml")
    simulated = " ".join(run_well("simulate", "offset.toml", "--n-modes", "2", "--no-errors").split())
    counted = " ".join(run_well(*STATISTICS, "offset.toml").split())
    (said,) = re.findall(r"base_motion: record of acceleration, .* removed: offset", simulated)
    assert said in counted
    mean, trend = map(float, re.findall(r"mean (\S+) m/s2, trend (\S+) m/s2/s", said)[0])
    assert (mean, trend) == pytest.approx((2.5, 0.5), abs=0.1)
