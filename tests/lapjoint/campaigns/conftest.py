"""The counting solver, as tests of campaigns have it installed."""

from __future__ import annotations

from pathlib import Path

import pytest
from counting_solver import installed

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
