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
one that turns, rises or falls by at most 1 over the arc, they are integrals by Gauss' rule, which do not cancel.  Where
damped stops are closed, they are sums over exponentials, see `fe_lapjoint.march.coupled_arcs`.

Where a damped stop opens, the equation may be w m_1 + (1 - w) m_2 with the means m of the two arcs of its contact, of
durations p and r; see `lapjoint.orbits.arcs`.  With the means late_1 of the first and early_2 of the second arc,

    m_2 - m_1 = p late_1 + r early_2,

because the velocity between both arcs is one, so that the part of w in the derivatives does not cancel either.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.coupled import Coupled, CoupledFlow
from fe_lapjoint.march.coupled_arcs import MeanRate, Reading, write_coupled
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.propagator import free_response
from fe_lapjoint.march.section_points import coordinates_of, section_point
from fe_lapjoint.march.system import System
from fe_lapjoint.march.tangent import DEAD, closed_rows, responses
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.arcs import Chain, ContactSequence
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.orbits.watch import awake_rows
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
            events = np.array([_equation(arcs[max(i - 1, 0)], arc) for i, arc in enumerate(arcs[:-1])])
            end_by, events_by = self._derivatives(arcs) if derivatives else (None, None)
        starts, times = tuple(arc.y for arc in arcs), np.array([arc.start for arc in arcs])
        return Chain(starts, times, arcs[-1].end, events, end_by, events_by)

    def _arcs(self, sequence: ContactSequence, start: FloatArray, time: float, durations: FloatArray) -> Iterator[_Arc]:
        y, t, before = start, time, None
        ends = zip(sequence.stops, sequence.returning, sequence.joining, strict=True)
        for state, duration in zip(sequence.states, durations.tolist(), strict=True):
            if before is not None:
                y = (before.end.reshape(2, -1) @ self.model.transfer(before.state, state).T).ravel()
            before = _arc(self.model, state, t, duration, y, *next(ends, (None, False, False)))
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
        began, there, before = there, first.flown(there), first
        events = np.zeros((len(arcs) - 1, there.shape[2]))
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
                if arc.joining:
                    events[i] = _joined(before, arc, began, there, end)
                began, there, before = there, arc.flown(there), arc
            if arc.stop is not None and not arc.returning and not arc.joining:
                events[i] = arc.read(there)
                events[i, end] = arc.rate
        by_end = np.zeros((2 * n, events.shape[1]))
        by_end[: last.alive], by_end[n : n + last.alive] = there[:, 0], there[:, 1]
        by_end[:, -1] = last.system.rates(last.start + last.duration, last.end)
        return _by_durations(by_end, first), _by_durations(events, first)

    def _jump(self, before: _Arc, after: _Arc) -> FloatArray:
        """S q''- - q''+ between two arcs, in the modes of the second, kg^1/2 m/s2, shape ``(n,)``."""
        n, k = after.system.omega.size, before.stop
        assert k is not None
        if self.model.damped or self.model.drags:
            rates = before.system.rates(after.start, before.end)[n:], after.system.rates(after.start, after.y)[n:]
            return np.asarray(self.model.transfer(before.state, after.state) @ rates[0] - rates[1])
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
        K = max(terms_of(system) for system in sums.values())
        rates, amplitudes = np.zeros((2, len(states), K), dtype=complex)
        rows = np.concatenate([places, len(stops) + np.arange(len(self.model.damped))])
        weights = np.zeros((len(states), rows.size, K), dtype=complex)
        polynomial = np.zeros((len(states), rows.size, 3))
        for state, system in sums.items():
            here = np.array([i for i, other in enumerate(states) if other == state])
            if isinstance(system, Coupled):
                for i in here.tolist():
                    flow = CoupledFlow(system, float(chain.times[i]), *chain.starts[i].reshape(2, -1))
                    write_coupled(flow, rows, (rates[i], amplitudes[i], weights[i], polynomial[i]))
                continue
            own, modes = system.exponentials
            H = system.driven.size
            free = np.array([chain.starts[i] - forced(system, float(chain.times[i])) for i in here]).T
            terms, drift = system.amplitudes_of(*np.split(free, 2))
            angle = np.multiply.outer(chain.times[here], system.driven) + system.phase
            rates[here, : own.size + H] = np.concatenate([own, 1j * system.driven])
            amplitudes[here, : own.size + H] = np.concatenate([terms.T, -1j * np.exp(1j * angle)], axis=1)
            shares = [system.stops[:, modes], system.stop_amplitudes]
            weights[here, : places.size, : own.size + H] = np.concatenate(shares, axis=1)[places]
            polynomial[here, : places.size] = system.polynomial[places]
            polynomial[here, : places.size, :2] += drift[places].transpose(2, 0, 1)
        closed = np.array([closed_rows(self.model, state) for state in states]).reshape(len(states), -1)
        return Motion(
            start=chain.times - chain.times[0],
            duration=np.array(durations, dtype=float),
            rates=rates,
            amplitudes=amplitudes,
            weights=weights,
            polynomial=polynomial,
            orientation=np.where(closed, -1.0, 1.0) * awake_rows(stops, closed),
        )

    @in_one_thread
    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """(q, q') some time later. See `lapjoint.orbits.arcs.Arcs.later`."""
        with np.errstate(over="ignore", invalid="ignore"):
            return _arc(self.model, state, time, duration, start).end

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


