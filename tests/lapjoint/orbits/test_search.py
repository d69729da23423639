"""The search: how it marches, what it gives up, and that its outcomes hang on the problem and the effort alone."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from loose_pins import bar as loose_bar
from settled import amplification, orbit_of
from toy import Bar, BarMap, bar

import analytic
import fe_lapjoint
from lapjoint import FREE, Outcome, Problem, StepLoad, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.answers.steady_state import Exponent
from lapjoint.errors import InputError
from lapjoint.orbits import Effort, Passage
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import FAR, Orbit, find_orbit
from lapjoint.orbits.period_map import Derivative, Followed, Linearised, period_pieces
from lapjoint.orbits.search import FIRST_LOOK, STRETCH, TRANSIENT, SearchResult, SteadyStateSearch, as_linearised
from lapjoint.orbits.segments import Segment
from lapjoint.orbits.wandering import Wandering, breadth_and_residual, outcome_of
from lapjoint.problem import FloatArray

pytestmark = pytest.mark.long_march

SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=6), "FE": fe_lapjoint.Solver(elements=3), "bar": Bar()}
SPRUNG = bar(0.8)
JOINTS: dict[str, Problem] = {"analytic": paper_joint(), "FE": paper_joint(), "bar": bar(0.8, (0.5, 5.0))}


def searched(map_: Any, first_look: int = FIRST_LOOK, **effort: Any) -> SearchResult:
    """The end of a search from the initial state."""
    return SteadyStateSearch(map_, Effort(**effort)).run(map_.initial(), first_look)


def same(one: SectionPoint, other: SectionPoint) -> bool:
    """To the last bit."""
    return one.state == other.state and np.array_equal(one.coordinates, other.coordinates)


# --- The same bits, however it is marched --------------------------------------------------------------------------


@pytest.mark.parametrize("solver", SOLVERS)
def test_periods_marched_at_once_end_at_the_bits_of_one_after_the_other_and_so_does_half_a_one_more(
    solver: str,
) -> None:
    map_ = SOLVERS[solver].period_map(JOINTS[solver])
    point, impulses, switches = map_.initial(), np.zeros(len(map_.problem.stops)), 0
    for _ in range(5):
        passage = map_.march(point, 2)
        point, impulses, switches = passage.end, impulses + passage.impulses, switches + passage.switches
    at_once = map_.march(map_.initial(), 10)
    assert same(at_once.end, point)
    assert at_once.impulses == pytest.approx(impulses, rel=1e-12)
    assert at_once.switches == switches > 0
    assert same(map_.march(map_.initial(), 11).end, map_.march(point, 1).end)


@pytest.mark.parametrize("solver", ["analytic", "FE"])
def test_what_is_followed_ends_at_the_bits_of_the_march(solver: str) -> None:
    map_ = SOLVERS[solver].period_map(JOINTS[solver])
    point = map_.initial()
    n = map_.difference(point, point).size
    deviation = np.random.default_rng(0).standard_normal(n)
    followed = map_.followed(point, deviation / map_.norm(deviation), 6)
    assert len(followed.points) == 6
    for periods in (1, 3, 6):
        assert same(followed.points[periods - 1], map_.march(point, 2 * periods).end)
    passage = map_.march(point, 12)
    assert followed.impulses.sum(axis=0) == pytest.approx(passage.impulses, rel=1e-12)
    assert followed.switches == passage.switches > 0
    assert map_.norm(followed.deviation) == pytest.approx(1.0)


@pytest.mark.parametrize("solver", SOLVERS)
def test_simulate_ends_each_period_at_the_bits_of_the_search(solver: str) -> None:
    """Its history shows the same displacement and velocity at each end of a period, to rounding of the evaluation."""
    problem, periods = JOINTS[solver], 6
    map_ = SOLVERS[solver].period_map(problem)
    marched = SOLVERS[solver].simulate(problem, periods * map_.period, errors=False)
    recorded = map_.history(map_.initial(), periods)
    assert np.array_equal(marched.switch_times, recorded.switch_times)
    assert marched.states == recorded.states
    assert marched.contacts == recorded.contacts
    x = np.linspace(0, problem.beam.length, 7)
    t = np.linspace(0, periods * map_.period * (1 - 1e-12), 50)
    for dt in (0, 1):
        assert np.array_equal(marched.evaluate(x, t, dt=dt), recorded.evaluate(x, t, dt=dt))
    point = map_.march(map_.initial(), 2 * periods).end
    again, size = map_.history(point, 1), np.abs(marched.displacement(x, t)).max()
    end = marched.displacement(x, marched.end)
    assert again.displacement(x, 0.0) == pytest.approx(end, abs=1e-12 * size)
    impulses = sum(marched.contacts[i].impulse for i in range(len(marched.contacts)))
    assert impulses == pytest.approx(map_.march(map_.initial(), 2 * periods).impulses.sum(), rel=1e-10)


@pytest.mark.parametrize("solver", ["analytic", "FE"])
def test_a_switch_at_the_end_of_a_period_is_neither_lost_nor_made_twice(solver: str) -> None:
    """Whatever part of a period a joint starts at, marches and histories count alike."""
    for phase in np.linspace(0, 2 * math.pi, 9):
        map_ = SOLVERS[solver].period_map(paper_joint().with_base_numbers(phase=float(phase)))
        point = map_.march(map_.initial(), 20).end
        passage, history = map_.march(point, 4), map_.history(point, 2)
        assert passage.switches == history.switch_times.size
        assert passage.impulses.sum() == pytest.approx(sum(c.impulse for c in history.contacts), rel=1e-9, abs=1e-9)


# --- Outcomes ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "problem",
    [
        pytest.param(bar(0.8, (0.5, 5.0)), id="one period"),
        pytest.param(bar(3.0, (0.0, 20.0), ratio=0.03), id="two periods"),
    ],
)
def test_outcomes_do_not_depend_on_who_looks_on_or_on_what_is_measured(problem: Problem) -> None:
    map_, calls = Bar().period_map(problem), []
    alone = searched(map_)
    watched = SteadyStateSearch(map_, Effort(), lambda done, most: calls.append((done, most))).run(map_.initial())
    unmeasured = searched(map_, growth=False)
    for found in (watched, unmeasured):
        assert isinstance(found.motion, Orbit)
        assert isinstance(alone.motion, Orbit)
        assert same(found.motion.point, alone.motion.point)
        assert found.acceptance.periods == alone.acceptance.periods
        assert same(found.acceptance.point, alone.acceptance.point)
    assert alone.acceptance.pushes == 0
    assert same(alone.acceptance.point, map_.march(map_.initial(), 2 * alone.acceptance.periods).end)
    assert unmeasured.acceptance.growth is None
    assert unmeasured.acceptance.sensitive is None
    done = [one for one, _ in calls]
    assert done == sorted(done)
    assert done[-1] == alone.acceptance.periods
    assert {most for _, most in calls} == {16_000}


@pytest.mark.parametrize("periods", [1, 7, 700])
def test_effort_in_periods_ends_in_undecided(periods: int) -> None:
    """Undamped motion never settles; one stretch is measured beyond the periods allowed."""
    map_ = Bar().period_map(bar(0.8, (10.0, 5.0), ratio=0.0))
    found = searched(map_, 1, max_periods=periods, max_period_multiple=2, growth=False)
    assert isinstance(found.motion, Wandering)
    assert found.motion.outcome is Outcome.UNDECIDED
    assert found.acceptance.periods <= max(periods, TRANSIENT) + 2 * STRETCH + 40
    assert abs(found.motion.exponent.value) < 1e-2


def test_effort_in_switches_ends_in_undecided() -> None:
    found = searched(Bar().period_map(bar(2.6, (0.3, 30.0), ratio=0.02)), max_switches=50, growth=False)
    assert isinstance(found.motion, Wandering)
    assert found.motion.outcome is Outcome.UNDECIDED
    assert found.acceptance.periods < TRANSIENT + STRETCH


# --- Courses -------------------------------------------------------------------------------------------------------


def test_a_march_that_leaves_its_course_takes_the_orbit_with_it() -> None:
    """The march is led astray after the orbit was found, as by a switch that the orbit does not make."""
    problem = bar(0.8, (10.0, 5.0))
    inner = Bar().period_map(problem)
    orbit = find_orbit(HalfPeriods(inner), inner.initial(), 2, np.inf)
    assert orbit is not None

    class Astray(BarMap):
        def march(self, start: SectionPoint, half_periods: int) -> Passage:
            passage = super().march(start, half_periods)
            return replace(passage, end=self.moved(passage.end, np.array([1.0, 0.0])))

    for map_, kept in ((inner, True), (Astray(problem, "astray"), False)):
        search = SteadyStateSearch(map_, Effort(growth=False))
        search.point = inner.moved(orbit.point, np.array([3.0, 0.0]))
        deviation = inner.difference(search.point, orbit.point)
        assert search.on_course(orbit, deviation, 4) is kept
        assert search.marched <= 4


def test_an_orbit_with_switches_is_approached_by_the_step_of_its_linearised_map_alone() -> None:
    """A march that stands still beside the orbit is at another one, and one that is off by as much may circle it."""
    map_ = Bar().period_map(bar(0.8, (0.5, 5.0)))
    halves, orbit, deviation = HalfPeriods(map_), orbit_of(map_, 2), np.array([1e-3, 0.0])
    mapped = orbit.last.matrix @ deviation
    for off, expected in ((0.0, True), (0.05, True), (1.0, False)):
        after = mapped + off * (deviation - mapped)
        assert as_linearised(halves, orbit, deviation, lambda after=after: after) is expected


def test_a_march_still_far_from_a_clearance_goes_on_until_it_is_bound() -> None:
    """The farther it starts, the longer it waits, and never less than until the deviation clears the stop."""
    omega, ratio = 0.8, 0.02
    amplitude = abs(amplification(omega, ratio))
    problem = bar(omega, (1.3 * amplitude, 5.0), ratio=ratio)
    map_ = Bar().period_map(problem)
    orbit = find_orbit(HalfPeriods(map_), map_.march(map_.initial(), 400).end, 2, 1.0)
    assert orbit is not None
    waited = []
    for size in (0.1, 1.0, 5.0):
        start = map_.moved(orbit.point, np.array([size * amplitude, 0.0]))
        found = SteadyStateSearch(map_, Effort(growth=False)).run(start, 1)
        assert isinstance(found.motion, Orbit)
        assert not map_.history(found.acceptance.point, 200).contacts
        waited.append(found.acceptance.periods)
    assert waited == sorted(waited)
    assert waited[0] < waited[-1]


# --- Growth beyond rounding ----------------------------------------------------------------------------------------


NONE = np.zeros(0, dtype=complex)
STILL = Segment(
    start=0.0,
    end=1.0,
    closed=np.zeros(0, dtype=bool),
    rates=NONE,
    weights=np.zeros((0, 0), dtype=complex),
    amplitudes=NONE,
    polynomial=np.zeros((0, 3)),
    deviations=np.zeros((0, 1), dtype=complex),
    drift=np.zeros((0, 2, 1)),
    switched=-1,
)
"""A period of a motion without stops, with one deviation."""


class Violent:
    """A map whose ends are random numbers for some periods, and from then on a third as far from a fixed point."""

    period, name = 1.0, "violent"

    def __init__(self, periods: float, lowest_damping_rate: float) -> None:
        self.problem = SPRUNG.replace(point_loads=(StepLoad(x=1.0, force=1.0),))
        self.periods, self.lowest_damping_rate, self.linearisations = periods, lowest_damping_rate, 0

    def initial(self) -> SectionPoint:
        return SectionPoint(FREE, np.array([[1.5, 0.0]]))

    def step(self, point: SectionPoint) -> tuple[SectionPoint, float]:
        x, done = point.coordinates[0]
        if done >= self.periods:
            return SectionPoint(FREE, np.array([[1 + (x - 1) / 3, done + 1]])), 1 / 3
        chance = np.random.default_rng(np.array([x]).view(np.uint64)).uniform(0.5, 1.5)
        return SectionPoint(FREE, np.array([[chance, done + 1]])), 1e20

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        return Passage(self.linearised(start, half_periods).end, np.zeros(0), 0)

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        point, whole = start, 1.0
        for _ in range(half_periods // 2):
            point, growth = self.step(point)
            whole *= growth

        def derivative() -> Derivative:
            self.linearisations += 1
            return Derivative(np.array([[whole]]))

        return Linearised(point, derivative, lambda: (STILL,))

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        points, growth = [start], []
        for _ in range(periods):
            point, rate = self.step(points[-1])
            points.append(point)
            growth.append(math.log(rate))
        return Followed(tuple(points[1:]), np.zeros((periods, 0)), 0, np.array(growth), deviation)

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        return np.asarray((point.coordinates - origin.coordinates)[0, :1])

    def norm(self, deviation: FloatArray) -> float:
        return float(np.abs(deviation[0]))

    def size(self, point: SectionPoint) -> float:
        return float(point.coordinates[0, 0])

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        return SectionPoint(FREE, origin.coordinates + np.array([[deviation[0], 0.0]]))


@pytest.mark.parametrize("growth", [True, False])
def test_where_rounding_decides_every_period_newtons_method_is_not_tried_again(growth: bool) -> None:
    map_ = Violent(math.inf, 0.1)  # twenty decay times are 200 periods
    found = searched(map_, growth=growth)
    assert isinstance(found.motion, Wandering)
    assert found.motion.outcome is Outcome.APERIODIC
    assert found.motion.exponent.value == pytest.approx(math.log(1e20))
    assert found.motion.exponent.periods >= 200
    assert found.acceptance.periods < TRANSIENT  # where the last stretch begins
    assert map_.linearisations <= 1  # where no growth is known yet


@pytest.mark.parametrize(("violent", "rate"), [(10, 1.0), (30, 1.0), (90, 1.0), (200, 1.0), (900, 0.02)])
def test_a_march_that_calms_down_within_twenty_decay_times_is_followed_to_its_orbit(violent: int, rate: float) -> None:
    map_ = Violent(violent, rate)
    found = searched(map_)
    assert isinstance(found.motion, Orbit)
    assert found.motion.leading == pytest.approx(1 / 3)
    assert found.acceptance.periods >= violent


def test_no_fixed_point_is_looked_for_of_a_map_that_makes_deviations_grow_beyond_rounding() -> None:
    map_ = Violent(math.inf, 1.0)
    for half_periods in (2, 40):  # over twenty periods, the derivative is beyond double precision
        assert find_orbit(HalfPeriods(map_), map_.initial(), half_periods, FAR) is None  # type: ignore[arg-type]
    assert map_.linearisations == 2


# --- Pushes, and what is shown -------------------------------------------------------------------------------------


def test_a_march_that_is_held_is_pushed_and_says_so() -> None:
    map_ = analytic.Solver(n_modes=11).period_map(loose_bar(300.0))
    found = searched(map_)
    assert isinstance(found.motion, Orbit)
    assert found.motion.stable
    assert found.acceptance.pushes >= 1
    assert found.acceptance.sensitive


def exponent(value: float, error: float = 0.1) -> Exponent:
    return Exponent(value, error, 1000, 100.0, (value, value), (value,) * 4)


def test_what_a_measurement_shows() -> None:
    def outcome(value: float, breadth: float, spirals: bool = False, pushes: int = 0) -> Outcome:
        return outcome_of(exponent(value), 1.0, breadth, spirals=spirals, pushes=pushes)

    assert outcome(1.0, 0.5) is Outcome.APERIODIC
    assert outcome(1.0, 1e-5) is Outcome.UNDECIDED  # it repeats
    assert outcome(1.0, 5e-3) is Outcome.UNDECIDED  # so narrow that it may be held
    assert outcome(1.0, 5e-3, pushes=3) is Outcome.APERIODIC
    assert outcome(0.01, 0.5) is Outcome.UNDECIDED  # nothing is known that it could circle
    assert outcome(0.01, 0.5, spirals=True) is Outcome.QUASIPERIODIC
    assert outcome(0.3, 0.5, spirals=True) is Outcome.UNDECIDED
    assert outcome(-1.0, 0.5, spirals=True) is Outcome.UNDECIDED


def test_a_stretch_confirms_the_one_before_where_both_show_the_same() -> None:
    def stretch(outcome: Outcome, value: float) -> Wandering:
        point = SectionPoint(Bar().period_map(bar(1.0, (0.5, 1.0))).initial().state, np.zeros((2, 1)))
        return Wandering(outcome, exponent(value), point, 0.5, 0.5, np.zeros(1), np.zeros(1))

    chaos, torus = stretch(Outcome.APERIODIC, 1.0), stretch(Outcome.QUASIPERIODIC, 0.0)
    dying, unclear = stretch(Outcome.UNDECIDED, -1.0), stretch(Outcome.UNDECIDED, 0.2)
    assert chaos.confirms(chaos)
    assert not chaos.confirms(torus)
    assert dying.confirms(dying)
    assert not dying.confirms(unclear)
    assert not unclear.confirms(unclear)


def test_breadth_and_residual_are_those_of_the_best_multiple() -> None:
    halves = HalfPeriods(Bar().period_map(bar(1.0, (0.5, 1.0))))

    def points(series: FloatArray) -> list[SectionPoint]:
        return [SectionPoint(halves.map.initial().state, np.array([[z], [0.0]])) for z in series]

    three = np.tile([1.0, 2.0, 4.0], 40)
    assert breadth_and_residual(halves, points(three), 3) == pytest.approx((0.0, 0.0), abs=1e-15)
    assert breadth_and_residual(halves, points(three), 2)[0] == pytest.approx(3 / 4)
    drifting = three + np.arange(120) * 1e-3
    assert breadth_and_residual(halves, points(drifting), 8)[0] == pytest.approx(3e-3 / drifting.max())


def test_a_march_of_more_periods_than_can_be_kept_is_refused_by_name() -> None:
    with pytest.raises(InputError, match=r"duration = 1e\+300: at most 1e\+07 periods"):
        period_pieces(0.01, 1e300)
    assert period_pieces(0.5, 1.25) == [0.5, 0.5, 0.25]
