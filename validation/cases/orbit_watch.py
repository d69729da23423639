"""Are the statements of the search about an orbit true for the motion?

A march is found to be bound for an orbit by four things: the derivative of the period map, the orbit's distances from
its stops, the deviations there, and a rule that compares deviations and distances for all later time.  The search is
shared by both solvers, so their comparison shows no mistake in it.  Each of the four is derived again here.  Marches
that begin a little beside the orbit give the derivative and the deviations.  The motion itself gives distances and
rates.  The rule is evaluated as it is stated in `lapjoint.orbits.approach`, deviation by deviation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

import analytic
import fe_lapjoint
from lapjoint import History, ModalDamping, Problem, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.compiled_watch import terms_at_points
from lapjoint.orbits.finite_differences import FiniteDifferences
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import FAR, Orbit, find_orbit
from lapjoint.orbits.period_map import Follows
from lapjoint.orbits.wandering import breadth_and_residual
from lapjoint.orbits.watch import Deviated, Intervals, SegmentWatch
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.cases.rigid_bar import MIRROR, SOFT, SPRINGS
from validation.cases.settled import JOINTS, joint
from validation.cases.textbook_equations import BEAMS, roots
from validation.verdict import Check, Criterion, Estimate, Kind

Solver = analytic.Solver | fe_lapjoint.Solver
MODAL, MESH = analytic.Solver(n_modes=5), fe_lapjoint.Solver(elements=1)
"""Coarse solvers, as each solver is compared only with itself."""
WIDE = joint("Gaps out of reach", 2.5, 0.05, (1.0, "top", 1.2e-2, 30.0), (0.5, "bottom", 9e-3, 30.0))
FOUR = joint("Four periods", 2.5, 0.02, (1.0, "top", 4e-3, 30.0), (0.5, "bottom", 2e-3, 30.0))
ORBITS: tuple[tuple[str, Problem, Solver], ...] = (
    ("springs", from_toml(SPRINGS.format(stiffness=repr(SOFT))), MODAL),
    ("mirror", from_toml(MIRROR.format(stiffness=repr(SOFT))), MESH),
    ("uneven", JOINTS["uneven"], MODAL),
    ("uneven", JOINTS["uneven"], MESH),
    ("four periods", FOUR, MESH),
    ("out of reach", WIDE, MODAL),
    ("out of reach", WIDE, MESH),
)
"""Orbits of all kinds: with one and with several switches at a stop, with a mirror image, of several periods,
without contact."""
FEW = tuple((ratio, omega) for ratio in (0.02, 0.05) for omega in (120.0, 160.0, 222.0, 300.0, 400.0, 500.0))
"""Damping ratios of the paper's joint, and frequencies of its base, rad/s, at which truncation to five modes makes a
stop switch beyond its gap and back: finite differences give the derivative only if they account for these switches."""
BESIDE = (
    1e-7  # Distance of neighbouring starts, divided by the orbit's size; errors are its square, and rounding over it
)
DERIVED = 1e-5  # Relative error of a derivative by differences over `BESIDE`
BY_SAMPLES = 0.05
"""Relative error of the parabolas between 64 samples in half a period, which `FiniteDifferences` draws."""
EDGE = 1e-6
"""Time before a switch, divided by the orbit's length; rates are extrapolated from once and twice this time."""
READ = 1e-3  # Relative error of a rate, and of its derivative, by this extrapolation
CLOSED = 1e-8  # Relative error of the times of switches, by their location and by the closure of the orbit
PERIODS = 3  # Periods over which a deviation is followed, and after which a march from rest gives a deviation
POINTS = 9  # Points in an interval at which distances are evaluated
EXACT = 1e-6  # Relative rounding of bounds and sizes that are derived twice
TIGHT = 0.5
"""Least bound on a distance that the search must find, divided by the distance; a smaller bound would make it march too
long."""
ON_AVERAGE = 0.975
"""Least mean of the ratios in `within`: chords are close over intervals of at most a 32nd of a period."""
CHORD = 1e-4  # Relative error of a chord for a distance or a deviation that hardly bends
WITHIN = (
    1e-9  # Distance from a switch, divided by the interval: truncated modes jump there, and rounding decides the side
)
INSIDE = 0.02  # Distance from the ends of an interval, divided by its length, as a deviation moves the switches there
WANDERING = ("four periods",)
WANDERED, WATCHED, MULTIPLES = 80, 64, 6
"""Periods of a march from rest, the last periods over which its wandering is measured, and the multiples tried."""
RATIOS = (0.0, 0.01, 0.02)  # Damping ratios of modes, the first without damping
FREE, BENT, SHIFTS, RATE, APART = 0.9, 0.5, 3.0, 0.5, 1 / 3
"""The numbers of the rule: largest deviation divided by the distance, without switches and with switches; exempt time
beside a switch, divided by its shift; largest change of the rate, divided by the rate; largest shift, divided by the
time to the next switch."""
LOOKED_AT = 512  # Periods of the orbit over which the rule is evaluated: the slowest orbit decays by 0.85 in each
SMALLEST, LARGEST, HALVINGS = 1e-8, 1e4, 40
"""Sizes of deviations, divided by the size of the orbit, between which the largest allowed size is bisected."""
BEYOND = (1.5, 4.0, 20.0)  # Multiples of the allowed size at which the rule states a time to wait
NEARLY = 0.95  # Least ratio of the rule's limit by bounds to its limit by true deviations and distances
BACK = 40  # Periods after which a march from an allowed deviation must be back
RETURNED = 1e-2  # Largest rest, divided by the deviation, after `BACK` periods: 0.85 to the power of 40 is 1.5e-3
DECAYING = -np.array([0.1, 1.0, 3.0, 0.0]) + 1j * np.array([2.0, 9.0, 0.0, 4.0])
"""Exponents of the terms whose chords are tested, 1/s: ringing, overdamped and undamped terms."""
CUTS = (0.0, 0.01, 0.015, 0.02, 0.04, 0.06)  # Ends of the intervals in a segment, s
OVER = 1.1
"""Largest bound on the error of a chord, divided by the error: the bound uses the term at the start of an interval of
at most 0.2 rad."""


