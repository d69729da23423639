"""The same motion by a solver of twice, four times or more its resolution: what errors are judged by."""

from __future__ import annotations

import analytic
import fe_lapjoint
from lapjoint import Problem, SteadyState
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import find_orbit

AnySolver = analytic.Solver | fe_lapjoint.Solver


def doubled(solver: AnySolver, problem: Problem, times: int) -> AnySolver:
    """The same solver with 2**times the modes, as far as there are so many, or elements."""
    if isinstance(solver, fe_lapjoint.Solver):
        return fe_lapjoint.Solver(elements=solver.elements * 2**times)
    return analytic.Solver(n_modes=min(max(solver.mode_counts(problem)) * 2**times, 500))


def refined(solver: AnySolver, problem: Problem, steady: SteadyState) -> SteadyState | None:
    """The steady state of another resolution that is the nearest to a known one; None if there is none."""
    half_periods, multiple = HalfPeriods(solver.period_map(problem)), steady.period_multiple
    near = half_periods.map.adopted(steady.section_point)
    for periods in (0, 8):
        start = half_periods.map.march(near, 2 * periods * multiple).end if periods else near
        found = find_orbit(half_periods, start, 2 * multiple, farthest=0.5)
        if found is not None and found.stable:
            history = half_periods.map.history(found.point, multiple)
            return SteadyState(
                problem=problem,
                solver=solver.name,
                outcome=steady.outcome,
                period_multiple=multiple,
                symmetric=steady.symmetric,
                residual=found.residual,
                multipliers=found.multipliers,
                exponent=None,
                section_point=found.point,
                history=history,
                impulses=history.impulses() / multiple,
            )
    return None


def touches(steady: SteadyState) -> bool:
    """Whether a motion repeats, with contacts."""
    return steady.period_multiple > 0 and bool(steady.history.contacts)
