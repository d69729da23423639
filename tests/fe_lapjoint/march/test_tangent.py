"""How deviations travel along the finite element motion: monodromy, multipliers, exponents."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fe_lapjoint.certificate import read_section
from fe_lapjoint.exponent import Growth
from fe_lapjoint.turns import Point, Turns

import fe_lapjoint
from fe_lapjoint.answers import begin
from fe_lapjoint.march.march import march
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.tangent import monodromy
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import ModalDamping, Problem, SteadyState, ViscousDamping, paper_joint

OMEGA = 515.0
PERIOD = 2 * math.pi / OMEGA


def model_of(problem: Problem, elements: int) -> Model:
    return Model(problem, Assembly(problem, mesh_nodes(problem, elements, None)), "exact", 1e-9, 1e-12)


def orbit_of(problem: Problem, elements: int) -> tuple[Model, SteadyState, Point]:
    steady = fe_lapjoint.Solver(elements=elements).steady_state(problem)
    model = model_of(problem, elements)
    return model, steady, read_section(model, steady.section)


@pytest.mark.parametrize("damping", [ModalDamping(ratio=(0.08, 0.02)), ViscousDamping(coefficient=2000.0)])
def test_volume_shrinks_as_the_damping_says(damping: ModalDamping | ViscousDamping) -> None:
    """The determinant of the monodromy is exp(-integral of the trace of the damping); switches lose nothing."""
    model, steady, point = orbit_of(paper_joint(angular_frequency=OMEGA).replace(damping=damping), 4)
    motion = march(model, point.state, point.y, 0.0, PERIOD)
    assert steady.history.contacts
    trace = sum(2 * float(np.sum(model.system(p.state).decay)) * (p.end - p.start) for p in motion.pieces)
    assert np.linalg.slogdet(monodromy(model, motion))[1] == pytest.approx(-trace, rel=1e-6)


@pytest.mark.parametrize("gap", [1e-3, 2e-3])  # of one stop: the symmetric joint takes half turns, the other does not
def test_multipliers_are_those_of_a_monodromy_by_finite_differences(gap: float) -> None:
    problem = paper_joint(angular_frequency=OMEGA)
    first = problem.stops[0].model_copy(update={"gap": gap})
    model, steady, point = orbit_of(problem.replace(stops=(first, *problem.stops[1:])), 3)
    assert steady.symmetric == (gap == 1e-3)
    n, columns = point.y.size // 2, []
    for i in range(2 * n):
        step = np.zeros(2 * n)
        step[i] = 1e-5 * np.linalg.norm(np.split(point.y, 2)[i // n])
        plus, minus = (march(model, point.state, point.y + sign * step, 0.0, PERIOD).y for sign in (1, -1))
        columns.append((plus - minus) / (2 * step[i]))
    moduli = np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))[::-1]
    # The errors of the differences weigh on the small ones.
    assert steady.multipliers[:4] == pytest.approx(moduli[:4], abs=1e-4)


def test_the_exponent_on_an_orbit_is_that_of_its_largest_multiplier() -> None:
    model, steady, point = orbit_of(paper_joint(angular_frequency=OMEGA), 3)
    turns = Turns(model, OMEGA)
    growth, turned = Growth(turns), turns.after(point)
    while not growth.enough:
        growth.add(turned)  # the same turn again and again
    assert growth.exponent.periods == len(growth.logs)
    assert growth.exponent.value == pytest.approx(math.log(steady.multipliers[0]) / PERIOD, rel=1e-2)
    assert growth.exponent.negative


def test_nearby_chaotic_motions_part_as_the_tangent_says() -> None:
    """The ratio of two motions' distance before and after against the tangent vector that links them."""
    problem = paper_joint(angular_frequency=380.0, damping_ratio=0.02)
    model, first = begin(fe_lapjoint.Solver(elements=2), problem)
    turns = Turns(model, 380.0)
    point = turns.after(first, 40).end
    step = 1e-8 * np.random.default_rng(1).normal(size=first.y.size) * np.abs(point.y).max()
    for _ in range(6):
        turned = turns.after(point)
        near = turns.after(Point(point.state, point.y + step)).end
        expected = turns.carried(turned, step[:, None])[:, 0]
        apart = turns.seen_from(turned.end.state, near) - turned.end.y
        assert turns.size(apart - expected) <= 1e-2 * turns.size(apart)
        point, step = turned.end, 1e-8 * turns.size(turned.end.y) / turns.size(expected) * expected
