"""A third solver, that gives the search for periodic motions no more than it must: a rigid bar on its springs.

The bar moves up and down only, so all of it, and every stop, has one displacement z:

    m z'' + c z' + K z = F sin(omega t + phase) + f0

with m = mass_per_length L, K the springs of all supports and closed stops, f0 the closed stops' k gap with their sign,
and F = m Y omega^2.  Damping is `viscous`, c = C L, or `modal`, c = 2 zeta sqrt(K m) in the present contact state.
Between switches z is known in closed form; a switch is the first root of its gap function between the extrema of z,
none of which lies hidden between samples as close as these.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    ContactState,
    History,
    InputError,
    ModalDamping,
    Problem,
    SteadyState,
    Stop,
    Support,
    ViscousDamping,
)
from lapjoint.answers import Contact, Modes, SectionPoint
from lapjoint.errors import SolverError
from lapjoint.orbits import Effort, Passage, find_steady_state
from lapjoint.orbits.displaced import StaticShapes
from lapjoint.problem import FloatArray
from lapjoint.problem.symmetry import mirror_twins
from lapjoint.solver import MODES, Progress

_SAMPLES = 32  # in a cycle of the excitation or of free vibration, whichever is shorter
_MOST_SWITCHES = 1000  # in one period


def bar(
    omega: float,
    *stops: tuple[float, float],
    ratio: float = 0.05,
    amplitude: float = 1.0,
    viscous: bool = True,
) -> Problem:
    """A bar of mass 1 on springs of stiffness 1, with stops given as (gap, stiffness); a negative gap: below."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=0.5), Support(x=1.0, translational=0.5)),
        stops=tuple(
            Stop(x=0.5, side="bottom" if math.copysign(1, gap) < 0 else "top", gap=abs(gap), stiffness=stiffness)
            for gap, stiffness in stops
        ),
        damping=ViscousDamping(coefficient=2 * ratio) if viscous else ModalDamping(ratio=ratio),
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=omega),
    )


