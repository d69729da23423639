"""The ledger: printed digits, rulings, and curves read at their peaks."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from lapjoint import Outcome, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from validation.cases import mode_map, sensitivity
from validation.ledger.curves import Curve
from validation.ledger.entry import Entry, Ruling, counted, last_digit, ledger_table, matches
from validation.ledger.modal import modal_entries
from validation.ledger.numerics import numerical_entries
from validation.ledger.tolerance_claims import tolerance_entries
from validation.ledger.window_claims import phase_lag


@pytest.mark.parametrize(("text", "half"), [("41.5", 0.05), ("734.92", 0.005), ("7.38e-15", 5e-18), ("1.67 %", 0.005)])
def test_a_printed_number_stands_for_half_a_unit_of_its_last_digit(text: str, half: float) -> None:
    assert last_digit(text) == pytest.approx(half)


def test_a_value_matches_what_it_rounds_to() -> None:
    assert matches(41.5476, "41.5")
    assert not matches(729.0584, "729.0")
    assert matches(1.6738, "1.67 %")


def test_every_claim_on_frequencies_and_numerics_has_a_ruling() -> None:
    entries = [*modal_entries(), *numerical_entries()]
    assert len(entries) == 24 + 1 + 4 + 2 + 3
    by_claim = {entry.claim: entry for entry in entries}
    table_4 = [entry for entry in entries if entry.place == "Table 4"]
    assert sum(entry.ruling is Ruling.CONFIRMED for entry in table_4) == 23
    assert by_claim["density, kg/m3"].ruling is Ruling.MISPRINT
    assert by_claim["off-diagonal entries C* omega^2"].ruling is Ruling.MISPRINT
    first = by_claim["tip of mode 1 in state 2 over that of the free beam, hard contact"]
    second = by_claim["tip of mode 2 in state 2 over that of the free beam, hard contact"]
    assert (first.ruling, second.ruling) == (Ruling.OVERTURNED, Ruling.CONFIRMED)
    assert all(entry.why and entry.evidence for entry in entries)
    assert len(ledger_table("all", entries).rows) == len(entries)


def test_the_convergence_study_is_judged_by_its_own_tolerances() -> None:
    free, contact = tolerance_entries()
    assert "8.0e-6 m" in free.claim
    assert "6.1e-5 m" in contact.claim
    assert contact.ruling is Ruling.OVERTURNED
    assert free.ruling is Ruling.UNDECIDABLE


def test_rulings_are_counted() -> None:
    entry = Entry("Table 4", "x", "1", "1", "1", "", Ruling.CONFIRMED, "equal", "table4")
    assert counted([entry, entry]) == "2 confirmed"


def curve() -> Curve:
    return Curve(sweep(paper_joint(), [Axis(FREQUENCY, range(500, 526, 2))], options={"n_modes": 10}))


def test_a_curve_is_read_at_the_top_of_its_peak() -> None:
    found = curve()
    omega, height = found.peak(512.0, 12.0)
    assert omega == pytest.approx(511.7, abs=0.5)
    assert height >= found.tip.max()
    assert found.outcome_is(Outcome.PERIODIC).all()
    assert (found.asymmetry < 1e-6).all()
    assert ((found.longest_contact > 0.3) & (found.longest_contact < 0.5)).all()


def test_a_point_without_an_answer_is_passed_over() -> None:
    data: xr.Dataset = curve().dataset.copy(deep=True)
    data["impulse"][0] = np.nan
    assert Curve(data).peak(512.0, 12.0)[0] == pytest.approx(511.7, abs=0.5)


def test_at_5000_rad_s_the_tip_does_not_lag_by_pi() -> None:
    entry = phase_lag()
    assert entry.ruling is Ruling.OVERTURNED


def test_errors_of_few_modes_are_larger_than_those_of_many() -> None:
    makes = {"few": lambda: mode_map.analytic.Solver(n_modes=6), "many": lambda: mode_map.analytic.Solver(n_modes=14)}
    few, many = mode_map.errors(makes, (515.0,), lambda _: None)[:, 0]
    assert many < 0.1 * few


def test_the_published_scheme_freezes_more_and_more_where_it_drifts() -> None:
    early, late = mode_map.left_behind(1000.0, 8, 5)
    assert late > 1.5 * early > 0.01
    assert max(mode_map.left_behind(1000.0, 24, 24)) < 1e-3


def test_findings_are_read_off_a_variant() -> None:
    found = sensitivity.findings(sensitivity.scaled(paper_joint(), gap=1.02), 4)
    assert found.settled == 3
    assert found.periodic == 4
    assert found.ratios == pytest.approx((0.488, 2.91), rel=0.01)
