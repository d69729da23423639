"""Supports too soft to matter: beams move as without them, by both solvers, down to the softest springs allowed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import UNIT

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, NoDamping, Problem, Stop, Support
from lapjoint.problem import FloatArray

SOLVERS = {"analytic": analytic.Solver(n_modes=8), "fe": fe_lapjoint.Solver(elements=8)}
SOFTEST, SOFT = 1e-16, 1e-10  # over EI / L^3 or EI / L: the motion below changes by a thousand times as much at most
EXACT = 1e-7  # of the impulses
FIRST = 2  # contacts: after these a free beam is gone


def beam_on(springs: tuple[float, float], kind: str) -> Problem:
    """A bar of 1 m with EI = m = 1 on springs, shaken against two stops."""
    a, b = springs
    supports = {
        "pin": (Support(x=0.3, translational=math.inf, torsional=a),),
        "slide": (Support(x=0.2, translational=a, torsional=math.inf),),
        "two springs": (Support(x=0.1, translational=a), Support(x=0.8, translational=b)),
        "spring and hinge": (Support(x=0.0, translational=a), Support(x=1.0, torsional=b)),
        "stiff pin": (Support(x=0.0, translational=1e4, torsional=a),),
    }
    return Problem(
        beam=UNIT,
        supports=supports[kind],
        stops=(
            Stop(x=1.0, side="top", gap=1e-3, stiffness=500.0),
            Stop(x=0.6, side="bottom", gap=1e-3, stiffness=300.0),
        ),
        damping=NoDamping(),  # a modal ratio would damp the slow motion as the root of its spring
        base_motion=BaseMotion(amplitude=5e-3, angular_frequency=11.0),
    )


def impulses(solver: analytic.Solver | fe_lapjoint.Solver, problem: Problem) -> FloatArray:
    """Of the first contacts, N s."""
    found = solver.simulate(problem, 1.5).contacts
    assert len(found) >= FIRST
    return np.array([contact.impulse for contact in found[:FIRST]])


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "kind",
    [
        "pin",
        "spring and hinge",
        *(pytest.param(it, marks=pytest.mark.thorough) for it in ("slide", "two springs", "stiff pin")),
    ],
)
def test_springs_too_soft_to_matter_do_not(kind: str, solver: str) -> None:
    without = impulses(SOLVERS[solver], beam_on((0.0, 0.0), kind))
    rng = np.random.default_rng((16, len(kind)))
    drawn = np.exp(rng.uniform(math.log(SOFTEST), math.log(SOFT), (3, 2)))
    for springs in [(SOFTEST, SOFT), (SOFTEST, SOFTEST), *drawn.tolist()]:
        found = impulses(SOLVERS[solver], beam_on(tuple(springs), kind))
        np.testing.assert_allclose(found, without, atol=EXACT * np.abs(without).max(), err_msg=str(springs))
