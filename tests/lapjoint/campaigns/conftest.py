"""What tests of campaigns share: the counting solver, installed, and the branches of a cantilever."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr
from counting_solver import installed
from small_joints import HIGH, LOW, TOUCHING

from lapjoint import branch
from lapjoint.campaigns.batch import made_solver


@pytest.fixture
def counting(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """The counting solver, installed for this process and its children; a folder for its files."""
    folder = tmp_path / "package"
    folder.mkdir()
    monkeypatch.setenv("PYTHONPATH", installed(folder))
    monkeypatch.setenv("COUNTING_LOG", str(tmp_path / "log"))
    monkeypatch.syspath_prepend(str(folder))
    made_solver.cache_clear()
    return tmp_path


@pytest.fixture(scope="session")
def branches() -> xr.Dataset:
    """A graze and two folds with their errors, for confirmations; no test changes the dataset."""
    return branch(TOUCHING, "base_motion.amplitude", LOW, HIGH, options={"n_modes": 8})