def terms_of(system: System) -> int:
    """Number of terms of the motion of the places in `Arcs.motion`."""
    if isinstance(system, Coupled):
        return system.rates_of_terms.size - 1
    return int(system.exponentials[0].size + system.driven.size)


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
    stop: int | None = None
    """The stop that switches at the end, or ~k of a force; None if none does."""
    returning: bool = False
    """Whether what switches at the end also switched at the start."""
    joining: bool = False
    """Whether the equation of the end joins this arc and the one before; see `lapjoint.orbits.arcs`."""

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
        assert self.stop is not None
        return np.asarray(self.model.sign[self.stop] * self.system.stops[self.stop])

    @property
    def h(self) -> float:
        """Gap function of the stop that switches, at the end, m."""
        assert self.stop is not None
        seen = self.system.seen_motion(np.array([self.start + self.duration]))[self.stop, 0]
        return float(
            self.row @ self.end[: self.row.size] + self.model.sign[self.stop] * seen - self.model.gap[self.stop]
        )

    @property
    def rate(self) -> float:
        """Rate of `h`, m/s."""
        assert self.stop is not None
        seen = self.system.seen_motion(np.array([self.start + self.duration]), 1)[self.stop, 0]
        return float(self.row @ self.end[self.row.size :] + self.model.sign[self.stop] * seen)

    def read(self, deviations: FloatArray) -> FloatArray:
        """Gap function of the stop that switches, of deviations of the modes alive, ``(alive, 2, m)``; shape
        ``(m,)``."""
        return np.asarray(self.row[: self.alive] @ deviations[:, 0])

    @cached_property
    def mean(self) -> MeanRate:
        """Mean rate over the arc of the gap function of what switches at its end."""
        assert self.stop is not None
        return self.mean_of(self.stop)

    def mean_of(self, stop: int) -> MeanRate:
        """Mean rate over the arc of the gap function of a stop."""
        it, d, sign = self.system, self.duration, self.model.sign[stop]
        row = sign * it.stops[stop]
        wave = sign * it.stop_amplitudes[stop] * np.exp(1j * (it.driven * self.start + it.phase))
        both = np.concatenate([self._free[:, :, 0].T * row, [wave.imag, it.driven * wave.real]], axis=1)
        a, omega = np.concatenate([it.damping_rate, np.zeros_like(it.driven)]), np.concatenate([it.omega, it.driven])
        means = _means(a, omega, d)
        value, early, late = np.einsum("kij,ij->k", means, both).tolist()
        _, speed, bend = (sign * it.polynomial[stop]).tolist()
        by_start = row * means[0, :, : row.size]
        return MeanRate(value + speed + bend * d, by_start, early + bend, late + bend)


