"""Branches as a dataset: the same however the work is done, resumed, refused where it must be."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import lapjoint
from lapjoint import FREQUENCY, Axis, BaseMotion, Beam, InputError, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch_search
from lapjoint.campaigns.branch_dataset import KINDS, read_branches
from lapjoint.campaigns.dataset import read_curve
from lapjoint.campaigns.journal import journal_path
from lapjoint.errors import Interrupted

AMPLITUDE = "base_motion.amplitude"
LOW, HIGH = 3e-4, 4e-4
OPTIONS = {"n_modes": 3}
FELT = 1e-6  # N: just beyond a graze a contact is so light that its impulse is below rounding
DOUBLING: dict[str, Any] = {"options": {"n_modes": 2}, "errors": False, "max_period_multiple": 2}


def by_map(function: Callable[[Any], Any], batches: Iterable[Any]) -> Iterator[Any]:
    return map(function, batches)


@pytest.fixture(scope="module")
def problem() -> Problem:
    """A viscously damped cantilever with one stop, which it first touches within the range."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=LOW, angular_frequency=5.0),
    )


@pytest.fixture(scope="module")
def found(problem: Problem) -> xr.Dataset:
    """The branches of the problem, found by one process."""
    return lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)


def test_the_starts_at_both_ends_lead_to_one_branch_with_two_folds(found: xr.Dataset) -> None:
    assert found.branch_first_end.size == 1
    assert set(found.branch.values) == {0}
    assert [KINDS[kind] for kind in found.bifurcation_kind.values] == ["grazing", "fold", "fold"]
    assert found.base_motion_amplitude.values[[0, -1]] == pytest.approx([LOW, HIGH])
    first, last = found.bifurcation_point.values[1:]
    assert (found.stable.values[:first] == 1).all()
    assert (found.stable.values[first:last] == 0).all()
    assert (found.stable.values[last:] == 1).all()


def test_contacts_begin_at_the_graze(found: xr.Dataset) -> None:
    after = int(found.bifurcation_point[0]) + 1  # the motion just before the graze is a point of the branch
    assert (found.contact_count.values[:after] == 0).all()
    assert (found.contact_count.values[after:] > 0).all()
    force = found.peak_force.values[after:]
    assert (force > 0).all()
    assert (found.impulse.values[after:][force > FELT] > 0).all()


def test_each_point_closes_and_has_its_certificate(found: xr.Dataset) -> None:
    assert (found.residual.values <= 1e-9).all()
    leading = np.hypot(found.multiplier_real.values, found.multiplier_imag.values)
    assert ((leading < 1) == (found.stable.values == 1)).all()


def test_a_file_is_written_read_and_not_made_again(problem: Problem, found: xr.Dataset, tmp_path: Path) -> None:
    out = tmp_path / "branch.nc"
    made = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    xr.testing.assert_identical(made, found)
    assert not journal_path(out).exists()
    xr.testing.assert_equal(read_branches(out), found)
    with pytest.raises(InputError, match="is not the result of a sweep"):
        read_curve(out)
    with pytest.raises(InputError, match="is the result of another search for branches"):
        lapjoint.branch(problem, AMPLITUDE, LOW, 2 * HIGH, options=OPTIONS, errors=False, out=out)


def test_an_interrupted_search_resumes(
    problem: Problem, found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, solve_branch = tmp_path / "branch.nc", branch_search.solve_branch

    def interrupted(*args: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(branch_search, "solve_branch", interrupted)
    with pytest.raises(Interrupted, match=r"2 parts of the work are kept in .*; the same command resumes"):
        lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    monkeypatch.setattr(branch_search, "solve_branch", solve_branch)
    monkeypatch.setattr(branch_search, "solve_start", interrupted)
    made = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    xr.testing.assert_identical(made, found)


def test_a_branch_ends_with_the_effort_that_is_allowed(problem: Problem) -> None:
    shares: list[float] = []
    short = lapjoint.branch(
        problem,
        AMPLITUDE,
        LOW,
        HIGH,
        options=OPTIONS,
        errors=False,
        max_points=8,
        progress=lambda done, total: shares.append(done / total),
    )
    assert "effort" in [*short.branch_first_end.values, *short.branch_last_end.values]
    assert np.bincount(short.branch.values).max() <= 8 + 2  # a graze is two points
    assert any(0 < share < 1 for share in shares)
    assert max(shares) == 1


@pytest.mark.parametrize("workers", [1, by_map])
def test_a_start_that_leads_to_a_known_branch_costs_one_process_nothing(
    problem: Problem, found: xr.Dataset, workers: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, solve_branch = [], branch_search.solve_branch

    def counted(*args: object) -> dict[str, object]:
        made.append(args)
        return solve_branch(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(branch_search, "solve_branch", counted)
    if workers == 1:
        again = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)
        assert len(made) == 1
    else:
        monkeypatch.setattr(branch_search, "solve_branch", solve_branch)
        again = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, workers=workers)
    xr.testing.assert_identical(again, found)


GAPS = (1.05e-3, 1e-3, 0.95e-3)
ALSO: dict[str, Any] = {
    "options": OPTIONS,
    "errors": False,
    "also_over": Axis("stops.*.gap", GAPS),
}


@pytest.fixture(scope="module")
def in_two_numbers(problem: Problem) -> xr.Dataset:
    """The branches for three gaps, found by one process."""
    return lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, **ALSO)


def test_a_second_number_gives_the_branches_of_each_of_its_values(
    in_two_numbers: xr.Dataset, found: xr.Dataset
) -> None:
    assert in_two_numbers.stops_all_gap.values.tolist() == list(GAPS)
    assert in_two_numbers.branch_also_over.values.tolist() == list(GAPS)
    own = in_two_numbers.branch_also_over.values[in_two_numbers.branch.values] == 1e-3
    np.testing.assert_array_equal(in_two_numbers.base_motion_amplitude.values[own], found.base_motion_amplitude.values)
    mine = in_two_numbers.bifurcation_also_over.values == 1e-3
    np.testing.assert_array_equal(in_two_numbers.bifurcation_value.values[mine], found.bifurcation_value.values)


def test_bifurcations_that_scale_with_the_gap_lie_on_one_locus_each(in_two_numbers: xr.Dataset) -> None:
    gap, value, locus = (in_two_numbers[f"bifurcation_{name}"].values for name in ("also_over", "value", "locus"))
    assert np.bincount(locus).tolist() == [3, 3, 3]
    for number, kind in enumerate(("grazing", "fold", "fold")):
        mine = locus == number
        assert {KINDS[one] for one in in_two_numbers.bifurcation_kind.values[mine]} == {kind}
        assert np.ptp(value[mine] / gap[mine]) <= 1e-7 * value[mine][0] / gap[mine][0]  # located to 1e-9 each


@pytest.mark.parametrize("workers", [pytest.param(2, marks=pytest.mark.thorough), by_map])
def test_workers_find_the_same_in_two_numbers(problem: Problem, in_two_numbers: xr.Dataset, workers: Any) -> None:
    xr.testing.assert_identical(lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, workers=workers, **ALSO), in_two_numbers)


