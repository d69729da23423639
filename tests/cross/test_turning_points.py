"""Turning points just beyond the switches of a motion, which show that a switch is about to vanish."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, derivatives_of, same_turning_point, turning_points
from lapjoint.orbits.half_periods import Return
from lapjoint.orbits.segments import Segment
from lapjoint.problem import FloatArray

LOW, HIGH = 4.0, 100.0  # rad/s
SOLVERS = {"analytic": analytic.Solver(n_modes=12), "finite elements": fe_lapjoint.Solver(elements=12)}


def drawn(name: str, seed: int) -> tuple[Family, Return]:
    """A march of the paper's joint, from a transient at a random frequency: switches of any speed."""
    rng, grid = np.random.default_rng((29, seed)), Grid(paper_joint(), (Axis(FREQUENCY, (LOW, HIGH)),))
    family = Family(SOLVERS[name], lambda value: grid.with_values((value,)), FREQUENCY, LOW, HIGH)
    value = float(np.exp(rng.uniform(np.log(LOW), np.log(HIGH))))
    map_ = family.at(value).map
    return family, family.linearised(value, map_.march(map_.initial(), 2 * int(rng.integers(1, 9))).end, 2)


def course(segment: Segment, at: int, t: FloatArray) -> FloatArray:
    """Displacement at a stop as the state of a segment has it, also after its end, m."""
    tau, wave = t - segment.start, segment.weights[at] * segment.amplitudes
    powers = np.stack([tau**0, tau, tau**2], axis=1)
    return np.asarray((np.exp(np.outer(tau, segment.rates)) @ wave).real + powers @ segment.polynomial[at])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", SOLVERS)
def test_a_turning_point_is_where_the_state_before_the_switch_would_turn(name: str, seed: int) -> None:
    _, found = drawn(name, seed)
    segments, stops = found.linearised.segments, found.half_periods.map.problem.stops
    there = turning_points(found)
    for i, one in enumerate(segments):
        mine = [point for point in there if point.segment == i]
        assert len(mine) <= 1
        if one.switched < 0:
            assert not mine
            continue
        stop, length = stops[one.switched], one.end - one.start
        t = one.end + np.linspace(0.0, 0.5, 4001) * length
        h = stop.sign * course(one, one.switched, t) - stop.gap
        h = -h if one.closed[one.switched] else h  # it rises at the switch
        turns = np.flatnonzero((h[1:-1] >= h[:-2]) & (h[1:-1] > h[2:])) + 1
        if mine:
            assert turns.size
            assert mine[0].time == pytest.approx(t[turns[0]], abs=1.01 * (t[1] - t[0]))
            begins = (-1 if one.closed[one.switched] else 1) * (
                stop.sign * course(one, one.switched, np.array([one.start])) - stop.gap
            )
            own = -mine[0].value if one.closed[one.switched] else mine[0].value
            assert own == pytest.approx(h[turns[0]] - max(begins.item(), 0.0), abs=1e-4 * np.ptp(h))
            assert own > 0
        elif turns.size:  # one that lies so far beyond that Newton's method does not come to it
            assert t[turns[0]] - one.end > 0.05 * length


@pytest.mark.parametrize("name", SOLVERS)
def test_a_turning_point_changes_as_its_derivatives_say_whether_the_switch_comes_first_or_not(name: str) -> None:
    """A start is moved so that a turning point comes to zero and beyond, where the motion does not switch any more."""
    checked = 0
    for seed in range(150):
        family, found = drawn(name, seed)
        half, value = found.half_periods, 2 * np.pi / found.half_periods.map.period
        duration = found.count * half.map.period / 2
        for one in turning_points(found):
            row, slope = derivatives_of(found, one)
            unit = half.unit_norms(row.size)
            way = row / unit**2 / np.sum((row / unit) ** 2)  # the shortest that changes it by one metre
            if half.map.norm(way * one.value) > 1e-3 * half.size(found.start) or abs(one.value) > 2e-7:
                continue
            checked += 1
            for share in (0.5, 1.5):
                point = half.map.moved(found.start, -share * one.value * way)
                beside = family.linearised(value, point, found.count)
                there = same_turning_point(beside, one, duration)
                assert there is not None
                assert there.value == pytest.approx((1 - share) * one.value, abs=0.1 * abs(one.value))
                assert comes_first(beside, there) == (share < 1)
            assert (slope is None) == (found.by_number is None)
            if slope is not None:
                step = min(0.3 * abs(one.value / slope), 1e-6 * value)
                other = family.linearised(value + step, family.adopted(value + step, found.start), found.count)
                there = same_turning_point(other, one, duration)
                assert there is not None
                assert there.value - one.value == pytest.approx(slope * step, rel=0.1)
    assert checked


def comes_first(found: Return, point: Extremum) -> bool:
    """Whether a motion switches before it comes to a turning point."""
    assert point.segment is not None
    one = found.linearised.segments[point.segment]
    return one.switched == point.at and point.time > one.end


def test_a_turning_point_far_from_one_in_phase_is_not_it() -> None:
    _, found = drawn("analytic", 0)
    (first, *_) = turning_points(found)
    duration = found.count * found.half_periods.map.period / 2
    again = same_turning_point(found, first, duration)
    assert again is not None
    assert again.segment == first.segment
    assert again.time == pytest.approx(first.time)
    moved = same_turning_point(found, replace(first, time=first.time + 0.5 * duration), duration)
    assert moved is None or moved.time != pytest.approx(first.time)
