"""Arcs: a motion with a given contact sequence, continued in closed form, whatever the gaps do meanwhile.

A *contact sequence* names the stop that switches at the end of each arc.  Between two switches the motion follows the
closed form of one contact state for a given duration, so the end of a chain of arcs is a smooth function of the start
and of the durations.  Which durations make a motion of the joint is asked by equations, one for each event:

    h(end of the arc) = 0                             if another stop switched at the start of the arc, or none did,
    (h(end of the arc) - h(start of the arc)) / d = 0 if the same stop did,

with the gap function h = sign z - gap of the stop that switches, both values in the contact state of the arc, and the
duration d.  The divided difference is regular at d = 0, where it is h' = 0: the equation of a graze.  Durations below
zero mean nothing for a joint, but the equations hold for them, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, runtime_checkable

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class ContactSequence:
    """Which stops switch, one after the other, from the section on: ``M`` events between ``M + 1`` arcs."""

    first: ContactState
    """The contact state at the section."""
    stops: tuple[int, ...] = ()
    """The stop that switches at each event."""

    @cached_property
    def states(self) -> tuple[ContactState, ...]:
        """The contact state of each arc, ``M + 1`` of them."""
        states = [self.first]
        for stop in self.stops:
            states.append(states[-1].toggled(stop))
        return tuple(states)

    @cached_property
    def returning(self) -> tuple[bool, ...]:
        """Whether the event before each event was of the same stop, ``M`` of them."""
        before = (-1, *self.stops)[:-1]
        return tuple(stop == other for stop, other in zip(self.stops, before, strict=True))


@dataclass(frozen=True)
class Chain:
    """The arcs of a contact sequence from one start, with ``n`` coordinates at the section and ``M`` events."""

    starts: tuple[FloatArray, ...] = field(repr=False)
    """Displacements and velocities (q, v) at the start of each arc, in the modes of its contact state, ``M + 1`` arrays
    of shape ``(n_i,)``."""
    times: FloatArray = field(repr=False)
    """When each arc begins, s, shape ``(M + 1,)``."""
    end: FloatArray = field(repr=False)
    """(q, v) at the end of the last arc, in the modes of its contact state, shape ``(n_M,)``."""
    events: FloatArray
    """Left side of the equation of each event, m, or m/s where the stop returns, shape ``(M,)``."""
    end_by: FloatArray | None = field(default=None, repr=False)
    """Derivatives of `end` by (q, v) at the start of the first arc, then by the durations of all ``M + 1`` arcs, while
    the time of the section stays where it is; shape ``(n_M, n + M + 1)``; None if they were not asked for."""
    events_by: FloatArray | None = field(default=None, repr=False)
    """The same derivatives of `events`, shape ``(M, n + M + 1)``."""
    by_number: FloatArray | None = field(default=None, repr=False)
    """Derivatives of `end` and then of `events` by a number of the problem, while the start stays, and the time of the
    section and the durations keep their ratios to the excitation period, shape ``(n_M + M,)``; None if it was not asked
    for, or is not known."""


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
        """Follow the arcs of a contact sequence.

        Parameters
        ----------
        sequence : ContactSequence
            Which stops switch, ``M`` events.
        start : FloatArray, shape (n,)
            Displacements and velocities (q, v) at the section, in the modes of the first contact state.
        time : float
            Time of the section, s from a multiple of the period.
        durations : FloatArray, shape (M + 1,)
            Durations of the arcs, s, of either sign.
        derivatives : bool
            Whether to carry derivatives along.
        number : str, optional
            Path of a number of the problem, as `lapjoint.Axis` takes it: with the other derivatives that by this number
            is carried along, if the solver knows it.

        Returns
        -------
        Chain
            The arcs.
        """

    def motion(self, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> Motion:
        """The displacement at the stops along the arcs of a chain, as sums of exponentials.

        Parameters
        ----------
        sequence, chain, durations : ContactSequence, Chain, FloatArray of shape (M + 1,)
            The arcs.

        Returns
        -------
        Motion
            A segment for each arc; its places are the distinct positions of the stops in ascending order.  Segment
            starts count from the section.
        """

    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """Displacements and velocities some time later in the same contact state.

        Parameters
        ----------
        state : ContactState
            The contact state.
        start : FloatArray, shape (n,)
            (q, v) in its modes.
        time : float
            When, s from a multiple of the period.
        duration : float
            How much later, s, of either sign.

        Returns
        -------
        FloatArray, shape (n,)
            (q, v) in the same modes.
        """

    def point(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        """A state of the motion as a section point, as `lapjoint.orbits.PeriodMap` has them.

        Parameters
        ----------
        state : ContactState
            The contact state.
        coordinates : FloatArray, shape (n,)
            (q, v) in its modes.

        Returns
        -------
        SectionPoint
            The point.
        """

    def coordinates(self, point: SectionPoint) -> FloatArray:
        """The displacements and velocities of a section point of this problem and resolution.

        Parameters
        ----------
        point : SectionPoint
            The point.

        Returns
        -------
        FloatArray, shape (n,)
            (q, v) in the modes of its contact state.
        """

    def unit_norms(self, state: ContactState) -> FloatArray:
        """Sizes of units of the coordinates, as `lapjoint.orbits.PeriodMap.norm` has them.

        Parameters
        ----------
        state : ContactState
            The contact state.

        Returns
        -------
        FloatArray, shape (n,)
            In the unit of the displacement coordinates: displacements count as they are, velocities over the
            excitation frequency.
        """


@runtime_checkable
class HasArcs(Protocol):
    """A period map whose solver continues motions by arcs."""

    @property
    def arcs(self) -> Arcs:
        """The arcs of the same problem at the same resolution."""
