"""Branches of joints with damped stops: both solvers follow them, and their points are the solvers' own motions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import Problem, paper_joint
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Limits, Traced, trace

PATH = "base_motion.angular_frequency"
SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=6)}
LAWS = pytest.mark.parametrize("may_pull", [False, True])


def preloaded(may_pull: bool) -> Problem:
    """The paper's joint, one of its stops with an interference, and all four damped."""
    joint = paper_joint()
    omega = joint.require_excitation_frequency("test")
    stops = [
        stop.model_copy(update={"damping": 0.05 * stop.stiffness / omega, "may_pull": may_pull}) for stop in joint.stops
    ]
    stops[0] = stops[0].model_copy(update={"gap": -0.3 * stops[0].gap})
    return joint.replace(stops=tuple(stops))


def traced(problem: Problem, solver: Any, low: float, high: float) -> Traced:
    """The branch of the motion from rest over a range of the frequency, as fractions of the problem's frequency."""
    omega = problem.require_excitation_frequency("test")
    grid = Grid(problem, (Axis(PATH, (omega,)),))
    of = ParameterRange(solver, lambda value: grid.with_values((value,)), PATH, low * omega, high * omega)
    start = start_from(of, omega, solver.period_map(problem).initial(), 4)
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
