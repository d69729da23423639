"""The dataset of a confirmation: distances over errors, verdicts, and why there is none."""

from __future__ import annotations

import numpy as np
import xarray as xr

from lapjoint import confirm
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.campaigns.confirm.spec import confirm_spec
from lapjoint.campaigns.confirm.table import VERDICTS, Confirmed, confirm_dataset


def test_each_bifurcation_has_its_verdict_and_its_distance_over_both_errors(branches: xr.Dataset) -> None:
    spec = confirm_spec(branches, "fe", {"elements": 4})
    first, second, third = spec.rows
    answers = [
        Confirmed(first.value + 3 * first.error, first.error, "apart"),
        Confirmed(second.value, np.inf, "no error stated"),
        Confirmed(message="stopped"),
    ]
    found = confirm_dataset(spec, answers)
    assert [VERDICTS[code] for code in found.verdict.values] == ["apart", "no error stated", "not found"]
    assert [KINDS[code] for code in found.kind.values] == [row.kind for row in spec.rows]
    # Of the difference of two near values 1e-16 over the error is lost.
    np.testing.assert_allclose(found.ratio.values[:2], [1.5, 0.0], atol=1e-3)
    assert np.isnan(found.ratio.values[2])
    assert np.isnan(found.other_value.values[2])
    assert found.message.values.tolist() == ["", "", "stopped"]
    assert found.attrs["branches"] == branches.attrs["fingerprint"]
    assert third.value == found.value.values[2]


def test_both_solvers_agree_with_different_values(branches: xr.Dataset) -> None:
    found = confirm(branches, options={"elements": 4})
    assert found.number.values.tolist() == list(range(3))
    assert (found.ratio.values <= 1).all()
    assert (found.other_value.values != found.value.values).all()
    assert found.message.values.tolist() == [""] * 3
