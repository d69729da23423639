"""Contact states: the sets of closed stops, and the paper's numbers of its nine states."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

from lapjoint.errors import InputError
from lapjoint.problem import PlacedStop, Problem


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

    @property
    def pressed(self) -> ContactState:
        """The state with the same closed stops, none of which is released."""
        return ContactState(self.closed) if self.released else self

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

    def mirrored(self, twins: Sequence[int]) -> ContactState:
        """The state with every stop exchanged for its twin.

        Parameters
        ----------
        twins : sequence of int
            For each stop the index of its twin on the other side.

        Returns
        -------
        ContactState
            The mirror image.
        """
        return ContactState(tuple(twins[k] for k in self.closed), tuple(twins[k] for k in self.released))

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


def stop_of(switch: int) -> int:
    """The stop of a switch k, or ~k of its force; see `ContactState.toggled`."""
    return switch if switch >= 0 else ~switch


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
    """The stops of each place (`PlacedStop.place`), ascending; a place seen from both sides is one.

    One displacement decides which stops of a place are closed.
    """
    at: dict[object, list[int]] = {}
    for i, stop in enumerate(problem.structure.stops):
        at.setdefault(_from_one_side(stop)[0], []).append(i)
    return [at[place] for place in sorted(at, key=repr)]


def _from_one_side(stop: PlacedStop) -> tuple[object, int]:
    """What a gap sees, with the factor 1 at the leftmost position, and the sign that belongs to it."""
    factor = 1 if min(stop.reading)[1] > 0 else -1
    return (tuple(sorted((x, factor * a) for x, a in stop.reading)), factor * stop.base_share), factor * stop.sign


def closed_together(problem: Problem, here: Sequence[int]) -> set[tuple[int, ...]]:
    """The sets of stops of one place, of indices `here`, that some displacement there closes."""
    stops = {i: problem.structure.stops[i] for i in here}
    sign = {i: _from_one_side(stop)[1] for i, stop in stops.items()}
    edges = sorted({sign[i] * stop.gap for i, stop in stops.items()})
    between = [(a + b) / 2 for a, b in itertools.pairwise(edges)]
    beyond = [-math.inf, math.inf]
    return {tuple(i for i in here if sign[i] * z > stops[i].gap) for z in (*beyond, *between, *edges)}


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
    L = problem.line.length
    places = sorted((stop.x, stop.side) for stop in problem.structure.stops)
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
    tip = problem.line.length
    return _PAPER_STATES[
        frozenset(
            ("tip" if problem.structure.stops[i].x == tip else "mid", problem.structure.stops[i].side)
            for i in state.closed
        )
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
