"""Statistics do not depend on who worked, nor on interruptions, and refuse what they cannot be made of."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from killing import killed_at_work

from lapjoint import Beam, InputError, ModalDamping, Problem, SolverError, Stop, Support, statistics, write_problem
from lapjoint.campaigns.journal import journal_path
from lapjoint.campaigns.statistics import job
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.errors import Interrupted
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad
from lapjoint.solver import Solver
from lapjoint.summaries.measure import Measure
from lapjoint.summaries.sums import Sums

NOISY = Problem(
    title="Shaken",
    beam=Beam(length=1.0, bending_stiffness=200.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    stops=(Stop(x=1.0, side="top", gap=1e-4, stiffness=1e4),),
    damping=ModalDamping(ratio=0.1),
    base_motion=RandomBaseMotion(psd=[[5.0, 1.0], [40.0, 1.0]]),
    point_loads=(RandomLoad(x=0.5, psd=[[5.0, 1.0], [40.0, 1.0]], seed=7),),
)
GIVEN: dict[str, Any] = {"duration": 1.5, "options": {"n_modes": 2}}


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    return statistics(NOISY, seeds=4, **GIVEN)


def test_values_lie_within_their_intervals_and_differ_between_realisations(whole: xr.Dataset) -> None:
    ends = whole.displacement_rms_interval.sel(x=1.0).values
    assert 0 < ends[0] < float(whole.displacement_rms.sel(x=1.0)) < ends[1] < math.inf
    assert (whole.attrs["units"], whole.attrs["failed"]) == (4, 0)
    plan = Realisations(NOISY, 1.5, 4)
    assert plan.realisation(0) == NOISY
    third = plan.realisation(2)
    assert isinstance(third.base_motion, RandomBaseMotion)
    assert (third.base_motion.seed, third.point_loads[0].seed) == (2, 9)  # type: ignore[union-attr]


@pytest.mark.thorough
def test_two_processes_find_what_one_does(whole: xr.Dataset) -> None:
    xr.testing.assert_identical(statistics(NOISY, seeds=4, workers=2, **GIVEN), whole)


def test_a_function_like_map_finds_the_same(whole: xr.Dataset) -> None:
    xr.testing.assert_identical(
        statistics(NOISY, seeds=4, workers=lambda work, of: map(work, reversed(of)), **GIVEN), whole
    )


def test_interrupted_they_resume_with_the_same_bits(whole: xr.Dataset, tmp_path: Path) -> None:
    out = tmp_path / "stats.nc"

    def press(done: float, total: float) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(
        Interrupted, match=r"2 of 4 realisations are kept in .*stats.nc.journal; the same command resumes"
    ):
        statistics(NOISY, seeds=4, out=out, progress=press, **GIVEN)
    seen: list[float] = []
    again = statistics(NOISY, seeds=4, out=out, progress=lambda done, total: seen.append(done), **GIVEN)
    assert [done for done in seen if done == int(done)] == [2, 3, 4]
    xr.testing.assert_identical(again, whole)
    assert not journal_path(out).exists()
    xr.testing.assert_identical(statistics(NOISY, seeds=4, out=out, **GIVEN), whole)
    with pytest.raises(InputError, match=r"is the result of another run of statistics; choose"):
        statistics(NOISY, seeds=3, out=out, **GIVEN)


def test_a_single_march_says_how_far_it_has_come() -> None:
    long, seen = {**GIVEN, "duration": 200.0}, list[tuple[float, float]]()
    found = statistics(NOISY, progress=lambda done, total: seen.append((done, total)), **long)
    assert seen[0] == (0, 1)
    assert seen[-1] == (1, 1)
    parts = [done for done, _ in seen]
    assert parts == sorted(parts)
    assert len(parts) > 2  # between its first word and its last
    xr.testing.assert_identical(found, statistics(NOISY, **long))


@pytest.mark.thorough
def test_killed_at_once_they_resume_with_the_same_bits(whole: xr.Dataset, tmp_path: Path) -> None:
    out, problem = tmp_path / "stats.nc", tmp_path / "noisy.toml"
    write_problem(NOISY, problem)
    command = ["statistics", str(problem), "--duration", "1.5", "--seeds", "4", "--modes", "2", "--out", str(out)]
    killed_at_work(["-m", "lapjoint", *command, "--workers", "2"], out, 1)
    xr.testing.assert_identical(statistics(NOISY, seeds=4, out=out, **GIVEN), whole)


@pytest.mark.parametrize(
    ("problem", "given", "message"),
    [
        (NOISY, {"seeds": 0}, r"seeds = 0: must be an integer from 1"),
        (
            NOISY.replace(base_motion=None, point_loads=()),
            {"seeds": 2},
            r"seeds = 2: nothing in this problem is random",
        ),
        (NOISY, {"duration": None}, r"duration: is missing; only a problem with a record"),
        (NOISY, {"duration": 0.1}, r"duration = 0.1: must be longer than the .* s that are left out"),
        (NOISY, {"at": [2.0]}, r"x = 2: lies outside the beam"),
        (NOISY, {"solver": "none"}, r"solver = 'none' is not installed"),
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
    found = statistics(NOISY, seeds=4, **GIVEN)
    assert (found.attrs["failed"], found.attrs["messages"], found.attrs["units"]) == (1, "stuck", 3)
    assert not np.array_equal(found.displacement_rms, whole.displacement_rms)
    broken = [0, 1, 2, 3]
    with pytest.raises(SolverError, match="no realisation came to its end: stuck"):
        statistics(NOISY, seeds=4, **GIVEN)
