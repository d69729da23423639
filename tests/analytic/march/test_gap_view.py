"""The gaps along a motion as exponential sums: against its field, and against marches of its neighbours."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.march import Coordinates, Joint, gap_view, march
from analytic.march.field import history_of
from analytic.march.initial_state import started
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


def gaps(segment: Segment, t: FloatArray) -> FloatArray:
    """z at the stops by the sums, shape ``(P, m)``."""
    tau = t - segment.start
    waves = segment.amplitudes[:, None] * np.exp(np.outer(segment.rates, tau))
    return np.asarray((segment.weights @ waves).real + segment.polynomial @ np.stack([tau**0, tau, tau**2]))


def deviations(segment: Segment, e: FloatArray, t: FloatArray) -> FloatArray:
    """dz at the stops by the sums, shape ``(P, m)``."""
    tau, A = t - segment.start, segment.deviations
    free = A.shape[0]
    waves = (A @ e)[:, None] * np.exp(np.outer(segment.rates[:free], tau))
    drift = segment.drift @ e
    return np.asarray((segment.weights[:, :free] @ waves).real + drift[:, :1] + drift[:, 1:] * tau)


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


@pytest.mark.parametrize("name", PROBLEMS)
def test_deviations_are_those_of_neighbours_that_are_marched(name: str) -> None:
    problem = PROBLEMS[name]
    joint, begin, period = settled(problem, 6)
    view = gap_view(march(joint, begin, 0.0, period))
    rng, n = np.random.default_rng(2), begin.q.size
    e = np.concatenate([rng.standard_normal(n) * 1e-8, rng.standard_normal(n) * 1e-8 * 2 * math.pi / period])
    near = [gap_view(march(joint, begin.moved(begin.y + sign * e), 0.0, period)) for sign in (1, -1)]
    assert [one.switched for one in view] == [one.switched for one in near[0]] == [one.switched for one in near[1]]
    for segment, forth, back in zip(view, *near, strict=True):
        first, last = (pick(s.start for s in (segment, forth, back)) for pick in (max, max))
        last = min(s.end for s in (segment, forth, back))
        t = np.linspace(first, last, 7)
        expected = (gaps(forth, t) - gaps(back, t)) / 2
        size = np.abs(expected).max()
        # Differences of marches: their rounding, 1e-12 of 1e-8, and the third order in 1e-8.
        np.testing.assert_allclose(deviations(segment, e, t), expected, atol=1e-4 * size)
