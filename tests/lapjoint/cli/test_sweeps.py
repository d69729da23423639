"""Sweeps and their plots by the command line, and what is said of progress."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial

import click
import numpy as np
import pytest
from click.testing import CliRunner
from command_line import PAPER, assert_refused, run, run_well

from analytic import Solver
from lapjoint import SteadyState, paper_joint
from lapjoint.campaigns.pace import Pace
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.table import read_curve
from lapjoint.cli.progress import lines_of_progress, lines_of_search, lines_with_time_left, tell_of_delays
from lapjoint.errors import SolverError
from lapjoint.files.plain_text import duration_text
from lapjoint.solver import Progress

SWEEP = ("sweep", PAPER, "--from", "500", "--to", "520", "--step", "10", "--n-modes", "4", "--out", "curve.nc")


def test_sweep_writes_a_dataset_and_plot_draws_it() -> None:
    printed = run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2")
    assert printed.splitlines()[0] == "Wrote curve.nc"
    assert printed.splitlines()[1].startswith("6 points: ")
    curve = read_curve("curve.nc")
    assert curve.angular_frequency.values.tolist() == [500.0, 510.0, 520.0]
    assert curve.stops_all_gap.values.tolist() == [1e-3, 2e-3]
    exact = Solver(n_modes=4).steady_state(paper_joint(angular_frequency=510.0, gap=2e-3))
    np.testing.assert_array_equal(curve.impulse[1, 1], exact.impulses)
    assert run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2").startswith("curve.nc: holds this sweep already")
    assert run_well("plot", "curve.nc").startswith("Wrote curve.pdf\n")
    assert run_well("plot", "curve.nc", "--wide", "-o", "wide.svg").startswith("Wrote wide.svg\n")
    assert_refused(run(*SWEEP), "curve.nc: is the result of another sweep; choose another --out, or overwrite it")
    run_well(*SWEEP, "--force")


def test_a_sweep_needs_no_frequencies() -> None:
    run_well("sweep", PAPER, "--over", "damping.ratio=0.1,0.08", "--start", "up", "--n-modes", "4", "--out", "curve.nc")
    assert read_curve("curve.nc").damping_ratio.values.tolist() == [0.1, 0.08]


def test_a_sweep_with_points_that_failed_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(*_: object, **__: object) -> None:
        raise SolverError("stopped at t = 0.1 s")

    monkeypatch.setattr(Solver, "steady_state", gives_up)
    result = run(*SWEEP)
    assert result.exit_code == 1
    assert result.stdout.splitlines() == ["Wrote curve.nc", "3 points: 3 failed", *["failed: stopped at t = 0.1 s"] * 3]


@pytest.mark.parametrize("done", [0, 2])
def test_ctrl_c_in_a_sweep_says_how_to_resume(done: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked = Solver(n_modes=4).steady_state(paper_joint()), 0

    def interrupted(*_: object, **__: object) -> SteadyState:
        nonlocal asked
        asked += 1
        if asked > done:
            raise KeyboardInterrupt
        return found

    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    monkeypatch.setattr(Solver, "steady_state", interrupted)
    result = run(*SWEEP)
    assert result.exit_code == 130
    kept = "2 of 3 points are kept in curve.nc.journal; the same command resumes"
    assert result.stderr.splitlines()[-1] == f"lapjoint: interrupted: {kept if done else 'none of 3 points was done'}"


PROGRESS: dict[str, tuple[Callable[..., Progress], list[tuple[float, float, float]], list[str]]] = {
    "a sweep that goes on says how much time is left": (
        lines_with_time_left,
        [(done, 5000, 600.0) for done in (2000, 2500, 4000, 4010, 5000)],
        [
            "goes on from 2000 of 5000",
            "50 %, 2500 of 5000, 50 min left",
            "80 %, 4000 of 5000, 10 min left",
            "100 %, 5000 of 5000",
        ],
    ),
    "slow points: a line after a few, then ever more rarely, until a twentieth is done": (
        lines_with_time_left,
        [(done, 5000, 10.75) for done in (0, 1, 2, 3, 4, 5, 6, 8, 250, 251, 5000)],
        ["0.06 %, 3 of 5000", "0.12 %, 6 of 5000", "5 %, 250 of 5000", "100 %, 5000 of 5000"],
    ),
    "one piece of work that takes long says early what is left": (
        lines_with_time_left,
        [(done, 1, 10.75) for done in (0.0, 0.005, 0.02, 0.03, 0.06, 1.0)],
        ["2 %, 18 min left", "5 %, 11 min left", "100 %"],
    ),
    "few pieces of work do so, too": (
        lines_with_time_left,
        [(done, 4, 10.75) for done in (0.0, 0.1, 0.5, 1.0, 4.0)],
        ["2.5 %, 0 of 4, 7 min left", "10 %, 0 of 4", "25 %, 1 of 4", "100 %, 4 of 4"],
    ),
    "a search says what is known so far and no time that is left": (
        lines_of_search,
        # Fifty starts are done in ten seconds; each branch that they lead to takes minutes, and leads to more.
        [(3, 51, 8.0), (50, 51, 4.0), (50, 55, 2.0), (51, 60, 200.0), (52, 60, 50.0), (60, 60, 0.0)],
        [
            "goes on from 3 of 51 known so far",
            "50 of 55 known so far, after 12 s",
            "52 of 60 known so far, after 4 min",
            "60 of 60 known so far, after 4 min",
        ],
    ),
    "a search for a steady state says how many periods it has marched, at least every minute": (
        partial(lines_of_search, known_as="periods allowed"),
        [(0, 1, 24.0), (8, 16000, 2.0), (9, 16000, 600.0), *((done, 16000, 61.0) for done in range(33, 38))],
        ["8 of 16000 periods allowed, after 24 s", *(f"{done} of 16000 periods allowed" for done in range(33, 38))],
    ),
    "progress off a terminal is a line for every tenth": (
        lambda title, clock: lines_of_progress(title),
        [(done, 1000, 0.0) for done in range(1001)],
        [f"{percent} %" for percent in range(10, 101, 10)],
    ),
}


@pytest.mark.parametrize("what", PROGRESS)
def test_lines_of_progress(what: str) -> None:
    """Steps are how much is done, of how much, and the time until the work goes on, s; lines begin as expected."""
    lines, steps, expected = PROGRESS[what]
    now = 0.0

    @click.command()
    def work() -> None:
        nonlocal now
        progress = lines("work", clock=lambda: now)
        for done, total, later in steps:
            progress(done, total)
            now += later

    found = CliRunner().invoke(work).stderr.splitlines()
    assert len(found) == len(expected), found
    for line, beginning in zip(found, expected, strict=True):
        assert line.startswith(f"work: {beginning}")
    assert not found[-1].endswith("left")


def test_durations_are_told_in_seconds_minutes_or_hours() -> None:
    assert [duration_text(seconds) for seconds in (40.4, 700.0, 12000.0)] == ["40 s", "12 min", "3 h 20 min"]


@pytest.fixture
def loggers() -> Iterator[None]:
    """What tells of delays, as it was before."""
    those = [
        logging.getLogger(name)
        for name in ("lapjoint.compiled.compiling", "lapjoint.campaigns.pace", "lapjoint.machine.memory")
    ]
    before = [(logger.level, logger.handlers[:]) for logger in those]
    yield
    for logger, (level, handlers) in zip(those, before, strict=True):
        logger.setLevel(level)
        logger.handlers[:] = handlers


@pytest.mark.usefixtures("loggers")
def test_a_sweep_whose_first_points_do_not_repeat_says_what_it_will_take() -> None:
    now = 0.0

    def said(*multiples: int, each: float = 20.0) -> list[str]:
        @click.command()
        def work() -> None:
            nonlocal now
            tell_of_delays()
            pace = Pace("sweep", lambda: now)
            for i, multiple in enumerate(multiples):
                now += each
                pace.take([Point(period_multiple=multiple)], 1000 - i - 1)

        return CliRunner().invoke(work).stderr.splitlines()

    (line,) = said(0, 0, 1, 0, 0, 0, 0)
    assert line == (
        "lapjoint: sweep: 4 of the first 5 points do not repeat, which takes longest to establish: "
        "20 s a point at this pace, 5 h 32 min for the other 995"
    )
    assert said(1, 0, 1, 0, 1, 0, 1, 0) == []
    assert said(0, 0, 0, 0, 0, 0, each=0.01) == []
    assert len(said(*[1] * 7, *[0] * 20)) == 1