@dataclass(frozen=True)
class Known:
    """An orbit, and the period map by which it was found."""

    label: str
    solver: Solver
    half_periods: HalfPeriods
    orbit: Orbit

    @property
    def length(self) -> float:
        """Length of the orbit, s."""
        return self.orbit.half_periods * self.half_periods.map.period / 2

    @property
    def stops(self) -> range:
        """Numbers of the stops."""
        return range(len(self.half_periods.map.problem.stops))

    @cached_property
    def history(self) -> History:
        """Its motion."""
        return self.half_periods.map.history(self.orbit.point, math.ceil(self.orbit.half_periods / 2))

    @cached_property
    def deviation(self) -> FloatArray:
        """A random deviation, as long as the orbit's section point."""
        map_ = self.half_periods.map
        found = np.random.default_rng(5).standard_normal(self.orbit.last.matrix[0].shape)
        return np.asarray(found * map_.size(self.orbit.point) / map_.norm(found))

    @cached_property
    def transient(self) -> FloatArray:
        """The deviation of a march from rest after some periods, scaled to be as long as the orbit's section point."""
        map_ = self.half_periods.map
        found = map_.difference(map_.march(map_.initial(), 2 * PERIODS).end, self.orbit.point)
        return np.asarray(found * map_.size(self.orbit.point) / map_.norm(found))

    def beside(self, deviation: FloatArray) -> SectionPoint:
        """The section point of the orbit, displaced by a deviation."""
        return self.half_periods.map.moved(self.orbit.point, deviation)

    def neighbour(self, deviation: FloatArray, periods: int) -> History:
        """The motion from the displaced section point over some periods."""
        return self.half_periods.map.history(self.beside(deviation), periods)


def known(label: str, problem: Problem, solver: Solver) -> Known | None:
    """The orbit on which a march from rest ends; None if it is no fixed point of the solver's map."""
    steady = solver.steady_state(problem, sensitivity=False, errors=False)
    half_periods = HalfPeriods(solver.period_map(problem))
    mirrors = steady.symmetric and half_periods.twins is not None
    orbit = find_orbit(half_periods, steady.section_point, steady.period_multiple * (1 if mirrors else 2), FAR)
    return None if orbit is None else Known(f"{label}, {solver.name}", solver, half_periods, orbit)


