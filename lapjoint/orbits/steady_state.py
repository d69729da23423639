"""The steady state of a problem, made from the motion that the search found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lapjoint.answers import History
from lapjoint.answers.steady_state import Acceptance, SectionPoint, SteadyState, impulses_per_period, periodic_outcome
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.orbit_errors import FinerMap, orbit_errors
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.orbits.search import (
    FIRST_LOOK,
    FIRST_LOOK_NEAR,
    MULTIPLES_AT_A_LOOK,
    Effort,
    SearchResult,
    SteadyStateSearch,
)
from lapjoint.orbits.wandering import Wandering
from lapjoint.parts import require
from lapjoint.solver import Progress


@in_one_thread
def find_steady_state(
    period_map: PeriodMap,
    solver: str,
    effort: Effort,
    *,
    start: SectionPoint | None = None,
    finer: Callable[[], FinerMap] | None = None,
    errors: bool = True,
    progress: Progress | None = None,
) -> SteadyState:
    """The steady state to which a march converges, with its certificate.

    Parameters
    ----------
    period_map : PeriodMap
        The motion of the problem from section point to section point, by some solver.
    solver : str
        Name and options of the solver.
    effort : Effort
        Limits of the search.
    start : SectionPoint, optional
        Start of the march, by default the problem's initial state: a section point of the same solver, of this problem
        or a neighbouring one.
    finer : callable, optional
        Returns the period map at a finer resolution; without `finer` the errors of a periodic motion are unknown.
    errors : bool
        Whether to estimate the errors of the impulses and of the contacts.
    progress : callable, optional
        Called with the periods marched, and their limit.

    Returns
    -------
    SteadyState
        The steady state; its outcome says whether it is periodic, quasi-periodic, aperiodic or undecided.

    Raises
    ------
    InputError
        If `start` is not a section point of this or a neighbouring problem, or the period map lacks a part.
    SolverError
        If the march cannot be continued.
    """
    require(period_map, PeriodMap, f"the period map of solver = {solver}", "steady states")
    begin = period_map.initial() if start is None else period_map.adopted(start)
    first_look = FIRST_LOOK if start is None else FIRST_LOOK_NEAR
    found = SteadyStateSearch(period_map, effort, progress).run(begin, min(first_look, effort.max_periods))
    steady = _certified(period_map, solver, found, effort)
    return _with_errors(steady, found.motion, finer) if errors else steady


def _with_errors(steady: SteadyState, motion: Orbit | Wandering, finer: Callable[[], FinerMap] | None) -> SteadyState:
    """A steady state with its errors: by a finer resolution, or standard errors if the motion does not repeat."""
    if isinstance(motion, Wandering):
        source = f"standard error of the mean over {motion.exponent.periods} periods"
        unknown = "unknown: the motion does not repeat, and a finer one makes other contacts"
        history = replace(steady.history, error_source=unknown)
        return replace(steady, history=history, impulse_errors=motion.standard_errors, error_source=source)
    if finer is None:
        source = "unknown: the solver has no finer self to compare with"
        return replace(steady, history=replace(steady.history, error_source=source), error_source=source)
    found = orbit_errors(motion, steady.history, finer)
    return replace(
        steady,
        history=found.history,
        impulse_errors=found.impulses,
        dissipated_errors=found.dissipated,
        error_source=found.source,
        comparison=found.comparison,
    )


def _certified(period_map: PeriodMap, solver: str, found: SearchResult, effort: Effort) -> SteadyState:
    """The steady state that the search found, marched once more with its contacts."""
    motion = found.motion
    if isinstance(motion, Orbit):
        return periodic_state(period_map, solver, motion, found.acceptance)
    return SteadyState(
        problem=period_map.problem,
        solver=solver,
        outcome=motion.outcome,
        period_multiple=0,
        symmetric=False,
        residual=motion.residual,
        multipliers=np.zeros(0, dtype=complex),
        exponent=motion.exponent,
        section_point=motion.point,
        history=period_map.history(motion.point, min(effort.max_period_multiple, MULTIPLES_AT_A_LOOK)),
        impulses=motion.impulses,
        acceptance=found.acceptance,
        march_on=lambda periods: period_map.history(motion.point, periods),
    )


def periodic_state(period_map: PeriodMap, solver: str, orbit: Orbit, acceptance: Acceptance | None) -> SteadyState:
    """A periodic motion, stable or not, with its certificate; `acceptance` is None without a march."""
    history = period_map.history(orbit.point, orbit.period_multiple)
    return SteadyState(
        problem=period_map.problem,
        solver=solver,
        outcome=periodic_outcome(history),
        period_multiple=orbit.period_multiple,
        symmetric=orbit.symmetric or mirrors_itself(history),
        residual=orbit.residual,
        multipliers=orbit.multipliers,
        exponent=None,
        section_point=orbit.point,
        history=history,
        impulses=impulses_per_period(history, orbit.period_multiple),
        acceptance=acceptance,
    )


def mirrors_itself(history: History) -> bool:
    """Whether a motion over one period must mirror itself: there are harmonic loads only, and no contact."""
    return not history.contacts and history.problem.forces.change_sign
