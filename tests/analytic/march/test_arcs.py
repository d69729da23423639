"""Arcs with a given contact sequence: against the march, differences, and quotients in fifty digits."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import mpmath as mp
import numpy as np
import numpy.typing as npt
import pytest

import analytic
from analytic.march import Coordinates, Joint, March, march
from analytic.march.arcs import JointArcs
from analytic.march.gap_view import outline_of
from analytic.march.mean_rates import mean_rate
from analytic.march.oscillator import DRIFTING, OSCILLATING, SPLIT
from analytic.period_map import PeriodMap
from lapjoint import BaseMotion, ModalDamping, NoDamping, Problem, Support, ViscousDamping, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.arcs import Chain, ContactSequence, HasArcs
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY
from lapjoint.orbits.watch import motion_at
from lapjoint.problem import FloatArray
from tests.helpers.population import harmonic_joint, joint, lasting_joint, stiffened_joint

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


SOME = pytest.mark.parametrize("seeds", [range(24), pytest.param(range(24, 144), marks=pytest.mark.slow)], ids=str)


@lru_cache(maxsize=24)
def mapped(seed: int) -> tuple[PeriodMap, SectionPoint]:
    """A joint with 5 to 24 modes, every twelve two of each kind, and a motion of it some periods from rest."""
    rng, kind = np.random.default_rng((107, seed)), KINDS[seed // 2 % len(KINDS)]
    period_map = analytic.Solver(n_modes=int(rng.integers(5, 25))).period_map(kind(93, seed))
    return period_map, period_map.march(period_map.initial(), 2 * int(rng.integers(1, 12))).end


def marched(period_map: PeriodMap, point: SectionPoint, periods: float) -> March:
    """A march from a section point, recorded."""
    begin = Coordinates(point.state, point.coordinates[0], point.coordinates[1])
    return march(period_map.joint, begin, 0.0, periods * period_map.period)


def cut(motion: March) -> tuple[ContactSequence, FloatArray]:
    """The contact sequence of a march, and the durations of its arcs."""
    log = motion.log
    stops = tuple(int(stop) for stop in log.stop[:-1])
    return ContactSequence(motion.joint.state_in(int(log.slot[0])), stops), log.end - log.start


def any_sequence(arcs: JointArcs, point: SectionPoint, seed: int) -> tuple[ContactSequence, FloatArray]:
    """Up to six events of any stops, with durations of either sign, one of them zero."""
    rng, stops = np.random.default_rng((108, seed)), list[int]()
    for _ in range(int(rng.integers(1, 7))):
        another = not stops or rng.random() < 0.4
        stops.append(int(rng.integers(arcs.joint.stops)) if another else stops[-1])
    durations = rng.uniform(-0.05, 0.4, len(stops) + 1)
    durations[int(rng.integers(durations.size))] = 0.0
    return ContactSequence(point.state, tuple(stops)), durations * arcs.period


def size(values: npt.NDArray[np.inexact[Any]]) -> float:
    """The largest of some numbers, without sign."""
    return float(np.abs(values).max(initial=0.0))


def events_of_the_march(arcs: JointArcs, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> FloatArray:
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


def assert_events_are_those_of_the_march(motion: March, arcs: JointArcs, point: SectionPoint) -> Chain:
    """Cut a march into arcs, and compare their end and their equations with it."""
    sequence, durations = cut(motion)
    chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations)
    assert chain.end_by is not None
    assert chain.events_by is not None
    n, rounding = chain.starts[0].size, 1e-14 * arcs.period  # of durations, as differences of times
    assert size(chain.times - motion.log.start) <= rounding
    shifted = rounding * size(chain.end_by[:, n:])
    assert size(chain.end - motion.end.y) <= 1e-12 * size(motion.end.y) + shifted
    misses = np.abs(chain.events - events_of_the_march(arcs, sequence, chain, durations))
    allowed = rounding * np.abs(chain.events_by[:, n:]).sum(axis=1)
    gaps = np.array([stop.gap for stop in arcs.problem.stops])[list(sequence.stops)]
    located = 1e-11 * gaps / np.where(sequence.returning, durations[:-1], 1.0)
    assert (misses <= located + allowed).all()  # a switch is located to 1e-13 of a unit of time
    return chain


@SOME
def test_arcs_that_last_as_in_a_march_end_where_it_ends_and_satisfy_every_equation(seeds: range) -> None:
    events = 0
    for seed in seeds:
        period_map, point = mapped(seed)
        chain = assert_events_are_those_of_the_march(marched(period_map, point, 1.0), period_map.arcs, point)
        events += chain.events.size
    assert events >= 2 * len(seeds)


def test_arcs_of_a_periodic_motion_come_back_to_its_start() -> None:
    for n_modes in (8, 20):
        solver = analytic.Solver(n_modes=n_modes)
        found = solver.steady_state(paper_joint(), errors=False)
        assert found.period_multiple == 1
        period_map = solver.period_map(paper_joint())
        motion = marched(period_map, found.section_point, 1.0)
        chain = assert_events_are_those_of_the_march(motion, period_map.arcs, found.section_point)
        assert chain.events.size >= 4
        assert size(chain.end - chain.starts[0]) <= 1e-10 * size(chain.end)  # to which it is found


@SOME
def test_derivatives_are_those_that_differences_give(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped(seed)
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        time = 0.3 * arcs.period
        chain = arcs.chain(sequence, start, time, durations)
        assert chain.end_by is not None
        assert chain.events_by is not None
        n, M = start.size, len(sequence.stops)
        fastest = max(period_map.joint.tables.fastest[period_map.joint.slot(state)] for state in sequence.states)
        steps = np.concatenate([size(start) / arcs.unit_norms(point.state), np.full(M + 1, 1e-4 / fastest)])
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
        period_map, point = mapped(seed)
        problem = period_map.problem
        path = AMPLITUDE if isinstance(problem.base_motion, BaseMotion) and seed % 4 == 1 else FREQUENCY
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        value, phase = getattr(problem.base_motion, path.split(".")[1]), 0.3
        chain = arcs.chain(sequence, start, phase * arcs.period, durations, number=path)
        assert chain.by_number is not None
        assert chain.end_by is not None
        assert chain.events_by is not None
        step, n, slopes = value * (1e-5 if path == FREQUENCY else 0.25), start.size, list[FloatArray]()
        grid = Grid(problem, (Axis(path, (value,)),))
        for h in (step, 2 * step):  # the motion is linear in the amplitude
            ends = []
            for number in (value + h, value - h):
                there = PeriodMap(Joint(grid.with_values((number,)), *period_map.joint.counts), "").arcs
                shares = durations / arcs.period
                its = there.chain(sequence, start, phase * there.period, shares * there.period, derivatives=False)
                ends.append(np.concatenate([its.end, its.events]))
            slopes.append((ends[0] - ends[1]) / (2 * h))
        found = (4 * slopes[0] - slopes[1]) / 3
        parts = (chain.end_by, slice(0, chain.end.size)), (chain.events_by, slice(chain.end.size, None))
        for by, part in parts:
            rounding = 1e-13 * size(np.abs(by[:, :n]) @ np.abs(start)) / step
            assert size((found - chain.by_number)[part]) <= 1e-6 * size(chain.by_number[part]) + rounding, seed
        assert arcs.chain(sequence, start, 0.0, durations, number="stops.*.gap").by_number is None


def test_mean_rates_of_exponentials_are_right_for_any_duration() -> None:
    rng = np.random.default_rng(109)
    with mp.workdps(60):
        for _ in range(200):
            root = complex(-(10 ** rng.uniform(-4, 1)), rng.choice([0.0, 10 ** rng.uniform(-4, 1)]))
            d = float(rng.choice([0.0, rng.choice([-1, 1]) * 10 ** rng.uniform(-14, 1)]))
            exact, x = mp.mpc(root), mp.mpc(root) * mp.mpf(d)
            mean, slope = exact, exact**2 / 2
            if d:
                mean = (mp.exp(x) - 1) / mp.mpf(d)
                slope = (exact * mp.exp(x) - mean) / mp.mpf(d)
            found, found_slope = mean_rate(root, d)
            most = max(1.0, math.exp(root.real * d))  # what a term comes to on the way
            assert abs(found - mean) <= 2e-15 * most * abs(root), (root, d)
            assert abs(found_slope - slope) <= 2e-15 * most * abs(root) ** 2, (root, d)


def quotient(coefficient: mp.mpc, rate: mp.mpc, d: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """The mean rate of the real part of an exponential over a duration, its derivative, and the size of the rate."""
    first, second = coefficient * rate, coefficient * rate**2 / 2
    if d:
        first = coefficient * (mp.exp(rate * d) - 1) / d
        second = (coefficient * rate * mp.exp(rate * d) - first) / d
    return first.real, second.real, abs(coefficient * rate)


def in_many_digits(
    arcs: JointArcs, slot: int, start: FloatArray, time: float, d: float, stop: int
) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """(h(end) - h(start)) / d of a stop at the top, its derivative by d, and the size of its terms."""
    tables = arcs.joint.tables
    n, u, total = int(tables.modes[slot]), int(tables.position[stop]), [mp.mpf(0)] * 3
    extra = n
    turns = [
        (mp.expj(angle), mp.mpf(w)) for angle, w in zip(tables.omega * time + tables.phase, tables.omega, strict=True)
    ]

    def add(weight: mp.mpc, coefficient: mp.mpc, rate: mp.mpc) -> None:
        total[:] = [it + one for it, one in zip(total, quotient(weight * coefficient, rate, mp.mpf(d)), strict=True)]

    for i in range(n):
        weight, root, static = (
            mp.mpmathify(it[slot][i]) for it in (tables.weight[:, u], tables.root, tables.static[..., 0])
        )
        x, y = start[i] - static, start[n + i] - mp.mpf(tables.static[slot, i, 1])
        for wave, (turn, omega) in zip(tables.harmonic[slot, :, i], turns, strict=True):
            x, y = x - (mp.mpc(wave) * turn).imag, y - omega * (mp.mpc(wave) * turn).real
        if tables.kind[slot, i] == OSCILLATING:
            add(weight, mp.mpc(x, -(y - root.real * x) / root.imag), root)
        elif tables.kind[slot, i] == SPLIT:
            other = mp.mpmathify(tables.root[slot, extra])
            extra += 1
            add(weight, (y - other * x) / (root - other), root)
            add(weight, (root * x - y) / (root - other), other)
        rigid = y if tables.kind[slot, i] == DRIFTING else 0
        drift = rigid + mp.mpf(tables.static[slot, i, 1]) + tables.static[slot, i, 2] * mp.mpf(d)
        total[0], total[2] = total[0] + weight * drift, total[2] + abs(weight * drift)
        total[1] += weight * tables.static[slot, i, 2]
    for wave, (turn, omega) in zip(tables.forced[slot, u], turns, strict=True):
        add(mp.mpc(0, -1), mp.mpc(wave) * turn, mp.mpc(0, omega))
    return total[0], total[1], total[2]


@SOME
def test_equations_of_short_contacts_lose_no_digits(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped(seed)
        arcs, rng = period_map.arcs, np.random.default_rng((110, seed))
        stop = int(rng.integers(arcs.joint.stops))
        sequence = ContactSequence(point.state, (stop, stop))
        for d in (0.0, *(sign * 10.0**-k for k in (3, 6, 9, 12) for sign in (1, -1))):
            durations = np.array([0.2, d, 0.1]) * arcs.period
            chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations)
            assert chain.events_by is not None
            slot = arcs.joint.slot(sequence.states[1])
            sign, begin = arcs.problem.stops[stop].sign, chain.starts[1]
            with mp.workdps(60):
                exact = in_many_digits(arcs, slot, begin, float(chain.times[1]), float(durations[1]), stop)
                value, slope, most = (float(it) for it in exact)
            fastest = arcs.joint.tables.fastest[slot]
            assert abs(chain.events[1] - sign * value) <= 1e-14 * most, (seed, d)
            assert abs(chain.events_by[1, chain.starts[0].size + 1] - sign * slope) <= 1e-14 * most * fastest, (seed, d)


@SOME
def test_arcs_go_on_from_any_of_their_moments_and_a_period_later_as_before(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped(seed)
        arcs, start = period_map.arcs, period_map.arcs.coordinates(point)
        sequence, durations = any_sequence(arcs, point, seed)
        durations = np.abs(durations)
        whole = arcs.chain(sequence, start, 0.0, durations, derivatives=False)
        later = arcs.chain(sequence, start, arcs.period, durations, derivatives=False)
        assert size(later.end - whole.end) <= 1e-11 * size(whole.end)
        i = len(sequence.stops) // 2
        state, part = sequence.states[i], 0.3 * durations[i]
        between = arcs.later(state, whole.starts[i], float(whole.times[i]), part)
        rest = ContactSequence(state, sequence.stops[i:])
        left = np.concatenate([[durations[i] - part], durations[i + 1 :]])
        end = arcs.chain(rest, between, float(whole.times[i]) + part, left, derivatives=False).end
        assert size(end - whole.end) <= 1e-12 * size(whole.end), seed
        back = arcs.later(state, between, float(whole.times[i]) + part, -1e-3 * arcs.period)
        again = arcs.later(state, back, float(whole.times[i]) + part - 1e-3 * arcs.period, 1e-3 * arcs.period)
        assert size(again - between) <= 1e-9 * size(between), seed


@SOME
def test_the_displacement_at_the_stops_is_that_of_the_march(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped(seed)
        motion, arcs = marched(period_map, point, 1.0), period_map.arcs
        sequence, durations = cut(motion)
        chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations, derivatives=False)
        _, first = np.unique([stop.x for stop in period_map.problem.stops], return_index=True)
        told, expected = arcs.motion(sequence, chain, durations), motion_at(outline_of(motion), first)
        for name, one, other in zip(told._fields, told, expected, strict=True):
            assert one.shape == other.shape, name
            assert size(one - other) <= 1e-10 * size(other), (seed, name)


def test_a_section_point_is_its_coordinates_and_units_have_their_norms() -> None:
    for seed in range(20):
        period_map, point = mapped(seed)
        assert isinstance(period_map, HasArcs)
        arcs = period_map.arcs
        again = arcs.point(point.state, arcs.coordinates(point))
        assert again.state == point.state
        assert np.array_equal(again.coordinates, point.coordinates)
        norms = [period_map.norm(unit) for unit in np.eye(point.coordinates.size)]
        assert np.allclose(arcs.unit_norms(point.state), norms, rtol=1e-15, atol=0)


def test_arcs_of_a_map_of_another_frequency_are_those_of_its_problem() -> None:
    period_map = analytic.Solver(n_modes=9).period_map(paper_joint())
    base = paper_joint().base_motion
    assert isinstance(base, BaseMotion)
    problem = paper_joint().replace(base_motion=base.model_copy(update={"angular_frequency": 300.0}))
    retuned = period_map.retuned("base_motion.angular_frequency", 300.0, lambda: problem)
    made = analytic.Solver(n_modes=9).period_map(problem)
    assert retuned is not None
    point = made.march(made.initial(), 8).end
    sequence, durations = any_sequence(made.arcs, point, 1)
    ends = [it.arcs.chain(sequence, made.arcs.coordinates(point), 0.0, durations).end for it in (made, retuned)]
    assert retuned.arcs.period == made.arcs.period
    assert size(ends[0] - ends[1]) <= 1e-13 * size(ends[0])
