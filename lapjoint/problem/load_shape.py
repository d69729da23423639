"""Where a load acts: at points, and along pieces of the beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True)
class LoadShape:
    """The forces of a load of size 1; their unit, times that of the size, is N at points and N/m along pieces."""

    points: tuple[tuple[float, float], ...] = ()
    """Position, m, and force of each point."""
    pieces: tuple[tuple[float, float, float], ...] = ()
    """Start, m, end, m, and force per unit length of each piece; pieces may overlap."""

    @classmethod
    def at(cls, x: float) -> Self:
        """A unit force at a position, m."""
        return cls(points=((x, 1.0),))

    @classmethod
    def along(cls, start: float, end: float) -> Self:
        """A unit force per unit length from one position to another, m."""
        return cls(pieces=((start, end, 1.0),))

    @property
    def edges(self) -> tuple[float, ...]:
        """Positions of the points and of the ends of the pieces, m."""
        return (*(x for x, _ in self.points), *(x for start, end, _ in self.pieces for x in (start, end)))
