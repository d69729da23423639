"""Branches as a dataset: the same however the work is done, resumed, refused where it must be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from small_joints import cantilever

from lapjoint import FREQUENCY, Axis, BaseMotion, InputError, ModalDamping, Problem, Stop
from lapjoint.campaigns import branch
from lapjoint.campaigns.branches import search, solve
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.problem.presets import paper_joint

FELT = 1e-6  # N: just beyond a graze a contact is so light that its impulse is below rounding
GAPS = (1.05e-3, 1e-3, 0.95e-3)  # m


@pytest.fixture(scope="module")
def also_asked(asked: dict[str, Any]) -> dict[str, Any]:
    """The same for three gaps."""
    return {**asked, "also_over": Axis("stops.*.gap", GAPS)}


@pytest.fixture(scope="module")
def in_two_numbers(problem: Problem, also_asked: dict[str, Any]) -> xr.Dataset:
    """The branches for three gaps, found by one process."""
    return branch(problem, **also_asked)


def test_the_starts_at_both_ends_lead_to_one_branch_with_two_folds(found: xr.Dataset, asked: dict[str, Any]) -> None:
    assert found.branch_first_end.size == 1
    assert set(found.branch.values) == {0}
    assert [KINDS[kind] for kind in found.bifurcation_kind.values] == ["grazing", "fold", "fold"]
    assert found.base_motion_amplitude.values[[0, -1]] == pytest.approx([asked["first"], asked["last"]])
    first, last = found.bifurcation_point.values[1:]
    assert (found.stable.values[:first] == 1).all()
    assert (found.stable.values[first:last] == 0).all()
    assert (found.stable.values[last:] == 1).all()
    assert "uncovered_from" not in found
    assert int(found.left_out) == 0


def test_contacts_begin_at_the_graze(found: xr.Dataset) -> None:
    graze = int(found.bifurcation_point[0])  # the point before lies at the graze, where a touch is rounding
    assert found.base_motion_amplitude.values[graze - 1] == pytest.approx(found.bifurcation_value.values[0], rel=1e-8)
    assert (found.contact_count.values[: graze - 1] == 0).all()
    assert (found.contact_count.values[graze:] == 1).all()
    force = found.peak_force.values[graze:]
    assert (force > 0).all()
    assert (found.impulse.values[graze:][force > FELT] > 0).all()


def test_a_branch_is_followed_once_though_several_starts_lead_to_it(
    problem: Problem, asked: dict[str, Any], found: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []

    def counted(*args: Any) -> dict[str, Any]:
        made.append(args)
        return solve.solve_branch(*args)

    monkeypatch.setattr(search, "solve_branch", counted)
    xr.testing.assert_identical(branch(problem, **asked), found)
    assert len(made) == 1


def test_a_second_number_gives_the_branches_of_each_of_its_values(
    in_two_numbers: xr.Dataset, found: xr.Dataset
) -> None:
    assert in_two_numbers.stops_all_gap.values.tolist() == list(GAPS)
    assert in_two_numbers.branch_also_over.values.tolist() == list(GAPS)
    own = in_two_numbers.branch_also_over.values[in_two_numbers.branch.values] == GAPS[1]
    np.testing.assert_array_equal(in_two_numbers.base_motion_amplitude.values[own], found.base_motion_amplitude.values)
    mine = in_two_numbers.bifurcation_also_over.values == GAPS[1]
    np.testing.assert_array_equal(in_two_numbers.bifurcation_value.values[mine], found.bifurcation_value.values)


def test_bifurcations_that_scale_with_the_gap_lie_on_one_locus_each(in_two_numbers: xr.Dataset) -> None:
    gap, value, locus = (in_two_numbers[f"bifurcation_{name}"].values for name in ("also_over", "value", "locus"))
    assert np.bincount(locus).tolist() == [3, 3, 3]
    for number, kind in enumerate(("grazing", "fold", "fold")):
        mine = locus == number
        assert {KINDS[one] for one in in_two_numbers.bifurcation_kind.values[mine]} == {kind}
        assert np.ptp(value[mine] / gap[mine]) <= 1e-7 * value[mine][0] / gap[mine][0]  # located to 1e-9 each


def test_a_branch_ends_with_the_points_that_are_allowed(problem: Problem, asked: dict[str, Any]) -> None:
    shares: list[float] = []
    short = branch(problem, **asked, max_points=8, progress=lambda done, total: shares.append(done / total))
    assert "effort" in [*short.branch_first_end.values, *short.branch_last_end.values]
    assert np.bincount(short.branch.values).max() <= 8 + 1  # one of the two points beside a graze comes on top
    assert any(0 < share < 1 for share in shares)
    assert max(shares) == 1


def test_what_could_not_be_followed_is_told(
    problem: Problem, asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*args: object) -> dict[str, object]:
        return {"starts": [], "points": [], "message": "stopped at t = 0.1 s"}

    monkeypatch.setattr(search, "solve_branch", stopped)
    nothing = branch(problem, **asked)
    ends = asked["first"], asked["last"]
    assert nothing.failure_message.values.tolist() == [
        f"a motion at {asked['path']} = {value:g}: stopped at t = 0.1 s" for value in ends
    ]
    assert (nothing.uncovered_from.item(), nothing.uncovered_to.item()) == ends
    assert nothing.branch_first_end.size == 0


def resonant() -> Problem:
    """A lightly damped cantilever with one stop, which repeats after two periods of slow excitation."""
    return cantilever(
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=100.0),),
        damping=ModalDamping(ratio=0.02),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=3.0),
    )


def test_no_branch_is_followed_once_the_effort_is_spent_and_the_number_left_out_is_told() -> None:
    short = branch(resonant(), FREQUENCY, 3.0, 3.1, max_period_multiple=2, errors=False, effort=1)
    assert short.branch_first_end.size == 1
    assert short.attrs["effort"] == 1
    assert int(short.left_out) >= 1


def test_the_mother_of_a_branch_is_followed_from_where_it_springs() -> None:
    found = branch(resonant(), FREQUENCY, 3.0, 3.1, max_period_multiple=2, errors=False)
    assert found.period_multiple.values[found.branch.values == 0][0] == 2
    mine = np.flatnonzero((found.period_multiple.values == 1) & (found.branch.values > 0))
    values = found.angular_frequency.values[mine]
    assert (values.min(), values.max()) == (3.0, 3.1)
    flips = found.bifurcation_value.values[found.bifurcation_kind.values == KINDS.index("flip")]
    # The branch ends where its mother flips, both located to 1e-9.
    assert np.abs(flips / found.angular_frequency.values[found.branch.values == 0].max() - 1).min() <= 1e-8


@pytest.mark.slow
def test_the_main_resonance_is_found_from_branches_of_two_periods_at_both_ends() -> None:
    found = branch(resonant(), FREQUENCY, 3.0, 12.0, max_period_multiple=4, errors=False)
    mine = [i for i in range(found.branch_first_end.size) if (found.period_multiple[found.branch == i] == 1).all()]
    spans = [np.ptp(found.angular_frequency.values[found.branch.values == i]) for i in mine]
    assert max(spans) == pytest.approx(9.0)
    assert "uncovered_from" not in found


@pytest.mark.thorough
def test_workers_find_the_same_branches_of_the_paper() -> None:
    how: dict[str, Any] = {"options": {"n_modes": 6}, "errors": False}
    alone = branch(paper_joint(), FREQUENCY, 103.0, 110.0, **how)
    assert "symmetry breaking" in {KINDS[kind] for kind in alone.bifurcation_kind.values}
    xr.testing.assert_identical(branch(paper_joint(), FREQUENCY, 103.0, 110.0, workers=2, **how), alone)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"max_period_multiple": 0}, "max_period_multiple = 0: must be an integer from 1 to 64"),
        ({"max_points": 1}, "max_points = 1: must be an integer from 2 to"),
        ({"effort": 0}, "effort = 0: must be an integer from 1 to"),
        ({"also_over": Axis("base_motion.amplitude", (1.0,))}, "is the number that changes along the branches already"),
        ({"also_over": Axis("stops.*.stiffness", (1e8, -2.0))}, r"stops\.\*\.stiffness = -2"),
        ({"scheduler": "nowhere"}, "scheduler = 'nowhere'"),
        ({"starts": -1}, "starts = -1: must be an integer from 0 to"),
        ({"seed": -1}, "seed = -1: must be an integer from 0 to"),
        ({"last": 3e-4}, "must differ from 0.0003, where the range begins"),
        ({"first": np.nan}, "from = nan: must be a finite number"),
        ({"path": "stops.7.gap"}, "there is no element '7'"),
        ({"first": -1e-4}, "must be"),
        ({"workers": 0}, "workers = 0"),
        ({"solver": "nothing"}, "solver = 'nothing' is not installed"),
        (
            {"solver": "analytic-published", "options": {}},
            "solver = analytic as published .*: lacks period_map of .*, which branches need",
        ),
    ],
)
def test_bad_input_is_refused_with_the_field_and_its_value(
    problem: Problem, asked: dict[str, Any], wrong: dict[str, Any], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        branch(problem, **{**asked, **wrong})
