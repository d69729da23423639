"""A plane of starts: two coordinates in which a section point is moved, each a displacement or velocity at a place."""

from __future__ import annotations

import re
from dataclasses import dataclass

from lapjoint.errors import InputError
from lapjoint.problem.places import place_of
from lapjoint.problem.problem import Problem

_COORDINATE = re.compile(r"\s*([zv])\s*\(\s*([^()\s]+)\s*\)\s*")


@dataclass(frozen=True)
class Coordinate:
    """One coordinate of a plane of starts: the displacement or the velocity at a place."""

    kind: str
    """"z": displacement, m; "v": velocity, m/s."""
    place: float | str
    """m from the root; of several beams as ``upper:0.3``."""

    def __str__(self) -> str:
        return f"{self.kind}({self.place})" if isinstance(self.place, str) else f"{self.kind}({self.place:.10g})"

    @property
    def units(self) -> str:
        """Unit of its values, as CF writes it."""
        return "m" if self.kind == "z" else "m s-1"


@dataclass(frozen=True)
class Plane:
    """Two coordinates in which a section point is moved."""

    first: Coordinate
    second: Coordinate

    @staticmethod
    def from_text(text: str) -> Plane:
        """The plane of two coordinates with a comma between them, as in ``z(2.5),v(2.5)``."""
        parts = text.split(",") if isinstance(text, str) else []
        found = [_COORDINATE.fullmatch(part) for part in parts]
        try:
            coordinates = [Coordinate(one[1], place_of(one[2])) for one in found if one is not None]
        except ValueError:
            coordinates = []
        if len(found) != 2 or len(coordinates) != 2:
            raise InputError(
                f"plane = {text!r}: must be two coordinates, displacement z or velocity v at a place, m, as in "
                "z(2.5),v(2.5)"
            )
        if coordinates[0] == coordinates[1]:
            raise InputError(f"plane = {text!r}: both coordinates are {coordinates[0]}; they must differ")
        return Plane(*coordinates)

    def __str__(self) -> str:
        return f"{self.first},{self.second}"

    @property
    def coordinates(self) -> tuple[Coordinate, Coordinate]:
        """Both coordinates."""
        return self.first, self.second

    def check(self, problem: Problem) -> None:
        """Refuse a plane with a place that is not on the beam of a problem."""
        for one in self.coordinates:
            fault = problem.line.fault_of(one.place)
            if fault:
                raise InputError(f"plane = {str(self)!r}: {one}: {fault[1]}")
