"""Branches of joints with damped stops: both solvers follow them, and their points are the solvers' own motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from few_and_many import few_and_many
from random_joints import DAMPED

import analytic
import fe_lapjoint
from lapjoint import Problem, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Limits, Traced, trace

PATH = "base_motion.angular_frequency"
SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=6)}
SETTLING: dict[str, Any] = {  # with fewer modes, arcs and marches differ by what a truncated switch loses, over 1e-6
    "analytic": analytic.Solver(n_modes=16, max_periods=1500),
    "fe": fe_lapjoint.Solver(elements=6, max_periods=1500),
}
SEED = 271
SAME_IMPULSES = 1e-6  # of the largest: one motion by the equations of the branch and by the search
LAWS = pytest.mark.parametrize("may_pull", [False, pytest.param(True, marks=pytest.mark.thorough)])


def preloaded(may_pull: bool) -> Problem:
    """The paper's joint, one of its stops with an interference, and all four damped."""
    joint = paper_joint()
    omega = joint.require_excitation_frequency("test")
    stops = [
        stop.model_copy(update={"damping": 0.05 * stop.stiffness / omega, "may_pull": may_pull}) for stop in joint.stops
    ]
    stops[0] = stops[0].model_copy(update={"gap": -0.3 * stops[0].gap})
    return joint.replace(stops=tuple(stops))


def traced(problem: Problem, solver: Any, low: float, high: float, start_at: SectionPoint | None = None) -> Traced:
    """The branch of the motion from rest, or from a section point, over a range of the frequency, as fractions of the
    problem's frequency."""
    omega = problem.require_excitation_frequency("test")
    grid = Grid(problem, (Axis(PATH, (omega,)),))
    of = ParameterRange(solver, lambda value: grid.with_values((value,)), PATH, low * omega, high * omega)
    start = start_from(of, omega, start_at or solver.period_map(problem).initial(), 4)
    assert start is not None
    found = trace(of, start, 2, Limits(max_points=100))
    assert found is not None
    return found


def check_point(point: CurvePoint) -> None:
    """Fail unless the solver's own march closes the motion and has its multipliers."""
    period_map = point.problem.resolution.map(point.value)
    section = point.section()
    ahead = period_map.linearised(section, point.problem.half_periods)
    apart = period_map.norm(period_map.difference(ahead.end, section)) / period_map.size(section)
    assert apart <= 1e-6
    mine, known = (np.sort(np.abs(values))[::-1][:3] for values in (point.multipliers, ahead.multipliers))
    assert mine == pytest.approx(known, rel=1e-4, abs=1e-6)


@LAWS
def test_the_branch_of_a_preloaded_damped_joint_is_followed_by_both_solvers(may_pull: bool) -> None:
    problem, values = preloaded(may_pull), []
    for solver in SOLVERS.values():
        found = traced(problem, solver, 0.98, 1.02)
        assert found.ends == ("boundary", "boundary")
        assert any(switch < 0 for switch in found.points[-1].problem.sequence.stops) == (not may_pull)
        for point in found.points[:: max(1, len(found.points) // 3)]:
            check_point(point)
        values.append(found.points[-1].problem.resolution.map(found.points[-1].value))
        impulses = values[-1].march(found.points[-1].section(), 2).impulses
        values[-1] = impulses
    assert values[0] == pytest.approx(values[1], rel=0.05)


def judged(name: str, index: int) -> int:
    """Compare five stable points of the branch of a random joint with the steady states found from them; how many."""
    solver, problem = SETTLING[name], DAMPED(SEED, index)
    steady = solver.steady_state(problem, sensitivity=False, errors=False)
    if steady.period_multiple != 1 or not steady.history.contacts:
        return 0
    found, count = traced(problem, solver, 0.97, 1.03, steady.section_point), 0
    for point in found.points[:: max(1, len(found.points) // 5)]:
        check_point(point)
        if np.abs(point.multipliers).max() >= 1:
            continue
        section, period_map = point.section(), point.problem.resolution.map(point.value)
        own = period_map.march(section, 2).impulses
        there = solver.steady_state(period_map.problem, start=section, sensitivity=False, errors=False)
        assert there.period_multiple == 1
        assert np.abs(there.impulses - own).max() <= SAME_IMPULSES * np.abs(own).max()
        count += 1
    return count


@pytest.mark.parametrize("name", SOLVERS)
@pytest.mark.parametrize("members", few_and_many((8,), range(56)))
def test_stable_points_of_branches_are_steady_states(name: str, members: Sequence[int]) -> None:
    followed = [count for count in (judged(name, index) for index in members) if count]
    assert len(followed) >= len(members) / 4
