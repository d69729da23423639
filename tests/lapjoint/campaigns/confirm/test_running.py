"""A confirmation is the same however the work is done, and another one in the file is not thrown away."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from lapjoint import InputError
from lapjoint.campaigns import confirm
from lapjoint.campaigns.dataset import read_result
from lapjoint.errors import Interrupted

OPTIONS = {"elements": 4}


def by_map(function: Callable[[Any], Any], batches: Iterable[Any]) -> Iterator[Any]:
    return map(function, batches)


@pytest.mark.parametrize("workers", [pytest.param(2, marks=pytest.mark.thorough), by_map])
def test_interrupted_it_resumes_to_the_same_bytes(branches: xr.Dataset, tmp_path: Path, workers: Any) -> None:
    def stop(done: float, whole: float) -> None:
        if done >= 1:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match=r"1 of 3 bifurcations are kept in .*; the same command resumes"):
        confirm(branches, options=OPTIONS, out=tmp_path / "a.nc", progress=stop)
    said: list[float] = []
    again = confirm(branches, options=OPTIONS, out=tmp_path / "a.nc", progress=lambda done, _: said.append(done))
    assert said[0] == 1
    whole = confirm(branches, options=OPTIONS, workers=workers, out=tmp_path / "b.nc")
    xr.testing.assert_identical(again, whole)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    with pytest.raises(InputError, match="is the result of another confirmation"):
        confirm(branches, options=OPTIONS, share=0.3, out=tmp_path / "a.nc")
    xr.testing.assert_equal(read_result(tmp_path / "a.nc", "confirmation"), again)


def test_both_solvers_agree_with_different_values(branches: xr.Dataset) -> None:
    found = confirm(branches, options=OPTIONS)
    assert found.number.values.tolist() == list(range(3))
    assert (found.ratio.values <= 1).all()
    assert (found.other_value.values != found.value.values).all()
    assert found.message.values.tolist() == [""] * 3
