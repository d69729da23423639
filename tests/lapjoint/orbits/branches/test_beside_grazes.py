"""Motions beside a graze of which every second period alone has the contact: marches have them, too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from galerkin_arcs import GalerkinArcs, before_first_graze, marched, towards_graze

import analytic
from lapjoint import FREQUENCY, paper_joint
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.halves import beside_graze, half_difference
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import SequenceChange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Limits, trace

SEED, FARTHEST = 46, 3.0
FEW, MANY, MOST = (30, 35, 37, 48), 60, 150
"""Joints with such a motion beside the first graze; number of joints in all, and of steps along the curve of each."""
GROWING = 30.0
"""Largest multiplier of a motion that is marched: a march leaves others."""


def found_beside(index: int, grazes: int) -> Iterator[tuple[SequenceChange, CurvePoint]]:
    """The first grazes of a random joint, from small motions on, each with such a motion, if there is one."""
    _, resolution, free = before_first_graze(SEED, index, FARTHEST)
    for number, step in enumerate(follow(towards_graze(resolution, free))):
        if number == MOST or grazes == 0:
            return
        if isinstance(step, SequenceChange) and step.kind != "exchange":
            grazes -= 1
            point = beside_graze(step)
            if point is not None:
                yield step, point


def check(graze: SequenceChange, point: CurvePoint) -> None:
    """Fail unless it is a motion of the joint, by an integrator that knows the force law alone, and has its period."""
    arcs, n, periods = point.problem.resolution.arcs(point.value), point.coordinates, point.problem.half_periods // 2
    assert isinstance(arcs, GalerkinArcs)
    assert (periods, half_difference(point)) == (graze.before.problem.half_periods, None)
    if np.abs(point.multipliers).max() > GROWING:
        return
    after, half_way = (
        float(np.linalg.norm((marched(arcs, point, count) - point.u[:n]) / point.scale[:n]))
        for count in (periods, periods // 2)
    )
    assert after <= 1e-6
    assert after <= 1e-2 * half_way


@pytest.mark.parametrize("index", FEW)
def test_one_period_of_two_has_the_contact_and_marches_come_back_after_two(index: int) -> None:
    ((graze, point),) = found_beside(index, 1)
    assert point.problem.events == 2
    check(graze, point)


@pytest.mark.slow
def test_what_is_found_beside_grazes_of_random_joints_are_motions_of_twice_the_period() -> None:
    found = [one for index in range(MANY) for one in found_beside(index, MOST)]
    assert len(found) >= 10
    for graze, point in found:
        check(graze, point)


def test_a_branch_leads_to_motions_beside_its_grazes_if_asked_alone() -> None:
    """The paper's symmetric motion touches first with one half period of two."""
    low, high = 54.4, 54.43
    of = ParameterRange(analytic.Solver(), lambda omega: paper_joint(angular_frequency=omega), FREQUENCY, low, high)
    start = start_from(of, low, of.resolution(low).map(low).initial(), 1)
    assert start is not None
    without, with_them = (trace(of, start, 1, Limits(from_grazes=asked)) for asked in (False, True))
    assert without is not None
    assert with_them is not None
    assert len(with_them.starts) == len(without.starts) + 1
    (own,) = [one for one in with_them.starts if one.away_from is None]
    assert own.half_periods == 2 * start.half_periods
    daughter = trace(of, own, 1, Limits(from_grazes=True))
    assert daughter is not None
    assert "bifurcation" in daughter.ends
    grazes = [one.what.value for one in with_them.found if isinstance(one.what, SequenceChange)]
    end = daughter.points[0 if daughter.ends[0] == "bifurcation" else -1].value
    assert min(abs(value - end) for value in grazes) <= 1e-8 * end
    assert not daughter.springs