@dataclass(frozen=True)
class _CoupledArc(_Arc):
    """The motion of ``n`` modes in a contact state in which damped stops are closed."""

    system: Coupled

    @cached_property
    def _exactly(self) -> CoupledFlow:
        """The motion from the start on."""
        return CoupledFlow(self.system, self.start, *self.y.reshape(2, -1))

    def flown(self, deviations: FloatArray) -> FloatArray:
        """Free motions (q, q') at the end, from those motions at the start, ``(n, 2, m)``."""
        n, m = deviations.shape[0], deviations.shape[2]
        there = self.system.flown(self.duration, deviations.transpose(1, 0, 2).reshape(2 * n, m))
        return there.reshape(2, n, m).transpose(1, 0, 2)

    @cached_property
    def end(self) -> FloatArray:
        """(q, q') at the end, ``(2 n,)``."""
        return self._exactly.at(self.start + self.duration)

    @cached_property
    def _reading(self) -> Reading:
        assert self.stop is not None
        return Reading.of(self.model, self.system, self.stop)

    @property
    def h(self) -> float:
        """Gap function of what switches, at the end, m."""
        return self._reading.value(self.start + self.duration, self.end)

    @property
    def rate(self) -> float:
        """Rate of `h`, m/s."""
        return self._reading.rate(self.start + self.duration, self.end)

    def read(self, deviations: FloatArray) -> FloatArray:
        """Gap function of what switches, of deviations ``(n, 2, m)``; shape ``(m,)``."""
        by_q, by_v = self._reading.row
        return np.asarray(by_q @ deviations[:, 0] + by_v @ deviations[:, 1])

    def mean_of(self, stop: int) -> MeanRate:
        """Mean rate over the arc of the gap function of a stop k, or ~k of a force."""
        return Reading.of(self.model, self.system, stop).mean(self._exactly, self.duration)


def _arc(
    model: Model,
    state: ContactState,
    start: float,
    duration: float,
    y: FloatArray,
    stop: int | None = None,
    returning: bool = False,
    joining: bool = False,
) -> _Arc:
    """An arc in any contact state."""
    system = model.system(state)
    made = _CoupledArc if isinstance(system, Coupled) else _Arc
    return made(model, system, start, duration, y, stop, returning, joining)  # type: ignore[arg-type]


def _equation(before: _Arc, arc: _Arc) -> float:
    """Left side of the equation of the event at the end of an arc, m or m/s; `before` is the arc before."""
    if not arc.joining:
        return arc.mean.value if arc.returning else arc.h
    assert arc.stop is not None
    w = _weight(before.duration, arc.duration)
    return w * before.mean_of(arc.stop).value + (1 - w) * arc.mean.value


def _weight(p: float, r: float) -> float:
    """Weight w of the first of two arcs of durations `p` and `r`, s; see `lapjoint.orbits.arcs`."""
    both = abs(p) + abs(r)
    return abs(p) / both if both > 0 else 0.5


def _joined(before: _Arc, arc: _Arc, began: FloatArray, here: FloatArray, end: int) -> FloatArray:
    """Derivatives of the equation that joins two arcs by the columns of `Arcs._derivatives`, shape ``(m,)``.

    `began` and `here`, ``(n, 2, m)``, are the deviations at the starts of both arcs; the column `end` is of the time of
    the second arc's end.
    """
    assert arc.stop is not None
    w, one, two = _weight(before.duration, arc.duration), before.mean_of(arc.stop), arc.mean
    first, second = (np.einsum("cj,jcm->m", it.by_start, there) for it, there in ((one, began), (two, here)))
    first[end - 2] += one.by_shifted_start
    first[end - 1] += one.by_end
    second[end - 1] += two.by_shifted_start
    second[end] += two.by_end
    alike = -1.0 if before.duration * arc.duration < 0 else 1.0
    by_p = -(1 - w) * (w * one.by_end + alike * (1 - w) * two.by_shifted_start)
    by_r = w * (alike * w * one.by_end + (1 - w) * two.by_shifted_start)
    total = w * first + (1 - w) * second
    total[end - 2 : end + 1] += [-by_p, by_p - by_r, by_r]
    return np.asarray(total)


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
