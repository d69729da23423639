"""Steady states of all solvers: what their certificates say holds of the march that goes on."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from beams import unit_cantilever
from settled import amplification
from toy import Bar, bar

import analytic
import fe_lapjoint
from lapjoint import FREE, InputError, Outcome, SteadyState, Stop, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.half_periods import HalfPeriods

pytestmark = pytest.mark.long_march

FIRST = 3.5160152685  # rad/s: first natural frequency of a cantilever of EI = m = L = 1


def marched_on(map_: PeriodMap, steady: SteadyState) -> tuple[np.ndarray, float]:
    """Impulses a period long after a motion was accepted, and how well the march then repeats.

    Three times as long as free vibration takes to die away: what deceives a search does so sooner.  And until 1e-9 of
    the distance from the orbit is left.
    """
    assert steady.acceptance is not None
    multiple = max(steady.period_multiple, 1)
    periods = 3 / map_.lowest_damping_rate / map_.period
    if steady.multipliers.size:
        periods = max(periods, multiple * math.log(1e-9) / math.log(abs(steady.multipliers[0])))
    point = map_.march(steady.acceptance.point, 2 * multiple * math.ceil(periods / multiple)).end
    passage = map_.march(point, 2 * multiple)
    return passage.impulses / multiple, HalfPeriods(map_).apart(passage.end, point)


def assert_is_where_the_march_leads(map_: PeriodMap, steady: SteadyState) -> None:
    impulses, residual = marched_on(map_, steady)
    assert residual < 1e-6
    scale = max(np.abs(impulses).max(), 1e-12)
    # Newton's method stops within 1e-9 of the motion, and truncation makes it jump by some 1e-6.
    assert steady.impulses == pytest.approx(impulses, rel=1e-4, abs=1e-5 * scale)


# --- The problems of which both solvers were certain, and wrong ----------------------------------------------------


def tip(gap: float, stiffness: float) -> Stop:
    return Stop(x=1.0, side="top", gap=gap, stiffness=stiffness)


TRANSIENTS = {
    "three periods, by a late contact": (
        unit_cantilever(tip(0.003, 100.0), omega=4.5 * FIRST, ratio=0.01),
        0.02189,
    ),
    "three periods, two stops": (
        unit_cantilever(
            tip(0.00177700226, 5.57214),
            Stop(x=0.5, side="bottom", gap=0.00226287, stiffness=1.83650),
            omega=3.327636 * FIRST,
        ),
        6.286e-4,
    ),
    "three periods, one stop": (
        unit_cantilever(tip(0.001849372330525, 29.229075838), omega=4.976706 * FIRST, ratio=0.02),
        1.2975e-3,
    ),
}
CERTAIN: dict[str, Any] = {"analytic": analytic.Solver(n_modes=10), "FE": fe_lapjoint.Solver(elements=8)}


@pytest.mark.parametrize("solver", CERTAIN)
@pytest.mark.parametrize("case", TRANSIENTS)
def test_late_contacts_of_a_transient_are_waited_for(solver: str, case: str) -> None:
    """Each has a stable motion of one period as well; no march from rest comes to it."""
    problem, impulse = TRANSIENTS[case]
    steady = CERTAIN[solver].steady_state(problem)
    assert (steady.outcome, steady.period_multiple) == (Outcome.PERIODIC, 3)
    # Stated to four digits; 8 elements or 10 modes bring some 1e-4 of their own.
    assert steady.impulses[0] == pytest.approx(impulse, rel=1e-3)
    assert_is_where_the_march_leads(CERTAIN[solver].period_map(problem), steady)


# --- Acceptance ----------------------------------------------------------------------------------------------------

SOLVERS: dict[str, Any] = {"analytic": analytic.Solver(n_modes=8), "FE": fe_lapjoint.Solver(elements=4), "bar": Bar()}


@pytest.mark.parametrize(
    "seed",
    [
        *(0, 1, 2, 3, 7),
        *(pytest.param(seed, marks=pytest.mark.thorough) for seed in (4, 5, 6)),
        *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(8, 40)),
    ],
)
def test_a_random_bar_is_where_its_march_leads(seed: int) -> None:
    """One stop or two, near what the motion without contact reaches; damped so that all of it is over soon."""
    rng = np.random.default_rng(seed)
    omega, ratio = rng.uniform(0.5, 4.5), rng.uniform(0.04, 0.1)
    amplitude = abs(amplification(omega, ratio))
    gaps = rng.uniform(0.5, 1.6, 2) * amplitude * [1, -1]
    stops = [(float(gap), float(np.exp(rng.uniform(1, 5)))) for gap in gaps[: rng.integers(1, 3)]]
    problem = bar(omega, *stops, ratio=ratio)
    map_ = Bar().period_map(problem)
    steady = Bar(max_periods=1500).steady_state(problem, sensitivity=False)
    if steady.period_multiple:
        assert_is_where_the_march_leads(map_, steady)
        contacts = bool(np.any(marched_on(map_, steady)[0]))
        assert contacts == (steady.outcome is not Outcome.NO_CONTACT)
    else:
        assert steady.outcome in (Outcome.APERIODIC, Outcome.UNDECIDED)
        if steady.outcome is Outcome.APERIODIC:
            assert marched_on(map_, steady)[1] > 1e-3


# --- What a certificate says ---------------------------------------------------------------------------------------


def test_stability_is_said_of_certified_orbits_only() -> None:
    settled = Bar().steady_state(bar(0.8, (0.5, 5.0)))
    assert settled.stable is True
    undamped = Bar(max_periods=20).steady_state(bar(0.8, (10.0, 5.0), ratio=0.0), sensitivity=False)
    assert undamped.outcome is Outcome.UNDECIDED
    assert (undamped.stable, undamped.period_multiple, undamped.multipliers.size) == (None, 0, 0)
    assert undamped.exponent is not None
    assert undamped.history.end == pytest.approx(8 * Bar().period_map(undamped.problem).period)
    assert replace(settled, multipliers=np.array([-1.2 + 0j, 0.1])).stable is False


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_motion_begins_at_its_section_point_and_holds_one_period(solver: str) -> None:
    problem = bar(0.8, (0.5, 5.0)) if solver == "bar" else paper_joint()
    steady = SOLVERS[solver].steady_state(problem)
    map_ = SOLVERS[solver].period_map(problem)
    assert steady.solver == SOLVERS[solver].name
    assert steady.history.end == pytest.approx(steady.period_multiple * map_.period)
    again = map_.march(steady.section_point, 2 * steady.period_multiple)
    assert HalfPeriods(map_).apart(again.end, steady.section_point) < 1e-7
    assert steady.impulses == pytest.approx(again.impulses / steady.period_multiple, rel=1e-9)


# --- Beginning elsewhere -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", ["analytic", "FE"])
def test_a_section_point_of_its_own_is_adopted_as_it_is(solver: str) -> None:
    map_ = SOLVERS[solver].period_map(paper_joint())
    for periods in (0, 1, 7, 30):
        point = map_.march(map_.initial(), 2 * periods).end if periods else map_.initial()
        again = map_.adopted(point)
        assert again.state == point.state
        assert map_.size(again) == pytest.approx(map_.size(point), rel=1e-12)
        assert map_.norm(map_.difference(again, point)) <= 1e-12 * max(map_.size(point), 1e-300)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_is_no_section_point_of_the_solver_is_refused(solver: str) -> None:
    problem = bar(0.8, (0.5, 5.0)) if solver == "bar" else paper_joint()
    strange = [SectionPoint(FREE, np.zeros((2, 3)), np.array([0.0, 1.0]))]
    strange += [
        SOLVERS[name].period_map(problem).initial() for name in ("analytic", "FE") if solver not in (name, "bar")
    ]
    for point in strange:
        with pytest.raises(InputError, match="start"):
            SOLVERS[solver].steady_state(problem, start=point)


def test_the_mirror_image_of_a_lopsided_motion_is_found_from_its_mirror_image() -> None:
    """A symmetric joint whose motion is not: which of the two is reached, where it starts decides."""
    solver = fe_lapjoint.Solver(elements=4)
    problem = paper_joint(angular_frequency=1100.0, damping_ratio=0.02)
    map_ = solver.period_map(problem)
    steady = solver.steady_state(problem)
    assert (steady.outcome, steady.period_multiple, steady.symmetric) == (Outcome.PERIODIC, 1, False)
    halfway = map_.mirrored(map_.march(steady.section_point, 1).end)
    twin = solver.steady_state(problem, start=halfway)
    twins = HalfPeriods(map_).twins
    assert twins is not None
    assert twin.impulses == pytest.approx(-steady.impulses[list(twins)], rel=1e-6)
    assert np.abs(twin.impulses - steady.impulses).max() > 1e-4 * np.abs(steady.impulses).max()
