"""The watch over an orbit against brute force: what it says for certain holds at every time, not at samples only."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np
import pytest
from settled import amplification
from toy import Bar, bar

import analytic
import fe_lapjoint
from lapjoint import FREE, Outcome, Problem, SineLoad, StepLoad, ViscousDamping, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.orbits import PeriodMap, Segment
from lapjoint.orbits.half_periods import HalfPeriodMarch, HalfPeriods
from lapjoint.orbits.watch import SegmentWatch
from lapjoint.problem import FloatArray

SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=6), "FE": fe_lapjoint.Solver(elements=3)}
PROBLEMS = {
    "modal": paper_joint(),
    "viscous": paper_joint().replace(damping=ViscousDamping(coefficient=2000.0)),
    "overdamped, pushed aside": paper_joint().replace(
        damping=ViscousDamping(coefficient=30_000.0),
        point_loads=(StepLoad(x=2.0, force=2e4), SineLoad(x=1.0, force=5e3, angular_frequency=515.0)),
    ),
    "without contact": paper_joint(base_amplitude=1e-5),
}


def at(segment: Segment, t: FloatArray) -> FloatArray:
    """z at the stops at times from the start of the march, shape ``(P, m)``."""
    tau = t - segment.start
    waves = segment.amplitudes[:, None] * np.exp(np.multiply.outer(segment.rates, tau))
    return (segment.weights @ waves).real + segment.polynomial @ tau ** np.arange(3)[:, None]


def moved_at(segment: Segment, t: FloatArray, e: FloatArray) -> FloatArray:
    """Change of z at the stops by a deviation ``(n,)`` at the start of the march, shape ``(P, m)``."""
    tau, count = t - segment.start, segment.deviations.shape[0]
    waves = (segment.deviations @ e)[:, None] * np.exp(np.multiply.outer(segment.rates[:count], tau))
    return (segment.weights[:, :count] @ waves).real + (segment.drift @ e) @ tau ** np.arange(2)[:, None]


def settled(map_: PeriodMap, periods: int = 40) -> SectionPoint:
    return map_.march(map_.initial(), 2 * periods).end


# --- Sums of exponentials, at random -------------------------------------------------------------------------------


def random_orbit(rng: np.random.Generator, problem: Problem) -> tuple[Segment, ...]:
    """Some segments of an orbit through nothing but numbers: four terms, a parabola; two stops at a place."""
    assert problem.excitation_frequency is not None
    period, stops, n = 2 * math.pi / problem.excitation_frequency, len(problem.stops), 3
    cuts = np.concatenate([[0.0], np.sort(rng.uniform(0, period, rng.integers(0, 4))), [period]])
    segments = []
    for i, (a, b) in enumerate(pairwise(cuts)):
        rates = -rng.exponential(0.5, 4) + 1j * rng.uniform(0, 40, 4)
        rates[-1] = 1j * problem.excitation_frequency
        terms = int(rng.integers(0, 4))
        segments.append(
            Segment(
                start=float(a),
                end=float(b),
                closed=rng.random(stops) < 0.3,
                rates=rates,
                weights=np.repeat(rng.standard_normal((1, 4)) + 1j * rng.standard_normal((1, 4)), stops, axis=0),
                amplitudes=0.2 * (rng.standard_normal(4) + 1j * rng.standard_normal(4)),
                polynomial=np.repeat(0.1 * rng.standard_normal((1, 3)), stops, axis=0),
                deviations=rng.standard_normal((terms, n)) + 1j * rng.standard_normal((terms, n)),
                drift=np.repeat(rng.standard_normal((1, 2, n)), stops, axis=0) * (rng.random() < 0.5),
                switched=int(rng.integers(0, stops)) if i + 2 < cuts.size else -1,
            )
        )
    return tuple(segments)


@pytest.mark.parametrize(
    "seed", [*range(12), *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(12, 40))]
)
def test_no_sample_is_nearer_than_the_watch_says_or_moves_farther(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = bar(rng.uniform(0.5, 3.0), (rng.uniform(0, 2), 1.0), (-rng.uniform(0, 2), 1.0))
    assert_holds(problem, random_orbit(rng, problem), rng)


def assert_holds(problem: Problem, segments: tuple[Segment, ...], rng: np.random.Generator) -> None:
    """Sample each interval densely; its place in time is told by what comes before and after it."""
    watch = SegmentWatch(problem, segments, None)
    stops, n = len(problem.stops), segments[0].deviations.shape[1]
    columns = np.concatenate([np.eye(n), rng.standard_normal((n, 2))], axis=1)
    found = watch.deviated(columns)
    distance = watch.intervals.distance.reshape(stops, -1)
    largest = found.largest.reshape(stops, -1, columns.shape[1])
    ends = interval_ends(watch, segments)
    assert len(ends) == distance.shape[1]
    sign = np.array([stop.sign for stop in problem.stops])[:, None]
    gap = np.array([stop.gap for stop in problem.stops])[:, None]
    first: dict[int, FloatArray] = {}
    for j, (i, a, b) in enumerate(ends):
        segment, t = segments[i], np.linspace(a, b, 9)
        h = np.where(segment.closed[:, None], -1.0, 1.0) * (sign * at(segment, t) - gap)
        first.setdefault(i, np.maximum(h[:, :1], 0.0))
        room = np.maximum(first[i] - h, 0.0)
        scale = 1e-12 * (1 + np.abs(h).max())
        assert np.all(distance[:, j] <= room.min(axis=1) + scale)
        for k, column in enumerate(columns.T):
            d = np.abs(moved_at(segment, t, column))
            assert np.all(largest[:, j, k] >= d.max(axis=1) * (1 - 1e-12) - 1e-14)


def interval_ends(watch: SegmentWatch, segments: tuple[Segment, ...]) -> list[tuple[int, float, float]]:
    """Segment, start and end of each interval, s: the watch's own cuts, which must cover the orbit without gaps."""
    found = []
    for i, segment in enumerate(segments):
        tau = watch.tau[watch.segment == i]
        assert tau[0] == 0.0
        assert tau[-1] == pytest.approx(segment.end - segment.start, rel=1e-14)
        assert np.all(np.diff(tau) > 0)
        found += [(i, segment.start + a, segment.start + b) for a, b in pairwise(tau)]
    return found