def test_a_search_in_two_numbers_resumes_where_it_was_interrupted(
    problem: Problem, in_two_numbers: xr.Dataset, tmp_path: Path
) -> None:
    out = tmp_path / "loci.nc"

    def interrupt(done: float, total: float) -> None:
        if done >= 5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match=r"5 parts of the work are kept in .*; the same command resumes"):
        lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, out=out, progress=interrupt, **ALSO)
    shown: list[tuple[float, float]] = []
    made = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, out=out, progress=lambda *now: shown.append(now), **ALSO)
    assert shown[0][0] == 5
    assert all(done <= known for done, known in shown)
    xr.testing.assert_identical(made, in_two_numbers)
    xr.testing.assert_equal(read_branches(out), made)


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.thorough), by_map])
def test_no_branch_is_followed_once_the_effort_is_spent_and_the_number_left_out_is_told(
    problem: Problem, found: xr.Dataset, workers: Any
) -> None:
    hard = problem.replace(
        stops=(problem.stops[0].model_copy(update={"stiffness": 500.0}),),
        base_motion=BaseMotion(amplitude=HIGH, angular_frequency=5.0),
    )
    short = lapjoint.branch(hard, FREQUENCY, 5.0, 8.0, **DOUBLING, effort=1, workers=workers)
    assert int(found.left_out) == 0
    assert short.branch_first_end.size == 1
    assert short.attrs["effort"] == 1
    assert int(short.left_out) >= 2


def test_what_could_not_be_followed_is_told(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*args: object) -> dict[str, object]:
        return {"seeds": [], "points": [], "message": "stopped at t = 0.1 s"}

    monkeypatch.setattr(branch_search, "solve_branch", stopped)
    found = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)
    assert found.failure_message.values.tolist() == [
        f"a motion at {AMPLITUDE} = {value:g}: stopped at t = 0.1 s" for value in (LOW, HIGH)
    ]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"max_period_multiple": 0}, "max_period_multiple = 0: must be an integer from 1 to 64"),
        ({"max_points": 1}, "max_points = 1: must be an integer from 2 to"),
        ({"effort": 0}, "effort = 0: must be an integer from 1 to"),
        ({"also_over": Axis(AMPLITUDE, (1.0,))}, "is the number that changes along the branches already"),
        ({"also_over": Axis("stops.*.gap", (1e-3, -2.0))}, r"stops\.\*\.gap = -2"),
        ({"scheduler": "nowhere"}, "scheduler = 'nowhere'"),
        ({"starts": -1}, "starts = -1: must be an integer from 0 to"),
        ({"last": LOW}, "must differ from 0.0003, where the range begins"),
        ({"first": np.nan}, "from = nan: must be a finite number"),
        ({"path": "stops.7.gap"}, "there is no element '7'"),
        ({"first": -1e-4}, "must be"),
        ({"workers": 0}, "workers = 0"),
        ({"solver": "nothing"}, "solver = 'nothing' is not installed"),
    ],
)
def test_bad_input_is_refused_with_the_field_and_its_value(
    problem: Problem, wrong: dict[str, object], says: str
) -> None:
    right: dict[str, object] = {"path": AMPLITUDE, "first": LOW, "last": HIGH, "options": OPTIONS}
    with pytest.raises(InputError, match=says):
        lapjoint.branch(problem, **{**right, **wrong})  # type: ignore[arg-type]
