"""Arcs: a motion with a given contact sequence, in closed form, whether or not the gap functions fit the sequence.

A *contact sequence* names the stop that switches at the end of each arc.  Between two switches the motion follows the
closed form of one contact state for a given duration, so the end of a chain of arcs is a smooth function of the start
and of the durations.  The durations make a motion of the joint if they solve an equation for each event:

    h(end of the arc) = 0                              if another stop switched at the start of the arc, or none did,
    (h(end of the arc) - h(start of the arc)) / d = 0  if the stop also switched at the start of the arc,

with the gap function h = sign z - gap of the stop that switches, both values in the contact state of the arc, and the
duration d.  The divided difference is regular at d = 0, where it is h' = 0: the equation of a graze, a touch at zero
velocity.  Durations below zero describe no motion of a joint, but the equations still have solutions.

A damped stop that may not pull has two gap functions: its own, and that of its force, which reads z + (c / k) z' in
place of z; see
`lapjoint.orbits.watch.rows_of`.  It opens after its force has ended, so that its contact near a graze has two arcs of
durations p and r, pressing and released, which vanish together.  The equation of its opening is then

    w m_p + (1 - w) m_r = 0,    w = |p| / (|p| + |r|), or 1/2 at p = r = 0,

with the mean rates m of its own gap function over both arcs: for a contact, the change of h over p + r, divided by p +
r.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, runtime_checkable

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class ContactSequence:
    """The stops that switch, in order of time from the section: ``M`` events between ``M + 1`` arcs.

    A stop k that opens or closes is k, and ~k is a damped stop whose force ends or begins, as in
    `ContactState.toggled`.
    """

    first: ContactState
    """The contact state at the section."""
    stops: tuple[int, ...] = ()
    """The stop that switches at each of the ``M`` events."""

    @cached_property
    def states(self) -> tuple[ContactState, ...]:
        """The contact state of each arc, ``M + 1`` of them."""
        states = [self.first]
        for stop in self.stops:
            states.append(states[-1].toggled(stop))
        return tuple(states)

    @cached_property
    def returning(self) -> tuple[bool, ...]:
        """For each of the ``M`` events, whether the previous event was a switch of the same stop."""
        before = (None, *self.stops)[:-1]
        return tuple(stop == other for stop, other in zip(self.stops, before, strict=True))

    @cached_property
    def joining(self) -> tuple[bool, ...]:
        """For each of the ``M`` events, whether it opens a damped stop whose touch and whose end of force were the two
        previous events."""
        before = zip((None, None, *self.stops), (None, *self.stops), self.stops, strict=False)
        return tuple(now >= 0 and one == now and two == ~now for one, two, now in before)


def image_of(switch: int, twins: Sequence[int]) -> int:
    """The mirror image of a switch k, or ~k of a force; `twins` are the twins of the stops."""
    return twins[switch] if switch >= 0 else ~twins[~switch]


@dataclass(frozen=True)
class Chain:
    """The arcs of a contact sequence from one start, with ``n`` coordinates at the section and ``M`` events."""

    starts: tuple[FloatArray, ...] = field(repr=False)
    """Displacements and velocities (q, v) at the start of each arc, in the modes of its contact state, ``M + 1`` arrays
    of shape ``(n_i,)``."""
    times: FloatArray = field(repr=False)
    """Time at which each arc begins, s, shape ``(M + 1,)``."""
    end: FloatArray = field(repr=False)
    """(q, v) at the end of the last arc, in the modes of its contact state, shape ``(n_M,)``."""
    events: FloatArray
    """Left side of the equation of each event, m, or m/s if the stop also switched at the previous event, shape
    ``(M,)``."""
    end_by: FloatArray | None = field(default=None, repr=False)
    """Derivatives of `end` by (q, v) at the start of the first arc, then by the durations of all ``M + 1`` arcs, at a
    fixed time of the section, shape ``(n_M, n + M + 1)``; None if they were not requested."""
    events_by: FloatArray | None = field(default=None, repr=False)
    """Derivatives of `events` by the variables of `end_by`, shape ``(M, n + M + 1)``; None if they were not
    requested."""
    by_number: FloatArray | None = field(default=None, repr=False)
    """Derivatives of `end` and then of `events` by a parameter, shape ``(n_M + M,)``; None if not requested, or not
    known.  The start is fixed; the time of the section and the durations are fixed as fractions of the excitation
    period."""


class Arcs(Protocol):
    """The closed form of one problem's motion in all of its contact states."""

    @property
    def problem(self) -> Problem:
        """The problem; its excitation has a period."""

    @property
    def period(self) -> float:
        """The excitation period T, s."""

    def chain(
        self,
        sequence: ContactSequence,
        start: FloatArray,
        time: float,
        durations: FloatArray,
        derivatives: bool = True,
        number: str | None = None,
    ) -> Chain:
        """Follow the arcs of a contact sequence of ``M`` events.

        `start`, (n,), holds displacements and velocities (q, v) at the section, in the modes of the first contact
        state.  `time` is the time of the section, s from a multiple of the period.  `durations`, (M + 1,), are the
        durations of the arcs, s, of either sign.  With `derivatives`, `Chain.end_by` and `Chain.events_by` are also
        computed.  With a `number`, the path of a parameter, see `lapjoint.Axis`, `Chain.by_number` is also computed, if
        the solver knows it.
        """

    def motion(self, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> Motion:
        """The displacement at the stops along the arcs of a chain, as sums of exponentials: a segment for each arc.

        The places are the distinct positions of the stops in ascending order, and then one for each damped stop, which
        reads z + (c / k) z'.  The orientation has a row for each stop, and then for the force of each damped stop.  The
        times of segments count from the section.
        """

    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """(q, v), shape (n,), a `duration` of either sign, s, after `time`, in one contact state and its modes."""

    def point(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        """The section point with `coordinates` (q, v), (n,), in the modes of its contact state."""

    def coordinates(self, point: SectionPoint) -> FloatArray:
        """(q, v), shape (n,), of a section point of this problem and resolution, in the modes of its contact state."""

    def unit_norms(self, state: ContactState) -> FloatArray:
        """`PeriodMap.norm` of a unit of each coordinate, shape (n,): 1 of displacements, 1 / omega of velocities."""


@runtime_checkable
class HasArcs(Protocol):
    """A period map whose solver continues motions by arcs."""

    @property
    def arcs(self) -> Arcs:
        """The arcs of the same problem at the same resolution."""
