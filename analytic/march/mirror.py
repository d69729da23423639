"""The mirror image of a contact state, z -> -z."""

from __future__ import annotations

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import Problem


def mirrored(problem: Problem, state: ContactState) -> ContactState | None:
    """The state with every closed stop exchanged for its twin on the other side; None without such twins."""
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
