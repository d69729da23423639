"""A witness of branches who follows none: at motions drawn from a branch he marches, looks at every gap, and pushes.

He draws a field and a range of it for each random joint, has the branch of the motion from rest traced, and then

- evaluates each drawn orbit's gap functions densely: nothing is beyond a stop but in a contact, and no contact is short
  of it; finite elements he marches again by `dense_march`, too, and finds the same switches;
- marches a drawn orbit from a section point pushed a little away: it comes back or leaves as the multipliers say, by
  the factor that the largest of them says;
- asks whether contacts or the number of multipliers outside the unit circle change anywhere without a bifurcation,
  whether the number is extremal at folds, and whether the branch ends where it says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from dense_march import dense_march, fastest_moving
from population import joint

import analytic
import fe_lapjoint
from fe_lapjoint.march.field import ElementField
from lapjoint import History, Problem, SteadyState
from lapjoint.campaigns.branches.solve import steady_state
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.bifurcations import Bifurcation, beside
from lapjoint.orbits.branches.errors import value_of
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Found, Limits, Traced, trace
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.problem import BaseMotion, FloatArray

AnySolver = analytic.Solver | fe_lapjoint.Solver
FIELDS = ("base_motion.angular_frequency", "base_motion.amplitude", "stops.*.gap", "stops.*.stiffness")
"""What is varied; gaps and stiffnesses of the first stop, or of all where they are equal."""
WIDTH = (0.03, 0.5)  # of the number: between these is half the range, evenly by its logarithm
POINTS = 40  # of a branch, at most
DRAWN = 4  # of its points, which are looked at closely
MARGIN = 0.02  # distance of a multiplier's modulus from 1, below which a march takes too long to decide
PUSH = 1e-9  # of the motion's size: it may grow 3000-fold in the first periods where the motion is stable
FAR = 1e-4  # of the motion's size: what leaves it by so much does not come back
LEFT = 1e-2  # of the largest distance between returns: what is left of it in the end
_CLOSED = 1e-7  # of the motion's size, and of its period: by so much the marches' ends and switches may differ
_DEEP = 1e-6  # of a motion's largest displacement: contacts less deep may be seen by one march, and not by the other
_GRAZES = 1e-3  # of the number: a motion is at a graze
_BESIDE = 1e-9  # of a motion's period
_ONE = 1e-9  # of the number: bifurcations are located to so much
_AWAY = (1e-3, 1e-4, 1e-5, 1e-6)  # arclengths from a fold at which the number is looked at
_TOLD = 1e-13  # of the number's scale: the least change that is told
_SAMPLES = 40  # in the shortest period of a mode
_AT_ONCE = 1_000_000  # samples that are looked at: all of a motion with fast modes would fill the memory


@dataclass(frozen=True)
class Drawn:
    """A random joint and what is varied."""

    problem: Problem
    path: str
    low: float
    high: float


def drawn(seed: int, index: int) -> Drawn:
    """One of a seed's problems; it depends on the seed and its index alone."""
    problem, rng = joint(seed, index), np.random.default_rng((seed, index, 13))
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    field = FIELDS[int(rng.integers(0, len(FIELDS)))]
    if field.startswith("stops"):
        name = field.rpartition(".")[2]
        twins = len({getattr(stop, name) for stop in problem.stops}) == 1
        path, middle = (field if twins else f"stops.0.{name}"), float(getattr(problem.stops[0], name))
    else:
        path, middle = field, float(getattr(base, field.rpartition(".")[2]))
    share = math.exp(rng.uniform(*np.log(WIDTH)))
    return Drawn(problem, path, middle * (1 - share), middle * (1 + share))


@dataclass(frozen=True)
class Witnessed:
    """What is said of one problem."""

    faults: tuple[str, ...]
    """What is wrong; empty if nothing is."""
    points: int
    """Points of the branch; 0 if there is none."""
    pushed: int
    """Motions that were marched from a push."""
    ends: tuple[str, ...]
    """Why the branch ends."""
    kinds: tuple[str, ...]
    """Its bifurcations."""


