"""Where fast modes have died out, units of the others are carried on: nothing is lost that rounding leaves.

Each derivative is judged by marches from starts that are a little apart, and by one that carries all columns all the
way.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.march import march_linearised
from analytic.march.coordinates import Coordinates
from analytic.period_map import PeriodMap
from lapjoint import ModalDamping, Problem, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import FREQUENCY
from lapjoint.orbits.period_map import Linearised

SETTLED, MODES = 30, (40, 90)
STEP = 1e-6
"""Difference of two starts, over the size of the motion."""
ALIKE, SLOW = 1e-12, 8
"""What rounding may leave of the largest entry of a column, and of how many modes: of others nothing may be left."""


def drawn(seed: int) -> tuple[PeriodMap, SectionPoint, int]:
    """A lightly damped joint with many modes, a motion of it, and for how many half periods it is marched."""
    rng = np.random.default_rng((91, seed))
    frequency = math.exp(rng.uniform(math.log(80.0), math.log(400.0)))
    problem = paper_joint(angular_frequency=frequency).replace(damping=ModalDamping(ratio=rng.uniform(0.015, 0.1)))
    period_map = analytic.Solver(n_modes=int(rng.integers(*MODES))).period_map(problem)
    point = period_map.march(period_map.initial(), 2 * int(rng.integers(5, SETTLED))).end
    return period_map, point, int(rng.integers(2, 9))


def known(period_map: PeriodMap, point: SectionPoint, half_periods: int) -> Linearised:
    found = period_map.linearised_by(FREQUENCY, point, half_periods)
    assert found is not None
    return found


def scaled(period_map: PeriodMap, matrix: np.ndarray) -> np.ndarray:
    """A derivative whose velocities are displacements times the frequency of the excitation."""
    norms = period_map.unit_norms(matrix.shape[0])
    return matrix * norms[:, None] / norms


@pytest.mark.parametrize("seed", range(12))
def test_the_derivative_is_that_with_all_columns(seed: int) -> None:
    period_map, point, half_periods = drawn(seed)
    found = known(period_map, point, half_periods)
    begin = Coordinates(point.state, *point.coordinates)
    duration = half_periods * period_map.period / 2
    end, whole = march_linearised(period_map.joint, begin, duration, np.eye(point.coordinates.size))
    if end.state != point.state:
        S, n = period_map.joint.passage(end.state, point.state).S, whole.shape[0] // 2
        whole = np.concatenate([S @ whole[:n], S @ whole[n:]])
    whole, own = scaled(period_map, whole), scaled(period_map, found.matrix)
    assert np.abs(own - whole).max() <= ALIKE * np.abs(whole).max()
    slow = [j for j in range(whole.shape[0]) if j % (whole.shape[0] // 2) < SLOW]
    assert (np.abs(own - whole)[:, slow].max(axis=0) <= ALIKE * np.abs(whole[:, slow]).max(axis=0)).all()
    factors = found.known.factors
    assert factors is not None
    assert factors[0].shape[1] < whole.shape[0]
    assert scaled(period_map, factors[0] @ factors[1]) == pytest.approx(own, abs=ALIKE * np.abs(own).max())
    dense = np.linalg.eigvals(whole)
    largest = np.abs(dense).max()
    for one in found.multipliers[np.abs(found.multipliers) > 1e-3 * largest]:  # the whole matrix has others worse
        assert np.abs(dense - one).min() <= 1e-7 * largest


@pytest.mark.parametrize("seed", range(12))
def test_marches_from_starts_a_little_apart_end_as_it_says(seed: int) -> None:
    """Deviations of all modes alike, the fastest too, and of the slowest alone."""
    period_map, point, _ = drawn(seed)
    found, rng = known(period_map, point, 2), np.random.default_rng((92, seed))
    units = 1 / period_map.unit_norms(point.coordinates.size)
    for n in (point.coordinates.size // 2, 4):
        deviation = np.zeros((2, point.coordinates.shape[1]))
        deviation[:, :n] = rng.standard_normal((2, n))
        way = STEP * period_map.size(point) * deviation.ravel() * units / np.linalg.norm(deviation)
        ends = [period_map.march(period_map.moved(point, sign * way), 2) for sign in (1, -1)]
        assert ends[0].switches == ends[1].switches
        change = period_map.difference(ends[0].end, point) - period_map.difference(ends[1].end, point)
        expected = 2 * found.matrix @ way
        assert period_map.norm(change - expected) <= 1e-5 * period_map.norm(expected) + 1e-9 * period_map.norm(way)


@pytest.mark.parametrize("seed", range(12))
def test_the_derivative_by_the_frequency_is_that_of_marches_beside(seed: int) -> None:
    """A forced motion changes in all modes, those too whose free motion has died out."""
    period_map, point, half_periods = drawn(seed)
    found = known(period_map, point, half_periods)
    assert found.by_number is not None
    frequency = period_map.problem.require_excitation_frequency("test")
    step, ends = 1e-6 * frequency, []
    for there in (frequency + step, frequency - step):
        problem: Problem = paper_joint(angular_frequency=there).replace(damping=period_map.problem.damping)
        solver = analytic.Solver(n_modes=point.coordinates.shape[1])
        beside = solver.period_map(problem)
        ends.append(beside.march(beside.adopted(point), half_periods).end)
    change = (period_map.difference(ends[0], point) - period_map.difference(ends[1], point)) / (2 * step)
    assert period_map.norm(change - found.by_number) <= 1e-6 * period_map.norm(found.by_number)
