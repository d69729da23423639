"""Contact states: the sets of closed stops, and the paper's numbers of its nine states."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

from lapjoint.errors import InputError
from lapjoint.problem import Problem


@dataclass(frozen=True, order=True)
class ContactState:
    """Which stops are closed, and which of the closed ones exert no force.

    A damped stop is closed while the beam is beyond its gap.  It is released while it is closed and its force is 0,
    because spring and damper together would pull.
    """

    closed: tuple[int, ...] = ()
    """Indices of the closed stops into ``problem.stops``, ascending."""
    released: tuple[int, ...] = ()
    """Indices of the closed stops whose force is 0, ascending; stops without damping are never among them."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "closed", tuple(sorted(set(self.closed))))
        object.__setattr__(self, "released", tuple(sorted(set(self.released) & set(self.closed))))

    def __contains__(self, stop: int) -> bool:
        return stop in self.closed

    def toggled(self, stop: int) -> ContactState:
        """The state after a stop has opened or closed, or after its force has ended or begun.

        Parameters
        ----------
        stop : int
            Index k into ``problem.stops`` of a stop that opens or closes; or ``~k`` of a closed stop whose force ends
            or begins again.

        Returns
        -------
        ContactState
            The state with this one change; a stop that closes presses.
        """
        if stop < 0:
            return ContactState(self.closed, tuple(set(self.released) ^ {~stop}))
        return ContactState(tuple(set(self.closed) ^ {stop}), self.released)

    def name(self, problem: Problem) -> str:
        """The names of the closed stops, and which of them are released, or ``free``.

        Parameters
        ----------
        problem : Problem
            The problem whose stops these are.

        Returns
        -------
        str
            As ``P2 + P3 (released)``.
        """
        names = (problem.stop_names[i] + " (released)" * (i in self.released) for i in self.closed)
        return " + ".join(names) or "free"


FREE = ContactState()
MOST_STATES = 4096
"""Largest number of contact states in a list: twelve stops at different positions have this number."""


def contact_states(problem: Problem) -> tuple[ContactState, ...]:
    """Every set of stops that can be closed together, fewest first.

    Opposite stops at one position can be closed together only if their gaps overlap: if the sum of both is below 0.

    Parameters
    ----------
    problem : Problem
        The problem whose stops these are.

    Returns
    -------
    tuple of ContactState
        States with equally many closed stops are sorted by the stops' indices.

    Raises
    ------
    InputError
        If there are more than `MOST_STATES` of them.
    """
    choices = [sorted(closed_together(problem, here), key=lambda c: (len(c), c)) for here in places(problem)]
    digits = sum(math.log10(len(subsets)) for subsets in choices)
    if digits > math.log10(MOST_STATES) + 1e-9:
        number = str(math.prod(map(len, choices))) if digits < 18 else f"some 10^{digits:.0f}"
        raise InputError(f"stops: these have {number} contact states; at most {MOST_STATES} can be listed")
    states = {
        ContactState(tuple(i for part in combination for i in part)) for combination in itertools.product(*choices)
    }
    return tuple(sorted(states, key=lambda s: (len(s.closed), s.closed)))


def can_be_closed(problem: Problem, state: ContactState) -> bool:
    """Whether the stops of a state can be closed while all others are open; `contact_states` lists such states."""
    here = places(problem)
    return all(tuple(i for i in stops if i in state) in closed_together(problem, stops) for stops in here)


def places(problem: Problem) -> list[list[int]]:
    """The stops of each place (`Stop.place`), from the root to the tip: one displacement decides which are closed."""
    at: dict[tuple[float, bool], list[int]] = {}
    for i, stop in enumerate(problem.stops):
        at.setdefault(stop.place, []).append(i)
    return [at[place] for place in sorted(at)]


def closed_together(problem: Problem, here: Sequence[int]) -> set[tuple[int, ...]]:
    """The sets of stops of one place, of indices `here`, that some displacement there closes."""
    edges = sorted({problem.stops[i].sign * problem.stops[i].gap for i in here})
    between = [(a + b) / 2 for a, b in itertools.pairwise(edges)]
    beyond = [-math.inf, math.inf]
    return {
        tuple(i for i in here if problem.stops[i].sign * z > problem.stops[i].gap) for z in (*beyond, *between, *edges)
    }


# The paper's Table 1, by (place, side) of the closed stops; Table 4 gives the order of states 6 to 9.
_PAPER_STATES = {
    frozenset(): 1,
    frozenset({("tip", "bottom")}): 2,
    frozenset({("mid", "bottom")}): 3,
    frozenset({("tip", "top")}): 4,
    frozenset({("mid", "top")}): 5,
    frozenset({("tip", "bottom"), ("mid", "bottom")}): 6,
    frozenset({("tip", "bottom"), ("mid", "top")}): 7,
    frozenset({("tip", "top"), ("mid", "bottom")}): 8,
    frozenset({("tip", "top"), ("mid", "top")}): 9,
}


def is_paper_joint(problem: Problem) -> bool:
    """Whether the stops are those of the paper: one on each side at mid-span and at the tip."""
    L = problem.beam.length
    places = sorted((stop.x, stop.side) for stop in problem.stops)
    return places == [(L / 2, "bottom"), (L / 2, "top"), (L, "bottom"), (L, "top")]


def paper_state_number(problem: Problem, state: ContactState) -> int:
    """The paper's number of a contact state of its joint.

    Parameters
    ----------
    problem : Problem
        A problem with the paper's stops.
    state : ContactState
        One of `contact_states`.

    Returns
    -------
    int
        1 to 9, by the paper's Tables 1 and 4.

    Raises
    ------
    ValueError
        If the stops are not those of the paper.
    """
    if not is_paper_joint(problem):
        raise ValueError("only the paper's joint, with stops at mid-span and tip, has numbered states")
    tip = problem.beam.length
    return _PAPER_STATES[
        frozenset(("tip" if problem.stops[i].x == tip else "mid", problem.stops[i].side) for i in state.closed)
    ]


def state_label(problem: Problem, state: ContactState) -> str:
    """The name of a state, after the paper's number if the state has one: ``6 P2 + P3``."""
    number = f"{paper_state_number(problem, state)}  " if is_paper_joint(problem) else ""
    return number + state.name(problem)


def state_order(problem: Problem, state: ContactState) -> tuple[int, tuple[int, ...], tuple[int, ...]]:
    """A key to sort states: the paper's number or the number of closed stops, the closed stops, the released stops."""
    return (
        paper_state_number(problem, state) if is_paper_joint(problem) else len(state.closed),
        state.closed,
        state.released,
    )
