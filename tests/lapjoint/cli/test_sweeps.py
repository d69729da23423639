"""Sweeps and their plots by the command line, and what is said of progress."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from command_line import PAPER, assert_refused, run, run_well

from analytic import Solver
from lapjoint import SteadyState, paper_joint
from lapjoint.cli.progress import duration_text, lines_of_progress, lines_with_time_left
from lapjoint.errors import SolverError

SWEEP = ("sweep", PAPER, "--from", "500", "--to", "520", "--step", "10", "--modes", "4", "--out", "curve.nc")


def test_sweep_writes_a_dataset_and_plot_draws_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.campaigns.dataset import read_curve

    monkeypatch.chdir(tmp_path)
    printed = run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2")
    assert printed.splitlines()[0] == "Wrote curve.nc"
    assert printed.splitlines()[1].startswith("6 points: ")
    curve = read_curve("curve.nc")
    assert curve.angular_frequency.values.tolist() == [500.0, 510.0, 520.0]
    assert curve.stops_all_gap.values.tolist() == [1e-3, 2e-3]
    exact = Solver(n_modes=4).steady_state(paper_joint(angular_frequency=510.0, gap=2e-3))
    np.testing.assert_array_equal(curve.impulse[1, 1], exact.impulses)
    assert run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2").startswith("curve.nc: holds this sweep already")
    assert run_well("plot", "curve.nc") == "Wrote curve.pdf\n"
    assert run_well("plot", "curve.nc", "--wide", "-o", "wide.svg") == "Wrote wide.svg\n"
    assert_refused(run(*SWEEP), "curve.nc: is the result of another sweep; choose another --out, or overwrite it")
    run_well(*SWEEP, "--force")


def test_a_sweep_needs_no_frequencies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.campaigns.dataset import read_curve

    monkeypatch.chdir(tmp_path)
    run_well("sweep", PAPER, "--over", "damping.ratio=0.1,0.08", "--start", "up", "--modes", "4", "--out", "curve.nc")
    assert read_curve("curve.nc").damping_ratio.values.tolist() == [0.1, 0.08]


def test_a_sweep_with_points_that_failed_ends_with_status_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(*_: object, **__: object) -> None:
        raise SolverError("stopped at t = 0.1 s")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Solver, "steady_state", gives_up)
    result = run(*SWEEP)
    assert result.exit_code == 1
    assert result.stdout.splitlines() == ["Wrote curve.nc", "3 points: 3 failed", *["failed: stopped at t = 0.1 s"] * 3]


@pytest.mark.parametrize("done", [0, 2])
def test_ctrl_c_in_a_sweep_says_how_to_resume(done: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked = Solver(n_modes=4).steady_state(paper_joint()), 0

    def interrupted(*_: object, **__: object) -> SteadyState:
        nonlocal asked
        asked += 1
        if asked > done:
            raise KeyboardInterrupt
        return found

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    monkeypatch.setattr(Solver, "steady_state", interrupted)
    result = run(*SWEEP)
    assert result.exit_code == 130
    kept = "2 of 3 points are kept in curve.nc.journal; the same command resumes"
    assert result.stderr.splitlines()[-1] == f"lapjoint: interrupted: {kept if done else 'none of 3 points was done'}"


def test_progress_of_a_sweep_says_how_much_time_is_left() -> None:
    now = 0.0

    @click.command()
    def work() -> None:
        nonlocal now
        progress = lines_with_time_left("sweep", lambda: now)
        for done in (2000, 2500, 4000, 4010, 5000):
            progress(done, 5000)
            now += 600.0

    assert CliRunner().invoke(work).stderr.splitlines() == [
        "sweep: goes on from 2000 of 5000",
        "sweep: 50 %, 2500 of 5000, 50 min left",
        "sweep: 80 %, 4000 of 5000, 10 min left",
        "sweep: 100 %, 5000 of 5000",
    ]
    assert [duration_text(seconds) for seconds in (40.4, 700.0, 12000.0)] == ["40 s", "12 min", "3 h 20 min"]


def test_progress_off_a_terminal_is_a_line_for_every_tenth() -> None:
    @click.command()
    def work() -> None:
        progress = lines_of_progress("work")
        for i in range(1001):
            progress(i, 1000)

    lines = CliRunner().invoke(work).stderr.splitlines()
    assert lines == [f"work: {percent} %" for percent in range(10, 101, 10)]
