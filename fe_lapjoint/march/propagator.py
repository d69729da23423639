r"""The exact flow of one contact state.

Each mode is a driven oscillator q'' + 2 a q' + omega^2 q = f0 + sum_h fh sin(Omega_h t + phase_h).  With
s = sqrt(a^2 - omega^2), real or imaginary,

    q(t) = p(t) + exp(-a t) [ (q0 - p(0)) (cosh s t + a sinh(s t) / s) + (v0 - p'(0)) sinh(s t) / s ]

where p answers the loads alone.  For the modes that oscillate the bracket is one rotating phasor; sinh(s t) / s is
smooth through s = 0, so critical damping and rigid-body modes need no case of their own.
"""

from __future__ import annotations

import itertools
import math
from functools import cached_property

import numpy as np

from fe_lapjoint.march.compiled import above_troughs, at_place, at_row, integrals, moved_on, start_terms
from fe_lapjoint.march.envelope import Envelope
from fe_lapjoint.march.system import ComplexArray, System
from lapjoint.problem import FloatArray

_ROUNDING = 32 * np.finfo(float).eps
"""Bound on the relative rounding error of a sum of some hundred terms, and of a change of state."""


def free_response(a: FloatArray, omega: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Free damped modes: C(t) after a unit displacement, and S(t), s, after a unit velocity, each ``(n, m)``.

    Arguments are damping rates zeta omega, 1/s, and undamped angular frequencies, rad/s, ``(n,)``; and times, s, of
    either sign, ``(m,)``.
    """
    square = (a**2 - omega**2)[:, None]
    s = np.sqrt(np.abs(square))
    w = s * t
    small = np.abs(w) < 1e-3
    w_ = np.where(small, 1.0, w)
    # For overdamped modes exp(s t) is multiplied by exp(-a t) before it can overflow.
    fast, slow = (
        np.exp(-(a[:, None] + s) * t),
        np.exp(-np.where(square > 0, _slow_rate(a, omega)[:, None], 0.0) * t),
    )
    decay = np.exp(-a[:, None] * t)
    oscillating = decay * np.where(small, 1 - w**2 / 6 * (1 - w**2 / 20), np.sin(w_) / w_) * t
    splitting = np.where(small, decay * (1 + w**2 / 6 * (1 + w**2 / 20)) * t, (slow - fast) / (2 * w_) * t)
    S = np.where(square > 0, splitting, oscillating)
    cosine = np.where(square > 0, (slow + fast) / 2, decay * np.cos(w))
    return cosine + a[:, None] * S, S


def _slow_rate(a: FloatArray, omega: FloatArray) -> FloatArray:
    """a - sqrt(a^2 - omega^2) without cancellation, where a exceeds omega."""
    s = np.sqrt(np.maximum(a**2 - omega**2, 0.0))
    return omega**2 / np.where(a + s > 0, a + s, 1.0)


class Flow:
    """The exact motion of a `System` of ``n`` modes and ``P`` stops at ``p`` places from `start`, s, on.

    `q` and `v` are modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, at the start, ``(n,)``.
    """

    def __init__(self, system: System, start: float, q: FloatArray, v: FloatArray) -> None:
        self.system, self.start, self.q, self.v = system, start, q, v
        y, loads = np.concatenate([q, v]), (system.driven, system.phase)
        self.free, self._amplitudes, self._moduli, self.terms, self._sizes = start_terms(
            y, start, loads, system.motion_by_loads, system.which, system.parts_of_roots, *system.shares_and_moduli
        )

    free: FloatArray
    """Modal displacement and velocity at the start, less those of the forced motion, shape ``(2, n)``."""
    _amplitudes: ComplexArray
    """Amplitudes of the oscillating modes, of the loads at the start, and of the constant, 1, shape ``(terms,)``."""
    _moduli: FloatArray
    """Moduli of `_amplitudes`, shape ``(terms,)``."""
    terms: ComplexArray
    """Complex amplitudes at the start of the terms of each place's motion, Re(c exp(r s)), shape ``(p, terms)``."""
    _sizes: FloatArray
    """Sum of the moduli of all addends of the displacement of each place, m, shape ``(p,)``."""

    @property
    def _phasors(self) -> ComplexArray:
        """Complex amplitudes c at the start of the oscillating modes, Re(c exp(root s)), shape ``(oscillating,)``."""
        return self._amplitudes[: self.system.which.size]

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of q at the times ``t``, s, shape ``(m,)``; gives ``(n, m)``."""
        result = self._forced(t, dt)
        it = self.system
        free = ((self._phasors * it.roots**dt)[:, None] * np.exp(np.multiply.outer(it.roots, t - self.start))).real
        if it.all_oscillate:
            return np.asarray(result + free)
        result[it.oscillating] += free
        result[~it.oscillating] += self._others(t)[dt]
        return result

    def at(self, t: float) -> FloatArray:
        """(q, q') at time `t`, s: kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
        it = self.system
        if not it.plain:
            times = np.array([t])
            return np.concatenate([self(times)[:, 0], self(times, 1)[:, 0]])
        return np.asarray(moved_on(self._amplitudes, it.rates_of_terms, it.motion_by_loads, t - self.start))

    def at_stops(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of z at the stops at times ``(m,)``, s: m over s^dt, shape ``(P, m)``."""
        it = self.system
        terms = self.terms * it.rates_of_terms**dt if dt else self.terms
        return self._with_others(terms.view(float) @ it.waves(t - self.start).T, t, dt)

    def at_grid(self, step: float, count: int) -> FloatArray:
        """z at the stops on an even grid from the start, m, shape ``(P, count + 1)``; `count` is at most `SAMPLES`."""
        z = self.terms.view(float) @ self.system.grid(step)[: count + 1].T
        if self.system.plain:
            return np.asarray(z[self.system.place_of])
        return self._with_others(z, np.asarray(self.start + step * np.arange(count + 1.0)), 0)

    def at_stop(self, k: int, t: float) -> tuple[float, float]:
        """z, m, and its rate, m/s, at stop `k` at time `t`, s."""
        it = self.system
        both = at_place(self.terms, it.rates_of_terms, it.place_of[k], t - self.start)
        return self._with_other_rates(both, k, t)

    def at_step(self, k: int, step: float, i: int) -> tuple[float, float, float, float]:
        """z, m, and its rate, m/s, at stop `k` at the beginning, then at the end, of step `i` of a grid."""
        it, grid = self.system, self.system.grid(step)
        first, last = (at_row(self.terms, it.rates_of_terms, it.place_of[k], grid[j]) for j in (i, i + 1))
        begin, end = self.start + i * step, self.start + (i + 1) * step
        return *self._with_other_rates(first, k, begin), *self._with_other_rates(last, k, end)

    def _with_other_rates(self, both: tuple[float, float], k: int, t: float) -> tuple[float, float]:
        """A displacement and its rate with the contribution of rigid-body and overdamped modes, m and m/s."""
        it = self.system
        if it.plain:
            return both
        place, since, now = it.place_of[k], t - self.start, np.array(both)
        if not it.all_oscillate:
            others = self._others(np.array([t]))
            now = now + [it.places[place, ~it.oscillating] @ part[:, 0] for part in others[:2]]
        if it.drift is not None:
            now = now + [it.places[place] @ self._drift(np.array([since]), dt)[:, 0] for dt in (0, 1)]
        return float(now[0]), float(now[1])

    def _with_others(self, z: FloatArray, t: FloatArray, dt: int) -> FloatArray:
        """Motion of the stops, ``(P, m)``, from that of the places and of rigid-body and overdamped modes."""
        it = self.system
        if it.drift is not None:
            z = z + it.places @ self._drift(t - self.start, dt)
        if not it.all_oscillate:
            z = z + it.places[:, ~it.oscillating] @ self._others(t)[dt]
        return np.asarray(z[it.place_of])

    def _others(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Free motion of the modes that are not `System.oscillating`: overdamped, critical, rigid.

        Displacement, velocity and acceleration at the times ``(m,)``, each ``(others, m)``.
        """
        it = self.system
        rest = ~it.oscillating
        a, square = it.damping_rate[rest, None], it.omega[rest, None] ** 2
        x, y = (part[rest, None] for part in self.free)
        C, S = free_response(it.damping_rate[rest], it.omega[rest], t - self.start)
        displacement, velocity = x * C + y * S, -square * x * S + y * (C - 2 * a * S)
        return displacement, velocity, -2 * a * velocity - square * displacement

    def _forced(self, t: FloatArray, dt: int) -> FloatArray:
        """Response to the loads alone, chosen to be periodic, constant or a polynomial, ``(n, m)``."""
        it = self.system
        angle = it.driven[:, None] * t + it.phase[:, None]
        waves = (it.amplitudes @ ((1j * it.driven[:, None]) ** dt * np.exp(1j * angle))).imag
        if dt == 0:
            waves += it.equilibrium[:, None]
        return np.asarray(waves if it.drift is None else waves + self._drift(t - self.start, dt))

    def _drift(self, s: FloatArray, dt: int) -> FloatArray:
        """Response of rigid-body modes to the constant forces, ``(n, m)``."""
        assert self.system.drift is not None
        ramp, fall = self.system.drift
        one, zero = np.ones_like(s), np.zeros_like(s)
        return np.asarray(np.outer(ramp, (s, one, zero)[dt]) + np.outer(fall, (s**2 / 2, s, one)[dt]))

    def above_troughs(self, k: int, side: float, t: FloatArray, width: float) -> FloatArray:
        """Sum of the swinging terms at both ends of each interval, less its lower bound within, m, shape ``(2, i)``.

        The intervals begin at `t`, s, ``(i,)``; `side` is +1 for the displacement of stop `k`, -1 for its opposite.
        """
        it = self.system
        terms = self.terms[it.place_of[k]]
        return np.asarray(above_troughs(terms, it.rates_of_terms, it.swinging, side, t - self.start, width))

    def integral_at_stops(self, end: float) -> FloatArray:
        """The time integral of z at the stops from the start to `end`, m s, shape ``(P,)``."""
        it, T = self.system, end - self.start
        if not it.plain:
            return np.asarray(it.stops @ self.integral(end) + (it.seen @ self._integral_of_waves(T).imag)[it.place_of])
        return np.asarray(integrals(self.terms, it.rates_of_terms, T)[it.place_of])

    def integral(self, end: float) -> FloatArray:
        """The time integral of q from the start to `end`, kg^1/2 m s, shape ``(n,)``."""
        it, T = self.system, end - self.start
        area = (it.amplitudes @ self._integral_of_waves(T)).imag + it.equilibrium * T
        if it.drift is not None:
            area += it.drift[0] * (T**2 / 2) + it.drift[1] * (T**3 / 6)
        area[it.oscillating] += (self._phasors * np.expm1(it.roots * T) / it.roots).real
        if not it.all_oscillate:
            area += self._integral_of_others(T)
        return np.asarray(area)

    def _integral_of_waves(self, T: float) -> ComplexArray:
        """The integral of exp(i angle) of each harmonic load over T from the start, s, shape ``(H,)``."""
        it = self.system
        turned = np.exp(1j * (it.driven * self.start + it.phase))
        return np.asarray(np.expm1(1j * it.driven * T) / (1j * it.driven) * turned)

    def _integral_of_others(self, T: float) -> FloatArray:
        """The integral over T of the free motion of modes that do not oscillate, 0 for the other modes, ``(n,)``."""
        it, (x, y) = self.system, self.free
        area = np.zeros_like(x)
        drifting = (it.omega == 0) & (it.damping_rate == 0)
        area[drifting] = x[drifting] * T + y[drifting] * T**2 / 2
        creeping = it.bounded[2]
        for rate, part in zip(it.creeping_rates, self._creeping, strict=True):
            moving = rate > 0
            area[creeping] += part * np.where(moving, -np.expm1(-rate * T) / np.where(moving, rate, 1.0), T)
        near = np.flatnonzero(~it.oscillating & np.isin(np.arange(x.size), it.bounded[1]))
        # The equation of motion integrated once: omega^2 int q = -[q'] - 2 a [q].
        C, S = (part[:, 0] for part in free_response(it.damping_rate[near], it.omega[near], np.array([T])))
        a, square, x, y = it.damping_rate[near], it.omega[near] ** 2, x[near], y[near]
        velocity = -square * x * S + y * (C - 2 * a * S)
        area[near] = -(velocity - y + 2 * a * (x * C + y * S - x)) / square
        return np.asarray(area)

    @cached_property
    def _creeping(self) -> tuple[FloatArray, FloatArray]:
        """Amplitudes of the slow and the fast part of the creeping modes, kg^1/2 m, each ``(creeping,)``."""
        x, y = (part[self.system.bounded[2]] for part in self.free)
        slow, fast = self.system.creeping_rates
        first = (y + fast * x) / (fast - slow)
        return first, x - first

    @cached_property
    def envelope(self) -> Envelope:
        r"""Bounds on the motion of the places, one term for each mode that rings or is nearly critical.

        A mode that creeps has two terms.  Each load has a term, and so has the motion of rigid-body modes under
        constant forces.  Where the two exponentials of a mode nearly cancel, with rates a +- s,

            \|q(t)\| <= (\|x\| + 2 \|y + a x\| / e r) exp(-r t / 2),   r = a - Re(s),

        from x and y = x' on, because t exp(-r t / 2) is at most 2 / e r.  The derivatives of q are free motions, too,
        and are bounded in the same way.
        """
        it, (x, y) = self.system, self.free
        if it.all_ring:
            value = self._moduli[:-1]
            slope = value * it.moduli
            return Envelope(self.start, it.fading, it.bounded_shares, value, slope, slope * it.moduli)
        ringing, near, _ = it.bounded
        amplitude = np.hypot(x, (y + it.damping_rate * x) / np.where(it.oscillating, _frequency(it), np.inf))[ringing]
        a, omega, p, r = it.damping_rate[near], it.omega[near], x[near], y[near]
        motions = [p, r]
        for _ in range(2):
            motions.append(-2 * a * motions[-1] - omega**2 * motions[-2])
        least = math.e / 2 * (a - np.sqrt(np.maximum(a**2 - omega**2, 0.0)))
        bounds = [np.abs(now) + np.abs(rate + a * now) / least for now, rate in itertools.pairwise(motions)]
        slow, fast = (np.abs(part) for part in self._creeping)
        drifting = 0 if it.drift is None else 1

        def bound(n: int) -> FloatArray:
            modes = [amplitude * it.omega[ringing] ** n, bounds[n], *_powers(it.creeping_rates, (slow, fast), n)]
            rigid = np.full(drifting, 1.0 if n == 2 else np.inf)
            return np.concatenate([*modes, it.driven**n, rigid])

        return Envelope(self.start, it.fading, it.bounded_shares, bound(0), bound(1), bound(2))

    @cached_property
    def rounding(self) -> FloatArray:
        """Rounding error of z at each stop, m, shape ``(P,)``: `_ROUNDING` of the sum of all terms' moduli."""
        return np.asarray(_ROUNDING * self._sizes[self.system.place_of])


def _powers(
    rates: tuple[FloatArray, FloatArray], amplitudes: tuple[FloatArray, FloatArray], n: int
) -> list[FloatArray]:
    """Each amplitude times the n-th power of its rate."""
    return [amplitude * rate**n for rate, amplitude in zip(rates, amplitudes, strict=True)]


def _frequency(it: System) -> FloatArray:
    """sqrt(omega^2 - a^2) of the modes that oscillate, 1 for the others, rad/s, shape ``(n,)``."""
    return np.sqrt(np.where(it.oscillating, it.omega**2 - it.damping_rate**2, 1.0))