def gap(history: History, stop: int, t: FloatArray) -> FloatArray:
    """The gap function of a stop, m, positive where it is closed; times from the start of the motion, s."""
    where = history.problem.structure.stops[stop]
    at = np.clip(history.start + t, history.start, history.end)
    return np.asarray(where.sign * history.displacement(where.x, at)[0] - where.gap)


def speed(history: History, stop: int, t: FloatArray) -> FloatArray:
    """Velocity at a stop, m/s."""
    return np.asarray(history.velocity(history.problem.structure.stops[stop].x, history.start + t)[0])


def nearest(history: History, stop: int, time: float) -> float:
    """The time of a stop's switch nearest to a time, both in s from the start of the motion; infinite without
    switches."""
    own = [contact for contact in history.contacts if contact.stop == stop]
    times = [c.start for c in own if not c.open_start] + [c.end for c in own if not c.open_end]
    return min((t - history.start for t in times), key=lambda t: abs(t - time), default=math.inf)


def same(name: str, unit: str, pair: Iterable[FloatArray], share: float, how: str) -> Iterator[Check]:
    """Numbers of one kind by the search, against independent ones; the tolerance is `share` times the largest
    number."""
    found, reference = pair
    u = share * float(np.abs(reference).max(initial=0.0))
    for i, (one, other) in enumerate(zip(found, reference, strict=True)):
        a, b = Estimate(float(one), u, "of the search"), Estimate(float(other), 0.0, how, Kind.CROSS_METHOD)
        yield Check(f"{name} {i + 1}", unit, a, b)


def derivative(it: Known) -> Iterator[Check | Criterion]:
    """The solver's own derivative against the finite differences that the search uses for solvers without a
    derivative."""
    map_, count, how = it.half_periods.map, it.orbit.half_periods, "by finite differences"
    plain = FiniteDifferences(map_)
    own, other = it.half_periods.tangent.linearised(it.orbit.point, count), plain.linearised(it.orbit.point, count)
    apart = float(np.abs(own.matrix - other.matrix).max() / np.abs(own.matrix).max())
    yield Criterion(f"{it.label}: derivative less that {how}", "1", apart, 0.0, DERIVED, "over its largest entry")
    watch, twins = it.orbit.watch, it.half_periods.twins if it.orbit.symmetric else None
    sampled = SegmentWatch(map_.problem, other.segments, twins)
    yield from same(f"{it.label}: switch", "s", (watch.switches.time, sampled.switches.time), DERIVED, how)
    yield from same(f"{it.label}: rate at switch", "m/s", (watch.switches.rate, sampled.switches.rate), BY_SAMPLES, how)
    farthest = (farthest_from_stops(it, one.intervals) for one in (watch, sampled))
    yield from same(f"{it.label}: farthest from stop", "m", farthest, BY_SAMPLES, how)
    if isinstance(
        it.solver, fe_lapjoint.Solver
    ):  # with few modes the motion jumps a little at a switch, so that a sample there is uncertain
        beside = (one.deviated(it.deviation[:, None]).at_switches[:, 0] for one in (watch, sampled))
        yield from same(f"{it.label}: deviation at switch", "m", beside, DERIVED, how)
    yield from followed(it, plain, how)


def followed(it: Known, plain: FiniteDifferences, how: str) -> Iterator[Check | Criterion]:
    """One deviation along a march, by the solver and by finite differences."""
    map_ = it.half_periods.map
    assert isinstance(map_, Follows)
    unit = it.deviation / map_.norm(it.deviation)
    own, other = (one.followed(it.orbit.point, unit, PERIODS) for one in (map_, plain))
    yield from same(f"{it.label}: growth in period", "1", (own.growth, other.growth), DERIVED, how)
    impulses = (one.impulses.ravel() for one in (own, other))
    yield from same(f"{it.label}: impulse by period and stop", "N s", impulses, DERIVED, how)
    numbers = (np.array([float(one.switches)]) for one in (own, other))
    yield from same(f"{it.label}: number of switches", "1", numbers, 0.0, how)
    yield from same(f"{it.label}: deviation followed", "1", (own.deviation, other.deviation), DERIVED, how)
    for n, point in enumerate(own.points, start=1):
        apart = it.half_periods.apart(map_.march(it.orbit.point, 2 * n).end, point)
        reason = "a march that is followed is no other march"
        yield Criterion(f"{it.label}: followed for {n} periods, less marched", "1", apart, 0.0, 0.0, reason)


