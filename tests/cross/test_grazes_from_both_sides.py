"""A graze lies where it lies, whichever side it is come to from.

Under modal damping with several modes the touched side is not smooth: the number runs as a power of the penetration
there, and a straight line from the nearest motion misses the graze by as much as that motion is away.
"""

from __future__ import annotations

import numpy as np
import pytest

import analytic
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import directly
from lapjoint.orbits.branches.grazing import beyond_graze, located_graze
from lapjoint.orbits.branches.run import Graze, Limits
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import Traced, trace

LOW, HIGH = 327.9, 328.05  # rad/s: the first stop's second contact arises at 327.979


@in_one_thread
def grazes(n_modes: int) -> list[Graze]:
    """The one graze of the motion from rest, come to from above and from below."""
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    grid = Grid(joint, (Axis(FREQUENCY, (LOW, HIGH)),))
    family = Family(analytic.Solver(n_modes=n_modes), lambda v: grid.with_values((v,)), FREQUENCY, LOW, HIGH)
    seed = seed_from(family, 328.03, family.at(328.03).map.initial(), 1)
    assert seed is not None
    start = corrected(family, seed.value, seed.point, seed.count, fixed=True)
    assert start is not None
    down = follow(family, start if start.tangent[-1] < 0 else start.turned(), Limits(most=50))
    up = follow(family, down.places[-1].turned(), Limits(most=50))
    assert len(down.grazes) == len(up.grazes) == 1
    return [down.grazes[0], up.grazes[0]]


@pytest.mark.parametrize("n_modes", [16, 24])
def test_a_graze_has_one_value_from_both_sides(n_modes: int) -> None:
    smooth, touched = grazes(n_modes)
    assert smooth.before.left <= 1e-11 * smooth.value < 1e-7 * smooth.value < touched.before.left
    assert max(smooth.left, touched.left) <= 1e-11 * smooth.value
    assert abs(touched.before.value - smooth.value) > 1e-6 * smooth.value  # what the straight line misses it by
    assert touched.value == pytest.approx(smooth.value, rel=1e-10)


def test_a_graze_is_where_its_motion_is() -> None:
    """Where the first stop begins to be touched, others lie close by: the smooth side is that of this one."""
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (1.0, 50.0)),))
    family = Family(analytic.Solver(), lambda v: grid.with_values((v,)), FREQUENCY, 1.0, 50.0)
    seed = seed_from(family, 4.29, family.at(4.29).map.initial(), 1)
    assert seed is not None
    start = corrected(family, seed.value, seed.point, seed.count)
    assert start is not None
    for place in (start, start.turned()):
        run = follow(family, place, Limits(most=60))
        assert run.grazes
        for graze in run.grazes:
            assert graze.value == pytest.approx(graze.before.place.value, rel=1e-6)


def nearest_graze(found: Traced, value: float) -> Graze:
    grazes = [it.found for it in found.bifurcations if isinstance(it.found, Graze)]
    return min(grazes, key=lambda graze: abs(graze.value - value))


@in_one_thread
def test_beyond_a_graze_at_which_a_symmetry_breaks_lies_the_motion_that_touches_neither_twin() -> None:
    """And not the mirror image of the motion before it, which is as near, and on the branch's other side.

    How far beyond the graze it is looked for depends on how fast the extremum changes with the arc length.
    """
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    grid = Grid(joint, (Axis(FREQUENCY, (326.1, 326.3)),))
    family = Family(analytic.Solver(), lambda v: grid.with_values((v,)), FREQUENCY, 326.1, 326.3)
    seed = seed_from(family, 326.3, family.at(326.3).map.initial(), 1)
    assert seed is not None
    both = trace(family, seed, most_multiple=1, errors=False)
    assert both is not None
    (one,) = (trace(family, seed, most_multiple=1, errors=False) for seed in both.seeds)
    assert one is not None
    graze = nearest_graze(one, both.branch.bifurcations[0].value)
    assert graze.value == pytest.approx(both.branch.bifurcations[0].value, rel=1e-11)
    before, value = graze.before, graze.value
    assert before.place.closings in {(2, 1, 1, 1), (1, 1, 2, 1)}  # it, or its mirror image
    for _ in range(3):
        for rate in np.copysign(np.geomspace(1e-5, 3e-3, 12), graze.rate):
            beyond = beyond_graze(family, before, rate)
            assert beyond is not None
            assert beyond.place.closings == (1, 1, 1, 1)
            assert beyond.value == pytest.approx(value, rel=1e-8)
        finer = family.finer(value)
        assert finer is not None
        family = finer[1]
        again = directly(graze)(family, before.place)
        assert again is not None
        extremum = again.place.matching(before.extremum, before.place.extrema.duration)
        assert extremum is not None
        found = located_graze(family, again.place, extremum, graze.rate)
        assert found is not None
        before, value = found, again.value


@in_one_thread
def test_branches_that_meet_at_a_graze_have_it_at_one_number() -> None:
    """A motion that touches one twin more and one that touches both come from one that touches neither."""
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (4.295, 4.2975)),))
    family = Family(analytic.Solver(n_modes=16), lambda v: grid.with_values((v,)), FREQUENCY, 4.295, 4.2975)
    seed = seed_from(family, 4.2975, family.at(4.2975).map.initial(), 1)
    assert seed is not None
    both = trace(family, seed, most_multiple=1, errors=False)
    assert both is not None
    (one,) = (trace(family, seed, most_multiple=1, errors=False) for seed in both.seeds)
    assert one is not None
    first, *_ = (it.found for it in both.bifurcations if isinstance(it.found, Graze))
    second = nearest_graze(one, first.value)
    assert [graze.before.place.closings for graze in (first, second)] == [(4, 0, 4, 0), (4, 0, 3, 0)]
    assert abs(second.before.value - first.value) > 1e-7 * first.value  # what the straight line misses it by
    assert second.value == pytest.approx(first.value, rel=1e-9)
