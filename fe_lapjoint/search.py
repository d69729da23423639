"""The next switch of a contact state, found with certainty.

Each stop j has a switch function s_j(t), negative while its present state may last and zero when it switches:
``+(sign z - gap)`` if open, ``-(sign z - gap)`` if closed.  On an interval of length h from a time where the modes'
envelopes are known, a function and the chord through its end values differ by no more than::

    max |s - chord| <= sum_i |row_i| min(c_i h^2 / 8, 2 a_i)                                        (S1)

c_i and a_i bounding the curvature and the size of mode i there.  So an interval is clear of a switch if both its
end values lie below minus this bound, or if s' (bounded in the same way) keeps one sign and the later or the earlier end value is
negative; it holds exactly one switch if s' > 0 throughout and the end values differ in sign.  Any other interval
is divided by eight and examined again.  No double crossing, however shallow, can be missed; a graze so slight
that its depth is below rounding is taken as none.

Where a segment starts at a switch, the switch function starts at zero, up to rounding of either sign, and falls:
the first value is set to zero if positive, so that no switch fires twice.

The functions C, S, J and D of (F2) are tabulated once per state on each level of division.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fe_lapjoint.bounds import Bounds, Envelope
from fe_lapjoint.flow import ComplexArray, Flow
from lapjoint.problem import FloatArray

_FIRST = 32  # intervals on the coarsest level
_DIVISION = 8
_LEVELS = 12  # 8^12 = 7e10: the finest interval is far below the precision of time itself
_TIE = 1e-10  # of the coarsest step: stops that switch closer together than this switch at once


@dataclass(frozen=True)
class Switch:
    """A switch at ``t``, of all `stops` that switch then, with the modal state there in the old coordinates."""

    t: float
    stops: tuple[int, ...]
    q: FloatArray
    v: FloatArray


@dataclass(frozen=True)
class Table:
    """The functions of (F2) at equidistant elapsed times ``0, h, 2h ...``, ``intervals + 1`` of them."""

    flow: Flow
    rows: FloatArray
    h: float
    intervals: int

    @cached_property
    def times(self) -> FloatArray:
        """Elapsed times, s, shape ``(intervals + 1,)``."""
        return self.h * np.arange(self.intervals + 1)

    @cached_property
    def fundamental(self) -> tuple[FloatArray, FloatArray]:
        """C and S, each ``(n, intervals + 1)``."""
        return self.flow.fundamental(self.times)

    @cached_property
    def stacked(self) -> FloatArray:
        """C above S, ``(2n, intervals + 1)``."""
        return np.ascontiguousarray(np.concatenate(self.fundamental))

    @cached_property
    def static(self) -> FloatArray:
        """J, ``(n, intervals + 1)``."""
        return self.flow.static_response(self.times, *self.fundamental)

    @cached_property
    def harmonic(self) -> tuple[tuple[ComplexArray, ComplexArray], ...]:
        """D and D' of each harmonic, each ``(n, intervals + 1)``."""
        C, S = self.fundamental
        return tuple(self.flow.harmonic_response(h, self.times, C, S) for h in range(len(self.flow.harmonics)))

    @cached_property
    def forced_rows(self) -> tuple[FloatArray, tuple[ComplexArray, ...]]:
        """Displacement above velocity at the stops, from rest: constant load, and each harmonic's."""
        C, S = self.fundamental
        load = self.rows * self.flow.load
        static = np.concatenate((load @ self.static, load @ S))
        waves = tuple(
            np.concatenate(((self.rows * F) @ D, (self.rows * F) @ dD))
            for (_, F), (D, dD) in zip(self.flow.harmonics, self.harmonic, strict=True)
        )
        return static, waves

    def stop_motion(self, t: float, q: FloatArray, v: FloatArray) -> FloatArray:
        """Displacement above velocity at the stops, ``(2 stops, intervals + 1)``, from ``(q, v)`` at `t`."""
        flow, R = self.flow, self.rows
        Rv = R * v
        start = np.concatenate(
            (
                np.concatenate((R * q, Rv), axis=1),
                np.concatenate((Rv, R * (-(flow.omega**2) * q - 2 * flow.sigma * v)), axis=1),
            )
        )
        static, waves = self.forced_rows
        motion: FloatArray = start @ self.stacked + static
        for (Omega, _), wave in zip(flow.harmonics, waves, strict=True):
            motion += (np.exp(1j * Omega * t) * wave).imag
        return motion

    def advance(self, t: float, q: FloatArray, v: FloatArray, k: int) -> tuple[FloatArray, FloatArray]:
        """The modal state `k` intervals after `t`."""
        flow = self.flow
        C, S = self.fundamental[0][:, k], self.fundamental[1][:, k]
        q1 = q * C + v * S + flow.load * self.static[:, k]
        v1 = v * (C - 2 * flow.sigma * S) - flow.omega**2 * (q * S) + flow.load * S
        for (Omega, F), (D, dD) in zip(flow.harmonics, self.harmonic, strict=True):
            amplitude = F * np.exp(1j * Omega * t)
            q1 += (amplitude * D[:, k]).imag
            v1 += (amplitude * dD[:, k]).imag
        return q1, v1

    @cached_property
    def decays(self) -> FloatArray:
        """How far each mode's envelope has decayed at the start of each interval, ``(n, intervals)``."""
        return np.exp(-Bounds(self.flow).decay[:, None] * self.times[:-1])


