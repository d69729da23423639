"""Computation of the motions that commands need, with progress shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lapjoint import History, Problem, SteadyState
    from lapjoint.cli.options import MotionChoice, SolverChoice
    from lapjoint.solver import Solver


def find_motion(problem: Problem, solver: Solver, duration: float, errors: bool) -> History:
    """The motion from the initial state, with progress shown."""
    from lapjoint.cli.progress import shown_progress

    with shown_progress("simulate") as progress:
        return solver.simulate(problem, duration, errors=errors, progress=progress)


def find_steady_state(problem: Problem, solver: Solver, errors: bool) -> SteadyState:
    """The steady state, with progress shown."""
    from lapjoint.cli.progress import shown_search

    with shown_search("steady state", "periods allowed") as progress:
        progress(0.0, 1.0)  # starts the clock
        return solver.steady_state(problem, errors=errors, progress=progress)


def find_motions(
    source: str,
    overrides: tuple[str, ...],
    motion: MotionChoice,
    solver: SolverChoice,
) -> dict[str, History]:
    """The chosen motion of each chosen solver, by the name of the solver."""
    from lapjoint.cli import arguments
    from lapjoint.errors import InputError

    if (motion.duration is None) != motion.steady_state:
        raise InputError("--duration, --steady: give one of them")
    arguments.check_duration(motion.duration)
    this = arguments.problem_from(source, overrides)
    solvers = {solver.name: solver.make()}
    if motion.beside is not None:
        solvers[arguments.other_name(motion.beside, solvers)] = arguments.named_solver(motion.beside)
    return {
        name: find_steady_state(this, one, False).history
        if motion.duration is None
        else find_motion(this, one, motion.duration, False)
        for name, one in solvers.items()
    }
