r"""The exact flow of one contact state under forces that are linear in time, from one knot of a record to the next.

The equations are linear, so the answer p to the ramps alone is added to the flow of all the rest, which starts from
what p leaves.  For a modal force f + g s on a mode with stiffness, s from the start,

    p(s) = (f + g s) / omega^2 - 2 a g / omega^4,

and a rigid-body mode, q'' + 2 a q' = f + g s, starts from rest: p = f e2 + g e3, with e1, e2, ... the integrals of
exp(-2 a s), s and s^2 / 2 and so on where a is 0.

p of modes with stiffness is linear in time, so it strays from no chord and from no tangent.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from fe_lapjoint.march.envelope import Envelope
from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.system import System
from lapjoint.problem import FloatArray

_ROUNDING = 32 * np.finfo(float).eps  # relative, as in `fe_lapjoint.march.propagator`
_SHORT = 2.0  # of 2 a s, without unit: up to it the integrals are summed as series
_TERMS = 22  # of those: the next is 2^22 4! / 26!, 3e-19 of the first


def fading_integrals(drag: float, s: FloatArray) -> tuple[FloatArray, ...]:
    """exp(-drag s), and its integrals from 0 to s, once to four times.

    Parameters
    ----------
    drag : float
        1/s, 0 or more.
    s : FloatArray, shape (m,)
        Times, s.

    Returns
    -------
    tuple of FloatArray, each of shape (m,)
        Without unit, s, s^2, s^3 and s^4.
    """
    x = drag * s
    small = np.where(x <= _SHORT, x, 0.0)
    series = sum((-small) ** n * (math.factorial(4) / math.factorial(4 + n)) for n in range(_TERMS))
    fourth = np.asarray(series) * s**4 / 24
    third = s**3 / 6 - drag * fourth
    second = s**2 / 2 - drag * third
    first = s - drag * second
    brief = np.stack([1 - drag * first, first, second, third, fourth])
    if not np.any(x > _SHORT):
        return tuple(brief)
    long = [np.exp(-x), -np.expm1(-x) / drag]
    for n in (1, 2, 3):
        long.append((s**n / math.factorial(n) - long[-1]) / drag)
    return tuple(np.asarray(np.where(x <= _SHORT, brief, np.stack(long))))


class RampFlow(Flow):
    """The exact motion of a `System` up to the next knot of its sampled forces, from given coordinates on.

    Parameters
    ----------
    system : System
        The contact state, with ramps.
    start : float
        s.
    q : FloatArray, shape (n,)
        Modal displacements at the start, kg^1/2 m.
    v : FloatArray, shape (n,)
        Modal velocities at the start, kg^1/2 m/s.
    """

    def __init__(self, system: System, start: float, q: FloatArray, v: FloatArray) -> None:
        assert system.ramps is not None
        self._force, self._slope = system.ramps.at(start)
        self._rigid = np.flatnonzero(system.omega == 0)
        self._drag = float(2 * system.damping_rate[self._rigid].max(initial=0.0))
        square = np.where(system.omega > 0, system.omega, np.inf) ** 2
        self._rate = self._slope / square
        """p' of the modes with stiffness, kg^1/2 m/s, shape ``(n,)``; 0 for the others."""
        self._begin = self._force / square - 2 * system.damping_rate * self._rate / square
        """p of them at the start, kg^1/2 m, shape ``(n,)``."""
        super().__init__(system, start, q - self._begin, v - self._rate)

    def _added(self, t: FloatArray, dt: int) -> FloatArray:
        """The `dt`-th derivative of p at the times ``(m,)``, shape ``(n, m)``."""
        s = np.asarray(t - self.start)
        if dt == 0:
            p = self._begin[:, None] + np.multiply.outer(self._rate, s)
        else:
            p = np.multiply.outer(self._rate if dt == 1 else np.zeros_like(self._rate), np.ones_like(s))
        if self._rigid.size:
            e = fading_integrals(self._drag, s)
            f, g = self._force[self._rigid], self._slope[self._rigid]
            p[self._rigid] = np.outer(f, e[2 - dt]) + np.outer(g, e[3 - dt])
        return np.asarray(p)

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of q at the times ``t``, s, shape ``(m,)``; gives ``(n, m)``."""
        return np.asarray(super().__call__(t, dt) + self._added(t, dt))

    def at(self, t: float) -> FloatArray:
        """(q, q') at one time. See `Flow.at`."""
        if not self.system.plain:
            return np.asarray(super().at(t))  # which asks for `__call__`
        return np.asarray(super().at(t) + np.concatenate([self._begin + self._rate * (t - self.start), self._rate]))

    def at_stops(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """A derivative of z at the stops. See `Flow.at_stops`."""
        return np.asarray(super().at_stops(t, dt) + self.system.stops @ self._added(t, dt))

    def at_grid(self, step: float, count: int) -> FloatArray:
        """z at the stops on an even grid of times. See `Flow.at_grid`."""
        t = np.asarray(self.start + step * np.arange(count + 1.0))
        return np.asarray(super().at_grid(step, count) + self.system.stops @ self._added(t, 0))

    def _with_other_rates(self, both: tuple[float, float], k: int, t: float) -> tuple[float, float]:
        """A displacement and its rate with what other modes and the ramps contribute, m and m/s."""
        z, rate = super()._with_other_rates(both, k, t)
        at = np.array([t])
        return z + float(self.system.stops[k] @ self._added(at, 0)[:, 0]), rate + float(
            self.system.stops[k] @ self._added(at, 1)[:, 0]
        )

    def integral_at_stops(self, end: float) -> FloatArray:
        """The time integral of z at the stops, from the start. See `Flow.integral_at_stops`."""
        if not self.system.plain:
            return np.asarray(super().integral_at_stops(end))  # which asks for `integral`
        return np.asarray(super().integral_at_stops(end) + self.system.stops @ self._added_area(end))

    def integral(self, end: float) -> FloatArray:
        """The time integral of q from the start. See `Flow.integral`."""
        return np.asarray(super().integral(end) + self._added_area(end))

    def _added_area(self, end: float) -> FloatArray:
        """The time integral of p from the start, shape ``(n,)``."""
        T = end - self.start
        area = self._begin * T + self._rate * (T**2 / 2)
        if self._rigid.size:
            e = fading_integrals(self._drag, np.array([T]))
            area[self._rigid] = self._force[self._rigid] * e[3][0] + self._slope[self._rigid] * e[4][0]
        return np.asarray(area)

    @cached_property
    def envelope(self) -> Envelope:
        """Bounds on the motion of the places but for what is linear in time; rigid-body modes add one. See `Flow`."""
        found, it = super().envelope, self.system
        if not self._rigid.size:
            return found
        # |p''| = |f exp(-2 a s) + g e1| up to the next knot, or a window further on.
        assert it.ramps is not None
        ahead = min(it.ramps.ramps.until(self.start), it.ramps.ramps.end) - self.start
        bound = np.abs(self._force) + np.abs(self._slope) * 2 * max(ahead, 0.0)
        share = np.abs(it.places[:, self._rigid]) @ bound[self._rigid]
        return Envelope(
            found.start,
            np.append(found.fading, 0.0),
            np.concatenate([found.shares, share[:, None]], axis=1),
            np.append(found.value, np.inf),
            np.append(found.slope, np.inf),
            np.append(found.curvature, 1.0),
        )

    @cached_property
    def rounding(self) -> FloatArray:
        """What rounding makes of z at each stop, m, shape ``(P,)``. See `Flow.rounding`."""
        it = self.system
        more = np.abs(it.places) @ (np.abs(self._begin) + np.abs(self.q + self._begin))
        return np.asarray(super().rounding + _ROUNDING * more[it.place_of])


def flow_of(system: System, start: float, q: FloatArray, v: FloatArray) -> Flow:
    """The exact motion of a contact state from given coordinates on, up to the next knot of its sampled forces.

    Parameters
    ----------
    system : System
        The contact state.
    start : float
        s.
    q : FloatArray, shape (n,)
        Modal displacements at the start, kg^1/2 m.
    v : FloatArray, shape (n,)
        Modal velocities at the start, kg^1/2 m/s.

    Returns
    -------
    Flow
        A `RampFlow` where there are sampled forces.
    """
    return Flow(system, start, q, v) if system.ramps is None else RampFlow(system, start, q, v)