def witnessed(solver: AnySolver, seed: int, index: int) -> Witnessed:
    """All of it for one problem."""
    one, rng = drawn(seed, index), np.random.default_rng((seed, index, 14))
    of = range_of(solver, one)
    traced, at_end = first_branch(of)
    if traced is None:
        return Witnessed((), 0, 0, (), ())
    faults, pushed = [*unnamed(traced), *listed_twice(traced), *ends(of, traced, at_end), *not_extremal(traced)], 0
    for i in rng.permutation(len(traced.points))[:DRAWN].tolist():
        point = traced.points[i]
        map_, motion = point.problem.resolution.map(point.value), steady_state(point)
        where = f"point {i} at {point.value:.9g}"
        faults += [f"{where}: {what}" for what in unseen(motion)]
        if not at_graze(traced, i, _ONE):  # there rounding decides about a contact, and nearby a push
            faults += [f"{where}: {what}" for what in marched_again(map_, point, motion)]
        said = None if at_graze(traced, i, _GRAZES) else pushed_march(map_, motion, rng)
        pushed += said is not None
        faults += [f"{where}: {said}"] if said else []
    kinds = tuple(one.what.kind for one in traced.found)
    return Witnessed(tuple(faults), len(traced.points), pushed, traced.ends, kinds)


def range_of(solver: AnySolver, one: Drawn) -> ParameterRange:
    """The range of a problem by a solver."""
    grid = Grid(one.problem, (Axis(one.path, (one.low, one.high)),))
    return ParameterRange(solver, lambda value: grid.with_values((value,)), one.path, one.low, one.high)


def first_branch(of: ParameterRange) -> tuple[Traced | None, bool]:
    """The branch of a motion that a march from rest comes to, at one of three values, and whether at an end."""
    for value in (of.low, of.high, 0.5 * (of.low + of.high)):
        start = start_from(of, value, of.resolution(value).map(value).initial(), 2)
        if start is not None:
            return trace(of, start, 2, Limits(POINTS)), value in (of.low, of.high)
    return None, False


def closings(point: CurvePoint, multiple: int) -> int:
    """Contacts that begin while the excitation has so many periods, as the contact sequence has them."""
    return point.problem.events * multiple // point.problem.half_periods


def begun(history: History) -> int:
    """Contacts that begin in a motion."""
    return sum(not contact.open_start for contact in history.contacts)


def unnamed(traced: Traced) -> Iterator[str]:
    """Where contacts or stability change from point to point without a bifurcation between."""
    named = {one.index for one in traced.found}
    last = len(traced.points) - 1
    named |= {at for at, end in zip((1, last), traced.ends, strict=True) if end == "bifurcation"}
    for i, (a, b) in enumerate(pairwise(traced.points)):
        if i + 1 in named:
            continue
        where = f"between points {i} and {i + 1} at {a.value:.9g} and {b.value:.9g}"
        if a.problem.events != b.problem.events:
            yield f"{where}: {a.problem.events} and {b.problem.events} switches, and no graze"
        outside = [int(np.count_nonzero(np.abs(one.multipliers) > 1)) for one in (a, b)]
        if outside[0] != outside[1]:
            yield f"{where}: {outside[0]} and {outside[1]} multipliers outside the circle, and no bifurcation"


def listed_twice(traced: Traced) -> Iterator[str]:
    """Bifurcations that have the number and the motion of another one of their kind."""
    for one, other in combinations(traced.found, 2):
        a, b = value_of(one.what), value_of(other.what)
        if one.what.kind == other.what.kind and abs(a - b) <= _ONE * abs(a) and is_one_motion(one, other):
            yield f"{one.what.kind} at {a:.12g} before points {one.index} and {other.index}"


def is_one_motion(one: Found, other: Found) -> bool:
    """Whether two bifurcations have one motion."""
    point, there = (
        found.what.point if isinstance(found.what, Bifurcation) else found.what.before for found in (one, other)
    )
    half = HalfPeriods(point.problem.resolution.map(point.value))
    mine = half.map.adopted(point.section())
    return any(half.apart(half.map.adopted(image), mine) <= SAME for image in there.sections())


