"""Branches over curves with a fixed contact sequence: alike however the work is done, and none is lost in silence."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from lapjoint import FREQUENCY, Axis, BaseMotion, Beam, InputError, ModalDamping, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns.branch_dataset import KINDS, read_branches
from lapjoint.campaigns.branches import branch, search, solve
from lapjoint.campaigns.branches.known import Curve, Motion
from lapjoint.campaigns.branches.plain import plain_start, start_of
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.branches.table import uncovered
from lapjoint.campaigns.journal import journal_path
from lapjoint.errors import Interrupted
from lapjoint.orbits.curves.starts import of_motion, start_from
from lapjoint.problem.presets import paper_joint

AMPLITUDE = "base_motion.amplitude"
LOW, HIGH = 3e-4, 4e-4
OPTIONS = {"n_modes": 8}


def by_map(function: Callable[[Any], Any], batches: Iterable[Any]) -> Iterator[Any]:
    return map(function, batches)


def interrupted(*args: object) -> None:
    raise KeyboardInterrupt


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
    return branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)


@pytest.fixture(scope="module")
def spec(problem: Problem) -> BranchSpec:
    """What the problem's branches depend on."""
    return BranchSpec(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)


@pytest.fixture(scope="module")
def plain(spec: BranchSpec) -> dict[str, Any]:
    """The branch of the motion from rest at the low end."""
    return solve.solve_branch(spec, solve.solve_start(spec, 0)["starts"][0])


def test_the_starts_at_both_ends_lead_to_one_branch_with_two_folds(found: xr.Dataset) -> None:
    assert found.branch_first_end.size == 1
    assert [KINDS[kind] for kind in found.bifurcation_kind.values] == ["grazing", "fold", "fold"]
    assert found.bifurcation_first.values.tolist() == [1, 0, 0]
    assert found.base_motion_amplitude.values[[0, -1]] == pytest.approx([LOW, HIGH])
    first, last = found.bifurcation_point.values[1:]
    assert (found.stable.values[:first] == 1).all()
    assert (found.stable.values[first:last] == 0).all()
    assert (found.stable.values[last:] == 1).all()
    assert "uncovered_from" not in found


def test_each_point_closes_and_has_the_contacts_of_the_march(found: xr.Dataset) -> None:
    assert (found.residual.values <= 1e-9).all()
    leading = np.hypot(found.multiplier_real.values, found.multiplier_imag.values)
    assert ((leading < 1) == (found.stable.values == 1)).all()
    graze = int(found.bifurcation_point[0])
    assert (found.contact_count.values[:graze] == 0).all()
    assert (found.contact_count.values[graze + 1 :] == 1).all()


def test_a_file_is_written_read_and_not_made_again(problem: Problem, found: xr.Dataset, tmp_path: Path) -> None:
    out = tmp_path / "branch.nc"
    made = branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    xr.testing.assert_identical(made, found)
    assert not journal_path(out).exists()
    xr.testing.assert_equal(read_branches(out), found)
    with pytest.raises(InputError, match="is the result of another search for branches"):
        branch(problem, AMPLITUDE, LOW, 2 * HIGH, options=OPTIONS, errors=False, out=out)


