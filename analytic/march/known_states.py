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
    """Contact state with the stop open, and the stop, of each switch, sorted; each switch stands for both
    directions."""

    @cached_property
    def slots(self) -> dict[ContactState, int]:
        """The number of each state; not to be written to."""
        return {state: slot for slot, state in enumerate(self.states)}

    def and_of(self, old: ContactState, stop: int) -> KnownStates:
        """These states and switches, with the switch of a stop from `old`, and the states before and after it,
        added."""
        new = old.toggled(stop)
        opened = new if stop in old else old
        return KnownStates(tuple(sorted({*self.states, old, new})), tuple(sorted({*self.switches, (opened, stop)})))


class Memory:
    """The states and switches that the motions of a loaded structure have met so far."""

    def __init__(self) -> None:
        self.known = KnownStates()
        """Replaced as a whole, so a thread reads either the old ones or the new ones.  Of two threads that add to it at
        once one may lose its addition: then that state is met again, which costs time and changes no bit."""
        self.room = 0, 0
        """Slots, and rows for switches, that the tables of joints with damped stops have grown to."""


@lru_cache(maxsize=_KEPT)
def memory_of(loaded: LoadedStructure, counts: tuple[int, int]) -> Memory:
    """The memory of a loaded structure with these numbers of modes: one object for all calls, as long as it is kept."""
    return Memory()
