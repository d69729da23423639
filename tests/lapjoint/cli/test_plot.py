"""``lapjoint plot``: several files, the numbers it prints, limits, and files that it cannot draw."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import PAPER, assert_refused, run, run_well
from made_sweeps import made_sweep

from lapjoint.cli.plot_printing import _print_jumps
from lapjoint.figures.curve_features import Jump
from lapjoint.files.netcdf import write_netcdf
from lapjoint.problem import FloatArray

X = np.linspace(10.0, 20.0, 21)


def put(name: str, impulse: FloatArray, multiples: list[int] | None = None) -> str:
    write_netcdf(made_sweep(X, [impulse], multiples), name)
    return name


def test_several_sweeps_are_drawn_in_one_figure_and_their_peaks_and_jumps_are_printed() -> None:
    put("up.nc", np.where(X < 18, X - 9, 0.0) ** 2, [1] * 10 + [2] * 11)
    put("down.nc", np.exp(-((X - 14) ** 2)))
    assert run_well("plot", "up.nc", "down.nc", "--limit", "impulse=0.5").splitlines() == [
        "Wrote up.pdf",
        "",
        "up",
        "",
        "Peaks                   angular frequency [rad/s]                impulse [N s]",
        "pad                                   17.5 +- 0.5                        72.25",
        "A peak stands out by 5 % of the largest value; its place is known to one step of",
        "the grid.",
        "",
        "Jumps             between neighbouring points that are different motions",
        "angular frequency [rad/s]  impulse [N s]    motion",
        "14.5 to 15                 pad 30.25 -> 36  periodic, 1 period -> periodic, 2 periods",
        "17.5 to 18                 pad 72.25 -> 0   periodic, 2 periods",
        "",
        "Beyond the limit of 0.5 N s",
        "pad               16 of 21 points, 10 to 17.5 rad/s",
        "",
        "down",
        "",
        "Peaks                   angular frequency [rad/s]                impulse [N s]",
        "pad                                     14 +- 0.5                            1",
        "A peak stands out by 5 % of the largest value; its place is known to one step of",
        "the grid.",
        "",
        "Beyond the limit of 0.5 N s",
        "pad               3 of 21 points, 13.5 to 14.5 rad/s",
    ]
    assert " 2.22817 +- 0.0796 " in run_well("plot", "up.nc", "down.nc", "--hz", "--wide")
    Path("other").mkdir()
    put("other/up.nc", X)
    twice = run_well("plot", "up.nc", "other/up.nc", "-o", "a.svg")
    assert {"up.nc", "other/up.nc"} <= set(twice.splitlines())
    assert "2: up.nc" in run_well("plot", "up.nc", "up.nc")


def test_a_second_parameter_and_several_starts() -> None:
    grid = ("--over", "stops.*.gap=1e-3,2e-3", "--n-modes", "4", "--out")
    run_well("sweep", PAPER, "--from", "500", "--to", "520", "--step", "10", *grid, "grid.nc")
    said = run_well("plot", "grid.nc")
    assert said.index("gap (all stops) = 0.001 m") < said.index("gap (all stops) = 0.002 m")
    run_well("sweep", PAPER, "--over", "damping.ratio=0.1", "--starts", "2", "--n-modes", "4", "--out", "starts.nc")
    assert "several starts at a point make no curve" in run_well("plot", "starts.nc")
    assert_refused(run("plot", "starts.nc", "grid.nc"), "grid: is over angular_frequency and stops_all_gap", 1)


def test_statistics_are_drawn_and_how_often_contacts_exceed_a_limit_is_printed() -> None:
    run_well("statistics", PAPER, "--duration", "3", "--n-modes", "2", "--out", "stats.nc")
    said = run_well("plot", "stats.nc", "--variable", "peak_force", "--limit", "peak_force=1").splitlines()
    assert said[0] == "Wrote stats.pdf"
    assert said[2] == "Contacts a second beyond the limit of 1 N, and their 95 % interval"
    assert [line.split()[0] for line in said[3:]] == ["P2", "P3", "P4", "P5"]
    beyond = run_well("plot", "stats.nc", "--limit", "impulse=1e12").splitlines()
    assert beyond[3].split()[:3] == ["P2", "0", "0"]
    assert_refused(run("plot", "stats.nc", "--wide"), "--wide: a figure of statistics has one look", 1)
    assert_refused(run("plot", "stats.nc", "--variable", "colour"), "quantity = 'colour': allowed are impulse", 1)
    assert_refused(run("plot", "stats.nc", "--variable", "stress_range"), "with [beam.material.fatigue]", 1)


REFUSED = {
    "a text": (("text.nc",), "text.nc: cannot be read: is not a NetCDF-4 file"),
    "a file cut short": (("cut.nc",), "cut.nc: is not the result of a sweep or a search"),
    "a second file that is none": (("up.nc", "text.nc"), "text.nc: cannot be read"),
    "a limit of something else": (("up.nc", "--limit", "force_peak=3"), "the figure shows impulse; --variable chooses"),
    "a limit without a value": (("up.nc", "--limit", "impulse"), "--limit impulse: must be NAME=VALUE with a positive"),
    "a limit below zero": (("up.nc", "--limit", "impulse=-1"), "must be NAME=VALUE with a positive value"),
    "a variable that one file lacks": (
        ("up.nc", "up.nc", "--variable", "force_peak"),
        "variable 'force_peak': is not in",
    ),
    "a file of basins among sweeps": (("up.nc", "basins.nc"), "basins.nc: is the result of a search for basins; only"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_drawn_is_told_in_a_line(what: str) -> None:
    put("up.nc", X)
    Path("text.nc").write_text("no dataset")
    Path("cut.nc").write_bytes(Path("up.nc").read_bytes()[:3000])
    write_netcdf(made_sweep(X, [X]).assign_attrs(result_of="search for basins"), "basins.nc")
    arguments, message = REFUSED[what]
    assert_refused(run("plot", *arguments, "-o", "a.png"), message, 1)
    assert not Path("a.png").exists()


@pytest.mark.thorough
def test_samples_are_a_bifurcation_diagram() -> None:
    given = ("--from", "500", "--to", "520", "--step", "10", "--n-modes", "4", "--strobe", "8")
    run_well("sweep", PAPER, *given, "--at", "x=1.25", "--out", "strobe.nc")
    assert xr.load_dataset("strobe.nc").strobe_displacement.attrs["place"] == "x = 1.25"
    said = run_well("plot", "strobe.nc").splitlines()
    assert said[0] == "Wrote strobe.pdf"
    assert "Peaks" in said[2]
    assert "impulse [N s]" in said[2]
    run_well("plot", "strobe.nc", "strobe.nc", "--wide", "--hz", "--variable", "strobe_velocity", "-o", "both.png")
    run_well("plot", "strobe.nc", "--variable", "impulse", "--wide", "--limit", "impulse=1", "-o", "curve.png")
    assert_refused(
        run("plot", "strobe.nc", "--limit", "strobe_displacement=1"), "--limit: a bifurcation diagram has none", 1
    )
    assert_refused(run("sweep", PAPER, *given, "--at", "x=1,2", "--out", "a.nc"), "--at x=1,2: has 2 places; one", 1)
    assert_refused(run("sweep", PAPER, *given, "--at", "x=9", "--out", "a.nc"), "x = 9: lies outside the beam", 1)


def test_columns_of_jumps_stay_apart_however_long_a_name_or_a_value_is(capsys: pytest.CaptureFixture[str]) -> None:
    jump = Jump(19.25, 19.5, ("periodic, 1 period", "aperiodic"), 0, (-0.00074694, -0.00085237))
    _print_jumps([jump], ["support plate 12"], "frequency [Hz]", "impulse [N s]")
    *_, header, row = capsys.readouterr().out.splitlines()
    assert re.split(r"\s{2,}", header) == ["frequency [Hz]", "impulse [N s]", "motion"]
    place, values, motions = re.split(r"\s{2,}", row)
    assert (place, motions) == ("19.25 to 19.5", "periodic, 1 period -> aperiodic")
    assert values == "support plate 12 -0.00074694 -> -0.00085237"
    assert header.index("motion") == row.index(motions)