def test_distances_are_known_well_where_the_orbit_comes_near() -> None:
    """A bound that holds could be of no use; this one is within a factor of two but where it all but touches."""
    omega, ratio = 0.8, 0.05
    amplitude = abs(amplification(omega, ratio))
    for gap in (1.5, 1.05, 1.001):
        problem = bar(omega, (gap * amplitude, 5.0), ratio=ratio)
        segment = Segment(
            start=0.0,
            end=2 * math.pi / omega,
            closed=np.zeros(1, dtype=bool),
            rates=np.array([1j * omega]),
            weights=np.ones((1, 1), dtype=complex),
            amplitudes=np.array([amplitude], dtype=complex),
            polynomial=np.zeros((1, 3)),
            deviations=np.zeros((0, 2), dtype=complex),
            drift=np.zeros((1, 2, 2)),
            switched=-1,
        )
        least = SegmentWatch(problem, (segment,), None).intervals.distance.min()
        assert 0.45 * (gap - 1) * amplitude < least <= (gap - 1) * amplitude * (1 + 1e-9)


# --- Orbits of both solvers ----------------------------------------------------------------------------------------


class Marched(NamedTuple):
    """A period from a section point near a motion, marched with derivatives."""

    map_: PeriodMap
    point: SectionPoint
    found: HalfPeriodMarch


@pytest.fixture(scope="module", params=product(SOLVERS, PROBLEMS), ids="-".join)
def marched(request: pytest.FixtureRequest) -> Marched:
    solver, kind = request.param
    map_ = SOLVERS[solver].period_map(PROBLEMS[kind])
    point = settled(map_)
    return Marched(map_, point, HalfPeriods(map_).linearised(point, 2))


