"""Motions of the finite element model with a given contact sequence, and their derivatives.

An arc is the motion from one switch to the next; `lapjoint.orbits.arcs` says how arcs are used.  Within an arc the
motion y = (q, q') is the forced motion p and a free one,

    y(t + d) = p(t + d) + F(d) (y(t) - p(t)),

and the orthogonal map S takes it from the modes of one contact state to those of the next.  If the switch
between two arcs comes later, all other times fixed, the motion of the second arc changes, at a fixed time just after
the switch, at the rate

    S f- - f+ = (0, S q''- - q''+),

with f- and f+ the rates before and after.  Displacements and velocities are continuous.  Accelerations differ by the
damping of the two states, and by the force of the stop that switches, where this force is not zero.  The derivative by
the duration of an arc is the sum of the derivatives by the times of its end and of all later ends.

Where the stop that ends an arc also began it, the equation of the event is the mean rate of its gap function h over the
arc,

    (h(d) - h(0)) / d = int_0^1 h'(s d) ds.

The derivative of this mean by the time of the arc's end is int_0^1 s h''(s d) ds.  By the time of the start, moved
along the arc, it is int_0^1 (1 - s) h''(s d) ds.  The means are sums over modes and loads; a load is an undamped mode
here.  For a fast mode they are computed from differences between both ends, divided by powers of d.  For a slow mode,
one that turns, rises or falls by at most 1 over the arc, they are integrals by Gauss' rule, which do not cancel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.section_points import coordinates_of, section_point
from fe_lapjoint.march.system import System
from fe_lapjoint.march.tangent import DEAD, responses
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.arcs import Chain, ContactSequence
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.problem import FloatArray, Problem

_POINTS, _WEIGHTS = np.add(np.polynomial.legendre.leggauss(8), [[1.0], [0.0]]) / 2
"""Gauss' rule on [0, 1]: exact to rounding for exponentials that turn, rise or fall by up to 1."""


