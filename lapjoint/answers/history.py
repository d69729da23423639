"""A motion: its contacts, and the means to evaluate it anywhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.shown import Shown
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.supports_and_stops import readings

NO_ERRORS = "no errors were estimated"
"""The `History.error_source` of a motion without estimated errors."""


@dataclass(frozen=True)
class Contact:
    """One contact of one stop, from impact to rebound; of a damped stop, the time in which its force acts."""

    stop: int
    """Index into ``problem.stops``."""
    start: float
    """Time of impact, s; the start of the history if `open_start`."""
    end: float
    """Time of rebound, or of the end of a damped stop's force, s; the end of the history if `open_end`."""
    impulse: float
    """Time integral of the stop's force, N s, with the sign of the side: top positive."""
    peak_force: float
    """Largest force with which the stop presses, N."""
    open_start: bool = False
    """Whether the contact was already closed when the history starts."""
    open_end: bool = False
    """Whether the contact is still closed when the history ends."""
    start_error: float | None = None
    """Estimate of the numerical error of `start`, s; infinite if no error can be stated, None if none was estimated."""
    impulse_error: float | None = None
    """Estimate of the numerical error of `impulse`, N s; infinite or None, see `start_error`."""
    peak_force_error: float | None = None
    """Estimate of the numerical error of `peak_force`, N; infinite or None, see `start_error`."""
    dissipated: float = 0.0
    """Energy that is lost in a damped stop, J: the integral of its force times the rate of its penetration.  What its
    spring stores when the force ends is lost with it; what the spring stores where the history cuts the contact is not.
    A stop without damping gives all back."""
    dissipated_error: float | None = None
    """Estimate of the numerical error of `dissipated`, J; infinite or None, see `start_error`."""

    @property
    def duration(self) -> float:
        """Time in contact within the history, s."""
        return self.end - self.start


