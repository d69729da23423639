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
    """Number of equidistant stations along the beam; the positions of supports and stops are added."""
    offset: float = 0.0
    """Shift of the joint along y, m, if several joints stand side by side."""
    pressed: float = 0.0
    """Largest penetration of a stop, m; the springs are made longer than this."""

    def __post_init__(self) -> None:
        check_points(self.points)

    @cached_property
    def stations(self) -> FloatArray:
        """Positions along the beam, m, ascending, shape ``(n,)``."""
        L = self.problem.beam.length
        special = [support.x for support in self.problem.supports] + [stop.x for stop in self.problem.stops]
        grid = np.linspace(0.0, L, self.points)
        # A grid point closer than this to a support or stop is left out, so that no cell is degenerate.
        apart = np.all(np.abs(grid[:, None] - np.array(special)[None, :]) > 1e-9 * L, axis=1)
        return np.unique(np.concatenate([grid[apart], special]))

    @cached_property
    def at_stops(self) -> IntArray:
        """Index of each stop's station, shape ``(stops,)``."""
        return np.searchsorted(self.stations, [stop.x for stop in self.problem.stops]).astype(np.int64)

    @cached_property
    def across(self) -> FloatArray:
        """Position of each stop across the beam, m, shape ``(stops,)``; stops at one position stand side by side."""
        stops = self.problem.stops
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
        """Height of the beam's surface above its axis, m; 0 if the problem gives no cross-section."""
        section = self.problem.beam.section
        return section.depth / 2 if section else 0.0

    @property
    def breadth(self) -> float:
        """Breadth of the beam, m; a thirtieth of its length if the problem gives no cross-section."""
        section = self.problem.beam.section
        if section is None:
            return self.problem.beam.length / 30
        return section.breadth if isinstance(section, Rectangle) else section.depth

    @property
    def reach(self) -> float:
        """Distance from the beam's surface to the rails that carry the stops, m, without gaps."""
        return max(2 * self.half_depth, self.problem.beam.length / 15, 1.6 * self.pressed)

    def widest_gap(self, sign: int) -> float:
        """The widest gap, m, on the side `sign` of the beam (1: above), by which the rail of this side is moved
        away."""
        return max((stop.gap for stop in self.problem.stops if stop.sign == sign), default=0.0)

    def place(self, x: FloatArray, y: FloatArray | float, z: FloatArray | float) -> FloatArray:
        """Points of the scene, (n, 3), from coordinates along, across and above this joint's axis, m, (n,)."""
        return np.column_stack(np.broadcast_arrays(x, np.asarray(y) + self.offset, z)).astype(float)


def check_points(points: int) -> None:
    """Refuse a number of stations along a beam that is not 2 to `MOST_POINTS`."""
    if not 2 <= points <= MOST_POINTS:
        raise InputError(f"points = {points}: allowed are 2 to {MOST_POINTS}")
