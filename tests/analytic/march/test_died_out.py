"""Where fast modes have died out, units of the others are carried on: nothing is lost that rounding leaves.

Deviations are judged by those that a march carries all the way, and these by marches from starts that are a little
apart.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.march import gap_view, march, march_linearised
from analytic.march.coordinates import Coordinates
from analytic.period_map import PeriodMap
from lapjoint import ModalDamping, paper_joint
from lapjoint.answers import SectionPoint

SETTLED, MODES = 30, (40, 90)
DIED_OUT = math.log(1e-16)
"""Of a mode, logarithm of what is left of its free motion."""
ALIKE, SLOW = 1e-12, 8
"""What rounding may leave of the largest of a column, and of how many modes: of others nothing may be left."""


def drawn(seed: int) -> tuple[PeriodMap, SectionPoint, int]:
    """A lightly damped joint with many modes, a motion of it, and for how many half periods it is marched."""
    rng = np.random.default_rng((91, seed))
    frequency = math.exp(rng.uniform(math.log(80.0), math.log(400.0)))
    problem = paper_joint(angular_frequency=frequency).replace(damping=ModalDamping(ratio=rng.uniform(0.015, 0.1)))
    period_map = analytic.Solver(n_modes=int(rng.integers(*MODES))).period_map(problem)
    point = period_map.march(period_map.initial(), 2 * int(rng.integers(5, SETTLED))).end
    return period_map, point, int(rng.integers(2, 9))


@pytest.mark.parametrize("seed", range(12))
def test_deviations_at_the_stops_are_those_of_all_columns(seed: int) -> None:
    period_map, point, half_periods = drawn(seed)
    joint, begin = period_map.joint, Coordinates(point.state, *point.coordinates)
    motion, fewer = march(joint, begin, 0.0, half_periods * period_map.period / 2), 0
    norms, x = period_map.unit_norms(point.coordinates.size), np.array([stop.x for stop in period_map.problem.stops])
    for i, one in enumerate(gap_view(motion)):
        state, width = joint.state_in(motion.log.slot[i]), one.end - one.start
        end, whole = march_linearised(joint, begin, one.start + width / 2, np.eye(norms.size))
        assert end.state == state
        waves = one.weights[:, : one.deviations.shape[0]] * np.exp(one.rates[: one.deviations.shape[0]] * width / 2)
        own = (waves @ one.deviations).real + one.drift[:, 0] + one.drift[:, 1] * width / 2
        expected = joint.shapes_at(state, x, 0).T @ whole[: joint.count(state)]
        own, expected = own / norms, expected / norms
        assert np.abs(own - expected).max() <= ALIKE * np.abs(expected).max()
        slow = [j for j in range(norms.size) if j % (norms.size // 2) < SLOW]
        assert (np.abs(own - expected)[:, slow].max(axis=0) <= ALIKE * np.abs(expected[:, slow]).max(axis=0)).all()
        left = joint.tables.root[motion.log.slot[i], : joint.count(state)].real * width > DIED_OUT
        fewer += np.count_nonzero(left) < 0.7 * left.size
    assert fewer > 0  # so that units of the others are carried
