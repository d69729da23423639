"""How commands end that do not end well, and how the exit status says so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import PAPER, SIMULATE, run

from analytic import Solver
from lapjoint import Outcome, Problem, SteadyState, paper_joint
from lapjoint.answers import Exponent
from lapjoint.errors import SolverError


def raising(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let simulations raise an error."""

    def raises(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(Solver, "simulate", raises)


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [(KeyboardInterrupt(), 130, "interrupted"), (SolverError("stopped at t = 0.1 s"), 1, "stopped at t = 0.1 s")],
)
def test_ctrl_c_and_a_solver_that_gives_up_end_with_a_status(
    error: BaseException, status: int, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    raising(error, monkeypatch)
    result = run(*SIMULATE)
    assert (result.exit_code, result.stderr) == (status, f"lapjoint: {said}\n")


@pytest.fixture(scope="module")
def found() -> SteadyState:
    """A steady state that is found quickly."""
    return Solver(n_modes=8).steady_state(paper_joint())


def undecided(found: SteadyState, value: float, error: float, periods: int) -> SteadyState:
    """A march that did not settle, with an exponent."""
    exponent = Exponent(value, error, periods, time=periods / 20, halves=(value,) * 2, quarters=(value,) * 4)
    return replace(found, outcome=Outcome.UNDECIDED, period_multiple=0, multipliers=np.zeros(0), exponent=exponent)


def test_an_undecided_motion_ends_with_status_1(found: SteadyState, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Solver, "steady_state", lambda *_, **__: undecided(found, 0.1, 0.2, 400))
    result = run("steady", PAPER)
    assert result.exit_code == 1
    assert "the motion did not settle" in result.stdout
    assert "exponent: 0.1 1/s +- 0.2, over 400 periods" in result.stdout
    assert "Repeats" not in result.stdout
    assert "max_period_multiple" not in result.stdout


def test_a_motion_of_more_periods_than_were_looked_for_is_said_to_be_one(
    found: SteadyState, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Solver, "steady_state", lambda *_, **__: undecided(found, -0.3, 0.01, 4000))
    assert "repeats, but after more periods than max_period_multiple" in run("steady", PAPER).stdout


@pytest.mark.parametrize("status", [0, 1])
def test_validate_passes_on_what_is_asked_and_the_verdict(
    status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []

    def suite_main(
        problem: Problem,
        cases: tuple[str, ...],
        level: str,
        output: Path,
        console: object,
        peers: tuple[str, ...],
        *,
        source: str,
        duration: float | None,
    ) -> int:
        asked.extend([problem, cases, level, output, peers, source, duration])
        return status

    monkeypatch.setattr("validation.suite.main", suite_main)
    options = ("--case", "a", "--case", "b", "--quick", "-o", tmp_path / "out", *("--peers", "x") * 2)
    result = run("validate", PAPER, "--set", (frequency := "base_motion.angular_frequency=820"), *options)
    assert result.exit_code == status
    problem, source = paper_joint(angular_frequency=820.0), f"{PAPER} --set {frequency}"
    assert asked == [problem, ("a", "b"), "quick", tmp_path / "out", ("x",), source, None]


def test_a_fault_of_the_program_is_not_dressed_up_as_bad_input(monkeypatch: pytest.MonkeyPatch) -> None:
    raising(ValueError("a bug"), monkeypatch)
    assert isinstance(run(*SIMULATE).exception, ValueError)
