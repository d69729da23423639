"""A branch looked for by another solver from where it springs, as both have that.

A branch may be nearer to the one from which it springs than two solvers are to each other.  Then a motion that is
carried may belong to the wrong one, and of what lies on the branch no distance between solvers tells which is which.
But both have the bifurcation at which it springs, and nearly the same way from there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lapjoint.orbits.branches.carrier import Carrier
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import Approach
from lapjoint.orbits.branches.switching import repeated_near, springs_beside, switched
from lapjoint.problem import FloatArray

_FROM = 1e-4
"""Least arc length from where another solver begins to a bifurcation."""


@dataclass(frozen=True)
class Springing:
    """Where a branch springs, by two solvers."""

    spring: Carrier
    """The bifurcation by the one that has the branch."""
    family: Family
    """The period maps of the other."""
    its: Place
    """The bifurcation by the other."""
    new: Place
    """A motion of its branch beside that."""
    motion: Carrier
    """The motion of the first one near which something is looked for."""

    def expected(self, motion: Carrier) -> Place:
        """Where a motion of the first solver lies for the other, as far from the bifurcation as that one has it.

        Parameters
        ----------
        motion : Carrier
            The motion.

        Returns
        -------
        Place
            To measure distances from.
        """
        there = motion.seen_by(self.family)
        value, point = self.its.moved(self.family, self._carried - self.its.chord(self.family, there))
        return replace(self.its.beginning_at(point), value=value)

    @cached_property
    def _carried(self) -> FloatArray:
        """The way from the first one's bifurcation, as the other sees it, to the other's."""
        return self.its.chord(self.family, self.spring.seen_by(self.family))

    @property
    def sides(self) -> Iterator[Iterator[Approach]]:
        """A motion of the other's branch, of its images that nearest to the first's, with its tangent either way."""
        new, there = self.new, self.expected(self.motion)
        later = new.half_periods.marched(new.point, new.count // 2)
        image = corrected(self.family, new.value, later, new.count, fixed=True)
        ways = [(float(np.linalg.norm(one.chord(self.family, there))), one) for one in (new, image) if one is not None]
        length, nearer = min(ways, key=lambda one: one[0])
        for one in (nearer, nearer.turned()):
            yield iter((Approach(one, max(length, _FROM)),))


def spring_of(own: Family, motion: Place) -> tuple[Carrier, Carrier] | None:
    """Where a motion's branch springs from another that is near, by one solver.

    Parameters
    ----------
    own : Family
        The period maps of the solver.
    motion : Place
        The motion.

    Returns
    -------
    tuple of Carrier, or None
        The motion of the other branch that is nearest, and the bifurcation; None if there is none.
    """
    mother = repeated_near(own, motion)
    known = [] if mother is None else list(springs_beside(own, mother))
    if mother is None or not known:
        return None
    spring = min(known, key=lambda one: float(np.linalg.norm(motion.chord(own, one))))
    return Carrier(own, mother), Carrier(own, spring)


def springing(motion: Carrier, spring: tuple[Carrier, Carrier], family: Family) -> Iterator[Springing]:
    """The same by two solvers.

    Parameters
    ----------
    motion : Carrier
        The motion of the solver that has the branch.
    spring : tuple of Carrier
        As `spring_of` gives it.
    family : Family
        The period maps of the other solver.

    Yields
    ------
    Springing
        For each bifurcation that the other solver has near the motion.
    """
    near = next((there for one in spring if (there := one.carried(family)) is not None), None)
    for its in () if near is None else springs_beside(family, near):
        new = switched(family, its)
        if new is not None:
            yield Springing(spring[1], family, its, new, motion)
