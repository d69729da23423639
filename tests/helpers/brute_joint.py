"""A joint marched in tiny steps of the matrix exponential, on Hermite elements of its own.

Nothing of a solver is used: no modes of a contact state, no closed form, no bound, no search.  The unknowns are the
nodes' displacements and slopes, their rates, a constant 1, and sine and cosine of every harmonic of the base; the
motion of a contact state is then z' = M z, and each step multiplies by exp(M dt).  A stop of sign s at x is closed
where s (z + y) > gap if it is fixed in space, and where s z > gap if it moves with the base; it pushes with k times
that penetration.  A switch within a step is found by halving the step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, expm

from lapjoint import ModalDamping, NoDamping, Problem
from lapjoint.answers import History
from lapjoint.problem import FloatArray, ViscousDamping

STEPS = 512  # in the shortest period of the base's harmonics
_HALVINGS = 26  # of such a step, to find a switch
_LIGHT = 0.01  # of the largest impulse: whether so light a contact is there, the elements decide
_FIRST = 4  # contacts that are compared


@dataclass(frozen=True)
class BruteContact:
    """One contact."""

    stop: int
    start: float
    """s; the start of the march if the stop is closed there."""
    end: float
    """s; the end of the march if the stop is closed there."""
    impulse: float
    """N s, positive at the top."""
    peak: float
    """N."""


@dataclass(frozen=True)
class BruteMotion:
    """A motion from rest, on a grid of times."""

    t: FloatArray
    """s, ascending; the grid and all switches."""
    z: FloatArray
    """Displacement at each stop, m, shape ``(P, times)``."""
    penetration: FloatArray
    """Penetration of each stop, below 0 where it is open, m, shape ``(P, times)``."""
    contacts: tuple[BruteContact, ...]
    """By their start."""


class BruteJoint:
    """A problem on `elements` equal elements, cut besides at stops and supports."""

    def __init__(self, problem: Problem, elements: int = 14) -> None:
        self.problem = problem
        L = problem.beam.length
        places = [s.x for s in problem.stops] + [s.x for s in problem.supports]
        grid = [float(x) for x in np.linspace(0.0, L, elements + 1)]
        grid = [x for x in grid if min((abs(x - p) for p in places), default=L) > 0.2 * L / elements or x in (0.0, L)]
        nodes = np.array(sorted({*grid, *places}))
        self.K, self.M, self.load = _assembled(nodes, problem.beam.EI, problem.beam.m)
        fixed = set()
        for support in problem.supports:
            node = int(np.argmin(np.abs(nodes - support.x)))
            for i, spring in ((2 * node, support.translational), (2 * node + 1, support.torsional)):
                if math.isinf(spring):
                    fixed.add(i)
                else:
                    self.K[i, i] += spring
        self.free = np.array([i for i in range(2 * nodes.size) if i not in fixed])
        rows = [np.eye(2 * nodes.size)[2 * int(np.argmin(np.abs(nodes - s.x)))][self.free] for s in problem.stops]
        self.rows = np.array(rows).reshape(len(rows), self.free.size)
        self.K, self.M = self.K[np.ix_(self.free, self.free)], self.M[np.ix_(self.free, self.free)]
        self.load = self.load[self.free]
        base = problem.base_motion
        self.waves = () if base is None else base.waves
        self._made: dict[tuple[frozenset[int], float], tuple[FloatArray, FloatArray]] = {}

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 2 * self.free.size + 1 + 2 * len(self.waves)

    def seen(self) -> FloatArray:
        """Rows that give the penetration of each stop from the unknowns, shape ``(P, size)``."""
        n, found = self.free.size, np.zeros((len(self.problem.stops), self.size))
        for k, stop in enumerate(self.problem.stops):
            found[k, :n] = stop.sign * self.rows[k]
            found[k, 2 * n] = -stop.gap
            if stop.fixed_to == "space":
                for h, wave in enumerate(self.waves):
                    found[k, 2 * n + 1 + 2 * h] = stop.sign * wave.amplitude
        return found

    def matrix(self, closed: frozenset[int]) -> FloatArray:
        """M of z' = M z with some stops closed."""
        n, stops = self.free.size, self.problem.stops
        K = self.K + sum((stops[k].stiffness * np.outer(self.rows[k], self.rows[k]) for k in closed), np.zeros((n, n)))
        force, seen = np.zeros((n, self.size)), self.seen()
        force[:, :n] = -self.K
        for k in closed:
            force -= stops[k].sign * stops[k].stiffness * np.outer(self.rows[k], seen[k])
        for h, wave in enumerate(self.waves):
            force[:, 2 * n + 1 + 2 * h] += self.load * wave.amplitude * wave.angular_frequency**2
        force[:, n : 2 * n] -= self._damping(K)
        A = np.zeros((self.size, self.size))
        A[:n, n : 2 * n] = np.eye(n)
        A[n : 2 * n] = np.linalg.solve(self.M, force)
        for h, wave in enumerate(self.waves):
            s = 2 * n + 1 + 2 * h
            A[s, s + 1], A[s + 1, s] = wave.angular_frequency, -wave.angular_frequency
        return A

    def _damping(self, K: FloatArray) -> FloatArray:
        """The damping matrix in the modes of the stiffness `K`."""
        damping = self.problem.damping
        if isinstance(damping, ViscousDamping):
            return np.asarray(damping.coefficient / self.problem.beam.m * self.M)
        if isinstance(damping, NoDamping):
            return np.zeros_like(K)
        assert isinstance(damping, ModalDamping)
        square, shapes = eigh(K, self.M)
        omega = np.sqrt(np.maximum(square, 0.0))
        weighted = self.M @ shapes
        return np.asarray(weighted * (2 * damping.ratios(omega.size) * omega) @ weighted.T)

    def moved(self, closed: frozenset[int], dt: float) -> tuple[FloatArray, FloatArray]:
        """exp(M dt), and its integral over dt."""
        key = closed, dt
        if key not in self._made:
            n = self.size
            both = np.zeros((2 * n, 2 * n))
            both[:n, :n], both[:n, n:] = self.matrix(closed), np.eye(n)
            whole = expm(both * dt)
            self._made[key] = whole[:n, :n], whole[:n, n:]
        return self._made[key]

    def march(self, duration: float) -> BruteMotion:
        """The motion from rest."""
        fastest = max((wave.angular_frequency for wave in self.waves), default=2 * math.pi / duration)
        steps = math.ceil(duration * fastest / (2 * math.pi) * STEPS)
        dt, n, seen = duration / steps, self.free.size, self.seen()
        z = np.zeros(self.size)
        z[2 * n] = 1.0
        for h, wave in enumerate(self.waves):
            z[2 * n + 1 + 2 * h : 2 * n + 3 + 2 * h] = math.sin(wave.phase), math.cos(wave.phase)
        closed = self._at_first(z)
        times, path, area, start = [0.0], [z], dict.fromkeys(closed, 0.0), dict.fromkeys(closed, 0.0)
        deepest, contacts = {k: float(seen[k] @ z) for k in closed}, []
        now, end = 0, steps << _HALVINGS  # in the shortest steps
        while now < end:
            part = min((now & -now).bit_length() - 1, _HALVINGS) if now else _HALVINGS  # a step that ends on the grid
            while True:
                move, integral = self.moved(closed, dt / 2 ** (_HALVINGS - part))
                after = move @ z
                passed = frozenset(k for k, depth in enumerate(seen @ after) if (depth > 0) != (k in closed))
                if not passed or part == 0:
                    break
                part -= 1  # a switch on the way: half of the step at first
            gained, z, now = seen @ (integral @ z), after, now + (1 << part)
            t, depth = now / (1 << _HALVINGS) * dt, seen @ z
            times.append(t)
            path.append(z)
            for k in closed:
                area[k] += float(gained[k])
                deepest[k] = max(deepest[k], float(depth[k]))
            for k in passed:
                if k in closed:
                    contacts.append(self._contact(k, start.pop(k), t, area.pop(k), deepest.pop(k)))
                else:
                    start[k], area[k], deepest[k] = t, 0.0, 0.0
            closed = closed ^ passed
        contacts += [self._contact(k, start[k], duration, area[k], deepest[k]) for k in closed]
        every = np.array(path).T
        contacts.sort(key=lambda contact: (contact.start, contact.stop))
        return BruteMotion(np.array(times), self.rows @ every[:n], seen @ every, tuple(contacts))

    def _at_first(self, z: FloatArray) -> frozenset[int]:
        """The stops that are closed at once: beyond their gap, or at it and on the way."""
        seen, closed = self.seen(), set()
        for k, depth in enumerate(seen @ z):
            rate = float(seen[k] @ (self.matrix(frozenset()) @ z))
            if depth > 0 or (depth == 0 and rate > 0):
                closed.add(k)
        return frozenset(closed)

    def _contact(self, k: int, start: float, end: float, area: float, deepest: float) -> BruteContact:
        stop = self.problem.stops[k]
        return BruteContact(k, start, end, stop.sign * stop.stiffness * area, stop.stiffness * deepest)


