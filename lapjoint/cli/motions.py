"""Motions as the commands find them, with progress shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lapjoint import History, Problem, SteadyState
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
        progress(0.0, 1.0)  # the time is counted from here
        return solver.steady_state(problem, errors=errors, progress=progress)


def find_motions(
    source: str,
    overrides: tuple[str, ...],
    duration: float | None,
    steady_state: bool,
    beside: str | None,
    solver: dict[str, Any],
) -> dict[str, History]:
    """The motion asked for, by the name of its solver, and that of the solver beside it."""
    from lapjoint.cli import arguments
    from lapjoint.errors import InputError

    if (duration is None) != steady_state:
        raise InputError("--duration, --steady: give one of them")
    if duration is not None:
        arguments.check_duration(duration)
    this = arguments.problem_from(source, overrides)
    solvers = {solver["solver_name"]: arguments.solver_from(**solver)}
    if beside is not None:
        solvers[arguments.other_name(beside, solvers)] = arguments.named_solver(beside)
    return {
        name: find_steady_state(this, one, False).history
        if duration is None
        else find_motion(this, one, duration, False)
        for name, one in solvers.items()
    }