def farthest_from_stops(it: Known, intervals: Intervals) -> FloatArray:
    """Largest distance of the orbit from each stop, m."""
    return np.array([intervals.distance[intervals.stop == k].max() for k in it.stops])


def switches(it: Known) -> Iterator[Check]:
    """Times, rates, curvatures and spacings of switches, and the effect of a deviation there, against the motion
    itself."""
    watch, how = it.orbit.watch, "of the motion"
    found, h = watch.switches, it.history
    exact = np.array([nearest(h, k, t) for k, t in zip(found.stop, found.time, strict=True)])
    yield from same(f"{it.label}: time of switch", "s", (found.time, exact), CLOSED, how)
    beside = [it.neighbour(sign * BESIDE * it.deviation, math.ceil(it.orbit.half_periods / 2)) for sign in (1, -1)]
    columns: dict[str, list[float]] = {"rate": [], "curvature": [], "shift": [], "turn": []}
    for k, t in zip(found.stop.tolist(), exact, strict=True):
        before = t - EDGE * it.length * np.array([2.0, 1.0])
        after = np.mod(t + EDGE * it.length * np.array([1.0, 2.0]), it.length)
        columns["rate"].append(abs(float(carried(speed(h, k, before)))))
        bends = (np.diff(speed(h, k, at))[0] / (EDGE * it.length) for at in (before, after))
        columns["curvature"].append(max(abs(float(bend)) for bend in bends))
        shifts = [nearest(one, k, t) for one in beside]
        columns["shift"].append(abs(shifts[0] - shifts[1]) / 2)
        columns["turn"].append(float(carried(speed(beside[0], k, before) - speed(beside[1], k, before))) / 2)
    values = {name: np.array(column) for name, column in columns.items()}
    yield from same(f"{it.label}: rate of the motion at switch", "m/s", (found.rate, values["rate"]), READ, how)
    yield from same(f"{it.label}: curvature at switch", "m/s2", (found.curvature, values["curvature"]), READ, how)
    deviated, how = watch.deviated(BESIDE * it.deviation[:, None]), "of neighbouring motions"
    shift = np.abs(deviated.at_switches[:, 0]) / found.rate
    yield from same(f"{it.label}: shift of switch", "s", (shift, values["shift"]), DERIVED, how)
    yield from same(f"{it.label}: change of rate at switch", "m/s", (deviated.rates[:, 0], values["turn"]), READ, how)


def carried(pair: FloatArray) -> float:
    """The value at 0 of a line through its values at -2 and -1."""
    return float(2 * pair[1] - pair[0])


def edges(it: Known) -> FloatArray:
    """Start and end of every interval, s, from the times to the switches of each stop, shape (2, P, I); NaN without a
    switch."""
    found, intervals, length = it.orbit.watch.switches, it.orbit.watch.intervals, it.length
    tiny = 1e-9 * length  # so that the ends of the orbit are unchanged
    both = np.full((2, intervals.stop.size), math.nan)
    told = intervals.before >= 0
    both[0, told] = np.mod(found.time[intervals.before[told]] + intervals.since[told] + tiny, length) - tiny
    told = intervals.after >= 0
    both[1, told] = np.mod(found.time[intervals.after[told]] - intervals.until[told] - tiny, length) + tiny
    return both.reshape(2, len(it.stops), -1)