@dataclass(frozen=True)
class Arcs:
    """The closed form of a problem's motion on a mesh in all of its contact states; see `lapjoint.orbits.arcs.Arcs`."""

    model: Model
    """The problem on a mesh."""
    omega: float
    """Angular frequency of the excitation, rad/s."""

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.model.problem

    @property
    def period(self) -> float:
        """The excitation period, s."""
        return 2 * math.pi / self.omega

    @in_one_thread
    def chain(
        self,
        sequence: ContactSequence,
        start: FloatArray,
        time: float,
        durations: FloatArray,
        derivatives: bool = True,
        number: str | None = None,
    ) -> Chain:
        """Follow arcs. See `lapjoint.orbits.arcs.Arcs.chain`.

        Backwards in time fast modes grow: values that overflow are infinite or NaN.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            arcs = list(self._arcs(sequence, start, time, durations))
            events = np.array([arc.equation for arc in arcs[:-1]])
            end_by, events_by = self._derivatives(arcs) if derivatives else (None, None)
        starts, times = tuple(arc.y for arc in arcs), np.array([arc.start for arc in arcs])
        return Chain(starts, times, arcs[-1].end, events, end_by, events_by)

    def _arcs(self, sequence: ContactSequence, start: FloatArray, time: float, durations: FloatArray) -> Iterator[_Arc]:
        y, t, before, ends = start, time, None, zip(sequence.stops, sequence.returning, strict=True)
        for state, duration in zip(sequence.states, durations.tolist(), strict=True):
            if before is not None:
                y = (before.end.reshape(2, -1) @ self.model.transfer(before.state, state).T).ravel()
            before = _Arc(self.model, self.model.system(state), t, duration, y, *next(ends, (-1, False)))
            yield before
            t += duration

    def _derivatives(self, arcs: list[_Arc]) -> tuple[FloatArray, FloatArray]:
        """Derivatives of the end and of the events, ``(2 n, 2 n + M + 1)`` and ``(M, 2 n + M + 1)``, for ``n`` modes.

        Only modes whose free motion has not died out by the end of an arc are carried.  The columns are derivatives by
        the start's coordinates that are alive at the end of the first arc, and by the times of the ends of arcs.
        """
        first, last, n = arcs[0], arcs[-1], arcs[-1].system.omega.size
        there = np.zeros((first.alive, 2, 2 * first.alive + len(arcs)))
        modes = np.arange(first.alive)
        there[modes, 0, modes] = there[modes, 1, first.alive + modes] = 1.0
        there, before, events = first.flown(there), first, np.zeros((len(arcs) - 1, there.shape[2]))
        for i, arc in enumerate(arcs):
            end = 2 * first.alive + i
            if i:
                S, jump = self.model.transfer(before.state, arc.state)[:, : before.alive], self._jump(before, arc)
                if arc.returning:
                    events[i] = (arc.mean.by_start @ S).T.ravel() @ there.reshape(2 * before.alive, events.shape[1])
                    events[i, end - 1] += arc.mean.by_start[1] @ jump + arc.mean.by_shifted_start
                    events[i, end] = arc.mean.by_end
                passed = S[: arc.alive] @ there.reshape(before.alive, 2 * events.shape[1])
                there = passed.reshape(arc.alive, 2, events.shape[1])
                there[:, 1, end - 1] += jump[: arc.alive]
                there, before = arc.flown(there), arc
            if arc.stop >= 0 and not arc.returning:
                events[i] = arc.row[: arc.alive] @ there[:, 0]
                events[i, end] = arc.rate
        by_end = np.zeros((2 * n, events.shape[1]))
        by_end[: last.alive], by_end[n : n + last.alive] = there[:, 0], there[:, 1]
        by_end[:, -1] = last.system.rates(last.start + last.duration, last.end)
        return _by_durations(by_end, first), _by_durations(events, first)

    def _jump(self, before: _Arc, after: _Arc) -> FloatArray:
        """S q''- - q''+ between two arcs, in the modes of the second, kg^1/2 m/s2, shape ``(n,)``."""
        n, k = after.system.omega.size, before.stop
        drag = 2 * before.system.damping_rate * before.end[n:]
        jump = 2 * after.system.damping_rate * after.y[n:] - self.model.transfer(before.state, after.state) @ drag
        force = (1 if k in after.state else -1) * self.model.sign[k] * self.model.stiffness[k] * before.h
        return np.asarray(jump + force * after.system.stops[k])

    @in_one_thread
    def motion(self, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> Motion:
        """The arcs as sums of exponentials. See `lapjoint.orbits.arcs.Arcs.motion`."""
        states, stops = sequence.states, self.problem.structure.stops
        keys = [stop.place for stop in stops]
        places = np.array([keys.index(place) for place in sorted(set(keys))], dtype=np.intp)
        sums = {state: self.model.system(state) for state in states}
        K = max(system.exponentials[0].size + system.driven.size for system in sums.values())
        rates, amplitudes = np.zeros((2, len(states), K), dtype=complex)
        weights = np.zeros((len(states), places.size, K), dtype=complex)
        polynomial = np.zeros((len(states), places.size, 3))
        for state, system in sums.items():
            here = np.array([i for i, other in enumerate(states) if other == state])
            own, modes = system.exponentials
            H = system.driven.size
            free = np.array([chain.starts[i] - forced(system, float(chain.times[i])) for i in here]).T
            terms, drift = system.amplitudes_of(*np.split(free, 2))
            angle = np.multiply.outer(chain.times[here], system.driven) + system.phase
            rates[here, : own.size + H] = np.concatenate([own, 1j * system.driven])
            amplitudes[here, : own.size + H] = np.concatenate([terms.T, -1j * np.exp(1j * angle)], axis=1)
            shares = [system.stops[:, modes], system.stop_amplitudes]
            weights[here, :, : own.size + H] = np.concatenate(shares, axis=1)[places]
            polynomial[here] = system.polynomial[places]
            polynomial[here, :, :2] += drift[places].transpose(2, 0, 1)
        closed = np.array([[k in state for k in range(len(stops))] for state in states], dtype=bool)
        return Motion(
            start=chain.times - chain.times[0],
            duration=np.array(durations, dtype=float),
            rates=rates,
            amplitudes=amplitudes,
            weights=weights,
            polynomial=polynomial,
            orientation=np.where(closed, -1.0, 1.0).reshape(len(states), len(stops)),
        )

    @in_one_thread
    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """(q, q') some time later. See `lapjoint.orbits.arcs.Arcs.later`."""
        with np.errstate(over="ignore", invalid="ignore"):
            return _Arc(self.model, self.model.system(state), time, duration, start).end

    @in_one_thread
    def point(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        """A section point. See `lapjoint.orbits.arcs.Arcs.point`."""
        return section_point(self.model, state, coordinates)

    @in_one_thread
    def coordinates(self, point: SectionPoint) -> FloatArray:
        """(q, q') of a section point. See `lapjoint.orbits.arcs.Arcs.coordinates`."""
        return coordinates_of(self.model, point)

    def unit_norms(self, state: ContactState) -> FloatArray:
        """Sizes of units of (q, q'), kg^1/2 m. See `lapjoint.orbits.arcs.Arcs.unit_norms`."""
        return np.repeat([1.0, 1 / self.omega], self.model.system(state).omega.size)


def forced(system: System, t: float, since: float = 0.0) -> FloatArray:
    """Forced motion (q, q') at time `t`, s, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``.

    Rigid-body modes have drifted under the constant forces for `since` seconds, from 0 at the start of the arc.
    """
    by_loads, constant = system.motion_by_loads
    motion = by_loads @ np.exp(1j * (system.driven * t + system.phase)).view(float) + constant
    if system.drift is not None:
        ramp, fall = system.drift
        motion += np.concatenate([since * ramp + since**2 / 2 * fall, since * fall])
    return np.asarray(motion)


@dataclass(frozen=True)
class _MeanRate:
    """The mean rate of a stop's gap function h over an arc, (h(end) - h(start)) / d, at any d."""

    value: float
    """The mean rate, m/s."""
    by_start: FloatArray
    """Its derivatives by (q, q') at the start, shape ``(2, n)``."""
    by_shifted_start: float
    """Its derivative by the time of the start, which moves along the arc while the end stays, m/s2."""
    by_end: float
    """Its derivative by the time of the end, m/s2."""


@dataclass(frozen=True)
class _Arc:
    """The motion of ``n`` modes in one contact state from a start on."""

    model: Model
    """The problem on a mesh."""
    system: System
    """The contact state."""
    start: float
    """Start of the arc, s."""
    duration: float
    """Duration of the arc, s, of either sign."""
    y: FloatArray
    """(q, q') at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    stop: int = -1
    """The stop that switches at the end; -1 if none does."""
    returning: bool = False
    """Whether the stop that switches at the end also switched at the start."""

    @property
    def state(self) -> ContactState:
        return self.system.state

    @cached_property
    def alive(self) -> int:
        """Number of the lowest modes up to the last one whose free motion has not died out at the end."""
        modes = np.flatnonzero(self.system.slowest_decay * self.duration < DEAD)
        return int(modes[-1]) + 1 if modes.size else 0

    @cached_property
    def _free(self) -> FloatArray:
        """The free motion at the start, ``(n, 2, 1)``."""
        return (self.y - forced(self.system, self.start)).reshape(2, -1).T[:, :, None]

    @cached_property
    def _responses(self) -> tuple[FloatArray, FloatArray]:
        return responses(self.system, self.duration, self.system.omega.size)

    def flown(self, deviations: FloatArray) -> FloatArray:
        """Free motions (q, q') of the lowest modes at the end, from those motions at the start, ``(count, 2, m)``."""
        count = deviations.shape[0]
        C, S = (part[:count] for part in self._responses)
        a, omega = self.system.damping_rate[:count, None], self.system.omega[:count, None]
        q, v = deviations[:, 0], deviations[:, 1]
        flown = np.empty_like(deviations)
        flown[:, 0], flown[:, 1] = C * q + S * v, (C - 2 * a * S) * v - omega**2 * S * q
        return flown

    @cached_property
    def end(self) -> FloatArray:
        """(q, q') at the end, ``(2 n,)``."""
        free = self.flown(self._free)[:, :, 0].T.ravel()
        return np.asarray(free + forced(self.system, self.start + self.duration, self.duration))

    @cached_property
    def row(self) -> FloatArray:
        """Factor of each mode in the gap function of the stop that switches, kg^-1/2, shape ``(n,)``."""
        return np.asarray(self.model.sign[self.stop] * self.system.stops[self.stop])

    @property
    def h(self) -> float:
        """Gap function of the stop that switches, at the end, m."""
        seen = self.system.seen_motion(np.array([self.start + self.duration]))[self.stop, 0]
        return float(
            self.row @ self.end[: self.row.size] + self.model.sign[self.stop] * seen - self.model.gap[self.stop]
        )

    @property
    def rate(self) -> float:
        """Rate of `h`, m/s."""
        seen = self.system.seen_motion(np.array([self.start + self.duration]), 1)[self.stop, 0]
        return float(self.row @ self.end[self.row.size :] + self.model.sign[self.stop] * seen)

    @property
    def equation(self) -> float:
        """Left side of the equation of the event at the end, m or m/s."""
        return self.mean.value if self.returning else self.h

    @cached_property
    def mean(self) -> _MeanRate:
        """Mean rate over the arc of the gap function of the stop that switches."""
        it, d, sign = self.system, self.duration, self.model.sign[self.stop]
        wave = sign * it.stop_amplitudes[self.stop] * np.exp(1j * (it.driven * self.start + it.phase))
        both = np.concatenate([self._free[:, :, 0].T * self.row, [wave.imag, it.driven * wave.real]], axis=1)
        a, omega = np.concatenate([it.damping_rate, np.zeros_like(it.driven)]), np.concatenate([it.omega, it.driven])
        means = _means(a, omega, d)
        value, early, late = np.einsum("kij,ij->k", means, both).tolist()
        _, speed, bend = (sign * it.polynomial[self.stop]).tolist()
        by_start = self.row * means[0, :, : self.row.size]
        return _MeanRate(value + speed + bend * d, by_start, early + bend, late + bend)


def _means(a: FloatArray, omega: FloatArray, d: float) -> FloatArray:
    """Means over a time `d`, s, of free modes with damping rates and frequencies ``(n,)``, shape ``(3, 2, n)``.

    The first mean is of the velocity.  The other two are of the acceleration, weighted by the fraction of the time that
    is left, and by the fraction that has passed.  Each mean is given after a unit displacement, and after a unit
    velocity.
    """
    slow = np.where(omega > a, omega, a + np.sqrt(np.maximum(a**2 - omega**2, 0.0))) * abs(d) <= 1
    means = np.empty((3, 2, a.size))
    if slow.any():
        v, bend = _rates(a[slow], omega[slow], d * _POINTS)[1:]
        means[:, :, slow] = v @ _WEIGHTS, bend @ ((1 - _POINTS) * _WEIGHTS), bend @ (_POINTS * _WEIGHTS)
    if not slow.all():
        z, v = (part[:, :, 0] for part in _rates(a[~slow], omega[~slow], np.array([d]))[:2])
        unit, rest = np.eye(2)[:, :, None]
        mean = (z - unit) / d
        means[:, :, ~slow] = mean, (mean - rest) / d, (v - mean) / d
    return means


def _rates(a: FloatArray, omega: FloatArray, t: FloatArray) -> FloatArray:
    """Displacement, velocity and acceleration of the modes of `_means` at times ``(m,)``, shape ``(3, 2, n, m)``."""
    C, S = free_response(a, omega, t)
    a, square = a[:, None], omega[:, None] ** 2
    v = np.array([-square * S, C - 2 * a * S])
    return np.array([[C, S], v, [-square * v[1], -2 * a * v[1] - square * S]])


def _by_durations(columns: FloatArray, first: _Arc) -> FloatArray:
    """Derivatives by all coordinates and durations, from those by the alive coordinates and the ends of arcs."""
    n, alive = first.system.omega.size, first.alive
    whole = np.zeros((columns.shape[0], 2 * n + columns.shape[1] - 2 * alive))
    whole[:, :alive], whole[:, n : n + alive] = columns[:, :alive], columns[:, alive : 2 * alive]
    whole[:, 2 * n :] = np.cumsum(columns[:, 2 * alive :][:, ::-1], axis=1)[:, ::-1]
    return whole
