"""A march that is held at an unstable motion: by a symmetry of the problem, or by the jumps that truncation makes."""

from __future__ import annotations

import numpy as np
import pytest
from loose_pins import bar

import analytic
from lapjoint import FREE, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.unstable import NARROW, PUSHES, REPEATS, disturbed, pushed_off

pytestmark = pytest.mark.long_march


def lopsided(map_: PeriodMap, point: SectionPoint) -> float:
    """How much farther the left end is out than the right one, m."""
    z = map_.history(point, 1).displacement(np.array([0.0, 1.0]), 0.0)[:, 0]
    return float(z[0] - z[1])


def after(map_: PeriodMap, point: SectionPoint, periods: int) -> SectionPoint:
    return map_.march(point, 2 * periods).end


@pytest.fixture(scope="module")
def held() -> tuple[PeriodMap, SectionPoint]:
    """The march from rest, which keeps all symmetries, after 200 periods."""
    map_ = analytic.Solver(n_modes=11).period_map(bar(300.0))
    return map_, after(map_, map_.initial(), 200)


def test_a_march_is_pushed_off_only_where_deviations_grow(held: tuple[PeriodMap, SectionPoint]) -> None:
    map_, point = held
    halves = HalfPeriods(map_)
    away = pushed_off(halves, point, 2, 0)
    assert away is not None
    assert REPEATS / 2 < halves.apart(away, point) < NARROW
    assert pushed_off(halves, point, 2, PUSHES) is None
    stable = analytic.Solver(n_modes=12).period_map(paper_joint())
    settled = after(stable, stable.initial(), 60)
    assert pushed_off(HalfPeriods(stable), settled, 2, 0) is None


def test_each_push_is_ten_times_as_far_as_the_one_before(held: tuple[PeriodMap, SectionPoint]) -> None:
    map_, point = held
    halves = HalfPeriods(map_)
    pushes = [pushed_off(halves, point, 2, times) for times in range(PUSHES)]
    sizes = [halves.apart(one, point) for one in pushes if one is not None]
    assert len(sizes) == PUSHES
    # Through another contact state a deviation loses what that one's modes cannot carry.
    assert np.array(sizes[1:]) / sizes[:-1] == pytest.approx(10.0, rel=0.2)
    assert max(sizes) < 3e-2 * 1.2


def test_a_push_goes_to_the_side_on_which_the_march_is_already(held: tuple[PeriodMap, SectionPoint]) -> None:
    """Whichever side that is: a deviation of either sign leads on to its own."""
    map_, point = held
    halves = HalfPeriods(map_)
    values, vectors = np.linalg.eig(halves.linearised(point, 2).matrix)
    along = vectors[:, int(np.argmax(np.abs(values)))].real
    along *= 1e-4 * map_.size(point) / map_.norm(along)  # well beyond what the jumps wander by
    sides = []
    for sign in (1, -1):
        beside = map_.moved(point, sign * along)
        away = pushed_off(halves, beside, 2, 0)
        assert away is not None
        sides.append((lopsided(map_, beside), lopsided(map_, away)))
        assert abs(sides[-1][1]) > 3 * abs(sides[-1][0])
        assert sides[-1][0] * sides[-1][1] > 0
    assert sides[0][0] * sides[1][0] < 0


def test_a_march_that_does_not_repeat_is_not_pushed(held: tuple[PeriodMap, SectionPoint]) -> None:
    map_, point = held
    astray = map_.moved(point, 1e-2 * point.coordinates.ravel())
    assert HalfPeriods(map_).apart(after(map_, astray, 1), astray) > REPEATS
    assert pushed_off(HalfPeriods(map_), astray, 2, 0) is None


def test_an_aperiodic_march_is_disturbed_by_little_and_a_narrow_one_by_more_each_time() -> None:
    map_ = analytic.Solver(n_modes=4).period_map(paper_joint())
    halves, point = HalfPeriods(map_), map_.initial()
    point = after(map_, point, 5)
    deviation = np.random.default_rng(0).standard_normal(point.coordinates.size)
    deviation /= map_.norm(deviation)

    def far(wander: float, times: int) -> float:
        return halves.apart(disturbed(halves, point, wander, deviation, times), point)

    if point.state == FREE:
        assert far(0.5, 0) == pytest.approx(1e-3, rel=1e-2)
    assert far(1e-3, 0) == pytest.approx(1e-2, rel=0.2)
    assert far(1e-3, 2) == pytest.approx(3e-2, rel=0.2)  # no farther, or it would begin anew
    assert far(1e-6, 0) == pytest.approx(REPEATS, rel=0.2)
    assert far(1e-6, 1) == pytest.approx(10 * REPEATS, rel=0.2)
