"""Samples of the motion in a scene, at given times: the beam at its stations, the stops, and the base.

There are two sources of samples: the history of any solver, and the modes of a contact state.  The "time" of a mode is
its number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import is_paper_joint, paper_state_number
from lapjoint.problem import FloatArray, Problem
from lapjoint.scene.layout import Layout
from lapjoint.scene.section_mesh import IntArray


@dataclass(frozen=True)
class Sample:
    """A motion at ``m`` times, on ``n`` stations, with ``s`` stops; z is relative to the base."""

    times: FloatArray
    """Times, s, shape ``(m,)``; numbers for modes."""
    beam: dict[str, FloatArray]
    """Values at the stations by name, each of shape ``(m, n)``: z (m), z_x (1), z_xx (1/m), z_xxx (1/m^2), z_t (m/s),
    z_xt (1/s).  Modes have neither z_t nor z_xt."""
    base: FloatArray
    """Displacement and velocity of the base, m and m/s, shape ``(2, m)``."""
    faces: FloatArray
    """Displacement of the face of each stop, m, shape ``(m, s)``: its gap while open, the beam's displacement while
    closed."""
    force: FloatArray
    """Force of each stop on the beam, N, positive upwards, shape ``(m, s)``."""
    closed: IntArray
    """1 where a stop is closed, else 0, shape ``(m, s)``."""
    whole: dict[str, FloatArray | IntArray]
    """Values of the whole joint by name, each of shape ``(m,)``."""
    moved: FloatArray
    """Displacement of what carries each stop, relative to the base, m, shape ``(m, s)``: 0 of the base, -y of a stop
    fixed in space, and that of the first beam of a stop between two."""
    gapped: bool = True
    """Whether stops have gaps; in mode shapes they have none."""


class Source(Protocol):
    """A motion that can be sampled."""

    @property
    def problem(self) -> Problem:
        """The problem whose motion it is."""

    @property
    def pressed(self) -> float:
        """Largest penetration of a stop, m."""

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """The motion at the layout's stations and at times, s, (m,); for modes these are their numbers, from 1."""


_DERIVATIVES = {"z": (0, 0), "z_x": (1, 0), "z_xx": (2, 0), "z_xxx": (3, 0), "z_t": (0, 1), "z_xt": (1, 1)}


@dataclass(frozen=True)
class Motion:
    """The motion of a history."""

    history: History

    @property
    def problem(self) -> Problem:
        """The problem whose motion it is."""
        return self.history.problem

    @property
    def pressed(self) -> float:
        """Largest penetration of a stop, m."""
        stops = self.history.problem.structure.stops
        return max((c.peak_force / stops[c.stop].stiffness for c in self.history.contacts), default=0.0)

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """Sample the history.  See `lapjoint.scene.sampled_motion.Source.sample`."""
        history = self.history
        beam = {name: history.evaluate(layout.stations, times, *d).T for name, d in _DERIVATIVES.items()}
        states = [history.state_at(float(t)) for t in times]
        stops = history.problem.structure.stops
        closed = np.array([[i in state for i in range(len(stops))] for state in states], dtype=np.int64)
        closed = closed.reshape(times.size, len(stops))
        moved = -history.base_of_stops(times).T
        for stop, station in layout.on_beams:
            moved[:, stop] += beam["z"][:, station]
        faces = np.where(closed, beam["z"][:, layout.at_stops], moved + [stop.sign * stop.gap for stop in stops])
        whole = _closed_stops(closed)
        if is_paper_joint(history.problem):
            whole["contact_state"] = np.array([paper_state_number(history.problem, state) for state in states])
        force = history.contact_force(times).T
        base = np.array([history.base(times), history.base(times, 1)])
        return Sample(times, beam, base, faces, force, closed, whole, moved)


@dataclass(frozen=True)
class ModeSeries:
    """Mass-normalised mode shapes, one after the other; the faces of closed stops move with the beam."""

    problem: Problem
    modes: Modes
    pressed: float = 0.0

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """Sample the mode shapes.  See `lapjoint.scene.sampled_motion.Source.sample`."""
        here = np.asarray(times, dtype=np.int64) - 1
        beam = {f"z{'_' * (d > 0)}{'x' * d}": self.modes.shapes(layout.stations, d)[here] for d in range(4)}
        stops, still = self.problem.structure.stops, np.zeros((2, here.size))
        closed = np.tile([int(i in self.modes.state) for i in range(len(stops))], (here.size, 1)).astype(np.int64)
        faces = closed * beam["z"][:, layout.at_stops]
        moved = np.zeros(faces.shape)
        for stop, station in layout.on_beams:
            moved[:, stop] = beam["z"][:, station]
        force = -np.array([stop.stiffness for stop in stops]) * closed * (faces - moved)
        whole = {"angular_frequency": self.modes.angular_frequencies[here], **_closed_stops(closed)}
        return Sample(np.asarray(times, dtype=float), beam, still, faces, force, closed, whole, moved, gapped=False)


def _closed_stops(closed: IntArray) -> dict[str, FloatArray | IntArray]:
    """A number whose bit i is set while stop i is closed, shape ``(m,)``; empty if there are more stops than bits."""
    stops = closed.shape[1]
    return {"closed_stops": closed @ (1 << np.arange(stops))} if 0 < stops < 63 else {}
