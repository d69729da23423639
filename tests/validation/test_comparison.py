"""The comparison itself: verdicts, uncertainty from refinement, invariants that catch wrong motions, reports."""

from __future__ import annotations

import io
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import analytic
import fe_lapjoint
from lapjoint import History, InputError, Problem, paper_joint, sdnl104
from lapjoint.errors import OutputError
from lapjoint.problem import FloatArray
from lapjoint.problem.files import problem_tables_json
from validation import suite
from validation.cases.motions import refined_by
from validation.invariants import continuity, energy_balance, gaps, stated_impulses, witness
from validation.uncertainty import Refined, factor_of_safety, observed_order, refined_estimate, refined_vector
from validation.verdict import Check, Criterion, ErrorSource, Estimate, Kind, Verdict

TEST = Refined(ErrorSource.REFINEMENT, "test")
CASES = Path(suite.__file__).parent / "cases"


def check(a: float, b: float, u: float, **options: object) -> Check:
    return Check("x", "1", Estimate(a, u, ""), Estimate(b, 0.0, ""), **options)  # type: ignore[arg-type]


def test_a_difference_is_judged_by_the_combined_uncertainty() -> None:
    assert check(1.0, 1.1, 0.2).verdict is Verdict.AGREE
    assert check(1.0, 1.1, 0.05).verdict is Verdict.DISAGREE
    assert check(1.0, 1.1, 0.05, explanation="known").verdict is Verdict.EXPLAINED


def test_a_large_uncertainty_cannot_hide_a_large_difference() -> None:
    assert check(1.0, 1.1, 1.0, cap=1e-3).verdict is Verdict.DISAGREE


def test_nan_never_agrees() -> None:
    assert check(math.nan, 1.0, 1.0).verdict is Verdict.DISAGREE
    assert Criterion("x", "1", math.nan, -math.inf, math.inf, "").verdict is Verdict.DISAGREE


@pytest.mark.parametrize("order", [2.0, 4.0])
def test_a_known_sequence_gives_its_order_and_a_bound_on_its_error(order: float) -> None:
    values = [1.0 + 0.1 * h**order for h in (1.0, 0.5, 0.25)]
    assert observed_order(*values, 2.0) == pytest.approx(order, rel=1e-9)
    estimate = refined_estimate(values, 2.0, order, TEST)
    error = abs(estimate.value - 1.0)
    assert error < estimate.uncertainty < 2 * error


def test_an_unexpected_order_costs_confidence() -> None:
    values = [1.0, 1.01, 1.005]  # not monotone
    estimate = refined_estimate(values, 2.0, 4.0, TEST)
    assert estimate.uncertainty >= 0.005
    assert "not asymptotic" in estimate.how


def test_factors_of_safety_are_those_of_xing_and_stern() -> None:
    assert factor_of_safety(1.0) == pytest.approx(1.6)
    assert factor_of_safety(0.5) == pytest.approx(2.025)
    assert factor_of_safety(1.0 + 1e-12) == pytest.approx(1.6)


def test_numbers_of_one_motion_share_their_uncertainty() -> None:
    values = np.array([[1.0 + 0.1 * h**4, 5.0 + 1e-6 * h**4] for h in (1.0, 0.5, 0.25)])
    a, b = refined_vector(values, 2.0, 4.0, TEST)
    assert a.uncertainty == b.uncertainty >= 0.1 / 4**4


@pytest.fixture(scope="module")
def motion() -> History:
    return analytic.Solver(n_modes=30).simulate(paper_joint(), 0.03)


def test_a_right_motion_passes_every_invariant(motion: History) -> None:
    assert [item for item in witness(motion, 2e-5, "") if item.verdict is not Verdict.AGREE] == []


def test_energy_is_accounted_for_without_damping() -> None:
    history = analytic.Solver(n_modes=30).simulate(sdnl104(), 0.1)
    assert energy_balance(history, 2e-5).verdict is Verdict.AGREE


