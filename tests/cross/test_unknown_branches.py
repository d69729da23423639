"""How likely an unknown branch is, as a search tells it, against marches that the search has not made.

The witnesses are marches at random frequencies, drawn as the search draws its own, each until a stable periodic motion
is certified.  The share of them that lie on no branch is compared with the probability that the search states.
"""

from __future__ import annotations

import numpy as np
import pytest
from population import joint

from lapjoint import FREQUENCY
from lapjoint.campaigns.branches.known import Curve, Motion
from lapjoint.campaigns.branches.plain import plain_start
from lapjoint.campaigns.branches.search import Search
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.random_start import random_initial
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits import search
from lapjoint.orbits.branches.starts import of_motion
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import Orbit

JOINTS, STARTS, WITNESSES = 30, 10, 20
PERIODS = 2000
"""Longest march of a witness, in periods."""
MULTIPLE = 4


def asked(number: int) -> BranchSpec:
    problem = joint(467, number)
    assert problem.base_motion is not None
    omega = problem.base_motion.angular_frequency
    return BranchSpec(
        problem,
        FREQUENCY,
        0.85 * omega,
        1.15 * omega,
        options={"n_modes": 4},
        max_period_multiple=MULTIPLE,
        starts=STARTS,
        errors=False,
        max_points=1000,
        effort=5_000,
    )


def witness(spec: BranchSpec, value: float, seed: tuple[int, ...]) -> Motion | None:
    """The stable motion in which a march from a random state ends; None if it is not certified."""
    resolution, problem = range_of(spec).resolution(value), spec.problem_at(value)
    problem = problem.replace(initial=random_initial(problem, resolution.solver, seed))
    half = HalfPeriods(resolution.map(value))
    effort = search.Effort(max_period_multiple=MULTIPLE, max_periods=PERIODS, growth=False)
    start = half.map.adopted(resolution.solver.period_map(problem).initial())
    motion = search.Search(half.map, effort).run(start).motion
    if not isinstance(motion, Orbit):
        return None
    return Motion(spec, plain_start(of_motion(resolution, value, motion.point, motion.half_periods)))


@pytest.mark.slow
@in_one_thread
def test_marches_end_on_unknown_branches_about_as_often_as_searches_say() -> None:
    """The mean distance of both over the joints is within three standard errors, taken from the joints themselves."""
    apart = list[float]()
    for number in range(JOINTS):
        spec = asked(number)
        whole, found = Search(spec, 0, 1), dict[str, dict[str, object]]()
        while parts := whole.go_on(found):
            found |= {part.name: part.solved(spec) for part in parts}
        reached, rng = whole.diagram.reached, np.random.default_rng((467, number, 7))
        curves = [Curve(spec, branch) for branch in whole.diagram.branches]
        motions = [witness(spec, float(rng.uniform(*spec.axis.values)), (99, number, k)) for k in range(WITNESSES)]
        is_off = [not any(motion.lies_on(curve) for curve in curves) for motion in motions if motion is not None]
        if reached.probability is None or not is_off:
            continue
        apart.append(reached.probability - float(np.mean(is_off)))
    error = float(np.std(apart, ddof=1)) / np.sqrt(len(apart))
    assert len(apart) >= JOINTS / 2
    assert abs(np.mean(apart)) <= 3 * error, f"apart by {np.mean(apart):.4f}, standard error {error:.4f}"