def ends(of: ParameterRange, traced: Traced, at_end: bool) -> Iterator[str]:
    """Ends that are said to be those of the range, and are not, and rings from a motion at an end of the range."""
    for end, point in zip(traced.ends, (traced.points[0], traced.points[-1]), strict=True):
        if end == "boundary" and point.value not in (of.low, of.high):
            yield f"ends as boundary at {point.value:.9g}"
        if end == "closed" and at_end:
            yield "is a ring, which goes through an end of the range"


def not_extremal(traced: Traced) -> Iterator[str]:
    """Folds on both sides of which the number goes on in one direction."""
    for one in traced.found:
        if isinstance(one.what, Bifurcation) and one.what.kind == "fold" and not is_extremal(one.what.point):
            yield f"fold at {one.what.point.value:.9g}: the number goes on"


def is_extremal(fold: CurvePoint) -> bool:
    """Whether the number is on one side of a fold's on both sides of it, as near as can be told."""
    told = True
    for length in _AWAY:
        near = [beside(fold, way) for way in (length, -length)]
        changes = [(one.value - fold.value) / fold.scale[-1] for one in near if one is not None]
        if len(changes) == 2 and min(map(abs, changes)) > _TOLD:
            told = changes[0] * changes[1] > 0
            if told:
                break
    return told


def at_graze(traced: Traced, i: int, near: float) -> bool:
    """Whether the number of a point is as near to that of a graze, over its size."""
    value = traced.points[i].value
    grazes = (value_of(one.what) for one in traced.found if not isinstance(one.what, Bifurcation))
    return any(abs(one - value) <= near * abs(value) for one in grazes)


def unseen(motion: SteadyState) -> Iterator[str]:
    """Where the orbit is beyond a stop outside its contacts, or short of it in one."""
    history = motion.history
    count = math.ceil((history.end - history.start) * fastest_of(history) * _SAMPLES / (2 * math.pi))
    samples, jumps = max(count, 2000), displaced(history)
    edges = np.linspace(0, samples, math.ceil(samples / _AT_ONCE) + 1).astype(int)
    step = (history.end - history.start) / (samples - 1)
    for k in range(len(history.problem.stops)):
        parts = (np.minimum(history.start + step * np.arange(a, b), history.end) for a, b in pairwise(edges))
        seen = [_farthest(history, k, t) for t in parts]
        size, beyond, short = (max(values) for values in zip(*seen, strict=True))
        least = max(_DEEP * size, 2 * jumps[k])
        for what, wrong in (("beyond", beyond), ("short of", short)):
            if wrong > least:
                yield f"{wrong:.1e} m {what} stop {k} unseen, of {size:.1e} m"


def fastest_of(history: History) -> float:
    """Angular frequency of the fastest load or mode, rad/s; by finite elements, of those that move a stop."""
    field, fastest = history.field, history.problem.forces.fastest
    if not isinstance(field, ElementField):
        return max(history.highest_mode or 0.0, fastest)
    for piece in field.pieces:
        t = np.array([piece.start])
        q, v = (piece.coordinates(t, dt)[:, 0] for dt in (0, 1))
        fastest = max(fastest, fastest_moving(field.model.system(piece.state), q, v, piece.start))
    return fastest


def _farthest(history: History, k: int, t: FloatArray) -> tuple[float, float, float]:
    """Of some samples the largest displacement, and how far they are beyond a stop outside contacts, or short of it."""
    stop, edge = history.problem.stops[k], _CLOSED * (history.end - history.start)
    z = history.displacement(stop.x, t)[0]
    gap = stop.sign * z - stop.gap
    inside, near = np.zeros(t.size, dtype=bool), np.zeros(t.size, dtype=bool)
    for contact in history.contacts:
        if contact.stop == k:
            inside |= (t >= contact.start) & (t <= contact.end)
            near |= (np.abs(t - contact.start) <= edge) | (np.abs(t - contact.end) <= edge)
    beyond, short = gap[~inside & ~near].max(initial=-np.inf), -gap[inside & ~near].min(initial=np.inf)
    return float(np.abs(z).max()), float(beyond), float(short)


