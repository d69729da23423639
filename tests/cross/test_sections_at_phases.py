"""Motions whose sections lie at any phase, in another resolution or solver: loads and stops are those of that phase."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, SineLoad, Stop, Support, ViscousDamping
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.confirmation import shaped
from lapjoint.orbits.branches.errors import carried
from lapjoint.orbits.branches.point import CurvePoint, _at_section
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import SequenceChange
from lapjoint.orbits.branches.starts import at_parameter, start_from, without_contact
from lapjoint.orbits.branches.tracing import Limits, one_way

PATH = "base_motion.amplitude"
SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=6)}
BOTH = pytest.mark.parametrize("name", SOLVERS)
AMPLITUDE = 4.9e-4
JOINT = Problem(
    beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=inf, torsional=inf),),
    stops=(
        Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0, damping=0.3, fixed_to="space"),
        Stop(x=0.6, side="bottom", gap=0.6e-3, stiffness=80.0, damping=0.5, fixed_to="space"),
    ),
    damping=ViscousDamping(coefficient=0.8),
    base_motion=BaseMotion(amplitude=AMPLITUDE, angular_frequency=5.0),
    point_loads=(SineLoad(x=0.3, force=1e-4, angular_frequency=10.0, phase=0.7),),
)


def over_amplitudes(name: str, problem: Problem) -> ParameterRange:
    """The amplitudes of the base of a problem, m, for one solver."""
    grid = Grid(problem, (Axis(PATH, (AMPLITUDE,)),))
    return ParameterRange(SOLVERS[name], lambda value: grid.with_values((value,)), PATH, 2e-4, 5e-4)


def solved(name: str) -> CurvePoint:
    """The motion from rest, as a point of its branch."""
    of = over_amplitudes(name, JOINT)
    start = start_from(of, AMPLITUDE, SOLVERS[name].period_map(JOINT).initial(), 2)
    assert start is not None
    point = start.solved(of)
    assert point is not None
    return point


def in_all_arcs(point: CurvePoint) -> list[CurvePoint]:
    """The motion of a point with its section in the middle of each arc but the last."""
    found = []
    for arc in range(point.problem.events):
        problem, u = _at_section(point.problem, point.u, arc, 0.5 * point.durations[arc])
        there = at_parameter(problem, u)
        assert there is not None
        found.append(there)
    return found


@BOTH
def test_a_motion_keeps_its_section_wherever_it_lies(name: str) -> None:
    phases = set()
    for point in in_all_arcs(solved(name)):
        guess = carried(point, point.problem.resolution)
        assert guess is not None, point.problem.phase
        assert np.allclose(guess[1], point.u, rtol=1e-12, atol=1e-12 * point.scale.max())
        phases.add(round(point.problem.phase, 3))
    assert len(phases) > 3


@BOTH
def test_the_other_solver_takes_over_a_motion_wherever_its_section_lies(name: str) -> None:
    other = "fe" if name == "analytic" else "analytic"
    resolution, taken = over_amplitudes(other, JOINT).resolution(AMPLITUDE), 0
    own = solved(other)
    for point in in_all_arcs(solved(name)):
        found = shaped(point, resolution)
        assert found is not None, point.problem.phase
        problem, u = found
        residual = problem.residual(u)[: problem.coordinates(u)] / own.scale[: problem.coordinates(u)]
        assert np.abs(residual).max() <= 0.05, point.problem.phase
        taken += 1
    assert taken > 3


def test_a_graze_is_not_also_a_fold() -> None:
    """The parameter is even in the time beyond a graze, so that its derivative along the curve is zero there."""
    of = over_amplitudes("analytic", JOINT.replace(point_loads=()))
    start = without_contact(of, 4.8e-4)
    point = None if start is None else start.solved(of)
    assert point is not None
    found = [one.what for one in one_way(of, point, Limits(max_points=20)).found]
    assert any(isinstance(what, SequenceChange) for what in found)
    for what in found:
        if isinstance(what, Bifurcation):
            assert min(abs(what.point.shares)) > 1e-4