def test_an_interrupted_search_resumes_from_its_journal(
    problem: Problem, found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "branch.nc"
    with monkeypatch.context() as patched:
        patched.setattr(search, "solve_branch", interrupted)
        with pytest.raises(Interrupted, match=r"2 parts of the work are kept in .*; the same command resumes"):
            branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    monkeypatch.setattr(search, "solve_start", interrupted)
    made = branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    xr.testing.assert_identical(made, found)


def test_a_branch_is_followed_once_though_several_starts_lead_to_it(
    problem: Problem, found: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []

    def counted(*args: Any) -> dict[str, Any]:
        made.append(args)
        return solve.solve_branch(*args)

    monkeypatch.setattr(search, "solve_branch", counted)
    again = branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)
    assert len(made) == 1
    xr.testing.assert_identical(again, found)


@pytest.mark.parametrize("workers", [pytest.param(2, marks=pytest.mark.thorough), by_map])
def test_workers_find_the_same_in_two_numbers(problem: Problem, workers: Any) -> None:
    also: dict[str, Any] = {"options": OPTIONS, "errors": False, "also_over": Axis("stops.*.gap", (1.05e-3, 1e-3))}
    alone = branch(problem, AMPLITUDE, LOW, HIGH, **also)
    assert np.bincount(alone.bifurcation_locus.values).tolist() == [2, 2, 2]
    xr.testing.assert_identical(branch(problem, AMPLITUDE, LOW, HIGH, workers=workers, **also), alone)


def test_a_start_comes_back_from_json_with_the_same_bits(spec: BranchSpec) -> None:
    of = range_of(spec)
    start = start_from(of, HIGH, of.resolution(HIGH).map(HIGH).initial(), 1)
    assert start is not None
    there = start.solved(of)
    assert there is not None
    one = type(start).at(there, (there.value, there.section()))
    back = start_of(json.loads(json.dumps(plain_start(one))))
    assert (back.sequence, back.half_periods, back.phase) == (one.sequence, one.half_periods, one.phase)
    np.testing.assert_array_equal(back.unknowns, one.unknowns)
    np.testing.assert_array_equal(back.direction, one.direction)
    assert back.away_from is not None
    assert back.away_from[0] == there.value
    np.testing.assert_array_equal(back.away_from[1].coordinates, there.section().coordinates)


@pytest.mark.parametrize("value", [3.1e-4, 3.21e-4, 3.3e-4, 3.36e-4, 3.39e-4])
def test_every_motion_that_a_march_keeps_lies_on_the_branch(
    spec: BranchSpec, plain: dict[str, Any], value: float
) -> None:
    of, curve = range_of(spec), Curve(spec, plain)
    resolution = of.resolution(value)
    assert Motion(spec, plain_start(_settled(of, value, None))).lies_on(curve)
    for one in curve.motions_at(value, 2):  # with a contact: one or two of them within the folds
        start = of_motion(resolution, value, one.section(), 2)
        assert Motion(spec, plain_start(start)).lies_on(curve)


def _settled(of: Any, value: float, point: Any) -> Any:
    return start_from(of, value, point or of.resolution(value).map(value).initial(), 1)


def test_a_motion_of_a_part_that_a_branch_lacks_does_not_lie_on_it(spec: BranchSpec, plain: dict[str, Any]) -> None:
    turn = next(i for i, (_, _, may_turn) in enumerate(plain["knots"]) if may_turn and i > len(plain["knots"]) // 2)
    part = Curve(spec, {**plain, "knots": plain["knots"][:turn]})
    of, value = range_of(spec), 3.9e-4
    motion = Motion(spec, plain_start(_settled(of, value, None)))
    assert motion.lies_on(Curve(spec, plain))
    assert not motion.lies_on(part)


def test_no_branch_is_followed_once_the_effort_is_spent(problem: Problem) -> None:
    one = branch(_hole(3.0), FREQUENCY, 3.0, 3.1, max_period_multiple=2, errors=False, effort=1)
    assert one.branch_first_end.size == 1
    assert int(one.left_out) >= 1


def test_a_branch_ends_with_the_points_that_are_allowed(problem: Problem) -> None:
    shares: list[float] = []
    short = branch(
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
    assert np.bincount(short.branch.values).max() <= 9
    assert any(0 < share < 1 for share in shares)
    assert max(shares) == 1


def test_what_could_not_be_followed_is_told(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*args: object) -> dict[str, object]:
        return {"starts": [], "points": [], "message": "stopped at t = 0.1 s"}

    monkeypatch.setattr(search, "solve_branch", stopped)
    nothing = branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)
    assert nothing.failure_message.values.tolist() == [
        f"a motion at {AMPLITUDE} = {value:g}: stopped at t = 0.1 s" for value in (LOW, HIGH)
    ]
    assert (nothing.uncovered_from.item(), nothing.uncovered_to.item()) == (LOW, HIGH)


def test_parts_of_the_range_that_no_branch_covers_are_told_with_the_ends_beside_them(spec: BranchSpec) -> None:
    def made(values: list[float], ends: tuple[str, str]) -> dict[str, Any]:
        return {"values": values, "ends": ends, "bifurcations": []}

    low = made([LOW, 3.2e-4], ("boundary", "graze"))
    ring = made([3.3e-4, 3.5e-4, 3.4e-4, 3.3e-4], ("closed", "closed"))
    high = made([3.6e-4, HIGH], ("lost", "boundary"))
    assert uncovered(spec, [low, high, ring]) == [
        (3.2e-4, 3.3e-4, "branch 0: graze; branch 2: closed"),
        (3.5e-4, 3.6e-4, "branch 2: fold; branch 1: lost"),
    ]
    assert uncovered(spec, [made([LOW, HIGH], ("boundary", "boundary")), ring]) == []
    assert uncovered(spec, [ring])[0] == (LOW, 3.3e-4, "branch 0: closed")


def _hole(frequency: float) -> Problem:
    """A lightly damped cantilever with one stop, which repeats after two periods of slow excitation."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=100.0),),
        damping=ModalDamping(ratio=0.02),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=frequency),
    )


def test_the_mother_of_a_branch_is_followed_from_where_it_springs() -> None:
    found = branch(_hole(3.0), FREQUENCY, 3.0, 3.1, max_period_multiple=2, errors=False)
    assert found.period_multiple.values[found.branch.values == 0][0] == 2
    mine = np.flatnonzero((found.period_multiple.values == 1) & (found.branch.values > 0))
    values = found.angular_frequency.values[mine]
    assert (values.min(), values.max()) == (3.0, 3.1)
    flips = found.bifurcation_value.values[found.bifurcation_kind.values == KINDS.index("flip")]
    assert np.abs(flips / found.angular_frequency.values[found.branch.values == 0].max() - 1).min() <= 1e-8


@pytest.mark.slow
def test_the_main_resonance_is_found_from_branches_of_two_periods_at_both_ends() -> None:
    found = branch(_hole(3.0), FREQUENCY, 3.0, 12.0, max_period_multiple=4, errors=False)
    mine = [i for i in range(found.branch_first_end.size) if (found.period_multiple[found.branch == i] == 1).all()]
    spans = [np.ptp(found.angular_frequency.values[found.branch.values == i]) for i in mine]
    assert max(spans) == pytest.approx(9.0)
    assert "uncovered_from" not in found


@pytest.mark.thorough
def test_workers_find_the_same_branches_of_the_paper(tmp_path: Path) -> None:
    how: dict[str, Any] = {"options": {"n_modes": 6}, "errors": False}
    alone = branch(paper_joint(), FREQUENCY, 103.0, 110.0, **how)
    assert "symmetry breaking" in {KINDS[kind] for kind in alone.bifurcation_kind.values}
    xr.testing.assert_identical(branch(paper_joint(), FREQUENCY, 103.0, 110.0, workers=2, **how), alone)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"max_points": 1}, "max_points = 1: must be an integer from 2 to"),
        ({"last": LOW}, "must differ from 0.0003, where the range begins"),
        ({"path": "stops.7.gap"}, "there is no element '7'"),
        ({"workers": 0}, "workers = 0"),
        ({"solver": "nothing"}, "solver = 'nothing' is not installed"),
    ],
)
def test_bad_input_is_refused_with_the_field_and_its_value(problem: Problem, wrong: dict[str, Any], says: str) -> None:
    right: dict[str, Any] = {"path": AMPLITUDE, "first": LOW, "last": HIGH, "options": OPTIONS}
    with pytest.raises(InputError, match=says):
        branch(problem, **{**right, **wrong})
