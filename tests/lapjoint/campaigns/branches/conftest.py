"""A cantilever with one stop, which it first touches within a range of the amplitude: a graze and two folds."""

from __future__ import annotations

from typing import Any

import pytest
import xarray as xr
from small_joints import HIGH, LOW, TOUCHING

from lapjoint import Problem
from lapjoint.campaigns import branch
from lapjoint.campaigns.branches.solve import solve_branch, solve_start
from lapjoint.campaigns.branches.spec import BranchSpec


@pytest.fixture(scope="session")
def problem() -> Problem:
    """The cantilever at the low end of the range."""
    return TOUCHING


@pytest.fixture(scope="session")
def asked() -> dict[str, Any]:
    """What is asked of its branches."""
    amplitude = "base_motion.amplitude"
    return {"path": amplitude, "first": LOW, "last": HIGH, "options": {"n_modes": 2}, "errors": False}


@pytest.fixture(scope="session")
def found(problem: Problem, asked: dict[str, Any]) -> xr.Dataset:
    """The branches, found by one process."""
    return branch(problem, **asked)


@pytest.fixture(scope="session")
def spec(problem: Problem, asked: dict[str, Any]) -> BranchSpec:
    """The same as what branches depend on."""
    return BranchSpec(problem, **asked)


@pytest.fixture(scope="session")
def plain(spec: BranchSpec) -> dict[str, Any]:
    """The branch of the motion without contact at the low end."""
    return solve_branch(spec, solve_start(spec, 0)["starts"][0])