def distances(it: Known) -> Iterator[Criterion]:
    """Bounds on distances and on deviations in all intervals, against the motion and its neighbours."""
    told = edges(it)
    start, end = np.nanmin(told, axis=1)
    apart = float(np.nanmax(np.nanmax(told, axis=1) - np.nanmin(told, axis=1)))
    gaps = float(np.abs(np.append(start, it.length) - np.insert(end, 0, 0.0)).max())
    name = f"{it.label}: gaps between the intervals, over the orbit's length"
    yield Criterion(
        name, "1", max(apart, gaps) / it.length, 0.0, CLOSED, "they follow each other, whichever stop tells"
    )
    t = start[:, None] + (end - start)[:, None] * np.linspace(WITHIN, 1 - WITHIN, POINTS)
    true = np.array([np.abs(gap(it.history, k, t.ravel())).reshape(t.shape).min(axis=1) for k in it.stops])
    bound = it.orbit.watch.intervals.distance.reshape(true.shape)
    yield from within(f"{it.label}: least distance, bound over true one", bound, true)
    t = start[:, None] + (end - start)[:, None] * np.linspace(INSIDE, 1 - INSIDE, POINTS)
    periods = math.ceil(it.orbit.half_periods / 2)
    above, below = (it.neighbour(sign * BESIDE * it.transient, periods) for sign in (1, -1))
    moved = np.array([np.abs(gap(above, k, t.ravel()) - gap(below, k, t.ravel())) / 2 for k in it.stops])
    largest = it.orbit.watch.deviated(BESIDE * it.transient[:, None]).largest[:, 0].reshape(true.shape)
    true = moved.reshape(len(it.stops), *t.shape).max(axis=2)
    yield from within(f"{it.label}: largest deviation, true one over bound", true, largest)


def within(name: str, part: FloatArray, whole: FloatArray) -> Iterator[Criterion]:
    """Ratio of the part to the whole in all intervals: never above 1, and close to 1 on average."""
    shares = (part / whole)[whole > 1e-6 * whole.max()]
    reason = "a bound, reached where the motion hardly bends"
    yield Criterion(f"{name}, largest", "1", float(shares.max()), 1 - CHORD, 1 + EXACT, reason)
    reason = "bounds are tight"
    yield Criterion(f"{name}, least", "1", float(shares.min()), TIGHT, 1.0, reason)
    yield Criterion(f"{name}, mean", "1", float(shares.mean()), ON_AVERAGE, 1.0, reason)


def out_of_reach(it: Known) -> Iterator[Criterion]:
    """Distances of an orbit without switches, and the limit of the rule against the first deviation that touches a
    stop."""
    t = np.linspace(0.0, it.length, 4001)
    for k in it.stops:
        true = float(np.abs(gap(it.history, k, t)).min())
        found = it.orbit.watch.intervals
        bound = float(found.distance[found.stop == k].min())
        name = f"{it.label}, stop {k + 1}: least distance, bound over true one"
        yield Criterion(name, "1", bound / true, TIGHT, 1 + EXACT, "a bound, and a tight one")
    t = np.linspace(0.0, BACK * it.half_periods.map.period, 200 * BACK + 1)
    orbit, beside = it.half_periods.map.history(it.orbit.point, BACK), it.neighbour(BESIDE * it.transient, BACK)
    moved = max(float(np.max((gap(beside, k, t) - gap(orbit, k, t)) / -gap(orbit, k, t))) for k in it.stops)
    share = allowed(lambda size: it.orbit.forecast(size * it.transient, LOOKED_AT).fails) * moved / BESIDE
    name = f"{it.label}: deviation that the rule allows over that which touches a stop"
    yield Criterion(
        name, "1", share, NEARLY * FREE, FREE + EXACT, "what touches a stop is not bound for a motion that does not"
    )


def chords() -> Iterator[Criterion]:
    """Errors of chords of terms, against the terms themselves, in every interval of two segments and at two
    positions."""
    rng = np.random.default_rng(3)
    segment, tau = np.repeat([0, 1], len(CUTS)), np.tile(CUTS, 2)
    rates = np.stack([DECAYING, DECAYING[::-1]])
    weights = rng.standard_normal((2, 2, rates.shape[1])) + 1j * rng.standard_normal((2, 2, rates.shape[1]))
    where, watched = (segment.astype(np.intp), tau), np.ones((2, 2), dtype=np.bool_)
    terms, misses = terms_at_points(*where, rates, weights, watched, rates.shape[1])
    part = np.linspace(0.0, 1.0, 33)
    shares, summed = [], 0.0
    for i in range(tau.size):
        s = segment[i]
        exact = weights[s] * np.exp(rates[s] * tau[i])
        summed = max(summed, float(np.abs(terms[0, :, i] + 1j * terms[1, :, i] - exact).max()))
        if i + 1 < tau.size and segment[i + 1] == s:
            wave = np.exp(rates[s] * (tau[i] + part[:, None] * (tau[i + 1] - tau[i])))
            chord = wave[0] + part[:, None] * (wave[-1] - wave[0])
            shares.append(misses[:, i] / (np.abs(weights[s]) * np.abs(wave - chord).max(axis=0)))
    least, largest = float(np.min(shares)), float(np.max(shares))
    yield Criterion("terms at the points between intervals: largest difference", "1", summed, 0.0, CLOSED, "of numpy")
    reason = "a bound in every interval, and a tight one"
    yield Criterion("what a chord misses, least bound over the true one", "1", least, 1 - EXACT, OVER, reason)
    yield Criterion("what a chord misses, largest of these", "1", largest, 1.0, OVER, reason)


