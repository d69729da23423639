"""A bar that is all but rigid on its springs is one degree of freedom, and costs no more than that.

The witness is the rigid bar of `validation.references`, which numpy marches alone.  A bar bends by at most 1e-8 of what
it moves, k L^3 / 48 EI.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import fe_lapjoint
from fe_lapjoint.march.field import ElementField
from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support, make_solver
from lapjoint.problem import FloatArray
from lapjoint.problem.files import to_toml
from validation.references.rigid_bar import RigidBar

PERIODS = 4
BENT = 1e-6
"""Relative: a hundred times what bending changes, for what contacts make of it."""


def bar(seed: int) -> Problem:
    """A random bar of EI / L^3 from 1e14 to 1e18 N/m beside springs and a stop at its middle of 1e4 to 1e7 N/m."""
    rng = np.random.default_rng([45, seed])
    k, stop = 10 ** rng.uniform(4, 7, 2)
    m, omega = 10 ** rng.uniform(-1, 1), rng.uniform(0.3, 3)
    frequency = omega * math.sqrt(2 * k / m)
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=10 ** rng.uniform(14, 18), mass_per_length=m),
        supports=tuple(Support(x=x, translational=k, torsional=0.0) for x in (0.0, 1.0)),
        stops=(Stop(x=0.5, side=rng.choice(["top", "bottom"]), gap=10 ** rng.uniform(-5, -3), stiffness=stop),),
        damping=ModalDamping(ratio=rng.uniform(0.02, 0.2)),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=frequency),
    )


def rigid_contacts(problem: Problem, duration: float) -> FloatArray:
    """Start, s, duration, s, and impulse, N s, of the contacts of the rigid bar that end in time, shape ``(n, 3)``."""
    contacts = RigidBar.from_toml(to_toml(problem)).march(duration).contacts
    return np.array([(c.start, c.end - c.start, c.impulse) for c in contacts if c.end < duration]).reshape(-1, 3)


def compare(seed: int, solver: str) -> None:
    """Compare the contacts of one bar."""
    problem = bar(seed)
    assert problem.excitation_frequency is not None
    duration = PERIODS * 2 * math.pi / problem.excitation_frequency
    exact = rigid_contacts(problem, duration)
    history = make_solver(solver).simulate(problem, duration, errors=False)
    contacts = np.array([(c.start, c.end - c.start, c.impulse) for c in history.contacts if not c.open_end])
    contacts = contacts.reshape(-1, 3)
    assert contacts.shape == exact.shape, seed
    if exact.size:
        scales = duration, duration, np.abs(exact[:, 2]).max()
        assert np.abs((contacts - exact) / scales).max() < BENT, seed


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("solver", [pytest.param("analytic", marks=pytest.mark.thorough), "fe"])
def test_a_rigid_bar_moves_as_one_degree_of_freedom(solver: str, seed: int) -> None:
    compare(seed, solver)


@pytest.mark.slow
def test_two_hundred_rigid_bars_move_as_one_degree_of_freedom() -> None:
    for seed in range(200):
        compare(seed, "fe")


@pytest.mark.parametrize("EI", [1e8, 1e13, 1e18])
def test_what_is_kept_of_a_motion_does_not_grow_with_how_rigid_it_is(EI: float) -> None:
    problem = bar(0).replace(beam=Beam(length=1.0, bending_stiffness=EI, mass_per_length=1.0))
    assert problem.excitation_frequency is not None
    period = 2 * math.pi / problem.excitation_frequency
    history = fe_lapjoint.Solver().simulate(problem, PERIODS * period, errors=False)
    # Windows are thirds of the period, or of that of the slowest mode; periods and switches end some.
    slowest = 2 * math.pi / math.sqrt(2 * problem.supports[0].translational)
    windows = 3 * PERIODS * (1 + max(1.0, period / slowest))
    assert isinstance(history.field, ElementField)
    assert len(history.field.pieces) <= windows + PERIODS + 2 * len(history.contacts) + 1
