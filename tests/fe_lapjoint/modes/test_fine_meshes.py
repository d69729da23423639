"""Low modes of fine meshes against the analytic solver's: they converge as far as rounding of curvatures lets them."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import ContactState, paper_joint
from lapjoint.problem import FloatArray

LOW, COARSE, FINE, ORDER = 4, 60, 300, 4
ROUNDED = 1e-11
"""Of the largest of a mode's displacements: what rounding leaves of 300 elements."""


def shapes_at_stops(solver: analytic.Solver | fe_lapjoint.Solver, state: ContactState) -> FloatArray:
    """The displacements of the low modes at the stops, without their signs, ``(LOW, P)``."""
    problem = paper_joint()
    x = np.array([stop.x for stop in problem.stops])
    shapes: FloatArray = np.abs(np.asarray(solver.modes(problem, state, LOW).shapes(x), dtype=float))
    return shapes


@pytest.mark.parametrize("closed", [(), (1,), (0, 2)])
def test_shapes_of_low_modes_converge_on_fine_meshes(closed: tuple[int, ...]) -> None:
    """With the fourth power of the mesh; rounding of the stiffness had mixed 2e-8 of others into the first mode."""
    state = ContactState(closed=closed)
    exact = shapes_at_stops(analytic.Solver(), state)
    coarse, fine = (
        np.abs(shapes_at_stops(fe_lapjoint.Solver(elements=n), state) - exact).max(axis=1) / exact.max()
        for n in (COARSE, FINE)
    )
    assert (fine <= 1.5 * coarse * (COARSE / FINE) ** ORDER + ROUNDED).all()


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("omega", "elements"),
    [*((omega, 464) for omega in (103.0, 300.0, 1000.0)), pytest.param(103.0, 1000, marks=pytest.mark.slow)],
)
def test_impulses_of_the_finest_meshes_converge(omega: float, elements: int) -> None:
    """Over two periods from rest, up to a thousand elements: they had been 1e-6 off there, and at best 1e-9."""
    problem = paper_joint(angular_frequency=omega, damping_ratio=0.02)

    def impulses(solver: analytic.Solver | fe_lapjoint.Solver) -> FloatArray:
        period_map = solver.period_map(problem)
        return np.asarray(period_map.march(period_map.initial(), 4).impulses)

    exact = impulses(analytic.Solver(n_modes=200))
    coarse, fine = (
        np.abs(impulses(fe_lapjoint.Solver(elements=n)) - exact).max() / np.abs(exact).max() for n in (91, elements)
    )
    assert fine <= 2 * coarse * (91 / elements) ** ORDER + ROUNDED
