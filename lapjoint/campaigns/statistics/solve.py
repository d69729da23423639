"""How a realisation is summarised: by sums whose number does not grow with the duration, independent of other
realisations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.errors import SolverError
from lapjoint.solver import Progress, Solver
from lapjoint.summaries.measure import sums_of

REHEARSAL = 1e-3
"""Fraction of the duration that is marched to compile all functions before workers begin."""


@dataclass(frozen=True)
class Realised:
    """The result of one realisation."""

    sums: dict[str, Any] | None = None
    """Sums of the realisation, as `Sums.plain` gives them; None if the solver gave up."""
    message: str = ""
    """Why the solver gave up; empty where it did not."""


def solve_realisation(spec: Realisations, number: int, solver: Solver, progress: Progress | None = None) -> Realised:
    """The sums of a realisation; `progress` is called with the time marched and the whole, s."""
    try:
        return Realised(sums_of(spec.measure(solver), solver, spec.realisation(number), progress).plain())
    except SolverError as error:
        return Realised(message=str(error))


def rehearse(spec: Realisations, solver: Solver) -> None:
    """March a small part of the duration, so that everything is compiled."""
    short = replace(spec.measure(solver), duration=REHEARSAL * spec.duration, settle=0.0, units=1)
    sums_of(short, solver, spec.problem)