@dataclass(frozen=True)
class Watch:
    """Watches the stops during one contact state.

    Parameters
    ----------
    flow : Flow
        The motion in this state.
    rows, offsets : ndarray
        Switch functions ``rows @ q + offsets``, of shape ``(stops, n)`` and ``(stops,)``.
    step : float
        The coarsest interval, s.  It changes the effort only, not the result.
    """

    flow: Flow
    rows: FloatArray
    offsets: FloatArray
    step: float
    _tables: dict[int, Table] = field(default_factory=dict, repr=False)

    @property
    def window(self) -> float:
        """Time that one coarse scan covers, s."""
        return self.step * _FIRST

    @cached_property
    def bounds(self) -> Bounds:
        """Envelopes of the flow."""
        return Bounds(self.flow)

    @cached_property
    def _magnitudes(self) -> FloatArray:
        return np.abs(self.rows)

    @cached_property
    def _steady_curvature(self) -> tuple[FloatArray, FloatArray]:
        """Largest second and third derivative of the response in step with the loads, each ``(stops, 1)``."""
        second = np.zeros((self.rows.shape[0], 1))
        third = np.zeros_like(second)
        for (Omega, _), p in zip(self.flow.harmonics, self.bounds.steady, strict=True):
            amplitude = np.abs(self.rows @ p)[:, None]
            second += amplitude * Omega**2
            third += amplitude * Omega**3
        return second, third

    def table(self, level: int) -> Table:
        """The table of a level of division, 0 the coarsest."""
        if level not in self._tables:
            n = _FIRST if level == 0 else _DIVISION
            self._tables[level] = Table(self.flow, self.rows, self.step / _DIVISION**level, n)
        return self._tables[level]

    def first_switch(self, t: float, q: FloatArray, v: FloatArray, end: float) -> Switch:
        """The first switch after `t`, or the state at `end` with no stops if nothing switches before.

        ``q`` and ``v`` of shape ``(n,)`` are the modal state at `t`.
        """
        while end > t:
            hit = self._scan(0, t, q, v, end) if self.rows.size else None
            if hit is not None and hit.t <= end:
                return hit
            if t + self.window >= end:
                q, v = self._at(t, q, v, end - t)
                break
            q, v = self.table(0).advance(t, q, v, _FIRST)
            t += self.window
        return Switch(end, (), q, v)

    def _at(self, t: float, q: FloatArray, v: FloatArray, tau: float) -> tuple[FloatArray, FloatArray]:
        q1, v1 = self.flow.motion(t, q, v, np.array([tau]))
        return q1[:, 0], v1[:, 0]

    def _scan(self, level: int, t: float, q: FloatArray, v: FloatArray, end: float) -> Switch | None:
        """The first switch in one table's span from `t`, or None."""
        table = self.table(level)
        motion = table.stop_motion(t, q, v)
        stops = self.rows.shape[0]
        s = motion[:stops] + self.offsets[:, None]
        ds = motion[stops:]
        s[:, 0] = np.minimum(s[:, 0], 0.0)
        clear, rising = self._verdict(table, self.bounds.envelope(t, q, v, table.h * table.intervals), s, ds)
        crossing = rising & (s[:, :-1] <= 0) & (s[:, 1:] > 0)
        undecided = ~(clear | crossing)
        for k in np.flatnonzero(np.any(crossing | undecided, axis=0)):
            t_k = t + table.times[k]
            if t_k > end:
                break
            q_k, v_k = table.advance(t, q, v, int(k))
            if not np.any(undecided[:, k]):
                return self._switch(t_k, q_k, v_k, table.h, np.flatnonzero(crossing[:, k]))
            hit = self._divide(level, t_k, q_k, v_k, end, s[:, k + 1] > 0)
            if hit is not None:
                return hit
        return None

    def _divide(
        self, level: int, t: float, q: FloatArray, v: FloatArray, end: float, closing: np.ndarray
    ) -> Switch | None:
        if level + 1 < _LEVELS:
            return self._scan(level + 1, t, q, v, end)
        stops = np.flatnonzero(closing)
        return self._switch(t, q, v, self.table(level).h, stops) if stops.size else None

    def _verdict(
        self, table: Table, envelope: Envelope, s: FloatArray, ds: FloatArray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Which intervals are clear of a switch, and in which s' > 0 throughout; each ``(stops, intervals)``."""
        h2 = table.h**2 / 8
        second, third = self._steady_curvature
        slack = np.minimum(envelope.acceleration * h2, 2 * envelope.displacement)
        slack_rate = np.minimum(envelope.jerk * h2, 2 * envelope.velocity)
        deviation = (self._magnitudes * slack) @ table.decays + second * h2
        deviation_rate = (self._magnitudes * slack_rate) @ table.decays + third * h2
        a, b, da, db = s[:, :-1], s[:, 1:], ds[:, :-1], ds[:, 1:]
        rising = np.minimum(da, db) > deviation_rate
        falling = np.maximum(da, db) < -deviation_rate
        clear = (np.maximum(a, b) + deviation <= 0) | (falling & (a <= 0)) | (rising & (b <= 0))
        return clear, rising

    def _switch(self, t: float, q: FloatArray, v: FloatArray, h: float, stops: np.ndarray) -> Switch:
        """The earliest of the single crossings of `stops` in the interval of length `h` from `t`."""
        roots = np.array([self._crossing(int(j), t, q, v, h) for j in stops])
        first = float(np.min(roots))
        together = stops[roots <= first + _TIE * self.step]
        q, v = self._at(t, q, v, first)
        return Switch(t + first, tuple(int(j) for j in together), q, v)

    def _crossing(self, j: int, t: float, q: FloatArray, v: FloatArray, h: float) -> float:
        """Elapsed time at which switch function `j` rises through zero within ``[0, h]``: safeguarded Newton."""
        row, offset = self.rows[j], self.offsets[j]
        low, high = 0.0, h
        s, ds = float(row @ q) + offset, float(row @ v)
        if s >= 0:
            return 0.0
        tau = min(-s / ds, h) if ds > 0 else 0.5 * h
        for _ in range(100):
            q1, v1 = self._at(t, q, v, tau)
            s, ds = float(row @ q1) + offset, float(row @ v1)
            low, high = (tau, high) if s < 0 else (low, tau)
            guess = tau - s / ds if ds > 0 else low
            if not low < guess < high:
                guess = 0.5 * (low + high)
            moved, tau = abs(guess - tau), guess
            # The next Newton step would be of the order of this one squared over h: below rounding.
            if moved <= 1e-8 * h or high - low <= 1e-16 * t:
                break
        return tau
