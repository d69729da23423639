"""The gap functions of an integrated motion, for `fe_lapjoint.march.events`.

Where every mode of a flow rings, its motion at the stops is a sum of exponentials and nothing else; the search is then
compiled as a whole, and reads them in `FlowTerms`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fe_lapjoint.march.compiled import above_trough, at_place, at_row
from fe_lapjoint.march.envelope import from_chord, from_tangent
from fe_lapjoint.march.events import BoolArray, GapReaders, in_python, searching
from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.system import SAMPLES, ComplexArray, Coordinates, IndexArray, System
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray


@by_reference
class FlowTerms(NamedTuple):
    """The gap functions of ``P`` stops at ``p`` places, in a flow of ``m`` terms of which all but the constant ring."""

    start: float
    """Start of the flow, s."""
    terms: ComplexArray
    """Amplitudes of the terms at the start in the motion of each place, m, shape ``(p, m)``."""
    rates: ComplexArray
    """Rates r of the terms, 1/s, shape ``(m,)``."""
    swinging: FloatArray
    """\\|r\\| of the terms that may be taken for swinging, 1/s; 0 for the others; shape ``(m,)``."""
    grid: FloatArray
    """Conjugates of exp(r s) on the grid that is searched, as pairs of real numbers, shape ``(SAMPLES + 1, 2 m)``."""
    place_of: IndexArray
    """Which place each stop is at, shape ``(P,)``."""
    orientation: FloatArray
    """Sign of z in each gap function, +1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """Gap of each open stop, minus the gap of each closed one, m, shape ``(P,)``; see `Model.offset`."""
    shares: FloatArray
    """As in `Envelope`, shape ``(p, m - 1)``."""
    fading: FloatArray
    """As in `Envelope`, 1/s, shape ``(m - 1,)``."""
    value: FloatArray
    """As in `Envelope`, shape ``(m - 1,)``."""
    slope: FloatArray
    """As in `Envelope`, shape ``(m - 1,)``."""
    curvature: FloatArray
    """As in `Envelope`, shape ``(m - 1,)``."""


@njit_inner()
def _at(it: FlowTerms, k: int, t: float) -> tuple[float, float]:
    """See `fe_lapjoint.march.events.BoundedGaps.at`."""
    z, rate = at_place(it.terms, it.rates, it.place_of[k], t - it.start)
    return it.orientation[k] * z - it.offset[k], it.orientation[k] * rate


@njit_inner()
def _at_step(it: FlowTerms, k: int, i: int) -> tuple[float, float, float, float]:
    """See `fe_lapjoint.march.events.Gaps.at_step`."""
    u, sign, offset = it.place_of[k], it.orientation[k], it.offset[k]
    z, rate = at_row(it.terms, it.rates, u, it.grid[i])
    z_end, rate_end = at_row(it.terms, it.rates, u, it.grid[i + 1])
    return sign * z - offset, sign * rate, sign * z_end - offset, sign * rate_end


@njit_inner()
def _from_chord(it: FlowTerms, k: int, t: float, width: float) -> float:
    """See `fe_lapjoint.march.events.BoundedGaps.from_chord`."""
    return from_chord(it.shares[it.place_of[k]], it.fading, it.value, it.curvature, t - it.start, width)


@njit_inner()
def _ceiling(it: FlowTerms, k: int, t: float, width: float, h: float, h_end: float) -> float:
    """See `fe_lapjoint.march.events.BoundedGaps.ceiling`."""
    u, sign = it.place_of[k], it.orientation[k]
    begin, end = above_trough(it.terms[u], it.rates, it.swinging, sign, t - it.start, width)
    return max(h - begin, h_end - end) + _from_chord(it, k, t, width)


@njit_inner()
def _from_tangent(it: FlowTerms, k: int, t: float, width: float) -> tuple[float, float]:
    """See `fe_lapjoint.march.events.BoundedGaps.from_tangent`."""
    return from_tangent(it.shares[it.place_of[k]], it.fading, it.slope, it.curvature, t - it.start, width)


in_flows = searching(GapReaders(_at, _at_step, _from_chord, _ceiling, _from_tangent), njit_inner(), njit_called())
"""The search in `FlowTerms`."""