def conditions(it: Known, deviated: Deviated) -> npt.NDArray[np.bool_]:
    """Whether deviations meet the rule, as it is stated, term by term."""
    watch = it.orbit.watch
    found, intervals = watch.switches, watch.intervals
    if not found.time.size:
        return np.asarray((deviated.largest <= FREE * intervals.distance[:, None]).all(axis=0))
    rate = found.rate[:, None]
    shift = np.abs(deviated.at_switches) / rate
    kept = (shift <= APART * found.spacing[:, None]) & (3 * shift * found.curvature[:, None] <= rate)
    kept &= np.abs(deviated.rates) <= RATE * rate
    clear = deviated.largest <= BENT * intervals.distance[:, None]
    for switch, gone in ((intervals.before, intervals.since), (intervals.after, intervals.until)):
        clear |= (switch >= 0)[:, None] & (gone[:, None] <= SHIFTS * shift[switch])
    return np.asarray(kept.all(axis=0) & clear.all(axis=0))


def waits(it: Known, size: float) -> int:
    """Periods of the orbit after which a deviation, of `size` times the orbit's size, meets the rule for ever."""
    column, columns = size * it.deviation, []
    for _ in range(LOOKED_AT):
        columns.append(column)
        column = it.orbit.last.matrix @ column
    broken = np.flatnonzero(~conditions(it, it.orbit.watch.deviated(np.array(columns).T)))
    return int(broken[-1]) + 1 if broken.size else 0


def allowed(fails: Callable[[float], int]) -> float:
    """The largest size for which the rule need not wait, by bisection of the ratio of allowed and rejected sizes."""
    low, high = SMALLEST, LARGEST
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if fails(middle) == 0 else (low, middle)
    return low


def rule(it: Known) -> Iterator[Check | Criterion]:
    """Statements of the search about deviations of several sizes, against the rule as it is stated, and against a
    march."""

    def fails(size: float) -> int:
        return it.orbit.forecast(size * it.deviation, LOOKED_AT).fails

    size = allowed(fails)
    how = "the rule, deviation by deviation"
    stated = np.array([allowed(lambda size: waits(it, size))])
    yield from same(
        f"{it.label}: largest deviation allowed, over the orbit,", "1", (np.array([size]), stated), EXACT, how
    )
    found, stated = (
        np.array([float(one(times * size)) for times in BEYOND]) for one in (fails, lambda s: waits(it, s))
    )
    yield from same(f"{it.label}: periods to wait beyond it,", "1", (found, stated), 0.0, how)
    map_, course = it.half_periods.map, [size * it.deviation]
    for _ in range(BACK):
        course.append(it.orbit.last.matrix @ course[-1])
    end = it.half_periods.marched(it.beside(course[0]), BACK * it.orbit.half_periods)
    left = map_.norm(map_.difference(end, it.orbit.point)) / max(map(map_.norm, course))
    yield Criterion(f"{it.label}: left of it after {BACK} turns", "1", left, 0.0, RETURNED, "it is bound for the orbit")