def displaced(history: History) -> FloatArray:
    """Largest displacement by which truncated modes make each stop's gap jump at any switch, m, shape ``(stops,)``."""
    beside = _BESIDE * (history.end - history.start)
    before, after = history.switch_times - beside, history.switch_times + beside
    jumps = [
        history.displacement(stop.x, after) - history.displacement(stop.x, before) for stop in history.problem.stops
    ]
    return np.array([float(np.abs(jump).max(initial=0.0)) for jump in jumps])


def marched_again(map_: PeriodMap, point: CurvePoint, motion: SteadyState) -> Iterator[str]:
    """How the solver's march, and by finite elements one in tiny steps, too, differ from the orbit."""
    contacts = closings(point, motion.period_multiple), begun(motion.history)
    if contacts[0] != contacts[1]:
        yield f"marched it has {contacts[1]} contacts, not {contacts[0]}"
    model = getattr(map_, "model", None)
    if model is None:
        return
    periods, start = motion.period_multiple, motion.section_point
    y = np.asarray(map_.modal(start)).ravel()  # type: ignore[attr-defined]
    found = dense_march(model, start.state, y, map_.period, periods)
    omega = 2 * math.pi / map_.period
    q, v = np.split(found.y, 2)
    if found.state != start.state:
        yield f"marched in tiny steps it begins with {start.state.closed} closed, and ends with {found.state.closed}"
        return
    q0, v0 = np.split(y, 2)
    size = math.hypot(float(np.linalg.norm(q0)), float(np.linalg.norm(v0)) / omega)
    away = math.hypot(float(np.linalg.norm(q - q0)), float(np.linalg.norm(v - v0)) / omega)
    growth = max(1.0, float(np.abs(motion.multipliers).max()))
    if away > _CLOSED * growth * size:
        yield f"marched in tiny steps it closes to {away / size:.1e}"
    history = motion.history
    expected = sorted(
        [(c.start - history.start, c.stop) for c in history.contacts if not c.open_start]
        + [(c.end - history.start, c.stop) for c in history.contacts if not c.open_end]
    )
    if sorted(k for k, _ in found.switches) != sorted(k for _, k in expected):
        yield f"marched in tiny steps it switches {len(found.switches)} times, not {len(expected)}"
        return
    by_time: FloatArray = np.array([t for t, _ in expected]) - np.array([t for _, t in found.switches])
    if by_time.size and np.abs(by_time).max() > 1e-5 * periods * map_.period:
        yield f"marched in tiny steps a switch is {np.abs(by_time).max():.1e} s off"


def pushed_march(map_: PeriodMap, motion: SteadyState, rng: np.random.Generator) -> str | None:
    """What is wrong with a march from a push, "" if nothing is; None where the multipliers say too little."""
    leading = float(np.abs(motion.multipliers).max(initial=0.0))
    if abs(leading - 1) < MARGIN:
        return None
    start, periods = motion.section_point, motion.period_multiple
    size = map_.size(start)
    deviation = rng.standard_normal(map_.difference(start, start).size)
    deviation = deviation * np.array([1 / map_.norm(unit) for unit in np.eye(deviation.size)])
    here = map_.moved(start, deviation * (PUSH * size / map_.norm(deviation)))
    most = 10 + math.ceil(math.log(FAR / PUSH * 100) / abs(math.log(max(leading, 1e-3))))
    returns, farthest = [], 0.0
    for _ in range(most):
        there = map_.march(here, 2 * periods).end
        returns.append(map_.norm(map_.difference(there, here)) / size)
        here = there
        farthest = max(farthest, map_.norm(map_.difference(here, start)) / size)
        if leading > 1 and farthest > FAR:
            break
    if leading > 1:
        return "" if farthest > FAR else f"multiplier {leading:.4f}, but a push of {PUSH} has become {farthest:.1e}"
    back = returns[-1] <= max(LEFT * max(returns), 1e-11)
    return "" if back else f"multiplier {leading:.4f}, but returns of {max(returns):.1e} have become {returns[-1]:.1e}"
