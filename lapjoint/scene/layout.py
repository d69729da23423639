"""The layout of a joint at rest: positions along the beam (stations), and sizes of parts that the problem leaves
open."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.beam import Rectangle
from lapjoint.scene.section_mesh import IntArray

MOST_POINTS = 100_000
"""Largest number of stations along a beam, so that a frame can be drawn."""


@dataclass(frozen=True)
class Layout:
    """The layout of a joint at rest; a number of stations out of its range is an `InputError`."""

    problem: Problem
    """The joint."""
    points: int = 81
    """Number of equidistant stations along the beam; the positions of supports, stops, masses and steps are added."""
    offset: float = 0.0
    """Shift of the joint along y, m, if several joints stand side by side."""
    pressed: float = 0.0
    """Largest penetration of a stop, m; the springs are made longer than this."""

    def __post_init__(self) -> None:
        check_points(self.points)

    @cached_property
    def stations(self) -> FloatArray:
        """Positions along the beam, m, ascending, shape ``(n,)``."""
        L = self.problem.line.length
        problem = self.problem
        special = [support.x for support in problem.structure.supports] + [stop.x for stop in problem.structure.stops]
        special += [mass.x for mass in problem.structure.masses] + [piece.end for piece in problem.line.pieces]
        grid = np.linspace(0.0, L, self.points)
        # A grid point within 1e-9 L of a support, stop, mass or step is left out, so that no cell is degenerate.
        apart = np.all(np.abs(grid[:, None] - np.array(special)[None, :]) > 1e-9 * L, axis=1)
        return np.unique(np.concatenate([grid[apart], special]))

    @cached_property
    def at_stops(self) -> IntArray:
        """Index of each stop's station, shape ``(stops,)``."""
        return np.searchsorted(self.stations, [stop.x for stop in self.problem.structure.stops]).astype(np.int64)

    @cached_property
    def across(self) -> FloatArray:
        """Position of each stop across the beam, m, shape ``(stops,)``; stops at one position stand side by side."""
        stops = self.problem.structure.stops
        places = [(stop.x, stop.sign) for stop in stops]
        counted: Counter[tuple[float, int]] = Counter()
        number = np.zeros(len(places))
        for i, place in enumerate(places):
            number[i] = counted[place]
            counted[place] += 1
        count = np.array([counted[place] for place in places], dtype=float)
        across: FloatArray = self.breadth * ((number + 0.5) / count - 0.5)
        return across

    @property
    def half_depth(self) -> float:
        """Largest height of the beam's surface above its axis, m; 0 where the problem gives no cross-section."""
        return float(self.half_depth_at(self.stations).max())

    def half_depth_at(self, x: FloatArray) -> FloatArray:
        """Height of the beam's surface above its axis at positions, m, ``(n,)``; at a step the larger of both sides."""
        found = np.zeros(x.size)
        for piece in self.problem.line.pieces:
            if piece.section is not None:
                here = (x >= piece.start) & (x <= piece.end)
                found = np.maximum(found, np.where(here, piece.section.depth / 2, 0.0))
        return found

    @property
    def half_mass(self) -> float:
        """Half the side of the cube that stands for a mass, m; it covers the beam."""
        return max(1.2 * self.half_depth, self.problem.line.length / 50)

    @property
    def breadth(self) -> float:
        """Largest breadth of the beam, m; a thirtieth of its length where the problem gives no cross-section."""
        sections = [piece.section for piece in self.problem.line.pieces]
        wide = [it.breadth if isinstance(it, Rectangle) else it.depth for it in sections if it is not None]
        return max(wide, default=self.problem.line.length / 30)

    @property
    def reach(self) -> float:
        """Distance from the beam's surface to the rails that carry the stops, m, without gaps."""
        return max(2 * self.half_depth, self.problem.line.length / 15, 1.6 * self.pressed)

    def widest_gap(self, sign: int) -> float:
        """The widest gap, m, on the side `sign` of the beam (1: above), by which the rail of this side is moved
        away."""
        return max((stop.gap for stop in self.problem.structure.stops if stop.sign == sign), default=0.0)

    def place(self, x: FloatArray, y: FloatArray | float, z: FloatArray | float) -> FloatArray:
        """Points of the scene, (n, 3), from coordinates along, across and above this joint's axis, m, (n,)."""
        return np.column_stack(np.broadcast_arrays(x, np.asarray(y) + self.offset, z)).astype(float)


def check_points(points: int) -> None:
    """Refuse a number of stations along a beam that is not 2 to `MOST_POINTS`."""
    if not 2 <= points <= MOST_POINTS:
        raise InputError(f"points = {points}: allowed are 2 to {MOST_POINTS}")
