"""The section points of a motion and of its mirror image, from each of which a branch is known again.

A symmetric motion of three half periods has three section points: half a period later it is its own mirror image at
another of them.  It is a subharmonic of the paper's joint with little damping.
"""

from __future__ import annotations

import numpy as np

import analytic
from lapjoint import ModalDamping, Problem, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import FREQUENCY
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.by_another_solver import _Search
from lapjoint.orbits.branches.closing import begun_anywhere, images_of
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.seeds import on_branch
from lapjoint.orbits.branches.tracing import Seed

OMEGA, SETTLED = 293.0, 500


def problem_at(omega: float) -> Problem:
    """The joint at an angular frequency, with a hundredth of critical damping."""
    return paper_joint(angular_frequency=omega).replace(damping=ModalDamping(ratio=0.01))


def subharmonic(family: Family) -> SectionPoint:
    """A section point of the motion, to which every third start leads."""
    half, rng = family.at(OMEGA), np.random.default_rng(4)
    map_ = half.map
    start, size = map_.initial(), map_.size(map_.march(map_.initial(), 2).end)
    units = size / half.unit_norms(start.coordinates.size) / np.sqrt(start.coordinates.size)
    for _ in range(20):
        begin = map_.moved(start, 3 * rng.standard_normal(units.size) * units)
        point = map_.march(begin, 2 * SETTLED).end
        if half.apart(half.marched(point, 3), point) < 1e-4 < 1e-2 < half.apart(half.marched(point, 1), point):
            return point
    raise AssertionError("no start leads there")


def test_a_symmetric_motion_of_three_half_periods_is_known_from_each_of_its_section_points() -> None:
    family = Family(analytic.Solver(n_modes=6), problem_at, FREQUENCY, OMEGA - 5, OMEGA + 5)
    start = corrected(family, OMEGA, subharmonic(family), 3, fixed=True)
    assert start is not None
    half = start.half_periods
    images = images_of(half, start.point, 3)
    assert len(images) == 3
    assert min(half.apart(images[i], images[j]) for i, j in ((0, 1), (1, 2), (2, 0))) > 1e-2
    assert half.apart(half.marched(images[2], 1), start.point) < 1e-8
    places = follow(family, start, Limits(most=6)).places
    there = places[2]
    values, points = [place.value for place in places], [place.point for place in places]
    for image in images_of(there.half_periods, there.point, 3):
        assert on_branch(family, Seed(there.value, image, 3), values, points, 3)


def test_a_motion_that_is_not_its_mirror_image_has_the_section_points_of_both() -> None:
    half = Family(analytic.Solver(n_modes=6), problem_at, FREQUENCY, OMEGA - 5, OMEGA + 5).at(OMEGA)
    point = half.map.march(half.map.initial(), 7).end
    assert [len(images_of(half, point, count)) for count in (1, 2, 4, 8)] == [1, 2, 4, 8]
    first = half.map.problem.stops[0].model_copy(update={"gap": 2e-3})
    lopsided = half.map.problem.replace(stops=(first, *half.map.problem.stops[1:]))
    alone = Family(analytic.Solver(n_modes=6), lambda _: lopsided, FREQUENCY, OMEGA - 5, OMEGA + 5).at(OMEGA)
    assert [len(images_of(alone, alone.map.initial(), count)) for count in (2, 4, 8)] == [1, 2, 4]


def test_the_mirror_image_of_a_rival_is_not_taken_for_what_is_looked_for() -> None:
    """Of two motions of one branch the one that is nearly its own mirror image is nearer to that of the other."""
    family = Family(analytic.Solver(n_modes=6), problem_at, FREQUENCY, 1000.0, 3000.0)
    point = family.at(2000.0).map.march(family.at(2000.0).map.initial(), 2 * SETTLED).end
    symmetric = corrected(family, 2000.0, point, 2, fixed=True)
    assert symmetric is not None
    away = 1e-3 * np.random.default_rng(5).standard_normal(symmetric.weights.size) / symmetric.weights
    beside, rival = (symmetric.beginning_at(symmetric.half_periods.map.moved(point, n * away)) for n in (1.0, 5.0))
    search = _Search(
        Listed(family, Bifurcation("fold", 2000.0, 0.0, 0), Located("fold", beside), rivals=(rival,)), family
    )
    itself, mirrored = (Again(one, 2000.0) for one in begun_anywhere(rival))
    norm = np.linalg.norm
    assert norm(mirrored.place.chord(family, beside)) < norm(mirrored.place.chord(family, rival))
    assert not search._is_nearest(0, itself)
    assert not search._is_nearest(0, mirrored)
    assert all(search._is_nearest(0, Again(one, 2000.0)) for one in begun_anywhere(beside))
