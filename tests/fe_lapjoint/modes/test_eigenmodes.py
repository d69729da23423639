"""Frequencies of Hermite elements against the textbook characteristic equations of a uniform beam."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

import fe_lapjoint
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import FREE, Beam, ContactState, Problem, Support, paper_joint
from lapjoint.answers.observed_order import fitted_order

LENGTH, EI, MASS = 2.5, 6.4e5, 118.0  # m, N m2, kg/m
PINNED = {"translational": math.inf}
CLAMPED = {"translational": math.inf, "torsional": math.inf}
Equation = Callable[[float], float]


def beam_on(*supports: Support) -> Problem:
    return Problem(beam=Beam(length=LENGTH, bending_stiffness=EI, mass_per_length=MASS), supports=supports)


def frequencies(equation: Equation, centres: list[float]) -> np.ndarray:
    """Angular frequencies from the roots beta L of a characteristic equation, one near each of `centres`."""
    roots = [brentq(equation, c - 0.4, c + 0.4, xtol=1e-15, rtol=1e-15) for c in centres]
    return np.array(roots) ** 2 * math.sqrt(EI / MASS) / LENGTH**2


HALF = [(i + 0.5) * math.pi for i in range(9)]
CASES = {
    "cantilever": (
        beam_on(Support(x=0.0, **CLAMPED)),
        frequencies(lambda b: math.cos(b) + 1 / math.cosh(b), [1.875, *HALF[1:8]]),
    ),
    "pinned at both ends": (
        beam_on(Support(x=0.0, **PINNED), Support(x=LENGTH, **PINNED)),
        frequencies(math.sin, [i * math.pi for i in range(1, 9)]),
    ),
    "clamped at both ends": (
        beam_on(Support(x=0.0, **CLAMPED), Support(x=LENGTH, **CLAMPED)),
        frequencies(lambda b: math.cos(b) - 1 / math.cosh(b), HALF[1:9]),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_frequencies_converge_at_order_four(name: str) -> None:
    problem, exact = CASES[name]
    meshes = np.array([16, 24, 32, 48])
    found = [fe_lapjoint.Solver(elements=int(n)).modes(problem, FREE, 8).angular_frequencies for n in meshes]
    errors = np.array(found) / exact - 1
    # The first two modes reach the round-off floor of 1e-9 on these meshes; the rate of the others is clean.
    for mode in range(2, 5):
        assert 3.9 < fitted_order(meshes, errors[:, mode]) < 4.1


@pytest.mark.parametrize("name", CASES)
def test_frequencies_agree_with_the_textbook_on_a_fine_mesh(name: str) -> None:
    problem, exact = CASES[name]
    found = fe_lapjoint.Solver(elements=128).modes(problem, FREE, 8).angular_frequencies
    assert found[0] == pytest.approx(exact[0], rel=1e-8)  # the accuracy that the project asks for
    assert found == pytest.approx(exact, rel=2e-6)  # discretisation: (beta h)^4 / 720 of the eighth mode


def test_a_graded_mesh_of_the_users_own_gives_the_same_frequencies() -> None:
    problem, exact = CASES["cantilever"]
    nodes = tuple(LENGTH * np.linspace(0, 1, 41) ** 1.2)
    found = fe_lapjoint.Solver(nodes=nodes).modes(problem, FREE, 3).angular_frequencies
    assert found == pytest.approx(exact[:3], rel=1e-5)  # discretisation


@pytest.mark.parametrize("elements", [40, 200])
def test_modes_of_any_two_states_map_onto_each_other_without_loss(elements: int) -> None:
    problem = paper_joint()
    assembly = Assembly(problem, mesh_nodes(problem, elements, None))
    old, new = (eigenmodes(assembly, state)[1] for state in (FREE, ContactState((0, 1))))
    transfer = new.T @ assembly.mass @ old
    assert transfer.T @ transfer == pytest.approx(np.eye(old.shape[1]), abs=1e-12)  # rounding


def test_refining_splits_the_elements_of_given_nodes() -> None:
    solver = fe_lapjoint.Solver(nodes=(0.0, 0.1, 0.5, 2.5))
    assert solver.refined(2).nodes == pytest.approx((0.0, 0.05, 0.1, 0.3, 0.5, 1.5, 2.5))
    assert solver.refined(1).nodes == solver.nodes
    assert fe_lapjoint.Solver(elements=10).refined(1.5).elements == 15
    problem = paper_joint()
    coarse, fine = (s.modes(problem, FREE, 3).angular_frequencies for s in (solver, solver.refined(4)))
    assert np.all(fine < coarse)
