"""The contact states met by motions of a loaded structure: a joint has them in its tables before its first march.

These states are all that a motion leaves behind for later ones.  They save a sweep from meeting each state anew at
every point, and decide no answer: the tables of a state depend on the state alone, and further states in them change no
bit of a motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

from analytic.march.modal_state import LoadedStructure
from lapjoint.answers.contact_state import ContactState

_KEPT = 64  # memories, one for each loaded structure and numbers of modes; each takes a few hundred bytes


@dataclass(frozen=True, eq=False)
class KnownStates:
    """A set of states, and of switches between them."""

    states: tuple[ContactState, ...] = ()
    """The contact states, sorted."""
    switches: tuple[tuple[ContactState, int], ...] = ()
    """Contact state before the switch, and the row of the tables that switches, of each switch, sorted."""

    @cached_property
    def slots(self) -> dict[ContactState, int]:
        """The number of each state; not to be written to."""
        return {state: slot for slot, state in enumerate(self.states)}

    def and_of(self, *switches: tuple[ContactState, int, ContactState]) -> KnownStates:
        """These states and switches with further ones: the state before, the row, and the state after."""
        states = {*self.states, *(state for old, _, new in switches for state in (old, new))}
        rows = {*self.switches, *((old, row) for old, row, _ in switches)}
        return KnownStates(tuple(sorted(states)), tuple(sorted(rows)))


class Memory:
    """The states and switches that the motions of a loaded structure have met so far."""

    def __init__(self) -> None:
        self.known = KnownStates()
        """Replaced as a whole, so a thread reads either the old ones or the new ones.  Of two threads that add to it at
        once one may lose its addition: then that state is met again, which costs time and changes no bit."""


@lru_cache(maxsize=_KEPT)
def memory_of(loaded: LoadedStructure, counts: tuple[int, int]) -> Memory:
    """The memory of a loaded structure with these numbers of modes: one object for all calls, as long as it is kept."""
    return Memory()
