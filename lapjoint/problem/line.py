"""All beams of a problem on one axis, the line: end to end in the order of the file, with a space between neighbours.

A position on the line is one number, m, wherever a position is meant; of a problem with one beam it is the position
from the root.  On a space there is nothing: no stiffness, no mass, no displacement.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem.beam import Beam, BeamPiece, Material, Section
from lapjoint.problem.fatigue import SNLine
from lapjoint.problem.messages import shortened
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.places import split_place
from lapjoint.problem.schema import FloatArray

_SPACE = 0.25
"""Space between two beams on the line, divided by the length of the longest beam; any number gives the same answers."""


@dataclass(frozen=True)
class Line:
    """The beams of a problem on one axis."""

    beams: tuple[Beam, ...]
    """The beams, from left to right."""

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """Where each beam begins on the line, m."""
        space, found = _SPACE * max(beam.length for beam in self.beams), [0.0]
        for beam in self.beams[:-1]:
            found.append(found[-1] + beam.length + space)
        return tuple(found)

    @cached_property
    def ends(self) -> tuple[float, ...]:
        """Where each beam ends on the line, m."""
        return tuple(start + beam.length for start, beam in zip(self.starts, self.beams, strict=True))

    @cached_property
    def spaces(self) -> tuple[tuple[float, float], ...]:
        """Start and end, m, of the space after each beam but the last."""
        return tuple(zip(self.ends[:-1], self.starts[1:], strict=True))

    @property
    def length(self) -> float:
        """Length of the line, m: L of the only beam."""
        return self.ends[-1]

    @property
    def several(self) -> bool:
        """Whether beams have names, and places are a name and a position: true of all beams but a [beam]."""
        return isinstance(self.beams[0], NamedBeam)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The name of each beam; empty of the only beam."""
        return tuple(beam.name if isinstance(beam, NamedBeam) else "" for beam in self.beams)

    @cached_property
    def pieces(self) -> tuple[BeamPiece, ...]:
        """The parts of constant stiffness and mass of all beams, from left to right, by their positions on the line."""
        return tuple(
            BeamPiece(
                start + piece.start,
                start + piece.end,
                piece.EI,
                piece.mass,
                piece.inertia,
                piece.material,
                piece.section,
            )
            for start, beam in zip(self.starts, self.beams, strict=True)
            for piece in beam.pieces
        )

    @cached_property
    def EI(self) -> float:
        """Bending stiffness EI of a beam, N m2; a mean of several, or of one with segments."""
        if not self.several:
            return self.beams[0].EI
        return sum(beam.length for beam in self.beams) / sum(beam.length / beam.EI for beam in self.beams)

    @cached_property
    def m(self) -> float:
        """Mass per unit length that moves of a beam, kg/m; the mean of several, or of one with segments."""
        if not self.several:
            return self.beams[0].m
        return sum(beam.m * beam.length for beam in self.beams) / sum(beam.length for beam in self.beams)

    @property
    def slowest_bending(self) -> float:
        """Lowest natural angular frequency of a beam as a uniform cantilever, rad/s: that of the slowest beam."""
        return min(beam.slowest_bending for beam in self.beams)

    def beam_at(self, x: float) -> int:
        """The beam at a position.

        Parameters
        ----------
        x : float
            Position on the line, m.

        Returns
        -------
        int
            Its index; that of the nearest beam, if the position is on a space.
        """
        distances = [max(a - x, x - b, 0.0) for a, b in zip(self.starts, self.ends, strict=True)]
        return distances.index(min(distances))

    def at(self, place: float | str) -> float:
        """A place on the line.

        Parameters
        ----------
        place : float or str
            Position on the line, m, which is that on the only beam; or the name of one of several beams, and a position
            on it: ``upper:0.3``.

        Returns
        -------
        float
            The position on the line, m.

        Raises
        ------
        InputError
            If there is no such beam, or the position is not on it.
        """
        if isinstance(place, str):
            fault, found = self.fault_of(place), split_place(place)
            if fault or found is None:
                raise InputError(f"x = {fault[0]}: {fault[1]}" if fault else f"x = {place}: is no place")
            return self.starts[self.names.index(found[0])] + found[1]
        if not any(a <= place <= b for a, b in zip(self.starts, self.ends, strict=True)):
            allowed = " or ".join(f"{a:g} to {b:g} m" for a, b in zip(self.starts, self.ends, strict=True))
            raise InputError(f"x = {place:g}: lies outside the beam; allowed are {allowed}")
        return float(place)

    def fault_of(self, place: float | str) -> tuple[str, str] | None:
        """What is wrong with a place as a file states it.

        Parameters
        ----------
        place : float or str
            The place, a number of the only beam, and a name and a number of several.

        Returns
        -------
        tuple of (str, str), or None
            The place as a message shows it, and what is wrong with it; None if nothing is.
        """
        if not isinstance(place, str):
            if self.several:
                return (
                    f"{place:g}",
                    f'of several beams a place is a name and a number, as in "{self.names[0]}:{place:g}"',
                )
            L = self.beams[0].length
            return None if 0.0 <= place <= L else (f"{place:g}", f"lies outside the beam; allowed are 0 to {L:g} m")
        text, found = shortened(f'"{place}"'), split_place(place)
        if not self.several:
            return text, "there is one beam, without a name; a place is a number, m"
        if found is None or found[0] not in self.names:
            return text, f'must be a beam and a position, as in "{self.names[0]}:0.1"; beams: {", ".join(self.names)}'
        L = self.beams[self.names.index(found[0])].length
        return None if found[1] <= L else (text, f"lies outside the beam; allowed are 0 to {L:g} m")

    def exact_place(self, x: float) -> float | str:
        """A position as a place that stays on its beam if the lengths of beams change.

        Parameters
        ----------
        x : float
            Position on the line, m.

        Returns
        -------
        float or str
            The place, as `at` takes it: the position, or of several beams a name and a position.
        """
        if not self.several:
            return x
        i = self.beam_at(x)
        return f"{self.names[i]}:{min(x - self.starts[i], self.beams[i].length)!r}"

    def place(self, x: float, digits: int = 6) -> str:
        """A position as a person writes it.

        Parameters
        ----------
        x : float
            Position on the line, m.
        digits : int
            Number of significant digits.

        Returns
        -------
        str
            As ``1.25``, or ``upper:0.3`` of several beams.
        """
        if not self.several:
            return f"{x:.{digits}g}"
        i = self.beam_at(x)
        return f"{self.names[i]}:{x - self.starts[i]:.{digits}g}"

    def check(self, x: FloatArray) -> None:
        """Refuse positions that lie on no beam.

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions on the line, m.

        Raises
        ------
        ValueError
            If a position lies on no beam.
        """
        on = np.any([(a <= x) & (x <= b) for a, b in zip(self.starts, self.ends, strict=True)], axis=0)
        if not on.all():
            allowed = " or ".join(f"{a:g} to {b:g} m" for a, b in zip(self.starts, self.ends, strict=True))
            raise ValueError(f"x must lie within the beam, {allowed}")

    def grid(self, points: int) -> FloatArray:
        """Equidistant positions along each beam.

        Parameters
        ----------
        points : int
            Number of positions on each beam, at least 2; both ends are among them.

        Returns
        -------
        FloatArray, shape (beams * points,)
            Positions on the line, m, ascending.
        """
        return np.concatenate([np.linspace(a, b, points) for a, b in zip(self.starts, self.ends, strict=True)])

    def own(self, x: FloatArray, beam: int) -> FloatArray:
        """Which positions are on a beam.

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions on the line, m.
        beam : int
            Index of the beam.

        Returns
        -------
        FloatArray, shape (n,)
            True for the positions on this beam.
        """
        return np.asarray((x >= self.starts[beam]) & (x <= self.ends[beam]))

    @property
    def edges(self) -> tuple[float, ...]:
        """Positions of the ends of all beams, m, ascending."""
        return tuple(x for ends in zip(self.starts, self.ends, strict=True) for x in ends)

    def EI_at(self, x: FloatArray) -> FloatArray:
        """Bending stiffness at positions.

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions on the line, m.

        Returns
        -------
        FloatArray, shape (n,)
            EI, N m2; at a step that of the piece to the left, and 0 on a space.
        """
        return self._of_piece(self._piece_numbers[1], x)

    def inertia_at(self, x: FloatArray) -> FloatArray:
        """Mass per unit length that moves, kg/m, at positions, m, ``(n,)``.  See `EI_at`."""
        return self._of_piece(self._piece_numbers[2], x)

    @cached_property
    def _piece_numbers(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """End, m, EI, N m2, and inertia, kg/m, of each piece, ``(pieces,)``."""
        rows = np.array([(piece.end, piece.EI, piece.inertia) for piece in self.pieces])
        return rows[:, 0], rows[:, 1], rows[:, 2]

    def _of_piece(self, values: FloatArray, x: FloatArray) -> FloatArray:
        """A number of the piece at each position, m, ``(n,)``; at a step of the piece to the left, on spaces 0."""
        ends = self._piece_numbers[0]
        found = np.asarray(values[np.minimum(np.searchsorted(ends, x, side="left"), ends.size - 1)])
        for start, end in self.spaces:
            found = np.where((x > start) & (x < end), 0.0, found)
        return found

    def stress_per_moment_at(self, x: FloatArray, purpose: str = "stress") -> FloatArray:
        """Bending stress at the faces of the beam, divided by the bending moment.

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions on the line, m.
        purpose : str
            What needs it; the message begins with it.

        Returns
        -------
        FloatArray, shape (n,)
            c / I, 1/m3, with c half of the depth; at a step the larger of both sides.

        Raises
        ------
        InputError
            If a piece of a beam has no section.
        """
        self.require_sections(purpose)
        found = np.zeros(np.shape(x))
        for piece in self.pieces:
            assert piece.section is not None
            here = (x >= piece.start) & (x <= piece.end)
            own = np.where(here, piece.section.depth / 2 / piece.section.second_moment, 0.0)
            found = np.maximum(found, own)
        return found

    def require_sections(self, purpose: str) -> tuple[tuple[Material, Section], ...]:
        """The material and the cross-section of each piece, for what cannot be done without.

        Parameters
        ----------
        purpose : str
            What needs them; the message begins with it.

        Returns
        -------
        tuple of (Material, Section)
            One pair for each of `pieces`.

        Raises
        ------
        InputError
            If a piece has none.
        """
        found = tuple((piece.material, piece.section) for piece in self.pieces)
        whole = tuple((material, section) for material, section in found if material and section)
        if len(whole) < len(found):
            raise InputError(f"{purpose}: the beam has no section; it needs beam.material and beam.section")
        return whole

    @property
    def has_sections(self) -> bool:
        """Whether each piece has a section."""
        return all(piece.section is not None for piece in self.pieces)

    @cached_property
    def has_fatigue(self) -> bool:
        """Whether the beams have sections everywhere, and any of them a material with an S-N line."""
        return self.has_sections and any(
            piece.material is not None and piece.material.fatigue is not None for piece in self.pieces
        )

    def fatigue_at(self, x: float) -> SNLine | None:
        """The S-N line at a position: at a step that of the side with the larger stress.

        Parameters
        ----------
        x : float
            Position on the line, m.

        Returns
        -------
        SNLine or None
            The line; None if the material there has none.
        """
        sides = [piece for piece in self.pieces if piece.start <= x <= piece.end and piece.section is not None]
        if not sides:
            return None
        larger = max(sides, key=lambda piece: piece.section.depth / piece.section.second_moment if piece.section else 0)
        return larger.material.fatigue if larger.material else None
