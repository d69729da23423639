"""OpenSees as a third solver: numerical options, and the three questions that it answers.

OpenSees knows neither gaps, nor contacts, nor this package: it marches the beam at a fixed step with Newmark's method,
and contacts are read off what it recorded.  It has global state and may abort its process, so it always runs in
another one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import SectionPoint, SteadyState
from lapjoint.errors import InputError
from lapjoint.problem import AtRest, ModalDamping, Problem
from lapjoint.solver import MODES, Progress

MOST_ELEMENTS = 400
"""Largest number of elements: 80 of them with dt = 1e-6 s take 418 s of wall time for a second of motion."""
MOST_STEPS = 1_000_000  # Most steps of a march or an excitation period: each is recorded at every node


@dataclass(frozen=True)
class Solver:
    """OpenSees: elasticBeamColumn with consistent mass, gap springs, Newmark's average acceleration at a fixed step.

    Parameters
    ----------
    elements : int
        About how many elements over the beam; every support and stop gets a node besides.
    dt : float
        Time step, s; shortened a little so that the duration, or the excitation period, is a multiple of it.
    repeats : float
        A steady state is reached when displacements, velocities and impulses come back to this fraction of their size.
    max_period_multiple : int
        Longest periodic motion looked for, in excitation periods.
    max_periods : int
        Most excitation periods marched in search of a steady state.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    elements: int = 40
    dt: float = 4e-6
    repeats: float = 1e-6
    max_period_multiple: int = 8
    max_periods: int = 500

    def __post_init__(self) -> None:
        for field, most in (("elements", MOST_ELEMENTS), ("max_period_multiple", 100), ("max_periods", 10**5)):
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
                raise InputError(f"{field} = {value!r}: must be an integer from 1 to {most}")
        for field in ("dt", "repeats"):
            value = getattr(self, field)
            if not 0 < value < 1:
                raise InputError(f"{field} = {value!r}: must lie between 0 and 1")

    @property
    def name(self) -> str:
        """Name and options in a line."""
        return f"OpenSees ({self.elements} elements, dt = {self.dt:g} s)"

    def refined(self, factor: float) -> Solver:
        """This solver with `factor` times the elements and a time step shorter by `factor`.  See
        `lapjoint.solver.Solver.refined`."""
        return replace(self, elements=max(1, math.ceil(self.elements * factor)), dt=self.dt / factor)

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest `count` modes of a contact state by OpenSees' dense eigensolver.  See
        `lapjoint.solver.Solver.modes`."""
        from validation.peers import opensees_answers

        return opensees_answers.modes(self, problem, state, count)

    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        """The motion from rest over `duration` s.  No errors are estimated and `errors` is not used.  See
        `lapjoint.solver.Solver.simulate`."""
        if not (math.isfinite(duration) and duration > 0):
            raise InputError(f"duration = {duration!r}: must be positive and finite, in s")
        check_problem(problem)
        if duration / self.dt > MOST_STEPS:
            raise InputError(f"dt = {self.dt!r}: {duration:g} s would take more than {MOST_STEPS} steps")
        from validation.peers import opensees_answers

        return opensees_answers.simulate(self, problem, float(duration), progress)

    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        """The first motion that a march from rest repeats, to within `repeats`, without multipliers, exponent and
        errors; `start`, `sensitivity` and `errors` are not used.  See `lapjoint.solver.Solver.steady_state`."""
        period = problem.require_excitation_period("steady state")
        check_problem(problem)
        if period / self.dt > MOST_STEPS:
            raise InputError(f"dt = {self.dt!r}: an excitation period would take more than {MOST_STEPS} steps")
        from validation.peers import opensees_answers

        return opensees_answers.steady_state(self, problem, progress)


def check_problem(problem: Problem) -> None:
    """Refuse what OpenSees cannot express, or starts wrongly: it begins with zero acceleration."""
    if isinstance(problem.damping, ModalDamping):
        raise InputError('damping.kind = "modal": OpenSees has it for one state only; allowed are "viscous" and "none"')
    if problem.point_loads:
        raise InputError("point_loads: the OpenSees solver knows base motion only")
    if not isinstance(problem.initial, AtRest):
        raise InputError(f'initial.kind = "{problem.initial.kind}": the OpenSees solver starts at rest only')
    for what, parts in (("a record", problem.records), ("random", problem.random)):
        if parts:
            raise InputError(f"{next(iter(parts))}: is {what}; the OpenSees solver knows sums of sines only")
    base = problem.base_motion
    for i, wave in enumerate(() if base is None else base.waves):
        if base is not None and wave.phase:
            path = "base_motion" if base.kind == "sine" else f"base_motion.harmonics[{i}]"
            raise InputError(f"{path}.phase = {wave.phase:g}: must be 0, as OpenSees starts without acceleration")
