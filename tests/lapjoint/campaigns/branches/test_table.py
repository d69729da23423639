"""The dataset of branches: first grazes are told apart, and parts of the range that no branch covers are named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr
from small_joints import HIGH, LOW

from lapjoint import InputError, Problem
from lapjoint.campaigns.branches.search import Diagram
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.branches.table import KINDS, branch_dataset, read_branches, uncovered
from lapjoint.campaigns.sweep.table import read_curve
from lapjoint.files.netcdf import write_netcdf
from lapjoint.problem import FloatArray


def ranging(values: list[float], ends: tuple[str, str], *bifurcations: dict[str, Any]) -> dict[str, Any]:
    """A branch of which only the values are asked."""
    return {"values": values, "ends": ends, "bifurcations": list(bifurcations)}


def test_kinds_are_those_of_the_sequence_of_codes() -> None:
    assert set(KINDS) == {"fold", "flip", "symmetry breaking", "neimark-sacker", "grazing"}


def test_each_point_closes_and_has_its_certificate(found: xr.Dataset) -> None:
    assert (found.residual.values <= 1e-9).all()
    leading = np.hypot(found.multiplier_real.values, found.multiplier_imag.values)
    assert ((leading < 1) == (found.stable.values == 1)).all()


def test_a_graze_on_one_side_of_which_nothing_is_touched_is_a_first_one(found: xr.Dataset) -> None:
    first = found.bifurcation_first.values == 1
    assert [KINDS[kind] for kind in found.bifurcation_kind.values[first]] == ["grazing"]
    graze = int(np.flatnonzero(first)[0])
    assert found.bifurcation_stop.values[graze] == 0
    assert found.bifurcation_after.values[graze] == "persists"
    assert (found.bifurcation_stop.values[~first] == -1).all()


def test_motions_at_bifurcations_are_json_with_the_number_there(found: xr.Dataset) -> None:
    for name in ("motion", "arcs"):
        texts = found[f"bifurcation_{name}"].values
        assert all(json.dumps(json.loads(text), separators=(",", ":")) == text for text in texts)
    values = [json.loads(text)[0] for text in found.bifurcation_motion.values]
    np.testing.assert_array_equal(values, found.bifurcation_value.values)  # no errors are asked: nothing is refined


def test_a_file_is_read_as_it_was_written_and_only_as_branches(found: xr.Dataset, tmp_path: Path) -> None:
    write_netcdf(found, tmp_path / "branch.nc")
    xr.testing.assert_equal(read_branches(tmp_path / "branch.nc"), found)
    with pytest.raises(InputError, match="is not the result of a sweep"):
        read_curve(tmp_path / "branch.nc")
    write_netcdf(found.assign_attrs(result_of="sweep"), tmp_path / "sweep.nc")
    with pytest.raises(InputError, match="is not the result of a search for branches"):
        read_branches(tmp_path / "sweep.nc")


def test_a_search_that_finds_nothing_has_a_dataset_that_says_so(spec: BranchSpec) -> None:
    nothing = branch_dataset(spec, [Diagram([], ["start 0: it stops"], 2)])
    assert nothing.failure_message.values.tolist() == ["start 0: it stops"]
    assert int(nothing.left_out) == 2
    assert (nothing.uncovered_from.item(), nothing.uncovered_to.item()) == (LOW, HIGH)
    assert nothing.sizes["point"] == nothing.sizes["bifurcation"] == nothing.sizes["branch_number"] == 0


def test_random_starts_of_which_none_led_to_a_stable_motion_tell_nothing(
    problem: Problem, asked: dict[str, Any]
) -> None:
    nothing = branch_dataset(BranchSpec(problem, **asked, starts=2), [Diagram([])])
    assert np.isnan(float(nothing.unknown_probability))
    assert "NaN where" in nothing.unknown_probability.attrs["long_name"]
    assert float(nothing.unknown_probability_bound) == 1.0


def test_parts_of_the_range_that_no_branch_covers_are_told_with_the_ends_beside_them(spec: BranchSpec) -> None:
    low = ranging([LOW, 3.2e-4], ("boundary", "graze"))
    ring = ranging([3.3e-4, 3.5e-4, 3.4e-4, 3.3e-4], ("closed", "closed"))
    high = ranging([3.6e-4, HIGH], ("lost", "boundary"))
    assert uncovered(spec, [low, high, ring]) == [
        (3.2e-4, 3.3e-4, "branch 0: graze; branch 2: closed"),
        (3.5e-4, 3.6e-4, "branch 2: fold; branch 1: lost"),
    ]
    assert uncovered(spec, [ranging([LOW, HIGH], ("boundary", "boundary")), ring]) == []
    assert uncovered(spec, [ring])[0] == (LOW, 3.3e-4, "branch 0: closed")


def test_a_branch_that_folds_at_a_graze_reaches_as_far_as_the_graze(spec: BranchSpec) -> None:
    graze = {"kind": "grazing", "after": "folds", "motion": [3.7e-4, None, 2]}
    branch = ranging([LOW, 3.6e-4, 3.5e-4], ("boundary", "effort"), graze)
    assert uncovered(spec, [branch]) == [(3.7e-4, HIGH, "branch 0 folds at a graze")]


def covered_by_sampling(branches: list[dict[str, Any]], values: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether each value lies on some branch."""
    ends = [(min(one["values"]), max(one["values"])) for one in branches]
    return np.asarray(np.any([(low <= values) & (values <= high) for low, high in ends], axis=0))


@pytest.mark.parametrize("seed", range(10))
def test_every_value_lies_on_a_branch_or_in_a_part_that_none_covers(spec: BranchSpec, seed: int) -> None:
    rng = np.random.default_rng((46, seed))
    branches = [ranging(rng.uniform(LOW, HIGH, 3).tolist(), ("lost", "lost")) for _ in range(int(rng.integers(1, 7)))]
    values, gaps = np.linspace(LOW, HIGH, 1001)[1:-1], uncovered(spec, branches)
    is_left = np.any([(first < values) & (values < last) for first, last, _ in gaps], axis=0)
    np.testing.assert_array_equal(is_left, ~covered_by_sampling(branches, values))
    assert all(why for _, _, why in gaps)
