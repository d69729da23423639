"""No start is bound to a motion that its own long march does not reach."""

from __future__ import annotations

import numpy as np
import pytest
from population import joint, response_of
from toy import Bar, bar

import analytic
import fe_lapjoint
from lapjoint import Outcome, Problem, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits import Effort, PeriodMap
from lapjoint.orbits.binding import Binder
from lapjoint.orbits.certified import CertifiedMotion, certified, mirrored_motion, same_motion
from lapjoint.orbits.displaced import DisplacedStarts, energy_roots, random_deviation
from lapjoint.orbits.ensemble import OneByOne, ensemble_of
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import find_orbit

AnySolver = analytic.Solver | fe_lapjoint.Solver
THERE = 1e-5  # of the size of a motion: a march that has come so near to its orbit, and stays, has reached it
DECAYS, LONGER = 25.0, 8  # decay times that the witness marches on, and how often again where it is not there yet

HYSTERESIS = bar(1.25, (2.9, 6.0), ratio=0.05)
"""A bar that moves up and down only has two motions here: one touches the stop, the other does not."""
MIRROR = bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05)
"""A bar between two equal stops, with motions of one period and of three."""
ENERGY = 20.0  # J: some of the starts of each bar end in each of its motions


def starts_of(period_map: PeriodMap, count: int, energy: float, seed: int = 0) -> list[SectionPoint]:
    assert isinstance(period_map, DisplacedStarts)
    origin = period_map.initial()
    roots = energy_roots(period_map, period_map.problem, origin)
    return [period_map.moved(origin, random_deviation(roots, energy, (seed, i))) for i in range(count)]


def bound(period_map: PeriodMap, count: int = 6, energy: float = ENERGY) -> Binder:
    """The motions in which some random starts end."""
    binder = Binder(period_map, Effort(max_periods=2000))
    binder.ends(starts_of(period_map, count, energy))
    return binder


def not_reached(period_map: PeriodMap, start: SectionPoint, periods: int, motion: CertifiedMotion) -> str:
    """Why a plain march of so many periods does not end on a motion; empty if it does.

    No search takes part: the march must come to some section point of the motion, and be at the next ones after that.
    """
    half_periods = HalfPeriods(period_map)
    now, apart = start, np.inf
    for _ in range(LONGER):
        now = period_map.march(now, 2 * periods).end
        on_way = [now]
        for _ in range(motion.period_multiple - 1):
            on_way.append(period_map.march(on_way[-1], 2).end)
        apart = min(
            max(half_periods.apart(p, motion.points[(i + k) % len(on_way)]) for i, p in enumerate(on_way))
            for k in range(len(on_way))
        )
        if apart <= THERE:
            return ""
    return f"after {LONGER * periods} periods it is {apart:.1e} away"


def check(period_map: PeriodMap, starts: list[SectionPoint], decay: float, effort: int = 4000) -> Binder:
    """Bind starts, and fail if one is bound to a motion that it does not reach."""
    binder = Binder(period_map, Effort(max_periods=effort))
    ends = binder.ends(starts)
    assert len(ends) == len(starts)
    periods = int(np.ceil(DECAYS / (decay * period_map.period))) if decay else 2000
    wrong = {
        i: why
        for i, (start, end) in enumerate(zip(starts, ends, strict=True))
        if end.motion is not None and not end.pushes
        for why in [not_reached(period_map, start, periods, binder.motions[end.motion])]
        if why
    }
    assert not wrong, wrong
    return binder


@pytest.mark.parametrize("problem", [HYSTERESIS, MIRROR], ids=["hysteresis", "mirror"])
def test_starts_of_a_bar_are_bound_to_what_they_reach(problem: Problem) -> None:
    period_map = Bar().period_map(problem)
    binder = check(period_map, starts_of(period_map, 6, ENERGY), period_map.lowest_damping_rate)
    assert len(binder.motions) == 2


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=6), fe_lapjoint.Solver(elements=6)], ids=["analytic", "fe"])
def test_starts_of_a_joint_are_bound_to_what_they_reach(solver: AnySolver) -> None:
    period_map = solver.period_map(joint(2, 10))
    check(period_map, starts_of(period_map, 3, 1e-4), period_map.lowest_damping_rate)


