"""Statistics do not depend on who worked, nor on interruptions, and refuse what they cannot be made of."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from killing import killed_at_work
from small_joints import SHAKEN

from lapjoint import InputError, Problem, SolverError, statistics, write_problem
from lapjoint.campaigns.statistics import job
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.problem.random_motion import RandomBaseMotion
from lapjoint.solver import Solver
from lapjoint.summaries.measure import Measure
from lapjoint.summaries.sums import Sums

GIVEN: dict[str, Any] = {"duration": 1.5, "options": {"n_modes": 2}}


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    return statistics(SHAKEN, seeds=4, **GIVEN)


def test_values_lie_within_their_intervals_and_differ_between_realisations(whole: xr.Dataset) -> None:
    ends = whole.displacement_rms_interval.sel(x=1.0).values
    assert 0 < ends[0] < float(whole.displacement_rms.sel(x=1.0)) < ends[1] < math.inf
    assert (whole.attrs["units"], whole.attrs["failed"]) == (4, 0)
    plan = Realisations(SHAKEN, 1.5, 4)
    assert plan.realisation(0) == SHAKEN
    third = plan.realisation(2)
    assert isinstance(third.base_motion, RandomBaseMotion)
    assert (third.base_motion.seed, third.point_loads[0].seed) == (2, 9)  # type: ignore[union-attr]


def test_a_single_march_says_how_far_it_has_come() -> None:
    long, seen = {**GIVEN, "duration": 200.0}, list[tuple[float, float]]()
    found = statistics(SHAKEN, progress=lambda done, total: seen.append((done, total)), **long)
    assert seen[0] == (0, 1)
    assert seen[-1] == (1, 1)
    parts = [done for done, _ in seen]
    assert parts == sorted(parts)
    assert len(parts) > 2  # between its first word and its last
    xr.testing.assert_identical(found, statistics(SHAKEN, **long))


@pytest.mark.thorough
def test_killed_at_once_they_resume_with_the_same_bits(whole: xr.Dataset, tmp_path: Path) -> None:
    out, problem = tmp_path / "stats.nc", tmp_path / "noisy.toml"
    write_problem(SHAKEN, problem)
    command = ["statistics", str(problem), "--duration", "1.5", "--seeds", "4", "--n-modes", "2", "--out", str(out)]
    killed_at_work(["-m", "lapjoint", *command, "--workers", "2"], out, 1)
    xr.testing.assert_identical(statistics(SHAKEN, seeds=4, out=out, **GIVEN), whole)


@pytest.mark.parametrize(
    ("problem", "given", "message"),
    [
        (SHAKEN, {"seeds": 0}, r"seeds = 0: must be an integer from 1"),
        (
            SHAKEN.replace(base_motion=None, point_loads=()),
            {"seeds": 2},
            r"seeds = 2: nothing in this problem is random",
        ),
        (SHAKEN, {"duration": None}, r"duration: is missing; only a problem with a record"),
        (SHAKEN, {"duration": 0.1}, r"duration = 0.1: must be longer than the .* s that are left out"),
        (SHAKEN, {"at": [2.0]}, r"x = 2: lies outside the beam"),
        (SHAKEN, {"solver": "none"}, r"solver = 'none' is not installed"),
    ],
)
def test_what_cannot_be_is_refused(problem: Problem, given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        statistics(problem, **{**GIVEN, **given})


def test_realisations_that_failed_are_told_and_left_out(monkeypatch: pytest.MonkeyPatch, whole: xr.Dataset) -> None:
    made = job.sums_of

    def fails(what: Measure, solver: Solver, problem: Problem, progress: Any) -> Sums:
        if problem.base_motion.seed in broken:  # type: ignore[union-attr]
            raise SolverError("stuck")
        return made(what, solver, problem, progress)

    monkeypatch.setattr(job, "sums_of", fails)
    broken = [2]
    found = statistics(SHAKEN, seeds=4, **GIVEN)
    assert (found.attrs["failed"], found.attrs["messages"], found.attrs["units"]) == (1, "stuck", 3)
    assert not np.array_equal(found.displacement_rms, whole.displacement_rms)
    broken = [0, 1, 2, 3]
    with pytest.raises(SolverError, match="no realisation came to its end: stuck"):
        statistics(SHAKEN, seeds=4, **GIVEN)
