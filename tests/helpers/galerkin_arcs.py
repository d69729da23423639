"""Arcs of a cantilever with stops by a few Galerkin modes and matrix exponentials: a third solver, for tests alone.

EI = m = L = 1.  The coordinates of every contact state are those of the clamped-free modes: passages lose nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from lapjoint import BaseMotion, Beam, Problem, Stop, Support
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.orbits.arcs import Chain, ContactSequence
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.options import ContinuationOptions
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import Resolution
from lapjoint.orbits.branches.sequence_changes import nearest
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.problem import FloatArray

AMPLITUDE = "base_motion.amplitude"


@lru_cache
def clamped_free(modes: int, x: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Frequencies, mass-normalised shapes at x, and integrals of the shapes of the first modes."""
    z = np.array(
        [
            brentq(lambda z: np.cos(z) + 1 / np.cosh(z), (n - 0.5) * np.pi - 0.35, (n - 0.5) * np.pi + 0.35)
            for n in range(1, modes + 1)
        ]
    )
    s = (np.sinh(z) - np.sin(z)) / (np.cosh(z) + np.cos(z))
    shape = (np.cosh(z * x) - np.cos(z * x)) - s * (np.sinh(z * x) - np.sin(z * x))
    return z**2, shape, 2 * s / z


def base_of(problem: Problem) -> BaseMotion:
    """The sine of the base of a problem that has one."""
    assert isinstance(problem.base_motion, BaseMotion)
    return problem.base_motion


class State:
    """x' = A x + e + Re(F exp(i w t)) of one contact state."""

    def __init__(self, A: FloatArray, e: FloatArray, F: ComplexArray, w: float) -> None:
        self.A, self.w = A, w
        self.rates, self.V = np.linalg.eig(A)
        self.inverse = np.linalg.inv(self.V)
        self.static, self.X = -np.linalg.solve(A, e), np.linalg.solve(1j * w * np.eye(len(e)) - A, F)

    def forced(self, t: float, dt: int = 0) -> FloatArray:
        """The forced motion, and its derivatives by time."""
        wave = (self.X * (1j * self.w) ** dt * np.exp(1j * self.w * t)).real
        return np.asarray(self.static + wave if dt == 0 else wave)

    def flow(self, duration: float) -> FloatArray:
        """The transition matrix."""
        return np.asarray(((self.V * np.exp(self.rates * duration)) @ self.inverse).real)


def _phi(z: FloatArray) -> FloatArray:
    """(exp(z) - 1) / z."""
    small = np.abs(z) < 1e-3
    safe = np.where(small, 1.0, z)
    series = 1 + z / 2 * (1 + z / 3 * (1 + z / 4 * (1 + z / 5)))
    return np.where(small, series, np.expm1(safe) / safe)


def _phi_slope(z: FloatArray) -> FloatArray:
    """Derivative of `_phi`."""
    small = np.abs(z) < 1e-2
    safe = np.where(small, 1.0, z)
    series = 0.5 + z / 3 + z**2 / 8 + z**3 / 30 + z**4 / 144 + z**5 / 840
    return np.where(small, series, (np.exp(safe) * (safe - 1) + 1) / safe**2)


