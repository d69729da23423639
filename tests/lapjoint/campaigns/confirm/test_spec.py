"""What is looked for of a dataset of branches, and what is said of a bifurcation that cannot be looked for."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from lapjoint import Axis, InputError
from lapjoint.campaigns import branch
from lapjoint.campaigns.branches.search import Diagram
from lapjoint.campaigns.branches.table import branch_dataset
from lapjoint.campaigns.confirm import job
from lapjoint.campaigns.confirm.job import solve_bifurcation
from lapjoint.campaigns.confirm.spec import ConfirmSpec, confirm_spec
from lapjoint.campaigns.confirm.table import Confirmed
from lapjoint.errors import SolverError
from lapjoint.problem.files import from_toml

OPTIONS = {"elements": 4}


@pytest.fixture
def spec(branches: xr.Dataset) -> ConfirmSpec:
    return confirm_spec(branches, "fe", OPTIONS)


def test_all_bifurcations_are_looked_for_with_the_motions_of_the_finest_resolution(
    branches: xr.Dataset, spec: ConfirmSpec
) -> None:
    assert [row.kind for row in spec.rows] == ["grazing", "fold", "fold"]
    for row in spec.rows:
        assert row.value == branches.bifurcation_value.values[row.number]
        assert row.error == branches.bifurcation_error.values[row.number]
        assert json.loads(row.arcs)["finer"] >= 2  # an error takes two refinements
        assert row.also == 0


def test_what_was_asked_of_the_search_comes_back_from_its_dataset(branches: xr.Dataset, spec: ConfirmSpec) -> None:
    assert spec.branches.fingerprint == branches.attrs["fingerprint"]
    assert (spec.other.solver, spec.other.options) == ("fe", OPTIONS)


def test_a_search_that_followed_what_springs_at_grazes_comes_back_as_such(branches: xr.Dataset) -> None:
    also = replace(confirm_spec(branches, "fe", OPTIONS).branches, from_grazes=True)
    held = branches.assign_attrs(branch_dataset(also, [Diagram([])]).attrs)
    assert confirm_spec(held, "fe", OPTIONS).branches.fingerprint == also.fingerprint


def test_a_share_is_drawn_at_random_and_by_its_seed(branches: xr.Dataset) -> None:
    drawn = [confirm_spec(branches, "fe", OPTIONS, 0.4, seed) for seed in (0, 0, *range(1, 9))]
    assert all(spec.size == 1 for spec in drawn)
    assert drawn[0].rows == drawn[1].rows
    assert len({spec.rows[0].number for spec in drawn}) > 1
    both = confirm_spec(branches, "fe", OPTIONS, 0.7).rows
    assert [row.number for row in both] == sorted({row.number for row in both})
    assert len(both) == 2


def test_another_share_seed_solver_or_set_of_bifurcations_is_another_confirmation(
    branches: xr.Dataset, spec: ConfirmSpec
) -> None:
    others = [
        replace(spec, seed=1),
        replace(spec, share=0.5),
        replace(spec, options={"elements": 5}),
        replace(spec, rows=spec.rows[1:]),
    ]
    assert confirm_spec(branches, "fe", OPTIONS).fingerprint == spec.fingerprint
    assert len({one.fingerprint for one in (spec, *others)}) == 5


def test_at_values_of_a_second_number_each_bifurcation_is_looked_for_at_its_own(branches: xr.Dataset) -> None:
    gaps = (1.05e-3, 1e-3)
    found = branch(
        from_toml(branches.attrs["problem"]),
        "base_motion.amplitude",
        3e-4,
        4e-4,
        options={"n_modes": 2},
        also_over=Axis("stops.*.gap", gaps),
    )
    spec = confirm_spec(found, "fe", OPTIONS)
    assert [gaps[row.also] for row in spec.rows] == found.bifurcation_also_over.values.tolist()
    for row in spec.rows:
        assert spec.branches.at(row.also).problem.stops[0].gap == gaps[row.also]
        assert row.value == found.bifurcation_value.values[row.number]


def answer_of(spec: ConfirmSpec) -> Confirmed:
    return solve_bifurcation(spec, 0)


def test_a_bifurcation_without_a_motion_in_the_file_is_said(spec: ConfirmSpec) -> None:
    found = answer_of(replace(spec, rows=(replace(spec.rows[0], arcs=""),)))
    assert (found.verdict, found.message) == ("not found", "the file has no motion of it")
    assert np.isnan([found.value, found.error]).all()


def test_a_motion_that_the_first_solver_does_not_find_again_is_said(
    spec: ConfirmSpec, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(job, "located_of", lambda *_: None)
    assert "the first solver does not find it again" in answer_of(spec).message


def test_a_solver_that_stops_is_said_with_its_message(spec: ConfirmSpec, monkeypatch: pytest.MonkeyPatch) -> None:
    def stops(*args: Any) -> None:
        raise SolverError("stopped at t = 0.1 s")

    monkeypatch.setattr(job, "confirmed", stops)
    found = answer_of(spec)
    assert (found.verdict, found.message) == ("not found", "stopped at t = 0.1 s")


@pytest.mark.parametrize(
    ("without", "says"),
    [
        (lambda found: found.drop_vars("bifurcation_arcs"), "hold no motions at their bifurcations"),
        (lambda found: found.assign_attrs(errors=0), "state no errors of their bifurcations"),
        (lambda found: found.isel(bifurcation=slice(0, 0)), "there is nothing to confirm"),
    ],
)
def test_branches_that_cannot_be_confirmed_are_refused(branches: xr.Dataset, without: Any, says: str) -> None:
    with pytest.raises(InputError, match=says):
        confirm_spec(without(branches), "fe", OPTIONS)


@pytest.mark.parametrize(("share", "seed"), [(0.0, 0), (1.5, 0), (np.nan, 0), (True, 0), (1.0, -1)])
def test_a_share_or_seed_that_is_not_allowed_is_refused(branches: xr.Dataset, share: float, seed: int) -> None:
    with pytest.raises(InputError, match=r"share = |seed = -1"):
        confirm_spec(branches, "fe", OPTIONS, share, seed)
