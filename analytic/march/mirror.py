"""The mirror image of a contact state, z -> -z."""

from __future__ import annotations

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import Problem


def mirrored(problem: Problem, state: ContactState) -> ContactState | None:
    """The state with every closed stop exchanged for its twin on the other side.

    Parameters
    ----------
    problem : Problem
        What is solved.
    state : ContactState
        The stops that are closed.

    Returns
    -------
    ContactState or None
        The mirror image; None if a closed stop has not exactly one twin.
    """
    twins = []
    for k in state.closed:
        stop = problem.stops[k]
        same = [
            i
            for i, other in enumerate(problem.stops)
            if other.side != stop.side and (other.x, other.gap, other.stiffness) == (stop.x, stop.gap, stop.stiffness)
        ]
        if len(same) != 1:
            return None
        twins.append(same[0])
    return ContactState(tuple(twins))
