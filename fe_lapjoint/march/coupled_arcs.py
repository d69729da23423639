"""Readings of gap functions in contact states in which damped stops are closed, for arcs.

The gap function of a stop reads z, and that of the force of a damped stop z + (c / k) z'.  Their mean rates over an arc
are sums over the exponentials of the state.  Of exp(r s) over d, with x = r d, they are

    mean = r int_0^1 exp(x s) ds,    early = r^2 int_0^1 (1 - s) exp(x s) ds,    late = r^2 int_0^1 s exp(x s) ds,

closed forms for |x| above 1, and else integrals by Gauss' rule, which do not cancel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march.coupled import Coupled, CoupledFlow
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.system import ComplexArray, IndexArray
from lapjoint.problem import FloatArray

_POINTS, _WEIGHTS = np.add(np.polynomial.legendre.leggauss(8), [[1.0], [0.0]]) / 2
"""Gauss' rule on [0, 1]: exact to rounding for exponentials that turn, rise or fall by up to 1."""


@dataclass(frozen=True)
class MeanRate:
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
class Reading:
    """The gap function of a stop, or of the force of a damped stop, in one state."""

    system: Coupled
    """The contact state."""
    stop: int
    """The stop."""
    place: int
    """Its place among those of the state."""
    sign: float
    """+1 for a stop at the top, -1 for one at the bottom."""
    gap: float
    """Its gap, m."""

    @staticmethod
    def of(model: Model, system: Coupled, switch: int) -> Reading:
        """The gap function of a stop k, or ~k of a force."""
        stop = switch if switch >= 0 else ~switch
        row = stop if switch >= 0 else model.sign.size + model.damped.index(stop)
        place = int(system.row_places[row])
        return Reading(system, stop, place, float(model.sign[stop]), float(model.gap[stop]))

    @property
    def row(self) -> tuple[FloatArray, FloatArray]:
        """Factors of q, kg^-1/2, and of q', kg^-1/2 s, in the gap function, shape ``(n,)`` each."""
        own = self.sign * self.system.places[self.place]
        return own, self.system.delay[self.place] * own

    def value(self, t: float, y: FloatArray) -> float:
        """The gap function, m, of (q, q') at the time `t`, s."""
        return float(np.concatenate(self.row) @ y + self._seen(t, 0) - self.gap)

    def rate(self, t: float, y: FloatArray) -> float:
        """The rate of the gap function, m/s, of (q, q') at the time `t`, s."""
        return float(np.concatenate(self.row) @ self.system.rates(t, y) + self._seen(t, 1))

    def _seen(self, t: float, dt: int) -> float:
        """The part of the `dt`-th derivative of the base's motion, m / s^dt."""
        it, at = self.system, np.array([t])
        y, y1 = (it.seen_motion(at, order)[self.stop, 0] for order in (dt, dt + 1))
        return float(self.sign * (y + it.delay[self.place] * y1))

    def mean(self, flow: CoupledFlow, d: float) -> MeanRate:
        """The mean rate of the gap function along a motion over `d`, s."""
        it, free = self.system, self.system.free
        mean, early, late = means(it.rates_of_terms[:-1], d)
        shares = self.sign * it.shares[self.place, :-1]
        waves = shares * flow.amplitudes
        value, before, after = ((waves @ part).real for part in (mean, early, late))
        T, bend, by_q = free.rates.size, 0.0, self.sign * it.places[self.place]
        by_start = ((shares * mean)[:T] @ free.back).real
        if free.rest is not None:
            _, speed, bend = (by_q @ flow.polynomial).tolist()
            value += speed + bend * (d + 2 * it.delay[self.place])
            by_start = by_start + by_q @ free.rest[1]
        return MeanRate(float(value), by_start.reshape(2, -1), float(before + bend), float(after + bend))


def means(rates: ComplexArray, d: float) -> ComplexArray:
    """Mean, early and late of exp(r s) over `d`, s, for rates r, 1/s, ``(m,)``; shape ``(3, m)``."""
    x = rates * d
    slow = np.abs(x) <= 1
    waves = np.exp(np.multiply.outer(np.where(slow, x, 0.0), _POINTS))
    found = np.array(
        [rates * (waves @ _WEIGHTS), *(rates**2 * (waves @ (s * _WEIGHTS)) for s in (1 - _POINTS, _POINTS))]
    )
    if not slow.all():
        r, e = rates[~slow], np.exp(x[~slow])
        mean = (e - 1) / d
        found[:, ~slow] = mean, (mean - r) / d, (r * e - mean) / d
    return found


def write_coupled(
    flow: CoupledFlow, rows: IndexArray, arrays: tuple[ComplexArray, ComplexArray, ComplexArray, FloatArray]
) -> None:
    """Write the motion of gap functions, of the rows ``(U,)``, as one segment of `compiled_intervals.Motion`.

    `arrays` are its rates and amplitudes, ``(K,)``, weights, ``(U, K)``, and polynomial, ``(U, 3)``, which are zero.
    """
    it, (rates, amplitudes, weights, polynomial) = flow.system, arrays
    K = it.rates_of_terms.size - 1
    rates[:K], amplitudes[:K] = it.rates_of_terms[:-1], flow.amplitudes
    for u, row in enumerate(rows.tolist()):
        place = it.row_places[row]
        if place < 0:
            continue
        weights[u, :K] = it.shares[place, :-1]
        polynomial[u] = still = it.places[place] @ flow.polynomial
        polynomial[u, :2] += it.delay[place] * still[1:] * [1.0, 2.0]
