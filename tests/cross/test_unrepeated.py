"""Motions that do not repeat, by both solvers: never two certificates that contradict each other.

What is true of each motion was found by marches of 64 000 periods, and is checked here in ways of its own: by two
motions marched side by side, and by the multipliers of an orbit that is found when longer ones are looked for.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from beams import CLAMP
from witness import testify

import analytic
import fe_lapjoint
from lapjoint import (
    BaseMotion,
    Beam,
    Material,
    ModalDamping,
    Outcome,
    PolynomialShape,
    Problem,
    SteadyState,
    Stop,
    Support,
    Tube,
)

pytestmark = pytest.mark.long_march

PIPE = Problem(  # that of docs/gallery/own_joint.py at half its frequency
    beam=Beam(
        length=1.8,
        material=Material(youngs_modulus=1.93e11, density=8000.0),
        section=Tube(outer_diameter=0.050, inner_diameter=0.046),
    ),
    supports=(Support(x=0.0, translational=4e6, torsional=6e3), Support(x=1.8, translational=5e3)),
    stops=(
        Stop(name="hanger, below", x=1.2, side="bottom", gap=0.5e-3, stiffness=8e5),
        Stop(name="hanger, above", x=1.2, side="top", gap=1.0e-3, stiffness=8e5),
        Stop(name="tail", x=1.8, side="top", gap=1.5e-3, stiffness=2e5),
    ),
    damping=ModalDamping(ratio=(0.02, 0.03, 0.05)),
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=80.0),
)
WEAK_CHAOS = 0.464  # 1/s, +- 0.004: over 64 000 periods with 10, 20 and 40 modes, and 32 000 with 24 elements

CANTILEVER = Problem(
    beam=Beam(length=1.0, bending_stiffness=450.0, mass_per_length=2.4),
    supports=(CLAMP,),
    stops=(Stop(name="tip", x=1.0, side="top", gap=0.0, stiffness=1e5),),
    damping=ModalDamping(ratio=0.01),
    base_motion=BaseMotion(amplitude=2e-3, angular_frequency=130.0),
)
PERIOD = 2 * math.pi / 130.0


def assert_weakly_chaotic(found: SteadyState) -> None:
    assert found.outcome is Outcome.APERIODIC
    assert found.exponent is not None
    assert abs(found.exponent.value - WEAK_CHAOS) <= 4 * found.exponent.standard_error
    assert found.exponent.standard_error < 0.25 * WEAK_CHAOS


@pytest.mark.parametrize("n_modes", [None, 20, pytest.param(40, marks=pytest.mark.thorough)])
def test_weak_chaos_is_not_taken_for_a_torus_analytic(n_modes: int | None) -> None:
    assert_weakly_chaotic(analytic.Solver(n_modes=n_modes).steady_state(PIPE, errors=False))


@pytest.mark.parametrize(
    "elements",
    [pytest.param(12, marks=pytest.mark.thorough), *(pytest.param(n, marks=pytest.mark.slow) for n in (16, 24, 40))],
)
def test_weak_chaos_is_not_taken_for_a_torus_fe(elements: int) -> None:
    assert_weakly_chaotic(fe_lapjoint.Solver(elements=elements).steady_state(PIPE, errors=False))


def test_two_motions_side_by_side_part_at_the_rate_of_weak_chaos() -> None:
    """Without any tangent: the distance is brought back to 1e-7 of the motion once in ten periods."""
    map_ = analytic.Solver(n_modes=10).period_map(PIPE)
    span, here = 10 * map_.period, map_.march(map_.initial(), 800).end
    away, growths = np.random.default_rng(3).standard_normal(here.coordinates.size), []
    away *= 1e-7 * map_.size(here) / map_.norm(away)
    while len(growths) < 1500:
        there = map_.march(map_.moved(here, away), 20).end
        end = map_.march(here, 20).end
        if there.state == end.state:  # else one of them touches a stop just now: begin anew from here
            after = map_.difference(there, end)
            growths.append(math.log(map_.norm(after) / map_.norm(away)))
            away = after * math.exp(-growths[-1])
        here = end
    rates = np.array(growths[50:]) / span
    batches = rates[: rates.size // 16 * 16].reshape(16, -1).mean(axis=1)
    assert abs(rates.mean() - WEAK_CHAOS) <= 4 * batches.std(ddof=1) / 4


SOLVERS: dict[str, Any] = {"analytic": analytic.Solver, "FE": fe_lapjoint.Solver}
MESH: dict[str, Any] = {"analytic": {}, "FE": {"elements": 26}}


def fourteen(solver: str) -> SteadyState:
    """The motion of 14 periods, which a solver that looks for no longer one finds from a point of it.

    Transient chaos leads to it, or to stable motions of 2 and 28 periods beside it.  Which one hangs on rounding, so
    that many starts are tried, of which about two in five lead there.
    """
    for k in range(32):
        start = CANTILEVER.replace(initial=PolynomialShape(displacement=(0.0, 0.0, 1e-5 * k)))
        found = SOLVERS[solver](**MESH[solver]).steady_state(start, sensitivity=False, errors=False)
        if found.period_multiple == 14:
            return SOLVERS[solver](max_period_multiple=14, **MESH[solver]).steady_state(
                CANTILEVER, start=found.section_point, errors=False
            )
    raise AssertionError("no start leads to 14 periods")


@pytest.mark.parametrize("solver", ["analytic", pytest.param("FE", marks=pytest.mark.thorough)])
def test_a_motion_of_fourteen_periods_is_found_or_left_undecided_with_its_exponent(solver: str) -> None:
    """A joint amid period doublings, after transient chaos: other meshes show 28 and 56 periods, a coarse one chaos.

    The exponent measured where 14 periods are beyond `max_period_multiple` is that of the orbit's multiplier.
    """
    long = fourteen(solver)
    assert (long.outcome, long.period_multiple) == (Outcome.PERIODIC, 14)
    brief = SOLVERS[solver](max_period_multiple=8, **MESH[solver])
    short = brief.steady_state(CANTILEVER, start=long.section_point, errors=False)
    assert short.outcome is Outcome.UNDECIDED
    assert short.exponent is not None
    assert short.exponent.negative
    decay = math.log(abs(long.multipliers[0])) / (14 * PERIOD)
    assert abs(short.exponent.value - decay) <= 4 * short.exponent.standard_error
    # Weighted means converge as fast as they may: seen from any quarter the rate is that of the orbit.
    assert short.exponent.quarters[-1] == pytest.approx(decay, rel=1e-4)


@pytest.mark.thorough
@pytest.mark.parametrize("longest", [14, pytest.param(56, marks=pytest.mark.slow)])
def test_of_a_motion_and_one_that_circles_it_the_one_marched_to_is_certified(longest: int) -> None:
    """With 18 elements a motion of 56 periods lies 0.8 % of its size from a stable orbit of 14.

    Which of the two the transient chaos leads to hangs on rounding, but not that the certificate names it.
    """
    solver = fe_lapjoint.Solver(elements=18, max_period_multiple=longest, max_periods=1200)
    found = solver.steady_state(CANTILEVER)
    judgement = testify(solver.period_map(CANTILEVER), found, 4.0)
    assert judgement.verdict != "false", judgement.why
    assert found.period_multiple in (0, 14, 56)


@pytest.mark.slow
def test_a_coarser_mesh_is_chaotic_and_says_so() -> None:
    found = fe_lapjoint.Solver(elements=16).steady_state(CANTILEVER, errors=False)
    assert found.outcome is Outcome.APERIODIC
    assert found.exponent is not None
    assert found.exponent.value == pytest.approx(0.288, abs=4 * found.exponent.standard_error)  # over 32 000 periods