def test_an_ensemble_marches_to_the_bits_of_single_marches() -> None:
    for solver in (analytic.Solver(n_modes=6), analytic.Solver(free_modes=5, contact_modes=7)):
        period_map = solver.period_map(joint(2, 11))
        points = starts_of(period_map, 5, 1e-3)
        many, single = ensemble_of(period_map, points), OneByOne(period_map, points)
        assert not isinstance(many, OneByOne)
        which = np.array([4, 0, 2])
        for periods in (1, 3):
            assert many.march(which, periods) == single.march(which, periods) == {}
        for i in range(5):
            one, other = many.point(i), single.point(i)
            assert one.state == other.state
            assert np.array_equal(one.coordinates, other.coordinates)
        origin = points[1]
        every = np.arange(5)
        found, expected = many.deviations(every, origin), single.deviations(every, origin)
        size = period_map.size(origin)
        assert np.allclose(found, expected, rtol=0, atol=1e-9 * size)


def test_a_start_near_a_motion_that_it_is_not_bound_for_is_not_bound_to_it() -> None:
    """Closeness alone binds nothing: beside the orbit without contact, a stop waits."""
    period_map = Bar().period_map(HYSTERESIS)
    free, touching = sorted(bound(period_map).motions, key=lambda motion: motion.outcome is not Outcome.NO_CONTACT)
    known = Binder(period_map, Effort(max_periods=2000), [free])
    assert [end.motion for end in known.ends([touching.points[0]])] == [1]
    assert same_motion(HalfPeriods(period_map), known.motions[1], touching)


def test_a_mirror_image_is_a_motion_of_its_own_and_a_symmetric_one_is_not() -> None:
    period_map = analytic.Solver().period_map(paper_joint(angular_frequency=100.0))
    half_periods = HalfPeriods(period_map)
    binder = bound(period_map, 24, 1000.0)
    assert {motion.symmetric for motion in binder.motions} == {True, False}
    for motion in binder.motions:
        image = mirrored_motion(half_periods, motion)
        assert (image is None) == motion.symmetric
        if image is not None:
            assert sum(same_motion(half_periods, image, other) for other in binder.motions) == 1
            assert image.impulses == tuple(-motion.impulses[k] for k in (2, 3, 0, 1))


def test_a_motion_is_known_again_at_any_of_its_periods() -> None:
    period_map = analytic.Solver(n_modes=2).period_map(MIRROR)
    several = next(motion for motion in bound(period_map).motions if motion.period_multiple > 1)
    half_periods = HalfPeriods(period_map)
    for point in several.points:
        orbit = find_orbit(half_periods, point, 2 * several.period_multiple, 1e-3)
        assert orbit is not None
        assert same_motion(half_periods, certified(half_periods, orbit), several)


def test_what_does_not_settle_within_the_effort_is_not_bound() -> None:
    period_map = analytic.Solver(n_modes=2).period_map(bar(0.9, (2.2, 30.0), ratio=1e-4))
    (end,) = Binder(period_map, Effort(max_periods=20)).ends(starts_of(period_map, 1, ENERGY))
    assert end.motion is None
    assert end.outcome in (Outcome.UNDECIDED, Outcome.APERIODIC, Outcome.QUASIPERIODIC)


def test_known_motions_change_no_answer() -> None:
    period_map = analytic.Solver(n_modes=6).period_map(joint(2, 12))
    starts = starts_of(period_map, 8, 1e-4)
    first = Binder(period_map, Effort(max_periods=2000))
    alone = first.ends(starts)
    again = first.again()
    later = again.ends(starts)
    assert len(again.motions) == len(first.motions)
    assert [end.motion for end in alone] == [end.motion for end in later]


@pytest.mark.slow
@pytest.mark.parametrize("index", range(60))
def test_no_start_of_random_joints_is_bound_to_what_it_does_not_reach(index: int) -> None:
    problem = joint(27182, index)
    period_map = analytic.Solver().period_map(problem)
    decay = 1 / response_of(problem).decay_time
    check(period_map, starts_of(period_map, 20, 1e-4, index), decay, effort=2000)
