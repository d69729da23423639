"""How deviations travel along the finite element motion: monodromy, multipliers, exponents."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fe_lapjoint
from fe_lapjoint.march import tangent
from fe_lapjoint.march.march import march
from fe_lapjoint.march.tangent import Carried
from fe_lapjoint.period_map import PeriodMap
from lapjoint import ModalDamping, ViscousDamping, paper_joint
from lapjoint.orbits.exponent import exponent_of

OMEGA = 515.0
PERIOD = 2 * math.pi / OMEGA


@pytest.mark.parametrize("damping", [ModalDamping(ratio=(0.08, 0.02)), ViscousDamping(coefficient=2000.0)])
def test_volume_shrinks_as_the_damping_says(damping: ModalDamping | ViscousDamping) -> None:
    """The determinant of the monodromy is exp(-integral of the trace of the damping); switches lose nothing."""
    solver, problem = fe_lapjoint.Solver(elements=4), paper_joint(angular_frequency=OMEGA).replace(damping=damping)
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    model, point = period_map.model, steady.section_point
    motion = march(model, point.state, period_map.modal(point), 0.0, PERIOD)
    assert steady.history.contacts
    trace = sum(2 * float(np.sum(model.system(p.state).damping_rate)) * (p.end - p.start) for p in motion.pieces)
    monodromy = Carried(model, motion, np.eye(motion.y.size)).end
    assert np.linalg.slogdet(monodromy)[1] == pytest.approx(-trace, rel=1e-6)


@pytest.mark.parametrize(("elements", "periods", "ratio"), [(16, 1, 0.08), (24, 3, 0.02), (60, 1, 0.02)])
def test_what_fast_modes_leave_out_of_the_monodromy_is_below_rounding(
    elements: int, periods: int, ratio: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no mode is taken to have died out, all deviations are carried with all their coordinates."""
    problem = paper_joint(angular_frequency=100.0, damping_ratio=ratio)
    period_map = fe_lapjoint.Solver(elements=elements).period_map(problem)
    model, point = period_map.model, period_map.march(period_map.initial(), 40).end
    motion = march(model, point.state, period_map.modal(point), 0.0, periods * 2 * math.pi / 100.0)
    n = motion.y.size // 2
    columns, rest = Carried(model, motion, np.eye(2 * n)).combinations
    assert rest is not None
    assert columns.shape[1] <= n  # half of the coordinates
    together = columns @ rest
    monkeypatch.setattr(tangent, "DEAD", math.inf)
    all_modes = Carried(model, motion, np.eye(2 * n))
    assert all_modes.combinations[1] is None
    alone = all_modes.end
    monkeypatch.undo()
    size = np.repeat([100.0, 1.0], n)  # a velocity is compared with a displacement times the excitation's frequency
    known = period_map.linearised(point, 2 * periods)
    dense = np.linalg.eigvals(known.matrix)
    largest = np.abs(dense).max()
    for one in known.multipliers:  # small ones are worse known by the whole matrix
        assert np.abs(dense - one).min() <= 1e-8 * largest
    apart, whole = ((one * size[:, None]) / size for one in (together - alone, alone))
    assert np.abs(apart).max() <= 1e-13 * np.abs(whole).max()


def moved_along(period_map: PeriodMap, steps: np.ndarray) -> np.ndarray:
    """Central differences of the map over a period at the section point of the steady state, ``(n, n)``."""
    point = fe_lapjoint.Solver(elements=3).steady_state(period_map.problem).section_point
    columns = []
    for i, step in enumerate(steps):
        by = np.eye(steps.size)[i] * step
        ends = [period_map.march(period_map.moved(point, sign * by), 2).end for sign in (1, -1)]
        columns.append(period_map.difference(*ends) / (2 * step))
    return np.array(columns).T


@pytest.mark.parametrize("gap", [1e-3, 2e-3])  # of one stop: the symmetric joint has a map over half periods
def test_multipliers_are_those_of_a_monodromy_by_finite_differences(gap: float) -> None:
    problem = paper_joint(angular_frequency=OMEGA)
    first = problem.stops[0].model_copy(update={"gap": gap})
    problem = problem.replace(stops=(first, *problem.stops[1:]))
    solver = fe_lapjoint.Solver(elements=3)
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    assert steady.symmetric == (gap == 1e-3)
    n = period_map.difference(steady.section_point, steady.section_point).size // 2
    size = period_map.size(steady.section_point)
    differences = moved_along(period_map, np.repeat([1e-5 * size, 1e-5 * size * OMEGA], n))
    moduli = np.sort(np.abs(np.linalg.eigvals(differences)))[::-1]
    # The errors of the differences weigh on the small ones.
    assert np.abs(steady.multipliers[:4]) == pytest.approx(moduli[:4], abs=1e-4)


def test_the_exponent_on_an_orbit_is_that_of_its_largest_multiplier() -> None:
    solver, problem = fe_lapjoint.Solver(elements=3), paper_joint(angular_frequency=OMEGA)
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    start = np.random.default_rng(0).normal(size=period_map.difference(steady.section_point, steady.section_point).size)
    followed = period_map.followed(steady.section_point, start / period_map.norm(start), 400)
    exponent = exponent_of(followed.growth[20:], period_map.period)
    assert exponent.value == pytest.approx(math.log(abs(steady.multipliers[0])) / PERIOD, rel=1e-2)
    assert exponent.negative


def test_nearby_chaotic_motions_part_as_the_tangent_says() -> None:
    """The ratio of two motions' distance before and after against the tangent vector that links them."""
    problem = paper_joint(angular_frequency=380.0, damping_ratio=0.02)
    period_map = fe_lapjoint.Solver(elements=2).period_map(problem)
    point = period_map.march(period_map.initial(), 40).end
    unit = np.random.default_rng(1).normal(size=period_map.difference(point, point).size)
    unit /= period_map.norm(unit)
    for _ in range(6):
        followed, length = period_map.followed(point, unit, 1), 1e-8 * period_map.size(point)
        near = period_map.march(period_map.moved(point, length * unit), 2).end
        expected = length * math.exp(followed.growth[0]) * followed.deviation
        apart = period_map.difference(near, followed.points[0])
        assert period_map.norm(apart - expected) <= 1e-2 * period_map.norm(apart)
        point, unit = followed.points[0], followed.deviation
