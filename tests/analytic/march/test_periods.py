"""Marches over whole periods, and the growth of a deviation: to the bits of one march after another."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.march import Coordinates, Joint, march, march_linearised, march_periods, measure_growth
from analytic.march.carried import size_of
from analytic.march.initial_state import started
from lapjoint import Problem, StepLoad, ViscousDamping, paper_joint
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray

PROBLEMS = {
    "symmetric": paper_joint(angular_frequency=820.0),
    "lightly damped": paper_joint(angular_frequency=300.0, damping_ratio=0.005),
    "viscous, with a load": paper_joint(angular_frequency=515.0).replace(
        damping=ViscousDamping(coefficient=300.0), point_loads=(StepLoad(x=1.0, force=40.0),)
    ),
}


def period_of(problem: Problem) -> float:
    return problem.require_excitation_period("test")


def same(one: Coordinates, other: Coordinates) -> bool:
    return one.state == other.state and one.y.tobytes() == other.y.tobytes()


@pytest.mark.parametrize("name", PROBLEMS)
def test_periods_at_once_and_the_growth_of_a_deviation_are_those_one_by_one(name: str) -> None:
    problem, count = PROBLEMS[name], 25
    period, joint = period_of(problem), Joint(problem, 9, 7)
    begin = now = started(joint)
    deviation = np.random.default_rng(5).standard_normal(18)
    sizes, penetration, sections = np.zeros(count), np.zeros(4), []
    along: FloatArray = deviation.reshape(-1, 1) / size_of(deviation.reshape(-1, 1), period)
    for i in range(count):
        motion = march(joint, now, 0.0, period, record=False)
        _, along = march_linearised(joint, now, period, along)
        sizes[i] = size_of(along, period)
        along = along / sizes[i]
        now = motion.end
        penetration += motion.penetration
        sections.append(now)
    fresh = Joint(problem, 9, 7)
    bare, grown = march_periods(fresh, begin, period, count), measure_growth(fresh, begin, deviation, period, count)
    for found in (bare, grown):
        assert found.switches > 50
        assert same(found.end, now)
        assert found.penetration.tobytes() == penetration.tobytes()
    assert len(grown.slots) == count
    for slot, y, section in zip(grown.slots, grown.coordinates, sections, strict=True):
        assert fresh.state_in(slot) == section.state
        assert y[:, : section.q.size].tobytes() == section.y.tobytes()
    np.testing.assert_allclose(grown.growth, np.log(sizes), rtol=1e-14, atol=1e-14)
    assert grown.deviation.tobytes() == along[:, 0].tobytes()


def test_too_many_switches_are_an_error() -> None:
    problem = PROBLEMS["symmetric"]
    period, joint = period_of(problem), Joint(problem, 9, 7)
    with pytest.raises(SolverError, match="more than 20 switches"):
        march_periods(joint, started(joint), period, 1000, max_switches=20)
    with pytest.raises(SolverError, match="more than 20 switches"):
        measure_growth(joint, started(joint), np.ones(18), period, 1000, max_switches=20)