@dataclass(frozen=True)
class Stretch:
    """The motion between two switches: z = Re C exp(rate s) + Im P exp(i omega t) + level, with s = t - start."""

    start: float
    state: ContactState
    C: complex
    rate: complex
    P: complex
    omega: float
    level: float
    end: float = math.nan
    switched: int = -1

    def z(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """z or a derivative in time, at times of any shape."""
        t = np.asarray(t, dtype=float)
        free = self.C * self.rate**derivative * np.exp(self.rate * (t - self.start))
        forced = self.P * (1j * self.omega) ** derivative * np.exp(1j * self.omega * t)
        return np.asarray(free.real + forced.imag + (self.level if derivative == 0 else 0.0))

    def until(self, end: float, switched: int) -> Stretch:
        """The same, ended."""
        return replace(self, end=end, switched=switched)


@dataclass(frozen=True)
class BarMap:
    """See `lapjoint.orbits.PeriodMap`; a deviation is that of (z, z')."""

    problem: Problem
    name: str

    @property
    def omega(self) -> float:
        """Angular frequency of the excitation, rad/s."""
        assert self.problem.excitation_frequency is not None
        return self.problem.excitation_frequency

    @property
    def period(self) -> float:
        """The excitation period, s."""
        return 2 * math.pi / self.omega

    @property
    def lowest_damping_rate(self) -> float:
        """Decay of free vibration without contact, 1/s."""
        m, c, _, _ = self.constants(ContactState())
        return c / (2 * m)

    def constants(self, state: ContactState) -> tuple[float, float, float, float]:
        """m, c, K and f0 of a contact state."""
        problem = self.problem
        closed = [problem.stops[k] for k in state.closed]
        L = problem.beam.length
        m = problem.beam.m * L
        K = sum(support.translational for support in problem.supports) + sum(stop.stiffness for stop in closed)
        if isinstance(problem.damping, ViscousDamping):
            c = problem.damping.coefficient * L
        elif isinstance(problem.damping, ModalDamping):
            c = 2 * float(problem.damping.ratios(1)[0]) * math.sqrt(K * m)
        else:
            c = 0.0
        return m, c, K, sum(stop.sign * stop.stiffness * stop.gap for stop in closed)

    def initial(self) -> SectionPoint:
        """The middle of the bar's initial state."""
        x = np.array(self.problem.beam.length / 2)
        start = self.problem.initial
        point = np.array([[float(start.displacement_at(x))], [float(start.velocity_at(x))]])
        return self._settled(ContactState(), point)

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March on, piece by piece of a period."""
        point, impulses, switches = start, np.zeros(len(self.problem.stops)), 0
        for piece in [self.period] * (half_periods // 2) + [self.period / 2] * (half_periods % 2):
            stretches, point = self._piece(point, piece)
            for stretch in stretches:
                switches += stretch.switched >= 0
                for k in stretch.state.closed:
                    impulses[k] += self.impulse(stretch, k)
        return Passage(point, impulses, switches)

    def history(self, start: SectionPoint, periods: int) -> History:
        """The same march, with its contacts."""
        return self._recorded_over(start, [self.period] * periods)

    def simulated(self, duration: float) -> History:
        """The motion from the initial state, in the same pieces."""
        whole = int(duration / self.period * (1 + 1e-12))
        left = duration - whole * self.period
        return self._recorded_over(self.initial(), [self.period] * whole + [left] * (left > 1e-12 * duration))

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """Difference of (z, z')."""
        return np.asarray((point.coordinates - origin.coordinates).ravel())

    def norm(self, deviation: FloatArray) -> float:
        """Of z, and of z' over the excitation frequency."""
        return math.hypot(deviation[0], deviation[1] / self.omega)

    def size(self, point: SectionPoint) -> float:
        """Norm of (z, z')."""
        return self.norm(point.coordinates.ravel())

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """Moved, with the stops open or closed as the gaps then have it."""
        return self._settled(origin.state, origin.coordinates + deviation.reshape(2, 1))

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image."""
        twins = mirror_twins(self.problem)
        assert twins is not None
        return SectionPoint(ContactState(tuple(twins[k] for k in point.state.closed)), -point.coordinates)

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A point of a bar with other stops."""
        if point.coordinates.shape != (2, 1) or point.nodes is not None:
            raise InputError("start: is no section point of a rigid bar")
        return self._settled(point.state, point.coordinates)

    def static_shapes(self, origin: SectionPoint, places: FloatArray) -> StaticShapes:
        """See `DisplacedStarts`; all places move alike."""
        compliance = 1 / self.constants(ContactState())[2]
        one = np.full((len(places), 1), compliance)
        return StaticShapes(one * [1.0, 0.0], one * [0.0, 1.0], np.full((len(places), len(places)), compliance))

    def energy(self, origin: SectionPoint) -> FloatArray:
        """See `DisplacedStarts`."""
        m, _, K, _ = self.constants(ContactState())
        return np.diag([K, m])

    def impulse(self, stretch: Stretch, stop: int) -> float:
        """Time integral of a closed stop's force over a stretch, with the sign of the side, N s."""
        m, c, K, f0 = self.constants(stretch.state)
        a, b = stretch.start, stretch.end
        force, phase = self._load()
        gained = force / self.omega * (math.cos(self.omega * a + phase) - math.cos(self.omega * b + phase))
        z, v = stretch.z([a, b]), stretch.z([a, b], 1)
        area = (gained + f0 * (b - a) - m * (v[1] - v[0]) - c * (z[1] - z[0])) / K
        one = self.problem.stops[stop]
        return float(one.stiffness * (area - one.sign * one.gap * (b - a)))

    def _load(self) -> tuple[float, float]:
        """Amplitude, N, and phase of the load."""
        base = self.problem.base_motion
        assert base is not None
        return self.problem.beam.m * self.problem.beam.length * base.amplitude * self.omega**2, base.phase

    def _settled(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        z = float(coordinates[0, 0])
        closed = [
            k
            for k, stop in enumerate(self.problem.stops)
            if stop.sign * z > stop.gap or (stop.sign * z == stop.gap and k in state)
        ]
        return SectionPoint(ContactState(tuple(closed)), coordinates)

    def _stretch(self, state: ContactState, start: float, z: float, v: float) -> Stretch:
        m, c, K, f0 = self.constants(state)
        force, phase = self._load()
        P = force * cmath.exp(1j * phase) / (K - m * self.omega**2 + 1j * c * self.omega)
        decay = c / (2 * m)
        rate = complex(-decay, math.sqrt(K / m - decay**2))
        forced = P * cmath.exp(1j * self.omega * start)
        a = z - forced.imag - f0 / K
        b = (v - (1j * self.omega * forced).imag + decay * a) / rate.imag
        return Stretch(start, state, complex(a, -b), rate, P, self.omega, f0 / K)

    def _piece(self, point: SectionPoint, until: float) -> tuple[list[Stretch], SectionPoint]:
        """March from a section point to a time within the period."""
        stretches, t, state, last = [], 0.0, point.state, -1
        z, v = (float(value) for value in point.coordinates[:, 0])
        while len(stretches) <= _MOST_SWITCHES:
            stretch = self._stretch(state, t, z, v)
            t, last = self._first_switch(stretch, until, last)
            stretches.append(stretch.until(t, last))
            z, v = float(stretch.z(t)), float(stretch.z(t, 1))
            if last < 0:
                return stretches, SectionPoint(state, np.array([[z], [v]]))
            z = self.problem.stops[last].sign * self.problem.stops[last].gap
            state = state.toggled(last)
        raise SolverError(f"more than {_MOST_SWITCHES} switches in a period")

    def _first_switch(self, stretch: Stretch, until: float, last: int) -> tuple[float, int]:
        """When which stop first switches; -1 if none does before `until`.  `last` is the one that just has."""
        step = min(2 * math.pi / self.omega, 2 * math.pi / stretch.rate.imag) / _SAMPLES
        count = max(2, math.ceil((until - stretch.start) / step) + 1)
        t = np.linspace(stretch.start, until, count)
        v = stretch.z(t, 1)
        turns = np.flatnonzero(v[:-1] * v[1:] < 0)
        t = np.sort(np.concatenate([t, [_root(lambda s: stretch.z(s, 1), t[i], t[i + 1]) for i in turns]]))
        z, found = stretch.z(t), (until, -1)
        for k, stop in enumerate(self.problem.stops):
            side = -1.0 if k in stretch.state else 1.0
            room = side * (stop.gap - stop.sign * z)
            if k == last:
                room[0] = 0.0
            beyond = np.flatnonzero(room[1:] < 0)
            if beyond.size:
                i = int(beyond[0])
                if room[i] > 0:
                    when = _root(lambda s, one=stop: stop_gap(one, stretch, s), t[i], t[i + 1])
                else:  # it touches at the start, and is pressed or left at once
                    when = float(t[i])
                if when < found[0]:
                    found = when, k
        return found

    def _recorded_over(self, point: SectionPoint, pieces: list[float]) -> History:
        stretches: list[Stretch] = []
        offsets: list[float] = []
        for i, piece in enumerate(pieces):
            more, point = self._piece(point, piece)
            stretches += more
            offsets += [i * self.period] * len(more)
        begins = np.array([stretch.start + offset for stretch, offset in zip(stretches, offsets, strict=True)])
        changes = [i for i in range(1, len(stretches)) if stretches[i].state != stretches[i - 1].state]

        def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
            which = np.searchsorted(begins, t, side="right") - 1
            z = [float(stretches[i].z(s - offsets[i], dt)) if dx == 0 else 0.0 for i, s in zip(which, t, strict=True)]
            return np.tile(np.array(z), (x.size, 1))

        return History(
            problem=self.problem,
            solver=self.name,
            start=0.0,
            end=sum(pieces),
            switch_times=begins[changes],
            states=(stretches[0].state, *(stretches[i].state for i in changes)),
            contacts=self._contacts(stretches, offsets),
            field=field,
        )

    def _contacts(self, stretches: list[Stretch], offsets: list[float]) -> tuple[Contact, ...]:
        found = []
        for k, stop in enumerate(self.problem.stops):
            mine: list[list[int]] = []
            for i, stretch in enumerate(stretches):
                if k not in stretch.state:
                    continue
                if mine and mine[-1][-1] == i - 1:
                    mine[-1].append(i)
                else:
                    mine.append([i])
            for group in mine:
                first, last = stretches[group[0]], stretches[group[-1]]
                deepest = max(float(np.max(stop.sign * _samples(stretches[i]))) for i in group)
                found.append(
                    Contact(
                        stop=k,
                        start=first.start + offsets[group[0]],
                        end=last.end + offsets[group[-1]],
                        impulse=sum(self.impulse(stretches[i], k) for i in group),
                        peak_force=stop.stiffness * (deepest - stop.gap),
                        open_start=group[0] == 0,
                        open_end=group[-1] == len(stretches) - 1,
                    )
                )
        return tuple(sorted(found, key=lambda contact: contact.start))


@dataclass(frozen=True)
class Unwilling(BarMap):
    """A map that cannot be marched."""

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """Give up."""
        raise SolverError("stopped at t = 0 s")


@dataclass(frozen=True)
class Bar:
    """The solver of a rigid bar."""

    max_period_multiple: int = 8
    max_periods: int = 16_000

    @property
    def name(self) -> str:
        """Name in a line."""
        return "rigid bar"

    def period_map(self, problem: Problem) -> BarMap:
        """The motion from section point to section point."""
        return BarMap(problem, self.name)

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The one mode."""
        m, _, K, _ = self.period_map(problem).constants(state)

        def shapes(x: FloatArray, derivative: int = 0) -> FloatArray:
            return np.full((1, x.size), 0.0 if derivative else 1 / math.sqrt(m))

        return Modes(state, np.array([math.sqrt(K / m)]), shapes)

    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        """The motion from the initial state."""
        return self.period_map(problem).simulated(duration)

    def refined(self, factor: float) -> Bar:
        """The same: there is nothing to refine."""
        return self

    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        """The motion that remains."""
        effort = Effort(self.max_period_multiple, self.max_periods, growth=sensitivity)
        period_map = self.period_map(problem)
        return find_steady_state(period_map, self.name, effort, start=start, errors=errors, progress=progress)


def stop_gap(stop: Stop, stretch: Stretch, t: float) -> float:
    """How far a stop is open, m; negative where it is pressed."""
    return float(stop.gap - stop.sign * stretch.z(t))


def _root(function: Callable[[float], float], a: float, b: float) -> float:
    return float(brentq(function, a, b, xtol=1e-15, rtol=1e-15))


def _samples(stretch: Stretch) -> FloatArray:
    return stretch.z(np.linspace(stretch.start, stretch.end, 4 * _SAMPLES))
