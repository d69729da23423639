"""Basins as they are asked for: many starts in ten minutes on two cores, and none bound to what it does not reach."""

from __future__ import annotations

import json
import math
import os
import resource
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from population import joint

import analytic
from lapjoint import Problem, basins, paper_joint
from lapjoint.campaigns.basins.solve import prepared, start_of
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.point import section_from
from lapjoint.orbits import PeriodMap
from lapjoint.problem.files import from_toml
from validation.cases.rigid_bar import MIRROR

pytestmark = pytest.mark.long_march

SECONDS, CORES = 600.0, 2
DRAWN = 2000
DECAYS, LONGER = 25.0, 6  # decay times that the witness marches on, and how often again where it is not there yet
THERE = 1e-5  # of the size of a motion: what a march may be away from it in the end

BAR = from_toml(MIRROR.format(stiffness=1e6))
assert BAR.base_motion is not None
BAR = BAR.replace(base_motion=BAR.base_motion.model_copy(update={"angular_frequency": 52.0}))
"""The rigid bar between equal stops, so fast that a motion of two periods and its mirror image stand beside another."""


def used() -> float:
    """CPU time of this process and of its children that have ended, s."""
    whose = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
    return sum(resource.getrusage(who).ru_utime + resource.getrusage(who).ru_stime for who in whose)


def why_not(period_map: PeriodMap, plan: BasinPlan, number: int, multiple: int, section: str, periods: int) -> str:
    """Why the plain march from a start does not end on a motion; empty if it does.  No search takes part."""
    now = start_of(plan, prepared(plan, 0, "[]"), 0, number)
    first = section_from(json.loads(section))
    orbit = [first]
    for _ in range(multiple - 1):
        orbit.append(period_map.march(orbit[-1], 2).end)
    sizes = [period_map.size(point) for point in orbit]
    nearest = math.inf
    for _ in range(LONGER):
        now = period_map.march(now, 2 * periods).end
        distances = [period_map.norm(period_map.difference(now, point)) for point in orbit]
        nearest = min(distance / size for distance, size in zip(distances, sizes, strict=True))
        if nearest <= THERE:
            return ""
    return f"start {number} is {nearest:.1e} away from its motion after {LONGER * periods} periods"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("problem", "options", "energy", "starts"),
    [
        pytest.param(BAR, {"n_modes": 2}, 1.0, 100_000, id="rigid bar"),
        pytest.param(paper_joint(), {}, 1e5, 10_000, id="the paper's joint"),
        pytest.param(paper_joint(angular_frequency=100.0), {}, 1e3, 10_000, id="the paper's joint at 100 rad/s"),
    ],
)
def test_many_starts_end_where_they_are_said_to_end(
    problem: Problem, options: dict[str, int], energy: float, starts: int, tmp_path: Path
) -> None:
    before = used()
    workers = min(CORES, os.cpu_count() or 1)
    found = basins(
        problem, energy=energy, starts=starts, seed=3, options=options, workers=workers, out=tmp_path / "basins.nc"
    )
    spent = used() - before
    print(f"{spent:.0f} s of CPU, {dict(zip(found.period_multiple.values, found.fraction.values, strict=True))}")
    assert spent <= CORES * SECONDS
    assert float(found.unbound_fraction.sum()) <= 0.01
    plan = BasinPlan(problem, options=options, energy=energy, starts=starts, seed=3)
    period_map = analytic.Solver(**options).period_map(problem)
    periods = math.ceil(DECAYS / (period_map.lowest_damping_rate * period_map.period))
    drawn = np.random.default_rng(4).choice(starts, DRAWN, replace=False)
    wrong = []
    for number in drawn.tolist():
        motion = int(found.motion[number])
        if motion >= 0 and not int(found.pushed[number]):
            multiple, section = int(found.period_multiple[motion]), str(found.section_point.values[motion])
            wrong.append(why_not(period_map, plan, number, multiple, section, periods))
    assert len(wrong) >= 0.99 * DRAWN
    assert not any(wrong), [why for why in wrong if why]


POPULATION, STARTS = 60, 8
BY_CHANCE = 0.02
"""Share of starts whose transient is chaotic, so that rounding decides where they end: as measured of marches."""


@pytest.mark.slow
def test_starts_of_random_joints_end_in_the_motions_that_they_are_bound_to() -> None:
    checked, bound, wrong = 0, 0, []
    for index in range(POPULATION):
        problem, options = joint(5, index), {"n_modes": 5}
        how: dict[str, Any] = {"energy": 1e-5, "starts": STARTS, "seed": index, "options": options, "effort": 1000}
        found, plan = basins(problem, **how), BasinPlan(problem, **how)
        period_map = analytic.Solver(n_modes=5).period_map(problem)
        periods = math.ceil(DECAYS / (period_map.lowest_damping_rate * period_map.period))
        for number in range(STARTS):
            motion = int(found.motion[number])
            checked += 1
            if motion >= 0 and not int(found.pushed[number]):
                bound += 1
                multiple, section = int(found.period_multiple[motion]), str(found.section_point.values[motion])
                why = why_not(period_map, plan, number, multiple, section, periods)
                wrong += [f"joint {index}: {why}"] * bool(why)
    print(f"{bound} of {checked} starts bound, {len(wrong)} of them elsewhere: {wrong}")
    assert bound >= 0.5 * checked
    assert len(wrong) <= BY_CHANCE * bound, wrong
