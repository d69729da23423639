"""Which contact states of a family motions have met: what a joint fills in before its first march.

This is the one thing that a motion leaves behind for later ones.  It saves a sweep from meeting each state anew at
every point; it decides nothing else.  What is known of a state depends on the state alone, and which states are known
beside those that a motion meets changes no bit of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

from analytic.march.modal_state import Family
from lapjoint.answers.contact_state import ContactState

_KEPT = 64  # memories, one for each family and numbers of modes; each takes a few hundred bytes


@dataclass(frozen=True, eq=False)
class KnownStates:
    """A set of states, and of switches between them."""

    states: tuple[ContactState, ...] = ()
    """Sorted."""
    switches: tuple[tuple[ContactState, int], ...] = ()
    """State and stop, from the state in which that stop is open; each stands for the way back, too.  Sorted."""

    @cached_property
    def slots(self) -> dict[ContactState, int]:
        """The number of each state; not to be written to."""
        return {state: slot for slot, state in enumerate(self.states)}

    def and_of(self, old: ContactState, stop: int) -> KnownStates:
        """These states and switches, and one switch more, with the states before and after it.

        Parameters
        ----------
        old : ContactState
            The state before the switch.
        stop : int
            The stop that opens or closes.

        Returns
        -------
        KnownStates
            A new set.
        """
        new = old.toggled(stop)
        opened = new if stop in old else old
        return KnownStates(tuple(sorted({*self.states, old, new})), tuple(sorted({*self.switches, (opened, stop)})))


class Memory:
    """The states and switches that the motions of a family have met so far."""

    def __init__(self) -> None:
        self.known = KnownStates()
        """Replaced as a whole, so a thread reads either the old ones or the new ones.  Of two threads that add to it at
        once one may lose its addition: then that state is met again, which costs time and changes no bit."""


@lru_cache(maxsize=_KEPT)
def memory_of(family: Family, counts: tuple[int, int]) -> Memory:
    """The memory of a family.

    Parameters
    ----------
    family : Family
        The problems that share it.
    counts : tuple of int
        Numbers of modes: in the free state, and in every other.

    Returns
    -------
    Memory
        The same object at every call, as long as it is kept.
    """
    return Memory()
