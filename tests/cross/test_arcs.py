"""Arcs with a given contact sequence, by both solvers: against their marches and against differences."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from few_and_many import few_and_many
from population import harmonic_joint, joint, joints, lasting_joint, recorded_joint, stiffened_joint
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import (
    BaseMotion,
    History,
    InputError,
    ModalDamping,
    NoDamping,
    Problem,
    Support,
    ViscousDamping,
    paper_joint,
)
from lapjoint.answers import SectionPoint
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.arcs import Arcs, Chain, ContactSequence, HasArcs
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY
from lapjoint.problem import FloatArray

Kind = Callable[[int, int], Problem]


def overdamped(seed: int, index: int) -> Problem:
    """The first mode decays without oscillating, and the second nearly so."""
    return joint(seed, index).replace(damping=ModalDamping(ratio=(3.0, 1.5, 0.1)))


def with_a_rigid_body(seed: int, index: int) -> Problem:
    """A pinned beam, undamped in every second problem, which turns about its pin."""
    damping = ViscousDamping(coefficient=0.5) if index % 2 else NoDamping()
    pin = (Support(x=0.0, translational=math.inf),)
    return stiffened_joint(seed, index).replace(damping=damping, supports=pin)


KINDS: list[Kind] = [joint, stiffened_joint, lasting_joint, harmonic_joint, overdamped, with_a_rigid_body]
SOME = pytest.mark.parametrize("seeds", few_and_many(range(24), range(24, 144)))
CHATTERS = 60  # switches in a period, beyond which roundings grow too large
BOTH = pytest.mark.parametrize("name", ["analytic", "fe"])


def solver_of(name: str, seed: int) -> AnySolver:
    """A solver of 5 to 24 modes, or 2 to 5 elements."""
    rng = np.random.default_rng((107, seed))
    if name == "analytic":
        return analytic.Solver(n_modes=int(rng.integers(5, 25)))
    return fe_lapjoint.Solver(elements=int(rng.integers(2, 6)))


@lru_cache(maxsize=48)
def mapped(name: str, seed: int) -> tuple[PeriodMap, SectionPoint]:
    """A joint, every twelve two of each kind, and a motion of it some periods from rest."""
    period_map = solver_of(name, seed).period_map(KINDS[seed // 2 % len(KINDS)](93, seed))
    periods = int(np.random.default_rng((106, seed)).integers(1, 12))
    return period_map, period_map.march(period_map.initial(), 2 * periods).end


def cut(history: History) -> tuple[ContactSequence, FloatArray]:
    """The contact sequence of a march, and the durations of its arcs."""
    stops = tuple(
        (set(one.closed) ^ set(other.closed)).pop()
        for one, other in zip(history.states[:-1], history.states[1:], strict=True)
    )
    return ContactSequence(history.states[0], stops), np.diff([history.start, *history.switch_times, history.end])


def fastest(arcs: Any, states: tuple[ContactState, ...]) -> float:
    """Angular frequency or rate of decay of the fastest mode of some states, rad/s."""
    if hasattr(arcs, "joint"):
        slots = [arcs.joint.slot(state) for state in states]  # new states make new tables
        return float(arcs.joint.tables.fastest[slots].max())
    return float(max(max(it.omega[-1], 2 * it.damping_rate.max()) for it in map(arcs.model.system, states)))


def any_sequence(arcs: Arcs, point: SectionPoint, seed: int) -> tuple[ContactSequence, FloatArray]:
    """Up to six events of any stops, with durations of either sign, one of them zero."""
    rng, stops = np.random.default_rng((108, seed)), list[int]()
    for _ in range(int(rng.integers(1, 7))):
        another = not stops or rng.random() < 0.4
        stops.append(int(rng.integers(len(arcs.problem.stops))) if another else stops[-1])
    sequence = ContactSequence(point.state, tuple(stops))
    durations = rng.uniform(-0.05, 0.4, len(stops) + 1) * arcs.period
    durations = np.maximum(durations, -0.5 / fastest(arcs, sequence.states))  # backwards, fast modes grow
    durations[int(rng.integers(durations.size))] = 0.0
    return sequence, durations


def size(values: npt.NDArray[np.inexact[Any]]) -> float:
    """The largest of some numbers, without sign."""
    return float(np.abs(values).max(initial=0.0))


def events_of_the_march(arcs: Arcs, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> FloatArray:
    """What the left sides of the equations are where stops switch as in a march, m, or m/s where a stop returns.

    By truncation the gap function of a stop may begin a state beyond 0.  The march lets the stop switch where its gap
    function comes back to that, if it is above 0 in the sense that rising through 0 is the next switch, and else at 0.
    """
    motion = arcs.motion(sequence, chain, durations)
    places = sorted({stop.x for stop in arcs.problem.stops})
    expected = np.zeros(len(sequence.stops))
    for i, k in enumerate(sequence.stops):
        stop, way = arcs.problem.stops[k], motion.orientation[i, k]
        u = places.index(stop.x)
        begins = (motion.weights[i, u] * motion.amplitudes[i]).real.sum() + motion.polynomial[i, u, 0]
        h = way * (stop.sign * begins - stop.gap)
        returning = sequence.returning[i]
        expected[i] = way * (max(h, 0.0) - h) / durations[i] if returning else way * max(h, 0.0)
    return expected


def along_the_march(period_map: PeriodMap, point: SectionPoint, periods: int = 1) -> tuple[Chain, History]:
    """A march and the arcs that it is cut into, whose end and equations are compared with it."""
    arcs, history = period_map.arcs, period_map.history(point, periods)
    sequence, durations = cut(history)
    chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations)
    assert chain.end_by is not None
    assert chain.events_by is not None
    end = period_map.march(point, 2 * periods).end
    assert end.state == sequence.states[-1]
    n, rounding = chain.starts[0].size, 1e-14 * history.end  # of durations, as differences of times
    shifted = rounding * size(chain.end_by[:, n:])
    if len(sequence.stops) > CHATTERS:
        return chain, history
    assert size(chain.end - arcs.coordinates(end)) <= 1e-9 * size(chain.end) + shifted
    misses = np.abs(chain.events - events_of_the_march(arcs, sequence, chain, durations))
    allowed = rounding * np.abs(chain.events_by[:, n:]).sum(axis=1)
    gaps = np.array([stop.gap for stop in arcs.problem.stops])[list(sequence.stops)]
    located = 1e-10 * gaps / np.where(sequence.returning, durations[:-1], 1.0)
    assert (misses <= located + allowed).all()  # a switch is located to 1e-13 of a unit of time
    return chain, history


@BOTH
@SOME
def test_arcs_that_last_as_in_a_march_go_where_it_goes_and_satisfy_every_equation(seeds: range, name: str) -> None:
    events = 0
    for seed in seeds:
        period_map, point = mapped(name, seed)
        chain, history = along_the_march(period_map, point)
        events += chain.events.size
        if chain.events.size > CHATTERS:
            continue
        sequence, durations = cut(history)
        motion, stops = period_map.arcs.motion(sequence, chain, durations), period_map.problem.stops
        places = np.unique([stop.x for stop in stops])
        assert motion.weights.shape == (durations.size, places.size, motion.rates.shape[1])
        assert motion.start == pytest.approx(chain.times, abs=1e-14)
        assert all(array.flags.c_contiguous for array in motion)
        largest = size(history.displacement(places, np.linspace(0.0, history.end, 100)))
        for i, state in enumerate(sequence.states):
            assert motion.orientation[i].tolist() == [-1.0 if k in state else 1.0 for k in range(len(stops))]
            tau = 0.7 * durations[i]
            waves = motion.amplitudes[i] * np.exp(motion.rates[i] * tau)
            told = (motion.weights[i] @ waves).real + motion.polynomial[i] @ np.array([1.0, tau, tau**2])
            assert size(told - history.displacement(places, chain.times[i] + tau)[:, 0]) <= 1e-9 * largest, (seed, i)
    assert events >= len(seeds)


@pytest.mark.parametrize(
    ("solver", "problems"),
    [
        (analytic.Solver(n_modes=8), (paper_joint(),)),
        (fe_lapjoint.Solver(elements=6), tuple(joints(7, 4))),
        pytest.param(analytic.Solver(n_modes=20), (paper_joint(),), marks=pytest.mark.thorough),
        pytest.param(fe_lapjoint.Solver(elements=12), tuple(joints(7, 4)), marks=pytest.mark.thorough),
    ],
)
def test_arcs_along_a_steady_state_close_and_have_its_multipliers(
    solver: AnySolver, problems: tuple[Problem, ...]
) -> None:
    met = 0
    for problem in problems:
        steady, period_map = solver.steady_state(problem, errors=False), solver.period_map(problem)
        if not steady.period_multiple:
            continue
        chain, _ = along_the_march(period_map, steady.section_point, steady.period_multiple)
        assert size(chain.end - chain.starts[0]) <= 1e-8 * size(chain.end)  # as far as the search went
        n = chain.end.size
        by_times = chain.end_by[:, n:-1] - chain.end_by[:, -1:]  # the last arc ends with the period
        times = np.linalg.solve(chain.events_by[:, n:-1], -chain.events_by[:, :n])
        multipliers = np.linalg.eigvals(chain.end_by[:, :n] + by_times @ times)
        known = period_map.linearised(steady.section_point, 2 * steady.period_multiple).multipliers[:4]
        assert np.abs(np.subtract.outer(known, multipliers)).min(axis=1).max() <= 1e-8 * size(known)
        met += chain.events.size
    assert met


@BOTH
@SOME
def test_derivatives_are_those_that_differences_give(seeds: range, name: str) -> None:
    for seed in seeds:
        period_map, point = mapped(name, seed)
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        time = 0.3 * arcs.period
        chain = arcs.chain(sequence, start, time, durations)
        assert chain.end_by is not None
        assert chain.events_by is not None
        n, M = start.size, len(sequence.stops)
        by_duration = np.full(M + 1, 1e-4 / fastest(arcs, sequence.states))
        steps = np.concatenate([size(start) / arcs.unit_norms(point.state), by_duration])
        ends, events = np.empty((chain.end.size, n + M + 1)), np.empty((M, n + M + 1))
        for j in range(n + M + 1):  # the motion is linear in its start: any step will do
            moved = np.zeros(n + M + 1)
            moved[j] = steps[j]
            ahead, back = (
                arcs.chain(sequence, start + way * moved[:n], time, durations + way * moved[n:], derivatives=False)
                for way in (1, -1)
            )
            ends[:, j], events[:, j] = (ahead.end - back.end) / 2, (ahead.events - back.events) / 2
        told, told_events = chain.end_by * steps, chain.events_by * steps
        for part in (slice(0, n), slice(n, n + M + 1)):
            assert size((told - ends)[:, part]) <= 1e-6 * size(told[:, part]), (seed, part)
            for i in range(M):
                assert size((told_events - events)[i, part]) <= 1e-6 * size(told_events[i, part]), (seed, part, i)


@SOME
def test_derivatives_by_numbers_of_the_excitation_are_those_that_differences_give(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped("analytic", seed)
        problem, solver = period_map.problem, solver_of("analytic", seed)
        path = AMPLITUDE if isinstance(problem.base_motion, BaseMotion) and seed % 4 == 1 else FREQUENCY
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        value, phase = getattr(problem.base_motion, path.split(".")[1]), 0.3
        chain = arcs.chain(sequence, start, phase * arcs.period, durations, number=path)
        assert chain.by_number is not None
        step, n, slopes = value * (1e-5 if path == FREQUENCY else 0.25), start.size, list[FloatArray]()
        grid = Grid(problem, (Axis(path, (value,)),))
        for h in (step, 2 * step):  # the motion is linear in the amplitude
            ends = []
            for number in (value + h, value - h):
                there = solver.period_map(grid.with_values((number,))).arcs
                shares = durations / arcs.period
                its = there.chain(sequence, start, phase * there.period, shares * there.period, derivatives=False)
                ends.append(np.concatenate([its.end, its.events]))
            slopes.append((ends[0] - ends[1]) / (2 * h))
        found = (4 * slopes[0] - slopes[1]) / 3
        parts = (chain.end_by, slice(0, chain.end.size)), (chain.events_by, slice(chain.end.size, None))
        for by, part in parts:
            assert by is not None
            rounding = 1e-13 * size(np.abs(by[:, :n]) @ np.abs(start)) / step
            assert size((found - chain.by_number)[part]) <= 1e-6 * size(chain.by_number[part]) + rounding, seed
        assert arcs.chain(sequence, start, 0.0, durations, number="stops.*.gap").by_number is None


@BOTH
@SOME
def test_arcs_go_on_from_any_of_their_moments_and_a_period_later_as_before(seeds: range, name: str) -> None:
    for seed in seeds:
        period_map, point = mapped(name, seed)
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        durations = np.abs(durations)
        whole, later = (arcs.chain(sequence, start, t, durations) for t in (0.0, arcs.period))
        assert size(later.end - whole.end) <= 1e-11 * size(whole.end)
        assert later.end_by == pytest.approx(whole.end_by, rel=1e-9, abs=1e-11 * size(whole.end_by))  # type: ignore[arg-type]
        i = len(sequence.stops) // 2
        state, part, time = sequence.states[i], 0.3 * durations[i], float(whole.times[i])
        between = arcs.later(state, whole.starts[i], time, part)
        rest = ContactSequence(state, sequence.stops[i:])
        left = np.concatenate([[durations[i] - part], durations[i + 1 :]])
        end = arcs.chain(rest, between, time + part, left, derivatives=False).end
        assert size(end - whole.end) <= 1e-11 * size(whole.end), seed
        step = min(1e-3 * arcs.period, 0.1 / fastest(arcs, (state,)))
        back = arcs.later(state, between, time + part, -step)
        assert size(arcs.later(state, back, time + part - step, step) - between) <= 1e-9 * size(between), seed


@BOTH
def test_a_section_point_is_its_coordinates_and_units_have_their_norms(name: str) -> None:
    for seed in range(20):
        period_map, point = mapped(name, seed)
        assert isinstance(period_map, HasArcs)
        arcs = period_map.arcs
        again = arcs.point(point.state, arcs.coordinates(point))
        assert again.state == point.state
        assert again.coordinates == pytest.approx(point.coordinates, rel=1e-10, abs=1e-10 * size(point.coordinates))
        deviations = FREE if name == "fe" else point.state  # in whose modes deviations from a point are
        norms = [period_map.norm(unit) for unit in np.eye(period_map.difference(point, point).size)]
        assert arcs.unit_norms(deviations) == pytest.approx(norms, rel=1e-12)


def test_what_has_no_arcs_is_refused() -> None:
    for solver in (analytic.Solver(n_modes=3), fe_lapjoint.Solver(elements=3)):
        with pytest.raises(InputError, match="is a record, which has no period"):
            solver.period_map(recorded_joint(1, 0)[0])
    coarse, fine = (fe_lapjoint.Solver(elements=n).period_map(joint(1, 0)) for n in (3, 12))
    with pytest.raises(InputError, match="another mesh"):
        fine.arcs.coordinates(coarse.initial())
