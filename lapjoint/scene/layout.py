"""The layout of a joint at rest: positions along the beam (stations), and sizes of parts that the problem leaves
open."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, NamedBeam, Problem
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
        structure = self.problem.structure
        special = [support.x for support in structure.supports] + [mass.x for mass in structure.masses]
        special += [x for stop in structure.stops for x, _ in stop.reading]
        special += [piece.end for piece in structure.line.pieces]
        grid = structure.line.grid(self.points)
        # A grid point within 1e-9 L of a support, stop, mass or step is left out, so that no cell is degenerate.
        apart = np.all(np.abs(grid[:, None] - np.array(special)[None, :]) > 1e-9 * self.longest, axis=1)
        return np.unique(np.concatenate([grid[apart], special]))

    @property
    def longest(self) -> float:
        """Length of the longest beam, m."""
        return max(beam.length for beam in self.problem.line.beams)

    def beam_of(self, x: FloatArray) -> IntArray:
        """The beam at, or nearest to, each position on the line, m, ``(n,)``."""
        return np.array([self.problem.line.beam_at(float(one)) for one in x], dtype=np.int64)

    def levels(self, x: FloatArray) -> FloatArray:
        """Height of the axis of the beam at each position on the line, m, ``(n,)``."""
        return self._moved_by[1][self.beam_of(x)]

    @cached_property
    def _moved_by(self) -> tuple[FloatArray, FloatArray]:
        """How far each beam lies along x from its place on the line, and above z = 0, m, ``(beams,)`` each."""
        line = self.problem.line
        named = [(beam.origin, beam.offset) if isinstance(beam, NamedBeam) else (0.0, 0.0) for beam in line.beams]
        return np.array([x for x, _ in named]) - np.array(line.starts), np.array([z for _, z in named])

    @cached_property
    def at_stops(self) -> IntArray:
        """Index of the station at which each stop meets the beam from below or above, shape ``(stops,)``."""
        seen = [stop.reading[0][0] for stop in self.problem.structure.stops]
        return np.searchsorted(self.stations, seen).astype(np.int64)

    @cached_property
    def on_beams(self) -> tuple[tuple[int, int], ...]:
        """Stop, and station on its first beam, of each stop between two beams."""
        stops = self.problem.structure.stops
        return tuple(
            (k, int(np.searchsorted(self.stations, stop.x))) for k, stop in enumerate(stops) if stop.side == "between"
        )

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
        return max(1.2 * self.half_depth, self.longest / 50)

    @property
    def breadth(self) -> float:
        """Largest breadth of the beam, m; a thirtieth of its length where the problem gives no cross-section."""
        sections = [piece.section for piece in self.problem.line.pieces]
        wide = [it.breadth if isinstance(it, Rectangle) else it.depth for it in sections if it is not None]
        return max(wide, default=self.longest / 30)

    @property
    def reach(self) -> float:
        """Distance from the beam's surface to the rails that carry the stops, m, without gaps."""
        return max(2 * self.half_depth, self.longest / 15, 1.6 * self.pressed)

    def widest_gap(self, sign: int) -> float:
        """The widest gap, m, on the side `sign` of the beam (1: above), by which the rail of this side is moved
        away."""
        return max((stop.gap for stop in self.problem.structure.stops if stop.sign == sign), default=0.0)

    def place(self, x: FloatArray, y: FloatArray | float, z: FloatArray | float) -> FloatArray:
        """Points of the scene, (n, 3), from positions on the line, and coordinates across and above the beam's axis, m,
        (n,)."""
        along, above = (moved[self.beam_of(x)] for moved in self._moved_by)
        return np.column_stack(np.broadcast_arrays(x + along, np.asarray(y) + self.offset, z + above)).astype(float)


def check_points(points: int) -> None:
    """Refuse a number of stations along a beam that is not 2 to `MOST_POINTS`."""
    if not 2 <= points <= MOST_POINTS:
        raise InputError(f"points = {points}: allowed are 2 to {MOST_POINTS}")