def test_segments_are_the_march(marched: Marched) -> None:
    map_, point, found = marched
    history = map_.history(point, 1)
    x = np.array([stop.x for stop in map_.problem.stops])
    segments = found.linearised.segments
    assert segments[0].start == 0.0
    assert segments[-1].end == pytest.approx(map_.period, rel=1e-14)
    assert [s.end for s in segments if s.switched >= 0] == pytest.approx(history.switch_times, abs=1e-12 * map_.period)
    whole = np.abs(history.displacement(x, np.linspace(0, history.end, 200))).max()
    for segment, following in zip(segments, (*segments[1:], None), strict=True):
        if following is not None:
            assert segment.end == following.start
        t = np.linspace(segment.start, segment.end, 13)[1:-1]
        assert at(segment, t) == pytest.approx(history.displacement(x, t), abs=1e-9 * whole)
        state = history.state_at(float(t[5]))
        assert segment.closed.tolist() == [k in state for k in range(x.size)]
    assert any(s.closed.any() for s in segments) == (map_.problem is not PROBLEMS["without contact"])


def test_segments_carry_deviations_as_marches_beside_the_orbit_do(marched: Marched) -> None:
    map_, point, found = marched
    x = np.array([stop.x for stop in map_.problem.stops])
    rng = np.random.default_rng(4)
    n = map_.difference(point, point).size
    soft = np.zeros(n)
    soft[[0, 1, n // 2, n // 2 + 1]] = rng.standard_normal(4) * [1, 1, 515.0, 515.0]
    e = 1e-7 * map_.size(point) / map_.norm(soft) * soft
    beside = [map_.history(map_.moved(point, sign * e), 1) for sign in (1, -1)]
    segments = found.linearised.segments
    largest = max(np.abs(moved_at(s, np.linspace(s.start, s.end, 9), e)).max() for s in segments)
    for segment in segments:
        margin = 0.02 * (segment.end - segment.start)  # the neighbours switch a little earlier or later
        t = np.linspace(segment.start + margin, segment.end - margin, 9)
        between = 0.5 * (beside[0].displacement(x, t) - beside[1].displacement(x, t))
        # Rounding of 1e-16 in a motion of 1, by differences of 1e-7; truncation of the state that a moved march ends
        # a segment in is the analytic solver's own.
        assert moved_at(segment, t, e) == pytest.approx(between, abs=1e-4 * largest)


def test_the_watch_over_an_orbit_holds_at_every_sample(marched: Marched) -> None:
    assert_holds(marched.map_.problem, marched.found.linearised.segments, np.random.default_rng(0))


def test_switches_know_their_rate_and_their_neighbours(marched: Marched) -> None:
    map_, point, found = marched
    history, switches = map_.history(point, 1), found.watch.switches
    assert switches.time == pytest.approx(history.switch_times, abs=1e-12 * map_.period)
    for time, stop, rate, curvature in zip(
        switches.time, switches.stop, switches.rate, switches.curvature, strict=True
    ):
        x = map_.problem.stops[stop].x
        v = history.velocity(x, np.clip(time + 1e-9 * map_.period * np.array([-1.0, 1.0]), 0, history.end))[0]
        assert rate == pytest.approx(abs(v[0]), rel=1e-5)
        beside = np.clip(time + 1e-6 * map_.period * np.array([-1.0, 1.0]), 0, history.end)
        bends = np.abs(history.evaluate(x, beside, dt=2)[0])
        assert curvature == pytest.approx(bends.max(), rel=2e-2)
    for j, stop in enumerate(switches.stop):
        others = np.delete(switches.time, j)[np.delete(switches.stop, j) == stop]
        around = np.concatenate([others - map_.period, others, others + map_.period])
        around = np.append(around, [switches.time[j] - map_.period, switches.time[j] + map_.period])
        assert switches.spacing[j] == pytest.approx(np.abs(around - switches.time[j]).min(), rel=1e-9)


def test_half_of_a_symmetric_orbit_is_watched_as_the_whole_is() -> None:
    """Its other half is the mirror image: neighbours of a switch may be those of the twin."""
    map_ = analytic.Solver(n_modes=6).period_map(paper_joint())
    halves = HalfPeriods(map_)
    point = settled(map_, 150)
    half, whole = halves.linearised(point, 1).watch, halves.linearised(point, 2).watch
    count = half.switches.time.size
    assert whole.switches.time.size == 2 * count
    assert halves.twins is not None
    for name in ("rate", "curvature", "spacing"):
        first, both = getattr(half.switches, name), getattr(whole.switches, name)
        assert first == pytest.approx(both[:count], rel=1e-5), name
        assert first == pytest.approx(both[count:], rel=1e-5), name
    assert [halves.twins[k] for k in half.switches.stop] == whole.switches.stop[count:].tolist()
    assert half.intervals.distance.max() == pytest.approx(whole.intervals.distance.max(), rel=1e-2)


def test_intervals_know_the_switches_of_their_own_stop_around_them() -> None:
    map_ = Bar().period_map(bar(0.8, (0.5, 5.0), (-0.5, 5.0)))
    found = HalfPeriods(map_).linearised(settled(map_), 2)
    switches, intervals = found.watch.switches, found.watch.intervals
    times = switches.time
    assert np.all(switches.stop[intervals.before] == intervals.stop)
    assert np.all(switches.stop[intervals.after] == intervals.stop)
    assert np.all(intervals.since >= 0)
    assert np.all(intervals.until >= 0)
    # From a switch to the next one of the same stop, through the end of the period where it must be.
    gap = (times[intervals.after] - times[intervals.before]) % map_.period
    width = gap - intervals.since - intervals.until
    assert np.all(width > -1e-9 * map_.period)
    assert width[: width.size // 2].sum() == pytest.approx(map_.period, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_force_begins_and_ends_with_its_gap(solver: str) -> None:
    """Beside the touch the distance of a force from 0 is c d' / k: in the limit there is no room for any deviation."""
    plain = paper_joint(angular_frequency=2950.0)
    damped = plain.replace(stops=tuple(stop.model_copy(update={"damping": 1e-3}) for stop in plain.stops))
    periods = []
    for problem in (plain, damped):
        accepted = SOLVERS[solver].steady_state(problem, sensitivity=False).acceptance
        assert accepted is not None
        periods.append(accepted.periods)
    assert periods[0] == periods[1]
    map_ = SOLVERS[solver].period_map(damped)
    watch = HalfPeriods(map_).linearised(settled(map_), 2).watch
    stops, rows = len(plain.stops), watch.switches.stop
    force = watch.intervals.stop >= stops
    own = watch.intervals.stop[force]
    for beside in (watch.intervals.before[force], watch.intervals.after[force]):
        assert np.all((rows[beside] == own) | (rows[beside] == own - stops))
    assert np.any(rows[watch.intervals.before[force]] == own - stops)


def test_an_orbit_without_stops_is_watched_too() -> None:
    free = paper_joint().replace(stops=())
    for solver in SOLVERS.values():
        map_ = solver.period_map(free)
        found = HalfPeriods(map_).linearised(settled(map_), 2)
        assert found.watch.switches.time.size == 0
        assert found.watch.intervals.distance.size == 0
        assert found.watch.deviated(np.eye(found.matrix.shape[0])).largest.shape == (0, found.matrix.shape[0])
        assert solver.steady_state(free).outcome is Outcome.NO_CONTACT
    bare = bar(0.8)
    assert Bar().steady_state(bare).outcome is Outcome.NO_CONTACT
    assert Bar().period_map(bare).initial().state == FREE


def test_no_deviations_come_to_nothing_and_fail_nowhere() -> None:
    """Where all eigenvectors have died away none is left to ask about; finite differences have no terms but drift."""
    for map_ in (SOLVERS["FE"].period_map(paper_joint()), Bar().period_map(bar(0.8, (0.5, 5.0)))):
        watch = HalfPeriods(map_).linearised(settled(map_), 2).watch
        n = map_.difference(map_.initial(), map_.initial()).size
        found = watch.deviated(np.zeros((n, 0)))
        assert found.largest.shape == (watch.intervals.distance.size, 0)
        assert found.at_switches.shape == found.rates.shape == (watch.switches.time.size, 0)