@dataclass(frozen=True)
class GalerkinArcs:
    """The arcs of one problem."""

    problem: Problem
    modes: int
    zeta: float
    viscous: bool = False

    @cached_property
    def omega(self) -> float:
        """Excitation frequency."""
        return float(base_of(self.problem).angular_frequency)

    @property
    def period(self) -> float:
        """Excitation period."""
        return 2 * np.pi / self.omega

    @cached_property
    def _states(self) -> dict[ContactState, State]:
        return {}

    def shapes(self, x: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Frequencies without contact, mass-normalised shapes at x, and integrals of the shapes over the mass."""
        return clamped_free(self.modes, x)

    def row(self, stop: int) -> FloatArray:
        """Displacement at a stop from (q, v)."""
        return np.concatenate([self.shapes(self.problem.stops[stop].x)[1], np.zeros(self.modes)])

    def state(self, closed: ContactState) -> State:
        """One contact state."""
        if closed not in self._states:
            natural, _, part = self.shapes(self.problem.beam.length)
            K, e, N = np.diag(natural**2), np.zeros(self.modes), self.modes
            for k in closed.closed:
                stop, phi = self.problem.stops[k], self.row(k)[:N]
                K = K + stop.stiffness * np.outer(phi, phi)
                e = e + stop.stiffness * stop.gap * stop.sign * phi
            squares, P = np.linalg.eigh(K)
            C = P @ np.diag(2 * self.zeta * np.sqrt(squares)) @ P.T
            if self.viscous:
                C = 2 * self.zeta * natural[0] * np.eye(N)
            A = np.block([[np.zeros((N, N)), np.eye(N)], [-K, -C]])
            F = -1j * np.concatenate([np.zeros(N), part * base_of(self.problem).amplitude * self.omega**2])
            self._states[closed] = State(A, np.concatenate([np.zeros(N), e]), F, self.omega)
        return self._states[closed]

    def chain(
        self,
        sequence: ContactSequence,
        start: FloatArray,
        time: float,
        durations: FloatArray,
        derivatives: bool = True,
        number: str | None = None,
    ) -> Chain:
        """See `lapjoint.orbits.Arcs.chain`."""
        n, M = start.size, len(sequence.stops)
        x, X, t, dt = start, np.eye(n, n + M + 1), time, np.zeros(n + M + 1)
        starts, times, events, rows = [], [], [], []
        for i, (closed, d) in enumerate(zip(sequence.states, durations, strict=True)):
            state = self.state(closed)
            starts.append(x)
            times.append(t)
            E, e = state.flow(d), np.eye(n + M + 1)[n + i]
            free, free_by = x - state.forced(t), X - np.outer(state.forced(t, 1), dt)
            y = E @ free + state.forced(t + d)
            rate = state.A @ (E @ free) + state.forced(t + d, 1)
            Y = E @ free_by + np.outer(state.forced(t + d, 1), dt) + np.outer(rate, e)
            if i < M:
                stop = self.problem.stops[sequence.stops[i]]
                row = stop.sign * self.row(sequence.stops[i])
                if sequence.returning[i]:
                    z, w = state.rates * d, 1j * self.omega * d
                    own, wave = (row @ state.V) * state.rates, (row @ state.X) * np.exp(1j * self.omega * t)
                    at = (own * _phi(z)) @ state.inverse
                    turning = 1j * self.omega * wave
                    events.append((at @ free + turning * _phi(np.array(w))).real)
                    slope = ((own * state.rates * _phi_slope(z)) @ state.inverse) @ free
                    slope += turning * 1j * self.omega * _phi_slope(np.array(w))
                    moved = at @ free_by + turning * 1j * self.omega * _phi(np.array(w)) * dt
                    rows.append(moved.real + slope.real * e)
                else:
                    events.append(row @ y - stop.gap)
                    rows.append(row @ Y)
            x, X, t, dt = y, Y, t + d, dt + e
        known = (X, np.array(rows).reshape(M, n + M + 1)) if derivatives else (None, None)
        return Chain(tuple(starts), np.array(times), x, np.array(events), *known)

    def motion(self, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> Motion:
        """See `lapjoint.orbits.Arcs.motion`."""
        stops = self.problem.stops
        _, first = np.unique([stop.x for stop in stops], return_index=True)
        rates, weights, amplitudes, polynomial = [], [], [], []
        for closed, x, t in zip(sequence.states, chain.starts, chain.times, strict=True):
            state, rows = self.state(closed), np.array([self.row(int(k)) for k in first])
            rates.append(np.append(state.rates, 1j * self.omega))
            weights.append(np.concatenate([rows @ state.V, (rows @ state.X)[:, None]], axis=1))
            amplitudes.append(np.append(state.inverse @ (x - state.forced(t)), np.exp(1j * self.omega * t)))
            polynomial.append(np.outer(rows @ state.static, [1.0, 0.0, 0.0]))
        orientation = [[-1.0 if k in closed else 1.0 for k in range(len(stops))] for closed in sequence.states]
        return Motion(
            np.ascontiguousarray(chain.times - chain.times[0]),
            np.ascontiguousarray(durations),
            np.array(rates, dtype=complex),
            np.array(amplitudes, dtype=complex),
            np.array(weights, dtype=complex),
            np.array(polynomial),
            np.array(orientation),
        )

    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """See `lapjoint.orbits.Arcs.later`."""
        its = self.state(state)
        return its.flow(duration) @ (start - its.forced(time)) + its.forced(time + duration)

    def point(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        """See `lapjoint.orbits.Arcs.point`."""
        return SectionPoint(state, coordinates.reshape(2, -1))

    def coordinates(self, point: SectionPoint) -> FloatArray:
        """See `lapjoint.orbits.Arcs.coordinates`."""
        return point.coordinates.ravel()

    def unit_norms(self, state: ContactState) -> FloatArray:
        """See `lapjoint.orbits.Arcs.unit_norms`."""
        return np.repeat([1.0, 1 / self.omega], self.modes)

    @property
    def without_contact(self) -> FloatArray:
        """(q, v) of the periodic motion without contact at time 0."""
        return self.state(FREE).forced(0.0)


def first_graze(arcs: GalerkinArcs, amplitude: float) -> float:
    """Y = min gap / |H|, of a joint that is driven at the amplitude."""
    answers = [abs(arcs.row(k) @ arcs.state(FREE).X) / amplitude for k in range(len(arcs.problem.stops))]
    return float(min(stop.gap / answer for stop, answer in zip(arcs.problem.stops, answers, strict=True)))


class GalerkinResolution(Resolution):
    """One number of modes over a range of the amplitude or the frequency."""

    kind = GalerkinArcs

    def __init__(
        self, problem: Problem, path: str, low: float, high: float, modes: int, zeta: float, viscous: bool = False
    ) -> None:
        name = path.split(".")[1]

        def problem_at(value: float) -> Problem:
            return problem.model_copy(update={"base_motion": base_of(problem).model_copy(update={name: value})})

        super().__init__(None, problem_at, path, low, high, ContinuationOptions())  # type: ignore[arg-type]
        self.modes, self.zeta, self.viscous = modes, zeta, viscous
        self._arcs: dict[float, GalerkinArcs] = {}

    def arcs(self, value: float) -> GalerkinArcs:
        """The arcs at a value of the parameter."""
        if value not in self._arcs:
            if len(self._arcs) > 64:
                self._arcs.clear()
            self._arcs[value] = self.kind(self.problem_at(value), self.modes, self.zeta, self.viscous)
        return self._arcs[value]


def random_joint(rng: np.random.Generator, stops: int) -> tuple[Problem, int, float, bool]:
    """A cantilever with some stops, its number of modes, damping ratio, and whether damping is viscous."""
    omega = 3.516 * float(rng.uniform(0.4, 3.5))
    made = tuple(
        Stop(
            x=1.0 if stops == 1 else float(rng.choice([0.5, 0.73, 1.0])),
            side=str(rng.choice(["top", "bottom"])),
            gap=1e-3 if stops == 1 else float(1e-3 * rng.uniform(0.3, 1.5)),
            stiffness=float(10 ** rng.uniform(0.5, 3)),
        )
        for _ in range(stops)
    )
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=made,
        base_motion=BaseMotion(amplitude=1e-4, angular_frequency=omega),
    )
    return problem, int(rng.choice([4, 8])), float(rng.choice([0.01, 0.02, 0.05])), bool(rng.integers(2))


def before_first_graze(seed: int, index: int, farthest: float) -> tuple[float, GalerkinResolution, FloatArray]:
    """A random joint's first graze in closed form, its resolution up to a multiple of that, and a motion before it."""
    problem, modes, zeta, viscous = random_joint(np.random.default_rng((seed, index)), 1 + index % 4)
    graze = first_graze(GalerkinArcs(problem, modes, zeta, viscous), base_of(problem).amplitude)
    resolution = GalerkinResolution(problem, AMPLITUDE, 0.2 * graze, farthest * graze, modes, zeta, viscous)
    return graze, resolution, np.append(resolution.arcs(0.9 * graze).without_contact, 0.9 * graze)


def towards_graze(resolution: GalerkinResolution, motion: FloatArray) -> CurvePoint:
    """That motion as a point of its curve, its tangent towards larger amplitudes."""
    start = nearest(BoundaryProblem(resolution, ContactSequence(FREE), 2, 0.0), motion)
    assert start is not None
    return start if start.tangent[-1] > 0 else start.turned()


def marched(arcs: GalerkinArcs, point: CurvePoint, periods: int = 1) -> FloatArray:
    """The motion some periods after the section, by an integrator that knows of no sequence: the force law alone."""
    stops, rows = arcs.problem.stops, [arcs.row(k) for k in range(len(arcs.problem.stops))]

    def rate(t: float, y: FloatArray) -> FloatArray:
        closed = tuple(k for k, stop in enumerate(stops) if stop.sign * float(rows[k] @ y) > stop.gap)
        state = arcs.state(ContactState(closed))
        return np.asarray(state.A @ (y - state.forced(t)) + state.forced(t, 1))

    time, start = point.problem.time(point.u), point.u[: point.coordinates]
    # the force law has kinks where a stop switches: steps must be short there, wherever that is
    found = solve_ivp(
        rate, (time, time + periods * arcs.period), start, "DOP853", rtol=1e-9, atol=1e-13, max_step=arcs.period / 400
    )
    return np.asarray(found.y[:, -1])
