"""One degree of freedom between damped stops, by numpy alone: motion piece by piece, its cycle and its multipliers.

The mass m follows m z'' + 2 zeta sqrt(k_e m) z' + k_0 z = F sin(omega t) - sum of the forces of the stops, where k_e is
k_0 and the stiffness of all stops beyond whose gap the mass is.  A stop presses with k d + c d' while this is above 0
or the stop may pull, and d > 0.  Between switches the motion is a matrix exponential; switches are roots by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from lapjoint.problem import FloatArray

_STEPS = 400  # Times per excitation period at which switches are looked for
_HALVINGS = 60  # Halvings of a step: 1e-18 of a period
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class DampedStop:
    """A stop."""

    sign: int
    """1 above, -1 below."""
    gap: float
    """m."""
    stiffness: float
    """N/m."""
    damping: float
    """N s/m."""
    may_pull: bool


@dataclass
class Passage:
    """What a march leaves behind."""

    state: FloatArray
    """z, m, and z', m/s, at its end."""
    impulses: FloatArray
    """Of each stop, N s, top positive."""
    lost: FloatArray
    """Integral of F d' of each stop, J."""
    touches: list[float] = field(default_factory=list)
    """Times at which a stop is touched, s."""


@dataclass(frozen=True)
class DampedOscillator:
    """The mass, its spring, and its stops."""

    mass: float
    """kg."""
    stiffness: float
    """k_0, N/m."""
    ratio: float
    """zeta."""
    force: float
    """F, N."""
    omega: float
    """rad/s."""
    stops: tuple[DampedStop, ...]

    @property
    def period(self) -> float:
        """s."""
        return 2 * math.pi / self.omega

    def march(self, state: FloatArray, start: float, end: float) -> Passage:
        """The motion from (z, z') at a time to another time, s."""
        n = len(self.stops)
        done, t = Passage(np.array(state, dtype=float), np.zeros(n), np.zeros(n)), start
        beyond = [s.sign * done.state[0] > s.gap for s in self.stops]
        acts = [b and (s.may_pull or self._pressed(s, done.state) > 0) for b, s in zip(beyond, self.stops, strict=True)]
        while t < end:
            move = self._flow(beyond, acts, done.state, t)
            times = np.append(np.arange(t, end, self.period / _STEPS)[1:], end)
            switch = self._first(move, t, times, beyond, acts)
            until = end if switch is None else switch[0]
            self._add(done, move, t, until, acts)
            done.state, t = move(np.array([until]))[:, 0], until
            if switch is None:
                break
            _, k, opens = switch
            if not opens:
                acts[k] = not acts[k]
            else:
                beyond[k] = not beyond[k]
                acts[k] = beyond[k]
                done.touches += [t] * beyond[k]
        return done

    def cycle(self, periods: int) -> FloatArray:
        """(z, z') at a multiple of the period after some periods from rest."""
        return self.march(np.zeros(2), 0.0, periods * self.period).state

    def multipliers(self, state: FloatArray) -> FloatArray:
        """Floquet multipliers of the cycle through a state, by central differences; largest modulus first."""
        columns = []
        for i, size in enumerate((1.0, self.omega)):
            h = 1e-6 * np.abs(state / [1.0, self.omega]).max() * size
            ends = []
            for far in (2, 1, -1, -2):
                moved = state.copy()
                moved[i] += far * h
                ends.append(self.march(moved, 0.0, self.period).state)
            columns.append((8 * (ends[1] - ends[2]) - ends[0] + ends[3]) / (12 * h))
        found = np.linalg.eigvals(np.array(columns).T)
        return np.asarray(found[np.argsort(-np.abs(found))])

    @staticmethod
    def _pressed(stop: DampedStop, state: FloatArray) -> float:
        depth = stop.sign * state[0] - stop.gap
        return float(stop.stiffness * depth + stop.damping * stop.sign * state[1])

    def _flow(
        self, beyond: list[bool], acts: list[bool], state: FloatArray, start: float
    ) -> Callable[[FloatArray], FloatArray]:
        """(z, z') at times, s, (2, m), from a state on, in one state of the stops."""
        within = self.stiffness + sum(s.stiffness for s, b in zip(self.stops, beyond, strict=True) if b)
        k, c, f = self.stiffness, 2 * self.ratio * math.sqrt(within * self.mass), 0.0
        for stop, a in zip(self.stops, acts, strict=True):
            if a:
                k, c, f = k + stop.stiffness, c + stop.damping, f + stop.stiffness * stop.sign * stop.gap
        steady = self.force / (k - self.mass * self.omega**2 + 1j * self.omega * c)
        roots = np.roots([self.mass, c, k]).astype(complex)

        def forced(t: FloatArray) -> FloatArray:
            z = steady * np.exp(1j * self.omega * t)
            return np.array([z.imag + f / k, (1j * self.omega * z).imag])

        free = state - forced(np.array([start]))[:, 0]
        sizes = np.linalg.solve(np.array([[1, 1], roots]), free.astype(complex))

        def move(t: FloatArray) -> FloatArray:
            terms = sizes[:, None] * np.exp(np.outer(roots, t - start))
            return np.array([terms.sum(axis=0).real, (roots[:, None] * terms).sum(axis=0).real]) + forced(t)

        return move

    def _first(
        self,
        move: Callable[[FloatArray], FloatArray],
        start: float,
        times: FloatArray,
        beyond: list[bool],
        acts: list[bool],
    ) -> tuple[float, int, bool] | None:
        """Time of the first switch, its stop, and whether the gap switches (or else the force); None without one."""
        found = None
        for k, stop in enumerate(self.stops):

            def depth(z: FloatArray, stop: DampedStop = stop, k: int = k) -> FloatArray:
                return np.asarray((stop.sign * z[0] - stop.gap) * (-1.0 if beyond[k] else 1.0))

            def force(z: FloatArray, stop: DampedStop = stop, k: int = k) -> FloatArray:
                pressed = stop.stiffness * (stop.sign * z[0] - stop.gap) + stop.damping * stop.sign * z[1]
                return np.asarray(pressed * (-1.0 if acts[k] else 1.0))

            for opens, rises in ((True, depth), (False, force)):
                if not opens and (stop.may_pull or not beyond[k]):
                    continue
                values = rises(move(times))
                hit = np.flatnonzero((values > 0) & (np.concatenate([[-1.0], values[:-1]]) <= 0))
                if hit.size:
                    low, high = (start if hit[0] == 0 else times[hit[0] - 1]), times[hit[0]]
                    for _ in range(_HALVINGS):
                        middle = (low + high) / 2
                        if rises(move(np.array([middle])))[0] > 0:
                            high = middle
                        else:
                            low = middle
                    if found is None or high < found[0]:
                        found = high, k, opens
        return found

    def _add(
        self, done: Passage, move: Callable[[FloatArray], FloatArray], start: float, end: float, acts: list[bool]
    ) -> None:
        """Add impulses and energies of a piece."""
        edges = np.linspace(start, end, 1 + math.ceil((end - start) / self.period * 64))
        half, middle = np.diff(edges)[:, None] / 2, (edges[1:, None] + edges[:-1, None]) / 2
        z = move((middle + half * _NODES).ravel())
        weights = (half * _WEIGHTS).ravel()
        for k, (stop, a) in enumerate(zip(self.stops, acts, strict=True)):
            if a:
                pressed = stop.stiffness * (stop.sign * z[0] - stop.gap) + stop.damping * stop.sign * z[1]
                done.impulses[k] += stop.sign * float(pressed @ weights)
                done.lost[k] += float((pressed * stop.sign * z[1]) @ weights)


def restitution(ratio: float, may_pull: bool) -> tuple[float, float]:
    """Duration times omega, and speed of the rebound over that of the impact, of a free mass against a damped stop.

    The solution of d'' + 2 ratio d' + d = 0 from d = 0, d' = 1 ends where d = 0, or without tension where d'' = 0.
    """
    if ratio == 1:
        return (math.inf, 0.0) if may_pull else (2.0, math.exp(-2.0))
    s = np.sqrt(complex(ratio**2 - 1))
    one, other = -ratio + s, -ratio - s
    if may_pull:
        t = math.pi / abs(s) if ratio < 1 else math.inf
    else:
        t = (2 * np.log(other / one) / (one - other)).real
        t += 2 * math.pi / abs(s) if t < 0 else 0.0
    if math.isinf(t):
        return t, 0.0
    return t, float(-((one * np.exp(one * t) - other * np.exp(other * t)) / (one - other)).real)