class Field(Protocol):
    """The motion z(x, t) and its derivatives."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """A derivative of z.

        At a switch the derivative is that of the later contact state.  Where a concentrated force makes the third
        x-derivative jump, the value is the limit from the left (from the right at x = 0).

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions, m, from 0 to L.
        t : FloatArray, shape (m,)
            Times, s, within the history, in any order.
        dx : int
            Order of the x-derivative, 0 to 3.
        dt : int
            Order of the t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (n, m)
            The derivative, m^(1 - dx) s^-dt.
        """


def penetration_of(problem: Problem, seen: FloatArray) -> FloatArray:
    """Penetration of each stop, m, (stops, m), by the displacement that its gap sees, m, (stops, m)."""
    sign = np.array([stop.sign for stop in problem.structure.stops])[:, None]
    gap = np.array([stop.gap for stop in problem.stops])[:, None]
    return np.asarray(sign * seen - gap)


@dataclass(frozen=True, repr=False)
class History(Shown):
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
    """The contact states before, between and after the switches, in order, ``switches + 1`` of them."""
    contacts: tuple[Contact, ...]
    """All contacts, by start time."""
    field: Field
    """z(x, t), m, and its derivatives."""
    error_source: str = NO_ERRORS
    """How the errors of the contacts were estimated, or why there are none."""
    lost_errors: FloatArray | None = None
    """Estimates of the numerical errors of `dissipated`, J, shape ``(stops,)``; None if the contacts' errors are all
    that is known."""
    highest_mode: float | None = None
    """Angular frequency of the fastest mode in the solver's motion, rad/s; None if the solver does not state it."""

    def displacement(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z(x, t), the displacement relative to the base, m, positive upwards.  See `History.evaluate`."""
        return self.evaluate(x, t)

    def velocity(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z_t(x, t), the velocity relative to the base, m/s.  See `History.evaluate`."""
        return self.evaluate(x, t, dt=1)

    def acceleration(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z_tt(x, t), the acceleration relative to the base, m/s2.  See `History.evaluate`."""
        return self.evaluate(x, t, dt=2)

    def base(self, t: FloatArray | float, dt: int = 0) -> FloatArray:
        """y(t), the displacement of the base, or a derivative of it.

        Parameters
        ----------
        t : float or FloatArray, shape (m,)
            Times, s.
        dt : int
            Order of the t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (m,)
            m s^-dt; zero where the base does not move.
        """
        t_ = np.atleast_1d(np.asarray(t, dtype=float))
        motion = self.problem.base_motion
        return np.zeros(t_.size) if motion is None else motion.at(t_, dt)

    def slope(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """z_x(x, t), the slope, rad.  See `History.evaluate`."""
        return self.evaluate(x, t, dx=1)

    def moment(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """EI z_xx, the bending moment (14a), N m.  See `History.evaluate`."""
        return self._stiffness(x) * self.evaluate(x, t, dx=2)

    def bending_stress(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """-E c z_xx, the bending stress at the top of the section, Pa, tension positive.  See `History.evaluate`.

        The top lies c above the axis; the stress at the bottom is the opposite.  At a step of the beam it is the larger
        stress of both sides.  A beam without a section is an `InputError`.
        """
        x_ = np.atleast_1d(np.asarray(x, dtype=float))
        return -self.problem.line.stress_per_moment_at(x_)[:, None] * self.moment(x_, t)

    def shear(self, x: FloatArray | float, t: FloatArray | float) -> FloatArray:
        """EI z_xxx, the shear force (14b), N.  See `History.evaluate`."""
        return self._stiffness(x) * self.evaluate(x, t, dx=3)

    def _stiffness(self, x: FloatArray | float) -> FloatArray:
        """EI, N m2, at positions, m, ``(n, 1)``."""
        return self.problem.line.EI_at(np.atleast_1d(np.asarray(x, dtype=float)))[:, None]

    def evaluate(self, x: FloatArray | float, t: FloatArray | float, dx: int = 0, dt: int = 0) -> FloatArray:
        """Any derivative of z; `Field` defines its value where it jumps.

        Parameters
        ----------
        x : float or FloatArray, shape (n,)
            Positions, m, from 0 to L.
        t : float or FloatArray, shape (m,)
            Times, s, within the history, in any order.
        dx : int
            Order of the x-derivative, 0 to 3.
        dt : int
            Order of the t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (n, m)
            The derivative, m^(1 - dx) s^-dt; n = 1 or m = 1 for a single number.

        Raises
        ------
        ValueError
            If a position is outside the beam or a time outside the history.
        """
        x_ = np.atleast_1d(np.asarray(x, dtype=float))
        t_ = np.atleast_1d(np.asarray(t, dtype=float))
        self.problem.line.check(x_)
        if np.any((t_ < self.start) | (t_ > self.end)):
            raise ValueError(f"t must lie within the history, {self.start:g} to {self.end:g} s")
        return self.field(x_, t_, dx, dt)

    def state_at(self, t: float) -> ContactState:
        """The contact state at a time; at a switch the later one.

        Parameters
        ----------
        t : float
            Time, s, within the history.

        Returns
        -------
        ContactState
            The stops that are closed at this time.
        """
        return self.states[int(np.searchsorted(self.switch_times, t, side="right"))]

    def contact_force(self, t: FloatArray | float) -> FloatArray:
        """Force of each stop on the beam, by the force law from the motion at the stop.

        Parameters
        ----------
        t : float or FloatArray, shape (m,)
            Times, s, within the history, in any order.

        Returns
        -------
        FloatArray, shape (stops, m)
            Forces, N, positive upwards; zero where a stop is open, and where a damped stop would pull but may not.
        """
        stops, depth = self.problem.structure.stops, self.penetration(t)
        sign_and_k = np.array([stop.sign * stop.stiffness for stop in stops])[:, None]
        force = np.asarray(-sign_and_k * np.maximum(depth, 0.0))
        damped = [k for k, stop in enumerate(stops) if stop.damping > 0]
        rate = self.seen_by_stops(t, 1) if damped else depth
        for k in damped:
            pressed = stops[k].stiffness * depth[k] + stops[k].damping * stops[k].sign * rate[k]
            acts = (depth[k] > 0) & ((pressed > 0) | stops[k].may_pull)
            force[k] = np.where(acts, -stops[k].sign * pressed, 0.0)
        return force

    def penetration(self, t: FloatArray | float) -> FloatArray:
        """Penetration of each stop: how far the beam is beyond the stop's gap.

        Parameters
        ----------
        t : float or FloatArray, shape (m,)
            Times, s, within the history, in any order.

        Returns
        -------
        FloatArray, shape (stops, m)
            Penetrations, m; where a stop is open, minus the distance to it.
        """
        return penetration_of(self.problem, self.seen_by_stops(t))

    def seen_by_stops(self, t: FloatArray | float, dt: int = 0) -> FloatArray:
        """What the gap of each stop sees: z there, and z + y where the stop is fixed in space.

        Parameters
        ----------
        t : float or FloatArray, shape (m,)
            Times, s, within the history, in any order.
        dt : int
            Order of the t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (stops, m)
            m s^-dt.
        """
        t_ = np.atleast_1d(np.asarray(t, dtype=float))
        if not self.problem.structure.stops:
            return np.zeros((0, t_.size))
        x, seen = readings(self.problem.structure.stops)
        return np.asarray(seen @ self.evaluate(x, t_, dt=dt) + self.base_of_stops(t_, dt))

    def base_of_stops(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The motion of the base that the gap of each stop sees: y(t) where the stop is fixed in space, else 0.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s.
        dt : int
            Order of the t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (stops, m)
            m s^-dt.
        """
        shares = np.array([stop.base_share for stop in self.problem.structure.stops])
        if not shares.any():
            return np.zeros((shares.size, t.size))
        return np.outer(shares, self.base(t, dt))

    def faces(self, t: FloatArray) -> FloatArray:
        """Where the face of each stop is, in the frame of the beam that meets it.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s, within the history.

        Returns
        -------
        FloatArray, shape (stops, m)
            The displacement at which the beam touches the stop, m: the gap, up or down, moved by what carries the stop.
        """
        stops = self.problem.structure.stops
        found = np.outer([stop.sign * stop.gap for stop in stops], np.ones(t.size)) - self.base_of_stops(t)
        for k, stop in enumerate(stops):
            if stop.side == "between":
                found[k] += self.displacement(stop.x, t)[0]
        return found

    def impulses(self, start: float | None = None, end: float | None = None) -> FloatArray:
        """Impulse of each stop, summed over the contacts that start in ``[start, end)``.

        Parameters
        ----------
        start : float, optional
            Earliest start of a contact, s; the start of the history if not given.
        end : float, optional
            Time before which contacts start, s; by default after the last contact.

        Returns
        -------
        FloatArray, shape (stops,)
            Impulses, N s, positive at the top, negative at the bottom.
        """
        lo = self.start if start is None else start
        hi = np.inf if end is None else end
        total = np.zeros(len(self.problem.stops))
        for contact in self.contacts:
            if lo <= contact.start < hi:
                total[contact.stop] += contact.impulse
        return total

    def dissipated(self) -> FloatArray:
        """Energy that each stop has taken from the beam and kept, over all contacts; 0 of stops without damping.

        Returns
        -------
        FloatArray, shape (stops,)
            Energies, J.
        """
        total = np.zeros(len(self.problem.stops))
        for contact in self.contacts:
            total[contact.stop] += contact.dissipated
        return total

    def dissipated_errors(self) -> FloatArray | None:
        """Estimates of the numerical errors of `dissipated`: `lost_errors`, or the sums of the errors of the contacts.

        Returns
        -------
        FloatArray, shape (stops,), or None
            Errors, J; infinite where no error can be stated, None if none was estimated.
        """
        if self.lost_errors is not None:
            return self.lost_errors
        total = np.zeros(len(self.problem.stops))
        for contact in self.contacts:
            if contact.dissipated_error is None:
                return None
            total[contact.stop] += contact.dissipated_error
        return None if self.error_source == NO_ERRORS else total
