"""The gaps along a motion as exponential sums, against its field, and deviations as a march carries them.

Derivatives of marches are judged by differences in tests/cross/test_tangent.py.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.march import Coordinates, Joint, gap_view, march, march_linearised
from analytic.march.field import history_of
from analytic.march.initial_state import started
from analytic.period_map import PeriodMap
from lapjoint import (
    BaseMotion,
    ModalDamping,
    NoDamping,
    Problem,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    paper_joint,
)
from lapjoint.orbits.segments import Segment
from lapjoint.problem import FloatArray
from tests.helpers.beams import CLAMP, LONG

STOPS = (
    Stop(x=2.0, side="top", gap=2e-3, stiffness=1e5),
    Stop(x=1.0, side="bottom", gap=1e-3, stiffness=1e6),
)
BASE = BaseMotion(amplitude=0.005, angular_frequency=35.0)
PROBLEMS = {
    "the paper's": paper_joint(angular_frequency=515.0),
    "viscous, with a load": paper_joint(angular_frequency=515.0).replace(
        damping=ViscousDamping(coefficient=2000.0), point_loads=(StepLoad(x=1.0, force=40.0),)
    ),
    "overdamped": Problem(
        beam=LONG,
        supports=(CLAMP,),
        stops=STOPS,
        damping=ModalDamping(ratio=(3.0, 1.5, 0.1)),
        base_motion=BaseMotion(amplitude=0.05, angular_frequency=35.0),
    ),
    "with a rigid-body mode": Problem(
        beam=LONG,
        supports=(Support(x=0.0, translational=math.inf),),
        stops=(*STOPS, Stop(x=2.0, side="bottom", gap=2e-3, stiffness=1e5)),
        damping=NoDamping(),
        base_motion=BASE,
    ),
}


DIED_OUT = math.log(1e-16)
"""Of a mode, logarithm of what is left of its free motion."""
ALIKE, SLOW = 1e-12, 8
"""What rounding may leave of the largest of a column, and of how many modes: of others nothing may be left."""


def gaps(segment: Segment, t: FloatArray) -> FloatArray:
    """z at the stops by the sums, shape ``(P, m)``."""
    tau = t - segment.start
    waves = segment.amplitudes[:, None] * np.exp(np.outer(segment.rates, tau))
    return np.asarray((segment.weights @ waves).real + segment.polynomial @ np.stack([tau**0, tau, tau**2]))


def settled(problem: Problem, modes: int) -> tuple[Joint, Coordinates, float]:
    joint = Joint(problem, modes, modes)
    period = joint.period or math.nan
    return joint, march(joint, started(joint), 0.0, 3 * period, record=False).end, period


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_sums_are_the_motion(name: str) -> None:
    problem = PROBLEMS[name]
    joint, begin, period = settled(problem, 8)
    motion = march(joint, begin, 0.0, period, depth=True)
    history, view = history_of("here", motion.joint, motion.log), gap_view(motion)
    assert len(view) == motion.log.slot.size > 2
    x = np.array([stop.x for stop in problem.stops])
    for segment, marched in zip(view, motion.segments, strict=True):
        t = np.linspace(segment.start, segment.end, 7)[:-1]
        z = history.field(x, t)
        np.testing.assert_allclose(gaps(segment, t), z, rtol=1e-11, atol=1e-13)  # rounding of motions of 1e-2 m
        assert segment.switched == marched.switched
        assert tuple(np.flatnonzero(segment.closed)) == marched.state.closed
        if segment.switched >= 0:  # the next state starts where this one ends
            stop = problem.stops[segment.switched]
            end = gaps(segment, np.array([segment.end]))[segment.switched, 0]
            assert stop.sign * end == pytest.approx(stop.gap, abs=1e-9 + 1e-3 * stop.gap)  # by truncation of 8 modes
    assert [one.end for one in view[:-1]] == [other.start for other in view[1:]]


def with_many_modes(seed: int) -> tuple[Joint, Coordinates, float]:
    """A lightly damped joint with many modes, where a motion of it begins, and for how long it is marched, s."""
    rng = np.random.default_rng((91, seed))
    frequency = math.exp(rng.uniform(math.log(80.0), math.log(400.0)))
    problem = paper_joint(angular_frequency=frequency).replace(damping=ModalDamping(ratio=rng.uniform(0.015, 0.1)))
    modes, periods = int(rng.integers(40, 90)), int(rng.integers(5, 30))
    joint, period = Joint(problem, modes, modes), 2 * math.pi / frequency
    begin = march(joint, started(joint), 0.0, periods * period, record=False).end
    return joint, begin, int(rng.integers(2, 9)) * period / 2


@pytest.mark.parametrize("of", [*PROBLEMS, *range(12)])
def test_deviations_at_the_stops_are_those_that_a_march_carries(of: str | int) -> None:
    """Where fast modes have died out, units of the others are carried on: nothing is lost that rounding leaves."""
    joint, begin, duration = settled(PROBLEMS[of], 6) if isinstance(of, str) else with_many_modes(of)
    motion, fewer = march(joint, begin, 0.0, duration), 0
    norms, x = PeriodMap(joint, "").unit_norms(begin.y.size), np.array([stop.x for stop in joint.problem.stops])
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
        alike = 100 * ALIKE if isinstance(of, str) else ALIKE  # rigid bodies turn by little
        assert (np.abs(own - expected)[:, slow].max(axis=0) <= alike * np.abs(expected[:, slow]).max(axis=0)).all()
        left = joint.tables.root[motion.log.slot[i], : joint.count(state)].real * width > DIED_OUT
        fewer += np.count_nonzero(left) < 0.7 * left.size
    assert fewer or isinstance(of, str)  # so that units of the others are carried
