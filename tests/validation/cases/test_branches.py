"""The case `branches`: one of its parts agrees, and its own closed forms are those of the textbooks."""

from __future__ import annotations

import pytest

from lapjoint.campaigns.basins.motions import wilson as counted
from validation.cases import branch_births as births
from validation.cases import branches as case
from validation.cases.branch_ends import gaps_of
from validation.verdict import Check, Verdict

BIRTHS = [f"bar, {kind}: analytic, against closed form" for kind in ("symmetry breaking", "neimark-sacker")]


def test_the_shares_of_a_small_basin_are_those_of_plain_marches() -> None:
    items = list(case.basin(lambda _: None))
    assert [item.line for item in items if item.verdict is Verdict.DISAGREE] == []


@pytest.mark.parametrize(("some", "of"), [(1, 36), (18, 36), (23, 36)])
def test_wilsons_interval_has_its_ends_where_a_share_would_be_just_as_far_away(some: int, of: int) -> None:
    assert case.wilson(some / of, of) == pytest.approx(counted(some, of), abs=1e-12)


def test_the_flip_of_the_rigid_bar_lies_between_those_of_beams() -> None:
    assert case.rigid_flip() == pytest.approx(23.1444, abs=1e-3)  # soft beams flip at 23.1375 and 23.1427 rad/s


def test_a_symmetry_breaks_and_a_torus_is_born_where_the_closed_form_has_it() -> None:
    items = list(births.over_births(lambda _: None))
    assert [item.line for item in items if item.verdict is Verdict.DISAGREE] == []
    compared = [item.name for item in items if isinstance(item, Check)]
    assert compared == BIRTHS


def test_what_no_branch_covers_is_found_between_branches_and_at_the_ends_of_the_range() -> None:
    assert gaps_of([(4.0, 6.0), (1.0, 3.0), (2.0, 3.5)], 0.0, 6.0) == [(0.0, 1.0), (3.5, 4.0)]
    assert gaps_of([(0.0, 2.0)], 0.0, 3.0) == [(2.0, 3.0)]


def test_a_stop_that_is_a_thousandth_too_stiff_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = births.from_toml

    def stiffer(text: str) -> case.Problem:
        problem = sound(text)
        stops = tuple(stop.model_copy(update={"stiffness": 1.001 * stop.stiffness}) for stop in problem.stops)
        return problem.replace(stops=stops)

    monkeypatch.setattr(births, "from_toml", stiffer)
    wrong = [item.name for item in births.over_births(lambda _: None) if item.verdict is Verdict.DISAGREE]
    assert wrong == BIRTHS
