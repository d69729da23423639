"""A motion: its contacts, and the means to evaluate it anywhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class Contact:
    """One contact of one stop, from impact to rebound."""

    stop: int
    """Index into ``problem.stops``."""
    start: float
    """Time of impact, s; the start of the history if `open_start`."""
    end: float
    """Time of rebound, s; the end of the history if `open_end`."""
    impulse: float
    """Time integral of the stop's spring force magnitude, N s, with the sign of the side: top positive."""
    peak_force: float
    """Largest spring force magnitude, N."""
    open_start: bool = False
    """Whether the contact was already closed when the history starts."""
    open_end: bool = False
    """Whether the contact is still closed when the history ends."""

    @property
    def duration(self) -> float:
        """Time in contact within the history, s."""
        return self.end - self.start


class Field(Protocol):
    """The motion z(x, t) and its derivatives."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x-derivative (0 to 3) of the `dt`-th t-derivative (0 to 2) of z.

        ``x`` has shape ``(n,)`` and ``t`` shape ``(m,)`` in any order; returns ``(n, m)``.  At a switch the later
        state is used.  Where a concentrated force makes the third x-derivative jump, the value is the one to
        the left (to the right at x = 0).
        """


@dataclass(frozen=True)
class History:
    """A motion from `start` to `end`, with its contacts and the means to evaluate it anywhere."""

    problem: Problem
    solver: str
    """Name of the solver and its numerical options, for tables and files."""
    start: float
    """First time, s."""
    end: float
    """Last time, s."""
    switch_times: FloatArray
    """Times at which the contact state changes, s, ascending, shape ``(switches,)``."""
    states: tuple[ContactState, ...]
    """The state before the first switch, between each two, and after the last: ``switches + 1`` of them."""
    contacts: tuple[Contact, ...]
    """All contacts, by start time."""
    field: Field
    """z(x, t), m, and its derivatives."""

    def displacement(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z(x, t) relative to the base, m, shape ``(n, m)`` for ``n`` positions and ``m`` times."""
        return self.evaluate(x, t)

    def velocity(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z_t(x, t) relative to the base, m/s, shape ``(n, m)``."""
        return self.evaluate(x, t, dt=1)

    def slope(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z_x(x, t), rad, shape ``(n, m)``."""
        return self.evaluate(x, t, dx=1)

    def moment(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """Bending moment EI z_xx (14a), N m, shape ``(n, m)``."""
        return self.problem.beam.EI * self.evaluate(x, t, dx=2)

    def shear(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """Shear force EI z_xxx (14b), N, shape ``(n, m)``."""
        return self.problem.beam.EI * self.evaluate(x, t, dx=3)

    def evaluate(self, x: FloatArray | float, t: FloatArray | float, dx: int = 0, dt: int = 0) -> FloatArray:
        """Any x- and t-derivative of z, shape ``(n, m)``; see `Field`.

        Raises
        ------
        ValueError
            If a position is outside the beam or a time outside the history.
        """
        x_ = np.atleast_1d(np.asarray(x, dtype=float))
        t_ = np.atleast_1d(np.asarray(t, dtype=float))
        L = self.problem.beam.length
        if np.any((x_ < 0) | (x_ > L)):
            raise ValueError(f"x must lie within the beam, 0 to {L:g} m")
        if np.any((t_ < self.start) | (t_ > self.end)):
            raise ValueError(f"t must lie within the history, {self.start:g} to {self.end:g} s")
        return self.field(x_, t_, dx, dt)

    def state_at(self, t: float) -> ContactState:
        """The contact state at time `t`; at a switch the later one."""
        return self.states[int(np.searchsorted(self.switch_times, t, side="right"))]

    def contact_force(self, t: FloatArray | float) -> FloatArray:
        """Force of each stop on the beam, N, positive upwards, shape ``(stops, m)``, from the force law."""
        stops = self.problem.stops
        t_ = np.atleast_1d(np.asarray(t, dtype=float))
        if not stops:
            return np.zeros((0, t_.size))
        z = self.displacement(np.array([stop.x for stop in stops]), t_)
        sign = np.array([[stop.sign] for stop in stops])
        k = np.array([[stop.stiffness] for stop in stops])
        gap = np.array([[stop.gap] for stop in stops])
        force: FloatArray = -sign * k * np.maximum(sign * z - gap, 0.0)
        return force

    def impulses(self, start: float | None = None, end: float | None = None) -> FloatArray:
        """Impulse of each stop summed over the contacts that start in ``[start, end)``, N s, ``(stops,)``."""
        lo = self.start if start is None else start
        hi = np.inf if end is None else end
        total = np.zeros(len(self.problem.stops))
        for contact in self.contacts:
            if lo <= contact.start < hi:
                total[contact.stop] += contact.impulse
        return total