def _assembled(nodes: FloatArray, EI: float, m: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness, mass, and the load of a unit acceleration of all mass, on Hermite elements between nodes."""
    n = 2 * nodes.size
    K, M, load = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    for i, h in enumerate(np.diff(nodes)):
        at = slice(2 * i, 2 * i + 4)
        bent = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]]
        bent += [[-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]
        K[at, at] += EI / h**3 * np.array(bent)
        mass = [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h]]
        mass += [[54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]
        M[at, at] += m * h / 420 * np.array(mass)
        load[at] += m * h / 2 * np.array([1.0, h / 6, 1.0, -h / 6])
    return K, M, load


def off_by(history: History, seen: BruteMotion) -> tuple[float, float]:
    """How far a motion is from the witness: its displacement at the stops, and its first contacts, infinite if others.

    Displacements are compared up to the end of these contacts, and are over the largest; starts are over the duration;
    impulses and peaks over the largest of each.
    """
    size = max((abs(c.impulse) for c in seen.contacts), default=0.0)
    both = history.contacts, seen.contacts
    one, other = ([c for c in them if abs(c.impulse) > _LIGHT * size][:_FIRST] for them in both)
    until = max((c.end for c in other), default=math.inf)
    problem, t = history.problem, np.linspace(0.0, min(seen.t[-1], history.end, until), 60)
    marched = np.array([np.interp(t, seen.t, z) for z in seen.z])
    x = np.array([stop.x for stop in problem.stops])
    apart = float(np.abs(history.displacement(x, t) - marched).max() / np.abs(marched).max())
    if [c.stop for c in one] != [c.stop for c in other]:
        return apart, math.inf
    worst, peak = 0.0, max((c.peak for c in other), default=1.0)
    for a, b in zip(one, other, strict=True):
        numbers = (a.start - b.start) / seen.t[-1], (a.impulse - b.impulse) / size, (a.peak_force - b.peak) / peak
        worst = max(worst, *(abs(number) for number in numbers))
    return apart, worst
