"""From a problem and numbers of modes to a motion."""

from __future__ import annotations

from analytic.march import Joint, march
from analytic.march.field import history_of
from analytic.march.initial_state import started
from analytic.period_map import PeriodMap
from lapjoint.answers import History
from lapjoint.problem import Problem
from lapjoint.solver import Progress


def simulate(
    problem: Problem,
    name: str,
    counts: tuple[int, int],
    duration: float,
    progress: Progress | None,
    depth: bool = True,
) -> History:
    """The motion from the initial state.

    Parameters
    ----------
    problem : Problem
        What is solved.
    name : str
        Name and options of the solver.
    counts : tuple of int
        Numbers of modes: in the free state, and in every other.
    duration : float
        How long, s.
    progress : callable or None
        Called with (done, total), in the same unit.
    depth : bool
        Whether to find the peak forces of the contacts.

    Returns
    -------
    History
        The motion from 0 to `duration`, with its contacts.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    joint = Joint(problem, *counts)
    if problem.excitation_frequency is not None:
        return PeriodMap(joint, name).simulated(duration, progress, depth)
    motion = march(joint, started(joint), 0.0, duration, depth=depth, progress=progress)
    return history_of(name, motion)
