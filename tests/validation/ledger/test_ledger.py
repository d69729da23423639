"""The ledger: printed digits, rulings, and curves read at their peaks."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import xarray as xr

import analytic
from lapjoint import Outcome, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.campaigns.branches.table import KINDS
from validation.cases import ledger, mode_map, sensitivity
from validation.ledger.curves import Curve
from validation.ledger.entry import Entry, claims, counted, ledger_table, said
from validation.ledger.modal import modal_entries
from validation.ledger.numerics import numerical_entries
from validation.ledger.rules import RULES, Ruling, rule_of
from validation.ledger.tolerance_claims import tolerance_entries
from validation.ledger.window_branches import Window, in_window, window
from validation.ledger.window_claims import phase_lag
from validation.references.reading import sources
from validation.verdict import Verdict


def test_every_claim_on_frequencies_and_numerics_has_the_ruling_that_is_expected() -> None:
    entries = [*modal_entries(), *numerical_entries(), *tolerance_entries(), phase_lag()]
    assert len(entries) == 24 + 1 + 4 + 2 + 3 + 2 + 1
    assert [entry.key for entry in entries if entry.ruling is not entry.claim.expected] == []
    assert all(entry.why and entry.claim.evidence for entry in entries)
    assert len(ledger_table("all", entries).rows) == len(entries)


SETTLED = {"analytic stable": 3, "fe stable": 3, "frequencies": 3, "analytic changes": 0, "fe changes": 0}
WHOLE = {"analytic broken": 0, "fe broken": 0}
FOUND: dict[str, tuple[dict[str, float], dict[str, float]]] = {
    # By kind: numbers as they are found, and those of them that would give another ruling.
    "density": ({"fit printed": 0, "fit other": 23, "frequencies": 24}, {"fit printed": 23, "fit other": 0}),
    "quoted frequency/1": ({"analytic": 518.76, "fe": 518.76}, {"analytic": 510.0, "fe": 510.0}),
    "quoted frequency/2": ({"analytic": 814.14, "fe": 814.14}, {"analytic": 818.0, "fe": 818.0}),
    "quoted frequency/5": ({"analytic": 2970.66, "fe": 2970.67}, {"fe": 2959.3}),
    "sixth": ({"analytic": 5, "fe": 5}, {"analytic": 6, "fe": 6}),
    "tip ratio/1": ({"analytic": 0.27747, "fe": 0.27747}, {"analytic": 0.3217, "fe": 0.3217}),
    "tip ratio/2": ({"analytic": 1.67384, "fe": 1.67384}, {"analytic": 1.679, "fe": 1.679}),
    "frequency interval": ({"largest spacing": 1.1e-13}, {"largest spacing": 7.1e-15}),
    "event interval": (
        {"analytic speed": 21.7, "fe speed": 21.7, "gap": 1e-3},
        {"analytic speed": 100.0, "fe speed": 100.0},
    ),
    "equation 29": (
        {"integrated": 5.0357e-6, "corrected": 5.03577e-6, "printed": 9.05e-8},
        {"integrated": 9.05e-8},
    ),
    "tolerance/free": ({"largest change": 0.0}, {"largest change": 1e-6}),
    "tolerance/contact": ({"largest change": 0.11}, {"largest change": 4.1e-5}),
    "peak/515": ({"analytic": 511.685, "fe": 511.685}, {"analytic": 505.0, "fe": 505.0}),
    "peak/820": ({"analytic": 819.73, "fe": 819.73}, {"analytic": 840.0, "fe": 840.0}),
    "peak/2950": ({"analytic": 2966.2, "fe": 2966.2}, {"fe": 2990.0}),
    "offset/515": ({"peak": 515.0, "analytic": -5.1, "fe": -5.1}, {"analytic": 5.1, "fe": 5.1}),
    "offset/820": ({"peak": 820.0, "analytic": 8.69, "fe": 8.69}, {"analytic": 20.0, "fe": 20.0}),
    "offset/2950": ({"peak": 2950.0, "analytic": 6.81, "fe": 6.86}, {"analytic": -6.81, "fe": -6.86}),
    "offset in percent/515": ({"by arithmetic": -0.579}, {"by arithmetic": -0.586}),
    "offset in percent/820": ({"by arithmetic": 0.737}, {"by arithmetic": 0.782}),
    "offset in percent/2950": ({"by arithmetic": -0.673}, {"by arithmetic": 0.673}),
    "peak ratio/820": ({"analytic": 0.48819, "fe": 0.48819}, {"analytic": 0.44, "fe": 0.44}),
    "peak ratio/2950": ({"analytic": 2.9088, "fe": 2.9088}, {"analytic": 1.478, "fe": 1.478}),
    "axis": ({"analytic": 22081, "fe": 21869}, {"analytic": 15700, "fe": 15700}),
    "low frequencies": ({"analytic struck": 22, "fe struck": 2}, {"analytic struck": 0, "fe struck": 0}),
    "step": (
        {"analytic steepest": 22.6, "fe steepest": 22.6, "published steepest": 68.6},
        {"analytic steepest": 60.0, "fe steepest": 60.0},
    ),
    "aperiodic": (SETTLED, {"analytic stable": 0, "fe stable": 0}),
    "bound": ({"analytic": 835.41, "fe": 835.41}, {"analytic": 456.0, "fe": 456.0}),
    "window/2060": (
        {"analytic asymmetry": 3e-15, "fe asymmetry": 2e-16, **WHOLE},
        {"analytic asymmetry": 1, "fe asymmetry": 1},
    ),
    "window/2160": (
        {"analytic asymmetry": 1e-15, "fe asymmetry": 8e-16, **WHOLE},
        {"analytic asymmetry": 1, "fe asymmetry": 1},
    ),
    "asymmetric often": ({"analytic share": 0.0, "fe share": 0.0}, {"analytic share": 0.5, "fe share": 0.5}),
    "phase lag": (
        {
            **{"analytic lag middle": 184.0, "analytic gain middle": 1.51, "analytic lag tip": 84.0},
            **{"analytic gain tip": 1.7, "fe lag middle": 184.0, "fe gain middle": 1.51, "fe lag tip": 84.0},
            "fe gain tip": 1.7,
        },
        {
            f"{solver} {what} {place}": value
            for solver in ("analytic", "fe")
            for what, value in (("lag", 178.0), ("gain", 1.05))
            for place in ("middle", "tip")
        },
    ),
    "enough modes": ({"share off": 0.67}, {"share off": 0.0}),
}


def numbers_of(key: str) -> tuple[dict[str, float], dict[str, float]]:
    """What is found of a claim, and what would give another ruling."""
    claim = claims()[key]
    if key.startswith("table 4/"):
        exact = claim.number.value + (0.058 if claim.expected is Ruling.MISPRINT else 0.0)
        off = claim.number.value + (0.0 if claim.expected is Ruling.MISPRINT else 3.0)
        return {**said(key), "analytic": exact, "fe": exact}, {"analytic": off, "fe": off}
    found, otherwise = FOUND[key]
    try:
        return {**said(key), **found}, otherwise
    except ValueError:  # what is printed is no number
        return found, otherwise


@pytest.mark.parametrize("key", claims())
def test_the_ruling_of_every_claim_follows_from_numbers_and_could_have_come_out_otherwise(key: str) -> None:
    found, otherwise = numbers_of(key)
    assert rule_of(key).judge(found) is claims()[key].expected
    assert rule_of(key).judge({**found, **otherwise}) is not claims()[key].expected


@pytest.mark.parametrize("key", [key for key in claims() if "fe" in numbers_of(key)[0]])
def test_what_only_one_solver_says_confirms_nothing(key: str) -> None:
    found, otherwise = numbers_of(key)
    if "fe" in otherwise and claims()[key].expected is Ruling.CONFIRMED:
        assert rule_of(key).judge({**found, "fe": otherwise["fe"]}) is not Ruling.CONFIRMED


def test_a_ruling_that_changes_makes_the_case_disagree() -> None:
    entries = [Entry(key, numbers_of(key)[0], "as found") for key in claims()]
    assert {item.verdict for item in ledger.decided(entries)} == {Verdict.AGREE}
    for i, entry in enumerate(entries):
        changed = replace(entry, numbers={**entry.numbers, **numbers_of(entry.key)[1]})
        items = ledger.decided([*entries[:i], changed, *entries[i + 1 :]])
        assert [item.verdict for item in items].count(Verdict.DISAGREE) == 1
        assert ledger.decided([*entries[:i], *entries[i + 1 :]])[0].verdict is Verdict.DISAGREE


def test_every_rule_has_claims_and_every_claim_a_source() -> None:
    assert {key.partition("/")[0] for key in claims()} == set(RULES)
    assert {claim.source for claim in claims().values()} == {sources()["rahmani-ervin"]}


def test_rulings_are_counted() -> None:
    entry = Entry("tolerance/free", {"printed": 8e-6, "largest change": 1e-6}, "less")
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


@pytest.mark.thorough
def test_errors_of_few_modes_are_larger_than_those_of_many() -> None:
    makes = {name: partial(analytic.Solver, n_modes=n) for name, n in (("few", 6), ("many", 14))}
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


@pytest.mark.parametrize(
    ("key", "what"), [("aperiodic", "changes"), ("window/2060", "broken"), ("window/2160", "broken")]
)
def test_a_bifurcation_between_the_points_of_a_sweep_overturns_an_overturned_window(key: str, what: str) -> None:
    found, _ = numbers_of(key)
    assert rule_of(key).judge(found) is Ruling.OVERTURNED
    assert rule_of(key).judge({**found, f"analytic {what}": 1}) is Ruling.UNDECIDABLE


@pytest.mark.parametrize("solver", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
@pytest.mark.parametrize("first", [1398.0, 2060.0, 2160.0])
def test_one_branch_leads_through_each_window_of_the_paper_without_a_bifurcation(solver: str, first: float) -> None:
    assert window(solver, first, first + 1.0) == Window(changes=0, broken=0)


def test_what_happens_in_a_window_is_counted_and_what_happens_elsewhere_is_not() -> None:
    kinds = [KINDS.index("grazing"), KINDS.index("symmetry breaking"), KINDS.index("fold")]
    found = xr.Dataset(
        {
            "angular_frequency": ("point", [100.0, 110.0, 120.0, 130.0, 140.0]),
            "branch": ("point", [0] * 5),
            "stable": ("point", [1, 1, 0, 1, 1]),
            "symmetric": ("point", [1] * 5),
            "period_multiple": ("point", [1] * 5),
            "branch_first_end": ("branch_number", ["boundary"]),
            "bifurcation_kind": ("bifurcation", kinds),
            "bifurcation_value": ("bifurcation", [102.0, 115.0, 125.0]),
        }
    )
    assert in_window(found, 101.0, 103.0) == Window(changes=0, broken=0)  # a graze alone changes nothing
    assert in_window(found, 114.0, 116.0) == Window(changes=2, broken=1)  # and the unstable motion next to it
    assert in_window(found, 124.0, 126.0) == Window(changes=2, broken=0)
    assert in_window(found, 132.0, 133.0) == Window(changes=0, broken=0)
    assert in_window(found, 139.0, 141.0) == Window(changes=1, broken=1)  # no branch leads through it
