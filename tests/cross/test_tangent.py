"""The derivative of a march is that of the march as it is, however coarse it is: judged by differences.

With few modes what a switch leaves out is large.  A derivative that holds only for all modes is off by a thousandth
then, while a motion that converges to a periodic one shows nothing of it.  With many modes the fast ones die out, and
are not carried on; the derivative must hold for them, too.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from population import harmonic_joint, joint, stiffened_joint
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import ModalDamping, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.exponent import exponent_of
from lapjoint.problem import FloatArray

STEP = 1e-6
"""Difference of two starts over the size of the motion."""
SMOOTH = 1e-3
"""Most by which the differences ahead and back may differ, over their size: else a stop is grazed between."""
LEFT = 1e-5
"""Most by which the derivative may differ from them, over its size."""
KINDS = {"as they are": joint, "stiffer": stiffened_joint, "harmonics": harmonic_joint}


def with_few_modes(kind: str, seed: int) -> tuple[PeriodMap, SectionPoint]:
    """A joint with few modes, and a motion of it."""
    rng = np.random.default_rng((93, seed))
    period_map = analytic.Solver(n_modes=int(rng.integers(5, 25))).period_map(KINDS[kind](93, seed))
    return period_map, period_map.march(period_map.initial(), 2 * int(rng.integers(1, 12))).end


def with_many_modes(kind: str, seed: int) -> tuple[PeriodMap, SectionPoint]:
    """The paper's joint with light damping and many modes, and a motion of it."""
    rng = np.random.default_rng((91, seed))
    frequency = math.exp(rng.uniform(math.log(80.0), math.log(400.0)))
    problem = paper_joint(angular_frequency=frequency).replace(damping=ModalDamping(ratio=rng.uniform(0.015, 0.1)))
    period_map = analytic.Solver(n_modes=int(rng.integers(40, 90))).period_map(problem)
    return period_map, period_map.march(period_map.initial(), 2 * int(rng.integers(5, 30))).end


def with_few_elements(kind: str, seed: int) -> tuple[PeriodMap, SectionPoint]:
    """A joint with few elements, and a motion of it."""
    rng = np.random.default_rng((93, seed))
    period_map = fe_lapjoint.Solver(elements=int(rng.integers(2, 6))).period_map(KINDS[kind](93, seed))
    return period_map, period_map.march(period_map.initial(), 2 * int(rng.integers(1, 8))).end


def is_off(period_map: PeriodMap, ahead: FloatArray, back: FloatArray, derivative: FloatArray) -> float | None:
    """How far a derivative is from two one-sided differences, over its size; None where they differ themselves."""
    size = period_map.norm(derivative)
    if period_map.norm(ahead - back) > SMOOTH * size:
        return None
    return period_map.norm((ahead + back) / 2 - derivative) / size


@pytest.mark.parametrize(
    ("drawn", "kind", "count"),
    [
        (with_few_modes, "as they are", 40),
        *(pytest.param(with_few_modes, kind, 40, marks=pytest.mark.thorough) for kind in ("stiffer", "harmonics")),
        (with_many_modes, "lightly damped", 12),
        *((with_few_elements, kind, 12) for kind in KINDS),
    ],
)
def test_marches_from_starts_beside_end_as_the_derivative_says(drawn: object, kind: str, count: int) -> None:
    told, with_contacts = 0, 0
    for seed in range(count):
        period_map, point = drawn(kind, seed)  # type: ignore[operator]
        found, rng = period_map.linearised(point, 2), np.random.default_rng((94, seed))
        units = np.array([1 / period_map.norm(unit) for unit in np.eye(period_map.difference(point, point).size)])
        here, size = period_map.march(point, 2), period_map.size(point)
        for _ in range(3):
            deviation = rng.standard_normal(units.size)
            way = STEP * size * deviation * units / np.linalg.norm(deviation)
            ends = [here.end, *(period_map.march(period_map.moved(point, sign * way), 2).end for sign in (1, -1))]
            now, ahead, back = (period_map.difference(end, point) for end in ends)
            off = is_off(period_map, ahead - now, now - back, found.matrix @ way)
            assert off is None or off <= LEFT, (seed, off)
            told += off is not None
        unit = way / period_map.norm(way)
        followed = period_map.followed(point, unit, 1)
        if followed.points[0].state == point.state:  # so that both are in its coordinates
            grown = math.exp(followed.growth[0]) * followed.deviation
            assert period_map.norm(grown - found.matrix @ unit) <= 1e-8 * period_map.norm(grown)
        with_contacts += here.switches > 0
    assert told >= 1.5 * count  # half of the deviations, or the test judges too little
    assert with_contacts >= count / 2  # half of the motions


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=3)])
# of one stop: the symmetric joint has a map over half periods
@pytest.mark.parametrize("gap", [1e-3, pytest.param(2e-3, marks=pytest.mark.thorough)])
def test_on_an_orbit_the_exponent_and_differences_are_those_of_its_multipliers(solver: AnySolver, gap: float) -> None:
    problem = paper_joint(angular_frequency=515.0)
    first = problem.stops[0].model_copy(update={"gap": gap})
    problem = problem.replace(stops=(first, *problem.stops[1:]))
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    assert steady.symmetric == (gap == 1e-3)
    point = steady.section_point
    units = np.eye(period_map.difference(point, point).size)
    steps = [unit * 1e-5 * period_map.size(point) / period_map.norm(unit) for unit in units]
    ends = [[period_map.march(period_map.moved(point, sign * by), 2).end for sign in (1, -1)] for by in steps]
    columns = [period_map.difference(*both) / (2 * np.abs(by).max()) for both, by in zip(ends, steps, strict=True)]
    moduli = np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))[::-1]
    # The errors of the differences weigh on the small ones.
    assert np.abs(steady.multipliers[:4]) == pytest.approx(moduli[:4], abs=1e-4)
    start = np.random.default_rng(0).normal(size=units.shape[0])
    followed = period_map.followed(point, start / period_map.norm(start), 400)
    exponent = exponent_of(followed.growth[20:], period_map.period)
    assert exponent.value == pytest.approx(math.log(abs(steady.multipliers[0])) / period_map.period, rel=1e-2)
    assert exponent.negative