def wanders(it: Known) -> Iterator[Criterion]:
    """The distance of a march from repeating, against its definition, term by term."""
    map_ = it.half_periods.map
    points = [map_.initial()]
    for _ in range(WANDERED):
        points.append(map_.march(points[-1], 2).end)
    found = breadth_and_residual(it.half_periods, points, MULTIPLES)
    last = points[-WATCHED - 1 :]
    size = max(map(map_.size, last))
    returns = [
        [map_.norm(map_.difference(last[i + n], last[i])) / size for i in range(len(last) - n)]
        for n in range(1, MULTIPLES + 1)
    ]
    for name, one, other in zip(
        ("breadth", "residual"), found, (min(map(max, returns)), min(row[-1] for row in returns)), strict=True
    ):
        low, high = other * (1 - EXACT), other * (1 + EXACT)
        yield Criterion(f"{it.label}: {name} of a march from rest", "1", one, low, high, "by its definition")


def few_modes() -> Iterator[Criterion]:
    """The derivative of a march with few modes, as a matrix and for one deviation, with large truncation at
    switches."""
    told, whole, growth = 0, 0.0, 0.0
    for ratio, omega in FEW:
        it = known("few modes", paper_joint(angular_frequency=omega, damping_ratio=ratio), MODAL)
        if it is None:
            continue
        map_, count, plain = it.half_periods.map, it.orbit.half_periods, FiniteDifferences(it.half_periods.map)
        assert isinstance(map_, Follows)
        own, other = (one.linearised(it.orbit.point, count).matrix for one in (it.half_periods.tangent, plain))
        whole = max(whole, float(np.abs(own - other).max() / np.abs(own).max()))
        unit = it.deviation / map_.norm(it.deviation)
        grown = map_.followed(it.orbit.point, unit, PERIODS).growth
        expected = sum(plain.followed(it.orbit.point, sign * unit, PERIODS).growth for sign in (1, -1)) / 2
        growth, told = max(growth, float(np.abs(grown - expected).max())), told + 1
    name, reason = f"the paper's joint, {MODAL.name}", f"at {len(FEW)} frequencies and damping ratios"
    yield Criterion(f"{name}: motions that repeat", "1", told, len(FEW) / 2, len(FEW), reason)
    reason = "over its largest entry, the largest of these motions"
    yield Criterion(f"{name}: derivative less that by finite differences", "1", whole, 0.0, DERIVED, reason)
    reason = "the largest of these motions and of three periods"
    yield Criterion(f"{name}: growth in a period less that of marches beside", "1", growth, 0.0, DERIVED, reason)


def damping_rates() -> Iterator[Check]:
    """The lowest damping rate of damped modes, by which the search bounds the duration of a transient."""
    ratios = ModalDamping(ratio=RATIOS)
    for solver in (MODAL, fe_lapjoint.Solver(elements=16)):
        found = solver.period_map(JOINTS["uneven"].replace(damping=ratios)).lowest_damping_rate
        a = Estimate(found, READ * found, solver.name)
        b = Estimate(
            RATIOS[1] * roots(BEAMS["clamped-free"].equation, 2)[1] ** 2,
            0.0,
            "of the second mode, as the first is not damped",
            Kind.ANALYTICAL,
        )
        yield Check(f"lowest damping rate: {solver.name}", "1/s", a, b)


def run(level: Level, say: Say) -> CaseResult:
    """All orbits, the chords, and the marches with few modes."""
    items: list[Check | Criterion] = [*damping_rates(), *chords(), *few_modes()]
    for label, problem, solver in ORBITS:
        it = known(label, problem, solver)
        name, reason = f"{label}, {solver.name}: a fixed point (1: yes)", "where the march ends, Newton's method closes"
        items.append(Criterion(name, "1", float(it is not None), 1.0, 1.0, reason))
        if it is None:
            continue
        items += [*derivative(it), *switches(it), *rule(it)]
        items += distances(it) if it.orbit.watch.switches.time.size else out_of_reach(it)
        items += wanders(it) if label in WANDERING else ()
        say(it.label)
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "orbit-watch",
        "What the search knows of an orbit",
        "A march is called bound for an orbit by the derivative of its map, its distances from the stops, what "
        "deviations do there, and a rule that holds for all time. Both solvers share the code. Here the derivative and "
        "deviations are compared with marches that begin a little beside the orbit, distances and rates with the "
        "motion, and what the search decides with the rule as it is stated, for deviations of all sizes.",
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("Orbits", ("quantity", "unit", "reference", "found", "difference", "allowed"), rows),),
    )
