"""Branches as a dataset: the same however the work is done, resumed, refused where it must be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import lapjoint
from lapjoint import BaseMotion, Beam, InputError, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch_parts
from lapjoint.campaigns.branch_dataset import KINDS, read_branches
from lapjoint.campaigns.dataset import read_curve
from lapjoint.campaigns.journal import journal_path
from lapjoint.errors import Interrupted

AMPLITUDE = "base_motion.amplitude"
LOW, HIGH = 3e-4, 4e-4
OPTIONS = {"n_modes": 3}


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
    assert (found.impulse.values[after:] > 0).all()


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
    out, solve_branch = tmp_path / "branch.nc", branch_parts.solve_branch

    def interrupted(*args: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(branch_parts, "solve_branch", interrupted)
    with pytest.raises(Interrupted, match=r"2 parts of the work are kept in .*; the same command resumes"):
        lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, out=out)
    monkeypatch.setattr(branch_parts, "solve_branch", solve_branch)
    monkeypatch.setattr(branch_parts, "solve_start", interrupted)
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


@pytest.mark.parametrize("workers", [1, 2])
def test_a_start_that_leads_to_a_known_branch_costs_one_process_nothing(
    problem: Problem, found: xr.Dataset, workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, solve_branch = [], branch_parts.solve_branch

    def counted(*args: object) -> dict[str, object]:
        made.append(args)
        return solve_branch(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(branch_parts, "solve_branch", counted)
    if workers == 1:
        again = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False)
        assert len(made) == 1
    else:
        monkeypatch.setattr(branch_parts, "solve_branch", solve_branch)
        again = lapjoint.branch(problem, AMPLITUDE, LOW, HIGH, options=OPTIONS, errors=False, workers=workers)
    xr.testing.assert_identical(again, found)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"max_period_multiple": 0}, "max_period_multiple = 0: must be an integer from 1 to 64"),
        ({"max_points": 1}, "max_points = 1: must be an integer from 2 to"),
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