def broken(history: History, factor: float) -> History:
    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return history.field(x, t, dx, dt) * (1 + factor * (t > 0.015))

    return replace(history, field=field)


def test_a_motion_that_gains_energy_is_caught() -> None:
    history = broken(analytic.Solver(n_modes=20).simulate(sdnl104(), 0.03), 1e-3)
    assert energy_balance(history, 2e-5).verdict is Verdict.DISAGREE


def test_a_motion_that_ignores_its_stops_is_caught(motion: History) -> None:
    assert gaps(broken(motion, 0.5), 2e-5).verdict is Verdict.DISAGREE


def test_a_wrong_impulse_is_caught(motion: History) -> None:
    wrong = tuple(replace(contact, impulse=contact.impulse * 1.001) for contact in motion.contacts)
    assert stated_impulses(replace(motion, contacts=wrong), 2e-5).verdict is Verdict.DISAGREE


def test_a_jump_at_a_switch_is_caught(motion: History) -> None:
    when = motion.switch_times[2]

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return motion.field(x, t, dx, dt) * (1 + 1e-3 * (t >= when))

    assert continuity(replace(motion, field=field), 2e-5).verdict is Verdict.DISAGREE


def run(tmp_path: Path, problem: Problem | None, *cases: str) -> tuple[int, dict, str]:  # type: ignore[type-arg]
    status = suite.main(problem, cases, "quick", tmp_path / "report", Console(file=io.StringIO()))
    data = json.loads((tmp_path / "report" / "report.json").read_text())
    return status, data, (tmp_path / "report" / "report.html").read_text()


def test_table_4_comes_out_to_the_last_digit_and_its_misprint_is_named(tmp_path: Path) -> None:
    status, data, page = run(tmp_path, None, "table4")
    assert status == 0
    checks = data["cases"][0]["checks"]
    printed = [c for c in checks if c["name"].endswith("printed")]
    assert len(printed) == 2 * 9 * 3
    assert {c["name"] for c in printed if c["verdict"] != "agree"} == {
        "k* = 5, state 3, omega_3, printed",
        "k* = 5, state 5, omega_3, printed",
    }
    assert "Misprint" in page
    assert "src=" not in page
    assert 'href="http' not in page  # nothing is fetched


def test_a_problem_of_ones_own_is_compared(tmp_path: Path) -> None:
    status, data, page = run(tmp_path, sdnl104(), "frequencies")
    assert status == 0
    assert [case["name"] for case in data["cases"]] == ["frequencies"]
    assert data["about"]["problem"] == problem_tables_json(sdnl104())
    assert page.count("<svg") == 2  # the sketch, for wide and for narrow screens; no figure of the case


def test_unknown_cases_and_unwritable_reports_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'figure5' is unknown"):
        suite.main(None, ("figure5",), "quick", tmp_path, Console())
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"):
        suite.main(None, ("table4",), "quick", tmp_path / "file", Console())


def test_sources_of_error_follow_from_what_was_refined_and_not_from_a_name() -> None:
    named = Refined(ErrorSource.MODES, "a solver that calls its modes elements")
    estimate = refined_estimate([1.0, 1.1, 1.11], 2.0, 4.0, named)
    assert estimate.contributions[0][0] is ErrorSource.MODES
    assert refined_by(fe_lapjoint.Solver()).source is ErrorSource.MESH
    assert refined_by(analytic.Solver(n_modes=7)).source is ErrorSource.MODES
    assert refined_by(analytic.PublishedScheme()).source is ErrorSource.REFINEMENT
    assert Estimate(1.0, 0.1, "", Kind.PUBLISHED).contributions == ((Kind.PUBLISHED, 0.1),)


def test_every_case_is_in_the_suite() -> None:
    modules = {path.stem for path in CASES.glob("*.py") if "\ndef run(level: Level, say: Say)" in path.read_text()}
    assert modules == set(suite.modules_of(()))
