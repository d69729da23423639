"""Modes of both solvers: their frequencies, norms and derivatives, and what closing a stop does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, LONG, UNIT
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import (
    FREE,
    BaseMotion,
    ContactState,
    InputError,
    ModalDamping,
    Problem,
    Stop,
    Support,
    contact_states,
    paper_joint,
)

SOLVERS: dict[str, AnySolver] = {"analytic": analytic.Solver(), "fe": fe_lapjoint.Solver(elements=40)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
SUPPORTS = {
    "free": (),
    "pinned": (Support(x=0.3, translational=math.inf),),
    "clamped in the middle": (Support(x=1.0, translational=math.inf, torsional=math.inf),),
    "nearly clamped in the middle": (Support(x=1.0, translational=1e12, torsional=1e12),),
    "on soft springs": (Support(x=0.0, translational=1.0), Support(x=2.0, translational=1.0)),
    "general (Figure 1)": (
        Support(x=0.0, translational=3e4, torsional=2e3),
        Support(x=0.7, translational=5e5, torsional=4e4),
        Support(x=2.0, translational=1e4, torsional=1e5),
    ),
}


@solvers
def test_modes_need_no_more_than_the_problem(solver: AnySolver) -> None:
    found = solver.modes(paper_joint())
    assert (found.state, found.angular_frequencies.size) == (FREE, 6)
    again = solver.modes(paper_joint(), FREE, 6)
    np.testing.assert_array_equal(found.angular_frequencies, again.angular_frequencies)


@pytest.mark.parametrize("name", SUPPORTS)
def test_both_solvers_have_the_same_frequencies_on_any_supports(name: str) -> None:
    problem = Problem(beam=LONG, supports=SUPPORTS[name])
    one, other = (solver.modes(problem, FREE, 6).angular_frequencies for solver in SOLVERS.values())
    assert np.array_equal(one == 0, other == 0)
    assert other == pytest.approx(one, rel=2e-5)  # (beta h)^4 / 1440 of the sixth mode


@solvers
@pytest.mark.parametrize("name", SUPPORTS)
def test_shapes_are_mass_normalised_and_orthogonal(name: str, solver: AnySolver) -> None:
    """(16) and (18)."""
    shapes = solver.modes(Problem(beam=LONG, supports=SUPPORTS[name]), FREE, 10).shapes
    node, weight = np.polynomial.legendre.leggauss(8)  # exact for products of two cubics, and more than enough here
    h = LONG.length / 40
    phi = shapes((h * np.arange(40)[:, None] + h * (node + 1) / 2).ravel())
    product = LONG.m * (phi * np.tile(weight * h / 2, 40)) @ phi.T
    assert product == pytest.approx(np.eye(10), abs=1e-9)  # clusters of frequencies hold nine digits


@solvers
def test_derivatives_of_shapes_agree_with_differences(solver: AnySolver) -> None:
    shapes = solver.modes(paper_joint(), ContactState((1,)), 10).shapes
    x, h = np.array([0.31, 1.01, 2.1]), 1e-5  # inside elements
    for d in (1, 2, 3):
        difference = (shapes(x + h, d - 1) - shapes(x - h, d - 1)) / (2 * h)
        scale = np.abs(shapes(x, d)).max(axis=1, keepdims=True)
        assert np.all(np.abs(difference - shapes(x, d)) < 1e-6 * scale)  # h^2 beta^2 / 6 at the tenth mode, rounding


@solvers
def test_frequencies_of_all_nine_states_interlace_the_free_ones(solver: AnySolver) -> None:
    """A stop that closes lowers no frequency, and lifts none above the next one: Rayleigh."""
    problem, rounding = paper_joint(k_star=5000.0), 1e-9
    free = solver.modes(problem, FREE, 12).angular_frequencies
    for state in contact_states(problem):
        omega = solver.modes(problem, state, 10).angular_frequencies
        assert np.all(omega >= free[:10] * (1 - rounding))
        assert np.all(omega <= free[len(state.closed) : 10 + len(state.closed)] * (1 + rounding))


@pytest.mark.parametrize(
    "solver", [analytic.Solver(), pytest.param(fe_lapjoint.Solver(elements=16), marks=pytest.mark.thorough)]
)
def test_sixteen_stops_of_65536_states_run(solver: AnySolver) -> None:
    """States are made as they are met, so that their number is no limit."""
    places = np.linspace(0.3, 1.0, 8)
    problem = Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=tuple(
            Stop(x=float(x), side=side, gap=1e-4 * x, stiffness=200.0) for x in places for side in ("top", "bottom")
        ),
        damping=ModalDamping(ratio=0.1),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=8.0),
    )
    with pytest.raises(InputError, match="contact states"):
        contact_states(problem)
    history = solver.simulate(problem, 3 * 2 * math.pi / 8.0)
    assert {contact.stop for contact in history.contacts} == set(range(16))
    assert 8 < len(set(history.states)) < 400
