"""The exact march: closed-form segments of constant contact state, joined at certified switches.

Displacement and velocity are continuous at a switch.  The modes of every state span the whole finite element
space, so the change of coordinates, ``q_new = Phi_new^T M Phi_old q_old``, loses nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.search import Watch
from fe_lapjoint.system import System
from lapjoint.contact import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_STEPS_PER_PERIOD = 64  # of the excitation, on the coarsest level of the search
_STEPS_PER_MODE_PERIOD = 16
_RESOLVED_MODE = 4  # without excitation, the coarsest step resolves this mode
_MAX_SWITCHES = 100_000  # in one march between two reports: far beyond any real motion


@dataclass(frozen=True)
class Point:
    """The motion at one instant: time, contact state, and modal displacement and velocity, each ``(n,)``."""

    t: float
    state: ContactState
    q: FloatArray
    v: FloatArray


@dataclass(frozen=True)
class Segment:
    """A stretch of one contact state, from `start` to `end`, which is in the coordinates of the same state."""

    start: Point
    end: Point
    switched: tuple[int, ...] = ()
    """Stops that switch at the end; none where the march stopped."""


@dataclass(frozen=True)
class March:
    """Marches a system exactly from one time to another."""

    system: System
    _watches: dict[ContactState, Watch] = field(default_factory=dict, repr=False)

    def watch(self, state: ContactState) -> Watch:
        """The search for switches in a contact state."""
        if state not in self._watches:
            model = self.system.model(state)
            orientation = self.system.orientation(state)
            self._watches[state] = Watch(
                flow=model.flow,
                rows=np.ascontiguousarray((orientation * self.system.signs)[:, None] * model.rows),
                offsets=-orientation * self.system.gaps,
                step=self.step(),
            )
        return self._watches[state]

    def step(self) -> float:
        """The coarsest interval of the search, s."""
        omega = self.system.model(ContactState()).basis.omega
        mode = 2 * np.pi / omega[min(_RESOLVED_MODE, omega.size - 1)] / _STEPS_PER_MODE_PERIOD
        loads = [Omega for Omega, _ in self.system.assembly.harmonic_loads]
        return float(min([mode, *(2 * np.pi / Omega / _STEPS_PER_PERIOD for Omega in loads)]))

    def start(self) -> Point:
        """The problem's initial state."""
        state, q, v = self.system.initial()
        return Point(0.0, state, q, v)

    def run(self, start: Point, end: float, progress: Progress | None = None) -> list[Segment]:
        """Segments from `start` to the time `end`; at least one.

        Raises
        ------
        SolverError
            If the stops switch without end.
        """
        segments: list[Segment] = []
        point = start
        reported = start.t
        while True:
            segment = self._segment(point, end)
            segments.append(segment)
            if not segment.switched:
                return segments
            point = self.switched(segment)
            if len(segments) > _MAX_SWITCHES * (1 + (point.t - start.t) / (64 * self.step())):
                raise SolverError(f"the stops switch without end at t = {point.t:.9g} s")
            if progress is not None and point.t - reported > 0.01 * (end - start.t):
                progress(point.t - start.t, end - start.t)
                reported = point.t

    def _segment(self, start: Point, end: float) -> Segment:
        hit = self.watch(start.state).first_switch(start.t, start.q, start.v, end)
        return Segment(start, Point(hit.t, start.state, hit.q, hit.v), hit.stops)

    def switched(self, segment: Segment) -> Point:
        """The instant after the switch that ends a segment, in the coordinates of the next state."""
        state = segment.end.state
        for stop in segment.switched:
            state = state.toggled(stop)
        T = self.system.transfer(state, segment.end.state)
        return Point(segment.end.t, state, T @ segment.end.q, T @ segment.end.v)
