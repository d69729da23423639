"""What moves in a scene, at some times: the beam at its stations, the stops, the base.

Two sources give samples: the history of either solver, and the modes of a contact state, whose "time" is the number of
the mode.
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
    """s, shape ``(m,)``."""
    beam: dict[str, FloatArray]
    """z, z_x, z_xx, z_xxx, z_t and z_xt at the stations, each ``(m, n)``, by these names."""
    base: FloatArray
    """Displacement and velocity of the base, m and m/s, shape ``(2, m)``."""
    faces: FloatArray
    """Displacement of the face of each stop, m, ``(m, s)``: its gap, or that of the beam which presses it."""
    force: FloatArray
    """Force of each stop on the beam, N, positive upwards, ``(m, s)``."""
    closed: IntArray
    """1 where a stop is closed, ``(m, s)``."""
    whole: dict[str, FloatArray | IntArray]
    """Numbers of the whole joint, each ``(m,)``, by name."""
    gapped: bool = True
    """Whether the stops stand behind their gaps; modes know none."""


class Source(Protocol):
    """Something that moves."""

    @property
    def problem(self) -> Problem:
        """Whose motion it is."""

    @property
    def pressed(self) -> float:
        """How far a stop is pressed at most, m."""

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """The motion at `times`."""


_DERIVATIVES = {"z": (0, 0), "z_x": (1, 0), "z_xx": (2, 0), "z_xxx": (3, 0), "z_t": (0, 1), "z_xt": (1, 1)}


@dataclass(frozen=True)
class Motion:
    """The motion of a history; see `Source`."""

    history: History

    @property
    def problem(self) -> Problem:
        """Whose motion it is."""
        return self.history.problem

    @property
    def pressed(self) -> float:
        """How far a stop is pressed at most, m."""
        stops = self.history.problem.stops
        return max((c.peak_force / stops[c.stop].stiffness for c in self.history.contacts), default=0.0)

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """The motion at `times`, s, within the history."""
        history = self.history
        beam = {name: history.evaluate(layout.stations, times, *d).T for name, d in _DERIVATIVES.items()}
        states = [history.state_at(float(t)) for t in times]
        stops = history.problem.stops
        closed = np.array([[i in state for i in range(len(stops))] for state in states], dtype=np.int64)
        closed = closed.reshape(times.size, len(stops))
        faces = np.where(closed, beam["z"][:, layout.at_stops], [stop.sign * stop.gap for stop in stops])
        whole = _closed_stops(closed)
        if is_paper_joint(history.problem):
            whole["contact_state"] = np.array([paper_state_number(history.problem, state) for state in states])
        force = history.contact_force(times).T
        return Sample(times, beam, _base(history.problem, times), faces, force, closed, whole)


@dataclass(frozen=True)
class ModesInTurn:
    """Mass-normalised mode shapes, one after the other; see `Source`.  Closed stops move along, as springs do."""

    problem: Problem
    modes: Modes
    pressed: float = 0.0

    def sample(self, layout: Layout, times: FloatArray) -> Sample:
        """The shapes of the modes numbered `times`, from 1."""
        here = np.asarray(times, dtype=np.int64) - 1
        beam = {f"z{'_' * (d > 0)}{'x' * d}": self.modes.shapes(layout.stations, d)[here] for d in range(4)}
        stops, still = self.problem.stops, np.zeros((2, here.size))
        closed = np.tile([int(i in self.modes.state) for i in range(len(stops))], (here.size, 1)).astype(np.int64)
        faces = closed * beam["z"][:, layout.at_stops]
        force = -np.array([stop.stiffness for stop in stops]) * faces
        whole = {"angular_frequency": self.modes.angular_frequencies[here], **_closed_stops(closed)}
        return Sample(np.asarray(times, dtype=float), beam, still, faces, force, closed, whole, gapped=False)


def _closed_stops(closed: IntArray) -> dict[str, FloatArray | IntArray]:
    """A number with bit i set where stop i is closed; there are no numbers for more stops than bits."""
    stops = closed.shape[1]
    return {"closed_stops": closed @ (1 << np.arange(stops))} if 0 < stops < 63 else {}


def _base(problem: Problem, times: FloatArray) -> FloatArray:
    """Displacement and velocity of the base, ``(2, m)``."""
    motion = problem.base_motion
    if motion is None:
        return np.zeros((2, times.size))
    Y, omega = motion.amplitude, motion.angular_frequency
    angle = omega * times + motion.phase
    return np.array([Y * np.sin(angle), Y * omega * np.cos(angle)])
