"""A motion marched again in tiny steps by matrix exponentials, which knows nothing of closed forms, bounds or searches.

It takes finite elements from a section point over some periods of harmonic loads, or along sampled forces from knot to
knot.  What drives the motion is a further unknown, so that the motion of a contact state is z' = M z, and each step
multiplies by exp(M dt).  In every step the gap functions and their rates are looked at, and where one rises through 0,
or turns just below it, exponentials to the times that a bracketing search asks for say when.

All modes are marched, and the steps are such that those which move a stop are seen to: a sliver of an element may have
modes a hundred thousand times as fast as the rest, with 1e-20 of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from fe_lapjoint.march.model import Model
from fe_lapjoint.march.system import System
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray

STEPS = 40  # in the shortest period or time constant of the state, and of the loads, and between two knots
_CHUNK = 2000  # steps that are looked at together
STILL = 1e-9  # of the largest displacement of a stop: modes that move none by more in all leave it where it is


@dataclass(frozen=True)
class Passed:
    """What the march over some periods comes to."""

    switches: tuple[tuple[int, float], ...]
    """Each stop that switches, and when, s."""
    state: ContactState
    """The stops that are closed at the end."""
    y: FloatArray
    """Modal displacements and velocities of that state at the end, shape ``(2 n,)``."""


def dense_march(
    model: Model, state: ContactState, y: FloatArray, period: float, periods: int = 1, most: float = math.inf
) -> Passed:
    """March from (q, q') in the modes of a contact state, ``(2 n,)``, over `periods` periods of the loads, s.

    The march ends at the switch with the number `most`, too.
    """
    switches: list[tuple[int, float]] = []
    ramps = model.problem.forces.ramps
    for n in range(periods):
        t, last = 0.0, -1
        while t < period and len(switches) < most:
            end = period if ramps is None else min(period, ramps.until(t))
            y, t, last = _Stretch(model, state, y, t, last).until(end)
            if last >= 0:
                switches.append((last, n * period + t))
                y = (y.reshape(2, -1) @ model.transfer(state, state.toggled(last)).T).ravel()
                state = state.toggled(last)
    return Passed(tuple(switches), state, y)


def fastest_moving(system: System, q: FloatArray, v: FloatArray, t: float) -> float:
    """Angular frequency, rad/s, of the fastest load, or of the fastest mode that moves a stop while the state lasts.

    `q` and `v`, ``(n,)``, are the modal displacements and velocities at time `t`, s.  A mode's own motion is its motion
    less its answer to the loads; its energy never grows, so its displacement is at most hypot(q, v / omega).
    """
    driven = float(system.driven.max(initial=0.0))
    fast = np.flatnonzero(system.omega > 2 * driven)  # slower ones count in any case
    omega, rate = system.omega[fast], system.damping_rate[fast]
    dynamic = (omega**2)[:, None] - system.driven**2 + 2j * rate[:, None] * system.driven
    answer = system.harmonic[fast] * np.exp(1j * (system.driven * t + system.phase)) / dynamic
    forced = system.constant[fast] / omega**2 + answer.imag.sum(axis=1)
    own = np.hypot(q[fast] - forced, (v[fast] - (1j * system.driven * answer).imag.sum(axis=1)) / omega)
    moved = np.abs(system.stops) * np.hypot(q, v / np.maximum(system.omega, driven))
    least = STILL * float(moved.sum(axis=1).max(initial=0.0))
    order = np.argsort(-omega)  # from the fastest
    together = np.cumsum(np.abs(system.stops[:, fast[order]]) * own[order], axis=1).max(axis=0, initial=0.0)
    pace = np.hypot(omega, rate)[order]
    slower = float(np.hypot(system.omega, system.damping_rate)[system.omega <= 2 * driven].max(initial=0.0))
    return max(driven, slower, float(pace[together > least].max(initial=0.0)))


class _Stretch:
    """The motion of one contact state from (q, q') at a time; `last` is the stop that has just switched."""

    def __init__(self, model: Model, state: ContactState, y: FloatArray, t: float, last: int) -> None:
        system = model.system(state)
        self.n, self.t, self.last = system.omega.size, t, last
        slowest = system.driven.max() if system.driven.size else 1.0
        self.unit = np.maximum(system.omega, slowest)  # of velocities: like entries round less
        self.M, self.z = matrix(system, self.unit, y, t)
        q, v = np.split(y, 2)
        every = float(np.hypot(system.omega, system.damping_rate).max())
        self.fastest = fastest_moving(system, q, v, t) if system.ramps is None else every
        self.rows = np.zeros((2, model.sign.size, self.z.size))
        self.rows[0, :, : self.n] = model.orientation(state)[:, None] * system.stops
        self.rows[1, :, self.n : 2 * self.n] = self.rows[0, :, : self.n] * self.unit
        self.offset = model.offset(state).copy()
        if last >= 0:  # it lies at its gap but for rounding
            self.offset[last] = float(self.rows[0, last] @ self.z)

    def until(self, end: float) -> tuple[FloatArray, float, int]:
        """March up to a switch or a time: (q, q') then, the time, and the stop, -1 for none."""
        steps = max(STEPS, math.ceil((end - self.t) * self.fastest * STEPS / (2 * math.pi)))
        dt = (end - self.t) / steps
        move, z = expm(self.M * dt), self.z
        for first in range(0, steps, _CHUNK):
            count = min(_CHUNK, steps - first)
            path = np.empty((count + 1, z.size))
            path[0] = z
            for i in range(count):
                path[i + 1] = move @ path[i]
            h, rate = self.rows @ path.T - np.array([self.offset, np.zeros_like(self.offset)])[:, :, None]
            for i in self._candidates(h, rate):
                begins = first + i == 0
                found = [self._rises(path[i], k, dt, begins, rate[k, i : i + 2]) for k in range(h.shape[0])]
                times = [(s, k) for k, s in enumerate(found) if s is not None]
                if times:
                    s, k = min(times)
                    return self._coordinates(self._at(path[i], s)), self.t + (first + i) * dt + s, k
            z = path[-1]
        return self._coordinates(z), end, -1

    def _coordinates(self, z: FloatArray) -> FloatArray:
        """(q, q') of the unknowns."""
        return np.concatenate([z[: self.n], self.unit * z[self.n : 2 * self.n]])

    def _candidates(self, h: FloatArray, rate: FloatArray) -> list[int]:
        """Steps in which a gap function ends above 0, or turns on the way from its rise to its fall."""
        turns = (rate[:, :-1] > 0) & (rate[:, 1:] < 0)
        return np.flatnonzero(((h[:, 1:] > 0) | turns).any(axis=0)).tolist()

    def _at(self, z: FloatArray, s: float) -> FloatArray:
        return np.asarray(expm(self.M * s) @ z)

    def _rises(self, z: FloatArray, k: int, dt: float, begins: bool, rate: FloatArray) -> float | None:
        """When in a step, the first or not, a gap function rises through 0, s from its start; None if it does not."""

        def value(of: int) -> Callable[[float], float]:
            return lambda s: float(self.rows[of, k] @ self._at(z, s) - (0.0 if of else self.offset[k]))

        low, high = 0.0, dt
        if begins and k == self.last:  # it leaves its gap before it may come back
            if not rate[0] < 0 < rate[1]:
                return None
            low = _root(value(1), 0.0, dt)
        elif rate[0] > 0 > rate[1]:
            high = _root(value(1), 0.0, dt)
        return _root(value(0), low, high) if value(0)(low) < 0 < value(0)(high) else None


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(function, low, high, xtol=1e-16, rtol=1e-14))


def matrix(system: System, unit: FloatArray, y: FloatArray, t: float) -> tuple[FloatArray, FloatArray]:
    """M, and z at a time: q and q' in units, 1, sine and cosine of each load, and sampled forces and their slopes."""
    n, H = system.omega.size, system.driven.size
    angle, sampled = system.driven * t + system.phase, np.zeros((2, 0))
    if system.ramps is not None:
        sampled = np.array([part[0] for part in system.ramps.ramps.at(np.array([t]))])
    forces, size = 2 * n + 1 + 2 * H, 2 * n + 1 + 2 * H + sampled.size
    M = np.zeros((size, size))
    if system.ramps is not None:
        slopes = forces + sampled.shape[1]
        M[n : 2 * n, forces:slopes] = system.ramps.shares / unit[:, None]
        M[forces:slopes, slopes:] = np.eye(sampled.shape[1])
    M[:n, n : 2 * n] = np.diag(unit)
    M[n : 2 * n, :n] = -np.diag(system.omega**2 / unit)
    M[n : 2 * n, n : 2 * n] = -2 * np.diag(system.damping_rate)
    M[n : 2 * n, 2 * n] = system.constant / unit
    sine = 2 * n + 1
    M[n : 2 * n, sine : sine + H] = system.harmonic / unit[:, None]
    M[sine : sine + H, sine + H : forces] = np.diag(system.driven)
    M[sine + H : forces, sine : sine + H] = -np.diag(system.driven)
    return M, np.concatenate([y[:n], y[n:] / unit, [1.0], np.sin(angle), np.cos(angle), sampled.ravel()])