@dataclass(frozen=True)
class FlowGaps:
    """The gap functions, orientation z - offset, of an exact flow; see `fe_lapjoint.march.events.Gaps`."""

    flow: Flow
    orientation: FloatArray
    """Sign of z in each gap function, +1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """Gap of each open stop, minus the gap of each closed one, m, shape ``(P,)``; see `Model.offset`."""
    step: float
    """Spacing of the grid that is searched, s; the grid begins with the flow."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``(m,)``, shape ``(P, m)``."""
        return np.asarray(self.orientation[:, None] * self.flow.at_stops(t) - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.Gaps.at`."""
        z, rate = self.flow.at_stop(k, t)
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)

    @cached_property
    def curvature(self) -> FloatArray:
        """Bounds on the curvature, m/s2, ``(P,)``. See `fe_lapjoint.march.events.Gaps.curvature`."""
        envelope, place_of = self.flow.envelope, self.flow.system.place_of
        return np.asarray((envelope.shares @ envelope.curvature)[place_of])

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """One gap function and its rate at both ends of a step. See `fe_lapjoint.march.events.Gaps.at_step`."""
        sign, offset = float(self.orientation[k]), float(self.offset[k])
        z, rate, z_end, rate_end = self.flow.at_step(k, self.step, i)
        return sign * z - offset, sign * rate, sign * z_end - offset, sign * rate_end

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """Bounds between the ends of intervals. See `fe_lapjoint.march.events.Gaps.from_chord`."""
        return np.asarray(self.flow.envelope.from_chord(t, width)[self.flow.system.place_of])

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Bounds on a gap function. See `fe_lapjoint.march.events.Gaps.ceiling`."""
        above, u = self.flow.above_troughs(k, side * float(self.orientation[k]), t, width), self.flow.system.place_of[k]
        chord = self.flow.envelope.from_chord(t, width, slice(u, u + 1))[0]
        return np.asarray((side * ends - above).max(axis=0) + chord)

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """Bounds on the time ahead. See `fe_lapjoint.march.events.Gaps.from_tangent`."""
        return self.flow.envelope.from_tangent(int(self.flow.system.place_of[k]), t, width)

    @property
    def rounding(self) -> FloatArray:
        """Rounding error of each gap function, m, shape ``(P,)``."""
        return np.asarray(self.flow.rounding + np.finfo(float).eps * np.abs(self.offset))

    @property
    def flow_terms(self) -> FlowTerms | None:
        """The gap functions for the compiled search; None where not every mode rings."""
        flow, it = self.flow, self.flow.system
        if not it.all_ring:
            return None
        by, grid = flow.envelope, it.grid(self.step)
        whole = flow.start, flow.terms, it.rates_of_terms, it.swinging, grid, it.place_of, self.orientation, self.offset
        return FlowTerms(*whole, by.shares, by.fading, by.value, by.slope, by.curvature)

    def first_switch(self, t: FloatArray, h: FloatArray, rounding: FloatArray, fresh: BoolArray) -> tuple[float, int]:
        """The first switch on a grid of times. See `fe_lapjoint.march.events.searching`."""
        terms = self.flow_terms
        search, gaps = (in_python, self) if terms is None else (in_flows, terms)
        time, stop = search.first_switch(gaps, t, h, rounding, fresh, self.curvature)
        return float(time), int(stop)


@dataclass(frozen=True)
class SolutionGaps:
    """The gap functions, orientation z - offset, of a library method's dense output."""

    system: System
    """The contact state."""
    coordinates: Coordinates
    start: float
    """Start of the window, s."""
    end: float
    """End of the window, s."""
    orientation: FloatArray
    """Sign of z in each gap function, +1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """Gap of each open stop, minus the gap of each closed one, m, shape ``(P,)``; see `Model.offset`."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``(m,)``, shape ``(P, m)``."""
        z = self._at_stops(t, 0)
        return np.asarray(self.orientation[:, None] * z - self.offset[:, None])

    def _at_stops(self, t: FloatArray, dt: int) -> FloatArray:
        """The `dt`-th derivative of what the gap functions read at times ``(m,)``: m s^-dt, ``(P, m)``."""
        return self.system.read(self.coordinates, t, dt)

    def first_switch(self, rounding: FloatArray, fresh: BoolArray) -> tuple[float, int]:
        """The first switch on the grid. See `fe_lapjoint.march.events.searching`."""
        h = self(self.grid)
        time, stop = in_python.first_switch(self, self.grid, h, rounding, fresh, self.curvature)
        return float(time), int(stop)

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.Gaps.at`."""
        z, rate = (float(self._at_stops(np.array([t]), dt)[k, 0]) for dt in (0, 1))
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """One gap function and its rate at both ends of a step. See `fe_lapjoint.march.events.Gaps.at_step`."""
        begin, end = self.grid[i : i + 2].tolist()
        return *self.at(k, begin), *self.at(k, end)

    @cached_property
    def grid(self) -> FloatArray:
        """The times of the grid that is searched, s, shape ``(SAMPLES + 1,)``."""
        return np.linspace(self.start, self.end, SAMPLES + 1)

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """Estimates for intervals. See `fe_lapjoint.march.events.Gaps.from_chord`."""
        return np.asarray(np.multiply.outer(self.curvature * (width**2 / 8), np.ones_like(t)))

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Estimates in place of bounds. See `fe_lapjoint.march.events.Gaps.ceiling`."""
        return np.asarray((side * ends).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """Estimates for the time ahead. See `fe_lapjoint.march.events.Gaps.from_tangent`."""
        bent = float(self.curvature[k]) * width
        return bent * width / 2, bent

    @cached_property
    def curvature(self) -> FloatArray:
        """Twice the largest of 200 samples of |z''| at the stops, m/s2, shape ``(P,)``.

        It is an estimate, not a bound: dense output gives no bound.
        """
        sampled = np.abs(self._at_stops(np.linspace(self.start, self.end, 200), 2))
        return np.asarray(2 * sampled.max(axis=1, initial=0.0))

    @cached_property
    def rounding(self) -> FloatArray:
        """Rounding error of each gap function, m, shape ``(P,)``."""
        q, v = (np.abs(self.coordinates(np.array([self.start]), dt)[:, 0]) for dt in (0, 1))
        return np.asarray(32 * np.finfo(float).eps * (self.system.sizes(q, v) + np.abs(self.offset)))
