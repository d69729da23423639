r"""A motion seen once in each turn: the map whose fixed points are the periodic motions.

A turn is one period T of the excitation.  A problem that is its own mirror image obeys z -> -z, t -> t + T/2; there
a turn is half a period, mirrored afterwards, so that the loads are again at the phase at which they started:

    H(y) = -y(T/2)

A fixed point of H is a symmetric motion, z(t + T/2) = -z(t); one of H H is any motion of period T.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.march import March, march
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.tangent import carried
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem, StepLoad


def mirror(problem: Problem) -> tuple[int, ...] | None:
    """The twin of each stop on the other side, if the problem is its own mirror image; else None."""
    if any(isinstance(load, StepLoad) and load.force for load in problem.point_loads):
        return None
    sides: dict[str, list[tuple[tuple[float, float, float], int]]] = {"top": [], "bottom": []}
    for k, stop in enumerate(problem.stops):
        sides[stop.side].append(((stop.x, stop.gap, stop.stiffness), k))
    top, bottom = (sorted(sides[side]) for side in ("top", "bottom"))
    if [key for key, _ in top] != [key for key, _ in bottom]:
        return None
    twins = {a: b for (_, a), (_, b) in zip(top, bottom, strict=True)}
    twins |= {b: a for a, b in twins.items()}
    return tuple(twins[k] for k in range(len(problem.stops)))


@dataclass(frozen=True)
class Point:
    """A contact state and (q, q') in its modes, shape ``(2 n,)``."""

    state: ContactState
    y: FloatArray


@dataclass(frozen=True)
class Turned:
    """A march over some turns, and where it ended, mirrored back if that is due."""

    motion: March
    end: Point
    sign: int


@dataclass(frozen=True)
class Turns:
    """The map of one problem."""

    model: Model
    omega: float
    """Angular frequency of the excitation, rad/s."""

    @cached_property
    def twins(self) -> tuple[int, ...] | None:
        """See `mirror`."""
        return mirror(self.model.problem)

    @property
    def per_period(self) -> int:
        """Turns in an excitation period: 2 if the problem is its own mirror image, or 1."""
        return 1 if self.twins is None else 2

    @property
    def duration(self) -> float:
        """Length of a turn, s."""
        return 2 * math.pi / self.omega / self.per_period

    def mirrored(self, state: ContactState) -> ContactState:
        """The state with top and bottom exchanged; its modes are the same, to the sign."""
        assert self.twins is not None
        return ContactState(tuple(self.twins[k] for k in state.closed))

    def after(self, point: Point, count: int = 1) -> Turned:
        """March over some turns."""
        motion = march(self.model, point.state, point.y, 0.0, count * self.duration, record=False)
        if count % self.per_period == 0:
            return Turned(motion, Point(motion.state, motion.y), 1)
        return Turned(motion, Point(self.mirrored(motion.state), -motion.y), -1)

    def carried(self, turned: Turned, deviations: FloatArray) -> FloatArray:
        """Deviations ``(2 n, m)`` from the start of a march, at its end."""
        return turned.sign * carried(self.model, turned.motion, deviations)

    def matrix(self, point: Point, turned: Turned) -> FloatArray:
        """d(end) / d(start), both in the modes of the start, shape ``(2 n, 2 n)``."""
        M = self.carried(turned, np.eye(point.y.size))
        if turned.end.state == point.state:
            return M
        return np.kron(np.eye(2), self.model.transfer(turned.end.state, point.state)) @ M

    def seen_from(self, state: ContactState, point: Point) -> FloatArray:
        """(q, q') of a point in the modes of another state."""
        if point.state == state:
            return point.y
        return (point.y.reshape(2, -1) @ self.model.transfer(point.state, state).T).ravel()

    def size(self, y: FloatArray) -> float:
        """Norm of (q, q' / omega), the same in the modes of every state."""
        q, v = y.reshape(2, -1)
        return math.hypot(float(np.linalg.norm(q)), float(np.linalg.norm(v)) / self.omega)

    def settled(self, point: Point) -> Point:
        """The same place with the contact state that its position implies; a stop just touched stays as it is."""
        model, state = self.model, point.state
        depth = model.sign * (model.system(state).stops @ np.split(point.y, 2)[0]) - model.gap
        unclear = np.abs(depth) <= 1e-12 * np.maximum(model.gap, 1e-12)
        closed = [k for k in range(depth.size) if (k in state if unclear[k] else depth[k] > 0)]
        new = ContactState(tuple(closed))
        return Point(new, self.seen_from(new, point))
